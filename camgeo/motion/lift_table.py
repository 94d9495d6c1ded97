"""A lift given by a table in a CSV file, and the spline through it or near it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.motion.boundary import FREE, Boundary
from camgeo.motion.points import (
    FitReport,
    clamped_spline,
    periodic_spline,
    report,
    smooth_clamped_spline,
    smooth_periodic_spline,
)
from camgeo.motion.spline import Spline
from camgeo.motion.two_columns import (
    Column,
    TwoColumns,
    check_ascending,
    fault,
    read_two_columns,
)
from camgeo.numeric import checked
from camgeo.numeric.arrays import FloatArray
from camgeo.pickled import Pickled

ANGLE: Final = Column("angle", ("phi", "angle", "cam angle"), ("deg", "degree", "degrees", "°"))
LIFT: Final = Column("lift", ("s", "lift", "psi", "swing"))

LAST_ROW: Final = 1e-9
"""By this share of the span may the last angle be off, as 120.00000000001 is from 120."""


@dataclass(frozen=True, slots=True, eq=False)
class LiftTable(Pickled):
    """Lift over the cam angle, row by row.

    Attributes
    ----------
    angle_deg : (n,) [degrees], strictly ascending from 0; the last one is `span`, or smaller in a
        periodic table without its closing row.
    lift : (n,) in the unit of the table.
    span : [degrees] that the table stands for.
    unit : of the lift as the heading tells it, e.g. "mm"; empty where it does not.
    """

    angle_deg: FloatArray
    lift: FloatArray
    span: float
    unit: str = ""

    def __post_init__(self) -> None:
        angle, lift = checked.array("angle_deg", self.angle_deg), checked.array("lift", self.lift)
        if len(angle) < 2 or len(angle) != len(lift) or angle[0] or np.any(np.diff(angle) <= 0.0):
            raise GeometryError(
                "must be 2 angles or more that ascend from 0, as many as lifts",
                key="angle_deg",
                value=checked.shown(angle),
            )
        span = checked.number("span", self.span, least=float(angle[-1]))
        checked.hold(self, angle_deg=angle, lift=lift, span=span)


def read_lift_table(
    data: bytes | str, file: str, span: float = 360.0, *, periodic: bool = False
) -> LiftTable:
    """Read a table of cam angle [degrees] and lift.

    The file is written as `camgeo.motion.two_columns` tells; a heading may call the columns "phi",
    "angle" or "cam angle" [deg], and "s", "lift", "psi" or "swing".

    Parameters
    ----------
    data : the file, UTF-8; at most 16,000,000 bytes and 200,000 rows.
    file : its name, for messages.
    span : [degrees] the angle of the last row.
    periodic : whether the last row, which repeats the first one's lift, may be missing.

    Raises
    ------
    GeometryError
        With file and line, if anything is not as said here: not a number or not a finite one, too
        few or too many rows or cells, angles that do not start at 0, ascend, or end at the span.
    """
    span = checked.positive("span", span, "degrees")
    table = read_two_columns(data, file, (ANGLE, LIFT))
    angles = table.first.copy()
    _check_angles(table, file, span)
    if abs(angles[-1] - span) <= LAST_ROW * span and span > angles[-2]:
        angles[-1] = span
    elif not periodic:
        raise fault(
            file,
            table.lines[-1],
            repr(float(angles[-1])),
            f"the last angle; allowed is the end of the span, {span:.17g} degrees",
        )
    return LiftTable(angles, table.second, span, table.unit)


def _check_angles(table: TwoColumns, file: str, span: float) -> None:
    angles = table.first
    if angles[0] != 0.0:
        raise fault(file, table.lines[0], repr(float(angles[0])), "the first angle; allowed is 0")
    check_ascending(table, angles, file, "angle")
    beyond = np.flatnonzero(angles > span * (1.0 + LAST_ROW))
    if len(beyond):
        place = int(beyond[0])
        raise fault(
            file,
            table.lines[place],
            repr(float(angles[place])),
            f"beyond the span; allowed is up to {span:.17g} degrees",
        )


def fit_table(
    table: LiftTable,
    *,
    periodic: bool,
    largest_deviation: float | None = None,
    length: float | None = None,
    start: Boundary = FREE,
    end: Boundary = FREE,
    gap: float = 0.0,
) -> tuple[Spline, FitReport]:
    """The lift over the cam angle [rad] from 0 as a spline, and its deviation from every row.

    Parameters
    ----------
    table : the rows; the unit of lift is theirs.
    periodic : whether the lift repeats after the table's span; then `start` and `end` are free.
    largest_deviation : allowed deviation at the rows, in the unit of lift; without it and without
        `length` the spline goes through all rows.
    length : cut-off length of the smoothing [rad], instead; see `camgeo.motion.points`.
    start, end : s' [unit/rad] and s'' [unit/rad^2] at the ends, None where free. The ends
        themselves are kept, smoothed or not.
    gap : how far the last row of a periodic table may be from the first one.

    Raises
    ------
    GeometryError
        See `camgeo.motion.points`; and if end conditions are given for a periodic table, or both
        `largest_deviation` and `length`.
    """
    x, y = np.radians(table.angle_deg), table.lift
    smooth = largest_deviation is not None or length is not None
    if periodic:
        if (start, end) != (FREE, FREE):
            raise GeometryError("a periodic table has no ends; allowed are no end conditions")
        period = math.radians(table.span)
        if smooth:
            spline, fit = smooth_periodic_spline(
                x, y, period, largest_deviation=largest_deviation, length=length, gap=gap
            )
            return spline, report(spline, x, y, fit.length)
        spline = periodic_spline(x, y, period, gap=gap)
        return spline, report(spline, x, y)
    if smooth:
        return smooth_clamped_spline(
            x, y, start, end, largest_deviation=largest_deviation, length=length
        )
    spline = clamped_spline(x, y, start, end)
    return spline, report(spline, x, y)
