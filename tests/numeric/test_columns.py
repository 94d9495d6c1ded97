"""Tables of numbers with columns that may be missing; lift tables test the format itself."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.numeric.columns import (
    LONGEST_HEADING,
    MOST_COLUMNS,
    Asked,
    Columns,
    NumberColumn,
    read_columns,
)
from camgeo.reading import DIGITS, TABLE

ASKED = Asked(
    (NumberColumn("x", ("x",), ("mm", "inch"), "mm or inch"), NumberColumn("y", ("y",))),
    (NumberColumn("nx", ("nx", "i")), NumberColumn("ny", ("ny", "j"))),
    fewest=1,
    most=3,
)


def read(text: str) -> Columns:
    return read_columns(text, "points.csv", ASKED)


@pytest.mark.parametrize(
    "text",
    [
        "1.5,2,0,1\n3,4,1,0\n",
        "x;y;nx;ny\n1,5;2;0;1\n3;4;1;0\n",
        "J\tz\ty\tx [mm]\tI\n1\t?\t2\t1.5\t0\n0\t?\t4\t3\t1\n",
    ],
)
def test_columns_are_found_by_name_or_by_place(text: str) -> None:
    found = read(text)
    assert found.values.tolist() == [[1.5, 3.0], [2.0, 4.0], [0.0, 1.0], [1.0, 0.0]]
    assert found.units == (("mm" if "mm" in text else ""), "", "", "")


@pytest.mark.parametrize("text", ["1,2\n", "x,y\n1,2\n", "z,y,x\n9,2,1\n"])
def test_columns_that_may_be_missing(text: str) -> None:
    assert np.array_equal(read(text).values, [[1.0], [2.0]])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "1,2,3\n",
            "line 1.*3 columns; without a heading 2 or 4 are allowed, x and y, or x, y,",
        ),
        ("x,y,nx\n1,2,3\n", "line 1.*0 columns of ny; allowed: one, called ny or j"),
        ("x,y,nx,i,ny\n1,2,3,4,5\n", "line 1.*2 columns of nx"),
        ("x [cm],y\n1,2\n", "line 1: 'x \\[cm\\]': the unit of the x; allowed: mm or inch"),
        ("1,2\n" * 4, "line 4: 4 rows of numbers; allowed: 1 to 3"),
        ("x,y\n", "line 2: 0 rows of numbers"),
        ("1;2\n1,5;2.5\n", "line 2: '2.5': the decimals above have ','; allowed: one kind"),
    ],
)
def test_other_tables_are_refused(text: str, message: str) -> None:
    with pytest.raises(GeometryError, match=message):
        read(text)


MARKS = {";": (",", "."), "\t": (",", "."), ",": (".",), "  ": (",", ".")}


@given(
    rows=st.lists(st.tuples(st.floats(-1e9, 1e9), st.floats(-1e-3, 1e-3)), min_size=2, max_size=6),
    separator=st.sampled_from(sorted(MARKS)),
    comma=st.booleans(),
    end=st.sampled_from(["\n", "\r\n", "\r"]),
    heading=st.booleans(),
    skipped=st.lists(st.sampled_from(["", "  ", "# 1;2", "  # x,y", "\t"]), max_size=7),
)
def test_a_written_table_is_read_back_with_its_lines(
    rows: list[tuple[float, float]],
    separator: str,
    comma: bool,
    end: str,
    heading: bool,
    skipped: list[str],
) -> None:
    mark = MARKS[separator][0 if comma else -1]
    lines = [separator.join((' "X [MM]"', "y ( kg ) "))] if heading else []
    lines += [separator.join(f" {value!r} ".replace(".", mark) for value in row) for row in rows]
    places = []
    text = ""
    count = 0
    for number, line in enumerate(lines):
        for extra in skipped[number::3]:
            if number or not extra.strip():
                text += extra + end
                count += 1
        text += line + end
        count += 1
        places.append(count)
    data = "\N{BYTE ORDER MARK}" * (len(rows) % 2) + text
    asked = Asked(ASKED.needed, fewest=2, most=6)
    for given_data in (data, data.encode("utf-8")):
        found = read_columns(given_data, "points.csv", asked)
        assert found.values.T.tolist() == [list(row) for row in rows]
        assert found.units == (("MM", "kg") if heading else ("", ""))
        assert found.lines == tuple(places[1:] if heading else places)


def table(rows: int) -> str:
    return "1,2\n" * rows


@pytest.mark.parametrize(
    ("data", "message", "value"),
    [
        ("", "points.csv, line 1: no rows; allowed: 2 or more", ""),
        ("\n# a\n\n", "points.csv, line 4: no rows; allowed: 2 or more", ""),
        ("1,2\n\n", "points.csv, line 1: 1 row of numbers; allowed: 2 to 5", ""),
        ("\n" + table(6), "points.csv, line 7: 6 rows of numbers; allowed: 2 to 5", ""),
        ("\n" + table(9), "points.csv, line 7: 9 rows of numbers; allowed: 2 to 5", ""),
        ("x,y\n", "points.csv, line 2: 0 rows of numbers; allowed: 2 to 5", ""),
        (
            "1,2\n3,4,5\n6,7\n",
            "points.csv, line 2: '3,4,5': 3 columns; allowed: 2 in this file",
            "3,4,5",
        ),
        (
            "1,2\n3,1e5x\n",
            "points.csv, line 2: '1e5x': not a number; allowed: numbers like 12.5",
            "1e5x",
        ),
        ("1,2\n,4\n", "points.csv, line 2: not a number; allowed: numbers like 12.5", ""),
        (
            "1,2\n3,1.000001e30\n",
            "points.csv, line 2: '1.000001e30': too large; allowed: numbers up to 1e+30",
            "1.000001e30",
        ),
        (
            "1\n2\n",
            (
                "points.csv, line 1: '1': one column; allowed separators are ; and tab and comma"
                " and blanks"
            ),
            "1",
        ),
        (b"1,2\n3,\xff4\n", "points.csv, line 2: not UTF-8 text", ""),
        (
            "\n1,2,3\n",
            (
                "points.csv, line 2: '1,2,3': 3 columns; without a heading 2 are allowed, x and y"
                " (a decimal comma needs ; or tab or blanks as separator)"
            ),
            "1,2,3",
        ),
        (
            "x,z\n1,2\n",
            "points.csv, line 1: 'x, z': 0 columns of y; allowed: one, called y",
            "x, z",
        ),
        (
            "y,x [inches]\n",
            "points.csv, line 1: 'x [inches]': the unit of the x; allowed: mm or inch",
            "x [inches]",
        ),
    ],
)
def test_a_fault_is_told_with_its_line_and_what_is_allowed(
    data: bytes | str, message: str, value: str
) -> None:
    with pytest.raises(GeometryError) as caught:
        read_columns(data, "points.csv", Asked(ASKED.needed, fewest=2, most=5))
    assert caught.value.message == message
    assert caught.value.value == value


def test_limits_of_tables_are_allowed_and_one_more_is_not() -> None:
    asked = Asked(ASKED.needed, fewest=2, most=5)
    for rows in (2, 5):
        assert read_columns(table(rows), "points.csv", asked).values.shape == (2, rows)
    assert read_columns("1,1e30\n1,-1e30\n", "points.csv", asked).values[1].tolist() == [
        1e30,
        -1e30,
    ]
    long = "0." + "1" * (DIGITS - 2)
    assert read_columns(f"1,2\n3,{long}\n", "points.csv", asked).values[1, 1] == float(long)
    with pytest.raises(GeometryError, match="not a number"):
        read_columns(f"1,2\n3,{long}1\n", "points.csv", asked)
    for columns, good in ((MOST_COLUMNS, True), (MOST_COLUMNS + 1, False)):
        wide = ",".join(["x", "y"] + [f"c{k}" for k in range(columns - 2)]) + "\n"
        wide += 2 * (",".join(map(str, range(columns))) + "\n")
        if good:
            assert read_columns(wide, "points.csv", asked).values.tolist() == [[0, 0], [1, 1]]
            continue
        with pytest.raises(GeometryError) as caught:
            read_columns(wide, "points.csv", asked)
        assert caught.value.message.startswith("points.csv, line 1: 'x,y,c0")
        assert caught.value.message.endswith("1,001 columns or more; allowed: at most 1,000")
        assert caught.value.value.endswith("...")
        assert len(caught.value.value) == 60
    for spaces, unit in ((LONGEST_HEADING - 5, "kg"), (LONGEST_HEADING - 4, "")):
        head = f"y{' ' * spaces}[kg]"
        text = f"x,{head}\n1,2\n3,4\n"
        if unit:
            assert read_columns(text, "points.csv", asked).units == ("", unit)
        else:  # a cell this long is a name alone
            with pytest.raises(GeometryError, match="0 columns of y"):
                read_columns(text, "points.csv", asked)


def test_files_that_are_too_long_are_not_read() -> None:
    with pytest.raises(GeometryError) as caught:
        read_columns(b" " * (TABLE.size + 1), "big.csv", ASKED)
    told = "big.csv, line 1: the file has 16,000,001 bytes; allowed: 16,000,000"
    assert caught.value.message == told
    assert TABLE.lines is not None
    for ends in ("\n", "\r", "\r\n"):
        text = ends * TABLE.lines
        with pytest.raises(GeometryError, match="no rows"):
            read_columns(text, "big.csv", ASKED)
        with pytest.raises(GeometryError, match="400,001 lines; allowed: 400,000"):
            read_columns(text + ends, "big.csv", ASKED)


def test_numbers_may_lack_a_digit_on_one_side_of_their_mark() -> None:
    for text in ("+1.;.5e1\n-1,;2\n", "+1.\t.5e1\n-1.\t2\n"):
        if "," in text:
            with pytest.raises(GeometryError, match=r"the decimals above have '\.'"):
                read_columns(text, "points.csv", ASKED)
        else:
            found = read_columns(text, "points.csv", ASKED)
            assert found.values.tolist() == [[1.0, -1.0], [5.0, 2.0]]
