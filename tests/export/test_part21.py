"""The text of STEP files: what is spelled is read back, and what breaks the syntax is told."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

import camgeo_export
from camgeo.errors import FileError
from camgeo.reading import COORDINATE
from camgeo_export.part21.solid import Model
from camgeo_export.part21.text import Record, exchange_of
from camgeo_export.part21.text import Ref as ReadRef
from camgeo_export.part21.text import Word as ReadWord
from camgeo_export.step.writer import DERIVED, NONE, Entities, Ref, Typed, flag, real, spelled

HEAD = "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('X'));\nENDSEC;\nDATA;\n"
TAIL = "ENDSEC;\nEND-ISO-10303-21;\n"


def read(*lines: str) -> dict[int, tuple[Record, ...]]:
    return exchange_of("\n".join((HEAD, *lines, TAIL)).encode()).instances


@given(st.text(st.characters(exclude_categories=["Cs"]), max_size=40))
def test_any_text_makes_the_round_trip(text: str) -> None:
    line = f"#1=A({spelled(text)});"
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
        ("#1=A('x);", "is nothing that STEP knows"),
        ("#1=A(x);", "is nothing that STEP knows"),
        ("#1=(1.0);", "a type expected"),
        ("#1=A()", "';' expected"),
        ("#1=A();#1=B();", "#1 is there twice"),
        ("#1=A(1.E10);", "not a number of at most 1e"),
        ("#1=A(((((((((1.))))))))));", "lists are nested more than 8 deep"),
        (r"#1=A('\q');", "a backslash that begins no directive"),
        (r"#1=A('\X2\D800\X0\');", "which is no character"),
        ("#1=A();ENDSEC;END-ISO-10303-21; more", "more"),
    ],
)
def test_what_breaks_the_syntax_is_told_with_its_line(line: str, what: str) -> None:
    with pytest.raises(FileError) as raised:
        read(line)
    assert what in str(raised.value)


def test_a_reference_to_nothing_is_told() -> None:
    data = "\n".join((HEAD, "#1=A((1,B(#7)));", TAIL)).encode()
    with pytest.raises(FileError, match="#1 refers to #7, which is not there"):
        Model.of(exchange_of(data))


def test_the_reader_shares_no_code_with_the_writer() -> None:
    folder = Path(camgeo_export.__file__).parent
    readers = [*folder.glob("part21/*.py"), *folder.glob("verify/*.py")]
    assert len(readers) > 10
    for path in readers:
        assert "from camgeo_export.step" not in path.read_text("utf-8"), path
    for path in folder.glob("step/*.py"):
        imported = re.findall(r"from camgeo_export\.(part21\S*|verify\S*)", path.read_text("utf-8"))
        assert imported == (["part21.measure"] if path.stem == "writer" else [])
