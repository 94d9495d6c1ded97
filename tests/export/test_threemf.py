"""3MF packages read by the XML of the standard library, trimesh and lib3mf: all that is in them,
and what strict readers take.
"""

from __future__ import annotations

import contextlib
import io
import math
import re
import zipfile
from collections.abc import Callable, Mapping
from functools import cache
from random import Random
from typing import Any, Final
from xml.etree import ElementTree as ET

import lib3mf  # type: ignore[import-untyped]  # has no types  # type: ignore[import-untyped]  # it has no types
import numpy as np
import pytest
import trimesh

import camgeo
from camgeo.design.drawn import COMPENSATED
from camgeo.design.plate import plate_pieces
from camgeo.design.product import Product
from camgeo.design.verify import ReadingOptions
from camgeo.design.writing import Writer, make_files
from camgeo.errors import FileError
from camgeo.part.mass import Solid
from camgeo.part.part import Part
from camgeo_export.dxf.writer import WRITER as DXF
from camgeo_export.step.writer import WRITER as STEP
from camgeo_export.stl import WRITER as STL
from camgeo_export.threemf.writer import WRITER
from camgeo_export.verify import threemf
from camgeo_export.verify.threemf import (
    VERIFIER,
    check_bodies,
    package_checks,
    packed,
    unpack_parts,
)
from tests.contour.cams import SCENES
from tests.export.stub_product import StubProduct
from tests.export.test_solids import BODIES
from tests.export.verified import (
    TOLERANCE,
    VERIFIERS,
    checked,
    faults,
    measured,
    read_back,
    require_moments,
)
from tests.long_form import LONG
from tests.packages import repacked

CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"

TYPE_OF_RELATIONS = "application/vnd.openxmlformats-package.relationships+xml"

TYPE_OF_MODEL = "application/vnd.ms-package.3dmanufacturing-3dmodel+xml"

PLATE: dict[str, Any] = {
    "output.3mf.plate": ["cam", "return-cam", "roller", "test-ring"],
    "output.3mf.roller_bore": 6,
    "drawing.title": "Nocken Ø8 & <mehr>",
    "print.bore_clearance": 0.2,
    "print.elephant_foot": {"inset": 0.2, "height": 0.4},
}


def with_values(values: dict[str, Any]) -> tuple[Product, ...]:
    scene = camgeo.load(SCENES / "conjugate_carriage.toml").scene
    return camgeo.Design(scene.with_values(values)).discs


@cache
def plated() -> tuple[tuple[Product, ...], bytes]:
    """The discs, and what is written of the first."""
    discs = with_values(PLATE)
    return discs, WRITER.write(discs[0], TOLERANCE).data


def require_strict(data: bytes, bodies: int) -> None:
    """That lib3mf warns of nothing, and takes all bodies as closed."""
    model = lib3mf.get_wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromBuffer(data)
    assert reader.GetWarningCount() == 0
    meshes = model.GetMeshObjects()
    assert meshes.Count() == bodies
    while meshes.MoveNext():
        assert meshes.GetCurrentMeshObject().IsManifoldAndOriented()


def unpacked(data: bytes) -> dict[str, ET.Element]:
    """The parts, of which nothing depends on when and where they were made."""
    with zipfile.ZipFile(io.BytesIO(data)) as package:
        for entry in package.infolist():
            assert entry.date_time == (1980, 1, 1, 0, 0, 0)
            assert (entry.create_system, entry.compress_type) == (3, zipfile.ZIP_DEFLATED)
        return {name: ET.fromstring(package.read(name)) for name in package.namelist()}


def mesh_of(element: ET.Element) -> trimesh.Trimesh:
    corners = element.iterfind(f"{CORE}mesh/{CORE}vertices/{CORE}vertex")
    facets = element.iterfind(f"{CORE}mesh/{CORE}triangles/{CORE}triangle")
    vertices = [[float(each.get(axis, "")) for axis in "xyz"] for each in corners]
    triangles = [[int(each.get(name, "")) for name in ("v1", "v2", "v3")] for each in facets]
    return trimesh.Trimesh(vertices, triangles, process=False)


def check_body(mesh: trimesh.Trimesh, part: Part) -> None:
    """Closed, of the moments of the part, with corners on its boundaries at its heights."""
    assert mesh.is_volume
    walls = sum(each.arcs(0.01, "fast").contour.length for each in part.boundaries)
    require_moments(mesh, part, TOLERANCE * walls * part.thickness)
    bottom, vertices = part.layers[0].z0, mesh.vertices
    for level in part.levels:
        here = vertices[np.abs(vertices[:, 2] - (level.z - bottom)) <= 1e-9]
        expected = sum(len(each.polyline(0.98 * TOLERANCE).contour) for each in level.boundaries)
        assert 0.8 * expected <= len(here) <= 1.2 * expected + 8
    heights = np.unique(np.round(vertices[:, 2], 9))
    assert heights == pytest.approx([each.z - bottom for each in part.levels], abs=1e-8)


