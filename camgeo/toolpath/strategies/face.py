"""Facing: the whole upper face of the blank by a spiral from outside inward."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.errors import GeometryError
from camgeo.toolpath.cut import AreaCut
from camgeo.toolpath.moves import Heights, Move
from camgeo.toolpath.plane.parallel import grown
from camgeo.toolpath.plane.spiral import fitted
from camgeo.toolpath.plane.star import Star
from camgeo.toolpath.plane.track import Track, chained
from camgeo.toolpath.strategies.area import coarse, spiral
from camgeo.toolpath.strategies.walk import Walk

ROOM = 0.75
"""Of the way into the blank, as a share of the cutter's radius."""

INNERMOST = 0.9
"""Radius of the last round as a share of that within which the cutter is flat."""


def face(cut: AreaCut, heights: Heights, tolerance: float) -> list[Move]:
    """At each depth: down in the air beside the blank, and round it inward to its middle.

    Between depths the cutter runs out again over what it has cleared.

    Raises
    ------
    GeometryError
        If the blank is unknown, or too long and narrow for a spiral.
    """
    if cut.stock is None:
        raise GeometryError(f"{cut.name} needs the outline of the blank", "stock")
    fine = coarse(cut, tolerance)
    blank = cut.stock.arcs(fine, "fast").contour
    middle = blank.moments.first / blank.area
    radius = cut.tool.radius
    flat = max(radius - cut.tool.corner_radius, 0.25 * radius)
    begin = Star.of(grown(blank, radius), middle)
    ends = [Star.of(Contour.circle(each, middle), middle) for each in (radius, INNERMOST * flat)]
    if begin is None or ends[0] is None or ends[1] is None:
        raise GeometryError("the blank is too long and narrow to be faced by a spiral", "stock")
    # Nothing is left within the cutter's radius: there is no engagement to measure.
    paced = spiral(cut, begin, ends[0], 0.0, fine, outward=False)
    wide = begin.distances().highest.value
    longer = (wide - INNERMOST * flat) / (wide - radius)
    morph = replace(paced, b=ends[1], turns=paced.turns * longer)
    turned = fitted(morph, fine)
    free = -morph.side
    centre = turned.start + free * 1j * turned.headings[0] * ROOM * radius
    entry = Track.arc(turned.start, centre, -free * 0.5 * np.pi).reversed()
    circle = Track.arc(turned.end, middle, morph.sense * 2.0 * np.pi)
    level = chained((entry, turned, circle))
    walk = Walk(cut, heights)
    for z in cut.depths:
        walk.over(level.start)
        walk.down(z)
        walk.follow(level)
    walk.up()
    return walk.moves
