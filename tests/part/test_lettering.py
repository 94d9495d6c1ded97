"""Engraved texts: glyphs of the font, their boundaries, where letters lie, what is refused."""

from __future__ import annotations

import cmath
import math
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest
from fontTools.pens.areaPen import AreaPen  # type: ignore[import-untyped]  # has no types
from fontTools.ttLib import TTFont  # type: ignore[import-untyped]  # has no types
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import TextToPath

from camgeo.cam.cam import Contact
from camgeo.errors import GeometryError, ToleranceError
from camgeo.geometry.contour.contour import Contour, Pieces, distances, winding_number
from camgeo.geometry.contour.spline import CubicSpline, SplineContour, area, bezier_points, elevated
from camgeo.geometry.outline.path import Moments
from camgeo.numeric.arrays import ComplexArray
from camgeo.part.boundaries import Letter, LetterBoundary, place_letters
from camgeo.part.glyphs import CAPITAL, FILE, glyph, kerning, require_glyphs
from camgeo.part.mass import Solid, Web
from camgeo.part.part import Part
from camgeo.part.spec import (
    SENSES,
    Engraving,
    Holes,
    Hub,
    Mark,
    PartSpec,
    read_engravings,
    text_name,
)
from tests.part.parts import DISC, made, refused
from tests.strategies import attack

FONT = Path(mpl.get_data_path()) / FILE

LETTERS = "ABIOQgijö8Ø%ß_Ж"

ROUNDED = 1.0 / 64.0 / 100.0 * 2048.0 / CAPITAL
"""Matplotlib's text paths are in 64ths of a hundredth of the font's size."""


@pytest.fixture(scope="module")
def other() -> Any:
    return TTFont(FONT)


@pytest.mark.parametrize("letter", LETTERS)
def test_areas_are_those_that_fonttools_finds(other: Any, letter: str) -> None:
    """The signs cancel, for holes run the other way round, and the midpoints of neighbouring
    control points are exact in both.
    """
    glyphs, name = other.getGlyphSet(), other.getBestCmap()[ord(letter)]
    pen = AreaPen(glyphs)
    glyphs[name].draw(pen)
    found = sum(area(elevated(outline)) for outline in glyph(letter).outlines)
    assert (found, glyph(letter).advance * CAPITAL) == pytest.approx(
        (pen.value / CAPITAL**2, glyphs[name].width), rel=1e-12
    )


@pytest.mark.parametrize("letter", "EHIX")
def test_capital_letters_have_the_height_one(letter: str) -> None:
    points = np.concatenate([each.ravel() for each in glyph(letter).outlines])
    assert (np.min(points.imag), np.max(points.imag)) == (0.0, 1.0)


@pytest.mark.parametrize("text", ["AVATAR", "Ø8 für Nockenhebel"])
def test_a_line_of_letters_is_that_of_text_paths(text: str) -> None:
    """Those begin with the last letter and end with the first one."""
    vertices, _ = TextToPath().get_text_path(FontProperties(fname=FONT), text)
    points = np.array(vertices)
    scale = 2048.0 / 100.0 / CAPITAL
    expected = scale * (points[:, 0] + 1j * points[:, 1])
    at = 0.0
    own: list[complex] = []
    for before, letter in pairwise(f" {text}"):
        at += kerning(before, letter) if own or before != " " else 0.0
        outlines = [at + each for each in glyph(letter).outlines]
        own += [complex(each) for outline in outlines for each in outline.ravel()]
        at += glyph(letter).advance
    found = np.array(own)
    low, high = (f(found.real) for f in (np.min, np.max))
    assert np.min(expected[expected != 0.0].real) == pytest.approx(low, abs=3.0 * ROUNDED)
    assert np.max(expected.real) == pytest.approx(high, abs=(3.0 + len(text)) * ROUNDED)
    assert np.max(expected.imag) == pytest.approx(np.max(found.imag), abs=ROUNDED)


