"""Splines through points and near them: quintic, with the least integral of s''' squared.

All of them minimise one energy over the values (y, s', s'') at the given points,

    sum over the points of (s(x_i) - y_i)^2  +  lambda * integral of s'''(x)^2 dx,

with some of the nodal values prescribed; an interpolating spline has all y prescribed, so the sum
is zero and lambda has no effect. Between two points the minimiser is the quintic with these nodal
values. At a point where s' is free s'''' is continuous, where s'' is free s''' is continuous: those
are the energy's natural conditions (the factors of a variation of s' and s''). So

- where nothing is prescribed, s is continuous up to the fourth derivative (C4);
- where only s' is prescribed, s to s''' are continuous and s'''' may jump;
- where only s'' is prescribed, s to s'' and s'''' are continuous and s''' may jump;
- where both are, s to s'' are continuous, s''' and s'''' may jump;
- at an end, the natural conditions are s''' = 0 (s'' free) and s'''' = 0 (s' free).

C. de Boor, A Practical Guide to Splines, ch. XIV (smoothing); C. H. Reinsch, Numer. Math. 10 (1967)
177-183, for the second derivative instead of the third.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.polynomial.polynomial import polyval

from camgeo.errors import GeometryError
from camgeo.kinematics.motion import (
    FREE,
    FULL_ORDER,
    Boundary,
    checked_boundaries,
    checked_boundary,
)
from camgeo.numeric import checked
from camgeo.numeric.arrays import BoolArray, FloatArray, IntArray, Side
from camgeo.numeric.extremes import Extreme, Extremes, sampled_extremes
from camgeo.record import Pickled
from camgeo.units import counted

MOST_UNEQUAL: Final = 1e6
"""Largest allowed ratio of the longest to the shortest distance of neighbouring points. The solve
keeps eight digits there, but the rounding of the points' own values weighs ever more in the slope
between close ones."""

MIN_RING: Final = 3
"""Points of the smallest ring that can be solved."""


@dataclass(frozen=True, slots=True)
class FitReport:
    """Deviation of a spline from all points of its data.

    Attributes
    ----------
    largest_deviation : largest |s(x_i) - y_i|, in the unit of y.
    rms : root of the mean square of s(x_i) - y_i, in the unit of y.
    place : the x_i of the largest deviation.
    """

    largest_deviation: float
    rms: float
    place: float

    @classmethod
    def from_points(cls, spline: Spline, x: FloatArray, y: FloatArray) -> FitReport:
        """Deviation of `spline` from the points `x`, `y` (n,), at all of them."""
        return cls.of_deviations(x, spline.values(x, 0)[0] - y)

    @classmethod
    def of_deviations(cls, x: FloatArray, deviation: FloatArray) -> FitReport:
        """From the deviations (n,) at the points `x` (n,)."""
        worst = int(np.argmax(np.abs(deviation)))
        return cls(
            float(abs(deviation[worst])),
            float(np.sqrt(np.mean(deviation**2))),
            float(x[worst]),
        )


def _smoothed(
    knots: FloatArray,
    nodes: FloatArray,
    fixed: BoolArray,
    largest_deviation: float,
    *,
    ring: bool,
) -> tuple[Spline, FitReport]:
    step = np.diff(knots)
    values, stress = Smoothing(step, nodes, fixed, ring).longest_fit(largest_deviation)
    spline = Spline(knots, from_stress(step, values[: len(step)], stress), ring)
    return spline, FitReport.of_deviations(knots[: len(nodes)], values[:, 0] - nodes[:, 0])


def smoothest_values(
    x: FloatArray, y: FloatArray, prescribed: Mapping[int, Boundary], period: float | None = None
) -> FloatArray:
    """(n, 2) s' and s'' at each point of the interpolant with these values prescribed.

    Parameters
    ----------
    x, y : (n,) ascending x and the values there; n >= 2, or 1 with a period.
    prescribed : s' and s'' by index of the point, None where free.
    period : of a motion that closes, larger than x[-1] - x[0]; None for one that ends.

    Raises GeometryError as `Spline.clamped` does.
    """
    count = len(x)
    if period is not None:
        # A ring of few points is repeated, because the folded matrix needs distinct neighbours.
        # Division rounded up.
        times = -(-MIN_RING // count)
        x = np.concatenate([x + k * period for k in range(times)])
        y = np.tile(y, times)
        prescribed = {
            k * count + index: value for index, value in prescribed.items() for k in range(times)
        }
        x, y = _checked(x, y)
        step, chord = np.diff(np.append(x, x[0] + times * period)), np.diff(np.append(y, y[0]))
        _check_spacing(step)
    else:
        x, y = _checked(x, y)
        step, chord = np.diff(x), np.diff(y)
    nodes, fixed = _prescribed(y, prescribed)
    fixed[:, 0] = True
    ring = period is not None
    return np.asarray(interpolate(step, chord, nodes, fixed, ring=ring)[:count, 1:])


# Checks ---------------------------------------------------------------------------------------


def _checked(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    x, y = checked.array("x", x), checked.array("y", y, largest=HIGHEST)
    if x.shape != y.shape:
        raise GeometryError(
            f"has {counted(len(y), 'number')}, x has {len(x)}; allowed: as many as x", "y"
        )
    if len(x) < 2:
        raise GeometryError(f"{_few(x)}; allowed: at least 2", "x")
    step = np.diff(x)
    wrong = np.flatnonzero(step <= 0.0)
    if len(wrong):
        place = int(wrong[0])
        fault = "equal" if step[place] == 0.0 else "descending"
        raise GeometryError(
            f"the x of points {place + 1} and {place + 2} are {fault} ({float(x[place])!r},"
            f" {float(x[place + 1])!r});"
            " allowed: only ascending",
            key="x",
            value=repr(float(x[place + 1])),
        )
    checked.positive("x", x[-1] - x[0])
    _check_spacing(step)
    return x, y


def _check_spacing(step: FloatArray) -> None:
    ratio = float(np.max(step)) / float(np.min(step))
    if not ratio <= MOST_UNEQUAL * (1.0 + 1e-6):
        place = int(np.argmin(step))
        raise GeometryError(
            f"the points are spaced too unequally: the longest distance is {ratio:.3g} times the"
            f" shortest, which follows point {place + 1}; allowed: up to {MOST_UNEQUAL:g}",
            key="x",
            value=repr(ratio),
        )


def _ring(
    x: FloatArray, y: FloatArray, period: float, rise: float, gap: float
) -> tuple[FloatArray, FloatArray]:
    """The knots of one period including the closing one, and the values without that of the closing
    one, which repeats the first.
    """
    period = checked.positive("period", period)
    rise = checked.number("rise", rise, largest=HIGHEST)
    gap = checked.number("gap", gap, least=0.0, largest=HIGHEST)
    rest = float(x[0]) + period - float(x[-1])
    # Each of the three numbers is rounded, and so is their sum.
    rounding = 4.0 * np.spacing(max(abs(float(x[0])), abs(float(x[-1])), period))
    if rest < -rounding:
        raise GeometryError(
            f"the points span {float(x[-1] - x[0])!r}; allowed: up to the period {period!r}",
            key="period",
            value=repr(float(x[-1] - x[0])),
        )
    if rest <= rounding:
        seam = float(y[-1]) - (float(y[0]) + rise)
        if not abs(seam) <= gap:
            raise GeometryError(
                f"the last point lies {seam:g} away from where it would close with the first one;"
                f" allowed: up to {gap:g}",
                key="y",
                value=repr(seam),
            )
        x, y = x[:-1], y[:-1]
    if len(x) < 3:
        raise GeometryError(
            f"{_few(x)} for a period, not counting the closing one; allowed: at least 3", "x"
        )
    knots = np.append(x, x[0] + period)
    _check_spacing(np.diff(knots))
    return knots, y


def _few(x: FloatArray) -> str:
    return f"{counted(len(x), 'point')} {'is' if len(x) == 1 else 'are'} too few"


def _boundaries(
    count: int, start: Boundary, end: Boundary, inner: Mapping[int, Boundary]
) -> dict[int, Boundary]:
    """The prescribed s' and s'' at the ends and at inner points, by index of the point."""
    return {
        0: checked_boundary("start", start),
        **checked_boundaries("inner", inner, 1, count - 2),
        count - 1: checked_boundary("end", end),
    }


