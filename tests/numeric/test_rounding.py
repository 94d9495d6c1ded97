"""Sums that are 0 up to rounding, and a single object among many."""

from __future__ import annotations

import math

import numpy as np
import pytest

from camgeo.numeric.arrays import ONE, SHARE, resolved


@pytest.mark.parametrize("size", [1.0, 250.0, 1e-9])
def test_a_sum_is_rounding_up_to_its_share_of_the_terms(size: float) -> None:
    limit = SHARE * size
    for sign in (1.0, -1.0):
        assert resolved(sign * limit, size) == 0.0
        beyond = sign * math.nextafter(limit, math.inf)
        assert resolved(beyond, size) == beyond
    assert SHARE == 2.0**-46


def test_one_object_is_asked_as_one_of_many() -> None:
    x = np.linspace(0.0, 1.0, 5)
    found = ONE.everywhere(lambda phi, side: np.stack((phi, phi * len(side))), x, "left")
    assert found.shape == (2, ONE.count, 5)
    assert found[1, 0].tolist() == (4.0 * x).tolist()
    at = ONE.at(lambda phi, side: phi * len(side), x, "right", np.zeros(5, dtype=np.intp))
    assert at.tolist() == (5.0 * x).tolist()
