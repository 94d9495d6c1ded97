"""A closed contour of cubic splines and arcs: the form for CAD programs that accept curves."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from itertools import chain, pairwise
from typing import Self

import numpy as np

from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour, is_straight
from camgeo.geometry.outline.path import segment_areas
from camgeo.numeric.arrays import ComplexArray, FloatArray, IntArray, grouped
from camgeo.numeric.checked import CheckedFields, Complexes, Floats
from camgeo.units import counted

# -- bezier ---------------------------------------------------------------------------------------
# Cubic Bezier pieces: B-splines split into them, cut, measured and bounded.
#
# A piece is a row of four complex control points [mm]; (n, 4) is n pieces.


CUBIC = 3

MOMENTS = (
    (0, 1, 0.3), (0, 2, 0.15), (0, 3, 0.05), (1, 2, 0.15), (1, 3, 0.15), (2, 3, 0.3),
)  # fmt: skip
"""Half the integral of x dy - y dx of a piece: weights of the products b_i x b_j."""

GAUSS = 16
"""Nodes of Gauss's quadrature of the length of a quarter of a piece."""


def beziers_of_spline(degree: int, knots: FloatArray, controls: ComplexArray) -> ComplexArray:
    """(n, 4) the pieces of a B-spline that is not rational, in order.

    Each piece is the blossom of the spline at the two ends of its span. Knots may be multiple, and
    the ends need not be clamped.

    Parameters
    ----------
    degree : 1, 2 or 3.
    knots : (m + degree + 1,) ascending.
    controls : (m,) complex [mm].

    Raises
    ------
    GeometryError
        If the degree is another, the numbers do not match or no span is left.
    """
    if not 1 <= degree <= CUBIC:
        raise GeometryError(f"the spline has degree {degree}; degrees 1 to 3 are supported")
    count = len(controls)
    if count <= degree or len(knots) != count + degree + 1:
        raise GeometryError(
            f"the spline of degree {degree} has {counted(count, 'control point')} and"
            f" {counted(len(knots), 'knot')}; it needs at least"
            f" {counted(degree + 1, 'control point')}, and {counted(degree + 1, 'knot')} more than"
            " control points"
        )
    if np.any(np.diff(knots) < 0.0):
        raise GeometryError("the knots of a spline do not ascend")
    inside = np.arange(degree, count)
    spans = inside[knots[inside + 1] > knots[inside]]
    if not len(spans):
        raise GeometryError("the spline has no span: all its knots are equal")
    low, high = knots[spans], knots[spans + 1]
    points = np.empty((len(spans), degree + 1), dtype=np.complex128)
    for upper in range(degree + 1):  # this many arguments are the upper end of the span
        rows = [controls[spans - degree + k] for k in range(degree + 1)]
        for level in range(1, degree + 1):
            place = high if level <= upper else low
            rows = [
                _blend(rows[k - 1], rows[k], place, knots, spans - degree + k, degree + 1 - level)
                for k in range(level, degree + 1)
            ]
            # Padded, so that index k remains that of the control point.
            rows = [*([rows[0]] * level), *rows]
        points[:, upper] = rows[-1]
    return elevated(points)


def _blend(
    left: ComplexArray,
    right: ComplexArray,
    place: FloatArray,
    knots: FloatArray,
    index: IntArray,
    width: int,
) -> ComplexArray:
    """One step of de Boor's scheme: two neighbouring blossom values combined at `place` (n,)."""
    share = (place - knots[index]) / (knots[index + width] - knots[index])
    return left + share * (right - left)


def elevated(points: ComplexArray) -> ComplexArray:
    """Pieces of degree 1 or 2 as cubics; the curve stays the same."""
    while points.shape[1] < CUBIC + 1:
        degree = points.shape[1]
        inner = np.arange(1, degree) / degree
        middle = inner * points[:, :-1] + (1.0 - inner) * points[:, 1:]
        points = np.column_stack((points[:, 0], middle, points[:, -1]))
    return points


