"""The part: layers of closed boundaries, each with its material side."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator
from dataclasses import dataclass, replace
from functools import partial
from itertools import groupby, pairwise
from operator import itemgetter
from typing import Annotated, Any, Final, Literal, Protocol, overload

from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour, Effort, Fit, Form, winding_number
from camgeo.geometry.contour.spline import SplineContour, SplineFit
from camgeo.geometry.outline.path import Moments, SecondMoments
from camgeo.numeric.checked import (
    CheckedFields,
    Truth,
    check_fields,
    finite,
    hold,
    instance,
    number,
    positive,
    value_text,
)
from camgeo.record import Brief

RETURN_PREFIX: Final = "return "
"""Prefix of the names of the return disc's boundaries and layers in a pair in one piece."""

NARROWEST: Final = 4.0
"""Least width of a chamfer in a solid, in tolerances."""


@dataclass(frozen=True, slots=True)
class Layer:
    """A slice of the part with a constant section.

    Attributes
    ----------
    z0, z1 : heights of its lower and upper face [mm]; 0 is the upper face of the disc, as in its
        milling program. Equal if the scene does not give the height of the layer.
    boundaries : boundaries of the section, nested without crossing; one that contains others
        precedes or follows all of them, and the outermost of the layer is the first of all.
    name : what the layer is for: "disc", "groove", "hub".

    Raises
    ------
    GeometryError
        With key "part" if a height is not finite or the layer upside down, or if it has no
        boundary or two of the same name.
    """

    z0: Height
    z1: Height
    boundaries: Annotated[tuple[Boundary, ...], boundary_tuple, "part"]
    name: Annotated[str, partial(instance, kind=str, what="the name of a layer"), "part"] = "disc"

    def __post_init__(self) -> None:
        check_fields(self)
        if self.z0 > self.z1:
            heights = f"from {self.z0} to {self.z1} mm"
            raise GeometryError(f"the {self.name} must reach upwards", key="part", value=heights)
        names = [boundary.name for boundary in self.boundaries]
        if not names or len(set(names)) < len(names):
            raise GeometryError(
                f"the {self.name} needs boundaries, each with its own name",
                key="part",
                value=", ".join(names),
            )


@dataclass(frozen=True, slots=True)
class Wall:
    """The upright face along one boundary, from the height `z0` to `z1` [mm]."""

    boundary: BoundaryField
    z0: Height
    z1: float

    def __post_init__(self) -> None:
        check_fields(self)
        hold(self, z1=number("part", self.z1, least=self.z0, unit="mm"))


@dataclass(frozen=True, slots=True)
class Level:
    """The flat faces at one height.

    Attributes
    ----------
    name : "lower face" or "upper face"; where a hub stands on the disc, or of either disc of a
        pair, the same followed by "of the disc"; or the name of the floor between two layers.
    z : height [mm].
    below : boundaries that end here; the faces within their material point up.
    above : boundaries that begin here; the faces within their material point down.
    """

    name: str
    z: float
    below: tuple[Boundary, ...]
    above: tuple[Boundary, ...]

    @property
    def boundaries(self) -> tuple[Boundary, ...]:
        """All edges of the faces."""
        return self.below + self.above


