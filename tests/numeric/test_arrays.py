from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.numeric.arrays import ascending, frozen, merged, phase
from camgeo.units import TURN


def test_frozen_arrays_cannot_be_written() -> None:
    array = frozen([1, 2], np.float64)
    assert array.dtype == np.float64
    assert not array.flags.writeable


def test_the_source_stays_writable_and_apart() -> None:
    source = np.array([1.0, 2.0])
    array = frozen(source, np.float64)
    source[0] = 9.0
    assert array.tolist() == [1.0, 2.0]


@given(values=st.lists(st.floats(-1e3, 1e3), max_size=30))
def test_ascending_is_what_numpy_calls_unique(values: list[float]) -> None:
    array = np.array(values, dtype=np.float64)
    assert np.array_equal(ascending(array), np.unique(array))


def test_merged_is_ascending_where_nothing_is_near() -> None:
    assert merged(np.array([3.0, 1.0, 2.0, 1.0])).tolist() == [1.0, 2.0, 3.0]
    assert merged(np.empty(0)).tolist() == []
    assert merged(np.array([2.0])).tolist() == [2.0]


def test_merged_makes_one_of_what_differs_by_rounding() -> None:
    ulp = float(np.spacing(TURN))
    near = np.array([0.0, ulp, 1.0, 1.0 + 4.0 * ulp, 2.0, TURN - 3.0 * ulp, TURN])
    assert merged(near).tolist() == [0.0, 1.0, 2.0, TURN]
    # What is farther apart than that is not.
    apart = np.array([0.0, 1.0, 1.0 + 100.0 * ulp, TURN])
    assert merged(apart).tolist() == apart.tolist()


@given(
    values=st.lists(st.floats(0.0, TURN), min_size=1, max_size=20),
    steps=st.lists(st.integers(-3, 3), min_size=20, max_size=20),
)
def test_merged_keeps_both_ends_and_all_that_stand_apart(
    values: list[float], steps: list[int]
) -> None:
    """Each of the angles, and another one that differs in the last digits."""
    array = np.clip(np.array([0.0, *values, TURN]), 0.0, TURN)
    close = array[1:-1] + np.spacing(TURN) * np.array(steps[: len(values)])
    both = np.concatenate((array, np.clip(close, 0.0, TURN)))
    found = merged(both)
    assert (found[0], found[-1]) == (0.0, TURN)
    assert np.all(np.diff(found) > 0.0)
    assert set(found) <= set(both)
    # No angle is farther from one that was kept than the group that it was counted to is wide.
    gap = 8.0 * np.spacing(TURN) * len(both)
    assert np.all(np.min(np.abs(both[:, np.newaxis] - found), axis=1) <= gap)
    # Told again it is the same.
    assert merged(found).tolist() == found.tolist()


def test_merged_takes_any_order() -> None:
    array = np.array([0.0, 1.0, 1.0 + np.spacing(1.0), 3.0, TURN])
    for shift in range(len(array)):
        assert merged(np.roll(array, shift)).tolist() == [0.0, 1.0, 3.0, TURN]


@given(st.complex_numbers(allow_nan=False))
def test_the_phase_is_that_of_numpy(value: complex) -> None:
    assert math.copysign(1.0, phase(value)) == math.copysign(1.0, np.angle(value))
    assert phase(value) == pytest.approx(np.angle(value), rel=1e-15)


@pytest.mark.parametrize("height", [5e-324, -5e-324])
def test_the_smallest_phase_is_no_error(height: float) -> None:
    """`cmath.phase` raises an OverflowError."""
    assert phase(complex(90.0, height)) == math.copysign(0.0, height)
    assert phase(complex(-90.0, height)) == math.copysign(math.pi, height)
