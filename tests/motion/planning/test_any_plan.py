"""Plans of 1 to 50 segments by every law, whatever is requested: what always holds."""

from __future__ import annotations

import math
import re

import numpy as np
from hypothesis import assume, given, settings

from camgeo.errors import GeometryError
from camgeo.kinematics.laws import FAMILIES, make_law
from camgeo.kinematics.laws.law import acceleration_jumps, characteristic
from camgeo.kinematics.plan import Dwell, Joint, MotionPlan, Move, joints
from camgeo.kinematics.planning.planner import plan_motion
from camgeo.kinematics.planning.requests import AUTO, MoveRequest, Request
from tests.long_form import examples
from tests.motion.planning.wishes import POLYNOMIALS, Wishes
from tests.speed import spending
from tests.strategies import attack

SECONDS = 12.0
"""Of computing for a plan, see `tests.speed`. The slowest of 20,000 random ones took 3 at most."""

WORDS = r"allowed|must|leave|for which there are|polynomial-5|its parameters|one of them"
"""One of these is in every refusal, to say what would work."""

ANY = Wishes(
    counts=(1, 2, 3, 4, 5, 6, 8, 12, 25, 50),
    sizes=(1e-9, 1e-3, 1.0, 10.0, 10.0, 10.0, 1e3, 1e6),
    stated=0.03,
    data=0.08,
)


def accepted(wish: list[Request]) -> MotionPlan:
    """The plan for a request; a refusal names a key and what would work."""
    plan, refusal = None, None
    with spending() as spent:
        try:
            plan = plan_motion(wish)
        except GeometryError as error:
            refusal = error
    assert spent.seconds < SECONDS
    if refusal is not None:
        assert refusal.key.startswith("motion[")
        assert re.search(WORDS, refusal.message)
    assume(plan is not None)
    assert plan is not None
    return plan


def beside(wish: list[Request], joint: int) -> tuple[Request, Request]:
    """The requests that meet at a joint."""
    moving = [request for request in wish if request.span > 0]
    return moving[joint - 1], moving[joint]


def least_order(before: Request, after: Request) -> int:
    """The derivative up to which two requests meet, whatever is left open.

    A straight line meets a rest with a shock. The acceleration may jump next to a law in which it
    does from rest to rest, and between two laws that both decide their turns, because all is stated
    or because they have no choice.
    """
    laws = [request.law for request in (before, after) if isinstance(request, MoveRequest)]
    if "straight-line" in laws:
        return 0
    if any(law in FAMILIES and jerks(law) for law in laws) or (decides(before) and decides(after)):
        return 1
    return 2


def jerks(law: str) -> bool:
    """Whether a law from rest to rest has accelerations at its ends, or jumps of it inside."""
    if "R-R" not in FAMILIES[law].tasks:
        return False
    own = make_law(law, "R-R")
    return own.start.acceleration != 0.0 or bool(acceleration_jumps(own))


def decides(request: Request) -> bool:
    """Whether the turns of a move follow from its law, so that not both can be chosen."""
    if not isinstance(request, MoveRequest) or request.law in (AUTO, *POLYNOMIALS):
        return False
    return request.law in ("double-harmonic", "simple-sine") or bool(request.shaped_by)


@given(ANY.drawn())
@settings(attack, max_examples=examples(16, long=2000))
def test_any_plan(wish: list[Request]) -> None:
    """One test of all invariants, because planning takes longer than examining the plan."""
    plan = accepted(wish)
    for number, joint in enumerate(joints(plan)):
        before, after = beside(wish, number)
        assert joint.order >= least_order(before, after)
        for order, name in enumerate(("velocity", "acceleration", "jerk"), start=1):
            stated = getattr(before, name, None)
            if stated is not None:
                assert_met(plan, joint, order, stated, math.radians(float(before.span)))
    assert_between_ends(plan)


def assert_met(plan: MotionPlan, joint: Joint, order: int, stated: float, length: float) -> None:
    """What is stated is met within rounding.

    That is the rounding of some ten operations on values as large as those of
    the segment, and of its length, the difference of two rounded cam angles.
    """
    end = joint.cam_angle or 2.0 * math.pi
    inside = plan.jet(end - length * np.linspace(0.05, 0.95, 10))[order]
    found = float(plan.jet(np.array([end]), "left")[order, 0])
    size = max(float(np.max(np.abs(inside))), abs(stated))
    assert abs(found - stated) <= (1e-12 + order * 2.0 * math.ulp(end) / length) * size


def assert_between_ends(plan: MotionPlan) -> None:
    """A law whose velocity does not change its sign stays between its ends."""
    position = 0.0
    for segment, start, end in plan.stretches:
        if isinstance(segment, Move) and segment.scale is None:
            low, high = sorted((position, segment.to))
            if characteristic(segment.law).least_velocity.value >= 0.0:
                lift = plan.jet(np.linspace(start, end, 43)[1:-1])[0]
                rounding = 1e-15 * (abs(low) + abs(high))
                assert np.min(lift) >= low - rounding
                assert np.max(lift) <= high + rounding
        if not isinstance(segment, Dwell):
            position = segment.to
