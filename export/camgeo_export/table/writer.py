"""CSV: the value table, one header line, numbers in the shortest form that reads back the same."""

from __future__ import annotations

import csv
import io

import numpy as np

from camgeo.files.product import Product, Written
from camgeo.formats.csv import FORMAT
from camgeo.units import MM_PER
from camgeo_export.errors import FileError


class CsvWriter:
    """Writes the value table."""

    format = FORMAT

    def write(self, product: Product, tolerance: float) -> Written:
        """The table in the product's unit and in degrees; its values are not fitted."""
        table = product.tabulated.table()
        facts: dict[str, int | float | str] = {
            "rows": len(table.values),
            "columns": len(table.names),
        }
        return Written(table.csv().encode("utf-8"), facts)

    def measure(self, product: Product, data: bytes) -> float:
        """Read the table back; the largest difference of its lengths [mm], 0.0 for a file of ours.

        Raises FileError if anything else differs.
        """
        table = product.tabulated.table()
        rows = list(csv.reader(io.StringIO(data.decode("utf-8", "replace"), newline="")))
        header = tuple(rows.pop(0)) if rows else ()
        if header != table.names or len(rows) != len(table.values):
            raise FileError("the table has other columns or rows than this scene's")
        try:
            values = np.array(rows, dtype=np.float64)
        except ValueError as error:
            raise FileError(f"the table holds something that is not a number: {error}") from None
        difference = abs(values - table.values).max(axis=0)
        lengths = np.array([f"[{product.unit}]" in name for name in table.names])
        if difference[~lengths].any():
            raise FileError("the table's angles or ratios differ from this scene's")
        return float(difference[lengths].max(initial=0.0)) * MM_PER[product.unit]


WRITER = CsvWriter()
