"""Parallels with corners: along which curves these slide, and how many steps keep to their chords.

That parallels are those of shapely is in tests/printing/test_drawn_in.py.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.contour.exact import distance_between, matching_chords_of
from camgeo.geometry.contour.parallel import corner_radius, corners, parallel, steps_to
from camgeo.part.assembly import bore_outline, flattened
from camgeo.part.spec import DShaft, Keyway
from tests.strategies import attack

KEYED = bore_outline(20.0, Keyway(6.0, 2.8))
FLAT = flattened(20.0, DShaft(17.0))


def test_corners_are_where_directions_change() -> None:
    assert corners(KEYED).tolist() == [True] * 4
    assert corners(FLAT).tolist() == [True] * 2
    assert not corners(Contour.circle(5.0)).any()
    assert corner_radius(KEYED) == pytest.approx(10.0, rel=1e-15)
    assert corner_radius(Contour.circle(5.0)) is None
    assert corner_radius(Contour.polygon(np.array([0.0, 4.0, 4.0j]))) is None


@given(st.floats(0.0, 20.0))
@attack
def test_a_corner_of_line_and_arc_slides_along_a_parabola(by: float) -> None:
    """u^2 = r^2 - p^2 + 2 d (r - p), see `corner_radius`: here along x, at y = p + d."""
    found = parallel(KEYED, by).vertices[3]
    assert found.imag == pytest.approx(3.0 + by, rel=1e-14)
    assert found.real**2 == pytest.approx(100.0 - 9.0 + 2.0 * by * 7.0, rel=1e-13)


@pytest.mark.parametrize("contour", [KEYED, FLAT], ids=["keyway", "flat"])
@pytest.mark.parametrize("limit", [1e-2, 1e-4])
def test_steps_keep_to_the_chords(contour: Contour, limit: float) -> None:
    def off(steps: int) -> float:
        """Largest distance of corners of parallels from the chords over the first of the steps."""
        step = 4.0 / steps
        shares = np.linspace(0.0, 1.0, 65)
        ways = np.array([parallel(contour, step * share).vertices for share in shares])
        return float(np.max(np.abs(ways - ways[0] - np.outer(shares, ways[-1] - ways[0]))))

    steps = steps_to(contour, 4.0, limit)
    assert off(steps) <= limit
    assert steps == 1 or off(steps - 1) > limit / 1.21


@pytest.mark.parametrize("tolerance", [0.1, 1e-3])
def test_matching_chords_are_as_many_and_within_the_tolerance(tolerance: float) -> None:
    contours = [parallel(KEYED, by) for by in (0.0, 1.0, 4.0)]
    polygons = matching_chords_of(contours, tolerance)
    assert len({len(each) for each in polygons}) == 1
    for contour, polygon in zip(contours, polygons, strict=True):
        assert set(contour.vertices.tolist()) <= set(polygon.tolist())
        assert distance_between(contour, Contour.polygon(polygon)) <= tolerance * 1.001
    assert len(polygons[0]) <= 5 + math.pi / math.sqrt(tolerance / 14.0)