@dataclass(frozen=True, slots=True)
class Part(Brief):
    """The part: layers from the lowest upwards, each on top of the previous one.

    A boundary that extends through several layers is the same object in each. Layers, boundaries
    and walls have sharp edges; chamfers show in `bands` and `levels`, of which solids are made.

    Attributes
    ----------
    layers : layers of the part, from the lowest upwards.
    bevels : chamfers of the part, each at an end of a wall.

    Raises
    ------
    GeometryError
        With key "part" if there is no layer, a gap between two, one name for two boundaries, or a
        chamfer that is at no end of a wall, or higher than what is left of it.
    """

    layers: tuple[Layer, ...]
    bevels: tuple[Bevel, ...] = ()

    def __post_init__(self) -> None:
        layers = instance("part", self.layers, tuple, "a tuple of layers")
        if not layers or not all(isinstance(layer, Layer) for layer in layers):
            raise GeometryError("a part needs layers", key="part", value=value_text(layers))
        for lower, upper in pairwise(self.layers):
            if lower.z1 != upper.z0:
                raise GeometryError(
                    f"the {upper.name} must begin where the {lower.name} ends",
                    key="part",
                    value=f"{lower.z1} and {upper.z0} mm",
                )
        names = [boundary.name for boundary in self.boundaries]
        if len(set(names)) < len(names):
            raise GeometryError(
                "each boundary needs its own name", key="part", value=", ".join(names)
            )
        for bevel in instance("part", self.bevels, tuple, "a tuple of chamfers"):
            instance("part", bevel, Bevel, "a chamfer")
        if self.bevels:
            self._require_ends()

    def _require_ends(self) -> None:
        """GeometryError unless each chamfer is at an end of a wall, and leaves some of it."""
        ends = (
            self._bevel(wall.boundary, z, upper=upper)
            for wall in self.walls
            for z, upper in ((wall.z0, False), (wall.z1, True))
        )
        if sum(bevel is not None for bevel in ends) < len(self.bevels):
            raise GeometryError("each chamfer must be at an end of a wall", key="part")
        if any(band.z0 >= band.z1 for band in self.bands):
            raise GeometryError("chamfers must leave some of a wall", key="part")

    @property
    def boundaries(self) -> tuple[Boundary, ...]:
        """All boundaries, each once, in the order of drawing: as they begin from below."""
        distinct: list[Boundary] = []
        for layer in self.layers:
            distinct += [boundary for boundary in layer.boundaries if boundary not in distinct]
        return tuple(distinct)

    @property
    def outermost(self) -> Boundary:
        """The boundary of the disc that surrounds all others; hubs lie within it."""
        first = [layer.boundaries[0] for layer in self.layers]
        # With a hub or a second disc the layers have different ones.
        if all(boundary is first[0] for boundary in first):
            return first[0]
        return max(first, key=lambda boundary: boundary.farthest()[0])

    @property
    def disc(self) -> tuple[Layer, ...]:
        """The layers of the disc, without hubs."""
        around = self.outermost
        return tuple(layer for layer in self.layers if around in layer.boundaries)

    @property
    def _discs(self) -> dict[str, str]:
        """Names of the discs in sentences, by the names of the boundaries around them."""
        around = self.outermost.name.removeprefix(RETURN_PREFIX)
        names = {around: "disc", f"{RETURN_PREFIX}{around}": f"{RETURN_PREFIX}disc"}
        return {name: called for name, called in names.items()
                if any(boundary.name == name for boundary in self.boundaries)}  # fmt: skip

    @property
    def thickness(self) -> float:
        """Distance from the lowest to the highest face [mm]; 0 if the scene states no thickness."""
        return self.layers[-1].z1 - self.layers[0].z0

    @property
    def sharp(self) -> Part:
        """The part without chamfers."""
        return replace(self, bevels=()) if self.bevels else self

    def lowered(self) -> Part:
        """The part with its highest face at height 0, and without chamfers."""
        high = self.layers[-1].z1
        if not high:
            return self.sharp
        layers = (replace(layer, z0=layer.z0 - high, z1=layer.z1 - high) for layer in self.layers)
        return Part(tuple(layers))

    def without(self, names: Collection[str]) -> Part:
        """The part without the holes and marks of the given names."""
        if not names:
            return self

        def remaining(layer: Layer) -> Layer:
            boundaries = tuple(
                boundary for boundary in layer.boundaries if boundary.name not in names
            )
            return replace(layer, boundaries=boundaries)

        return Part(tuple(remaining(layer) for layer in self.layers))

    @property
    def walls(self) -> tuple[Wall, ...]:
        """The upright faces with sharp edges, boundary by boundary; a wall continues through
        layers.
        """
        all_walls: list[Wall] = []
        for boundary in self.boundaries:
            present = [boundary in layer.boundaries for layer in self.layers]
            # Each run of neighbouring layers that have the boundary is one wall.
            for runs, group in groupby(zip(present, self.layers, strict=True), itemgetter(0)):
                run = [layer for _, layer in group]
                if runs:
                    all_walls.append(Wall(boundary, run[0].z0, run[-1].z1))
        return tuple(all_walls)

    def _bevel(self, boundary: Boundary, z: float, *, upper: bool) -> Bevel | None:
        """The chamfer along a boundary at the `upper` or lower end of its wall, at the height z."""
        for bevel in self.bevels:
            if (bevel.z, bevel.upper) == (z, upper) and bevel.boundary == boundary:
                return bevel
        return None

    @property
    def bands(self) -> tuple[Band, ...]:
        """The upright faces and the chamfers at their ends, wall by wall, from below."""
        all_bands: list[Band] = []
        for wall in self.walls:
            boundary, z0, z1 = wall.boundary, wall.z0, wall.z1
            lower, upper = (
                self._bevel(boundary, z0, upper=False),
                self._bevel(boundary, z1, upper=True),
            )
            if lower is not None:
                z0 = lower.foot
                all_bands.append(Band(boundary, lower.edge, boundary, wall.z0, z0, lower.width))
            if upper is not None:
                z1 = upper.foot
            all_bands.append(Band(boundary, boundary, boundary, z0, z1))
            if upper is not None:
                all_bands.append(Band(boundary, boundary, upper.edge, z1, wall.z1, upper.width))
        return tuple(all_bands)

    @property
    def outlines(self) -> tuple[Boundary, ...]:
        """The edges of all bands, each once: the boundaries, followed by the edges of chamfers."""
        edges = list(self.boundaries)
        for bevel in self.bevels:
            if bevel.edge not in edges:
                edges.append(bevel.edge)
        return tuple(edges)

    def _edges(
        self, boundaries: tuple[Boundary, ...], z: float, *, upper: bool
    ) -> Iterator[Boundary]:
        """The edges of the flat faces at the height z where walls end, if `upper`, or begin."""
        for boundary in boundaries:
            bevel = self._bevel(boundary, z, upper=upper)
            yield boundary if bevel is None else bevel.edge

    def require_heights(self) -> None:
        """Raise GeometryError with the key of a height that the scene does not give.

        Such a part can be drawn, but there is no solid and nothing to mill.
        """
        if not self.thickness:
            raise GeometryError("a solid needs part.thickness", key="part.thickness")
        for layer in self.layers:
            if layer.z0 == layer.z1:
                key = f"part.{layer.name}_depth"
                raise GeometryError(f"a solid needs {key}", key=key)

    def require_steps(self, tolerance: float) -> None:
        """Raise GeometryError if a layer or chamfer is too small for a file of `tolerance` [mm].

        The faces of a layer within the tolerance could not be told apart; the error has the key of
        the thickness if that is too small. Also raises like `require_heights`.
        """
        self.require_heights()
        for layer in self.layers:
            height = layer.z1 - layer.z0
            if not height > tolerance:
                key = "part.thickness" if self.thickness <= tolerance else "part"
                message = (
                    f"a solid within {tolerance:g} mm cannot have a layer of {height:g} mm, whose"
                    " faces would be one"
                )
                raise GeometryError(message, key=key)
        least = NARROWEST * tolerance
        for bevel in self.bevels:
            if min(bevel.width, bevel.height) < least:
                raise GeometryError(
                    f"the {bevel.edge.name} must be at least {NARROWEST:g} tolerances wide,"
                    f" {least:g} mm, to show in a solid",
                    key="part.chamfers",
                    value=f"{bevel.width:g}",
                )

    def turned_over(self) -> Part:
        """The part upside down, its lower face at height 0, without chamfers.

        Boundaries keep their X and Y; only heights are reflected.
        """
        low = self.layers[0].z0
        layers = (replace(layer, z0=low - layer.z1, z1=low - layer.z0) for layer in self.layers)
        return Part(tuple(layers)[::-1])

    @property
    def levels(self) -> tuple[Level, ...]:
        """The flat faces from the lowest upwards; raises like `require_heights`.

        Between two layers of the same boundaries there is no face.
        """
        self.require_heights()
        first, last, discs = self.layers[0], self.layers[-1], self._discs
        flat_faces = [Level("lower face", first.z0, (), first.boundaries)]
        for lower, upper in pairwise(self.layers):
            ends = tuple(
                boundary for boundary in lower.boundaries if boundary not in upper.boundaries
            )
            begins = tuple(
                boundary for boundary in upper.boundaries if boundary not in lower.boundaries
            )
            name = f"floor of the {upper.name}"
            # A face at which a disc begins or ends is named after that disc.
            for disc, called in discs.items():
                if disc in (boundary.name for boundary in (*ends, *begins)):
                    side = "upper" if disc in (boundary.name for boundary in ends) else "lower"
                    name = f"{side} face of the {called}"
            if ends or begins:
                flat_faces.append(Level(name, upper.z0, ends, begins))
        flat_faces.append(Level("upper face", last.z1, last.boundaries, ()))
        if not self.bevels:
            return tuple(flat_faces)
        return tuple(
            replace(
                level,
                below=tuple(self._edges(level.below, level.z, upper=True)),
                above=tuple(self._edges(level.above, level.z, upper=False)),
            )
            for level in flat_faces
        )


