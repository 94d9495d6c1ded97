"""The program of each fixture scene, run by our own interpreter, against the exact curves."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely

from camgeo.milling.cut import ContourCut
from camgeo.milling.milling import Tool
from tests.end_to_end.built import CHORDS, Built
from tests.end_to_end.exact import TURN
from tests.end_to_end.features import DENSE
from tests.end_to_end.program import Move, Program, outline, run
from tests.measuring import DensePath, polygon

POINTS = 10_000

GAP = 1e-12
"""Printed end points are the same numbers; a closed loop closes exactly [mm]."""


@pytest.fixture(scope="module")
def program(built: Built) -> Program:
    return run(built.file(".ngc").read_text("ascii"))


def _tool(built: Built) -> Tool:
    """The one tool of the scene."""
    milling = built.design.scene.milling
    assert milling is not None
    (tool,) = milling.tools
    return tool


def _cut(built: Built, operation: str) -> ContourCut:
    """As the sequence was planned."""
    return next(cut for cut in built.design.disc.milled.contour_cuts if cut.name == operation)


def _away(built: Built, operation: str) -> float:
    """How far off its wall the centre runs: a roughing leaves its allowance even where it is off
    by its slack.
    """
    cut = _cut(built, operation)
    return cut.tool.radius + cut.allowance + cut.slack


def _exact_paths(built: Built, program: Program) -> dict[str, np.ndarray]:
    """Dense points of each cutter path, by the tool's radius and the sides of the material."""
    found: dict[str, np.ndarray] = {}
    for name in set(program.operations) - {""}:
        wall, away = name.removeprefix("rough "), _away(built, name)
        if wall == "bore":
            assert built.spec.bore is not None
            radius = built.spec.bore / 2.0 - away
            found[name] = radius * np.exp(1j * np.linspace(0.0, TURN, DENSE, endpoint=False))
            continue
        inner = wall == "inner flank" or (wall == "outline" and built.design.cam.contact == "inner")
        found[name] = built.flank(*(("inner", away) if inner else ("outer", -away))).dense(DENSE)
    return found


def _depth(built: Built, operation: str) -> float:
    if "flank" in operation:
        assert built.spec.groove_depth is not None
        return built.spec.groove_depth
    milling = built.design.scene.milling
    assert milling is not None
    assert milling.holding is not None
    return built.thickness + milling.holding.through - (milling.holding.skin or 0.0)


def _is_rough(operation: str) -> bool:
    return operation.startswith("rough ")


def _slopes(move: Move) -> bool:
    return move.z_start != move.z_end and move.start != move.end


def _rounds(operation: str, moves: list[Move]) -> list[list[Move]]:
    """The closed rounds at one depth, without the leads of a finish."""
    found: list[list[Move]] = [[]]
    for move in moves if _is_rough(operation) else moves[1:-1]:
        if found[-1] and found[-1][-1].end == found[-1][0].start:
            found.append([])
        found[-1].append(move)
    return found


def test_paths_lie_on_the_exact_offsets(built: Built, program: Program) -> None:
    exact = _exact_paths(built, program)
    finished = {name for name in exact if not _is_rough(name)}
    assert finished == {name.removeprefix("rough ") for name in exact}
    worst = 0.0
    for name, points in exact.items():
        path = DensePath(points)
        passes = program.passes(name)
        depth = _depth(built, name)
        stepdown = _tool(built).stepdown
        assert stepdown is not None
        # Rough cuts come down along their path, each round by a pass at most, to a level one.
        assert [moves[0].z_end for moves in passes] == pytest.approx([-depth], abs=1e-4)
        rounds = [_rounds(name, moves) for moves in passes]
        assert [len(each) for each in rounds] == [1 if _is_rough(name) else 2]  # a spring round
        down = [move for move in program.operations[name] if move.code > 0 and _slopes(move)]
        assert bool(down) == _is_rough(name)
        if down:
            once = sum(abs(move.end - move.start) for move in rounds[0][0])
            way = sum(abs(move.end - move.start) for move in down)
            assert way >= once * (math.ceil(depth / stepdown - 1e-9) - 0.01)
        loops = [outline(each) for one in rounds for each in one]
        for loop in loops:
            assert abs(loop.starts[0] - loop.ends[-1]) <= GAP
            assert np.array_equal(loop.starts, loops[0].starts)  # all passes equally
        there = loops[0].distances(points[:: DENSE // POINTS])
        back = path.distances(loops[0].dense(POINTS))
        slack = _cut(built, name).slack
        assert slack <= (0.02 if _is_rough(name) else 0.0)
        worst = max(worst, float(np.max(there)) - slack, float(np.max(back)) - slack)
        wall = name.removeprefix("rough ")
        # Climb milling, spindle clockwise: clockwise round material, else counter-clockwise.
        climb = -1 if wall == "inner flank" or built.design.cam.contact == "inner" else 1
        assert np.sign(loops[0].area) == (climb if wall != "bore" else 1)
    worst += program.blending
    assert worst <= built.tolerance + CHORDS
    assert built.deviation(".ngc") >= worst - CHORDS


def test_cutter_never_enters_the_part(built: Built, program: Program) -> None:
    """Leads and plunges included: all of the path keeps the tool's radius from the material."""
    tool = _tool(built).radius
    boundaries = {exact.name: exact for exact in built.boundaries}
    against = {
        "bore": [("bore", True)],
        "outline": [("inner", False)] if built.design.cam.contact == "inner" else [("outer", True)],
        "inner flank": [("inner", False), ("outer", True)],
        "outer flank": [("inner", False), ("outer", True)],
    }
    for name in set(program.operations) - {""}:
        moves = program.passes(name)[-1]
        points = np.append(outline(moves).dense(5_000), moves[-1].end)
        for boundary, inside in against[name.removeprefix("rough ")]:
            exact = boundaries[boundary]
            circle = boundary == "bore"  # the keyway is not milled
            radius = (built.spec.bore or 0.0) / 2.0
            room = radius - np.abs(points) if circle else exact.path.distances(points)
            assert np.min(room) >= tool - built.tolerance - CHORDS
            region = polygon(exact.points)
            within = shapely.contains_xy(region, points.real, points.imag)
            assert np.all(within == inside)
