"""Swallow tails: between two cusps the flank runs back and crosses itself once.

The crossing is where the way from one side to the other vanishes, the integral of a exp(i theta).
It is taken by Gauss-Legendre quadrature where the tail is small: the pace a has its digits also
where the points of the flank differ by less than their own rounding.

That there is one crossing at most is sure of a run of cells about the two cusps in which the
tangent turns one way, see `camgeo.outline.division`. Where it turns back at the cusps, as beside a
corner of the pitch curve, a run is known if what runs back is short, of length L: along the tangent
there, the parts before and after it add up to at most L for a pair of points that coincide. So both
lie within 1.2 L of the cusps, if the tangent turns by less than half a radian there, and by less
than a right angle farther out. Of two such pairs one would be inside the other, and the two sums of
directions between them equal. They are not if the tangents of both parts lie in cones apart; nor if
both parts of a pair, 1.2 L together, turn by less than the tangent turns back between the cusps:
going from one pair to the other, the tangent of one part would be ahead of that of the other all
the way.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgeo.numeric.arrays import BoolArray, joined
from camgeo.numeric.quadrature import gauss
from camgeo.outline.division import STRAIGHT, Division
from camgeo.outline.envelope import Envelope

REACH = 1.2
"""Length of the parts beside the cusps in which a crossing must lie, in times of what runs back;
more than 1 / cos(0.5)."""

SLIGHT = 0.5
"""Angle [rad] by which the tangent turns at most in these parts."""

SQUARE = 1.5
"""Angle [rad] by which it turns at most in the run: less than a right angle."""

SAMPLES = 33
"""Places at which the tangents of a part are looked at; over so short a part they turn steadily."""


@dataclass(frozen=True, slots=True)
class Run:
    """Cells that follow each other, in which there is one crossing at most.

    Attributes
    ----------
    first, cells : number of the first cell, and how many there are.
    low, high : path parameters between which the crossing lies, counted so that the cusps between
        them begin in [0, total).
    """

    first: int
    cells: int
    low: float
    high: float


def steady_run(line: Line, start: float, end: float) -> Run | None:
    """The longest run about the range [start, end] in which the tangent turns one way, below pi.

    None if it does not turn one way between the cusps.
    """
    left, right = line.cells_of(start, end)
    inner = slice(left, right + 1)
    sense = line.bend[left] if right >= left else 0.0
    if sense == 0.0 or np.any(line.bend[inner] != sense) or not np.all(line.negative[inner]):
        return None
    run = line.grown(left, right, STRAIGHT, line.bend == sense)
    return run if run is not None and run.low < start and end < run.high else None


def small_run(line: Line, envelope: Envelope, start: float, end: float) -> Run | None:
    """The run about a short range [start, end] beside which the tangent turns back, see above."""
    left, right = line.cells_of(start, end)
    if right < left or not np.all(line.negative[left : right + 1]):
        return None
    run = line.grown(left, right, SQUARE, np.ones(len(line.low), dtype=np.bool_))
    if run is None or run.low >= start or run.high <= end:
        return None
    inside = 0.5 * (end - start)
    within = start + (end - start) * (np.arange(SAMPLES) + 0.5) / SAMPLES
    length = 2.0 * inside * float(np.max(np.abs(envelope.course(within).pace)))
    parts, rates = [], []
    for cusp, limit in ((start, run.low), (end, run.high)):
        shares = np.linspace(0.0, 1.0, SAMPLES)[1:]
        away = np.sign(limit - cusp)
        pace = float(envelope.course(np.array([cusp + 1e-3 * away * inside])).pace[0])
        reach = cusp + away * min(REACH * length / max(pace, 1e-300), abs(limit - cusp))
        course = envelope.course(cusp + (reach - cusp) * shares)
        if np.mean(course.pace) * abs(reach - cusp) < length or np.min(course.pace) <= 0.0:
            return None
        parts.append((reach, course.tangents))
        steps = np.abs(np.angle(course.tangents[1:] * np.conj(course.tangents[:-1])))
        rates.append(float(np.max(steps / course.pace[1:])) * SAMPLES / abs(reach - cusp))
    (low, before), (high, after) = parts
    middle = before[0]
    angles = [np.angle(tangents * np.conj(middle)) for tangents in (before, after)]
    apart = np.max(angles[0]) < np.min(angles[1]) or np.max(angles[1]) < np.min(angles[0])
    first, last = envelope.course(np.array([start, end])).tangents
    back = abs(float(np.angle(last * np.conj(first))))
    apart = apart or max(rates) * REACH * length < back
    slight = max(float(np.max(np.abs(turned))) for turned in angles) < SLIGHT
    return Run(run.first, run.cells, float(low), float(high)) if apart and slight else None


class Line:
    """The cells of a division over three turns, so that none of them is at an end."""

    def __init__(self, division: Division) -> None:
        cells, total = division.cells, division.envelope.total
        self.count = len(cells)
        thrice = joined([cells, cells, cells])
        turns = np.repeat([-total, 0.0, total], self.count)
        self.low, self.high, self.bend = thrice.low + turns, thrice.high + turns, thrice.bend
        self.negative: BoolArray = np.tile(division.negative, 3)
        self.turn = np.tile(2.0 * cells.turn, 3)

    def cells_of(self, start: float, end: float) -> tuple[int, int]:
        """First and last cell of a range that begins and ends with cells."""
        left = int(np.searchsorted(self.low, start, side="left"))
        return left, int(np.searchsorted(self.high, end, side="left"))

    def grown(self, left: int, right: int, most: float, fit: BoolArray) -> Run | None:
        """The run from `left` to `right` with cells added on both sides in turn.

        As long as the pace is positive there, they `fit`, and all turn by less than `most` [rad].
        None if the range itself turns by more.
        """
        turned = float(np.sum(self.turn[left : right + 1]))
        if turned >= most:
            return None
        is_open = [True, True]
        while any(is_open):
            for side in (0, 1):
                k = right + 1 if side else left - 1
                is_open[side] &= bool(
                    fit[k]
                    and not self.negative[k]
                    and turned + self.turn[k] < most
                    and right - left + 1 < self.count
                )
                if is_open[side]:
                    turned += float(self.turn[k])
                    left, right = (left, k) if side else (k, right)
        cells = right - left + 1
        return Run(left % self.count, cells, float(self.low[left]), float(self.high[right]))


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
    envelope, line = division.envelope, Line(division)
    tails = []
    for start, end in backward:
        if end - start < envelope.total:
            tail = _tail(line, envelope, start, end)
            if tail is not None:
                tails.append(tail)
    return tuple(tails)


def _tail(line: Line, envelope: Envelope, start: float, end: float) -> SwallowTail | None:
    run = steady_run(line, start, end) or small_run(line, envelope, start, end)
    if run is None:
        return None
    low, high = run.low, run.high
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
