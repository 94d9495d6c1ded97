from __future__ import annotations

from decimal import Decimal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.kinematics.plan import MotionPlan
from camgeo.kinematics.planning.planner import plan_motion
from camgeo.kinematics.planning.requests import MoveRequest, TableRequest
from camgeo.kinematics.time_course import (
    ConstantSpeed,
    SpeedCurve,
    in_time,
    inertia_torque,
    plan_extremes,
    time_extremes,
)
from tests.strategies import BENT, attack, plans

QUANTITIES = ("velocity", "acceleration", "jerk", "torque")


@attack
@given(plan=plans(BENT), speed=st.floats(0.1, 100.0))
def test_nothing_is_larger_and_the_search_finds_the_same(plan: MotionPlan, speed: float) -> None:
    course = ConstantSpeed(speed)
    found = plan_extremes(plan, course)
    phi = np.linspace(0.0, 2.0 * np.pi, 20_001)
    timed = in_time(plan.jet(phi), course, phi)
    rows = (*timed[1:], inertia_torque(timed, course.rates(phi)[0]))
    searched = time_extremes(plan, course)
    for name, values in zip(QUANTITIES, rows, strict=True):
        exact = getattr(found, name)
        size = exact.magnitude
        assert np.max(values) <= exact.highest.value + 1e-12 * size
        assert np.min(values) >= exact.lowest.value - 1e-12 * size
        # The search takes one side of a border a ten-millionth of a piece inside.
        other = getattr(searched, name)
        assert exact.highest.value == pytest.approx(other.highest.value, abs=1e-6 * size)
        assert exact.lowest.value == pytest.approx(other.lowest.value, abs=1e-6 * size)


def test_the_place_has_the_value() -> None:
    plan = plan_motion(
        [MoveRequest(Decimal(160), 12.0, "auto"), MoveRequest(Decimal(200), 0.0, "auto")]
    )
    course = ConstantSpeed(5.0)
    found = plan_extremes(plan, course)
    for end in (found.velocity.highest, found.velocity.lowest):
        at = in_time(plan.jet(np.array([end.place])), course, np.array([end.place]))
        assert at[1, 0] == pytest.approx(end.value, rel=1e-14)


def test_motion_by_data_is_left_to_the_search() -> None:
    shares = np.linspace(0.0, 1.0, 20)
    lifts = 1.0 - np.cos(2.0 * np.pi * shares)
    lifts[-1] = 0.0
    plan = plan_motion([TableRequest(Decimal(360), shares, lifts)])
    course = ConstantSpeed(1.0)
    assert plan_extremes(plan, course) == time_extremes(plan, course)


def test_a_disc_that_turns_unevenly_is_left_to_the_search() -> None:
    plan = plan_motion(
        [MoveRequest(Decimal(160), 12.0, "auto"), MoveRequest(Decimal(200), 0.0, "auto")]
    )
    angles = np.linspace(0.0, 2.0 * np.pi, 13)
    course = SpeedCurve(angles + 0.1 * np.sin(angles), angles)
    assert plan_extremes(plan, course) == time_extremes(plan, course)
