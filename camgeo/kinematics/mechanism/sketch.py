"""Sketches of mechanisms for pictures: links, joints, guides, rollers and faces.

A sketch shows one position, in which each point is a complex number, or n positions, in which
points that move are arrays (n,) and points that rest remain complex numbers.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any, Generic, TypeVar

import numpy as np

from camgeo.numeric.arrays import ComplexArray

Places = complex | ComplexArray
"""A point in n positions [mm]: (n,), or one complex number for all of them."""

Place = TypeVar("Place", covariant=True)


@dataclass(frozen=True, slots=True)
class Guide(Generic[Place]):
    """A straight guide.

    Attributes
    ----------
    middle : a point on it [mm]; that of the slider, if there is one.
    direction : unit vector along it.
    block : whether a slider runs on it; otherwise a rod runs through it.
    travel : ends [mm] of the way of that point; the guide itself does not move.
    """

    middle: Place
    direction: complex
    block: bool = True
    travel: tuple[complex, ...] = ()


@dataclass(frozen=True, slots=True)
class Dimension(Generic[Place]):
    """A length of the mechanism that a scene states.

    Attributes
    ----------
    key : key of the scene, without the table of the follower or linkage to which it belongs.
    start, end : points between which it is measured [mm].
    vector : whether the scene states both coordinates of `end` relative to `start`.
    negative : whether the scene states the length with a minus sign, for the side on which it lies.
    """

    key: str
    start: Place
    end: Place
    vector: bool = False
    negative: bool = False

    @property
    def value(self: Dimension[complex]) -> tuple[float, ...]:
        """The length, or both coordinates [mm], as the scene states them."""
        way = self.end - self.start
        return (way.real, way.imag) if self.vector else (-abs(way) if self.negative else abs(way),)


@dataclass(frozen=True, slots=True)
class MechanismSketch(Generic[Place]):
    """A mechanism in one or n positions, in the fixed frame with its origin in the cam axis [mm].

    Attributes
    ----------
    links : for each moving body, two or more points to join by a line.
    joints : moving joints.
    shafts : fixed joints, except the cam's.
    guides : straight guides.
    rollers : centre and radius of each roller; the radius of a knife edge is 0.
    faces : start and end of each flat face.
    dimensions : lengths that the scene states.
    """

    links: tuple[tuple[Place, ...], ...] = ()
    joints: tuple[Place, ...] = ()
    shafts: tuple[complex, ...] = ()
    guides: tuple[Guide[Place], ...] = ()
    rollers: tuple[tuple[Place, float], ...] = ()
    faces: tuple[tuple[Place, Place], ...] = ()
    dimensions: tuple[Dimension[Place], ...] = ()

    def of_table(self, name: str) -> MechanismSketch[Place]:
        """The same sketch with the `name` of a table of the scene before the keys of its
        dimensions.
        """
        dimensions = (
            replace(dimension, key=f"{name}.{dimension.key}") for dimension in self.dimensions
        )
        return replace(self, dimensions=tuple(dimensions))

    def __add__(
        self: MechanismSketch[Places], other: MechanismSketch[Places]
    ) -> MechanismSketch[Places]:
        """A sketch with the parts of both."""
        return MechanismSketch(
            *(getattr(self, field.name) + getattr(other, field.name) for field in fields(self))
        )

    def position(self: MechanismSketch[Places], number: int) -> MechanismSketch[complex]:
        """The sketch of the position with that `number`, from 0."""
        return MechanismSketch(
            *(_pick_position(getattr(self, field.name), number) for field in fields(self))
        )

    @property
    def points(self) -> ComplexArray:
        """(m,) [mm] points that a picture must enclose, in all positions."""
        ends: list[Any] = [point for line in (*self.links, *self.faces) for point in line]
        sides = np.array([[1.0], [1j], [-1.0], [-1j]])
        rims: list[Any] = [np.asarray(centre) + radius * sides for centre, radius in self.rollers]
        guides = [point for guide in self.guides for point in (guide.middle, *guide.travel)]
        places = [*ends, *self.joints, *self.shafts, *guides, *rims]
        return np.concatenate([np.zeros(0, np.complex128), *map(np.ravel, places)])


def _pick_position(value: Any, number: int) -> Any:
    """`value` with the entry of that `number` in place of each array of points."""
    if isinstance(value, np.ndarray):
        return complex(value[number])
    if isinstance(value, tuple):
        return tuple(_pick_position(entry, number) for entry in value)
    if isinstance(value, Guide):
        return replace(value, middle=_pick_position(value.middle, number))
    if isinstance(value, Dimension):
        return replace(
            value, start=_pick_position(value.start, number), end=_pick_position(value.end, number)
        )
    return value
