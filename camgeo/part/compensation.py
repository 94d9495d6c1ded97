"""The part that a printer is given, so that what it makes is the part that the scene states.

First bore and key get their clearance, then everything is scaled about the cam axis, then the
lowest layers are inset: their heights are in millimetres of the file, as a slicer counts them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from itertools import combinations, pairwise
from typing import Annotated, Any, Final

import numpy as np

from camgeo.errors import GeometryError, UndercutError
from camgeo.geometry.contour.contour import (
    EPS,
    Contour,
    Effort,
    Fit,
    proved_gap,
    require_simple,
    winding_number,
)
from camgeo.geometry.contour.parallel import parallel
from camgeo.geometry.contour.spline import Arc, CubicSpline, SplineContour, SplineFit
from camgeo.geometry.outline.outline import real_outline
from camgeo.geometry.outline.path import Moments, Path, SecondMoments
from camgeo.geometry.pitch_curve import WorkingCurve
from camgeo.kinematics.mechanism.values import Length
from camgeo.numeric.checked import CheckedFields, number, positive, whole
from camgeo.part.boundaries import CurveBoundary, ExactBoundary
from camgeo.part.part import Boundary, BoundaryField, Layer, Part
from camgeo.part.spec import PartSpec
from camgeo.record import Pickled

# -- printing --------------------------------------------------------------------------------------
# What a scene states on printing.


LEAST_SHRINKAGE, MOST_SHRINKAGE = -10.0, 20.0
"""Range of the shrinkage of a length, in percent; printed parts of some materials grow."""

MOST_STEPS: Final = 20
"""Most steps of an elephant's foot."""

Percent = Annotated[float, partial(number, least=LEAST_SHRINKAGE, most=MOST_SHRINKAGE, unit="%")]
Steps = Annotated[int, partial(whole, least=1, most=MOST_STEPS)]


@dataclass(frozen=True, slots=True)
class Foot(CheckedFields, path="print.elephant_foot."):
    """How the lowest layers are inset, as the weight of the part and the hot bed squeeze them wide.

    Attributes
    ----------
    inset : distance by which every edge of the lowest face is moved into the material, per side
        [mm].
    height : height above the lowest face from which on the part has its size [mm].
    steps : number of steps of equal height, over which the inset decreases evenly.

    Raises
    ------
    GeometryError
        With the key, if a value is invalid.
    """

    inset: Length
    height: Length
    steps: Steps = 1

    @property
    def insets(self) -> tuple[float, ...]:
        """Inset of each step [mm], from the lowest one upwards."""
        return tuple(self.inset * (self.steps - step) / self.steps for step in range(self.steps))


@dataclass(frozen=True, slots=True)
class Shrinkage(CheckedFields, path="print.shrinkage."):
    """How much smaller a printed part comes out than its file states.

    Attributes
    ----------
    xy, z : shrinkage of a length in the plane of the disc and along the cam axis [%].

    Raises
    ------
    GeometryError
        With the key, if a value is invalid.
    """

    xy: Percent = 0.0
    z: Percent = 0.0

    @property
    def scale_xy(self) -> float:
        """Factor by which the part in the file is larger in the plane of the disc."""
        return 1.0 / (1.0 - 0.01 * self.xy)

    @property
    def scale_z(self) -> float:
        """Factor by which the part in the file is larger along the cam axis."""
        return 1.0 / (1.0 - 0.01 * self.z)


