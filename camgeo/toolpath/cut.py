"""What an operation is to cut, exactly, before any tolerance."""

from __future__ import annotations

import math
from dataclasses import dataclass

from camgeo.part.part import Boundary
from camgeo.toolpath.tool import Tool


@dataclass(frozen=True, slots=True)
class Cut:
    """One operation to be planned.

    Attributes
    ----------
    name : its identity, unique in the program and named in the file.
    strategy : how it is cut, a name in `camgeo.toolpath.strategies.registry.STRATEGIES`.
    tool : with which it is cut.
    centre : the exact closed path of the cutter's centre. Where it is a hole, as inside of a bore,
        it is run counter-clockwise, else clockwise: so the cutter climbs (spindle clockwise).
    right, left : names of the part's boundaries that come about on either side of the cutter, seen
        in the direction of cutting; empty where nothing of the part is.
    depths : Z of each pass [mm], descending.
    room : largest radius of the arcs that lead onto the path and off again [mm]; 0 without any.
    note : what the person at the machine should know, or empty.
    """

    name: str
    strategy: str
    tool: Tool
    centre: Boundary
    right: str
    left: str
    depths: tuple[float, ...]
    room: float = 0.0
    note: str = ""


def passes(top: float, bottom: float, largest: float | None) -> tuple[float, ...]:
    """Z of equal passes of at most `largest` [mm], the last at `bottom` exactly; one if None."""
    depth = top - bottom
    count = 1 if largest is None else max(1, math.ceil(depth / largest * (1.0 - 1e-12)))
    return (*(top - depth * (k + 1) / count for k in range(count - 1)), bottom)
