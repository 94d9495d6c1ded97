from __future__ import annotations

import math
from decimal import Decimal

import numpy as np
import pytest
from hypothesis import given

from camgeo.geometry.pitch_curve import PitchCurve, joints
from camgeo.kinematics.laws import make_law
from camgeo.kinematics.laws.law import Law
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from tests.laws import LAWS
from tests.strategies import SMOOTH, attack, pitch_curves

RIGHT = Decimal(90)
SPAN = math.radians(90.0)


def curve_with(law: Law) -> PitchCurve:
    plan = MotionPlan((Dwell(RIGHT), Move(RIGHT, 10.0, law), Dwell(RIGHT), Move(RIGHT, 0.0, law)))
    return PitchCurve(plan, TranslatingRoller(40.0, 5.0), 1)


@attack
@given(curve=pitch_curves(SMOOTH))
def test_smooth_laws_close_point_and_tangent(curve: PitchCurve) -> None:
    join = joints(curve)
    size = np.max(np.abs(curve.point(join.phi)))
    assert 0.0 in join.phi
    assert set(curve.breaks.tolist()) <= set(join.phi.tolist())
    assert np.max(join.gaps) <= 1e-14 * size
    # u and v of |Z'| may both be small: its direction is right to the lengths in it.
    assert np.max(join.turns) <= 1e-13 * size / np.min(np.abs(curve.jet(join.phi)[1]))


def test_a_straight_line_turns_the_tangent_by_the_angle_of_its_speed() -> None:
    join = joints(curve_with(make_law("straight-line")))
    speed = 10.0 / SPAN
    start = int(np.argmin(np.abs(join.phi - SPAN)))
    assert join.turns[start] == pytest.approx(math.atan2(speed, 40.0), rel=1e-12)
    assert np.max(join.gaps) <= 1e-13


def test_a_parabola_closes_in_its_tangents() -> None:
    join = joints(curve_with(LAWS["quadratic-parabola"]))
    assert {90.0, 135.0, 180.0, 0.0} <= set(np.degrees(join.phi).round(6).tolist())
    assert np.max(join.turns) <= 1e-13