def _prescribed(y: FloatArray, given: Mapping[int, Boundary]) -> tuple[FloatArray, BoolArray]:
    """(n, 3) nodal values y, s', s'', 0 where not prescribed; and (n, 3) whether s' or s'' is."""
    nodes = np.zeros((len(y), 3))
    fixed = np.zeros((len(y), 3), dtype=np.bool_)
    nodes[:, 0] = y
    for index, values in given.items():
        for column, value in enumerate(values, start=1):
            if value is not None:
                nodes[index, column], fixed[index, column] = value, True
    return nodes, fixed


# -- spline ---------------------------------------------------------------------------------------
# A piecewise polynomial of degree 5: the form of a motion given by points or by a table.
#
# Built through points or near them, and evaluated with numpy alone.


DEGREE: Final = 5

MAX_STEPS: Final = 200
"""Most steps of the search for a root. Every third one halves the bracket, and 53 halvings of [0,
1] suffice."""

LARGEST: Final = 1e200
"""Largest magnitude of knots, coefficients and rise; points within their own limits stay below
it."""

EDGE: Final = 8.0 * 2.0**-52
"""An argument outside the knots by at most this fraction of the largest knot is rounding."""


@dataclass(frozen=True, slots=True, eq=False)
class Spline(Pickled):
    """s(x) in pieces, each a polynomial of degree 5 at most.

    In piece i, with h = knots[i + 1] - knots[i] and t = (x - knots[i]) / h in [0, 1], s is the sum
    of taylor[i, k] t^k. A knot belongs to the piece on its right, the last one to the last piece.

    Attributes
    ----------
    knots : (m + 1,) x, strictly ascending; the domain is [knots[0], knots[-1]].
    taylor : (m, 6) in the unit of s: taylor[i, k] = s^(k)(knots[i]) h^k / k!.
    periodic : whether s continues beyond the domain, with s(x + period) = s(x) + rise and period =
        knots[-1] - knots[0].
    rise : see `periodic`; 0 unless periodic.

    Raises
    ------
    GeometryError
        If the shapes do not fit, a number is not finite or the knots do not ascend.
    """

    knots: FloatArray
    taylor: FloatArray
    periodic: bool = False
    rise: float = 0.0

    def __post_init__(self) -> None:
        knots = checked.array("knots", self.knots, largest=LARGEST)
        taylor = checked.array("taylor", self.taylor, 2, LARGEST)
        if len(knots) < 2 or taylor.shape != (len(knots) - 1, DEGREE + 1):
            raise GeometryError(
                f"must be {DEGREE + 1} coefficients for each interval between two of the knots,"
                " of which there are at least 2",
                key="taylor",
            )
        if not np.all(knots[1:] > knots[:-1]):
            raise GeometryError("the knots must ascend")
        rise = checked.number("rise", self.rise, largest=LARGEST)
        checked.hold(self, knots=knots, taylor=taylor, rise=rise)

    @classmethod
    def closed(
        cls, x: FloatArray, y: FloatArray, period: float, rise: float = 0.0, gap: float = 0.0
    ) -> Spline:
        """Interpolate with s(x + period) = s(x) + rise; C4 everywhere, the seam included.

        Parameters
        ----------
        x : (n,) ascending, n >= 3 without the closing point x[0] + period, which may be missing.
        y : (n,) the values there.
        period : in the unit of x, larger than x[-1] - x[0], or equal with a closing point.
        rise : growth over a period, in the unit of y.
        gap : allowed distance of a closing point from y[0] + rise; it has no other use.

        Raises
        ------
        GeometryError
            For too few points, points that do not ascend or are spaced too unequally, numbers that
            are not finite, points beyond the period, and a closing point that does not close.
        """
        knots, y = _ring(*_checked(x, y), period, rise, gap)
        nodes, fixed = _prescribed(y, {})
        fixed[:, 0] = True
        step, chord = np.diff(knots), np.diff(np.append(y, y[0] + rise))
        nodes = interpolate(step, chord, nodes, fixed, ring=True)
        ends = np.roll(nodes, -1, axis=0)
        return cls(knots, hermite(step, chord, nodes, ends), True, float(rise))

    @classmethod
    def clamped(
        cls,
        x: FloatArray,
        y: FloatArray,
        start: Boundary = FREE,
        end: Boundary = FREE,
        inner: Mapping[int, Boundary] | None = None,
    ) -> Spline:
        """Interpolate with prescribed s' and s'' at the ends and at any inner points.

        The module docstring states which derivatives are continuous where. With both values given
        at both ends and none inside, a polynomial of degree 5 is reproduced.

        Parameters
        ----------
        x, y : (n,) ascending x, n >= 2, and the values there; n = 2 needs a prescribed s' or s''.
        start, end : (s', s'') at the first and the last point, None where free.
        inner : the same for further points, by index 1 to n - 2.

        Raises
        ------
        GeometryError
            For too few points, points that do not ascend or are spaced too unequally, numbers that
            are not finite, and an index that is not that of an inner point.
        """
        x, y = _checked(x, y)
        nodes, fixed = _prescribed(
            y, _boundaries(len(x), start, end, {} if inner is None else inner)
        )
        fixed[:, 0] = True
        if len(x) == 2 and np.count_nonzero(fixed) == 2:
            raise GeometryError(
                "2 points without a velocity or acceleration are too few; allowed: at least 3",
                key="x",
            )
        step, chord = np.diff(x), np.diff(y)
        nodes = interpolate(step, chord, nodes, fixed, ring=False)
        return cls(x, hermite(step, chord, nodes[:-1], nodes[1:]))

    @classmethod
    def smooth_closed(
        cls,
        x: FloatArray,
        y: FloatArray,
        period: float,
        largest_deviation: float,
        gap: float = 0.0,
    ) -> tuple[Spline, FitReport]:
        """Smooth with s(x + period) = s(x); C4 everywhere, the seam included.

        Parameters
        ----------
        x, y, period, gap : as for `closed`.
        largest_deviation : allowed |s(x_i) - y_i|, in the unit of y, > 0. The cut-off length is the
            longest found whose spline keeps it. Of all splines that keep it, others can have a
            smaller integral of s''' squared: this one also keeps the sum of squares small.

        Returns
        -------
        The spline, and its deviation from all points except a closing one.

        Raises
        ------
        GeometryError
            As for `closed`; and if no spline keeps the deviation.
        """
        knots, y = _ring(*_checked(x, y), period, 0.0, gap)
        return _smoothed(knots, *_prescribed(y, {}), largest_deviation, ring=True)

    @classmethod
    def smooth_clamped(
        cls,
        x: FloatArray,
        y: FloatArray,
        start: Boundary = FREE,
        end: Boundary = FREE,
        *,
        largest_deviation: float,
    ) -> tuple[Spline, FitReport]:
        """Smooth between the first and the last point, which are kept with their s' and s''.

        Parameters and errors as for `clamped` and `smooth_closed`; n >= 3.
        C4 inside; for the ends see the module docstring.
        """
        x, y = _checked(x, y)
        if len(x) < 3:
            raise GeometryError(f"{_few(x)} to smooth; allowed: at least 3", "x")
        nodes, fixed = _prescribed(y, _boundaries(len(x), start, end, {}))
        fixed[[0, -1], 0] = True
        return _smoothed(x, nodes, fixed, largest_deviation, ring=False)

    @property
    def period(self) -> float:
        """Length of the domain, in the unit of x."""
        return float(self.knots[-1] - self.knots[0])

    def values(self, x: FloatArray, order: int = FULL_ORDER, side: Side = "right") -> FloatArray:
        """(order + 1, n) s and its derivatives up to `order` (0 to 5) at `x` (n,).

        `side` selects the one-sided value at a knot; an end of the domain with only one side gives
        that one.

        Raises
        ------
        GeometryError
            If an x is not finite, or outside the domain of a spline that is not periodic.
        """
        x = np.atleast_1d(np.asarray(x, dtype=np.float64))
        turns, x = self._reduced(x, side)
        piece = self._piece(x, side)
        left = self.knots[piece]
        rate = 1.0 / (self.knots[piece + 1] - left)
        derivatives = _taylor(self.taylor[piece].T, (x - left) * rate, order)
        scale = np.ones_like(rate)
        for k in range(1, order + 1):
            # The polynomial is in t, so each derivative with respect to x has one more factor dt/dx
            # = 1/h.
            scale = scale * rate
            derivatives[k] *= scale
        derivatives[0] += turns * self.rise
        return derivatives

    def bounds(self, order: int) -> FloatArray:
        """(m,) upper bounds of the absolute value of the derivative of `order` in each piece.

        The largest Bernstein coefficient, by the convex hull property; exact for orders 4 and 5,
        otherwise the relative excess vanishes with the square of the piece's length.
        """
        local = np.max(np.abs(_bernstein(_derivative(self.taylor, order))), axis=1)
        return np.asarray(local / np.diff(self.knots) ** order)

    def cell_bounds(self, low: FloatArray, high: FloatArray) -> FloatArray:
        """(4, n) upper bounds of |s - s(middle)|, |s'|, |s''|, |s'''| over the cells [low, high].

        `low`, `high` (n,) as `values` takes them; no cell reaches across a knot. The Taylor series
        from the middle of the cell, which ends with the fifth derivative.
        """
        # Terms of the series with derivative j > k bound the change of derivative k over the half
        # cell.
        half = 0.5 * (high - low)
        middle = np.abs(self.values(0.5 * (low + high), DEGREE))
        bounds = np.zeros((FULL_ORDER + 1, len(half)))
        for k in range(FULL_ORDER + 1):
            for j in range(DEGREE, k - 1, -1):
                # The value in the middle itself is no deviation from it.
                if j == k == 0:
                    continue
                bounds[k] += middle[j] * half ** (j - k) / math.factorial(j - k)
        return bounds

    def extremes(self, order: int) -> Extremes:
        """Smallest and largest derivative of `order` (0 to 5) over the domain, with their places.

        Exact but for rounding: all roots of the next derivative in each piece, each in a bracket,
        and both one-sided values at every knot. The place lies within the domain; of equal values
        the first counts.
        """
        pieces, places = self._turning_points(order)
        length = np.diff(self.knots)
        values = (
            _evaluate_rows(_derivative(self.taylor, order)[pieces], places)
            / length[pieces] ** order
        )
        return sampled_extremes(self._arguments(pieces, places), values)

    def beyond_knots(self) -> Extreme:
        """The largest amount by which s exceeds, inside a piece, both values at the ends of the
        piece.

        Negative if s falls below both values, with the place at which it does; 0 if s stays between
        them everywhere. Exact except for rounding.
        """
        pieces, places = self._turning_points(0)
        values = _evaluate_rows(self.taylor[pieces], places)
        ends = np.stack((self.taylor[:, 0], np.sum(self.taylor, axis=1)))
        above, below = (
            values - np.max(ends, axis=0)[pieces],
            values - np.min(ends, axis=0)[pieces],
        )
        beyond = np.where(above > 0.0, above, np.minimum(below, 0.0))
        most = int(np.argmax(np.abs(beyond)))
        return Extreme(float(beyond[most]), float(self._arguments(pieces, places)[most]))

    def _turning_points(self, order: int) -> tuple[IntArray, FloatArray]:
        """(n,), (n,) the pieces and the t in them at which the derivative of `order` may have an
        extremum, the ends of the pieces included.
        """
        rows = np.arange(len(self.taylor))
        piece = [rows, rows]
        place = [np.zeros(len(rows)), np.ones(len(rows))]
        if order < DEGREE:
            turning = _derivative(self.taylor, order + 1)
            hull = _bernstein(turning)
            # Where all Bernstein coefficients have one sign the derivative has no root, as its
            # values lie in their hull.
            bent = np.flatnonzero((np.min(hull, axis=1) <= 0.0) & (np.max(hull, axis=1) >= 0.0))
            edges = _monotone_edges(turning[bent])
            inner = _sign_changes(turning[bent], edges)
            place += [edges[:, 1:-1].ravel(), inner.ravel()]
            piece += [np.repeat(bent, edges.shape[1] - 2), np.repeat(bent, inner.shape[1])]
        return np.concatenate(piece), np.concatenate(place)

    def _arguments(self, pieces: IntArray, places: FloatArray) -> FloatArray:
        """(n,) x at t = `places` (n,) in `pieces` (n,), clipped to the domain."""
        x = self.knots[pieces] + places * np.diff(self.knots)[pieces]
        return np.asarray(np.clip(x, self.knots[0], self.knots[-1]))

    def inverse(self, y: FloatArray) -> FloatArray:
        """(n,) x with s(x) = `y` (n,), for a spline that ascends everywhere.

        Raises
        ------
        GeometryError
            If the values at the knots do not ascend, or `y` is not finite or outside the range of
            a spline that is not periodic.
        """
        y = np.atleast_1d(np.asarray(y, dtype=np.float64))
        start = self.taylor[:, 0]
        end = float(self.values(self.knots[-1:], 0, "left")[0, 0])
        if not np.all(np.diff(np.append(start, end)) > 0.0):
            raise GeometryError("the values at the knots do not ascend, so there is no inverse")
        turns = np.floor((y - start[0]) / self.rise) if self.periodic else np.zeros(len(y))
        y = y - turns * self.rise
        slack = EDGE * max(abs(float(start[0])), abs(end))
        if not np.all((y >= start[0] - slack) & (y <= end + slack)):
            raise GeometryError(
                f"a value is outside the range of the spline, {start[0]:g} to {end:g}"
            )
        piece = np.clip(np.searchsorted(start, y, "right") - 1, 0, len(start) - 1)
        rows = self.taylor[piece].copy()
        rows[:, 0] -= y
        t = _roots(rows, np.zeros(len(y)), np.ones(len(y)))
        left = self.knots[piece]
        return np.asarray(left + t * (self.knots[piece + 1] - left) + turns * self.period)

    def _reduced(self, x: FloatArray, side: Side) -> tuple[FloatArray, FloatArray]:
        """Whole periods in `x`, and the remainder."""
        first, last = float(self.knots[0]), float(self.knots[-1])
        if not np.all(np.isfinite(x)):
            raise GeometryError("the arguments of a spline must be finite numbers")
        if not self.periodic:
            slack = EDGE * max(abs(first), abs(last))
            outside = (x < first - slack) | (x > last + slack)
            if np.any(outside):
                wrong = float(x[np.argmax(outside)])
                raise GeometryError(
                    f"{wrong!r} is outside the spline; allowed: {first!r} to {last!r}",
                    value=repr(wrong),
                )
            return np.zeros(len(x)), x
        turns = np.floor((x - first) / self.period)
        if side == "left":
            # From the left the end of a period belongs to that period, from the right to the next
            # one.
            turns = np.ceil((x - first) / self.period) - 1.0
        return turns, x - turns * self.period

    def _piece(self, x: FloatArray, side: Side) -> IntArray:
        index = np.searchsorted(self.knots, x, side) - 1
        return np.asarray(np.clip(index, 0, len(self.knots) - 2))


