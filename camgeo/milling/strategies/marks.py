"""Strategies that work on single places: holes, lines and letters."""

from __future__ import annotations

import shapely

from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour, Effort, Fit, least_distance
from camgeo.milling.cut import Cut, LetterCut, LineCut, PointCut
from camgeo.milling.making import FINE, centres, strokes
from camgeo.milling.moves import Heights, Move
from camgeo.milling.stages import Area
from camgeo.milling.strategies.around import descent
from camgeo.milling.strategies.walk import Walk
from camgeo.milling.track import Track


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


# -- engrave --------------------------------------------------------------------------------------
# A mark as wide as the cutter: to and fro along a line.


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


# -- letters --------------------------------------------------------------------------------------
# The strokes of letters: rounds within each, from the inside outwards.


def letters(cut: Cut, heights: Heights, tolerance: float, effort: Effort) -> list[Move]:  # noqa: ARG001  all strategies are called alike
    """Straight down to each depth in turn and once around, then on to the next round at the
    clearance height.

    Raises
    ------
    GeometryError
        With key "toolpath", if a path comes too near to an outline.
    """
    if not isinstance(cut, LetterCut):
        raise TypeError(f"{cut.name}: the strategy {cut.strategy} cuts letters")
    walk = Walk(cut, heights)
    walls = [each.arcs(FINE, "fast") for each in cut.walls]
    for stroke in strokes(cut.walls):
        around = [each for each in walls if _bounds(each, stroke)]
        for path in centres(stroke, cut):
            _require_clear(path, around, cut)
            track = Track.around(path)
            walk.above(track.start)
            walk.down(cut.top)
            for z in cut.depths:
                walk.down(z)
                walk.follow(track)
    walk.up()
    return walk.moves


def _bounds(wall: Fit, stroke: Area) -> bool:
    """Whether a wall bounds a stroke."""
    point = complex(wall.contour.vertices[0])
    apart = shapely.distance(shapely.Point(point.real, point.imag), shapely.boundary(stroke))
    return float(apart) <= 2.0 * FINE


def _require_clear(path: Contour, walls: list[Fit], cut: LetterCut) -> None:
    needed = cut.tool.radius + cut.allowance
    for wall in walls:
        apart = least_distance(Track.around(path), Track.around(wall.contour)) - wall.deviation
        if apart < needed:
            message = f"{cut.name} comes {needed - apart:.3g} mm too near to an outline"
            raise GeometryError(message, key="toolpath")
