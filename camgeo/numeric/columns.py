"""Tables of numbers: CSV with the separators and decimal marks of any country."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.numeric import checked
from camgeo.numeric.arrays import FloatArray
from camgeo.reading import DIGITS, TABLE
from camgeo.units import counted, listed

MOST_ROWS: Final = 200_000

NUMBER: Final = re.compile(r"[+-]?(\d+([.,]\d*)?|[.,]\d+)([eE][+-]?\d+)?", re.ASCII)

HEADING: Final = re.compile(r"(?P<name>[^\[(]*?)\s*([\[(]\s*(?P<unit>[^\])]*?)\s*[\])])?")

LONGEST_HEADING: Final = 200
"""Characters of a cell that may be a name and a unit."""

MOST_COLUMNS: Final = 1_000

BLANKS: Final = re.compile(r"(?<!\s)\s++(?![\[(]|[^\[\]()\s]{0,20}+\s{0,5}+[\])])")
"""The blanks that separate cells where nothing else does; a unit in brackets belongs to its
name."""

LINE_END: Final = re.compile(r"\r\n|\r|\n")


@dataclass(frozen=True, slots=True)
class NumberColumn:
    """The names and units of a column.

    Attributes
    ----------
    what : its name in messages.
    names : those allowed in headings, in lower case.
    units : allowed in headings, in lower case; empty for any.
    units_text : the units as messages list them.
    """

    what: str
    names: tuple[str, ...]
    units: tuple[str, ...] = ()
    units_text: str = ""


@dataclass(frozen=True, slots=True)
class RequestedColumns:
    """The columns that a table may have.

    Attributes
    ----------
    required : columns that it must have.
    optional : further columns that it may have, all of them or none.
    fewest, most : smallest and largest number of rows.
    named : whether the `optional` columns are recognised only by their names in a heading.
    """

    required: tuple[NumberColumn, ...]
    optional: tuple[NumberColumn, ...] = ()
    fewest: int = 2
    most: int = MOST_ROWS
    named: bool = False

    @property
    def sets(self) -> tuple[tuple[NumberColumn, ...], ...]:
        """The sets of columns, one or two, that a table without a heading may have."""
        both = (self.required, self.required + self.optional)
        return both if self.optional and not self.named else both[:1]


@dataclass(frozen=True, slots=True, eq=False)
class Columns:
    """The rows of a table.

    Attributes
    ----------
    values : (k, n) the columns of the table, in the order in which they were requested.
    units : (k) unit of each column, from its heading; empty where there is none.
    lines : (n) line of the file on which each row stands, from 1.
    """

    values: FloatArray
    units: tuple[str, ...]
    lines: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class _Layout:
    """The form of the rows: separator, number of cells, and the cells and units of the columns."""

    separator: str
    cells: int
    places: tuple[int, ...]
    units: tuple[str, ...]
    has_heading: bool


def read_columns(data: bytes | str, file: str, requested: RequestedColumns) -> Columns:
    """Read a table of numbers.

    Cells are separated by ; or tab or comma or blanks, the first of these that occurs in the first
    row; commas in numbers between which blanks stand are decimal ones. The decimal mark is a point;
    with other separators than a comma it may be a comma, the same in all rows. Empty lines and
    lines that begin with # are skipped. A heading may name the columns: then there may be more
    than those requested, which are recognised by their names, in upper or lower case, with or
    without a unit in brackets. Without a heading a table has the requested columns only.

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
        raise fault(file, len(lines), "", f"there are no rows; allowed: {requested.fewest} or more")
    layout = _layout(rows[0][1], file, rows[0][0], requested)
    if layout.has_heading:
        rows = rows[1:]
    if not requested.fewest <= len(rows) <= requested.most:
        place = rows[min(len(rows), requested.most + 1) - 1][0] if rows else len(lines)
        message = f"of numbers; allowed: {requested.fewest} to {requested.most:,}"
        raise fault(file, place, "", f"{counted(len(rows), 'row')} {message}")
    values = _values(rows, layout, file)
    return Columns(values, layout.units, tuple(number for number, _ in rows))


