"""Verification of files that other programs wrote, and of its parts: joints, meshes, origins."""

from __future__ import annotations

import io
import math
import random
import re
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
import trimesh
from hypothesis import example, given
from hypothesis import strategies as st

import camgeo
from camgeo.design.design import Design
from camgeo.design.product import Product
from camgeo.design.verify import Check, Origin, Reading, Verifier, length_of
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.contour.spline import Arc, CubicSpline, SplineContour
from camgeo.numeric.arrays import ComplexArray
from camgeo.part.boundaries import ExactBoundary
from camgeo_export.dxf.writer import WRITER as DXF
from camgeo_export.gcode.writer import WRITER as GCODE
from camgeo_export.stl import WRITER as STL
from camgeo_export.threemf.writer import WRITER as THREEMF
from camgeo_export.verify.body import solid_checks
from camgeo_export.verify.dxf import VERIFIER as DXF_VERIFIER
from camgeo_export.verify.gcode import VERIFIER as GCODE_VERIFIER
from camgeo_export.verify.plane import contour_checks, farthest, joints_of, shapes_of
from camgeo_export.verify.stl import VERIFIER as STL_VERIFIER
from camgeo_export.verify.threemf import MODEL_PATH
from camgeo_export.verify.threemf import VERIFIER as THREEMF_VERIFIER
from tests.effects.scenes import SCENES as EFFECTS
from tests.export.stub_product import StubProduct
from tests.export.verified import TOLERANCE, Checks, checked
from tests.packages import repacked

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"

FIT = 0.5 * TOLERANCE

FOREIGN = Reading("drawing.dxf")


@pytest.fixture(scope="module")
def design() -> Design:
    return camgeo.load(SCENES / "setzhub.toml")


def _checks(
    verifier: Verifier, product: Product, data: bytes, reading: Reading = FOREIGN
) -> Checks:
    return checked(verifier, product, data, reading)


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
    checks = _checks(DXF_VERIFIER, design.disc, data, Reading("a.dxf", unit=unit))
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
    checks = _checks(DXF_VERIFIER, design.disc, _data(_drawing(design, units=0)))
    closure = checks["closure", ""]
    assert closure.ok is False
    assert re.search(r"does not state its unit .*\(--unit\)", closure.note)


def test_layers_of_a_foreign_drawing(design: Design) -> None:
    """Other layers do not count; without a layer everything does."""
    document = _drawing(design, layer="OUTLINE")
    document.modelspace().add_circle((0, 0), 3.0, dxfattribs={"layer": "HOLES"})
    data = _data(document)
    assert not _failed(_checks(DXF_VERIFIER, design.disc, data, Reading("a.dxf", layer="OUTLINE")))
    count = _checks(DXF_VERIFIER, design.disc, data)["contours", ""]
    assert (count.value, count.expected, count.ok) == (3.0, 2.0, False)


@pytest.mark.parametrize(("code", "name"), [(38, "elevation"), (39, "thickness"), (43, "width")])
def test_drawings_lie_flat_within_the_tolerance(design: Design, code: int, name: str) -> None:
    """Their other groups do not matter."""
    lines = DXF.write(design.disc, TOLERANCE).data.decode().split("\n")
    place = lines.index("AcDbPolyline") + 1
    for value, expected in (("0.5", {name}), ("0.005", set())):
        other = [*lines[:place], f"{code:>3}", value, " 62", "1", *lines[place:]]
        checks = _checks(DXF_VERIFIER, design.disc, "\n".join(other).encode())
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
    checks = _checks(DXF_VERIFIER, groove, data)
    assert not _failed(checks)
    assert checks["contours", ""].value == 4.0


def test_boundary_left_out_of_a_foreign_drawing(design: Design) -> None:
    checks = _checks(DXF_VERIFIER, design.disc, _data(_drawing(design, without=1)))
    assert _failed(checks) == {"contours", "deviation"}
    assert checks["deviation", "bore"].note == "there is no contour for it"
    assert checks["deviation", "outline"].ok


def test_gap_beyond_the_tolerance_is_reported(design: Design) -> None:
    document = _drawing(design)
    line = next(iter(document.modelspace().query("LINE")))
    line.dxf.start += ezdxf.math.Vec3(0.0, 3.0 * TOLERANCE)
    closure = _checks(DXF_VERIFIER, design.disc, _data(document))["closure", ""]
    assert closure.ok is False
    assert "has a loose end at" in closure.note


# Foreign programs and meshes ----------------------------------------------------------------------


def test_program_without_comments_is_matched(design: Design) -> None:
    """Operations are distinguished by their paths where no comment names them."""
    text = GCODE.write(design.disc, TOLERANCE).data.decode()
    bare = re.sub(r"\([^()]*\)", "", text).encode()
    assert GCODE_VERIFIER.origin(bare) == Origin()
    checks = _checks(GCODE_VERIFIER, design.disc, bare)
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
        [replace(each, note="") for each in _checks(GCODE_VERIFIER, design.disc, data).values()]
        for data in (text.encode(), after.encode())
    )
    assert good == other


