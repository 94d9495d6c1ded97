"""Strategies that work on single places: holes, lines and letters."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import takewhile
from typing import Final

import shapely

from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour, Effort, Fit, least_distance
from camgeo.milling.cut import Cut, LetterCut, LineCut, PointCut
from camgeo.milling.milling import END_MILL, Heights, Tool
from camgeo.milling.moves import Move
from camgeo.milling.polygons import Area, parts, polygon, rings
from camgeo.milling.strategies.around import descent
from camgeo.milling.strategies.clear import MOST_TURNS
from camgeo.milling.strategies.walk import Walk, cut_of_kind
from camgeo.milling.track import Track
from camgeo.numeric.arrays import ComplexArray
from camgeo.part.nozzle import unreached
from camgeo.part.part import Boundary


def drill(cut: Cut, heights: Heights, tolerance: float, effort: Effort) -> list[Move]:  # noqa: ARG001  all strategies are called alike
    """Each hole to its depths one after the other, out of it for chips after each.

    All of it at the feed of a drill, or the plunge feed of a cutter: no rapid enters a hole.
    """
    cut = cut_of_kind(cut, PointCut, "cuts at points")
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
    cut = cut_of_kind(cut, LineCut, "cuts along a line")
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
# The strokes of engraved letters, and what a round cutter makes of them: rounds within each, from
# the inside outwards.
#
# Strokes are polygons a thousandth of a millimetre off at most; where the centre of a cutter may
# be, they are shrunk by slightly more than its radius, and the paths that follow are proved to keep
# off the exact outlines.


FINE: Final = 1e-3
"""Tolerance [mm] of the outlines of strokes, of their chords, and of what paths are thinned by."""

OFF: Final = 4.0 * FINE
"""By how much cutters stay off letters [mm], so that their paths can be proved to cut none: once
for each of these, and for the chords of round corners."""

CORNERS: Final = 24
"""Chords of a quarter of a round corner."""


def letters(cut: Cut, heights: Heights, tolerance: float, effort: Effort) -> list[Move]:  # noqa: ARG001  all strategies are called alike
    """Straight down to each depth in turn and once around, then on to the next round at the
    clearance height.

    Raises
    ------
    GeometryError
        With key "toolpath", if a path comes too near to an outline.
    """
    cut = cut_of_kind(cut, LetterCut, "cuts letters")
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
            raise GeometryError(
                f"{cut.name} comes {needed - apart:.3g} mm too near to an outline", key="toolpath"
            )


def strokes(walls: Sequence[Boundary]) -> list[Area]:
    """A polygon for each connected stroke [mm]."""
    return parts(polygon([each.arcs(FINE, "fast").contour for each in walls], FINE))


def unfit_for_letters(tool: Tool, walls: Sequence[Boundary]) -> str:
    """Why a tool does not make the strokes of letters; empty if it does."""
    if tool.kind != END_MILL or tool.corner_radius:
        return "letters are cut with a flat end mill"
    if not tool.plunges:
        return "letters take a tool that plunges"
    for stroke in strokes(walls):
        place = unreached(stroke, tool.radius + OFF)
        if place is not None:
            x, y = place
            return f"{tool.diameter:g} mm are wider than a stroke at X {x:.4g}, Y {y:.4g} mm"
    return ""


def centres(stroke: Area, cut: LetterCut) -> list[Contour]:
    """Paths of the cutter's centre that clear a stroke, the innermost first: counter-clockwise in a
    hole and clockwise around what stands in it, where the cut climbs.

    Raises
    ------
    GeometryError
        With key "tool.stepover", if they are more than `MOST_TURNS`.
    """
    step = min(cut.stepover, cut.tool.radius)
    first = cut.tool.radius + cut.allowance + OFF
    shrunk = (
        shapely.buffer(stroke, -(first + number * step), quad_segs=CORNERS)
        for number in range(int(stroke.length / step) + 2)
    )
    found: list[Contour] = []
    for number, area in enumerate(takewhile(lambda each: not each.is_empty, shrunk)):
        if number == MOST_TURNS:
            message = f"makes more than {MOST_TURNS} rounds in a stroke of {cut.name}"
            raise GeometryError(message, "tool.stepover", f"{cut.stepover:g}")
        thin = shapely.orient_polygons(shapely.simplify(area, FINE))
        found += [_round(ring[:-1], climb=cut.climb) for ring in rings(thin)]
    return found[::-1]


def _round(ring: ComplexArray, *, climb: bool) -> Contour:
    """A path along a ring, of which outer ones run counter-clockwise."""
    contour = Contour.polygon(ring)
    return contour if climb else contour.reversed()


def reached(cut: LetterCut) -> list[Contour]:
    """The outlines of what the cutter makes of the letters: their corners are round."""
    found: list[Contour] = []
    for stroke in strokes(cut.walls):
        within = shapely.buffer(stroke, -cut.tool.radius, quad_segs=CORNERS)
        made = shapely.buffer(within, cut.tool.radius, quad_segs=CORNERS)
        found += [Contour.polygon(ring[:-1]) for ring in rings(made)]
    return found
