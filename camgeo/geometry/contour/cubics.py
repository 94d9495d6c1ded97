"""Fit by cubic splines: C2 along each smooth piece, tangent at breaks, dwells and turns as arcs."""

from __future__ import annotations

import bisect
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from camgeo.errors import ToleranceError
from camgeo.geometry.contour.cubic_proof import (
    CELLS,
    ROUNDING_OF_PARTS,
    ArcLength,
    Part,
    fitted_deviation,
    parts_of,
)
from camgeo.geometry.contour.legs import (
    UNTRIED,
    clearly_less,
    in_steps,
    is_stuck,
    legs_of,
    marked,
    stuck_at,
    too_many,
)
from camgeo.geometry.contour.proof import SHARPNESS, proved
from camgeo.geometry.contour.spline import Arc, CubicSpline, SplineContour, SplineFit
from camgeo.geometry.outline.path import Path
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, IntArray, grouped, taken

# -- search ---------------------------------------------------------------------------------------
# Spans of least-squares splines: the number and the places of the knots.


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


# -- least squares --------------------------------------------------------------------------------
# C2 cubic splines by least squares: many splines at once, over the arc length of the curve.
#
# The samples are the ends and the middles of the spans, with equal weights. Over equal spans the
# error of a spline then is a sum of Bernoulli polynomials of degree 4, centred so that it is as
# large at knots as between them: the least that a C2 cubic can have, h^4/768 times the fourth
# derivative.


PARTS = np.array([0.0, 0.25, 0.5, 0.75])
"""Places in each span at which the curve is evaluated while knots are shifted; the largest errors
lie near 0 and 1/2."""

FINE_PARTS = np.arange(8) / 8.0
"""Places in each span for the final error; parabolas between them give the peaks."""

CELLS_A_SPAN = 4
"""Cells that a span must have, on average over its piece, for the curve to be interpolated between
them while knots are shifted."""

ORDER = 4


@dataclass(frozen=True, slots=True, eq=False)
class Ends:
    """Where splines begin and end [mm], and their unit tangents there: complex, one each."""

    starts: ComplexArray
    stops: ComplexArray
    first: ComplexArray
    last: ComplexArray


@dataclass(frozen=True, slots=True, eq=False)
class Layout:
    """Splines to be fitted, one after the other, with the indices of their spans and control
    points.

    Attributes
    ----------
    piece : (splines,) the piece of the curve that each follows.
    counts : (splines,) cubics of each.
    ends : of each spline.
    """

    piece: IntArray
    counts: IntArray
    ends: Ends

    @property
    def span_starts(self) -> IntArray:
        """(splines,) first span of each."""
        return np.cumsum(self.counts) - self.counts

    @property
    def control_starts(self) -> IntArray:
        """(splines,) first control point of each."""
        each = self.counts + ORDER - 1
        return np.cumsum(each) - each


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """Fitted splines with their errors.

    Attributes
    ----------
    low, high : (spans,) arc length S [mm] of the ends of each span.
    controls : (all control points,) complex [mm].
    errors : (spans,) [mm] largest distance from the curve found in each span.
    """

    low: FloatArray
    high: FloatArray
    controls: ComplexArray
    errors: FloatArray


def solve(
    course: ArcLength, layout: Layout, low: FloatArray, high: FloatArray, *, final: bool = False
) -> Solution:
    """The splines with spans from `low` to `high` (spans,) [mm] in S.

    If `final`, the curve itself is evaluated and the error found at `FINE_PARTS`; before, points
    interpolated between the cells of `course` suffice, at `PARTS`.

    Ends and end tangents are those of the curve: the outermost legs are a third of a span long, as
    they are where the parameter is the arc length.
    """
    from scipy.linalg import solveh_banded  # only where a spline is fitted

    spans = len(low)
    owner = np.repeat(np.arange(len(layout.counts)), layout.counts)
    first_span = layout.span_starts[owner]
    local = np.arange(spans) - first_span
    parts = FINE_PARTS if final else PARTS
    basis = _basis(low, high, first_span, first_span + layout.counts[owner] - 1, parts)
    columns = (layout.control_starts[owner] + local)[:, None] + np.arange(ORDER)

    at = low[:, None] + (high - low)[:, None] * parts
    exact = np.full(spans, final) | (layout.counts * CELLS_A_SPAN > CELLS)[owner]
    points, tangents = _curve(course, layout.piece[owner], at, exact)

    fixed, held = _fixed(layout, low, high)
    middle = len(parts) // 2
    chosen = basis[:, ::middle]  # ends and middles of the spans
    free = chosen * ~held[columns][:, None, :]
    rest = points[:, ::middle] - np.einsum("sqc,sc->sq", chosen, fixed[columns])
    products = np.einsum("sqi,sqj->sij", free, free)
    size = len(fixed)
    bands = np.zeros((ORDER, size))
    for offset in range(ORDER):
        for i in range(ORDER - offset):
            bands[offset] += np.bincount(
                columns[:, i], weights=products[:, i, i + offset], minlength=size
            )
    bands[0] += held
    sides = np.einsum("sqi,sq->si", free, rest)
    right = np.empty((size, 2))
    for k, part in enumerate((sides.real, sides.imag)):
        right[:, k] = np.bincount(columns.ravel(), weights=part.ravel(), minlength=size)
    solved = solveh_banded(bands, right, lower=True, check_finite=False)
    controls = np.where(held, fixed, solved[:, 0] + 1j * solved[:, 1])

    apart = np.einsum("sqc,sc->sq", basis, controls[columns]) - points
    off = (np.conj(tangents) * apart).imag  # the part along the curve is not a distance
    errors = np.max(np.abs(off), axis=1)
    if final:
        first = layout.span_starts
        errors = np.maximum(errors, _peaks(off, first, first + layout.counts - 1))
    return Solution(low, high, controls, errors)


