"""Series of the forcing, and the closed-form solution of the modal equation u' = lambda u + a(t)
with them.

On a cell of half length H, with x from -1 to 1 and kappa = lambda H, the solution is a polynomial
and a free vibration,

    u = Q(x) + C exp(kappa (x + 1)),   dQ/dx = kappa Q + H a.

Integrated term by term this gives, for the coefficients q_k of Q and a_k of a and k >= 1,

    2 k q_k = kappa (c q_{k-1} - q_{k+1}) + H (c a_{k-1} - a_{k+1}),   c = 2 for k = 1, else 1

(C. W. Clenshaw, Proc. Camb. Phil. Soc. 53 (1957) 134-149). Where |kappa| is large, Q is the
polynomial of the degree of a that these rows give from the highest downwards; no row then magnifies
the rounding of the one above. Where |kappa| is small they are a recurrence whose desired solution
decreases with k, so it is eliminated backwards (F. W. J. Olver, J. Res. Nat. Bur. Standards 71B
(1967) 111-129). In between, the piece is cut until |kappa| is small.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from camgeo.numeric.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
    Side,
    frozen,
    grouped,
)

DEGREE: Final = 16
"""Degree of the series on a piece. Half a period of a sine needs this much for 16 digits, a
polynomial law less; a piece that needs more is halved."""

MOST_HALVINGS: Final = 40
"""A piece is halved at most this often. Repeated halving closes in on a kink that is not an edge;
its piece is then 1e-12 of the original."""

MOST_PIECES: Final = 4000
"""Pieces, or four times as many as there were, beyond which none is halved any further: what is
rounding and nothing else is as rough on any piece."""

_ANGLES: Final = np.pi * (np.arange(DEGREE + 1) + 0.5) / (DEGREE + 1)

NODES: Final = frozen(-np.cos(_ANGLES), np.float64)
"""(17,) zeros of T_17, ascending: inside the piece, where the function has a single value."""

TO_SERIES: Final = frozen(
    np.cos(np.outer(np.arange(DEGREE + 1), np.pi - _ANGLES))
    * np.where(np.arange(DEGREE + 1) == 0, 1.0, 2.0)[:, np.newaxis]
    / (DEGREE + 1),
    np.float64,
)
"""(17, 17) from the values at the nodes to the coefficients, by the discrete orthogonality of the
polynomials (Trefethen, Approximation Theory and Approximation Practice, chapter 3)."""

ORDERS: Final = frozen(np.arange(DEGREE + 1), np.float64)

TAIL: Final = 3
"""Number of last coefficients whose sum estimates the truncation."""


@dataclass(frozen=True, slots=True, eq=False)
class Pieces:
    """A function as Chebyshev series.

    Attributes
    ----------
    edges : (p + 1,) ascending; the pieces lie between neighbours.
    series : (17, p) coefficients of T_0 to T_16 on each piece.
    error : estimate of the integral of the magnitude of the truncated terms.
    largest : magnitude of the function at the nodes.
    """

    edges: FloatArray
    series: FloatArray
    error: float
    largest: float

    def times(self, factor: float) -> Pieces:
        """`factor` times the function."""
        size = abs(factor)
        return Pieces(self.edges, factor * self.series, size * self.error, size * self.largest)

    @property
    def steepest(self) -> float:
        """A bound of the magnitude of its slope on any piece (Markov: |T_k'| is at most k^2)."""
        half = 0.5 * np.diff(self.edges)
        return float(np.max(ORDERS**2 @ np.abs(self.series) / half))

    @property
    def jumps(self) -> FloatArray:
        """(p,) its jump at the start of each piece; the last one ends where the first begins."""
        ends = np.sum(self.series, axis=0)
        starts = 2.0 * np.sum(self.series[::2], axis=0) - ends
        return np.asarray(starts - np.roll(ends, 1))

    def values(self, t: FloatArray, side: Side) -> FloatArray:
        """(n,) the function at `t` (n,) between the edges."""
        place = np.clip(np.searchsorted(self.edges, t, side) - 1, 0, self.series.shape[1] - 1)
        low, high = self.edges[place], self.edges[place + 1]
        return series_values(self.series[:, place], (2.0 * t - low - high) / (high - low))


def interpolated(
    function: Callable[[FloatArray], FloatArray],
    edges: FloatArray,
    tolerance: float,
    rounding: float = 0.0,
) -> Pieces:
    """`function` as series.

    Parameters
    ----------
    function : (n,) -> (n,), smooth between neighbouring edges; it is not evaluated at them.
    edges : (m + 1,) ascending, m >= 1.
    tolerance : a piece is halved until the estimated integral of its truncation is below this
        fraction of the integral of the function's magnitude.
    rounding : of the argument; what it changes, halving does not reduce, and it stays part of the
        error.
    """
    low, high = edges[:-1], edges[1:]
    starts, rows = [], []
    size, largest, error = 0.0, 0.0, 0.0
    most = max(MOST_PIECES, 4 * len(low))
    for halving in range(MOST_HALVINGS + 1):
        half = 0.5 * (high - low)
        x = (0.5 * (high + low))[:, np.newaxis] + half[:, np.newaxis] * NODES
        values = function(x.ravel()).reshape(x.shape)
        magnitude = np.max(np.abs(values), axis=1)
        largest = max(largest, float(np.max(magnitude)))
        if halving == 0:
            size = float(np.sum(2.0 * half * magnitude))
        series = values @ TO_SERIES.T
        lost = 2.0 * half * np.sum(np.abs(series[:, -TAIL:]), axis=1)
        steepest = np.abs(series) @ ORDERS**2 / half  # see `Pieces.steepest`
        good = (lost <= tolerance * size) | (lost <= 2.0 * half * rounding * steepest)
        if halving == MOST_HALVINGS or np.count_nonzero(~good) > most:
            good[:] = True
        starts.append(low[good])
        rows.append(series[good])
        error += float(np.sum(lost[good]))
        if np.all(good):
            break
        middle = 0.5 * (low + high)[~good]
        low = np.concatenate((low[~good], middle))
        high = np.concatenate((middle, high[~good]))
        order = np.argsort(low, kind="stable")
        low, high = low[order], high[order]
    ordered = np.concatenate(starts)
    order = np.argsort(ordered, kind="stable")
    return Pieces(
        np.append(ordered[order], edges[-1]), np.concatenate(rows)[order].T, error, largest
    )


def series_values(series: FloatArray, x: FloatArray) -> FloatArray:
    """Sum of series[k] T_k(x), Clenshaw's recurrence; `series` (m, ...) and `x` broadcast."""
    double = 2.0 * x
    last = series[-1] + 0.0 * x
    before = np.zeros_like(last)
    for row in series[-2:0:-1]:
        last, before = row + double * last - before, last
    found: FloatArray = series[0] + x * last - before
    return found


SMALL: Final = 1.5
"""|kappa| up to which the recurrence is eliminated backwards. The pivots stay away from 0: their
zeros are those of the Bessel functions J_0, J_1 ..., of which 2.4 is the smallest."""

LARGE: Final = 64.0
"""|kappa| from which on the polynomial of the degree of a is taken: DEGREE^2 / 4, so that the k-th
derivative of T_16 by kappa^k, at most 256^k / (1 3 5 ... (2k - 1) 64^k), does not exceed 6."""

ORDER: Final = 24
"""Degree of Q on a cell with small |kappa|: exp(kappa x) needs 20 for 16 digits."""


@dataclass(frozen=True, slots=True, eq=False)
class Cells:
    """Q on the cells of one or more problems, a piece and a lambda each.

    Attributes
    ----------
    problem : (c,) the problem that each cell belongs to; the cells of a problem are consecutive.
    start, half : (c,) where the cell begins, and half its length.
    rate : (c,) lambda.
    series : (25, c) coefficients of Q.
    first : (c,) whether the cell is the first one of its piece.
    """

    problem: IntArray
    start: FloatArray
    half: FloatArray
    rate: ComplexArray
    series: ComplexArray
    first: BoolArray

    @property
    def at_start(self) -> ComplexArray:
        """(c,) Q(-1)."""
        even: ComplexArray = np.sum(self.series[::2], axis=0)
        odd: ComplexArray = np.sum(self.series[1::2], axis=0)
        return even - odd

    @property
    def growth(self) -> ComplexArray:
        """(c,) factor of a free vibration from the start of the cell to its end."""
        grown: ComplexArray = np.exp(2.0 * self.rate * self.half)
        return grown

    @property
    def gain(self) -> ComplexArray:
        """(c,) u at the end of the cell, if it is 0 at its start."""
        at_end: ComplexArray = np.sum(self.series, axis=0)
        return at_end - self.growth * self.at_start


def most_cells(pieces: int, rate: ComplexArray) -> FloatArray:
    """(q,) bounds of the number of cells over `pieces` of length 1 in all, for each lambda."""
    cut = np.minimum(np.abs(rate) * (0.5 / SMALL), pieces * (LARGE / SMALL))
    return np.asarray(pieces + cut)


def solve(pieces: Pieces, piece: IntArray, rate: ComplexArray) -> Cells:
    """Q of the problems (q,): the `piece` of `pieces` and the lambda `rate` of each."""
    width = np.diff(pieces.edges)[piece]
    size = 0.5 * np.abs(rate) * width
    wide = size >= LARGE
    parts = np.where(wide, 1.0, np.maximum(1.0, np.ceil(size / SMALL))).astype(np.intp)
    problem, number = grouped(parts)
    count = parts[problem].astype(np.float64)
    forcing = pieces.series[:, piece[problem]]
    cut = np.flatnonzero(count > 1.0)
    if len(cut):
        x = (2.0 * number[cut] + 1.0 + NODES[:, np.newaxis]) / count[cut] - 1.0
        forcing[:, cut] = TO_SERIES @ series_values(forcing[:, cut], x)
    start = pieces.edges[:-1][piece][problem] + width[problem] * (number / count)
    half = 0.5 * width[problem] / count
    forcing *= half
    kappa = rate[problem] * half
    series = np.zeros((ORDER + 1, len(problem)), dtype=np.complex128)
    large = wide[problem]
    if np.any(large):
        series[: DEGREE + 1, large] = _downwards(kappa[large], forcing[:, large])
    if not np.all(large):
        series[:, ~large] = _eliminated(kappa[~large], forcing[:, ~large])
    return Cells(problem, start, half, rate[problem], series, number == 0)


def _downwards(kappa: ComplexArray, forcing: FloatArray) -> ComplexArray:
    """(17, c) the polynomial of the degree of `forcing`, H a."""
    q = np.zeros((DEGREE + 3, len(kappa)), dtype=np.complex128)
    padded = np.concatenate((forcing, np.zeros((2, len(kappa)))))
    inverse = 1.0 / kappa
    q[DEGREE] = -forcing[DEGREE] * inverse
    for k in range(DEGREE, 0, -1):
        c = 2.0 if k == 1 else 1.0
        known = 2.0 * k * q[k] - (c * padded[k - 1] - padded[k + 1])
        q[k - 1] = (known * inverse + q[k + 1]) / c
    found: ComplexArray = q[: DEGREE + 1]
    return found


def _eliminated(kappa: ComplexArray, forcing: FloatArray) -> ComplexArray:
    """(25, c) the solution with q_0 = 0: q_k = slope_k q_{k-1} + shift_k from the end back."""
    count = len(kappa)
    padded = np.zeros((ORDER + 2, count))
    padded[: DEGREE + 1] = forcing
    slope = np.zeros((ORDER + 2, count), dtype=np.complex128)
    q = np.zeros((ORDER + 2, count), dtype=np.complex128)  # the shifts, then the solution
    for k in range(ORDER, 0, -1):
        c = 2.0 if k == 1 else 1.0
        pivot = 1.0 / (2.0 * k + kappa * slope[k + 1])
        slope[k] = c * kappa * pivot
        q[k] = (c * padded[k - 1] - padded[k + 1] - kappa * q[k + 1]) * pivot
    for k in range(2, ORDER + 1):  # q_0 = 0 leaves q_1 as it is
        q[k] += slope[k] * q[k - 1]
    found: ComplexArray = q[: ORDER + 1]
    return found


@dataclass(frozen=True, eq=False)
class Mode:
    """u over the cells of one problem after the other, all with the same lambda.

    Attributes
    ----------
    edges : (c + 1,) borders of the cells.
    cells : Q.
    free : (c,) C.
    """

    edges: FloatArray
    cells: Cells
    free: ComplexArray

    @property
    def largest(self) -> float:
        """Bound of the magnitude of u."""
        return float(np.max(np.sum(np.abs(self.cells.series), axis=0) + np.abs(self.free)))

    def values(self, t: FloatArray, side: Side) -> ComplexArray:
        """(n,) u at `t` (n,) between the edges; from the side asked for where it jumps."""
        place = np.searchsorted(self.edges, t, side) - 1
        place = np.clip(place, 0, len(self.free) - 1)
        half = self.cells.half[place]
        way = (t - self.cells.start[place]) / half
        series = self._needed[place].T
        x = way - 1.0
        double = 2.0 * x
        last = series[-1].copy()
        before = np.zeros_like(last)
        for row in series[-2:0:-1]:
            before *= -1.0
            before += row
            before += double * last
            last, before = before, last
        u: ComplexArray = series[0] + x * last - before
        u += self.free[place] * np.exp((self.cells.rate[0] * half) * way)
        return u

    @cached_property
    def _needed(self) -> ComplexArray:
        """(c, .) the coefficients up to the last that exceeds the rounding of the largest."""
        rows = np.max(np.abs(self.cells.series), axis=1)
        counts = np.flatnonzero(rows > np.finfo(np.float64).eps * 0.125 * np.max(rows))
        count = max(int(counts[-1]) + 1 if len(counts) else 2, 2)
        return np.ascontiguousarray(self.cells.series[:count].T)


def gain_over(cells: Cells, jumps: FloatArray, end: float) -> complex:
    """u at `end` of all `cells`, if it is 0 before them and jumps by `jumps` (p,) at each piece."""
    until = end - cells.start
    kicks = np.zeros(len(cells.start))
    kicks[cells.first] = jumps
    rest = np.maximum(until - 2.0 * cells.half, 0.0)
    return complex(
        np.sum(np.exp(cells.rate * rest) * cells.gain) + np.sum(np.exp(cells.rate * until) * kicks)
    )


def followed(cells: Cells, jumps: FloatArray, end: float, begin: complex) -> Mode:
    """The mode with the value `begin` at the start, before the first jump; see `gain_over`."""
    kicks = np.zeros(len(cells.start))
    kicks[cells.first] = jumps
    starts = []
    u = begin + kicks[0]
    for growth, gain, kick in zip(
        cells.growth.tolist(), cells.gain.tolist(), [*kicks.tolist()[1:], 0.0], strict=True
    ):
        starts.append(u)
        u = growth * u + gain + kick
    free = np.array(starts) - cells.at_start
    return Mode(np.append(cells.start, end), cells, free)
