"""Comparisons that the last digits of deviations do not decide."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from camgeo.geometry.contour.legs import STEP, clearly_less, in_steps

SIZES = st.floats(1e-12, 1e3)


@given(SIZES, st.integers(-9, 9))
def test_of_equal_deviations_neither_is_less(size: float, units: int) -> None:
    """Equal except for `units` of 1e-11."""
    other = np.array([size * (1.0 + 1e-11 * units)])
    assert not clearly_less(other, np.array([size]))[0]
    assert not clearly_less(np.array([size]), other)[0]


@given(SIZES)
def test_less_by_a_tenth_of_a_step_is_less(size: float) -> None:
    best = np.array([size, np.inf, size])
    found = np.array([size * (1.0 - 0.1 * STEP), size, np.nan])
    assert clearly_less(found, best).tolist() == [True, True, False]


@given(st.integers(-9_000, 9_000), st.floats(-0.499, 0.499))
def test_steps(number: int, part: float) -> None:
    """Numbers go to the nearest multiple of a step, which zero is too."""
    assert in_steps(np.array([(number + part) * STEP]))[0] == number * STEP
