"""What closed contours enclose, and where circles meet lines and arcs."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from camgeo.geometry.contour.contour import Contour, Pieces, distances
from camgeo.milling.plan import crossings, inside
from tests.toolpath.plane.tracks import any_track

RECTANGLE = Contour.polygon(np.array([-50.0 - 25.0j, 50.0 - 25.0j, 50.0 + 25.0j, -50.0 + 25.0j]))

places = st.builds(complex, st.floats(-15.0, 15.0), st.floats(-15.0, 15.0))


@given(places, st.floats(1.0, 10.0))
@example(0j, 1.0)
def test_inside_of_contours(point: complex, radius: float) -> None:
    boundary = Pieces.around([Contour.circle(radius), RECTANGLE])
    if abs(abs(point) - radius) < 1e-9:
        return
    # Both together are the rectangle without the circle.
    assert inside(boundary, np.array([point]))[0] == (abs(point) > radius)


@pytest.mark.parametrize("distance", [0.0, 1.5])
@pytest.mark.parametrize("seed", range(10))
def test_a_circle_passes_a_distance_at_its_crossings_only(seed: int, distance: float) -> None:
    """Between neighbouring angles all points are nearer, or all are farther off."""
    rng = np.random.default_rng(seed)
    pieces = any_track(rng).pieces
    place, radius = complex(*rng.uniform(-5.0, 5.0, 2)), float(rng.uniform(1.0, 6.0))
    ends = np.sort(np.mod(crossings(pieces, place, radius, distance), 2.0 * np.pi))
    ends = np.concatenate(([0.0], ends, [2.0 * np.pi]))
    wide = np.flatnonzero(np.diff(ends) > 1e-6)
    shares = np.array([0.01, 0.3, 0.7, 0.99])
    angles = ends[wide, None] + np.diff(ends)[wide, None] * shares
    off = distances((place + radius * np.exp(1j * angles)).ravel(), pieces)
    farther = (off > distance).reshape(angles.shape)
    assert np.all(farther == farther[:, :1])
