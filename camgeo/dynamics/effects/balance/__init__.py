"""Effect `balance`: mass, centre of mass and unbalance of the disc."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

from camgeo.dynamics.effects.effect import GIVEN_SPEED, ONE_DISC, STIFF_SHAFT, Effect, Only, data_of
from camgeo.errors import GeometryError
from camgeo.part.materials import USUAL, density_of
from camgeo.record import schema_beside

# -- table ----------------------------------------------------------------------------------------
# The table ``[effects.balance]``: density, grade, and means of balancing.


LARGEST_HOLE: Final = 0.25
"""Largest diameter of a balancing hole as a share of its distance from the axis, by default."""


@dataclass(frozen=True, slots=True)
class BalanceRequirements:
    """Density of the disc, and what is required of its balance.

    Attributes
    ----------
    density : of the disc [t/mm^3].
    counterweight_radius : distance of the counterweight's centre of mass from the cam axis [mm];
        None for no counterweight.
    hole_radius : distance of balancing holes from the cam axis [mm]; None for no holes.
    hole_diameter : the largest diameter allowed [mm]; None without holes.
    grade : balance quality grade G [mm/s]; None for no requirement.
    """

    density: float
    counterweight_radius: float | None = None
    hole_radius: float | None = None
    hole_diameter: float | None = None
    grade: float | None = None


def parse(table: Mapping[str, Any]) -> BalanceRequirements:
    """The data of the table.

    Raises
    ------
    GeometryError
        With the key, if there is no such material, or a hole diameter without a hole radius.
    """
    if "hole_diameter" in table and "hole_radius" not in table:
        raise GeometryError(
            "needs hole_radius, the distance of the holes from the cam axis", key="hole_diameter"
        )
    values = dict(table)
    if "hole_radius" in table:
        values.setdefault("hole_diameter", LARGEST_HOLE * table["hole_radius"])
    values["density"] = density_of({"material": USUAL, **table})
    return data_of(BalanceRequirements, values)


# -- balance --------------------------------------------------------------------------------------


EFFECT: Final = Effect(
    name="balance",
    title="balance of the disc",
    compute="camgeo.dynamics.effects.balance.result:compute",
    schema=schema_beside(__file__),
    parse=parse,
    rules=(Only(ONE_DISC),),
    keys=(("part.thickness",),),
    numerical=True,
    premise="disc",
    refined_by=(GIVEN_SPEED, STIFF_SHAFT),
)
