"""What strict readers take of a 3MF package: small ones with one fault each, read by lib3mf too.

The clauses are those of the 3MF core specification 1.3 (github.com/3MFConsortium/spec_core). What
lib3mf accepts although a clause forbids it has a table of its own.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from random import Random
from typing import Final

import lib3mf  # type: ignore[import-untyped]  # it has no types
import pytest

from camgeo_export.verify.threemf import VERIFIER, package_checks, packed, parts_of
from tests.long_form import LONG

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

REFUSED: Final[dict[str, tuple[Edits, str]]] = {
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
    "a component that comes later": (component("2", after=""), "'2', which is no object before it"),
    "no such component": (component("9"), "'9', which does not exist"),
    "an object within itself": (component("3"), "the object 3 contains itself"),
    "eleven numbers": (
        model("<item ", '<item transform="1 0 0 0 1 0 0 0 1 0 0" '), "11 numbers, not 12",
    ),
    "no such object": (model('<item objectid="2"', '<item objectid="5"'), "'5', which"),
    "materials that are built": (model('<item objectid="2"', '<item objectid="1"'), "'1', which"),
    "an object of type other": (model('"model"', '"other"'), "is of type 'other' .*3.4.3.1"),
    "an object of unknown type": (model('"model"', '"form"'), "'form' is not a type of object"),
    "two builds": (model(BUILD, BUILD + BUILD), "one element resources, and after it one .*3.4"),
    "no build": (model(BUILD, ""), "after it one element build"),
    "two resources": (model("<build>", "<resources/><build>"), "not one element resources"),
    "a build that comes before": (
        model(BUILD, "") + model("<resources>", f"{BUILD}<resources>"), "and after it one element",
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
    unit = re.search(rb' unit="([^"]*)"', parts_of(data)[MODEL])
    if unit is not None and unit[1] != b"millimeter":
        return f"{unit[1].decode()!r} is not a unit"  # which is a check of its own
    return "".join(each.note for each in package_checks(parts_of(data))
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


@pytest.mark.parametrize("kind", [*REFUSED, *STRICTER])
def test_what_a_clause_forbids(kind: str) -> None:
    edits, words = (REFUSED | STRICTER)[kind]
    data = edited(edits)
    assert data is not None
    assert re.search(words, said(data))
    assert bool(strict(data)) == (kind in REFUSED)  # else it belongs to the other table


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
            chosen.append(draw.choice(list(REFUSED.values()))[0])
        draw.shuffle(chosen)
        data = edited(tuple(each for edits in chosen for each in edits))
        if data is None:
            continue
        verdict = said(data)
        assert bool(verdict) == bool(strict(data)), (chosen, verdict, strict(data))
        judged[not verdict] += 1
