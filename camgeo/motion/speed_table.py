"""A disc that turns unevenly, given by a table of its cam angle over time in a CSV file."""

from __future__ import annotations

from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.motion.time_course import SpeedCurve
from camgeo.motion.two_columns import Column, check_ascending, fault, read_two_columns
from camgeo.units import TURN

TIME: Final = Column("time", ("t", "time"), ("s", "sec", "second", "seconds"))
ANGLE: Final = Column("angle", ("phi", "angle", "cam angle"), ("deg", "degree", "degrees", "°"))

FULL_TURN: Final = 360.0

LAST_ROW: Final = 1e-9
"""By this share of a turn may the last angle be off."""


def read_speed_table(data: bytes | str, file: str) -> SpeedCurve:
    """Read a table of time [s] and cam angle [degrees] over one turn, from 0 and 0.

    The file is written as `camgeo.motion.two_columns` tells; a heading may call the columns "t" or
    "time" [s], and "phi", "angle" or "cam angle" [deg].

    Raises
    ------
    GeometryError
        With file and line, if a row is not as said there, times or angles do not start at 0,
        ascend, or end at 360 degrees; and if the disc would stand still or run backwards between
        the rows.
    """
    table = read_two_columns(data, file, (TIME, ANGLE))
    times, angles = table.first, table.second
    for what, values in (("time", times), ("angle", angles)):
        if values[0] != 0.0:
            raise fault(
                file, table.lines[0], repr(float(values[0])), f"the first {what}; allowed is 0"
            )
        check_ascending(table, values, file, what)
    if not abs(angles[-1] - FULL_TURN) <= LAST_ROW * FULL_TURN:
        raise fault(
            file, table.lines[-1], repr(float(angles[-1])), "the last angle; allowed is 360 degrees"
        )
    radians = np.radians(angles)
    radians[-1] = TURN
    try:
        return SpeedCurve(times, radians)
    except GeometryError as error:
        raise GeometryError(f"{file}: {error.message}", error.key, error.value) from error
