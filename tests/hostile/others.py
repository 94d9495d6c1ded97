"""Hostile bodies, packages, scenes, profiles, certificates and projects."""

from __future__ import annotations

import io
import json
import struct
import zipfile
from functools import partial
from typing import Any

import numpy as np

from camgeo_export.verify.stl import FACET, PREFIX
from camgeo_export.verify.threemf import (
    CONTENT_TYPES_PATH,
    CORE,
    MODEL_PATH,
    RELATIONSHIPS_PATH,
)
from tests.hostile.texts import Named, damaged, times, truncated, wrong


def facets(count: int, *, stated: int | None = None, fill: Any = 0.0) -> bytes:
    """A binary STL of `count` facets with normals upwards, all corners `fill`."""
    rows = np.zeros(count, dtype=FACET)
    rows["corners"] = fill
    rows["normal"] = [0.0, 0.0, 1.0]
    number = count if stated is None else stated
    return bytes(PREFIX - 4) + struct.pack("<I", number) + rows.tobytes()


def text_stl(*corners: str, normal: str = "0 0 1") -> bytes:
    body = "".join(f"vertex {each}\n" for each in corners)
    return (
        f"solid a\nfacet normal {normal}\nouter loop\n{body}endloop\nendfacet\nendsolid\n".encode()
    )


def bodies(good: bytes) -> Named:
    yield from damaged(good)
    yield from truncated(good, 0.001, 0.1, 0.5, 0.99)
    yield from {
        "count that lies": facets(1, stated=2**32 - 1),
        "no facet": facets(0),
        "facets of no size": facets(200_000),
        "too many facets": facets(500_000),
    }.items()
    for fill in (float("nan"), float("inf"), 3e38, 1e-44):
        yield f"coordinates {fill}", facets(100, fill=fill)
    data = np.frombuffer(good, FACET, offset=PREFIX).copy()
    for name, value in (("NaN", np.nan), ("infinite", np.inf), ("huge", 3e38)):
        changed = data.copy()
        changed["normal"][5] = value
        yield f"normal {name}", good[:PREFIX] + changed.tobytes()
        foreign = b"another program".ljust(80) + good[80:PREFIX]
        yield f"foreign normal {name}", foreign + changed.tobytes()
    signalling = good[: PREFIX + 12] + b"\x01\x00\xa0\x7f" + good[PREFIX + 16 :]
    yield "signalling NaN", signalling  # found by mutation
    data["normal"] *= -1.0
    yield "flipped normals", b"another program".ljust(80) + good[80:PREFIX] + data.tobytes()
    corners = np.random.default_rng(1).normal(size=(times(100_000), 3, 3))
    yield "random facets", facets(len(corners), fill=corners)
    yield from wrong("text", lambda x: text_stl(f"{x} 0 0", "1 0 0", "0 1 0"))
    yield from wrong(
        "text normal", lambda z: text_stl("0 0 0", "1 0 0", "0 1 0", normal=f"0 0 {z}")
    )
    yield from {
        "text of two corners": text_stl("0 0 0", "1 0 0"),
        "text of many words": text_stl("0 " * 1_000_000, "1 0 0", "0 1 0"),
        "text of many corners": text_stl(*("0 0 0",) * 600_003),
        "text that is cut": text_stl("0 0 0", "1 0 0", "0 1 0")[:-9],
        "text at its limit": b"solid a\n" + text_stl("0 0 0", "9 0 0", "0 9 0")[8:-9] * 150_000,
    }.items()


# Packages -----------------------------------------------------------------------------------------

TYPES = """<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
</Types>"""

RELATIONS = f"""<Relationships
xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="r"
Target="/{MODEL_PATH}" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
</Relationships>"""

TETRAHEDRON = (
    '<mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="9" y="0" z="0"/>'
    '<vertex x="0" y="9" z="0"/><vertex x="0" y="0" z="9"/></vertices><triangles>'
    '<triangle v1="0" v2="2" v3="1"/><triangle v1="0" v2="1" v3="3"/>'
    '<triangle v1="1" v2="2" v3="3"/><triangle v1="2" v2="0" v3="3"/></triangles></mesh>'
)


def thing(inside: str = TETRAHEDRON, number: object = 1) -> str:
    return f'<object id="{number}" type="model">{inside}</object>'