def _peaks(off: FloatArray, first: IntArray, last: IntArray) -> FloatArray:
    """(spans,) largest magnitude of the parabolas through any three neighbours of `off` (spans,
    parts).

    At their vertices; those of the spans before and after count too. Before the spans `first` and
    after the spans `last` (splines,) nothing is off.
    """
    after, before = np.roll(off[:, 0], -1), np.roll(off[:, -1], 1)
    after[last] = 0.0
    before[first] = 0.0
    values = np.column_stack((before, off, after))
    before, here, after = values[:, :-2], values[:, 1:-1], values[:, 2:]
    slope = 0.5 * (after - before)
    bend = after - 2.0 * here + before
    fall = np.divide(0.5 * slope * slope, bend, out=np.zeros_like(bend), where=bend != 0.0)
    peaks = np.where(np.abs(slope) < np.abs(bend), np.abs(here - fall), 0.0)
    largest: FloatArray = np.max(peaks, axis=1)
    return largest


def _curve(
    course: ArcLength, piece: IntArray, at: FloatArray, exact: BoolArray
) -> tuple[ComplexArray, ComplexArray]:
    """(spans, parts) points and tangents of the curve at S `at`, the curve itself where `exact`
    (spans,), else between its cells.
    """
    of = np.repeat(piece, at.shape[1]).reshape(at.shape)
    if np.all(exact):
        points, tangents = _exact(course, of.ravel(), at.ravel())
        return points.reshape(at.shape), tangents.reshape(at.shape)
    points, tangents = course.near(of, at)
    if np.any(exact):
        found = _exact(course, of[exact].ravel(), at[exact].ravel())
        points[exact], tangents[exact] = (part.reshape(-1, at.shape[1]) for part in found)
    return points, tangents


def _exact(course: ArcLength, piece: IntArray, s: FloatArray) -> tuple[ComplexArray, ComplexArray]:
    return course.curve.points_and_tangents(course.angles(piece, s))


def _fixed(layout: Layout, low: FloatArray, high: FloatArray) -> tuple[ComplexArray, BoolArray]:
    """(control points,) the four outer ones of each spline, 0 for free ones; a mask of them."""
    fixed = np.zeros(int(np.sum(layout.counts + ORDER - 1)), dtype=np.complex128)
    begin = layout.control_starts
    end = begin + layout.counts + ORDER - 2
    steps = high - low
    spans = layout.span_starts
    ends = layout.ends
    fixed[begin] = ends.starts
    fixed[begin + 1] = ends.starts + ends.first * steps[spans] / 3.0
    fixed[end] = ends.stops
    fixed[end - 1] = ends.stops - ends.last * steps[spans + layout.counts - 1] / 3.0
    held = np.zeros(len(fixed), dtype=np.bool_)
    for place in (begin, begin + 1, end - 1, end):
        held[place] = True
    return fixed, held


def _basis(
    low: FloatArray, high: FloatArray, first: IntArray, last: IntArray, parts: FloatArray
) -> FloatArray:
    """(spans, parts, 4) the four B-splines over each span, clamped at the spans `first`, `last`."""
    index = np.arange(len(low))
    before = [low[np.maximum(index - k, first)] for k in (2, 1, 0)]
    after = [high[np.minimum(index + k, last)] for k in (0, 1, 2)]
    knots = np.stack((*before, *after), axis=1)[:, None, :]
    x = low[:, None] + (high - low)[:, None] * parts
    values = [np.ones_like(x)]
    for degree in range(1, ORDER):
        grown = [np.zeros_like(x) for _ in range(degree + 1)]
        for k in range(degree):
            left, right = knots[..., 3 - degree + k], knots[..., 3 + k]
            share = values[k] / (right - left)
            grown[k] += (right - x) * share
            grown[k + 1] += (x - left) * share
        values = grown
    return np.stack(values, axis=-1)


