"""Requests for the planner: what a designer may ask for, drawn at random, and short forms of it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from decimal import Decimal
from functools import cache

import numpy as np
from hypothesis import strategies as st

from camgeo.kinematics.motion import Boundary
from camgeo.kinematics.plan import Dwell, MotionPlan, Move, SplineMove
from camgeo.kinematics.planning.planner import plan_motion
from camgeo.kinematics.planning.requests import (
    CRITERIA,
    MoveRequest,
    PointsRequest,
    Request,
    TableRequest,
)
from camgeo.numeric.arrays import FloatArray
from tests.strategies import among

LAWS_TO_ASK = (
    "auto",
    "polynomial-5",
    "polynomial-7",
    "polynomial",
    "harmonic-combination",
    "modified-trapezoid",
    "sine-straight",
    "simple-sine",
    "modified-sine",
    "straight-line",
)
"""Families of every kind: free, of one parameter, of two, for some tasks only."""


def rest(span: float | str | Decimal) -> Dwell:
    """A rest."""
    return Dwell(Decimal(span))


def move(span: float | str | Decimal, to: float, law: str = "auto", **also: object) -> MoveRequest:
    """A move."""
    return MoveRequest(Decimal(span), to, law, **also)  # type: ignore[arg-type]  # values by their names


def through(
    span: float | str | Decimal, to: float, *points: tuple[float, float], **also: object
) -> PointsRequest:
    """A move through points (share of the span, position)."""
    shares, positions = (np.array(column, dtype=np.float64) for column in zip(*points, strict=True))
    return PointsRequest(Decimal(span), to, shares, positions, **also)  # type: ignore[arg-type]  # values by their names


def table(
    span: float | str, lifts: Sequence[float] | FloatArray, smoothing: float | None = None
) -> TableRequest:
    """A table of evenly spaced rows."""
    rows = np.asarray(lifts, dtype=np.float64)
    return TableRequest(Decimal(span), np.linspace(0.0, 1.0, len(rows)), rows, smoothing)


def straight(request: Request) -> bool:
    """Whether a request is a straight line."""
    return isinstance(request, MoveRequest) and request.law == "straight-line"


def planned(*requests: Request) -> MotionPlan:
    """The plan of the requests."""
    return plan_motion(requests)


def laws(plan: MotionPlan) -> list[str]:
    """What each segment is: the name of its law and its task, "rest" or "data"."""
    found = []
    for segment in plan.segments:
        if isinstance(segment, Move):
            found.append(f"{segment.law.name} {segment.law.task}")
        else:
            found.append("rest" if isinstance(segment, Dwell) else "data")
    return found


def data_of(plan: MotionPlan, number: int) -> SplineMove:
    """The segment of that number, which comes from data."""
    segment = plan.segments[number]
    assert isinstance(segment, SplineMove)
    return segment


def move_of(plan: MotionPlan, number: int) -> Move:
    """The segment of that number, which has a law."""
    segment = plan.segments[number]
    assert isinstance(segment, Move)
    return segment


# Drawn at random ------------------------------------------------------------------------------


@st.composite
def spans(draw: st.DrawFn, count: int) -> list[Decimal]:
    """Spans of a turn in tenths of a degree, sometimes one of a few thousandths."""
    weights = [draw(st.integers(1, 40)) for _ in range(count)]
    free = 3600 - 50 * count
    found = [Decimal(50 + free * weight // sum(weights)) / 10 for weight in weights]
    if count > 1 and draw(st.integers(0, 5)) == 0:
        found[0] = Decimal(draw(among(("0.001", "0.02", "1"))))
    found[-1] += 360 - sum(found)
    return found


@cache
def positions(size: float) -> st.SearchStrategy[float]:
    """A position, often one that comes up again, so that moves return and go nowhere."""
    return st.one_of(
        st.sampled_from([0.0, 0.5, 1.0, -0.5]), st.floats(-1.0, 1.0).map(lambda x: round(x, 3))
    ).map(lambda share: share * size)


@st.composite
def wishes(
    draw: st.DrawFn,
    laws: tuple[str, ...] = LAWS_TO_ASK,
    *,
    size: float = 20.0,
    stated: bool = True,
    data: bool = True,
    rests: bool = True,
) -> list[Request]:
    """Requests for one turn, 1 to 8 of them."""
    count = draw(st.integers(1, 8))
    lengths = draw(spans(count))
    kinds = ("move",) * 5 + ("rest",) * 2 * rests + ("points", "table") * data
    found: list[Request] = []
    position = 0.0
    for number, span in enumerate(lengths):
        kind = draw(among(kinds))
        last = number == count - 1
        if last and kind == "rest" and position != 0.0:
            kind = "move"
        if rests and draw(st.integers(0, 9)) == 0:
            found.append(Dwell(Decimal(0)))
        if kind == "rest":
            found.append(Dwell(span))
            continue
        to = 0.0 if last else draw(positions(size))
        found.append(draw(_wish(kind, span, position, to, laws, size, stated)))
        position = to
    return found


@st.composite
def _wish(
    draw: st.DrawFn,
    kind: str,
    span: Decimal,
    start: float,
    to: float,
    laws: tuple[str, ...],
    size: float,
    stated: bool,
) -> Request:
    length = math.radians(float(span))
    velocity, acceleration = draw(_stated(length, size)) if stated else (None, None)
    if kind == "move":
        law = draw(among(laws))
        optimise = {}
        if law == "auto" and draw(st.booleans()):
            optimise = {draw(among(CRITERIA)): 1.0}
        return MoveRequest(
            span, to, law, velocity=velocity, acceleration=acceleration, optimise=optimise
        )
    rows = draw(st.integers(1, 6))
    inner = np.array([draw(positions(size)) for _ in range(rows)])
    shares = np.linspace(0.0, 1.0, rows + 2)
    if kind == "points":
        given: dict[int, Boundary] = {}
        if stated and draw(st.booleans()):
            given[0] = draw(_stated(length, size))
        return PointsRequest(span, to, shares[1:-1], inner, given, velocity, acceleration)
    smoothing = draw(among((None, 0.02 * size)))
    return TableRequest(span, shares, np.concatenate(([start], inner, [to])), smoothing)


@cache
def _shares() -> st.SearchStrategy[float | None]:
    some = st.floats(-5.0, 5.0).map(lambda x: round(x, 2))
    return st.one_of(st.none(), st.none(), st.none(), st.just(0.0), some)


@st.composite
def _stated(draw: st.DrawFn, length: float, size: float) -> tuple[float | None, float | None]:
    """Velocity and acceleration of the size that such a move has; mostly none."""
    velocity, acceleration = draw(_shares()), draw(_shares())
    return (
        None if velocity is None else velocity * size / length,
        None if acceleration is None else acceleration * size / length**2,
    )
