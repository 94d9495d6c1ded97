"""Where a gap closes in a cell."""

from __future__ import annotations

from typing import Final

import numpy as np

from camgeo.effects.lift_off.cells import Polynomial
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.roots import bracketed_roots
from camgeo.units import TURN

EVEN: Final = np.linspace(0.0, 1.0, 65)
EARLY: Final = np.append(0.0, np.geomspace(1e-9, 1.0, 128))
"""Places in a cell at which the landing is searched for; early ones where a flight begins with a
speed, which may last but a moment.
"""

FINER: Final = np.linspace(0.0, 1.0, 9)
"""Places between two probes, where their gaps do not exclude that it closes in between."""

FINEST: Final = 1e-10
"""A gap that would close and open again within this share of a turn only touches 0."""


def closes(gap: Polynomial, probes: FloatArray) -> float | None:
    """The first place from the first to the last of `probes` at which the `gap`, above 0 at first,
    falls to 0; None if there is none.

    Between probes a bound of its second derivative excludes that it does.
    """
    values = gap(probes)
    width = np.diff(probes)
    bend = float(np.sum(np.abs(gap.deriv(2).coef)))
    least = np.minimum(values[:-1], values[1:])
    doubtful = (least <= 0.0) | (least < 0.125 * bend * width * width)
    for piece in np.flatnonzero(doubtful).tolist():
        low, high = float(probes[piece]), float(probes[piece + 1])
        if values[piece] <= 0.0:
            return low
        if high - low > FINEST * TURN:
            found = closes(gap, low + (high - low) * FINER)
            if found is not None:
                return found
        elif values[piece + 1] <= 0.0:
            return float(bracketed_roots(gap, np.array([low]), np.array([high]))[0])
    return None
