"""What `joints` finds: classes, order of continuity, sizes of the jumps."""

from __future__ import annotations

import math
from decimal import Decimal

import pytest

from camgeo.motion.joints import joints
from camgeo.motion.laws import make_law
from camgeo.motion.plan import Dwell, MotionPlan, Move
from tests.motion.planning.wishes import move, planned, rest


def orders(plan: MotionPlan) -> list[int]:
    """The order of continuity at each joint."""
    return [joint.order for joint in joints(plan)]


@pytest.mark.parametrize(
    ("law", "order"),
    [
        ("straight-line", 0),
        ("quadratic-parabola", 1),
        ("simple-sine", 1),
        ("polynomial-345", 2),
        ("inclined-sine", 2),
        ("modified-trapezoid", 2),
        ("modified-sine", 2),
        ("polynomial-4567", 3),
    ],
)
def test_order_between_a_rest_and_each_law(law: str, order: int) -> None:
    plan = MotionPlan(
        (
            Dwell(Decimal(60)),
            Move(Decimal(90), 20.0, make_law(law)),
            Dwell(Decimal(60)),
            Move(Decimal(150), 0.0, make_law(law)),
        )
    )
    assert orders(plan) == [order] * 4


def test_the_jumps_are_those_of_the_law() -> None:
    """s^(k) = S/Phi^k f^(k): -4 S/Phi^2 for the parabola, S/Phi for the straight line."""
    span = math.radians(90.0)
    plan = planned(rest(60), move(90, 20.0, "quadratic-parabola"), rest(60), move(150, 0.0))
    joint = joints(plan)[2]
    assert float(joint.left[2]) == pytest.approx(-4.0 * 20.0 / span**2, rel=1e-14)
    assert (joint.before, joint.after) == ("U", "R")
    plan = planned(rest(60), move(90, 20.0, "straight-line"), rest(60), move(150, 0.0))
    joint = joints(plan)[1]
    assert float(joint.right[1] - joint.left[1]) == pytest.approx(20.0 / span, rel=1e-14)
    assert (joint.before, joint.after) == ("R", "G")


@pytest.mark.parametrize("size", [1e-9, 1e-3, 1.0, 1e9])
def test_order_and_class_do_not_depend_on_the_unit(size: float) -> None:
    plan = planned(
        rest(40),
        move(60, 5.0 * size),
        move(40, 15.0 * size, "straight-line"),
        move(60, 25.0 * size),
        move(160, 0.0),
    )
    found = joints(plan)
    assert [joint.before + joint.after for joint in found] == ["RR", "RR", "GG", "GG", "UU"]
    assert all(joint.order >= 2 for joint in found)


@pytest.mark.parametrize("span", ["0.000001", "0.00001", "0.0001", "0.01"])
@pytest.mark.parametrize("at", [0, 1, 7, 359])
def test_the_rounding_of_a_short_span_is_no_jump(span: str, at: int) -> None:
    """Its length is the difference of two rounded cam angles, off by 5e-8 of the shortest."""
    short = Decimal(span)
    speed = 10.0 / math.radians(float(short))
    plan = planned(
        move(359 - at + 1 - short, -10.0, "polynomial-5", velocity=speed, acceleration=0.0),
        move(short, 0.0, "polynomial-5", velocity=0.3 * speed, acceleration=0.0),
        *([move(at, 0.0, "polynomial-5")] if at else []),
    )
    assert min(orders(plan)) >= 2


@pytest.mark.parametrize("part", [1e-6, 1e-3])
def test_a_small_jump_is_a_jump(part: float) -> None:
    """A velocity a millionth off is reported as order 0; one 1e-12 off, as by rounding, is not."""
    span = Decimal(90)
    slope = 1.0 + part

    def plan(velocity: float) -> MotionPlan:
        quintic = make_law("polynomial-5", "R-G", v1=velocity)
        back = make_law("polynomial-5", "G-R", v0=1.0)
        return MotionPlan(
            (
                Move(span, 10.0, quintic),
                Move(span, 20.0, back),
                Dwell(span),
                Move(span, 0.0, make_law("polynomial-345")),
            )
        )

    assert orders(plan(slope))[1] == 0
    assert orders(plan(1.0 + 1e-12))[1] >= 2


def test_a_move_of_no_length_has_no_joint_of_its_own() -> None:
    plan = MotionPlan(
        (
            Move(Decimal(120), 20.0, make_law("polynomial-345")),
            Dwell(Decimal(0)),
            Move(Decimal(240), 0.0, make_law("polynomial-345")),
            Dwell(Decimal(0)),
        )
    )
    assert [joint.cam_angle for joint in joints(plan)] == [0.0, math.radians(120.0)]


def test_a_turn_of_rest_has_one_joint_without_a_jump() -> None:
    (joint,) = joints(planned(rest(360)))
    assert (joint.cam_angle, joint.order, joint.before, joint.after) == (0.0, 3, "R", "R")


def test_a_gentle_side_is_not_judged_by_a_violent_one() -> None:
    """10 mm in a thousandth of a degree, and half a mm per rad^2 next to it."""
    plan = planned(
        rest(1),
        move("0.001", 10.0, "polynomial-5", velocity=0.0, acceleration=-0.5),
        move("178.999", 0.0, "polynomial-5"),
        rest(180),
    )
    turn = joints(plan)[2]
    assert turn.after == "U"
    assert turn.right[2] == pytest.approx(-0.5, rel=1e-9)
