"""The slotted lever against mpmath, its closed forms, and identities between two slotted levers."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mp, mpf

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.slotted_lever import SlottedLever
from camgeo.units import TURN
from tests.stability.slotted_levers import exact_angle
from tests.strategies import attack

EPS = 2.0**-52
LIMIT = 16.0 * EPS
"""Of the largest term in a sum: some ten operations of half an ulp, sines and roots among them,
and the three shares of the lengths, which enter squared."""


def near(exponents: tuple[float, float]) -> st.SearchStrategy[float]:
    return st.floats(*exponents).map(lambda exponent: 10.0**exponent)


@st.composite
def slotted_levers(draw: st.DrawFn) -> SlottedLever:
    """beta = a/R anywhere from 1e-8 to 1e8, also within 1e-9 and less of 1, at any scale."""
    scale = draw(st.sampled_from([1.0, 75.0, 1e-6, 1e6]))
    close = st.builds(
        lambda sign, distance: 1.0 + sign * distance,
        st.sampled_from([1.0, -1.0]),
        near((-15.0, -1.0)),
    )
    beta = draw(st.one_of(st.floats(0.1, 10.0), close, near((-8.0, 8.0)), st.just(1.0)))
    return SlottedLever(scale, scale * beta)


def crank_angles() -> st.SearchStrategy[float]:
    """Anywhere in five turns, or as near as 1e-12 to where the pin is nearest or farthest."""
    offset = near((-12.0, -1.0))
    place = st.sampled_from([0.0, math.pi, TURN, -math.pi, 2.0 * TURN])
    sign = st.sampled_from([1.0, -1.0, 0.0])
    return st.one_of(
        st.floats(-2.0 * TURN, 3.0 * TURN).map(lambda theta: theta if abs(theta) > 1e-60 else 0.0),
        st.builds(lambda p, s, d: p + s * d, place, sign, offset),
        near((-60.0, -12.0)),
    )


def undefined(lever: SlottedLever, theta: float) -> bool:
    spread = 2.0 * np.spacing(abs(theta))
    return lever.crank == lever.distance and abs(math.remainder(theta, TURN)) <= 2.0 * spread


@attack
@given(lever=slotted_levers(), theta=crank_angles())
def test_angle_velocity_and_acceleration_by_the_complex_logarithm(
    lever: SlottedLever, theta: float
) -> None:
    if undefined(lever, theta):
        return
    place = np.array([theta])
    phi, velocity, acceleration = (
        float(values[0])
        for values in (lever.angle(place), lever.velocity(place), lever.acceleration(place))
    )
    # The terms of phi' cancel to theta squared, 1e-120, where a = R.
    with mp.workdps(200):
        lengths = mpf(lever.crank), mpf(lever.distance)
        series = exact_angle(mpf(theta), *lengths, 3)
        true, true1, true2 = (series.derivative(order) for order in range(3))
        assert abs(phi - true) <= LIMIT * abs(true)
        share = mpf(lever.crank) / (mpf(lever.crank) + mpf(lever.distance))
        near_square = abs(true1 / share) if true1 else mpf(0)
        if lever.crank != lever.distance:
            cosine, half = mp.cos(mpf(theta)), mp.sin(mpf(theta) / 2)
            q, d = 1 - share, 1 - 2 * share
            square = d**2 + 4 * share * q * half**2
            terms = min(abs(q * cosine) + share, abs(d) + 2 * q * half**2)
            near_square = terms / square
        assert abs(velocity - true1) <= LIMIT * share * near_square
        if lever.crank == lever.distance:
            assert acceleration == 0.0
        else:
            assert abs(acceleration - true2) <= 2.0 * LIMIT * abs(true2)


@attack
@given(lever=slotted_levers(), theta=crank_angles())
def test_the_counterpart_with_crank_and_distance_exchanged(
    lever: SlottedLever, theta: float
) -> None:
    """phi(1/beta) = pi - theta - phi(beta), phi'(1/beta) = -1 - phi'(beta), phi'' changes sign."""
    if undefined(lever, theta):
        return
    other, place = SlottedLever(lever.distance, lever.crank), np.array([theta])
    total = lever.angle(place)[0] + other.angle(place)[0]
    assert total == pytest.approx(math.pi - theta, abs=LIMIT * (2.0 * math.pi + abs(theta)))
    one, two = lever.velocity(place)[0], other.velocity(place)[0]
    assert one + two == pytest.approx(-1.0, abs=LIMIT * (1.0 + abs(one) + abs(two)))
    assert lever.acceleration(place)[0] == pytest.approx(
        -other.acceleration(place)[0], rel=2.0 * LIMIT, abs=0.0
    )


@attack
@given(lever=slotted_levers(), theta=crank_angles())
def test_the_closed_extremes_are_exceeded_nowhere(lever: SlottedLever, theta: float) -> None:
    if undefined(lever, theta):
        return
    place, above = np.array([theta]), 1.0 + 4.0 * LIMIT
    speeds = lever.velocity_extremes
    assert lever.velocity(place)[0] <= speeds.highest.value + 4.0 * LIMIT * speeds.magnitude
    assert lever.velocity(place)[0] >= speeds.lowest.value - 4.0 * LIMIT * speeds.magnitude
    largest = lever.largest_acceleration
    assert abs(lever.acceleration(place)[0]) <= above * abs(largest.value)
    if lever.swings:
        assert abs(lever.angle(place)[0]) <= above * lever.largest_angle.value


@attack
@given(lever=slotted_levers())
def test_the_closed_extremes_are_taken_at_their_places(lever: SlottedLever) -> None:
    at = np.array([lever.largest_acceleration.place])
    # A maximum is flat; the place itself is right to the last digits, also where it is 1e-10.
    assert lever.acceleration(at)[0] == pytest.approx(
        lever.largest_acceleration.value, rel=8.0 * LIMIT
    )
    if lever.crank != lever.distance:
        with mp.workdps(50):
            beta = mpf(lever.distance) / mpf(lever.crank)
            b = beta**2 + 1
            cosine = (mp.sqrt(b**2 + 32 * beta**2) - b) / (4 * beta)
            true = 2 * mp.asin(mp.sqrt((1 - cosine) / 2))
            assert abs(lever.largest_acceleration.place - true) <= LIMIT * true
        for speed in (lever.velocity_extremes.lowest, lever.velocity_extremes.highest):
            found = lever.velocity(np.array([speed.place]))[0]
            assert found == pytest.approx(speed.value, rel=LIMIT)
    if lever.swings:
        angle = lever.largest_angle
        with mp.workdps(50):
            share = mpf(lever.crank) / mpf(lever.distance)
            assert abs(angle.value - mp.asin(share)) <= LIMIT * angle.value
            assert abs(angle.place - mp.acos(share)) <= LIMIT * angle.place
        slow = math.pi + 2.0 * angle.value
        assert lever.time_ratio == pytest.approx(slow / (2.0 * angle.place), rel=LIMIT)


def test_the_exercise_with_beta_2() -> None:
    """a = 150, R = 75, n = 1.5 1/s: the values of the SAM exercise's text, corrected."""
    lever, speed = SlottedLever(75.0, 150.0), 3.0 * math.pi
    assert lever.ratio == 2.0
    assert math.degrees(lever.largest_angle.value) == pytest.approx(30.0, rel=LIMIT)
    assert math.degrees(lever.largest_angle.place) == pytest.approx(60.0, rel=LIMIT)
    assert lever.time_ratio == pytest.approx(2.0, rel=LIMIT)
    place = lever.largest_acceleration.place
    assert math.degrees(place) == pytest.approx(22.9030618658217, rel=1e-13)
    phi, _, acceleration = lever.in_time(np.array([place]), speed)[:, 0]
    # Printed to 15 digits in the reference.
    assert math.degrees(phi) == pytest.approx(19.8361245911597, rel=1e-14)
    assert acceleration == pytest.approx(-119.883473983041, rel=1e-13)
    at = lever.in_time(np.array([lever.largest_angle.place]), speed)[:, 0]
    assert at[1] == pytest.approx(0.0, abs=speed * LIMIT)
    assert at[2] == pytest.approx(-(speed**2) / math.sqrt(3.0), rel=2.0 * LIMIT)


