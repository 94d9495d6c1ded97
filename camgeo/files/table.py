"""The value table: columns over the cam angle."""

from __future__ import annotations

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
