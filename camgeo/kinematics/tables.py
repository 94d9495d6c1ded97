"""Tables of two columns in CSV files, the motions that they state, and the value table of a law."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from decimal import Decimal, localcontext
from fractions import Fraction
from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.kinematics.laws.law import Law
from camgeo.kinematics.time_course import SpeedCurve
from camgeo.numeric import checked
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.columns import Asked, NumberColumn, fault, read_columns
from camgeo.record import Pickled
from camgeo.units import TURN

LIFT: Final = NumberColumn("lift", ("s", "lift", "psi", "swing"))

TIME: Final = NumberColumn("time", ("t", "time"), ("s", "sec", "second", "seconds"), "s")


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
        raise table.fault(
            int(beyond[0]), angles, f"beyond the span; allowed: up to {span:.17g} degrees"
        )
    if abs(angles[-1] - span) <= LAST_ROW * span and span > angles[-2]:
        return replace(table, first=np.append(angles[:-1], span))
    if not periodic:
        raise table.fault(
            -1, angles, f"the last angle; allowed: the end of the span, {span:.17g} degrees"
        )
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


# -- two columns ----------------------------------------------------------------------------------
# Tables of two columns, mostly over the cam angle.


ANGLE: Final = NumberColumn(
    "angle", ("phi", "angle", "cam angle"), ("deg", "degree", "degrees", "°"), "deg"
)

FULL_TURN: Final = 360.0

LAST_ROW: Final = 1e-9
"""The last angle may be off its span by this fraction, as 120.00000000001 is from 120."""


@dataclass(frozen=True, slots=True, eq=False)
class TwoColumns(Pickled, checked.CheckedFields):
    """The rows of a table.

    Attributes
    ----------
    file : its name, for messages.
    first, second : (n,) the numbers.
    unit : of the second column, from its heading; empty if the heading has none.
    lines : (n,) line of the file on which each row stands, from 1.
    """

    file: str
    first: checked.Floats
    second: checked.Floats
    unit: str
    lines: tuple[int, ...]

    def fault(self, row: int, values: FloatArray, message: str) -> GeometryError:
        """The error for the value of a row, counted from 0, or backwards from the end."""
        return fault(self.file, self.lines[row], repr(float(values[row])), message)


def read_two_columns(
    data: bytes | str, file: str, columns: tuple[NumberColumn, NumberColumn]
) -> TwoColumns:
    """Read a table of two numbers a row; format, parameters and errors as of `read_columns`."""
    found = read_columns(data, file, Asked(columns))
    first, second = found.values
    return TwoColumns(file, first, second, found.units[1], found.lines)


def turn_of(table: TwoColumns, angles: FloatArray) -> FloatArray:
    """The `angles` [degrees] in radians, from 0 to one turn.

    Raises GeometryError with the line if they do not ascend from 0 to 360 degrees.
    """
    check_from_zero(table, angles, "angle")
    if not abs(angles[-1] - FULL_TURN) <= LAST_ROW * FULL_TURN:
        raise table.fault(-1, angles, "the last angle; allowed: 360 degrees")
    radians = np.radians(angles)
    radians[-1] = TURN
    return radians


def check_from_zero(table: TwoColumns, values: FloatArray, what: str) -> None:
    """Raise GeometryError with the line of the first row whose `values` do not ascend from 0."""
    if values[0] != 0.0:
        raise table.fault(0, values, f"the first {what}; allowed: 0")
    check_ascending(table, values, what)


def check_ascending(table: TwoColumns, values: FloatArray, what: str) -> None:
    """Raise GeometryError with the line of the first row whose `values` do not ascend."""
    falls = np.flatnonzero(np.diff(values) <= 0.0)
    if len(falls):
        place = int(falls[0]) + 1
        before = float(values[place - 1])
        raise table.fault(
            place, values, f"the {what} before is {before!r}; allowed: only ascending"
        )


# -- value table ----------------------------------------------------------------------------------
# The value table of a normalised law, as the appendix of VDI 2143-1 prints it for four laws.


SMALLEST_STEP: Final = Decimal("0.000001")
LARGEST_STEP: Final = Decimal("0.5")

PRINTED_STEP: Final = Decimal("0.002")
"""The step of the guideline's tables."""

NAMES: Final = ("z", "f", "f1", "f2", "f3")

PRINTED_DECIMALS: Final = (7, 4, 4)
"""Decimals of f, f' and f'' in the guideline's tables."""

PRINTED_DECIMALS_OF_Z: Final = 3
"""Decimals of z; a finer step needs more."""


@dataclass(frozen=True, slots=True, eq=False)
class LawTable(Pickled, checked.CheckedFields):
    """Values of a law at equidistant z.

    Attributes
    ----------
    z : (n,) from 0 to 1, exact.
    values : (n, 5), the columns `NAMES`: z, each rounded once from its decimal, f, f', f'', f'''.
        Right-hand values at the law's borders, left-hand ones at z = 1; no -0.0.
    """

    z: tuple[Decimal, ...]
    values: checked.Floats

    def printed(self) -> list[tuple[str, str, str, str]]:
        """The rows z, f, f', f'' rounded as in the guideline: 7 decimals of f, 4 of f' and f''.

        A double is rounded from all its digits, a tie to the even digit; what rounds to zero has no
        sign. z is exact, with at least three decimals.
        """
        step = f"{self.z[1]:f}".partition(".")[2].rstrip("0")
        places = max(PRINTED_DECIMALS_OF_Z, len(step))
        f, f1, f2 = PRINTED_DECIMALS
        return [
            (f"{z:.{places}f}", f"{row[1]:z.{f}f}", f"{row[2]:z.{f1}f}", f"{row[3]:z.{f2}f}")
            for z, row in zip(self.z, self.values.tolist(), strict=True)
        ]


def law_table(law: Law, step: Decimal | float = PRINTED_STEP) -> LawTable:
    """Tabulate a law at z = 0, step, 2 step, ... below 1, and at 1.

    The multiples are exact, so rounding neither drops nor doubles a row; a step that does not
    divide 1 makes the last interval shorter.

    Parameters
    ----------
    law : any normalised law.
    step : of z, from 1e-6 to 0.5; a float counts as the decimal number that Python prints for it.

    Raises
    ------
    GeometryError
        If the step is outside these limits.
    """
    step = checked.decimal("step", step, SMALLEST_STEP, LARGEST_STEP, what="step of z")
    with localcontext() as context:
        # Fewer than 10^7 multiples: seven digits more than the step has hold each of them.
        context.prec = max(context.prec, len(step.as_tuple().digits) + 7)
        count = math.ceil(1 / Fraction(step))
        z = (*(step * number for number in range(count)), Decimal(1))
    rounded = np.array([float(place) for place in z])
    values = np.column_stack((rounded, *law(rounded)))
    return LawTable(z, values + 0.0)
