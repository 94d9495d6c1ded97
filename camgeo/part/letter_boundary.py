"""Outlines of letters as boundaries: closed chains of quadratic Bezier curves and lines."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np

from camgeo.contour.bezier import elevated
from camgeo.contour.contour import Contour, Effort, Fit
from camgeo.contour.counts import too_many
from camgeo.contour.cubics.lines_and_arcs import approximating_arcs
from camgeo.contour.exact import MAX_CHORDS, distance_between
from camgeo.contour.hausdorff import ROUNDING
from camgeo.contour.proof.deviation import ENOUGH
from camgeo.contour.simple import crossing, winding_number
from camgeo.contour.spline import Arc, CubicSpline, SplineContour, SplineFit
from camgeo.errors import GeometryError, ToleranceError
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, frozen, grouped
from camgeo.numeric.checked import array, instance, positive
from camgeo.numeric.quadrature import gauss
from camgeo.outline.moments import (
    LOW_ORDER,
    NODES,
    SECOND_ORDER,
    Integrand,
    Moments,
    SecondMoments,
)
from camgeo.outline.moments import ROUNDING as SUMMED
from camgeo.part.boundaries import once
from camgeo.pickled import Pickled

ARCS: Final = "unchecked arcs"
"""Key of fits that may cross themselves."""

CLAMPED: Final = np.repeat((0.0, 1.0), 4)
"""Knots of a spline of one cubic."""

SHARPNESS: Final = 0.005
"""Largest share of a measured distance that is due to the arcs by which it is measured."""

FIRST: Final = 2.5e-4
"""Tolerance of these arcs to begin with, as a share of the coarsest one of fits."""

FINEST: Final = 1e-10
"""How near to the outline these arcs come at most, as a share of its distance from the cam axis,
and no nearer than a proof needs."""

FOREIGN: Final = 1e-5
"""Tolerance of the arcs by which splines of others are measured, as a share of the coarsest one."""

CLOSE: Final = 1e-3
"""Distance of the points of two outlines, as a share of their size, up to which they are taken to
have been written as one and the same; beyond it they are compared as curves."""


@dataclass(frozen=True, slots=True, eq=False)
class LetterBoundary(Pickled):
    """A closed outline of a letter as a boundary, see `camgeo.part.part.Boundary`.

    Attributes
    ----------
    pieces : (n, 3) complex [mm], the Bezier points of quadratic curves, end to end; of a line the
        middle one lies halfway. Counter-clockwise once made.
    coarsest : tolerance [mm] beyond which fits become no coarser, so that the narrow strokes of a
        letter, and letters side by side, stay apart.
    known : the fits already made, by form and tolerance, and the deviations already found.
    """

    name: str
    hole: bool
    pieces: ComplexArray
    coarsest: float
    known: dict[Any, Any] = field(default_factory=dict, init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        instance("part", self.name, str, "the name of a boundary")
        instance("part", self.hole, bool, "true or false")
        positive("part", self.coarsest, "mm")
        pieces = np.asarray(self.pieces, dtype=np.complex128)
        array("part", np.abs(pieces), 2)
        closed = pieces.shape[1:] == (3,) and np.array_equal(
            pieces[:, 2], np.roll(pieces[:, 0], -1)
        )
        if not closed:
            raise GeometryError(
                "must be quadratic curves, end to end and closed", "part", self.name
            )
        if _integrals(pieces, LOW_ORDER)[0][0].real < 0.0:
            pieces = pieces[::-1, ::-1]
        object.__setattr__(self, "pieces", frozen(pieces, np.complex128))

    @property
    def curve(self) -> SplineContour:
        """The same outline: each quadratic curve as a cubic, which has the same points."""
        if "curve" not in self.known:
            cubics = elevated(self.pieces)
            self.known["curve"] = SplineContour(
                tuple(
                    Arc(complex(cubic[0]), complex(cubic[3]), 0.0, 0j)
                    if straight
                    else CubicSpline(CLAMPED, cubic)
                    for cubic, straight in zip(cubics, self._straight, strict=True)
                )
            )
        known: SplineContour = self.known["curve"]
        return known

    @property
    def _straight(self) -> BoolArray:
        start, middle, end = self.pieces.T
        straight: BoolArray = middle == 0.5 * (start + end)
        return straight

    def arcs(self, tolerance: float, effort: Effort = "fewest") -> Fit:
        """Lines and arcs with their ends on the outline, the same at either effort."""
        return self._fit("arcs", tolerance)

    def beside(self, tolerance: float) -> Fit:
        """Like `arcs`."""
        return self._arcs(tolerance)

    def polyline(self, tolerance: float, effort: Effort = "fewest") -> Fit:
        """Straight pieces with vertices on the outline, the same at either effort."""
        return self._fit("polyline", tolerance)

    def sampled(self, tolerance: float) -> Contour:
        """The same straight pieces."""
        return self.polyline(tolerance).contour

    def spline(self, tolerance: float, effort: Effort = "fewest") -> SplineFit:
        """The outline itself."""
        self._fit("arcs", tolerance)  # which shows that it does not cross itself
        return SplineFit(self.curve, 0.0, tolerance)

    def _fit(self, form: str, tolerance: float) -> Fit:
        """A fit; GeometryError if it crosses itself, ToleranceError if rounding forbids it."""
        if (form, tolerance) not in self.known:
            found = self._arcs(tolerance) if form == "arcs" else self._chords(tolerance)
            if crossing(found.contour) is not None:
                raise GeometryError(f"the {self.name} crosses itself", key="part", value=self.name)
            if found.deviation > tolerance:
                message = f"coordinates round too much for the {self.name}"
                raise ToleranceError(message, tolerance, found.deviation)
            self.known[form, tolerance] = found
        known: Fit = self.known[form, tolerance]
        return known

    def _arcs(self, tolerance: float) -> Fit:
        if (ARCS, tolerance) not in self.known:
            found = approximating_arcs(self.curve, min(tolerance, self.coarsest))
            self.known[ARCS, tolerance] = Fit(found.contour, found.apart, tolerance)
        known: Fit = self.known[ARCS, tolerance]
        return known

    def _chords(self, tolerance: float) -> Fit:
        """A quadratic curve leaves the chord of 1/n of it by at most 1/(4 n^2) of the distance
        between its middle point and that of its chord, and at the same share of both.
        """
        start, middle, end = self.pieces.T
        bend = 0.25 * np.abs(start - 2.0 * middle + end)
        aim = min(tolerance, self.coarsest)
        counts = np.maximum(1.0, np.ceil(np.sqrt(bend / aim)))
        if np.sum(counts) > MAX_CHORDS:
            raise too_many(MAX_CHORDS, "straight pieces", tolerance)
        index, number = grouped(counts.astype(np.intp))
        t = number / counts[index]
        vertices = _at(self.pieces[index], t)
        rounding = 2.0 * ROUNDING * float(np.max(np.abs(self.pieces)))
        return Fit(
            Contour.polygon(np.where(number == 0, start[index], vertices)),
            float(np.max(bend / counts**2)) + rounding,
            tolerance,
        )

    def deviation(self, contour: Contour | SplineContour) -> float:
        """Proved bound [mm], by the arcs of both; of the same curves by their control points."""
        return once(self.known, contour, lambda: self._deviation(contour))

    def _deviation(self, contour: Contour | SplineContour) -> float:
        if isinstance(contour, SplineContour):
            apart = _between_points(self.curve, contour.counter_clockwise())
            if apart <= CLOSE * self.curve.length:
                return apart + 2.0 * ROUNDING * self.curve.reach
            by_arcs = approximating_arcs(contour, FOREIGN * self.coarsest)
            return self._deviation(by_arcs.contour) + by_arcs.apart
        share, finest = FIRST * self.coarsest, max(FINEST * self.curve.reach, ENOUGH)
        while True:
            fine = self._arcs(share)
            reached = distance_between(fine.contour, contour)
            if fine.deviation <= SHARPNESS * reached or share <= finest:
                return reached + fine.deviation
            share = max(finest, min(0.1 * share, SHARPNESS * reached))

    def offset(self, distance: float) -> LetterBoundary:
        """GeometryError: strokes are narrower than most cutters, and their corners are sharp."""
        raise GeometryError(f"no cutter runs along the {self.name}", key="part", value=self.name)

    @property
    def corner_radius(self) -> None:
        """See `camgeo.part.part.Boundary`: there are no parallels."""
        return None

    def inset(self, distance: float, name: str) -> LetterBoundary:
        """GeometryError: letters have corners, along which there is no smooth parallel."""
        raise GeometryError(f"there is no chamfer along the {self.name}", key="part", value=name)

    def moments(self, tolerance: float) -> Moments:
        """Exact but for rounding, see `camgeo.part.part.Boundary`."""
        (area, of_area), (first, of_first) = _integrals(self.pieces, LOW_ORDER)
        return Moments(area.real, first, SUMMED * of_area, SUMMED * of_first)

    def second_moments(self, tolerance: float) -> SecondMoments:
        """Exact but for rounding, see `camgeo.part.part.Boundary`."""
        (polar, of_polar), (square, of_square) = _integrals(self.pieces, SECOND_ORDER)
        return SecondMoments(polar.real, square, SUMMED * of_polar, SUMMED * of_square)

    def farthest(self) -> tuple[float, float | None]:
        """See `camgeo.part.part.Boundary`; no cam angle belongs to a point of it."""
        return max(self._radii()), None

    def nearest(self) -> float:
        """See `camgeo.part.part.Boundary`."""
        around = winding_number(self._arcs(self.coarsest).contour, 0j)
        return min(self._radii()) if around else 0.0

    def _radii(self) -> list[float]:
        """Distances from the cam axis of the ends of pieces, and where they are least or largest
        in between: where x x' = 0, a cubic.
        """
        start, middle, end = self.pieces.T
        a, b = start - 2.0 * middle + end, 2.0 * (middle - start)
        found: list[float] = np.abs(start).tolist()
        for k in range(len(start)):
            p, q, r = complex(a[k]), complex(b[k]), complex(start[k])
            cubic = [
                2.0 * abs(p) ** 2,
                3.0 * (p.conjugate() * q).real,
                2.0 * (p.conjugate() * r).real + abs(q) ** 2,
                (q.conjugate() * r).real,
            ]
            turns = np.roots(cubic).real
            inside = turns[(turns > 0.0) & (turns < 1.0)]
            found += [abs((p * t + q) * t + r) for t in inside.tolist()]
        return found


def _at(pieces: ComplexArray, t: FloatArray) -> ComplexArray:
    """(n,) points of quadratic curves (n, 3) at `t` (n,)."""
    w = 1.0 - t
    weights = np.stack((w * w, 2.0 * w * t, t * t), axis=1)
    points: ComplexArray = np.sum(weights * pieces, axis=1)
    return points


def _between_points(one: SplineContour, other: SplineContour) -> float:
    """Largest distance [mm] of the control points of two outlines of as many strands of the same
    kinds; infinite of others. Curves lie within it, for each point is a mean of these.
    """
    kinds = [[type(each) for each in contour.strands] for contour in (one, other)]
    count = len(one.strands)
    if len(other.strands) != count:
        return math.inf
    starts = np.array([complex(each.start) for each in other.strands])
    first = int(np.argmin(np.abs(starts - one.strands[0].start)))
    if kinds[0] != kinds[1][first:] + kinds[1][:first]:
        return math.inf
    largest = 0.0
    for k in range(count):
        mine, theirs = one.strands[k], other.strands[(first + k) % count]
        if isinstance(mine, CubicSpline) and isinstance(theirs, CubicSpline):
            if not np.array_equal(theirs.knots, mine.knots):
                return math.inf
            largest = max(largest, float(np.max(np.abs(mine.controls - theirs.controls))))
        elif isinstance(theirs, Arc) and theirs.sweep:
            return math.inf
        largest = max(largest, abs(mine.start - theirs.start), abs(mine.end - theirs.end))
    return largest


def _integrals(
    pieces: ComplexArray, integrands: tuple[Integrand, Integrand]
) -> list[tuple[complex, float]]:
    """Contour integrals along quadratic curves, each with that of its magnitude: by quadrature,
    which is exact for polynomials but for rounding.
    """
    count = len(pieces)
    t, half, weights = gauss(np.zeros(count), np.ones(count), NODES)
    start, middle, end = (pieces[:, k, np.newaxis] for k in range(3))
    point = (1.0 - t) ** 2 * start + 2.0 * t * (1.0 - t) * middle + t * t * end
    way = 2.0 * ((1.0 - t) * (middle - start) + t * (end - middle))
    found = []
    for integrand in integrands:
        values = integrand(point, way)
        each = half * (values @ weights)
        total = complex(math.fsum(each.real), math.fsum(each.imag))
        found.append((total, math.fsum(half * (np.abs(values) @ weights))))
    return found
