"""Fields of meshes are changed in turn: verify measures the change, or it is harmless."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from camgeo.design.verify import ReadingOptions
from camgeo_export.stl import WRITER as STL
from camgeo_export.threemf.writer import WRITER as THREEMF
from camgeo_export.verify.stl import FACET, PREFIX
from camgeo_export.verify.stl import VERIFIER as STL_VERIFIER
from camgeo_export.verify.threemf import (
    CONTENT_TYPES_PATH,
    MODEL_PATH,
    MODEL_RELATION,
    PRODUCTION,
    RELATIONSHIPS_PATH,
    packed,
    unpack_parts,
)
from camgeo_export.verify.threemf import VERIFIER as THREEMF_VERIFIER
from tests.export.stub_product import StubProduct
from tests.export.verified import TOLERANCE, checked, faults
from tests.packages import repacked

PRODUCT = StubProduct()


# Meshes -------------------------------------------------------------------------------------------

MESH = STL.write(PRODUCT, TOLERANCE).data


def stl_with(change: Callable[[Any], None]) -> bytes:
    """The good STL with its facets changed in place."""
    facets = np.frombuffer(MESH, FACET, offset=PREFIX).copy()
    change(facets)
    return MESH[:PREFIX] + facets.tobytes()


def set_to(name: str, value: Any, which: Any = 7) -> Callable[[Any], None]:
    def change(facets: Any) -> None:
        facets[name][which] = value

    return change


def scaled(name: str, factor: float) -> Callable[[Any], None]:
    def change(facets: Any) -> None:
        facets[name] *= factor

    return change


def collinear(facets: Any) -> None:
    """Move a corner of a facet of a wall to the middle of the facet's upright side."""
    for corners in facets["corners"]:
        for k in range(3):
            low, high = corners[k - 1], corners[k - 2]
            if (low[:2] == high[:2]).all():
                corners[k] = 0.5 * (low + high)
                return


@pytest.mark.parametrize(
    ("data", "check", "note"),
    [
        (stl_with(set_to("normal", 0.0)), "normals", "is 0; 1 facet affected"),
        (stl_with(set_to("normal", 0.0, slice(None))), "normals", "is 0"),
        (stl_with(scaled("normal", -1.0)), "normals", "is turned away from its facet"),
        (stl_with(scaled("normal", 2.0)), "normals", "is not of length 1"),
        (stl_with(set_to("normal", (0.0, 1.0, 0.0))), "normals", "normal of facet 8"),
        (stl_with(set_to("normal", np.nan)), "normals", "normal of facet 8"),
        (stl_with(set_to("attribute", 31)), "attributes", "facet 8 has the attribute 31"),
        (stl_with(set_to("corners", np.inf)), "facets", "not finite"),
        (stl_with(set_to("corners", 0.0)), "facets", "1 of them have no area"),
        (stl_with(collinear), "facets", "1 of them have no area"),
        (stl_with(scaled("corners", 1.001)), "deviation", "mm off near"),
        (MESH.replace(b"unit mm", b"unit in"), "unit", "camgeo's STL files are in mm"),
        (MESH.replace(b"eccentric", b"excentric"), "part", "a different part"),
        (MESH.replace(b"scene 0123", b"scene 0124"), "scene", ""),
        (MESH[: PREFIX - 4] + bytes(4) + MESH[PREFIX:], "file", "not a complete binary STL"),
        (MESH[:-1], "file", "not a complete binary STL"),
    ],
)
def test_an_stl_that_is_changed(data: bytes, check: str, note: str) -> None:
    """Each field of the format: header, count, normals, corners, attributes; not the version."""
    assert not faults(STL_VERIFIER, PRODUCT, MESH.replace(b"0.0.test", b"9.9.test"))
    assert note in {each.name: each.note for each in faults(STL_VERIFIER, PRODUCT, data)}[check]


def test_normals_of_other_programs_may_be_zero_but_not_wrong() -> None:
    foreign = b"solid".ljust(80)
    zero = foreign + stl_with(set_to("normal", 0.0, slice(None)))[80:]
    assert not faults_of_foreign(zero)
    turned = foreign + stl_with(scaled("normal", -1.0))[80:]
    assert faults_of_foreign(turned) == {"normals"}


def faults_of_foreign(data: bytes) -> set[str]:
    assert not STL_VERIFIER.origin(data).version
    checks = checked(STL_VERIFIER, PRODUCT, data, ReadingOptions("a.stl")).values()
    return {check.name for check in checks if check.ok is False}


# Packages -----------------------------------------------------------------------------------------

PACKAGE = THREEMF.write(PRODUCT, TOLERANCE).data

RELATION = f'<Relationship Target="/{MODEL_PATH}" Id="second" Type="{MODEL_RELATION}" />'