# -- boundary -------------------------------------------------------------------------------------
# What every closed boundary of a part can do.


WRITTEN_SHARE: Final = 0.98
"""Share of the tolerance that the fit of a written contour may use; the rest is for rounding to the
nearest double and for the slack of the bound by which the file is measured."""


class Boundary(Protocol):
    """One closed boundary of the part.

    Attributes
    ----------
    name : name that is unique in the part: "outline", "inner flank", "outer flank", "rim", "bore",
        "hub", "lower hub", "mark".
        Faces of a solid, dimensions and milling operations refer to it.
    hole : True if the material lies outside the boundary.
    """

    @property
    def name(self) -> str: ...

    @property
    def hole(self) -> bool: ...

    @property
    def corner_radius(self) -> float | None:
        """Radius [mm] of the smallest arc that ends at a corner; None if there is none."""

    def arcs(self, tolerance: float, effort: Effort = "fewest") -> Fit:
        """Lines and arcs within `tolerance` [mm] of the exact boundary, counter-clockwise."""

    def distance_fit(self, tolerance: float) -> Fit:
        """Lines and arcs within `tolerance` [mm] from which distances are taken, with no library;
        that they do not cross themselves is not shown.
        """

    def polyline(self, tolerance: float, effort: Effort = "fewest") -> Fit:
        """Straight pieces within `tolerance` [mm] of the exact boundary, counter-clockwise."""

    def sampled(self, tolerance: float) -> Contour:
        """Straight pieces for pictures, counter-clockwise: where a flank was sampled, they are
        within `tolerance` [mm] of it. Nothing is proved.
        """

    def spline(self, tolerance: float, effort: Effort = "fewest") -> SplineFit:
        """Cubic splines and arcs within `tolerance` [mm] of the exact boundary,
        counter-clockwise.
        """

    def deviation(self, contour: Contour | SplineContour) -> float:
        """Proved upper bound [mm] on the distance between `contour` and the exact boundary."""

    def offset(self, distance: float) -> Boundary:
        """The path of a cutter's centre at `distance` [mm], on the side without material.

        A hole gives a hole. Raises GeometryError if the boundary has no such parallel curve.
        """

    def inset(self, distance: float, name: str) -> Boundary:
        """The exact parallel at `distance` [mm] within the material, with a name of its own.

        Nothing is trimmed: `camgeo.part.assembly` makes sure that there is such a parallel. Corners
        of lines and arcs stay corners; of a flank there are none, or GeometryError is raised.
        """

    def moments(self, tolerance: float) -> Moments:
        """Area and first moments of all that it encloses, counter-clockwise.

        `tolerance` is a share, see `camgeo.geometry.outline.path.Path.moments`.
        """

    def second_moments(self, tolerance: float) -> SecondMoments:
        """Second moments of all that it encloses, counter-clockwise; see `moments`."""

    def farthest(self) -> tuple[float, float | None]:
        """Largest distance from the cam axis [mm]; of a flank, with the first cam angle [rad] at
        which that is in contact.
        """

    def nearest(self) -> float:
        """Smallest distance from the cam axis [mm]; 0 if the axis lies outside."""


