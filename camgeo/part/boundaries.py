"""Boundaries of a part: outlines of the flanks, exact lines and arcs, and letters."""

from __future__ import annotations

import cmath
import hashlib
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import combinations, pairwise
from typing import Annotated, Any, Final, TypeVar

import numpy as np

from camgeo.errors import GeometryError, ToleranceError
from camgeo.geometry.contour.chords import fit_polyline, sampled_polyline
from camgeo.geometry.contour.contour import (
    Contour,
    Effort,
    Fit,
    Pieces,
    crossing,
    least_distance,
    require_simple,
    winding_number,
)
from camgeo.geometry.contour.cubic_proof import approximating_arcs, bound_by_arcs
from camgeo.geometry.contour.exact import (
    ROUNDING,
    arc_angles,
    arc_count,
    arc_offset,
    circle_count,
    deviation_bound,
)
from camgeo.geometry.contour.legs import too_many_error
from camgeo.geometry.contour.parallel import corners, parallel
from camgeo.geometry.contour.proof import ENOUGH, deviation
from camgeo.geometry.contour.spline import (
    Arc,
    CubicSpline,
    SplineContour,
    SplineFit,
    as_spline_contour,
    elevated,
)
from camgeo.geometry.outline.path import (
    Moments,
    Path,
    SecondMoments,
    radii,
)
from camgeo.geometry.pieces import stays_on_one_side, surely_clear_of_axis
from camgeo.lazy import Ledger
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, IntArray, frozen, grouped
from camgeo.numeric.checked import CheckedFields, Truth, array, check_fields, instance, positive
from camgeo.part.glyphs import glyph, kerning
from camgeo.part.part import Size
from camgeo.part.spec import CIRCLE, ENGRAVING, LETTER, OUTWARD, Engraving
from camgeo.record import Pickled
from camgeo.units import TURN

DISTANCES = "distances"
"""Key of the fits from which distances are taken."""

FitKind = TypeVar("FitKind", Fit, SplineFit)

Name = Annotated[str, partial(instance, kind=str, what="the name of a boundary"), "part"]
Hole = Annotated[Truth, "part"]


