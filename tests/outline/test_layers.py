"""The outermost of pieces over a turn, compared with that at single angles."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.geometry.outline import outline
from camgeo.numeric.arrays import FloatArray, IntArray, ascending
from camgeo.units import TURN

ranges = st.lists(
    st.tuples(st.integers(0, 359), st.integers(1, 359)), min_size=1, max_size=8, unique=True
)
"""Starts and widths [deg] of the ranges of pieces, each higher than the one before."""


def outermost(low: FloatArray, width: FloatArray) -> tuple[FloatArray, IntArray]:
    """Borders and the piece from each on; piece k has the height k."""
    high = (low + width) % TURN
    nodes = ascending(np.concatenate((low, high)))
    cells = outline.Cells.between(nodes)
    first = np.searchsorted(nodes, low)
    count = np.remainder(np.searchsorted(nodes, high) - first, len(nodes))
    cell, piece = outline.covered(cells, first, count, "pieces lie")
    kept = outline.seen(cell, piece.astype(float), piece.astype(float))
    borders, parent, held = outline.outermost(
        cells, (cell[kept], piece[kept]), np.empty(0), lambda which, _: which.astype(float)
    )
    assert np.array_equal(parent, np.arange(len(nodes)))
    return outline.changes(borders, held)


@given(ranges)
def test_the_highest_piece_at_every_angle(degrees: list[tuple[int, int]]) -> None:
    low, width = np.radians(np.array(degrees, dtype=np.float64)).T
    borders, held = outermost(low, width)
    between = np.radians(np.arange(360.0) + 0.5)
    covers = (between - low[:, None]) % TURN < width[:, None]
    highest = [int(np.flatnonzero(each)[-1]) if each.any() else outline.NONE for each in covers.T]
    for turn in (-TURN, 0.0, TURN):
        assert outline.piece_at(borders, held, between + turn, "right").tolist() == highest
    before = outline.piece_at(borders, held, borders, "left")
    assert np.array_equal(before, np.roll(held, 1))


def test_all_pairs_in_one_cell() -> None:
    cell = np.array([0, 0, 0, 2, 3, 3])
    found = {pair for one, other in outline.together(cell) for pair in zip(one, other, strict=True)}
    assert found == {(0, 1), (1, 2), (0, 2), (4, 5)}


def test_too_many_layers(monkeypatch: pytest.MonkeyPatch) -> None:
    """Three pieces over three of six cells each: nine pairs, as many as may be, and no more."""
    low, width = np.array([0.0, 0.1, 0.2]), np.array([6.0, 6.0, 6.0])
    monkeypatch.setattr(outline, "MOST_PAIRS", 9)
    assert outermost(low, width)[1].tolist() == [0, 1, 2, outline.NONE]
    monkeypatch.setattr(outline, "MOST_PAIRS", 8)
    with pytest.raises(GeometryError, match="its pieces lie in 2 layers; smooth it first"):
        outermost(low, width)
