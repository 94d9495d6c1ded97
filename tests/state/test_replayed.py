"""The motion over the corners of a trimmed disc, as a motion like any other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.dynamics.state.written import ReplayedMotion
from camgeo.geometry.outline.roller import AS_DEMANDED
from camgeo.kinematics.motion import Dwell
from camgeo.numeric.arrays import FloatArray, IntArray
from camgeo.units import TURN
from tests.effects.scenes import design
from tests.strategies import attack

TRIMMED = ("swallow_tail", "cut_lobe", "trimmed_ring", "straight_moves")


def replayed(name: str) -> ReplayedMotion:
    motion: Any = design(name, "").effects.subject.state.motion
    assert isinstance(motion, ReplayedMotion)
    return motion


@pytest.mark.parametrize("name", TRIMMED)
def test_each_derivative_is_that_of_the_one_before(name: str) -> None:
    motion = replayed(name)
    edges = np.append(motion.borders, motion.borders[0] + TURN)
    wide = np.flatnonzero(np.diff(edges) > 1e-3)
    middle, step = 0.5 * (edges[wide] + edges[wide + 1]), 1e-5
    before, here, after = (motion.jet(middle + k * step) for k in (-1, 0, 1))
    size = np.max(np.abs(motion.jet(np.linspace(0.0, TURN, 999))), axis=1)
    for order in range(3):
        slope = (after[order] - before[order]) / (2.0 * step)
        assert slope == pytest.approx(here[order + 1], abs=1e-6 * (size[order] + size[order + 1]))


@pytest.mark.parametrize("name", TRIMMED)
def test_it_breaks_where_corners_begin_and_end_and_is_the_demanded_one_beside_them(
    name: str,
) -> None:
    motion = replayed(name)
    phi = np.linspace(0.0, TURN, 5000)
    held = motion.on_corner(phi, "right")
    assert np.any(held)
    assert motion.jet(phi[~held]) == pytest.approx(motion.demanded.jet(phi[~held]), abs=0.0)
    assert np.all(motion.jet(phi[held])[0] != motion.demanded.jet(phi[held])[0])
    for start, end in motion.ranges:
        assert {start % TURN, end % TURN} <= {*motion.breaks.tolist()} & {*motion.borders.tolist()}
        inner = (motion.borders - start) % TURN
        assert not np.any((inner > 0.0) & (inner < end - start))
    jet, bounds = motion.jet_and_bounds(phi[:-1], phi[1:])
    middle = 0.5 * (phi[:-1] + phi[1:])
    assert jet == pytest.approx(motion.jet(middle), abs=0.0)
    assert np.array_equal(np.isinf(bounds[0]), motion.on_corner(middle, "right"))


@dataclass(frozen=True)
class Lying:
    """Corners of a disc between some of its borders, and demanded rests."""

    borders: FloatArray
    numbers: IntArray
    dwells: tuple[Dwell, ...]


@attack
@given(
    st.lists(st.integers(0, 71), min_size=2, max_size=6, unique=True),
    st.integers(0, 71),
    st.integers(1, 72),
    st.integers(0, 1),
)
def test_of_a_dwell_what_no_corner_interrupts_is_left(
    borders: list[int], start: int, span: int, first: int
) -> None:
    """Counted in cells of five degrees."""
    cell = TURN / 72.0
    places = np.sort(borders)
    numbers = np.where((np.arange(len(places)) + first) % 2, 0, AS_DEMANDED)
    dwell = Dwell(start * cell, span * cell)
    lying: Any = Lying(places * cell, numbers, (dwell,))
    left = ReplayedMotion(lying, lying).dwells
    middle = np.arange(72) + 0.5
    inside = np.zeros(72, dtype=np.int64)
    for each in left:
        inside += (middle - each.start / cell) % 72 < each.span / cell
    held = numbers[np.searchsorted(places, middle) - 1] != AS_DEMANDED
    assert np.array_equal(inside, ((middle - start) % 72 < span) & ~held)
