"""The table ``[effects.vibration]``: the elastic follower train."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from camgeo.effects.effect import data_of
from camgeo.errors import GeometryError

if TYPE_CHECKING:
    from camgeo.numeric.oscillator.train import Second


FREQUENCY_KEYS: Final = ("natural_frequency", "stiffness", "torsional_stiffness")


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
    """

    natural_frequency: float | None = None
    stiffness: float | None = None
    torsional_stiffness: float | None = None
    damping: float = 0.0
    limit: float | None = None
    limit_angle: float | None = None
    second: Second | None = None


def parse(table: Mapping[str, Any]) -> TrainData:
    """The data of the table.

    Raises
    ------
    GeometryError
        If not exactly one key gives the natural frequency, or its value is 0.
    """
    given = [key for key in FREQUENCY_KEYS if table.get(key) is not None]
    if not given:
        raise GeometryError(
            "is missing, and so are stiffness and torsional_stiffness: one of the three is needed",
            key="natural_frequency",
        )
    if len(given) > 1:
        raise GeometryError(
            f"cannot be combined with {given[0]}: give only one of them", key=given[1]
        )
    if not table[given[0]] > 0.0:
        raise GeometryError(
            "must be above 0, or nothing would move the follower", key=given[0], value="0"
        )
    second = None
    if "second" in table:
        from camgeo.numeric.oscillator.train import Second  # few trains have one

        own = table["second"]
        second = Second(own["natural_frequency"], own["mass_ratio"], own.get("damping", 0.0))
    return data_of(TrainData, {**table, "second": second})