def without(part: str) -> bytes:
    return repacked(PACKAGE, lambda path, content: None if path == part else content)


def put(part: str, old: str, new: str) -> bytes:
    """`new` for the first match of the pattern `old` in a part."""

    def change(path: str, content: str) -> str:
        if path != part:
            return content
        assert re.search(old, content)
        return re.sub(old, new, content, count=1)

    return repacked(PACKAGE, change)


TYPES, RELATIONS, MODEL = CONTENT_TYPES_PATH, RELATIONSHIPS_PATH, MODEL_PATH

PACKAGES: dict[str, tuple[bytes, str]] = {
    "no content types": (without(TYPES), "package"),
    "no relationships": (without(RELATIONS), "package"),
    "no model": (without(MODEL), "file"),
    "a further part": (
        repacked(PACKAGE, lambda _, content: content, {"a.txt": ""}), "written again",
    ),
    "types: namespace": (put(TYPES, "content-types", "content-typez"), "package"),
    "types: root": (put(TYPES, r"<Types(.*)</Types>", r"<Kinds\1</Kinds>"), "package"),
    "types: no XML": (put(TYPES, "</Types>", ""), "package"),
    "types: extension of the model": (put(TYPES, '"model"', '"modal"'), "package"),
    "types: extension of relationships": (put(TYPES, '"rels"', '"rel"'), "package"),
    "types: type of the model": (put(TYPES, "model[+]xml", "modal+xml"), "package"),
    "types: type of relationships": (put(TYPES, "ships[+]xml", "ship+xml"), "package"),
    "types: one twice": (put(TYPES, "(<Default [^>]*>)", r"\1\1"), "package"),
    "relationships: namespace": (put(RELATIONS, "2006/rel", "2007/rel"), "package"),
    "relationships: type": (put(RELATIONS, "01/3dmodel", "01/3dmodal"), "package"),
    "relationships: target": (put(RELATIONS, "/3D/3d", "/3D/4d"), "package"),
    "relationships: relative target": (put(RELATIONS, '"/3D', '"3D'), "package"),
    "relationships: no Id": (put(RELATIONS, ' Id="model"', ""), "package"),
    "relationships: no identifier": (put(RELATIONS, 'Id="model"', 'Id="1 a"'), "package"),
    "relationships: two": (put(RELATIONS, "</Rel", f"{RELATION}</Rel"), "package"),
    "model: namespace": (put(MODEL, "core/2015/02", "core/2016/02"), "model"),
    "model: root": (put(MODEL, "(?s)<model(.*)</model>", r"<shape\1</shape>"), "model"),
    "model: encoding": (put(MODEL, "UTF-8", "ISO-8859-1"), "file"),
    "model: document type": (put(MODEL, "<model", "<!DOCTYPE model><model"), "file"),
    "model: unknown unit": (put(MODEL, "millimeter", "mm"), "unit"),
    "model: unit": (put(MODEL, "millimeter", "inch"), "deviation"),
    "model: required extension": (put(MODEL, "<model ", '<model requiredextensions="q" '), "model"),
    "model: no prefix": (put(MODEL, 'xmlns:camgeo="[^"]*"', ""), "model"),
    "metadata: title": (put(MODEL, ">eccentric<", ">other<"), "written again"),
    "metadata: one twice": (put(MODEL, 'name="Application"', 'name="Title"'), "model"),
    "metadata: unknown": (put(MODEL, 'name="Application"', 'name="Program"'), "model"),
    "metadata: no name": (put(MODEL, 'name="Application"', ""), "model"),
    "metadata: scene": (put(MODEL, ">0123", ">0124"), "scene"),
    "metadata: tolerance": (put(MODEL, ">0.01 mm", ">0.02 mm"), "tolerance"),
    "an element": (put(MODEL, "<resources>", "<resources><slice />"), "model"),
    "an attribute": (put(MODEL, "<triangle ", '<triangle p1="0" '), "written again"),
    "object: id 0": (put(MODEL, 'id="1"', 'id="0"'), "file"),
    "object: id": (put(MODEL, 'id="1"', 'id="2"'), "file"),
    "object: type": (put(MODEL, 'type="model"', 'type="modal"'), "model"),
    "object: support": (put(MODEL, 'type="model"', 'type="support"'), "written again"),
    "object: name": (put(MODEL, 'name="eccentric"', 'name="other"'), "written again"),
    "object: twice": (put(MODEL, "(?s)(<object.*</object>)", r"\1\1"), "model"),
    "vertex: NaN": (put(MODEL, 'x="[^"]*"', 'x="nan"'), "file"),
    "vertex: no z": (put(MODEL, ' z="[^"]*"', ""), "file"),
    "vertex: moved": (put(MODEL, 'x="32.0"', 'x="32.1"'), "walls"),
    "triangle: two corners alike": (
        put(MODEL, r'v1="\d+" v2="(\d+)"', r'v1="\1" v2="\1"'), "facets",
    ),
    "triangle: no such corner": (put(MODEL, r'v1="\d+"', 'v1="99999"'), "facets"),
    "triangle: negative": (put(MODEL, r'v1="\d+"', 'v1="-1"'), "facets"),
    "triangle: twice": (put(MODEL, "(<triangle [^>]*>)", r"\1\1"), "closed"),
    "triangle: left out": (put(MODEL, "<triangle [^>]*>", ""), "closed"),
    "build: none": (put(MODEL, "<build>.*</build>", ""), "model"),
    "build: empty": (put(MODEL, "<build>.*</build>", "<build />"), "model"),
    "build: no such object": (put(MODEL, 'objectid="1"', 'objectid="2"'), "file"),
    "build: twice": (put(MODEL, "(<item [^>]*>)", r"\1\1"), "written again"),
    "build: moved": (
        put(MODEL, "<item", '<item transform="1 0 0 0 1 0 0 0 1 5 0 0"'), "deviation",
    ),
    "cut short": (PACKAGE[: len(PACKAGE) // 2], "file"),
}  # fmt: skip
"""Changes to a package, and the check that reports each. lib3mf 2.5, a strict reader, rejects all
that concern the package and the model, or reads a different part."""

HARMLESS_PACKAGES = {
    "the version": put(MODEL, "camgeo 0.0.test", "camgeo 9.9.test"),
    "the language": put(MODEL, '"en"', '"de"'),
    "no unit: millimetres": put(MODEL, ' unit="millimeter"', ""),
    "no type: a model": put(MODEL, ' type="model"', ""),
    "a vertex that no triangle uses": put(
        MODEL, "</vertices>", '<vertex x="0" y="0" z="0" /></vertices>'
    ),
    "another compression": repacked(PACKAGE, lambda _, content: content),
}  # fmt: skip
"""Changes after which every reader finds the same body."""


@pytest.mark.parametrize("kind", PACKAGES)
def test_a_package_that_is_changed(kind: str) -> None:
    data, check = PACKAGES[kind]
    found = {each.name: each.note for each in faults(THREEMF_VERIFIER, PRODUCT, data)}
    assert check in found
    assert found[check] or check in ("scene", "tolerance", "closed")


@pytest.mark.parametrize("kind", HARMLESS_PACKAGES)
def test_a_package_that_is_as_good(kind: str) -> None:
    assert not faults(THREEMF_VERIFIER, PRODUCT, PACKAGE)
    reading = ReadingOptions("file")
    checks = checked(THREEMF_VERIFIER, PRODUCT, HARMLESS_PACKAGES[kind], reading).values()
    assert all(each.ok is not False for each in checks)


@pytest.mark.parametrize(
    ("old", "new"), [("millimeter", "inch"), ('x="32.0"', 'x="32.1"')], ids=["unit", "mesh"]
)
def test_the_model_is_the_one_that_a_package_leads_to(old: str, new: str) -> None:
    """It need not have the usual name, and another one may have that."""
    parts = {path: part.decode() for path, part in unpack_parts(PACKAGE).items()}
    good = parts[MODEL].replace("camgeo 0.0.test", "another program")
    bad = good.replace(old, new, 1)
    assert bad != good
    elsewhere = "3D/other.model"
    parts[RELATIONS] = parts[RELATIONS].replace(MODEL, elsewhere)
    for led_to, other in ((good, bad), (bad, good)):
        changed = parts | {MODEL: other, elsewhere: led_to}
        data = packed({path: part.encode() for path, part in changed.items()})
        assert not THREEMF_VERIFIER.origin(data).version
        reading = ReadingOptions("file")
        checks = checked(THREEMF_VERIFIER, PRODUCT, data, reading).values()
        assert all(each.ok is not False for each in checks) == (led_to == good)


def test_an_item_of_another_part_is_not_taken_for_one_of_the_model() -> None:
    """Both have an object of that number, and programs that know the extension build the other."""
    parts = {path: part.decode() for path, part in unpack_parts(PACKAGE).items()}
    good = parts[MODEL].replace("camgeo 0.0.test", "another program")
    item = f'<item xmlns:p="{PRODUCTION}" p:path="/3D/other.model" '
    other = re.sub("<build>.*</build>", "<build />", good)
    changed = parts | {MODEL: good.replace("<item ", item), "3D/other.model": other}
    data = packed({path: part.encode() for path, part in changed.items()})
    assert not THREEMF_VERIFIER.origin(data).damage
    assert "another part" in checked(THREEMF_VERIFIER, PRODUCT, data)["model", ""].note
