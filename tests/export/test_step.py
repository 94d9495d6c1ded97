"""STEP: one closed shell for parts of any layers, and each fault in it is found."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.design.product import Product
from camgeo.design.verify import Check, Reading
from camgeo.errors import FileError, GeometryError, ToleranceError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.contour.spline import CubicSpline, SplineContour
from camgeo.part.boundaries import ExactBoundary
from camgeo.part.part import Layer, Part
from camgeo.scene.formats.step import StepSpec
from camgeo_export.part21.solid import Extrusion, Model, Solid, solid_of
from camgeo_export.part21.text import exchange_of
from camgeo_export.step import writer
from camgeo_export.step.writer import WRITER
from camgeo_export.verify.step import VERIFIER, bounds_of, is_flat, shell_checks, volume_of
from tests.export.stub_product import PIECES, CircleBoundary, StubProduct
from tests.export.test_dxf_spline import PRODUCTS
from tests.export.test_solids import BORE, PARTS, POCKETS, RIM, VOLUMES, PartProduct
from tests.export.verified import TOLERANCE, faults
from tests.long_form import examples

both = pytest.mark.parametrize("groove", [False, True], ids=["disc", "groove"])


def read(data: bytes) -> Solid:
    return solid_of(Model.of(exchange_of(data)))


@both
@pytest.mark.parametrize("unit", ["mm", "inch"])
def test_read_back_is_within_the_tolerance(groove: bool, unit: str) -> None:
    product = StubProduct(groove=groove, unit="inch" if unit == "inch" else "mm")
    written = WRITER.write(product, TOLERANCE)
    assert 0.5 * TOLERANCE < WRITER.measure(product, written.data) <= TOLERANCE
    assert written.data == WRITER.write(product, TOLERANCE).data
    assert faults(VERIFIER, product, written.data) == []
    solid = read(written.data)
    assert solid.unit == (25.4 if unit == "inch" else 1.0)
    assert solid.uncertainty == pytest.approx(1e-7, rel=1e-12)
    assert len(solid.faces) == (2 + 2 * PIECES if not groove else 4 + 4 * PIECES)
    volume = volume_of(bounds_of(solid))
    assert volume == pytest.approx(written.facts["volume_mm3"], rel=1e-12)
    assert volume == pytest.approx(VOLUMES[groove], rel=TOLERANCE / 5.0)


@pytest.mark.parametrize("name", ["mm", "inch"])
def test_walls_may_be_splines(name: str) -> None:
    """A real flank with dwells and a round bore: the same strands as in the drawing."""
    product = replace(PRODUCTS[name], step=StepSpec("spline"))
    written = WRITER.write(product, TOLERANCE)
    assert 0.5 * TOLERANCE < WRITER.measure(product, written.data) <= TOLERANCE
    drawn = product.part.boundaries[0].spline(0.98 * TOLERANCE).contour
    assert written.facts["splines"] == len(drawn.splines)
    solid = read(written.data)
    walls = [face for face in solid.faces if not is_flat(face)]
    assert sum(isinstance(face.surface, Extrusion) for face in walls) == len(drawn.splines)
    volume = volume_of(bounds_of(solid))
    assert volume == pytest.approx(written.facts["volume_mm3"], rel=1e-12)
    text = written.data.decode()
    for kind, fields in (
        ("B_SPLINE_CURVE_WITH_KNOTS", (".UNSPECIFIED.", ".F.")),
        ("SURFACE_OF_LINEAR_EXTRUSION", ()),
    ):
        found = re.search(rf"#(\d+)={kind}\((.*)\);", text)
        assert found is not None
        for field in FIELD.finditer(text, found.start(2), found.end(2)):
            if field.group() not in (*fields, "''"):
                changed = text[: field.start()] + _changed(field.group()) + text[field.end() :]
                with pytest.raises(FileError):
                    WRITER.measure(product, changed.encode())


def test_a_spline_that_is_closed_is_divided() -> None:
    """A shell has no edge that ends where it begins."""
    knots = np.array([0.0] * 4 + [1.0, 2.0, 3.0] + [4.0] * 4)
    controls = np.array([30, 30 + 20j, 40j, -50, -40j, 30 - 20j, 30], dtype=complex)
    contour = SplineContour((CubicSpline(knots, controls),))
    strands = writer._open(contour)
    assert len(strands) == 2
    assert SplineContour(strands).area == pytest.approx(contour.area, rel=1e-15)


@pytest.mark.parametrize("name", PARTS)
def test_layers_of_any_kind_make_one_solid(name: str) -> None:
    """The faces of each level with the holes in them, islands and floors that look down."""
    part = Part(PARTS[name])
    product = PartProduct(given=part)
    written = WRITER.write(product, TOLERANCE)
    assert 0.5 * TOLERANCE < WRITER.measure(product, written.data) <= TOLERANCE
    solid = read(written.data)
    assert all(check.ok for check in shell_checks(solid, 1e-7))
    flat = [face for face in solid.faces if is_flat(face)]
    assert len(solid.faces) - len(flat) == PIECES * len(part.walls)
    loops = sum(len(face.loops) for face in flat)
    assert loops == sum(len(level.boundaries) for level in part.levels)
    layers = sum(
        (-1.0 if each.hole else 1.0)
        * abs(each.arcs(0.98 * TOLERANCE).contour.area)
        * (layer.z1 - layer.z0)
        for layer in part.layers
        for each in layer.boundaries
    )
    assert volume_of(bounds_of(solid)) == pytest.approx(layers, rel=1e-12)


def test_an_island_has_a_face_of_its_own() -> None:
    solid = read(WRITER.write(PartProduct(given=Part(PARTS["pockets round an island"])), 0.01).data)
    loops = sorted(
        (face.name, len(face.loops), len(face.loops[0])) for face in solid.faces if is_flat(face)
    )
    pocket = "floor of the pocket"
    assert loops == [
        (pocket, 1, PIECES),
        (pocket, 1, PIECES),
        (pocket, 2, PIECES),  # round the island
        ("lower face", 2, PIECES),
        ("upper face", 1, PIECES),  # of the island
        ("upper face", 5, PIECES),
    ]


def test_a_closed_cavity_is_refused() -> None:
    layers = [Layer(-10.0, -8.0, (RIM, BORE)), Layer(-2.0, 0.0, (RIM, BORE))]
    hollow = Layer(-8.0, -2.0, (RIM, BORE, POCKETS[0]), "cavity")
    product = PartProduct(given=Part((layers[0], hollow, layers[1])))
    with pytest.raises(GeometryError, match="one body without closed cavities"):
        WRITER.write(product, TOLERANCE)


SOLID, OPEN, RINGED = "solid", "open", "with an island"

ISLANDS = tuple(
    CircleBoundary(f"island {k}", False, 2.0, pocket.centre) for k, pocket in enumerate(POCKETS)
)

Slice = tuple[str, ...]
"""What is at the place of each pocket in a layer."""


def _regions(kind: str) -> dict[str, bool]:
    """Whether the middle and the ring at a pocket are solid."""
    return {"middle": kind != OPEN, "ring": kind == SOLID}


def _pieces(slices: list[Slice], *, solid: bool) -> int:
    """Into how many pieces the material falls, or all that is none, the outside included."""
    cells = {
        (layer, place, part)
        for layer, kinds in enumerate(slices)
        for place, kind in enumerate(kinds)
        for part, is_solid in _regions(kind).items()
        if is_solid == solid
    }
    rest = {(layer, -1, "plate") for layer in range(len(slices))}
    outside = {(-1, 0, "outside")}
    cells |= rest if solid else outside
    found = 0
    while cells:
        left = [cells.pop()]
        found += 1
        while left:
            layer, place, part = left.pop()
            near = {each for each in cells if _touch((layer, place, part), each, len(slices))}
            cells -= near
            left += near
    return found


def _touch(one: tuple[int, int, str], other: tuple[int, int, str], layers: int) -> bool:
    """Whether two regions of the same kind have an area in common."""
    if "outside" in (one[2], other[2]):
        cell = other if one[2] == "outside" else one
        return cell[0] in (0, layers - 1)
    if "plate" in (one[2], other[2]):
        cell = other if one[2] == "plate" else one
        return cell[2] == "plate" or (one[0] == other[0] and cell[2] == "ring")
    if one[1] != other[1]:
        return False
    return one[0] == other[0] or (abs(one[0] - other[0]) == 1 and one[2] == other[2])


@given(st.lists(st.tuples(*[st.sampled_from((SOLID, OPEN, RINGED))] * 2), min_size=1, max_size=4))
@settings(max_examples=examples(12, long=300), deadline=None)
def test_random_layers_are_one_solid_or_are_refused(slices: list[Slice]) -> None:
    """Refused if the material falls apart, or holds a cavity; else closed and of its volume."""
    layers = []
    for number, kinds in enumerate(slices):
        boundaries = [RIM]
        for place, kind in enumerate(kinds):
            boundaries += [POCKETS[place]] if kind != SOLID else []
            boundaries += [ISLANDS[place]] if kind == RINGED else []
        layers.append(Layer(2.0 * number, 2.0 * number + 2.0, tuple(boundaries), f"{number}"))
    product = PartProduct(given=Part(tuple(layers)))
    if _pieces(slices, solid=True) > 1 or _pieces(slices, solid=False) > 1:
        with pytest.raises(GeometryError, match="one body without closed cavities"):
            WRITER.write(product, 0.1)
        return
    written = WRITER.write(product, 0.1)
    assert WRITER.measure(product, written.data) <= 0.1
    areas = {SOLID: 0.0, OPEN: 25.0, RINGED: 25.0 - 4.0}
    volume = 2.0 * math.pi * sum(1600.0 - sum(areas[kind] for kind in kinds) for kinds in slices)
    assert volume_of(bounds_of(read(written.data))) == pytest.approx(volume, rel=0.01)


def test_a_scene_without_thickness_is_refused() -> None:
    assert "part.thickness" in WRITER.format.needs
    product = StubProduct(thickness=None)
    with pytest.raises(GeometryError, match=r"part\.thickness"):
        WRITER.write(product, TOLERANCE)
    data = WRITER.write(StubProduct(), TOLERANCE).data
    with pytest.raises(FileError, match=r"part\.thickness"):
        WRITER.measure(product, data)
    checks = VERIFIER.checks(product, data, Reading("file"), TOLERANCE)
    assert [check.name for check in checks if check.ok is False] == ["body"]


def test_names_are_those_of_the_part_in_any_script() -> None:
    product = StubProduct(name="Nockenhebel für Ø8, 凸轮 '𝛼' \\ a")
    data = WRITER.write(product, TOLERANCE).data
    assert data.isascii()
    assert rb"\X2\00FC\X0\r \X2\00D8\X0\8, \X2\51F88F6E\X0\ ''\X4\0001D6FC\X0\'' \\ a" in data
    solid = read(data)
    assert (solid.name, solid.products) == (product.name, (product.name,))
    assert {face.name for face in solid.faces} == {"lower face", "upper face", "outline", "bore"}
    assert WRITER.measure(product, data) <= TOLERANCE


def test_what_is_almost_straight_is_a_line_or_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """A radius of 1e10 mm has a centre that doubles cannot place to 1e-7 mm."""

    def product(sagitta: float) -> Product:
        corners = np.array([50.0 + 50.0j, -50.0 + 50.0j, -50.0 - 50.0j, 50.0 - 50.0j])
        sweeps = np.array([8.0 * sagitta / 100.0, 0.0, 0.0, 0.0])
        outline = ExactBoundary("outline", hole=False, exact=Contour.through(corners, sweeps))
        return PartProduct(given=Part((Layer(-5.0, 0.0, (outline,)),)))

    written = WRITER.write(product(1.25e-7), 1e-3)
    assert written.facts["cylinders"] == 0
    assert WRITER.measure(product(1.25e-7), written.data) <= 1e-3
    with pytest.raises(ToleranceError, match="too flat for the numbers of the format"):
        WRITER.write(product(1.25e-7), 1e-6)
    curved = WRITER.write(product(1.25e-3), 1e-3)
    assert curved.facts["cylinders"] == 1
    assert WRITER.measure(product(1.25e-3), curved.data) <= 1e-9
    monkeypatch.setattr(writer, "SAGITTA", 0.0)
    with pytest.raises(ToleranceError, match="too flat"):
        WRITER.write(product(1.25e-7), 1e-3)


def test_the_file_of_a_cad_program_is_read_wherever_it_lies_along_z() -> None:
    """Another origin, other names, entities that belong to nothing, 3 mm higher."""
    text = WRITER.write(StubProduct(), TOLERANCE).data.decode()
    text = text.replace("'camgeo 0.0.test'", "'another program'").replace("eccentric", "Part1")
    text = text.replace("ENDSEC;\nEND", "#99999=DIRECTION('',(1.,0.,0.));\nENDSEC;\nEND")

    def higher(found: re.Match[str]) -> str:
        x, y, z = found.group(1).split(",")
        return f"CARTESIAN_POINT('',({x},{y},{float(z) + 3.0!r}))"

    text = re.sub(r"CARTESIAN_POINT\('',\(([^)]*)\)\)", higher, text)
    data = text.encode()
    assert not VERIFIER.origin(data).version
    checks = VERIFIER.checks(StubProduct(), data, Reading("file"), TOLERANCE)
    assert [check.name for check in checks if check.ok is False] == []


# Faults -------------------------------------------------------------------------------------------

PRODUCT = StubProduct()

LINES = WRITER.write(PRODUCT, TOLERANCE).data.decode().splitlines()

FIELD = re.compile(r"#\d+|-?\d+\.\d*(?:E-?\d+)?|'(?:[^']|'')*'|\.[A-Z]+\.|\b\d+\b")

HARMLESS = {
    ("VECTOR", "1."),  # it only shows a direction
    ("DIRECTION", "1."),  # which may have any length
}
"""Fields of a solid that say nothing about its shape: no measure need find their change."""

BEGIN, END = (
    next(k for k, line in enumerate(LINES) if word in line)
    for word in ("REPRESENTATION_CONTEXT", "MANIFOLD_SOLID_BREP")
)
"""The lines of the solid lie between these, or are the last of them."""

SHARES = 5


def _harmless(kind: str, field: str, text: str) -> bool:
    """Also the place of a plane's origin in it, and where a first axis points across the third."""
    if (kind, field) in HARMLESS or field.startswith("'"):
        return True
    planes = re.search(r"=CARTESIAN_POINT\('',\((0\.03,0\.|0\.,0\.03),8\.\)\);", text)
    firsts = re.search(r"=DIRECTION\('',\(1\.,(0\.03,0\.|0\.,0\.03)\)\);", text)
    return bool(planes or firsts)


