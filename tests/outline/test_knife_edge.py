"""A knife edge, a roller of radius 0: the flank is the pitch curve, its corners are sharp."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given

import camgeo
from camgeo.check.flank import check_standstill
from camgeo.design.design import Design
from camgeo.errors import SceneError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.contour.exact import chords_of
from camgeo.geometry.outline.outline import real_outline
from camgeo.geometry.outline.replay import replay_contour, replay_outline
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.kinematics.plan import MotionPlan
from camgeo.scene.scene import parse_scene
from camgeo.units import TURN
from tests.contour.cams import dwell
from tests.strategies import attack, pitch_curves, signs, wild_pitch_curves, with_roller

SCENE = Path(__file__).parents[2] / "fixtures" / "scenes" / "knife_edge.toml"


@attack
@given(curve=wild_pitch_curves(), side=signs())
def test_nothing_is_cut_off_whatever_the_motion(curve: PitchCurve, side: int) -> None:
    """1 + 0 kappa never vanishes; with shocks the corners stand where the velocity jumps."""
    edge = with_roller(curve, 0.0)
    assume(not check_standstill(edge))
    outline = real_outline(WorkingCurve(edge, math.copysign(0.0, side)))
    assert not outline.is_trimmed
    assert outline.lobes == ()
    assert all(each.distance == 0.0 for each in outline.path.pivots)
    replay = replay_outline(edge, outline.path)
    assert replay.press == side
    assert replay.largest_error.value == 0.0
    assert len(replay.drops) == 0


@attack
@given(curve=pitch_curves(), side=signs())
def test_inner_and_outer_flank_are_the_pitch_curve(curve: PitchCurve, side: int) -> None:
    phi = np.linspace(0.0, TURN, 61)
    flank = WorkingCurve(curve, math.copysign(0.0, side))
    assert np.array_equal(flank.point(phi), curve.point(phi))
    assert np.all(flank.regularity(phi) == 1.0)


def test_on_a_polygon_the_edge_rides_along_its_sides() -> None:
    """The height of the polygon's side over the angle, exactly; no arcs about its vertices."""
    follower = TranslatingRoller(40.0, 0.0)
    curve = PitchCurve(MotionPlan((dwell(360),)), follower, 1)
    polygon = chords_of(Contour.circle(40.0), 0.5).contour
    replay = replay_contour(curve, polygon, "inner")
    ends = polygon.vertices
    half = 0.5 * abs(ends[1] - ends[0])
    apothem = math.sqrt(abs(ends[0]) ** 2 - half**2)
    width = 2.0 * math.asin(half / abs(ends[0]))
    around = np.angle(1j * np.exp(-1j * replay.phi) / ends[0]) % width
    height = apothem / np.cos(around - 0.5 * width)
    # The lift is a difference of lengths of 40 mm, the angles are rounded to some ulp of a turn.
    assert np.max(np.abs(replay.actual[0] + 40.0 - height)) < 1e-12
    assert len(replay.shocks) == len(ends)
    inside = replay_contour(curve, polygon, "outer")
    assert np.max(np.abs(inside.actual[0] - replay.actual[0])) < 1e-12


def with_motion(motion: str) -> Design:
    text = SCENE.read_text("utf-8")
    first, last = text.index("[[motion]]"), text.index("[limits]")
    return Design(parse_scene(text[:first] + motion + text[last:]))


CONCAVE = """[[motion]]
dwell = 100
[[motion]]
law = "straight-line"
span = 130
to = 10
[[motion]]
law = "modified-sine"
span = 130
to = 0
"""


def test_a_concave_corner_is_drawn_and_no_cutter_makes_it() -> None:
    """Where the edge sets out from rest with a jump."""
    design = with_motion(CONCAVE)
    assert design.judgement.has_outline
    fit = design.disc.drawn.part.boundaries[0].arcs(1e-3)
    assert fit.deviation <= 1e-3
    corner = complex(design.cam.disc.pitch_curve.point(np.array([math.radians(100.0)]))[0])
    assert np.min(np.abs(fit.contour.vertices - corner)) <= 1e-12
    with pytest.raises(SceneError, match="a concave part of it") as caught:
        design.disc.milled.toolpath(1e-3)
    assert [fault.key for fault in caught.value.faults] == ["tool[1]"]


def test_the_check_states_that_any_curvature_fits() -> None:
    design = camgeo.load(SCENE)
    (found,) = (f for f in design.findings if f.name == "radius-ratio-inner")
    assert (found.severity, found.value) == ("ok", 0.0)
    assert "knife edge" in found.sentence
    assert design.judgement.cures == ()
    assert design.disc.pictured.cut_off == ()


@pytest.mark.parametrize(("base", "offset"), [("30", "3"), ("10", "0"), ("3", "0")])
def test_a_sharp_corner_has_an_outline(base: str, offset: str) -> None:
    """However far it turns about the corner: 23, 37 and 47 degrees."""
    text = SCENE.read_text("utf-8").replace("base_radius = 30", f"base_radius = {base}")
    design = Design(parse_scene(text.replace("offset = 3", f"offset = {offset}"), str(SCENE)))
    assert {each.severity for each in design.findings} <= {"ok", "warning", "broken"}
    assert len(design.cam.disc.inner_outline.path.pivots) == 1