def _values(rows: list[tuple[int, str]], layout: _Layout, file: str) -> FloatArray:
    """(k, n) the columns of the numbered lines."""
    values = np.empty((len(layout.places), len(rows)))
    decimal = ""
    for row, (number, line) in enumerate(rows):
        cells = _cells(line, layout.separator)
        count = len(cells)
        if count != layout.cells:
            message = f"{counted(count, 'column')}; allowed: {layout.cells} in this file"
            raise fault(file, number, line, message)
        for column, cell in enumerate(layout.places):
            text = cells[cell].strip()
            if len(text) > DIGITS or not NUMBER.fullmatch(text):
                raise fault(file, number, text, "not a number; allowed: numbers like 12.5")
            # All decimals of a file have the same mark, so that 1,234 is never read in two ways.
            mark = "," if "," in text else "." if "." in text else ""
            if mark and decimal and mark != decimal:
                raise fault(
                    file,
                    number,
                    text,
                    f"the numbers above have the decimal mark {decimal!r}; allowed: one mark",
                )
            decimal = mark or decimal
            value = float(text.replace(",", "."))
            if not abs(value) <= checked.LARGEST:
                message = f"too large; allowed: numbers up to {checked.LARGEST:g}"
                raise fault(file, number, text, message)
            values[column, row] = value
    return values


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
    # A line ends with LF, CR, or CR LF, which counts once.
    count = text.count("\n") + text.count("\r") - text.count("\r\n")
    if TABLE.lines is not None and count > TABLE.lines:
        message = f"the file has {counted(count, 'line')}; allowed: {TABLE.lines:,}"
        raise GeometryError(f"{file}: {message}", value=str(count))
    return LINE_END.split(text.removeprefix("\N{BYTE ORDER MARK}"))


def _layout(line: str, file: str, number: int, requested: RequestedColumns) -> _Layout:
    """Separator and columns, from the first line that is not skipped."""
    separator = next((mark for mark in (";", "\t", ",") if mark in line), " ")
    words = BLANKS.split(line.strip(), MOST_COLUMNS + 1)
    # "1,5 2,5" has commas, but each word between blanks is a number: the commas are decimal.
    if separator == "," and all(map(NUMBER.fullmatch, words)) and len(words) > 1:
        separator = " "
    if separator == " " and len(words) == 1:
        message = "there is only one column; allowed separators: semicolon, tab, comma, blanks"
        raise fault(file, number, line, message)
    cells = [cell.strip().strip('"').strip() for cell in _cells(line, separator)]
    if len(cells) > MOST_COLUMNS:
        message = f"{counted(len(cells), 'column')} or more; allowed: at most {MOST_COLUMNS:,}"
        raise fault(file, number, line, message)
    if NUMBER.fullmatch(cells[0]):
        if len(cells) not in map(len, requested.sets):
            allowed = " or ".join(str(len(columns)) for columns in requested.sets)
            what = ", or ".join(
                listed([column.what for column in columns]) for columns in requested.sets
            )
            more = (
                f"; {listed([c.what for c in requested.optional])} by name"
                if requested.named
                else ""
            )
            raise fault(
                file,
                number,
                line,
                f"{counted(len(cells), 'column')}; without a heading {allowed} are allowed,"
                f" {what}{more} (a decimal comma needs ; or tab or blanks as separator)",
            )
        places = tuple(range(len(cells)))
        return _Layout(separator, len(cells), places, ("",) * len(cells), has_heading=False)
    headings = [_heading(cell) for cell in cells]
    wanted = requested.required
    if any(name in column.names for column in requested.optional for name, _ in headings):
        wanted += requested.optional
    places = tuple(_column(headings, column, file, number) for column in wanted)
    for place, column in zip(places, wanted, strict=True):
        unit = headings[place][1]
        if unit and column.units and unit.lower() not in column.units:
            raise fault(
                file,
                number,
                cells[place],
                f"the unit of the {column.what} is unknown; allowed: {column.units_text}",
            )
    units = tuple(headings[place][1] for place in places)
    return _Layout(separator, len(cells), places, units, has_heading=True)


def _cells(line: str, separator: str) -> list[str]:
    """The cells of a row, at most one more than are allowed."""
    if separator == " ":
        return BLANKS.split(line.strip(), MOST_COLUMNS)
    return line.split(separator, MOST_COLUMNS)


def _heading(cell: str) -> tuple[str, str]:
    """Name, in lower case, and unit of a column."""
    match = HEADING.fullmatch(cell) if len(cell) <= LONGEST_HEADING else None
    if match is None:
        return cell.lower(), ""
    return match["name"].strip().lower(), match["unit"] or ""


def _column(headings: list[tuple[str, str]], column: NumberColumn, file: str, number: int) -> int:
    matches = [k for k, (name, _) in enumerate(headings) if name in column.names]
    if len(matches) != 1:
        heading_names = ", ".join(name[:LONGEST_HEADING] for name, _ in headings)
        raise fault(
            file,
            number,
            heading_names,
            f"{counted(len(matches), 'column')} of {column.what}; allowed: one, called"
            f" {' or '.join(column.names)}",
        )
    return matches[0]


def fault(file: str, line: int, value: str, message: str) -> GeometryError:
    """The error for a line of a table."""
    excerpt = value.strip() if len(value.strip()) <= 60 else value.strip()[:57] + "..."
    quoted = f"{excerpt!r}: " if excerpt else ""
    return GeometryError(f"{file}, line {line}: {quoted}{message}", value=excerpt)
