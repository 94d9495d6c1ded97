from __future__ import annotations

import numpy as np
import pytest

from camgeo.geometry.pitch_curve import BLOCK, cells_in_blocks, in_blocks
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.units import TURN
from tests.reference import inner_of, mechanisms, pitch_curve_of


@pytest.mark.parametrize("count", [0, 1, BLOCK - 1, BLOCK, BLOCK + 1, 2 * BLOCK, 3 * BLOCK + 7])
def test_blocks_cover_all_points_once_in_order(count: int) -> None:
    sizes = []

    @in_blocks
    def function(_: None, x: FloatArray, side: Side) -> FloatArray:
        assert side == "left"
        sizes.append(len(x))
        return np.stack((x, 2.0 * x))

    x = np.arange(float(count))
    assert np.array_equal(function(None, x, "left"), np.stack((x, 2.0 * x)))
    assert max(sizes) <= BLOCK
    assert sum(sizes) == count


def test_a_point_has_the_same_value_in_any_array() -> None:
    curve = pitch_curve_of(mechanisms()["T6_setzhub_sm_program"]["params"])
    phi = np.linspace(0.0, TURN, 2 * BLOCK + 11)
    some = slice(BLOCK - 3, BLOCK + 3)
    assert np.array_equal(curve.jet(phi)[:, some], curve.jet(phi[some]))
    assert np.array_equal(curve.curvature(phi)[some], curve.curvature(phi[some]))
    inner = inner_of(curve)
    assert np.array_equal(inner.point(phi)[some], inner.point(phi[some]))


@pytest.mark.parametrize("count", [0, 1, BLOCK, BLOCK + 1, 3 * BLOCK + 7])
def test_blocks_cover_all_cells_once_in_order(count: int) -> None:
    sizes: list[int] = []

    @cells_in_blocks
    def ends(_: object, low: FloatArray, high: FloatArray) -> FloatArray:
        sizes.append(len(low))
        return np.stack((low, high))

    phi = np.arange(float(count))
    assert np.array_equal(ends(None, phi, phi + 0.5), np.stack((phi, phi + 0.5)))
    assert max(sizes) <= BLOCK
