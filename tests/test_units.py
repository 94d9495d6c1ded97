"""Texts restated in inches."""

from __future__ import annotations

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.units import in_unit, unit_in


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
    found = in_unit(f"{25.4 * stated:.10g} mm", "inch").removesuffix(" inch")
    assert float(found) == stated


def test_units() -> None:
    assert unit_in("mm", "inch") == ("inch", 25.4)
    assert unit_in("mm^2", "inch") == ("inch^2", 25.4**2)
    assert unit_in("mm/s^3", "inch") == ("inch/s^3", 25.4)
    assert unit_in("g mm", "inch") == ("g inch", 25.4)
    for other in ("N/mm", "deg", "", "kg"):
        assert unit_in(other, "inch") == (other, 1.0)
    assert unit_in("mm", "mm") == ("mm", 1.0)
