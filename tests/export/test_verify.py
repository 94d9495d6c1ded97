"""Verification: of files that other programs wrote, of its parts, of files that name the running
version, and of programs as they are simulated.
"""

from __future__ import annotations

import hashlib
import io
import json
import math
import random
import re
from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import ezdxf
import numpy as np
import pytest
import trimesh
from hypothesis import example, given, settings
from hypothesis import strategies as st

import camgeo
from camgeo.app.answers.verify import FileVerdict, Reference, Wanted, first_difference, verify_files
from camgeo.design.design import Design
from camgeo.design.product import Product
from camgeo.design.verify import Check, Origin, ReadingOptions, Verifier, parse_tolerance
from camgeo.design.writing import CERTIFICATE, make_files
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.contour.spline import Arc, CubicSpline, SplineContour
from camgeo.milling.machine import load
from camgeo.milling.moves import ArcFeed, Feed
from camgeo.milling.simulation import ToolRun
from camgeo.numeric.arrays import ComplexArray
from camgeo.part.boundaries import ExactBoundary
from camgeo_export.dxf.writer import WRITER as DXF
from camgeo_export.gcode.writer import WRITER as GCODE
from camgeo_export.interpreter.run import run as run_program
from camgeo_export.reading import TOKEN
from camgeo_export.stl import WRITER as STL
from camgeo_export.threemf.writer import WRITER as THREEMF
from camgeo_export.verify.body import solid_checks
from camgeo_export.verify.dxf import VERIFIER as DXF_VERIFIER
from camgeo_export.verify.gcode import VERIFIER as GCODE_VERIFIER
from camgeo_export.verify.gcode import simulation_checks, trace_program
from camgeo_export.verify.plane import boundary_shapes, contour_checks, contour_joints, farthest
from camgeo_export.verify.step import VERIFIER as STEP_VERIFIER
from camgeo_export.verify.stl import FACET, PREFIX
from camgeo_export.verify.stl import VERIFIER as STL_VERIFIER
from camgeo_export.verify.svg import VERIFIER as SVG_VERIFIER
from camgeo_export.verify.threemf import MODEL_PATH
from camgeo_export.verify.threemf import VERIFIER as THREEMF_VERIFIER
from tests.effects.scenes import SCENES as EFFECTS
from tests.export.stub_product import SECOND_TOOL, StubProduct
from tests.export.verified import TOLERANCE, Checks, checked, written
from tests.long_form import examples
from tests.packages import repacked

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"

FIT = 0.5 * TOLERANCE


@pytest.fixture(scope="module")
def design() -> Design:
    return camgeo.load(SCENES / "setzhub.toml")


def _failed(checks: Checks) -> set[str]:
    return {name for (name, _), check in checks.items() if check.ok is False}


# Foreign drawings ---------------------------------------------------------------------------------


def _drawing(
    design: Design,
    *,
    units: int = 4,
    scale: float = 1.0,
    decimals: int = 6,
    layer: str = "0",
    without: int | None = None,
) -> Any:
    """All boundaries as single lines and arcs, end points written with so many decimals."""
    document = ezdxf.new("R2010")  # type: ignore[attr-defined] # not exported explicitly
    document.header["$INSUNITS"] = units
    space = document.modelspace()
    attributes = {"layer": layer}
    for index, boundary in enumerate(design.disc.drawn.part.boundaries):
        contour = boundary.arcs(FIT, "fast").contour
        for start, end, sweep, centre in zip(
            contour.vertices, contour.ends, contour.sweeps, contour.centres, strict=True
        ):
            if index == without:
                continue
            if sweep == 0.0:
                points = [
                    (round(z.real * scale, decimals), round(z.imag * scale, decimals))
                    for z in (start, end)
                ]
                space.add_line(points[0], points[1], dxfattribs=attributes)
                continue
            first, last = (math.degrees(np.angle(z - centre)) for z in (start, end))
            if sweep < 0.0:
                first, last = last, first
            place = (round(centre.real * scale, decimals), round(centre.imag * scale, decimals))
            radius = round(abs(start - centre) * scale, decimals)
            space.add_arc(place, radius, first, last, dxfattribs=attributes)
    return document


def _data(document: Any) -> bytes:
    stream = io.StringIO()
    document.write(stream)
    return stream.getvalue().encode()


@pytest.mark.parametrize(
    ("units", "scale", "unit"), [(4, 1.0, None), (1, 1.0 / 25.4, None), (0, 1.0 / 25.4, "inch")]
)
def test_foreign_drawing_passes(design: Design, units: int, scale: float, unit: Any) -> None:
    """Single pieces with gaps of rounding, in any unit, stated by the file or by the user."""
    decimals = 6 if scale == 1.0 else 7
    data = _data(_drawing(design, units=units, scale=scale, decimals=decimals))
    checks = checked(DXF_VERIFIER, design.disc, data, ReadingOptions("a.dxf", unit=unit))
    assert not _failed(checks)
    gap = checks["closure", ""].value
    assert isinstance(gap, float)
    # Centre and radius are each off by up to 5e-7 mm, so that ends of flat arcs are, too.
    assert 0.0 < gap <= 1e-5
    assert checks["unit", ""].value == ("mm" if scale == 1.0 else "inch")
    for boundary in design.disc.drawn.part.boundaries:
        value = checks["deviation", boundary.name].value
        assert isinstance(value, float)
        assert gap <= value <= FIT + 3e-5
        area = checks["area", boundary.name]
        assert isinstance(area.value, float)
        assert isinstance(area.expected, float)
        assert area.limit is not None
        assert abs(area.value - area.expected) <= area.limit


