"""Clearing of a groove: a slot along its middle, widened on both sides towards the walls."""

from __future__ import annotations

import math

from camgeo.contour.contour import Contour
from camgeo.contour.nearness import least_distance
from camgeo.errors import GeometryError
from camgeo.numeric.arrays import phase
from camgeo.part.part import Boundary
from camgeo.toolpath.cut import AreaCut
from camgeo.toolpath.leads import begun, flattest, started
from camgeo.toolpath.moves import Heights, Move
from camgeo.toolpath.plane.spiral import MOST_TURNS
from camgeo.toolpath.plane.track import Track
from camgeo.toolpath.strategies.area import SPENT, along, coarse, off_joints, require_clear, star_of
from camgeo.toolpath.strategies.around import descent
from camgeo.toolpath.strategies.walk import Walk


def ring(
    cut: AreaCut, solid: Boundary, hole: Boundary, heights: Heights, tolerance: float
) -> list[Move]:
    """Between a wall around it, `hole`, and one within it, `solid`, which are parallel.

    To each depth in turn along the middle, and from there rounds nearer to the outer wall, then
    back and nearer to the inner one, each by climb milling.

    Raises
    ------
    GeometryError
        If the cutter is too large for the groove, or there are more than `MOST_TURNS` rounds.
    """
    fine = coarse(cut, tolerance)
    outer, inner = (Track.around(each.arcs(tolerance, "fast").contour) for each in (hole, solid))
    width = least_distance(outer, inner)
    play = width - cut.tool.diameter - 2.0 * cut.allowance - 2.0 * SPENT * fine
    if play < 0.0:
        raise GeometryError(
            f"the cutter must be narrower than the groove of {width:.4g} mm with the allowances on"
            " both sides",
            key="tool",
            value=f"{cut.tool.diameter:g}",
        )
    if 0.5 * play > MOST_TURNS * cut.stepover:
        message = f"makes more than {MOST_TURNS} rounds on each side of the groove's middle"
        raise GeometryError(message, "tool.stepover", f"{cut.stepover:g}")
    count = math.ceil(0.5 * play / cut.stepover)
    offs = [0.5 * play * (count - k) / count for k in range(1, count + 1)] if count else []
    middle = _begun(along(hole, cut, fine, 0.5 * play), climb=cut.climb)
    point = middle.start
    sides = [
        [_beside(wall, along(wall, cut, fine, off), point, ccw=ccw) for off in offs]
        for wall, ccw in ((hole, cut.climb), (solid, not cut.climb))
    ]
    for track in (middle, *sides[0], *sides[1]):
        for wall in (hole, solid):
            require_clear(track, wall, cut, fine)
    walk = Walk(cut, heights)
    walk.above(point)
    walk.down(cut.top)
    above = cut.top
    for z in cut.depths:
        for end in descent(cut, above, z, middle.length):
            walk.follow(middle, end, both=True)
        walk.follow(middle, both=True)
        for rounds in sides:
            for track in rounds:
                walk.follow(Track.line(walk.place, track.start))
                walk.follow(track)
            walk.follow(Track.line(walk.place, point))
        above = z
    walk.up()
    return walk.moves


def _begun(path: Contour, *, climb: bool) -> Track:
    path = started(path, next(flattest(path)))
    return Track.around(path if climb else path.reversed())


def _beside(wall: Boundary, path: Contour, point: complex, *, ccw: bool) -> Track:
    """Once round a path, from where the ray through `point` meets it."""
    star = star_of(path, wall.name)
    path = begun(path, star.along(off_joints(path, star, phase(point))))
    return Track.around(path if ccw else path.reversed())
