from __future__ import annotations

import itertools
from decimal import Decimal

import pytest
from hypothesis import given

from camgeo.curve.pieces import smooth_pieces
from camgeo.motion.plan import Dwell, MotionPlan, Move
from camgeo.units import TURN
from tests.reference import POLYNOMIAL
from tests.strategies import attack, plans


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
