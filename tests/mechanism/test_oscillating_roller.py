from __future__ import annotations

import cmath
import math
from decimal import Decimal

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mp, mpc, mpf

from camgeo.errors import GeometryError
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.kinematics.mechanism.oscillating_roller import OscillatingRoller, hypot_rest
from camgeo.kinematics.plan import MotionPlan, Move
from camgeo.numeric.arrays import phase
from camgeo.units import TURN
from tests.reference import POLYNOMIAL
from tests.stability.series import Series, direction, variable
from tests.strategies import attack

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


def test_a_pivot_may_lie_as_close_to_an_axis_as_numbers_can_tell() -> None:
    """Its angle is then smaller than the smallest normal number."""
    near, at = (
        PitchCurve(RISE, OscillatingRoller(complex(-120.0, height), 80.0, 60.0, 5.0), 1)
        for height in (5e-324, 0.0)
    )
    assert np.array_equal(near.point(TOP), at.point(TOP))
    assert np.array_equal(near.curvature(TOP), at.curvature(TOP))


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
def test_without_direction_the_lift_is_the_rockers_own_angle(arm_side: int) -> None:
    follower = OscillatingRoller(PIVOT, 80.0, 90.0, 5.0, arm_side, None)
    curve = PitchCurve(RISE, follower, 1)
    start = curve.point(np.zeros(1))[0] - PIVOT
    top = curve.point(TOP)[0] * cmath.exp(1j * math.pi) - PIVOT
    assert phase(top / start) == pytest.approx(SWING, rel=1e-14)


# Distant pivots -------------------------------------------------------------------------------


@st.composite
def rockers(draw: st.DrawFn) -> tuple[OscillatingRoller, float]:
    """A rocker with its pivot up to 1e9 base radii away, for any base circle; and its size."""
    size = 10.0 ** draw(st.floats(-6.0, 6.0))
    distance = size * 10.0 ** draw(st.floats(0.0, 9.0))
    pivot = cmath.rect(distance, draw(st.floats(0.0, TURN)))
    arm = abs(pivot) + draw(st.floats(-0.9, 0.9)) * size
    side, direction = draw(st.sampled_from([1, -1])), draw(st.sampled_from([1, -1, None]))
    return OscillatingRoller(pivot, arm, size, 0.0, side, direction), size


@attack
@given(rockers(), st.tuples(*[st.floats(-0.3, 0.3)] * 4), st.sampled_from([1, -1]))
def test_a_distant_pivot_costs_no_digits(
    made: tuple[OscillatingRoller, float], shares: tuple[float, ...], rotation: int
) -> None:
    """Against the law of cosines and W = l_3 exp(i chi) - l_1 with 60 digits."""
    rocker, size = made
    jet = np.array(shares)[:, np.newaxis] * (size / rocker.arm)
    found = rocker.relative_jet(jet, rotation)
    tangent = rocker.tangent_jet(jet, rotation)
    with mp.workdps(60):
        l1, l3 = mp.hypot(rocker.pivot.real, rocker.pivot.imag), mpf(rocker.arm)
        start = mp.acos((l1**2 + l3**2 - mpf(rocker.base_radius) ** 2) / (2 * l1 * l3))
        swing = Series(tuple(mpf(float(s)) / mp.factorial(k) for k, s in enumerate(jet[:, 0])))
        chi = rocker.arm_side * start + rocker.swing_sense * swing
        centre = (l3 * direction(chi) - l1) * direction(variable(mpf(0), mpf(-rotation), 4))
        exact = [centre.derivative(order) for order in range(4)]
        forward = rotation * exact[1] * mp.expj(-chi.terms[0])
        # Sums of a dozen terms, each of at most a few sizes and rounded a few times.
        room = 512 * 2.0**-53 * size
        for own, along, across in zip(exact, found.along[:, 0], found.across[:, 0], strict=True):
            assert abs(own - mpc(float(along), float(across))) <= room
        assert abs(forward - mpc(float(found.u[0]), -float(found.v[0]))) <= room
        assert abs(forward - mpc(float(tangent.u[0, 0]), float(tangent.w[0, 0]))) <= room


def test_bounds_do_not_grow_with_the_distance_of_the_pivot() -> None:
    """The same path of the roller on ever larger circles: its bounds tend to those of a guide."""
    low = np.linspace(0.0, TURN, 65)[:-1]
    found = []
    for distance in (1e4, 1e8):
        way = MotionPlan(
            (
                Move(Decimal(180), 20.0 / distance, POLYNOMIAL),
                Move(Decimal(180), 0.0, POLYNOMIAL),
            )
        )
        rocker = OscillatingRoller(complex(-distance, 0.0), distance, 50.0, 5.0)
        found.append(PitchCurve(way, rocker, 1).speed_bounds(low, low + TURN / 64.0))
    assert np.all(found[1] <= 1.01 * found[0])
    assert np.all(found[0] <= 1000.0)


# What the rounding of a length took ------------------------------------------------------------

lengths = st.floats(1e-12, 1e12)
signed = st.builds(lambda size, sign: sign * size, lengths, st.sampled_from([-1.0, 1.0]))


@given(signed, signed)
def test_the_rest_of_a_length_is_what_its_rounding_took(x: float, y: float) -> None:
    size = abs(complex(x, y))
    rest = hypot_rest(complex(x, y), size)
    with mpmath.workdps(80):
        exact = mpmath.hypot(x, y) - size
        # The rest is divided by 2 size instead of the sum of both, and is itself rounded.
        assert abs(exact - rest) <= 2.0**-100 * size
    assert abs(rest) <= 2.0**-51 * size


@given(signed)
def test_along_an_axis_nothing_is_lost(x: float) -> None:
    assert hypot_rest(complex(x, 0.0), abs(x)) == 0.0
    assert hypot_rest(complex(0.0, x), abs(x)) == 0.0
    assert hypot_rest(0j, 0.0) == 0.0