@pytest.mark.parametrize("plate", [True, False], ids=["plate", "disc"])
def test_all_that_is_in_a_package(plate: bool) -> None:
    disc = with_values(PLATE if plate else {})[0]
    written = read_back(WRITER, disc)
    found = unpacked(written.data)
    assert list(found) == ["[Content_Types].xml", "_rels/.rels", "3D/3dmodel.model"]
    types, relations, model = found.values()
    assert types.tag.endswith("content-types}Types")
    assert [each.attrib for each in types] == [
        {"Extension": "rels", "ContentType": TYPE_OF_RELATIONS},
        {"Extension": "model", "ContentType": TYPE_OF_MODEL},
    ]  # fmt: skip
    (relation,) = relations
    assert relation.attrib == {
        "Target": "/3D/3dmodel.model", "Id": "model",
        "Type": "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel",
    }  # fmt: skip
    assert (model.tag, model.get("unit")) == (f"{CORE}model", "millimeter")
    assert model.get("{http://www.w3.org/XML/1998/namespace}lang") == "en"
    said = {each.get("name"): each.text for each in model.iterfind(f"{CORE}metadata")}
    advice = f"Compensated for printing: {disc.drawn.printed.advice}"
    assert said == {
        "Title": "Nocken Ø8 & <mehr>" if plate else "conjugate_carriage",
        "Application": f"camgeo {disc.version}",
        "camgeo:scene": disc.scene_hash,
        "camgeo:tolerance": "0.01 mm",
        **({"Description": advice} if plate else {}),
    }
    pieces = plate_pieces(disc)
    bases = model.findall(f"{CORE}resources/{CORE}basematerials")
    assert [each.get("id") for each in bases] == (["1"] if plate else [])
    colours = [(each.get("name"), each.get("displaycolor")) for group in bases for each in group]
    assert colours == [(each.name, each.colour) for each in pieces]
    objects = model.findall(f"{CORE}resources/{CORE}object")
    items = model.findall(f"{CORE}build/{CORE}item")
    if plate:
        assert [each.attrib for each in objects] == [
            {"id": str(number + 2), "type": "model", "name": each.name, "pid": "1",
             "pindex": str(number)}
            for number, each in enumerate(pieces)
        ]  # fmt: skip
        assert [each.attrib for each in items] == [
            {"objectid": str(number + 2), "transform": f"1 0 0 0 1 0 0 0 1 {each.x!r} {each.y!r} 0"}
            for number, each in enumerate(pieces)
        ]
    else:
        assert [each.attrib for each in objects] == [
            {"id": "1", "type": "model", "name": "conjugate_carriage"}
        ]
        assert [each.attrib for each in items] == [{"objectid": "1"}]
    bodies = [each.part for each in pieces] if plate else [disc.drawn.part]
    require_strict(written.data, len(bodies))
    meshes = list(map(mesh_of, objects))
    for mesh, part in zip(meshes, bodies, strict=True):
        check_body(mesh, part)
    facts = dict(written.facts)
    assert facts.pop("triangles") == sum(len(each.faces) for each in meshes)
    volume = sum(float(each.volume) for each in meshes)
    assert facts.pop("volume_mm3") == pytest.approx(volume, rel=1e-9)
    assert facts.pop("bodies", "") == ("cam, return-cam, roller, test-ring" if plate else "")
    assert facts == disc.drawn.printed.facts


@pytest.mark.parametrize("name", BODIES)
def test_an_stl_has_the_same_body(name: str) -> None:
    """Facet by facet, to single precision; normals are those of the facets."""
    product = StubProduct(given=BODIES[name])
    data = read_back(WRITER, product).data
    require_strict(data, 1)
    element = unpacked(data)["3D/3dmodel.model"]
    (body,) = element.findall(f"{CORE}resources/{CORE}object")
    mesh = mesh_of(body)
    data = read_back(STL, product).data
    assert data.startswith(b"camgeo 0.0.test unit mm scene 0123456789abcdef eccentric")
    count = int.from_bytes(data[80:84], "little")
    facets = np.frombuffer(data[84:], np.dtype([("n", "<f4", 3), ("c", "<f4", (3, 3)),
                                                ("a", "<u2")]))  # fmt: skip
    assert len(facets) == count == len(mesh.faces)
    assert not np.any(facets["a"])
    corners = facets["c"].astype(np.float64)
    assert np.allclose(corners, mesh.triangles, rtol=2.0**-23, atol=0.0)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sizes = np.linalg.norm(normals, axis=1, keepdims=True)
    assert np.allclose(facets["n"], normals / sizes, atol=1e-5)
    check_body(mesh, product.part)


# What is read -------------------------------------------------------------------------------------


def package(entries: dict[str, bytes], method: int = zipfile.ZIP_STORED) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as file:
        for name, data in entries.items():
            file.writestr(zipfile.ZipInfo(name), data, method)
    return stream.getvalue()


def patched(data: bytes, at: int, new: bytes, *, directory: bool = True) -> bytes:
    """A package with bytes of its first entry in the directory, or of its first file, changed."""
    start = data.index(b"PK\x01\x02" if directory else b"PK\x03\x04") + at
    return data[:start] + new + data[start + len(new) :]


PLAIN = {"a": b"1", "b": b"2"}