def spline_deviation(path: Path, contour: SplineContour) -> float:
    """Upper bound [mm] of the distance between `contour` and `path`, in both directions.

    Parameters
    ----------
    path : the exact path, as for `camgeo.geometry.contour.proof.deviation`.
    contour : once round the path, in either direction.

    Raises
    ------
    GeometryError
        If the contour does not follow the path once round, so that no bound can be given.
    """
    return bound_by_arcs(lambda arcs: deviation(path, arcs), contour)


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
        from camgeo.geometry.contour.arcs import (
            fewest_arcs,
            fit_arcs,  # a check without milling has no arcs
        )

        fit = fit_arcs if effort == "fast" else fewest_arcs
        return self._simple_fit("arcs", fit, tolerance, lambda fitted: fitted.contour)

    def distance_fit(self, tolerance: float) -> Fit:
        """See `camgeo.part.part.Boundary`; raises ToleranceError."""
        if (DISTANCES, tolerance) not in self.known:
            with self.ledger.entry(f"distances from {self.name}"):
                self.known[DISTANCES, tolerance] = fit_polyline(self.path, tolerance)
        known: Fit = self.known[DISTANCES, tolerance]
        return known

    def polyline(self, tolerance: float, effort: Effort = "fewest") -> Fit:
        """Straight pieces; raises like `arcs`."""
        from camgeo.geometry.contour.fewest_chords import fewest_chords  # a check has the fast fit

        fit = fit_polyline if effort == "fast" else fewest_chords
        return self._simple_fit("chords", fit, tolerance, lambda fitted: fitted.contour)

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
        return self._simple_fit(
            "cubics",
            fit,
            tolerance,
            lambda fitted: approximating_arcs(fitted.contour, tolerance).contour,
        )

    def _simple_fit(
        self,
        what: str,
        fit: Callable[[Path, float], FitKind],
        tolerance: float,
        as_arcs: Callable[[FitKind], Contour],
    ) -> FitKind:
        """The fit of the path, computed or known already; GeometryError if it crosses itself.

        `as_arcs` gives its contour as lines and arcs, by which that is tested.
        """
        if (fit, tolerance) not in self.known:
            with self.ledger.entry(f"{what} of {self.name}"):
                new_fit = fit(self.path, tolerance)
            require_simple(as_arcs(new_fit), self.name)
            self.known[fit, tolerance] = new_fit
        known: FitKind = self.known[fit, tolerance]
        return known

    def deviation(self, contour: Contour | SplineContour) -> float:
        """Proved bound [mm], see `camgeo.geometry.contour.proof`."""

        def prove() -> float:
            with self.ledger.entry(f"proof of {self.name}"):
                if not isinstance(contour, SplineContour):
                    return deviation(self.path, contour)

                return spline_deviation(self.path, contour)

        return once(self.known, contour, prove)

    @property
    def corner_radius(self) -> None:
        """None, because no arc of the boundary ends at a corner."""
        return None

    def offset(self, distance: float) -> CurveBoundary:
        """See `camgeo.part.part.Boundary`; the cutter rolls around corners on arcs."""
        # The side without material is inside a hole, and outside anything else.
        path = self.path.offset(-distance if self.hole else distance)
        return CurveBoundary(f"path of the cutter along the {self.name}", self.hole, path)

    def inset(self, distance: float, name: str) -> CurveBoundary:
        """See `camgeo.part.part.Boundary`; fits of the parallel are recorded in the same ledger."""
        if any(pivot.distance == 0.0 for pivot in self.path.pivots):
            raise GeometryError(
                f"the {self.name} has a corner, along which there is no parallel", "part", self.name
            )
        path = self.path.offset(distance if self.hole else -distance)
        return CurveBoundary(name, self.hole, path, self.ledger)

    def moments(self, tolerance: float) -> Moments:
        """See `camgeo.part.part.Boundary`."""
        return self.path.moments(tolerance).counter_clockwise()

    def second_moments(self, tolerance: float) -> SecondMoments:
        """See `camgeo.part.part.Boundary`."""
        return self.path.second_moments(tolerance).counter_clockwise()

    def farthest(self) -> tuple[float, float | None]:
        """See `camgeo.part.part.Boundary`."""
        farthest = radii(self.path).highest
        return farthest.value, farthest.place

    def nearest(self) -> float:
        """See `camgeo.part.part.Boundary`."""
        nearest = radii(self.path).lowest.value
        return nearest if nearest > 0.0 and self.path.encloses_axis else 0.0

    def surely_around(self, radius: float) -> bool:
        """True if bounds show that the boundary goes round the cam axis and stays farther than
        `radius` [mm] from it.

        False is inconclusive; `nearest` decides then. A roller centre that stays on one side goes
        round the axis, and so does a whole parallel that is nearer to the centre than the axis is.
        """
        if not self.path.is_whole or not self.path.stretches:
            return False
        curve = self.path.stretches[0].curve
        beyond = radius + abs(curve.distance)
        return stays_on_one_side(curve.pitch) and surely_clear_of_axis(curve.pitch, beyond)


def once(
    known: dict[Any, Any], contour: Contour | SplineContour, find: Callable[[], float]
) -> float:
    """The deviation of `contour`, computed by `find` unless it is `known` for the same contour,
    whose start may be another one.
    """
    key = hashlib.blake2b(contour_bytes(contour)).digest()
    if key not in known:
        known[key] = find()
    deviation: float = known[key]
    return deviation


def contour_bytes(contour: Contour | SplineContour) -> bytes:
    """All numbers of a contour as bytes; of lines and arcs the same bytes wherever it begins."""
    if isinstance(contour, SplineContour):
        return b"".join(
            strand.knots.tobytes() + strand.controls.tobytes()
            if isinstance(strand, CubicSpline)
            else np.array([strand.start, strand.end, strand.sweep, strand.centre]).tobytes()
            for strand in contour.strands
        )
    # The vertex that is first by X, then by Y, becomes the start.
    first = -int(np.lexsort((contour.vertices.imag, contour.vertices.real))[0])
    # + 0.0 turns -0.0 into 0.0
    rolled = (np.roll(values + 0.0, first) for values in (contour.vertices, contour.sweeps))
    return b"".join(values.tobytes() for values in rolled)


