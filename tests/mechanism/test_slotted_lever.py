"""The slotted lever against mpmath, its closed forms, and identities between two slotted levers."""

from __future__ import annotations

import math
from decimal import Decimal
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mp, mpf

from camgeo.app.answers.slotted_lever import NAMES, lever_table
from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.slotted_lever import DrivenLever, SlottedLever
from camgeo.numeric.arrays import FloatArray
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
        assert DrivenLever(lever, SPEED).strokes is None
        with pytest.raises(GeometryError, match="no strokes: the lever turns round") as caught:
            _ = lever.time_ratio
        assert caught.value.key == "distance"


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


# In time ---------------------------------------------------------------------------------------

SPEED = 3.5

LEVERS = {
    "swings": SlottedLever(30.0, 80.0),
    "nearly equal": SlottedLever(30.0, 31.0),
    "turns round": SlottedLever(80.0, 30.0),
    "equal": SlottedLever(40.0, 40.0),
}


def seen(lever: SlottedLever, theta: FloatArray) -> FloatArray:
    """(n,) angle of the pin [rad] seen from the lever's axis, against the direction to the crank's,
    positive as the crank turns: the crank's axis at 0, the lever's at -a on a line.
    """
    pin = -lever.crank * np.exp(1j * theta)
    return np.asarray(np.unwrap(np.angle(pin + lever.distance)))


@pytest.mark.parametrize("name", LEVERS)
def test_the_lever_points_at_the_pin(name: str) -> None:
    lever = LEVERS[name]
    driven = DrivenLever(lever, SPEED)
    theta = np.linspace(0.05, TURN - 0.05, 601)
    phi = driven.output(theta)[0]
    expected = seen(lever, theta)
    assert np.ptp(phi - expected) <= 1e-9
    assert math.cos(phi[0] - expected[0]) == pytest.approx(1.0)
    assert driven.turn_time == pytest.approx(TURN / SPEED)


@pytest.mark.parametrize("name", LEVERS)
def test_extremes_are_those_of_dense_samples(name: str) -> None:
    lever = LEVERS[name]
    driven = DrivenLever(lever, SPEED)
    theta = np.linspace(1e-9, TURN - 1e-9, 40_001)
    values = dict(zip(("phi", "omega2", "eps2"), driven.output(theta), strict=True))
    found = driven.extremes
    if name == "equal":
        assert found == ()
        return
    wanted = ["omega2"] * 2 + ["eps2"] * 2
    assert [each.quantity for each in found] == (["phi"] * 2 if lever.swings else []) + wanted
    for first, second in zip(found[::2], found[1::2], strict=True):
        assert {first.largest, second.largest} == {True, False}
        assert first.crank < second.crank
    for each in found:
        dense = values[each.quantity]
        best = float(np.max(dense) if each.largest else np.min(dense))
        size = float(np.ptp(dense))
        assert each.value == pytest.approx(best, abs=1e-5 * size)
        assert (
            (each.value >= best - 1e-9 * size)
            if each.largest
            else (each.value <= best + 1e-9 * size)
        )
        at = driven.output(np.array([each.crank]))[:, 0]
        assert at[("phi", "omega2", "eps2").index(each.quantity)] == pytest.approx(
            each.value, rel=1e-9, abs=1e-12
        )
        if each.crank:
            assert each.angle == pytest.approx(at[0], abs=1e-12)
        assert each.time == pytest.approx(each.crank / SPEED, rel=1e-15)
        assert each.unit == {"phi": "rad", "omega2": "rad/s", "eps2": "rad/s^2"}[each.quantity]


