"""Cells of cam angle in which a flight is integrated."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from typing import Final

import numpy as np

from camgeo.numeric.arrays import FloatArray
from camgeo.units import TURN

FIRST_CELL: Final = 2.0**-16
"""Length of the first cell as a share of a smooth piece; each cell is twice as long as the one
before, so that a short flight is resolved as well as a long one."""

LONGEST_CELL: Final = 0.25
"""Largest length of a cell as a share of a smooth piece, before cells are halved."""


def cells_from(start: float, edges: FloatArray, share: float) -> Iterator[tuple[float, float]]:
    """Cells [rad] over one turn from `start`, short at first, none across one of `edges`.

    `share` scales their lengths.
    """
    ahead = np.concatenate((edges[:-1], edges[:-1] + TURN))
    stops = [start, *ahead[(ahead > start) & (ahead < start + TURN)], start + TURN]
    size = share * FIRST_CELL
    for low, high in itertools.pairwise(stops):
        length = high - low
        if length <= 8.0 * math.ulp(high):
            continue
        place = low
        while place < high:
            end = min(place + max(size * length, math.ulp(high)), high)
            if high - end < 0.5 * size * length:
                end = high
            yield float(place), float(end)
            place = end
            size = min(2.0 * size, share * LONGEST_CELL)
