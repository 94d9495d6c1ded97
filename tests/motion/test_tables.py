"""Tables of lift and of speed: what is read, refusals with file and line, and their splines."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

from camgeo.errors import GeometryError
from camgeo.kinematics.splines import periodic_spline
from camgeo.kinematics.tables import TwoColumns, read_lift_table, read_speed_table
from camgeo.numeric.columns import MOST_ROWS
from camgeo.reading import TABLE
from camgeo.units import TURN

PLAIN = "0,0\n120,5\n240,2\n360,0\n"


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
    table = read_lift_table(text, "lift.csv")
    assert columns(table) == EXPECTED
    assert columns(read_lift_table(text.encode(), "lift.csv")) == EXPECTED
    assert table.unit == ("mm" if "mm" in text else "")
    assert not table.second.flags.writeable


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("", 1, "no rows; allowed: 2 or more"),
        ("# nothing\n", 2, "no rows"),
        ("0,0\n", 1, "1 row of numbers; allowed: 2"),
        ("phi,s\n", 2, "0 rows of numbers"),
        ("0\n360\n", 1, "allowed separators are ; and tab and comma and blanks"),
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
        ("0;0\n1;1,5\n360;0.5\n", 3, "'0.5': the decimals above have ','; allowed: one kind"),
        ("1,0\n360,0\n", 1, "'1.0': the first angle; allowed: 0"),
        ("0,0\n\n5,1\n5,2\n360,0\n", 4, "'5.0': the angle before is 5.0; allowed: only asc"),
        ("0,0\n5,1\n4,2\n360,0\n", 3, "'4.0': the angle before is 5.0"),
        ("0,0\n5,1\n361,2\n", 3, "'361.0': beyond the span; allowed: up to 360 degrees"),
        ("0,0\n5,1\n359,2\n", 3, "'359.0': the last angle; allowed: the end of the span, 360"),
        ("phi,lift,s\n0,0,0\n360,0,0\n", 1, "2 columns of lift; allowed: one, called s or lift"),
        ("phi,v\n0,0\n360,0\n", 1, "'phi, v': 0 columns of lift"),
        ("a,s\n0,0\n360,0\n", 1, "0 columns of angle; allowed: one, called phi or angle or"),
        ("phi [rad],s\n0,0\n360,0\n", 1, r"'phi [rad]': the unit of the angle; allowed: deg"),
    ],
)
def test_faults_are_reported_with_file_and_line(text: str, line: int, message: str) -> None:
    with pytest.raises(GeometryError) as caught:
        read_lift_table(text, "lift.csv")
    assert caught.value.message.startswith(f"lift.csv, line {line}: ")
    assert message in caught.value.message
    assert "allowed" in caught.value.message


def test_too_much_is_refused() -> None:
    with pytest.raises(GeometryError, match="16,000,001 bytes; allowed: 16,000,000"):
        read_lift_table(b"#" * (TABLE.size + 1), "lift.csv")
    rows = "\n".join(f"{k},0" for k in range(MOST_ROWS + 1))
    with pytest.raises(GeometryError, match=r"line 200001: 200,001 rows of numbers; .* to 200,000"):
        read_lift_table(rows, "lift.csv", MOST_ROWS)


def test_as_much_as_is_allowed_is_read() -> None:
    rows = "\n".join(f"{k},0" for k in range(MOST_ROWS))
    assert len(read_lift_table(rows, "lift.csv", MOST_ROWS - 1).second) == MOST_ROWS


@pytest.mark.parametrize("span", [0.0, -1.0, math.nan, math.inf])
def test_a_poor_span_is_refused(span: float) -> None:
    with pytest.raises(GeometryError, match="must be a number above 0"):
        read_lift_table(PLAIN, "lift.csv", span)


def test_the_last_row_counts_as_the_end_of_the_span_though_rounded() -> None:
    table = read_lift_table("0,0\n40,1\n119.99999999999,2\n", "lift.csv", 120.0)
    assert table.first[-1] == 120.0


def test_a_periodic_table_may_miss_its_closing_row() -> None:
    rows = "".join(f"{k},{math.sin(math.radians(k))!r}\n" for k in range(0, 360, 5))
    table = read_lift_table(rows, "lift.csv", periodic=True)
    assert table.first[-1] == 355.0
    with pytest.raises(GeometryError, match="the end of the span, 360"):
        read_lift_table(rows, "lift.csv")
    closing = read_lift_table(rows + "360,0\n", "lift.csv", periodic=True)
    spline, closed = (
        periodic_spline(np.radians(each.first), each.second, TURN) for each in (table, closing)
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
    course = read_speed_table(text(ROWS, "t [s],phi [deg]\n"), "speed.csv")
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
        ([(0.1, 0.0), *ROWS[1:]], "line 1: '0.1': the first time; allowed: 0"),
        ([(0.0, 1.0), *ROWS[1:]], "line 1: '1.0': the first angle; allowed: 0"),
        ([*ROWS[:2], (0.05, 95.0), *ROWS[2:]], "line 3: '0.05': the time before is 0.1"),
        ([*ROWS[:3], (0.3, 80.0), *ROWS[3:]], "line 4: '80.0': the angle before is 90.0"),
        (ROWS[:-1], "line 5: '300.0': the last angle; allowed: 360 degrees"),
        ([(0.0, 0.0), (0.5, 1.0), (0.6, 359.0), (1.0, 360.0)], "stand still or run backwards"),
        ([(0.0, 0.0), (1.0, 360.0)], "allowed: 4 rows or more"),
    ],
)
def test_faults_are_reported(rows: list[tuple[float, float]], message: str) -> None:
    with pytest.raises(GeometryError, match=re.escape(message)):
        read_speed_table(text(rows), "speed.csv")


def test_the_unit_of_the_time_is_seconds() -> None:
    with pytest.raises(GeometryError, match="the unit of the time; allowed: s"):
        read_speed_table(text(ROWS, "t [ms],phi [deg]\n"), "speed.csv")
