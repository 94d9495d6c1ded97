"""Splines through points and near them: quintic, with the least integral of s''' squared.

All of them minimise one energy over the values (y, s', s'') at the given points,

    sum over the points of (s(x_i) - y_i)^2  +  lambda * integral of s'''(x)^2 dx,

with some of the nodal values prescribed; an interpolating spline has all y prescribed, so the sum
is zero and lambda without effect. Between two points the minimiser is the quintic with these nodal
values. At a point where s' is free s'''' is continuous, where s'' is free s''' is continuous: those
are the energy's natural conditions (the factors of a variation of s' and s''). So

- where nothing is prescribed, s is continuous with four derivatives (C4);
- where only s' is prescribed, s to s''' are continuous and s'''' may jump;
- where only s'' is prescribed, s to s'' and s'''' are continuous and s''' may jump;
- where both are, s to s'' are continuous, s''' and s'''' may jump;
- at an end, what is not prescribed gives way to s''' = 0 (s'' free) and s'''' = 0 (s' free).

C. de Boor, A Practical Guide to Splines, ch. XIV (smoothing); C. H. Reinsch, Numer. Math. 10 (1967)
177-183, for the second derivative instead of the third.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.motion.boundary import FREE, Boundary
from camgeo.motion.spline import Spline
from camgeo.numeric.arrays import BoolArray, FloatArray, IntArray

MOST_UNEQUAL: Final = 1e6
"""Largest allowed ratio of the longest to the shortest distance of neighbouring points. The solve
keeps eight digits there; but what rounding the points' own values have counts ever more in the
slope between near ones."""

LONGEST: Final = 1e4
"""Largest cut-off length in mean distances of points; rounding grows with its cube and leaves
eight digits there."""

SHORTEST: Final = 1e-4
"""Smallest cut-off length tried, in shortest distances: its spline interpolates, nearly."""

SPANS: Final = (1e-30, 1e30)
HIGHEST: Final = 1e100
"""Allowed spans of x and sizes of y: within them no fifth derivative overflows."""

NEAR_ENOUGH: Final = 0.97
"""The search for a cut-off length ends with a deviation of this share of the allowed one."""

MAX_SEARCH: Final = 40

TINY: Final = 1e-300

ROOT_3, ROOT_5 = math.sqrt(3.0), math.sqrt(5.0)

MIN_RING: Final = 3
"""Points of the smallest ring that can be solved."""

VELOCITY, ACCELERATION = 1, 2


@dataclass(frozen=True, slots=True)
class FitReport:
    """How far a spline is from the data, at all points of it.

    Attributes
    ----------
    largest_deviation : largest |s(x_i) - y_i|, in the unit of y.
    rms : root of the mean square of s(x_i) - y_i, in the unit of y.
    place : the x_i of the largest deviation.
    length : cut-off length of the smoothing, in the unit of x; 0 if the spline interpolates.
    """

    largest_deviation: float
    rms: float
    place: float
    length: float = 0.0


# Builders -------------------------------------------------------------------------------------


def periodic_spline(
    x: FloatArray, y: FloatArray, period: float, rise: float = 0.0, gap: float = 0.0
) -> Spline:
    """Interpolate with s(x + period) = s(x) + rise; C4 everywhere, the seam included.

    Parameters
    ----------
    x : (n,) ascending, n >= 3 without the closing point x[0] + period, which may be missing.
    y : (n,) the values there.
    period : in the unit of x, larger than x[-1] - x[0], or equal with a closing point.
    rise : growth over a period, in the unit of y.
    gap : how far a closing point may be from y[0] + rise; it is not otherwise used.

    Raises
    ------
    GeometryError
        For too few points, points that do not ascend or are spaced too unequally, numbers that are
        not finite, points beyond the period, and a closing point that does not close.
    """
    x, y = _ring(*_checked(x, y), period, rise, gap)
    step = np.diff(np.append(x, x[0] + period))
    _check_spacing(step)
    nodes = np.zeros((len(x), 3))
    nodes[:, 0] = y
    chord = np.diff(np.append(y, y[0] + rise))
    fixed = np.zeros((len(x), 3), dtype=np.bool_)
    fixed[:, 0] = True
    nodes = _interpolate(step, chord, nodes, fixed, ring=True)
    ends = np.roll(nodes, -1, axis=0)
    return Spline(
        np.append(x, x[0] + period), _hermite(step, chord, nodes, ends), True, float(rise)
    )


def clamped_spline(
    x: FloatArray,
    y: FloatArray,
    start: Boundary = FREE,
    end: Boundary = FREE,
    inner: Mapping[int, Boundary] | None = None,
) -> Spline:
    """Interpolate with prescribed s' and s'' at the ends and at any inner points.

    The head of the module tells which derivatives are continuous where. With both values given at
    both ends and none inside, a polynomial of degree 5 is reproduced.

    Parameters
    ----------
    x, y : (n,) ascending x, n >= 2, and the values there; n = 2 needs a prescribed s' or s''.
    start, end : (s', s'') at the first and the last point, None where free.
    inner : the same for further points, by index 1 to n - 2.

    Raises
    ------
    GeometryError
        For too few points, points that do not ascend or are spaced too unequally, numbers that are
        not finite, and an index that is no inner point.
    """
    x, y = _checked(x, y)
    nodes, fixed = _prescribed(y, start, end, inner or {})
    fixed[:, 0] = True
    if len(x) == 2 and np.count_nonzero(fixed) == 2:
        raise GeometryError(
            "2 points without a velocity or acceleration are too few; 3 are allowed"
        )
    step, chord = np.diff(x), np.diff(y)
    nodes = _interpolate(step, chord, nodes, fixed, ring=False)
    return Spline(x, _hermite(step, chord, nodes[:-1], nodes[1:]))


def smooth_periodic_spline(
    x: FloatArray,
    y: FloatArray,
    period: float,
    rise: float = 0.0,
    *,
    largest_deviation: float | None = None,
    length: float | None = None,
    gap: float = 0.0,
) -> tuple[Spline, FitReport]:
    """Smooth with s(x + period) = s(x) + rise; C4 everywhere, the seam included.

    Parameters
    ----------
    x, y, period, rise, gap : as for `periodic_spline`.
    largest_deviation : allowed |s(x_i) - y_i|, in the unit of y, > 0. The cut-off length is then
        the longest found whose spline keeps it. Of all splines that keep it, others can have a
        smaller integral of s''' squared: this one also keeps the sum of squares small.
    length : or this cut-off length itself, in the unit of x, > 0: lambda = length^6 / mean
        distance, so that a wave sin(x / length) in evenly spaced data comes out with half its
        height, a longer wave with more (1 / (1 + (length * angular frequency)^6)). Up to the
        period, and to 10,000 mean distances of the points.

    Returns
    -------
    The spline, and its deviation from all points, a closing one excepted.

    Raises
    ------
    GeometryError
        As for `periodic_spline`; and unless exactly one of the last two is given.
    """
    x, y = _ring(*_checked(x, y), period, rise, gap)
    knots = np.append(x, x[0] + period)
    step = np.diff(knots)
    _check_spacing(step)
    trend = rise * (x - x[0]) / period
    nodes = np.zeros((len(x), 3))
    nodes[:, 0] = y - trend
    problem = _Smoothing(step, nodes, np.zeros((len(x), 3), dtype=np.bool_), ring=True)
    found, stress, length = problem.search(largest_deviation, length)
    taylor = _from_stress(step, found, stress)
    taylor[:, 0] += trend
    taylor[:, 1] += rise * step / period
    return Spline(knots, taylor, True, float(rise)), _report(x, taylor[:, 0] - y, length)


def smooth_clamped_spline(
    x: FloatArray,
    y: FloatArray,
    start: Boundary = FREE,
    end: Boundary = FREE,
    *,
    largest_deviation: float | None = None,
    length: float | None = None,
) -> tuple[Spline, FitReport]:
    """Smooth between the first and the last point, which are kept, with s' and s'' there.

    Parameters and errors as for `clamped_spline` and `smooth_periodic_spline`; n >= 3.
    C4 inside; at the ends see the head of the module.
    """
    x, y = _checked(x, y)
    if len(x) < 3:
        raise GeometryError(f"{len(x)} points are too few to smooth; at least 3 are allowed")
    nodes, fixed = _prescribed(y, start, end, {})
    fixed[[0, -1], 0] = True
    step = np.diff(x)
    problem = _Smoothing(step, nodes, fixed, ring=False)
    found, stress, length = problem.search(largest_deviation, length)
    taylor = _from_stress(step, found[:-1], stress)
    return Spline(x, taylor), _report(x, found[:, 0] - y, length)


def smoothest_values(
    x: FloatArray, y: FloatArray, given: Mapping[int, Boundary], period: float | None = None
) -> FloatArray:
    """(n, 2) s' and s'' at each point of the interpolant with these values prescribed.

    Parameters
    ----------
    x, y : (n,) ascending x and the values there; n >= 2, or 1 with a period.
    given : prescribed s' and s'' by index of the point, None where free.
    period : of a motion that closes, larger than x[-1] - x[0]; None for one that ends.

    Raises GeometryError as `clamped_spline` does.
    """
    count = len(x)
    if period is not None:
        # A ring of few points is laid twice and more: the matrix wants distinct neighbours.
        times = -(-MIN_RING // count)
        x = np.concatenate([x + k * period for k in range(times)])
        y = np.tile(y, times)
        given = {k * count + index: value for index, value in given.items() for k in range(times)}
        x, y = _checked(x, y)
        step, chord = np.diff(np.append(x, x[0] + times * period)), np.diff(np.append(y, y[0]))
        _check_spacing(step)
    else:
        x, y = _checked(x, y)
        step, chord = np.diff(x), np.diff(y)
    nodes = np.zeros((len(x), 3))
    nodes[:, 0] = y
    fixed = np.zeros((len(x), 3), dtype=np.bool_)
    fixed[:, 0] = True
    for index, values in given.items():
        for column, value in zip((VELOCITY, ACCELERATION), values, strict=True):
            if value is not None:
                nodes[index, column], fixed[index, column] = value, True
    ring = period is not None
    slopes: FloatArray = _interpolate(step, chord, nodes, fixed, ring=ring)[:count, 1:]
    return slopes


def report(spline: Spline, x: FloatArray, y: FloatArray, length: float = 0.0) -> FitReport:
    """Deviation of `spline` from the points `x`, `y` (n,), at all of them."""
    return _report(x, spline.values(x, 0)[0] - y, length)


def _report(x: FloatArray, deviation: FloatArray, length: float) -> FitReport:
    worst = int(np.argmax(np.abs(deviation)))
    return FitReport(
        float(abs(deviation[worst])),
        float(np.sqrt(np.mean(deviation**2))),
        float(x[worst]),
        length,
    )


# Checks ---------------------------------------------------------------------------------------


def _checked(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    x, y = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
    if x.ndim != 1 or x.shape != y.shape:
        raise GeometryError(f"x {x.shape} and y {y.shape} must be two rows of equal length")
    if len(x) < 2:
        raise GeometryError(f"{len(x)} points are too few; at least 2 are allowed")
    for name, values in (("x", x), ("y", y)):
        wrong = np.flatnonzero(~np.isfinite(values))
        if len(wrong):
            raise GeometryError(
                f"{name} of point {wrong[0]} is {values[wrong[0]]}, allowed are finite numbers",
                value=repr(float(values[wrong[0]])),
            )
    step = np.diff(x)
    wrong = np.flatnonzero(step <= 0.0)
    if len(wrong):
        place = int(wrong[0])
        fault = "equal" if step[place] == 0.0 else "descending"
        raise GeometryError(
            f"the x of points {place} and {place + 1} are {fault} ({float(x[place])!r},"
            f" {float(x[place + 1])!r});"
            " allowed is only ascending",
            value=repr(float(x[place + 1])),
        )
    _check_spacing(step)
    span, height = float(x[-1] - x[0]), float(np.max(np.abs(y)))
    if not (SPANS[0] <= span <= SPANS[1] and height <= HIGHEST):
        raise GeometryError(
            f"the points span {span:g} and have heights up to {height:g}; allowed are spans from"
            f" {SPANS[0]:g} to {SPANS[1]:g} and heights up to {HIGHEST:g}"
        )
    return x, y


def _check_spacing(step: FloatArray) -> None:
    found = float(np.max(step) / np.min(step))
    if not found <= MOST_UNEQUAL * (1.0 + 1e-6):
        place = int(np.argmin(step))
        raise GeometryError(
            f"the points are spaced too unequally: the distance {step[place]:g} after point {place}"
            f" is contained {found:g} times in the longest one; allowed is up to {MOST_UNEQUAL:g}",
            value=repr(found),
        )


def _ring(
    x: FloatArray, y: FloatArray, period: float, rise: float, gap: float
) -> tuple[FloatArray, FloatArray]:
    """The points of one period without the closing one."""
    if not (math.isfinite(period) and period > 0.0 and math.isfinite(rise)):
        raise GeometryError(
            f"period {period!r} and rise {rise!r}: allowed are a period above 0 and a finite rise"
        )
    rest = float(x[0]) + period - float(x[-1])
    rounding = 4.0 * np.spacing(max(abs(float(x[0])), abs(float(x[-1])), period))
    if rest < -rounding:
        raise GeometryError(
            f"the points span {float(x[-1] - x[0])!r}, allowed is up to the period {period!r}",
            value=repr(float(x[-1] - x[0])),
        )
    if rest <= rounding:
        seam = float(y[-1]) - (float(y[0]) + rise)
        if not abs(seam) <= gap:
            raise GeometryError(
                f"the last point lies {seam:g} off where it would close with the first; allowed is"
                f" up to {gap:g}",
                value=repr(seam),
            )
        x, y = x[:-1], y[:-1]
    if len(x) < 3:
        raise GeometryError(f"{len(x)} points are too few for a period; at least 3 are allowed")
    return x, y


def _prescribed(
    y: FloatArray, start: Boundary, end: Boundary, inner: Mapping[int, Boundary]
) -> tuple[FloatArray, BoolArray]:
    """(n, 3) nodal values y, s', s'', and which of s', s'' are prescribed."""
    nodes = np.zeros((len(y), 3))
    fixed = np.zeros((len(y), 3), dtype=np.bool_)
    nodes[:, 0] = y
    for index in inner:
        if not 0 < index < len(y) - 1:
            raise GeometryError(
                f"point {index} is no inner point; allowed are 1 to {len(y) - 2}", value=str(index)
            )
    for index, values in ((0, start), (len(y) - 1, end), *inner.items()):
        for column, value in zip((VELOCITY, ACCELERATION), values, strict=True):
            if value is None:
                continue
            if not math.isfinite(value):
                raise GeometryError(
                    f"the derivative prescribed at point {index} is {value}; allowed are finite"
                    " numbers",
                    value=repr(value),
                )
            nodes[index, column], fixed[index, column] = value, True
    return nodes, fixed


# The energy of one piece ----------------------------------------------------------------------
#
# With t in [0, 1] and u(t) = s, integral of u''' squared = d0^2 + d1^2 + d2^2, the moments of u'''
# with the orthonormal Legendre polynomials. Integrated by parts they are, with the chord
# D = u(1) - u(0), p = u'(0), q = u'(1), A = u''(0), B = u''(1):
#     d0 = B - A,  d1 = sqrt(3) (A + B + 2 p - 2 q),  d2 = sqrt(5) (B - A - 6 p - 6 q + 12 D).
# In x the integral is that divided by h^5.

MOMENTS: Final = np.array(
    [
        [0.0, 0.0, -1.0, 0.0, 0.0, 1.0],
        [0.0, 2.0 * ROOT_3, ROOT_3, 0.0, -2.0 * ROOT_3, ROOT_3],
        [-12.0 * ROOT_5, -6.0 * ROOT_5, -ROOT_5, 12.0 * ROOT_5, -6.0 * ROOT_5, ROOT_5],
    ]
)
"""(d0, d1, d2) from u, u', u'' at t = 0 and at t = 1."""

OF_CHORD: Final = np.array([0.0, 0.0, 12.0 * ROOT_5])

SLOPES: Final = [1, 2, 4, 5]
"""Columns of MOMENTS that belong to derivatives."""


def _node_scales(step: FloatArray, ring: bool) -> FloatArray:
    """(n,) for each node the length in which its derivatives are counted: its shorter piece."""
    if ring:
        return np.minimum(step, np.roll(step, 1))
    padded = np.concatenate((step[:1], step, step[-1:]))
    return np.minimum(padded[:-1], padded[1:])


def _pieces(step: FloatArray, scale: FloatArray, ring: bool) -> tuple[FloatArray, IntArray]:
    """(m, 3, 6) the moments of each piece from scaled nodal values; (m, 2) its nodes."""
    count = len(scale)
    first = np.arange(len(step))
    ends = np.stack((first, (first + 1) % count if ring else first + 1), axis=1)
    powers = (step[:, np.newaxis] / scale[ends])[:, :, np.newaxis] ** np.arange(3.0)
    return MOMENTS * powers.reshape(-1, 1, 6), ends


def _positions(count: int, ring: bool) -> IntArray:
    """(count,) the order in which the members of a chain or ring stand in a banded matrix.

    A ring is laid double, 0, count - 1, 1, count - 2, ...: neighbours are at most 2 apart.
    """
    number = np.arange(count)
    if not ring:
        return number
    return np.where(2 * number < count, 2 * number, 2 * (count - 1 - number) + 1)


def _hermite(
    step: FloatArray, chord: FloatArray, starts: FloatArray, ends: FloatArray
) -> FloatArray:
    """(m, 6) Taylor coefficients of the quintics with these nodal values (m, 3)."""
    p, q = starts[:, 1] * step, ends[:, 1] * step
    a, b = starts[:, 2] * step**2, ends[:, 2] * step**2
    p_less, q_less = p - chord, q - chord  # a straight motion leaves no rest of rounding
    return np.stack(
        (
            starts[:, 0],
            p,
            0.5 * a,
            -6.0 * p_less - 4.0 * q_less - 1.5 * a + 0.5 * b,
            8.0 * p_less + 7.0 * q_less + 1.5 * a - b,
            -3.0 * p_less - 3.0 * q_less - 0.5 * a + 0.5 * b,
        ),
        axis=1,
    )


# Interpolation: banded Cholesky ---------------------------------------------------------------


def _interpolate(
    step: FloatArray, chord: FloatArray, nodes: FloatArray, fixed: BoolArray, ring: bool
) -> FloatArray:
    """(n, 3) nodal values with the least energy; `nodes` holds the prescribed ones."""
    from scipy.linalg import cho_solve_banded, cholesky_banded

    count = len(nodes)
    scale = _node_scales(step, ring)
    moments, ends = _pieces(step, scale, ring)
    # The moments see the positions only through the chord, which is exact where positions cancel.
    rows = moments[:, :, SLOPES] * ((step / np.min(step)) ** -2.5)[:, np.newaxis, np.newaxis]
    shift = OF_CHORD * (chord * (step / np.min(step)) ** -2.5)[:, np.newaxis]
    place = 2 * _positions(count, ring)[ends][:, :, np.newaxis] + np.arange(2)
    place = place.reshape(-1, 4)

    held = np.zeros(2 * count, dtype=np.bool_)
    own = 2 * _positions(count, ring)[:, np.newaxis] + np.arange(2)
    held[own] = fixed[:, 1:]
    unknown = np.zeros(2 * count)
    unknown[own] = nodes[:, 1:] * np.stack((scale, scale**2), axis=1)

    width = 5 if ring else 3
    stiffness = np.einsum("mki,mkj->mij", rows, rows)
    diagonal = np.zeros(2 * count)
    np.add.at(diagonal, place, np.einsum("mii->mi", stiffness))
    balance = 1.0 / np.sqrt(diagonal)
    banded = np.zeros((width + 1, 2 * count))
    for i in range(4):
        for j in range(4):
            low, high = place[:, i], place[:, j]
            free = (low >= high) & ~held[low] & ~held[high]
            entry = stiffness[free, i, j] * balance[low[free]] * balance[high[free]]
            np.add.at(banded, (low[free] - high[free], high[free]), entry)
    banded[0, held] = 1.0
    factor = cholesky_banded(banded, lower=True)
    for _ in range(2):  # the second time with what rounding has left
        strain = np.einsum("mki,mi->mk", rows, unknown[place]) + shift
        force = np.zeros(2 * count)
        np.add.at(force, place, -np.einsum("mki,mk->mi", rows, strain))
        force[held] = 0.0
        unknown += balance * cho_solve_banded((factor, True), balance * force)

    out = nodes.copy()
    free_slopes = unknown[own] / np.stack((scale, scale**2), axis=1)
    out[:, 1:] = np.where(fixed[:, 1:], nodes[:, 1:], free_slopes)
    return out


# Smoothing: the mixed system ------------------------------------------------------------------


class _Smoothing:
    """The smoothing problem of one set of points, solved for any cut-off length.

    The moments of s''' are unknowns beside the nodal values: the matrix then has the condition of a
    least squares problem and not its square, and the moments come out as exactly as the values.
    """

    def __init__(self, step: FloatArray, nodes: FloatArray, fixed: BoolArray, ring: bool) -> None:
        self.step, self.nodes, self.fixed, self.ring = step, nodes, fixed, ring
        self.scale = _node_scales(step, ring)
        self.mean = float(np.mean(step))
        self.moments, self.ends = _pieces(step, self.scale, ring)
        members = 2 * len(step) if ring else 2 * len(step) + 1
        place = 3 * _positions(members, ring)[:, np.newaxis] + np.arange(3)
        self.size = 3 * members
        self.width = 8 if ring else 5
        self.of_node = place[0::2]
        self.of_piece = place[1::2]
        self.of_ends = self.of_node[self.ends].reshape(-1, 6)

    def solve(self, length: float) -> tuple[FloatArray, FloatArray]:
        """(n, 3) nodal values, and (m, 3) moments d0, d1, d2 of each piece."""
        from scipy.linalg import solve_banded

        unit = self.scale[:, np.newaxis] ** np.arange(3.0)
        weight = (length / self.mean) ** 3 * (self.mean / self.step) ** 2.5
        # With all pieces at a point soft, the rows of its s' and s'' have small numbers only.
        nearest = np.zeros(len(self.nodes))
        np.maximum.at(nearest, self.ends, weight[:, np.newaxis])
        balance = np.ones((len(self.nodes), 3))
        balance[:, 1:] = 1.0 / np.minimum(nearest, 1.0)[:, np.newaxis]
        rows = self.moments * weight[:, np.newaxis, np.newaxis]
        columns = rows * balance[self.ends].reshape(-1, 1, 6)
        width = self.width
        banded = np.zeros((2 * width + 1, self.size))
        right = np.zeros(self.size)
        banded[width, self.of_piece] = 1.0
        for k in range(3):
            for j in range(6):
                node, piece = self.of_ends[:, j], self.of_piece[:, k]
                banded[width + piece - node, node] = -rows[:, k, j]
                banded[width + node - piece, piece] = columns[:, k, j]
        banded[width, self.of_node[:, 0]] = 1.0  # the sum of squares
        right[self.of_node[:, 0]] = self.nodes[:, 0]
        held = self.of_node[self.fixed]
        for offset in range(-width, width + 1):  # a prescribed value: its row becomes value = given
            column = held - offset
            inside = (column >= 0) & (column < self.size)
            banded[width + offset, column[inside]] = 1.0 if offset == 0 else 0.0
        right[held] = (self.nodes * unit)[self.fixed]
        solution = solve_banded(
            (width, width), banded, right, overwrite_ab=True, overwrite_b=True, check_finite=False
        )
        found = np.where(self.fixed, self.nodes, solution[self.of_node] / unit)
        return found, solution[self.of_piece] / weight[:, np.newaxis]

    def search(
        self, largest_deviation: float | None, length: float | None
    ) -> tuple[FloatArray, FloatArray, float]:
        """Nodal values, moments and the cut-off length used."""
        limit = min(LONGEST * self.mean, float(np.sum(self.step)))
        if (largest_deviation is None) == (length is None):
            raise GeometryError("smoothing takes a largest deviation or a length, and not both")
        if length is not None:
            if not 0.0 < length <= limit:
                raise GeometryError(
                    f"the cut-off length is {length!r}; allowed is above 0 and up to {limit:g}",
                    value=repr(length),
                )
            return (*self.solve(length), length)
        if not (largest_deviation is not None and 0.0 < largest_deviation < math.inf):
            raise GeometryError(
                f"the largest deviation is {largest_deviation!r}; allowed is a number above 0",
                value=repr(largest_deviation),
            )
        return self._within(largest_deviation, limit)

    def _within(self, allowed: float, limit: float) -> tuple[FloatArray, FloatArray, float]:
        """The longest cut-off length found that keeps the deviation.

        The largest deviation need not grow with the length, so lengths are halved from the longest
        one on; then false position, on logarithms, between the first that keeps it and the next.
        """
        length, above = limit, 0.0
        while True:
            nodes, moments = self.solve(length)
            deviation = float(np.max(np.abs(nodes[:, 0] - self.nodes[:, 0])))
            if deviation <= allowed:
                break
            high, above = length, deviation
            length *= 0.5
            if length < SHORTEST * float(np.min(self.step)):
                raise GeometryError(
                    f"no spline was found within {allowed:g} of all points; the nearest one has a"
                    f" deviation of {above:g}, from rounding; allowed is more",
                    value=repr(allowed),
                )
        best = nodes, moments, length
        if not above:
            return best
        log_low, log_high = math.log(length), math.log(high)
        below = deviation
        for _ in range(MAX_SEARCH):
            if below >= NEAR_ENOUGH * allowed or log_high - log_low < 1e-4:
                break
            wanted = math.log(0.5 * (1.0 + NEAR_ENOUGH) * allowed)
            share = (wanted - math.log(max(below, TINY))) / (
                math.log(above) - math.log(max(below, TINY))
            )
            middle = log_low + min(max(share, 0.1), 0.9) * (log_high - log_low)
            nodes, moments = self.solve(math.exp(middle))
            deviation = float(np.max(np.abs(nodes[:, 0] - self.nodes[:, 0])))
            if deviation <= allowed:
                best = nodes, moments, math.exp(middle)
                log_low, below = middle, deviation
            else:
                log_high, above = middle, deviation
        return best


def _from_stress(step: FloatArray, starts: FloatArray, moments: FloatArray) -> FloatArray:
    """(m, 6) Taylor coefficients from u, u', u'' at the left ends and the moments of u'''.

    u''' = e0 + e1 (2 t - 1) + e2 (6 t^2 - 6 t + 1) with e = d (1, sqrt 3, sqrt 5).
    """
    e0, e1, e2 = (moments * (1.0, ROOT_3, ROOT_5)).T
    return np.stack(
        (
            starts[:, 0],
            starts[:, 1] * step,
            0.5 * starts[:, 2] * step**2,
            (e0 - e1 + e2) / 6.0,
            (2.0 * e1 - 6.0 * e2) / 24.0,
            6.0 * e2 / 60.0,
        ),
        axis=1,
    )