def _taylor(rows: FloatArray, t: FloatArray, order: int) -> FloatArray:
    """(order + 1, n) values and derivatives at `t` (n,) of n polynomials with coefficients `rows`
    (6, n).

    Horner's scheme for all orders at once; it yields s^(k) / k!, multiplied by k! at the end.
    """
    derivatives = np.zeros((order + 1, len(t)))
    for row in rows[::-1]:
        # From the highest order down, as order k needs the value of order k - 1 from before this
        # step.
        for k in range(order, 0, -1):
            derivatives[k] *= t
            derivatives[k] += derivatives[k - 1]
        derivatives[0] *= t
        derivatives[0] += row
    for k in range(2, order + 1):
        derivatives[k] *= math.factorial(k)
    return derivatives


def _evaluate_rows(rows: FloatArray, t: FloatArray) -> FloatArray:
    """(n,) the value of each polynomial of `rows` (n, d + 1) at its own `t` (n,)."""
    return np.asarray(polyval(t, rows.T, tensor=False), np.float64)


def _derivative(rows: FloatArray, order: int) -> FloatArray:
    """(m, d + 1 - order) coefficients of the derivative of polynomials (m, d + 1)."""
    for _ in range(order):
        rows = rows[:, 1:] * np.arange(1.0, rows.shape[1])
    return rows


