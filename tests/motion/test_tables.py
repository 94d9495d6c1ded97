"""Tables of lift and of speed: what is read, refusals with file and line, and their splines. Value
tables of laws: the guideline's own four are equal in every cell but the listed ones.

`fixtures/tables` holds the tables as printed and two lists of the cells that are not the exact
value rounded: misprints, and last digits cut off or rounded the wrong way.
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Iterable
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.app.answers.table import LARGEST_STEP_OF_Z, NAMES, SMALLEST_STEP_OF_Z, law_table
from camgeo.errors import GeometryError
from camgeo.kinematics.laws import make_law
from camgeo.kinematics.splines import Spline
from camgeo.kinematics.tables import TwoColumns
from camgeo.kinematics.time_course import SpeedCurve
from camgeo.numeric.columns import MOST_ROWS
from camgeo.reading import TABLE
from camgeo.units import TURN
from tests.long_form import examples


def columns(table: TwoColumns) -> tuple[list[float], list[float]]:
    return table.first.tolist(), table.second.tolist()


EXPECTED = ([0.0, 90.5, 360.0], [0.0, 1.25, -0.5])


@pytest.mark.parametrize(
    "text",
    [
        "0,0\n90.5,1.25\n360,-0.5\n",
        "0;0\n90.5;1.25\n360;-.5\n",
        "0;0\r\n90,5;1,25\r\n360;-0,5",
        "0\t0\r90,5\t1,25\r360\t-,5\r",
        "\ufeff# measured\n\n  # twice\n0 , 0\n 90.50,+1.25e0\n3.6E2, -5e-1\n\n",
        "phi [deg],s [mm]\n0,0\n90.5,1.25\n360,-0.5\n",
        '"Angle (°)"; "Lift (mm)"\n0;0\n90,5;1,25\n360;-0,5\n',
        "# x\ns [mm]\tv\tCam angle [DEG]\n0\tn/a\t0\n1.25\t\t90.5\n-0.5\t7\t360\n",
    ],
)
def test_all_ways_of_writing_read_the_same(text: str) -> None:
    table = TwoColumns.of_lifts(text, "lift.csv")
    assert columns(table) == EXPECTED
    assert columns(TwoColumns.of_lifts(text.encode(), "lift.csv")) == EXPECTED
    assert table.unit == ("mm" if "mm" in text else "")
    assert not table.second.flags.writeable


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("", 1, "there are no rows; allowed: 2 or more"),
        ("# nothing\n", 2, "no rows"),
        ("0,0\n", 1, "1 row of numbers; allowed: 2"),
        ("phi,s\n", 2, "0 rows of numbers"),
        ("0\n360\n", 1, "allowed separators: semicolon, tab, comma, blanks"),
        ("0,0,1\n360,0,1\n", 1, "3 columns; without a heading 2 are allowed"),
        ("0,5,1,5\n360,0,1,0\n", 1, "4 columns; without a heading 2"),
        ("0,0\n1\n360,0\n", 2, "1 column; allowed: 2"),
        ("0,0\n1,2,3\n360,0\n", 2, "'1,2,3': 3 columns"),
        ("0,0\n1,x\n360,0\n", 2, "'x': not a number"),
        ("0,0\n1,nan\n360,0\n", 2, "'nan': not a number"),
        ("0,0\n1,inf\n360,0\n", 2, "'inf': not a number"),
        ("0,0\n1,1e999\n360,0\n", 2, "'1e999': too large"),
        ("0,0\n1,\n360,0\n", 2, "not a number"),
        ("0,0\n1,1_0\n360,0\n", 2, "'1_0': not a number"),
        ("0;0\n1;1.234,5\n360;0\n", 2, "'1.234,5': not a number"),
        (
            "0;0\n1;1,5\n360;0.5\n",
            3,
            "'0.5': the numbers above have the decimal mark ','; allowed: one mark",
        ),
        ("1,0\n360,0\n", 1, "'1.0': the first angle is not 0; allowed: 0"),
        ("0,0\n\n5,1\n5,2\n360,0\n", 4, "'5.0': the angle does not exceed the one before, 5.0"),
        ("0,0\n5,1\n4,2\n360,0\n", 3, "'4.0': the angle does not exceed the one before, 5.0"),
        (
            "0,0\n5,1\n361,2\n",
            3,
            "'361.0': the angle is beyond the span; allowed: up to 360 degrees",
        ),
        (
            "0,0\n5,1\n359,2\n",
            3,
            "'359.0': the last angle is not the end of the span; allowed: 360",
        ),
        ("phi,lift,s\n0,0,0\n360,0,0\n", 1, "2 columns of lift; allowed: one, called s or lift"),
        ("phi,v\n0,0\n360,0\n", 1, "'phi, v': 0 columns of lift"),
        ("a,s\n0,0\n360,0\n", 1, "0 columns of angle; allowed: one, called phi or angle or"),
        (
            "phi [rad],s\n0,0\n360,0\n",
            1,
            r"'phi [rad]': the unit of the angle is unknown; allowed: deg",
        ),
    ],
)
def test_faults_are_reported_with_file_and_line(text: str, line: int, message: str) -> None:
    with pytest.raises(GeometryError) as caught:
        TwoColumns.of_lifts(text, "lift.csv")
    assert caught.value.message.startswith(f"lift.csv, line {line}: ")
    assert message in caught.value.message
    assert "allowed" in caught.value.message


def test_too_much_is_refused() -> None:
    with pytest.raises(GeometryError, match="16,000,001 bytes; allowed: 16,000,000"):
        TwoColumns.of_lifts(b"#" * (TABLE.size + 1), "lift.csv")
    rows = "\n".join(f"{k},0" for k in range(MOST_ROWS + 1))
    with pytest.raises(GeometryError, match=r"line 200001: 200,001 rows of numbers; .* to 200,000"):
        TwoColumns.of_lifts(rows, "lift.csv", MOST_ROWS)


def test_as_much_as_is_allowed_is_read() -> None:
    rows = "\n".join(f"{k},0" for k in range(MOST_ROWS))
    assert len(TwoColumns.of_lifts(rows, "lift.csv", MOST_ROWS - 1).second) == MOST_ROWS


@pytest.mark.parametrize("span", [0.0, -1.0, math.nan, math.inf])
def test_a_poor_span_is_refused(span: float) -> None:
    with pytest.raises(GeometryError, match="must be a number above 0"):
        TwoColumns.of_lifts("0,0\n120,5\n240,2\n360,0\n", "lift.csv", span)


def test_the_last_row_counts_as_the_end_of_the_span_though_rounded() -> None:
    table = TwoColumns.of_lifts("0,0\n40,1\n119.99999999999,2\n", "lift.csv", 120.0)
    assert table.first[-1] == 120.0


def test_a_periodic_table_may_miss_its_closing_row() -> None:
    rows = "".join(f"{k},{math.sin(math.radians(k))!r}\n" for k in range(0, 360, 5))
    table = TwoColumns.of_lifts(rows, "lift.csv", periodic=True)
    assert table.first[-1] == 355.0
    with pytest.raises(GeometryError, match="the end of the span; allowed: 360"):
        TwoColumns.of_lifts(rows, "lift.csv")
    closing = TwoColumns.of_lifts(rows + "360,0\n", "lift.csv", periodic=True)
    spline, closed = (
        Spline.closed(np.radians(each.first), each.second, TURN) for each in (table, closing)
    )
    assert spline.taylor.tolist() == closed.taylor.tolist()
    x = np.linspace(-7.0, 7.0, 57)
    # Interpolation of sin: (pi / 72)^6 / 6! of its sixth derivative, times what splines add.
    np.testing.assert_allclose(spline.values(x, 0)[0], np.sin(x), rtol=0.0, atol=1e-9)


# Tables of speed -------------------------------------------------------------------------------

ROWS = [(0.0, 0.0), (0.1, 30.0), (0.2, 90.0), (0.35, 200.0), (0.5, 300.0), (0.6, 360.0)]


def text(rows: list[tuple[float, float]], heading: str = "") -> str:
    return heading + "".join(f"{time},{angle}\n" for time, angle in rows)


def test_the_disc_is_where_the_rows_say() -> None:
    course = SpeedCurve.read(text(ROWS, "t [s],phi [deg]\n"), "speed.csv")
    angles = np.radians([angle for _, angle in ROWS[:-1]])
    assert course.time(angles) == pytest.approx([time for time, _ in ROWS[:-1]], abs=1e-14)
    omega, alpha, _ = course.rates(angles)
    # By differences over a short time, whose error is h^2/6 of the third derivative, here < 1e-5.
    h = 1e-4
    t = course.time(angles) + 0.3
    mean = (course.spline.values(t + h, 0)[0] - course.spline.values(t - h, 0)[0]) / (2.0 * h)
    assert course.spline.values(t, 1)[1] == pytest.approx(mean, rel=1e-4)
    assert np.all(omega > 0.0)
    assert np.any(np.abs(alpha) > 1.0)
    # One turn takes 0.6 s, whatever the speed between.
    assert course.time(np.array([2.0 * math.pi])) == pytest.approx([0.6], abs=1e-14)


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ([(0.1, 0.0), *ROWS[1:]], "line 1: '0.1': the first time is not 0; allowed: 0"),
        ([(0.0, 1.0), *ROWS[1:]], "line 1: '1.0': the first angle is not 0; allowed: 0"),
        (
            [*ROWS[:2], (0.05, 95.0), *ROWS[2:]],
            "line 3: '0.05': the time does not exceed the one before, 0.1",
        ),
        (
            [*ROWS[:3], (0.3, 80.0), *ROWS[3:]],
            "line 4: '80.0': the angle does not exceed the one before, 90.0",
        ),
        (ROWS[:-1], "line 5: '300.0': the last angle is not a full turn; allowed: 360 degrees"),
        ([(0.0, 0.0), (0.5, 1.0), (0.6, 359.0), (1.0, 360.0)], "stand still or run backwards"),
        ([(0.0, 0.0), (1.0, 360.0)], "allowed: 4 rows or more"),
    ],
)
def test_faults_are_reported(rows: list[tuple[float, float]], message: str) -> None:
    with pytest.raises(GeometryError, match=re.escape(message)):
        SpeedCurve.read(text(rows), "speed.csv")


def test_the_unit_of_the_time_is_seconds() -> None:
    with pytest.raises(GeometryError, match="the unit of the time is unknown; allowed: s"):
        SpeedCurve.read(text(ROWS, "t [ms],phi [deg]\n"), "speed.csv")


# Value tables of laws -----------------------------------------------------------------------------

FOLDER = Path(__file__).parents[2] / "fixtures" / "tables"

TABLES = {
    "polynomial-345": "poly345",
    "inclined-sine": "inclined_sine",
    "modified-trapezoid": "mod_acc_trapezoid",
    "modified-sine": "mod_sine",
}
"""The guideline's laws and what the lists call their tables."""


