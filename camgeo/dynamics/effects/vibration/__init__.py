"""Effect `vibration`: an elastic follower train in its steady state."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from camgeo.dynamics.effects.effect import (
    GIVEN_SPEED,
    SPEED,
    STIFF_SHAFT,
    Effect,
    Kind,
    Only,
    data_of,
)
from camgeo.dynamics.effects.results import INERTIA, LOAD, VIBRATION
from camgeo.errors import GeometryError
from camgeo.record import schema_beside

if TYPE_CHECKING:
    from camgeo.dynamics.oscillator.train import Stage


# -- table ----------------------------------------------------------------------------------------
# The table ``[effects.vibration]``: the elastic follower train.


KINDS: Final = ("natural_frequency", "stiffness", "torsional_stiffness", "masses", "moments")
"""Keys, one of which says what the train is."""

OF_ONE: Final = ("damping", "second")
"""Keys that a train given mass by mass does not have: each mass has its own damping."""


@dataclass(frozen=True, slots=True)
class Second:
    """A second mass on a spring and a damper on the first one.

    Attributes
    ----------
    natural_frequency : with the first mass held fixed [rad/s].
    mass_ratio : to the first mass, above 0.
    damping : damping ratio, in [0, 1).
    """

    natural_frequency: float
    mass_ratio: float
    damping: float = 0.0


@dataclass(frozen=True, slots=True)
class TrainData:
    """The elastic train.

    Attributes
    ----------
    natural_frequency : of the first mass without the second [rad/s]; None if a stiffness gives it.
    stiffness : at the member with the demanded motion [N/mm].
    torsional_stiffness : the same for a rotation [N mm/rad].
    damping : damping ratio.
    limit : largest allowed error of the demanded motion [mm].
    limit_angle : the same for a rotation [rad].
    second : a second mass, or None.
    stages : masses [t or t mm^2], springs and dampers from the cam outwards; empty if the keys
        above give the train.
    output : number of the mass among them that is the output, from 1; None for the last.
    """

    natural_frequency: float | None = None
    stiffness: float | None = None
    torsional_stiffness: float | None = None
    damping: float = 0.0
    limit: float | None = None
    limit_angle: float | None = None
    second: Second | None = None
    stages: tuple[Stage, ...] = ()
    output: int | None = None


def parse(table: Mapping[str, Any]) -> TrainData:
    """The data of the table.

    Raises
    ------
    GeometryError
        If not exactly one key gives the train, its value is 0, or keys contradict each other.
    """
    given = [key for key in KINDS if table.get(key) is not None]
    if not given:
        raise GeometryError(
            "is missing, and so are stiffness, torsional_stiffness, masses and moments: one of"
            " them is needed",
            key="natural_frequency",
        )
    if len(given) > 1:
        raise GeometryError(
            f"cannot be combined with {given[0]}: give only one of them", key=given[1]
        )
    kind = given[0]
    if kind in ("masses", "moments"):
        return _listed(table, kind)
    if not table[kind] > 0.0:
        raise GeometryError(
            "must be above 0, or nothing would move the follower", key=kind, value="0"
        )
    if "output" in table:
        raise GeometryError("needs masses or moments, of which it is the number", key="output")
    second = data_of(Second, table["second"]) if "second" in table else None
    return data_of(TrainData, {**table, "second": second})


def _listed(table: Mapping[str, Any], kind: str) -> TrainData:
    """The train given mass by mass."""
    from camgeo.dynamics.oscillator.train import Stage  # few trains are

    for key in OF_ONE:
        if key in table:
            raise GeometryError(
                f"cannot be combined with {kind}: each mass has its own damping", key=key
            )
    rotary = kind == "moments"
    mass, stiffness, viscous = (
        ("moment", "torsional_stiffness", "viscous_torque")
        if rotary
        else ("mass", "stiffness", "viscous")
    )
    stages = []
    for number, row in enumerate(table[kind], 1):
        for key in (mass, stiffness):
            if not row[key] > 0.0:
                raise GeometryError(f"{key} of number {number} must be above 0", key=kind)
        if "damping" in row and viscous in row:
            raise GeometryError(
                f"damping and {viscous} of number {number} both give its damper; allowed: one",
                key=kind,
            )
        ratio = 2.0 * row.get("damping", 0.0) * math.sqrt(row[stiffness] * row[mass])
        stages.append(
            Stage(
                row[mass],
                row[stiffness],
                row.get(viscous, ratio),
                row.get(f"ground_{stiffness}", 0.0),
                row.get(f"ground_{viscous}", 0.0),
            )
        )
    output = table.get("output")
    if output is not None and output > len(stages):
        raise GeometryError(
            f"is the number of one of the {kind}; allowed: 1 to {len(stages)}",
            key="output",
            value=str(output),
        )
    limits = {key: table[key] for key in ("limit", "limit_angle") if key in table}
    return TrainData(stages=tuple(stages), output=output, **limits)


# -- vibration ------------------------------------------------------------------------------------


ANGLES: Final = Kind(
    "demanded",
    ("mm",),
    "is for a demanded motion that is an angle, and here it is a length",
    "Only where the demanded motion is an angle.",
)
LENGTHS: Final = Kind(
    "demanded",
    ("rad",),
    "is for a demanded motion that is a length, and here it is an angle",
    "Only where the demanded motion is a length.",
)


EFFECT: Final = Effect(
    name=VIBRATION,
    title="vibration of the follower train",
    compute="camgeo.dynamics.effects.vibration.result:compute",
    schema=schema_beside(__file__),
    parse=parse,
    rules=(
        Only(LENGTHS, "stiffness", "limit", "masses"),
        Only(ANGLES, "torsional_stiffness", "limit_angle", "moments"),
    ),
    uses=(INERTIA, LOAD),
    keys=(SPEED,),
    tabled=True,
    numerical=True,
    regardless=("natural-frequency", "time-constant", "settling"),
    refined_by=(GIVEN_SPEED, STIFF_SHAFT),
)
