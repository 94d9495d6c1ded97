"""What holds for every plan, whatever is requested: drawn at random."""

from __future__ import annotations

import copy
import math
import pickle
import re
from collections.abc import Callable, Sequence
from dataclasses import fields, replace
from decimal import Decimal
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.kinematics.laws import FAMILIES, make_law
from camgeo.kinematics.laws.law import acceleration_jumps, characteristic
from camgeo.kinematics.plan import Dwell, Joint, MotionPlan, Move, SplineMove, joints
from camgeo.kinematics.planning.planner import plan_motion
from camgeo.kinematics.planning.requests import (
    AUTO,
    MoveRequest,
    PointsRequest,
    PositionUnit,
    Request,
    TableRequest,
)
from camgeo.numeric.arrays import FloatArray
from tests.laws import LAWS
from tests.long_form import examples
from tests.motion.planning.wishes import POLYNOMIALS, Wishes, move, planned, rest, through
from tests.speed import spending
from tests.strategies import attack

SHARES = np.array([0.003, 0.11, 0.23, 0.47, 0.53, 0.77, 0.89, 0.997])
"""Places inside a segment, symmetric."""

SAME = 1e-6
"""Of the size of each derivative. A plan asked for in another way differs by rounding, which the
banded solve multiplies: over spans from 0.001 to 359 degrees 1e-9 was the most."""

UNIQUE = ("auto", "polynomial-5", "polynomial-7", "polynomial", "modified-sine", "straight-line")
"""Laws whose joints are settled without a choice between two that are as good."""

SECONDS = 12.0
"""Of computing for a plan, see `tests.speed`. The slowest of 20,000 random ones took 3 at most."""

WORDS = r"allowed|must|leave|for which there are|polynomial-5|its parameters|one of them"
"""One of these is in every refusal, to say what would work."""

many = settings(attack, max_examples=examples(9, long=80))


def plan_of(requests: Sequence[Request]) -> MotionPlan | None:
    """The plan; None if it is refused, with the key of a segment and what would work."""
    plan, refusal = None, None
    with spending() as spent:
        try:
            plan = planned(*requests)
        except GeometryError as error:
            refusal = error
    assert spent.seconds < SECONDS
    if refusal is not None:
        assert refusal.key.startswith("motion[")
        assert re.search(WORDS, refusal.message)
    return plan


def accepted(requests: Sequence[Request]) -> MotionPlan:
    """The plan, if there is one."""
    plan = plan_of(requests)
    assume(plan is not None)
    assert plan is not None
    return plan


def moving(requests: Sequence[Request]) -> list[Request]:
    """The requests that have a length."""
    return [request for request in requests if request.span > 0]


def positions(requests: Sequence[Request]) -> list[float]:
    """Position at the start of each request, and at the end."""
    found = [0.0]
    for request in requests:
        match request:
            case Dwell():
                found.append(found[-1])
            case TableRequest():
                found.append(found[-1] + request.rise)
            case _:
                found.append(request.to)
    return found


def samples(plan: MotionPlan) -> list[FloatArray]:
    """(4, 8) jet in each segment that has a length."""
    return [plan.jet(start + (end - start) * SHARES) for _, start, end in plan.stretches]


def assert_same(
    first: list[FloatArray], second: list[FloatArray], requests: Sequence[Request]
) -> None:
    """Equal except for rounding; that of a segment that hardly moves is its neighbours'."""
    way = max(float(np.ptp(jet[0])) for jet in first)
    for one, other, request in zip(first, second, moving(requests), strict=True):
        length = math.radians(float(request.span))
        for order in range(4):
            size = max(float(np.max(np.abs(one[order]))), 0.01 * way / length**order)
            assert np.max(np.abs(one[order] - other[order])) <= SAME * size


# What holds at the joints ----------------------------------------------------------------------


@given(Wishes(("polynomial-5",), data=0.0, rests=False, stated=0.0).drawn())
@many
def test_free_joints_have_four_continuous_derivatives(requests: list[Request]) -> None:
    """s''' as `joints` finds it, s'''' from the quintics: where a turn that is not requested is not
    pinned to velocity 0."""
    assume(min(request.span for request in requests) >= 1)
    plan = accepted(requests)
    found = joints(plan)
    for joint in found:
        assert joint.order == 3
    fourth = [fourth_at_ends(plan, number) for number in range(len(found))]
    size = max(abs(value) for pair in fourth for value in pair) + 1e-300
    for number, joint in enumerate(found):
        if joint.before == "U":
            continue  # a turn stands still, which is asked of it
        # Rounding of s' over span^3, with spans from 1 degree on, relative to the largest.
        assert fourth[number - 1][1] == pytest.approx(fourth[number][0], abs=1e-6 * size)


