"""Swallow tails: between two cusps the flank runs back and crosses itself once.

The crossing is where the way from one side to the other vanishes, the integral of a exp(i theta).
It is taken by Gauss-Legendre quadrature where the tail is small: the pace a has its digits also
where the points of the flank differ by less than their own rounding.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgeo.numeric.quadrature import gauss
from camgeo.outline.division import Division
from camgeo.outline.envelope import Envelope
from camgeo.outline.runs import small_run, steady_run

STEPS = 60
"""Newton steps at most; from the guess six do."""

SMALL = 1e-2
"""A tail whose flank is shorter than this share of its distance from the axis is a small one."""

NODES = 12
"""Of a quadrature over each smooth part."""

SETTLED = 1e-7
"""After a Newton step of this share of the tail's width the next one meets rounding."""

NOISE = 2.0**-52 * 64.0
"""Rounding of the pace, as a share of the speed of the roller centre."""


@dataclass(frozen=True, slots=True)
class SwallowTail:
    """The one crossing of a run of cells with two cusps.

    Attributes
    ----------
    first, second : path parameters in [0, total) of the crossing, before and after the cusps.
    point : where [mm].
    start, cells : the run in which there is no other: its first cell and their number.
    """

    first: float
    second: float
    point: complex
    start: int
    cells: int


def swallow_tails(
    division: Division, backward: list[tuple[float, float]]
) -> tuple[SwallowTail, ...]:
    """The tails of the ranges `backward` that cross within a short run of cells."""
    tails = []
    for start, end in backward:
        if end - start < division.envelope.total:
            tail = _tail(division, start, end)
            if tail is not None:
                tails.append(tail)
    return tuple(tails)


def _tail(division: Division, start: float, end: float) -> SwallowTail | None:
    run = steady_run(division, start, end) or small_run(division, start, end)
    if run is None:
        return None
    low, high, envelope = run.low, run.high, division.envelope
    middle, half = 0.5 * (start + end), 0.5 * (end - start)
    # Of a pace that is a parabola between the cusps the crossing lies root 3 times as far out.
    x = max(middle - np.sqrt(3.0) * half, 0.5 * (low + start))
    y = min(middle + np.sqrt(3.0) * half, 0.5 * (end + high))
    jet = envelope.curve.pitch.jet(np.array([envelope.angle_at(start)]))
    speed, settled = float(np.abs(jet[1, 0])), False
    for _ in range(STEPS):
        ends = envelope.course(np.array([x, y]))
        gap = _way(envelope, x, y)
        (t_x, t_y), (a_x, a_y) = ends.tangents, ends.pace
        sine = float((np.conj(t_x) * t_y).imag)
        if sine == 0.0 or a_x <= 0.0 or a_y <= 0.0:
            return None
        dx = float((np.conj(t_y) * gap).imag) / (-sine * float(a_x))
        dy = float((np.conj(t_x) * gap).imag) / (-sine * float(a_y))
        # Stay on the own side of the cusps, and inside the run.
        share = min(1.0, _room(x, dx, low, start), _room(y, dy, end, high))
        x, y = x + share * dx, y + share * dy
        if settled:
            break
        # The pace is a difference of speeds; of a tiny tail it has few digits left.
        noise = NOISE * speed / min(float(a_x), float(a_y))
        settled = abs(dx) + abs(dy) <= (SETTLED + noise) * (y - x) + 8.0 * float(np.spacing(y))
    else:
        return None
    if not (low <= x < start and end < y <= high):
        return None
    places = envelope.within(np.array([x, y]))
    point = complex(np.mean(envelope.course(places).points))
    return SwallowTail(float(places[0]), float(places[1]), point, run.first, run.cells)


def _room(place: float, step: float, low: float, high: float) -> float:
    """Share of `step` that leaves some of the way to the end it goes towards."""
    room = 0.9 * (high - place if step > 0.0 else place - low)
    return room / abs(step) if abs(step) > room else 1.0


def _way(envelope: Envelope, x: float, y: float) -> complex:
    """From the envelope at x to that at y."""
    ends = envelope.course(np.array([x, y]))
    straight = complex(ends.points[1] - ends.points[0])
    size = float(np.max(np.abs(ends.points))) + abs(envelope.curve.distance)
    inner = envelope.breaks + envelope.total * np.array([[-1.0], [0.0], [1.0]])
    inner = np.sort(inner.ravel())
    inner = inner[(inner > x) & (inner < y)]
    marks = np.concatenate(([x], inner, [y]))
    length = float(np.sum(np.abs(ends.pace))) * (y - x)
    if length > SMALL * size or len(inner) > 4:
        return straight
    places, half, weights = gauss(marks[:-1], marks[1:], NODES)
    course = envelope.course(places.ravel())
    parts = (half[:, None] * weights).ravel() * course.pace * course.tangents
    return complex(np.sum(parts))
