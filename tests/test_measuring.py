"""The measures that other tests rely on, on figures with known distances, and broken on purpose."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.measuring import DensePath, Outline, polygon

# A stadium: half circles of radius 1 about +-2, straight sides; counter-clockwise.
STADIUM = Outline.through(
    np.array([2 - 1j, 2 + 1j, -2 + 1j, -2 - 1j]), np.array([np.pi, 0.0, np.pi, 0.0])
)


def test_centres_follow_from_sweeps() -> None:
    assert STADIUM.centres[0] == pytest.approx(2.0)
    assert STADIUM.centres[2] == pytest.approx(-2.0)
    assert STADIUM.area == pytest.approx(8.0 + np.pi)


@pytest.mark.parametrize(
    ("point", "distance"), [(0, 1), (3, 0), (5, 2), (2, 1), (0.5 + 3j, 2), (3 + 1j, 2**0.5 - 1)]
)
def test_distance_by_hand(point: complex, distance: float) -> None:
    assert STADIUM.distances(np.array([point]))[0] == pytest.approx(distance, abs=1e-15)


def test_dense_points_are_on_the_outline() -> None:
    points = STADIUM.dense(1000)
    assert len(points) >= 1000
    assert np.max(STADIUM.distances(points)) < 1e-14
    assert polygon(points).area == pytest.approx(STADIUM.area, rel=1e-4)


def test_clockwise_quarter() -> None:
    quarter = Outline.through(np.array([1j, 1.0 + 0j]), np.array([-np.pi / 2]), closed=False)
    assert abs(quarter.centres[0]) < 1e-15
    # Behind its start the arc is no nearer than that.
    assert quarter.distances(np.array([-1.0 + 0j]))[0] == pytest.approx(2**0.5)


def test_a_bulge_that_is_wrong_shows() -> None:
    broken = Outline.through(STADIUM.starts, np.array([np.pi, 0.0, 3.1, 0.0]))
    # The sagitta of the half circle shrinks from 1 to tan(3.1/4).
    found = np.max(broken.distances(STADIUM.dense(20_000)))
    assert found == pytest.approx(1.0 - np.tan(3.1 / 4.0), rel=1e-3)


def test_dense_path() -> None:
    path = DensePath(STADIUM.dense(20_000))
    points = np.array([0j, 5 + 0j, 3 + 1j])
    assert path.distances(points) == pytest.approx(STADIUM.distances(points), abs=1e-7)


@given(st.integers(1, 40), st.floats(0.1, 6.2), st.floats(0.0, 3.0), st.integers(0, 2**32 - 1))
def test_the_nearest_piece_is_never_passed_over(
    count: int, most: float, away: float, seed: int
) -> None:
    """The least of all distances of all pieces, straight and turned by up to a whole turn."""
    random = np.random.default_rng(seed)
    starts = random.normal(size=count + 1) + 1j * random.normal(size=count + 1)
    sweeps = random.uniform(-most, most, count) * random.integers(0, 2, count)
    pieces = Outline.through(starts, sweeps, closed=False)
    points = away * np.asarray(random.normal(size=60) + 1j * random.normal(size=60), np.complex128)
    number = np.arange(count)
    each = [float(np.min(pieces.apart(np.full(count, point), number))) for point in points]
    assert np.array_equal(pieces.distances(points), each)


def test_a_full_circle_is_one_piece() -> None:
    circle = Outline(
        np.ones(1, complex), np.ones(1, complex), np.full(1, 2 * np.pi), np.zeros(1, complex)
    )
    assert circle.distances(np.array([-3 + 0j, 0.5j])) == pytest.approx([2.0, 0.5], abs=1e-15)


@pytest.mark.parametrize("count", [3, 8, 9, 17])
def test_all_chords_of_a_dense_path_count(count: int) -> None:
    corners = np.exp(2j * np.pi * np.arange(count) / count)
    middles = 0.5 * (corners + np.roll(corners, -1))
    path = DensePath(corners)
    assert path.distances(middles) == pytest.approx(np.zeros(count), abs=1e-15)
    assert path.distances(2.0 * middles) == pytest.approx(np.abs(middles), abs=1e-15)


@given(st.integers(0, 2**32 - 1), st.floats(0.0, 4.0))
def test_the_nearest_chord_is_never_passed_over(seed: int, away: float) -> None:
    """Also where the nearest points of a dense path do not have the nearest chord."""
    random = np.random.default_rng(seed)
    uneven = np.exp(0.3 * away * random.normal(size=24))
    corners = uneven * np.exp(2j * np.pi * np.cumsum(uneven) / np.sum(uneven))
    points = np.asarray(random.normal(size=60) + 1j * random.normal(size=60), np.complex128)
    lines = Outline.through(corners, np.zeros(24))
    assert DensePath(corners).distances(points) == pytest.approx(lines.distances(points), abs=1e-14)