def _bernstein(rows: FloatArray) -> FloatArray:
    """(m, d + 1) Bernstein coefficients over [0, 1] of polynomials `rows` (m, d + 1)."""
    degree = rows.shape[1] - 1
    change = np.array(
        [
            [math.comb(j, k) / math.comb(degree, k) for k in range(degree + 1)]
            for j in range(degree + 1)
        ]
    )
    return np.asarray(rows @ change.T)


def _monotone_edges(rows: FloatArray) -> FloatArray:
    """(m, d + 1) ends in [0, 1], ascending, between which each polynomial (m, d + 1) is monotone.

    They are the roots of the derivative, which lie between those of the second derivative, and so
    on. If there are fewer than d - 1 of them, some ends are equal.
    """
    degree = rows.shape[1] - 1
    edges = np.tile(np.array([0.0, 1.0]), (len(rows), 1))
    for order in range(degree - 1, 0, -1):
        inner = _sign_changes(_derivative(rows, order), edges)
        edges = np.concatenate((edges[:, :1], inner, edges[:, -1:]), axis=1)
    return edges


def _sign_changes(rows: FloatArray, edges: FloatArray) -> FloatArray:
    """(m, k) the root of each polynomial in each of its k brackets; the left end of a bracket
    without a root.
    """
    count = edges.shape[1]
    at_edges = np.stack([_evaluate_rows(rows, edges[:, k]) for k in range(count)], axis=1)
    roots = edges[:, :-1].copy()
    row, cell = np.nonzero(at_edges[:, :-1] * np.sign(at_edges[:, 1:]) < 0.0)
    roots[row, cell] = _roots(rows[row], edges[row, cell], edges[row, cell + 1])
    return roots


