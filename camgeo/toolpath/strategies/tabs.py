"""Heights along a round: even, or lifted over the tabs that hold the part."""

from __future__ import annotations

import math

import numpy as np

from camgeo.errors import GeometryError
from camgeo.toolpath.cut import ContourCut
from camgeo.toolpath.plane.track import Track
from camgeo.toolpath.strategies.walk import ramp_of
from camgeo.toolpath.tool import ToolError

RISE = math.radians(30.0)
"""Of the way up onto a tab, through the slot that the cutter has just made."""

STEEPEST = math.radians(45.0)
"""Of the way down from a tab of a tool that may plunge."""


def lifted(cut: ContourCut, track: Track, start: float, end: float) -> list[tuple[float, float]]:
    """(distance along the round, z) [mm] from `start` to `end` of a round, evenly but for tabs.

    Over each tab the cutter stays above its top, which is given above the last depth, over the
    width of the tab and its own diameter, so that its circle leaves that width. It rises steeply
    and comes down no steeper than it may enter material. The first tab lies half a space behind the
    start, where leads join. Rounds with tabs start at the point with the largest x, so that a
    finish leaves the tabs where the roughing has left them.

    Raises
    ------
    ToolError
        With field "ramp_angle", if the ramps down from the tabs are too flat for the space between.
    GeometryError
        With key "holding.count", if the tabs do not fit one after the other at all.
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
        room = space - up - wide
        least = math.atan2(drop, room)
        if not cut.tool.plunges and least < STEEPEST:
            raise ToolError(
                f"ramps of {math.degrees(ramp_of(cut)):.3g} degrees down from {tabs.count} tabs do"
                f" not fit between them on the {length:.4g} mm of {cut.name}: at least"
                f" {math.degrees(least):.3g} degrees are needed, or fewer or lower tabs, or a tool"
                " that plunges",
                cut.tool,
                "ramp_angle",
            )
        most = math.floor(length / (up + wide + drop))
        raise GeometryError(
            f"{tabs.count} tabs, each wider than stated by the cutter's diameter, and the ways onto"
            f" them and down again do not fit on the {length:.4g} mm of {cut.name}; there is room"
            f" for {most}",
            key="holding.count",
            value=f"{tabs.count}",
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
