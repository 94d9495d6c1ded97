"""Conjugate cams: both rollers of one rigid follower touch their discs at every cam angle."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.kinematics.mechanism.conjugate import FLAT, return_on_carriage, return_on_lever
from camgeo.kinematics.mechanism.oscillating_roller import OscillatingRoller
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.units import TURN
from tests.long_form import examples
from tests.pairs import Lever, Pair, pairs
from tests.strategies import attack

EPS = float(np.finfo(np.float64).eps)

GUIDE = TranslatingRoller(base_radius=50.0, roller_radius=8.0, offset=30.0)
ROCKER = OscillatingRoller(complex(-96.0, -72.0), 80.0, 90.0, 5.0)


def rounding(pair: Pair) -> float:
    """[mm] what is lost in the start angle of a triangle, and in the height of a guide.

    An angle psi of a triangle is known from its side r to eps r^2 / (l_1 l_3 sin psi), sin psi at
    least sin 20 deg here and r below l_1 + l_3; a height from its hypotenuse to eps r^2 / height,
    at least 15 mm of 90. A few such roundings of each of two rollers, 20 in all, are moved by arms
    and radii of `size`.
    """
    size = max(float(np.max(np.abs(curve.point(np.zeros(1))))) for curve in (pair.main, pair.other))
    if isinstance(pair.body, Lever):
        length = abs(pair.body.pivot) + max(pair.body.arms)
        lowest = abs(pair.body.pivot) * min(pair.body.arms) * math.sin(math.radians(20.0))
        return 20.0 * EPS * length * length**2 / lowest
    return 20.0 * EPS * (size + 130.0) ** 2 / 15.0


@settings(attack, max_examples=examples(16, long=40))
@given(pairs(), st.lists(st.floats(0.0, TURN), min_size=20, max_size=20))
def test_both_rollers_are_where_the_rigid_follower_holds_them(
    pair: Pair, angles: list[float]
) -> None:
    phi = np.array(angles)
    main, other = pair.in_cam(phi)
    slack = rounding(pair)
    assert np.max(np.abs(pair.main.point(phi) - main)) <= slack
    assert np.max(np.abs(pair.other.point(phi) - other)) <= slack


@settings(attack, max_examples=25)
@given(pairs(), st.floats(0.0, TURN))
def test_no_point_of_either_flank_is_nearer_than_the_roller(pair: Pair, angle: float) -> None:
    """Both rollers at one cam angle, against all of a flank that does not cross itself."""
    phi = np.array([angle])
    turn = np.linspace(0.0, TURN, 2001)
    for curve, roller in zip((pair.main, pair.other), pair.in_cam(phi), strict=True):
        radius = curve.follower.roller_radius
        flank = WorkingCurve(curve, -radius)
        touch = flank.point(phi) - roller
        assert abs(touch[0]) == pytest.approx(radius, abs=rounding(pair))
        points = flank.point(turn)
        ring = shapely.LinearRing(np.column_stack((points.real, points.imag))[:-1])
        if np.min(flank.regularity(turn)) > 0.05 and ring.is_simple:
            assert np.min(np.abs(points - roller[0])) >= radius - rounding(pair)


@given(pairs())
@settings(attack, max_examples=20)
def test_what_moves_one_roller_outward_moves_the_other_inward(pair: Pair) -> None:
    phi = np.linspace(0.0, TURN, 400)
    assert np.all(pair.main.leverage(phi) * pair.other.leverage(phi) < 0.0)
    assert np.sign(pair.other.follower.reach) == (
        np.sign(pair.main.follower.reach)
        if isinstance(pair.body, Lever)
        else -np.sign(pair.main.follower.reach)
    )


def test_what_is_not_given_is_that_of_the_main_roller() -> None:
    carriage = return_on_carriage(GUIDE, 95.0)
    assert (carriage.offset, carriage.roller_radius) == (-30.0, 8.0)
    # 40 mm above the axis, so 55 mm below it.
    assert carriage.base_radius == pytest.approx(math.hypot(30.0, 55.0), rel=1e-15)
    lever = return_on_lever(ROCKER, -2.0)
    assert (lever.arm, lever.roller_radius, lever.pivot) == (80.0, 5.0, ROCKER.pivot)


def test_behind_a_linkage_the_lift_stays_the_levers_own_angle() -> None:
    linked = OscillatingRoller(complex(-96.0, -72.0), 80.0, 90.0, 5.0, 1, None)
    assert return_on_lever(linked, -2.0).direction is None


@pytest.mark.parametrize("spacing", [39.0, 40.0, 40.0 + 20.0 * FLAT])
def test_a_carriage_whose_rollers_lie_on_one_side_is_refused(spacing: float) -> None:
    with pytest.raises(GeometryError, match=r"other side of the cam axis: .* 40 mm") as caught:
        return_on_carriage(GUIDE, spacing)
    assert caught.value.key == "follower.return.spacing"


@pytest.mark.parametrize("turns", [0.0, 0.5, -0.5, 1.0])
@pytest.mark.parametrize("off", [0.0, 0.5 * FLAT, -0.5 * FLAT])
@pytest.mark.parametrize("arm", [80.0, 120.0, 1e-3])
def test_a_return_arm_on_the_line_of_centres_is_refused(
    turns: float, off: float, arm: float
) -> None:
    """An arm of 120 mm on it holds the roller in the cam axis itself."""
    angle = turns * TURN - ROCKER.start_angle + off
    with pytest.raises(GeometryError, match="lies on the line from the pivot") as caught:
        return_on_lever(ROCKER, angle, arm)
    assert caught.value.key == "follower.return.arm_angle"
