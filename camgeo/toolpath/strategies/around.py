"""Rounds along the closed path of the cutter's centre: finishes, slots, chamfers.

The path is the exact parallel, fitted once within the tolerance, or that of a roughing within its
slack; each round runs all of it.
"""

from __future__ import annotations

import math

from camgeo.contour.contour import Contour, Effort
from camgeo.errors import GeometryError, UndercutError
from camgeo.toolpath.compensation import side_of
from camgeo.toolpath.cut import ContourCut, Cut
from camgeo.toolpath.leads import Beside, begun, farthest_along_x, flattest, joined, started
from camgeo.toolpath.moves import Heights, Move
from camgeo.toolpath.plane.track import Track
from camgeo.toolpath.strategies.tabs import lifted
from camgeo.toolpath.strategies.walk import SAME, Walk, ramp_of
from camgeo.toolpath.tool import CONTROL, ToolError

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
    cut = contour_cut(cut)
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
    cut = contour_cut(cut)
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


def contour_cut(cut: Cut) -> ContourCut:
    """The cut, if it is one along a path; else TypeError."""
    if not isinstance(cut, ContourCut):
        raise TypeError(f"{cut.name}: the strategy {cut.strategy} runs along a path")
    return cut


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
