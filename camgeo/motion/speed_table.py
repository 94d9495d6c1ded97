"""A disc that turns unevenly, given by a table of its cam angle over time in a CSV file."""

from __future__ import annotations

from typing import Final

from camgeo.errors import GeometryError
from camgeo.motion.time_course import SpeedCurve
from camgeo.motion.two_columns import ANGLE, Column, check_from_zero, read_two_columns, turn_of

TIME: Final = Column("time", ("t", "time"), ("s", "sec", "second", "seconds"))


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
    times = table.first
    check_from_zero(table, times, "time")
    radians = turn_of(table, table.second)
    try:
        return SpeedCurve(times, radians)
    except GeometryError as error:
        raise GeometryError(f"{file}: {error.message}", error.key, error.value) from error
