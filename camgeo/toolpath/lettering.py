"""The strokes of engraved letters, and what a round cutter makes of them.

Strokes are polygons a thousandth of a millimetre off at most; where the centre of a cutter may be,
they are shrunk by slightly more than its radius, and the paths that follow are proved to keep off
the exact outlines (`camgeo.toolpath.strategies.letters`).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import takewhile
from typing import Final

import shapely

from camgeo.contour.contour import Contour
from camgeo.errors import GeometryError
from camgeo.numeric.arrays import ComplexArray
from camgeo.part.part import Boundary
from camgeo.printing.nozzle import unreached
from camgeo.toolpath.cut import LetterCut
from camgeo.toolpath.plane.spiral import MOST_TURNS
from camgeo.toolpath.sweep import Area, parts, polygon, rings
from camgeo.toolpath.tool import END_MILL, Tool

FINE: Final = 1e-3
"""Tolerance [mm] of the outlines of strokes, of their chords, and of what paths are thinned by."""

OFF: Final = 4.0 * FINE
"""By how much cutters stay off letters [mm], so that their paths can be proved to cut none: once
for each of these, and for the chords of round corners."""

CORNERS: Final = 24
"""Chords of a quarter of a round corner."""


def strokes(walls: Sequence[Boundary]) -> list[Area]:
    """A polygon for each connected stroke [mm]."""
    return parts(polygon([each.arcs(FINE, "fast").contour for each in walls], FINE))


def unfit(tool: Tool, walls: Sequence[Boundary]) -> str:
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
