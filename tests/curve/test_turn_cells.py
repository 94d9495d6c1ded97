"""Cells of one turn, and the bound of |Z'| that is taken over them."""

from __future__ import annotations

from decimal import Decimal

import numpy as np
import pytest
from hypothesis import given

from camgeo.errors import GeometryError
from camgeo.geometry.pieces import MOST, halves, slowest, turn_cells
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.kinematics.plan import Dwell, MotionPlan
from camgeo.units import TURN
from tests.reference import hard_case, pitch_curve_of
from tests.strategies import attack, wild_pitch_curves


@attack
@given(wild_pitch_curves())
def test_cells_fill_the_turn_and_cross_no_border(pitch: PitchCurve) -> None:
    low, high = turn_cells(pitch)
    assert low[0] == 0.0
    assert high[-1] == TURN
    assert np.array_equal(low[1:], high[:-1])
    assert np.all(np.isin(pitch.borders, low))


@attack
@given(wild_pitch_curves())
def test_the_roller_centre_is_nowhere_slower_than_the_bound(pitch: PitchCurve) -> None:
    speeds = np.abs(pitch.jet(np.linspace(0.0, TURN, 2001))[1])
    assert slowest(pitch) <= np.min(speeds)


def test_the_bound_is_no_bound_at_a_standstill() -> None:
    assert slowest(pitch_curve_of(hard_case("HC18")[0])) <= 0.0


def test_of_a_circle_the_bound_is_near_its_radius() -> None:
    """Over a half cell h = pi/64 a point of a circle of radius 40 changes Z' by 40 (h + h^2/2)."""
    pitch = PitchCurve(MotionPlan((Dwell(Decimal(360)),)), TranslatingRoller(40.0, 5.0), 1)
    h = np.pi / 64.0
    assert slowest(pitch) == pytest.approx(40.0 * (1.0 - h - 0.5 * h * h), rel=1e-12)


def test_halves_fill_the_cells_that_are_asked_for() -> None:
    low, high = np.array([0.0, 1.0, 2.0]), np.array([1.0, 2.0, 4.0])
    lows, highs = halves(low, high, np.array([True, False, True]))
    assert sorted(zip(lows.tolist(), highs.tolist(), strict=True)) == [
        (0.0, 0.5), (0.5, 1.0), (2.0, 3.0), (3.0, 4.0),
    ]  # fmt: skip


def test_cells_without_end_are_refused() -> None:
    many = np.zeros(MOST + 1)
    with pytest.raises(GeometryError, match="too steep"):
        halves(many, many, many == 0.0)
