"""Spans of least-squares splines: the number and the places of the knots."""

from __future__ import annotations

import bisect
import math
from dataclasses import dataclass

import numpy as np

from camgeo.contour.counts import UNTRIED, is_stuck, marked, stuck_at, too_many
from camgeo.contour.cubics.arc_length import ArcLength
from camgeo.contour.cubics.least_squares import ORDER, Ends, Layout, Solution, solve
from camgeo.contour.decided import clearly_less, in_steps
from camgeo.contour.spline import CubicSpline
from camgeo.numeric.arrays import FloatArray, IntArray, grouped, taken

CUBIC_CONSTANT = 768.0**-0.25
"""Cubics needed, asymptotically: 0.18996 eps^(-1/4) times the integral of
|kappa'' - kappa^3|^(1/4) ds.

kappa'' - kappa^3 is the normal part of the fourth derivative over the arc length. The error of a
C2 cubic over equal spans h is that times h^4 (B_4(t) - c)/24, B_4 Bernoulli's polynomial, which c
centres to +-1/32. The order is 4; it could be raised by parameters other than the arc length, which
are as free as a plane curve has components, but not by a C2 spline over the length."""

DAMPING = (1.0, 0.8, 0.6, 0.5, 0.4, 0.3, 0.3)
"""Powers of the correction of the spans, round by round: moving a knot changes the errors of all
spans near it."""

FAST_ROUNDS = 2
"""Number of corrections of a fit in one pass."""

SMALLEST = 1e-3
"""Least error of a span that counts, as a fraction of the largest one: it limits the correction."""

LEAST, LESS = 0.95, 1
"""The search for the fewest cubics begins at this fraction of the limit, less this number: a count
below the limit suffices only by chance, where a piece has few cubics."""

CANDIDATES = 6
"""Numbers of cubics that are tried at once."""

ONE_BY_ONE, STEP = 60, 1.015
"""Up to this many cubics each number is tried, then in steps: for a smooth piece of hundreds of
cubics a solution for each number is not worth its cost."""

SPARE = ((1.04, 1), (1.10, 1), (1.17, 2), (1.25, 2))
"""The fast fit tries the limit times the first number, plus the second for the ends."""

MAX_CUBICS = 20_000
"""Most cubics of a smooth piece; a tolerance that needs more is beyond double precision."""


def _ladder() -> list[int]:
    counts = list(range(1, ONE_BY_ONE + 1))
    while counts[-1] < MAX_CUBICS:
        counts.append(math.ceil(counts[-1] * STEP))
    return counts


LADDER = _ladder()


@dataclass(frozen=True, slots=True)
class Found:
    """A spline for a piece, and its largest distance [mm] found."""

    spline: CubicSpline
    error: float


@dataclass(frozen=True, slots=True, eq=False)
class Trial:
    """The best splines found for a layout.

    Attributes
    ----------
    worst : (splines,) [mm] largest distance found of each.
    """

    layout: Layout
    solution: Solution
    worst: FloatArray

    def found(self, number: int) -> Found:
        """The spline of that number, over its own arc length from 0 on."""
        layout, found = self.layout, self.solution
        count = int(layout.counts[number])
        first = int(layout.span_starts[number])
        begin = int(layout.control_starts[number])
        places = np.append(found.low[first : first + count], found.high[first + count - 1])
        places = places - places[0]
        knots = np.concatenate(
            (np.repeat(places[:1], ORDER), places[1:-1], np.repeat(places[-1:], ORDER))
        )
        spline = CubicSpline(knots, found.controls[begin : begin + count + ORDER - 1])
        return Found(spline, float(self.worst[number]))


def limits(course: ArcLength, aim: float) -> FloatArray:
    """(pieces,) cubics that each piece needs for `aim` [mm], asymptotically; not whole numbers."""
    needed: FloatArray = CUBIC_CONSTANT * course.totals * aim**-0.25
    return needed


def fewest(course: ArcLength, ends: Ends, aim: float, tolerance: float) -> list[Found]:
    """A spline for each piece, of the fewest cubics whose distance found is at most `aim` [mm].

    For a number of cubics the distance depends only on the piece, and the numbers tried only on the
    aim at which they begin; so a larger aim never needs more cubics.

    Raises
    ------
    ToleranceError
        If more than `MAX_CUBICS` would be needed, or no number comes closer.
    """
    needed = limits(course, aim)
    places = [bisect.bisect_left(LADDER, LEAST * limit - LESS) for limit in needed]
    marks = [UNTRIED] * len(places)
    found: dict[int, Found] = {}
    while len(found) < len(places):
        open_pieces = [k for k in range(len(places)) if k not in found]
        tried = [(k, LADDER[i]) for k in open_pieces for i in _next(places[k], tolerance)]
        trial = _equalised(course, ends, tried, DAMPING)
        for number, (k, count) in enumerate(tried):
            worst = float(trial.worst[number])
            if k not in found and worst <= aim:
                found[k] = trial.found(number)
            marks[k] = marked(marks[k], count, worst)
            if k not in found and is_stuck(marks[k], count):
                raise stuck_at(worst, tolerance)
        for k in open_pieces:
            places[k] += CANDIDATES
    return [found[k] for k in range(len(places))]


