"""Effect `spring`: a linear spring that closes the contact."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final, Literal

from camgeo.dynamics.effects.effect import Effect
from camgeo.dynamics.effects.results import SPRING, HelicalSpring
from camgeo.errors import GeometryError
from camgeo.record import schema_beside

# -- table ----------------------------------------------------------------------------------------
# The table ``[effects.spring]``: the spring.


Kind = Literal["compression", "extension", "torsion"]


ENDS: Final = ("anchor", "attachment")


LINEAR: Final = ("stiffness", "preload")


TORSIONAL: Final = ("torsional_stiffness", "preload_torque")


WIRE: Final = "wire"
"""The table of the wire, which states the stiffness in other words."""


INACTIVE: Final = 2.0
"""Coils at squared ends that do not deflect, one at each."""


STEEL: Final = {"shear_modulus": 79300.0, "density": 7.85e-9}
"""Of spring steel [MPa] and [t/mm^3]."""


@dataclass(frozen=True, slots=True)
class SpringData:
    """The data of the spring.

    Attributes
    ----------
    kind : see `Kind`.
    stiffness : k [N/mm], or [N mm/rad] for a torsion spring.
    preload : P at cam angle 0 [N], or [N mm].
    anchor, attachment : the ends of a spring on a rocker at cam angle 0, relative to the cam axis
        [mm].
    helical : the helical spring that has this stiffness; None if the scene states it itself.
    """

    kind: Kind
    stiffness: float
    preload: float
    anchor: complex | None = None
    attachment: complex | None = None
    helical: HelicalSpring | None = None


def parse(table: Mapping[str, Any]) -> SpringData:
    """The data of the table.

    Raises
    ------
    GeometryError
        With the key, if a key for this kind of spring is missing, or one for another kind is given,
        or no spring can be wound of the wire.
    """
    kind: Kind = table.get("kind", "compression")
    article = f"{'an' if kind == 'extension' else 'a'} {kind} spring"
    helical = None
    if WIRE in table:
        helical = _wound(kind, table)
        table = {**table, "stiffness": helical.stiffness}
    own, foreign = (TORSIONAL, (*LINEAR, *ENDS)) if kind == "torsion" else (LINEAR, TORSIONAL)
    for key in own:
        if key not in table:
            raise GeometryError(f"is missing: {article} needs {' and '.join(own)}", key=key)
    for key in foreign:
        if key in table:
            raise GeometryError(
                f"does not belong to {article}, which has {' and '.join(own)}", key=key
            )
    for given, other in (ENDS, ENDS[::-1]):
        if given in table and other not in table:
            raise GeometryError(f"is missing: {given} is only one end of the spring", key=other)
    anchor, attachment = (complex(*table[key]) if key in table else None for key in ENDS)
    return SpringData(kind, float(table[own[0]]), float(table[own[1]]), anchor, attachment, helical)


def _wound(kind: Kind, table: Mapping[str, Any]) -> HelicalSpring:
    """The spring of the table of its wire; raises GeometryError as `parse` does."""
    if kind != "compression":
        raise GeometryError("is for compression springs", key=WIRE)
    if "stiffness" in table:
        raise GeometryError("follows from wire: give only one of them", key="stiffness")
    own = table[WIRE]
    active = own["active_coils"]
    found = HelicalSpring(
        wire=own["diameter"],
        coil=own["coil_diameter"],
        active=active,
        total=own.get("total_coils", active + INACTIVE),
        free_length=own["free_length"],
        shear_modulus=own.get("shear_modulus", STEEL["shear_modulus"]),
        density=own.get("density", STEEL["density"]),
        seats=own.get("seats", "flat"),
        strength=own.get("strength"),
    )
    _refuse_unwindable(found)
    return found


def _refuse_unwindable(spring: HelicalSpring) -> None:
    """Raise GeometryError, with the key, if its dimensions exclude each other."""
    if not spring.coil > spring.wire:
        fault = ("coil_diameter", spring.coil, f"above {spring.wire:g} mm, that of the wire")
    elif spring.total < spring.active:
        fault = ("total_coils", spring.total, f"at least {spring.active:g}, the active coils")
    elif not spring.free_length > spring.solid_length:
        least = f"above {spring.solid_length:g} mm, the length with all coils touching"
        fault = ("free_length", spring.free_length, least)
    else:
        return
    key, value, allowed = fault
    raise GeometryError(f"must be {allowed}", key=f"{WIRE}.{key}", value=f"{value:g}")


# -- spring ---------------------------------------------------------------------------------------


EFFECT: Final = Effect(
    name=SPRING,
    title="force of the spring that closes the contact",
    compute="camgeo.dynamics.effects.spring.result:compute",
    schema=schema_beside(__file__),
    parse=parse,
    tabled=True,
    premise="motion",
)
