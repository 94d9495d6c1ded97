"""Turns of the tangents of biarcs: a least sum of squares, with the best arcs as its limit."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.geometry.contour.arcs import OUTERMOST, tangent_turns
from camgeo.geometry.contour.least_pieces import ARC
from camgeo.numeric.arrays import FloatArray

PLACES = np.arange(1, 6) / 6


def _turned(places: FloatArray) -> tuple[FloatArray, FloatArray]:
    """C1 quadratics over [0, 1] with a knot in the middle that are 0 at both ends, and have the
    slope 1 at the start, or at the end, and 0 at the other.
    """
    rows = []
    for slopes in ((1.0, 0.0), (0.0, 1.0)):
        # Bends b, c of the halves: s0 + (b + c)/2 = s1 and s0 + 3 b/8 + c/8 = 0.
        b, c = np.linalg.solve([[0.5, 0.5], [0.375, 0.125]], [slopes[1] - slopes[0], -slopes[0]])
        late = np.maximum(places - 0.5, 0.0)
        rows.append(slopes[0] * places + 0.5 * b * places**2 + 0.5 * (c - b) * late**2)
    return rows[0], rows[1]


def _plain(places: FloatArray) -> FloatArray:
    """Distance, to the left, of a curve with kappa' = 1 from the biarc with its tangents."""
    half = places**3 / 6.0 - places**2 / 12.0
    other = (1.0 - places) ** 3 / 6.0 - (1.0 - places) ** 2 / 12.0
    return np.where(places < 0.5, half, -other)


def test_even_slope_of_curvature_gives_the_best_arcs() -> None:
    count, length, slope = 60, 0.3, 2e-3
    apart = -slope * length**3 * np.tile(_plain(PLACES), (count, 1))
    turns = tangent_turns(apart, np.full(count, length), np.array([count - 1]))
    assert turns[0, 0] == turns[1, -1] == 0.0
    assert np.array_equal(turns[0, 1:], turns[1, :-1])
    # What the ends change falls to a third from joint to joint.
    inner = turns[:, 30]
    assert inner == pytest.approx(-slope * (0.5 * length) ** 2 / 12.0, rel=1e-12)
    dense = np.linspace(0.0, 1.0, 20_001)
    first, second = _turned(dense)
    left = slope * length**3 * _plain(dense) - length * (inner[0] * first + inner[1] * second)
    assert np.max(np.abs(left)) == pytest.approx(ARC * slope * (0.5 * length) ** 3, rel=1e-6)
    assert math.isclose(ARC ** (1.0 / 3.0), 0.2002, rel_tol=1e-3)


@given(
    st.lists(st.lists(st.floats(0.1, 10.0), min_size=1, max_size=6), min_size=1, max_size=4),
    st.integers(0, 2**32 - 1),
)
def test_the_sum_of_squares_is_least(chains: list[list[float]], seed: int) -> None:
    lengths = np.concatenate(chains)
    apart = np.random.default_rng(seed).normal(size=(len(lengths), len(PLACES)))
    last = np.cumsum([len(chain) for chain in chains]) - 1
    turns = tangent_turns(apart, lengths, last)
    first, second = _turned(PLACES)
    start = 0
    for chain in chains:
        # Each chain by itself, by another way of solving.
        stop = start + len(chain)
        rows = np.zeros((len(chain), len(PLACES), len(chain) + 1))
        for k, length in enumerate(chain):
            rows[k, :, k], rows[k, :, k + 1] = length * first, length * second
        weight = np.ones(len(chain))
        weight[[0, -1]] = math.sqrt(OUTERMOST)
        matrix = (weight[:, None, None] * rows).reshape(-1, len(chain) + 1)[:, 1:-1]
        right = -(weight[:, None] * apart[start:stop]).ravel()
        joints = np.zeros(len(chain) + 1)
        if len(chain) > 1:
            joints[1:-1] = np.linalg.lstsq(matrix, right, rcond=None)[0]
        # Bands of cosines up to 0.6: a condition of ten, times that of the lengths squared.
        scale = max(1.0, float(np.max(np.abs(joints))))
        assert turns[0, start:stop] == pytest.approx(joints[:-1], abs=1e-9 * scale)
        assert turns[1, start:stop] == pytest.approx(joints[1:], abs=1e-9 * scale)
        start = stop
