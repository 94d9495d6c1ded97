"""Hostile files of every format, by name."""

from __future__ import annotations

import io
import json
import re
import struct
import zipfile
from collections.abc import Callable, Iterator
from functools import cache, partial
from typing import Any

import numpy as np

from camgeo.reading import DRAWING, DRAWING_LINES
from camgeo_export.verify.stl import FACET, PREFIX
from camgeo_export.verify.threemf import CONTENT_TYPES_PATH, CORE, MODEL_PATH, RELATIONSHIPS_PATH
from tests.long_form import examples

# Drawings, programs, contours and tables, which consist of text -----------------------------------


Named = Iterator[tuple[str, bytes]]

WRONG_NUMBERS = {
    "310 digits": "1" + "0" * 310,
    "1e308": "1e308",
    "1e400": "1e400",
    "nan": "nan",
    "inf": "-inf",
    "underscore": "1_000",
    "fullwidth": "\uff11\uff12",
    "hexadecimal": "0x10",
    "empty": "",
    "5,000 digits": "9" * 5000,
    "two signs": "--1",
    "NUL": "1\0",
}
"""What is not a number of a file."""


def times(count: int) -> int:
    """How often what takes time to read is repeated: `count` times in the long form."""
    return examples(count // 4, long=count)


def wrong(what: str, make: Callable[[str], bytes]) -> Named:
    """What is made with each of the wrong numbers."""
    for name, number in WRONG_NUMBERS.items():
        yield f"{what} {name}", make(number)


def truncated(good: bytes, *shares: float) -> Named:
    for share in shares:
        yield f"truncated to {share:.1%}", good[: int(share * len(good))]


def damaged(good: bytes) -> Named:
    """What can happen to any text."""
    yield from {
        "empty": b"",
        "one line end": b"\n",
        "NUL bytes": bytes(10_000),
        "high bytes": b"\xff" * 10_000,
        "UTF-16": good.decode("utf-8", "replace").encode("utf-16"),
        "UTF-16 without mark": good.decode("utf-8", "replace").encode("utf-16-be"),
        "upside down": good[::-1],
        "another file": b"%PDF-1.7\n" + bytes(range(256)) * 40,
    }.items()
    yield from large().items()


@cache
def large() -> dict[str, bytes]:
    """Large texts of nothing, made once for all readers."""
    return {
        "40 MB": b"0\n" * 20_000_000,
        "line ends only": b"\n" * 1_600_000,
        "CR only": b"\r" * 1_600_000,
        "one line": b"1" * 15_000_000,
        "quotes and brackets": b'("[{' * 1_000_000,
        "commas": b"," * 8_000_000,
        "blanks": b" " * 15_000_000,
    }


def dxf(*entities: str, unit: str = "4", head: str = "") -> bytes:
    """A drawing; each entity is its groups, parted by blanks."""
    body = "".join("\n".join(each.split(" ")) + "\n" for each in entities)
    header = f"0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n{unit}\n0\nENDSEC\n"
    return f"{header}{head}0\nSECTION\n2\nENTITIES\n{body}0\nENDSEC\n0\nEOF\n".encode()


def line(x: object, y: object, u: object, v: object) -> str:
    return f"0 LINE 8 0 10 {x} 20 {y} 11 {u} 21 {v}"


def drawings(good: bytes, *, any_text: bool = True) -> Named:
    """Of drawings; with what can happen to any text if `any_text`."""
    if any_text:
        yield from damaged(good)
    yield from truncated(good, 0.1, 0.5, 0.9, 0.99)
    yield from {
        "binary": b"AutoCAD Binary DXF\r\n\x1a\x00" + bytes(1000),
        "without EOF": good.replace(b"EOF", b"END"),
        "sections in sections": b"0\nSECTION\n2\nENTITIES\n" * times(100_000) + b"0\nEOF\n",
        "header that ends": b"0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n0\nEOF\n",
    }.items()
    yield from wrong("coordinate", lambda x: dxf(f"0 CIRCLE 8 0 10 {x} 20 0 40 5"))
    yield from wrong("bulge", lambda b: dxf(f"0 LWPOLYLINE 8 0 70 1 10 0 20 0 42 {b} 10 5 20 5"))
    yield from {
        "radius 1e-320": dxf("0 CIRCLE 8 0 10 0 20 0 40 1e-320"),
        "negative radius": dxf("0 CIRCLE 8 0 10 0 20 0 40 -1"),
        "angle of an arc": dxf("0 ARC 8 0 10 0 20 0 40 1 50 1e300 51 2"),
        "unit": dxf("0 CIRCLE 8 0 10 0 20 0 40 1", unit="9" * 400),
        **{
            f"{count} vertices": dxf(f"0 LWPOLYLINE 8 0 90 {count} 70 1 10 0 20 0 10 1 20 1")
            for count in ("-5", "1000000000", "nan", "1e308")
        },
        "flags": dxf("0 POLYLINE 8 0 70 1e300", "0 VERTEX 8 0 10 1 20 1", "0 SEQEND"),
        "polyline of nothing": dxf("0 POLYLINE 8 0 70 1", "0 SEQEND"),
        **{
            f"spline {what}": dxf(f"0 SPLINE 8 0 {what} 10 0 20 0 10 1 20 1 10 2 20 0 10 3 20 3")
            for what in (
                "71 1e9",
                "71 nan",
                "71 3 72 1000000000",
                "71 3 40 nan",
                "71 3 73 -1",
                "71 0",
            )
        },
    }.items()
    knots = " ".join(f"40 {k % 7}" for k in range(times(100_000)))
    yield "spline of unsorted knots", dxf(f"0 SPLINE 8 0 71 3 {knots} 10 0 20 0 10 1 20 1")
    controls = " ".join(f"10 {k % 9} 20 {k % 11}" for k in range(times(100_000)))
    yield (
        "spline of equal knots",
        dxf(f"0 SPLINE 8 0 71 3 {'40 0 ' * (times(100_000) + 4)}{controls}"),
    )
    block = "0\nSECTION\n2\nBLOCKS\n0\nBLOCK\n2\nA\n0\nINSERT\n2\nA\n0\nENDBLK\n0\nENDSEC\n"
    yield "block in itself", dxf("0 INSERT 8 0 2 A 10 0 20 0", head=block)
    blocks = "".join(
        f"0\nBLOCK\n2\nB{k}\n" + f"0\nINSERT\n2\nB{k + 1}\n" * 10 + "0\nENDBLK\n"
        for k in range(1000)
    )
    head = f"0\nSECTION\n2\nBLOCKS\n{blocks}0\nENDSEC\n"
    yield from {
        "blocks that multiply": dxf("0 INSERT 8 0 2 B0 10 0 20 0", head=head),
        "extrusion": dxf("0 CIRCLE 8 0 10 0 20 0 40 1 210 nan"),
        "group code of 5,000 digits": dxf("9" * 5000 + " 1"),
        "fullwidth group code": dxf("\uff10 LINE"),
        "group codes with marks": dxf("1_0 LINE"),
        "text of 10 MB": dxf("0 TEXT 1 " + "x" * 10_000_000),
        "layers": dxf(*(f"0 LINE 8 L{k}" for k in range(times(100_000)))),
        "one line's end": dxf(line(0, 0, 1e-320, 0), line(1e-320, 0, 0, 0)),
        "loose lines": dxf(*(line(k, 0, k, 1) for k in range(100_000))),
        "lines at one place": dxf(*(line(0, 0, 1, k % 3) for k in range(times(100_000)))),
        "far and near lines": dxf(line(1e9, 1e9, 1e-9, 0), line(1e-9, 0, 1e9, 1e9)),
        "circles": dxf(*(f"0 CIRCLE 8 0 10 {k} 20 0 40 1" for k in range(times(20_000)))),
    }.items()
    many = " ".join(f"10 {k % 17} 20 {k % 19}" for k in range(times(350_000)))
    yield "open polyline", dxf(f"0 LWPOLYLINE 8 0 70 0 {many}")
    yield "too many lines", b"0\nSECTION\n" + b"0\n" * DRAWING_LINES
    yield "too many bytes", b"0\nSECTION\n" + bytes(DRAWING.size)
    yield "tags of nothing", b"0\nSECTION\n" + b"0\n\n" * times(1_000_000)
    chain = " ".join(f"0 BLOCK 2 C{k} 10 0 20 0 0 INSERT 8 0 2 C{k + 1} 10 0 20 0 0 ENDBLK"
                     for k in range(times(4_000)))  # fmt: skip
    head = "0\nSECTION\n2\nBLOCKS\n" + "\n".join(chain.split(" ")) + "\n0\nENDSEC\n"
    yield "blocks in blocks in blocks", dxf("0 INSERT 8 0 2 C0 10 0 20 0", head=head)
    grid = "70 30000 71 30000 44 1 45 1"
    head = "0\nSECTION\n2\nBLOCKS\n0\nBLOCK\n2\nG\n0\nENDBLK\n0\nENDSEC\n"
    yield "rows of an empty block", dxf(f"0 INSERT 8 0 2 G 10 0 20 0 {grid}", head=head)
    wild = " ".join(f"40 {k}" for k in range(times(40_000) + 4))
    spikes = " ".join(f"10 {(-1) ** k * 1e9} 20 {k} 41 {1 + k % 2 * 1e9}"
                      for k in range(times(40_000)))  # fmt: skip
    yield from {
        "rational spikes": dxf(f"0 SPLINE 8 0 71 3 {wild} {spikes}"),
        "flat ellipse": dxf("0 ELLIPSE 8 0 10 0 20 0 11 1e9 21 0 40 1e-9 41 0 42 1e-9"),
    }.items()
    fit = " ".join(f"11 {k % 7} 21 {k % 11}" for k in range(times(40_000)))
    yield "spline through points", dxf(f"0 SPLINE 8 0 71 3 {fit}")
    web = (line(k, 0, j, 9) for k in range(150) for j in range(examples(75, long=150)))
    yield "web of lines", dxf(*web)


PROGRAM = "G17 G21 G40 G49 G54 G80 G90 G94\nG91.1\nT1 M6\nG43 H1\nS1000 M3\nG64 P0.001 Q0\nF100\n"


def program(*blocks: str, end: str = "M5\nM2\n") -> bytes:
    return (PROGRAM + "\n".join(blocks) + "\n" + end).encode()


def programs(good: bytes) -> Named:
    yield from damaged(good)
    yield from truncated(good, 0.1, 0.5, 0.99)
    yield from {
        **{
            f"{letter} of 310 digits": program(f"{letter}1{'0' * 310}")
            for letter in "GMXYZIJFSTHNPQ"
        },
        "decimals": program("G1 X0." + "0" * 1_000_000 + "1"),
        "beyond 1e9": program("G1 X10000000000 Y1"),
        "sizes that overflow": program("G0 X999999999", "G1 X-999999999", "G2 I1 J1 X5"),
        "exponent": program("G1 X1E308"),
        "fullwidth": program("G1 X\uff11"),
        "brackets": program("(" * 2_000_000),
        "comment in a comment": program("(" * 500_000 + ")" * 500_000),
        "words": program("X1" * 1_000_000),
        "variables": program("#1=[#1+1]", "O100 CALL", "G1 X[#1/0]"),
        "arc of nothing": program("G1 X0 Y0 Z-1", "G2 X0 Y0 I0 J0"),
        "another end": program("G1 X1 Y1", end="M2\nM5\nM2\n"),
        "no end": program("G1 X1 Y1", end=""),
        "tolerance": b"(camgeo 1.0)\n(tolerance 1e300 mm)\n" + program("G1 X1"),
        "polar": program("G16", "G1 X1"),
        "only a mark": b"%\n" * 100_000,
    }.items()
    within = (f"X{k % 7 * 1e-5:.5f} Y{k % 5 * 1e-5:.5f}" for k in range(times(120_000)))
    yield "moves within the tolerance", program("G0 X0 Y0", "G1 Z-1", *within)
    spiral = (f"X{(k % 2) * 0.01 + k * 1e-7:.7f} Y0" for k in range(times(60_000)))
    yield from {
        "moves to and fro": program("G0 X0 Y0", "G1 Z-1", *spiral),
        "closed paths": program("G0 X0 Y0", "G1 Z-1", *("X1 Y0", "X0 Y0") * times(30_000)),
        "comments": program(*("(operation a)",) * times(150_000)),
        "too many blocks": program(*("G1 X1",) * 200_001),
    }.items()


def contours(good: bytes) -> Named:
    yield from damaged(good)
    yield from wrong("x", lambda x: f"0,0\n{x},1\n1,1\n".encode())
    yield from wrong("bulge", lambda bulge: f"0,0,0\n1,1,{bulge}\n1,0,0\n".encode())
    yield from {
        "no area": b"0,0\n1,1\n2,2\n",
        "1e-320": b"0,0\n1e-320,0\n0,1e-320\n",
        "one place": b"1,1\n" * times(100_000),
        "rows": b"".join(b"%d,%d\n" % (k % 9, k % 11) for k in range(200_001)),
        "rows of three": b"0;0;1\n1;0;1\n1;1;1\n",
        "three columns, then two": b"0,0,0\n1,1\n",
        "too few": b"0,0\n1,0\n",
    }.items()


def tables(good: bytes, *, any_text: bool = True) -> Named:
    """Of tables of two columns; with what can happen to any text if `any_text`."""
    if any_text:
        yield from damaged(good)
        yield "lines", b"0,0\n" * 400_001
        yield "comments", b"#\n" * 399_000 + b"0,0\n"
    yield from wrong("first", lambda x: f"0,0\n{x},1\n360,0\n".encode())
    yield from wrong("second", lambda y: f"0,0\n180,{y}\n360,0\n".encode())
    yield from {
        "columns": b"phi," + b"a," * 2_000_000 + b"lift\n" + b"0,0\n" * 10,
        "blanks in a heading": b"a" + b" " * 1_000_000 + b"b,lift\n0,0\n1,1\n",
        "bracket in a heading": b"phi [" + b" " * 100_000 + b",lift\n0,0\n1,1\n",
        "equal headings": b"phi,phi\n0,0\n360,0\n",
        "descending": b"0,0\n10,1\n5,2\n360,0\n",
        "mixed decimals": b"0;0\n1,5;1.5\n360;0\n",
        "one row": b"0,0\n",
        "huge": b"0,0\n180,1e31\n360,0\n",
    }.items()


def points(good: bytes) -> Named:
    """Of measured points."""
    yield from damaged(good)
    rows = b"1,2\n" * 11
    yield from wrong("x", lambda x: rows + f"{x},1\n".encode())
    yield from wrong("normal", lambda n: b"1,2,1,0\n" * 11 + f"1,1,0,{n}\n".encode())
    yield from {
        "too few": rows,
        "too many": b"".join(b"%d,%d\n" % (k % 9, k % 11) for k in range(50_001)),
        "lines": b"0,0\n" * 400_001,
        "columns": b"x," + b"a," * 2_000_000 + b"y\n" + rows,
        "equal headings": b"x,x\n" + rows,
        "another unit": b"x [furlong],y\n" + rows,
        "two units": b"x [mm],y [inch]\n" + rows + rows,
        "mixed decimals": b"1;2\n" * 11 + b"1,5;2.5\n",
        "normals of no length": b"".join(b"%d,2,0,0\n" % k for k in range(12)),
        "half a normal": b"x,y,nx\n" + b"1,2,1\n" * 12,
        "one place": b"1,1\n" * 50_000,
        "the cam axis": b"0,0\n" * 20,
        "far away": b"1e9,-1e9\n" * 40_000,
        "far away in a row": b"".join(b"1e8,%d\n" % k for k in range(50_000)),
        "beyond 1e9": rows + b"2e9,0\n",
    }.items()


def svg(body: str, head: str = 'width="9mm" height="9mm" viewBox="0 0 9 9"') -> bytes:
    return f'<svg xmlns="http://www.w3.org/2000/svg" {head}>{body}</svg>'.encode()


def vectors(good: bytes) -> Named:
    """Of SVG drawings."""
    yield from damaged(good)
    yield from truncated(good, 0.1, 0.5, 0.9, 0.99)
    laughs = "".join(f'<!ENTITY a{k} "{f"&a{k - 1};" * 10 if k else "lol"}">' for k in range(10))
    yield from {
        "a billion laughs": f"<!DOCTYPE svg [{laughs}]><svg>&a9;</svg>".encode(),
        "an entity of a file": b'<!DOCTYPE s [<!ENTITY a SYSTEM "file:///etc/passwd">]><s>&a;</s>',
        "document types": b"<!DOCTYPE svg " * times(100_000),
        "UTF-16 stated": good.replace(b'"UTF-8"', b'"UTF-16"'),
        "deep groups": svg("<g>" * times(9_000) + "</g>" * times(9_000)),
        "groups without end": b"<g>" * times(1_000_000),
        "many elements": svg('<circle r="1"/>' * times(400_000)),
        "many circles": svg('<circle r="1"/>' * 9_000),
        "many attributes": svg("<g " + " ".join(f'a{k}="1"' for k in range(300_000)) + "/>"),
        "a long attribute": svg(f'<g id="{"a" * 8_000_000}"><circle r="1"/></g>'),
        "many pieces": svg(f'<path d="M0 0{"H1V2" * times(600_000)}Z"/>'),
        "many subpaths": svg(f'<path d="{"M0 0H1V1Z" * times(400_000)}"/>'),
        "many letters": svg(f'<path d="{"Z" * times(8_000_000)}"/>'),
        "many corners": svg(f'<polygon points="{"1,2 " * times(2_000_000)}"/>'),
        "a long number": svg(f'<path d="M0 0L{"9" * 8_000_000} 0 1 1Z"/>'),
        "points and signs": svg(f'<path d="M0 0L{"-.+" * 2_000_000}Z"/>'),
    }.items()
    circle, size = '<circle r="1"/>', 'width="1mm" height="1mm"'
    yield from wrong("coordinate", lambda x: svg(f'<path d="M{x} 0 L 5 5 0 7Z"/>'))
    yield from wrong("radius", lambda radius: svg(f'<circle r="{radius}"/>'))
    yield from wrong("width", lambda width: svg(circle, f'width="{width}mm" height="1mm"'))
    yield from wrong("box", lambda width: svg(circle, f'{size} viewBox="0 0 {width} 1"'))
    yield from {
        "radius 1e-320": svg('<circle r="1e-320"/>'),
        "arc of radius 1e-320": svg('<path d="M0 0A1e-320 1e-320 0 0 0 1 1Z"/>'),
        "arc that ends at its start": svg('<path d="M1 1A1 1 0 0 0 1 1Z"/>'),
        "transformation": svg('<circle r="1" transform="scale(1e300)"/>'),
        "use of itself": svg('<g id="a"><use href="#a"/></g>'),
    }.items()


# Bodies, packages, scenes, profiles, certificates and projects ------------------------------------


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
        **{
            f"coordinates {fill}": facets(100, fill=fill)
            for fill in (float("nan"), float("inf"), 3e38, 1e-44)
        },
    }.items()
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
        **{
            f"compression {method}": patched(plain, 10, struct.pack("<H", method))
            for method in (1, 9, 12, 14, 93, 97, 255)
        },
        "count of parts": plain[:-14] + b"\xff\xff\xff\xff" + plain[-10:],
        "place of the directory": plain[:-6] + b"\xff\xff\xff\x7f" + plain[-2:],
        "many parts": package(more=tuple((f"p{k}", b"") for k in range(5_000))),
        **{
            f"name {name}": package(more=((name, b"x"),))
            for name in ("../../etc/passwd", "/etc/passwd", "a\\..\\b", "3D/../../x")
        },
        "a part twice": package(more=((MODEL_PATH.upper(), model()),)),
        "billion laughs": package(
            model(head=entities(), top="<metadata name='Title'>&e9;</metadata>")
        ),
    }.items()
    late = " " * 2000 + entities()
    yield "late entities", package(model(head=late, top="<metadata name='Title'>&e9;</metadata>"))
    outside = '<!DOCTYPE a [<!ENTITY x SYSTEM "file:///etc/passwd">]>'
    yield from {
        "external entity": package(
            model(head=outside, top="<metadata name='Title'>&x;</metadata>")
        ),
        "entities in relationships": package(relations=entities() + RELATIONS),
        "entities in types": package(types=entities() + TYPES),
        **{
            f"encoding {encoding[:8]}": package(
                model(head=f'<?xml version="1.0" encoding="{encoding}"?>')
            )
            for encoding in ("UTF-9", "UTF-16", "cp1252", "utf-7", "x" * 5000)
        },
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
    yield from {
        **{
            f"block {braces}": text.replace("{unit}", braces).encode()
            for braces in (
                "{unit:99999999999}",
                "{unit.__class__}",
                "{0}",
                "{unit!r}",
                "{",
                "{unit[0]}",
            )
        },
        **{
            f"decimals {value[:9]}": text.replace("mm = 4", f"mm = {value}").encode()
            for value in ("nan", "-1", "1e308", "9" * 400, "true", "'4'")
        },
    }.items()
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
        **{
            f"tolerance {value.decode()}": good.replace(b"0.01", value)
            for value in (
                b"NaN",
                b"Infinity",
                b"-1",
                b"0",
                b"1e400",
                b'"0.01"',
                b"null",
                b"[]",
                b"true1",
            )
        },
    }.items()
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