Cells = dict[tuple[str, str], Any]
"""What cells hold, by z as printed and the column."""


def cells(rows: Iterable[Iterable[str]]) -> Cells:
    return {
        (z, column): text
        for z, *row in rows
        for column, text in zip(("f", "f1", "f2"), row, strict=True)
    }


def read_list(file_name: str, table: str) -> Cells:
    """Cells known not to be the exact value rounded: what is printed, and what ought to be."""
    with (FOLDER / file_name).open(newline="", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["table"] == table]
    found = {(row["z"], row["column"]): (row["printed"], row["correct_rounded"]) for row in rows}
    assert len(found) == len(rows)
    return found


# The guideline's tables -----------------------------------------------------------------------


@pytest.mark.parametrize("name", TABLES)
def test_the_printed_table_differs_in_the_listed_cells_only(name: str) -> None:
    with (FOLDER / f"{name}_printed.csv").open(newline="", encoding="utf-8") as file:
        head, *rows = csv.reader(file)
    assert head == ["z", "f", "f1", "f2"]
    printed = cells(rows)
    assert len(printed) == len(rows) * 3 == 3 * 501
    errata, rounding = (read_list(f"{kind}.csv", TABLES[name]) for kind in ("errata", "rounding"))
    assert not errata.keys() & rounding.keys()
    listed = errata | rounding
    assert all(printed[place] == own != right for place, (own, right) in listed.items())
    computed = cells(law_table(make_law(name), Decimal("0.002")).printed())
    assert computed == printed | {place: right for place, (_, right) in listed.items()}


