"""Nothing is written across edges, lines and other texts, wherever features are."""

from __future__ import annotations

import numpy as np
import pytest

from camgeo.pictures.sheet import placing
from camgeo.pictures.sheet.marks import Chain, Label, Mark, Round
from camgeo.pictures.sheet.placing import Ink, Options
from camgeo.pictures.sheet.sheet import sheets_of
from camgeo.units import LengthUnit
from tests.long_form import LONG
from tests.sheet.sheets import (
    EDGES,
    PARTS,
    TOLERANCE,
    crossed,
    overlaps,
    part,
    sheets,
    text_boxes,
)

ANGLES = (0, 15, 30, 45, 75, 90, 110, 135, 165, 180, 200, 225, 255, 270, 300, 330)

EVERY = [(name, angle, size) for name in PARTS for angle in ANGLES for size in ("A3", "A4")]

FEW = [
    ("hub", 255, "A3"), ("bolts", 255, "A3"), ("hub and bolts", 255, "A3"),
    ("hub and bolts", 30, "A4"), ("lightened", 110, "A4"), ("flat", 200, "A3"),
    ("small", 75, "A4"), ("thick", 330, "A3"), ("plain", 165, "A4"),
]  # fmt: skip


def unreadable(name: str, angle: float, size: str) -> list[tuple[str, str]]:
    """Texts of a part's sheets that are drawn across others, or that edges are drawn across."""
    (sheet,) = sheets_of(part(name, angle, sheet=size), TOLERANCE)
    texts = text_boxes(sheet)
    return [*overlaps(texts), *crossed(texts, sheet, EDGES)]


@pytest.mark.parametrize(("name", "angle", "size"), EVERY if LONG else FEW)
def test_every_text_is_clear(name: str, angle: float, size: str) -> None:
    assert unreadable(name, angle, size) == []


def test_texts_that_stand_where_they_would_first_are_found(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The same check, of places that look at nothing."""

    def first(options: Options, ink: Ink, scale: float, unit: LengthUnit) -> tuple[Mark, ...]:
        return next((tuple(marks) for _, marks in iter(options)), ())

    monkeypatch.setattr(placing, "chosen", first)
    found = unreadable("hub and bolts", 255, "A3")
    assert any(layer == "OUTLINE" for _, layer in found)
    assert any(layer in ("DIMENSION", "SYMBOL") for _, layer in found)


def test_holes_in_the_plane_have_centre_lines_in_the_section() -> None:
    """Of four holes at 0, 90, 180 and 270 degrees two are cut; the disc is 10 thick."""
    (sheet,) = sheets_of(part("hub and bolts", 0, sheet="A3"), TOLERANCE)
    found = [mark for mark in sheet.views[1].marks
             if isinstance(mark, Chain) and mark.layer == "CENTRE"]  # fmt: skip
    for level in (-25.0, 25.0):
        ends = np.concatenate([m.vertices for m in found if abs(m.vertices[0].imag - level) < 1e-9])
        assert (ends.real.min(), ends.real.max()) == pytest.approx((10.0, 24.0))


@pytest.mark.parametrize(("name", "number"), [("setzhub", ""), ("groove", "2x")])
def test_the_tolerance_holds_all_around_each_flank(name: str, number: str) -> None:
    (sheet,) = sheets(name)
    marks = sheet.views[0].marks
    rounds = [each for each in marks if isinstance(each, Round) and each.layer == "SYMBOL"]
    assert [each.radius * sheet.scale for each in rounds] == pytest.approx([1.5])
    texts = [each.text for each in marks if isinstance(each, Label)]
    assert [each for each in texts if each.endswith("x")] == [number] * bool(number)


def test_surfaces_that_differ_are_announced_in_brackets() -> None:
    for flank, there in (("Ra 0.8", True), (None, False)):
        (sheet,) = sheets_of(part("plain", 0, flank_surface=flank), TOLERANCE)
        texts = [each.text for each in sheet.marks if isinstance(each, Label)]
        assert ("(" in texts) == there
        assert "Ra 3.2" in texts
