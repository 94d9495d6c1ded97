"""Exact distances of points and chains, against dense points on them."""

from __future__ import annotations

import numpy as np
import pytest

from camgeo.geometry.contour.contour import distances, least_distance
from camgeo.milling.track import Track
from tests.toolpath.plane.tracks import any_track, dense, scattered, through

EACH = 400
"""Points on a piece of at most 60 mm: none is farther than 0.075 mm from one of them."""

APART = 0.08


@pytest.mark.parametrize("seed", range(20))
def test_points(seed: int) -> None:
    rng = np.random.default_rng(seed)
    track = any_track(rng)
    points = scattered(rng, 30, 15.0)
    found = distances(points, track)
    near = np.min(np.abs(points[:, None] - dense(track, EACH)), axis=1)
    assert np.all(found <= near + 1e-12)
    assert np.all(near - found <= APART)
    assert np.max(distances(dense(track, 20), track)) < 1e-12


@pytest.mark.parametrize("seed", range(40))
def test_chains(seed: int) -> None:
    rng = np.random.default_rng(seed)
    one, other = any_track(rng, 3, 4.0), any_track(rng, 2, 4.0)
    moved = Track(other.vertices + 9.0, other.sweeps, other.centres + 9.0)
    for each in (other, moved):
        found = least_distance(one, each)
        near = np.min(np.abs(dense(one, EACH)[:, None] - dense(each, EACH)))
        assert found <= near + 1e-12
        assert near - found <= APART
        assert least_distance(each, one) == pytest.approx(found, abs=1e-12)


def test_crossing_pieces_have_no_distance() -> None:
    line = Track.line(-5 - 0.1j, 5 + 0.2j)
    arc = through(np.array([-1 + 0j, 1 + 0j]), np.array([-3.0]))
    flat = Track.line(-4 + 0.5j, 4 + 0.5j)
    for one, other in ((line, Track.line(1 - 3j, 1 + 3j)), (line, arc), (arc, flat)):
        assert least_distance(one, other) == 0.0
    assert least_distance(arc, Track.arc(0.5 + 0j, 0.5 + 5j, 3.0)) == 0.0


def test_nested_circles() -> None:
    """The common normal of two arcs, on the same side of both centres."""
    outer, inner = Track.arc(-10 + 0j, 0j, 3.0), Track.arc(-5 - 2j, -2 - 2j, -2.9)
    gap = 10.0 - abs(-2 - 2j) - 3.0
    turned = Track(outer.vertices * 1j, outer.sweeps, outer.centres * 1j)
    assert least_distance(turned, inner) == pytest.approx(least_distance(inner, turned))
    assert least_distance(outer, inner) >= gap - 1e-12