NOT_UNPACKED: dict[str, tuple[bytes, str]] = {
    "an absolute name": (package({"/a": b""}), "leads out of the package"),
    "a name above": (package({"x/../../a": b""}), "leads out of the package"),
    "a name of another system": (package({"x%y": b""}).replace(b"%", b"\\"), "leads out"),
    "one name twice": (package({"A": b"", "a": b""}), "it has two parts named a"),
    "an encrypted part": (patched(package(PLAIN), 8, b"\x01"), "the part a is encrypted"),
    "another compression": (package(PLAIN, zipfile.ZIP_BZIP2), "compression method 12, which 3MF"),
    "a part that is longer": (patched(package(PLAIN), 24, b"\x02"), "not as long as|unpacked"),
    "UTF-16": (package({"a.xml": "<?xml?><a/>".encode("utf-16")}), "is not encoded as UTF-8"),
    "another encoding": (package({"a.rels": b"<?xml version='1.0' encoding='latin-1'?><a/>"}),
                         "a.rels: is not encoded as UTF-8"),
    "a document type": (package({"a.model": b"<!DOCTYPE a><a/>"}), "document type declaration"),
    "an entity": (package({"A.XML": b"<!ENTITY a 'b'>"}), "document type declaration"),
    "no package": (b"PK\x03\x04 and nothing else", "cannot be unpacked"),
}  # fmt: skip


@pytest.mark.parametrize("name", NOT_UNPACKED)
def test_what_may_not_be_unpacked(name: str) -> None:
    data, message = NOT_UNPACKED[name]
    with pytest.raises(FileError, match=message):
        unpack_parts(data)


def test_what_is_no_xml_may_hold_anything() -> None:
    harmless = {
        "a.png": b"\0<!DOCTYPE", "b.xml": b"\xef\xbb\xbf<?xml version='1.0' encoding='UTF-8'?><a/>",
        "c.model": b" <?xml encoding=\"utf8\"?><a/>", "d.rels": b"<a/>",
    }  # fmt: skip
    assert unpack_parts(package(harmless, zipfile.ZIP_DEFLATED)) == harmless
    assert unpack_parts(packed(harmless)) == harmless


def build(*objects: str, items: str = '<item objectid="1"/>') -> dict[str, bytes]:
    resources = "".join(objects)
    whole = f"<resources>{resources}</resources><build>{items}</build>"
    return {"3D/m.model": f'<model xmlns="{CORE[1:-1]}">{whole}</model>'.encode()}


def of_facets(number: int, name: int = 1, inner: str = "") -> str:
    return f'<object id="{name}">{"<triangle/>" * number}{inner}</object>'


def tripled(count: int) -> dict[str, bytes]:
    """Two copies of a body within another one, and itself: three times as many facets."""
    inner = '<components><component objectid="1"/></components>' * 2
    items = '<item objectid="2"/><item objectid="1"/>'
    return build(of_facets(count), of_facets(0, 2, inner), items=items)


LIMITS: dict[str, tuple[Callable[[int], dict[str, bytes]], str]] = {
    "MEMBERS": (lambda n: {str(k): b"" for k in range(n)}, "parts"),
    "UNPACKED": (lambda n: {"a": b"x" * 3, "b": b"x" * (n - 3)}, "bytes unpacked"),
    "TAG": (lambda n: {"a.xml": b"<a" + b"x" * (n - 1) + b">"}, "a tag of more than"),
    "ELEMENTS": (lambda n: {"a.xml": b"<" * n, "b.xml": b"<" * n}, "tags"),
    "ATTRIBUTES": (lambda n: {"a.xml": b"=" * (n - 1), "b.rels": b"="}, "attributes"),
    "OBJECTS": (lambda n: build(*(of_facets(1, k + 1) for k in range(n))), "objects"),
    "FACETS": (lambda n: build(of_facets(n)), "facets"),
}


@pytest.mark.parametrize("limit", LIMITS)
def test_as_much_as_the_limit_is_read_and_no_more(
    limit: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    make, message = LIMITS[limit]
    most = 12
    monkeypatch.setattr(threemf, limit, most)
    if limit == "TAG":  # which is compiled with it
        monkeypatch.setattr(threemf, "LONG", re.compile(rb"<[^<>!?][^<>]{%d}" % most))

    def check(count: int) -> None:
        found = unpack_parts(package(make(count)))
        if limit in ("OBJECTS", "FACETS"):
            check_bodies(found)

    check(most)
    with pytest.raises(FileError, match=message):
        check(most + 1)


def test_all_copies_of_a_body_count(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(threemf, "FACETS", 12)
    check_bodies(tripled(4))
    with pytest.raises(FileError, match="15 facets"):
        check_bodies(tripled(5))


def test_the_ratio_of_small_parts_does_not_matter(monkeypatch: pytest.MonkeyPatch) -> None:
    data = package({"a": b"x" * 5_000}, zipfile.ZIP_DEFLATED)
    with zipfile.ZipFile(io.BytesIO(data)) as file:
        ratio = 5_000 / file.infolist()[0].compress_size
    monkeypatch.setattr(threemf, "SMALL", 4_999)
    for allowed, fits in ((math.ceil(ratio), True), (math.ceil(ratio) - 1, False)):
        monkeypatch.setattr(threemf, "RATIO", allowed)
        if fits:
            assert len(unpack_parts(data)["a"]) == 5_000
            continue
        with pytest.raises(FileError, match=f"unpacks to {ratio:,.0f} times its size; allowed: "):
            unpack_parts(data)
    monkeypatch.setattr(threemf, "SMALL", 5_000)
    assert len(unpack_parts(data)["a"]) == 5_000


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (build(of_facets(1), items='<item objectid="2"/>'), "builds the object '2', which does"),
        (build(of_facets(1, 1, '<component objectid="3"/>')), "builds the object '3', which does"),
        (build(of_facets(1, 1, '<component objectid="1"/>')), "the object 1 contains itself"),
        (build('<object id="1"><vertex x="1" y="1e10" z="0"/></object>'), "a vertex has '1e10'"),
        (build('<object id="1"><vertex x="1" y="1"/></object>'), "a vertex has nothing"),
        (build(of_facets(1), items='<item objectid="1" transform="1 a"/>'),
         "the transform of a item has 'a'|the transform of an item has 'a'"),
    ],
)  # fmt: skip
def test_what_may_not_be_built(given: dict[str, bytes], message: str) -> None:
    with pytest.raises(FileError, match=message):
        check_bodies(given)