def _roots(rows: FloatArray, low: FloatArray, high: FloatArray) -> FloatArray:
    """(n,) the root of each polynomial of `rows` (n, d + 1) in its bracket [low, high] in [0, 1].

    Newton's method where it stays inside, bisection elsewhere.
    """
    slope = _derivative(rows, 1)
    low, high = low.copy(), high.copy()
    # The sign of the slope between the ends of a bracket says which of them a value of either sign
    # replaces.
    rising = _evaluate_rows(rows, high) >= _evaluate_rows(rows, low)
    t = 0.5 * (low + high)
    active = np.arange(len(t))
    for step in range(MAX_STEPS):
        if not len(active):
            break
        here = t[active]
        value = _evaluate_rows(rows[active], here)
        above = (value > 0.0) == rising[active]
        high[active] = np.where(above, here, high[active])
        low[active] = np.where(above, low[active], here)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            newton = here - value / _evaluate_rows(slope[active], here)
        # Every third step is a bisection, so that slow convergence of Newton, at a double root,
        # ends too.
        inside = (newton >= low[active]) & (newton <= high[active]) & (step % 3 != 2)
        following = np.where(inside, newton, 0.5 * (low[active] + high[active]))
        following = np.where(value == 0.0, here, following)
        t[active] = following
        active = active[np.abs(following - here) > np.spacing(following)]
    return t


