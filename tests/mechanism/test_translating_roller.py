from __future__ import annotations

import math
from decimal import Decimal

import numpy as np
import pytest

from camgeo.errors import GeometryError
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from tests.reference import POLYNOMIAL

RISE = MotionPlan((Move(Decimal(180), 20.0, POLYNOMIAL), Move(Decimal(180), 0.0, POLYNOMIAL)))


@pytest.mark.parametrize("offset", [50.001, -50.001])
def test_an_offset_above_the_base_radius_is_refused(offset: float) -> None:
    with pytest.raises(GeometryError, match="must not exceed the base radius, 50 mm") as caught:
        TranslatingRoller(50.0, 5.0, offset=offset)
    assert caught.value.key == "follower.offset"
    assert caught.value.value == f"{offset:g}"


@pytest.mark.parametrize("offset", [50.0, -50.0])
def test_an_offset_as_large_as_the_base_radius_starts_level_with_the_axis(offset: float) -> None:
    assert TranslatingRoller(50.0, 5.0, offset=offset).start_height == 0.0


def test_the_start_height_keeps_its_digits_near_the_limit() -> None:
    offset = math.nextafter(50.0, 0.0)
    expected = math.sqrt(100.0 * (50.0 - offset))
    height = TranslatingRoller(50.0, 5.0, offset=offset).start_height
    assert height == pytest.approx(expected, rel=1e-15)


def test_a_positive_offset_lies_to_the_right_of_the_way_out() -> None:
    up = PitchCurve(RISE, TranslatingRoller(50.0, 5.0, offset=30.0), 1)
    assert up.point(np.zeros(1))[0] == pytest.approx(30.0 + 40.0j, rel=1e-15)
    right = TranslatingRoller(50.0, 5.0, offset=30.0, guide_angle=0.0)
    assert PitchCurve(RISE, right, 1).point(np.zeros(1))[0] == pytest.approx(
        40.0 - 30.0j, rel=1e-15
    )


@pytest.mark.parametrize("rotation", [1, -1])
def test_the_offset_that_eases_the_rise(rotation: int) -> None:
    """For a cam that turns counter-clockwise a positive one (mechanisms.md 3.2)."""
    phi = np.radians(np.linspace(10.0, 170.0, 33))
    smallest = {
        offset: np.min(
            PitchCurve(
                RISE, TranslatingRoller(50.0, 5.0, offset=offset), rotation
            ).transmission_angle(phi)
        )
        for offset in (-10.0, 0.0, 10.0)
    }
    assert smallest[10.0 * rotation] > smallest[0.0] > smallest[-10.0 * rotation]


def test_a_rest_is_a_circle_about_the_cam_axis() -> None:
    still = MotionPlan((Dwell(Decimal(360)),))
    curve = PitchCurve(still, TranslatingRoller(50.0, 5.0, offset=14.0), -1)
    phi = np.linspace(0.0, 6.0, 25)
    assert np.abs(curve.point(phi)) == pytest.approx(np.full(25, 50.0), rel=1e-15)
    assert curve.curvature(phi) == pytest.approx(np.full(25, 0.02), rel=1e-15)
    assert curve.transmission_angle(phi) == pytest.approx(np.full(25, math.acos(0.28)), rel=1e-15)