@dataclass(frozen=True, slots=True)
class PrintSpec(CheckedFields, path="print."):
    """`[print]`: how bodies are compensated, and with what nozzle they are printed.

    Attributes
    ----------
    bore_clearance : enlargement of the bore in diameter [mm]; None for none.
    key_clearance : enlargement of the keyway in width [mm], half of it per side; its bottom, and
        the flat of a bore for a D-shaft, lie half of it farther from the cam axis. None for none.
    elephant_foot : compensation of the lowest layers; None for none.
    shrinkage : shrinkage for which the part in the file makes up; None for none.
    nozzle : width of the lines that the nozzle lays down [mm]; None if it is not stated.

    Raises
    ------
    GeometryError
        With the key, if a value is invalid.
    """

    bore_clearance: Length | None = None
    key_clearance: Length | None = None
    elephant_foot: Foot | None = None
    shrinkage: Shrinkage | None = None
    nozzle: Length | None = None

    @property
    def scale_xy(self) -> float:
        """See `Shrinkage`; 1 without one."""
        return 1.0 if self.shrinkage is None else self.shrinkage.scale_xy

    @property
    def scale_z(self) -> float:
        """See `Shrinkage`; 1 without one."""
        return 1.0 if self.shrinkage is None else self.shrinkage.scale_z

    @property
    def compensates(self) -> bool:
        """Whether a printed body differs from the part."""
        return bool(self.facts)

    @property
    def facts(self) -> dict[str, int | float | str]:
        """The compensation as certificates state it; empty if there is none."""
        stated: dict[str, int | float | str] = {}
        for name in ("bore_clearance", "key_clearance"):
            if getattr(self, name) is not None:
                stated[f"{name}_mm"] = getattr(self, name)
        if self.elephant_foot is not None:
            foot = self.elephant_foot
            stated |= {"foot_inset_mm": foot.inset, "foot_height_mm": foot.height}
            stated["foot_steps"] = foot.steps
        if (self.scale_xy, self.scale_z) != (1.0, 1.0):
            stated |= {"scale_xy": self.scale_xy, "scale_z": self.scale_z}
        return stated

    @property
    def text(self) -> str:
        """The compensation in words, lengths in mm; empty if there is none."""
        return "; ".join(self._words())

    def _words(self) -> Iterator[str]:
        if self.bore_clearance is not None:
            side = 0.5 * self.bore_clearance
            yield f"bore {self.bore_clearance:g} mm larger in diameter, {side:g} mm per side"
        if self.key_clearance is not None:
            side = 0.5 * self.key_clearance
            yield f"keyway or flat with {self.key_clearance:g} mm clearance, {side:g} mm per side"
        if self.elephant_foot is not None:
            foot = self.elephant_foot
            steps = f" in {foot.steps} steps" if foot.steps > 1 else ""
            yield f"lowest {foot.height:g} mm drawn in by {foot.inset:g} mm per side{steps}"
        if (self.scale_xy, self.scale_z) != (1.0, 1.0):
            yield f"scaled by {self.scale_xy:.6g} in X and Y, {self.scale_z:.6g} in Z"

    def with_clearance(self, part: PartSpec) -> PartSpec:
        """The part with a larger bore, keyway and flat.

        The bottom of the keyway and the flat move with the clearance of the key, not with that of
        the bore.

        Raises
        ------
        GeometryError
            With the key in `print`, if no such keyway or flat is left.
        """
        if part.bore is None:
            return part
        wider, key = self.bore_clearance or 0.0, self.key_clearance or 0.0
        if not (wider or key):
            return part
        radius = 0.5 * part.bore
        keyway, flat = part.keyway, part.d_shaft
        try:
            if keyway is not None:
                # The depth counts from the edge of the bore, which moves by the bore's clearance.
                bottom = radius + keyway.depth + 0.5 * key
                depth = bottom - (radius + 0.5 * wider)
                keyway = replace(keyway, width=keyway.width + key, depth=depth)
            if flat is not None:
                flat = replace(flat, across=flat.across + 0.5 * (wider + key))
            return replace(part, bore=part.bore + wider, keyway=keyway, d_shaft=flat)
        except GeometryError as error:
            raise self.fault_of_clearance(error) from None

    def fault_of_clearance(self, error: GeometryError) -> GeometryError:
        """The fault of the key that asks for a clearance for which the part has no room."""
        key = "bore_clearance" if self.bore_clearance else "key_clearance"
        value = getattr(self, key)
        return GeometryError(
            f"the part has no room for it: {error}", key=f"print.{key}", value=f"{value:g}"
        )


# -- compensation ----------------------------------------------------------------------------------


TOLERANCE: Final = 1e-3
"""Tolerance of the contours that show that boundaries lie apart [mm]; their deviation is accounted
for."""

FOOT: Final = "foot"
"""Name of the layers that are inset."""