def cut(pieces: ComplexArray, counts: IntArray) -> ComplexArray:
    """(sum of counts, 4): each of the `pieces` (n, 4) in `counts` (n,) equal parts, in order."""
    index, step = grouped(counts)
    low = (step / counts[index])[:, None]
    high = ((step + 1) / counts[index])[:, None]
    b = pieces[index]
    # Blossoms: one of the three arguments, then two, then all.
    at_low = b[:, :-1] + low * (b[:, 1:] - b[:, :-1])
    at_high = b[:, :-1] + high * (b[:, 1:] - b[:, :-1])
    low_low = at_low[:, :-1] + low * (at_low[:, 1:] - at_low[:, :-1])
    high_high = at_high[:, :-1] + high * (at_high[:, 1:] - at_high[:, :-1])
    low_high = at_low[:, :-1] + high * (at_low[:, 1:] - at_low[:, :-1])
    parts = np.empty((len(index), 4), dtype=np.complex128)
    parts[:, :1] = low_low[:, :1] + low * (low_low[:, 1:] - low_low[:, :1])
    parts[:, 1:2] = low_low[:, :1] + high * (low_low[:, 1:] - low_low[:, :1])
    parts[:, 2:3] = low_high[:, :1] + high * (low_high[:, 1:] - low_high[:, :1])
    parts[:, 3:4] = high_high[:, :1] + high * (high_high[:, 1:] - high_high[:, :1])
    parts[step == 0, 0] = b[step == 0, 0]
    last = step == counts[index] - 1
    parts[last, 3] = b[last, 3]
    return parts


def bezier_points(pieces: ComplexArray, t: FloatArray) -> ComplexArray:
    """(n, k) complex [mm] points of the `pieces` (n, 4) at `t` (k,) in [0, 1]."""
    w = 1.0 - t
    powers = np.stack((w**3, 3.0 * w * w * t, 3.0 * w * t * t, t**3))
    return np.asarray(pieces @ powers)


def area(pieces: ComplexArray) -> float:
    """Half the integral of x dy - y dx along the `pieces` (n, 4) [mm^2], exact but for rounding."""
    total = np.zeros(len(pieces))
    for one, other, weight in MOMENTS:
        total += weight * (np.conj(pieces[:, one]) * pieces[:, other]).imag
    return math.fsum(total)


def length(pieces: ComplexArray) -> float:
    """Length of the `pieces` (n, 4) [mm]."""
    if not len(pieces):
        return 0.0
    quarters = cut(pieces, np.full(len(pieces), 4, dtype=np.intp))
    sides = 3.0 * np.diff(quarters, axis=1)
    nodes, weights = np.polynomial.legendre.leggauss(GAUSS)  # numpy loads it on first use
    t = 0.5 + 0.5 * nodes
    w = 1.0 - t
    speeds = np.abs(sides @ np.stack((w * w, 2.0 * w * t, t * t)))
    return math.fsum(0.5 * (speeds @ weights))


# -- spline ---------------------------------------------------------------------------------------


DEGREE = CUBIC


@dataclass(frozen=True, slots=True, eq=False)
class CubicSpline(CheckedFields):
    """A cubic B-spline in the plane, clamped at both ends, not rational.

    Attributes
    ----------
    knots : (m + 4,) ascending, the first four and the last four equal. Simple knots between make
        the curve C2, as in every fit; imported splines may have double and triple ones.
    controls : (m,) complex [mm], m >= 4.
    """

    knots: Floats
    controls: Complexes

    @classmethod
    def from_bspline(cls, degree: int, knots: FloatArray, controls: ComplexArray) -> Self:
        """The same curve as a B-spline of degree 1 to 3, clamped or not.

        One that is already clamped and cubic keeps its knots.

        Raises
        ------
        GeometryError
            If it is not such a spline.
        """
        pieces = beziers_of_spline(degree, knots, controls)
        ends = (knots[0] == knots[DEGREE], knots[-1] == knots[-1 - DEGREE])
        if degree == DEGREE and all(ends):
            return cls(knots, controls)
        # Triple knots: the control points are the Bezier points, neighbouring pieces sharing one.
        inner = np.concatenate((pieces[:, :3].ravel(), pieces[-1:, 3]))
        places = np.arange(len(pieces) + 1.0)
        return cls(np.concatenate(([0.0], np.repeat(places, 3), places[-1:])), inner)

    def __len__(self) -> int:
        """Number of cubic pieces."""
        return int(np.count_nonzero(np.diff(self.knots)))

    @property
    def start(self) -> complex:
        """First point of the curve [mm]."""
        return complex(self.controls[0])

    @property
    def end(self) -> complex:
        """Last point of the curve [mm]."""
        return complex(self.controls[-1])

    @property
    def beziers(self) -> ComplexArray:
        """(n, 4) complex [mm]: its cubic pieces, in order, by their Bezier points."""
        return beziers_of_spline(DEGREE, self.knots, self.controls)

    @property
    def length(self) -> float:
        """Its length [mm]."""
        return length(self.beziers)

    @property
    def moment(self) -> float:
        """Half the integral of x dy - y dx along it [mm^2]: its share in the area."""
        return area(self.beziers)

    def reversed(self) -> Self:
        """The same curve in the opposite direction."""
        return type(self)(self.knots[0] + (self.knots[-1] - self.knots[::-1]), self.controls[::-1])

    def divided(self, knot: float) -> tuple[Self, Self]:
        """The same curve in two parts that meet at a knot between its ends, inserted by Boehm."""
        knots, controls = self.knots, self.controls
        # A knot as often as the degree makes the curve pass through a control point there.
        while (count := int(np.count_nonzero(knots == knot))) < DEGREE:
            last = int(np.searchsorted(knots, knot, "right")) - 1
            moved = np.arange(last - DEGREE + 1, last - count + 1)
            share = (knot - knots[moved]) / (knots[moved + DEGREE] - knots[moved])
            new = controls[moved - 1] + share * (controls[moved] - controls[moved - 1])
            controls = np.concatenate((controls[: moved[0]], new, controls[moved[-1] :]))
            knots = np.insert(knots, last + 1, knot)
        first = int(np.searchsorted(knots, knot))
        return (
            type(self)(np.append(knots[: first + DEGREE], knot), controls[:first]),
            type(self)(np.insert(knots[first:], 0, knot), controls[first - 1 :]),
        )

    def with_ends(self, start: complex, end: complex) -> Self:
        """The same curve with its ends moved to `start` and `end` [mm]."""
        controls = np.concatenate(([start], self.controls[1:-1], [end]))
        return type(self)(self.knots, controls)


