"""Smooth pieces and cells of one turn, bounds over cells, and extremes over pieces."""

from __future__ import annotations

import itertools
import math
from decimal import Decimal

import numpy as np
import pytest
from hypothesis import given

from camgeo.check.disc import slowest
from camgeo.errors import GeometryError
from camgeo.geometry import pieces
from camgeo.geometry.pieces import (
    Extremes,
    curvature_extremes,
    extremes,
    halves,
    smooth_pieces,
    turn_cells,
)
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.kinematics.mechanism.rollers import TranslatingRoller
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.numeric.arrays import FloatArray, Quantity, Side
from camgeo.units import TURN
from tests.laws import LAWS
from tests.reference import POLYNOMIAL, hard_case, pitch_curve_of
from tests.strategies import BENT, attack, pitch_curves, plans, wild_pitch_curves


@attack
@given(plan=plans())
def test_pieces_fill_one_turn_from_break_to_break(plan: MotionPlan) -> None:
    found = smooth_pieces(plan)
    assert sum(piece.end - piece.start for piece in found) == pytest.approx(TURN, rel=1e-15)
    for before, after in itertools.pairwise(found):
        assert before.end == after.start
    if plan.breaks.size:
        assert [piece.start for piece in found] == plan.breaks.tolist()


@attack
@given(plan=plans())
def test_rests_are_pieces_and_moves_are_not_rests(plan: MotionPlan) -> None:
    resting = [piece for piece in smooth_pieces(plan) if piece.dwell]
    dwells = sorted(plan.dwells, key=lambda dwell: dwell.start)
    assert [piece.start for piece in resting] == [dwell.start for dwell in dwells]
    spans = [piece.end - piece.start for piece in resting]
    assert spans == pytest.approx([dwell.span for dwell in dwells], rel=1e-14)


def test_a_rest_of_the_whole_turn() -> None:
    (piece,) = smooth_pieces(MotionPlan((Dwell(Decimal(360)),)))
    assert (piece.start, piece.end, piece.dwell) == (0.0, TURN, True)


def test_the_last_piece_may_reach_across_cam_angle_0() -> None:
    quarter = Decimal(90)
    plan = MotionPlan(
        (
            Dwell(quarter),
            Move(quarter, 5.0, POLYNOMIAL),
            Move(quarter, 0.0, POLYNOMIAL),
            Dwell(quarter),
        )
    )
    last = smooth_pieces(plan)[-1]
    assert last.dwell
    assert (last.start, last.end) == pytest.approx((0.75 * TURN, 1.25 * TURN), rel=1e-15)


def test_as_many_cells_are_halved_as_may_be_and_no_more(monkeypatch: pytest.MonkeyPatch) -> None:
    low, high = np.arange(7.0), np.arange(7.0) + 1.0
    which = np.array([True, False, True, True, True, False, True])
    monkeypatch.setattr(pieces, "MOST", 5)
    lows, highs = halves(low, high, which)
    assert sorted(zip(lows.tolist(), highs.tolist(), strict=True)) == [
        (k + part, k + part + 0.5) for k in (0, 2, 3, 4, 6) for part in (0.0, 0.5)
    ]
    monkeypatch.setattr(pieces, "MOST", 4)
    with pytest.raises(GeometryError, match="too exactly along a stretch"):
        halves(low, high, which)


@attack
@given(pitch=wild_pitch_curves())
def test_cells_of_a_turn_end_at_all_borders_and_bound_the_speed(pitch: PitchCurve) -> None:
    low, high = turn_cells(pitch)
    assert (low[0], high[-1]) == (0.0, TURN)
    assert np.array_equal(low[1:], high[:-1])
    assert np.all(np.isin(pitch.borders, low))
    assert np.max(high - low) <= np.pi / 32.0 + 1e-15
    assert slowest(pitch) <= np.min(np.abs(pitch.jet(np.linspace(0.0, TURN, 2001))[1]))


def test_the_bound_is_no_bound_at_a_standstill() -> None:
    assert slowest(pitch_curve_of(hard_case("HC18")[0])) <= 0.0


def test_of_a_circle_the_bound_is_near_its_radius() -> None:
    """Over a half cell h = pi/64 a point of a circle of radius 40 changes Z' by 40 (h + h^2/2)."""
    pitch = PitchCurve(MotionPlan((Dwell(Decimal(360)),)), TranslatingRoller(40.0, 5.0), 1)
    h = np.pi / 64.0
    assert slowest(pitch) == pytest.approx(40.0 * (1.0 - h - 0.5 * h * h), rel=1e-12)


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