def test_bodies_may_be_spread_over_several_models() -> None:
    spread = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06"
    item = f'<item xmlns:p="{spread}" p:path="/3D/other.model" objectid="7"/>'
    both = build(items=item) | {"3D/other.model": build(of_facets(3, 7), items="")["3D/m.model"]}
    check_bodies(both)
    with pytest.raises(FileError, match="builds the object '7'"):
        check_bodies(build(items=item))


# Several bodies on one plate ----------------------------------------------------------------------


def test_one_file_has_all() -> None:
    discs, written = plated()
    files, _ = make_files(discs, ("3mf",), TOLERANCE)
    assert sorted(files) == ["certificate.json", "conjugate_carriage.3mf"]
    assert files["conjugate_carriage.3mf"] == written  # the same bytes again
    checks = checked(VERIFIER, discs[0], written)
    for piece in plate_pieces(discs[0]):
        volume = checks["volume", piece.name]
        assert volume.expected == pytest.approx(Solid.from_part(piece.part).volume, rel=1e-9)


def _swapped(text: str, one: str, other: str) -> str:
    return text.replace(one, "\0").replace(other, one).replace("\0", other)


MUTATIONS: dict[str, Callable[[str], str]] = {
    "a name": lambda text: text.replace('name="roller" pid', 'name="router" pid'),
    "a colour": lambda text: text.replace("#E0A030", "#E0A031"),
    "the colours of two": lambda text: _swapped(text, 'pindex="0"', 'pindex="1"'),
    "a place": lambda text: text.replace("0 0 0 1 ", "0 0 0 1 1", 1),
    "a scale": lambda text: text.replace('transform="1 ', 'transform="1.001 ', 1),
    "the bodies of two": lambda text: _swapped(text, 'objectid="2"', 'objectid="3"'),
    "a body lost": lambda text: text[: text.rindex("<item")] + "</build></model>",
    "a vertex": lambda text: text.replace('vertex x="', 'vertex x="1', 1),
    "a body twice": lambda text: text.replace('objectid="5"', 'objectid="4"'),
}


@pytest.mark.parametrize("kind", MUTATIONS)
def test_what_is_changed_is_found(kind: str) -> None:
    (disc, _), written = plated()
    change = MUTATIONS[kind]
    data = repacked(written, lambda path, text: change(text) if "model" in path else text)
    assert data != written
    assert faults(VERIFIER, disc, data)
    if "colour" not in kind:
        with contextlib.suppress(FileError):
            assert measured(WRITER, disc, data) > TOLERANCE


def test_another_plate_is_another_file() -> None:
    _, written = plated()
    fewer = {**PLATE, "output.3mf.plate": PLATE["output.3mf.plate"][:3]}
    for values in (fewer, {}):
        disc, _ = with_values(values)
        with pytest.raises(FileError, match="are not those of the scene"):
            WRITER.measure(disc, written)
        assert faults(VERIFIER, disc, written)


def test_a_pair_in_one_piece_has_one_plate() -> None:
    values = {"part.pair": {"gap": 8, "spacer": 40}, "output.3mf.plate": ["cam", "roller"]}
    discs = with_values(values)
    files, (report,) = make_files(discs, ("3mf",), 0.1)
    assert report.name == "conjugate_carriage-pair.3mf"
    assert discs[0].pair is not None
    assert faults(VERIFIER, discs[0].pair, files[report.name], 0.1) == []


def test_without_a_plate_each_disc_has_a_file_of_its_own() -> None:
    apart, (together, _) = with_values({}), plated()
    assert [WRITER.pieces(each) for each in apart] == [(each,) for each in apart]
    assert [WRITER.pieces(each) for each in together] == [(together[0],), ()]


# Bodies compensated for printing ------------------------------------------------------------------


both = pytest.mark.parametrize("writer", [STL, WRITER], ids=["stl", "3mf"])

