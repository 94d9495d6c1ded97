"""What a scene says of friction."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from camgeo.effects.rules import ROLLERS
from camgeo.errors import GeometryError

if TYPE_CHECKING:
    from camgeo.effects.rules import Machine, Table


@dataclass(frozen=True, slots=True)
class Spec:
    """Coefficients of friction and the lengths they need; 0 where there is none.

    Attributes
    ----------
    guide : coefficient in the guide of a translating follower.
    guide_length : b, between the ends at which it carries [mm]; None without any lever.
    guide_overhang : a_0, from the roller centre out to the near end at cam angle 0 [mm].
    guide_viscous : of that guide, or of a linkage's slider [N s/mm].
    pivot : coefficient in the bearing of a rocker.
    pivot_diameter : of that bearing [mm].
    pivot_viscous : of that bearing [N mm s/rad].
    slider : Coulomb's friction of a linkage's slider [N].
    roller_pin : coefficient in the bearing of the roller.
    roller_pin_diameter : of that bearing [mm].
    rolling : lever arm of rolling friction between roller and cam [mm].
    face : coefficient between a flat face and the cam.
    guide_offset : of the guide's axis from the cam axis, to the right looking along the guide away
        from the cam [mm]; of a flat-faced follower, whose motion does not tell.
    """

    guide: float = 0.0
    guide_length: float | None = None
    guide_overhang: float = 0.0
    guide_viscous: float = 0.0
    pivot: float = 0.0
    pivot_diameter: float = 0.0
    pivot_viscous: float = 0.0
    slider: float = 0.0
    roller_pin: float = 0.0
    roller_pin_diameter: float = 0.0
    rolling: float = 0.0
    face: float = 0.0
    guide_offset: float = 0.0


DIAMETERS: Final = {"pivot": "pivot_diameter", "roller_pin": "roller_pin_diameter"}

TILTS: Final = (
    "is missing: a flat face is pressed beside the axis of its guide and tilts in it, by how much"
    " goes with the length of the guide"
)
"""What is said to the friction of a guide of a flat-faced follower that has no length."""

OF_GUIDE: Final = ("guide", "guide_length", "guide_overhang", "guide_offset")
OF_LEVER: Final = ("guide_length", "guide_overhang")
OF_ROLLER: Final = ("roller_pin", "roller_pin_diameter", "rolling")
OF_FACE: Final = ("face", "guide_offset")
OF_PIVOT: Final = ("pivot", "pivot_diameter", "pivot_viscous")


def parse(table: Mapping[str, Any]) -> Spec:
    """From the table of the scene.

    Raises
    ------
    GeometryError
        With the key, if a coefficient lacks the diameter of its bearing, or the overhang or offset
        of a guide its length.
    """
    for coefficient, diameter in DIAMETERS.items():
        if table.get(coefficient) and diameter not in table:
            raise GeometryError(
                f"is missing: {coefficient} needs the diameter of its bearing", key=diameter
            )
    for key, what in (("guide_overhang", "overhang"), ("guide_offset", "offset")):
        if key in table and "guide_length" not in table:
            raise GeometryError(
                f"is missing: the {what} is a lever only of a guide of known length",
                key="guide_length",
            )
    return Spec(**table)


def tilts(machine: Machine, table: Table) -> Iterator[tuple[str, str]]:
    """A flat face that rubs in its guide needs the guide's length, see `Rule`."""
    told = {"guide_overhang", "guide_offset"} & table.values.keys()  # they ask for it themselves
    rubs = machine.touching in ROLLERS.others and table.values.get("guide")
    if rubs and table.lacks("guide_length") and not told:
        yield "guide_length", TILTS
