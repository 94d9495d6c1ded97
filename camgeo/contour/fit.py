"""What a fit returns: the contour and the deviation that was proved for it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from camgeo.contour.contour import Contour

Effort = Literal["fast", "fewest"]
"""How hard a fit tries: one pass, or the fewest pieces and then the least deviation."""


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """A contour and its proof.

    Attributes
    ----------
    contour : the closed contour.
    deviation : upper bound [mm] of the distance between contour and exact curve, in both
        directions and for every point; rounding of the arithmetic included.
    tolerance : what was asked [mm]; `deviation` never exceeds it.
    """

    contour: Contour
    deviation: float
    tolerance: float