HUBBED = {
    "part.bore": 20,
    "part.keyway": {"width": 6, "depth": 2.8},
    "part.hub": {"diameter": 30, "height": 6, "side": "both"},
}

COMPENSATION: dict[str, Any] = {
    "print.bore_clearance": 0.2,
    "print.key_clearance": 0.1,
    "print.elephant_foot": {"inset": 0.2, "height": 0.4, "steps": 2},
    "print.shrinkage": {"xy": 0.5, "z": 0.3},
}


@cache
def compensated(*keys: str) -> Product:
    """The disc with some of the compensations."""
    design = camgeo.load(SCENES / "plate_translating.toml")
    scene = design.scene.with_values({**HUBBED, **{key: COMPENSATION[key] for key in keys}})
    return camgeo.Design(scene).disc


WHOLE = tuple(COMPENSATION)


@both
def test_a_compensated_body_is_what_it_should_be(writer: Writer) -> None:
    """Of the volume of the exact compensated part, and verified as such."""
    disc = compensated(*WHOLE)
    written = read_back(writer, disc)
    exact = Solid.from_part(disc.drawn.printed.target).volume
    assert exact != pytest.approx(Solid.from_part(disc.drawn.part).volume, rel=1e-3)
    assert written.facts["volume_mm3"] == pytest.approx(exact, rel=1e-3)
    assert written.facts["bore_clearance_mm"] == 0.2
    assert "switch off the slicer's own" in str(written.facts["compensation"])
    (finding,) = written.findings
    assert (finding.name, finding.severity) == (COMPENSATED, "warning")
    assert "switch off the slicer's own: elephant foot" in finding.sentence
    assert "bore 0.2 mm larger in diameter, 0.1 mm per side" in finding.sentence
    checks = checked(VERIFIERS[writer.format.name], disc, written.data)
    assert checks["compensation", ""].value == disc.drawn.printed.text
    assert checks["volume", ""].expected == pytest.approx(exact, rel=1e-9)


@both
@pytest.mark.parametrize("lost", WHOLE)
def test_a_body_without_one_of_them_is_another(writer: Writer, lost: str) -> None:
    """Each compensation is far above the tolerance: without it, the file is not the one."""
    data = writer.write(compensated(*(key for key in WHOLE if key != lost)), TOLERANCE).data
    disc = compensated(*WHOLE)
    if lost == "print.elephant_foot":  # there are fewer flat faces
        with pytest.raises(FileError, match="flat faces at"):
            writer.measure(disc, data)
    else:
        assert measured(writer, disc, data) > 3.0 * TOLERANCE
    reading = ReadingOptions("file")
    checks = checked(VERIFIERS[writer.format.name], disc, data, reading).values()
    assert any(each.ok is False for each in checks)


@both
def test_without_compensation_nothing_is_said(writer: Writer) -> None:
    disc = compensated()
    written = writer.write(disc, TOLERANCE)
    assert list(written.facts) == ["triangles", "volume_mm3"]
    assert written.findings == ()
    assert disc.drawn.printed.target is disc.drawn.part
    checks = checked(VERIFIERS[writer.format.name], disc, written.data)
    assert ("compensation", "") not in checks


@pytest.mark.parametrize("writer", [DXF, STEP], ids=["dxf", "step"])
def test_other_files_show_the_part_itself(writer: Writer) -> None:
    data = writer.write(compensated(*WHOLE), TOLERANCE).data
    assert measured(writer, compensated(), data) <= TOLERANCE


@pytest.mark.parametrize(
    ("key", "value"), [("bore_clearance", 60.0), ("elephant_foot", {"inset": 60, "height": 0.2})]
)
def test_a_part_without_room_is_refused_with_the_key(key: str, value: object) -> None:
    design = camgeo.load(SCENES / "plate_translating.toml")
    scene = design.scene.with_values({"part.bore": 20, f"print.{key}": value})
    with pytest.raises(camgeo.GeometryError) as caught:
        camgeo.Design(scene).disc.drawn.printed.target  # noqa: B018  # it is computed now
    assert caught.value.key.startswith(f"print.{key}")


# What strict readers take of a 3MF package: small ones with one fault each, read by lib3mf too ----


Edits = tuple[tuple[str, str, str], ...]
"""Part, what is there, what is put in its place; of an empty text the whole is put there."""

OPC: Final = "http://schemas.openxmlformats.org/package/2006"
MICROSOFT: Final = "http://schemas.microsoft.com/3dmanufacturing/2013/01"

TYPES, RELATIONS, MODEL = "[Content_Types].xml", "_rels/.rels", "3D/3dmodel.model"
OF_MODEL: Final = "3D/_rels/3dmodel.model.rels"

