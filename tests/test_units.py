"""Texts restated in inches, counts that agree with their nouns, places that are named once."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.errors import distinct_texts
from camgeo.units import (
    TURN,
    at_cam_angles,
    cam_angle,
    cam_angle_range,
    clock,
    counted,
    in_unit,
    listed,
    unit_and_divisor,
)


@pytest.mark.parametrize(
    ("mm", "inch"),
    [
        ("17.5 mm, between bolt hole 1 and bore", "0.689 inch, between bolt hole 1 and bore"),
        ("at (25.4, -50.80) mm", "at (1, -2.000) inch"),
        ("from -4.77465 to 4.77465 mm/rad, at cam angles 3 and 180 deg",
         "from -0.187978 to 0.187978 inch/rad, at cam angles 3 and 180 deg"),
        ("at X 25.4, Y 50.8 mm", "at X 1, Y 2 inch"),
        ("Z 25.4, 50.8 mm", "Z 1, 2 inch"),
        ("about x, y, z 645.16, 1290.32, 6451.6 kg mm^2", "about x, y, z 1, 2, 10 kg inch^2"),
        ("123 x 115 mm", "4.843 x 4.528 inch"),
        ("between 25.4 and 50.8 mm", "between 1 and 2 inch"),
        ("tool 1, 12.7 mm", "tool 1, 0.5 inch"),
        ("1,270.5 mm", "50.02 inch"),
        ("645.16 mm^2, 16387.064 mm^3", "1 inch^2, 1 inch^3"),
        ("25.4 g mm and 645.16 kg mm^2", "1 g inch and 1 kg inch^2"),
        ("-6.0164e+10 mm/s^3", "-2.3687e+09 inch/s^3"),
        ("at least 8.46667 mm, at most 8.46667 mm, 8.46667 mm",
         "at least 0.333334 inch, at most 0.333333 inch, 0.333333 inch"),
        ("0 mm", "0 inch"),
        ('3 N/mm, X1.5 mm, "5 mm", file 5 mm.csv and 5 mm/x.dxf',
         '3 N/mm, X1.5 mm, "5 mm", file 5 mm.csv and 5 mm/x.dxf'),
    ],
)  # fmt: skip
def test_texts_in_inches(mm: str, inch: str) -> None:
    assert in_unit(mm, "inch") == inch
    assert in_unit(inch, "inch") == inch
    assert in_unit(mm, "mm") == mm


def test_a_number_that_is_known_exactly() -> None:
    assert in_unit("96 mm, 90 mm", "inch", [96.0]) == "3.77953 inch, 3.543 inch"
    assert in_unit("at least 93.98 mm", "inch", [25.4 * 3.7]) == "at least 3.7 inch"


@given(st.floats(-1e7, 1e7), st.sampled_from([".6g", ".4g", "g", ".4f", ".2f"]))
def test_no_number_is_off_by_more_than_its_digits(value: float, form: str) -> None:
    text = format(value, form)
    found = in_unit(f"{text} mm", "inch").removesuffix(" inch")
    mantissa, _, exponent = found.partition("e")
    last = 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))
    assert float(found) == pytest.approx(float(text) / 25.4, abs=0.51 * last, rel=1e-12)
    digits = re.sub(r"^[-0.]+|\.", "", text.partition("e")[0])
    assert len(digits) < 4 or abs(float(found) - float(text) / 25.4) <= 1e-3 * abs(value) / 25.4


@given(st.integers(1, 99_999), st.integers(0, 5))
def test_a_length_stated_in_inches_comes_back(number: int, decimals: int) -> None:
    stated = number / 10.0**decimals
    assert float(in_unit(f"{25.4 * stated:.10g} mm", "inch").removesuffix(" inch")) == stated


def test_units() -> None:
    assert unit_and_divisor("mm", "inch") == ("inch", 25.4)
    assert unit_and_divisor("mm^2", "inch") == ("inch^2", 25.4**2)
    assert unit_and_divisor("mm/s^3", "inch") == ("inch/s^3", 25.4)
    assert unit_and_divisor("g mm", "inch") == ("g inch", 25.4)
    for other in ("N/mm", "deg", "", "kg"):
        assert unit_and_divisor(other, "inch") == (other, 1.0)
    assert unit_and_divisor("mm", "mm") == ("mm", 1.0)


ROOT = Path(__file__).resolve().parents[1]

NOUNS = (
    "angle|arc|byte|cell|column|contour|corner|edge|facet|fault|file|finding|gap|height|jump|kink"
    "|knot|law|line|lobe|loop|pass|piece|point|quantitie|range|row|scene|segment|shock|vertice"
)
COUNT = re.compile(rf"\{{(?![A-Z_]+\b)[^{{}}]*\}} (?:[a-z]+ )?(?:{NOUNS})s\b")
"""A number, other than a constant, before a noun in the plural, in a formatted text."""


def test_nouns_agree_with_their_numbers() -> None:
    assert counted(1, "shock") == "1 shock"
    assert [counted(number, "shock") for number in (0, 2)] == ["0 shocks", "2 shocks"]
    assert counted(1234, "entity", "entities") == "1,234 entities"
    assert counted(1, "entity", "entities") == "1 entity"


def test_words_are_listed_up_to_a_number() -> None:
    assert [listed("abcd"[:number]) for number in (1, 2, 3)] == ["a", "a and b", "a, b and c"]
    assert listed("abcd", 4) == listed("abcd") == "a, b, c and d"
    assert listed("abcd", 2) == "a, b and 2 more"


def test_a_place_is_named_once() -> None:
    quarter = math.radians(90.0)
    assert at_cam_angles(0.0, 0.0) == at_cam_angles(0.0, TURN) == "at cam angle 0 deg"
    assert at_cam_angles(quarter, quarter + 1e-9) == "at cam angle 90 deg"
    assert at_cam_angles(0.0, quarter) == "at cam angles 0 and 90 deg"
    assert at_cam_angles(quarter, form=".4f") == "at cam angle 90.0000 deg"
    assert cam_angle_range(quarter, quarter + 1e-9) == "at cam angle 90 deg"
    assert cam_angle_range(quarter, TURN + 0.5 * quarter) == "from cam angle 90 to 45 deg"
    assert cam_angle_range(0.0, TURN) == "over the whole turn"


@given(st.floats(-50.0, 50.0), st.sampled_from((".4f", ".6g", ".6f")))
def test_a_cam_angle_is_below_a_turn(angle: float, form: str) -> None:
    shown = float(cam_angle(angle, form))
    assert 0.0 <= shown < 360.0
    off = (math.radians(shown) - angle + math.pi) % TURN - math.pi
    assert abs(off) <= math.radians(5.1e-4 if form == ".6g" else 5.1e-5) + 1e-14


@pytest.mark.parametrize("folder", ["camgeo", "export"])
def test_messages_count_with_counted(folder: str) -> None:
    """No text has a plural after a number that may be 1."""
    found = [
        f"{path.relative_to(ROOT)}: {match[0]}"
        for path in sorted((ROOT / folder).rglob("*.py"))
        for match in COUNT.finditer(path.read_text(encoding="utf-8"))
    ]
    assert found == []


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(0.4, "0 s"), (59.6, "1:00 min"), (187.0, "3:07 min"), (3599.7, "1:00:00 h"),
     (3787.0, "1:03:07 h")],
)  # fmt: skip
def test_times_to_the_second(seconds: float, text: str) -> None:
    assert clock(seconds) == text


@given(st.floats(1e-9, 1e3), st.integers(0, 40))
def test_numbers_that_differ_are_told_apart(one: float, steps: int) -> None:
    """Down to neighbouring floating-point numbers, and no longer than they must be."""
    other = one
    for _ in range(steps):
        other = math.nextafter(other, math.inf)
    less, more = distinct_texts(one, other)
    assert (float(less) < float(more)) == (one != other)
    assert distinct_texts(0.005, 0.005000012) == ("0.005", "0.00500001")
    assert distinct_texts(0.005, 0.0095) == ("0.005", "0.0095")