def test_strokes_last_from_one_end_to_the_other() -> None:
    driven = DrivenLever(LEVERS["swings"], SPEED)
    assert driven.strokes is not None
    slow, quick = driven.strokes
    for stroke in (slow, quick):
        assert stroke.end - stroke.start == pytest.approx(stroke.duration * SPEED)
        ends = driven.output(np.array([stroke.start, stroke.end]))
        assert ends[1] == pytest.approx(np.zeros(2), abs=1e-12)
        assert abs(ends[0, 1] - ends[0, 0]) == pytest.approx(2.0 * math.asin(30.0 / 80.0))
    assert slow.duration + quick.duration == pytest.approx(driven.turn_time)
    assert slow.duration / quick.duration == pytest.approx(LEVERS["swings"].time_ratio)
    assert slow.duration > quick.duration
    assert slow.end == pytest.approx(quick.start)


@pytest.mark.parametrize(
    ("step", "first", "last"),
    [("1", "0", "360"), ("7", "0", "360"), ("0.5", "12.25", "200"), ("90", "180", "360")],
)
@pytest.mark.parametrize("name", ["swings", "turns round"])
def test_a_table_has_the_values_at_exact_multiples(
    name: str, step: str, first: str, last: str
) -> None:
    driven = DrivenLever(LEVERS[name], SPEED)
    table = lever_table(driven, Decimal(step), Decimal(first), Decimal(last))
    angles = list(table.crank)
    assert angles[0] == Decimal(first)
    assert angles[-1] == Decimal(last)
    steps = {b - a for a, b in pairwise(angles[:-1])}
    assert steps <= {Decimal(step)}
    assert Decimal(0) < angles[-1] - angles[-2] <= Decimal(step)
    theta = np.radians([float(each) for each in angles])
    phi, omega, eps = driven.output(theta)
    columns = dict(zip(NAMES, table.values.T, strict=True))
    assert list(columns) == [
        "crank [deg]", "time [s]", "phi [deg]", "omega2 [rad/s]", "eps2 [rad/s^2]",
    ]  # fmt: skip
    assert columns["crank [deg]"].tolist() == [float(each) for each in angles]
    assert columns["time [s]"] == pytest.approx(theta / SPEED, abs=1e-14)
    turned = np.degrees(phi) if name == "swings" else columns["phi [deg]"]
    assert columns["phi [deg]"] == pytest.approx(turned, abs=1e-10)
    apart = np.radians(columns["phi [deg]"]) - phi
    assert np.cos(apart) == pytest.approx(np.ones(len(apart)))
    assert columns["omega2 [rad/s]"] == pytest.approx(omega, abs=1e-11)
    assert columns["eps2 [rad/s^2]"] == pytest.approx(eps, abs=1e-10)
    assert not np.any(np.signbit(table.values) & (table.values == 0.0))
    places = max(len(str(float(each)).partition(".")[2].strip("0")) for each in angles)
    for row, angle, values in zip(table.printed(), angles, table.values, strict=True):
        assert row[0] == f"{angle:.{places}f}"
        assert [float(each) for each in row[1:]] == pytest.approx(values[1:], abs=5.1e-4)
        assert all(len(each.partition(".")[2]) == 3 for each in row[1:])
        assert "-0.000" not in row


def test_both_halves_of_a_table_agree_to_the_last_digit() -> None:
    table = lever_table(DrivenLever(LEVERS["swings"], SPEED), Decimal("0.7"), last=Decimal(360))
    whole = dict(zip(table.crank, table.values, strict=True))
    half = lever_table(DrivenLever(LEVERS["swings"], SPEED), Decimal(90)).values
    assert half[2, [2, 4]].tolist() == [0.0, 0.0]
    mirrored = lever_table(
        DrivenLever(LEVERS["swings"], SPEED), Decimal("0.7"), Decimal("3.3"), Decimal(360)
    )
    for angle, row in zip(mirrored.crank, mirrored.values, strict=True):
        other = whole.get(360 - angle)
        if other is not None:
            assert row[[2, 4]].tolist() == (-other[[2, 4]] + 0.0).tolist()
            assert row[3] == other[3]


GOOD: dict[str, Any] = {"step": Decimal(1), "first": Decimal(0), "last": Decimal(360)}