def fourth_at_ends(plan: MotionPlan, number: int) -> tuple[float, float]:
    """s'''' at both ends of a quintic, from three values of s''', which is a parabola."""
    segment = plan.segments[number]
    assert isinstance(segment, Move)
    length = math.radians(float(segment.span))
    start = math.radians(float(sum((each.span for each in plan.segments[:number]), Decimal(0))))
    third = plan.jet(start + length * np.array([0.2, 0.5, 0.8]))[3]
    a, b, c = (float(value) for value in third)
    middle, bend = (c - a) / 0.6, (a - 2.0 * b + c) / 0.09
    return (middle - 0.5 * bend) / length, (middle + 0.5 * bend) / length


@given(Wishes().drawn())
@many
def test_the_plan_is_its_laws_scaled(requests: list[Request]) -> None:
    plan = accepted(requests)
    position = 0.0
    for (segment, _, _), jet in zip(plan.stretches, samples(plan), strict=True):
        length = math.radians(float(segment.span))
        if isinstance(segment, Move):
            scale = segment.to - position if segment.scale is None else segment.scale
            values = np.array(segment.law(SHARES)) * scale
        elif isinstance(segment, SplineMove):
            values = np.array(segment.spline.values(SHARES))
        else:
            values = np.zeros((4, len(SHARES)))
        values[0] += position
        values /= length ** np.arange(4.0)[:, np.newaxis]
        position = getattr(segment, "to", position)
        for order in range(4):
            size = np.max(np.abs(values[order])) + abs(position) * (order == 0)
            if order == 3 and isinstance(segment, Move) and segment.law.borders:
                continue  # it jumps inside, and a place near a jump may lie on either side
            # z as the plan has it differs from the share by rounding of the angle, 1e-15 rad.
            slack = 1e-11 + 1e-13 / length
            assert np.max(np.abs(jet[order] - values[order])) <= slack * size + 1e-300


# Other ways to ask for the same ----------------------------------------------------------------


def changed(request: Request, positions_by: Callable[[float], float], factor: float) -> Request:
    """A request with other positions; velocities and accelerations times `factor`."""

    def times(value: float | None) -> float | None:
        return None if value is None else factor * value

    match request:
        case MoveRequest():
            return replace(
                request,
                to=positions_by(request.to),
                velocity=times(request.velocity),
                acceleration=times(request.acceleration),
                jerk=times(request.jerk),
            )
        case PointsRequest():
            return replace(
                request,
                to=positions_by(request.to),
                positions=np.array([positions_by(float(each)) for each in request.positions]),
                boundaries={
                    index: (times(velocity), times(acceleration))
                    for index, (velocity, acceleration) in request.boundaries.items()
                },
                velocity=times(request.velocity),
                acceleration=times(request.acceleration),
            )
        case TableRequest():
            smoothing = request.smoothing
            return replace(
                request,
                lifts=factor * request.lifts,
                smoothing=None if smoothing is None else abs(factor) * smoothing,
            )
    return request


@given(Wishes().drawn(), st.sampled_from([-1.0, 3.0, 1e-7, -1e5]))
@many
def test_a_scaled_or_mirrored_wish_gives_the_scaled_or_mirrored_motion(
    requests: list[Request], factor: float
) -> None:
    plan = plan_of(requests)
    other = plan_of([changed(each, lambda x: factor * x, factor) for each in requests])
    assert (plan is None) == (other is None)
    assume(plan is not None)
    assert plan is not None
    assert other is not None
    assert_same(samples(plan), [jet / factor for jet in samples(other)], requests)


def neighbouring_tables(requests: Sequence[Request]) -> bool:
    """Whether two tables meet, of which the first one decides how."""
    parts = moving(requests)
    return any(
        isinstance(one, TableRequest) and isinstance(other, TableRequest)
        for one, other in zip([parts[-1], *parts], parts, strict=False)
    )


def extreme(plan: MotionPlan) -> bool:
    """Whether a law is so lopsided that rounding decides whether "auto" takes it for smooth."""
    return any(
        isinstance(segment, Move)
        and segment.law.inflection is not None
        and not 1e-3 < segment.law.inflection < 1.0 - 1e-3
        for segment in plan.segments
    )


@given(Wishes(UNIQUE).drawn(), st.integers(0, 20))
@many
def test_where_the_turn_begins_does_not_matter(requests: list[Request], first: int) -> None:
    assume(not neighbouring_tables(requests))
    plan = accepted(requests)
    first %= len(requests)
    start = positions(requests)[first]
    turned = [
        changed(each, lambda x: x - start, 1.0) for each in requests[first:] + requests[:first]
    ]
    assume(positions(turned)[-1] == 0.0)  # rounding of the positions themselves
    other = plan_of(turned)
    assert other is not None
    assume(not extreme(plan) and not extreme(other))
    jets = samples(other)
    ahead = len(moving(requests[:first]))
    jets = jets[len(jets) - ahead :] + jets[: len(jets) - ahead]
    shift = np.array([[start], [0.0], [0.0], [0.0]])
    assert_same(samples(plan), [jet + shift for jet in jets], requests)