def test_outlines_are_closed_and_have_no_stray_points() -> None:
    """The "u" of the font has an anchor of two points, which encloses nothing."""
    for letter in "uíışÇ":
        for outline in glyph(letter).outlines:
            assert np.array_equal(outline[:, 2], np.roll(outline[:, 0], -1))
            assert abs(area(elevated(outline))) > 1e-3
    assert len(glyph("u").outlines) == 1
    assert (glyph(" ").outlines, glyph(" ").advance > 0.2) == ((), True)


def test_what_the_font_lacks_is_named() -> None:
    with refused("part.engraving.text", r'DejaVu Sans has no "\u51f8" \(U\+51F8\)'):
        require_glyphs("cam \u51f8")


TURNED = 30.0 * np.exp(2.0j)


def boundary(letter: str = "S", height: float = 5.0, place: complex = TURNED) -> LetterBoundary:
    pieces = place + height * np.exp(0.4j) * glyph(letter).outlines[0]
    return LetterBoundary("engraving 1 letter 1 outline 1", True, pieces, 0.004 * height)


def sampled(made: LetterBoundary, count: int = 60) -> ComplexArray:
    points = bezier_points(elevated(made.pieces), np.linspace(0.0, 1.0, count))
    return np.asarray(points.ravel(), dtype=np.complex128)


@given(
    st.sampled_from("SOeg8%Ø@"),
    st.floats(1.0, 30.0),
    st.floats(-4.0, -1.0),
    st.complex_numbers(max_magnitude=200.0),
)
@attack
def test_fits_lie_within_what_they_state(
    letter: str, height: float, power: float, place: complex
) -> None:
    made, tolerance = boundary(letter, height, place), 10.0**power
    points = sampled(made)
    for fit in (made.arcs(tolerance), made.polyline(tolerance), made.distance_fit(tolerance)):
        assert fit.deviation <= min(tolerance, made.coarsest)
        assert np.max(distances(points, Pieces.around([fit.contour]))) <= fit.deviation
        assert fit.contour.area > 0.0
        # The bound is a proof of its own: not less than what samples show, and hardly more.
        found = made.deviation(fit.contour)
        assert found <= 1.01 * fit.deviation
        assert found >= np.max(distances(points, Pieces.around([fit.contour])))


def test_the_spline_is_the_outline_itself() -> None:
    made = boundary()
    fit = made.spline(1e-3)
    assert fit.deviation == 0.0
    assert fit.contour.area == pytest.approx(area(elevated(made.pieces)), rel=1e-12)
    assert made.deviation(fit.contour) <= 1e-12
    assert made.deviation(fit.contour.reversed()) <= 1e-12
    strands = fit.contour.strands
    assert made.deviation(SplineContour((*strands[5:], *strands[:5]))) <= 1e-12


def test_a_spline_of_other_pieces_is_compared_as_a_curve() -> None:
    made = boundary("J")
    strands = list(made.spline(1e-3).contour.strands)
    first = next(k for k, each in enumerate(strands) if isinstance(each, CubicSpline))
    curve = strands[first]
    assert isinstance(curve, CubicSpline)
    strands[first : first + 1] = curve.divided(0.4)
    same = SplineContour(tuple(strands))
    assert made.deviation(same) <= 2e-5 * made.coarsest
    controls = curve.controls + np.array([0.0, 0.03j, 0.03j, 0.0])
    bent = CubicSpline(curve.knots, controls)
    strands[first : first + 2] = bent.divided(0.4)
    points = bezier_points(bent.beziers, np.linspace(0.0, 1.0, 200))[0]
    off = np.max(distances(points, Pieces.around([made.arcs(1e-6).contour])))
    assert made.deviation(SplineContour(tuple(strands))) == pytest.approx(off, rel=0.01)


@pytest.mark.parametrize("off", [1e-5, 1e-3, 0.3])
def test_what_lies_beside_is_found(off: float) -> None:
    made = boundary()
    fit = made.arcs(1e-6).contour
    moved = Contour(fit.vertices + off, fit.sweeps, np.where(fit.sweeps, fit.centres + off, 0.0))
    assert made.deviation(moved) == pytest.approx(off, rel=0.2)
    spline = made.spline(1e-3).contour
    strands = tuple(
        CubicSpline(each.knots, each.controls + off)
        if isinstance(each, CubicSpline)
        else type(each)(each.start + off, each.end + off, 0.0, 0j)
        for each in spline.strands
    )
    assert made.deviation(SplineContour(strands)) == pytest.approx(off, rel=0.2)


