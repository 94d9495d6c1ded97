"""What must hold for the moves of any strategy, and a cutter for the tests."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from typing import Any

from camgeo.geometry.contour.contour import Contour, Effort
from camgeo.geometry.outline.path import whole
from camgeo.milling.cut import AreaCut, ContourCut, Cut
from camgeo.milling.machining_time import arc_sweep
from camgeo.milling.moves import ArcFeed, Heights, Move, Rapid
from camgeo.milling.strategies import STRATEGIES
from camgeo.milling.tool import Tool
from camgeo.part.boundaries import CurveBoundary, ExactBoundary
from camgeo.part.part import Boundary
from tests.contour.cams import dwell, move, translating

HEIGHTS = Heights(clearance=12.0, retract=3.0)

TOOL = Tool(
    number=1, diameter=10.0, spindle_speed=3000.0, feed=600.0, plunge_feed=80.0, stepdown=5.0,
    stepover=2.0, ramp_angle=math.radians(2.5),
)  # fmt: skip

TOLERANCE = 0.001

LIMIT = math.radians(50.0)
"""Of the engagement of a cutter in the tests."""

DISC = CurveBoundary(
    "outline",
    hole=False,
    path=whole(translating(dwell(60), move(120, 20.0), dwell(40), move(140, 0.0))),
)
"""A lobe with hollow flanks, from 32 to 52 mm."""


def round_blank(radius: float) -> ExactBoundary:
    return ExactBoundary("stock", hole=False, exact=Contour.circle(radius))


def round_hole(radius: float) -> ExactBoundary:
    return ExactBoundary("bore", hole=True, exact=Contour.circle(radius))


def cleared(strategy: str, *walls: Boundary, **own: Any) -> AreaCut:
    """A cut of an area, with `TOOL` and `LIMIT` unless `own` says otherwise."""
    given = {
        "name": "roughing", "tool": replace(TOOL, engagement=LIMIT), "top": 0.0,
        "depths": (-4.0, -8.0), "allowance": 0.2, "stepover": 2.0, **own,
    }  # fmt: skip
    return AreaCut(strategy=strategy, walls=walls, **given)


def made(cut: Cut) -> list[Move]:
    """Its moves; a path that is followed closely has the fewest arcs."""
    effort: Effort = "fewest" if isinstance(cut, ContourCut) else "fast"
    return STRATEGIES[cut.strategy](cut, HEIGHTS, TOLERANCE, effort)


def require_sound(moves: list[Move], tool: Tool = TOOL) -> None:
    """Traverses, arcs and feeds."""
    assert isinstance(moves[0], Rapid)
    assert isinstance(moves[-1], Rapid)
    assert moves[0].end[2] == moves[-1].end[2] == HEIGHTS.clearance
    for before, after in pairwise(moves):
        at, end = complex(*before.end[:2]), complex(*after.end[:2])
        drop = before.end[2] - after.end[2]
        if isinstance(after, Rapid):
            assert (at == end) != (drop == 0.0)
            assert at == end or before.end[2] == HEIGHTS.clearance
            assert after.end[2] >= HEIGHTS.retract
            continue
        way = abs(end - at)
        assert way > 1e-6 or drop > 0.0
        if isinstance(after, ArcFeed):
            centre = complex(*after.centre)
            assert abs(abs(at - centre) - abs(end - centre)) < 1e-8
            way = abs(at - centre) * abs(arc_sweep(at - centre, end - centre, ccw=after.ccw))
            assert way <= math.pi * abs(at - centre) * (1.0 + 1e-9)
        length = math.hypot(way, drop)
        assert 0.0 < after.feed <= tool.feed * (1.0 + 1e-12)
        assert after.feed * drop / length <= tool.plunge_feed * (1.0 + 1e-9)


def descents(moves: list[Move]) -> list[tuple[float, float]]:
    """(way in the plane, drop) [mm] of the moves that go down by feed."""
    found = []
    for before, after in pairwise(moves):
        drop = before.end[2] - after.end[2]
        if not isinstance(after, Rapid) and drop > 0.0:
            at, end = complex(*before.end[:2]), complex(*after.end[:2])
            way = abs(end - at)
            if isinstance(after, ArcFeed):
                centre = complex(*after.centre)
                way = abs(at - centre) * abs(arc_sweep(at - centre, end - centre, ccw=after.ccw))
            found.append((way, drop))
    return found
