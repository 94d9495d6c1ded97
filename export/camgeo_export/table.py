"""CSV: the value table, one header line, numbers in the shortest form that reads back the same.

Or with the columns, decimals and signs that the scene states; UTF-8.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from typing import Final

import numpy as np

from camgeo.design.product import Product
from camgeo.design.value_table import rounded
from camgeo.design.writing import Written
from camgeo.errors import FileError
from camgeo.numeric.arrays import BoolArray, FloatArray
from camgeo.scene.formats.csv import FORMAT
from camgeo.scene.formats.format import ASC, Format
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
        values = np.array(rows, dtype=np.float64)
    except ValueError as error:
        raise FileError(f"{what} holds something that is not a number: {error}") from None
    if not np.array_equal(values[:, ~lengths], expected[:, ~lengths]):
        raise FileError(f"{what}'s angles, ratios or radii differ from this scene's")
    away = abs(values[:, lengths] - expected[:, lengths])
    if not np.all(np.isfinite(away)):
        raise FileError(f"{what} holds a length that is not a finite number")
    return float(away.max(initial=0.0))


WRITER = CsvWriter()


# -- asc -------------------------------------------------------------------------------------------
# ASC: the two point files of opticurv 1.0.3 (Wirsig, appendix A, source lines 1414 to 1443).
#
# No heading, one row for each step of the cam angle from 0 to below 360 degrees, numbers separated
# by commas. The columns are in the program's order and hold what its text means by them, with
# correct values; docs/opticurv.md lists where its own differ. Lengths are in mm whatever the
# scene's unit.


POINTS: Final = ("x_i_vers", "y_i_vers", "x_B_vers", "y_B_vers", "x_a_vers", "y_a_vers")
"""Inner working curve, pitch curve and outer working curve, seen from the cam axis [mm]."""

COLUMNS: Final = (
    *("phi", "s", "psi", "psi_rad", "psi'", "psi''", "x_Bik", "y_Bik"),
    *POINTS,
    *("mue", "r_K"),
)
"""Columns of the first file, by the program's headings: degrees, mm, degrees, rad, 1, 1/rad,
mm (from the pivot), mm (from the cam axis), degrees, mm (positive where the pitch curve is convex).
"""

LENGTHS: Final = frozenset(("s", "x_Bik", "y_Bik", *POINTS))
"""Columns whose differences count as deviation; r_K is not a position and must be equal."""


def point_columns(product: Product) -> dict[str, FloatArray]:
    """`COLUMNS`, each (n,) at the steps of the scene's value table.

    The stroke s is that of the slider of a slider-crank, psi the angle of the rocker behind it.
    """
    table = product.tabulated.table()
    values = dict(zip(table.names, table.values.T, strict=True))
    unit = product.unit
    mm = MM_PER[unit]
    pivot = product.pictured.follower_sketch.end
    pitch_x, pitch_y = mm * values[f"pitch x [{unit}]"], mm * values[f"pitch y [{unit}]"]
    swing = values["psi [deg]"]
    return {
        "phi": values["phi [deg]"],
        "s": mm * values[f"s [{unit}]"],
        "psi": swing,
        "psi_rad": np.radians(swing),
        "psi'": values["psi' [1]"],
        "psi''": values["psi'' [1/rad]"],
        "x_Bik": pitch_x - pivot.real,
        "y_Bik": pitch_y - pivot.imag,
        "x_i_vers": mm * values[f"inner x [{unit}]"],
        "y_i_vers": mm * values[f"inner y [{unit}]"],
        "x_B_vers": pitch_x,
        "y_B_vers": pitch_y,
        "x_a_vers": mm * values[f"outer x [{unit}]"],
        "y_a_vers": mm * values[f"outer y [{unit}]"],
        "mue": values["mu [deg]"],
        "r_K": mm * values[f"r_K [{unit}]"],
    }


@dataclass(frozen=True, slots=True)
class AscWriter:
    """Writes one of the point files.

    Attributes
    ----------
    format : with the suffix of the file.
    columns : of the file, in order.
    companions : writers of the format's further files.
    """

    format: Format[None]
    columns: tuple[str, ...]
    companions: tuple[AscWriter, ...] = ()

    def write(self, product: Product, tolerance: float) -> Written:
        """The points, each number in the shortest form that reads back the same; nothing is fitted.

        r_K is `inf` where the curvature is exactly 0, as in a C++ stream; no other value can be.
        """
        columns = point_columns(product)
        values = np.column_stack([columns[name] for name in self.columns]) + 0.0
        lines = [",".join(repr(x).removesuffix(".0") for x in row.tolist()) for row in values]
        facts: dict[str, int | float | str] = {"rows": len(lines), "columns": len(self.columns)}
        return Written(("\n".join(lines) + "\n").encode("ascii"), facts)

    def measure(self, product: Product, data: bytes) -> float:
        """Read the points back; the largest difference of a length [mm], 0.0 for our own file.

        Raises FileError if anything else differs.
        """
        columns = point_columns(product)
        expected = np.column_stack([columns[name] for name in self.columns])
        rows = (line.split(",") for line in data.decode("ascii", "replace").splitlines())
        lengths = np.array([name in LENGTHS for name in self.columns])
        return difference(rows, expected, lengths, "the file")


ASC_SECOND = AscWriter(replace(ASC, suffix="2.asc"), POINTS)

ASC_WRITER = AscWriter(ASC, COLUMNS, (ASC_SECOND,))
