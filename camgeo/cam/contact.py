"""The flank or flanks of the disc on which the follower runs."""

from __future__ import annotations

from enum import StrEnum

from camgeo.numeric.checked import one_of
from camgeo.outline.path import Flank


class Contact(StrEnum):
    """A contact, by its name in scenes."""

    INNER = "inner"
    OUTER = "outer"
    GROOVE = "groove"

    @property
    def flanks(self) -> tuple[Flank, ...]:
        """The flanks in use, the inner one first."""
        return tuple(Flank) if self is Contact.GROOVE else (Flank(self.value),)

    @property
    def closed_by_form(self) -> bool:
        """Whether the roller is guided on both sides."""
        return len(self.flanks) > 1

    @property
    def runs_inside(self) -> bool:
        """Whether a flank in use encloses material around the cam axis; false for a ring."""
        return Flank.INNER in self.flanks

    @property
    def is_plate(self) -> bool:
        """Whether the disc is a plate whose outline is the flank."""
        return self is Contact.INNER

    @property
    def main(self) -> Flank:
        """The flank that closes the contact, the inner one of a groove."""
        return self.flanks[0]

    @property
    def push(self) -> int:
        """Sign of the force that presses the follower onto that flank, positive outward."""
        return -self.main.sign

    def distances(self, half: float) -> dict[Flank, float]:
        """Signed distance [mm] of each flank in use from the pitch curve.

        `half` is the distance of either flank [mm], positive outward: the inner one lies at -half.
        """
        return {flank: flank.sign * half for flank in self.flanks}


def contact_of(key: str, value: object) -> Contact:
    """The contact of that name; GeometryError with `key` if there is none."""
    return Contact(one_of(key, value, [each.value for each in Contact]))