def test_a_roughing_may_be_off_by_its_slack_and_no_more(design: Design) -> None:
    text = GCODE.write(design.disc, TOLERANCE).data.decode()
    assert GCODE.measure(design.disc, text.encode()) <= TOLERANCE
    cut = next(each for each in design.disc.milled.contour_cuts if each.name == "rough outline")
    own = _checks(GCODE_VERIFIER, design.disc, text.encode())["deviation", cut.name]
    assert isinstance(own.value, float)
    assert own.value <= TOLERANCE < own.value + cut.slack
    begin, end = text.index("(operation rough outline)"), text.index("(operation outline)")
    # Arcs keep their centres, which are stated from their starts.
    along = re.sub(r"X(\S+)", lambda word: f"X{float(word[1]) + 0.05:.4f}", text[begin:end])
    moved = (text[:begin] + along + text[end:]).encode()
    off = GCODE.measure(design.disc, moved)
    assert 0.05 - 2.0 * cut.slack <= off <= 0.05 + TOLERANCE
    assert _checks(GCODE_VERIFIER, design.disc, moved)["deviation", cut.name].ok is False


def test_foreign_words_are_refused_with_a_sentence(design: Design) -> None:
    text = GCODE.write(design.disc, TOLERANCE).data.decode().replace("(camgeo", "(other")
    checks = _checks(GCODE_VERIFIER, design.disc, text.replace("G17 ", "G17 G68 ").encode())
    assert re.search(r"line \d+: .*G68, a rotation; .*for LinuxCNC", checks["program", ""].note)
    checks = _checks(GCODE_VERIFIER, design.disc, text.replace("G17 ", "G18 ").encode())
    assert "with an arc in the plane ZX" in checks["program", ""].note


