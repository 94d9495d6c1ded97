"""Points measured in other axes than those of the cam: shifted, turned, or from the other side."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.inspection.alignment import FEWEST, SOME, Align, Frame, aligned
from camgeo.inspection.exact_flank import ExactFlank
from camgeo.numeric.arrays import ComplexArray

GROSS: Final = 2e-3
"""Deviations (root mean square) beyond this fraction of the flank's size are no errors of making:
0.1 mm on a cam of 50 mm."""

BETTER: Final = 0.1
"""Share of the deviations that is left in axes that are the right ones."""


@dataclass(frozen=True, slots=True)
class OtherAxes:
    """Axes in which the points fit.

    Attributes
    ----------
    frame : of the part in the axes of the measurement, of which y is reversed if `mirrored`.
    mirrored : whether the points are those of the disc seen from the other side.
    left : deviation [mm] that is left, root mean square.
    """

    frame: Frame
    mirrored: bool
    left: float


def other_axes(
    flank: ExactFlank, points: ComplexArray, deviation: float, ball: float = 0.0
) -> OtherAxes | None:
    """The axes in which measured `points` (n,) [mm] fit far better than with a `deviation` [mm], a
    root mean square; None if that is no gross one, or there are none.
    """
    some = points[:: -(-len(points) // SOME)]
    if deviation <= GROSS * flank.size or len(some) < FEWEST:
        return None
    tried = []
    for mirrored in (False, True):
        try:
            found = aligned(flank, some.conj() if mirrored else some, Align.FREE, ball)
        except GeometryError:
            continue
        left = float(np.sqrt(np.mean(found.deviations**2)))
        tried.append(OtherAxes(found.frame, mirrored, left))
    # A flank that is its own mirror image is not seen from the other side by rounding.
    best = min(tried, key=lambda each: (1.0 + each.mirrored) * each.left, default=None)
    return best if best is not None and best.left < BETTER * deviation else None
