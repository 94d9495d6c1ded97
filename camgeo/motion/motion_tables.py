"""Motion from CSV tables: a lift, or how the disc turns."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.motion.time_course import SpeedCurve
from camgeo.motion.two_columns import (
    ANGLE,
    LAST_ROW,
    TwoColumns,
    check_from_zero,
    read_two_columns,
    turn_of,
)
from camgeo.numeric import checked
from camgeo.numeric.columns import Column

LIFT: Final = Column("lift", ("s", "lift", "psi", "swing"))

TIME: Final = Column("time", ("t", "time"), ("s", "sec", "second", "seconds"), "s")


def read_lift_table(
    data: bytes | str, file: str, span: float = 360.0, *, periodic: bool = False
) -> TwoColumns:
    """Read a table of cam angle [degrees] and lift.

    The format is that of `camgeo.numeric.columns`; a heading may call the columns "phi", "angle"
    or "cam angle" [deg], and "s", "lift", "psi" or "swing".

    Parameters
    ----------
    data : the file, UTF-8; at most 16,000,000 bytes and 200,000 rows.
    file : its name, for messages.
    span : [degrees] the angle of the last row.
    periodic : whether the last row, which repeats the first one's lift, may be missing.

    Returns
    -------
    Angles, ascending from 0 to the span exactly, and lifts in the unit of the table.

    Raises
    ------
    GeometryError
        With file and line, if the table is not as described: not a number or not a finite one, too
        few or too many rows or cells, angles that do not start at 0, ascend, or end at the span.
    """
    span = checked.positive("span", span, "degrees")
    table = read_two_columns(data, file, (ANGLE, LIFT))
    angles = table.first
    check_from_zero(table, angles, "angle")
    beyond = np.flatnonzero(angles > span * (1.0 + LAST_ROW))
    if len(beyond):
        message = f"beyond the span; allowed: up to {span:.17g} degrees"
        raise table.fault(int(beyond[0]), angles, message)
    if abs(angles[-1] - span) <= LAST_ROW * span and span > angles[-2]:
        return replace(table, first=np.append(angles[:-1], span))
    if not periodic:
        message = f"the last angle; allowed: the end of the span, {span:.17g} degrees"
        raise table.fault(-1, angles, message)
    return table


def read_speed_table(data: bytes | str, file: str) -> SpeedCurve:
    """Read a table of time [s] and cam angle [degrees] over one turn, from 0 and 0.

    The format is that of `camgeo.numeric.columns`; a heading may call the columns "t" or "time"
    [s], and "phi", "angle" or "cam angle" [deg].

    Raises
    ------
    GeometryError
        With file and line, if a row is not as described there, times or angles do not start at 0,
        ascend, or end at 360 degrees; and if the disc would stand still or run backwards between
        the rows.
    """
    table = read_two_columns(data, file, (TIME, ANGLE))
    times = table.first
    check_from_zero(table, times, "time")
    radians = turn_of(table, table.second)
    try:
        return SpeedCurve(times, radians)
    except GeometryError as error:  # whose key is not one of the file
        raise GeometryError(f"{file}: {error.message}", value=error.value) from error
