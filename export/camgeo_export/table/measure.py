"""A table that was read back, held against the one that was written."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from camgeo.numeric.arrays import BoolArray, FloatArray
from camgeo_export.errors import FileError


def difference(
    rows: Sequence[Sequence[str]], expected: FloatArray, lengths: BoolArray, what: str
) -> float:
    """Largest difference of the columns that are `lengths` (k,) from `expected` (n, k).

    Raises FileError if `what` was read has other rows, or anything else in it differs.
    """
    if len(rows) != len(expected) or {len(row) for row in rows} != {len(lengths)}:
        raise FileError(f"{what} has other columns or rows than this scene's")
    try:
        found = np.array(rows, dtype=np.float64)
    except ValueError as error:
        raise FileError(f"{what} holds something that is not a number: {error}") from None
    if not np.array_equal(found[:, ~lengths], expected[:, ~lengths]):
        raise FileError(f"{what}'s angles, ratios or radii differ from this scene's")
    away = abs(found[:, lengths] - expected[:, lengths])
    if not np.all(np.isfinite(away)):
        raise FileError(f"{what} holds a length that is no finite number")
    return float(away.max(initial=0.0))
