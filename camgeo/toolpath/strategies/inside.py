"""Clearing of a hole: down by a helix, and outward by a spiral, so that no core comes loose."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.part.part import Boundary
from camgeo.toolpath.cut import AreaCut
from camgeo.toolpath.leads import Beside, begun, lead_at
from camgeo.toolpath.moves import Heights, Move
from camgeo.toolpath.plane.spiral import fitted
from camgeo.toolpath.plane.star import Star
from camgeo.toolpath.plane.track import Track, chained
from camgeo.toolpath.strategies.area import (
    along,
    coarse,
    flattest_direction,
    require_clear,
    spiral,
    star_of,
)
from camgeo.toolpath.strategies.around import descend
from camgeo.toolpath.strategies.walk import SAME, Walk

HELIX = 0.75
"""Radius of the helix as a share of that within which the cutter is flat: nothing is left in the
middle, and the middle of the cutter, which may not cut, stays out of it."""

WHOLE = 0.95
"""A round hole with a path of at most this share of the cutter's radius is bored by the helix
alone."""

ROOM = 0.5
"""Of the way off the wall, as a share of the cutter's radius."""


def inside(cut: AreaCut, wall: Boundary, heights: Heights, tolerance: float) -> list[Move]:
    """A helix down to each depth in turn, from the middle or round a hole that is there, and from
    it a spiral out to the wall and a full round along it; a narrow round hole by the helix alone.

    Raises
    ------
    GeometryError
        If the cutter is too large for the hole, or no spiral possible.
    """
    fine = coarse(cut, tolerance)
    path = along(wall, cut, fine)
    flat = max(cut.tool.radius - cut.tool.corner_radius, 0.25 * cut.tool.radius)
    star = star_of(path, wall.name)
    least = star.distances().lowest.value
    walk = Walk(cut, heights)
    turned = 2.0 * math.pi if cut.climb else -2.0 * math.pi
    if _is_circle(path) and least <= WHOLE * flat:
        whole = Track.around(path if cut.climb else path.reversed())
        require_clear(whole, wall, cut, fine)
        for above, z in pairwise((cut.top, *cut.depths)):
            descend(walk, whole, above, z)
        walk.follow(whole)
        walk.follow(Track.line(whole.start, 0j))
        walk.up()
        return walk.moves
    hole = _hole(cut, fine)
    middle = min(HELIX * flat, 0.5 * least) if hole is None else min(hole, 0.9 * least)
    finish = flattest_direction(path)
    morph = spiral(cut, _circle(middle), star, finish, fine, outward=True)
    outward = fitted(morph, fine)
    helix = Track.arc(outward.start, 0j, turned)
    last = begun(path, star.along(finish))
    last = last if cut.climb else last.reversed()
    lead = lead_at(
        last,
        ROOM * min(cut.tool.radius, least),
        Beside(free=walk.free, usual=cut.tool.radius),
    )
    off = () if lead is None else (lead.off,)
    # The first round of the spiral begins on that of the helix, whose floor is still sloping.
    first = (helix,) if hole is None else ()
    level = chained((*first, outward, Track.around(last), *off))
    require_clear(level, wall, cut, fine)
    above = cut.top
    for number, z in enumerate(cut.depths):
        if number:
            walk.follow(Track.line(walk.place, helix.start))
        if hole is None:
            descend(walk, helix, above, z)
        else:
            if not number:
                walk.above(helix.start)
            walk.down(z)
        walk.follow(level)
        above = z
    walk.follow(Track.line(walk.place, 0.5 * walk.place))
    walk.up()
    return walk.moves


def _circle(radius: float) -> Star:
    found = Star.of(Contour.circle(radius))
    assert found is not None  # as of every circle about the pole
    return found


def _is_circle(path: Contour) -> bool:
    return bool(np.all(path.sweeps != 0.0) and np.max(np.abs(path.centres)) < SAME)


def _hole(cut: AreaCut, fine: float) -> float | None:
    """Radius [mm] of the cutter's path inside a hole about the axis that is there.

    None without one that it fits into with room to come down.
    """
    found = None
    for each in cut.cleared:
        star = Star.of(each.arcs(fine, "fast").contour)
        if star is not None:
            room = star.distances().lowest.value - cut.tool.radius - 2.0 * fine
            if room > 0.1 * cut.tool.radius:
                found = max(room, found or 0.0)
    return found
