"""Effect `contact-pressure`: Hertzian pressure between cam and follower."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Final, Literal

from camgeo.dynamics.effects.effect import (
    ELASTIC,
    FLATS,
    GIVEN_SPEED,
    ROLLERS,
    STIFF_SHAFT,
    Effect,
    Only,
)
from camgeo.dynamics.effects.results import CONTACT_FORCE
from camgeo.errors import GeometryError
from camgeo.part.materials import Material, find_material
from camgeo.record import schema_beside

# -- table ----------------------------------------------------------------------------------------
# The table ``[effects.contact-pressure]``: materials and limits of the contact.


Bearing = Literal["roller", "ball"]
"""What rolls in the bearing of the roller."""

MATERIAL: Final = "steel-hardened"

OF_FACE: Final = ("face_material", "face_modulus", "face_poisson")
OF_ROLLER: Final = (
    "roller_material", "roller_modulus", "roller_poisson", "rating", "bearing", "life",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class PressureRequirements:
    """Materials, width and limits of the contact.

    Attributes
    ----------
    cam, mate : materials of the cam, and of the roller or face.
    limit : largest pressure allowed [MPa].
    safety : required safety against this limit.
    width : of the contact [mm]; None for that of the part.
    rating : dynamic load rating of the roller bearing [N]; None to compute no life.
    bearing : kind of that bearing.
    life : required life of the bearing [s]; None for no requirement.
    """

    cam: Material
    mate: Material
    limit: float
    safety: float = 1.0
    width: float | None = None
    rating: float | None = None
    bearing: Bearing = "roller"
    life: float | None = None

    @property
    def modulus(self) -> float:
        """Contact modulus E* [MPa], see `hertz`."""
        return 1.0 / (self.cam.compliance + self.mate.compliance)

    @property
    def allowed(self) -> float:
        """Largest pressure with the required safety [MPa]."""
        return self.limit / self.safety


def parse(table: Mapping[str, Any]) -> PressureRequirements:
    """The data of the table.

    Raises
    ------
    GeometryError
        With the key: an unknown material, a material without a limit where the table gives none, a
        rating of 0, a life without a rating, keys of a face together with those of a roller.
    """
    who = "face" if any(key in table for key in OF_FACE) else "roller"
    both = [key for key in OF_ROLLER if key in table] if who == "face" else []
    if both:
        raise GeometryError(
            "is a key of a roller, and cannot be combined with those of a face", key=both[0]
        )
    cam, mate = (_material(each, table) for each in ("cam", who))
    rating, life = table.get("rating"), table.get("life")
    if rating is not None and not rating > 0.0:
        raise GeometryError("the load rating must be above 0 N", key="rating", value=f"{rating:g}")
    if life is not None and rating is None:
        raise GeometryError("needs the load rating of the roller bearing, `rating`", key="life")
    return PressureRequirements(
        cam=cam,
        mate=mate,
        limit=table["limit"] if "limit" in table else _common_limit(cam, mate),
        safety=table.get("safety", 1.0),
        width=table.get("width"),
        rating=rating,
        bearing=table.get("bearing", "roller"),
        life=life,
    )


def _material(who: str, table: Mapping[str, Any]) -> Material:
    key = f"{who}_material"
    found = find_material(table.get(key, MATERIAL), key)
    return replace(
        found,
        modulus=table.get(f"{who}_modulus", found.modulus),
        poisson=table.get(f"{who}_poisson", found.poisson),
    )


def _common_limit(cam: Material, mate: Material) -> float:
    """The smaller limit of the two materials [MPa]."""
    limits = []
    for material in (cam, mate):
        if material.pressure is None:
            raise GeometryError(
                f"is missing: there is no generally accepted limit of the pressure for"
                f" {material.name}",
                key="limit",
            )
        limits.append(material.pressure)
    return min(limits)


# -- contact pressure -----------------------------------------------------------------------------


EFFECT: Final = Effect(
    name="contact-pressure",
    title="pressure between cam and follower",
    compute="camgeo.dynamics.effects.contact_pressure.result:compute",
    schema=schema_beside(__file__),
    parse=parse,
    rules=(Only(ROLLERS, *OF_ROLLER), Only(FLATS, *OF_FACE)),
    needs=(CONTACT_FORCE,),
    numerical=True,
    refined_by=(ELASTIC, GIVEN_SPEED, STIFF_SHAFT),
)
