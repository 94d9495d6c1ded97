from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.numeric.arrays import ascending, frozen


def test_frozen_arrays_cannot_be_written() -> None:
    array = frozen([1, 2], np.float64)
    assert array.dtype == np.float64
    with pytest.raises(ValueError, match="read-only"):
        array[0] = 5.0


def test_the_source_stays_writable_and_apart() -> None:
    source = np.array([1.0, 2.0])
    array = frozen(source, np.float64)
    source[0] = 9.0
    assert array.tolist() == [1.0, 2.0]


@given(values=st.lists(st.floats(-1e3, 1e3), max_size=30))
def test_ascending_is_what_numpy_calls_unique(values: list[float]) -> None:
    array = np.array(values, dtype=np.float64)
    assert np.array_equal(ascending(array), np.unique(array))
