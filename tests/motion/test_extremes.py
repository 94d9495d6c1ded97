from __future__ import annotations

from decimal import Decimal

import numpy as np
import pytest
from hypothesis import given

from camgeo.kinematics.motion import Dwell as DwellSpan
from camgeo.kinematics.motion import Jet, lift_range, pieces, turning_angles
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.units import TURN
from tests.laws import LAWS
from tests.strategies import attack, plans


class Wave:
    """A motion that overshoots between its borders: s = 3 sin(phi - 1)."""

    breaks = np.empty(0)
    borders = np.empty(0)
    dwells: tuple[DwellSpan, ...] = ()

    def jet(self, phi: FloatArray, side: Side = "right", order: int = 3) -> Jet:
        x = phi - 1.0
        return 3.0 * np.stack((np.sin(x), np.cos(x), -np.sin(x), -np.cos(x)))

    def jet_and_bounds(self, low: FloatArray, high: FloatArray) -> tuple[Jet, Jet]:
        return self.jet(0.5 * (low + high)), np.full((4, len(low)), 6.0)


@attack
@given(plan=plans(tuple(LAWS)))
def test_the_range_is_that_of_the_positions(plan: MotionPlan) -> None:
    targets = [0.0, *(segment.to for segment in plan.segments if isinstance(segment, Move))]
    low, high = lift_range(plan)
    assert (low, high) == (min(targets), max(targets))


def test_turning_points_inside_a_piece_are_found() -> None:
    # The value is flat there: the place to 1e-8 gives it to the last digit.
    assert lift_range(Wave()) == pytest.approx((-3.0, 3.0), rel=4e-16)


def test_a_motion_that_never_moves() -> None:
    assert lift_range(MotionPlan((Dwell(Decimal(360)),))) == (0.0, 0.0)


@attack
@given(plan=plans())
def test_pieces_fill_the_turn(plan: MotionPlan) -> None:
    found = pieces(plan)
    assert found[0][0] == 0.0
    assert found[-1][1] == TURN
    assert [end for _, end in found[:-1]] == [start for start, _ in found[1:]]
    assert [start for start, _ in found] == plan.borders.tolist()


def test_without_borders_the_turn_is_one_piece() -> None:
    assert pieces(Wave()) == [(0.0, TURN)]


def test_a_rest_that_rounds_to_zero_is_no_turning_point() -> None:
    """Near its ends this law's velocity is 1 - cos, which is 0 within 1e-8."""
    half = Decimal(180)
    law = LAWS["inclined-sine"]
    plan = MotionPlan((Move(half, 6.0, law), Move(half, 0.0, law)))
    assert not len(turning_angles(plan))
