"""What a picture shows of a mechanism in one position: links, joints, guides, rollers, faces."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace


@dataclass(frozen=True, slots=True)
class Guide:
    """A straight guide.

    Attributes
    ----------
    middle : a point on it [mm]; that of the slider, if there is one.
    direction : unit vector.
    block : whether a slider runs on it, rather than a rod through it.
    travel : places [mm] of that point between which it moves; the guide itself stays.
    """

    middle: complex
    direction: complex
    block: bool = True
    travel: tuple[complex, ...] = ()


@dataclass(frozen=True, slots=True)
class Dimension:
    """A length of the mechanism that a scene states.

    Attributes
    ----------
    key : of the scene, from the table of what has it.
    start, end : where it is measured [mm].
    vector : whether the scene states both coordinates of `end` seen from `start`.
    negative : whether the scene states the length with a minus, for the side on which it lies.
    """

    key: str
    start: complex
    end: complex
    vector: bool = False
    negative: bool = False

    @property
    def value(self) -> tuple[float, ...]:
        """The length, or both coordinates [mm]."""
        way = self.end - self.start
        return (way.real, way.imag) if self.vector else (-abs(way) if self.negative else abs(way),)


@dataclass(frozen=True, slots=True)
class MechanismSketch:
    """A mechanism in one position, in the fixed frame with its origin in the cam axis [mm].

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

    links: tuple[tuple[complex, ...], ...] = ()
    joints: tuple[complex, ...] = ()
    shafts: tuple[complex, ...] = ()
    guides: tuple[Guide, ...] = ()
    rollers: tuple[tuple[complex, float], ...] = ()
    faces: tuple[tuple[complex, complex], ...] = ()
    dimensions: tuple[Dimension, ...] = ()

    def of_table(self, name: str) -> MechanismSketch:
        """The same with the `name` of the scene's table before the keys of its dimensions."""
        found = (replace(each, key=f"{name}.{each.key}") for each in self.dimensions)
        return replace(self, dimensions=tuple(found))

    def __add__(self, other: MechanismSketch) -> MechanismSketch:
        """Both together."""
        return MechanismSketch(
            *(getattr(self, each.name) + getattr(other, each.name) for each in fields(self))
        )

    @property
    def points(self) -> tuple[complex, ...]:
        """All points that must fit into a picture."""
        ends = [point for line in (*self.links, *self.faces) for point in line]
        rims = [
            centre + radius * side for centre, radius in self.rollers for side in (1, 1j, -1, -1j)
        ]
        guides = [point for guide in self.guides for point in (guide.middle, *guide.travel)]
        return (*ends, *self.joints, *self.shafts, *guides, *rims)
