"""Hostile files that consist of text: drawings, programs, contours, tables."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache

from camgeo.reading import DRAWING, DRAWING_LINES
from tests.long_form import examples

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
    }.items()
    for count in ("-5", "1000000000", "nan", "1e308"):
        yield f"{count} vertices", dxf(f"0 LWPOLYLINE 8 0 90 {count} 70 1 10 0 20 0 10 1 20 1")
    yield "flags", dxf("0 POLYLINE 8 0 70 1e300", "0 VERTEX 8 0 10 1 20 1", "0 SEQEND")
    yield "polyline of nothing", dxf("0 POLYLINE 8 0 70 1", "0 SEQEND")
    for what in ("71 1e9", "71 nan", "71 3 72 1000000000", "71 3 40 nan", "71 3 73 -1", "71 0"):
        yield f"spline {what}", dxf(f"0 SPLINE 8 0 {what} 10 0 20 0 10 1 20 1 10 2 20 0 10 3 20 3")
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
    yield "rational spikes", dxf(f"0 SPLINE 8 0 71 3 {wild} {spikes}")
    yield "flat ellipse", dxf("0 ELLIPSE 8 0 10 0 20 0 11 1e9 21 0 40 1e-9 41 0 42 1e-9")
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
    for letter in "GMXYZIJFSTHNPQ":
        yield f"{letter} of 310 digits", program(f"{letter}1{'0' * 310}")
    yield from {
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