def corner_radius(contour: Contour) -> float | None:
    """Radius [mm] of the smallest arc that ends at a corner; None if there is none.

    Where it meets a line p from its centre, both move out by d, and the corner slides along a
    parabola: its distance from the foot of the centre is the root of r^2 - p^2 + 2 d (r - p). So
    areas within parallels are analytic in d down to -(r + p) / 2, below -r / 2.
    """
    is_corner = corners(contour)
    # A piece ends at a corner if its start, or the start of the next one, is a corner.
    radii = contour.radii[(is_corner | np.roll(is_corner, -1)) & (contour.sweeps != 0.0)]
    return float(np.min(radii)) if len(radii) else None


@dataclass(frozen=True, slots=True)
class ExactBoundary(Pickled, CheckedFields):
    """An outline of lines and arcs as a boundary, see `camgeo.part.part.Boundary`.

    Attributes
    ----------
    exact : the outline.
    core : for a bore with keyway, the circle that a round cutter makes; None if that is the whole
        outline.
    known : the deviations already computed, by contour.
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
        """Whether the core, or the outline if it has none, is a circle."""
        circle = self.core or self.exact
        return circle.arc_count == len(circle) and not np.any(circle.centres != circle.centres[0])

    @property
    def round_radius(self) -> float:
        """Radius [mm] of the core, or of the outline; GeometryError if that is not a circle."""
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
        """See `camgeo.part.part.Boundary`; corners of outlines other than circles are mitred."""
        if self.core is not None or not self.is_round:
            displacement = distance if self.hole else -distance
            return ExactBoundary(
                name, self.hole, parallel(self.exact.counter_clockwise(), displacement)
            )
        radius = self.round_radius + (distance if self.hole else -distance)
        circle = Contour.circle(positive("part", radius, "mm"), complex(self.exact.centres[0]))
        return ExactBoundary(name, self.hole, circle)

    def moments(self, tolerance: float) -> Moments:
        """See `camgeo.part.part.Boundary`; in closed form."""
        return self.exact.moments.counter_clockwise()

    def second_moments(self, tolerance: float) -> SecondMoments:
        """Exact but for rounding, see `camgeo.part.part.Boundary`."""
        exact = self.exact
        moments = SecondMoments.of_pieces(exact.vertices, exact.ends, exact.sweeps, exact.centres)
        return moments.counter_clockwise()

    def farthest(self) -> tuple[float, float | None]:
        """See `camgeo.part.part.Boundary`; no cam angle belongs to a point of it."""
        return largest_radius(self.exact), None

    def nearest(self) -> float:
        """See `camgeo.part.part.Boundary`."""
        return smallest_radius(self.exact)

    def arcs(self, tolerance: float, effort: Effort = "fewest") -> Fit:
        """The outline itself, at either effort."""
        return Fit(self.exact.counter_clockwise(), 0.0, tolerance)

    def distance_fit(self, tolerance: float) -> Fit:
        """The outline itself."""
        return self.arcs(tolerance)

    def polyline(self, tolerance: float, effort: Effort = "fewest") -> Fit:
        """Straight pieces with vertices on the outline, or on both sides of it for the fewest."""
        chords = chord_fit if effort == "fast" else fewest_chord_fit
        return chords(self.exact.counter_clockwise(), tolerance)

    def sampled(self, tolerance: float) -> Contour:
        """Straight pieces with vertices on the outline."""
        return self.polyline(tolerance, "fast").contour

    def spline(self, tolerance: float, effort: Effort = "fewest") -> SplineFit:
        """The outline itself, at either effort: lines and arcs already are strands."""
        return SplineFit(as_spline_contour(self.exact.counter_clockwise()), 0.0, tolerance)

    def deviation(self, contour: Contour | SplineContour) -> float:
        """Bound [mm] in closed form, see `geometry.contour.exact`; for a spline by its arcs."""
        if isinstance(contour, SplineContour):
            from camgeo.geometry.contour.cubic_proof import bound_by_arcs  # few files have splines

            return bound_by_arcs(lambda arcs: deviation_bound(self.exact, arcs), contour)
        return once(self.known, contour, lambda: deviation_bound(self.exact, contour))


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
        # A line has its nearest point at the foot of the axis, an arc its extremes where the ray
        # through its centre meets it, if these lie between the ends.
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
"""Most chords of a contour."""


WIDEST = 1.6
"""Largest span of a chord [rad], however small the arc: a circle keeps four."""


def chord_fit(exact: Contour, tolerance: float) -> Fit:
    """Straight pieces with vertices on `exact`, at most `tolerance` [mm] off it."""
    radii = exact.radii
    largest = float(np.max(radii, initial=0.0))
    if largest > 0.0 and math.pi * math.sqrt(largest / (2.0 * tolerance)) > MAX_CHORDS:
        raise too_many_error(MAX_CHORDS, "straight pieces", tolerance)
    with np.errstate(divide="ignore", invalid="ignore"):
        # Sagitta r (1 - cos(step/2)) = tolerance, without the cancellation of 1 - cos.
        steps = 4.0 * np.arcsin(np.sqrt(np.minimum(tolerance / (2.0 * radii), 0.5)))
    counts = np.where(radii > 0.0, np.ceil(np.abs(exact.sweeps) / np.minimum(steps, WIDEST)), 1)
    index, number = grouped(counts.astype(np.intp))
    # `index` is the piece of each chord, `number` counts the chords within it; a line has one.
    arm = exact.vertices[index] - exact.centres[index]
    turned = exact.centres[index] + arm * np.exp(1j * exact.sweeps[index] * number / counts[index])
    vertices = np.where(exact.sweeps[index] == 0.0, exact.vertices[index], turned)
    return _fit(exact, vertices, index, tolerance)


def fewest_chord_fit(exact: Contour, tolerance: float) -> Fit:
    """The fewest straight pieces within `tolerance` [mm] of `exact`, on both sides of it.

    Corners of `exact` are vertices; along its arcs vertices lie off them. A whole circle has no
    corner. There are never more pieces than from `chord_fit`.

    Raises
    ------
    ToleranceError
        If more than `MAX_CHORDS` pieces would be needed.
    """
    if np.all(_shares_first_circle(exact)):
        return _circle_chords(exact, tolerance)
    chains: list[ComplexArray] = []
    for k, (sweep, radius) in enumerate(zip(exact.sweeps, exact.radii, strict=True)):
        if sweep == 0.0:
            chains.append(exact.vertices[k : k + 1])
            continue
        count = _checked(arc_count(tolerance, radius, abs(sweep), WIDEST), tolerance)
        chains.append(_along_arc(exact, k, count, radius, abs(sweep)))
    # The piece to which each vertex belongs, and the chord that starts there.
    index = np.repeat(np.arange(len(exact)), [len(chain) for chain in chains])
    return _fit(exact, np.concatenate(chains), index, tolerance)


def matching_chords(contours: Sequence[Contour], tolerance: float) -> list[ComplexArray]:
    """(n,) complex [mm] vertices of a polygon within `tolerance` [mm] of each contour.

    The contours must have the same kinds of pieces, as parallels have. Corresponding vertices have
    the same index: along an arc all polygons have as many as the one that needs most.
    """
    chains: list[list[ComplexArray]] = [[] for _ in contours]
    for k, sweep in enumerate(contours[0].sweeps):
        if sweep == 0.0:
            for chain, contour in zip(chains, contours, strict=True):
                chain.append(contour.vertices[k : k + 1])
            continue
        sizes = [(float(contour.radii[k]), float(abs(contour.sweeps[k]))) for contour in contours]
        count = max(_checked(arc_count(tolerance, *size, WIDEST), tolerance) for size in sizes)
        for chain, contour, (radius, turned) in zip(chains, contours, sizes, strict=True):
            chain.append(_along_arc(contour, k, count, radius, turned))
    return [np.concatenate(chain) for chain in chains]


def _along_arc(contour: Contour, k: int, count: int, radius: float, sweep: float) -> ComplexArray:
    """(count,) vertices of the chords of the arc `k`, without its end.

    The first one is the start of the arc; the inner ones lie off it, so that the chords deviate to
    both sides.
    """
    start, centre = contour.vertices[k], contour.centres[k]
    offset = arc_offset(count, radius, sweep)
    turned = arc_angles(count, radius, sweep, offset)[1:-1]
    arm = (1.0 + offset / radius) * (start - centre)
    along = centre + arm * np.exp(1j * np.sign(contour.sweeps[k]) * turned)
    return np.append(start, along)


def _circle_chords(exact: Contour, tolerance: float) -> Fit:
    """At least three chords of a whole circle, none over more than `WIDEST`.

    The n vertices lie r tan^2(pi/(2 n)) outside the circle, as far as the middles of the chords lie
    inside it.
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
    errors = np.max(np.abs([np.abs(start) - radii, np.abs(end) - radii, radii - foot]), axis=0)
    largest = float(np.max(errors[radii > 0.0], initial=0.0))
    rounding = 2.0 * ROUNDING * float(np.max(np.abs(vertices)))
    return Fit(contour, largest + rounding, tolerance)


