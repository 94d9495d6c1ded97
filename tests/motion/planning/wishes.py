"""Requests for the planner: what a designer may ask for, drawn at random, and short forms of it."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal
from typing import Any

import numpy as np
from hypothesis import strategies as st

from camgeo.kinematics.laws import FAMILIES
from camgeo.kinematics.plan import Dwell, MotionPlan, Move, SplineMove
from camgeo.kinematics.planning.planner import plan_motion
from camgeo.kinematics.planning.requests import (
    AUTO,
    CRITERIA,
    MoveRequest,
    PointsRequest,
    Request,
    TableRequest,
)
from camgeo.numeric.arrays import FloatArray


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

POLYNOMIALS = ("polynomial-5", "polynomial-7", "polynomial")

GROUPS = (
    (AUTO, *FAMILIES),
    (AUTO,),
    (AUTO, *POLYNOMIALS),
    ("modified-trapezoid", "harmonic-combination", AUTO),
    ("sine-straight", "simple-sine", "polynomial-5"),
    ("modified-sine", "straight-line", "harmonic-combination", AUTO),
)
"""Laws that are requested together: more requests can be met than if each plan drew from all."""

SHAPED = {
    "inflection": ("sine-straight", "modified-trapezoid", "harmonic-combination", "simple-sine"),
    "curved": ("sine-straight", "scca"),
    "sine": ("scca",),
}
"""Laws to which a parameter is given."""


@dataclass(frozen=True)
class Wishes:
    """Which turns are drawn.

    Attributes
    ----------
    laws : to choose from; empty for one of `GROUPS`.
    counts : numbers of segments.
    sizes : of the positions.
    stated : how often a velocity or an acceleration is.
    data : how often a move is by points or a table.
    rests : whether there are any.
    """

    laws: tuple[str, ...] = ()
    counts: tuple[int, ...] = (1, 2, 3, 4, 5, 6, 7, 8)
    sizes: tuple[float, ...] = (20.0,)
    stated: float = 0.1
    data: float = 0.2
    rests: bool = True

    def drawn(self) -> st.SearchStrategy[list[Request]]:
        """From a seed, because 50 segments are too many for hypothesis."""
        return st.integers(0, 2**32).map(lambda seed: self.turn(random.Random(seed)))

    def turn(self, dice: random.Random) -> list[Request]:
        """The requests of a random turn."""
        size = dice.choice(self.sizes)
        laws = self.laws or dice.choice(GROUPS)
        found: list[Request] = []
        position = 0.0
        lengths = spans_of(dice, dice.choice(self.counts))
        for number, span in enumerate(lengths):
            if self.rests and dice.random() < 0.1:
                found.append(Dwell(Decimal(0)))
            last = number == len(lengths) - 1
            if self.rests and dice.random() < 0.2 and not (last and position):
                found.append(Dwell(span))
                continue
            choices = (0.0, 0.5, 1.0, -0.5, position / size, round(dice.uniform(-1.0, 1.0), 3))
            to = 0.0 if last else dice.choice(choices) * size
            found.append(self.request(dice, span, position, to, size, dice.choice(laws)))
            position = to
        return found

    def request(
        self, dice: random.Random, span: Decimal, start: float, to: float, size: float, law: str
    ) -> Request:
        """A move by a law or by data, sometimes with stated values."""
        length = math.radians(float(span))
        also: dict[str, Any] = {}
        for order, name in enumerate(("velocity", "acceleration"), start=1):
            if dice.random() < self.stated:
                also[name] = dice.choice((0.0, dice.uniform(-9.0, 9.0) * size / length**order))
        if dice.random() < self.data:
            rows = dice.randint(1, 6)
            shares = np.linspace(0.0, 1.0, rows + 2)
            inner = [dice.uniform(-1.0, 1.0) * size for _ in range(rows)]
            if dice.random() < 0.5:
                return PointsRequest(span, to, shares[1:-1], np.array(inner), **also)
            smoothing = dice.choice((None, 0.02 * size))
            return TableRequest(span, shares, np.array([start, *inner, to]), smoothing)
        if not self.laws and to == start and dice.random() < 0.9:
            law = dice.choice((AUTO, "polynomial-5", "polynomial-7", "modified-sine"))
        if law in ("polynomial-7", "polynomial") and dice.random() < 2.0 * self.stated:
            also["jerk"] = dice.uniform(-9.0, 9.0) * size / length**3
        parameters = {
            name: round(dice.uniform(0.05, 0.95 if name != "sine" else 0.25), 3)
            for name, families in SHAPED.items()
            if law in families and dice.random() < 0.1
        }
        if law == AUTO and dice.random() < 0.4:
            also["optimise"] = {dice.choice(CRITERIA): 1.0}
        return MoveRequest(span, to, law, parameters, **also)


def spans_of(dice: random.Random, count: int) -> list[Decimal]:
    """Spans of a turn, sometimes with a tiny one."""
    weights = [dice.choice((1, 2, 3, 5, 8)) for _ in range(count)]
    found = [Decimal(36000 * weight // sum(weights)) / 100 for weight in weights]
    if count > 1 and dice.random() < 0.2:
        found[0] = Decimal(dice.choice(("0.000001", "0.0001", "0.01", "0.5")))
    found[-1] += 360 - sum(found)
    dice.shuffle(found)
    return found