def test_drawing_without_unit_is_not_measured(design: Design) -> None:
    checks = checked(DXF_VERIFIER, design.disc, _data(_drawing(design, units=0)))
    closure = checks["closure", ""]
    assert closure.ok is False
    assert re.search(r"does not state its unit .*\(--unit\)", closure.note)


def test_layers_of_a_foreign_drawing(design: Design) -> None:
    """Other layers do not count; without a layer everything does."""
    document = _drawing(design, layer="OUTLINE")
    document.modelspace().add_circle((0, 0), 3.0, dxfattribs={"layer": "HOLES"})
    data = _data(document)
    assert not _failed(
        checked(DXF_VERIFIER, design.disc, data, ReadingOptions("a.dxf", layer="OUTLINE"))
    )
    count = checked(DXF_VERIFIER, design.disc, data)["contours", ""]
    assert (count.value, count.expected, count.ok) == (3.0, 2.0, False)


@pytest.mark.parametrize(("code", "name"), [(38, "elevation"), (39, "thickness"), (43, "width")])
def test_drawings_lie_flat_within_the_tolerance(design: Design, code: int, name: str) -> None:
    """Their other groups do not matter."""
    lines = DXF.write(design.disc, TOLERANCE).data.decode().split("\n")
    place = lines.index("AcDbPolyline") + 1
    for value, expected in (("0.5", {name}), ("0.005", set())):
        other = [*lines[:place], f"{code:>3}", value, " 62", "1", *lines[place:]]
        checks = checked(DXF_VERIFIER, design.disc, "\n".join(other).encode())
        assert _failed(checks) == expected
        if expected:
            assert checks[name, ""].value == 0.5
            assert "LWPOLYLINE on layer CUT" in checks[name, ""].note


@pytest.mark.parametrize("entity", ["arcs", "lines-and-arcs"])
@pytest.mark.parametrize("layer", [b"BLIND_10", b"CUT"])
def test_edges_are_read_from_all_layers_of_the_part(entity: str, layer: bytes) -> None:
    """By depth, or as earlier versions drew them, all on layer CUT."""
    edits = {"fit": "fast", "dxf.auxiliary": False, "dxf.entity": entity}
    groove = camgeo.load(EFFECTS / "groove.toml").with_output(edits).disc
    data = DXF.write(groove, TOLERANCE).data.replace(b"\nBLIND_10\n", b"\n%s\n" % layer)
    checks = checked(DXF_VERIFIER, groove, data)
    assert not _failed(checks)
    assert checks["contours", ""].value == 4.0


def test_boundary_left_out_of_a_foreign_drawing(design: Design) -> None:
    checks = checked(DXF_VERIFIER, design.disc, _data(_drawing(design, without=1)))
    assert _failed(checks) == {"contours", "deviation"}
    assert checks["deviation", "bore"].note == "the file has no contour for it"
    assert checks["deviation", "outline"].ok


def test_gap_beyond_the_tolerance_is_reported(design: Design) -> None:
    document = _drawing(design)
    line = next(iter(document.modelspace().query("LINE")))
    line.dxf.start += ezdxf.math.Vec3(0.0, 3.0 * TOLERANCE)
    closure = checked(DXF_VERIFIER, design.disc, _data(document))["closure", ""]
    assert closure.ok is False
    assert "has a loose end at" in closure.note


# Foreign programs and meshes ----------------------------------------------------------------------


def test_program_without_comments_is_matched(design: Design) -> None:
    """Operations are distinguished by their paths where no comment names them."""
    text = GCODE.write(design.disc, TOLERANCE).data.decode()
    bare = re.sub(r"\([^()]*\)", "", text).encode()
    assert GCODE_VERIFIER.origin(bare) == Origin()
    checks = checked(GCODE_VERIFIER, design.disc, bare)
    assert not _failed(checks)
    named = {of for name, of in checks if name == "deviation"}
    assert named == {"rough bore", "bore", "rough outline", "outline"}


SPELLINGS: dict[str, Callable[[str], str]] = {
    "spaces": lambda text: re.sub(r"\n(G\d+) ", r"\n\1   ", text),
    "small letters": lambda text: re.sub(r"(?m)^G.*$", lambda each: each[0].lower(), text),
    "zeros": lambda text: re.sub(r"(?m)^G([0-3]) ", r"G0\1 ", text),
    "numbers of blocks": lambda text: re.sub(r"(?m)^(G[0-3] )", r"N10 \1", text),
    "empty lines": lambda text: text.replace("\nG1 ", "\n\nG1 "),
    "ends of lines": lambda text: text.replace("\n", "\r\n"),
}
"""Changes after which the machine does the same."""


@pytest.mark.parametrize("what", SPELLINGS)
def test_other_spellings_of_a_program_measure_the_same(design: Design, what: str) -> None:
    """No check says anything else, but for lines."""
    text = GCODE.write(design.disc, TOLERANCE).data.decode()
    after = SPELLINGS[what](text)
    assert after != text
    good, other = (
        [replace(each, note="") for each in checked(GCODE_VERIFIER, design.disc, data).values()]
        for data in (text.encode(), after.encode())
    )
    assert good == other


