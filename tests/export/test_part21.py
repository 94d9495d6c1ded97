"""STEP files as any program may write them: their text, the same solid otherwise said, faults.

A file of ours is rewritten: its edges run the other way, its axes point down, its lines are splines
of degree 1, its units are stated by others. What is measured stays what it was.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

import camgeo_export
from camgeo.design.product import Product
from camgeo.errors import FileError
from camgeo.reading import COORDINATE
from camgeo.scene.formats.step import StepSpec
from camgeo_export.part21 import Model, Record, Solid, read_exchange
from camgeo_export.part21 import Ref as ReadRef
from camgeo_export.part21 import Word as ReadWord
from camgeo_export.step.writer import (
    DERIVED,
    NONE,
    WRITER,
    Entities,
    Ref,
    Typed,
    flag,
    parameter_text,
    real,
)
from tests.export.test_dxf import SPLINES
from tests.export.test_step import product
from tests.export.verified import TOLERANCE, VERIFIERS, checked

HEAD = "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('X'));\nENDSEC;\nDATA;\n"
TAIL = "ENDSEC;\nEND-ISO-10303-21;\n"


def read(*lines: str) -> dict[int, tuple[Record, ...]]:
    return read_exchange("\n".join((HEAD, *lines, TAIL)).encode()).instances


@given(st.text(st.characters(exclude_categories=["Cs"]), max_size=40))
def test_any_text_makes_the_round_trip(text: str) -> None:
    line = f"#1=A({parameter_text(text)});"
    assert line.isascii()
    assert read(line)[1][0].values == (text,)


@given(st.floats(-COORDINATE, COORDINATE))
def test_any_number_makes_the_round_trip(number: float) -> None:
    text = real(number)
    assert "." in text.partition("E")[0]
    (found,) = read(f"#1=A({text});")[1][0].values
    assert isinstance(found, float)
    assert found == number


def test_values_of_every_kind() -> None:
    file = Entities()
    first = file.add("POINT", "it's", (0.0, -0.0, 1e-7))
    assert file.shared("UNIT", 3) == file.shared("UNIT", 3) == 2
    file.complex(("A", (DERIVED,)), ("B", ()))
    file.add("C", first, (first, Ref(2)), NONE, flag(True), Typed("LENGTH_MEASURE", 25.4), ())
    assert file.lines == [
        "#1=POINT('it''s',(0.,0.,1.E-7));",
        "#2=UNIT(3);",
        "#3=(A(*)B());",
        "#4=C(#1,(#1,#2),$,.T.,LENGTH_MEASURE(25.4),());",
    ]
    found = read(*file.lines)
    assert found[1] == (Record("POINT", ("it's", (0.0, 0.0, 1e-7))),)
    assert found[3] == (Record("A", (ReadWord("*"),)), Record("B", ()))
    measure = Record("LENGTH_MEASURE", (25.4,))
    ref = ReadRef(1)
    assert found[4] == (Record("C", (ref, (ref, ReadRef(2)), None, ReadWord("T"), measure, ())),)


def test_what_other_programs_write_is_read() -> None:
    found = read(
        "/* a comment; #9=A() */ #1 = A ( 'x' , /* * */ +1.5e+3 , -7 , \"0FF\" ) ;",
        r"#2=A('\S\d\X\E4\PA\\X2\03A9\X0\\\');",
    )
    assert found[1][0].values == ("x", 1500.0, -7, ReadWord('"0FF"'))
    assert found[2][0].values == ("ä" + "ä" + "\N{GREEK CAPITAL LETTER OMEGA}\\",)


@pytest.mark.parametrize(
    ("line", "what"),
    [
        ("#1=A(1.0,);", "line 7: a value expected"),
        ("#1=A(1.0;", "line 7: ',' expected, not ';'"),
        ("#1=A('x);", "is not a token of STEP"),
        ("#1=A(x);", "is not a token of STEP"),
        ("#1=(1.0);", "a type expected"),
        ("#1=A()", "';' expected"),
        ("#1=A();#1=B();", "#1 appears twice"),
        ("#1=A(1.E10);", "not a number of at most 1e"),
        ("#1=A(((((((((1.))))))))));", "lists are nested more than 8 deep"),
        (r"#1=A('\q');", "a backslash that begins no directive"),
        (r"#1=A('\X2\D800\X0\');", "which is not a character"),
        ("#1=A();ENDSEC;END-ISO-10303-21; more", "more"),
    ],
)
def test_what_breaks_the_syntax_is_told_with_its_line(line: str, what: str) -> None:
    with pytest.raises(FileError) as raised:
        read(line)
    assert what in str(raised.value)


def test_a_reference_to_nothing_is_told() -> None:
    data = "\n".join((HEAD, "#1=A((1,B(#7)));", TAIL)).encode()
    with pytest.raises(FileError, match="#1 refers to #7, which does not exist"):
        Model.from_exchange(read_exchange(data))


def test_the_reader_shares_no_code_with_the_writer() -> None:
    folder = Path(camgeo_export.__file__).parent
    readers = [folder / "part21.py", *folder.glob("verify/*.py")]
    assert len(readers) > 8
    for path in readers:
        assert "from camgeo_export.step" not in path.read_text("utf-8"), path
    for path in folder.glob("step/*.py"):
        imported = re.findall(r"from camgeo_export\.(part21\S*|verify\S*)", path.read_text("utf-8"))
        assert imported == (["verify.step"] if path.stem == "writer" else [])


# The same solid otherwise said --------------------------------------------------------------------


FREE = 90_000
"""First number of the entities that are added."""

Lines = dict[int, str]
"""The entities of a file by their numbers, without `#n=` and semicolon."""


@cache
def product_of(name: str) -> Product:
    if name == "splines":
        return replace(SPLINES["mm"], step=StepSpec("spline"))
    return product(name)


@cache
def written(name: str) -> str:
    return WRITER.write(product_of(name), TOLERANCE).data.decode()


def edited(name: str, edit: Callable[[Lines], None]) -> bytes:
    """The file with its entities changed."""
    whole = written(name)
    found = re.findall(r"^#(\d+)=(.*);$", whole, re.MULTILINE)
    lines = {int(number): body for number, body in found}
    edit(lines)
    head, tail = whole[: whole.index("#1=")], whole[whole.rindex("ENDSEC;") :]
    body = "".join(f"#{number}={each};\n" for number, each in lines.items())
    return f"{head}{body}{tail}".encode()


def kind_of(line: str) -> str:
    return line.partition("(")[0]


def of_kind(lines: Lines, *kinds: str) -> list[int]:
    return [number for number, line in lines.items() if kind_of(line) in kinds]


def refs(line: str) -> list[int]:
    return [int(each) for each in re.findall(r"#(\d+)", line)]


def turn(lines: Lines, number: int) -> None:
    """Turn the last truth value of an entity."""
    found = re.fullmatch(r"(.*)\.([TF])\.\)", lines[number])
    assert found is not None
    lines[number] = f"{found[1]}.{'F' if found[2] == 'T' else 'T'}.)"


# The same, otherwise said -------------------------------------------------------------------------


def edges_backwards(lines: Lines) -> None:
    """Edges run from their end to their start, against their curves, and are used so."""
    for number in of_kind(lines, "EDGE_CURVE"):
        start, end, curve = refs(lines[number])
        flag = lines[number][-4:]
        lines[number] = f"EDGE_CURVE('',#{end},#{start},#{curve},{flag}"
        turn(lines, number)
    for number in of_kind(lines, "ORIENTED_EDGE"):
        turn(lines, number)


def loops_backwards(lines: Lines) -> None:
    """Loops run the other way, and bounds say so; names of kinds that mean the same."""
    for number in of_kind(lines, "EDGE_LOOP"):
        uses = ",".join(f"#{each}" for each in refs(lines[number])[::-1])
        lines[number] = f"EDGE_LOOP('',({uses}))"
    for number in of_kind(lines, "ORIENTED_EDGE", "FACE_BOUND", "FACE_OUTER_BOUND"):
        turn(lines, number)
        lines[number] = lines[number].replace("FACE_OUTER_BOUND", "FACE_BOUND")
    for number in of_kind(lines, "ADVANCED_FACE"):
        lines[number] = lines[number].replace("ADVANCED_FACE", "FACE_SURFACE")


def circles_from_below(lines: Lines) -> None:
    """Circles and cylinders whose axes point down: such a circle runs clockwise."""
    lines[FREE] = "DIRECTION('',(0.,0.,-3.))"
    circles = of_kind(lines, "CIRCLE")
    for number in (*circles, *of_kind(lines, "CYLINDRICAL_SURFACE")):
        axes = refs(lines[number])[0]
        origin, _, first = refs(lines[axes])
        lines[axes] = f"AXIS2_PLACEMENT_3D('',#{origin},#{FREE},#{first})"
    for number in of_kind(lines, "EDGE_CURVE"):
        if refs(lines[number])[2] in circles:
            turn(lines, number)


def cones_from_elsewhere(lines: Lines) -> None:
    """Cones stated 0.25 mm farther along their axes, where they are as much wider."""
    for count, number in enumerate(of_kind(lines, "CONICAL_SURFACE")):
        (axes,) = refs(lines[number])
        *_, radius, angle = lines[number].rstrip(")").split(",")
        origin, axis, first = refs(lines[axes])
        x, y, z = numbers(lines[origin])
        up = math.copysign(0.25, numbers(lines[axis])[2])
        new = FREE + 2 * count
        lines[new] = f"CARTESIAN_POINT('',({x!r},{y!r},{z + up!r}))"
        lines[new + 1] = f"AXIS2_PLACEMENT_3D('',#{new},#{axis},#{first})"
        lines[number] = f"CONICAL_SURFACE('',#{new + 1},{float(radius) + 0.25!r},{angle})"


def numbers(line: str) -> list[float]:
    return [float(each) for each in line[line.rindex("((") + 2 if "((" in line else
            line.index(",(") + 2 : line.index(")")].split(",")]  # fmt: skip


def lines_as_splines(lines: Lines) -> None:
    """Rising lines as splines of degree 1, and all edges as curves on surfaces."""
    for count, number in enumerate(of_kind(lines, "EDGE_CURVE")):
        start, end, curve = refs(lines[number])
        ends = [refs(lines[each])[0] for each in (start, end)]
        heights = [numbers(lines[each])[2] for each in ends]
        if kind_of(lines[curve]) == "LINE" and abs(heights[0] - heights[1]) > 1e-6:
            lines[curve] = (
                f"B_SPLINE_CURVE_WITH_KNOTS('',1,(#{ends[0]},#{ends[1]}),.POLYLINE_FORM.,.F.,.F.,"
                "(2,2),(3.,7.),.UNSPECIFIED.)"
            )
        new = FREE + count
        lines[new] = f"{'SEAM' if count % 2 else 'SURFACE'}_CURVE('',#{curve},(),.CURVE_3D.)"
        lines[number] = lines[number].replace(f",#{curve},", f",#{new},")


def splines_with_weights(lines: Lines) -> None:
    """Splines as entities of several types, with weights that are all the same."""
    for number in of_kind(lines, "B_SPLINE_CURVE_WITH_KNOTS"):
        found = re.fullmatch(
            r"B_SPLINE_CURVE_WITH_KNOTS\('',(\d),(\([^)]*\)),(.*?),\.F\.,\.F\.,(.*)\)",
            lines[number],
        )
        assert found is not None
        degree, controls, form, rest = found.groups()
        weights = ",".join(["0.7"] * (controls.count("#")))
        lines[number] = (
            f"(BOUNDED_CURVE()B_SPLINE_CURVE({degree},{controls},{form},.F.,.F.)"
            f"B_SPLINE_CURVE_WITH_KNOTS({rest})CURVE()GEOMETRIC_REPRESENTATION_ITEM()"
            f"RATIONAL_B_SPLINE_CURVE(({weights}))REPRESENTATION_ITEM(''))"
        )


def axes_left_out(lines: Lines) -> None:
    """Placements upwards without an axis, or without a first one; directions of any length."""
    for number in of_kind(lines, "AXIS2_PLACEMENT_3D"):
        origin, axis, first = refs(lines[number])
        if lines[axis] == "DIRECTION('',(0.,0.,1.))":
            lines[number] = (
                f"AXIS2_PLACEMENT_3D('',#{origin},$,{'$' if first % 2 else f'#{first}'})"
            )
    for number in of_kind(lines, "DIRECTION"):
        x, y, z = (2.5 * each for each in numbers(lines[number]))
        lines[number] = f"DIRECTION('',({x!r},{y!r},{z!r}))"


def units_by_others(lines: Lines) -> None:
    """Millimetres as a tenth of a centimetre that is a hundredth of a metre; angles in degrees."""
    (length,) = (k for k, each in lines.items() if each.startswith("(LENGTH_UNIT()"))
    lines[FREE] = "(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.))"
    lines[FREE + 1] = f"LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(0.01),#{FREE})"
    lines[FREE + 2] = f"(CONVERSION_BASED_UNIT('CM',#{FREE + 1})LENGTH_UNIT()NAMED_UNIT(*))"
    lines[FREE + 3] = f"MEASURE_WITH_UNIT(LENGTH_MEASURE(0.1),#{FREE + 2})"
    lines[length] = f"(CONVERSION_BASED_UNIT('MM',#{FREE + 3})LENGTH_UNIT()NAMED_UNIT(*))"
    (angle,) = (k for k, each in lines.items() if "RADIAN" in each and "PLANE" in each)
    lines[FREE + 4] = lines[angle]
    size = f"{math.pi / 180.0!r}"
    lines[FREE + 5] = f"PLANE_ANGLE_MEASURE_WITH_UNIT(PLANE_ANGLE_MEASURE({size}),#{FREE + 4})"
    lines[angle] = f"(CONVERSION_BASED_UNIT('DEGREE',#{FREE + 5})NAMED_UNIT(*)PLANE_ANGLE_UNIT())"
    for number in of_kind(lines, "CONICAL_SURFACE"):
        head, _, angle_of = lines[number].rstrip(")").rpartition(",")
        lines[number] = f"{head},{math.degrees(float(angle_of))!r})"


EDITS: dict[str, tuple[Callable[[Lines], None], tuple[str, ...]]] = {
    each.__name__: (each, names) for each, names in (
        (edges_backwards, ("circle and keyway", "splines")),
        (loops_backwards, ("circle and flat",)),
        (circles_from_below, ("circle and keyway",)),
        (cones_from_elsewhere, ("circle and flat",)),
        (lines_as_splines, ("circle and keyway", "straight edges")),
        (splines_with_weights, ("circle and keyway", "splines")),
        (axes_left_out, ("circle and keyway",)),
        (units_by_others, ("circle and flat",)),
    )
}  # fmt: skip


@pytest.mark.parametrize("edit", EDITS)
def test_the_same_solid_otherwise_said_is_measured_alike(edit: str) -> None:
    change, names = EDITS[edit]
    for name in names:
        data = edited(name, change)
        assert data != written(name).encode()
        expected, found = (
            checked(VERIFIERS["step"], product_of(name), each)
            for each in (written(name).encode(), data)
        )
        assert found.keys() == expected.keys()
        for key, check in found.items():
            assert check.ok is not False, check
            if isinstance(check.value, float):
                assert check.value == pytest.approx(expected[key].value, abs=1e-8, rel=1e-12)


# Units --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("prefix", "size", "name"),
    [
        (".MILLI.", 1.0, "mm"), (".CENTI.", 10.0, "cm"), ("$", 1000.0, "m"),
        (".DECI.", 100.0, "100 mm"), (".MICRO.", 1e-3, "0.001 mm"), (".KILO.", 1e6, "1e+06 mm"),
    ],
)  # fmt: skip
def test_units_of_the_si(prefix: str, size: float, name: str) -> None:
    whole = written("circle and flat").replace("SI_UNIT(.MILLI.,", f"SI_UNIT({prefix},")
    solid = Solid.from_bytes(whole.encode())
    assert (solid.unit, solid.unit_name) == (size, name)
    assert solid.uncertainty == pytest.approx(1e-7 * size, rel=1e-12)
    heights = {use.edge.places[0].z for face in solid.faces for loop in face.loops for use in loop}
    assert max(heights) == pytest.approx(8.0 * size, rel=1e-12)
    if size != 1.0:
        with pytest.raises(FileError, match=rf"the solid is in {re.escape(name)}, not in mm"):
            WRITER.measure(product_of("circle and flat"), whole.encode())


@pytest.mark.parametrize(
    ("factors", "name"),
    [
        ((25.4,), "inch"),
        ((304.8,), "foot"),
        ((1e6,), "1e+06 mm"),
        ((1e-6,), "1e-06 mm"),
        ((2.0, 2.0), "4 mm"),
    ],
)
def test_units_that_are_stated_by_others(factors: tuple[float, ...], name: str) -> None:
    assert Solid.from_bytes(edited("circle and flat", by_factors(*factors))).unit_name == name


def by_factors(*factors: float) -> Callable[[Lines], None]:
    """The unit of length as so many millimetres, stated by as many units."""

    def edit(lines: Lines) -> None:
        (length,) = (k for k, each in lines.items() if each.startswith("(LENGTH_UNIT()"))
        lines[FREE] = lines[length]
        for count, factor in enumerate(factors):
            base = FREE + 2 * count
            new = length if count == len(factors) - 1 else base + 2
            lines[base + 1] = f"LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE({real(factor)}),#{base})"
            lines[new] = f"(CONVERSION_BASED_UNIT('X',#{base + 1})LENGTH_UNIT()NAMED_UNIT(*))"

    return edit


@pytest.mark.parametrize(
    ("factors", "message"),
    [
        ((2.0, 2.0, 2.0), "defined by other units more than 3 times"),
        ((1.000001e6,), "SI_UNIT: is "),
        ((0.999999e-6,), "SI_UNIT: is "),
    ],
)
def test_units_have_limits(factors: tuple[float, ...], message: str) -> None:
    """Two are stated by others, a third is not; none is beyond a kilometre or a nanometre."""
    with pytest.raises(FileError, match=message):
        Solid.from_bytes(edited("circle and flat", by_factors(*factors)))


@pytest.mark.parametrize(
    "pattern",
    [
        r"GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT\(\(#\d+\)\)",
        r"(?<=CERTAINTY_ASSIGNED_CONTEXT\(\()#\d+",
    ],
)
def test_without_an_uncertainty_none_is_told(pattern: str) -> None:
    data = re.sub(pattern, "", written("circle and flat")).encode()
    assert Solid.from_bytes(data).uncertainty is None


# Faults -------------------------------------------------------------------------------------------

NUMBER = r"[-\d.E]+"

FAULTS: dict[str, tuple[str, str, str, str]] = {
    "a direction of no length": ("circle and flat", r"DIRECTION\('',\(1\.,0\.,0\.\)\)",
                                 "DIRECTION('',(0.,0.,0.))", "is of length 0"),
    "an axis along the other": ("circle and flat", r"(AXIS2_PLACEMENT_3D\('',#\d+,#(\d+)),#\d+",
                                r"\1,#\2", "has a first axis parallel to its third axis"),
    "a circle that leans": ("circle and flat", r"DIRECTION\('',\(0\.,0\.,1\.\)\)",
                            "DIRECTION('',(0.,0.1,1.))", "only upright solids can be read"),
    "two coordinates": ("circle and flat", rf"(CARTESIAN_POINT\('',\({NUMBER},{NUMBER}),{NUMBER}",
                        r"\1", "does not have three coordinates"),
    "a circle of no radius": ("circle and flat", rf"(CIRCLE\('',#\d+,){NUMBER}", r"\g<1>0.",
                              "has no radius above 0"),
    "a cylinder of no radius": ("circle and flat", rf"(CYLINDRICAL_SURFACE\('',#\d+,){NUMBER}",
                                r"\g<1>-1.", "has no radius above 0"),
    "a cone that is a cylinder": (
        "circle and flat", rf"(CONICAL_SURFACE\('',#\d+,{NUMBER}),{NUMBER}", r"\1,0.",
        "a half angle that is not between"),
    "a cone that is a plane": ("circle and flat", rf"(CONICAL_SURFACE\('',#\d+,{NUMBER}),{NUMBER}",
                               r"\1,1.5707963267948966", "a half angle that is not between"),
    "a wall that is not extruded along Z": (
        "splines", r"(SURFACE_OF_LINEAR_EXTRUSION\('',#\d+,)#\d+", r"\g<1>#89999",
        "is not extruded along Z"),
    "a wall drawn out of a line": ("splines", r"SURFACE_OF_LINEAR_EXTRUSION\('',#\d+",
                                   "SURFACE_OF_LINEAR_EXTRUSION('',#89997", "not extrude a spline"),
    "weights that differ": ("weights", r"0\.7,0\.7\)", "0.7,0.8)", "is rational"),
    "no weights": ("weights", r"\(\(0\.7[^)]*\)\)", "(())", "is rational"),
    "a multiplicity of 0": ("splines", r",\(4,", ",(0,", "as many knots as multiplicities above 0"),
    "a knot too many": ("splines", r",\(4,", ",(4,1,", "as many knots as multiplicities above 0"),
    "a knot without a place": ("splines", r",\(4,", ",(3,", "is not a spline that can be read"),
    "a spline of degree 9": ("splines", r"WITH_KNOTS\('',3", "WITH_KNOTS('',9",
                             "is not a spline that can be read"),
    "another solid": ("circle and flat", r"(#\d+)=(MANIFOLD_SOLID_BREP.*);",
                      r"\1=\2;#89990=\2;", r"2 solids \(MANIFOLD_SOLID_BREP\), expected one"),
    "no solid": ("circle and flat", "MANIFOLD_SOLID_BREP", "SOLID_BREP",
                 r"0 solids \(MANIFOLD_SOLID_BREP\), expected one"),
    "an assembly": ("circle and flat", r"(#1=)", r"#89990=MAPPED_ITEM('');\1",
                    "#89990, MAPPED_ITEM: only files of one solid"),
    "a solid that is not shown": ("circle and flat", r"(REPRESENTATION\('[^']*',\(#\d+),#\d+",
                                  r"\1", "0 representations hold the solid, expected one"),
    "two units": ("circle and flat", r"(GLOBAL_UNIT_ASSIGNED_CONTEXT\(\((#\d+),)", r"\1\2,",
                  "2 units of length, expected one"),
    "a unit of angles alone": ("circle and flat", r"(GLOBAL_UNIT_ASSIGNED_CONTEXT\(\()#\d+,", r"\1",
                               "0 units of length, expected one"),
    "another prefix": ("circle and flat", r"\.MILLI\.", ".NANO.", "is not a unit of length"),
    "another unit": ("circle and flat", r"\.METRE\.", ".GRAM.", "is not a unit of length"),
    "a face without bounds": ("circle and flat", r"(ADVANCED_FACE\('[^']*',)\([^)]*\)", r"\1()",
                              "ADVANCED_FACE: has no bounds"),
    "a loop without edges": ("circle and flat", r"(EDGE_LOOP\('',)\([^)]*\)", r"\1()",
                             "EDGE_LOOP: has no edges"),
    "a face that appears twice": ("circle and flat", r"(CLOSED_SHELL\('',\((#\d+),)", r"\1\2,",
                                   "appears twice in the shell"),
    "an edge that appears twice": ("circle and flat", r"(EDGE_LOOP\('',\((#\d+),)", r"\1\2,",
                                    "appears twice in the shell"),
    "no reference": ("circle and flat", r"(VERTEX_POINT\('',)#\d+", r"\g<1>3",
                     "VERTEX_POINT: parameter 2 is not a reference"),
    "no text": ("circle and flat", r"ADVANCED_FACE\('[^']*'", "ADVANCED_FACE(7",
                "ADVANCED_FACE: parameter 1 is not a text"),
    "no truth value": ("circle and flat", r"(ORIENTED_EDGE\(.*),\.[TF]\.", r"\1,.U.",
                       r"ORIENTED_EDGE: parameter 5 is not \.T\. or \.F\."),
    "no enumeration": ("circle and flat", r"(ORIENTED_EDGE\(.*),\.[TF]\.", r"\1,1",
                       "ORIENTED_EDGE: parameter 5 is not an enumeration"),
    "no number": ("circle and flat", rf"(CIRCLE\('',#\d+,){NUMBER}", r"\1'2'",
                  "CIRCLE: parameter 3 is not a number"),
    "a reference for a number": ("circle and flat", rf"(CIRCLE\('',#\d+,){NUMBER}", r"\1#1",
                                 "CIRCLE: parameter 3 is not a number"),
    "a parameter that is missing": ("circle and flat", rf"(CIRCLE\('',#\d+),{NUMBER}", r"\1",
                                    "CIRCLE: parameter 3 is not a number"),
    "no list": ("circle and flat", r"(EDGE_LOOP\('',)\((#\d+)[^)]*\)", r"\1\2",
                "EDGE_LOOP: parameter 2 is not a list"),
    "a list of others": ("circle and flat", r"(EDGE_LOOP\('',\()#\d+", r"\g<1>1.",
                         "EDGE_LOOP: parameter 2 is not a list of references"),
    "another entity": ("circle and flat", r"(VERTEX_POINT\('',)#\d+", r"\1#1",
                       "#1 is APPLICATION_CONTEXT, not CARTESIAN_POINT"),
    "no measure": ("circle and flat", r"LENGTH_MEASURE\(1\.E-7\)", "1.E-7",
                   "UNCERTAINTY_MEASURE_WITH_UNIT: parameter 1 is not a measure"),
    "two measures": ("circle and flat", r"LENGTH_MEASURE\(1\.E-7\)", "LENGTH_MEASURE(1.,2.)",
                     "UNCERTAINTY_MEASURE_WITH_UNIT: parameter 1 is not a number"),
}  # fmt: skip


@pytest.mark.parametrize("name", FAULTS)
def test_what_is_wrong_is_told(name: str) -> None:
    file, pattern, new, message = FAULTS[name]
    if file == "weights":
        file, whole = "splines", edited("splines", splines_with_weights).decode()
    else:
        whole = written(file)
    if "#8999" in new:
        more = "#89999=VECTOR('',#89998,1.);#89998=DIRECTION('',(0.,0.1,1.));"
        more += "#89997=LINE('',#89996,#89999);#89996=CARTESIAN_POINT('',(0.,0.,0.));\n#1="
        whole = whole.replace("#1=", more, 1)
    changed, count = re.subn(pattern, new, whole)
    assert count
    with pytest.raises(FileError, match=message):
        WRITER.measure(product_of(file), changed.encode())


def test_knots_have_a_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    """As many as one allows are read, and one more is refused."""
    spline = written("splines").encode()
    counts = re.findall(r"\.F\.,\.F\.,\(([\d,]+)\)", spline.decode())
    most = max(sum(map(int, each.split(","))) for each in counts)
    monkeypatch.setattr("camgeo_export.part21.KNOTS", most)
    assert WRITER.measure(product_of("splines"), spline) <= TOLERANCE
    monkeypatch.setattr("camgeo_export.part21.KNOTS", most - 1)
    with pytest.raises(FileError, match="as many knots as multiplicities"):
        WRITER.measure(product_of("splines"), spline)
