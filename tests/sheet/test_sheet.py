"""Every fixture scene's sheet: in its frame, readable, with true dimensions; some as kept."""

from __future__ import annotations

import cmath
import math
import re
import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import groupby
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import TextPath

import camgeo
from camgeo.design.design import Design
from camgeo.errors import SceneError
from camgeo.numeric.arrays import ComplexArray
from camgeo.pictures.sheet import marks, texts
from camgeo.pictures.sheet.marks import (
    NARROWED,
    Chain,
    Diameter,
    Distance,
    Filled,
    Hatched,
    Ink,
    Label,
    Mark,
    Options,
    Round,
    Sheet,
    View,
    across,
    boxes,
    dimension_text,
    dots,
    line,
    text_width,
)
from camgeo.pictures.sheet.section import placed
from camgeo.pictures.sheet.sheet import build_sheets, parse_scale, scales, spelled
from camgeo.pictures.sheet.texts import LEFT, MARGIN, TABLE, wrapped
from camgeo.scene.scene import load_scene, parse_scene
from camgeo.units import LengthUnit
from tests import kept
from tests.long_form import LONG
from tests.sheet.sheets import (
    EDGES,
    FIXTURES,
    FULL,
    HUBBED,
    PARTS,
    ROUNDING,
    SCENES,
    TOLERANCE,
    crossed,
    edited,
    line_of,
    overlaps,
    part,
    products,
    sheets,
    text_boxes,
    text_of,
)

