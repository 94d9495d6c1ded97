"""What an operation cuts, exactly, before any tolerance."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.numeric.checked import array, hold, instance, number, positive, shown
from camgeo.part.part import Boundary, require_boundary
from camgeo.toolpath.spec import Tool

MOST_PASSES: Final = 10_000
"""Of one cut; a pass thinner than a ten-thousandth of a part is a typing error."""


@dataclass(frozen=True, slots=True)
class Cut:
    """One operation to plan.

    Attributes
    ----------
    name : its identity, unique in the program and stated in the file.
    strategy : how it is cut, a name in `camgeo.toolpath.strategies.STRATEGIES`.
    tool : the one that cuts it.
    centre : the exact closed path of the cutter's centre. If it is a hole, as inside a bore, it is
        run counter-clockwise, else clockwise, for climb milling (spindle clockwise).
    right, left : names of the part's boundaries produced on either side of the cutter, seen in the
        direction of cutting; empty where none is produced.
    depths : Z of each pass [mm], descending.
    room : largest radius of the arcs that lead onto and off the path [mm]; 0 for none.
    note : for the machine operator, or empty.

    Raises
    ------
    GeometryError
        With key "toolpath" if a text or the tool is invalid, the depths do not descend or the room
        is negative; with key "part" if the centre's path is not a boundary.
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

    def __post_init__(self) -> None:
        for text in (self.name, self.strategy, self.right, self.left, self.note):
            instance("toolpath", text, str, "a text")
        instance("toolpath", self.tool, Tool, "a tool")
        require_boundary(self.centre)
        depths = array("toolpath", instance("toolpath", self.depths, tuple, "a tuple of depths"))
        if not len(depths) or not np.all(np.diff(depths) < 0.0):
            raise GeometryError("must be descending depths", "toolpath", shown(self.depths))
        hold(
            self,
            depths=tuple(depths.tolist()),
            room=number("toolpath", self.room, least=0.0, unit="mm"),
        )


def passes(top: float, bottom: float, largest: float | None) -> tuple[float, ...]:
    """Z of equal passes of at most `largest` [mm], the last at `bottom` exactly; one if None.

    Raises
    ------
    GeometryError
        With key "output.gcode.pass_depth", if that makes more than `MOST_PASSES`.
    """
    depth = positive("part", top - bottom, "mm")
    count = 1
    if largest is not None:
        share = depth / positive("output.gcode.pass_depth", largest, "mm") * (1.0 - 1e-12)
        if share > MOST_PASSES:
            message = f"must be at least {depth / MOST_PASSES:.3g} mm: no more passes than that"
            raise GeometryError(message, "output.gcode.pass_depth", f"{largest:g}")
        count = max(1, math.ceil(share))
    return (*(top - depth * (k + 1) / count for k in range(count - 1)), bottom)
