"""Effect `speed-fluctuation`: speed of a motor-driven cam over a turn in its steady state."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from camgeo.dynamics.effects.effect import ELASTIC, DataFile, Effect
from camgeo.dynamics.effects.results import DRIVE_TORQUE, SPEED_FLUCTUATION
from camgeo.errors import GeometryError
from camgeo.kinematics.tables import check_ascending, read_two_columns
from camgeo.numeric.arrays import FloatArray, frozen
from camgeo.numeric.columns import NumberColumn
from camgeo.record import schema_beside
from camgeo.units import RPM

# -- table ----------------------------------------------------------------------------------------
# The table ``[effects.speed-fluctuation]``: the motor, and the inertia that it drives.


N_MM: Final = 1e3
"""From N m to N mm."""

SPEED: Final = NumberColumn(
    "speed", ("n", "speed"), ("rev/min", "rpm", "1/min", "min-1", "min^-1", "r/min")
)
TORQUE: Final = NumberColumn("torque", ("m", "t", "torque"), ("n m", "nm", "n*m"))

LINE: Final = ("stall_torque", "no_load_speed")


@dataclass(frozen=True, slots=True, eq=False)
class Motor:
    """Torque on the camshaft over its speed.

    It is linear between rows, and the first and last lines are extrapolated.

    Attributes
    ----------
    speeds : (k,) [rad/s], k >= 2, ascending.
    torques : (k,) [N mm], descending.
    """

    speeds: FloatArray
    torques: FloatArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "speeds", frozen(self.speeds, np.float64))
        object.__setattr__(self, "torques", frozen(self.torques, np.float64))

    def torque(self, omega: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Torque [N mm] and its derivative [N mm s] at the speeds `omega` (...) [rad/s]."""
        row = np.clip(np.searchsorted(self.speeds, omega, "right") - 1, 0, len(self.speeds) - 2)
        slope = (np.diff(self.torques) / np.diff(self.speeds))[row]
        return self.torques[row] + slope * (omega - self.speeds[row]), slope

    @property
    def no_load_speed(self) -> float:
        """Speed [rad/s] at which the torque is 0; 0 if it is never positive."""
        if self.torques[-1] > 0.0:
            slope = (self.torques[-1] - self.torques[-2]) / (self.speeds[-1] - self.speeds[-2])
            return float(self.speeds[-1] - self.torques[-1] / slope)
        if self.torques[0] <= 0.0:
            slope = (self.torques[1] - self.torques[0]) / (self.speeds[1] - self.speeds[0])
            return max(float(self.speeds[0] - self.torques[0] / slope), 0.0)
        return float(np.interp(0.0, self.torques[::-1], self.speeds[::-1]))


def parse_motor(table: Mapping[str, Any]) -> Motor:
    """The motor of the table, a straight line or a file.

    Raises
    ------
    GeometryError
        With the key, if neither or both are given; with file and line, if the curve does not fall.
    """
    given = [key for key in LINE if key in table]
    if "file" in table:
        if given:
            raise GeometryError(
                "contradicts file, which also gives the torque of the motor", key=given[0]
            )
        return read_motor(table["file"])
    for key in LINE:
        if key not in table:
            raise GeometryError(
                "is missing: the motor needs stall_torque and no_load_speed, or a file", key=key
            )
    if not table["stall_torque"] > 0.0:
        raise GeometryError(
            "the torque of the motor must fall to 0 at no_load_speed; allowed: above 0 N m",
            key="stall_torque",
            value="0",
        )
    return Motor(
        np.array([0.0, table["no_load_speed"]]),
        np.array([table["stall_torque"], 0.0]),
    )


def read_motor(file: DataFile) -> Motor:
    """The motor of a CSV file: speed [rev/min] and torque [N m].

    See `camgeo.numeric.columns` for the format; a heading may name the columns "n" or "speed",
    and "M", "T" or "torque".
    """
    try:
        table = read_two_columns(file.data, file.name, (SPEED, TORQUE))
        check_ascending(table, table.first, "speed")
        if table.first[0] < 0.0:
            raise table.fault(0, table.first, "a speed below 0 rev/min")
        rises = np.flatnonzero(np.diff(table.second) >= 0.0)
        if len(rises):
            row = int(rises[0]) + 1
            before = float(table.second[row - 1])
            message = f"the previous torque is {before!r}; the torque must decrease"
            raise table.fault(row, table.second, message)
    except GeometryError as error:
        raise GeometryError(error.message, "file", error.value) from error
    return Motor(RPM * table.first, N_MM * table.second)


@dataclass(frozen=True, slots=True)
class MotorDrive:
    """The motor and what it drives.

    Attributes
    ----------
    moment_of_inertia : J of everything that turns with the camshaft [t mm^2], above 0.
    motor : its torque over speed.
    limit : allowed speed fluctuation; None for no limit.
    """

    moment_of_inertia: float
    motor: Motor
    limit: float | None

    @property
    def first_speed(self) -> float | None:
        """A speed [rad/s] near that of the cam: that of the motor alone; None if it never turns."""
        return self.motor.no_load_speed or None


def parse(table: Mapping[str, Any]) -> MotorDrive:
    """The data of the table.

    Raises
    ------
    GeometryError
        With the key, if motor or moment of inertia is missing or invalid.
    """
    inertia = table.get("moment_of_inertia")
    if inertia is None:
        raise GeometryError(
            "is missing: the moment of inertia of everything that turns with the camshaft",
            key="moment_of_inertia",
        )
    if not inertia > 0.0:
        raise GeometryError(
            "without inertia there is no equation of motion for the speed; allowed: above 0",
            key="moment_of_inertia",
            value=f"{inertia:g}",
        )
    return MotorDrive(inertia, parse_motor(table), table.get("limit"))


# -- speed fluctuation ----------------------------------------------------------------------------


EFFECT: Final = Effect(
    name=SPEED_FLUCTUATION,
    title="speed of the motor-driven cam",
    compute="camgeo.dynamics.effects.speed_fluctuation.result:compute",
    schema=schema_beside(__file__),
    parse=parse,
    needs=(DRIVE_TORQUE,),
    tabled=True,
    numerical=True,
    refined_by=(ELASTIC,),
)
