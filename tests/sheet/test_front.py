"""Dashes of curves and lines."""

from __future__ import annotations

import numpy as np
import pytest

from camgeo.geometry.contour.contour import Contour
from camgeo.pictures.sheet.front import DASH_DOT, DASH_DOTS, dashed, dashed_stretch, in_dashes
from camgeo.pictures.sheet.marks import Chain, Label, Mark, line


def length(chain: Chain) -> float:
    """Of a chain [mm]."""
    chord = np.abs(np.diff(chain.vertices))
    half = 0.5 * np.abs(chain.sweeps[:-1])
    return float(np.sum(chord * np.where(half == 0.0, 1.0, half / np.sin(np.where(half, half, 1)))))


@pytest.mark.parametrize("pattern", [DASH_DOT, DASH_DOTS])
@pytest.mark.parametrize("scale", [0.01, 1.0, 50.0])
def test_dashes_lie_on_the_curve_in_their_proportion(
    pattern: tuple[float, ...], scale: float
) -> None:
    """A whole number of patterns, in pieces of any length: a circle of many arcs."""
    radius = 20.0 / scale
    circle = Contour.circle(radius).split(0.01)
    found = list(dashed(circle, scale, "PITCH_CURVE", pattern))
    assert len(found) % (len(pattern) / 2) == 0
    share = sum(pattern[::2]) / sum(pattern)
    assert sum(map(length, found)) == pytest.approx(share * circle.length, rel=1e-9)
    for each in found:
        assert np.allclose(np.abs(each.vertices), radius, rtol=1e-12)


def test_a_line_begins_and_ends_with_a_dash() -> None:
    whole = line(1 + 1j, 1 + 101j, "CENTRE")
    found = [each for each in in_dashes([whole], 1.0) if isinstance(each, Chain)]
    assert found[0].vertices[0] == 1 + 1j
    assert found[-1].vertices[1] == pytest.approx(1 + 101j)
    assert length(found[0]) == pytest.approx(length(found[-1]))
    assert all(each.layer == "CENTRE" for each in found)


def test_short_lines_and_other_layers_stay_as_they_are() -> None:
    marks: list[Mark] = [line(0j, 5 + 0j, "CENTRE"), line(0j, 500 + 0j, "OUTLINE"), Label("A", 0j)]
    assert list(in_dashes(marks, 1.0)) == marks


@pytest.mark.parametrize("sweep", [0.0, 0.3, -2.0])
def test_a_stretch_begins_and_ends_with_a_dash(sweep: float) -> None:
    """Of lines and arcs: its ends are those of the outer dashes, and the gaps are between."""
    whole = Chain(np.array([0j, 30 + 0j, 60 + 10j]), np.array([0.0, sweep, 0.0]), "HIDDEN")
    found = list(dashed_stretch(whole, 1.0, (4.2, 1.05)))
    assert found[0].vertices[0] == 0j
    assert found[-1].vertices[-1] == pytest.approx(60 + 10j)
    share = sum(map(length, found)) / length(whole)
    assert share == pytest.approx(4.2 / 5.25, abs=0.02)
    short = Chain(np.array([0j, 3 + 0j]), np.zeros(2), "HIDDEN")
    assert list(dashed_stretch(short, 1.0, (4.2, 1.05))) == [short]
