"""Findings on the motion: laws, shocks, jerks, overshoot, tables, points, and physical extremes."""

from __future__ import annotations

import math
from decimal import Decimal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.check.finding import Finding
from camgeo.check.judge import check_motion, check_speed
from camgeo.kinematics.laws import make_law
from camgeo.kinematics.laws.law import characteristic
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.kinematics.planning.planner import plan_motion
from camgeo.kinematics.planning.requests import PointsRequest, Request, TableRequest
from camgeo.kinematics.time_course import ConstantSpeed
from camgeo.numeric.arrays import FloatArray
from tests.findings import known
from tests.motion.planning.wishes import move
from tests.strategies import SMOOTH, attack, plans

STROKE, SPAN = 20.0, math.radians(100.0)


def there_and_back(law: str) -> MotionPlan:
    return plan_motion(
        [Dwell(Decimal(60)), move(100, STROKE, law), Dwell(Decimal(100)), move(100, 0.0, law)]
    )


def named(plan: MotionPlan, name: str) -> list[Finding]:
    return [finding for finding in check_motion(plan, "mm") if finding.name == name]


@attack
@given(plan=plans(SMOOTH))
def test_smooth_plans_have_findings_on_joints_alone(plan: MotionPlan) -> None:
    laws, order = check_motion(plan, "mm")
    assert (laws.name, laws.severity) == ("laws", "ok")
    assert (order.name, order.severity) == ("joints", "ok")
    assert known(order.value) >= 2.0


def test_laws_are_listed_with_what_was_computed_for_them() -> None:
    plan = plan_motion([Dwell(Decimal(60)), move(120, 10.0, "auto"), move(180, 0.0, "auto")])
    (found,) = named(plan, "laws")
    first, second = found.sentence.split("; ")
    assert first.startswith("60 to 180 deg ")
    assert second.startswith("180 to 360 deg ")
    for reported, segment in zip((first, second), plan.segments[1:], strict=True):
        assert isinstance(segment, Move)
        assert f"{segment.law.name} {segment.law.task}" in reported
        for key, value in segment.law.parameters.items():
            assert f"{key} {value:.6g}" in reported
    assert named(plan_motion([Dwell(Decimal(360))]), "laws")[0].sentence == "the follower rests"


def test_a_straight_line_has_a_shock_at_each_end_of_the_size_of_its_speed() -> None:
    shocks = named(there_and_back("straight-line"), "shock")
    speed = STROKE / SPAN
    assert [round(math.degrees(found.cam_angle or 0.0)) for found in shocks] == [0, 60, 160, 260]
    assert [found.value for found in shocks] == pytest.approx([speed, speed, -speed, -speed])
    assert {found.severity for found in shocks} == {"broken"}
    assert shocks[1].unit == "mm/rad"
    assert "11.4592 mm/rad at cam angle 60 deg" in shocks[1].sentence


@pytest.mark.parametrize(
    ("law", "jumps"),
    [
        # f'' of the laws: 4 and -4 with a jump of -8 between; pi^2/2 and -pi^2/2.
        ("quadratic-parabola", {0: 4.0, 60: 4.0, 110: -8.0, 160: 4.0, 260: -4.0, 310: 8.0}),
        (
            "simple-sine",
            {k: math.pi**2 / 2 * s for k, s in ((0, -1), (60, 1), (160, 1), (260, -1))},
        ),
    ],
)
def test_jerks_inside_a_law_are_reported_one_by_one(law: str, jumps: dict[int, float]) -> None:
    found = named(there_and_back(law), "jerk")
    size = STROKE / SPAN**2
    reported = {round(math.degrees(each.cam_angle or 0.0)): each.value for each in found}
    expected = {angle: jump * size for angle, jump in jumps.items()}
    if law == "quadratic-parabola":
        expected[0] *= -1.0  # the end of the return: from 4 of the falling stroke to rest
    assert reported == pytest.approx(expected, rel=1e-12)
    assert {each.severity for each in found} == {"warning"}
    assert {each.unit for each in found} == {"mm/rad^2"}


def test_angles_are_stated_in_degrees() -> None:
    requests: list[Request] = [
        Dwell(Decimal(90)),
        move(90, math.radians(10.0), "straight-line"),
        Dwell(Decimal(90)),
        move(90, 0.0, "polynomial-345"),
    ]
    plan = plan_motion(requests)
    shocks = [found for found in check_motion(plan, "rad") if found.name == "shock"]
    assert [found.value for found in shocks] == pytest.approx([20.0 / math.pi, -20.0 / math.pi])
    assert {found.unit for found in shocks} == {"deg/rad"}


