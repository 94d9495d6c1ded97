from __future__ import annotations

import math
from decimal import Decimal
from pathlib import Path

import numpy as np
import pytest

from camgeo.design.design import Design
from camgeo.errors import GeometryError
from camgeo.geometry.outline.envelope import STEEPEST, Envelope, divide
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.kinematics.mechanism.linked_motion import LinkedMotion
from camgeo.kinematics.mechanism.oscillating_roller import OscillatingRoller
from camgeo.kinematics.mechanism.slider_crank import SliderCrank
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.scene.scene import load_scene
from tests.reference import POLYNOMIAL

FOUND = Path(__file__).parents[2] / "fixtures" / "found"

NO_CUSPS = np.empty(0)


def flank(short: float) -> WorkingCurve:
    """For a cam whose linkage comes within a stroke of `short` [mm] of a dead centre at 120 deg."""
    linkage = SliderCrank(40.0, 60.0, math.radians(30.0), True, 1, 1, 1)
    stroke = max(linkage.dead_strokes) - short
    third = Decimal(120)
    plan = MotionPlan((Move(third, stroke, POLYNOMIAL), Dwell(third), Move(third, 0.0, POLYNOMIAL)))
    follower = OscillatingRoller(-60.0 + 10.0j, 55.0, 40.0, 3.0, direction=None)
    return WorkingCurve(PitchCurve(LinkedMotion(plan, linkage), follower, 1), -3.0)


@pytest.mark.parametrize("short", [1.0, 1e-2, 1e-4, 1e-6, 1e-8])
def test_the_cells_next_to_a_dead_centre_are_as_wide_as_they_are_far_from_it(short: float) -> None:
    """So their number grows with the logarithm of the distance: a few tens per decade."""
    found = divide(Envelope(flank(short)), NO_CUSPS).cells
    assert np.all(found.turn <= STEEPEST)
    assert len(found) <= 200 + 50 * abs(math.log10(short))


def test_few_cells_do_next_to_a_change_point() -> None:
    """There coupler, crank and lever are nearly in line, and the terms of a sum nearly cancel:
    bounds of their magnitudes would need 15,000 cells."""
    curve = Design(load_scene(FOUND / "near_dead_centre.toml")).cam.disc.inner_curve
    assert len(divide(Envelope(curve), NO_CUSPS).cells) <= 200


def test_an_unresolved_bend_is_reported_with_its_place(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("camgeo.geometry.outline.envelope.NARROWEST", 1e-3)
    place = r"at cam angle 1(19|20)\.\d* deg .* more tightly than can be resolved"
    with pytest.raises(GeometryError, match=place):
        divide(Envelope(flank(1e-8)), NO_CUSPS)


def test_no_flank_is_divided_at_a_dead_centre() -> None:
    with pytest.raises(GeometryError, match="dead centre"):
        divide(Envelope(flank(0.0)), NO_CUSPS)