def test_a_roughing_may_be_off_by_its_slack_and_no_more(design: Design) -> None:
    text = GCODE.write(design.disc, TOLERANCE).data.decode()
    assert GCODE.measure(design.disc, text.encode()) <= TOLERANCE
    cut = next(each for each in design.disc.milled.contour_cuts if each.name == "rough outline")
    own = checked(GCODE_VERIFIER, design.disc, text.encode())["deviation", cut.name]
    assert isinstance(own.value, float)
    assert own.value <= TOLERANCE < own.value + cut.slack
    begin, end = text.index("(operation rough outline)"), text.index("(operation outline)")
    # Arcs keep their centres, which are stated from their starts.
    along = re.sub(r"X(\S+)", lambda word: f"X{float(word[1]) + 0.05:.4f}", text[begin:end])
    moved = (text[:begin] + along + text[end:]).encode()
    off = GCODE.measure(design.disc, moved)
    assert 0.05 - 2.0 * cut.slack <= off <= 0.05 + TOLERANCE
    assert checked(GCODE_VERIFIER, design.disc, moved)["deviation", cut.name].ok is False


def test_foreign_words_are_refused_with_a_sentence(design: Design) -> None:
    text = GCODE.write(design.disc, TOLERANCE).data.decode().replace("(camgeo", "(other")
    checks = checked(GCODE_VERIFIER, design.disc, text.replace("G17 ", "G17 G68 ").encode())
    assert re.search(r"line \d+: .*G68, a rotation; .*for LinuxCNC", checks["program", ""].note)
    checks = checked(GCODE_VERIFIER, design.disc, text.replace("G17 ", "G18 ").encode())
    assert "with an arc in the plane ZX" in checks["program", ""].note


