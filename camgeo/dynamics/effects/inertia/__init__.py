"""Effect `inertia`: the masses that are moved, and their inertia forces."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from camgeo.dynamics.effects.effect import (
    GIVEN_SPEED,
    ROCKING,
    ROLLERS,
    SPEED,
    STIFF_SHAFT,
    STRAIGHT,
    Effect,
    Kind,
    Only,
    Refinement,
)
from camgeo.dynamics.effects.results import INERTIA
from camgeo.errors import GeometryError
from camgeo.record import schema_beside

if TYPE_CHECKING:
    from camgeo.kinematics.mechanism.linkage import Linkage


# -- table ----------------------------------------------------------------------------------------
# The table ``[effects.inertia]``: the masses.


OF_ROCKER: Final = ("moment_of_inertia", "rocker_mass", "rocker_centre")
OF_COUPLER: Final = ("coupler_mass", "coupler_centre", "coupler_moment")


@dataclass(frozen=True, slots=True)
class MassProperties:
    """Masses [t], moments of inertia [t mm^2] and centres of mass [mm].

    Attributes
    ----------
    mass : of the translating member that has the demanded motion.
    moment_of_inertia : of the rocker about its pivot, including the crank of a linkage, without the
        roller.
    roller_mass : at the centre of the roller.
    rocker_mass : without the roller, for its weight and static unbalance.
    rocker_centre : centre of mass of the rocker at cam angle 0, relative to the cam axis; None for
        the pivot.
    coupler_mass : of the coupler of a linkage.
    coupler_centre : of its mass on the line between its joints, 0 at the crank, 1 at the far pin.
    coupler_moment : about its centre of mass; None for that of a slender rod.
    output_moment : about its shaft, of the lever of a four-bar linkage or of a crank driven by a
        slider.
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
        """Inertia of the member with the demanded motion: [t], or [t mm^2] if it turns."""
        return {"mm": self.mass, "rad": self.output_moment}[linkage.unit]

    def turning(self, linkage: Linkage) -> float:
        """Of the coupler about its centre of mass [t mm^2]; by default m l^2/12, a slender rod.

        (Tables of mass properties, e.g. in the appendix of Norton, "Design of Machinery".)
        """
        moment = self.coupler_moment
        return self.coupler_mass * linkage.coupler**2 / 12.0 if moment is None else moment

    def beyond(self, linkage: Linkage | None) -> bool:
        """Whether anything beyond the rocker, behind the linkage, has mass."""
        if linkage is None:
            return False
        return bool(self.far(linkage) or self.coupler_mass or self.coupler_moment)


def parse(table: Mapping[str, Any]) -> MassProperties:
    """The data of the table.

    Raises
    ------
    GeometryError
        With the key, if a centre or moment is given for a body without mass.
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
    return MassProperties(
        rocker_centre=None if centre is None else complex(*centre),
        **rest,
    )


# -- inertia --------------------------------------------------------------------------------------


LINKED: Final = Kind(
    "far", ("",), "is for linkages, and the scene has no [linkage]", "Only with a linkage."
)
TURNING: Final = Kind(
    "far",
    ("", "slider"),
    "is for the lever of a four-bar linkage, or a crank driven by a slider",
    "Only with the lever of a four-bar linkage, or a crank driven by a slider.",
)


EFFECT: Final = Effect(
    name=INERTIA,
    title="inertia force",
    compute="camgeo.dynamics.effects.inertia.result:compute",
    schema=schema_beside(__file__),
    parse=parse,
    rules=(
        Only(ROCKING, *OF_ROCKER),
        Only(ROLLERS, "roller_mass"),
        Only(LINKED, *OF_COUPLER),
        Only(TURNING, "output_moment"),
        Only(STRAIGHT, "mass"),
    ),
    keys=(SPEED,),
    tabled=True,
    premise="motion",
    regardless=("reduced-mass", "reduced-moment-of-inertia"),
    refined_by=(Refinement("vibration", "a rigid follower"), GIVEN_SPEED, STIFF_SHAFT),
)
