"""Letters as programs cut them: within their strokes, all but their corners, or told."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pytest
import shapely

import camgeo
from camgeo.cam.cam import Contact
from camgeo.errors import FileError, GeometryError
from camgeo.milling.cut import LetterCut
from camgeo.milling.judged import unmade_names
from camgeo.milling.machine import load
from camgeo.milling.milling import OperationSpec, Tool
from camgeo.milling.moves import Feed, Stop
from camgeo.milling.plan import plan_toolpath
from camgeo.milling.polygons import polygon
from camgeo.milling.strategies import CORNERS, STANDOFF, centres, cut_moves, strokes
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.part.spec import Engraving
from camgeo_export.gcode.writer import WRITER
from camgeo_export.verify.gcode import VERIFIER
from tests.export.verified import TOLERANCE, faults
from tests.part.parts import refused
from tests.toolpath.milled import HEIGHTS, SPEC, named, part, sequence, tool

TEXT = Engraving("Ø8i", 6.0, 0.3, 24.0)

ENGRAVED = replace(SPEC, engraving=(TEXT,))

MILL = tool(12.0, stepdown=8.0)

FINE = tool(0.3, 2, stepdown=0.15, stepover=0.12, plunges=True)

SCENE = """
camgeo = 1
name = "plate7"
[cam]
rotation = "ccw"
[follower]
kind = "translating-roller"
base_radius = 40
roller_radius = 8
[[motion]]
dwell = 120
[[motion]]
law = "polynomial-345"
span = 120
to = 15
[[motion]]
law = "polynomial-345"
span = 120
to = 0
[part]
thickness = 8
[[part.engraving]]
text = "Ø7"
height = 6
depth = 0.3
radius = 20
[holding]
kind = "fixture"
through = 0.5
[[tool]]
number = 2
diameter = 0.3
spindle_speed = 20000
feed = 120
plunge_feed = 40
stepdown = 0.15
stepover = 0.12
plunges = true
[[operation]]
kind = "engrave"
boundary = "engraving 1"
tool = 2
[output]
tolerance = 0.01
formats = ["gcode"]
"""


def cut_of(*tools: Tool, text: Engraving = TEXT) -> LetterCut:
    spec = replace(SPEC, engraving=(text,))
    found = named(sequence(Contact.INNER, *tools, spec=spec))["engrave engraving 1"]
    assert isinstance(found, LetterCut)
    return found


def test_a_text_is_engraved_with_the_first_tool_that_fits() -> None:
    found = sequence(
        Contact.INNER, MILL, replace(FINE, number=3, plunges=False), FINE, spec=ENGRAVED
    )
    cut = named(found)["engrave engraving 1"]
    assert (cut.tool.number, cut.strategy, cut.depths) == (2, "letters", (-0.15, -0.3))
    assert len(cut.produced) == 3 + 3 + 2
    assert unmade_names(part(Contact.INNER, ENGRAVED), found.cuts) == ()
    assert cut.note == "corners keep the radius of the cutter, 0.15 mm"


@pytest.mark.parametrize(
    ("fine", "reason"),
    [
        (replace(FINE, diameter=0.6), r"0.6 mm are wider than a stroke at X \d"),
        (replace(FINE, plunges=False), "letters take a tool that plunges"),
        (replace(FINE, corner_radius=0.05), "letters are cut with a flat end mill"),
        (replace(FINE, flute_length=0.2), "its cutting edges, 0.2 mm, are shorter than 0.3 mm"),
        (replace(FINE, stepover=None), "it states no stepover or no stepdown"),
    ],
)
def test_what_no_tool_makes_is_told_or_refused(fine: Tool, reason: str) -> None:
    found = sequence(Contact.INNER, MILL, fine, spec=ENGRAVED)
    (said,) = (each for each in found.findings if each.name == "engraving-1-left-out")
    assert re.search(f"engraving 1: left out, tool 1: .*; tool 2: {reason}", said.sentence)
    assert len(unmade_names(part(Contact.INNER, ENGRAVED), found.cuts)) == 8
    operation = OperationSpec(kind="engrave", tool=2, boundary="engraving 1")
    with pytest.raises(GeometryError, match=reason if fine.stepover else "states no stepover"):
        sequence(Contact.INNER, MILL, fine, operations=(operation,), spec=ENGRAVED)


def test_no_operation_makes_it() -> None:
    other = replace(ENGRAVED, engraving=(TEXT, replace(TEXT, angle=math.pi)))
    operation = OperationSpec(kind="engrave", tool=2, boundary="engraving 2")
    found = sequence(Contact.INNER, MILL, FINE, operations=(operation,), spec=other)
    (said,) = (each for each in found.findings if each.name == "left-out")
    assert said.sentence == "no operation makes engraving 1"
    with pytest.raises(
        GeometryError, match='it has "outline", "bore", "engraving 1", "engraving 2"'
    ):
        sequence(
            Contact.INNER, FINE, spec=other,
            operations=(replace(operation, boundary="engraving 3"),),
        )  # fmt: skip


@pytest.mark.parametrize("stepover", [0.05, 0.12, 0.3])
@pytest.mark.parametrize("diameter", [0.1, 0.3])
def test_strokes_are_cleared_but_for_their_corners(diameter: float, stepover: float) -> None:
    """What is left lies in corners: an opening by the cutter, slightly larger, contains it."""
    fine = replace(FINE, diameter=diameter, stepover=min(stepover, diameter))
    cut = cut_of(MILL, fine, text=replace(TEXT, text="8T"))
    for stroke in strokes(cut.walls):
        swept = shapely.union_all(
            [
                shapely.buffer(shapely.LinearRing(_points(each.vertices)), fine.radius)
                for each in centres(stroke, cut)
            ]
        )
        assert shapely.difference(swept, shapely.buffer(stroke, 1e-3)).is_empty
        left = shapely.difference(stroke, shapely.buffer(swept, 3.0 * STANDOFF))
        within = shapely.buffer(stroke, -fine.radius, quad_segs=CORNERS)
        opened = shapely.buffer(within, fine.radius - 4.0 * STANDOFF, quad_segs=CORNERS)
        assert shapely.intersection(left, opened).area <= 1e-9
        assert left.area <= 0.06 * stroke.area


def _points(vertices: ComplexArray) -> FloatArray:
    return np.column_stack((vertices.real, vertices.imag))


@pytest.mark.parametrize("climb", [True, False])
def test_moves_go_straight_down_and_around(climb: bool) -> None:
    cut = replace(cut_of(MILL, FINE), climb=climb)
    operation = plan_toolpath((cut,), HEIGHTS, load("linuxcnc").arcs, 0.01).operations[0]
    moves = [each for each in operation.moves if not isinstance(each, Stop)]
    assert {each.end[2] for each in moves if isinstance(each, Feed)} == {0.0, -0.15, -0.3}
    region = polygon([each.arcs(1e-4).contour for each in cut.walls], 1e-4)
    low = [complex(*each.end[:2]) for each in moves if isinstance(each, Feed) and each.end[2] < 0.0]
    points = shapely.points([each.real for each in low], [each.imag for each in low])
    apart = shapely.distance(points, shapely.boundary(region))
    assert np.all(shapely.contains(region, points))
    assert np.min(apart) >= cut.tool.radius - 1e-4
    ring = next(each for each in strokes(cut.walls) if each.interiors)
    paths = centres(ring, cut)
    outer = max(paths, key=lambda each: abs(each.area))
    assert (outer.area > 0.0) == climb
    assert {each.area > 0.0 for each in paths} == {True, False}


def test_a_path_that_would_cut_an_outline_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    cut = cut_of(MILL, FINE)
    monkeypatch.setattr("camgeo.milling.strategies.STANDOFF", -0.01)
    with pytest.raises(GeometryError, match="too near to an outline"):
        cut_moves(cut, HEIGHTS, 0.01, "fast")
    with pytest.raises(TypeError, match="cuts letters"):
        cut_moves(
            replace(named(sequence(Contact.INNER))["outline"], strategy="letters"),
            HEIGHTS,
            0.01,
            "fast",
        )


def test_a_program_is_measured_verified_and_simulated() -> None:
    """What corners of letters keep is part of the target, and no rest."""
    product = camgeo.loads(SCENE).disc
    milled = product.milled
    (outline,) = milled.findings(milled.toolpath(TOLERANCE), TOLERANCE)
    assert outline.sentence == "no operation makes outline"
    data = WRITER.write(product, TOLERANCE).data
    assert WRITER.measure(product, data) <= TOLERANCE
    assert faults(VERIFIER, product, data) == []
    # A point moved by more than a stroke.
    x = list(re.finditer(r"\nG1 X([0-9.]+) Y", text := data.decode()))[20]
    moved = f"{text[: x.start(1)]}{float(x[1]) + 1.0:.3f}{text[x.end(1) :]}"
    with pytest.raises(FileError, match="too close to a wall"):
        WRITER.measure(product, moved.encode())


def test_rounds_without_number_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("camgeo.milling.strategies.MOST_TURNS", 3)
    with refused("tool.stepover", "more than 3 rounds in a stroke"):
        cut_moves(replace(cut_of(MILL, FINE), stepover=1e-6), HEIGHTS, 0.01, "fast")


def test_a_letter_that_is_left_standing_is_a_rest() -> None:
    """The simulation knows what letters are to be: too shallow a text is found."""
    product = camgeo.loads(SCENE.replace("depth = 0.3", "depth = 0.5")).disc
    milled = product.milled
    toolpath = milled.toolpath(TOLERANCE)
    deep = camgeo.loads(SCENE).disc.milled.toolpath(TOLERANCE)
    cut = toolpath.operations[0].cut
    shallow = replace(toolpath, operations=(replace(deep.operations[0], cut=cut),))
    assert "rest" in {each.name for each in milled.findings(shallow, TOLERANCE)}