def test_text_stl_of_another_program(design: Design) -> None:
    """In either unit; STL states none, so mm is assumed, which is reported."""
    mesh: Any = trimesh.load_mesh(
        io.BytesIO(STL.write(design.disc, FIT).data), file_type="stl", process=False
    )
    text = trimesh.exchange.stl.export_stl_ascii(mesh).encode()
    assert STL_VERIFIER.origin(text) == Origin()
    checks = checked(STL_VERIFIER, design.disc, text)
    assert not _failed(checks)
    assert "assumed" in checks["unit", ""].note
    mesh.apply_scale(1.0 / 25.4)
    inch = trimesh.exchange.stl.export_stl(mesh)
    assert {"deviation", "volume"} <= _failed(checked(STL_VERIFIER, design.disc, inch))
    note = checked(STL_VERIFIER, design.disc, inch)["deviation", "outline, lower face"].note
    assert "inch taken for mm?" in note
    reading = ReadingOptions("a.stl", unit="inch")
    assert not _failed(checked(STL_VERIFIER, design.disc, inch, reading))
    assert STL_VERIFIER.origin(text[: len(text) // 2]).damage.endswith("endsolid missing")


def test_3mf_in_inch_is_measured_in_inch(design: Design) -> None:
    def inch(path: str, text: str) -> str:
        if path != MODEL_PATH:
            return text
        text = text.replace('unit="millimeter"', 'unit="inch"').replace("camgeo", "other")
        return re.sub(r'([xyz])="([^"]+)"', lambda m: f'{m[1]}="{float(m[2]) / 25.4!r}"', text)

    data = repacked(THREEMF.write(design.disc, FIT).data, inch)
    assert THREEMF_VERIFIER.origin(data) == Origin()
    checks = checked(THREEMF_VERIFIER, design.disc, data)
    assert not _failed(checks)
    assert checks["unit", ""].value == "inch"


# Parts --------------------------------------------------------------------------------------------


@given(st.floats(-3.0, 3.0), st.floats(0.2, 3.0), st.booleans())
def test_kinks_of_lines_and_arcs(turn: float, sweep: float, left: bool) -> None:
    """A line, then an arc whose start is turned by `turn` against it; its end against the last."""
    sign = 1.0 if left else -1.0
    tangent = np.exp(1j * turn)
    centre = 1j * sign * tangent * 2.0
    end = centre - centre * np.exp(1j * sign * sweep)
    contour = Contour(
        np.array([-3.0 + 0j, 0j, end]),
        np.array([0.0, sign * sweep, 0.0]),
        np.array([0j, centre, 0j]),
    )
    joints = contour_joints(contour)
    assert joints.kinks[1] == pytest.approx(abs(turn), abs=1e-14)
    last = tangent * np.exp(1j * sign * sweep)
    assert joints.kinks[2] == pytest.approx(abs(np.angle((-3.0 - end) * np.conj(last))), abs=1e-13)
    assert joints.previous_length[1] == 3.0
    assert joints.next_length[1] == pytest.approx(2.0 * sweep)


def test_kinks_of_splines() -> None:
    """At the ends of a strand, and inside where a triple knot allows one."""
    controls = np.array([0, 1, 2, 3, 3 + 1j, 3 + 2j, 3 + 3j])
    knots = np.array([0.0, 0, 0, 0, 1, 1, 1, 2, 2, 2, 2])
    spline = CubicSpline(knots, controls)
    back = Arc(3 + 3j, 0j, math.pi, 1.5 + 1.5j)
    joints = contour_joints(SplineContour((spline, back)))
    assert joints.places == pytest.approx(np.array([0, 3, 3 + 3j]))
    # The half circle leaves at right angles to the diagonal and comes back so.
    assert joints.kinks == pytest.approx(np.radians([45.0, 90.0, 45.0]))


@pytest.mark.parametrize(("text", "length"), [
    ("0.001", 1e-3), ("0.001 mm", 1e-3), (" 1e-05 mm", 1e-5), ("", None), ("nan", None),
    ("inf mm", None), ("-1", None), ("0", None), ("1 inch", None),
])  # fmt: skip
def test_lengths_in_words(text: str, length: float | None) -> None:
    assert parse_tolerance(text) == length


def test_farthest_finds_a_dent() -> None:
    circle = Contour.circle(10.0)
    polygon = circle.points(1e-4)
    zero = np.zeros(len(polygon))
    dented = polygon.copy()
    dented[7] *= 1.01
    exact = Contour(polygon, zero, 0.0 * polygon)
    distance, place = farthest(exact, Contour(dented, zero, 0.0 * dented), 1e-4)
    assert distance == pytest.approx(0.1, abs=2e-4)
    assert place == dented[7]
    # From the outline to the contour, where the contour leaves a part of it out.
    cut = np.delete(polygon, np.arange(20, 40))
    distance, _ = farthest(exact, Contour(cut, 0.0 * cut.real, 0.0 * cut), 1e-4)
    chord = abs(polygon[40] - polygon[19])
    assert distance == pytest.approx(10.0 - math.sqrt(100.0 - 0.25 * chord**2), rel=0.01)
    assert farthest(exact, circle, 1e-4)[0] <= 2e-4


CUBE: Any = trimesh.creation.box((2.0, 3.0, 4.0))


def test_faults_of_meshes_are_named() -> None:
    vertices, triangles = np.array(CUBE.vertices), np.array(CUBE.faces)

    def notes(faces: Any) -> dict[str, str]:
        return {c.name: c.note for c in solid_checks(vertices, faces) if c.ok is False}

    open_mesh = notes(np.delete(triangles, 4, axis=0))
    assert set(open_mesh) == {"closed"}
    assert re.match(r"the edge from \(.*\) mm to \(.*\) mm has 1 of 2 facets", open_mesh["closed"])
    turned = triangles.copy()
    turned[4] = turned[4, ::-1]
    assert notes(turned)["oriented"].startswith("facet 5, near ")
    assert notes(triangles[:, ::-1]) == {"oriented": "the mesh is turned inside out"}
    assert "facet 13" in notes(np.vstack((triangles, [[0, 0, 1]])))["facets"]


@pytest.mark.parametrize("verifier", [DXF_VERIFIER, GCODE_VERIFIER, STL_VERIFIER, THREEMF_VERIFIER])
@example(data=b"EOF")
@example(data=b"0\nEOF\n")
@given(data=st.binary(max_size=300))
def test_any_bytes_are_recognised_as_damaged_or_foreign(verifier: Verifier, data: bytes) -> None:
    """Nothing raises, nothing passes for ours."""
    origin = verifier.origin(data)
    assert not origin.version
    assert origin.damage or verifier.format == "gcode"


# Kinks: those explained by the exact outline's bend, and others -----------------------------------


SIDES = 12

SIDE = 40.0

ROUNDING = 0.05
"""Radius of the corners [mm], far less than the tolerance."""

COARSE = 0.1


def corners() -> ComplexArray:
    """Of a regular polygon whose sides turn by 30 degrees from one to the next."""
    radius = 0.5 * SIDE / math.sin(math.pi / SIDES)
    return np.asarray(radius * np.exp(2j * math.pi * np.arange(SIDES) / SIDES))


def sharp() -> Contour:
    """The polygon, its sides halved: what chords of the rounded one may be."""
    ends = corners()
    vertices = np.ravel(np.column_stack((ends, 0.5 * (ends + np.roll(ends, -1)))))
    return Contour.through(vertices, np.zeros(len(vertices)))


def kink(contour: Contour) -> Check:
    """The check of `contour` against the polygon with its corners rounded off."""
    ends, turn = corners(), 2.0 * math.pi / SIDES
    along = np.roll(ends, -1) - ends
    along /= np.abs(along)
    cut = ROUNDING * math.tan(0.5 * turn)
    vertices = np.ravel(np.column_stack((ends - cut * np.roll(along, 1), ends + cut * along)))
    exact = Contour.through(vertices, np.tile([turn, 0.0], SIDES))
    (shape,) = boundary_shapes((ExactBoundary("outline", hole=False, exact=exact),), 150.0, COARSE)
    found = contour_checks(shape, contour, COARSE)
    return {check.name: check for check in found}["kink"]


def test_a_bend_within_a_piece_is_no_fault_of_chords() -> None:
    check = kink(sharp())
    assert math.isclose(float(check.value or 0.0), 30.0, rel_tol=1e-9)
    assert check.ok


def test_a_kink_where_the_outline_is_straight_is_reported() -> None:
    contour = sharp()
    vertices = contour.vertices.copy()
    vertices[1] *= 0.8
    check = kink(Contour.through(vertices, np.zeros(len(vertices))))
    assert check.ok is False
    assert float(check.value or 0.0) > 30.0


# What is told is a continuous function of the numbers in a file -----------------------------------


STEPS = (1e-12, 1e-9, 1e-6, 1e-3)

COORDINATES = ("10", "20", "11", "21")

BULGE = "42"

LONGEST = 40.0
"""Length of a piece [mm]: its middle moves by half of it times the change of the bulge."""

SLACK = 0.015
"""Fraction by which a proved bound may exceed a deviation from a curve."""

EACH = 2
"""Numbers of each kind that are moved by each step."""

ECCENTRIC = StubProduct()


@cache
def drawn_disc(scene: str, entity: str) -> Product:
    text = (SCENES / f"{scene}.toml").read_text("utf-8")
    return camgeo.loads(f'{text}\n[output.dxf]\nentity = "{entity}"\n').disc


def drawing(scene: str, entity: str) -> tuple[Product, list[str]]:
    """A disc, and the lines of its drawing, made with half of the tolerance."""
    disc = drawn_disc(scene, entity)
    return disc, written("dxf", disc, 0.5 * TOLERANCE).decode().split("\n")


def places(lines: list[str], codes: tuple[str, ...]) -> list[int]:
    """Indices of the values of the groups `codes` in the entities."""
    start = lines.index("ENTITIES")
    return [k + 1 for k in range(start + 1, len(lines) - 1, 2) if lines[k].strip() in codes]


def deviations(checks: Checks) -> dict[str, float]:
    found = {of: check.value for (name, of), check in checks.items() if name == "deviation"}
    assert all(isinstance(value, float) for value in found.values())
    return {of: float(value or 0.0) for of, value in found.items()}


KINDS = [("setzhub", "arcs"), ("setzhub", "spline"), ("plate_translating", "polyline")]


@pytest.mark.parametrize(("scene", "entity"), KINDS)
@pytest.mark.parametrize("step", STEPS)
def test_a_moved_number_moves_the_deviation_by_no_more(
    scene: str, entity: str, step: float
) -> None:
    """Except for the slack of the bound where the exact curve is not made of arcs."""
    disc, lines = drawing(scene, entity)
    before = deviations(checked(DXF_VERIFIER, disc, "\n".join(lines).encode()))
    chance = random.Random(f"{scene} {step}")
    numbers = [(k, 1.0) for k in chance.sample(places(lines, COORDINATES), EACH)]
    bulges = places(lines, (BULGE,)) if entity == "arcs" else []
    numbers += [(k, LONGEST) for k in chance.sample(bulges, min(EACH, len(bulges)))]
    for place, lever in numbers:
        moved = list(lines)
        moved[place] = repr(float(moved[place]) + step)
        after = deviations(checked(DXF_VERIFIER, disc, "\n".join(moved).encode()))
        assert after.keys() == before.keys()
        for name, value in after.items():
            allowed = 4.0 * lever * step + SLACK * max(value, before[name])
            assert abs(value - before[name]) <= allowed + 1e-12, (lines[place - 1], lines[place])


@pytest.mark.parametrize(("scene", "entity"), KINDS)
@pytest.mark.parametrize("decimals", [3, 4, 5, 6])
def test_rounded_numbers_pass_while_within_the_tolerance(
    scene: str, entity: str, decimals: int
) -> None:
    """Tangent pieces are no longer tangent then, but turn by no more than the tolerance permits."""
    disc, lines = drawing(scene, entity)
    for place in places(lines, (*COORDINATES, BULGE)):
        lines[place] = repr(round(float(lines[place]), decimals))
    checks = checked(DXF_VERIFIER, disc, "\n".join(lines).encode())
    found = deviations(checks)
    within = {of for of, value in found.items() if value <= TOLERANCE}
    assert within == found.keys() or decimals == 3
    for (_, of), check in checks.items():
        assert check.ok is not False or of not in within, check


@pytest.mark.parametrize("step", STEPS)
def test_moved_vertices_of_a_solid(step: float) -> None:
    """Faces and walls are flat and upright within the tolerance, not to the last digit."""
    chance, disc = random.Random(f"solid {step}"), drawn_disc("setzhub", "arcs")
    package = written("3mf", disc, 0.5 * TOLERANCE)

    def moved(found: re.Match[str]) -> str:
        return f'{found[1]}="{float(found[2]) + chance.uniform(-step, step)!r}"'

    data = repacked(
        package,
        lambda path, text: (
            re.sub(r'\b([xyz])="([^"]+)"', moved, text) if path == MODEL_PATH else text
        ),
    )
    before = deviations(checked(THREEMF_VERIFIER, disc, package))
    checks = checked(THREEMF_VERIFIER, disc, data)
    assert all(check.ok is not False for check in checks.values())
    for name, value in deviations(checks).items():
        # Faces that were alike before are reported together; now each is reported by itself.
        of = name if name in before else name.replace("upper", "lower")
        assert abs(value - before[of]) <= 2.0 * step + SLACK * value


@pytest.mark.parametrize("step", STEPS)
def test_moved_ends_of_a_program(step: float) -> None:
    """One after the other, also the point where a path closes, which it need not do exactly."""
    lines = written("gcode", ECCENTRIC, 0.5 * TOLERANCE).decode().splitlines()
    first = next(k for k, line in enumerate(lines) if line.startswith("G1 Z"))
    before = deviations(checked(GCODE_VERIFIER, ECCENTRIC, "\n".join(lines).encode()))
    for place in range(first + 1, first + 15):
        moved = list(lines)
        moved[place] = re.sub(
            r"X([-.\d]+)", lambda found: f"X{float(found[1]) + step:.15f}", moved[place]
        )
        checks = checked(GCODE_VERIFIER, ECCENTRIC, "\n".join(moved).encode())
        # These have more decimals than a controller reads.
        others = [check for check in checks.values() if check.name != "frame"]
        assert step > 1e-4 or all(check.ok is not False for check in others)
        after = deviations(checks)
        # A path that differs at one depth is reported by itself.
        assert {name.partition(",")[0] for name in after} == before.keys()
        for name, value in after.items():
            assert abs(value - before[name.partition(",")[0]]) <= 10.0 * step + 1e-12


# Files that name the running version are written again: what differs is told ----------------------


WRITTEN_WITHIN = 0.05

VERIFIERS: dict[str, Verifier] = {
    "vorschub.dxf": DXF_VERIFIER,
    "vorschub-drawing.dxf": DXF_VERIFIER,
    "vorschub.ngc": GCODE_VERIFIER,
    "vorschub.stl": STL_VERIFIER,
    "vorschub.3mf": THREEMF_VERIFIER,
    "vorschub.step": STEP_VERIFIER,
    "vorschub.cut.svg": SVG_VERIFIER,
}

TEXTS = [name for name in VERIFIERS if not name.endswith(("stl", "3mf"))]


@cache
def vorschub(name: str = "vorschub") -> Design:
    return camgeo.load(SCENES / f"{name}.toml").with_output({"fit": "fast"})


@cache
def files(tolerance: float = WRITTEN_WITHIN) -> dict[str, bytes]:
    formats = ("dxf", "gcode", "stl", "3mf", "step", "cut-svg", "drawing")
    contents, _ = make_files(vorschub().discs, formats, tolerance)
    return contents


def verdict_on(path: Path, data: bytes, of: Design | None = None) -> FileVerdict:
    """Of a file with these bytes; its scene states another tolerance than files do."""
    path.write_bytes(data)
    against = Reference((of or vorschub()).discs, 0.5 * WRITTEN_WITHIN)
    (verdict,) = verify_files((path,), lambda *_: against, Wanted(WRITTEN_WITHIN))
    return verdict


def again(verdict: FileVerdict) -> Check:
    (check,) = (each for each in verdict.checks if each.name == "written again")
    return check


def certify(folder: Path, name: str, data: bytes) -> None:
    """A certificate for these bytes."""
    document = json.loads(files()[CERTIFICATE])
    (record,) = (each for each in document["files"] if each["file"] == name)
    record["sha256"] = hashlib.sha256(data).hexdigest()
    (folder / CERTIFICATE).write_text(json.dumps(document))


# Tokens -------------------------------------------------------------------------------------------


def in_text(text: str, number: int) -> tuple[str, int]:
    """A text with one of its tokens changed, and the line of that."""
    found = list(TOKEN.finditer(text))
    token = found[number % len(found)]
    start, end = token.span()
    try:
        new = repr(1.01 * float(token[0]) + 0.03)
    except ValueError:
        new = f"{token[0]}x"
    return text[:start] + new + text[end:], text[:start].count("\n") + 1


@pytest.mark.parametrize("name", TEXTS)
@given(number=st.integers(0, 10**9))
@settings(max_examples=examples(12, long=200))
def test_a_changed_token_is_told_with_its_line(name: str, number: int) -> None:
    good = files()[name]
    text, line = in_text(good.decode(), number)
    difference = first_difference(VERIFIERS[name], text.encode(), good)
    assert difference is not None
    assert difference.place == f"line {line}"


@given(number=st.integers(0, 10**9))
@settings(max_examples=examples(12, long=200))
def test_a_changed_token_of_a_package_is_told_with_its_element(number: int) -> None:
    good = files()["vorschub.3mf"]
    line = 0

    def change(path: str, content: str) -> str:
        nonlocal line
        if path != MODEL_PATH:
            return content
        text, line = in_text(content.replace("<", "\n<"), number)
        return text

    changed = repacked(good, change)
    if THREEMF_VERIFIER.origin(changed).damage:
        return
    difference = first_difference(THREEMF_VERIFIER, changed, good)
    assert difference is not None
    # Elements begin on lines of their own here, the first two on the third of them.
    assert difference.place in {f"{MODEL_PATH}, element {line - k}" for k in (1, 2)}


@given(number=st.integers(0, 10**9), place=st.integers(0, 12))
@settings(max_examples=examples(12, long=200))
def test_a_changed_field_of_a_facet_is_told_with_its_number(number: int, place: int) -> None:
    """Its normal, its corners, its attribute."""
    good = files()["vorschub.stl"]
    facets: Any = np.frombuffer(good, FACET, offset=PREFIX).copy()
    facet = facets[number % len(facets)]
    if place == 12:
        facet["attribute"] += 1
    else:
        field = facet["normal"] if place < 3 else facet["corners"].reshape(-1)
        field[place % 3 if place < 3 else place - 3] += 0.01
    difference = first_difference(STL_VERIFIER, good[:PREFIX] + facets.tobytes(), good)
    assert difference is not None
    assert difference.place == f"facet {number % len(facets) + 1}"


def last_bit_of_a_normal(data: bytes) -> bytes:
    """Single precision has no more."""
    return data[:PREFIX] + bytes([data[PREFIX] ^ 1]) + data[PREFIX + 1 :]


def test_a_signalling_nan_is_a_difference() -> None:
    """Its conversion to double precision raises the processor's flag of an invalid operation."""
    good = files()["vorschub.stl"]
    changed = good[: PREFIX + 12] + b"\x01\x00\xa0\x7f" + good[PREFIX + 16 :]
    difference = first_difference(STL_VERIFIER, changed, good)
    assert difference is not None
    assert difference.place == "facet 1"


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("vorschub.dxf", lambda data: data.replace(b"\n", b"\r\n")),
        ("vorschub.ngc", lambda data: data.replace(b" ", b"  ").replace(b"\nG1", b"\n\nG1")),
        ("vorschub.3mf", partial(repacked, change=lambda _, content: content)),
        ("vorschub.step", lambda data: data.replace(b",", b" , ")),
        # The last bit of a normal: single precision has no more.
        ("vorschub.stl", last_bit_of_a_normal),
    ],
)
def test_blanks_and_last_digits_are_no_difference(
    name: str, change: Callable[[bytes], bytes]
) -> None:
    changed = change(files()[name])
    assert changed != files()[name]
    assert first_difference(VERIFIERS[name], changed, files()[name]) is None