KINDS = [
    (name, ("A3", "A4")[number % 2], ("en", "de")[number // 2 % 2])
    for number, name in enumerate(SCENES)
]
"""Each scene on one of the sheets, in one of the languages."""

PAPER = {"A3": (420.0, 297.0), "A4": (210.0, 297.0)}
"""Trimmed sheets of ISO 216 [mm]."""


WALLS = ("OUTLINE", "SECTION", "EDGES")
"""Layers of the lines that dimensions end on."""


def _paper(view: View, sheet: Sheet, points: ComplexArray) -> ComplexArray:
    """Points of a view on the sheet."""
    return np.asarray(view.origin + points * sheet.scale, np.complex128)


def points_of(sheet: Sheet) -> ComplexArray:
    """Points of all that the views draw [mm of paper]."""
    found: list[ComplexArray] = []
    for view in sheet.views:
        for mark in view.marks:
            if isinstance(mark, Chain):
                found.append(_paper(view, sheet, mark.vertices))
            elif isinstance(mark, Round):
                sides = mark.centre + mark.radius * np.array([1, 1j, -1, -1j], np.complex128)
                found.append(_paper(view, sheet, sides))
            elif isinstance(mark, Distance):
                ends = np.array([mark.first, mark.second, mark.line], np.complex128)
                found.append(_paper(view, sheet, ends))
    return np.concatenate(found)


@pytest.mark.parametrize(("name", "size", "language"), KINDS)
def test_all_is_inside_the_frame_and_no_text_is_across_another(
    name: str, size: str, language: str
) -> None:
    for sheet in sheets(name, size, language):
        assert (sheet.width, sheet.height) == PAPER[size]
        assert sheet.scale in {float(each) for each in scales()}
        low = complex(LEFT, MARGIN) - ROUNDING * (1 + 1j)
        high = complex(sheet.width - MARGIN, sheet.height - MARGIN) + ROUNDING * (1 + 1j)
        points = points_of(sheet)
        assert low.real < points.real.min()
        assert points.real.max() < high.real
        assert low.imag < points.imag.min()
        assert points.imag.max() < high.imag
        texts = text_boxes(sheet)
        for own in texts:
            if re.fullmatch(r"[1-8A-F]", own.text):
                continue  # of the grid
            for corner in own.corners:
                assert low.real <= corner.real <= high.real, own.text
                assert low.imag <= corner.imag <= high.imag, own.text
        assert overlaps(texts) == []
        assert crossed(texts, sheet, EDGES) == []


@pytest.mark.parametrize(("name", "size", "language"), KINDS)
def test_dimensions_measure_the_part(name: str, size: str, language: str) -> None:
    """What the scene states is measured; definition points are on lines that are drawn."""
    for product, sheet in zip(
        products(name, size, language), sheets(name, size, language), strict=True
    ):
        found = [each.measure for each in sheet.dimensions]
        spec = product.scene.part
        assert spec is not None
        stated = [spec.thickness, spec.rim]
        if product.cam.contact.runs_inside:
            stated.append(spec.bore)
        if spec.keyway is not None and spec.bore is not None:
            stated += [spec.keyway.width, spec.bore + spec.keyway.depth]
        for length in stated:
            if length is not None:
                assert min(abs(each - length) for each in found) <= 1e-9 * length
        for view in sheet.views:
            chains = (mark for mark in view.marks if isinstance(mark, Chain))
            drawn = [line_of(each) for each in chains if each.layer in WALLS]
            for mark in view.marks:
                if isinstance(mark, Distance):
                    for end in (mark.first, mark.second):
                        place = shapely.Point(end.real, end.imag)
                        assert shapely.distance(place, drawn).min() <= 1e-3, mark


def test_what_no_layer_has_is_a_note() -> None:
    """Of all files only the sheet has the hole of a set screw."""
    screw = "set_screw = { diameter = 4, height = 6, angle = 45 }\nhub ="
    scene = parse_scene(HUBBED.replace("hub =", screw)).with_values(edited({}))
    (sheet,) = build_sheets(Design(scene).disc, TOLERANCE)
    texts = " ".join(mark.text for mark in sheet.marks if isinstance(mark, Label))
    assert "Hole %%c4 for a set screw, radial through the hub at 45°, its middle 6 from" in texts


def test_counterbores_are_dimensioned_and_noted() -> None:
    bolts = """bolt_circle = { count = 4, circle = 52, hole = 4, angle = 60,
counterbore = { diameter = 7.5, depth = 4.25 } }
hub ="""
    scene = parse_scene(HUBBED.replace("hub =", bolts.replace("\n", " ", 1)))
    (sheet,) = build_sheets(Design(scene.with_values(edited(FULL))).disc, TOLERANCE)
    assert overlaps(text_boxes(sheet)) == []
    found = [text_of(each, sheet) for each in sheet.dimensions]
    assert {"4x %%c4", "4x %%c7.5"} <= set(found)
    assert found.count("%%c52") == 1  # one pitch circle of both
    texts = " ".join(mark.text for mark in sheet.marks if isinstance(mark, Label))
    assert "Counterbores %%c7.5, 4.25 deep from the upper end of the holes %%c4." in texts


def test_the_example_of_the_page_is_a_table() -> None:
    page = (FIXTURES.parent / "docs" / "drawing.md").read_text("utf-8")
    table = tomllib.loads(page.partition("```toml\n")[2].partition("```")[0])["drawing"]
    assert table.keys() >= FULL.keys()
    build_sheets(Design(parse_scene(HUBBED).with_values(edited(table))).disc, TOLERANCE)


def test_every_word_is_used_and_has_the_same_places_in_both_languages() -> None:
    used = re.findall(r"\bwords\[['\"](\w+)['\"]\]", Path(texts.__file__).read_text("utf-8"))
    assert set(used) == TABLE.keys()
    for found in TABLE.values():
        english, german = (sorted(re.findall(r"\{\w+\}", each)) for each in found)
        assert english == german


def test_nothing_is_invented() -> None:
    """A scene without [drawing] has empty fields, and no tolerance or symbol."""
    design = Design(parse_scene(HUBBED).with_values({"output.fit": "fast"}))
    (sheet,) = build_sheets(design.disc, TOLERANCE)
    texts = " ".join(
        mark.text for mark in (*sheet.marks, *sheet.views[0].marks) if isinstance(mark, Label)
    )
    assert not re.search(r"H7|JS9|Ra|20\d\d-|ISO 2768|HRC", texts)
    assert {each.suffix for each in sheet.dimensions} <= {"", ")"}


def test_a_part_without_thickness_has_one_view() -> None:
    text = HUBBED.partition("[part]")[0] + "[part]\nbore = 16\n"
    (sheet,) = build_sheets(Design(parse_scene(text)).disc, TOLERANCE)
    assert len(sheet.views) == 1
    assert [each.measure for each in sheet.dimensions if isinstance(each, Diameter)] == [16.0]


def test_what_does_not_fit_is_refused_with_its_key() -> None:
    design = Design(parse_scene(HUBBED).with_values(edited({"scale": "10:1"})))
    message = r'drawing\.scale = "10:1": does not fit .*: at most "1:1" does'
    with pytest.raises(SceneError, match=message):
        build_sheets(design.disc, TOLERANCE)


def test_only_a_sheet_with_brackets_explains_them() -> None:
    for name, explained in (("setzhub", True), ("ring", False)):
        for sheet in sheets(name):
            found = any("in brackets" in mark.text for mark in sheet.marks
                        if isinstance(mark, Label))  # fmt: skip
            assert found == explained
            assert found == any(mark.prefix == "(" for mark in sheet.dimensions)


def test_curves_far_larger_than_the_part_are_left_out_with_a_note() -> None:
    """What remains of a lobe is a tenth of its pitch curve, and is drawn ten times larger."""
    for name, scale, drawn in (("cut_lobe", 5.0, False), ("setzhub", 1.0, True)):
        (sheet,) = sheets(name)
        assert sheet.scale == scale
        layers = {mark.layer for mark in sheet.views[0].marks if isinstance(mark, Chain)}
        assert ({"PITCH_CURVE", "BASE_CIRCLE"} <= layers) == drawn
        texts = " ".join(mark.text for mark in sheet.marks if isinstance(mark, Label))
        assert ("far larger than the part and are not drawn" in texts) == (not drawn)


def test_the_sheets_of_a_pair_are_numbered() -> None:
    texts = [
        [mark.text for mark in sheet.marks if isinstance(mark, Label)]
        for sheet in sheets("conjugate_lever")
    ]
    assert ["1/2" in each for each in texts] == [True, False]
    assert ["2/2" in each for each in texts] == [False, True]


ANGLES = (0, 15, 30, 45, 75, 90, 110, 135, 165, 180, 200, 225, 255, 270, 300, 330)

EVERY = [(name, angle, size) for name in PARTS for angle in ANGLES for size in ("A3", "A4")]

FEW = [
    ("hub", 255, "A3"), ("bolts", 255, "A3"), ("hub and bolts", 255, "A3"),
    ("hub and bolts", 30, "A4"), ("lightened", 110, "A4"), ("flat", 200, "A3"),
    ("small", 75, "A4"), ("thick", 330, "A3"), ("plain", 165, "A4"),
]  # fmt: skip


def unreadable(name: str, angle: float, size: str) -> list[tuple[str, str]]:
    """Texts of a part's sheets that are drawn across others, or that edges are drawn across."""
    (sheet,) = build_sheets(part(name, angle, sheet=size), TOLERANCE)
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

    monkeypatch.setattr(marks, "cheapest_marks", first)
    found = unreadable("hub and bolts", 255, "A3")
    assert any(layer == "OUTLINE" for _, layer in found)
    assert any(layer in ("DIMENSION", "SYMBOL") for _, layer in found)


def test_surfaces_that_differ_are_announced_in_brackets() -> None:
    for flank, there in (("Ra 0.8", True), (None, False)):
        (sheet,) = build_sheets(part("plain", 0, flank_surface=flank), TOLERANCE)
        texts = [each.text for each in sheet.marks if isinstance(each, Label)]
        assert ("(" in texts) == there
        assert "Ra 3.2" in texts


# Kept ---------------------------------------------------------------------------------------------
# Whole sheets, mark by mark: views, dimensions, notes, tables, frame and title block.


CHAMFERED = HUBBED.replace(
    "keyway = { width = 5, depth = 2.3, angle = 90 }",
    """d_shaft = { across = 14, angle = 20 }
bolt_circle = { count = 4, circle = 50, hole = 4 }
chamfers = { outline = { width = 0.5, edges = "upper" }, bore = { width = 1 } }""",
)


def kept_sheets() -> Iterator[tuple[str, Sequence[Sheet]]]:
    """Of a part with a hub, holes and all that a scene can state; of one in inches in German, with
    a table on a sheet of its own; of one with chamfers and a flat; of a pair in one piece.
    """
    keys = edited(dict(FULL))
    full = load_scene(FIXTURES / "scenes" / "hub_and_holes.toml").with_values(keys)
    yield "hub and holes", build_sheets(Design(full).disc, TOLERANCE)
    keys = edited({**FULL, "sheet": "A4", "language": "de", "step": 5})
    inch = load_scene(FIXTURES / "scenes" / "inch.toml").with_values(keys)
    yield "inches on A4 in German", build_sheets(Design(inch).disc, TOLERANCE)
    chamfered = parse_scene(CHAMFERED).with_values(edited({"step": 0, "motion": False}))
    yield "chamfers and a flat", build_sheets(Design(chamfered).disc, TOLERANCE)
    scene = camgeo.load(FIXTURES / "pairs" / "conjugate_pair.toml").scene
    pair = Design(scene.with_values(edited({"material": "C45"}))).disc.pair
    assert pair is not None
    yield "a pair in one piece", build_sheets(pair, TOLERANCE)


def lines_of(marks: Sequence[Mark]) -> Iterator[str]:
    """Marks, one a line, of chains and polygons those of one kind and layer together."""

    def kind(mark: Mark) -> tuple[str, ...]:
        drawn = isinstance(mark, (Chain, Filled, Hatched))
        return (type(mark).__name__, getattr(mark, "layer", "")) if drawn else ("",)

    for key, group in groupby(sorted(marks, key=kind), kind):
        if key == ("",):
            yield from map(kept.marks, group)
            continue
        every = list(group)
        points = [each.vertices if isinstance(each, Chain) else np.array(each.corners)
                  for each in every if isinstance(each, (Chain, Filled, Hatched))]  # fmt: skip
        sweeps = [each.sweeps for each in every if isinstance(each, Chain)]
        closed = sum(isinstance(each, Chain) and each.closed for each in every)
        yield " ".join((
            *key, f"{len(every)}, closed {closed}", kept.marks(np.concatenate(points)),
            *([kept.marks(np.concatenate(sweeps))] if sweeps else []),
        ))  # fmt: skip


def test_sheets_are_as_kept() -> None:
    def parts() -> Iterator[tuple[str, str]]:
        for name, found in kept_sheets():
            for number, sheet in enumerate(found, 1):
                head = f"{name}, sheet {number}: {sheet.width:g} x {sheet.height:g} mm,"
                yield (
                    f"{head} scale {kept.short(sheet.scale)}, {sheet.unit}, comma {sheet.comma}",
                    "\n".join(lines_of(sheet.marks)),
                )
                for view in sheet.views:
                    yield f"view at {kept.marks(view.origin)}", "\n".join(lines_of(view.marks))

    kept.compare("sheet/sheets.txt", parts())


# Places -------------------------------------------------------------------------------------------
# Texts of a sheet: their widths, where they stand, and what cannot be read.


@pytest.mark.parametrize("text", ["0123456789", "The quick brown fox", "Rolle 14 mm (88.84)"])
def test_widths_are_those_of_the_font(text: str) -> None:
    font = FontProperties(family="DejaVu Sans")
    capital = TextPath((0, 0), "H", size=100.0, prop=font).get_extents().height
    wide = TextPath((0, 0), f"|{text}|", size=100.0, prop=font).get_extents().width
    bars = TextPath((0, 0), "||", size=100.0, prop=font).get_extents().width
    assert text_width(text, 1.0) == pytest.approx(NARROWED * (wide - bars) / capital, rel=0.03)


def test_long_texts_are_narrowed_or_wrapped() -> None:
    text = "a text that is much too long for its field"
    assert text_width(text, 2.5) * Label(text, 0j, width=20.0).squeeze == pytest.approx(20.0)
    assert Label("short", 0j, width=20.0).squeeze == Label(text, 0j).squeeze == 1.0
    lines = wrapped(text, 2.5, 30.0)
    assert " ".join(lines) == text
    assert all(text_width(each, 2.5) <= 30.0 for each in lines)


def test_scales_are_those_of_the_standard() -> None:
    """ISO 5455, table 1, and its decades."""
    found = scales()
    assert list(found) == sorted(found, reverse=True)
    stated = ["50:1", "20:1", "10:1", "5:1", "2:1", "1:1", "1:2", "1:5", "1:10", "1:20", "1:50"]
    assert [spelled(each) for each in found[:11]] == stated
    assert all(parse_scale(spelled(each)) == each for each in found)
    assert parse_scale("1:2") == Fraction(1, 2)


BOX = boxes([(10 + 0j, 1.0 + 0j, 6.0, 2.0)])


def test_lines_are_interrupted_at_texts_and_nothing_else_is() -> None:
    found = list(Ink(frames=BOX).cleared([line(0j, 20 + 0j, "CENTRE")], 1.0))
    ends = [[complex(end) for end in each.vertices] for each in found if isinstance(each, Chain)]
    assert ends == [[0j, pytest.approx(7)], [pytest.approx(13), 20 + 0j]]
    away = line(5j, 20 + 5j, "CENTRE")
    outline = line(0j, 20 + 0j, "OUTLINE")
    assert list(Ink(frames=BOX).cleared([away, outline], 1.0)) == [away, outline]


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
    assert dimension_text(mark, "inch" if unit == "inch" else "mm") == f"%%c{text} H7"


def with_marks(sheet: Sheet, *marks: Chain | Distance) -> Sheet:
    view = sheet.views[0]
    return replace(sheet, views=(replace(view, marks=(*view.marks, *marks)), *sheet.views[1:]))


def test_usual_sheets_are_readable() -> None:
    for name in ("setzhub", "ring", "inch"):
        assert [list(each.findings()) for each in sheets(name)] == [[]]


def test_a_line_across_a_text_is_told() -> None:
    (sheet,) = sheets("setzhub")
    distances = [each for each in sheet.views[0].marks if isinstance(each, Distance)]
    (mark,) = (each for each in distances if each.prefix == "(" and each.angle == 0.0)
    middle = 0.5 * (mark.first.real + mark.second.real) + 1j * mark.line.imag
    wrong = with_marks(sheet, line(middle, middle + 10j, "OUTLINE"))
    assert list(across(wrong.views[0], wrong)) == ["(69.53)"]
    (found,) = wrong.findings()
    assert found.severity == "warning"
    assert 'lines across 1 text ("(69.53)")' in found.sentence


def test_two_texts_in_one_place_are_told() -> None:
    (sheet,) = sheets("setzhub")
    view = View(0j, tuple(Distance(0j, 40 + 0j, 10j + 1j * lift) for lift in (0.0, 1.0)))
    assert list(across(view, sheet)) == ["40", "40"]


def test_outlines_that_are_dots_are_told_with_their_place() -> None:
    """A dot of 2 mm at radius 25 and 30 degrees, at 1 : 5."""
    (sheet,) = build_sheets(part("hub and bolts", 30, sheet="A3", scale="1:5"), TOLERANCE)
    ((width, at),) = dots(sheet)
    assert width == pytest.approx(0.4, abs=0.01)
    assert at == pytest.approx(25.0 * (0.75**0.5 + 0.5j), abs=0.01)
    sentences = [each.sentence for each in sheet.findings()]
    assert any("1 outline as a dot, 0.4 mm wide on paper, at (21.65 / 12.5)" in each
               for each in sentences)  # fmt: skip
