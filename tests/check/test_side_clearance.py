"""The play of a groove with side clearance: flanks, undercut, cure, and its effect on the lift."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.check.flank import check_side_clearance, largest_deviation
from camgeo.design.design import Design
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.kinematics.mechanism.oscillating_roller import OscillatingRoller
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.scene.scene import parse_scene
from camgeo.units import TURN
from tests.scene.scenes import GROOVE, spoilt
from tests.strategies import BENT, attack, linked_pitch_curves, pitch_curves

ROUNDING = 1e-10
"""Rounding of the leverage: 1e-13 of the largest |Z'| by |Z'|, down to a thousandth of it."""


@attack
@given(
    curve=st.one_of(pitch_curves(BENT), linked_pitch_curves(BENT)), clearance=st.floats(1e-3, 1.0)
)
def test_no_cam_angle_has_more_play_than_reported(curve: PitchCurve, clearance: float) -> None:
    """(c/2)/|dn/dq| at many angles, on both sides of all breaks, and at the place itself."""
    deviation, place = largest_deviation(curve, clearance)
    phi = np.linspace(0.0, TURN, 2000)
    places: tuple[tuple[FloatArray, Side], ...] = (
        (phi, "right"),
        (curve.breaks, "right"),
        (curve.breaks, "left"),
    )
    sides = [0.5 * clearance / np.abs(curve.leverage(*each)) for each in places]
    speed = np.abs(curve.jet(phi)[1])
    assert np.max(np.concatenate(sides)) <= deviation * (1.0 + ROUNDING)
    if np.min(speed) > 1e-3 * np.max(speed):
        at = np.array([place])
        levers = np.abs([curve.leverage(at, "left"), curve.leverage(at, "right")])
        # At the end of a piece its own value counts.
        assert 0.5 * clearance / np.min(levers) == pytest.approx(deviation, rel=1e-7)


def test_it_is_stated_in_the_unit_of_the_lift() -> None:
    rocker = design("oscillating")
    (found,) = (f for f in rocker.findings if f.name == "side-clearance")
    assert found.severity == "ok"
    assert found.unit == "deg"
    deviation, place = largest_deviation(rocker.cam.disc.pitch_curve, 0.1)
    assert found.value == pytest.approx(math.degrees(deviation))
    assert found.cam_angle == place
    guide = design("translating")
    assert {f.unit for f in guide.findings if f.name == "side-clearance"} == {"mm"}
    assert not [f for f in design("translating", 0.0).findings if f.name == "side-clearance"]


def test_a_follower_that_locks_has_no_bound() -> None:
    curve = design("translating").cam.disc.pitch_curve
    follower = curve.follower
    assert isinstance(follower, TranslatingRoller)
    locked = replace(follower, offset=follower.base_radius)
    found = check_side_clearance(replace(curve, follower=locked), 0.1)
    assert found.value is None
    assert "any amount" in found.sentence


MOVES = """[[motion]]
dwell = 90
[[motion]]
law = "modified-sine"
span = 90
to = {to}
[[motion]]
dwell = 90
[[motion]]
law = "modified-sine"
span = 90
to = 0
"""


def design(kind: str, clearance: float = 0.1, roller: float = 8.0, to: float = 12.0) -> Design:
    text = spoilt(
        GROOVE,
        ("[[motion]]\ndwell = 360\n", MOVES.format(to=to)),
        ("roller_radius = 8\n", f"roller_radius = {roller!r}\nside_clearance = {clearance!r}\n"),
    )
    if kind == "oscillating":
        text = spoilt(
            text, ('"translating-roller"', '"oscillating-roller"\npivot = [100, 0]\narm = 75')
        )
    return Design(parse_scene(text))


@pytest.mark.parametrize("kind", ["translating", "oscillating"])
def test_the_groove_is_wider_than_the_roller_by_the_clearance(kind: str) -> None:
    cam = design(kind, 0.3)
    phi = np.linspace(0.0, TURN, 37)
    pitch, inner, outer = (
        cam.disc.pictured.curve(name, phi) for name in ("pitch", "inner", "outer")
    )
    # Places of 90 mm are rounded to 1e-14 mm.
    assert np.linalg.norm(outer - inner, axis=1) == pytest.approx(np.full(37, 16.3), abs=1e-12)
    assert np.linalg.norm(outer - pitch, axis=1) == pytest.approx(np.full(37, 8.15), abs=1e-12)
    assert isinstance(cam.cam.follower, OscillatingRoller) == (kind == "oscillating")
    assert cam.cam.follower.roller_radius == 8.0


def test_the_rule_of_thumb_is_of_the_roller_and_the_cusp_of_the_flank() -> None:
    """Between r_K - c/2 and r_K the roller fits and the groove's flank undercuts; the cure is the
    roller whose groove just has no cusp."""
    sharp = design("translating", 0.0, 5.0, 40.0)
    radius = 1.0 / max(sharp.cam.disc.bends.largest()[0], -sharp.cam.disc.bends.smallest()[0])
    roller = radius - 0.1
    cam = design("translating", 0.5, roller, 40.0)
    ratios = [f.value for f in cam.findings if f.name.startswith("radius-ratio")]
    assert max(value or 0.0 for value in ratios) == pytest.approx(roller / radius, rel=1e-12)
    assert [f for f in cam.findings if f.name.startswith("undercut") and f.severity == "no-disc"]
    without = design("translating", 0.0, roller, 40.0)
    assert not [f for f in without.findings if f.name.startswith("undercut") and f.severity != "ok"]
    found = {(each.fault, each.knob): each for each in cam.judgement.cures}
    cure = found["undercut", "roller radius"]
    assert cure.limit == pytest.approx(radius - 0.25, rel=1e-9)