def _checked(count: int, tolerance: float) -> int:
    if count > MAX_CHORDS:
        raise too_many_error(MAX_CHORDS, "straight pieces", tolerance)
    return count


def _shares_first_circle(exact: Contour) -> BoolArray:
    """(n,) whether a piece is an arc of the same circle as the first one."""
    return np.asarray(
        (exact.sweeps != 0.0)
        & (exact.sweeps[0] != 0.0)
        & (exact.centres == exact.centres[0])
        & np.isclose(exact.radii, exact.radii[0], rtol=1e-12, atol=0.0)
    )


# -- lettering -------------------------------------------------------------------------------------
# Engraved texts: their letters in place, as boundaries, clear of each other.


COARSEST: Final = 0.004
"""Coarsest tolerance of the fits of an outline, as a share of the height of capital letters:
strokes are an eighth of it wide."""

LEAST_GAP: Final = 0.01
"""Least distance of outlines, as a share of the height of capital letters."""


FAR: Final = 1.5
"""Multiple of the distance at which letters can touch, beyond which they are not compared; it
covers how far arcs bulge beyond their ends."""


@dataclass(frozen=True, slots=True, eq=False)
class Letter:
    """A letter of an engraved text, in its place.

    Attributes
    ----------
    character : the character.
    place : middle of the letter [mm], at half the height of capital letters.
    boundaries : outlines of the letter, holes and what stands within them, by which it is cut.
    contours : the boundaries as lines and arcs.
    deviation : largest deviation of the contours [mm].
    """

    character: str
    place: complex
    boundaries: tuple[LetterBoundary, ...]
    contours: tuple[Contour, ...]
    deviation: float

    @property
    def where(self) -> str:
        """The letter and its place in words."""
        return f'"{self.character}" at X {self.place.real:.4g}, Y {self.place.imag:.4g} mm'


