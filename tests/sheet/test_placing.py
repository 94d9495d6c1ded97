"""Texts of a sheet: their widths, where they stand, and what cannot be read."""

from __future__ import annotations

import cmath
import math
from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import TextPath

from camgeo.pictures.sheet.marks import (
    NARROWED,
    Chain,
    Distance,
    Sheet,
    View,
    line,
    number_of,
    squeeze,
    width_of,
)
from camgeo.pictures.sheet.placing import Ink, across, boxes, cleared, dots, findings_of
from camgeo.pictures.sheet.section import placed
from camgeo.pictures.sheet.sheet import scale_of, scales, sheets_of, spelled
from camgeo.pictures.sheet.texts import wrapped
from tests.sheet.sheets import TOLERANCE, part, sheets


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


BOX = boxes([(10 + 0j, 1.0 + 0j, 6.0, 2.0)])


def test_lines_are_interrupted_at_texts_and_nothing_else_is() -> None:
    found = list(cleared([line(0j, 20 + 0j, "CENTRE")], Ink(frames=BOX), 1.0))
    ends = [[complex(end) for end in each.vertices] for each in found if isinstance(each, Chain)]
    assert ends == [[0j, pytest.approx(7)], [pytest.approx(13), 20 + 0j]]
    away = line(5j, 20 + 5j, "CENTRE")
    outline = line(0j, 20 + 0j, "OUTLINE")
    assert list(cleared([away, outline], Ink(frames=BOX), 1.0)) == [away, outline]


@given(
    size=st.floats(0.1, 500.0), turn=st.floats(-7.0, 7.0), scale=st.sampled_from([0.1, 1.0, 10.0])
)
def test_placing_changes_no_measure_and_keeps_texts_upright(
    size: float, turn: float, scale: float
) -> None:
    along = cmath.rect(1.0, turn)
    mark = Distance(3 + 4j, 3 + 4j + size * along, 5 + 5j, turn)
    for price, (first, *rest) in placed(mark, scale, "mm", along):
        assert isinstance(first, Distance)
        assert first.measure == pytest.approx(size, rel=1e-9)
        assert -0.5 * math.pi < first.angle <= 0.5 * math.pi + 1e-9
        assert {first.first, first.second} == {mark.first, mark.second}
        assert bool(first.aside) == bool(rest)
        assert price >= 0.0


@pytest.mark.parametrize(
    ("size", "unit", "decimals", "text"),
    [(16.0, "mm", 4, "16"), (18.30000001, "mm", 3, "18.3"), (100.0, "mm", 0, "100"),
     (4.7625, "inch", 5, "0.1875"), (1200.0, "mm", 2, "1200")],
)  # fmt: skip
def test_numbers_have_no_zeros_at_their_end(
    size: float, unit: str, decimals: int, text: str
) -> None:
    mark = Distance(0j, size + 0j, 0j, prefix="%%c", suffix=" H7", decimals=decimals)
    assert number_of(mark, "inch" if unit == "inch" else "mm") == f"%%c{text} H7"


def with_marks(sheet: Sheet, *marks: Chain | Distance) -> Sheet:
    view = sheet.views[0]
    return replace(sheet, views=(replace(view, marks=(*view.marks, *marks)), *sheet.views[1:]))


def test_usual_sheets_are_readable() -> None:
    for name in ("setzhub", "ring", "inch"):
        assert [list(findings_of(each)) for each in sheets(name)] == [[]]


def test_a_line_across_a_text_is_told() -> None:
    (sheet,) = sheets("setzhub")
    distances = [each for each in sheet.views[0].marks if isinstance(each, Distance)]
    (mark,) = (each for each in distances if each.prefix == "(" and each.angle == 0.0)
    middle = 0.5 * (mark.first.real + mark.second.real) + 1j * mark.line.imag
    wrong = with_marks(sheet, line(middle, middle + 10j, "OUTLINE"))
    assert list(across(wrong.views[0], wrong)) == ["(69.53)"]
    (found,) = findings_of(wrong)
    assert found.severity == "warning"
    assert 'lines across 1 text ("(69.53)")' in found.sentence


def test_two_texts_in_one_place_are_told() -> None:
    (sheet,) = sheets("setzhub")
    view = View(0j, tuple(Distance(0j, 40 + 0j, 10j + 1j * lift) for lift in (0.0, 1.0)))
    assert list(across(view, sheet)) == ["40", "40"]


def test_outlines_that_are_dots_are_told_with_their_place() -> None:
    """A dot of 2 mm at radius 25 and 30 degrees, at 1 : 5."""
    (sheet,) = sheets_of(part("hub and bolts", 30, sheet="A3", scale="1:5"), TOLERANCE)
    ((width, at),) = dots(sheet)
    assert width == pytest.approx(0.4, abs=0.01)
    assert at == pytest.approx(25.0 * (0.75**0.5 + 0.5j), abs=0.01)
    sentences = [each.sentence for each in findings_of(sheet)]
    assert any("1 outline as a dot, 0.4 mm wide on paper, at (21.65 / 12.5)" in each
               for each in sentences)  # fmt: skip
