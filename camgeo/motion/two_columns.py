"""Tables of two columns, mostly over the cam angle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.numeric import checked
from camgeo.numeric.arrays import FloatArray, frozen
from camgeo.numeric.columns import Asked, Column, fault, read_columns
from camgeo.pickled import Pickled
from camgeo.units import TURN

ANGLE: Final = Column(
    "angle", ("phi", "angle", "cam angle"), ("deg", "degree", "degrees", "°"), "deg"
)

FULL_TURN: Final = 360.0

LAST_ROW: Final = 1e-9
"""The last angle may be off its span by this fraction, as 120.00000000001 is from 120."""


@dataclass(frozen=True, slots=True, eq=False)
class TwoColumns(Pickled):
    """The rows of a table.

    Attributes
    ----------
    file : its name, for messages.
    first, second : (n,) the numbers.
    unit : of the second column, from its heading; empty if the heading has none.
    lines : (n,) line of the file on which each row stands, from 1.
    """

    file: str
    first: FloatArray
    second: FloatArray
    unit: str
    lines: tuple[int, ...]

    def __post_init__(self) -> None:
        first, second = (frozen(each, np.float64) for each in (self.first, self.second))
        checked.hold(self, first=first, second=second)

    def fault(self, row: int, values: FloatArray, message: str) -> GeometryError:
        """The error for the value of a row, counted from 0, or backwards from the end."""
        return fault(self.file, self.lines[row], repr(float(values[row])), message)


def read_two_columns(data: bytes | str, file: str, columns: tuple[Column, Column]) -> TwoColumns:
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
        message = f"the {what} before is {before!r}; allowed: only ascending"
        raise table.fault(place, values, message)
