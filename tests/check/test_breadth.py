"""The breadth of a cam between the two sides of a yoke."""

from __future__ import annotations

import math
from decimal import Decimal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.cam.cam import Breadth
from camgeo.check.machine import check_breadth
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.units import TURN
from tests.laws import LAWS
from tests.reference import shift
from tests.strategies import BENT, attack, plans, signs

HEIGHT = 40.0

ROUNDING = 1e-14 * 2.0 * HEIGHT
"""A sum of four lengths of the breadth's size at most."""


@st.composite
def even_plans(draw: st.DrawFn) -> MotionPlan:
    """Plans whose second half undoes the first: a rest and a move, twice, by the same law."""
    law = shift(LAWS[draw(st.sampled_from(BENT))], draw(st.floats(0.2, 0.8)))
    rest = Decimal(draw(st.integers(0, 120)))
    to = draw(st.floats(1.0, 20.0))
    half = [Dwell(rest)] if rest else []
    return MotionPlan((*half, Move(180 - rest, to, law), *half, Move(180 - rest, 0.0, law)))


@attack
@given(plan=even_plans(), direction=signs(), angle=st.floats(0.0, TURN))
def test_a_half_turn_that_undoes_the_other_keeps_the_breadth(
    plan: MotionPlan, direction: int, angle: float
) -> None:
    cam = Breadth(plan, HEIGHT, direction)
    stroke = max(abs(segment.to) for segment in plan.segments if isinstance(segment, Move))
    breadth = 2.0 * HEIGHT + direction * stroke
    assert cam.width(np.array([angle])) == pytest.approx(breadth, abs=ROUNDING)
    finding = check_breadth(cam, breadth, 1e-9)
    assert finding.severity == "ok"
    assert finding.value == pytest.approx(0.0, abs=ROUNDING)


@attack
@given(plan=plans(BENT, 20.0), direction=signs())
def test_the_error_is_the_largest_of_the_turn_and_is_reached(
    plan: MotionPlan, direction: int
) -> None:
    cam = Breadth(plan, HEIGHT, direction)
    breadth = 2.0 * HEIGHT + 7.0 * direction
    phi = np.linspace(0.0, TURN, 721)
    # From the lift itself: the two faces' distances from the axis at the same cam angle.
    sides = [HEIGHT + direction * plan.jet(angles)[0] for angles in (phi, phi + math.pi)]
    error = np.abs(sides[0] + sides[1] - breadth)
    finding = check_breadth(cam, breadth, 0.02)
    assert finding.value is not None
    assert finding.cam_angle is not None
    assert finding.value >= float(np.max(error)) - ROUNDING
    there = np.array([finding.cam_angle])
    at = [abs(float(cam.width(there, side)[0]) - breadth) for side in ("right", "left")]
    assert finding.value == pytest.approx(max(at), abs=1e-9)
    assert (finding.severity == "broken") == (finding.value > 0.02)


@attack
@given(plan=plans(BENT, 20.0), other=st.floats(-1.0, 1.0))
def test_no_breadth_is_better_than_the_best(plan: MotionPlan, other: float) -> None:
    cam = Breadth(plan, HEIGHT, 1)
    best = check_breadth(cam, cam.best, 0.02).value
    value = check_breadth(cam, cam.best + other, 0.02).value
    assert best is not None
    assert value == pytest.approx(best + abs(other), abs=ROUNDING)