@attack
@given(
    name=st.sampled_from(["polynomial-5", "polynomial-7", "modified-sine"]),
    v0=st.floats(-6.0, 6.0),
    v1=st.floats(-6.0, 6.0),
)
def test_overshoot_is_found_exactly(name: str, v0: float, v1: float) -> None:
    """Against the largest and smallest of 20,001 values, which lie at most h^2/8 |f''| inside."""
    law = make_law(name, "G-G", v0=v0, v1=v1)
    found = characteristic(law)
    z = np.linspace(0.0, 1.0, 20_001)
    f, _, f2, _ = law(z)
    slack = float(np.max(np.abs(f2))) * (z[1] ** 2) / 8.0 * 1.01 + 1e-15
    assert float(np.max(f)) <= found.lift.value + 4e-16
    assert found.lift.value <= float(np.max(f)) + slack
    assert found.least_lift.value >= float(np.min(f)) - slack
    assert found.least_lift.value <= float(np.min(f)) + 4e-16


def test_overshoot_is_reported_with_its_place_and_size() -> None:
    plan = plan_motion(
        [
            Dwell(Decimal(60)),
            move(60, 10.0, "polynomial-5", velocity=40.0, acceleration=0.0),
            move(60, 20.0, "polynomial-5", velocity=0.0, acceleration=100.0),
            move(180, 0.0, "polynomial-5"),
        ]
    )
    found = named(plan, "overshoot")
    phi = np.radians(np.linspace(0.0, 360.0, 36_001))
    lift = plan.jet(phi)[0]
    beyond = float(np.max(lift)) - 20.0
    assert beyond > 0.01, "the example overshoots"
    only = max(found, key=lambda each: each.value or 0.0)  # of three; the return has the largest
    assert only.value == pytest.approx(beyond, rel=1e-5)
    assert only.cam_angle == pytest.approx(float(phi[np.argmax(lift)]), abs=np.radians(0.02))
    assert only.severity == "warning"


def test_a_smoothed_table_reports_its_deviation() -> None:
    shares = np.linspace(0.0, 1.0, 181)
    lifts = 5.0 * (1.0 - np.cos(2.0 * math.pi * shares)) + 1e-3 * np.sin(90.0 * shares**2)
    lifts[-1] = lifts[0]
    plan = plan_motion([TableRequest(Decimal(360), shares, lifts, smoothing=2e-3)])
    (found,) = named(plan, "lift-table")
    rows = plan.jet(2.0 * math.pi * shares[:-1])[0]
    worst = float(np.max(np.abs(rows - lifts[:-1])))
    assert found.value == pytest.approx(worst, abs=1e-12)
    assert worst <= 2e-3
    assert found.cam_angle is not None
    at = plan.jet(np.array([found.cam_angle]))[0, 0]
    row = round(found.cam_angle / math.radians(2.0))
    assert abs(at - lifts[row]) == pytest.approx(worst, abs=1e-12)


@pytest.mark.parametrize("first", [0.0, 2.0, 5.0])
def test_a_table_reports_by_how_much_its_rows_are_shifted(first: float) -> None:
    """A table over the whole turn starts at 0, where the base radius holds, any other where the
    segment before it ends. Rows may count from there, or be positions."""
    shares = np.linspace(0.0, 1.0, 41)
    lifts = first + 5.0 * shares**3 * (10.0 - 15.0 * shares + 6.0 * shares**2)
    (alone,) = named(plan_motion([table_over(360, shares, lifts - 5.0 * shares)]), "lift-table")
    after: list[Request] = [Dwell(Decimal(60)), move(100, 5.0, "polynomial-5")]
    plan = plan_motion([*after, table_over(100, shares, lifts), move(100, 0.0, "polynomial-5")])
    (behind,) = named(plan, "lift-table")
    for found, start in ((alone, 0.0), (behind, 5.0)):
        assert found.value == pytest.approx(0.0, abs=1e-12)
        assert found.severity == ("ok" if first in (0.0, start) else "warning")
        shift = abs(start - first)
        assert ("each row" in found.sentence) == (shift > 0.0)
        assert shift == 0.0 or found.sentence.startswith(f"with {shift:g} mm ")
    assert plan.jet(np.radians([160.0, 260.0]))[0] == pytest.approx([5.0, 10.0], abs=1e-12)