@dataclass(frozen=True, slots=True)
class Arc:
    """One arc or line of a spline contour.

    Attributes
    ----------
    start, end : complex [mm].
    sweep : angle turned [rad], positive counter-clockwise; 0 is a line.
    centre : complex [mm]; 0 for a line.
    """

    start: complex
    end: complex
    sweep: float
    centre: complex

    def __len__(self) -> int:
        """One piece."""
        return 1

    @property
    def radius(self) -> float:
        """Radius [mm]; 0 for a line."""
        return abs(self.start - self.centre) if self.sweep else 0.0

    @property
    def length(self) -> float:
        """Its length [mm]."""
        return abs(self.sweep) * self.radius if self.sweep else abs(self.end - self.start)

    @property
    def moment(self) -> float:
        """Half the integral of x dy - y dx along it [mm^2]: its share in the area."""
        chord = 0.5 * (self.start.conjugate() * self.end).imag
        if not self.sweep:
            return chord
        # The segment between arc and chord, from the function for many of them.
        of_one = np.array([[abs(self.end - self.start)], [self.radius], [self.sweep]])
        return chord + float(segment_areas(*of_one)[0])

    def reversed(self) -> Self:
        """The same strand in the opposite direction."""
        return type(self)(self.end, self.start, -self.sweep, self.centre)

    def heading(self, point: complex) -> complex:
        """Direction of the strand at `point`, one of its ends; a vector of any length."""
        if not self.sweep:
            return self.end - self.start
        return (point - self.centre) * (1j if self.sweep > 0.0 else -1j)

    def points_by_share(self, shares: FloatArray) -> ComplexArray:
        """(n,) complex [mm] points at `shares` (n,) of its length."""
        if not self.sweep:
            return self.start + (self.end - self.start) * shares.astype(np.complex128)
        turned: ComplexArray = np.exp(1j * self.sweep * shares)
        return self.centre + (self.start - self.centre) * turned

    def with_ends(self, start: complex, end: complex) -> Self:
        """The same turn between `start` and `end` [mm]; the centre follows."""
        if abs(self.sweep) == 2.0 * math.pi:
            return type(self)(start, end, self.sweep, self.centre)
        if is_straight(start, end, self.sweep):
            return type(self)(start, end, 0.0, 0j)
        # Half a chord times cot(sweep/2) left of the chord's middle; the pole of tan gives zero.
        cot = math.cos(0.5 * self.sweep) / math.sin(0.5 * self.sweep)
        centre = 0.5 * (start + end) + 0.5j * (end - start) * cot
        return type(self)(start, end, self.sweep, centre)

    def split(self, max_sweep: float) -> tuple[Self, ...]:
        """The same in equal parts of at most `max_sweep` [rad] each."""
        count = max(1, math.ceil(abs(self.sweep) / max_sweep - 1e-12))
        arm, part = self.start - self.centre, self.sweep / count
        inner = (self.centre + arm * cmath.exp(1j * part * (k + 1)) for k in range(count - 1))
        ends = (self.start, *inner, self.end)
        return tuple(type(self)(a, b, part, self.centre) for a, b in pairwise(ends))


