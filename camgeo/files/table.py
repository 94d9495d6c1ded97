"""The value table: columns over the cam angle."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass

import numpy as np

from camgeo.numeric.arrays import FloatArray, frozen


@dataclass(frozen=True, slots=True, eq=False)
class Table:
    """Named columns of equal length.

    Attributes
    ----------
    names : of the columns, with their unit in brackets, e.g. "phi [deg]".
    values : (n, k), one column a name; NaN-free.
    """

    names: tuple[str, ...]
    values: FloatArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "values", frozen(self.values, np.float64))

    def csv(self) -> str:
        """The table as CSV: one header line, numbers in the shortest form that reads back the same.

        No number is written as -0.0.
        """
        stream = io.StringIO()
        rows = csv.writer(stream, lineterminator="\n")
        rows.writerow(self.names)
        rows.writerows([repr(value) for value in row] for row in (self.values + 0.0).tolist())
        return stream.getvalue()
