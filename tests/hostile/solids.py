"""Hostile STEP files: syntax, references, geometry and topology."""

from __future__ import annotations

import re

from tests.hostile.texts import Named, damaged, times, truncated, wrong

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
    }.items()
    for text in (r"\X2\D800\X0\ ", r"\X4\FFFFFFFF\X0\ ", r"\X2\00", "\\", r"\S", r"\X2\\X0\ "):
        yield f"string {text}", step(f"#1=A('{text}');")
    yield from {
        "directives": step("#1=A('" + r"\X2\0041\X0\ " * 500_000 + "\\');"),
        "binary": step('#1=A("' + "F" * 7_000_000),
        "enumeration": step("#1=A(." + "A" * 7_000_000),
        "digits": step("#1=A(" + "1" * 7_000_000 + ");"),
    }.items()


def _graph(good: bytes) -> Named:
    text = good.decode()
    yield "two solids", step(*["#1=MANIFOLD_SOLID_BREP('',#1);", "#2=MANIFOLD_SOLID_BREP('',#1);"])
    yield "solid in itself", step("#1=MANIFOLD_SOLID_BREP('',#1);")
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
    yield (
        "points of two coordinates",
        re.sub(r"(POINT\('',\([^,]*,[^,]*),[^)]*", r"\1", text).encode(),
    )
    yield "points of text", re.sub(r"(POINT\('',)\(.*\)\);", r"\1'a');", text).encode()
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
    for kind in ("PLANE", "CYLINDRICAL_SURFACE", "CIRCLE", "LINE", "EDGE_LOOP"):
        yield f"{kind} of another type", text.replace(f"={kind}(", "=OTHER(").encode()
    yield "all senses turned", text.replace(".T.", ".F.").encode()