def test_with_the_pin_on_the_axis_of_the_lever_nothing_is_reported() -> None:
    lever = SlottedLever(50.0, 50.0)
    for theta in (0.0, -0.0, TURN, -TURN, math.radians(1080.0)):
        for quantity in (lever.angle, lever.velocity, lever.acceleration):
            with pytest.raises(GeometryError, match="undefined"):
                quantity(np.array([1.0, theta]))
    tiny = np.array([1e-300, 1e-12])
    assert lever.angle(tiny) == pytest.approx(np.array([0.5 * math.pi] * 2), rel=1e-12)


def test_what_a_turning_lever_has_not() -> None:
    for lever in (SlottedLever(2.0, 1.0), SlottedLever(1.0, 1.0)):
        assert not lever.swings
        with pytest.raises(GeometryError, match="no largest angle"):
            _ = lever.largest_angle
        with pytest.raises(GeometryError, match="no strokes"):
            _ = lever.time_ratio


@pytest.mark.parametrize("length", [0.0, -1.0, math.nan, math.inf])
def test_lengths_must_be_positive(length: float) -> None:
    for given_lengths in ((length, 1.0), (1.0, length)):
        with pytest.raises(GeometryError, match="positive number"):
            SlottedLever(*given_lengths)


@pytest.mark.parametrize("theta", [math.nan, math.inf])
def test_crank_angles_must_be_numbers(theta: float) -> None:
    lever = SlottedLever(1.0, 2.0)
    for quantity in (lever.angle, lever.velocity, lever.acceleration):
        with pytest.raises(GeometryError, match="finite"):
            quantity(np.array([theta]))