def model(
    objects: str = "", *, build: str = '<item objectid="1"/>', head: str = "", top: str = ""
) -> bytes:
    return (
        f'{head}<model unit="millimeter" xml:lang="en" xmlns="{CORE}">{top}'
        f"<resources>{objects or thing()}</resources><build>{build}</build></model>"
    ).encode()


def package(
    content: bytes | None = None,
    *,
    more: tuple[tuple[str, bytes], ...] = (),
    method: int = zipfile.ZIP_DEFLATED,
    types: str = TYPES,
    relations: str = RELATIONS,
) -> bytes:
    """A package with a model."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", method) as file:
        file.writestr(CONTENT_TYPES_PATH, types)
        file.writestr(RELATIONSHIPS_PATH, relations)
        file.writestr(MODEL_PATH, model() if content is None else content)
        for name, data in more:
            file.writestr(zipfile.ZipInfo(name), data)
    return stream.getvalue()


def patched(data: bytes, place: int, value: bytes, *, entry: int = 2) -> bytes:
    """A package with other bytes at a place of the directory's entry of that number."""
    start = -1
    for _ in range(entry + 1):
        start = data.index(b"PK\x01\x02", start + 1)
    return data[: start + place] + value + data[start + place + len(value) :]


def component(number: object, transform: str = "") -> str:
    more = f' transform="{transform}"' if transform else ""
    return f'<component objectid="{number}"{more}/>'


def with_number(place: str, number: str) -> bytes:
    """A package whose attribute at a place has another number."""
    name = place.partition("=")[0]
    return package(model(thing(TETRAHEDRON.replace(place, f'{name}="{number}"'))))


def holding(*inside: str) -> str:
    return f"<components>{''.join(inside)}</components>"


def entities() -> str:
    """The billion laughs."""
    lines = ['<!DOCTYPE a [<!ENTITY e0 "ha">']
    lines += [f'<!ENTITY e{k} "{f"&e{k - 1};" * 10}">' for k in range(1, 10)]
    return "".join(lines) + "]>"


