"""A yoke in the effects: the disc twice, as its two sides touch it.

The second side is handled as the return disc of a conjugate pair: `camgeo.cam.breadth` has the
follower that it is, and the curve on which that runs is the disc's own, half a turn on.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from camgeo.cam.cam import Cam
    from camgeo.effects.effect import Subject
    from camgeo.part.part import Part
    from camgeo.state.contours import HasPart


@dataclass(frozen=True)
class Opposite:
    """A disc as the second side of its yoke touches it; its cam is made on demand."""

    disc: HasPart

    @property
    def cam(self) -> Cam:
        """See `Cam.opposite`."""
        second = self.disc.cam.opposite
        assert second is not None  # it has a yoke
        return second

    @property
    def part(self) -> Part:
        """The same part."""
        return self.disc.part


def astride(subject: Subject) -> Subject:
    """A `subject` whose cam has a yoke, with both sides of it."""
    return replace(subject, returning=replace(subject, disc=Opposite(subject.made)))