GOOD: Final[Mapping[str, str]] = {
    TYPES: f"""<Types xmlns="{OPC}/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model"
 ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
<Default Extension="png" ContentType="image/png"/>
<Default Extension="xml" ContentType="application/vnd.ms-printing.printticket+xml"/></Types>""",
    RELATIONS: f"""<Relationships xmlns="{OPC}/relationships">
<Relationship Target="/{MODEL}" Id="rel0" Type="{MICROSOFT}/3dmodel"/></Relationships>""",
    MODEL: """<model xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
 xmlns:a="urn:a" unit="millimeter" xml:lang="en"><metadata name="Title">t</metadata><resources>
<basematerials id="1"><base name="b" displaycolor="#112233"/>
<base name="c" displaycolor="#11223344"/></basematerials>
<object id="2" type="model" name="o" pid="1" pindex="0"><mesh><vertices>
<vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/><vertex x="0" y="1" z="0"/>
<vertex x="0" y="0" z="1"/></vertices><triangles><triangle v1="0" v2="2" v3="1"/>
<triangle v1="0" v2="1" v3="3"/><triangle v1="1" v2="2" v3="3"/><triangle v1="2" v2="0" v3="3"/>
</triangles></mesh></object></resources><build><item objectid="2"/></build></model>""",
}
"""A tetrahedron of two materials."""


def put(part: str, old: str, new: str) -> Edits:
    return ((part, old, new),)


def model(old: str, new: str) -> Edits:
    return put(MODEL, old, new)


def leads(source: str, *rows: tuple[str, str]) -> Edits:
    """Further relationships, with type and target, of the package or the model."""
    lines = "".join(
        f'<Relationship Id="more{k}" Type="{kind}" Target="{target}"/>'
        for k, (kind, target) in enumerate(rows)
    )
    if source == RELATIONS:
        return put(RELATIONS, "</Relationships>", f"{lines}</Relationships>")
    return put(source, "", f'<Relationships xmlns="{OPC}/relationships">{lines}</Relationships>')


def has(*names: str) -> Edits:
    """Further parts."""
    return tuple((name, "", "<a/>") for name in names)


def component(key: str, attributes: str = "", after: str = "</object>") -> Edits:
    """A further object that has one as its component, after the other one or at the end."""
    inner = f'<component objectid="{key}"/>'
    new = f'<object id="3" {attributes}><components>{inner}</components></object>'
    return model("<object ", f"{new}<object ") if not after else model(after, after + new)


THUMBNAIL: Final = f"{OPC}/relationships/metadata/thumbnail"
TICKET: Final = f"{MICROSOFT}/printticket"
TEXTURE: Final = f"{MICROSOFT}/3dtexture"

FIRST: Final = 'v1="0" v2="2" v3="1"'
MESH: Final = GOOD[MODEL][GOOD[MODEL].index("<mesh>") : GOOD[MODEL].index("</object>")]
MATERIALS: Final = GOOD[MODEL][GOOD[MODEL].index("<base") : GOOD[MODEL].index("<object")]
BUILD: Final = GOOD[MODEL][GOOD[MODEL].index("<build>") : GOOD[MODEL].index("</model>")]

