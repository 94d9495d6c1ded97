"""Tables of two columns: CSV with the separators and decimal marks of any country."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.numeric import checked
from camgeo.numeric.arrays import FloatArray, frozen
from camgeo.pickled import Pickled
from camgeo.reading import DIGITS, TABLE
from camgeo.units import TURN
from camgeo.wording import counted

MOST_ROWS: Final = 200_000

NUMBER: Final = re.compile(r"[+-]?(\d+([.,]\d*)?|[.,]\d+)([eE][+-]?\d+)?", re.ASCII)

HEADING: Final = re.compile(r"(?P<name>[^\[(]*?)\s*([\[(]\s*(?P<unit>[^\])]*?)\s*[\])])?")

LONGEST_HEADING: Final = 200
"""Characters of a cell that may be a name and a unit."""

MOST_COLUMNS: Final = 1_000

LINE_END: Final = re.compile(r"\r\n|\r|\n")


@dataclass(frozen=True, slots=True)
class Column:
    """The names and units of a column.

    Attributes
    ----------
    what : its name in messages.
    names : those allowed in headings, in lower case.
    units : allowed in headings, in lower case; empty for any.
    shown : these units in messages.
    """

    what: str
    names: tuple[str, ...]
    units: tuple[str, ...] = ()
    shown: str = ""


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


@dataclass(frozen=True, slots=True)
class _Layout:
    """How the rows are written: separator, number of cells, cells of both columns, unit."""

    separator: str
    cells: int
    first: int
    second: int
    unit: str
    has_heading: bool


def read_two_columns(data: bytes | str, file: str, columns: tuple[Column, Column]) -> TwoColumns:
    """Read a table of two numbers a row.

    Cells are separated by ; or tab or comma, the first of these that occurs in the first row.
    The decimal mark is a point; with ; or tab it may be a comma, the same in all rows. Empty lines
    and lines that begin with # are skipped. A heading may name the columns: then there may be more
    than two, of which those named in `columns` count, in any case, with or without a unit in
    brackets. Without a heading there are two columns.

    Parameters
    ----------
    data : the file, UTF-8; at most 16,000,000 bytes and 200,000 rows.
    file : its name, for messages.

    Raises
    ------
    GeometryError
        With file and line, if the table is not as described: not a number or not a finite one, too
        few or too many rows or cells.
    """
    lines = _lines(data, file)
    rows = [
        (number, line)
        for number, line in enumerate(lines, start=1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if not rows:
        raise fault(file, len(lines), "", "no rows; allowed: 2 or more")
    layout = _layout(rows[0][1], file, rows[0][0], columns)
    if layout.has_heading:
        rows = rows[1:]
    if not 2 <= len(rows) <= MOST_ROWS:
        place = rows[min(len(rows), MOST_ROWS + 1) - 1][0] if rows else len(lines)
        raise fault(
            file,
            place,
            "",
            f"{counted(len(rows), 'row')} of numbers; allowed: 2 to {MOST_ROWS:,}",
        )
    first, second = _columns(rows, layout, file)
    return TwoColumns(file, first, second, layout.unit, tuple(number for number, _ in rows))


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


def _columns(
    rows: list[tuple[int, str]], layout: _Layout, file: str
) -> tuple[FloatArray, FloatArray]:
    """Both columns, (n,) each, of the numbered lines."""
    out = np.empty((2, len(rows)))
    decimal = ""
    for row, (number, line) in enumerate(rows):
        count = 1 + line.count(layout.separator)
        if count != layout.cells:
            raise fault(
                file,
                number,
                line,
                f"{counted(count, 'column')}; allowed: {layout.cells} in this file",
            )
        cells = line.split(layout.separator)
        for column, cell in enumerate((layout.first, layout.second)):
            text = cells[cell].strip()
            if len(text) > DIGITS or not NUMBER.fullmatch(text):
                raise fault(file, number, text, "not a number; allowed: numbers like 12.5")
            mark = "," if "," in text else "." if "." in text else ""
            if mark and decimal and mark != decimal:
                raise fault(
                    file, number, text, f"the decimals above have {decimal!r}; allowed: one kind"
                )
            decimal = mark or decimal
            value = float(text.replace(",", "."))
            if not abs(value) <= checked.LARGEST:
                message = f"too large; allowed: numbers up to {checked.LARGEST:g}"
                raise fault(file, number, text, message)
            out[column, row] = value
    return out[0], out[1]


def _lines(data: bytes | str, file: str) -> list[str]:
    size = len(checked.instance("data", data, (bytes, str), "bytes or text"))
    if size > TABLE.size:
        raise GeometryError(
            f"{file}, line 1: the file has {counted(size, 'byte')}; allowed: {TABLE.size:,}",
            value=str(size),
        )
    if isinstance(data, str):
        text = data
    else:
        try:
            text = data.decode("utf-8")
        except UnicodeDecodeError as error:
            line = data[: error.start].count(b"\n") + 1
            raise fault(file, line, "", "not UTF-8 text") from error
    count = text.count("\n") + text.count("\r") - text.count("\r\n")
    if TABLE.lines is not None and count > TABLE.lines:
        message = f"the file has {counted(count, 'line')}; allowed: {TABLE.lines:,}"
        raise GeometryError(f"{file}: {message}", value=str(count))
    return LINE_END.split(text.removeprefix("\N{BYTE ORDER MARK}"))


def _layout(line: str, file: str, number: int, columns: tuple[Column, Column]) -> _Layout:
    """Separator and columns, from the first line that is not skipped."""
    separator = next((mark for mark in (";", "\t", ",") if mark in line), "")
    if not separator:
        raise fault(file, number, line, "one column; allowed separators are ; and tab and comma")
    columns_found = 1 + line.count(separator)
    if columns_found > MOST_COLUMNS:
        message = f"{counted(columns_found, 'column')}; allowed: at most {MOST_COLUMNS:,}"
        raise fault(file, number, line, message)
    cells = [cell.strip().strip('"').strip() for cell in line.split(separator)]
    if NUMBER.fullmatch(cells[0]):
        if len(cells) != 2:
            raise fault(
                file,
                number,
                line,
                f"{counted(len(cells), 'column')}; without a heading 2 are allowed,"
                f" {columns[0].what} and {columns[1].what} (a decimal comma needs ; or tab as"
                " separator)",
            )
        return _Layout(separator, 2, 0, 1, "", has_heading=False)
    headings = [_heading(cell) for cell in cells]
    found = [_column(headings, column, file, number) for column in columns]
    for place, column in zip(found, columns, strict=True):
        unit = headings[place][1]
        if unit and column.units and unit.lower() not in column.units:
            raise fault(
                file,
                number,
                cells[place],
                f"the unit of the {column.what}; allowed: {column.shown}",
            )
    unit = headings[found[1]][1]
    return _Layout(separator, len(cells), found[0], found[1], unit, has_heading=True)


def _heading(cell: str) -> tuple[str, str]:
    """Name, in lower case, and unit of a column."""
    match = HEADING.fullmatch(cell) if len(cell) <= LONGEST_HEADING else None
    if match is None:
        return cell.lower(), ""
    return match["name"].strip().lower(), match["unit"] or ""


def _column(headings: list[tuple[str, str]], column: Column, file: str, number: int) -> int:
    found = [k for k, (name, _) in enumerate(headings) if name in column.names]
    if len(found) != 1:
        given = ", ".join(name[:LONGEST_HEADING] for name, _ in headings)
        raise fault(
            file,
            number,
            given,
            f"{counted(len(found), 'column')} of {column.what}; allowed: one, called"
            f" {' or '.join(column.names)}",
        )
    return found[0]


def fault(file: str, line: int, value: str, message: str) -> GeometryError:
    """The error for a line of a table."""
    shown = value.strip() if len(value.strip()) <= 60 else value.strip()[:57] + "..."
    given = f"{shown!r}: " if shown else ""
    return GeometryError(f"{file}, line {line}: {given}{message}", value=shown)