# -- fits -----------------------------------------------------------------------------------------


AIM = 0.96
"""Fraction of the tolerance that the distance found may reach. The proof takes 1 % for its cells
and 2 % for its arcs, which may lie farther off than the spline; the rest is for what the parabolas
between samples miss, so that the first proof holds."""

STRAIGHT = 2.0**-52 * 64.0
"""A piece whose sagitta is a smaller fraction of its distance from the cam axis is a line."""

Search = Callable[[ArcLength, Ends, float, float], list[Found]]


def fit_spline(path: Path, tolerance: float) -> SplineFit:
    """Cubic splines within `tolerance` [mm] of `path`, counter-clockwise, in one pass.

    Each smooth piece between breaks is one spline, C2 inside and along the curve's tangents at both
    ends. Each dwell is one arc about the cam axis, of any sweep, each arc of the path is one arc,
    and a straight piece is one line. Corners are where the path has them and nowhere else.

    Raises
    ------
    UndercutError
        If the path is not regular.
    ToleranceError
        If the tolerance cannot be reached in double precision.
    GeometryError
        If the contour cannot be compared with the path, or the path has a gap.
    """
    return _proved(path, tolerance, fast)


def fewest_cubics(path: Path, tolerance: float) -> SplineFit:
    """As `fit_spline`, with the fewest cubics along each smooth piece, then the least deviation.

    Only splines over the arc length are searched; for their number see
    `camgeo.geometry.contour.cubics.CUBIC_CONSTANT`.
    """
    return _proved(path, tolerance, fewest)


def _proved(path: Path, tolerance: float, search: Search) -> SplineFit:
    legs = legs_of(path)
    parts = parts_of(legs, tolerance)
    size = max(abs(part.start) for part in parts)
    if not tolerance > ROUNDING_OF_PARTS * size:
        raise ToleranceError(
            "a spline cannot follow the curve", tolerance, ROUNDING_OF_PARTS * size
        )
    ends = [part.start for part in (*parts[1:], parts[0])]
    arcs = [part.arc(end) for part, end in zip(parts, ends, strict=True)]
    groups = _groups(parts, ends, [k for k, arc in enumerate(arcs) if arc is None])

    def fit(aim: float) -> tuple[SplineContour, float]:
        whole: list[CubicSpline | Arc | None] = list(arcs)
        error = 0.0
        for chosen, course, ends_of in groups:
            for k, found in zip(chosen, search(course, ends_of, aim, tolerance), strict=True):
                whole[k] = _strand(found.spline, size)
                error = max(error, found.error)
        return SplineContour(tuple(strand for strand in whole if strand is not None)), error

    def prove(made: tuple[SplineContour, float]) -> float:
        return fitted_deviation(legs, parts, *made, SHARPNESS * tolerance)

    (contour, _), reached = proved(fit, prove, AIM * tolerance, tolerance)
    return SplineFit(contour.counter_clockwise(), reached, tolerance)


def _groups(
    parts: Sequence[Part], ends: Sequence[complex], open_parts: Sequence[int]
) -> list[tuple[list[int], ArcLength, Ends]]:
    """The parts that need splines, by their curve; nearly always there is only one."""
    chosen: dict[int, tuple[ArcLength, list[int]]] = {}
    for k in open_parts:
        course = parts[k].course
        if course is not None:
            chosen.setdefault(id(course), (course, []))[1].append(k)
    found = []
    for course, members in chosen.values():
        course.require_finite()
        ends_of = Ends(
            np.array([parts[k].start for k in members]),
            np.array([ends[k] for k in members]),
            np.array([parts[k].first for k in members]),
            np.array([parts[k].last for k in members]),
        )
        found.append((members, course, ends_of))
    return found


def _strand(spline: CubicSpline, size: float) -> CubicSpline | Arc:
    """The spline, or a line if it is straight."""
    chord = spline.end - spline.start
    across = np.conj(chord) * (spline.controls - spline.start)
    if len(spline) == 1 and np.max(np.abs(across.imag)) <= STRAIGHT * size * abs(chord):
        return Arc(spline.start, spline.end, 0.0, 0j)
    return spline