def test_moments_are_those_of_fine_polygons() -> None:
    made = boundary()
    fine = made.polyline(1e-6).contour
    found, expected = made.moments(1e-9), fine.moments
    room = 1e-6 * fine.length
    assert abs(found.area - expected.area) <= room
    assert abs(found.first - expected.first) <= room * 35.0
    assert abs(found.area - area(elevated(made.pieces))) <= 1e-12
    polar = made.second_moments(1e-9)
    mean = expected.first / expected.area
    assert (polar.polar, polar.square) == pytest.approx(
        (expected.area * abs(mean) ** 2, expected.area * mean**2), rel=0.01
    )


@pytest.mark.parametrize("letter", ["O", "S"])
def test_radii_are_those_of_samples(letter: str) -> None:
    far, around = boundary(letter), boundary(letter, 20.0, -8.0 - 10.0j)
    for each in (far, around):
        reach, place = each.farthest()
        assert place is None
        assert reach == pytest.approx(np.max(np.abs(sampled(each))), rel=1e-4)
    assert far.nearest() == 0.0
    inside = winding_number(around.arcs(1e-3).contour, 0j) != 0
    expected = np.min(np.abs(sampled(around))) if inside else 0.0
    assert around.nearest() == pytest.approx(expected, rel=1e-4)


def test_refusals() -> None:
    made = boundary()
    with pytest.raises(GeometryError, match="no cutter"):
        made.offset(1.0)
    with pytest.raises(GeometryError, match="end to end and closed"):
        LetterBoundary("open", True, made.pieces[:-1], 0.01)
    bow = np.array([0.0, 2.0 + 2.0j, 2.0, 2.0j]) + 10.0
    ends = np.roll(bow, -1)
    crossed = LetterBoundary("bow", True, np.stack((bow, 0.5 * (bow + ends), ends), axis=1), 0.01)
    for form in (crossed.arcs, crossed.polyline, crossed.spline):
        with pytest.raises(GeometryError, match="the bow crosses itself"):
            form(1e-3)
    with pytest.raises(ToleranceError):
        made.arcs(1e-15)


TEXT = Engraving("Ø8", 4.0, 0.5, 20.0)

RING = Engraving("O", 30.0, 0.5, 0.1, along="straight")
"""A letter around the cam axis."""


def letters(text: Engraving) -> tuple[Letter, ...]:
    return place_letters((text,))[0]


def middle(letter: Letter) -> complex:
    """Centroid of what is cut."""
    cut = Moments.total(
        each.moments(1e-9).scaled(1.0 if each.hole else -1.0) for each in letter.boundaries
    )
    return cut.first / cut.area


def names(part: Part) -> list[str]:
    return [each.name for each in part.boundaries]


# -- the place -------------------------------------------------------------------------------------


@given(st.floats(2.0, 8.0), st.floats(15.0, 60.0), st.floats(-6.2, 6.2), st.sampled_from(SENSES))
@attack
def test_letters_on_a_circle_stand_on_their_rays(
    height: float, radius: float, angle: float, tops: str
) -> None:
    """ "T" is heavier at its top, and read before the dot, which lies at its foot."""
    (head, dot) = letters(Engraving("T.", height, 0.5, radius, angle, tops=tops))
    sense = 1.0 if tops == "outward" else -1.0
    for each in (head, dot):
        assert abs(each.place) == pytest.approx(radius)
        ray = each.place / abs(each.place)
        up, off = sense * ray, middle(each) - each.place
        assert (off * up.conjugate()).real == pytest.approx(
            {"T": 0.5, ".": -0.5}[each.character] * height, abs=0.35 * height
        )
        assert abs((off * up.conjugate()).imag) <= 1e-3 * height
    assert (dot.place * head.place.conjugate()).imag * sense < 0.0
    # What is drawn lies in the middle, about: by lengths along the circle.
    assert abs(cmath.log(head.place / cmath.rect(radius, angle)).imag) * radius < height


