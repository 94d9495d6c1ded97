"""What a scene says of the masses."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from camgeo.errors import GeometryError

if TYPE_CHECKING:
    from camgeo.mechanism.linkage_protocol import Linkage

OF_ROCKER: Final = ("moment_of_inertia", "rocker_mass", "rocker_centre")
OF_COUPLER: Final = ("coupler_mass", "coupler_centre", "coupler_moment")


@dataclass(frozen=True, slots=True)
class InertiaSpec:
    """The table ``[effects.inertia]``; masses in t, moments of inertia in t mm^2, lengths in mm.

    Attributes
    ----------
    mass : of what makes the demanded motion along a straight line.
    moment_of_inertia : of the rocker about its pivot, with a linkage's crank, without roller.
    roller_mass : in the roller's centre.
    rocker_mass : without roller, for weight and unbalance.
    rocker_centre : of the rocker's mass at cam angle 0, seen from the cam axis; None: the pivot.
    coupler_mass : of the coupler of a linkage.
    coupler_centre : of its mass on the line of its joints, 0 at the crank's tip, 1 at the pin.
    coupler_moment : about its centre of mass; None: of a slender rod.
    output_moment : about its shaft, of the lever of a four-bar or of a crank that a slider turns.
    """

    mass: float = 0.0
    moment_of_inertia: float = 0.0
    roller_mass: float = 0.0
    rocker_mass: float = 0.0
    rocker_centre: complex | None = None
    coupler_mass: float = 0.0
    coupler_centre: float = 0.5
    coupler_moment: float | None = None
    output_moment: float = 0.0

    def far(self, linkage: Linkage) -> float:
        """What makes the demanded motion behind a linkage: [t], or [t mm^2] if it turns."""
        return {"mm": self.mass, "rad": self.output_moment}[linkage.unit]

    def beyond(self, linkage: Linkage | None) -> bool:
        """Whether anything behind the linkage has a mass."""
        if linkage is None:
            return False
        return bool(self.far(linkage) or self.coupler_mass or self.coupler_moment)


def parse(table: Mapping[str, Any]) -> InertiaSpec:
    """The table, numbers converted.

    Raises
    ------
    GeometryError
        With the key, if a centre or moment is given of what has no mass.
    """
    for key, mass in (
        ("rocker_centre", "rocker_mass"),
        ("coupler_centre", "coupler_mass"),
        ("coupler_moment", "coupler_mass"),
    ):
        if key in table and mass not in table:
            raise GeometryError(f"needs {mass}, which is missing", key=key)
    centre = table.get("rocker_centre")
    rest = {key: value for key, value in table.items() if key != "rocker_centre"}
    return InertiaSpec(
        rocker_centre=None if centre is None else complex(*centre),
        **rest,
    )
