"""Stretches of a turn in which a function is negative."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.numeric.peaks import INSET
from camgeo.numeric.ranges import stretch_around, stretch_below
from camgeo.units import TURN

EDGES = np.linspace(0.0, TURN, 9)

NEAR = INSET * TURN / 8.0
"""A root this near to an edge is not told from it."""


@given(shift=st.floats(0.0, TURN), level=st.floats(-0.9, 0.9))
def test_a_wave_below_a_level(shift: float, level: float) -> None:
    """cos(phi - shift) < level from shift + acos(level) to shift - acos(level), once round."""
    lowest = (shift + math.pi) % TURN
    found = stretch_below(lambda phi: np.cos(phi - shift) - level, EDGES, lowest)
    assert found is not None
    for angle, expected in zip(
        found, (shift + math.acos(level), shift - math.acos(level)), strict=True
    ):
        away = (angle - expected + math.pi) % TURN - math.pi
        assert abs(away) <= NEAR


def test_all_of_the_turn() -> None:
    assert stretch_below(lambda phi: np.cos(phi) - 2.0, EDGES, math.pi) == (0.0, TURN)


def test_nowhere_and_at_one_place_alone() -> None:
    assert stretch_below(lambda phi: np.cos(phi) + 2.0, EDGES, math.pi) is None
    assert stretch_below(lambda phi: 1.0 + np.cos(phi), EDGES, math.pi) is None


@pytest.mark.parametrize(
    ("inside", "place", "expected"),
    [
        ([True, False, False, True], 0.0, (0.75 * TURN, 0.25 * TURN)),
        ([True, False, False, True], TURN, (0.75 * TURN, 0.25 * TURN)),
        ([False, True, True, False], 0.5 * TURN, (0.25 * TURN, 0.75 * TURN)),
        ([False, True, False, False], 0.5 * TURN, (0.25 * TURN, 0.5 * TURN)),
        ([False, False, False, True], 0.75 * TURN, (0.75 * TURN, 0.0)),
        ([False, True, False, False], 0.0, None),
    ],
)
def test_pieces_next_to_each_other(
    inside: list[bool], place: float, expected: tuple[float, float] | None
) -> None:
    cuts = np.linspace(0.0, TURN, 5)
    assert stretch_around(cuts, np.array(inside), place) == expected
