"""Contours seen from a pole."""

from __future__ import annotations

import numpy as np
import pytest

from camgeo.geometry.contour.contour import Contour, distances
from camgeo.milling.areas import Star
from camgeo.milling.track import Track

SLOT = Contour(
    np.array([-10 - 1j, 10 - 1j, 10 + 1j, -10 + 1j]),
    np.array([0.0, np.pi, 0.0, np.pi]),
    np.array([0j, 10.0, 0j, -10.0]),
)

WAISTED = Contour(
    np.array([4 - 3j, 4 + 3j, -4 + 3j, -4 - 3j]),
    np.array([0.0, -1.0, 0.0, -1.0]),
    np.array([0j, 3j + 4j / np.tan(0.5), 0j, -3j - 4j / np.tan(0.5)]),
)
"""Two sides bent inward."""


POLES = [(SLOT, 2 + 0.1j), (WAISTED, 0.3j), (SLOT.reversed(), 0j)]


@pytest.mark.parametrize(("contour", "pole"), POLES)
def test_rays_meet_the_contour(contour: Contour, pole: complex) -> None:
    star = Star.of(contour, pole)
    assert star is not None
    rays = np.linspace(-7.0, 9.0, 700)
    r, slope = star.at(rays)
    assert np.max(distances(star.points(rays), Track.around(contour))) < 1e-12
    step = 1e-6
    ahead, behind = (star.at(rays + each)[0] for each in (step, -step))
    # Apart from kinks and jumps of curvature within a step of a ray.
    assert np.quantile(np.abs((ahead - behind) / (2.0 * step) - slope), 0.98) < 1e-6
    assert np.all(r > 0.0)


@pytest.mark.parametrize("pole", [0.95j, 10.95 + 0j, 20 + 0j])
def test_steep_or_outside_is_none(pole: complex) -> None:
    assert Star.of(SLOT, pole) is None


def test_what_turns_back_is_none() -> None:
    hook = np.array([0j, 10 + 0j, 10 + 10j, 5 + 10j, 5 + 4j, 4 + 4j, 4 + 10j, 0 + 10j])
    assert Star.of(Contour.polygon(hook), 2 + 2j) is None


@pytest.mark.parametrize(("contour", "pole"), POLES)
def test_nothing_is_nearer_or_farther_than_its_distances(contour: Contour, pole: complex) -> None:
    star, other = Star.of(contour, pole), Star.of(Contour.circle(30.0, pole + 1.0), pole)
    assert star is not None
    assert other is not None
    rays = np.linspace(0.0, 2.0 * np.pi, 100_001)
    own = star.at(rays)[0]
    for found, values in (
        (star.distances(), own),
        (star.distances(beyond=other), own - other.at(rays)[0]),
    ):
        for end, sign in ((found.lowest, -1.0), (found.highest, 1.0)):
            most = float(np.max(sign * values))
            assert most - 1e-9 <= sign * end.value <= most + 1e-3


def test_the_distances_of_a_square_that_lies_askew() -> None:
    square = Star.of(Contour.polygon(10.0 * np.exp(1j * (0.1003 + 0.5 * np.pi * np.arange(4)))))
    assert square is not None
    found = square.distances()
    assert found.highest.value == pytest.approx(10.0, abs=1e-12)
    assert found.lowest.value == pytest.approx(np.sqrt(50.0), abs=1e-12)