def packages(good: bytes) -> Named:
    yield from damaged(good)
    yield from truncated(good, 0.1, 0.5, 0.9, 0.999)
    yield "zip bomb", package(model(top=f"<metadata name='Title'>{' ' * 60_000_000}</metadata>"))
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as file:
        for k in range(9):
            file.writestr(f"a{k}", bytes(10_000_000))
    yield "parts of zeros", stream.getvalue()
    plain = package()
    yield from {
        "size that lies": patched(package(model(head=" " * 50_000_000)), 24, b"\x10\0\0\0"),
        "size that lies upwards": patched(plain, 24, b"\xff\xff\xff\x0f"),
        "packed size that lies": patched(plain, 20, b"\xff\xff\xff\x0f"),
        "checksum": patched(plain, 16, b"\0\1\2\3"),
        "place of a part": patched(plain, 42, b"\xff\xff\xff\x7f"),
        "encrypted": patched(plain, 8, b"\x01\0"),
    }.items()
    for method in (1, 9, 12, 14, 93, 97, 255):
        yield f"compression {method}", patched(plain, 10, struct.pack("<H", method))
    yield from {
        "count of parts": plain[:-14] + b"\xff\xff\xff\xff" + plain[-10:],
        "place of the directory": plain[:-6] + b"\xff\xff\xff\x7f" + plain[-2:],
        "many parts": package(more=tuple((f"p{k}", b"") for k in range(5_000))),
    }.items()
    for name in ("../../etc/passwd", "/etc/passwd", "a\\..\\b", "3D/../../x"):
        yield f"name {name}", package(more=((name, b"x"),))
    yield "a part twice", package(more=((MODEL_PATH.upper(), model()),))
    yield (
        "billion laughs",
        package(model(head=entities(), top="<metadata name='Title'>&e9;</metadata>")),
    )
    late = " " * 2000 + entities()
    yield "late entities", package(model(head=late, top="<metadata name='Title'>&e9;</metadata>"))
    outside = '<!DOCTYPE a [<!ENTITY x SYSTEM "file:///etc/passwd">]>'
    yield from {
        "external entity": package(
            model(head=outside, top="<metadata name='Title'>&x;</metadata>")
        ),
        "entities in relationships": package(relations=entities() + RELATIONS),
        "entities in types": package(types=entities() + TYPES),
    }.items()
    for encoding in ("UTF-9", "UTF-16", "cp1252", "utf-7", "x" * 5000):
        yield (
            f"encoding {encoding[:8]}",
            package(model(head=f'<?xml version="1.0" encoding="{encoding}"?>')),
        )
    yield from {
        "model in UTF-16": package(model().decode().encode("utf-16")),
        "NUL": package(model(top="\0")),
        "no XML": package(b"<model"),
        "deep": package(b"<a>" * 300_000),
        "elements": package(b"<model>" + b"<a/>" * 800_000 + b"</model>"),
    }.items()
    attributes = " ".join(f'a{k}="1"' for k in range(900_000))
    yield from {
        "attributes": package(model(build=f"<item {attributes}/>"), method=zipfile.ZIP_STORED),
        "relationships that refer to themselves": package(
            relations=RELATIONS.replace(f"/{MODEL_PATH}", f"/{RELATIONSHIPS_PATH}")
        ),
        "two models": package(relations=RELATIONS.replace("</Rel", "</Rel") * 2),
        "model elsewhere": package(relations=RELATIONS.replace(MODEL_PATH, "../x.model")),
        "no relationships": package(relations="<a/>"),
        "no model": package(b""),
    }.items()
    for what, place in (("vertex", 'x="9"'), ("corner", 'v1="2"')):
        yield from wrong(what, partial(with_number, place))
    yield from {
        "corner -1": package(model(thing(TETRAHEDRON.replace('v1="2"', 'v1="-1"')))),
        "no coordinate": package(model(thing(TETRAHEDRON.replace(' x="9"', "")))),
        "object in itself": package(model(thing(holding(component(1))))),
    }.items()
    cycle = thing(holding(component(2))) + thing(holding(component(1)), 2)
    yield "objects in each other", package(model(cycle))
    double = "".join(thing(holding(component(k + 1), component(k + 1)), k) for k in range(1, 60))
    yield "components that multiply", package(model(double + thing(number=60)))
    chain = "".join(thing(holding(component(k + 1)), k) for k in range(1, 20_000))
    yield "chain of components", package(model(chain + thing(number=20_000)))
    far = "1e9 0 0 0 1e9 0 0 0 1e9 1e9 1e9 1e9"
    long = "".join(thing(holding(component(k + 1, far)), k) for k in range(1, 60))
    yield "transforms that multiply", package(model(long + thing(number=60)))
    for transform in ("nan " * 12, "1 0", "1e308 " * 12, "a b c"):
        whole = f'<item objectid="1" transform="{transform.strip()}"/>'
        yield f"transform {transform[:6]}", package(model(build=whole))
    yield from {
        "items": package(model(build='<item objectid="1"/>' * 100_000)),
        "component of nothing": package(model(thing(holding(component(7))))),
        "item of nothing": package(model(build='<item objectid="x"/>')),
        "unit": package(model().replace(b"millimeter", b"parsec")),
    }.items()
    vertices = '<vertex x="1" y="2" z="3"/>' * 100_000
    triangles = '<triangle v1="0" v2="1" v3="2"/>' * 200_000
    mesh = f"<mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh>"
    yield "mesh at its limit", package(model(thing(mesh)), method=zipfile.ZIP_STORED)


# Text with structure ------------------------------------------------------------------------------


def toml(good: bytes) -> Named:
    """Of any TOML, scene or profile."""
    yield from damaged(good)
    yield from {
        "dotted key": b"a" + b".a" * 30_000 + b" = 1",
        "dotted key with blanks": b"a" + b" . a" * 30_000 + b" = 1",
        "quoted dotted key": b'"a"' + b'."a"' * 30_000 + b" = 1",
        "dotted header": b"[a" + b".a" * 30_000 + b"]",
        "dotted header of an array": b"[[a" + b".a" * 30_000 + b"]]\nb = 1",
        "dotted key in a table": good + b"\nx = {a" + b".a" * 30_000 + b" = 1}",
        "many dotted keys": b"".join(b"k%d" % k + b".a" * 15 + b" = 1\n" for k in range(30_000)),
        "many keys": b"".join(b"k%d.a=1\n" % k for k in range(100_000)),
        "arrays": b"x = " + b"[" * 100_000,
        "empty arrays": b"x = [" + b"[]," * 250_000 + b"]",
        "tables in tables": b"x = " + b"{a=" * 50_000,
        "array of tables": b"[[a]]\n" * 100_000,
        "numbers": b"x = [" + b"1," * times(299_000) + b"]",
        "integer of 5,000 digits": b"x = " + b"9" * 5000,
        "integer of 300,000 digits": b"x = " + b"9" * 300_000,
        "hexadecimal digits": b"x = 0x" + b"f" * 1_000_000,
        "exponent": b"x = 1e" + b"9" * 100,
        "decimals": b"x = 0." + b"1" * 1_000_000,
        "quotes": b'"""' * 600_001,
        "escaped quotes": b'x = "' + b'\\"' * times(900_000),
        "backslashes": b'x = """' + b"\\" * times(1_900_000),
        "literal quotes": b"x = '''" + b"''x" * 600_000,
        "control characters": b"x = '\x1b[2J'",
        "lone surrogate": b'x = "\\ud800"',
        "mark of byte order": b"\xef\xbb\xbf" + good[:40],
        "the same key": b"a = 1\n" * 50_000,
        "comment of 2 MB": b"#" * 1_999_999,
    }.items()