def test_a_long_number_is_read_once() -> None:
    """With a square of its length this would not end."""
    assert first_difference(DXF_VERIFIER, b"9" * 10**6 + b"x", b"8" * 10**6 + b"x") is not None


@pytest.mark.parametrize(
    ("one", "other", "same"),
    [
        (b"1000.000001", b"1000.0", True),
        (b"1000.000002", b"1000.0", False),
        (b"0.0000000009", b"0", True),
        (b"0.0000000011", b"0", False),
        (b"X2.5", b"Y2.5", False),
        (b"X2.50", b"X2.5", True),
        (b"1e999", b"2e999", False),
        (b"G1 X2", b"G1", False),
        (b"G1", b"G1 X2", False),
    ],
)
def test_numbers_agree_within_a_share_of_their_size(one: bytes, other: bytes, same: bool) -> None:
    assert (first_difference(DXF_VERIFIER, one, other) is None) == same


# Verdicts -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", VERIFIERS)
def test_what_is_built_is_the_same_and_is_measured(name: str, tmp_path: Path) -> None:
    """By whatever name, though a mesh states its tolerance in its certificate alone."""
    data = files()[name]
    certify(tmp_path, name, data)
    verdict = verdict_on(tmp_path / name, data)
    assert (again(verdict).value, again(verdict).ok) == ("the same", True)
    assert verdict.passed
    assert verdict.deviation is not None
    renamed = again(verdict_on(tmp_path / f"other-{name}", data))
    assert renamed.ok == (None if name.endswith("stl") else True)


