"""What a simulation of a milling program hands on: the material in slabs, and what is wrong."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

import shapely

from camgeo.contour.contour import Contour
from camgeo.toolpath.moves import Point
from camgeo.toolpath.sweep import Area


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """An upright body between two heights [mm]; a point is in it if within an odd number of its
    contours.
    """

    name: str
    z0: float
    z1: float
    contours: tuple[Contour, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Slab:
    """The material between two heights [mm]."""

    z0: float
    z1: float
    material: Area

    @property
    def middle(self) -> float:
        """Height of its middle [mm]."""
        return 0.5 * (self.z0 + self.z1)

    def without(self, area: Area) -> Slab:
        """What is left when `area` is taken away."""
        if self.material.is_empty or area.is_empty:
            return self
        return replace(self, material=shapely.difference(self.material, area))


@dataclass(frozen=True, slots=True, eq=False)
class Stage:
    """The material after an operation, slab by slab from the lowest."""

    operation: str
    slabs: tuple[Slab, ...]

    @property
    def volume(self) -> float:
        """Of the material [mm^3]."""
        return sum((slab.z1 - slab.z0) * float(slab.material.area) for slab in self.slabs)


@dataclass(frozen=True, slots=True)
class Flaw:
    """Something that a machinist would not accept.

    Attributes
    ----------
    name : "rapid", "plunge", "gouge", "obstacle", "depth", "shank", "loose" or "rest".
    operation : in which it arises.
    text : what is wrong, in words.
    value, limit : what was found and what is allowed, in `unit`.
    place : of its largest extent, in the part's coordinates; as the work lies where it is shown.
    watched : whether it is no fault, but something for the machinist to watch.
    """

    name: str
    operation: str
    text: str
    value: float
    limit: float
    place: Point
    unit: str = "mm"
    watched: bool = False

    @property
    def sentence(self) -> str:
        """In words, with its operation and its place."""
        x, y, z = self.place
        return f"{self.operation}: {self.text} at X {x:.4g}, Y {y:.4g}, Z {z:.4g} mm"

    @property
    def excess(self) -> float:
        """By how much the limit is missed."""
        return abs(self.value - self.limit)


def areas(slabs: Iterable[Slab]) -> list[Area]:
    """The material of each."""
    return [slab.material for slab in slabs]


def each_once(found: Callable[[Area], Area], several: Iterable[Area]) -> list[Area]:
    """What is `found` of each of `several`, once for those that are the same object."""
    several = list(several)
    known = {id(area): area for area in several}
    made = {key: found(area) for key, area in known.items()}
    return [made[id(area)] for area in several]
