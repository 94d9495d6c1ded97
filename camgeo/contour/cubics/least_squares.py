"""C2 cubic splines by least squares: many splines at once, over the arc length of the curve.

The samples are the ends and the middles of the spans, with equal weights. Over equal spans the
error of a spline then is a sum of Bernoulli polynomials of degree 4, centred so that it is as large
at knots as between them: the least that a C2 cubic can have, h^4/768 times the fourth derivative.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgeo.contour.cubics.arc_length import CELLS, ArcLength
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, IntArray

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