FORBIDDEN: Final[dict[str, tuple[Edits, str]]] = {
    "no such thumbnail": (leads(RELATIONS, (THUMBNAIL, "/t.png")), "'/t.png' is not in .*2.1.1"),
    "in other case": (leads(RELATIONS, (THUMBNAIL, "/T.png")) + has("t.png"), "'/T.png' is not in"),
    "no target": (leads(RELATIONS, (THUMBNAIL, "")), "the target '' is not in the package"),
    "two thumbnails": (
        leads(RELATIONS, (THUMBNAIL, "/t.png"), (THUMBNAIL, "/u.png")) + has("t.png", "u.png"),
        r"two relationships of the type .*thumbnail \(.*2.1",
    ),
    "two models": (leads(RELATIONS, (f"{MICROSOFT}/3dmodel", f"/{MODEL}")), "two relationships"),
    "no such texture": (leads(OF_MODEL, (TEXTURE, "/t.png")), f"{OF_MODEL}: the target '/t.png'"),
    "outside": (leads(OF_MODEL, (TEXTURE, "C:/t.png")), "'C:/t.png' is not in the package"),
    "two print tickets": (
        leads(OF_MODEL, (TICKET, "/a.xml"), (TICKET, "/b.xml")) + has("a.xml", "b.xml"),
        "two relationships of the type .*printticket",
    ),
    "a texture twice": (
        leads(OF_MODEL, (TEXTURE, "/t.png"), (TEXTURE, "/t.png")) + has("t.png"), "two relation",
    ),
    "one Id twice": (
        put(RELATIONS, "</R", f'<Relationship Id="rel0" Type="urn:x" Target="/{MODEL}"/></R'),
        "the Id 'rel0' is not valid, or appears twice",
    ),
    "another type of the model": (put(TYPES, "3dmodel+xml", "3d+xml"), f"type of {MODEL} is"),
    "one type twice": (put(TYPES, '"xml"', '"png"'), "Default 'png' is .*appears twice"),
    "a thumbnail that the model does not name": (
        model('name="o"', 'name="o" thumbnail="/t.png"') + has("t.png"), "thumbnail '/t.png' of",
    ),
    "one id twice": (model('als id="1"', 'als id="2"'), "the resource id '2' appears twice"),
    "materials without an id": (model('als id="1"', "als"), "the resource id '' is not valid"),
    "xml:space": (model('xml:lang="en"', 'xml:space="default"'), "xml:space .*2.3.4"),
    "an unknown element": (model("<mesh>", "<form/><mesh>"), "the element form is not expected"),
    "an unknown unit": (model("millimeter", "mm"), "'mm' is not a unit"),
    "an encoding": (put(MODEL, "<model", "<?xml version='1.0' encoding='ISO-8859-1'?><model"),
                    "is not encoded as UTF-8"),
    "a document type": (model("<model", "<!DOCTYPE model><model"), "document type declaration"),
    "a name without a namespace": (model('"Title"', '"Slicer"'), "'Slicer' is neither .*3.4.1"),
    "a namespace not declared": (model('"Title"', '"q:Title"'), "'q:Title' is neither one of"),
    "a namespace declared later": (
        model('"Title"', '"q:Title"') + model("<resources", '<resources xmlns:q="urn:q"'),
        "'q:Title' is neither",
    ),
    "metadata twice": (model("<resources", '<metadata name="Title"/><resources'), "appears twice"),
    "metadata of an object": (
        model("<mesh>", '<metadatagroup><metadata name="Foo"/></metadatagroup><mesh>'), "'Foo' is",
    ),
    "metadata of an item": (
        model('"2"/></build>', '"2"><metadatagroup><metadata name="Foo"/></metadatagroup>'
              "</item></build>"), "'Foo' is neither",
    ),
    "no such properties": (model('pid="1"', 'pid="7"'), "the properties '7', which do not come"),
    "properties that are an object": (component("2") + model('pid="1"', 'pid="2"'), "'2', which"),
    "properties that come later": (
        model(MATERIALS, "") + model("</object>", f"</object>{MATERIALS}"), "do not come before",
    ),
    "no such property": (model('pindex="0"', 'pindex="2"'), "pindex = '2' of 2 properties"),
    "no such property of a facet": (
        model(FIRST, f'{FIRST} pid="1" p1="2"'), r"p1 = '2' of 2 properties .*4\.1\.4\.1"),
    "no such properties of a facet": (model(FIRST, f'{FIRST} pid="5" p1="0"'), "properties '5'"),
    "no such corner": (model(FIRST, 'v1="0" v2="2" v3="4"'), "corners 0, 2, 4, not three diff"),
    "two corners alike": (model(FIRST, 'v1="0" v2="2" v3="2"'), "corners 0, 2, 2, not three"),
    "a corner left out": (model(FIRST, 'v1="0" v2="2"'), "corners 0, 2, None, not three"),
    "no coordinate": (model(' z="1"', ""), "a vertex has nothing"),
    "an empty coordinate": (model(' z="1"', ' z=""'), "a vertex has '', which is not a number"),
    "neither mesh nor components": (model(MESH, ""), "the object 2 has 0 meshes"),
    "two meshes": (model(MESH, MESH + MESH), "the object 2 has 2 meshes"),
    "a component that comes later": (component("2", after=""), "'2', which is not an object"),
    "no such component": (component("9"), "'9', which does not exist"),
    "an object within itself": (component("3"), "the object 3 contains itself"),
    "eleven numbers": (
        model("<item ", '<item transform="1 0 0 0 1 0 0 0 1 0 0" '), "11 numbers, not 12",
    ),
    "no such object": (model('<item objectid="2"', '<item objectid="5"'), "'5', which"),
    "materials that are built": (model('<item objectid="2"', '<item objectid="1"'), "'1', which"),
    "an object of type other": (model('"model"', '"other"'), "is of type 'other' .*3.4.3.1"),
    "an object of unknown type": (model('"model"', '"form"'), "'form' is not a type of object"),
    "two builds": (model(BUILD, BUILD + BUILD), "one element resources, followed by one .*3.4"),
    "no build": (model(BUILD, ""), "followed by one element build"),
    "two resources": (model("<build>", "<resources/><build>"), "must have one element resources"),
    "a build that comes before": (
        model(BUILD, "") + model("<resources>", f"{BUILD}<resources>"), "followed by one element",
    ),
    "an extension that is required": (model(" unit", ' requiredextensions="a" unit'), "'a', which"),
}  # fmt: skip
"""What both refuse, and what camgeo says."""

STRICTER: Final[dict[str, tuple[Edits, str]]] = {
    "a thumbnail of another type": (
        leads(RELATIONS, (THUMBNAIL, "/t.xml")) + has("t.xml"), "not image/png or image/jpeg",
    ),
    "no such print ticket": (leads(OF_MODEL, (TICKET, "/a.xml")), "'/a.xml' is not in .*2.1.1"),
    "a link": (leads(RELATIONS, ("urn:x", "https://a.org/b")), "'https://a.org/b' is not in"),
    "an id of an extension": (model("<object ", '<a:group id="1"/><object '), "'1' appears twice"),
    "xml:space further down": (model("<mesh>", '<mesh xml:space="default">'), "xml:space"),
    "an index without properties": (model('pid="1" ', ""), "has a pindex and no pid"),
    "an object of type other in another": (
        model('"model"', '"other"') + component("2")
        + model('objectid="2"/></b', 'objectid="3"/></b'),
        "'3', which is of type 'other'",
    ),
    "no colour": (model("#112233", "red"), r"'red' is not a colour #RRGGBB \(.*5.1.1"),
    "an unknown attribute": (model("<mesh>", '<mesh form="1">'), "attribute form of mesh"),
    "an Id that is none": (put(RELATIONS, '"rel0"', '"0 a"'), "the Id '0 a' is not valid"),
}  # fmt: skip
"""What a clause forbids and lib3mf 2.5 reads."""