def compensate_part(part: Part, spec: PrintSpec) -> Part:
    """The part as the file has it: scaled, and its lowest layers inset.

    `part` has its clearance already. Raises GeometryError with the key in `print`, if a boundary of
    the lowest face cannot be inset.
    """
    part = _scaled(part, spec.scale_xy, spec.scale_z)
    foot = spec.elephant_foot
    return part if foot is None else _with_foot(part, foot)


def _scaled(part: Part, xy: float, z: float) -> Part:
    if xy == z == 1.0:
        return part
    known = {boundary.name: scaled(boundary, xy) for boundary in part.boundaries}

    def larger(layer: Layer) -> Layer:
        boundaries = tuple(known[boundary.name] for boundary in layer.boundaries)
        return Layer(z * layer.z0, z * layer.z1, boundaries, layer.name)

    bevels = tuple(
        replace(
            bevel,
            boundary=known[bevel.boundary.name],
            edge=scaled(bevel.edge, xy),
            width=xy * bevel.width,
            height=z * bevel.height,
            z=z * bevel.z,
        )
        for bevel in part.bevels
    )
    return Part(tuple(larger(layer) for layer in part.layers), bevels)


def _with_foot(part: Part, foot: Foot) -> Part:
    """The part with its lowest layer inset, step by step."""
    lowest, *others = part.layers
    part.require_heights()
    room = lowest.z1 - lowest.z0
    key = "print.elephant_foot"
    if any(bevel.z == lowest.z0 for bevel in part.bevels):
        raise GeometryError(
            "edges of the lowest face have chamfers: state upper ones only, or no such foot",
            key=key,
        )
    if foot.height >= room:
        raise GeometryError(
            f"must be less than the height of the lowest layer, {room:.6g} mm",
            key=f"{key}.height",
            value=f"{foot.height:g}",
        )
    rise = foot.height / foot.steps
    # The last height is the stated one, not a sum of rounded steps.
    heights = [lowest.z0 + step * rise for step in range(foot.steps)]
    heights.append(lowest.z0 + foot.height)
    layers = []
    for step, ((low, high), inset) in enumerate(
        zip(pairwise(heights), foot.insets, strict=True), start=1
    ):
        try:
            insets = tuple(
                inset_boundary(boundary, inset, f"{boundary.name} at step {step}")
                for boundary in lowest.boundaries
            )
            _require_alike(insets, lowest.boundaries)
        except GeometryError as error:
            raise GeometryError(
                f"the part has no room for it: {error.message}",
                key=f"{key}.inset",
                value=f"{foot.inset:g}",
            ) from None
        layers.append(Layer(low, high, insets, FOOT))
    rest = replace(lowest, z0=heights[-1])
    return replace(part, layers=(*layers, rest, *others))


def _require_alike(moved: tuple[Boundary, ...], originals: tuple[Boundary, ...]) -> None:
    """GeometryError unless the moved boundaries lie apart, each within those in which its original
    lies.
    """
    fits, original_fits = (
        [boundary.distance_fit(TOLERANCE) for boundary in group] for group in (moved, originals)
    )
    for a, b in combinations(range(len(moved)), 2):
        inside = [
            _nested(group_fits[a].contour, group_fits[b].contour)
            for group_fits in (fits, original_fits)
        ]
        if proved_gap(fits[a], fits[b]) <= 0.0 or inside[0] != inside[1]:
            raise GeometryError(
                f"{originals[a].name} and {originals[b].name} would touch", key="part"
            )


def _nested(one: Contour, other: Contour) -> tuple[bool, bool]:
    """Whether the first contour lies in the second, and the second in the first."""
    return (
        winding_number(other, complex(one.vertices[0])) != 0,
        winding_number(one, complex(other.vertices[0])) != 0,
    )


# -- inset ----------------------------------------------------------------------------------------
# Boundaries moved into the material by a distance, each parallel to its original.


