from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given

from camgeo.check.finding import Finding
from camgeo.check.machine import POINT_LIMIT, TANGENT_LIMIT, check_closure
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.kinematics.mechanism.linked_motion import LinkedMotion
from camgeo.kinematics.mechanism.oscillating_roller import OscillatingRoller
from camgeo.kinematics.mechanism.slider_crank import SliderCrank
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.kinematics.motion import Dwell as DwellSpan
from camgeo.kinematics.motion import Jet
from camgeo.kinematics.plan import MotionPlan
from camgeo.numeric.arrays import FloatArray, Side
from tests.reference import mechanisms, pitch_curve_of
from tests.strategies import SMOOTH, attack, pitch_curves, plans, slider_cranks


def named(curve: PitchCurve) -> dict[str, Finding]:
    return {finding.name: finding for finding in check_closure(curve)}


@attack
@given(curve=pitch_curves(SMOOTH))
def test_smooth_laws_close_without_a_word(curve: PitchCurve) -> None:
    found = named(curve)
    assert {name: finding.severity for name, finding in found.items()} == {
        "closure": "ok",
        "tangent-closure": "ok",
    }
    gap, turn = found["closure"], found["tangent-closure"]
    assert gap.unit == "mm"
    assert turn.unit == "deg"
    assert gap.value is not None
    assert gap.limit is not None
    assert gap.value <= gap.limit
    assert gap.limit >= POINT_LIMIT * curve.follower.base_radius
    assert turn.limit == math.degrees(TANGENT_LIMIT)


@attack
@given(plan=plans(SMOOTH, 8.0), linkage=slider_cranks(8.0))
def test_smooth_laws_stay_smooth_behind_a_linkage(plan: MotionPlan, linkage: SliderCrank) -> None:
    rocker = OscillatingRoller(-200.0 + 0j, 120.0, 170.0, 5.0, 1, None)
    found = named(PitchCurve(LinkedMotion(plan, linkage), rocker, 1))
    assert set(found) == {"closure", "tangent-closure"}


@pytest.mark.parametrize("name", mechanisms())
def test_the_cams_of_the_reference_close(name: str) -> None:
    found = named(pitch_curve_of(mechanisms()[name]["params"]))
    assert {finding.severity for finding in found.values()} == {"ok"}


class Spiral:
    """A lift that does not come back: 1 mm more after every turn."""

    breaks = np.array([0.0])
    borders = np.array([0.0])
    dwells: tuple[DwellSpan, ...] = ()

    def jet(self, phi: FloatArray, side: Side = "right", order: int = 3) -> Jet:
        inside = np.mod(phi, 2.0 * math.pi)
        if side == "left":
            inside = np.where(inside == 0.0, 2.0 * math.pi, inside)
        rate = np.full(len(phi), 0.5 / math.pi)
        return np.stack((inside * rate, rate, 0.0 * rate, 0.0 * rate))

    def jet_and_bounds(self, low: FloatArray, high: FloatArray) -> tuple[Jet, Jet]:
        return self.jet(0.5 * (low + high)), np.ones((4, len(low)))


def test_a_curve_that_does_not_close_is_seen() -> None:
    found = named(PitchCurve(Spiral(), TranslatingRoller(40.0, 5.0), 1))
    assert found["closure"].severity == "no-disc"
    assert found["closure"].value == pytest.approx(1.0, rel=1e-12)
    assert found["closure"].cam_angle == 0.0
