"""Heights along a round: even, or lifted over the tabs that hold the part."""

from __future__ import annotations

import math

import numpy as np

from camgeo.errors import GeometryError
from camgeo.toolpath.cut import ContourCut
from camgeo.toolpath.plane.track import Track
from camgeo.toolpath.strategies.walk import ramp_of

RISE = math.radians(30.0)
"""Of the way up onto a tab, through the slot that the cutter has just made."""


def lifted(cut: ContourCut, track: Track, start: float, end: float) -> list[tuple[float, float]]:
    """(distance along the round, z) [mm] from `start` to `end` of a round, evenly but for tabs.

    Over each tab the cutter stays above its top, which is given above the last depth, over the
    width of the tab and its own diameter, so that its circle leaves that width. It rises steeply
    and comes down no steeper than it may enter material. The first tab lies half a space behind the
    start, where leads join. Rounds with tabs start at the point with the largest x, so that a
    finish leaves the tabs where the roughing has left them.

    Raises
    ------
    GeometryError
        With key "holding.width", if tabs and ramps do not fit one after the other.
    """
    length = track.length
    tabs = cut.tabs
    top = -math.inf if tabs is None else cut.bottom + tabs.height
    if tabs is None or min(start, end) >= top:
        return [(0.0, start), (length, end)]
    wide = tabs.width + cut.tool.diameter
    drop = top - min(start, end)
    down = 1.0 if cut.tool.plunges else math.tan(ramp_of(cut))
    up, off = drop / math.tan(RISE), drop / down
    space = length / tabs.count
    taken = up + wide + off
    if taken > space:
        raise GeometryError(
            f"{tabs.count} tabs with the ramps beside them take {tabs.count * taken:.4g} mm of the"
            f" {length:.4g} mm of {cut.name}",
            key="holding.width",
            value=f"{tabs.width:g}",
        )
    middles = space * (np.arange(tabs.count) + 0.5)
    shape = np.array([-0.5 * wide - up, -0.5 * wide, 0.5 * wide, 0.5 * wide + off])
    places = (middles[:, None] + shape + 0.5 * (up - off)).ravel()
    slope = (end - start) / length
    over = start + slope * places
    on_top = np.tile([False, True, True, False], tabs.count)
    heights = np.where(on_top, np.maximum(over, top), over)
    inner = list(zip(places.tolist(), heights.tolist(), strict=True))
    return [(0.0, start), *inner, (length, end)]