def reversed_wish(requests: Sequence[Request]) -> list[Request]:
    """The same motion backwards, if the joints are not stated."""
    found: list[Request] = []
    starts = positions(requests)
    for request, start in zip(reversed(requests), starts[-2::-1], strict=True):
        match request:
            case MoveRequest():
                found.append(replace(request, to=start))
            case PointsRequest():
                found.append(
                    replace(
                        request,
                        to=start,
                        shares=1.0 - request.shares[::-1],
                        positions=request.positions[::-1],
                    )
                )
            case TableRequest():
                found.append(
                    replace(request, shares=1.0 - request.shares[::-1], lifts=request.lifts[::-1])
                )
            case Dwell():
                found.append(request)
    return found


@given(Wishes(UNIQUE, stated=0.0).drawn())
@many
def test_backwards(requests: list[Request]) -> None:
    assume(not neighbouring_tables(requests))
    plan = accepted(requests)
    other = plan_of(reversed_wish(requests))
    assert other is not None
    assume(not extreme(plan) and not extreme(other))
    signs = np.array([[1.0], [-1.0], [1.0], [-1.0]])
    jets = [signs * jet[:, ::-1] for jet in reversed(samples(other))]
    assert_same(samples(plan), jets, requests)


@pytest.mark.parametrize("law", ["auto", *sorted(LAWS), "polynomial-5", "polynomial-7"])
@pytest.mark.parametrize("span", ["0.001", "1", "179.9995", "359", "359.999"])
@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
def test_from_rest_to_rest_over_any_span(law: str, span: str, size: float) -> None:
    left = 360 - Decimal(span)
    plan = planned(move(span, size, law), rest(0), move(left, 0.0, law), rest(0))
    for jet, (segment, _, _) in zip(samples(plan), plan.stretches, strict=True):
        assert isinstance(segment, Move)
        length = math.radians(float(segment.span))
        assert np.all(np.isfinite(jet))
        assert np.max(np.abs(jet[1])) <= 2.5 * size / length  # C_v of all of them is below 2.5
        assert np.min(jet[0]) >= 0.0
        assert np.max(jet[0]) <= size


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
def test_through_points_without_rest_over_unequal_spans(size: float) -> None:
    """A thousandth of a degree next to 359 degrees: right, or refused with a reason."""
    plan = planned(
        move("0.001", 1e-5 * size), through("359.998", 0.0, (0.5, size)), move("0.001", 0.0)
    )
    found = joints(plan)
    assert all(joint.order >= 2 for joint in found)
    with pytest.raises(GeometryError, match="1e\\+06") as caught:
        planned(move("0.0001", size, "polynomial-5"), move("359.9999", 0.0))
    assert caught.value.key == "motion[1].span"


@pytest.mark.parametrize("law", ["modified-sine", "scca"])
@pytest.mark.parametrize("at_end", [False, True])
def test_a_part_of_a_law_is_as_long_as_cam_angles_can_tell(law: str, at_end: bool) -> None:
    """The shorter part of a move, or its curved share: four times what tells two angles apart."""
    least = 4.0 * 4.0 * math.ulp(2.0 * math.pi)
    length = math.radians(120.0)
    for size, good in ((1.05, True), (0.95, False)):
        curved = {"curved": 0.5} if law == "scca" else {}
        share = size * least / length / curved.get("curved", 1.0)
        parameters = {**curved, "inflection": 1.0 - share if at_end else share}
        rise = move(120, 10.0, law, parameters=parameters)
        asked: list[Request] = [rest(60), rise, rest(60), move(120, 0.0)]
        if good:
            assert isinstance(planned(*asked).segments[1], Move)
            continue
        with pytest.raises(GeometryError, match="too few for cam angles to distinguish") as caught:
            planned(*asked)
        assert caught.value.key == "motion[2].law"
        assert "of its 120," in caught.value.message


# Values at joints, and between them ------------------------------------------------------------

ANY = Wishes(
    counts=(1, 2, 3, 4, 5, 6, 8, 12, 25, 50),
    sizes=(1e-9, 1e-3, 1.0, 10.0, 10.0, 10.0, 1e3, 1e6),
    stated=0.03,
    data=0.08,
)


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
    return request.law in ("double-harmonic", "simple-sine") or bool(request.stated_parameters)


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


# Requests -----------------------------------------------------------------------------------------

ROW = np.array([0.25, 0.5])
SPAN = Decimal(60)

