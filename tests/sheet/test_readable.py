"""What cannot be read is told, with its place."""

from __future__ import annotations

from dataclasses import replace

import pytest

from camgeo.pictures.sheet.marks import Chain, Distance, Sheet, View, line
from camgeo.pictures.sheet.placing import across, dots, findings_of
from camgeo.pictures.sheet.sheet import sheets_of
from tests.sheet.sheets import TOLERANCE, part, sheets


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