def _kind(line: str) -> str:
    found = re.match(r"(?:#\d+=)?\(?([A-Z0-9_]+)", line)
    assert found is not None
    return found.group(1)


def _fields() -> list[tuple[int, int]]:
    """Lines and starts of fields: of each kind of entity of the solid those of the first and the
    last.
    """
    chosen: dict[str, list[int]] = {}
    for number in range(BEGIN + 1, END + 1):
        chosen.setdefault(_kind(LINES[number]), []).append(number)
    found = []
    for numbers in chosen.values():
        for number in sorted({numbers[0], numbers[-1]}):
            line = LINES[number]
            first = line.index("=") + 1
            found += [(number, field.start()) for field in FIELD.finditer(line, first)]
    return found


def _changed(field: str) -> str:
    if field.startswith("#"):
        return f"#{int(field[1:]) - 1 or 2}"
    if field.startswith("'"):
        return f"'{field[1:-1]}x'"
    if field.startswith("."):
        return {".T.": ".F.", ".F.": ".T.", ".MILLI.": ".CENTI."}.get(field, ".OTHER.")
    if "." not in field:
        return str(int(field) + 1)
    return repr(1.01 * float(field) + 0.03)


def _measured(text: str) -> list[Check]:
    """What fails of a file by its shape alone."""
    data = text.encode()
    if damage := VERIFIER.origin(data).damage:
        return [Check("file", ok=False, note=damage)]
    checks = VERIFIER.checks(PRODUCT, data, Reading("file"), TOLERANCE)
    return [check for check in checks if check.ok is False]