def place_letters(texts: Sequence[Engraving]) -> tuple[tuple[Letter, ...], ...]:
    """The letters of each text in their places.

    Raises
    ------
    GeometryError
        With the key of the text, if the font lacks a character, letters or their outlines touch, or
        a text goes round the cam axis more than once.
    """
    placed = tuple(_letters(text, number) for number, text in enumerate(texts, start=1))
    letters = [(number, letter) for number, text in enumerate(placed, start=1) for letter in text]
    for first, second in _near([letter for _, letter in letters]):
        (_, one), (number, other) = letters[first], letters[second]
        distance = least_distance(Pieces.around(one.contours), Pieces.around(other.contours))
        if distance <= LEAST_GAP * texts[number - 1].height:
            raise GeometryError(
                f"the {other.where} touches the {one.where}", key=f"part.{ENGRAVING}[{number}]"
            )
    return placed


def _near(letters: Sequence[Letter]) -> list[tuple[int, int]]:
    """The pairs of letters that may touch, by their indices, in order."""
    places = np.array([letter.place for letter in letters])
    # Radii of circles about the letters, in which the ends of all pieces lie.
    reaches = np.array(
        [
            max(
                float(np.max(np.abs(contour.vertices - letter.place)))
                for contour in letter.contours
            )
            for letter in letters
        ]
    )
    near = np.abs(places[:, None] - places) <= FAR * (reaches[:, None] + reaches)
    pairs: list[tuple[int, int]] = [(one, other) for one, other in np.argwhere(np.triu(near, 1))]
    return pairs