@pytest.mark.parametrize(
    ("given_keys", "reading"),
    [
        ({}, -1j),
        ({"tops": "inward"}, 1j),
        ({"turn": 0.0}, cmath.exp(-0.7j)),
        ({"turn": 1.0}, cmath.exp(0.3j)),
    ],
)
def test_straight_text(given_keys: dict[str, Any], reading: complex) -> None:
    """Read across the ray at 0.7 rad, or in the stated direction; its ink has its middle there."""
    text = Engraving("IoI", 5.0, 0.5, 20.0, 0.7, along="straight", **given_keys)
    found = letters(text)
    ray = cmath.exp(0.7j)
    places = np.array([each.place for each in found]) / ray
    way = places[2] - places[0]
    assert (way / abs(way), np.mean(places[[0, 2]])) == pytest.approx((reading, 20.0))
    spaced = 5.0 * (0.5 * glyph("I").advance * 2.0 + glyph("o").advance)
    assert abs(way) == pytest.approx(spaced)
    # The middles of "I" are the places themselves: it is a rectangle.
    assert middle(found[0]) == pytest.approx(found[0].place, abs=1e-9)


@pytest.mark.parametrize("tops", SENSES)
def test_letters_are_nowhere_nearer_than_in_straight_text(tops: str) -> None:
    """Where they are nearest to the axis their distances are those of straight text."""
    one, other = letters(Engraving("HH", 6.0, 0.5, 15.0, tops=tops))
    turned = abs(cmath.log(other.place / one.place).imag)
    assert turned * (15.0 - 3.0) == pytest.approx(6.0 * glyph("H").advance)


def test_islands_and_holes_take_turns() -> None:
    ring, (eight, oe, percent) = "0", letters(Engraving("8Ø%", 5.0, 0.5, 20.0))
    holes = [sorted(each.hole for each in one.boundaries) for one in (eight, oe, percent)]
    assert holes == [[False, False, True]] * 2 + [[False, False, True, True, True]]
    made_names = [
        each.name for each in letters(Engraving(f" {ring}", 5.0, 0.5, 20.0))[0].boundaries
    ]
    assert made_names == ["engraving 1 letter 2 outline 1", "engraving 1 letter 2 outline 2"]
    assert {text_name(each) for each in made_names} == {"engraving 1"}
    assert text_name("outline") == ""


def test_decomposed_characters_are_composed() -> None:
    assert Engraving("u\u0308", 5.0, 0.5, 20.0) == Engraving("ü", 5.0, 0.5, 20.0)


# -- the part --------------------------------------------------------------------------------------


def test_texts_are_sunk_to_their_depths() -> None:
    texts = (TEXT, replace(TEXT, text="0", angle=math.pi, depth=0.8))
    part = made(Contact.INNER, replace(DISC, hub=Hub(24.0, 5.0, "both"), engraving=texts))
    walls = {wall.boundary.name: (wall.z0, wall.z1) for wall in part.walls}
    assert walls["engraving 1 letter 1 outline 1"] == (-0.5, 0.0)
    assert walls["engraving 2 letter 1 outline 2"] == (-0.8, 0.0)
    assert [layer.name for layer in part.layers] == [
        "lower hub", "disc", "engraving 2", "engraving 1", "hub",
    ]  # fmt: skip
    assert part.outermost.name == "outline"
    assert len(names(part)) == 4 + 3 + 3 + 2


def test_what_is_cut_away_is_the_letters() -> None:
    plain = made(Contact.INNER, DISC)
    part = made(Contact.INNER, replace(DISC, engraving=(TEXT,)))
    area = sum(
        (1.0 if each.hole else -1.0) * each.polyline(1e-6).contour.area
        for each in part.boundaries
        if text_name(each.name)
    )
    assert Solid.from_part(plain).volume - Solid.from_part(part).volume == pytest.approx(
        0.5 * area, rel=1e-5
    )


def test_letters_are_no_walls() -> None:
    found, plain = (
        Web.thinnest_webs(made(Contact.INNER, spec))[0]
        for spec in (replace(DISC, engraving=(TEXT,)), DISC)
    )
    assert found == plain