@overload
def written_contour(
    boundary: Boundary,
    form: Literal["arcs", "polyline"],
    effort: Effort,
    tolerance: float,
    widest: float = ...,
) -> Fit: ...
@overload
def written_contour(
    boundary: Boundary, form: Form, effort: Effort, tolerance: float, widest: float = ...
) -> Fit | SplineFit: ...
def written_contour(
    boundary: Boundary, form: Form, effort: Effort, tolerance: float, widest: float = math.pi
) -> Fit | SplineFit:
    """The contour of `boundary` that is written into a file, counter-clockwise, with its proof.

    All files that have it, the follower's motion on it and its cost are based on this contour.

    Parameters
    ----------
    form : kind of its pieces.
    effort : effort of the fit.
    tolerance : tolerance of the file [mm], of which the fit takes `WRITTEN_SHARE`.
    widest : largest sweep of an arc [rad]; wider arcs are divided.

    Raises
    ------
    ToleranceError, GeometryError
        As `Boundary` does.
    """
    fit: Any = getattr(boundary, form)(WRITTEN_SHARE * tolerance, effort)  # a method for each form
    written: Fit | SplineFit = replace(fit, contour=fit.contour.split(widest))
    return written


def require_boundary(value: Any) -> None:
    """Raise GeometryError with key "part" unless `value` has the members of a boundary."""
    if not (isinstance(getattr(value, "name", None), str) and hasattr(value, "offset")):
        raise GeometryError("must be a boundary of a part", "part", value_text(value))


def valid_boundary(_: str, value: Any) -> Boundary:
    """`value`; raises as `require_boundary`."""
    require_boundary(value)
    boundary: Boundary = value
    return boundary


def boundary_tuple(key: str, value: Any) -> tuple[Boundary, ...]:
    """`value`; GeometryError with `key` unless it is a tuple, and as `require_boundary`."""
    for boundary in instance(key, value, tuple, "a tuple of boundaries"):
        require_boundary(boundary)
    boundaries: tuple[Boundary, ...] = value
    return boundaries


