"""Which contour of a file is which boundary: by size, and by place where sizes are equal."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest

from camgeo.geometry.contour.contour import Contour
from camgeo_export.reading import paired

HOLES = [Contour.circle(3.0, 30.0 * cmath.exp(2j * math.pi * k / 6.0)) for k in range(6)]

NESTED = [Contour.circle(radius) for radius in (60.0, 49.0, 48.0, 12.0)]


def polygon(contour: Contour) -> Contour:
    points = contour.points(0.03)
    return Contour(points, np.zeros(len(points)), np.zeros_like(points))


@pytest.mark.parametrize("seed", range(5))
def test_each_contour_is_found_in_any_order(seed: int) -> None:
    wanted = [*NESTED, *HOLES]
    order = np.random.default_rng(seed).permutation(len(wanted)).tolist()
    contours = [wanted[k] if k % 2 else wanted[k].reversed() for k in order]
    found = paired(contours, [polygon(each) for each in wanted])
    assert [order.index(k) for k in range(len(wanted))] == [
        next(i for i, each in enumerate(contours) if each is match) for match in found
    ]


def test_a_hole_that_was_moved_stays_that_hole() -> None:
    """The others keep theirs, so that one deviation is reported and not two."""
    moved = [Contour.circle(3.0, 31.0 + 0j), *HOLES[1:]]
    assert paired(moved, [polygon(each) for each in HOLES]) == moved


def test_small_contours_are_told_apart_by_their_places() -> None:
    """Their areas are no better known than a tolerance for the whole drawing allows, so their order
    is another one in the file.
    """
    sizes = [0.30 + 0.004 * k for k in range(12)]
    wanted = [Contour.circle(size, 20.0 * cmath.exp(0.3j * k)) for k, size in enumerate(sizes)]
    off = [0.009 if k % 2 else -0.009 for k in range(12)]
    contours = [
        Contour.circle(size + more, 20.0 * cmath.exp(0.3j * k))
        for k, (size, more) in enumerate(zip(sizes, off, strict=True))
    ]
    big = Contour.circle(50.0)
    assert paired([big, *contours[::-1]], [*wanted, big]) == [*contours, big]