ACCEPTED: Final[Mapping[str, Edits]] = {
    "as it is": (),
    "a thumbnail": leads(RELATIONS, (THUMBNAIL, "/t.png")) + has("t.png"),
    "a thumbnail, named from where it is": leads(RELATIONS, (THUMBNAIL, "t.png")) + has("t.png"),
    "a print ticket": leads(OF_MODEL, (TICKET, "/3D/a.xml")) + has("3D/a.xml"),
    "thumbnails of objects": leads(OF_MODEL, (THUMBNAIL, "/t.png"), (TEXTURE, "u.png"))
    + model('name="o"', 'name="o" thumbnail="/t.png"') + has("t.png", "3D/u.png"),
    "a part that nobody names": has("a.foo"),
    "what somebody else names": leads(RELATIONS, ("urn:x", "/a.foo"), ("urn:x", "/b.foo")),
    "the largest id": model('object id="2"', 'object id="2147483647"')
    + model('objectid="2"', 'objectid="2147483647"'),
    "metadata of a namespace": model('"Title"', '"a:Slicer"'),
    "metadata of an object": model(
        "<mesh>", '<metadatagroup><metadata name="a:b"/></metadatagroup><mesh>'
    ),
    "properties of facets": model(FIRST, f'{FIRST} pid="1" p1="1" p2="1" p3="1"'),
    "a component": component("2") + model('objectid="2"/></b', 'objectid="3"/></b'),
    "a support beside it": model("</object>", f'</object><object id="4" type="support">{MESH}'
                                 "</object>") + model("<item", '<item objectid="4"/><item'),
    "a transform": model("<item ", '<item transform=" 1 0 0  0 1 0 0 0 1 2 0 0 " '),
    "slices": model("<resources>", '<resources><a:stack id="9"><a:vertices><a:vertex x="1" y="0"/>'
                    "</a:vertices></a:stack>"),
    "elements of others": model("</mesh>", '<a:vertex/><a:triangle v1="9"/></mesh>'),
    "attributes of others": model("<vertices>", '<vertices a:b="1">'),
    "an extension that is recommended": model(" unit", ' recommendedextensions="a" unit'),
    "no unit": model(' unit="millimeter"', ""),
}  # fmt: skip
"""What both read."""


def edited(edits: Edits) -> bytes | None:
    """The package with edits; None if one of them does not find its place."""
    parts = dict(GOOD)
    for part, old, new in edits:
        if old not in parts.get(part, ""):
            return None
        parts[part] = parts[part].replace(old, new, 1) if old else new
    return packed({name: content.encode() for name, content in parts.items()})


def said(data: bytes) -> str:
    """What camgeo finds wrong; empty if it is nothing."""
    damage = VERIFIER.origin(data).damage
    if damage:
        return damage
    unit = re.search(rb' unit="([^"]*)"', unpack_parts(data)[MODEL])
    if unit is not None and unit[1] != b"millimeter":
        return f"{unit[1].decode()!r} is not a unit"  # which is a check of its own
    return "".join(each.note for each in package_checks(unpack_parts(data))
                   if each.ok is False)  # fmt: skip


def strict(data: bytes) -> str:
    """What lib3mf says of it in its strict mode; empty if it reads it without a warning."""
    found = lib3mf.get_wrapper().CreateModel()
    reader = found.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    try:
        reader.ReadFromBuffer(data)
    except lib3mf.ELib3MFException as error:
        return str(error)
    return ", ".join(reader.GetWarning(k)[1] for k in range(reader.GetWarningCount()))


@pytest.mark.parametrize("kind", [*FORBIDDEN, *STRICTER])
def test_what_a_clause_forbids(kind: str) -> None:
    edits, words = (FORBIDDEN | STRICTER)[kind]
    data = edited(edits)
    assert data is not None
    assert re.search(words, said(data))
    assert bool(strict(data)) == (kind in FORBIDDEN)  # else it belongs to the other table


@pytest.mark.parametrize("kind", ACCEPTED)
def test_what_all_read(kind: str) -> None:
    data = edited(ACCEPTED[kind])
    assert data is not None
    assert (said(data), strict(data)) == ("", "")


def test_several_changes_at_once_are_judged_as_by_lib3mf() -> None:
    """Two or three of those that both read, and at times one that both refuse."""
    draw = Random(3)
    judged = {True: 0, False: 0}
    while min(judged.values()) < (400 if LONG else 40):
        chosen = draw.sample(list(ACCEPTED.values()), draw.choice((2, 3)))
        if draw.random() < 0.5:
            chosen.append(draw.choice(list(FORBIDDEN.values()))[0])
        draw.shuffle(chosen)
        data = edited(tuple(each for edits in chosen for each in edits))
        if data is None:
            continue
        verdict = said(data)
        assert bool(verdict) == bool(strict(data)), (chosen, verdict, strict(data))
        judged[not verdict] += 1