def _next(place: int, tolerance: float) -> range:
    if place >= len(LADDER):
        raise too_many(MAX_CUBICS, "cubics", tolerance)
    return range(place, min(place + CANDIDATES, len(LADDER)))


def fast(course: ArcLength, ends: Ends, aim: float, tolerance: float) -> list[Found]:
    """A spline for each piece whose distance found is at most `aim` [mm], nearly always in one
    pass: a few numbers of cubics are tried at once, because calls cost more than numbers.

    Raises
    ------
    ToleranceError
        If more than `MAX_CUBICS` would be needed, or no number comes closer.
    """
    needed = limits(course, aim)
    counts = [
        sorted({math.ceil(factor * limit) + more for factor, more in SPARE}) for limit in needed
    ]
    found: dict[int, Found] = {}
    marks = [UNTRIED] * len(counts)
    while len(found) < len(counts):
        tried = [(k, count) for k in range(len(counts)) if k not in found for count in counts[k]]
        if max(count for _, count in tried) > MAX_CUBICS:
            raise too_many(MAX_CUBICS, "cubics", tolerance)
        trial = _equalised(course, ends, tried, DAMPING[:FAST_ROUNDS])
        for number, (k, count) in enumerate(tried):
            worst = float(trial.worst[number])
            excess = worst / aim
            if k not in found and excess <= 1.0:
                found[k] = trial.found(number)
            marks[k] = marked(marks[k], count, worst)
            if k not in found and is_stuck(marks[k], count):
                raise stuck_at(worst, tolerance)
            more = math.ceil(count * min(2.0, 1.02 * excess**0.25))
            counts[k] = [max(count + 1, more)]
    return [found[k] for k in range(len(counts))]


def _equalised(
    course: ArcLength, ends: Ends, tried: list[tuple[int, int]], damping: tuple[float, ...]
) -> Trial:
    """Splines for pairs (piece, cubics), their spans shifted until all errors are about equal."""
    piece = np.array([k for k, _ in tried], dtype=np.intp)
    counts = np.array([count for _, count in tried], dtype=np.intp)
    layout = Layout(piece, counts, taken(ends, piece))
    owner, local = grouped(counts)
    # All pieces lie on one line of S, and their shares from 0 to 1 on one from 0 to their number.
    shares = (np.arange(len(course.s))[:, None] + course.shares).ravel()
    line = course.s.ravel()
    low = np.interp(piece[owner] + local / counts[owner], shares, line)
    high = np.interp(piece[owner] + (local + 1) / counts[owner], shares, line)
    found = solve(course, layout, low, high)
    best_low, best_high = low, high
    worst = np.maximum.reduceat(found.errors, layout.span_starts)
    for power in damping:
        low, high = _shifted(course, layout, owner, found, power)
        found = solve(course, layout, low, high)
        now = np.maximum.reduceat(found.errors, layout.span_starts)
        better = clearly_less(now, worst)
        moved = better[owner]
        best_low, best_high = np.where(moved, low, best_low), np.where(moved, high, best_high)
        worst = np.where(better, now, worst)
    best = solve(course, layout, best_low, best_high, final=True)
    return Trial(layout, best, np.maximum.reduceat(best.errors, layout.span_starts))


def _shifted(
    course: ArcLength, layout: Layout, owner: IntArray, found: Solution, power: float
) -> tuple[FloatArray, FloatArray]:
    """New spans: the density of knots grows with the fourth root of the error, to a power."""
    first = layout.span_starts
    last = first + layout.counts - 1
    worst = np.maximum.reduceat(found.errors, first)
    share = found.errors / np.where(worst > 0.0, worst, 1.0)[owner]
    work = np.exp(0.25 * power * in_steps(np.log(share + SMALLEST)))
    sums = np.cumsum(work)
    before = (sums[first] - work[first])[owner]
    total = np.add.reduceat(work, first)[owner]
    # Work up to the end of each span, such that a spline's work is its number of spans.
    done = first[owner] + (sums - before) / total * layout.counts[owner]
    done[last] = last + 1.0
    lengths = found.high - found.low
    far = np.cumsum(lengths)
    line = np.interp(np.arange(len(owner) + 1.0), np.append(0.0, done), np.append(0.0, far))
    offset = (course.ends[layout.piece] - (far[first] - lengths[first]))[owner]
    low, high = line[:-1] + offset, line[1:] + offset
    low[first], high[last] = course.ends[layout.piece], course.ends[layout.piece + 1]
    return low, high
