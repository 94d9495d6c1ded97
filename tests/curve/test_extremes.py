from __future__ import annotations

import math
from decimal import Decimal

import numpy as np
import pytest
from hypothesis import given

from camgeo.check.flank import transmission_angle_extremes
from camgeo.geometry.pieces import Extremes, curvature_extremes, extremes
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.numeric.arrays import FloatArray, Quantity, Side
from camgeo.units import TURN
from tests.laws import LAWS
from tests.strategies import BENT, attack, pitch_curves

STEPS = np.concatenate(
    (np.logspace(-7, -2, 26), np.linspace(0.02, 0.98, 49), 1.0 - np.logspace(-2, -7, 26))
)
"""Shares of a stretch at which it is sampled, denser at its ends."""


def samples(found: Extremes) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Cam angles (k, m) in each stretch between neighbouring entries, and its end values (k, 1)."""
    wide = np.flatnonzero(np.diff(found.phi) > 1e-6)
    start, end = found.phi[wide, np.newaxis], found.phi[wide + 1, np.newaxis]
    ends = np.stack((found.values[wide], found.values[wide + 1]))
    low, high = np.min(ends, axis=0), np.max(ends, axis=0)
    return start + STEPS * (end - start), low[:, np.newaxis], high[:, np.newaxis]


@attack
@given(curve=pitch_curves(BENT))
def test_curvature_is_monotone_between_neighbouring_extremes(curve: PitchCurve) -> None:
    found = curvature_extremes(curve)
    phi, low, high = samples(found)
    values = curve.curvature(phi.ravel()).reshape(phi.shape)
    limit = 1e-12 * np.max(np.abs(found.values))
    assert np.all(values >= low - limit)
    assert np.all(values <= high + limit)


@attack
@given(curve=pitch_curves(BENT))
def test_no_transmission_angle_is_smaller_than_the_smallest_found(curve: PitchCurve) -> None:
    smallest, place = transmission_angle_extremes(curve).smallest()
    dense = curve.transmission_angle(np.linspace(0.0, TURN, 4001))
    assert np.min(dense) >= smallest - 1e-13
    at = np.array([place])
    sides: tuple[Side, Side] = ("right", "left")
    both = [curve.transmission_angle(at, side)[0] for side in sides]
    assert min(abs(value - smallest) for value in both) <= 1e-13


def test_an_extreme_next_to_a_break_is_found() -> None:
    """Nearer to the end of its piece than the first point of the grid."""
    sixth = Decimal(60)
    law = LAWS["polynomial-345"]
    plan = MotionPlan((Move(sixth, 1.0, law), Dwell(Decimal(240)), Move(sixth, 0.0, law)))
    top = 1e-4

    def value(phi: FloatArray, side: Side) -> FloatArray:
        return np.asarray(-((phi - top) ** 2))

    def slope(phi: FloatArray, side: Side) -> FloatArray:
        return np.asarray(-2.0 * (phi - top))

    assert plan.breaks[1] / 256.0 > top
    assert extremes(plan, value, slope).largest()[1] == pytest.approx(top, rel=1e-12)


def test_slopes_of_several_quantities_are_searched_together() -> None:
    half = Decimal(180)
    law = LAWS["modified-sine"]
    plan = MotionPlan((Move(half, 6.0, law), Move(half, 0.0, law)))

    def rows(which: int | slice) -> Quantity:
        return lambda phi, side: np.asarray(plan.jet(phi, side)[which])

    both = extremes(plan, rows(1), rows(slice(2, 4)))
    apart = [extremes(plan, rows(1), rows(order)) for order in (2, 3)]
    assert set(both.phi) == {*apart[0].phi, *apart[1].phi}


def test_entries_run_over_one_turn_with_both_sides_of_each_break() -> None:
    half = Decimal(180)
    law = LAWS["quadratic-parabola"]
    plan = MotionPlan((Move(half, 6.0, law), Move(half, 0.0, law)))

    def acceleration(phi: FloatArray, side: Side) -> FloatArray:
        return np.asarray(plan.jet(phi, side)[2])

    def jerk(phi: FloatArray, side: Side) -> FloatArray:
        return np.asarray(plan.jet(phi, side)[3])

    found = extremes(plan, acceleration, jerk)
    assert found.phi == pytest.approx(
        np.radians([0.0, 90.0, 90.0, 180.0, 180.0, 270.0, 270.0, 360.0]), rel=1e-15
    )
    assert np.sign(found.values).tolist() == [1, 1, -1, -1, -1, -1, 1, 1]
    assert found.smallest()[1] == pytest.approx(0.5 * math.pi, rel=1e-15)
    assert found.largest()[1] == 0.0
    assert not found.values.flags.writeable
