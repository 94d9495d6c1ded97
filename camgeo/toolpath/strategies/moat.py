"""Clearing around a round boss in full material: a slot along it, widened outward by a spiral."""

from __future__ import annotations

import math

import numpy as np

from camgeo.contour.contour import Contour, Effort
from camgeo.errors import GeometryError
from camgeo.toolpath.cut import AreaCut, Cut
from camgeo.toolpath.leads import begun
from camgeo.toolpath.moves import Heights, Move
from camgeo.toolpath.plane.spiral import fitted
from camgeo.toolpath.plane.track import Track, chained
from camgeo.toolpath.strategies.area import along, coarse, require_clear, spiral, star_of
from camgeo.toolpath.strategies.around import descend
from camgeo.toolpath.strategies.walk import Walk


def moat(cut: Cut, heights: Heights, tolerance: float, effort: Effort) -> list[Move]:  # noqa: ARG001  all strategies are called alike
    """To each depth in turn by a helix along the boss, from there a spiral out to the wall around
    it, and a full round along that.

    Raises
    ------
    GeometryError
        If the cutter is too large for the area, or that is none around a boss.
    """
    if not isinstance(cut, AreaCut) or [wall.hole for wall in cut.walls] != [False, True]:
        raise GeometryError("is cleared around a boss, within a wall", "toolpath", cut.name)
    boss, edge = cut.walls
    fine = coarse(cut, tolerance)
    inner, outer = along(boss, cut, fine), along(edge, cut, fine)
    morph = spiral(
        cut, star_of(inner, boss.name), star_of(outer, edge.name), 0.0, fine, outward=True
    )
    outward = fitted(morph, fine)
    helix = Track.arc(outward.start, 0j, 2.0 * math.pi if cut.climb else -2.0 * math.pi)
    last = begun(outer, morph.b.along(morph.finish))
    level = chained((helix, outward, Track.around(last if cut.climb else last.reversed())))
    for wall in cut.walls:
        require_clear(level, wall, cut, fine)
    # The cutter may pass where it has been, but not over the boss.
    kept = Track.around(Contour.circle(float(np.min(np.abs(inner.vertices))) - fine))
    walk = Walk(cut, heights)
    above = cut.top
    for number, z in enumerate(cut.depths):
        if number:
            walk.over(helix.start, kept)
            walk.down(above)
        descend(walk, helix, above, z)
        walk.follow(level)
        above = z
    walk.up()
    return walk.moves
