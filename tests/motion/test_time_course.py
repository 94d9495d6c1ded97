"""Derivatives over time: closed forms, numerical ones in forty digits, energy, and extremes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from decimal import Decimal
from typing import Any

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.kinematics.motion import Jet
from camgeo.kinematics.motion import MergedDwell as DwellSpan
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.kinematics.planning.planner import plan_motion
from camgeo.kinematics.planning.requests import TableRequest
from camgeo.kinematics.time_course import (
    ConstantSpeed,
    SpeedCurve,
    TimeCourse,
    in_time,
    inertia_torque,
    plan_extremes,
    time_extremes,
)
from camgeo.numeric.arrays import SIDES, FloatArray, Side
from camgeo.units import TURN
from tests.reference import POLYNOMIAL
from tests.strategies import attack, cam_angles, plans

EPS = 2.0**-52

LIFT, POWER = 10.0, 4
"""The motion of these tests: s = LIFT sin(phi)^POWER."""


def power_jet(phi: FloatArray, lift: float = LIFT, k: int = POWER) -> Jet:
    """(4, n) of lift * sin(phi)^k, by hand."""
    sin, cos = np.sin(phi), np.cos(phi)
    return lift * np.stack(
        (
            sin**k,
            k * sin ** (k - 1) * cos,
            k * (k - 1) * sin ** (k - 2) - k**2 * sin**k,
            k * (k - 1) * (k - 2) * sin ** (k - 3) * cos - k**3 * sin ** (k - 1) * cos,
        )
    )


class Power:
    """The motion s = LIFT sin(phi)^POWER, without borders."""

    breaks = np.empty(0)
    borders = np.empty(0)
    dwells: tuple[DwellSpan, ...] = ()

    def jet(self, phi: FloatArray, side: Side = "right", order: int = 3) -> Jet:
        return power_jet(phi)

    def jet_and_bounds(self, low: FloatArray, high: FloatArray) -> tuple[Jet, Jet]:
        return self.jet(0.5 * (low + high)), np.full((4, len(low)), LIFT * POWER**3)


@dataclass(frozen=True)
class Wobble:
    """A course known in closed form: t = (phi + e sin(phi)) / speed.

    With c = 1 + e cos(phi): omega = speed / c, alpha = omega domega/dphi = speed^2 e sin / c^3,
    and dalpha/dt = omega dalpha/dphi = speed^3 (e cos / c^4 + 3 e^2 sin^2 / c^5).
    """

    speed: float
    share: float

    borders = np.empty(0)
    jumps = np.empty(0)

    def rates(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        del side
        sin, cos = np.sin(phi), np.cos(phi)
        c = 1.0 + self.share * cos
        return np.stack(
            (
                self.speed / c,
                self.speed**2 * self.share * sin / c**3,
                self.speed**3 * (self.share * cos / c**4 + 3.0 * self.share**2 * sin**2 / c**5),
            )
        )

    def time(self, phi: FloatArray) -> FloatArray:
        return np.asarray((phi + self.share * np.sin(phi)) / self.speed)

    def table(self, count: int) -> SpeedCurve:
        """The course as a table of count + 1 rows."""
        phi = np.linspace(0.0, TURN, count + 1)
        return SpeedCurve(self.time(phi), phi)


speeds = st.floats(0.5, 200.0)
shares = st.floats(-0.6, 0.6)


# The chain rule -------------------------------------------------------------------------------


@attack
@given(cam_angles(), speeds, shares)
def test_against_numerical_derivatives_over_time(angle: float, speed: float, share: float) -> None:
    course = Wobble(speed, share)
    found = in_time(power_jet(np.array([angle])), course, np.array([angle]))[:, 0]
    with mpmath.workdps(30):
        e, w, start = mpmath.mpf(share), mpmath.mpf(speed), mpmath.mpf(angle)

        def lift(t: mpmath.mpf) -> mpmath.mpf:
            phi = start
            for _ in range(8):  # Newton's method, from next door
                phi -= (phi + e * mpmath.sin(phi) - w * t) / (1 + e * mpmath.cos(phi))
            return LIFT * mpmath.sin(phi) ** POWER

        t = (start + e * mpmath.sin(start)) / w
        expected = [float(mpmath.diff(lift, t, order)) for order in range(4)]
    # Sums of at most 15 terms of up to LIFT POWER^k omega^k, omega up to speed / (1 - |share|), and
    # 1 + e cos rounded, which a fifth power multiplies by 5 / (1 - |share|).
    fastest = speed / (1.0 - abs(share))
    for order in range(4):
        size = 15.0 * LIFT * POWER**order * fastest**order
        assert found[order] == pytest.approx(expected[order], abs=64.0 * EPS * size)


# Constant speed -------------------------------------------------------------------------------


def test_constant_speed() -> None:
    course = ConstantSpeed(20.0)
    phi = np.array([0.0, 1.0, TURN])
    assert course.rates(phi).tolist() == [[20.0] * 3, [0.0] * 3, [0.0] * 3]
    assert course.time(phi).tolist() == [0.0, 0.05, TURN / 20.0]


@pytest.mark.parametrize(
    "speed", [0.0, -1.0, math.nan, math.inf, 5e-324, 1e308, "1", None, True, 1j]
)
def test_a_cam_that_does_not_turn_forward_is_refused(speed: Any) -> None:
    with pytest.raises(GeometryError, match="must be") as caught:
        ConstantSpeed(speed)
    assert caught.value.key == "speed"


# A curve of speed -----------------------------------------------------------------------------


@attack
@given(st.integers(12, 60), speeds, shares, st.floats(-20.0, 20.0))
def test_time_and_angle_belong_together(
    count: int, speed: float, share: float, angle: float
) -> None:
    curve = Wobble(speed, share / 2.0).table(count)
    phi = np.array([angle])
    time = curve.time(phi)
    back = curve.spline.values(time, 1)
    assert back[0, 0] == pytest.approx(angle, abs=256.0 * EPS * 40.0)
    assert curve.rates(phi)[0, 0] == back[1, 0]
    assert curve.time(phi + TURN)[0] - time[0] == pytest.approx(TURN / speed, rel=1e-12)


@pytest.mark.parametrize("share", [0.0, 0.2, -0.4])
def test_a_table_comes_near_its_course_with_the_power_of_its_step(share: float) -> None:
    course = Wobble(3.0, share)
    places = np.linspace(0.1, 6.2, 400)
    expected = course.rates(places)
    errors = np.array(
        [
            np.max(np.abs(course.table(count).rates(places) - expected), axis=1)
            for count in (60, 120)
        ]
    )
    # A quintic spline over t: h^5 in phi', h^4 in phi'', h^3 in phi'''; half of it for safety.
    if share:
        assert np.all(errors[1] <= 2.0 * errors[0] / 2.0 ** np.array([5.0, 4.0, 3.0]))
    assert np.all(errors[1] <= np.array([1e-4, 1e-2, 1.0]))


@pytest.mark.parametrize("start", [-2.0, 0.0, 1.0, 5.5])
def test_a_table_may_start_at_any_angle(start: float) -> None:
    course = Wobble(3.0, 0.3)
    phi = start + np.linspace(0.0, TURN, 121)
    curve = SpeedCurve(course.time(phi), phi)
    places = np.linspace(0.0, TURN, 100)
    np.testing.assert_allclose(curve.rates(places)[0], course.rates(places)[0], atol=1e-5)
    np.testing.assert_allclose(curve.time(places), course.time(places), atol=1e-7)
    assert np.all((curve.borders >= 0.0) & (curve.borders < TURN))
    assert np.all(np.diff(curve.borders) > 0.0)


@pytest.mark.parametrize(
    ("t", "phi", "message"),
    [
        ([0, 1, 2], [0, 2, TURN], "4 rows or more"),
        ([0, 1, 2, 3], [0, 2, 4], "4 times and 3 angles"),
        ([0, 1, 2, 3], [0, 2, 4, 6], "one turn, 6.28"),
        ([0, 1, 1, 3], [0, 2, 4, TURN], "points 2 and 3 are equal"),
        ([0, 1, 2, 3], [0, math.nan, 4, TURN], "finite numbers, .* number 2 of them is not"),
        ([0, 1, 2, 3], [0, 4, 2, TURN], "stand still or run backwards between the rows: -"),
        # Angles that ascend, but so unevenly that what runs smoothly through them turns back.
        (
            [0, 1, 2, 3, 4],
            [0, 0.01, 3, 6.27, TURN],
            "stand still or run backwards between the rows: -",
        ),
    ],
)
def test_poor_tables_are_refused(t: list[float], phi: list[float], message: str) -> None:
    with pytest.raises(GeometryError, match=message) as caught:
        SpeedCurve(np.array(t, dtype=np.float64), np.array(phi, dtype=np.float64))
    assert caught.value.message


def test_the_place_where_the_cam_would_turn_back_is_reported() -> None:
    t = np.arange(9.0)
    phi = TURN * t / 8.0 + 1.1 * np.sin(TURN * t / 8.0)
    with pytest.raises(GeometryError) as caught:
        SpeedCurve(t, phi)
    # phi' = TURN / 8 (1 + 1.1 cos) is least at t = 4, where phi = pi.
    assert "-0.749556 rev/min at cam angle 180 deg, 4 s; allowed: above" in caught.value.message


# Energy ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("course", [ConstantSpeed(7.0), Wobble(7.0, 0.5), Wobble(7.0, -0.3)])
def test_the_torque_is_what_the_kinetic_energy_takes(course: TimeCourse) -> None:
    mass = 2.5
    # A periodic integrand: the sum over even angles is exact to rounding for smooth functions.
    phi = np.linspace(0.0, TURN, 2001)[:-1]
    timed = in_time(power_jet(phi), course, phi)
    torque = inertia_torque(timed, course.rates(phi)[0], mass)
    size = float(np.max(np.abs(torque)))
    assert abs(np.mean(torque)) <= 64.0 * EPS * size
    # d(m v^2 / 2) = M dphi, with v in m/s: Fourier differences of the energy give the torque.
    energy = 0.5 * mass * (1e-3 * timed[1]) ** 2
    waves = np.fft.rfftfreq(len(phi), 1.0 / len(phi))
    slope = np.fft.irfft(1j * waves * np.fft.rfft(energy), len(phi))
    # Rounding of the energy, by each of a thousand waves.
    np.testing.assert_allclose(slope, torque, rtol=0.0, atol=1000.0 * 8.0 * EPS * size)


def test_units_of_the_torque() -> None:
    timed = np.array([[0.0], [2000.0], [3000.0], [0.0]])  # 2 m/s and 3 m/s^2
    omega = np.array([10.0])
    assert inertia_torque(timed, omega, 5.0)[0] == pytest.approx(3.0, rel=4 * EPS)
    swing = np.array([[0.0], [2.0], [3.0], [0.0]])  # 2 rad/s and 3 rad/s^2
    assert inertia_torque(swing, omega, 5.0, "rad")[0] == pytest.approx(3.0, rel=4 * EPS)


# Extremes -------------------------------------------------------------------------------------


def test_extremes_at_constant_speed() -> None:
    # s = 10 sin^4: s' = 40 sin^3 cos is largest where tan^2 = 3, s'' = 120 sin^2 - 160 sin^4 where
    # sin^2 = 3/8 and at 1, s''' = 240 sin cos - 640 sin^3 cos.
    speed = 3.0
    found = time_extremes(Power(), ConstantSpeed(speed))
    third = math.pi / 3.0
    largest = 40.0 * (math.sqrt(3.0) / 2.0) ** 3 / 2.0
    assert found.velocity.highest.value == pytest.approx(speed * largest, rel=8 * EPS)
    assert found.velocity.lowest.value == pytest.approx(-speed * largest, rel=8 * EPS)
    places = (third, math.pi + third)
    assert min(abs(found.velocity.highest.place - p) for p in places) <= 1e-13
    assert found.acceleration.highest.value == pytest.approx(speed**2 * 22.5, rel=8 * EPS)
    assert found.acceleration.lowest.value == pytest.approx(-(speed**2) * 40.0, rel=8 * EPS)
    # s''' = 80 sin(4 phi) - 40 sin(2 phi): on a fine grid, flat at its top to rounding.
    phi = np.linspace(0.0, TURN, 2_000_001)
    jerk = speed**3 * (80.0 * np.sin(4.0 * phi) - 40.0 * np.sin(2.0 * phi))
    # Half a step off the top loses (step / 2)^2 / 2 of s''''' at most, 4^4 of s'''.
    allowed = speed**3 * 120.0 * (64.0 * EPS + 16.0 * (phi[1] / 2.0) ** 2)
    assert found.jerk.highest.value == pytest.approx(float(np.max(jerk)), abs=allowed)
    assert found.jerk.lowest.value == pytest.approx(float(np.min(jerk)), abs=allowed)


QUANTITIES = ("velocity", "acceleration", "jerk", "torque")


def check_extremes(plan: MotionPlan, course: TimeCourse, slack: float) -> None:
    """They are taken at their places, on one side, and no value of a grid is outside."""
    found = plan_extremes(plan, course)

    def timed(phi: FloatArray, side: Side = "right") -> FloatArray:
        rows = in_time(plan.jet(phi, side), course, phi)
        return np.concatenate((rows, [inertia_torque(rows, course.rates(phi)[0])]))

    dense = timed(np.linspace(0.0, TURN, 5001)[:-1])
    for order, name in enumerate(QUANTITIES, start=1):
        extremes, values = getattr(found, name), dense[order]
        size = max(extremes.magnitude, float(np.max(np.abs(values))))
        assert extremes.highest.value >= np.max(values) - slack * size
        assert extremes.lowest.value <= np.min(values) + slack * size
        for extreme in (extremes.lowest, extremes.highest):
            place = np.array([extreme.place])
            taken = np.array([timed(place, side)[order, 0] for side in SIDES])
            # Terms cancel by up to their sum.
            assert np.min(np.abs(taken - extreme.value)) <= 1e-9 * size


@attack
@given(plans(), speeds, shares)
def test_nothing_goes_beyond_the_extremes(plan: MotionPlan, speed: float, share: float) -> None:
    course = ConstantSpeed(speed)
    check_extremes(plan, Wobble(speed, share), 1e-9)
    check_extremes(plan, course, 1e-12)
    found, searched = plan_extremes(plan, course), time_extremes(plan, course)
    for name in QUANTITIES:
        exact, other = getattr(found, name), getattr(searched, name)
        # The search takes one side of a border a ten-millionth of a piece inside.
        size = 1e-6 * exact.magnitude
        assert exact.highest.value == pytest.approx(other.highest.value, abs=size)
        assert exact.lowest.value == pytest.approx(other.lowest.value, abs=size)


def test_extremes_with_a_table_of_speed() -> None:
    plan = MotionPlan(
        (
            Move(Decimal(120), 20.0, POLYNOMIAL),
            Dwell(Decimal(60)),
            Move(Decimal(90), 0.0, POLYNOMIAL),
            Dwell(Decimal(90)),
        )
    )
    exact = Wobble(10.0, 0.2)
    by_table, by_course = time_extremes(plan, exact.table(720)), time_extremes(plan, exact)
    for name in QUANTITIES:
        ours, course = getattr(by_table, name), getattr(by_course, name)
        # The table's spline is off by h^3 = 1e-6 in phi''', relative to the speed's wobble.
        for side in ("lowest", "highest"):
            a, b = getattr(ours, side), getattr(course, side)
            assert a.value == pytest.approx(b.value, rel=1e-5)
            assert a.place == pytest.approx(b.place, abs=1e-2)


def test_a_follower_that_rests() -> None:
    found = time_extremes(MotionPlan((Dwell(Decimal(360)),)), ConstantSpeed(5.0))
    for extremes in (found.velocity, found.acceleration, found.jerk, found.torque):
        assert extremes.magnitude == 0.0


# Extremes of a plan ----------------------------------------------------------------------------


def test_motion_by_data_is_left_to_the_search() -> None:
    shares = np.linspace(0.0, 1.0, 20)
    lifts = 1.0 - np.cos(2.0 * np.pi * shares)
    lifts[-1] = 0.0
    plan = plan_motion([TableRequest(Decimal(360), shares, lifts)])
    course = ConstantSpeed(1.0)
    assert plan_extremes(plan, course) == time_extremes(plan, course)