def inset_boundary(boundary: Boundary, distance: float, name: str) -> Boundary:
    """The boundary called `name` that lies `distance` [mm] farther in the material.

    Raises
    ------
    GeometryError
        If nothing, or more than one piece, is left of what it bounds, or if it is neither the
        outline of a flank nor lines and arcs, at any scale.
    """
    if isinstance(boundary, ScaledBoundary):
        unscaled = inset_boundary(boundary.unscaled, distance / boundary.factor, name)
        return scaled(unscaled, boundary.factor)
    if isinstance(boundary, ExactBoundary):
        exact = boundary.exact.counter_clockwise()
        try:
            moved = parallel(exact, distance if boundary.hole else -distance)
            require_simple(moved, boundary.name)
        except (GeometryError, UndercutError):
            raise _nothing_left(boundary.name, distance) from None
        return ExactBoundary(name, boundary.hole, moved)
    if isinstance(boundary, CurveBoundary):
        path = _inset_flank(boundary, distance)
        return CurveBoundary(name, boundary.hole, path, boundary.ledger)
    raise GeometryError(f"the {boundary.name} cannot be inset", key="part")


def _inset_flank(boundary: CurveBoundary, distance: float) -> Path:
    """The outline of the disc without a rim of `distance` [mm].

    What a roller leaves of a disc is, without such a rim, what a roller leaves that is larger in
    radius by the distance; with a flat face, what the face leaves that is nearer by it.
    """
    flank = boundary.path.stretches[0].curve
    displacement = distance if boundary.hole else -distance
    if flank.pitch.follower.has_pitch_curve:
        inset = WorkingCurve(flank.pitch, flank.distance + displacement)
    else:
        follower: Any = flank.pitch.follower  # a frozen dataclass
        names = [key.removeprefix("follower.") for key in follower.raising_keys]
        try:
            moved = replace(
                follower, **{name: getattr(follower, name) + displacement for name in names}
            )
        except GeometryError:
            raise _nothing_left(boundary.name, distance) from None
        inset = WorkingCurve(replace(flank.pitch, follower=moved), flank.distance)
    try:
        outline = real_outline(inset)
    except UndercutError:
        raise _nothing_left(boundary.name, distance) from None
    if outline.lobes and len(outline.lobes) > len(real_outline(flank).lobes):
        raise GeometryError(
            f"inset by {distance:g} mm, the {boundary.name} falls into several pieces",
            key="part",
        )
    return outline.path


def _nothing_left(name: str, distance: float) -> GeometryError:
    message = f"an inset of {abs(distance):g} mm leaves nothing of the {name}, or changes its shape"
    return GeometryError(message, key="part")


# -- scaled ---------------------------------------------------------------------------------------
# Boundaries scaled about the cam axis.


ROUNDING: Final = 4.0 * EPS
"""Relative rounding of a scaled coordinate: of the factor, of the product and of the proof at both
ends."""

Factor = Annotated[float, positive]