def test_a_difference_fails_unless_the_certificate_vouches_for_it(tmp_path: Path) -> None:
    """A feed, which nothing measures."""
    path = tmp_path / "vorschub.ngc"
    data = files()[path.name]
    changed = data.replace(b"F100", b"F101", 1)
    line = data[: data.index(b"F100")].count(b"\n") + 1
    verdict = verdict_on(path, changed)
    assert again(verdict).ok is False
    assert again(verdict).note == f"line {line}: 'F101' where camgeo writes 'F100'"
    assert [each.name for each in verdict.checks if each.ok is False] == ["written again"]
    certify(tmp_path, path.name, changed)
    verdict = verdict_on(path, changed)
    assert verdict.passed
    assert again(verdict).note.endswith("'F100'; certificate.json certifies these bytes")
    certify(tmp_path, path.name, data)
    assert again(verdict_on(path, changed)).ok is False
    assert again(verdict_on(path, data[: data.rindex(b"M2")])).note.endswith(
        "the end where camgeo writes 'M2'"
    )


def test_a_mesh_of_unknown_tolerance_may_be_another_one(tmp_path: Path) -> None:
    path = tmp_path / "vorschub.stl"
    check = again(verdict_on(path, files()[path.name]))
    assert check.ok is None
    assert check.note.endswith("its tolerance is not known")
    assert again(verdict_on(path, files(0.5 * WRITTEN_WITHIN)[path.name])).ok is True