# -- spline energy --------------------------------------------------------------------------------
# The energy of a spline, the integral of s''' squared, and its minimisers, exact or smoothed.
#
# With t in [0, 1] and u(t) = s, integral of u''' squared = d0^2 + d1^2 + d2^2, the moments of u'''
# with the orthonormal Legendre polynomials. Integrated by parts they are, with the chord
# D = u(1) - u(0), p = u'(0), q = u'(1), A = u''(0), B = u''(1):
#     d0 = B - A,  d1 = sqrt(3) (A + B + 2 p - 2 q),  d2 = sqrt(5) (B - A - 6 p - 6 q + 12 D).
# With respect to x the integral is this sum divided by h^5.


ROOT_3, ROOT_5 = math.sqrt(3.0), math.sqrt(5.0)

MOMENTS: Final = np.array(
    [
        [0.0, 0.0, -1.0, 0.0, 0.0, 1.0],
        [0.0, 2.0 * ROOT_3, ROOT_3, 0.0, -2.0 * ROOT_3, ROOT_3],
        [-12.0 * ROOT_5, -6.0 * ROOT_5, -ROOT_5, 12.0 * ROOT_5, -6.0 * ROOT_5, ROOT_5],
    ]
)
"""(d0, d1, d2) from u, u', u'' at t = 0 and at t = 1."""

OF_CHORD: Final = np.array([0.0, 0.0, 12.0 * ROOT_5])
"""(d0, d1, d2) per unit of the chord D = u(1) - u(0)."""

SLOPES: Final = [1, 2, 4, 5]
"""Columns of MOMENTS that belong to u' and u'' at both ends."""

LONGEST: Final = 1e4
"""Largest cut-off length, as a multiple of the mean distance of points; rounding grows with its
cube, and eight digits are left there."""

SHORTEST: Final = 1e-4
"""Smallest cut-off length that is tried, as a multiple of the shortest distance; its spline nearly
interpolates."""

NEAR_ENOUGH: Final = 0.97
"""The search for a cut-off length ends at this fraction of the allowed deviation."""

MAX_SEARCH: Final = 40

HIGHEST: Final = 1e100
"""Largest magnitude of y: with it and the spans that `camgeo.numeric.checked` allows, no fifth
derivative overflows."""

TINY: Final = 1e-300


def node_scales(step: FloatArray, ring: bool) -> FloatArray:
    """(n,) the unit of length for the derivatives at each node: the length of its shorter piece."""
    if ring:
        return np.minimum(step, np.roll(step, 1))
    padded = np.concatenate((step[:1], step, step[-1:]))
    return np.minimum(padded[:-1], padded[1:])


