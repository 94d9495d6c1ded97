"""What a scene says of the motor and of all that turns."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from camgeo.effects.speed_fluctuation.motor import Motor, parse_motor
from camgeo.errors import GeometryError


@dataclass(frozen=True, slots=True)
class Spec:
    """The table.

    Attributes
    ----------
    moment_of_inertia : J of all that turns with the camshaft [t mm^2], above 0.
    motor : its torque over the speed.
    limit : allowed fluctuation of the speed; None if there is none.
    """

    moment_of_inertia: float
    motor: Motor
    limit: float | None


def parse(table: Mapping[str, Any]) -> Spec:
    """The table of the scene.

    Raises
    ------
    GeometryError
        With the key, if motor or moment of inertia are missing or make no sense.
    """
    inertia = table.get("moment_of_inertia")
    if inertia is None:
        raise GeometryError(
            "is missing: the moment of inertia of all that turns with the camshaft",
            key="moment_of_inertia",
        )
    if not inertia > 0.0:
        raise GeometryError(
            "without inertia the speed follows from no equation of motion; allowed is above 0",
            key="moment_of_inertia",
            value=f"{inertia:g}",
        )
    return Spec(inertia, parse_motor(table), table.get("limit"))
