"""Materials of cams and rollers: a small table with the sources of each row.

The limits are guide values. A contact fails by pitting, with a large scatter that depends on
hardness, case depth, finish, lubrication and slip; a figure from experience or a test belongs in
the scene. The limits of iron and steel are the allowable stress numbers of gear flanks, quality MQ,
sigma_Hlim = A x + B with the hardness x (ISO 6336-5, table of sigma_Hlim): the Hertzian pressure
that 99 of 100 flanks withstand for 5e7 load cycles. Gear flanks have the same kind of contact, a
line contact that rolls and slips a little. There is no such standard for light metals and plastics:
these rows have no limit, and the scene must give one.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

from camgeo.errors import GeometryError, meant

if TYPE_CHECKING:
    from collections.abc import Mapping

PER_CUBIC_CM: Final = 1e-9
"""From g/cm^3 to t/mm^3."""

KG_M3: Final = 1e12
"""From t/mm^3 to kg/m^3."""


_STEEL: Final = "E, nu: EN 1993-1-1, 3.2.6; density: EN 1993-1-2, 3.2.2; "


@dataclass(frozen=True, slots=True)
class Material:
    """An isotropic elastic material.

    Attributes
    ----------
    name : its name in scenes.
    title : description, with the hardness where the limit depends on it.
    modulus : Young's modulus E [MPa].
    poisson : Poisson's ratio nu.
    density : density [t/mm^3].
    pressure : guide value of the largest Hertzian pressure in line contact [MPa], or None.
    source : sources of the numbers.
    """

    name: str
    title: str
    modulus: float
    poisson: float
    density: float
    pressure: float | None
    source: str

    @property
    def compliance(self) -> float:
        """(1 - nu^2)/E [1/MPa]."""
        return (1.0 - self.poisson * self.poisson) / self.modulus


_steel: Final = partial(Material, modulus=210e3, poisson=0.3, density=7.85 * PER_CUBIC_CM)

_ROWS: Final = (
    _steel(
        "steel",
        "structural or plain carbon steel, normalised, 180 HBW",
        pressure=370.0,
        source=f"{_STEEL}limit: ISO 6336-5, normalised low carbon steel, 1.000 x + 190",
    ),
    _steel(
        "steel-tempered",
        "alloy steel, quenched and tempered, e.g. 42CrMo4, 300 HV",
        pressure=767.0,
        source=f"{_STEEL}limit: ISO 6336-5, through-hardened wrought alloy steel, 1.313 x + 373",
    ),
    _steel(
        "steel-nitrided",
        "nitriding steel, quenched, tempered and gas nitrided, 650 to 900 HV",
        pressure=1250.0,
        source=f"{_STEEL}limit: ISO 6336-5, nitrided nitriding steel, 1250 at any hardness",
    ),
    _steel(
        "steel-hardened",
        "case hardened steel, e.g. 16MnCr5, 58 to 62 HRC",
        pressure=1500.0,
        source=f"{_STEEL}limit: ISO 6336-5, case hardened wrought steel, 1500 at any hardness",
    ),
    Material(
        "steel-100cr6",
        "rolling bearing steel, through-hardened, 58 to 64 HRC",
        210e3,
        0.3,
        7.81 * PER_CUBIC_CM,
        1500.0,
        "E, nu: EN 1993-1-1, 3.2.6; density: data sheets of 1.3505; limit: ISO 281:2007, the"
        " pressure at the fatigue load limit of a good bearing steel",
    ),
    Material(
        "cast-iron",
        "grey cast iron EN-GJL-250, 200 HBW",
        110e3,
        0.26,
        7.2 * PER_CUBIC_CM,
        339.0,
        "E (middle of 103 to 118 GPa), nu, density: EN 1561, informative annex; limit: ISO 6336-5,"
        " grey cast iron, 1.033 x + 132",
    ),
    Material(
        "cast-iron-ductile",
        "spheroidal graphite cast iron EN-GJS-600-3, 220 HBW",
        174e3,
        0.275,
        7.2 * PER_CUBIC_CM,
        526.0,
        "E, nu, density: EN 1563, informative annex; limit: ISO 6336-5, nodular cast iron,"
        " 1.434 x + 211",
    ),
    Material(
        "bronze",
        "tin bronze CuSn12-C-GZ, centrifugally cast",
        88.3e3,
        0.35,
        8.6 * PER_CUBIC_CM,
        425.0,
        "E, nu, limit: DIN 3996, worm wheel materials; density: data sheets of CC483K",
    ),
    Material(
        "aluminium",
        "wrought aluminium alloy EN AW-7075, T6",
        71e3,
        0.33,
        2.8 * PER_CUBIC_CM,
        None,
        "E, nu, density: ASM Handbook, volume 2, alloy 7075; no standard for a limit",
    ),
    Material(
        "pom",
        "polyoxymethylene, copolymer, for short times at 23 degrees C",
        2.8e3,
        0.35,
        1.41 * PER_CUBIC_CM,
        None,
        "E (ISO 527), nu, density: data sheets of semi-finished POM-C; no standard for a limit",
    ),
    Material(
        "pa6",
        "polyamide 6, dry, for short times at 23 degrees C",
        3.2e3,
        0.39,
        1.14 * PER_CUBIC_CM,
        None,
        "E (ISO 527), nu, density: data sheets of semi-finished PA 6; moist it has a third of this"
        " modulus; no standard for a limit",
    ),
)

MATERIALS: Final[Mapping[str, Material]] = MappingProxyType({row.name: row for row in _ROWS})
"""All materials, by name."""

USUAL: Final = "steel"
"""Material of a part to be balanced for which none is stated."""


def find_material(name: str, key: str = "") -> Material:
    """The material `name`.

    Parameters
    ----------
    name : as written in the scene.
    key : key of the table, for the message.

    Raises
    ------
    GeometryError
        If there is no material of that name; the message suggests the nearest and lists all.
    """
    if name in MATERIALS:
        return MATERIALS[name]
    hint = meant(name, MATERIALS)
    raise GeometryError(
        f"there is no material {name}{f', {hint}' if hint else ';'} known materials are"
        f" {', '.join(MATERIALS)}",
        key=key,
        value=name,
    )


def table_density(table: Mapping[str, Any]) -> float | None:
    """The density [t/mm^3] of a table: the one stated as `density`, or that of its `material`.

    None if the table states neither. Raises like `find_material`, with key "material".
    """
    stated: float | None = table.get("density")
    if stated is None and "material" in table:
        return find_material(table["material"], "material").density
    return stated