def pieces(step: FloatArray, scale: FloatArray, ring: bool) -> tuple[FloatArray, IntArray]:
    """(m, 3, 6) matrices that give the moments of each piece from the scaled values at its two
    nodes; (m, 2) the numbers of these nodes.
    """
    count = len(scale)
    first = np.arange(len(step))
    ends = np.stack((first, (first + 1) % count if ring else first + 1), axis=1)
    # s, s' and s'' are in units of their node's length; the piece needs them in units of its own,
    # h^k / scale^k times them.
    powers = (step[:, np.newaxis] / scale[ends])[:, :, np.newaxis] ** np.arange(3.0)
    return MOMENTS * powers.reshape(-1, 1, 6), ends


def positions(count: int, ring: bool) -> IntArray:
    """(count,) the order of the members of a chain or ring in a banded matrix.

    A ring is folded, 0, count - 1, 1, count - 2, ...: neighbours are at most 2 apart.
    """
    number = np.arange(count)
    if not ring:
        return number
    return np.where(2 * number < count, 2 * number, 2 * (count - 1 - number) + 1)


def hermite(
    step: FloatArray, chord: FloatArray, starts: FloatArray, ends: FloatArray
) -> FloatArray:
    """(m, 6) Taylor coefficients of the quintics with these nodal values (m, 3)."""
    p, q = starts[:, 1] * step, ends[:, 1] * step
    a, b = starts[:, 2] * step**2, ends[:, 2] * step**2
    p_less, q_less = p - chord, q - chord  # a straight motion leaves no rounding behind
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


def interpolate(
    step: FloatArray, chord: FloatArray, nodes: FloatArray, fixed: BoolArray, ring: bool
) -> FloatArray:
    """(n, 3) nodal values with the least energy, by a banded Cholesky factorisation.

    `nodes` holds the prescribed ones.
    """
    from scipy.linalg import cho_solve_banded, cholesky_banded

    count = len(nodes)
    scale = node_scales(step, ring)
    moments, ends = pieces(step, scale, ring)
    # The moments see the positions only through the chord, which is exact where positions cancel.
    # The square of a row is the integral over its piece, which is the sum of squares divided by
    # h^5; in units of the shortest step, so that nothing overflows.
    rows = moments[:, :, SLOPES] * ((step / np.min(step)) ** -2.5)[:, np.newaxis, np.newaxis]
    shift = OF_CHORD * (chord * (step / np.min(step)) ** -2.5)[:, np.newaxis]
    # Rows of the matrix for the four unknowns of each piece: two derivatives at each of its two
    # nodes.
    place = 2 * positions(count, ring)[ends][:, :, np.newaxis] + np.arange(2)
    place = place.reshape(-1, 4)

    held = np.zeros(2 * count, dtype=np.bool_)
    node_rows = 2 * positions(count, ring)[:, np.newaxis] + np.arange(2)
    held[node_rows] = fixed[:, 1:]
    unknown = np.zeros(2 * count)
    unknown[node_rows] = nodes[:, 1:] * np.stack((scale, scale**2), axis=1)

    width = 5 if ring else 3
    # For each piece m the 4 by 4 matrix R^T R of its three moments k, for unknowns i and j.
    stiffness = np.einsum("mki,mkj->mij", rows, rows)
    diagonal = np.zeros(2 * count)
    np.add.at(diagonal, place, np.einsum("mii->mi", stiffness))
    # Scaled to a diagonal of ones, so that pieces of very unequal length keep their digits.
    balance = 1.0 / np.sqrt(diagonal)
    banded = np.zeros((width + 1, 2 * count))
    for i in range(4):
        for j in range(4):
            low, high = place[:, i], place[:, j]
            # Only the lower triangle is stored; rows and columns of prescribed values are left out
            # and become the identity.
            free = (low >= high) & ~held[low] & ~held[high]
            entry = stiffness[free, i, j] * balance[low[free]] * balance[high[free]]
            np.add.at(banded, (low[free] - high[free], high[free]), entry)
    banded[0, held] = 1.0
    factor = cholesky_banded(banded, lower=True)
    for _ in range(2):  # the second pass corrects the rounding of the first
        # The moments k of each piece m at the present solution; their gradient is the force that is
        # left.
        strain = np.einsum("mki,mi->mk", rows, unknown[place]) + shift
        force = np.zeros(2 * count)
        np.add.at(force, place, -np.einsum("mki,mk->mi", rows, strain))
        force[held] = 0.0
        unknown += balance * cho_solve_banded((factor, True), balance * force)

    solution = nodes.copy()
    free_slopes = unknown[node_rows] / np.stack((scale, scale**2), axis=1)
    solution[:, 1:] = np.where(fixed[:, 1:], nodes[:, 1:], free_slopes)
    return solution