SOUND: dict[type, dict[str, Any]] = {
    PositionUnit: {"name": "mm", "size": 1.0},
    Dwell: {"span": SPAN},
    MoveRequest: {"span": SPAN, "to": 10.0, "law": "auto"},
    PointsRequest: {"span": SPAN, "to": 10.0, "shares": ROW, "positions": ROW},
    TableRequest: {"span": SPAN, "shares": ROW, "lifts": ROW},
}

NO_NUMBERS: tuple[Any, ...] = (
    math.nan,
    math.inf,
    -math.inf,
    1e308,
    "60",
    True,
    1j,
    [60.0],
    10**400,
    Decimal("NaN"),
    Decimal("sNaN"),
    Decimal("Infinity"),
    Decimal("1e-999999"),
    Decimal("1e999999"),
)


@pytest.mark.parametrize(
    ("kind", "key", "value"),
    [
        *(
            (kind, "span", value)
            for kind in SOUND
            if kind is not PositionUnit
            for value in (*NO_NUMBERS, None)
        ),
        *(
            (kind, "span", value)
            for kind in SOUND
            if kind is not PositionUnit
            for value in (-60, 360.5)
        ),
        *((kind, "span", Decimal("5e-7")) for kind in (MoveRequest, PointsRequest, TableRequest)),
        *((kind, "to", value) for kind in (MoveRequest, PointsRequest) for value in NO_NUMBERS),
        *((kind, "to", value) for kind in (MoveRequest, PointsRequest) for value in (None, 5e-324)),
        *(
            (MoveRequest, key, v)
            for key in ("velocity", "acceleration", "jerk")
            for v in NO_NUMBERS
        ),
        *((PointsRequest, key, v) for key in ("velocity", "acceleration") for v in NO_NUMBERS),
        *((MoveRequest, "law", value) for value in ("polynomal", None, 3, ["auto"])),
        *((MoveRequest, "balance", value) for value in ("velocity", None, 3)),
        *((MoveRequest, "optimise", value) for value in (3, {1: 1.0}, {"torque": 1.0})),
        (MoveRequest, "parameters", [("sine", 0.5)]),
        *(
            (kind, "shares", v)
            for kind in (PointsRequest, TableRequest)
            for v in (None, "ab", [1j, 2j])
        ),
        *((kind, "shares", [0.1]) for kind in (PointsRequest, TableRequest)),
        (PointsRequest, "boundaries", {2: (0.0, None)}),
        (PointsRequest, "boundaries", {"0": (0.0, None)}),
        (PointsRequest, "boundaries", {0: 3.0}),
        (PointsRequest, "boundaries", {0: (math.nan, None)}),
        *((TableRequest, "smoothing", value) for value in (*NO_NUMBERS, 0.0, -1.0, 5e-324)),
        *((PositionUnit, "size", value) for value in (*NO_NUMBERS, 0.0, -1.0, 5e-324, None)),
    ],
    ids=lambda each: getattr(each, "__name__", None),
)
def test_a_wrong_value_is_reported_with_its_key(kind: type, key: str, value: Any) -> None:
    with pytest.raises(GeometryError, match="must be") as caught:
        kind(**(SOUND[kind] | {key: value}))
    reported = {"shares": ("shares", "positions", "lifts")}.get(key, (key,))
    assert caught.value.key in reported
    assert len(caught.value.value) <= 60


@pytest.mark.parametrize("weight", [-1.0, 0.0, math.nan, "1"])
def test_a_wrong_weight_is_reported_with_its_name(weight: Any) -> None:
    with pytest.raises(GeometryError, match="must be") as caught:
        MoveRequest(SPAN, 1.0, "auto", optimise={"jerk": weight})
    assert caught.value.key == "jerk"


@pytest.mark.parametrize("requests", [None, 3, [None], ["dwell"], [Dwell(SPAN), 3]])
def test_only_requests_are_planned(requests: Any) -> None:
    with pytest.raises(GeometryError, match="a sequence of requests"):
        plan_motion(requests)


def test_numbers_of_any_kind_are_spans_as_they_are_written() -> None:
    for value in (np.float64(0.1), 0.1, Decimal("0.1"), np.int64(3), 3):
        assert Dwell(value).span == Decimal(str(value))  # type: ignore[arg-type]  # any number is allowed


@pytest.mark.parametrize(
    "travel", [copy.copy, copy.deepcopy, lambda value: pickle.loads(pickle.dumps(value))]
)
@pytest.mark.parametrize("kind", SOUND)
def test_requests_travel(travel: Callable[[Request], Request], kind: type) -> None:
    request = kind(**SOUND[kind])
    found = travel(request)
    assert type(found) is kind
    for each in fields(kind):
        value, same = getattr(found, each.name), getattr(request, each.name)
        if isinstance(same, np.ndarray):
            assert not value.flags.writeable
        assert type(value) is type(same)
        assert np.array_equal(value, same)
