"""Rounds along the closed path of the cutter's centre: finishes, slots, chamfers.

The path is the exact parallel, fitted once within the tolerance, or that of a roughing within its
slack; each round runs all of it.
"""

from __future__ import annotations

import math

import numpy as np

from camgeo.errors import GeometryError, UndercutError
from camgeo.geometry.contour.contour import Contour, Effort
from camgeo.milling.compensation import side_of
from camgeo.milling.cut import ContourCut, Cut
from camgeo.milling.milling import CONTROL, Heights, ToolError
from camgeo.milling.moves import Move
from camgeo.milling.strategies.walk import SAME, Walk, cut_of_kind
from camgeo.milling.track import Beside, Track, begun, flattest, joined, started

MOST_ROUNDS = 1000
"""Of one descent along a path: more is a ramp far too flat for it."""


def profile(cut: Cut, heights: Heights, tolerance: float, effort: Effort) -> list[Move]:
    """Along one boundary, outside material or inside a hole.

    Where the material beside the path is cleared: down next to it, onto it and once around at each
    depth, with tangential leads, and back beside it between depths. Else the cutter comes down
    along the path itself, see `slot`. Spring rounds follow at the last depth.

    Raises
    ------
    GeometryError
        If the cutter is too large for the boundary, or there is no room for leads.
    """
    cut = cut_of_kind(cut, ContourCut, "runs along a path")
    if not (cut.cleared and cut.room):
        return slot(cut, heights, tolerance, effort)
    walk = Walk(cut, heights)
    path = fitted(cut, tolerance, effort)
    side = side_of(cut)
    beside = Beside(
        free=walk.free,
        usual=cut.tool.radius,
        straight=bool(side),
        aside=cut.tool.radius if cut.compensation == CONTROL else 0.0,
        avoid=walk.avoid(cut.bottom),
        least=0.0 if cut.tool.plunges else cut.rest,
    )
    place = None if cut.tabs is None else farthest_along_x(path)
    try:
        contour, lead = joined(path, cut.room, beside, place=place)
    except GeometryError as error:
        raise GeometryError(f"{cut.name}: {error.message}", error.key, error.value) from None
    track = Track.around(contour)
    back = Track.line(lead.off.end, lead.into.start)
    walk.above(lead.into.start)
    for number, z in enumerate(cut.depths):
        if number:
            walk.follow(back)
        walk.down(z)
        _lead_in(walk, lead.into, side)
        for _ in range(1 + (cut.springs if z == cut.bottom else 0)):
            walk.profile(track, lifted(cut, track, z, z))
        _lead_off(walk, lead.off, side)
    walk.up()
    return walk.moves


def _lead_in(walk: Walk, into: Track, side: str) -> None:
    """Onto the path; its first piece switches compensation on, if there is a `side` for it."""
    first = float(into.lengths[0]) if side else 0.0
    if side:
        walk.follow(into.between(0.0, first), switch=side)
    walk.follow(into.between(first, into.length))


def _lead_off(walk: Walk, off: Track, side: str) -> None:
    """Off the path; its last piece switches compensation off."""
    last = off.length - float(off.lengths[-1]) if side else off.length
    walk.follow(off.between(0.0, last))
    if side:
        walk.follow(off.between(last, off.length), switch="off")


def slot(cut: Cut, heights: Heights, tolerance: float, effort: Effort) -> list[Move]:
    """Rounds in full material, or between two boundaries with a cutter as wide as the gap.

    Down to the material on the path itself, then along it, no steeper than the tool may, to each
    depth in turn without leaving the path, and once around at the last one; spring rounds follow.

    Raises
    ------
    GeometryError
        If the cutter is too large for the path, or the path so short that the descent would take
        more than `MOST_ROUNDS`.
    """
    cut = cut_of_kind(cut, ContourCut, "runs along a path")
    walk = Walk(cut, heights)
    contour = fitted(cut, tolerance, effort)
    if cut.tabs is None:
        contour = started(contour, next(flattest(contour)))
    else:
        contour = begun(contour, farthest_along_x(contour))
    track = Track.around(contour)
    walk.above(track.start)
    both = bool(cut.left)
    if cut.tool.plunges:
        for z in cut.depths:
            walk.down(z)
            walk.profile(track, lifted(cut, track, z, z), both=both)
    else:
        walk.down(cut.top)
        for z in cut.depths:
            for end in descent(cut, walk.z, z, track.length):
                walk.profile(track, lifted(cut, track, walk.z, end), both=both)
        walk.profile(track, lifted(cut, track, cut.bottom, cut.bottom), both=both)
    for _ in range(cut.springs):
        walk.profile(track, lifted(cut, track, cut.bottom, cut.bottom), both=both)
    walk.up()
    return walk.moves