def scenes(good: bytes) -> Named:
    yield from toml(good)
    text = good.decode()
    for value in ("nan", "inf", "1e400", "-1e308", "5e-324", "9" * 400, "1979-05-27", "[1]", "'x'"):
        yield (
            f"base radius {value[:9]}",
            text.replace("base_radius = ", f"base_radius = {value} #", 1).encode(),
        )
    yield "2 MB", good + b"#" * 2_000_000
    yield "segments", good + b'\n[[motion]]\nlaw = "modified-sine"\nspan = 1\nto = 0\n' * 20_000
    points = "{ at = 1, to = 1 }," * times(20_000)
    segment = f'\n[[motion]]\nlaw = "points"\nspan = 1\nto = 1\npoints = [{points}]\n'
    yield "many points", good + segment.encode()
    yield "formats", text.replace("formats = [", "formats = [" + '"x",' * times(50_000)).encode()


def profiles(good: bytes) -> Named:
    yield from toml(good)
    text = good.decode()
    for braces in ("{unit:99999999999}", "{unit.__class__}", "{0}", "{unit!r}", "{", "{unit[0]}"):
        yield f"block {braces}", text.replace("{unit}", braces).encode()
    for value in ("nan", "-1", "1e308", "9" * 400, "true", "'4'"):
        yield f"decimals {value[:9]}", text.replace("mm = 4", f"mm = {value}").encode()
    yield "unknown key", f"{'x' * 100_000} = 1\n{text}".encode()
    yield "not UTF-8", good + b"\xff"


def certificates(good: bytes) -> Named:
    # The standard allows JSON in UTF-16.
    yield from (each for each in damaged(good) if not each[0].startswith("UTF-16"))
    yield from truncated(good, 0.1, 0.5, 0.99)
    yield from {
        "lists": b"[" * 100_000,
        "closed lists": b"[" * 100_000 + b"]" * 100_000,
        "tables": b'{"a":' * 100_000,
        "empty lists": b"[" + b"[]," * times(600_000) + b"[]]",
        "too many bytes": b" " * 2_000_001,
        "integer of 5,000 digits": good.replace(b"0.01", b"9" * 5000),
    }.items()
    for value in (b"NaN", b"Infinity", b"-1", b"0", b"1e400", b'"0.01"', b"null", b"[]", b"true1"):
        yield f"tolerance {value.decode()}", good.replace(b"0.01", value)
    for name in ("a\0b", "\ud800", "\x1b[2J", ["a"], None, {"a": 1}):
        document = json.loads(good)
        document["files"][0]["file"] = name
        yield f"name {name!r}", json.dumps(document).encode()
    for hashed in ("", "x" * 64, 5, None, "0" * 100_000):
        document = json.loads(good)
        document["files"][0]["sha256"] = hashed
        yield f"hash {str(hashed)[:9]!r}", json.dumps(document).encode()
    for text in (b"null", b"5", b'"x"', b"[]", b"{}", b'{"scene": 1, "files": 2}'):
        yield f"document {text.decode()}", text


def projects(good: bytes) -> Named:
    yield from damaged(good)
    yield from {
        "one byte less": good[:-1],
        "one byte more": good + b"\0",
        "other byte order": b"".join(good[k : k + 8][::-1] for k in range(0, len(good), 8)),
    }.items()
    for value in (float("nan"), float("inf"), 1e308, -1e308, 5e-324):
        for place in (1, 5, 9, 16):
            number = struct.pack("<d", value)
            yield f"number {place} {value}", good[: 8 * place] + number + good[8 * place + 8 :]