def table_over(
    span: int, shares: FloatArray, lifts: FloatArray, smoothing: float | None = None
) -> TableRequest:
    """A table of these rows."""
    return TableRequest(Decimal(span), shares, lifts, smoothing)


@pytest.mark.parametrize(("step", "swings"), [(1, False), (10, False), (18, True), (30, True)])
def test_a_table_of_few_rows_swings_next_to_its_dwells(step: int, swings: bool) -> None:
    """Dwells of 90 degrees at 0 and 18 mm, and the moves between them, at every 1 to 30 degrees."""
    angles = np.arange(0.0, 361.0, step)
    way = np.clip(np.abs(angles - 225.0) / 90.0 - 0.5, 0.0, 1.0)
    plan = plan_motion(
        [table_over(360, angles / 360.0, 18.0 * (1.0 - make_law("modified-trapezoid")(way)[0]))]
    )
    found = named(plan, "overshoot")
    assert bool(found) == swings
    phi = np.linspace(0.0, 2.0 * math.pi, 36_001)
    lift = plan.jet(phi)[0]
    beyond = max(-float(np.min(lift)), float(np.max(lift)) - 18.0)
    for each in found:
        assert each.severity == "warning"
        assert each.limit == pytest.approx(1.8e-3, rel=0.03)
        assert each.value == pytest.approx(beyond, rel=1e-5)
        there = float(plan.jet(np.array([each.cam_angle]))[0, 0])
        assert max(-there, there - 18.0) == pytest.approx(beyond, rel=1e-5)
    assert swings or beyond <= 1.8e-3


def test_what_a_smoothed_table_may_deviate_is_no_swing() -> None:
    shares = np.linspace(0.0, 1.0, 181)
    noise = 8e-3 * np.sin(1e4 * np.arange(181.0) ** 2)
    lifts = np.where(shares < 0.5, 0.0, 5.0 * (1.0 - np.cos(4.0 * math.pi * shares))) + noise
    lifts[-1] = lifts[0] = 0.0
    rough, smooth = (
        plan_motion([table_over(360, shares, lifts, smoothing)]) for smoothing in (None, 16e-3)
    )
    assert named(rough, "overshoot")
    assert not named(smooth, "overshoot")


def test_a_motion_through_points_reports_how_far_it_swings() -> None:
    """Several points at one height ask for a dwell, which a spline cannot have."""
    points = PointsRequest(
        Decimal(300), 0.0, np.array([0.1, 0.2, 0.3, 0.7]), np.array([0.0, 0.0, 9.0, 9.0])
    )
    plan = plan_motion([Dwell(Decimal(60)), points])
    (found,) = named(plan, "overshoot")
    lift = plan.jet(np.radians(np.linspace(60.0, 360.0, 30_001)))[0]
    assert found.value == pytest.approx(max(np.max(lift) - 9.0, -np.min(lift)), rel=1e-6)
    assert "points at 150 and 270 deg" in found.sentence


def test_without_a_speed_the_derivatives_are_over_the_cam_angle() -> None:
    found = {each.name: each for each in check_speed(there_and_back("polynomial-345"), None, "mm")}
    assert found.keys() == {"largest-velocity", "largest-acceleration", "largest-jerk"}
    velocity = found["largest-velocity"]
    assert abs(velocity.value or 0.0) == pytest.approx(15.0 / 8.0 * STROKE / SPAN, rel=1e-13)
    assert velocity.unit == "mm/rad"
    assert found["largest-jerk"].unit == "mm/rad^3"


def test_what_is_infinite_has_no_value() -> None:
    course = ConstantSpeed(5.0)
    parabola = {
        each.name: each for each in check_speed(there_and_back("quadratic-parabola"), course, "mm")
    }
    assert parabola["largest-jerk"].value is None
    assert "infinite at a shock or a jerk" in parabola["largest-jerk"].sentence
    size = 4.0 * STROKE * 25.0 / SPAN**2
    assert abs(parabola["largest-acceleration"].value or 0.0) == pytest.approx(size, rel=1e-13)
    line = {each.name: each for each in check_speed(there_and_back("straight-line"), course, "mm")}
    assert line["largest-velocity"].value is not None
    for name in ("acceleration", "jerk", "inertia-torque"):
        assert line[f"largest-{name}"].value is None
