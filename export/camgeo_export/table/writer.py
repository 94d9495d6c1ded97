"""CSV: the value table, one header line, numbers in the shortest form that reads back the same."""

from __future__ import annotations

import csv
import io

import numpy as np

from camgeo.files.product import Product, Written
from camgeo.formats.csv import FORMAT
from camgeo.units import MM_PER
from camgeo_export.errors import FileError
from camgeo_export.table.measure import difference


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
        if header != table.names:
            raise FileError("the table has other columns or rows than this scene's")
        lengths = np.array([f"[{product.unit}]" in name for name in table.names])
        return difference(rows, table.values, lengths, "the table") * MM_PER[product.unit]


WRITER = CsvWriter()
