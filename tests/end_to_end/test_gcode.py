"""The program of each fixture scene, run by our own interpreter, against the exact curves."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely

from tests.end_to_end.built import CHORDS, DENSE, Built
from tests.end_to_end.exact import TURN, Flank
from tests.end_to_end.program import Program, outline, run
from tests.measuring import DensePath, polygon

POINTS = 20_000

GAP = 1e-12
"""Printed end points are the same numbers; a closed loop closes exactly [mm]."""

STEP = {"mm": 1e-4, "inch": 2.54e-4}
"""The last decimal of a program [mm]."""

ARC_ERROR = 0.002
"""Strictest check of radii that was seen in a controller [mm]."""


@pytest.fixture(scope="module")
def program(built: Built) -> Program:
    return run(built.file(".ngc"))


def _exact_paths(built: Built) -> dict[str, np.ndarray]:
    """Dense points of each cutter path, by the tool's radius and the sides of the material."""
    names = {name: path.dense(DENSE) for name, path in _flank_paths(built).items()}
    if built.spec.bore is not None and built.design.cam.contact != "outer":
        radius = (built.spec.bore - built.gcode.tool_diameter) / 2.0
        names["bore"] = radius * np.exp(1j * np.linspace(0.0, TURN, DENSE, endpoint=False))
    return names


def _flank_paths(built: Built) -> dict[str, Flank]:
    """The cutter paths along flanks, by the names of their operations."""
    tool = built.gcode.tool_diameter / 2.0
    if built.design.cam.contact == "inner":
        return {"outline": built.flank("inner", tool)}
    if built.design.cam.contact == "outer":
        return {"outline": built.flank("outer", -tool)}
    inner, outer = built.flank("inner", tool), built.flank("outer", -tool)
    return {"inner flank": inner, "outer flank": outer}


def _depth(built: Built, operation: str) -> float:
    flanks = ("inner flank", "outer flank")
    depth = built.spec.groove_depth if operation in flanks else built.thickness
    assert depth is not None
    return depth


def test_frame(built: Built, program: Program) -> None:
    unit = {"mm": "G21", "inch": "G20"}[built.design.scene.unit]
    for word in ("G17", unit, "G40", "G49", "G54", "G80", "G90", "G94", "G91.1", "M6", "G43"):
        assert word in program.words
    assert program.words[-2:] == ["M5", "M2"]
    assert all(len(line) <= 78 for line in built.file(".ngc").read_text().splitlines())
    moves = [move for moves in program.operations.values() for move in moves]
    for move in moves:
        if move.code == 0:  # traverses at the safe height or straight up and down, never into it
            assert move.start == move.end or np.isnan(move.start) or move.z_end == move.z_start
            lowest = min(move.z_start, move.z_end)
            assert (
                np.isnan(lowest)
                or move.start == move.end
                or (lowest == pytest.approx(built.gcode.safe_height))
            )
            assert move.z_end == pytest.approx(built.gcode.safe_height)
        else:
            assert move.feed > 0.0
            assert move.spindle
        if move.code == 1 and move.z_end != move.z_start:
            assert move.start == move.end  # plunges straight down
            assert move.feed == pytest.approx(built.gcode.plunge_feed)
        elif move.code > 0:
            assert move.feed == pytest.approx(built.gcode.feed)
        if move.code > 1:
            radii = abs(move.start - move.centre), abs(move.end - move.centre)
            assert abs(radii[0] - radii[1]) <= ARC_ERROR
            assert abs(move.sweep) <= np.pi * (1.0 + 1e-6)


