"""CSV: the value table, one header line, numbers in the shortest form that reads back the same.

Or with the columns, decimals and signs that the scene states; UTF-8.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Iterator, Sequence
from itertools import islice
from typing import Final

import numpy as np

from camgeo.design.product import Product
from camgeo.design.value_table import rounded
from camgeo.design.writing import Written
from camgeo.errors import FileError
from camgeo.numeric.arrays import BoolArray, FloatArray
from camgeo.scene.formats.csv import FORMAT
from camgeo.units import MM_PER

BATCH: Final = 4096
"""Rows that are compared at once: as text they take many times the memory of their numbers."""


class CsvWriter:
    """Writes the value table."""

    format = FORMAT

    def write(self, product: Product, tolerance: float) -> Written:
        """The table as the scene states it; its values are exact, not fitted."""
        table = product.tabulated.written()
        facts: dict[str, int | float | str] = {
            "rows": len(table.values),
            "columns": len(table.names),
        }
        return Written(table.encoded(), facts)

    def measure(self, product: Product, data: bytes) -> float:
        """Read the table back; the largest difference of its lengths [mm] from the exact ones: that
        of rounding to the decimals that the scene states, else 0.0 for our own file.

        Raises FileError if anything else differs.
        """
        exact = product.tabulated.stated()
        table = rounded(exact, product.options[FORMAT].decimals)
        text = io.TextIOWrapper(io.BytesIO(data), "utf-8", "replace", newline="")
        rows: Iterator[Sequence[str]] = csv.reader(text, delimiter=table.separator)
        if tuple(next(rows, ())) != table.names:
            raise FileError("the table does not have this scene's columns and rows")
        if table.decimal_comma:
            rows = ([cell.replace(",", ".") for cell in row] for row in rows)
        units = [
            unit for unit in MM_PER if any(name.endswith(f" [{unit}]") for name in table.names)
        ]
        lengths = np.array(
            [name.endswith(tuple(f" [{unit}]" for unit in units)) for name in table.names]
        )
        same = exact is table  # copies of large tables are large
        expected = table.values if same else np.where(lengths, exact.values, table.values)
        scale = MM_PER[units[0]] if units else 1.0
        return difference(rows, expected, lengths, "the table") * scale


def difference(
    rows: Iterable[Sequence[str]], expected: FloatArray, lengths: BoolArray, what: str
) -> float:
    """Largest difference from `expected` (n, k) in the columns that are `lengths` (k,).

    Raises FileError, naming the file as `what`, if it has other rows or differs in other columns.
    """
    remaining, compared, most = iter(rows), 0, 0.0
    while batch := list(islice(remaining, BATCH)):
        part = expected[compared : compared + len(batch)]
        if len(part) < len(batch) or {len(row) for row in batch} != {len(lengths)}:
            raise FileError(f"{what} does not have this scene's columns and rows")
        most = max(most, _difference(batch, part, lengths, what))
        compared += len(batch)
    if compared < len(expected):
        raise FileError(f"{what} does not have this scene's columns and rows")
    return most


def _difference(
    rows: Sequence[Sequence[str]], expected: FloatArray, lengths: BoolArray, what: str
) -> float:
    try:
        found = np.array(rows, dtype=np.float64)
    except ValueError as error:
        raise FileError(f"{what} holds something that is not a number: {error}") from None
    if not np.array_equal(found[:, ~lengths], expected[:, ~lengths]):
        raise FileError(f"{what}'s angles, ratios or radii differ from this scene's")
    away = abs(found[:, lengths] - expected[:, lengths])
    if not np.all(np.isfinite(away)):
        raise FileError(f"{what} holds a length that is not a finite number")
    return float(away.max(initial=0.0))


WRITER = CsvWriter()