# STEP files: syntax, references, geometry and topology --------------------------------------------


HEAD = "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(('a'),'2;1');\nENDSEC;\nDATA;\n"
TAIL = "ENDSEC;\nEND-ISO-10303-21;\n"


def step(*lines: str, head: str = HEAD) -> bytes:
    """A file of these instances."""
    return "\n".join((head, *lines, TAIL)).encode()


def solids(good: bytes) -> Named:
    """Of STEP files."""
    yield from damaged(good)
    for name, cut in truncated(good, 0.1, 0.5, 0.9, 0.999):
        yield name, cut
        yield f"{name} with an end", cut + b"\n" + TAIL.encode()
    yield from _syntax()
    yield from _graph(good)
    yield from _geometry(good)


def _syntax() -> Named:
    many = times(480_000)
    yield from {
        "nothing": step(),
        "no header": step(head="ISO-10303-21;DATA;"),
        "header alone": b"ISO-10303-21;HEADER;" + b"A();" * many + TAIL.encode(),
        "brackets": step("#1=A(" + "(" * many + ");"),
        "empty lists": step("#1=A(" + "()," * (many // 2) + "());"),
        "typed in typed": step("#1=A(" + "B(" * many + ")" * many + ");"),
        "commas alone": step("#1=A(" + "," * many + ");"),
        "values": step("#1=A(" + "1," * many + "1);"),
        "references": step("#1=A(" + "#1," * many + "#1);"),
        "too many brackets": step("(" * 600_000),
        "types of one instance": step("#1=(" + "A()" * many + ");"),
        "instances": step(*(f"#{k}=A();" for k in range(1, times(120_000)))),
        "too many instances": step(*(f"#{k}=A();" for k in range(1, 120_000))),
        "the same instance": step(*["#1=A();"] * 1000),
        "number of an instance": step(f"#{'9' * 5000}=A();"),
    }.items()
    yield from wrong("number", lambda x: step(f"#1=CARTESIAN_POINT('',({x}.,0.,0.));"))
    yield from {
        "string without end": step("#1=A('" + "x" * 7_000_000),
        "quotes in a string": step("#1=A('" + "''" * 3_000_000 + ");"),
        "comment without end": step("/*" + "*" * 7_000_000),
        "comments": step("/**/" * 1_700_000),
        "comments that begin": step("/*/" * 2_000_000),
        **{
            f"string {text}": step(f"#1=A('{text}');")
            for text in (
                r"\X2\D800\X0\ ",
                r"\X4\FFFFFFFF\X0\ ",
                r"\X2\00",
                "\\",
                r"\S",
                r"\X2\\X0\ ",
            )
        },
        "directives": step("#1=A('" + r"\X2\0041\X0\ " * 500_000 + "\\');"),
        "binary": step('#1=A("' + "F" * 7_000_000),
        "enumeration": step("#1=A(." + "A" * 7_000_000),
        "digits": step("#1=A(" + "1" * 7_000_000 + ");"),
    }.items()


def _graph(good: bytes) -> Named:
    text = good.decode()
    yield from {
        "two solids": step(*["#1=MANIFOLD_SOLID_BREP('',#1);", "#2=MANIFOLD_SOLID_BREP('',#1);"]),
        "solid in itself": step("#1=MANIFOLD_SOLID_BREP('',#1);"),
    }.items()
    for kind in ("CLOSED_SHELL", "EDGE_LOOP", "FACE_OUTER_BOUND", "VERTEX_POINT", "EDGE_CURVE"):
        number = re.search(rf"#(\d+)={kind}\(", text)
        assert number is not None
        own = re.sub(rf"(#{number[1]}={kind}\(.*?)#\d+", rf"\g<1>#{number[1]}", text, count=1)
        yield from {
            f"{kind} that refers to itself": own.encode(),
            f"{kind} of nothing": re.sub(rf"({kind}\('',\(?)#\d+", r"\1#9999999", text).encode(),
            f"{kind} without values": re.sub(rf"{kind}\(.*\);", f"{kind}();", text).encode(),
        }.items()
    unit = re.search(r"#(\d+)=\(LENGTH_UNIT", text)
    assert unit is not None
    loop = (
        f"#{unit[1]}=(CONVERSION_BASED_UNIT('A',#99999)LENGTH_UNIT()NAMED_UNIT(*));\n"
        f"#99999=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(2.),#{unit[1]});\n"
    )
    yield "units in each other", re.sub(r"#\d+=\(LENGTH_UNIT.*\n", loop, text).encode()
    for size in ("0.", "-1.", "1.E-300", "1.E9"):
        other = loop.replace("2.", size).replace(f"),#{unit[1]});", "),#99998);")
        other += "#99998=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.));\n"
        yield f"unit of {size}", re.sub(r"#\d+=\(LENGTH_UNIT.*\n", other, text).encode()
    yield from {
        "metres": good.replace(b".MILLI.", b"$"),
        "another prefix": good.replace(b".MILLI.", b".EXA."),
        "assembly": good.replace(b"DATA;", b"DATA;\n#99999=MAPPED_ITEM('',#1,#1);"),
    }.items()
    shell = re.search(r"CLOSED_SHELL\('',\((#\d+)", text)
    assert shell is not None
    often = f"{shell[1]}," * times(400_000)
    yield from {
        "a face many times": text.replace(f"('',({shell[1]}", f"('',({often}{shell[1]}").encode(),
        "face without bounds": re.sub(r"(ADVANCED_FACE\('.*?',)\(.*?\)", r"\1()", text).encode(),
        "loop without edges": re.sub(r"(EDGE_LOOP\('',)\(.*?\)", r"\1()", text).encode(),
        "no faces": re.sub(r"(CLOSED_SHELL\('',)\(.*?\)", r"\1()", text).encode(),
    }.items()


def _geometry(good: bytes) -> Named:
    text = good.decode()
    for name, number in {
        "0": "0.", "huge": "1.E9", "too large": "1.E10", "denormal": "1.E-320", "negative": "-5.",
    }.items():  # fmt: skip
        radius = re.sub(r"(=CIRCLE\('',#\d+,).*\);", rf"\g<1>{number});", text)
        yield f"radius {name}", radius.encode()
        yield f"all x {name}", re.sub(r"(POINT\('',\()[^,]*", rf"\g<1>{number}", text).encode()
        way = re.sub(r"(=DIRECTION\('',\().*\)\);", rf"\g<1>{number},{number},0.));", text)
        yield f"directions {name}", way.encode()
    yield from {
        "points of two coordinates": re.sub(
            r"(POINT\('',\([^,]*,[^,]*),[^)]*", r"\1", text
        ).encode(),
        "points of text": re.sub(r"(POINT\('',)\(.*\)\);", r"\1'a');", text).encode(),
    }.items()
    controls = ",".join(["#15"] * times(200_000))
    curves = {
        "degree": "'',1000000000,(#15,#15,#15,#15),.U.,.F.,.F.,(4,4),(0.,1.),.U.",
        "multiplicity": "'',3,(#15,#15,#15,#15),.U.,.F.,.F.,(1000000000,4),(0.,1.),.U.",
        "negative multiplicity": "'',3,(#15,#15,#15,#15),.U.,.F.,.F.,(-4,4),(0.,1.),.U.",
        "fractions": "'',3.5,(#15,#15,#15,#15),.U.,.F.,.F.,(4.5,4),(0.,1.),.U.",
        "equal knots": "'',3,(#15,#15,#15,#15),.U.,.F.,.F.,(4,4),(1.,1.),.U.",
        "falling knots": "'',3,(#15,#15,#15,#15),.U.,.F.,.F.,(4,4),(1.,0.),.U.",
        "no controls": "'',3,(),.U.,.F.,.F.,(4,4),(0.,1.),.U.",
        "one control": "'',3,(#15,#15,#15,#15),.U.,.F.,.F.,(4,4),(0.,1.),.U.",
        "many controls": f"'',3,({controls}),.U.,.F.,.F.,(4,4),(0.,1.),.U.",
    }
    for name, values in curves.items():
        spline = re.sub(r"=CIRCLE\(.*\);", f"=B_SPLINE_CURVE_WITH_KNOTS({values});", text, count=1)
        yield f"spline, {name}", spline.encode()
    yield from {
        **{
            f"{kind} of another type": text.replace(f"={kind}(", "=OTHER(").encode()
            for kind in ("PLANE", "CYLINDRICAL_SURFACE", "CIRCLE", "LINE", "EDGE_LOOP")
        },
        "all senses turned": text.replace(".T.", ".F.").encode(),
    }.items()
