"""What the scene says of the contact: the table ``[effects.contact-pressure]``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

from camgeo.effects.contact_pressure.hertz import Body, contact_modulus
from camgeo.effects.materials import Material, find_material
from camgeo.errors import GeometryError

MATERIAL: Final = "steel-hardened"


@dataclass(frozen=True, slots=True)
class Spec:
    """The table, numbers converted.

    Attributes
    ----------
    cam, roller : their elasticity.
    limit : largest pressure allowed [MPa].
    safety : against it, which is asked for.
    width : of the contact [mm]; None for that of the part.
    rating : dynamic load rating of the roller's bearing [N]; None if no life is asked for.
    life : asked of it [s]; None for none.
    """

    cam: Body
    roller: Body
    limit: float
    safety: float = 1.0
    width: float | None = None
    rating: float | None = None
    life: float | None = None

    @property
    def modulus(self) -> float:
        """E* [MPa]."""
        return contact_modulus(self.cam, self.roller)

    @property
    def allowed(self) -> float:
        """Largest pressure with the safety that is asked for [MPa]."""
        return self.limit / self.safety


def parse(table: Mapping[str, Any]) -> Spec:
    """From the table of the scene.

    Raises
    ------
    GeometryError
        With its key: an unknown material, a material without a limit where the table gives none,
        a rating of 0, a life without rating.
    """
    cam, roller = (
        find_material(table.get(key, MATERIAL), key) for key in ("cam_material", "roller_material")
    )
    rating, life = table.get("rating"), table.get("life")
    if rating is not None and not rating > 0.0:
        raise GeometryError("the load rating must be above 0 N", key="rating", value=f"{rating:g}")
    if life is not None and rating is None:
        raise GeometryError("needs the load rating of the roller's bearing, `rating`", key="life")
    return Spec(
        cam=_body(cam, "cam", table),
        roller=_body(roller, "roller", table),
        limit=table["limit"] if "limit" in table else _common_limit(cam, roller),
        safety=table.get("safety", 1.0),
        width=table.get("width"),
        rating=rating,
        life=life,
    )


def _body(material: Material, who: str, table: Mapping[str, Any]) -> Body:
    return Body(
        table.get(f"{who}_modulus", material.modulus), table.get(f"{who}_poisson", material.poisson)
    )


def _common_limit(cam: Material, roller: Material) -> float:
    """The smaller pressure of both [MPa]."""
    limits = []
    for material in (cam, roller):
        if material.pressure is None:
            raise GeometryError(
                f"is missing: there is no common figure for the pressure that {material.name}"
                " bears",
                key="limit",
            )
        limits.append(material.pressure)
    return min(limits)
