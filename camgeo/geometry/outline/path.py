"""Closed paths of stretches of parallels and of turns about a point, their radii and moments.

The outline of a real disc is one: the remaining stretches of a working curve, and between two of
them either a corner or, where the follower's velocity jumps, the arc of the roller turning about
its centre. So is each parallel of it: the path of a cutter, or that of the roller centre on the
real disc.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Final

import numpy as np

from camgeo.geometry.pitch_curve import WorkingCurve
from camgeo.kinematics.motion import turning_angles
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side, grouped, merged, phase
from camgeo.numeric.extremes import Extreme, Extremes, piecewise_extremes, sampled_extremes
from camgeo.numeric.quadrature import gauss
from camgeo.record import Brief
from camgeo.units import TURN


class Flank(StrEnum):
    """A flank by its name: the inner one bounds a disc, the outer one a hole."""

    INNER = "inner"
    OUTER = "outer"

    @property
    def sign(self) -> int:
        """Sign of the flank's distance from the pitch curve, and of the direction in which a roller
        is pressed against it.
        """
        return -1 if self is Flank.INNER else 1


@dataclass(frozen=True, slots=True)
class Stretch:
    """A stretch of a parallel of the pitch curve, traversed with growing cam angle.

    Attributes
    ----------
    curve : the parallel; regular inside the stretch.
    start, end : cam angles [rad], start in [0, 2 pi), start < end <= start + 2 pi. At `start` the
        right-hand values count, at `end` the left-hand ones.
    """

    curve: WorkingCurve
    start: float
    end: float

    @property
    def marks(self) -> FloatArray:
        """(m + 1,) cam angles [rad] from its start to its end, the curve smooth between them."""
        borders = np.concatenate((self.curve.borders, self.curve.borders + TURN))
        inside = borders[(borders > self.start) & (borders < self.end)]
        return np.concatenate(([self.start], inside, [self.end]))


@dataclass(frozen=True, slots=True)
class Pivot:
    """A turn of the normal about a point: centre + distance * n, n turning by `sweep`.

    With distance 0 it is a corner of the path; else an arc of the radius |distance|.

    Attributes
    ----------
    centre : [mm].
    distance : [mm], positive where the path lies on the outer side of the centre, as for a
        `WorkingCurve`.
    normal : n at the start, unit, outward.
    sweep : angle by which n turns [rad], counter-clockwise positive, in (-pi, pi).
    phi_start, phi_end : cam angles [rad] in [0, 2 pi] at its two ends: that at which the stretch
        before it ends, and that at which the one after it begins.
    """

    centre: complex
    distance: float
    normal: complex
    sweep: float
    phi_start: float
    phi_end: float

    @property
    def start(self) -> complex:
        """First point of the turn [mm]."""
        return self.centre + self.distance * self.normal

    @property
    def end(self) -> complex:
        """Last point of the turn [mm]."""
        return self.centre + self.distance * self.normal * cmath.exp(1j * self.sweep)


Element = Stretch | Pivot


@dataclass(frozen=True, slots=True)
class Path(Brief):
    """A closed path; each element begins where the one before it ends.

    Attributes
    ----------
    elements : in the order of traversal, with growing cam angle.
    """

    elements: tuple[Element, ...]

    @property
    def stretches(self) -> tuple[Stretch, ...]:
        """The stretches, in order."""
        return tuple(element for element in self.elements if isinstance(element, Stretch))

    @property
    def pivots(self) -> tuple[Pivot, ...]:
        """The corners and arcs between them, in order."""
        return tuple(element for element in self.elements if isinstance(element, Pivot))

    @property
    def is_whole(self) -> bool:
        """True if the path is one parallel all round, with nothing cut off."""
        return len(self.elements) == 1

    def offset(self, shift: float) -> Path:
        """The parallel at `shift` [mm] farther outward; corners become arcs.

        Nothing is trimmed: the caller must ensure that stretches stay regular and the path free of
        crossings.
        """
        return Path(tuple(_offset(element, shift) for element in self.elements))

    @property
    def encloses_axis(self) -> bool:
        """Whether the path, which must not pass through the cam axis, goes round it."""
        # By quadrature along stretches, in closed form along arcs; the sum is a multiple of a turn.
        turned = math.fsum(
            one.real
            for stretch in self.stretches
            for one, *_ in stretch_integrals(
                stretch, (_angle_integrand, _angle_integrand), NEAR_A_TURN
            )
        )
        turned += math.fsum(_turn_of_arc(pivot) for pivot in self.pivots if pivot.distance != 0.0)
        return round(turned / TURN) != 0

    def moments(self, tolerance: float) -> Moments:
        """Moments of the region inside.

        The path must be free of crossings; else each part counts as often as the path goes round
        it.

        Parameters
        ----------
        tolerance : a part of a stretch is halved until that changes its integrals by less than this
            share of the integrals of the magnitude over the stretch.

        Arcs about a pivot are in closed form.
        """
        parts = [Moments.of_pieces(*_arc_columns(self))]
        for stretch in self.stretches:
            sums = stretch_integrals(stretch, LOW_ORDER, tolerance)
            parts.append(
                Moments.total(Moments(one.real, other, *errors) for one, other, *errors in sums)
            )
        return Moments.total(parts)

    def second_moments(self, tolerance: float) -> SecondMoments:
        """Second moments of the region inside; parameters as for `moments`."""
        arcs = SecondMoments.of_pieces(*_arc_columns(self))
        sums = [
            row
            for stretch in self.stretches
            for row in stretch_integrals(stretch, SECOND_ORDER, tolerance)
        ]
        return SecondMoments(
            math.fsum([arcs.polar, *(one.real for one, *_ in sums)]),
            arcs.square + _sum(np.array([other for _, other, *_ in sums])),
            math.fsum([arcs.polar_error, *(row[2] for row in sums)]),
            math.fsum([arcs.square_error, *(row[3] for row in sums)]),
        )


def whole(curve: WorkingCurve) -> Path:
    """The path that is `curve` all round; its tangent must be continuous."""
    return Path((Stretch(curve, 0.0, TURN),))


def _offset(element: Element, shift: float) -> Element:
    """The parallel of an element at `shift` [mm] farther outward."""
    if isinstance(element, Stretch):
        curve = WorkingCurve(element.curve.pitch, element.curve.distance + shift)
        return replace(element, curve=curve)
    return replace(element, distance=element.distance + shift)


# -- radii ----------------------------------------------------------------------------------------
# Smallest and largest distance of a closed path from the cam axis, and whether it goes round it.
#
# On a parallel W = Z + d n of the pitch curve the derivative of |W|^2 is 2 Re(conj(W) W'), and W'
# has the direction t of the pitch curve, to which n is square: it vanishes where Re(conj(Z) t)
# does, for every d. The distance |Z| of a roller's centre is a function of the follower's position
# alone, so these are the turning points of the motion, and positions in which the follower is at a
# dead point.


NEAR_A_TURN: Final = 1e-3
"""Tolerance of the angle by which a path goes round, which is a multiple of a turn."""


def radii(path: Path) -> Extremes:
    """Smallest and largest distance from the cam axis [mm], each with the first cam angle [rad] at
    which it is reached.

    They are exact but for rounding where they are at an end of a stretch, a corner, a border or a
    turning point of the motion; those of any other kind are found as by `piecewise_extremes`.
    """
    element_radii = [
        _stretch_radii(element) if isinstance(element, Stretch) else _pivot_radii(element)
        for element in path.elements
    ]
    both = [extreme for pair in element_radii for extreme in (pair.lowest, pair.highest)]
    places = np.array([extreme.place % TURN for extreme in both])
    return sampled_extremes(places, np.array([extreme.value for extreme in both]))


def _angle_integrand(point: ComplexArray, way: ComplexArray) -> FloatArray:
    """Integrand of the angle about the origin: Im(dz / z)."""
    return np.asarray((way / point).imag)


def _turn_of_arc(pivot: Pivot) -> float:
    """Angle [rad] by which the arc turns about the cam axis, exact but for rounding.

    If the axis lies outside its circle it is less than half a turn. If it lies inside, it is the
    sweep plus the change, between the ends, of the lead of the direction from the axis over that
    from the centre; each lead is less than a quarter turn.
    """
    ends = np.array([pivot.start, pivot.end])
    if abs(pivot.centre) > abs(pivot.distance):
        return float(np.angle(ends[1] * ends[0].conj()))
    ahead = np.angle(ends / (ends - pivot.centre))
    return pivot.sweep + float(ahead[1] - ahead[0])


def _stretch_radii(stretch: Stretch) -> Extremes:
    """Smallest and largest distance of a stretch from the cam axis [mm]."""
    turning = turning_angles(stretch.curve.pitch.motion)
    turning = np.concatenate((turning, turning + TURN))
    inside = turning[(turning > stretch.start) & (turning < stretch.end)]

    def distance(phi: FloatArray, side: Side) -> FloatArray:
        return np.abs(stretch.curve.point(phi, side))

    return piecewise_extremes(distance, merged(np.concatenate((stretch.marks, inside))))


def _pivot_radii(pivot: Pivot) -> Extremes:
    """Distances of a corner, or of an arc: at its ends, and where it passes the line from the cam
    axis through its centre.
    """
    values = [abs(pivot.start), abs(pivot.end)]
    if pivot.distance != 0.0 and pivot.centre != 0.0:
        outward = pivot.centre / abs(pivot.centre)
        for normal in (outward, -outward):
            # Whether the normal turns past it: its angle from the start as a share of the sweep.
            if 0.0 <= phase(normal / pivot.normal) / pivot.sweep <= 1.0:
                values.append(abs(pivot.centre + pivot.distance * normal))
    return Extremes(Extreme(min(values), pivot.phi_end), Extreme(max(values), pivot.phi_end))


# -- moments --------------------------------------------------------------------------------------
# Area and moments of the region inside a path, by Green's theorem on its exact curves.
#
# With z = x + i y, and the boundary run counter-clockwise,
#
#     area = contour integral of Im(conj(z) dz) / 2,
#     integral of z dA = contour integral of |z|^2 dz / (2 i),
#     integral of |z|^2 dA = contour integral of |z|^2 Im(conj(z) dz) / 4,
#     integral of z^2 dA = contour integral of |z|^2 z dz / (2 i).
#
# They follow from the complex form of Green's theorem, contour integral of f dz = 2 i times the
# area integral of df/dconj(z), with f = conj(z), z conj(z), z conj(z)^2 / 2 and z^2 conj(z).


NODES: Final = 16
"""Nodes of the Gauss-Legendre rule on a part; the rule on both halves gives its error."""

MOST_PARTS: Final = 4096
"""Most parts of a stretch that are refined at a time: more are due to rounding, which halving does
not reduce. Their error then enters the estimate."""

HALVINGS: Final = 60
"""Most rounds of halving: a part is then as short as doubles resolve."""

FLAT: Final = 0.1
"""Sweep [rad] below which the series of `segment_areas` is exact to rounding."""

SHARE: Final = 1e-9
"""Tolerance of an area alone, as for `Path.moments`."""

WIDEST: Final = 0.5 * math.pi
"""Widest arc [rad] over which the rule is exact to rounding for second moments."""

ROUNDING: Final = 8.0 * float(np.finfo(np.float64).eps)
"""Tolerance of an integral, as a fraction of the integral of the magnitude."""


@dataclass(frozen=True, slots=True)
class Moments:
    """Area and first moments of a region.

    Attributes
    ----------
    area : [mm^2], positive if the boundary runs counter-clockwise.
    first : [mm^3], integral of z dA, with the sign of `area`; first / area is the centroid.
    area_error, first_error : estimates of the absolute errors [mm^2], [mm^3].
    """

    area: float
    first: complex
    area_error: float
    first_error: float

    def scaled(self, factor: float) -> Moments:
        """All values times `factor`, e.g. -1 for a hole, or the mass per unit of area."""
        size = abs(factor)
        return Moments(
            factor * self.area,
            factor * self.first,
            size * self.area_error,
            size * self.first_error,
        )

    def counter_clockwise(self) -> Moments:
        """The moments of the same region with a counter-clockwise boundary."""
        return self if self.area >= 0.0 else self.scaled(-1.0)

    @classmethod
    def total(cls, parts: Iterable[Moments]) -> Moments:
        """The sum of `parts`; their errors add up."""
        all_parts = tuple(parts)
        return cls(
            math.fsum(part.area for part in all_parts),
            complex(
                math.fsum(part.first.real for part in all_parts),
                math.fsum(part.first.imag for part in all_parts),
            ),
            math.fsum(part.area_error for part in all_parts),
            math.fsum(part.first_error for part in all_parts),
        )

    @classmethod
    def of_pieces(
        cls, start: ComplexArray, end: ComplexArray, sweep: FloatArray, centre: ComplexArray
    ) -> Moments:
        """The contributions of lines and arcs to the contour integrals, in closed form.

        Parameters
        ----------
        start, end : (n,) complex [mm].
        sweep : (n,) angle turned along each piece [rad], positive counter-clockwise; 0 is a line.
        centre : (n,) complex [mm] of each arc; unused for lines.

        The triangle of origin and chord has its centroid at a third of the sum of its corners. To
        that an arc adds the segment of the circle beyond its chord: with radius r and sweep a its
        area is r^2 (a - sin a) / 2, its first moment about the circle's centre 2/3 r^3 sin^3(a/2),
        in the direction of its middle (any table of sections, e.g. Bronshtein and Semendyayev,
        "Handbook of Mathematics", chapter on plane geometry, for the area and the distance of the
        centroid).
        """
        triangle = 0.5 * (np.conj(start) * end).imag
        of_triangle = triangle * (start + end) / 3.0
        arc = sweep != 0.0
        arm = np.where(arc, start - centre, 0.0)
        radius = np.abs(arm)
        segment = segment_areas(np.abs(end - start), radius, sweep)
        # The first moment 2/3 r^3 sin^3(a/2) points from the centre to the middle of the arc.
        towards = arm * radius * radius * np.exp(0.5j * sweep) * np.sin(0.5 * sweep) ** 3
        of_segment = np.where(arc, segment * centre, 0.0) + towards * (2.0 / 3.0)
        areas = np.concatenate((triangle, segment))
        firsts = np.concatenate((of_triangle, of_segment))
        return cls(
            math.fsum(areas),
            complex(math.fsum(firsts.real), math.fsum(firsts.imag)),
            ROUNDING * math.fsum(np.abs(areas)),
            ROUNDING * math.fsum(np.abs(firsts)),
        )

    @classmethod
    def of_quadratics(cls, pieces: ComplexArray) -> Moments:
        """Moments of the region inside closed quadratic curves (n, 3) [mm].

        They are exact but for rounding.
        """
        (area, of_area), (first, of_first) = _along_quadratics(pieces, LOW_ORDER)
        return cls(area.real, first, ROUNDING * of_area, ROUNDING * of_first)


def area(path: Path) -> float:
    """Signed area [mm^2] inside `path`, positive if it runs counter-clockwise; see `SHARE`."""
    return path.moments(SHARE).area


def _arc_columns(path: Path) -> tuple[ComplexArray, ComplexArray, FloatArray, ComplexArray]:
    """Starts and ends (n,) [mm], sweeps (n,) [rad] and centres (n,) [mm] of the arcs of a path."""
    pivots = [pivot for pivot in path.pivots if pivot.distance != 0.0]
    return (
        np.array([pivot.start for pivot in pivots], dtype=np.complex128),
        np.array([pivot.end for pivot in pivots], dtype=np.complex128),
        np.array([pivot.sweep for pivot in pivots], dtype=np.float64),
        np.array([pivot.centre for pivot in pivots], dtype=np.complex128),
    )


def segment_areas(chord: FloatArray, radius: FloatArray, sweep: FloatArray) -> FloatArray:
    """(n,) [mm^2] areas between arcs and their chords, with the signs of the sweeps (n,) [rad].

    r^2 (a - sin a) / 2, see `Moments.of_pieces`; of a flat arc, where this cancels and the circle
    is huge, the same over the square of its chord (n,) [mm], as a series.
    """
    square = sweep * sweep
    series = 1.0 + square * (1.0 / 30.0 + square * (1.0 / 840.0 + square / 25200.0))
    flat = chord * chord * sweep / 12.0 * series
    curved = 0.5 * radius**2 * (sweep - np.sin(sweep))
    return np.where(np.abs(sweep) < FLAT, flat, curved)


Integrand = Callable[[ComplexArray, ComplexArray], FloatArray | ComplexArray]
"""An integrand, as a function of points (n,) and their derivatives over the parameter (n,)."""


def _area_integrand(point: ComplexArray, way: ComplexArray) -> FloatArray:
    """Integrand of the area."""
    return np.asarray(0.5 * (np.conj(point) * way).imag)


def _first_integrand(point: ComplexArray, way: ComplexArray) -> ComplexArray:
    """Integrand of the first moment, the integral of z dA."""
    return -0.5j * (point * np.conj(point)).real * way


def _polar_integrand(point: ComplexArray, way: ComplexArray) -> FloatArray:
    """Integrand of the polar moment, the integral of |z|^2 dA."""
    return np.asarray(0.25 * (point * np.conj(point)).real * (np.conj(point) * way).imag)


def _square_integrand(point: ComplexArray, way: ComplexArray) -> ComplexArray:
    """Integrand of the integral of z^2 dA."""
    return _first_integrand(point, way) * point


LOW_ORDER: Final[tuple[Integrand, Integrand]] = (_area_integrand, _first_integrand)
SECOND_ORDER: Final[tuple[Integrand, Integrand]] = (_polar_integrand, _square_integrand)

Sums = tuple[complex, complex, float, float]
"""Two integrals, and the estimates of their errors."""


def stretch_integrals(
    stretch: Stretch, integrands: tuple[Integrand, Integrand], tolerance: float
) -> list[Sums]:
    """Two contour integrals along the stretch by quadrature, as the sums of each halving.

    Parts are halved as for `Path.moments`.
    """
    edges = merged(stretch.marks)
    low, high = edges[:-1], edges[1:]
    one, other, one_sizes, other_sizes = _gauss(stretch, integrands, low, high)
    one_scale, other_scale = float(np.sum(one_sizes)), float(np.sum(other_sizes))
    span = stretch.end - stretch.start
    sums: list[Sums] = [(0j, 0j, ROUNDING * one_scale, ROUNDING * other_scale)]
    for halving in range(HALVINGS):
        if not len(low):
            break
        middle = 0.5 * (low + high)
        lows, highs = np.concatenate((low, middle)), np.concatenate((middle, high))
        ones, others, *_ = _gauss(stretch, integrands, lows, highs)
        count = len(low)
        finer_one = ones[:count] + ones[count:]
        finer_other = others[:count] + others[count:]
        one_change, other_change = np.abs(finer_one - one), np.abs(finer_other - other)
        # Each part may have its share of the tolerance, by length.
        allowed = max(tolerance, ROUNDING) * (high - low) / span
        converged = (one_change <= allowed * one_scale) & (other_change <= allowed * other_scale)
        # More parts than that are due to rounding, and in the last round nothing is halved any
        # more: all parts count as they are.
        converged |= 2 * np.count_nonzero(~converged) > MOST_PARTS or halving == HALVINGS - 1
        sums.append(
            (
                _sum(finer_one[converged]),
                _sum(finer_other[converged]),
                math.fsum(one_change[converged]),
                math.fsum(other_change[converged]),
            )
        )
        left = np.concatenate((~converged, ~converged))
        low, high, one, other = lows[left], highs[left], ones[left], others[left]
    return sums


def _sum(values: FloatArray | ComplexArray) -> complex:
    """The sum of `values` (n,), rounded once."""
    return complex(math.fsum(values.real), math.fsum(values.imag))


def _gauss(
    stretch: Stretch, integrands: tuple[Integrand, Integrand], low: FloatArray, high: FloatArray
) -> tuple[FloatArray | ComplexArray, FloatArray | ComplexArray, FloatArray, FloatArray]:
    """Two integrals over [low, high] (m,), and those of their magnitudes."""
    phi, half, weights = gauss(low, high, NODES)
    point, tangent, pace = stretch.curve.traced(phi.ravel())
    one, other = (integrand(point, tangent * pace).reshape(phi.shape) for integrand in integrands)
    return (
        half * (one @ weights),
        half * (other @ weights),
        half * (np.abs(one) @ weights),
        half * (np.abs(other) @ weights),
    )


@dataclass(frozen=True, slots=True)
class SecondMoments:
    """Second moments of a region about the origin.

    Attributes
    ----------
    polar : [mm^4], integral of |z|^2 dA.
    square : [mm^4], integral of z^2 dA: that of x^2 - y^2, and twice that of x y.
    polar_error, square_error : estimates of the absolute errors [mm^4].
    """

    polar: float
    square: complex
    polar_error: float
    square_error: float

    def scaled(self, factor: float) -> SecondMoments:
        """All values times `factor`, e.g. -1 for a hole."""
        size = abs(factor)
        return SecondMoments(
            factor * self.polar,
            factor * self.square,
            size * self.polar_error,
            size * self.square_error,
        )

    def counter_clockwise(self) -> SecondMoments:
        """The moments of the same region with a counter-clockwise boundary."""
        return self if self.polar >= 0.0 else self.scaled(-1.0)

    @classmethod
    def of_pieces(
        cls, start: ComplexArray, end: ComplexArray, sweep: FloatArray, centre: ComplexArray
    ) -> SecondMoments:
        """The contributions of lines and arcs; parameters as for `Moments.of_pieces`.

        By quadrature, which is exact but for rounding: the integrand of a line is a cubic, that of
        an arc a sum of sines up to the fourth harmonic of its angle, over `WIDEST` at most.
        """
        counts = np.maximum(1, np.ceil(np.abs(sweep) / WIDEST)).astype(np.intp)
        piece, number = grouped(counts)
        share, half, weights = gauss(number / counts[piece], (number + 1) / counts[piece], NODES)
        # A column, to select for every node of the rule.
        index = piece[:, np.newaxis]
        arc, chord = sweep[index] != 0.0, (end - start)[index]
        arm = (start - centre)[index] * np.exp(1j * sweep[index] * share)
        point = np.where(arc, centre[index] + arm, start[index] + chord * share)
        way = np.where(arc, 1j * sweep[index] * arm, chord)
        polar, square = _polar_integrand(point, way), _square_integrand(point, way)
        return cls(
            math.fsum(half * (polar @ weights)),
            _sum(half * (square @ weights)),
            ROUNDING * math.fsum(half * (np.abs(polar) @ weights)),
            ROUNDING * math.fsum(half * (np.abs(square) @ weights)),
        )

    @classmethod
    def of_quadratics(cls, pieces: ComplexArray) -> SecondMoments:
        """Second moments of the region inside closed quadratic curves."""
        (polar, of_polar), (square, of_square) = _along_quadratics(pieces, SECOND_ORDER)
        return cls(polar.real, square, ROUNDING * of_polar, ROUNDING * of_square)


def _along_quadratics(
    pieces: ComplexArray, integrands: tuple[Integrand, Integrand]
) -> list[tuple[complex, float]]:
    """Contour integrals, each with that of its magnitude: by quadrature, which is exact for
    polynomials but for rounding.
    """
    count = len(pieces)
    t, half, weights = gauss(np.zeros(count), np.ones(count), NODES)
    start, middle, end = (pieces[:, k, np.newaxis] for k in range(3))
    point = (1.0 - t) ** 2 * start + 2.0 * t * (1.0 - t) * middle + t * t * end
    way = 2.0 * ((1.0 - t) * (middle - start) + t * (end - middle))
    integrals = []
    for integrand in integrands:
        values = integrand(point, way)
        integrals.append(
            (_sum(half * (values @ weights)), math.fsum(half * (np.abs(values) @ weights)))
        )
    return integrals
