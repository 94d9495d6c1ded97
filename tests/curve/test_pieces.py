from __future__ import annotations

import itertools
from decimal import Decimal

import numpy as np
import pytest
from hypothesis import given

from camgeo.errors import GeometryError
from camgeo.geometry import pieces
from camgeo.geometry.pieces import halves, slowest, smooth_pieces, turn_cells
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.units import TURN
from tests.reference import POLYNOMIAL
from tests.strategies import attack, pitch_curves, plans


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
@given(pitch=pitch_curves())
def test_cells_of_a_turn_end_at_all_borders_and_bound_the_speed(pitch: PitchCurve) -> None:
    low, high = turn_cells(pitch)
    assert low[0] == 0.0
    assert high[-1] == TURN
    assert np.array_equal(low[1:], high[:-1])
    assert np.all(np.isin(pitch.borders, low))
    assert np.max(high - low) <= np.pi / 32.0 + 1e-15
    speed = float(np.min(np.abs(pitch.jet(np.linspace(0.0, TURN, 2001))[1])))
    assert slowest(pitch) <= speed
    assert slowest(pitch) >= 0.5 * speed - 20.0
