"""What a scene says of its output files."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class DxfSpec:
    """`[output.dxf]`: how curves are drawn, and what is drawn beside the part.

    Attributes
    ----------
    entity : "arcs" (lines and arcs) or "polyline" (straight pieces only).
    auxiliary : whether pitch curve, base circle and centre mark are drawn too, on their own layers.
    """

    entity: str = "arcs"
    auxiliary: bool = True