def test_paths_lie_on_the_exact_offsets(built: Built, program: Program) -> None:
    exact = _exact_paths(built)
    assert set(program.operations) - {""} == set(exact)
    worst = 0.0
    for name, points in exact.items():
        path = DensePath(points)
        passes = program.passes(name)
        depth = _depth(built, name)
        count = math.ceil(depth / (built.gcode.pass_depth or depth) - 1e-9)
        levels = [moves[0].z_end for moves in passes]
        assert levels == pytest.approx([-depth * (k + 1) / count for k in range(count)], abs=1e-4)
        loops = [outline(moves[1:-1]) for moves in passes]  # without lead-in and lead-out
        for loop in loops:
            assert abs(loop.starts[0] - loop.ends[-1]) <= GAP
            assert np.array_equal(loop.starts, loops[0].starts)  # all passes equally
        there = loops[0].distances(points[:: DENSE // POINTS])
        back = path.distances(loops[0].dense(POINTS))
        worst = max(worst, float(np.max(there)), float(np.max(back)))
        # Climb milling, spindle clockwise: clockwise round material, else counter-clockwise.
        climb = -1 if name in ("inner flank",) or built.design.cam.contact == "inner" else 1
        assert np.sign(loops[0].area) == (climb if name != "bore" else 1)
    worst += program.blending
    assert worst <= built.tolerance + CHORDS
    assert built.deviation(".ngc") >= worst - CHORDS


def test_the_cutter_rolls_round_corners(built: Built, program: Program) -> None:
    """Once a pass, about the corner itself, and about the roller's centre where it turned."""
    step = STEP[built.design.scene.unit]
    for name, path in _flank_paths(built).items():
        for moves in program.passes(name):
            arcs = [move for move in moves[1:-1] if move.code > 1]
            for hinge, arm, sweep in path.turns:
                # Ends rounded by half a diagonal of the last decimal tilt the chord of a short
                # arc, and its centre swings by as much.
                reach = step * (1.0 + 2.0 / abs(sweep))
                about = [move for move in arcs if abs(move.centre - hinge) <= reach]
                turned = [abs(move.sweep) for move in about]
                assert sum(turned) == pytest.approx(abs(sweep), abs=4.0 * step / abs(arm))
                radii = [abs(move.start - move.centre) for move in about]
                assert radii == pytest.approx([abs(arm)] * len(about), abs=2.0 * step)


def test_cutter_never_enters_the_part(built: Built, program: Program) -> None:
    """Leads and plunges included: all of the path keeps the tool's radius from the material."""
    tool = built.gcode.tool_diameter / 2.0
    boundaries = {exact.name: exact for exact in built.through + built.groove}
    against = {
        "bore": [("bore", True)],
        "outline": [("inner", False)] if built.design.cam.contact == "inner" else [("outer", True)],
        "inner flank": [("inner", False), ("outer", True)],
        "outer flank": [("inner", False), ("outer", True)],
    }
    for name in set(program.operations) - {""}:
        moves = program.passes(name)[-1]
        points = np.append(outline(moves).dense(5_000), moves[-1].end)
        for boundary, inside in against[name]:
            exact = boundaries[boundary]
            circle = name == "bore"  # the keyway is not milled
            radius = (built.spec.bore or 0.0) / 2.0
            room = radius - np.abs(points) if circle else exact.path.distances(points)
            assert np.min(room) >= tool - built.tolerance - CHORDS
            region = polygon(exact.points)
            within = shapely.contains_xy(region, points.real, points.imag)
            assert np.all(within == inside)


def test_leads_are_tangential(built: Built, program: Program) -> None:
    for name in set(program.operations) - {""}:
        for moves in program.passes(name):
            first, second, last = moves[0], moves[1], moves[-1]
            assert last.start == second.start
            for lead, there in ((first, first.end), (last, last.start)):
                neighbour = second if lead is first else moves[-2]
                arm = (there - lead.centre) * np.sign(lead.sweep)
                other = (there - neighbour.centre) * np.sign(neighbour.sweep)
                if neighbour.code == 1:
                    other = -1j * (neighbour.end - neighbour.start)
                turn = abs(np.angle(arm / other))
                # Centres are rounded to half a diagonal of the last decimal, 0.7e-5 in, and end
                # points too; the smaller arm turns by twice that over its length.
                assert turn <= 3.0 * STEP[built.design.scene.unit] / min(abs(arm), abs(other))
