"""Banded equations: to the last bit as scipy solves them, and refused alike."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import solve_banded, solveh_banded

from camgeo.numeric import banded as module
from camgeo.numeric.banded import banded, tridiagonal

SEEDS = st.integers(0, 2**32 - 1)


@given(st.integers(2, 8), st.integers(9, 200), SEEDS)
def test_bands(width: int, count: int, seed: int) -> None:
    random = np.random.default_rng(seed)
    matrix = random.normal(size=(2 * width + 1, count)) * 10.0 ** random.integers(-8, 8)
    right = random.normal(size=count)
    given = matrix.copy(), right.copy()
    assert np.array_equal(banded(matrix, right, width), solve_banded((width, width), *given))
    assert np.array_equal(matrix, given[0])
    assert np.array_equal(right, given[1])
    with pytest.raises(np.linalg.LinAlgError):
        banded(np.zeros_like(matrix), right, width)


@given(st.integers(1, 200), SEEDS)
def test_tridiagonal(count: int, seed: int) -> None:
    random = np.random.default_rng(seed)
    middle = random.uniform(1.0, 3.0, count) * 10.0 ** random.integers(-8, 8)
    beside = 0.4 * random.uniform(-1.0, 1.0, count - 1) * np.minimum(middle[1:], middle[:-1])
    right = random.normal(size=count)
    bands = np.vstack((np.append(0.0, beside), middle))
    wanted = solveh_banded(bands, right) if count > 1 else right / middle
    assert np.array_equal(tridiagonal(beside, middle, right), wanted)
    if count > 1:
        with pytest.raises(np.linalg.LinAlgError):
            tridiagonal(beside, -middle, right)


SOLVED = "tridiagonal(np.ones(1), np.array([2.0, 2.0]), np.array([3.0, 3.0])).tolist()"


@pytest.mark.parametrize("there", [True, False])
def test_the_rest_of_scipy_is_left_alone_and_can_come_later(there: bool) -> None:
    """And where the wrapper is not in its place, scipy's own way to it is taken."""
    moved = "" if there else "module.WRAPPER = 'scipy.linalg._moved';"
    code = (
        "import sys; import numpy as np; from camgeo.numeric import banded as module;"
        f"{moved} from camgeo.numeric.banded import tridiagonal;"
        f"assert {SOLVED} == [1.0, 1.0];"
        f"assert ('scipy._lib._array_api' in sys.modules) is {not there};"
        f"import scipy.linalg; assert {SOLVED} == [1.0, 1.0];"
        "assert scipy.linalg.solve(np.eye(2), np.ones(2)).tolist() == [1.0, 1.0]"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
    assert module.WRAPPER.startswith("scipy.linalg.")
