"""Effect `friction`: Coulomb, rolling and viscous friction, and the margin against jamming."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Final

from camgeo.dynamics.effects.effect import (
    DRIVING_SLIDER,
    FLATS,
    ONE_ROLLER,
    ROCKING,
    ROLLERS,
    ROUND,
    STRAIGHT,
    Effect,
    Kind,
    Machine,
    Only,
    Table,
)
from camgeo.dynamics.effects.results import FRICTION
from camgeo.errors import GeometryError
from camgeo.record import schema_beside

# -- table ----------------------------------------------------------------------------------------
# The table ``[effects.friction]``: coefficients of friction, and lengths.


@dataclass(frozen=True, slots=True)
class FrictionCoefficients:
    """Coefficients of friction and the lengths they need; 0 means no friction.

    Attributes
    ----------
    guide : coefficient in the guide of a translating follower.
    guide_length : b, bearing length between the ends of the guide [mm]; None for no tilting.
    guide_overhang : a_0, from the roller centre outwards to the near end at cam angle 0 [mm].
    guide_viscous : of that guide, or of the slider of a linkage [N s/mm].
    pivot : coefficient in the bearing of a rocker.
    pivot_diameter : of that bearing [mm].
    pivot_viscous : of that bearing [N mm s/rad].
    slider : Coulomb friction of the slider of a linkage [N].
    roller_pin : coefficient in the bearing of the roller.
    roller_pin_diameter : of that bearing [mm].
    rolling : lever arm of rolling friction between roller and cam [mm].
    face : coefficient between a flat face and the cam.
    guide_offset : of the axis of the guide from the cam axis, to the right looking along the guide
        away from the cam [mm]; for a flat-faced follower, whose motion does not depend on it.
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
    "is missing: the cam presses a flat face away from the axis of its guide, so the follower tilts"
    ", and friction depends on the length of the guide"
)
"""Message for guide friction of a flat-faced follower without a guide length."""

OF_GUIDE: Final = ("guide", "guide_length", "guide_overhang", "guide_offset")
OF_LEVER: Final = ("guide_length", "guide_overhang")
OF_ROLLER: Final = ("roller_pin", "roller_pin_diameter", "rolling")
OF_FACE: Final = ("face", "guide_offset")
OF_PIVOT: Final = ("pivot", "pivot_diameter", "pivot_viscous")


def parse(table: Mapping[str, Any]) -> FrictionCoefficients:
    """The data of the table.

    Raises
    ------
    GeometryError
        With the key, if the diameter of a bearing or the length of a guide is missing.
    """
    for coefficient, diameter in DIAMETERS.items():
        if table.get(coefficient) and diameter not in table:
            raise GeometryError(
                f"is missing: {coefficient} needs the diameter of its bearing", key=diameter
            )
    for key, what in (("guide_overhang", "overhang"), ("guide_offset", "offset")):
        if key in table and "guide_length" not in table:
            raise GeometryError(
                f"is missing: the {what} of a guide has an effect only with its length",
                key="guide_length",
            )
    return FrictionCoefficients(**table)


def tilts(machine: Machine, table: Table) -> Iterator[tuple[str, str]]:
    """The `Rule` that a flat-faced follower with guide friction needs the length of the guide."""
    checked = {"guide_overhang", "guide_offset"} & table.values.keys()  # `parse` asks for it then
    rubs = machine.touching in ROLLERS.others and table.values.get("guide")
    if rubs and table.lacks("guide_length") and not checked:
        yield "guide_length", TILTS


# -- friction -------------------------------------------------------------------------------------


GUIDED: Final = Kind(
    "lift",
    ("rad",),
    "is for translating followers, and this follower is a rocker",
    "Translating followers only.",
)


EFFECT: Final = Effect(
    name=FRICTION,
    title="friction in guide, pivot, slider, roller and face",
    compute="camgeo.dynamics.effects.friction.result:compute",
    schema=schema_beside(__file__),
    parse=parse,
    rules=(
        Only(ONE_ROLLER, *OF_LEVER),
        Only(GUIDED, *OF_GUIDE),
        Only(ROCKING, *OF_PIVOT),
        Only(ROLLERS, *OF_ROLLER),
        Only(ROUND, *OF_ROLLER),
        Only(FLATS, *OF_FACE),
        tilts,
        Only(DRIVING_SLIDER, "slider"),
        Only(STRAIGHT, "guide_viscous"),
    ),
    tabled=True,
)
