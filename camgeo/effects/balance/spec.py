"""What a scene says about the balance of its disc."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

from camgeo.effects.effect import spec_of
from camgeo.errors import GeometryError

LARGEST_HOLE: Final = 0.25
"""Largest diameter of a balancing hole as a share of its distance from the axis, by default."""


@dataclass(frozen=True, slots=True)
class BalanceSpec:
    """What is asked.

    Attributes
    ----------
    density : of the disc [t/mm^3].
    counterweight_radius : distance of the counterweight's centre of mass from the cam axis [mm];
        None if none is sought.
    hole_radius : distance of balancing holes from the cam axis [mm]; None if none are sought.
    hole_diameter : the largest that is allowed [mm]; None without holes.
    grade : balance quality grade G [mm/s]; None if the disc is held to none.
    """

    density: float
    counterweight_radius: float | None = None
    hole_radius: float | None = None
    hole_diameter: float | None = None
    grade: float | None = None


def parse(table: Mapping[str, Any]) -> BalanceSpec:
    """From the table of the scene.

    Raises
    ------
    GeometryError
        With the key, if there is no such material, or a diameter of holes without their radius.
    """
    if "hole_diameter" in table and "hole_radius" not in table:
        raise GeometryError(
            "needs hole_radius, the distance of the holes from the cam axis", key="hole_diameter"
        )
    told = dict(table)
    if "hole_radius" in table:
        told.setdefault("hole_diameter", LARGEST_HOLE * table["hole_radius"])
    if "density" not in table:
        from camgeo.effects.materials import find_material  # a density needs no table

        told["density"] = find_material(table.get("material", "steel"), "material").density
    return spec_of(BalanceSpec, told)