def test_files_of_other_versions_and_scenes_are_only_measured(tmp_path: Path) -> None:
    path = tmp_path / "vorschub.dxf"
    data = files()[path.name]
    version = vorschub().disc.version
    verdict = verdict_on(path, data.replace(f"\n{version}\n".encode(), b"\n0.0.9\n", 1))
    assert again(verdict).note == "it was written by camgeo 0.0.9: only measured"
    assert verdict.passed
    verdict = verdict_on(path, data, vorschub("setzhub"))
    assert again(verdict).note == "it was not made from this scene: only measured"
    assert not verdict.passed
    foreign = data.replace(b"\ncamgeo\n", b"\nother\n", 1)
    assert "written again" not in {each.name for each in verdict_on(path, foreign).checks}


def test_a_scene_that_cannot_be_written_is_a_difference(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    refused = Mock(side_effect=camgeo.GeometryError("there is no room"))
    monkeypatch.setattr("camgeo_export.dxf.writer.DxfWriter.write", refused)
    check = again(verdict_on(tmp_path / "vorschub.dxf", files()["vorschub.dxf"]))
    assert check.ok is False
    assert check.note == "the scene cannot be written: there is no room"


def test_each_file_of_a_set_is_compared_with_its_own(tmp_path: Path) -> None:
    """Both discs of a pair, under other names too: the nearest of those that there are."""
    pair = vorschub("conjugate_lever")
    contents, _ = make_files(pair.discs, ("dxf",), WRITTEN_WITHIN)
    del contents[CERTIFICATE]
    assert len(contents) == 2
    for number, (name, data) in enumerate(contents.items()):
        for path in (tmp_path / name, tmp_path / f"{number}.dxf"):
            assert again(verdict_on(path, data, pair)).value == "the same"
        changed = data.replace(b"\nEOF", b"\nEOFF")
        assert "'EOFF' where" in again(verdict_on(tmp_path / name, changed + b"EOF", pair)).note


# Programs as they are written, simulated: sound ones, and ones changed on purpose -----------------


def simulated(text: str) -> list[Check]:
    return simulation_checks(PRODUCT, run_program(text, load("linuxcnc")), TOLERANCE)


PRODUCT = StubProduct(second_tool=SECOND_TOOL)

PROGRAM = GCODE.write(PRODUCT, TOLERANCE).data.decode()


def runs_in(text: str) -> list[ToolRun]:
    program = run_program(text, load("linuxcnc"))
    return [each.run for each in trace_program(PRODUCT, program, PRODUCT.milled.cuts)]


def test_moves_are_those_of_the_program() -> None:
    bore, outline = runs_in(PROGRAM)
    assert (bore.name, bore.radius) == ("bore", 3.0)
    assert (outline.name, outline.radius) == ("outline", 4.0)
    planned = PRODUCT.toolpath(TOLERANCE).operations[0].moves
    kinds = [type(move) for move in bore.moves]
    assert kinds.count(ArcFeed) == sum(isinstance(move, ArcFeed) for move in planned)
    assert kinds.count(Feed) == sum(isinstance(move, Feed) for move in planned)
    assert bore.start == (4.2, -2.8, 5.0)  # where the first traverse that says all of it ends


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        # The outline is cut with the smaller tool, on the path of the larger one.
        ("T2 M6", "T1 M6", "outline: material is left on the part, up to 1.01 mm thick"),
        # 1 mm along X through the whole of the outline.
        ("(operation outline)", "(operation outline)\nG52 X1", "outline: the cutter goes"),
        ("G1 Z-8.0000 F80", "G0 Z-8.0000", "outline: a traverse goes 4 mm deep into material"),
        ("G1 Z-8.0000 F80", "G1 Z-7.0000 F80", "material is left on the part, up to"),
    ],
)
def test_a_program_that_is_changed(old: str, new: str, sentence: str) -> None:
    text = PROGRAM
    if new.endswith("G52 X1"):
        head, tail = text.split(old)
        new = old
        tail = re.sub(r"X(-?[\d.]+)", lambda found: f"X{float(found[1]) + 1.0:.4f}", tail)
        text = f"{head}{old}{tail}"
    assert old in text
    found = simulated(text.replace(old, new))
    assert [check for check in found if check.ok is not False] == []
    assert any(sentence in check.note for check in found), [check.note for check in found]