@dataclass(frozen=True, slots=True)
class ScaledBoundary(Pickled, CheckedFields):
    """A boundary scaled about the cam axis, see `camgeo.part.part.Boundary`.

    Every question is put to the boundary itself, at its own scale: a deviation is proved there and
    multiplied by the factor.

    Attributes
    ----------
    unscaled : the boundary itself.
    factor : ratio of the scaled boundary to the boundary itself.
    """

    unscaled: BoundaryField
    factor: Factor

    @property
    def name(self) -> str:
        """The name of the boundary itself."""
        return self.unscaled.name

    @property
    def hole(self) -> bool:
        """Whether the boundary itself is a hole."""
        return self.unscaled.hole

    def arcs(self, tolerance: float, effort: Effort = "fewest") -> Fit:
        """See `camgeo.part.part.Boundary`."""
        return self._fit(lambda finer: self.unscaled.arcs(finer, effort), tolerance)

    def distance_fit(self, tolerance: float) -> Fit:
        """See `camgeo.part.part.Boundary`."""
        return self._fit(self.unscaled.distance_fit, tolerance)

    def polyline(self, tolerance: float, effort: Effort = "fewest") -> Fit:
        """See `camgeo.part.part.Boundary`."""
        return self._fit(lambda finer: self.unscaled.polyline(finer, effort), tolerance)

    def sampled(self, tolerance: float) -> Contour:
        """See `camgeo.part.part.Boundary`."""
        return scaled_contour(self.unscaled.sampled(tolerance / self.factor), self.factor)

    def _fit(self, fit: Callable[[float], Fit], tolerance: float) -> Fit:
        """A fit of the boundary itself within what rounding leaves of the tolerance, scaled."""
        lost = self._rounding
        unscaled_fit = fit((tolerance - lost) / self.factor)
        contour = scaled_contour(unscaled_fit.contour, self.factor)
        return Fit(contour, unscaled_fit.deviation * self.factor + lost, tolerance)

    def spline(self, tolerance: float, effort: Effort = "fewest") -> SplineFit:
        """See `camgeo.part.part.Boundary`."""
        lost = self._rounding
        unscaled_fit = self.unscaled.spline((tolerance - lost) / self.factor, effort)
        contour = scaled_splines(unscaled_fit.contour, self.factor)
        return SplineFit(contour, unscaled_fit.deviation * self.factor + lost, tolerance)

    def deviation(self, contour: Contour | SplineContour) -> float:
        """See `camgeo.part.part.Boundary`."""
        # The contour is compared at the scale of the boundary itself, where proofs are made.
        back = 1.0 / self.factor
        if isinstance(contour, SplineContour):
            unscaled: Contour | SplineContour = scaled_splines(contour, back)
            reach = contour.reach
        else:
            unscaled = scaled_contour(contour, back)
            reach = float(np.max(np.abs(contour.vertices)))
        return self.unscaled.deviation(unscaled) * self.factor + ROUNDING * reach

    def offset(self, distance: float) -> ScaledBoundary:
        """See `camgeo.part.part.Boundary`."""
        return ScaledBoundary(self.unscaled.offset(distance / self.factor), self.factor)

    @property
    def corner_radius(self) -> float | None:
        """See `camgeo.part.part.Boundary`."""
        radius = self.unscaled.corner_radius
        return None if radius is None else radius * self.factor

    def inset(self, distance: float, name: str) -> ScaledBoundary:
        """See `camgeo.part.part.Boundary`."""
        return ScaledBoundary(self.unscaled.inset(distance / self.factor, name), self.factor)

    def moments(self, tolerance: float) -> Moments:
        """See `camgeo.part.part.Boundary`."""
        unscaled_moments, factor = self.unscaled.moments(tolerance), self.factor
        return Moments(
            unscaled_moments.area * factor**2,
            unscaled_moments.first * factor**3,
            unscaled_moments.area_error * factor**2,
            unscaled_moments.first_error * factor**3,
        )

    def second_moments(self, tolerance: float) -> SecondMoments:
        """See `camgeo.part.part.Boundary`."""
        return self.unscaled.second_moments(tolerance).scaled(self.factor**4)

    def farthest(self) -> tuple[float, float | None]:
        """See `camgeo.part.part.Boundary`."""
        radius, place = self.unscaled.farthest()
        return radius * self.factor, place

    def nearest(self) -> float:
        """See `camgeo.part.part.Boundary`."""
        return self.unscaled.nearest() * self.factor

    @property
    def _rounding(self) -> float:
        """Rounding of a fit's coordinates [mm]."""
        return ROUNDING * self.farthest()[0]


def scaled(boundary: Boundary, factor: float) -> Boundary:
    """The boundary scaled about the cam axis by `factor`; the same object if that is 1."""
    if factor == 1.0:
        return boundary
    if isinstance(boundary, ExactBoundary):
        core = None if boundary.core is None else scaled_contour(boundary.core, factor)
        exact = scaled_contour(boundary.exact, factor)
        return ExactBoundary(boundary.name, boundary.hole, exact, core)
    return ScaledBoundary(boundary, factor)


def scaled_contour(contour: Contour, factor: float) -> Contour:
    """The contour scaled about the origin by `factor`."""
    return Contour(contour.vertices * factor, contour.sweeps, contour.centres * factor)


def scaled_splines(contour: SplineContour, factor: float) -> SplineContour:
    """The contour of splines and arcs scaled about the origin by `factor`."""
    return SplineContour(
        tuple(
            CubicSpline(strand.knots, strand.controls * factor)
            if isinstance(strand, CubicSpline)
            else Arc(
                strand.start * factor, strand.end * factor, strand.sweep, strand.centre * factor
            )
            for strand in contour.strands
        )
    )
