"""What a picture shows of a mechanism in one position: links, joints, guides, rollers, faces."""

from __future__ import annotations

from dataclasses import dataclass, fields


@dataclass(frozen=True, slots=True)
class Guide:
    """A straight guide.

    Attributes
    ----------
    middle : a point on it [mm]; that of the slider, if there is one.
    direction : unit vector.
    block : whether a slider runs on it, rather than a rod through it.
    """

    middle: complex
    direction: complex
    block: bool = True


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
    """

    links: tuple[tuple[complex, ...], ...] = ()
    joints: tuple[complex, ...] = ()
    shafts: tuple[complex, ...] = ()
    guides: tuple[Guide, ...] = ()
    rollers: tuple[tuple[complex, float], ...] = ()
    faces: tuple[tuple[complex, complex], ...] = ()

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
        guides = [guide.middle for guide in self.guides]
        return (*ends, *self.joints, *self.shafts, *guides, *rims)