# The table of any law -------------------------------------------------------------------------

few = settings(max_examples=examples(10, long=60))

steps = st.decimals(SMALLEST_STEP_OF_Z * 200, LARGEST_STEP_OF_Z, allow_nan=False, places=8)


@few
@given(name=st.sampled_from([*TABLES, "quadratic-parabola"]), step=steps)
def test_z_runs_over_the_exact_multiples_and_ends_at_1(name: str, step: Decimal) -> None:
    law = make_law(name)
    table = law_table(law, step)
    exact = [Fraction(z) for z in table.z]
    assert exact[:-1] == [Fraction(step) * number for number in range(len(exact) - 1)]
    assert 0 < exact[-1] - exact[-2] <= Fraction(step)
    assert exact[-1] == 1
    z = table.values[:, 0]
    assert z.tolist() == [float(place) for place in table.z]
    assert table.values.shape == (len(exact), len(NAMES))
    assert np.array_equal(table.values[:, 1:], law(z).T)
    assert not np.any(np.signbit(table.values) & (table.values == 0.0))


def test_a_third_has_all_its_digits() -> None:
    """40 digits are more than decimals are computed with by default."""
    third = Decimal("0." + 40 * "3")
    table = law_table(make_law("modified-sine"), third)
    assert [Fraction(z) for z in table.z[:4]] == [Fraction(third) * number for number in range(4)]
    assert len(table.z) == 5
    assert table.printed()[1][0] == str(third)


