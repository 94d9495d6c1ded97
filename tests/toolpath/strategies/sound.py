"""What must hold for the moves of any strategy, and a cutter for the tests."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from camgeo.geometry.contour.contour import Contour, Effort, distances
from camgeo.geometry.outline.path import whole
from camgeo.milling.cut import AreaCut, ContourCut, Cut
from camgeo.milling.milling import Heights, Tool
from camgeo.milling.moves import Move, Rapid
from camgeo.milling.strategies import cut_moves
from camgeo.milling.track import Track
from camgeo.part.boundaries import CurveBoundary, ExactBoundary
from camgeo.part.part import Boundary
from tests.contour.cams import dwell, move, translating
from tests.toolpath.cutting import steps_of

HEIGHTS = Heights(clearance=12.0, retract=3.0)

RAMP = math.radians(2.5)

TOOL = Tool(
    number=1, diameter=10.0, spindle_speed=3000.0, feed=600.0, plunge_feed=80.0, stepdown=5.0,
    stepover=2.0, ramp_angle=RAMP,
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
    return cut_moves(cut, HEIGHTS, TOLERANCE, effort)


def require_sound(moves: list[Move], tool: Tool = TOOL, rapids: int = 0) -> None:
    """Traverses, arcs and feeds; if stated, as many traverses: over the place, down, and up."""
    assert not rapids or sum(isinstance(move, Rapid) for move in moves) == rapids
    assert isinstance(moves[0], Rapid)
    assert isinstance(moves[-1], Rapid)
    assert moves[0].end[2] == moves[-1].end[2] == HEIGHTS.clearance
    for before, after in pairwise(moves):
        if isinstance(after, Rapid):
            across = before.end[:2] != after.end[:2]
            assert across != (before.end[2] != after.end[2])
            assert not across or before.end[2] == HEIGHTS.clearance
            assert after.end[2] >= HEIGHTS.retract
    for step in steps_of(moves):
        drop = step.high - step.low
        assert step.way > 1e-6 or drop > 0.0
        if step.sweep:
            assert abs(step.radius - abs(step.end - step.centre)) < 1e-8
            assert abs(step.sweep) <= math.pi * (1.0 + 1e-9)
        assert 0.0 < step.feed <= tool.feed * (1.0 + 1e-12)
        assert step.feed * drop <= tool.plunge_feed * math.hypot(step.way, drop) * (1.0 + 1e-9)


def require_allowance(track: Track, cut: AreaCut, most: float, *walls: Boundary) -> None:
    """A path keeps the allowance of walls, by default those of its cut, and leaves no more than
    `most` [mm] beside it. Chords within 1e-3 mm of the walls count.
    """
    for wall in walls or cut.walls:
        ring = wall.polyline(1e-3, "fast").contour.vertices
        left = distances(ring, track) - cut.tool.radius - cut.allowance
        assert np.min(left) >= -2e-3
        assert np.max(left) <= most


def descents(moves: list[Move]) -> list[tuple[float, float]]:
    """(way in the plane, drop) [mm] of the moves that go down by feed."""
    return [(step.way, step.high - step.low) for step in steps_of(moves) if step.high > step.low]


def steepest(moves: list[Move], ramp: float = RAMP) -> float:
    """The largest slope of the ramps down, no more than the tool may run."""
    slope = max(drop / way for way, drop in descents(moves) if way > 0.0)
    assert slope <= math.tan(ramp) * (1.0 + 1e-9)
    return slope
