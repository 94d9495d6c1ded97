"""Tables of two columns in CSV files, mostly over the cam angle."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.numeric import checked
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.columns import NumberColumn, RequestedColumns, fault, read_columns
from camgeo.record import Pickled
from camgeo.units import TURN

LIFT: Final = NumberColumn("lift", ("s", "lift", "psi", "swing"))

ANGLE: Final = NumberColumn(
    "angle", ("phi", "angle", "cam angle"), ("deg", "degree", "degrees", "°"), "deg"
)

FULL_TURN: Final = 360.0

LAST_ROW: Final = 1e-9
"""The last angle may differ from the span by this fraction, as 120.00000000001 differs from 120."""


@dataclass(frozen=True, slots=True, eq=False)
class TwoColumns(Pickled, checked.CheckedFields):
    """The rows of a table.

    Attributes
    ----------
    file : its name, for messages.
    first, second : (n,) the numbers.
    unit : unit of the second column, from its heading; empty if the heading has none.
    lines : (n,) line of the file on which each row stands, from 1.
    """

    file: str
    first: checked.Floats
    second: checked.Floats
    unit: str
    lines: tuple[int, ...]

    def fault(self, row: int, values: FloatArray, message: str) -> GeometryError:
        """The error for the value of a row; a negative `row` counts backwards from the end."""
        return fault(self.file, self.lines[row], repr(float(values[row])), message)

    @classmethod
    def read(
        cls, data: bytes | str, file: str, columns: tuple[NumberColumn, NumberColumn]
    ) -> TwoColumns:
        """Read a table with two numbers in each row; see `read_columns` for format and errors."""
        table = read_columns(data, file, RequestedColumns(columns))
        first, second = table.values
        return cls(file, first, second, table.units[1], table.lines)

    @classmethod
    def of_lifts(
        cls, data: bytes | str, file: str, span: float = 360.0, *, periodic: bool = False
    ) -> TwoColumns:
        """Read a table of cam angle [degrees] and lift.

        The format is that of `camgeo.numeric.columns`; a heading may call the columns "phi",
        "angle" or "cam angle" [deg], and "s", "lift", "psi" or "swing".

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
            With file and line, if the table is not as described: not a number or not a finite one,
            too few or too many rows or cells, angles that do not start at 0, ascend, or end at the
            span.
        """
        span = checked.positive("span", span, "degrees")
        table = cls.read(data, file, (ANGLE, LIFT))
        angles = table.first
        table.check_from_zero(angles, "angle")
        beyond = np.flatnonzero(angles > span * (1.0 + LAST_ROW))
        if len(beyond):
            raise table.fault(
                int(beyond[0]),
                angles,
                f"the angle is beyond the span; allowed: up to {span:.17g} degrees",
            )
        if abs(angles[-1] - span) <= LAST_ROW * span and span > angles[-2]:
            return replace(table, first=np.append(angles[:-1], span))
        if not periodic:
            raise table.fault(
                -1,
                angles,
                f"the last angle is not the end of the span; allowed: {span:.17g} degrees",
            )
        return table

    def turn_radians(self, angles: FloatArray) -> FloatArray:
        """The `angles` [degrees] in radians, from 0 to one turn.

        Raises GeometryError with the line if they do not ascend from 0 to 360 degrees.
        """
        self.check_from_zero(angles, "angle")
        if not abs(angles[-1] - FULL_TURN) <= LAST_ROW * FULL_TURN:
            raise self.fault(-1, angles, "the last angle is not a full turn; allowed: 360 degrees")
        radians = np.radians(angles)
        radians[-1] = TURN
        return radians

    def check_from_zero(self, values: FloatArray, what: str) -> None:
        """Raise GeometryError with the line of the first row that does not ascend from 0."""
        if values[0] != 0.0:
            raise self.fault(0, values, f"the first {what} is not 0; allowed: 0")
        self.check_ascending(values, what)

    def check_ascending(self, values: FloatArray, what: str) -> None:
        """Raise GeometryError with the line of the first row whose `values` do not ascend."""
        falls = np.flatnonzero(np.diff(values) <= 0.0)
        if len(falls):
            place = int(falls[0]) + 1
            previous = float(values[place - 1])
            raise self.fault(
                place,
                values,
                f"the {what} does not exceed the one before, {previous!r}; allowed: only ascending",
            )
