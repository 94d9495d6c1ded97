from __future__ import annotations

import cmath
import math
from decimal import Decimal

import numpy as np
import pytest

from camgeo.curve.pitch_curve import PitchCurve
from camgeo.errors import GeometryError
from camgeo.mechanism.oscillating_roller import OscillatingRoller
from camgeo.motion.plan import MotionPlan, Move
from tests.reference import POLYNOMIAL

PIVOT = complex(-96.0, -72.0)  # 120 mm from the cam axis
SWING = 0.4
RISE = MotionPlan((Move(Decimal(180), SWING, POLYNOMIAL), Move(Decimal(180), 0.0, POLYNOMIAL)))
TOP = np.array([math.pi])


@pytest.mark.parametrize("base", [39.999, 40.0, 200.0, 200.001])
def test_a_base_radius_that_closes_no_triangle_is_refused(base: float) -> None:
    with pytest.raises(GeometryError, match="between 40 and 200 mm") as caught:
        OscillatingRoller(PIVOT, 80.0, base, 5.0)
    assert caught.value.key == "follower.base_radius"
    assert caught.value.value == f"{base:g}"


@pytest.mark.parametrize("base", [40.001, 60.0, 120.0, 199.999])
def test_the_start_angle_is_that_of_the_triangle(base: float) -> None:
    angle = OscillatingRoller(PIVOT, 80.0, base, 5.0).start_angle
    # Law of cosines, the other way round.
    square = 120.0**2 + 80.0**2 - 2.0 * 120.0 * 80.0 * math.cos(angle)
    assert math.sqrt(square) == pytest.approx(base, rel=1e-12)


def test_the_start_angle_keeps_its_digits_where_the_arccosine_loses_them() -> None:
    base = 40.0 * (1.0 + 2.0**-40)
    # 1 - cos is (base^2 - 40^2) / (2 l_1 l_3), and the angle small.
    expected = 2.0 * math.asin(math.sqrt(1600.0 * (2.0**-39 + 2.0**-80) / (4.0 * 9600.0)))
    assert OscillatingRoller(PIVOT, 80.0, base, 5.0).start_angle == pytest.approx(
        expected, rel=4e-16
    )


@pytest.mark.parametrize("arm_side", [1, -1])
@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("rotation", [1, -1])
def test_direction_and_side(arm_side: int, direction: int, rotation: int) -> None:
    follower = OscillatingRoller(PIVOT, 80.0, 90.0, 5.0, arm_side, direction)
    curve = PitchCurve(RISE, follower, rotation)
    start, top = curve.point(np.zeros(1))[0], curve.point(TOP)[0]
    assert abs(start) == pytest.approx(90.0, rel=1e-15)
    assert math.copysign(1.0, abs(top) - 90.0) == direction
    arm = start - PIVOT
    side = (np.conj(-PIVOT) * arm).imag
    assert math.copysign(1.0, side) == arm_side


@pytest.mark.parametrize("arm_side", [1, -1])
def test_without_direction_the_lift_is_the_rockers_own_angle(arm_side: int) -> None:
    follower = OscillatingRoller(PIVOT, 80.0, 90.0, 5.0, arm_side, None)
    curve = PitchCurve(RISE, follower, 1)
    start = curve.point(np.zeros(1))[0] - PIVOT
    top = curve.point(TOP)[0] * cmath.exp(1j * math.pi) - PIVOT
    assert cmath.phase(top / start) == pytest.approx(SWING, rel=1e-14)


def test_the_rocker_angle_is_counted_on_the_arms_own_side() -> None:
    lift = np.array([0.0, 0.1])
    for arm_side, direction, sense in ((1, 1, 1), (-1, 1, 1), (1, -1, -1), (-1, -1, -1)):
        follower = OscillatingRoller(PIVOT, 80.0, 90.0, 5.0, arm_side, direction)
        expected = follower.start_angle + sense * lift
        assert follower.rocker_angle(lift) == pytest.approx(expected, rel=1e-15)