@pytest.mark.parametrize(
    "step",
    [
        SMALLEST_STEP_OF_Z * 20,
        # A million rows are made as fifty thousand are.
        pytest.param(SMALLEST_STEP_OF_Z, marks=pytest.mark.long),
    ],
)
def test_the_finest_table(step: Decimal) -> None:
    table, count = law_table(make_law("polynomial-345"), step), int(1 / step)
    assert table.values.shape == (count + 1, 5)
    assert table.values[:, 0].tolist() == [number / count for number in range(count + 1)]


@pytest.mark.parametrize(
    "step",
    [
        *map(Decimal, ("0", "-0.002", "0.0000009", "0.500001", "1", "NaN", "sNaN", "Infinity")),
        *(Decimal("-Infinity"), None, "0.002", 1, math.nan, True),
    ],
)
def test_a_step_outside_the_limits_is_refused(step: Any) -> None:
    with pytest.raises(GeometryError, match=r"a step of z from 0\.000001 to 0\.5") as raised:
        law_table(make_law("modified-sine"), step)
    assert raised.value.key == "step"
    assert not isinstance(step, Decimal) or raised.value.value == str(step)


def test_the_values_of_the_most_extreme_law_are_numbers() -> None:
    """The jerk of an inflection point at 1e-30 has 1e60; none is nearer to the border."""
    with pytest.raises(GeometryError, match="strictly between 0 and 1") as raised:
        make_law("modified-sine", inflection=1e-31)
    assert raised.value.key == "inflection"
    assert 1e60 < law_table(make_law("modified-sine", inflection=1e-30)).values[0, 4] < 1e62


def test_a_float_is_the_decimal_that_it_is_written_as() -> None:
    law = make_law("modified-sine")
    assert law_table(law, 0.1).z == law_table(law, Decimal("0.1")).z


def test_rounding_is_of_the_double_itself() -> None:
    """1/32 = 0.03125 is a tie at four decimals: to the even digit. 0.00015 is not the tie it
    looks like: as a double it is smaller, so it rounds down. What rounds to zero has no sign."""
    table = law_table(make_law("modified-sine"), Decimal("0.5"))
    values = [[0.0, 3 * 2.0**-8, 0.03125, 0.00015, 0.0], [0.5, -4e-8, -4e-5, -0.09375, 0.0]]
    rows = replace(table, z=table.z[:2], values=np.array(values)).printed()
    # 3/256 = 0.01171875 is a tie at seven decimals, 0.09375 one at four.
    assert rows == [
        ("0.000", "0.0117188", "0.0312", "0.0001", ),
        ("0.500", "0.0000000", "0.0000", "-0.0938"),
    ]  # fmt: skip