def _letters(text: Engraving, number: int) -> tuple[Letter, ...]:
    key = f"part.{ENGRAVING}[{number}]"
    letters = []
    for count, (character, place, along) in enumerate(_places(text, key), start=1):
        middle = 0.5 * glyph(character).advance + 0.5j
        outlines = [
            place + text.height * along * (outline - middle)
            for outline in glyph(character).outlines
        ]
        if outlines:
            name = f"{ENGRAVING} {number}{LETTER}{count}"
            letters.append(_letter(character, place, outlines, name, text, key))
    return tuple(letters)


def _places(text: Engraving, key: str) -> Iterator[tuple[str, complex, complex]]:
    """Each character with its place [mm] and the direction in which it is read there.

    Along a circle letters have the distances of straight text where they are nearest to the cam
    axis, at their feet or at their tops.
    """
    advances = [glyph(character).advance for character in text.text]
    moved = [0.0, *(kerning(*pair) for pair in pairwise(text.text))]
    starts = np.cumsum(moved) + np.concatenate(([0.0], np.cumsum(advances)[:-1]))
    first, last = _ink(text.text, starts)
    # Middles of the characters along the line, from the middle of what is drawn of the text.
    sizes = text.height * (starts + 0.5 * np.array(advances) - 0.5 * (first + last))
    ray = cmath.exp(1j * text.angle)
    outward = text.tops == OUTWARD
    if text.along != CIRCLE:
        way = ray * (-1j if outward else 1j)
        if text.turn is not None:
            way = cmath.exp(1j * text.turn)
        for character, size in zip(text.text, sizes.tolist(), strict=True):
            yield character, text.radius * ray + size * way, way
        return
    # The circle on which the letters are nearest to the cam axis, by their feet or their tops.
    radius = text.radius - 0.5 * text.height
    if text.height * (last - first) >= TURN * radius:
        raise GeometryError(
            f"{text.height * (last - first):.4g} mm of text do not fit around"
            f" {TURN * radius:.4g} mm, the circle on which the letters are nearest to the cam axis",
            key=f"{key}.radius",
            value=f"{text.radius:g}",
        )
    for character, size in zip(text.text, sizes.tolist(), strict=True):
        turned = ray * cmath.exp((-1j if outward else 1j) * size / radius)
        yield character, text.radius * turned, turned * (-1j if outward else 1j)


def _ink(text: str, starts: ComplexArray) -> tuple[float, float]:
    """Where the strokes of a straight text begin and end, in heights of capital letters."""
    ends = [
        (start + float(np.min(outline.real)), start + float(np.max(outline.real)))
        for character, start in zip(text, starts.tolist(), strict=True)
        for outline in glyph(character).outlines
    ]
    return min((low for low, _ in ends), default=0.0), max((high for _, high in ends), default=0.0)


def _letter(
    character: str,
    place: complex,
    outlines: list[ComplexArray],
    name: str,
    text: Engraving,
    key: str,
) -> Letter:
    """A letter made of its outlines: holes, and islands that stand within them."""
    coarsest = COARSEST * text.height
    outline_boundaries = [
        LetterBoundary(f"{name} outline {number}", True, outline, coarsest)
        for number, outline in enumerate(outlines, start=1)
    ]
    fits = [boundary.distance_fit(coarsest) for boundary in outline_boundaries]
    contours = [fit.contour for fit in fits]
    for one, other in combinations(contours, 2):
        distance = least_distance(Pieces.around([one]), Pieces.around([other]))
        if distance <= LEAST_GAP * text.height:
            raise GeometryError(
                f'outlines of "{character}" touch each other, which cannot be engraved',
                key=f"{key}.text",
                value=text.text,
            )
    boundaries = []
    for boundary, contour in zip(outline_boundaries, contours, strict=True):
        start = complex(contour.vertices[0])
        around = sum(
            winding_number(other, start) != 0 for other in contours if other is not contour
        )
        boundaries.append(boundary if around % 2 == 0 else replace(boundary, hole=False))
    deviation = max(fit.deviation for fit in fits)
    return Letter(character, place, tuple(boundaries), tuple(contours), deviation)


# -- letter boundary ------------------------------------------------------------------------------
# Outlines of letters as boundaries: closed chains of quadratic Bezier curves and lines.


ARCS: Final = "unchecked arcs"
"""Key of the fits that may cross themselves."""

CLAMPED: Final = np.repeat((0.0, 1.0), 4)
"""Knots of a spline of one cubic."""