def test_text_stl_of_another_program(design: Design) -> None:
    """In either unit; STL states none, so mm is assumed, which is reported."""
    mesh: Any = trimesh.load_mesh(
        io.BytesIO(STL.write(design.disc, FIT).data), file_type="stl", process=False
    )
    text = trimesh.exchange.stl.export_stl_ascii(mesh).encode()
    assert STL_VERIFIER.origin(text) == Origin()
    checks = _checks(STL_VERIFIER, design.disc, text)
    assert not _failed(checks)
    assert "assumed" in checks["unit", ""].note
    mesh.apply_scale(1.0 / 25.4)
    inch = trimesh.exchange.stl.export_stl(mesh)
    assert {"deviation", "volume"} <= _failed(_checks(STL_VERIFIER, design.disc, inch))
    note = _checks(STL_VERIFIER, design.disc, inch)["deviation", "outline, lower face"].note
    assert "inch taken for mm?" in note
    reading = Reading("a.stl", unit="inch")
    assert not _failed(_checks(STL_VERIFIER, design.disc, inch, reading))
    assert STL_VERIFIER.origin(text[: len(text) // 2]).damage.endswith("endsolid missing")


def test_3mf_in_inch_is_measured_in_inch(design: Design) -> None:
    def inch(path: str, text: str) -> str:
        if path != MODEL_PATH:
            return text
        text = text.replace('unit="millimeter"', 'unit="inch"').replace("camgeo", "other")
        return re.sub(r'([xyz])="([^"]+)"', lambda m: f'{m[1]}="{float(m[2]) / 25.4!r}"', text)

    data = repacked(THREEMF.write(design.disc, FIT).data, inch)
    assert THREEMF_VERIFIER.origin(data) == Origin()
    checks = _checks(THREEMF_VERIFIER, design.disc, data)
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
    joints = joints_of(contour)
    assert joints.kinks[1] == pytest.approx(abs(turn), abs=1e-14)
    last = tangent * np.exp(1j * sign * sweep)
    assert joints.kinks[2] == pytest.approx(abs(np.angle((-3.0 - end) * np.conj(last))), abs=1e-13)
    assert joints.before[1] == 3.0
    assert joints.after[1] == pytest.approx(2.0 * sweep)


def test_kinks_of_splines() -> None:
    """At the ends of a strand, and inside where a triple knot allows one."""
    controls = np.array([0, 1, 2, 3, 3 + 1j, 3 + 2j, 3 + 3j])
    knots = np.array([0.0, 0, 0, 0, 1, 1, 1, 2, 2, 2, 2])
    spline = CubicSpline(knots, controls)
    back = Arc(3 + 3j, 0j, math.pi, 1.5 + 1.5j)
    joints = joints_of(SplineContour((spline, back)))
    assert joints.places == pytest.approx(np.array([0, 3, 3 + 3j]))
    # The half circle leaves at right angles to the diagonal and comes back so.
    assert joints.kinks == pytest.approx(np.radians([45.0, 90.0, 45.0]))


@pytest.mark.parametrize(("text", "length"), [
    ("0.001", 1e-3), ("0.001 mm", 1e-3), (" 1e-05 mm", 1e-5), ("", None), ("nan", None),
    ("inf mm", None), ("-1", None), ("0", None), ("1 inch", None),
])  # fmt: skip
def test_lengths_in_words(text: str, length: float | None) -> None:
    assert length_of(text) == length


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
    degenerate = np.vstack((triangles, [[0, 0, 1]]))
    assert "facet 13" in notes(degenerate)["facets"]


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
    (shape,) = shapes_of((ExactBoundary("outline", hole=False, exact=exact),), 150.0, COARSE)
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


@cache
def drawing(scene: str, entity: str) -> tuple[str, ...]:
    """The lines of the scene's drawing, made with half of the tolerance."""
    return tuple(DXF.write(drawn_disc(scene, entity), 0.5 * TOLERANCE).data.decode().split("\n"))


def places(lines: tuple[str, ...], codes: tuple[str, ...]) -> list[int]:
    """Indices of the values of the groups `codes` in the entities."""
    start = lines.index("ENTITIES")
    return [k + 1 for k in range(start + 1, len(lines) - 1, 2) if lines[k].strip() in codes]


def verified(scene: str, entity: str, lines: list[str]) -> Checks:
    reading = Reading(f"{scene}.dxf")
    return checked(DXF_VERIFIER, drawn_disc(scene, entity), "\n".join(lines).encode(), reading)


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
    lines = drawing(scene, entity)
    before = deviations(verified(scene, entity, list(lines)))
    chance = random.Random(f"{scene} {step}")
    numbers = [(k, 1.0) for k in chance.sample(places(lines, COORDINATES), EACH)]
    bulges = places(lines, (BULGE,)) if entity == "arcs" else []
    numbers += [(k, LONGEST) for k in chance.sample(bulges, min(EACH, len(bulges)))]
    for place, lever in numbers:
        moved = list(lines)
        moved[place] = repr(float(moved[place]) + step)
        after = deviations(verified(scene, entity, moved))
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
    lines = list(drawing(scene, entity))
    for place in places(tuple(lines), (*COORDINATES, BULGE)):
        lines[place] = repr(round(float(lines[place]), decimals))
    checks = verified(scene, entity, lines)
    found = deviations(checks)
    within = {of for of, value in found.items() if value <= TOLERANCE}
    assert within == found.keys() or decimals == 3
    for (_, of), check in checks.items():
        assert check.ok is not False or of not in within, check


@cache
def package() -> bytes:
    return THREEMF.write(drawn_disc("setzhub", "arcs"), 0.5 * TOLERANCE).data


def with_numbers(change: Callable[[float], float]) -> bytes:
    """The package with each coordinate of its vertices changed."""

    def moved(path: str, text: str) -> str:
        number = r'\b([xyz])="([^"]+)"'
        if path != MODEL_PATH:
            return text
        return re.sub(number, lambda found: f'{found[1]}="{change(float(found[2]))!r}"', text)

    return repacked(package(), moved)


def verified_package(data: bytes) -> Checks:
    reading = Reading("setzhub.3mf")
    return checked(THREEMF_VERIFIER, drawn_disc("setzhub", "arcs"), data, reading)


@pytest.mark.parametrize("step", [1e-12, 1e-9, 1e-6, 1e-3])
def test_moved_vertices_of_a_solid(step: float) -> None:
    """Faces and walls are flat and upright within the tolerance, not to the last digit."""
    chance = random.Random(f"solid {step}")
    before = deviations(verified_package(package()))
    checks = verified_package(with_numbers(lambda value: value + chance.uniform(-step, step)))
    assert all(check.ok is not False for check in checks.values())
    for name, value in deviations(checks).items():
        # Faces that were alike before are reported together; now each is reported by itself.
        of = name if name in before else name.replace("upper", "lower")
        assert abs(value - before[of]) <= 2.0 * step + SLACK * value


@cache
def program() -> tuple[str, ...]:
    """The lines of a program made with half of the tolerance."""
    return tuple(GCODE.write(ECCENTRIC, 0.5 * TOLERANCE).data.decode().splitlines())


def verified_program(lines: list[str]) -> Checks:
    reading = Reading("eccentric.ngc")
    return checked(GCODE_VERIFIER, ECCENTRIC, "\n".join(lines).encode(), reading)


@pytest.mark.parametrize("step", STEPS)
def test_moved_ends_of_a_program(step: float) -> None:
    """One after the other, also the point where a path closes, which it need not do exactly."""
    lines = program()
    first = next(k for k, line in enumerate(lines) if line.startswith("G1 Z"))
    before = deviations(verified_program(list(lines)))
    for place in range(first + 1, first + 15):
        moved = list(lines)
        moved[place] = re.sub(
            r"X([-.\d]+)", lambda found: f"X{float(found[1]) + step:.15f}", moved[place]
        )
        checks = verified_program(moved)
        # These have more decimals than a controller reads.
        others = [check for check in checks.values() if check.name != "frame"]
        assert step > 1e-4 or all(check.ok is not False for check in others)
        after = deviations(checks)
        # A path that differs at one depth is reported by itself.
        assert {name.partition(",")[0] for name in after} == before.keys()
        for name, value in after.items():
            assert abs(value - before[name.partition(",")[0]]) <= 10.0 * step + 1e-12
