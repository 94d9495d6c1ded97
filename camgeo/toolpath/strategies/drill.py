"""Holes drilled in pecks."""

from __future__ import annotations

from camgeo.contour.contour import Effort
from camgeo.toolpath.cut import Cut, PointCut
from camgeo.toolpath.moves import Heights, Move
from camgeo.toolpath.strategies.walk import Walk


def drill(cut: Cut, heights: Heights, tolerance: float, effort: Effort) -> list[Move]:  # noqa: ARG001  all strategies are called alike
    """Each hole to its depths one after the other, out of it for chips after each.

    All of it at the feed of a drill, or the plunge feed of a cutter: no rapid enters a hole.
    """
    if not isinstance(cut, PointCut):
        raise TypeError(f"{cut.name}: the strategy {cut.strategy} cuts at points")
    walk = Walk(cut, heights)
    for place in cut.points:
        walk.above(place)
        for z in cut.depths:
            walk.down(z, feed=cut.sinking)
            walk.out()
    walk.up()
    return walk.moves
