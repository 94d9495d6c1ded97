"""A mark as wide as the cutter: to and fro along a line."""

from __future__ import annotations

from camgeo.contour.contour import Effort
from camgeo.toolpath.cut import Cut, LineCut
from camgeo.toolpath.moves import Heights, Move
from camgeo.toolpath.plane.track import Track
from camgeo.toolpath.strategies.around import descent
from camgeo.toolpath.strategies.walk import Walk


def engrave(cut: Cut, heights: Heights, tolerance: float, effort: Effort) -> list[Move]:  # noqa: ARG001  all strategies are called alike
    """To each depth in turn by ramps along the line, straight down where the tool may plunge, and
    once along it there.
    """
    if not isinstance(cut, LineCut):
        raise TypeError(f"{cut.name}: the strategy {cut.strategy} cuts along a line")
    walk = Walk(cut, heights)
    line = Track.line(cut.start, cut.end)
    walk.above(cut.start)
    walk.down(cut.top)
    above = cut.top
    for z in cut.depths:
        if cut.tool.plunges:
            walk.down(z)
        else:
            for end in descent(cut, above, z, line.length):
                walk.follow(line, end, both=True)
                line = line.reversed()
        walk.follow(line, both=True)
        line = line.reversed()
        above = z
    walk.up()
    return walk.moves