RAMP = math.radians(3.0)
"""Descent into material where the tool states none; its Z feed is limited all the same."""


def ramp_of(cut: Cut) -> float:
    """Steepest descent of the cut's tool into material [rad]."""
    return RAMP if cut.tool.ramp_angle is None else cut.tool.ramp_angle


def descent(cut: Cut, top: float, bottom: float, length: float) -> list[float]:
    """Z [mm] at the end of each round of `length` [mm] from `top` to `bottom`, evenly.

    No round is steeper than the tool may run.

    Raises
    ------
    GeometryError
        If these are more than `MOST_ROUNDS`.
    """
    rounds = math.ceil((top - bottom - SAME) / (length * math.tan(ramp_of(cut))))
    if rounds > MOST_ROUNDS:
        least = math.degrees(math.atan((top - bottom) / (MOST_ROUNDS * length)))
        raise ToolError(
            f"the descent of {cut.name} takes more than {MOST_ROUNDS} rounds of {length:.3g} mm:"
            f" the ramp of {math.degrees(ramp_of(cut)):g} degrees is too flat for it; at least"
            f" {least:.3g} are needed",
            cut.tool,
            "ramp_angle",
        )
    step = (bottom - top) / max(rounds, 1)
    return [*(top + step * k for k in range(1, rounds)), bottom][:rounds]


def descend(walk: Walk, round_: Track, top: float, bottom: float) -> None:
    """Down along a closed track from `top` to `bottom` [mm], first from above."""
    if not walk.moves:
        walk.above(round_.start)
        walk.down(top)
    for z in descent(walk.cut, top, bottom, round_.length):
        walk.follow(round_, z)


def farthest_along_x(contour: Contour) -> float:
    """Distance [mm] along the contour from its first vertex to its point with the largest x.

    Parallels have these points on one normal.
    """
    arms = contour.vertices - contour.centres
    turned = np.mod(-np.angle(arms) * np.where(contour.sweeps < 0.0, -1.0, 1.0), 2.0 * np.pi)
    round_there = (contour.sweeps != 0.0) & (turned < np.abs(contour.sweeps))
    most = np.where(round_there, contour.centres.real + contour.radii, contour.vertices.real)
    index = int(np.argmax(most))
    before = float(np.sum(contour.lengths[:index]))
    return before + (float(turned[index] * contour.radii[index]) if round_there[index] else 0.0)


def fitted(cut: ContourCut, tolerance: float, effort: Effort) -> Contour:
    """The cutter's path as lines and arcs within `tolerance` [mm], in the direction of cutting.

    Within a larger slack of the cut it is fitted fast.

    Raises
    ------
    GeometryError
        With key "tool", if the cutter cannot reach the whole boundary.
    """
    try:
        coarse = cut.slack > tolerance
        fit = cut.centre.arcs(cut.slack, "fast") if coarse else cut.centre.arcs(tolerance, effort)
    except UndercutError as error:
        raise ToolError(
            f"the cutter is too large for the {cut.name}: a concave part of it is more tightly"
            f" curved than the cutter ({error.message})",
            cut.tool,
        ) from None
    contour = fit.contour
    return contour if cut.centre.hole == cut.climb else contour.reversed()


# -- tabs -----------------------------------------------------------------------------------------
# Heights along a round: even, or lifted over the tabs that hold the part.


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