BoundaryField = Annotated[Boundary, valid_boundary, "part"]
Height = Annotated[float, partial(finite, unit="mm"), "part"]
Size = Annotated[float, partial(positive, unit="mm"), "part"]


# -- bands ----------------------------------------------------------------------------------------
# The faces around a part: upright ones, and chamfers at their ends.


@dataclass(frozen=True, slots=True)
class Bevel(CheckedFields):
    """A chamfer along one end of a wall.

    Attributes
    ----------
    boundary : boundary of the wall.
    edge : edge at which the chamfer meets the flat face, the parallel of the boundary at `width`.
    width : width on the face [mm].
    height : height along the wall [mm].
    z : height of the face [mm].
    upper : whether the face is at the upper end of the wall.
    """

    boundary: BoundaryField
    edge: BoundaryField
    width: Size
    height: Size
    z: Height
    upper: Annotated[Truth, "part"]

    @property
    def foot(self) -> float:
        """Height at which the chamfer meets the wall [mm]."""
        return self.z - self.height if self.upper else self.z + self.height


@dataclass(frozen=True, slots=True)
class Band:
    """The face around a part between two heights: what chamfers leave of a wall, or a chamfer.

    Attributes
    ----------
    wall : the boundary that the face runs along.
    lower, upper : lower and upper edge of the face, the same for an upright one.
    z0, z1 : heights of these edges [mm].
    width : width of a chamfer in the plane [mm]; 0 for an upright face.
    """

    wall: Boundary
    lower: Boundary
    upper: Boundary
    z0: float
    z1: float
    width: float = 0.0

    @property
    def is_upright(self) -> bool:
        """Whether the face is upright, and not a chamfer."""
        return self.lower is self.upper

    def section(self, z: float) -> Boundary:
        """The section of the face at a height `z` between its edges [mm]."""
        if self.is_upright:
            return self.wall
        away = self.z1 - z if self.lower is not self.wall else z - self.z0
        distance = self.width * away / (self.z1 - self.z0)
        return self.wall.inset(distance, f"section of the {self.wall.name}")


# -- edges ----------------------------------------------------------------------------------------
# The edges of a part seen from above: which go through the disc, which end at a depth.
#
# A drawing has one edge per boundary. Whoever cuts a part from a sheet needs to know which edges go
# through; a blind one would be cut through otherwise.


Kind = Literal["through", "sunk", "raised"]
"""An edge goes through the disc, is sunk into it from a face, or stands on a face of it."""


COARSE: Final = 0.01
"""Tolerance [mm] of the contours that show which holes lie within others."""


@dataclass(frozen=True, slots=True)
class PartEdge:
    """A boundary as it is drawn.

    Attributes
    ----------
    boundary : boundary of the part.
    kind : see `Kind`.
    below : whether the edge begins at the lower face of the disc, and not at the upper one.
    height : depth or height over that face [mm]; 0 if the edge goes through, or if the scene does
        not state it.
    """

    boundary: Boundary
    kind: Kind = "through"
    below: bool = False
    height: float = 0.0


def part_edges(part: Part) -> tuple[PartEdge, ...]:
    """The edges, in the order of the part's boundaries."""
    return tuple(_edge(part, boundary) for boundary in part.boundaries)


def _edge(part: Part, boundary: Boundary) -> PartEdge:
    """The edge of a boundary: through if it passes all layers of the disc, raised if it is in none
    of them, else sunk, from the face to which it is open.
    """
    disc = part.disc
    if all(boundary in layer.boundaries or _is_open(boundary, layer) for layer in disc):
        return PartEdge(boundary)
    bottom, top = disc[0].z0, disc[-1].z1
    layers = [layer for layer in part.layers if boundary in layer.boundaries]
    z0, z1 = layers[0].z0, layers[-1].z1
    if not any(layer in disc for layer in layers):
        below = layers[-1] in part.layers[: part.layers.index(disc[0])]
        return PartEdge(boundary, "raised", below, bottom - z0 if below else z1 - top)
    below = boundary in disc[0].boundaries
    return PartEdge(boundary, "sunk", below, z1 - bottom if below else top - z0)


def _is_open(boundary: Boundary, layer: Layer) -> bool:
    """Whether a hole continues through a layer within a wider hole, as below a counterbore."""
    if not boundary.hole:
        return False
    start = complex(boundary.distance_fit(COARSE).contour.vertices[0])
    return any(
        other.hole and winding_number(other.distance_fit(COARSE).contour, start)
        for other in layer.boundaries
    )