@pytest.mark.parametrize(
    ("given", "key", "message"),
    [
        ({"step": Decimal("0.0009")}, "step", "must be 0.001 to 90 degrees"),
        ({"step": Decimal("90.001")}, "step", "must be 0.001 to 90 degrees"),
        ({"step": Decimal("NaN")}, "step", "must be 0.001 to 90 degrees"),
        ({"step": Decimal("1.0000000000001")}, "step", "at most 12 decimals are allowed"),
        ({"first": Decimal(-1)}, "from", "must be from 0 to less than 360 degrees"),
        ({"first": Decimal(360)}, "from", "must be from 0 to less than 360 degrees"),
        ({"first": Decimal("0.0000000000001")}, "from", "at most 12 decimals are allowed"),
        ({"first": Decimal(20), "last": Decimal(20)}, "to", "must be above the first, 20, and"),
        ({"last": Decimal("360.001")}, "to", "at most 360 degrees"),
    ],
)
def test_limits_of_a_table_are_told_with_their_key(
    given: dict[str, Any], key: str, message: str
) -> None:
    driven = DrivenLever(LEVERS["swings"], SPEED)
    with pytest.raises(GeometryError, match=message) as caught:
        lever_table(driven, **(GOOD | given))
    assert caught.value.key == key
    assert caught.value.value == str(given["last" if key == "to" else "first" if key == "from"
                                           else key])  # fmt: skip
    for edge in (Decimal("0.001"), Decimal(90), Decimal("1.000000000001")):
        assert lever_table(driven, edge, Decimal(359), Decimal(360)).crank[-1] == 360


def test_where_the_pin_is_on_the_axis_no_table_begins_or_ends() -> None:
    driven = DrivenLever(LEVERS["equal"], SPEED)
    for span, key in (({}, "from"), ({"first": Decimal(1)}, "to")):
        with pytest.raises(GeometryError, match="whose angle is undefined there") as caught:
            lever_table(driven, **(GOOD | span))
        assert caught.value.key == key
    table = lever_table(driven, Decimal(1), Decimal(1), Decimal(359))
    assert np.abs(table.values[:, 3]) == pytest.approx(np.full(359, 0.5 * SPEED))
    assert table.values[:, 4].tolist() == [0.0] * 359


def test_a_speed_at_which_a_value_overflows_is_refused() -> None:
    lever = SlottedLever(1.0, 1.0 + 1e-12)
    assert DrivenLever(lever, 1e140).speed == 1e140
    with pytest.raises(GeometryError, match="too large for a floating-point number") as caught:
        DrivenLever(lever, 1e150)
    assert caught.value.key == "speed"
    with pytest.raises(GeometryError, match="must be a positive number"):
        DrivenLever(lever, 0.0)


@pytest.mark.parametrize("swing", [1e-6, 20.0, 60.0, 120.0, 179.0, 180.0])
def test_the_crank_of_a_swing_makes_that_swing(swing: float) -> None:
    crank = SlottedLever.crank_for_swing(80.0, swing)
    assert math.degrees(2.0 * math.asin(crank / 80.0)) == pytest.approx(swing, rel=1e-9)
    if swing < 180.0:
        lever = SlottedLever(crank, 80.0)
        assert math.degrees(2.0 * lever.largest_angle.value) == pytest.approx(swing, rel=1e-9)
    assert SlottedLever.crank_for_swing(80.0, 60.0) == 40.0


@pytest.mark.parametrize("swing", [0.0, -1.0, math.nextafter(180.0, 200.0), math.nan])
def test_a_swing_that_no_lever_has_is_refused(swing: float) -> None:
    with pytest.raises(GeometryError, match="above 0 and at most 180 degrees") as caught:
        SlottedLever.crank_for_swing(80.0, swing)
    assert caught.value.key == "swing"
    with pytest.raises(GeometryError, match="not distinguishable"):
        SlottedLever.crank_for_swing(80.0, math.nextafter(180.0, 0.0))
