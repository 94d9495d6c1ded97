from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.numeric.arrays import (
    ONE,
    SHARE,
    FloatArray,
    ascending,
    dot,
    frozen,
    grouped,
    joined,
    merged,
    phase,
    resolved,
    taken,
)
from camgeo.units import TURN


def test_frozen_arrays_cannot_be_written_and_their_source_can() -> None:
    source = np.array([1, 2])
    array = frozen(source, np.float64)
    source[0] = 9
    assert array.dtype == np.float64
    assert array.tolist() == [1.0, 2.0]
    assert not array.flags.writeable


@given(values=st.lists(st.floats(-1e3, 1e3), max_size=30))
def test_ascending_is_what_numpy_calls_unique(values: list[float]) -> None:
    array = np.array(values, dtype=np.float64)
    assert np.array_equal(ascending(array), np.unique(array))


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


@given(st.complex_numbers(allow_nan=False))
def test_the_phase_is_that_of_numpy(value: complex) -> None:
    assert math.copysign(1.0, phase(value)) == math.copysign(1.0, np.angle(value))
    assert phase(value) == pytest.approx(np.angle(value), rel=1e-15)


@pytest.mark.parametrize("height", [5e-324, -5e-324])
def test_the_smallest_phase_is_no_error(height: float) -> None:
    """`cmath.phase` raises an OverflowError."""
    assert phase(complex(90.0, height)) == math.copysign(0.0, height)
    assert phase(complex(-90.0, height)) == math.copysign(math.pi, height)


@dataclass(frozen=True)
class Inner:
    x: FloatArray
    y: FloatArray


@dataclass(frozen=True)
class Outer:
    inner: Inner
    z: FloatArray


def test_rows_are_taken_and_joined_in_all_columns() -> None:
    rows = Inner(np.arange(5.0), 10.0 * np.arange(5.0))
    for which in (np.array([3, 1]), [3, 1], np.arange(5) % 2 == 1, slice(1, 3)):
        found = taken(rows, which)
        assert found.x.tolist() == np.arange(5.0)[which].tolist()
        assert found.y.tolist() == (10.0 * np.arange(5.0))[which].tolist()
    parts = [Outer(Inner(np.full(n, 1.0 * n), np.full(n, 2.0 * n)), np.full(n, -n)) for n in (2, 3)]
    for some in (parts[:1], parts):
        whole = joined(some)
        wanted = [n for n in (2, 3)[: len(some)] for _ in range(n)]
        assert whole.inner.x.tolist() == wanted
        assert whole.inner.y.tolist() == [2.0 * n for n in wanted]
        assert whole.z.tolist() == [-n for n in wanted]


@given(counts=st.lists(st.integers(0, 5), max_size=8))
def test_items_of_groups_are_counted_in_each(counts: list[int]) -> None:
    group, number = grouped(np.array(counts, dtype=np.intp))
    wanted = [(k, each) for k, count in enumerate(counts) for each in range(count)]
    assert list(zip(group.tolist(), number.tolist(), strict=True)) == wanted


def test_scalar_products_of_plane_vectors() -> None:
    a = np.array([3.0 + 4.0j, -1.0 + 2.0j])
    assert dot(a, np.array([2.0 - 1.0j, 5.0 + 0.5j])).tolist() == [2.0, -4.0]
    assert dot(a, 1.0 + 10.0j).tolist() == [43.0, 19.0]


def test_angles_are_merged_up_to_eight_spacings_of_the_last() -> None:
    step = np.spacing(6.0)
    assert merged(np.array([1.0, 1.0 + 8.0 * step, 6.0])).tolist() == [1.0, 6.0]
    assert len(merged(np.array([1.0, 1.0 + 9.0 * step, 6.0]))) == 3
    assert merged(np.array([0.0, 6.0 - 2.0 * step, 6.0])).tolist() == [0.0, 6.0]
    assert merged(np.array([2.5])).tolist() == [2.5]
    assert merged(np.empty(0)).tolist() == []


# Sums that are 0 up to rounding, and one among many --------------------------------------------


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
    at = ONE.paired_values(
        lambda phi, side: phi * len(side), x, "right", np.zeros(5, dtype=np.intp)
    )
    assert at.tolist() == (5.0 * x).tolist()
