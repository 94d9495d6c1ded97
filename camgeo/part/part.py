"""The part: layers of closed boundaries, each with its material side."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from itertools import groupby, pairwise
from operator import itemgetter
from typing import Any, Final, Protocol

from camgeo.contour.contour import Contour, Effort, Fit
from camgeo.contour.spline import SplineContour, SplineFit
from camgeo.errors import GeometryError
from camgeo.numeric.checked import finite, hold, instance, number, shown
from camgeo.outline.moments import Moments, SecondMoments

OF_RETURN: Final = "return "
"""What the names of boundaries and layers of the return disc begin with in a pair in one piece."""


class Boundary(Protocol):
    """One closed boundary of the part.

    Attributes
    ----------
    name : its identity, unique in the part: "outline", "inner flank", "outer flank", "rim", "bore",
        "hub", "lower hub", "mark".
        Faces of a solid, dimensions and milling operations refer to it.
    hole : True if the material lies outside the boundary.
    """

    @property
    def name(self) -> str: ...

    @property
    def hole(self) -> bool: ...

    def arcs(self, tolerance: float, effort: Effort = "fewest") -> Fit:
        """Lines and arcs within `tolerance` [mm] of the exact boundary, counter-clockwise."""

    def beside(self, tolerance: float) -> Fit:
        """Lines and arcs within `tolerance` [mm] from which distances are taken, with no library;
        that they do not cross themselves is not shown.
        """

    def polyline(self, tolerance: float, effort: Effort = "fewest") -> Fit:
        """Straight pieces within `tolerance` [mm] of the exact boundary, counter-clockwise."""

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

    def moments(self, tolerance: float) -> Moments:
        """Area and first moments of all that it encloses, counter-clockwise.

        `tolerance` is a share, see `camgeo.outline.moments.path_moments`.
        """

    def second_moments(self, tolerance: float) -> SecondMoments:
        """Second moments of all that it encloses, counter-clockwise; see `moments`."""

    def farthest(self) -> tuple[float, float | None]:
        """Largest distance from the cam axis [mm]; of a flank, with the first cam angle [rad] at
        which that is in contact.
        """

    def nearest(self) -> float:
        """Smallest distance from the cam axis [mm]; 0 if the axis lies outside."""


def require_boundary(value: Any) -> None:
    """Raise GeometryError with key "part" unless `value` has the members of a boundary."""
    if not (isinstance(getattr(value, "name", None), str) and hasattr(value, "offset")):
        raise GeometryError("must be a boundary of a part", "part", shown(value))


@dataclass(frozen=True, slots=True)
class Layer:
    """A slice of the part with a constant section.

    Attributes
    ----------
    z0, z1 : heights of its lower and upper face [mm]; 0 is the upper face of the disc, as in its
        milling program. Equal if the scene does not give the height of the layer.
    boundaries : of the section, nested without crossing; one that contains others precedes or
        follows all of them, and the outermost of the layer is the first of all.
    name : what the layer is for: "disc", "groove", "hub".

    Raises
    ------
    GeometryError
        With key "part" if a height is not finite or the layer upside down, or if it has no
        boundary or two of the same name.
    """

    z0: float
    z1: float
    boundaries: tuple[Boundary, ...]
    name: str = "disc"

    def __post_init__(self) -> None:
        hold(self, z0=finite("part", self.z0, "mm"), z1=finite("part", self.z1, "mm"))
        instance("part", self.name, str, "the name of a layer")
        if self.z0 > self.z1:
            heights = f"from {self.z0} to {self.z1} mm"
            raise GeometryError(f"the {self.name} must reach upwards", key="part", value=heights)
        for each in instance("part", self.boundaries, tuple, "a tuple of boundaries"):
            require_boundary(each)
        names = [each.name for each in self.boundaries]
        if not names or len(set(names)) < len(names):
            message = f"the {self.name} needs boundaries, each with its own name"
            raise GeometryError(message, key="part", value=", ".join(names))


@dataclass(frozen=True, slots=True)
class Wall:
    """The upright face along one boundary, from the height `z0` to `z1` [mm]."""

    boundary: Boundary
    z0: float
    z1: float

    def __post_init__(self) -> None:
        require_boundary(self.boundary)
        hold(self, z0=finite("part", self.z0, "mm"))
        hold(self, z1=number("part", self.z1, least=self.z0, unit="mm"))


@dataclass(frozen=True, slots=True)
class Level:
    """The flat faces at one height.

    Attributes
    ----------
    name : "lower face", "upper face", the same "of the disc" below a hub, of either disc of a pair,
        or the name of the floor between two layers.
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
class Part:
    """The part: layers from the lowest upwards, each on top of the previous one.

    A boundary that extends through several layers is the same object in each.

    Raises
    ------
    GeometryError
        With key "part" if there is no layer, a gap between two, or one name for two boundaries.
    """

    layers: tuple[Layer, ...]

    def __post_init__(self) -> None:
        layers = instance("part", self.layers, tuple, "a tuple of layers")
        if not layers or not all(isinstance(layer, Layer) for layer in layers):
            raise GeometryError("a part needs layers", key="part", value=shown(layers))
        for lower, upper in pairwise(self.layers):
            if lower.z1 != upper.z0:
                message = f"the {upper.name} must begin where the {lower.name} ends"
                raise GeometryError(message, key="part", value=f"{lower.z1} and {upper.z0} mm")
        names = [boundary.name for boundary in self.boundaries]
        if len(set(names)) < len(names):
            message = "each boundary needs its own name"
            raise GeometryError(message, key="part", value=", ".join(names))

    @property
    def boundaries(self) -> tuple[Boundary, ...]:
        """All boundaries, each once, in the order of drawing: as they begin from below."""
        found: list[Boundary] = []
        for layer in self.layers:
            found += [each for each in layer.boundaries if each not in found]
        return tuple(found)

    @property
    def outermost(self) -> Boundary:
        """That of the disc, around all others: hubs lie within it."""
        first = [layer.boundaries[0] for layer in self.layers]
        if all(each is first[0] for each in first):
            return first[0]
        return max(first, key=lambda each: each.farthest()[0])

    @property
    def disc(self) -> tuple[Layer, ...]:
        """The layers of the disc, without hubs."""
        around = self.outermost
        return tuple(layer for layer in self.layers if around in layer.boundaries)

    @property
    def _discs(self) -> dict[str, str]:
        """What the discs are called, by the names of the boundaries around them."""
        around = self.outermost.name.removeprefix(OF_RETURN)
        names = {around: "disc", f"{OF_RETURN}{around}": f"{OF_RETURN}disc"}
        return {name: called for name, called in names.items()
                if any(each.name == name for each in self.boundaries)}  # fmt: skip

    @property
    def thickness(self) -> float:
        """From the lowest to the highest face [mm]; 0 if the scene gives none."""
        return self.layers[-1].z1 - self.layers[0].z0

    def lowered(self) -> Part:
        """The same part with its highest face at height 0."""
        high = self.layers[-1].z1
        if not high:
            return self
        layers = (replace(each, z0=each.z0 - high, z1=each.z1 - high) for each in self.layers)
        return Part(tuple(layers))

    def without(self, names: Collection[str]) -> Part:
        """The same part without the holes and marks of these names."""
        if not names:
            return self

        def left(layer: Layer) -> Layer:
            kept = tuple(each for each in layer.boundaries if each.name not in names)
            return replace(layer, boundaries=kept)

        return Part(tuple(left(layer) for layer in self.layers))

    @property
    def walls(self) -> tuple[Wall, ...]:
        """The upright faces, boundary by boundary; a wall continues through layers."""
        found: list[Wall] = []
        for boundary in self.boundaries:
            there = [boundary in layer.boundaries for layer in self.layers]
            for runs, group in groupby(zip(there, self.layers, strict=True), itemgetter(0)):
                run = [layer for _, layer in group]
                if runs:
                    found.append(Wall(boundary, run[0].z0, run[-1].z1))
        return tuple(found)

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
        """Raise GeometryError, with its key if it is the thickness, for a height within `tolerance`
        [mm], whose faces no file of that tolerance tells apart; and like `require_heights`.
        """
        self.require_heights()
        for layer in self.layers:
            height = layer.z1 - layer.z0
            if not height > tolerance:
                key = "part.thickness" if self.thickness <= tolerance else "part"
                what = f"a solid within {tolerance:g} mm has no layer of {height:g} mm"
                raise GeometryError(f"{what}: its faces would be one", key=key)

    def turned_over(self) -> Part:
        """The same part upside down, its lower face at height 0: the boundaries are the same in X
        and Y, heights are reflected.
        """
        low = self.layers[0].z0
        layers = (replace(each, z0=low - each.z1, z1=low - each.z0) for each in self.layers)
        return Part(tuple(layers)[::-1])

    @property
    def levels(self) -> tuple[Level, ...]:
        """The flat faces, from the lowest upwards; raises like `require_heights`.

        There is none between layers of the same boundaries.
        """
        self.require_heights()
        first, last, discs = self.layers[0], self.layers[-1], self._discs
        found = [Level("lower face", first.z0, (), first.boundaries)]
        for lower, upper in pairwise(self.layers):
            ends = tuple(each for each in lower.boundaries if each not in upper.boundaries)
            begins = tuple(each for each in upper.boundaries if each not in lower.boundaries)
            name = f"floor of the {upper.name}"
            for disc, called in discs.items():
                if disc in (each.name for each in (*ends, *begins)):
                    side = "upper" if disc in (each.name for each in ends) else "lower"
                    name = f"{side} face of the {called}"
            if ends or begins:
                found.append(Level(name, upper.z0, ends, begins))
        return (*found, Level("upper face", last.z1, last.boundaries, ()))