FOREIGN_PROGRAM = """G17 G21 G40 G49 G54 G80 G90 G94 G91.1
T{tool} M6
G43 H{tool}
S3000 M3
G0 Z5
G0 X0 Y-5
G1 Z-8 F100
G0 Z5
G0 X35 Y-5
G1 Z-8
G2 X35 Y-5 I-35 J0
G0 Z5
G28
G0 Z5
G0 X7 Y0
G1 Z-8
G3 X7 Y0 I-7 J0
G0 Z5
M5
M2
"""


def test_a_program_of_someone_else() -> None:
    """Whole circles, no comments, and after a traverse home a place that nobody has stated."""
    (sound,) = simulated(FOREIGN_PROGRAM.format(tool=1))
    assert sound.ok
    assert sound.value == "1 operation"  # in two parts
    (drilled,) = simulated(FOREIGN_PROGRAM.format(tool=1).replace("X0 Y-5", "X0 Y-12"))
    assert "tool 1: the cutter goes 5 mm into the part" in drilled.note
    runs = runs_in(FOREIGN_PROGRAM.format(tool=1))
    assert [each.name for each in runs] == ["tool 1", "tool 1"]
    assert sum(isinstance(move, ArcFeed) for each in runs for move in each.moves) == 4


def test_a_tool_that_the_scene_does_not_have() -> None:
    (check,) = simulated(FOREIGN_PROGRAM.format(tool=7))
    assert check.ok is False
    assert check.note == "line 7: tool 7 is not a tool of the scene"


def test_a_path_that_the_control_computes() -> None:
    text = FOREIGN_PROGRAM.format(tool=1).replace("G1 Z-8\nG2", "G41 D1\nG1 Z-8\nG2")
    (check,) = simulated(text)
    assert check.ok is None
    assert "control" in check.note