@pytest.mark.parametrize("part", range(examples(1, long=SHARES)))
def test_each_field_that_is_changed_is_measured(part: int) -> None:
    """A share of the fields, all of them in the long form."""
    missed = []
    for number, start in _fields()[part::SHARES]:
        line = LINES[number]
        found = FIELD.match(line, start)
        assert found is not None
        field = found.group()
        text = line[:start] + _changed(field) + line[found.end() :]
        lines = [*LINES[:number], text, *LINES[number + 1 :]]
        if not _measured("\n".join(lines)):
            missed.append((_kind(line), field, text))
    assert [each for each in missed if not _harmless(*each)] == []


def test_a_line_that_is_left_out_is_found() -> None:
    for number in range(END, BEGIN, -37):
        lines = [*LINES[:number], *LINES[number + 1 :]]
        assert _measured("\n".join(lines))


def test_a_shell_inside_out_is_found() -> None:
    """All faces and loops turned: closed and oriented, but around the outside."""
    text = "\n".join(LINES)
    for kind in ("ADVANCED_FACE", "FACE_OUTER_BOUND", "FACE_BOUND"):
        text = re.sub(
            rf"(={kind}\(.*)\.([TF])\.\);",
            lambda found: f"{found[1]}.{'F' if found[2] == 'T' else 'T'}.);",
            text,
        )
    (fault,) = _measured(text)
    assert (fault.name, fault.note) == ("outwards", "the shell is turned inside out")


def test_another_height_is_measured() -> None:
    data = WRITER.write(StubProduct(thickness=8.5), TOLERANCE).data
    assert WRITER.measure(StubProduct(), data) == pytest.approx(0.5)


def test_a_groove_that_is_not_there_is_refused() -> None:
    data = WRITER.write(StubProduct(), TOLERANCE).data.replace(b"'outline'", b"'rim'")
    with pytest.raises(FileError, match="flat faces at 2 heights, expected 3"):
        WRITER.measure(StubProduct(groove=True), data)


def test_a_turn_of_the_cam_changes_each_boundary() -> None:
    """The oracle itself: what is 1% larger is off by that."""
    measured = WRITER.measure(StubProduct(), WRITER.write(StubProduct(scale=1.01), 0.01).data)
    assert measured == pytest.approx(0.01 * math.hypot(32.0, 5.0), rel=0.2)
