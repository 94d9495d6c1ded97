"""What `joints` finds: classes, order of continuity, sizes of the jumps."""

from __future__ import annotations

import math
from decimal import Decimal

import numpy as np
import pytest
from hypothesis import assume, given

from camgeo.kinematics.laws import make_law
from camgeo.kinematics.plan import Dwell, MotionPlan, Move, joints
from tests.laws import LAWS
from tests.motion.planning.wishes import move, planned, rest
from tests.strategies import attack, plans


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
    speed = 10.0 * size / math.radians(40.0)
    assert [float(joint.left[1]) for joint in found[2:4]] == pytest.approx(
        [speed, speed], rel=1e-14
    )


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


@attack
@given(plan=plans(tuple(LAWS)))
def test_each_joint_is_where_two_segments_meet_with_what_both_have_there(plan: MotionPlan) -> None:
    """Places and positions summed up from the segments; both sides from their laws alone."""
    starts, position, found = [Decimal(0)], 0.0, []
    for segment in plan.segments:
        if segment.span:
            law = segment.law if isinstance(segment, Move) else None
            to = segment.to if isinstance(segment, Move) else position
            found.append((law, math.radians(float(segment.span)), to - position, position))
            starts.append(starts[-1] + segment.span)
            position = to
    assume(all(not stroke or abs(stroke) > 1e-3 for _, _, stroke, _ in found))
    meeting = joints(plan)
    assert len(meeting) == len(found)
    for number, joint in enumerate(meeting):
        assert joint.cam_angle == pytest.approx(math.radians(float(starts[number])), abs=1e-14)
        assert joint.position == pytest.approx(found[number][3], abs=1e-12)
        sides = []
        for (law, span, stroke, start), z in ((found[number - 1], 1.0), (found[number], 0.0)):
            if law is None or not stroke:
                sides.append(([start, 0.0, 0.0, 0.0], "R"))
                continue
            values = law(np.array([z]))[:, 0]
            jet = [stroke * each / span**order for order, each in enumerate(values)]
            jet[0] += start
            v, a = (abs(each) > 1e-9 for each in values[1:3])
            sides.append((jet, {(0, 0): "R", (1, 0): "G", (0, 1): "U", (1, 1): "B"}[v, a]))
        assert (joint.before, joint.after) == (sides[0][1], sides[1][1])
        for side, (jet, _) in zip((joint.left, joint.right), sides, strict=True):
            for order in range(4):
                size = max(abs(each[0][order]) for each in sides) + 1.0
                assert side[order] == pytest.approx(jet[order], abs=2e-9 * size)
        jumps = [
            abs(one - other) > 1e-6 * max(abs(one), abs(other), 1e-6)
            for one, other in zip(sides[0][0], sides[1][0], strict=True)
        ]
        assert joint.order == (jumps.index(True) - 1 if any(jumps) else 3)