class Smoothing:
    """The smoothing problem of one set of points, to be solved for any cut-off length.

    With lambda = length^6 / mean distance a wave sin(x / length) in evenly spaced data comes out
    with half its height, a longer wave with more (1 / (1 + (length * angular frequency)^6)).

    The moments of s''' are unknowns along with the nodal values: the matrix then has the condition
    of a least-squares problem instead of its square, and the moments are as exact as the values.
    """

    def __init__(self, step: FloatArray, nodes: FloatArray, fixed: BoolArray, ring: bool) -> None:
        self.step, self.nodes, self.fixed, self.ring = step, nodes, fixed, ring
        self.scale = node_scales(step, ring)
        self.mean = float(np.mean(step))
        self.moments, self.ends = pieces(step, self.scale, ring)
        members = 2 * len(step) if ring else 2 * len(step) + 1
        # Nodes and pieces alternate in the chain, each with three unknowns: y, s', s'' or d0, d1,
        # d2.
        place = 3 * positions(members, ring)[:, np.newaxis] + np.arange(3)
        self.size = 3 * members
        self.width = 8 if ring else 5
        self.of_node = place[0::2]
        self.of_piece = place[1::2]
        self.of_ends = self.of_node[self.ends].reshape(-1, 6)

    def solve(self, length: float) -> tuple[FloatArray, FloatArray]:
        """(n, 3) nodal values, and (m, 3) moments d0, d1, d2 of each piece."""
        from scipy.linalg import solve_banded

        unit = self.scale[:, np.newaxis] ** np.arange(3.0)
        # Square root of lambda / h^5 with lambda = length^6 / mean: the weight of a moment against
        # a deviation.
        weight = (length / self.mean) ** 3 * (self.mean / self.step) ** 2.5
        # If all pieces at a point have small weights, the equations of its s' and s'' have small
        # coefficients only and are scaled up.
        nearest = np.zeros(len(self.nodes))
        np.maximum.at(nearest, self.ends, weight[:, np.newaxis])
        balance = np.ones((len(self.nodes), 3))
        balance[:, 1:] = 1.0 / np.minimum(nearest, 1.0)[:, np.newaxis]
        rows = self.moments * weight[:, np.newaxis, np.newaxis]
        columns = rows * balance[self.ends].reshape(-1, 1, 6)
        width = self.width
        banded = np.zeros((2 * width + 1, self.size))
        right = np.zeros(self.size)
        # Equations of the moments: moment - weight * (matrix of the piece) * nodal values = 0.
        banded[width, self.of_piece] = 1.0
        for k in range(3):
            for j in range(6):
                # Band storage: row i, column j of the matrix is at [width + i - j, j].
                node, piece = self.of_ends[:, j], self.of_piece[:, k]
                banded[width + piece - node, node] = -rows[:, k, j]
                banded[width + node - piece, piece] = columns[:, k, j]
        banded[width, self.of_node[:, 0]] = 1.0  # from the sum of squares
        right[self.of_node[:, 0]] = self.nodes[:, 0]
        held = self.of_node[self.fixed]
        # The equation of a prescribed value becomes "unknown = value": its row is that of the
        # identity.
        for offset in range(-width, width + 1):
            column = held - offset
            inside = (column >= 0) & (column < self.size)
            banded[width + offset, column[inside]] = 1.0 if offset == 0 else 0.0
        right[held] = (self.nodes * unit)[self.fixed]
        solution = solve_banded(
            (width, width), banded, right, overwrite_ab=True, overwrite_b=True, check_finite=False
        )
        values = np.where(self.fixed, self.nodes, solution[self.of_node] / unit)
        return values, solution[self.of_piece] / weight[:, np.newaxis]

    def _deviating(self, length: float) -> tuple[tuple[FloatArray, FloatArray], float]:
        """The result of `solve` for a cut-off length, and its largest deviation from the points."""
        solution = self.solve(length)
        return solution, float(np.max(np.abs(solution[0][:, 0] - self.nodes[:, 0])))

    def longest_fit(self, largest_deviation: float) -> tuple[FloatArray, FloatArray]:
        """Nodal values and moments for the longest cut-off length found that keeps the deviation.

        As the largest deviation need not grow with the length, lengths are halved from the longest
        one down to the first that keeps the deviation; then follows false position, on logarithms,
        between this one and its predecessor.
        """
        allowed = checked.number("largest_deviation", largest_deviation, above=0.0, largest=HIGHEST)
        length, above = min(LONGEST * self.mean, float(np.sum(self.step))), 0.0
        while True:
            best, deviation = self._deviating(length)
            if deviation <= allowed:
                break
            high, above = length, deviation
            length *= 0.5
            if length < SHORTEST * float(np.min(self.step)):
                raise GeometryError(
                    f"no spline was found within {allowed:g} of all points; because of rounding the"
                    f" nearest one deviates by {above:g}; allowed: a larger deviation",
                    key="largest_deviation",
                    value=repr(allowed),
                )
        if not above:
            return best
        log_low, log_high = math.log(length), math.log(high)
        below = deviation
        for _ in range(MAX_SEARCH):
            if below >= NEAR_ENOUGH * allowed or log_high - log_low < 1e-4:
                break
            # The middle of the range of deviations in which the search ends.
            wanted = math.log(0.5 * (1.0 + NEAR_ENOUGH) * allowed)
            share = (wanted - math.log(max(below, TINY))) / (
                math.log(above) - math.log(max(below, TINY))
            )
            # Not too close to either end, so that the bracket shrinks from both sides.
            middle = log_low + min(max(share, 0.1), 0.9) * (log_high - log_low)
            candidate, deviation = self._deviating(math.exp(middle))
            if deviation <= allowed:
                best = candidate
                log_low, below = middle, deviation
            else:
                log_high, above = middle, deviation
        return best


def from_stress(step: FloatArray, starts: FloatArray, moments: FloatArray) -> FloatArray:
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
