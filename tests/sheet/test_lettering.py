"""Widths of texts, against the font itself; standard scales."""

from __future__ import annotations

from fractions import Fraction

import pytest
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import TextPath

from camgeo.pictures.sheet.marks import NARROWED, squeeze, width_of, wrapped
from camgeo.pictures.sheet.sheet import scale_of, scales, spelled


@pytest.mark.parametrize("text", ["0123456789", "The quick brown fox", "Rolle 14 mm (88.84)"])
def test_widths_are_those_of_the_font(text: str) -> None:
    font = FontProperties(family="DejaVu Sans")
    capital = TextPath((0, 0), "H", size=100.0, prop=font).get_extents().height
    wide = TextPath((0, 0), f"|{text}|", size=100.0, prop=font).get_extents().width
    bars = TextPath((0, 0), "||", size=100.0, prop=font).get_extents().width
    assert width_of(text, 1.0) == pytest.approx(NARROWED * (wide - bars) / capital, rel=0.03)


def test_long_texts_are_narrowed_or_wrapped() -> None:
    text = "a text that is much too long for its field"
    assert width_of(text, 2.5) * squeeze(text, 2.5, 20.0) == pytest.approx(20.0)
    assert squeeze("short", 2.5, 20.0) == squeeze(text, 2.5, 0.0) == 1.0
    lines = wrapped(text, 2.5, 30.0)
    assert " ".join(lines) == text
    assert all(width_of(each, 2.5) <= 30.0 for each in lines)


def test_scales_are_those_of_the_standard() -> None:
    """ISO 5455, table 1, and its decades."""
    found = scales()
    assert list(found) == sorted(found, reverse=True)
    stated = ["50:1", "20:1", "10:1", "5:1", "2:1", "1:1", "1:2", "1:5", "1:10", "1:20", "1:50"]
    assert [spelled(each) for each in found[:11]] == stated
    assert all(scale_of(spelled(each)) == each for each in found)
    assert scale_of("1:2") == Fraction(1, 2)
