"""Values and tables checked where they come in: numbers of any kind pass, all else is refused."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from itertools import product
from types import MappingProxyType
from typing import Annotated, Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.numeric import checked
from camgeo.numeric.columns import (
    LONGEST_HEADING,
    MOST_COLUMNS,
    Columns,
    NumberColumn,
    RequestedColumns,
    read_columns,
)
from camgeo.reading import DIGITS, TABLE


@pytest.mark.parametrize(
    "value",
    [
        None,
        True,
        False,
        "1",
        b"1",
        1 + 0j,
        [1.0],
        np.ones(1),
        np.True_,
        object(),
        math.nan,
        math.inf,
        -math.inf,
        np.float64("nan"),
        10**400,
        -(10**400),
        10**5000,
        1e308,
        -1e31,
    ],
    ids=lambda value: str(type(value).__name__),
)
@pytest.mark.parametrize("check", [checked.finite, checked.positive, checked.point])
def test_what_is_no_number_is_refused(check: Any, value: Any) -> None:
    if check is checked.point and isinstance(value, complex):
        return
    with pytest.raises(GeometryError, match="must be") as caught:
        check("arm", value)
    assert caught.value.key == "arm"
    assert 0 < len(caught.value.value) < 80


@pytest.mark.parametrize(
    "value", [2, 2.0, np.float64(2), np.float32(2), np.int8(2), np.uint64(2), Fraction(2)]
)
def test_numbers_of_any_kind_become_floats(value: Any) -> None:
    for check in (checked.finite, checked.positive):
        found = check("arm", value)
        assert type(found) is float
        assert found == 2.0
    assert type(checked.point("pivot", value)) is complex


@given(value=st.floats())
def test_a_positive_number_is_itself_or_refused(value: float) -> None:
    if checked.SMALLEST <= value <= checked.LARGEST:
        assert checked.positive("arm", value) == value
    else:
        with pytest.raises(GeometryError):
            checked.positive("arm", value)


def test_arrays_are_copied_and_read_only() -> None:
    found = checked.array("t", np.array([1, 2, 3]))
    assert found.dtype == np.float64
    assert not found.flags.writeable
    own = np.array([1.0, 2.0])
    found = checked.array("t", own)
    own[0] = 7.0
    assert found.tolist() == [1.0, 2.0]
    assert checked.array("t", [[1.0], [2.0]], 2).shape == (2, 1)


@pytest.mark.parametrize(
    "values",
    [
        None,
        "12",
        ["1", "2"],
        [1.0, None],
        [True, False],
        [[1.0], [2.0, 3.0]],
        [1.0 + 0j],
        [1.0, math.nan],
        [math.inf],
        [1e308],
        [10**400],
        3.0,
        [[1.0, 2.0]],
        (x for x in (1.0, 2.0)),
    ],
)
def test_what_is_no_array_of_numbers_is_refused(values: Any) -> None:
    with pytest.raises(GeometryError, match="must be") as caught:
        checked.array("t", values)
    assert caught.value.key == "t"


@pytest.mark.parametrize(
    "bounds",
    [
        dict(zip(("above", "least", "below", "most"), each, strict=True))
        for each in product((None, 1.0), (None, 2.0), (None, 8.0), (None, 7.0))
    ],
)
def test_each_set_of_bounds_holds_by_itself_and_is_told(bounds: dict[str, Any]) -> None:
    """Each value next to each bound against the words of the bounds; a later word replaces."""
    stated = {name: value for name, value in bounds.items() if value is not None}
    for edge in (1.0, 2.0, 7.0, 8.0):
        for value in (math.nextafter(edge, -9.0), edge, math.nextafter(edge, 9.0)):
            good = (
                value > stated.get("above", -math.inf)
                and value >= stated.get("least", -math.inf)
                and value < stated.get("below", math.inf)
                and value <= stated.get("most", math.inf)
            )
            if good:
                assert checked.number("arm", value, **bounds) == value
                continue
            with pytest.raises(GeometryError) as caught:
                checked.number("arm", value, **bounds)
            told = caught.value.message
            low = "from 2" if "least" in stated else "above 1" if "above" in stated else ""
            high = "to 7" if "most" in stated else "below 8" if "below" in stated else ""
            joint = {"to 7": " " if low else " up ", "below 8": " and " if low else " "}.get(high)
            assert told == f"must be a number{' ' if low else ''}{low}{joint or ''}{high}"
    with pytest.raises(GeometryError) as caught:
        checked.number("arm", math.nan, unit="mm", **bounds)
    assert caught.value.message.endswith(" (mm)")
    if not stated:
        assert caught.value.message == "must be a finite number (mm)"


def test_magnitudes_end_at_their_limits() -> None:
    for largest in (checked.LARGEST, 1e50):
        for value in (largest, -largest):
            assert checked.number("arm", value, largest=largest) == value
            beyond = math.nextafter(value, math.copysign(math.inf, value))
            with pytest.raises(GeometryError) as caught:
                checked.number("arm", beyond, largest=largest)
            assert caught.value.message == f"must be at most {largest:g} in magnitude"
        assert checked.array("t", [largest], largest=largest).tolist() == [largest]
        beyond = math.nextafter(largest, math.inf)
        with pytest.raises(GeometryError, match="finite numbers, at most"):
            checked.array("t", [-beyond], largest=largest)
    below = math.nextafter(checked.SMALLEST, 0.0)
    assert checked.number("arm", below, least=0.0) == below
    with pytest.raises(GeometryError) as caught:
        checked.positive("arm", below)
    assert caught.value.message == "must be at least 1e-30"
    assert checked.number("arm", 1.0 + below, above=1.0 - 1e-9) == 1.0


STEPS = (Decimal("0.1"), Decimal("0.5"))


STEP, POINT = "must be a step from 0.1 to 0.5 (deg)", "must be a point x + i y, a complex number"
WHOLE, FINITE = "must be a whole number from 2 to 7", "must be finite numbers, at most 1e+30 in"

REFUSED: list[tuple[Callable[..., object], tuple[Any, ...], str, str]] = [
    *(
        (checked.one_of, (value, (1, -1)), told, "must be one of 1, -1")
        for value, told in (
            (True, "True"), (0, "0.0"), (None, "None"), ("1", "1"), (math.nan, "nan"),
            (np.ones(2), "array([1., 1.])"), ([1], "[1]"),
        )
    ),
    (checked.one_of, (1, ("R-R",)), "1.0", 'must be one of "R-R"'),
    *(
        (checked.decimal, (value, *STEPS, *unit), told, message)
        for value, told in (
            (Decimal("0.09999999999999999999"), "0.09999999999999999999"),
            (Decimal("0.50000000000000000001"), "0.50000000000000000001"),
            (math.nextafter(0.1, 0.0), "0.09999999999999999"), (0.6, "0.6"), (1, "1.0"),
            (math.nan, "nan"), (-math.inf, "-inf"), (Decimal("NaN"), "NaN"),
            (Decimal("Infinity"), "Infinity"), ("0.2", "0.2"), (True, "True"), (None, "None"),
        )
        for unit, message in (
            (("deg", "step"), STEP), (("", "number"), "must be a number from 0.1 to 0.5"),
        )
    ),
    (checked.point, (complex(math.nan, 1.0), "mm"), "nan", "must be a finite number (mm)"),
    (checked.point, (complex(1.0, -math.inf), "mm"), "-inf", "must be a finite number (mm)"),
    (checked.point, (True, "mm"), "True", POINT),
    (checked.point, ((1.0, 2.0), "mm"), "(1.0, 2.0)", POINT),
    *(
        (checked.whole, (value, 2, 7), told, WHOLE)
        for value, told in (
            (4.0, "4.0"), (True, "True"), (None, "None"), ("2", "2"), (1, "1.0"), (8, "8.0"),
            (-(10**400), "-inf"),
        )
    ),
    *(
        (checked.instances, (values, (int,), "parts"), told, "must be a sequence of parts")
        for values, told in (([1, 2.5], "2.5"), (7, "7.0"), ({"a": 1}, "{'a': 1}"))
    ),
    (checked.by_name, ([1.0],), "[1.0]", "must be numbers by name"),
    (checked.by_name, ({1: 2.0},), "1.0", "must be numbers by name"),
    (checked.by_name, ({"key": "x"},), "x", "must be a finite number"),
    (checked.by_name, ({"key": 1e40},), "1e+40", "must be at most 1e+30 in magnitude"),
    (checked.array, ("12", 1), "12", "must be a row of numbers"),
    (checked.array, ([1.0], 2), "[1.0]", "must be rows of numbers of equal length"),
    (checked.array, ([[1.0], [2.0, 3.0]], 2), "[[1.0], [2.0, 3.0]]",
     "must be rows of numbers of equal length"),
    (checked.array, ([[1.0, 2.0], [3.0, -2e30]], 2), "-2e+30",
     f"{FINITE} magnitude; number 4 of them is not"),
    (checked.array, ([math.nan, math.inf], 1), "nan",
     f"{FINITE} magnitude; number 1 of them is not"),
]  # fmt: skip
"""A check with what it is given, the value that it tells, and its message."""


@pytest.mark.parametrize(("check", "given_", "told", "message"), REFUSED)
def test_what_is_wrong_is_told(
    check: Callable[..., object], given_: tuple[Any, ...], told: str, message: str
) -> None:
    with pytest.raises(GeometryError) as caught:
        check("key", *given_)
    assert (caught.value.key, caught.value.value, caught.value.message) == ("key", told, message)


def test_what_is_right_is_given_back() -> None:
    assert checked.one_of("direction", np.int64(-1), (1, -1)) == -1
    assert checked.one_of("task", "R-R", ("R-R", "R-U")) == "R-R"
    assert checked.point("pivot", 3) == 3 + 0j
    assert checked.point("pivot", -1.5 + 2j, "mm") == -1.5 + 2j
    assert [checked.whole("count", each, 2, 7) for each in (2, 7, np.int64(3))] == [2, 7, 3]
    assert checked.instances("motion", [1, "a"], (int, str), "parts") == (1, "a")
    assert checked.instances("motion", (), (int,), "parts") == ()
    assert [checked.among(each, {"a": 1}) for each in ("a", "b", ["a"])] == [True, False, False]
    assert checked.by_name("parameters", {"v": 1e40}, 1e50) == {"v": 1e40}


def test_numbers_by_name_are_read_only() -> None:
    given_values = {"v0": 1, "a0": np.float32(2.5)}
    found = checked.by_name("parameters", given_values)
    given_values["v0"] = 9
    assert list(found.items()) == [("v0", 1.0), ("a0", 2.5)]
    assert isinstance(found, MappingProxyType)


@pytest.mark.parametrize(
    ("value", "found"),
    [
        (0.1, "0.1"),
        (0.5, "0.5"),
        (0.2, "0.2"),
        (Decimal("0.30000000000000000001"), "0.30000000000000000001"),
        (np.float64(0.2), "0.2"),
        (Fraction(1, 4), "0.25"),
    ],
)
def test_a_decimal_number_is_the_one_that_is_printed(value: Any, found: str) -> None:
    assert checked.decimal("step", value, *STEPS) == Decimal(found)
    assert checked.decimal("step", 3, Decimal(1), Decimal(3)) == 3
    whole = 10**20 + 1
    assert checked.decimal("step", whole, Decimal(1), Decimal(2 * whole)) == whole


@dataclass(frozen=True)
class Wheel:
    radius: checked.Positive


@dataclass(frozen=True)
class Cart:
    """Each kind of field that is checked, and one that is not."""

    wheel: Wheel
    spare: Wheel | None
    load: checked.Finite | None
    length: Annotated[float, checked.positive, "cart.size"]
    places: checked.Row
    name: str = ""

    def __post_init__(self) -> None:
        checked.check_fields(self, "shop.")


def test_fields_are_what_their_annotations_say() -> None:
    given_values: dict[str, Any] = {"length": np.int64(3), "places": [1, 2]}
    cart = Cart(Wheel(2), None, None, **given_values)
    assert type(cart.length) is float
    assert cart.places.tolist() == [1.0, 2.0]
    assert not cart.places.flags.writeable
    given_values["name"] = 7  # which has no check
    assert Cart(Wheel(2), Wheel(1), 4, **given_values).load == 4.0


@pytest.mark.parametrize(
    ("changed", "key", "message"),
    [
        ({"wheel": None}, "shop.wheel", "must be a `Wheel`"),
        ({"wheel": 2.0}, "shop.wheel", "must be a `Wheel`"),
        ({"spare": "round"}, "shop.spare", "must be a `Wheel`"),
        ({"load": "much"}, "shop.load", "must be a finite number"),
        ({"length": None}, "shop.cart.size", "must be a number above 0"),
        ({"length": -1.0}, "shop.cart.size", "must be a number above 0"),
        ({"places": None}, "shop.places", "must be a row of numbers"),
    ],
)
def test_fields_that_are_wrong_are_told_by_their_keys(
    changed: dict[str, Any], key: str, message: str
) -> None:
    given_values: dict[str, Any] = {
        "wheel": Wheel(2.0), "spare": None, "load": 1.0, "length": 3.0, "places": [1.0]
    }  # fmt: skip
    with pytest.raises(GeometryError) as caught:
        Cart(**(given_values | changed))
    assert (caught.value.key, caught.value.message) == (key, message)


@pytest.mark.parametrize("what", ["a" * 60, "a" * 61, "a" * 57 + "bcd", [1] * 60, 10**400])
def test_values_are_shown_up_to_sixty_characters(what: Any) -> None:
    found = checked.value_text(what)
    assert len(found) <= checked.LONGEST
    if isinstance(what, str):
        assert found == (what if len(what) <= 60 else what[:57] + "...")
    assert checked.value_text(10**400) == "inf"
    assert checked.value_text(-(10**400)) == "-inf"
    assert checked.value_text(Fraction(1, 2)) == "0.5"


# Tables with columns that may be missing; lift tables test the format itself ----------------------
ASKED = RequestedColumns(
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
        (
            "x [cm],y\n1,2\n",
            "line 1: 'x \\[cm\\]': the unit of the x is unknown; allowed: mm or inch",
        ),
        ("1,2\n" * 4, "line 4: 4 rows of numbers; allowed: 1 to 3"),
        ("x,y\n", "line 2: 0 rows of numbers"),
        (
            "1;2\n1,5;2.5\n",
            "line 2: '2.5': the numbers above have the decimal mark ','; allowed: one mark",
        ),
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
    asked = RequestedColumns(ASKED.required, fewest=2, most=6)
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
        ("", "points.csv, line 1: there are no rows; allowed: 2 or more", ""),
        ("\n# a\n\n", "points.csv, line 4: there are no rows; allowed: 2 or more", ""),
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
                "points.csv, line 1: '1': there is only one column; allowed separators: semicolon,"
                " tab, comma, blanks"
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
            "points.csv, line 1: 'x [inches]': the unit of the x is unknown; allowed: mm or inch",
            "x [inches]",
        ),
    ],
)
def test_a_fault_is_told_with_its_line_and_what_is_allowed(
    data: bytes | str, message: str, value: str
) -> None:
    with pytest.raises(GeometryError) as caught:
        read_columns(data, "points.csv", RequestedColumns(ASKED.required, fewest=2, most=5))
    assert (caught.value.message, caught.value.value) == (message, value)


LONG = "0." + "1" * (DIGITS - 2)


def wide_table(columns: int) -> str:
    """Two rows under a heading of so many columns."""
    heads = ["x", "y", *(f"c{k}" for k in range(columns - 2))]
    return "\n".join([",".join(heads), *[",".join(map(str, range(columns)))] * 2, ""])


def test_limits_of_tables_are_allowed_and_one_more_is_not() -> None:
    asked = RequestedColumns(ASKED.required, fewest=2, most=5)
    for rows in (2, 5):
        assert read_columns(table(rows), "points.csv", asked).values.shape == (2, rows)
    assert read_columns("1,1e30\n1,-1e30\n", "points.csv", asked).values[1].tolist() == [
        1e30,
        -1e30,
    ]
    assert read_columns(f"1,2\n3,{LONG}\n", "points.csv", asked).values[1, 1] == float(LONG)
    with pytest.raises(GeometryError, match="not a number"):
        read_columns(f"1,2\n3,{LONG}1\n", "points.csv", asked)
    wide = read_columns(wide_table(MOST_COLUMNS), "points.csv", asked).values
    assert wide.tolist() == [[0, 0], [1, 1]]
    with pytest.raises(GeometryError) as caught:
        read_columns(wide_table(MOST_COLUMNS + 1), "points.csv", asked)
    assert caught.value.message.startswith("points.csv, line 1: 'x,y,c0")
    assert caught.value.message.endswith("1,001 columns or more; allowed: at most 1,000")
    assert (caught.value.value[-3:], len(caught.value.value)) == ("...", 60)
    spaces = " " * (LONGEST_HEADING - 5)
    assert read_columns(f"x,y{spaces}[kg]\n1,2\n3,4\n", "points.csv", asked).units == ("", "kg")
    with pytest.raises(GeometryError, match="0 columns of y"):  # a name alone
        read_columns(f"x,y{spaces} [kg]\n1,2\n3,4\n", "points.csv", asked)


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
            with pytest.raises(
                GeometryError, match=r"the numbers above have the decimal mark '\.'"
            ):
                read_columns(text, "points.csv", ASKED)
        else:
            found = read_columns(text, "points.csv", ASKED)
            assert found.values.tolist() == [[1.0, -1.0], [5.0, 2.0]]
