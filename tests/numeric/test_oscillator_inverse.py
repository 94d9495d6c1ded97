from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.numeric.oscillator.inverse import inverse
from tests.strategies import attack


@attack
@given(share=st.floats(0.0, 1.0), swing=st.floats(-0.999999, 0.999999))
def test_the_inverse_leads_back(share: float, swing: float) -> None:
    edges = np.array([0.0, 1.0, 2.5, 2.0 * math.pi])
    y = np.array([2.0 * math.pi * share])
    (x,) = inverse(lambda x: x + swing * np.sin(x), lambda x: 1.0 + swing * np.cos(x), edges, y)
    assert edges[0] <= x <= edges[-1]
    # Rounding of the function, and of x times the slope.
    assert abs(x + swing * math.sin(x) - y[0]) <= 8.0 * math.ulp(2.0 * math.pi)


def test_an_edge_is_found_as_it_is() -> None:
    edges = np.array([0.0, 0.1, 0.7, 1.0])
    found = inverse(np.exp, np.exp, edges, np.exp(edges))
    assert found.tolist() == edges.tolist()


def test_a_flat_place_is_closed_in_on_by_halving() -> None:
    edges = np.array([-1.0, 1.0])
    y = np.array([1e-30, -1e-12, 0.5])
    got = inverse(lambda x: x**3, lambda x: np.maximum(3.0 * x * x, 1e-300), edges, y)
    assert got == pytest.approx([1e-10, -1e-4, 0.5 ** (1.0 / 3.0)], abs=1e-9)
