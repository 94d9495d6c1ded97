"""Boundaries of a part: outlines of the flanks, and outlines that are exactly lines and arcs."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Annotated, Any, TypeVar

import numpy as np

from camgeo.errors import GeometryError
from camgeo.geometry.contour.chords import fit_polyline, sampled_polyline
from camgeo.geometry.contour.contour import Contour, Effort, Fit, require_simple, winding_number
from camgeo.geometry.contour.exact import (
    ROUNDING,
    arc_angles,
    arc_count,
    arc_offset,
    circle_count,
    distance_between,
)
from camgeo.geometry.contour.legs import too_many
from camgeo.geometry.contour.parallel import corners, parallel
from camgeo.geometry.contour.proof import deviation
from camgeo.geometry.contour.spline import CubicSpline, SplineContour, SplineFit, strands_of
from camgeo.geometry.outline.path import (
    Moments,
    Path,
    SecondMoments,
    encloses_axis,
    path_moments,
    path_second_moments,
    piece_second_moments,
    radii,
)
from camgeo.geometry.pieces import stays_on_one_side, surely_clear_of_axis
from camgeo.lazy import Ledger
from camgeo.numeric.arrays import BoolArray, ComplexArray, IntArray, grouped
from camgeo.numeric.checked import CheckedFields, Truth, instance, positive
from camgeo.record import Pickled

BESIDE = "beside"
"""Key of fits from which distances are taken."""

Found = TypeVar("Found", Fit, SplineFit)

Name = Annotated[str, partial(instance, kind=str, what="the name of a boundary"), "part"]
Hole = Annotated[Truth, "part"]


@dataclass(frozen=True, slots=True)
class CurveBoundary(Pickled, CheckedFields):
    """The outline of a flank as a boundary, see `camgeo.part.part.Boundary`.

    Attributes
    ----------
    path : the outline.
    ledger : records its fits.
    known : the fits already made, by function and tolerance, and the deviations already found, by
        contour: several files need the same one, and a solid has each outline twice.
    """

    name: Name
    hole: Hole
    path: Annotated[Path, partial(instance, kind=Path, what="an outline"), "part"]
    ledger: Annotated[Ledger, partial(instance, kind=Ledger, what="a ledger"), "part"] = field(
        default_factory=Ledger, repr=False, compare=False
    )
    known: dict[Any, Any] = field(default_factory=dict, init=False, repr=False, compare=False)

    def arcs(self, tolerance: float, effort: Effort = "fewest") -> Fit:
        """Lines and arcs; raises ToleranceError, or UndercutError if the path is not an outline."""
        from camgeo.geometry.contour.arcs import fit_arcs  # a check without milling has no arcs
        from camgeo.geometry.contour.fewest_arcs import fewest_arcs

        fit = fit_arcs if effort == "fast" else fewest_arcs
        return self._fitted("arcs", fit, tolerance, lambda found: found.contour)

    def beside(self, tolerance: float) -> Fit:
        """See `camgeo.part.part.Boundary`; raises ToleranceError."""
        if (BESIDE, tolerance) not in self.known:
            with self.ledger.entry(f"distances from {self.name}"):
                self.known[BESIDE, tolerance] = fit_polyline(self.path, tolerance)
        known: Fit = self.known[BESIDE, tolerance]
        return known

    def polyline(self, tolerance: float, effort: Effort = "fewest") -> Fit:
        """Straight pieces; raises like `arcs`."""
        from camgeo.geometry.contour.fewest_chords import fewest_chords  # a check has the fast fit

        fit = fit_polyline if effort == "fast" else fewest_chords
        return self._fitted("chords", fit, tolerance, lambda found: found.contour)

    def sampled(self, tolerance: float) -> Contour:
        """See `camgeo.geometry.contour.chords.sampled_polyline`."""
        return sampled_polyline(self.path, tolerance)

    def spline(self, tolerance: float, effort: Effort = "fewest") -> SplineFit:
        """Cubic splines and arcs; raises like `arcs`."""
        from camgeo.geometry.contour.cubic_proof import approximating_arcs
        from camgeo.geometry.contour.cubics import (  # few files have splines
            fewest_cubics,
            fit_spline,
        )

        fit = fit_spline if effort == "fast" else fewest_cubics
        return self._fitted(
            "cubics",
            fit,
            tolerance,
            lambda found: approximating_arcs(found.contour, tolerance).contour,
        )

    def _fitted(
        self,
        what: str,
        fit: Callable[[Path, float], Found],
        tolerance: float,
        drawn: Callable[[Found], Contour],
    ) -> Found:
        """The fit; its contour as lines and arcs, `drawn`, does not cross itself."""
        if (fit, tolerance) not in self.known:
            with self.ledger.entry(f"{what} of {self.name}"):
                found = fit(self.path, tolerance)
            require_simple(drawn(found), self.name)
            self.known[fit, tolerance] = found
        known: Found = self.known[fit, tolerance]
        return known

    def deviation(self, contour: Contour | SplineContour) -> float:
        """Proved bound [mm], see `camgeo.geometry.contour.proof`."""

        def prove() -> float:
            with self.ledger.entry(f"proof of {self.name}"):
                if not isinstance(contour, SplineContour):
                    return deviation(self.path, contour)
                from camgeo.geometry.contour.cubic_proof import spline_deviation  # few files

                return spline_deviation(self.path, contour)

        return once(self.known, contour, prove)

    @property
    def corner_radius(self) -> None:
        """It has no arcs that end at corners."""
        return None

    def offset(self, distance: float) -> CurveBoundary:
        """See `camgeo.part.part.Boundary`; the cutter rolls around corners on arcs."""
        path = self.path.offset(-distance if self.hole else distance)
        return CurveBoundary(f"path of the cutter along the {self.name}", self.hole, path)

    def inset(self, distance: float, name: str) -> CurveBoundary:
        """See `camgeo.part.part.Boundary`; its fits go into the same ledger."""
        if any(each.distance == 0.0 for each in self.path.pivots):
            message = f"the {self.name} has a corner, along which there is no parallel"
            raise GeometryError(message, "part", self.name)
        path = self.path.offset(distance if self.hole else -distance)
        return CurveBoundary(name, self.hole, path, self.ledger)

    def moments(self, tolerance: float) -> Moments:
        """See `camgeo.part.part.Boundary`."""
        return path_moments(self.path, tolerance).counter_clockwise()

    def second_moments(self, tolerance: float) -> SecondMoments:
        """See `camgeo.part.part.Boundary`."""
        return path_second_moments(self.path, tolerance).counter_clockwise()

    def farthest(self) -> tuple[float, float | None]:
        """See `camgeo.part.part.Boundary`."""
        farthest = radii(self.path).highest
        return farthest.value, farthest.place

    def nearest(self) -> float:
        """See `camgeo.part.part.Boundary`."""
        nearest = radii(self.path).lowest.value
        return nearest if nearest > 0.0 and encloses_axis(self.path) else 0.0

    def surely_around(self, radius: float) -> bool:
        """True if bounds show that it goes round the cam axis farther than `radius` [mm] from it.

        False is inconclusive; `nearest` decides then. A roller centre that stays on one side goes
        round the axis, and with it a whole parallel that is nearer to it than the axis.
        """
        if not self.path.is_whole or not self.path.stretches:
            return False
        curve = self.path.stretches[0].curve
        beyond = radius + abs(curve.distance)
        return stays_on_one_side(curve.pitch) and surely_clear_of_axis(curve.pitch, beyond)


def once(
    known: dict[Any, Any], contour: Contour | SplineContour, find: Callable[[], float]
) -> float:
    """The deviation of `contour`, found now or known for the same numbers from another start."""
    key = hashlib.blake2b(numbers_of(contour)).digest()
    if key not in known:
        known[key] = find()
    deviation: float = known[key]
    return deviation


def numbers_of(contour: Contour | SplineContour) -> bytes:
    """All numbers of a contour; of lines and arcs the same wherever it begins."""
    if isinstance(contour, SplineContour):
        return b"".join(
            each.knots.tobytes() + each.controls.tobytes()
            if isinstance(each, CubicSpline)
            else np.array([each.start, each.end, each.sweep, each.centre]).tobytes()
            for each in contour.strands
        )
    first = -int(np.lexsort((contour.vertices.imag, contour.vertices.real))[0])
    # + 0.0 turns -0.0 into 0.0
    rolled = (np.roll(each + 0.0, first) for each in (contour.vertices, contour.sweeps))
    return b"".join(each.tobytes() for each in rolled)


def corner_radius(contour: Contour) -> float | None:
    """Radius [mm] of the smallest arc that ends at a corner; None if there is none.

    Where it meets a line p from its centre, both move out by d, and the corner slides along a
    parabola: its distance from the foot of the centre is the root of r^2 - p^2 + 2 d (r - p). So
    areas within parallels are analytic in d down to -(r + p) / 2, below -r / 2.
    """
    at = corners(contour)
    radii = contour.radii[(at | np.roll(at, -1)) & (contour.sweeps != 0.0)]
    return float(np.min(radii)) if len(radii) else None


@dataclass(frozen=True, slots=True)
class ExactBoundary(Pickled, CheckedFields):
    """An outline of lines and arcs as a boundary, see `camgeo.part.part.Boundary`.

    Attributes
    ----------
    exact : the outline.
    core : for a bore with keyway, the circle that a round cutter makes; None if that is the whole
        outline.
    known : the deviations already found, by contour.
    """

    name: Name
    hole: Hole
    exact: Annotated[
        Contour, partial(instance, kind=Contour, what="an outline of lines and arcs"), "part"
    ]
    core: (
        Annotated[Contour, partial(instance, kind=Contour, what="a circle, or None"), "part"] | None
    ) = None
    known: dict[Any, Any] = field(default_factory=dict, init=False, repr=False, compare=False)

    @property
    def is_round(self) -> bool:
        """Whether what a round cutter makes is a circle."""
        circle = self.core or self.exact
        return circle.arc_count == len(circle) and not np.any(circle.centres != circle.centres[0])

    @property
    def round_radius(self) -> float:
        """Radius [mm] of what a round cutter makes; GeometryError if that is not a circle."""
        circle = self.core or self.exact
        if not self.is_round:
            raise GeometryError(f"the {self.name} is not round", key="part", value=self.name)
        return float(circle.radii[0])

    def offset(self, distance: float) -> ExactBoundary:
        """See `camgeo.part.part.Boundary`; only for a round outline or core."""
        radius = self.round_radius + (-distance if self.hole else distance)
        positive("part", radius, "mm")
        centre = complex((self.core or self.exact).centres[0])
        name = f"path of the cutter along the {self.name}"
        return ExactBoundary(name, self.hole, Contour.circle(radius, centre))

    @property
    def corner_radius(self) -> float | None:
        """See `corner_radius`."""
        return corner_radius(self.exact)

    def inset(self, distance: float, name: str) -> ExactBoundary:
        """See `camgeo.part.part.Boundary`; of a circle, or with the corners mitred."""
        if self.core is not None or not self.is_round:
            by = distance if self.hole else -distance
            return ExactBoundary(name, self.hole, parallel(self.exact.counter_clockwise(), by))
        radius = self.round_radius + (distance if self.hole else -distance)
        circle = Contour.circle(positive("part", radius, "mm"), complex(self.exact.centres[0]))
        return ExactBoundary(name, self.hole, circle)

    def moments(self, tolerance: float) -> Moments:
        """In closed form, see `camgeo.part.part.Boundary`."""
        return self.exact.moments.counter_clockwise()

    def second_moments(self, tolerance: float) -> SecondMoments:
        """Exact but for rounding, see `camgeo.part.part.Boundary`."""
        exact = self.exact
        found = piece_second_moments(exact.vertices, exact.ends, exact.sweeps, exact.centres)
        return found.counter_clockwise()

    def farthest(self) -> tuple[float, float | None]:
        """See `camgeo.part.part.Boundary`; no cam angle belongs to a point of it."""
        return largest_radius(self.exact), None

    def nearest(self) -> float:
        """See `camgeo.part.part.Boundary`."""
        return smallest_radius(self.exact)

    def arcs(self, tolerance: float, effort: Effort = "fewest") -> Fit:
        """The outline itself, at either effort."""
        return Fit(self.exact.counter_clockwise(), 0.0, tolerance)

    def beside(self, tolerance: float) -> Fit:
        """The outline itself."""
        return self.arcs(tolerance)

    def polyline(self, tolerance: float, effort: Effort = "fewest") -> Fit:
        """Straight pieces with vertices on the outline, or on both sides of it for the fewest."""
        chords = chords_of if effort == "fast" else fewest_chords_of
        return chords(self.exact.counter_clockwise(), tolerance)

    def sampled(self, tolerance: float) -> Contour:
        """Straight pieces with vertices on the outline."""
        return self.polyline(tolerance, "fast").contour

    def spline(self, tolerance: float, effort: Effort = "fewest") -> SplineFit:
        """The outline itself, at either effort: lines and arcs already are strands."""
        return SplineFit(strands_of(self.exact.counter_clockwise()), 0.0, tolerance)

    def deviation(self, contour: Contour | SplineContour) -> float:
        """Bound [mm] in closed form, see `geometry.contour.exact`; for a spline by its arcs."""
        if isinstance(contour, SplineContour):
            from camgeo.geometry.contour.cubic_proof import bound_by_arcs  # few files have splines

            return bound_by_arcs(lambda arcs: distance_between(self.exact, arcs), contour)
        return once(self.known, contour, lambda: distance_between(self.exact, contour))


def largest_radius(contour: Contour) -> float:
    """Largest distance of the contour from the cam axis [mm]."""
    return max(_radii(contour))


def smallest_radius(contour: Contour) -> float:
    """Smallest distance of the contour from the cam axis [mm]; 0 if the axis lies outside it."""
    return min(_radii(contour)) if winding_number(contour, 0j) else 0.0


def _radii(contour: Contour) -> list[float]:
    """Distances from the cam axis of the ends of pieces and of their nearest or farthest points."""
    radii: list[float] = []
    for start, end, sweep, centre in zip(
        contour.vertices, contour.ends, contour.sweeps, contour.centres, strict=True
    ):
        radii += (abs(start), abs(end))
        if sweep == 0.0:
            chord = end - start
            share = -(start * np.conj(chord)).real / abs(chord) ** 2
            if 0.0 < share < 1.0:
                radii.append(abs(start + share * chord))
        elif centre != 0.0:
            radius = abs(start - centre)
            for direction in (centre / abs(centre), -centre / abs(centre)):
                turned = np.angle(direction / (start - centre)) * np.sign(sweep)
                if turned % (2.0 * np.pi) <= abs(sweep):
                    radii.append(abs(centre + radius * direction))
    return [float(radius) for radius in radii]


# -- chords ---------------------------------------------------------------------------------------
# Straight pieces along lines and arcs.


MAX_CHORDS = 2_000_000
"""Chords at most."""


WIDEST = 1.6
"""Largest span of a chord [rad], however small the arc: a circle keeps four."""


def chords_of(exact: Contour, tolerance: float) -> Fit:
    """Straight pieces with vertices on `exact`, at most `tolerance` [mm] off it."""
    radii = exact.radii
    largest = float(np.max(radii, initial=0.0))
    if largest > 0.0 and math.pi * math.sqrt(largest / (2.0 * tolerance)) > MAX_CHORDS:
        raise too_many(MAX_CHORDS, "straight pieces", tolerance)
    with np.errstate(divide="ignore", invalid="ignore"):
        # Sagitta r (1 - cos(step/2)) = tolerance, without the cancellation of 1 - cos.
        steps = 4.0 * np.arcsin(np.sqrt(np.minimum(tolerance / (2.0 * radii), 0.5)))
    counts = np.where(radii > 0.0, np.ceil(np.abs(exact.sweeps) / np.minimum(steps, WIDEST)), 1)
    index, number = grouped(counts.astype(np.intp))
    arm = exact.vertices[index] - exact.centres[index]
    turned = exact.centres[index] + arm * np.exp(1j * exact.sweeps[index] * number / counts[index])
    vertices = np.where(exact.sweeps[index] == 0.0, exact.vertices[index], turned)
    return _fit(exact, vertices, index, tolerance)


def fewest_chords_of(exact: Contour, tolerance: float) -> Fit:
    """The fewest straight pieces within `tolerance` [mm] of `exact`, on both sides of it.

    Corners of `exact` are vertices; along its arcs vertices lie off them. A whole circle has no
    corner. There are never more pieces than from `chords_of`.

    Raises
    ------
    ToleranceError
        If more than `MAX_CHORDS` pieces would be needed.
    """
    if np.all(_on_first_circle(exact)):
        return _chords_of_circle(exact, tolerance)
    found: list[ComplexArray] = []
    for k, (sweep, radius) in enumerate(zip(exact.sweeps, exact.radii, strict=True)):
        if sweep == 0.0:
            found.append(exact.vertices[k : k + 1])
            continue
        count = _checked(arc_count(tolerance, radius, abs(sweep), WIDEST), tolerance)
        found.append(_along_arc(exact, k, count, radius, abs(sweep)))
    index = np.repeat(np.arange(len(exact)), [len(each) for each in found])
    return _fit(exact, np.concatenate(found), index, tolerance)


def matching_chords_of(contours: Sequence[Contour], tolerance: float) -> list[ComplexArray]:
    """(n,) complex [mm] polygons within `tolerance` [mm] of contours with the same kinds of pieces,
    such as parallels, as many pieces along each: vertices that belong together have the same index.
    """
    found: list[list[ComplexArray]] = [[] for _ in contours]
    for k, sweep in enumerate(contours[0].sweeps):
        if sweep == 0.0:
            for own, contour in zip(found, contours, strict=True):
                own.append(contour.vertices[k : k + 1])
            continue
        sizes = [(float(each.radii[k]), float(abs(each.sweeps[k]))) for each in contours]
        count = max(_checked(arc_count(tolerance, *size, WIDEST), tolerance) for size in sizes)
        for own, contour, (radius, turned) in zip(found, contours, sizes, strict=True):
            own.append(_along_arc(contour, k, count, radius, turned))
    return [np.concatenate(own) for own in found]


def _along_arc(contour: Contour, k: int, count: int, radius: float, sweep: float) -> ComplexArray:
    """(count,) vertices of the chords of an arc, the first one its start."""
    start, centre = contour.vertices[k], contour.centres[k]
    offset = arc_offset(count, radius, sweep)
    turned = arc_angles(count, radius, sweep, offset)[1:-1]
    arm = (1.0 + offset / radius) * (start - centre)
    along = centre + arm * np.exp(1j * np.sign(contour.sweeps[k]) * turned)
    return np.append(start, along)


def _chords_of_circle(exact: Contour, tolerance: float) -> Fit:
    """At least three chords, none over more than `WIDEST`; their vertices lie r tan^2(pi/(2 n)) off
    the circle.
    """
    centre, radius = complex(exact.centres[0]), float(exact.radii[0])
    count = _checked(circle_count(tolerance, radius, WIDEST), tolerance)
    offset = radius * math.tan(0.5 * math.pi / count) ** 2
    arm = (1.0 + offset / radius) * (complex(exact.vertices[0]) - centre)
    step = math.copysign(2.0 * math.pi / count, float(exact.sweeps[0]))
    vertices = centre + arm * np.exp(1j * step * np.arange(count))
    return _fit(exact, vertices, np.zeros(count, dtype=np.intp), tolerance)


def _fit(exact: Contour, vertices: ComplexArray, index: IntArray, tolerance: float) -> Fit:
    """The polygon of `vertices` (n,) [mm], whose chord i belongs to the piece `index[i]` (n,).

    A chord and its part of an arc lie within the same angle about the centre, and along each ray
    from there within the largest difference of their radii: at a vertex, or at the foot of the
    perpendicular.
    """
    contour, centres, radii = Contour.polygon(vertices), exact.centres[index], exact.radii[index]
    start, end = contour.vertices - centres, contour.ends - centres
    along = (end - start) / np.where(end == start, 1.0, np.abs(end - start))
    foot = np.abs((np.conj(along) * 0.5 * (start + end)).imag)
    off = np.max(np.abs([np.abs(start) - radii, np.abs(end) - radii, radii - foot]), axis=0)
    largest = float(np.max(off[radii > 0.0], initial=0.0))
    rounding = 2.0 * ROUNDING * float(np.max(np.abs(vertices)))
    return Fit(contour, largest + rounding, tolerance)


def _checked(count: int, tolerance: float) -> int:
    if count > MAX_CHORDS:
        raise too_many(MAX_CHORDS, "straight pieces", tolerance)
    return count


def _on_first_circle(exact: Contour) -> BoolArray:
    """(n,) whether a piece is an arc of the same circle as the first one."""
    same: BoolArray = (
        (exact.sweeps != 0.0)
        & (exact.sweeps[0] != 0.0)
        & (exact.centres == exact.centres[0])
        & np.isclose(exact.radii, exact.radii[0], rtol=1e-12, atol=0.0)
    )
    return same
