"""Contours seen from a pole."""

from __future__ import annotations

import numpy as np
import pytest

from camgeo.contour.contour import Contour
from camgeo.contour.nearness import distances
from camgeo.toolpath.plane.star import Star
from camgeo.toolpath.plane.track import Track

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
