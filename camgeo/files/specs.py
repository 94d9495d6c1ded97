"""What a scene says of its output files."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from camgeo.numeric.checked import instance, one_of

SMALLEST_TOLERANCE: Final = 1e-7
LARGEST_TOLERANCE: Final = 1.0
"""Tolerances [mm] that files may be asked for: below, rounding of their decimals would exceed it;
above, contours no longer resemble the cam."""


@dataclass(frozen=True, slots=True)
class DxfSpec:
    """`[output.dxf]`: how curves are drawn, and what is drawn beside the part.

    Attributes
    ----------
    entity : "arcs" (lines and arcs), "polyline" (straight pieces only) or "spline" (cubic splines;
        dwells and turns stay arcs).
    auxiliary : whether pitch curve, base circle and centre mark are drawn too, on their own layers.

    Raises
    ------
    GeometryError
        With the key, if a value is not what it has to be.
    """

    entity: str = "arcs"
    auxiliary: bool = True

    def __post_init__(self) -> None:
        one_of("output.dxf.entity", self.entity, ("arcs", "polyline", "spline"))
        instance("output.dxf.auxiliary", self.auxiliary, bool, "true or false")