@dataclass(frozen=True, slots=True)
class SplineContour:
    """Closed chain of cubic splines and arcs, each beginning exactly where the previous one ended.

    Attributes
    ----------
    strands : in order; the last ends where the first begins.
    """

    strands: tuple[CubicSpline | Arc, ...]

    def __len__(self) -> int:
        """Number of pieces: cubics, arcs and lines."""
        return sum(len(strand) for strand in self.strands)

    def split(self, max_sweep: float) -> Self:
        """The same with each arc in equal parts of at most `max_sweep` [rad]."""
        parts = (
            strand.split(max_sweep) if isinstance(strand, Arc) else (strand,)
            for strand in self.strands
        )
        return type(self)(tuple(chain.from_iterable(parts)))

    @property
    def pieces(self) -> list[Arc | ComplexArray]:
        """Arcs and lines, and (4,) complex [mm] Bezier points of each cubic, in order."""
        all_pieces: list[Arc | ComplexArray] = []
        for strand in self.strands:
            all_pieces += [strand] if isinstance(strand, Arc) else list(strand.beziers)
        return all_pieces

    @property
    def splines(self) -> tuple[CubicSpline, ...]:
        """The splines among the strands."""
        return tuple(strand for strand in self.strands if isinstance(strand, CubicSpline))

    @property
    def arcs(self) -> tuple[Arc, ...]:
        """The arcs and lines among the strands."""
        return tuple(strand for strand in self.strands if isinstance(strand, Arc))

    @property
    def area(self) -> float:
        """Enclosed area [mm^2], positive if the contour runs counter-clockwise."""
        return math.fsum(strand.moment for strand in self.strands)

    @property
    def length(self) -> float:
        """Length of the whole contour [mm]."""
        return math.fsum(strand.length for strand in self.strands)

    @property
    def reach(self) -> float:
        """Bound of the distance of its points from the cam axis [mm]."""
        reaches = [
            float(np.max(np.abs(strand.controls)))
            if isinstance(strand, CubicSpline)
            else max(abs(strand.start), abs(strand.end), abs(strand.centre) + strand.radius)
            for strand in self.strands
        ]
        return max(reaches)

    def reversed(self) -> Self:
        """The same outline in the opposite direction."""
        return type(self)(tuple(strand.reversed() for strand in self.strands[::-1]))

    def counter_clockwise(self) -> Self:
        """The same outline, counter-clockwise."""
        return self if self.area >= 0.0 else self.reversed()


@dataclass(frozen=True, slots=True)
class SplineFit:
    """A spline contour and its proof; otherwise as `camgeo.geometry.contour.contour.Fit`."""

    contour: SplineContour
    deviation: float
    tolerance: float


def as_spline_contour(contour: Contour) -> SplineContour:
    """The lines and arcs of a contour, each a strand."""
    pieces = zip(
        contour.vertices.tolist(),
        contour.ends.tolist(),
        contour.sweeps.tolist(),
        contour.centres.tolist(),
        strict=True,
    )
    return SplineContour(tuple(Arc(*piece) for piece in pieces))


# -- hermite --------------------------------------------------------------------------------------
# Cubics between places where a function and its slope are known: their overshoot, and a monotone
# table of them.


def highest(
    start: FloatArray, end: FloatArray, slope: FloatArray, end_slope: FloatArray
) -> FloatArray:
    """Largest magnitude inside [0, 1] of Hermite cubics with these values and slopes at 0 and 1.

    All arrays have one shape, and so has the result; 0 where a cubic has no extreme inside.
    """
    growth = end - start
    square = 3.0 * growth - 2.0 * slope - end_slope
    cube = slope + end_slope - 2.0 * growth
    # Extremes: slope + 2 square t + 3 cube t^2 = 0, in the form in which nothing cancels.
    radicand = square * square - 3.0 * cube * slope
    half = -(square + np.copysign(np.sqrt(np.maximum(radicand, 0.0)), square))
    largest: FloatArray = np.zeros_like(growth)
    with np.errstate(divide="ignore", invalid="ignore"):
        for t in (slope / half, half / (3.0 * cube)):
            value = np.abs(start + t * (slope + t * (square + t * cube)))
            inside = (t > 0.0) & (t < 1.0) & (radicand > 0.0)
            largest = np.where(inside, np.maximum(largest, value), largest)
    return largest
