"""Outlines of letters: those of the font as other programs read it."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest
from fontTools.pens.areaPen import AreaPen  # type: ignore[import-untyped]  # has no types
from fontTools.ttLib import TTFont  # type: ignore[import-untyped]  # has no types
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import TextToPath

from camgeo.geometry.contour.spline import area, elevated
from camgeo.part.glyphs import CAPITAL, FILE, glyph, kerning, require_glyphs
from tests.part.parts import refused

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
    assert found == pytest.approx(pen.value / CAPITAL**2, rel=1e-12)
    assert glyph(letter).advance * CAPITAL == pytest.approx(glyphs[name].width, rel=1e-12)


def test_capital_letters_have_the_height_one() -> None:
    for letter in "EHIX":
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