SHARPNESS: Final = 0.005
"""Largest share of a measured distance that is due to the arcs by which it is measured."""

FIRST: Final = 2.5e-4
"""First tolerance of these arcs, as a share of the coarsest tolerance of fits."""

FINEST: Final = 1e-10
"""Last tolerance of these arcs, as a share of the outline's distance from the cam axis; it is not
below what a proof needs."""

FOREIGN: Final = 1e-5
"""Tolerance of the arcs by which other programs' splines are measured, as a share of the coarsest
tolerance of fits."""

CLOSE: Final = 1e-3
"""Distance of the control points of two outlines, as a share of their length, up to which they
count as the same curves, compared point by point; beyond it they are compared as curves."""


@dataclass(frozen=True, slots=True, eq=False)
class LetterBoundary(Pickled):
    """A closed outline of a letter as a boundary, see `camgeo.part.part.Boundary`.

    Attributes
    ----------
    pieces : (n, 3) complex [mm], the Bezier points of quadratic curves, end to end; of a line the
        middle one lies halfway. Counter-clockwise once made.
    coarsest : tolerance [mm] beyond which fits become no coarser, so that the narrow strokes of a
        letter, and letters side by side, stay apart.
    known : the fits already made, by form and tolerance, and the deviations already computed.
    """

    name: Name
    hole: Hole
    pieces: ComplexArray
    coarsest: Size
    known: dict[Any, Any] = field(default_factory=dict, init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        check_fields(self)
        pieces = np.asarray(self.pieces, dtype=np.complex128)
        array("part", np.abs(pieces), 2)
        closed = pieces.shape[1:] == (3,) and np.array_equal(
            pieces[:, 2], np.roll(pieces[:, 0], -1)
        )
        if not closed:
            raise GeometryError(
                "must be quadratic curves, end to end and closed", "part", self.name
            )
        if Moments.of_quadratics(pieces).area < 0.0:
            # Both the order of the curves and the points of each are reversed.
            pieces = pieces[::-1, ::-1]
        object.__setattr__(self, "pieces", frozen(pieces, np.complex128))

    @property
    def curve(self) -> SplineContour:
        """The same outline with each quadratic curve as a cubic, which has the same points."""
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
        return np.asarray(middle == 0.5 * (start + end))

    def arcs(self, tolerance: float, effort: Effort = "fewest") -> Fit:
        """Lines and arcs with their ends on the outline, the same at either effort."""
        return self._fit("arcs", tolerance)

    def distance_fit(self, tolerance: float) -> Fit:
        """Like `arcs`."""
        return self._arcs(tolerance)

    def polyline(self, tolerance: float, effort: Effort = "fewest") -> Fit:
        """Straight pieces with vertices on the outline, the same at either effort."""
        return self._fit("polyline", tolerance)

    def sampled(self, tolerance: float) -> Contour:
        """The straight pieces of `polyline`."""
        return self.polyline(tolerance).contour

    def spline(self, tolerance: float, effort: Effort = "fewest") -> SplineFit:
        """The outline itself."""
        self._fit("arcs", tolerance)  # which shows that it does not cross itself
        return SplineFit(self.curve, 0.0, tolerance)

    def _fit(self, form: str, tolerance: float) -> Fit:
        """A fit; GeometryError if it crosses itself, ToleranceError if rounding forbids it."""
        if (form, tolerance) not in self.known:
            fit = self._arcs(tolerance) if form == "arcs" else self._chords(tolerance)
            if crossing(fit.contour) is not None:
                raise GeometryError(f"the {self.name} crosses itself", key="part", value=self.name)
            if fit.deviation > tolerance:
                raise ToleranceError(
                    f"coordinates round too much for the {self.name}", tolerance, fit.deviation
                )
            self.known[form, tolerance] = fit
        known: Fit = self.known[form, tolerance]
        return known

    def _arcs(self, tolerance: float) -> Fit:
        if (ARCS, tolerance) not in self.known:
            approximation = approximating_arcs(self.curve, min(tolerance, self.coarsest))
            self.known[ARCS, tolerance] = Fit(
                approximation.contour, approximation.distance, tolerance
            )
        known: Fit = self.known[ARCS, tolerance]
        return known

    def _chords(self, tolerance: float) -> Fit:
        """Straight pieces with vertices at equal steps of each curve's parameter.

        A quadratic curve deviates from the chord of 1/n of it by at most 1/n^2 of the distance at
        its middle, which is a quarter of |start - 2 middle + end|.
        """
        start, middle, end = self.pieces.T
        bend = 0.25 * np.abs(start - 2.0 * middle + end)
        aim = min(tolerance, self.coarsest)
        counts = np.maximum(1.0, np.ceil(np.sqrt(bend / aim)))
        if np.sum(counts) > MAX_CHORDS:
            raise too_many_error(MAX_CHORDS, "straight pieces", tolerance)
        index, number = grouped(counts.astype(np.intp))
        t = number / counts[index]
        vertices = _curve_points(self.pieces[index], t)
        rounding = 2.0 * ROUNDING * float(np.max(np.abs(self.pieces)))
        # Starts of curves are kept exactly, as the curves before them end there.
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
            distance = _control_point_distance(self.curve, contour.counter_clockwise())
            if distance <= CLOSE * self.curve.length:
                return distance + 2.0 * ROUNDING * self.curve.reach
            by_arcs = approximating_arcs(contour, FOREIGN * self.coarsest)
            return self._deviation(by_arcs.contour) + by_arcs.distance
        share, finest = FIRST * self.coarsest, max(FINEST * self.curve.reach, ENOUGH)
        # The arcs of the outline are refined until they matter little for the distance measured.
        while True:
            fine = self._arcs(share)
            reached = deviation_bound(fine.contour, contour)
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
        return Moments.of_quadratics(self.pieces)

    def second_moments(self, tolerance: float) -> SecondMoments:
        """Exact but for rounding, see `camgeo.part.part.Boundary`."""
        return SecondMoments.of_quadratics(self.pieces)

    def farthest(self) -> tuple[float, float | None]:
        """See `camgeo.part.part.Boundary`; no cam angle belongs to a point of it."""
        return max(self._radii()), None

    def nearest(self) -> float:
        """See `camgeo.part.part.Boundary`."""
        around = winding_number(self._arcs(self.coarsest).contour, 0j)
        return min(self._radii()) if around else 0.0

    def _radii(self) -> list[float]:
        """Distances from the cam axis of the ends of pieces, and of the places in between where the
        distance is extreme: there the point is square to its derivative, which is a cubic equation.
        """
        start, middle, end = self.pieces.T
        a, b = start - 2.0 * middle + end, 2.0 * (middle - start)
        radii: list[float] = np.abs(start).tolist()
        for k in range(len(start)):
            # A point is p t^2 + q t + r; the cubic is the real part of its conjugate times its
            # derivative. Real parts of complex roots only add further points of the curve.
            p, q, r = complex(a[k]), complex(b[k]), complex(start[k])
            cubic = [
                2.0 * abs(p) ** 2,
                3.0 * (p.conjugate() * q).real,
                2.0 * (p.conjugate() * r).real + abs(q) ** 2,
                (q.conjugate() * r).real,
            ]
            turns = np.roots(cubic).real
            inside = turns[(turns > 0.0) & (turns < 1.0)]
            radii += [abs((p * t + q) * t + r) for t in inside.tolist()]
        return radii


def _curve_points(pieces: ComplexArray, t: FloatArray) -> ComplexArray:
    """(n,) points of quadratic curves (n, 3) at `t` (n,)."""
    w = 1.0 - t
    # The Bernstein polynomials of degree 2.
    weights = np.stack((w * w, 2.0 * w * t, t * t), axis=1)
    return np.asarray(np.sum(weights * pieces, axis=1))


def _control_point_distance(one: SplineContour, other: SplineContour) -> float:
    """Largest distance [mm] of corresponding control points of two outlines; infinite unless both
    have the same number of strands, of the same kinds.

    The curves are no farther apart, as each point of one is a weighted mean of its control points.
    """
    kinds = [[type(strand) for strand in contour.strands] for contour in (one, other)]
    count = len(one.strands)
    if len(other.strands) != count:
        return math.inf
    starts = np.array([complex(strand.start) for strand in other.strands])
    # The other outline may begin elsewhere: its strand that starts nearest corresponds to the
    # first.
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
