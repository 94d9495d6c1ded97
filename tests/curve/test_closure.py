from __future__ import annotations

import math
from decimal import Decimal

import numpy as np
import pytest
from hypothesis import given

from camgeo.curve.closure import joints
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.mechanism.translating_roller import TranslatingRoller
from camgeo.motion.laws import LAWS
from camgeo.motion.laws.law import Law
from camgeo.motion.plan import Dwell, MotionPlan, Move
from tests.strategies import SMOOTH, attack, pitch_curves

RIGHT = Decimal(90)
SPAN = math.radians(90.0)


def curve_with(law: Law) -> PitchCurve:
    plan = MotionPlan((Dwell(RIGHT), Move(RIGHT, 10.0, law), Dwell(RIGHT), Move(RIGHT, 0.0, law)))
    return PitchCurve(plan, TranslatingRoller(40.0, 5.0), 1)


@attack
@given(curve=pitch_curves(SMOOTH))
def test_smooth_laws_close_point_tangent_and_acceleration(curve: PitchCurve) -> None:
    join = joints(curve)
    size = np.max(np.abs(curve.point(join.phi)))
    assert 0.0 in join.phi
    assert set(curve.breaks.tolist()) <= set(join.phi.tolist())
    assert np.max(join.gaps) <= 1e-14 * size
    # u and v of |Z'| may both be small: its direction is right to the lengths in it.
    assert np.max(join.turns) <= 1e-13 * size / np.min(np.abs(curve.jet(join.phi)[1]))
    assert np.max(np.abs(join.velocity_jumps)) <= 1e-12 * size
    assert np.max(np.abs(join.acceleration_jumps)) <= 1e-11 * size


def test_a_straight_line_turns_the_tangent_by_the_angle_of_its_speed() -> None:
    join = joints(curve_with(LAWS["straight-line"]))
    speed = 10.0 / SPAN
    start = int(np.argmin(np.abs(join.phi - SPAN)))
    assert join.velocity_jumps[start] == pytest.approx(speed, rel=1e-14)
    assert join.turns[start] == pytest.approx(math.atan2(speed, 40.0), rel=1e-12)
    assert np.max(join.gaps) <= 1e-13


def test_a_parabola_jumps_in_acceleration_only() -> None:
    join = joints(curve_with(LAWS["quadratic-parabola"]))
    most = 10.0 / SPAN**2 * 4.0
    jumps = dict(zip(np.degrees(join.phi).round(6).tolist(), join.acceleration_jumps, strict=True))
    assert jumps[90.0] == pytest.approx(most, rel=1e-14)
    assert jumps[135.0] == pytest.approx(-2.0 * most, rel=1e-14)
    assert jumps[180.0] == pytest.approx(most, rel=1e-14)
    assert jumps[0.0] == pytest.approx(-most, rel=1e-14)  # of the return's end, at 360
    assert np.max(np.abs(join.velocity_jumps)) <= 1e-13
    assert np.max(join.turns) <= 1e-13
