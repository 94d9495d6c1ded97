"""The strokes of letters: rounds within each, from the inside outwards."""

from __future__ import annotations

import shapely

from camgeo.contour.contour import Contour, Effort, Fit
from camgeo.contour.nearness import least_distance
from camgeo.errors import GeometryError
from camgeo.toolpath.cut import Cut, LetterCut
from camgeo.toolpath.lettering import FINE, centres, strokes
from camgeo.toolpath.moves import Heights, Move
from camgeo.toolpath.plane.track import Track
from camgeo.toolpath.strategies.walk import Walk
from camgeo.toolpath.sweep import Area


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