def test_a_part_without_a_thickness_is_engraved_too() -> None:
    part = made(Contact.GROOVE, PartSpec(rim=140.0, bore=20.0, engraving=(TEXT,)))
    assert "engraving 1 letter 2 outline 3" in names(part)


@pytest.mark.parametrize("contact", list(Contact))
def test_where_there_is_room(contact: Contact) -> None:
    """Within the inner flank, from 32 mm on, or beyond the outer one, up to 63 mm."""
    radius = 66.5 if contact is Contact.OUTER else 25.0
    spec = replace(DISC, engraving=(replace(TEXT, radius=radius, text="plate-12"),))
    assert len(made(contact, spec).boundaries) > 9


# -- refusals --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("spec", "message"),
    [
        (PartSpec(engraving=(replace(TEXT, radius=31.0, angle=1.6),)), "clear of the outline"),
        (PartSpec(engraving=(replace(TEXT, radius=90.0),)), "no material"),
        (PartSpec(bore=30.0, engraving=(replace(TEXT, radius=8.0),)), "no material"),
        (PartSpec(bore=30.0, engraving=(replace(TEXT, radius=15.5),)), "clear of the bore"),
        (PartSpec(hub=Hub(40.0, 5.0), engraving=(TEXT,)), "clear of the hub"),
        (PartSpec(hub=Hub(50.0, 5.0), engraving=(TEXT,)), "under the hub"),
        (
            PartSpec(bolt_circle=Holes(1, 40.0, 1.0, -0.05), engraving=(TEXT,)),
            r'clear of the bolt hole 1, which the "8" at X 19\.85, Y -2\.45 mm touches',
        ),
        (
            PartSpec(bolt_circle=Holes(1, 2.0, 1.0), engraving=(RING,)),
            'the "O" at .* lies around the bolt hole 1',
        ),
        (PartSpec(mark=Mark(20.0, 2.0, 1.0), engraving=(TEXT,)), "clear of the mark"),
        (
            PartSpec(engraving=(replace(TEXT, angle=2.0), TEXT, replace(TEXT, angle=0.2))),
            r'\[3\]: the "8" at .* touches the "Ø" at X 19\.91',
        ),
        (
            PartSpec(engraving=(replace(TEXT, text="O"), replace(TEXT, text="I", angle=0.1))),
            r'\[2\]: the "I" at .* touches the "O" at X 20',
        ),
        (PartSpec(engraving=(replace(TEXT, text="façade"),)), '"ç" touch each other'),
        (PartSpec(engraving=(replace(TEXT, text=30 * "M"),)), "do not fit around"),
    ],
)  # fmt: skip
def test_no_room(spec: PartSpec, message: str) -> None:
    with pytest.raises(GeometryError, match=message) as caught:
        made(Contact.INNER, spec)
    assert caught.value.key.startswith(f"part.engraving[{len(spec.engraving)}]")


@pytest.mark.parametrize(
    ("keys", "key", "message"),
    [
        ({"text": "  "}, "text", "not of spaces alone"),
        ({"text": 101 * "a"}, "text", "1 to 100 characters"),
        ({"text": "a\nb"}, "text", r"U\+000A"),
        ({"text": "\u0663"}, "text", "right to left"),
        ({"text": "\u05d0"}, "text", "right to left"),
        ({"text": "\u51f8"}, "text", r"has no .\u51f8."),
        ({"text": 7}, "text", "must be a text"),
        ({"height": 0.0}, "height", "above 0"),
        ({"radius": 2.0}, "radius", "above 2"),
        ({"along": "spiral"}, "along", "must be one of"),
        ({"tops": "up"}, "tops", "must be one of"),
        ({"turn": 0.0}, "turn", "straight"),
    ],
)
def test_wrong_values(keys: dict[str, Any], key: str, message: str) -> None:
    table = {"height": 4.0, "depth": 0.5, "radius": 20.0}
    assert read_engravings([table], "cam")[0].text == "cam"
    with refused(f"part.engraving[2].{key}", message):
        read_engravings([table, {**table, **keys}], "cam")
