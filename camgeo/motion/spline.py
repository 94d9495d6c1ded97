"""A piecewise polynomial of degree 5: the form of a motion given by points or by a table.

Built by `camgeo.motion.points`; only evaluated here, with numpy alone.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.polynomial.polynomial import polyval

from camgeo.errors import GeometryError
from camgeo.motion.motion import FULL_ORDER
from camgeo.numeric import checked
from camgeo.numeric.arrays import FloatArray, IntArray, Side
from camgeo.numeric.extremes import Extreme, Extremes, extremes_of
from camgeo.pickled import Pickled

DEGREE: Final = 5

MAX_STEPS: Final = 200
"""Every third step of the root search halves the bracket; 53 halvings of [0, 1] suffice."""

LARGEST: Final = 1e200
"""Largest magnitude of knots, coefficients and rise: above that of all points within limits."""

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
        out = _taylor(self.taylor[piece].T, (x - left) * rate, order)
        scale = np.ones_like(rate)
        for k in range(1, order + 1):
            scale = scale * rate
            out[k] *= scale
        out[0] += turns * self.rise
        return out

    def bounds(self, order: int) -> FloatArray:
        """(m,) upper bounds of the absolute value of the derivative of `order` in each piece.

        The largest Bernstein coefficient, by the convex hull property; exact for orders 4 and 5,
        otherwise the relative excess vanishes with the square of the piece's length.
        """
        local = np.max(np.abs(_bernstein(_derivative(self.taylor, order))), axis=1)
        bound: FloatArray = local / np.diff(self.knots) ** order
        return bound

    def cell_bounds(self, low: FloatArray, high: FloatArray) -> FloatArray:
        """(4, n) upper bounds of |s - s(middle)|, |s'|, |s''|, |s'''| over the cells [low, high].

        `low`, `high` (n,) as `values` takes them; no cell reaches across a knot. The Taylor series
        from the middle of the cell, which ends with the fifth derivative.
        """
        half = 0.5 * (high - low)
        middle = np.abs(self.values(0.5 * (low + high), DEGREE))
        out = np.zeros((FULL_ORDER + 1, len(half)))
        for k in range(FULL_ORDER + 1):
            for j in range(DEGREE, k - 1, -1):
                if j == k == 0:
                    continue
                out[k] += middle[j] * half ** (j - k) / math.factorial(j - k)
        return out

    def extremes(self, order: int) -> Extremes:
        """Smallest and largest derivative of `order` (0 to 5) over the domain, with their places.

        Exact but for rounding: all roots of the next derivative in each piece, each in a bracket,
        and both one-sided values at every knot. The place lies within the domain; of equal values
        the first counts.
        """
        pieces, places = self._turning_points(order)
        length = np.diff(self.knots)
        values = _each(_derivative(self.taylor, order)[pieces], places) / length[pieces] ** order
        return extremes_of(self._at(pieces, places), values)

    def beyond_knots(self) -> Extreme:
        """How far s goes, inside a piece, beyond both its values at the ends of the piece.

        The largest such distance, negative below them, and where it is; 0 where s stays between.
        Exact except for rounding.
        """
        pieces, places = self._turning_points(0)
        values = _each(self.taylor[pieces], places)
        ends = np.stack((self.taylor[:, 0], np.sum(self.taylor, axis=1)))
        above, below = (
            values - np.max(ends, axis=0)[pieces],
            values - np.min(ends, axis=0)[pieces],
        )
        beyond = np.where(above > 0.0, above, np.minimum(below, 0.0))
        most = int(np.argmax(np.abs(beyond)))
        return Extreme(float(beyond[most]), float(self._at(pieces, places)[most]))

    def _turning_points(self, order: int) -> tuple[IntArray, FloatArray]:
        """All (piece, t) at which the derivative of `order` may have an extremum, ends included."""
        rows = np.arange(len(self.taylor))
        piece = [rows, rows]
        place = [np.zeros(len(rows)), np.ones(len(rows))]
        if order < DEGREE:
            turning = _derivative(self.taylor, order + 1)
            hull = _bernstein(turning)
            bent = np.flatnonzero((np.min(hull, axis=1) <= 0.0) & (np.max(hull, axis=1) >= 0.0))
            edges = _monotone_edges(turning[bent])
            inner = _sign_changes(turning[bent], edges)
            place += [edges[:, 1:-1].ravel(), inner.ravel()]
            piece += [np.repeat(bent, edges.shape[1] - 2), np.repeat(bent, inner.shape[1])]
        return np.concatenate(piece), np.concatenate(place)

    def _at(self, pieces: IntArray, places: FloatArray) -> FloatArray:
        """x at t = `places` (n,) of `pieces` (n,), within the domain."""
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
            raise GeometryError(f"a value is outside the range {start[0]:g} to {end:g}")
        piece = np.clip(np.searchsorted(start, y, "right") - 1, 0, len(start) - 1)
        rows = self.taylor[piece].copy()
        rows[:, 0] -= y
        t = _roots(rows, np.zeros(len(y)), np.ones(len(y)))
        left = self.knots[piece]
        x: FloatArray = left + t * (self.knots[piece + 1] - left) + turns * self.period
        return x

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
            turns = np.ceil((x - first) / self.period) - 1.0
        return turns, x - turns * self.period

    def _piece(self, x: FloatArray, side: Side) -> IntArray:
        found = np.searchsorted(self.knots, x, side) - 1
        piece: IntArray = np.clip(found, 0, len(self.knots) - 2)
        return piece


def _taylor(rows: FloatArray, t: FloatArray, order: int) -> FloatArray:
    """(order + 1, n) a polynomial's value and derivatives at `t` (n,); `rows` (6, n) coefficients.

    Horner's scheme for all orders at once: it builds s^(k) / k!.
    """
    out = np.zeros((order + 1, len(t)))
    for row in rows[::-1]:
        for k in range(order, 0, -1):
            out[k] *= t
            out[k] += out[k - 1]
        out[0] *= t
        out[0] += row
    for k in range(2, order + 1):
        out[k] *= math.factorial(k)
    return out


def _each(rows: FloatArray, t: FloatArray) -> FloatArray:
    """Each polynomial of `rows` (n, d + 1) at its own `t` (n,)."""
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
    converted: FloatArray = rows @ change.T
    return converted


def _monotone_edges(rows: FloatArray) -> FloatArray:
    """(m, d + 1) ends in [0, 1], ascending, between which each polynomial (m, d + 1) is monotone.

    The roots of the derivative, found between those of the second derivative and so on. Where
    there are fewer than d - 1 some ends are equal.
    """
    degree = rows.shape[1] - 1
    edges = np.tile(np.array([0.0, 1.0]), (len(rows), 1))
    for order in range(degree - 1, 0, -1):
        inner = _sign_changes(_derivative(rows, order), edges)
        edges = np.concatenate((edges[:, :1], inner, edges[:, -1:]), axis=1)
    return edges


def _sign_changes(rows: FloatArray, edges: FloatArray) -> FloatArray:
    """(m, k) the root of each polynomial in each of its k brackets; without one the left end."""
    count = edges.shape[1]
    at_edges = np.stack([_each(rows, edges[:, k]) for k in range(count)], axis=1)
    found = edges[:, :-1].copy()
    row, cell = np.nonzero(at_edges[:, :-1] * np.sign(at_edges[:, 1:]) < 0.0)
    found[row, cell] = _roots(rows[row], edges[row, cell], edges[row, cell + 1])
    return found


def _roots(rows: FloatArray, low: FloatArray, high: FloatArray) -> FloatArray:
    """(n,) the root of each polynomial of `rows` (n, d + 1) in its bracket [low, high] in [0, 1].

    Newton's method where it stays inside, bisection elsewhere. `numeric.roots` knows a bracket by
    the argument alone; here each bracket has its own polynomial over the same [0, 1].
    """
    slope = _derivative(rows, 1)
    low, high = low.copy(), high.copy()
    rising = _each(rows, high) >= _each(rows, low)
    t = 0.5 * (low + high)
    active = np.arange(len(t))
    for step in range(MAX_STEPS):
        if not len(active):
            break
        here = t[active]
        value = _each(rows[active], here)
        above = (value > 0.0) == rising[active]
        high[active] = np.where(above, here, high[active])
        low[active] = np.where(above, low[active], here)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            newton = here - value / _each(slope[active], here)
        inside = (newton >= low[active]) & (newton <= high[active]) & (step % 3 != 2)
        following = np.where(inside, newton, 0.5 * (low[active] + high[active]))
        following = np.where(value == 0.0, here, following)
        t[active] = following
        active = active[np.abs(following - here) > np.spacing(following)]
    return t
