from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mpmath import mp, mpf

from camgeo.motion.laws import ALIASES, HALVES, LAWS, find_law
from camgeo.motion.laws.law import HalfLaw, Law, Region, Values
from camgeo.numeric.arrays import FloatArray
from tests.motion.oracle import DIGITS, Number, decimal, exact, ulps, worst_ulps
from tests.reference import LAW_NAMES, law_cases, law_of
from tests.strategies import attack, laws, places

LIMIT = 8.0
"""ulp. A result takes about six roundings, the most in the cube of x - sin x: z / factor, times pi,
squared, times x, divided by 6, times the series, each half a unit, some of them doubled."""

EPS = 2.0**-52

CASES = law_cases()
by_case = pytest.mark.parametrize("case", CASES, ids=[case["id"] for case in CASES])
by_law = pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)


def jerk_limit(law: Law) -> float:
    return max(region.jerk_bound for region in law.regions)


def mesh(law: Law) -> tuple[FloatArray, FloatArray, FloatArray]:
    """f', f'', f''' at both ends of every region and at 1,000 places between."""
    shares = np.linspace(0.0, 1.0, 1001)
    parts = []
    for region in law.regions:
        z = region.start + shares * (region.end - region.start)
        parts.append(region.formula(z, 1.0 - z)[1:])
    velocity, acceleration, jerk = (np.concatenate(part) for part in zip(*parts, strict=True))
    return velocity, acceleration, jerk


# Against the values of the reference -----------------------------------------------------------


def test_every_registered_law_has_reference_values() -> None:
    assert {law_of(case).name for case in CASES if case["law"] != "rr_asymmetric"} == set(LAWS)
    assert set(LAW_NAMES.values()) == set(LAWS)


@by_case
def test_f_and_its_complement_are_right_to_8_ulp(case: dict[str, Any]) -> None:
    law, points = law_of(case), case["points"]
    z = np.array([float.fromhex(point["z_hex"]) for point in points])
    assert z.min() == 0.0
    assert 1e-12 in z
    assert 1.0 - 1e-12 in z
    assert worst_ulps(law(z)[0], [decimal(point["f"]) for point in points]) <= LIMIT
    assert worst_ulps(law.complement(z), [decimal(point["g"]) for point in points]) <= LIMIT


@by_case
@pytest.mark.parametrize("order", [1, 2])
def test_derivatives_are_right_to_8_ulp(case: dict[str, Any], order: int) -> None:
    """Also near their zeros at z = 0, lambda and 1: there f' and f'' are written in z, lambda - z
    and 1 - z. Elsewhere no law of the reference has a zero."""
    law, points = law_of(case), case["points"]
    z = np.array([float.fromhex(point["z_hex"]) for point in points])
    true = [right_value(point, f"f{order}") for point in points]
    assert worst_ulps(law(z)[order], true) <= LIMIT


@by_case
def test_jerk_is_right_to_8_units_of_its_maximum(case: dict[str, Any]) -> None:
    """f''' has zeros inside the regions, where cosines lose digits; so relative to its maximum."""
    law, points = law_of(case), case["points"]
    z = np.array([float.fromhex(point["z_hex"]) for point in points])
    true = np.array([float(right_value(point, "f3")) for point in points])
    inside = np.array(["border" not in point or law.inflection == 0.5 for point in points])
    error = np.abs(law(z)[3] - true)[inside]
    assert np.max(error) <= LIMIT * EPS * jerk_limit(law)


def right_value(point: dict[str, Any], key: str) -> Number:
    """The limit from the right; `key` itself where there is no border, or at z = 1."""
    return decimal(
        point[key] if float(point["z"]) == 1.0 else point.get(f"{key}_right", point[key])
    )


@by_case
def test_one_sided_values_at_the_borders(case: dict[str, Any]) -> None:
    """f'' and f''' of the formulas left and right of each border.

    To 8 units of the maximum, and what the rounding of the border itself moves: f'' by f''', and
    f''' by no more than its maximum times 2 pi by the length of the region.
    """
    law = law_of(case)
    for border in case["borders"]:
        z = np.array([float(border["z"])])
        for side, region in (
            ("right", region_starting_at(law, z[0])),
            ("left", region_ending_at(law, z[0])),
        ):
            if z[0] == (1.0 if side == "right" else 0.0):
                continue
            values = region.formula(z, 1.0 - z)
            jerk = region.jerk_bound
            largest = max(abs(float(border["f2_left"])), abs(float(border["f2_right"])))
            limit = EPS * (LIMIT * largest + jerk)
            assert values[2][0] == pytest.approx(float(border[f"f2_{side}"]), abs=limit, rel=0)
            limit = EPS * jerk * (LIMIT + 2.0 * math.pi / (region.end - region.start))
            assert values[3][0] == pytest.approx(float(border[f"f3_{side}"]), abs=limit, rel=0)


def region_starting_at(law: Law, z: float) -> Region:
    return min(law.regions, key=lambda region: abs(region.start - z))


def region_ending_at(law: Law, z: float) -> Region:
    return min(law.regions, key=lambda region: abs(region.end - z))


@by_case
def test_borders_are_where_the_formula_changes_and_have_all_jumps(case: dict[str, Any]) -> None:
    """All jumps of f'' and f''' are borders; further ones are where the next derivative jumps."""
    law = law_of(case)
    inner = case["borders"][1:-1]
    jumps = [
        float(border["z"])
        for border in inner
        if any(border[f"f{order}_left"] != border[f"f{order}_right"] for order in (2, 3))
    ]
    for z in jumps:
        assert min(abs(z - border) for border in law.borders) <= 2.0 * EPS
    for border in law.borders:
        assert min(abs(float(entry["z"]) - border) for entry in inner) <= 2.0 * EPS


@by_case
def test_end_values(case: dict[str, Any]) -> None:
    law = law_of(case)
    first, last = case["borders"][0], case["borders"][-1]
    assert law.end_velocity == float(first["f1"]) == float(last["f1"])
    true = [decimal(first["f2_right"]), decimal(last["f2_left"])]
    assert worst_ulps(law.end_acceleration, true) <= LIMIT


# Characteristic values ------------------------------------------------------------------------

PUBLISHED = {
    # C_v, C_a, C_j, C_Mdyn to three digits: VDI 2143-1, section 6.1.1
    "straight-line": (1.0, math.inf, math.inf, math.inf),
    "quadratic-parabola": (2.0, 4.0, math.inf, 8.0),
    "simple-sine": (1.57, 4.93, math.inf, 3.88),
    "polynomial-345": (1.875, 5.77, 60.0, 6.69),
    "inclined-sine": (2.0, 6.28, 39.5, 8.16),
    "modified-trapezoid": (2.0, 4.89, 61.4, 8.09),
    "modified-sine": (1.76, 5.53, 69.5, 5.46),
}


@by_law
def test_published_characteristic_values(law: Law) -> None:
    found = law.characteristic
    values = (found.velocity, found.acceleration, found.jerk, found.moment)
    for value, published in zip(values, PUBLISHED[law.name], strict=True):
        # Half a unit of the third digit.
        half = 0.5 * 10.0 ** (math.floor(math.log10(value)) - 2) if math.isfinite(value) else 0.0
        assert value == pytest.approx(published, abs=half, rel=0)


@by_case
def test_characteristic_values_are_the_extremes_of_the_reference(case: dict[str, Any]) -> None:
    law, extrema = law_of(case), case["extrema"]
    found = law.characteristic
    assert ulps(found.velocity, decimal(extrema["f1"]["max"]["value"])) <= LIMIT
    shock = float(case["borders"][0]["f1"]) != 0.0
    if shock:
        assert math.isinf(found.acceleration)
        assert math.isinf(found.deceleration)
        assert math.isinf(found.moment)
        assert math.isinf(found.braking_moment)
    else:
        assert ulps(found.acceleration, decimal(extrema["f2"]["max"]["value"])) <= LIMIT
        assert ulps(-found.deceleration, decimal(extrema["f2"]["min"]["value"])) <= LIMIT
        assert ulps(found.moment, decimal(extrema["P"]["max"]["value"])) <= LIMIT
        assert ulps(-found.braking_moment, decimal(extrema["P"]["min"]["value"])) <= LIMIT
    if shock or acceleration_jumps(case):
        assert math.isinf(found.jerk)
    else:
        most = max(abs(decimal(extrema["f3"][end]["value"])) for end in ("max", "min"))
        assert ulps(found.jerk, most) <= LIMIT


def acceleration_jumps(case: dict[str, Any]) -> bool:
    """True if f'' jumps at a border, or from the rest before or behind the move."""
    borders = case["borders"]
    ends = float(borders[0]["f2_right"]), float(borders[-1]["f2_left"])
    return any(ends) or any(border["f2_left"] != border["f2_right"] for border in borders)


@attack
@given(law=laws())
def test_no_value_exceeds_the_characteristic_ones_and_some_come_near(law: Law) -> None:
    """A region turns by pi at most: on the mesh cosines come within (pi/1000)^2/8 of their peak."""
    found = law.characteristic
    velocity, acceleration, jerk = mesh(law)
    pairs = [
        (found.velocity, np.max(velocity)),
        (found.acceleration, np.max(acceleration)),
        (found.deceleration, np.max(-acceleration)),
        (found.jerk, np.max(np.abs(jerk))),
        (found.moment, np.max(velocity * acceleration)),
        (found.braking_moment, np.max(-velocity * acceleration)),
    ]
    for closed, dense in pairs:
        if math.isfinite(closed):
            assert dense <= closed * (1.0 + 16.0 * EPS)
            assert dense >= closed * (1.0 - 1e-4)


# Against the printed formulas at 80 digits ----------------------------------------------------


@settings(attack, max_examples=400)
@given(law=laws(), data=st.data())
def test_values_anywhere_are_right_to_8_ulp(law: Law, data: st.DataObject) -> None:
    z = data.draw(places(law))
    array = np.array([z])
    (f,), (f1,), (f2,), (f3,) = law(array)
    true = exact(law, z)
    assert ulps(f, true[0]) <= LIMIT
    assert ulps(law.complement(array)[0], true[1]) <= LIMIT
    assert ulps(f1, true[2]) <= LIMIT
    on_a_border = any(abs(z - border) < 4.0 * EPS for border in (law.inflection, *law.borders))
    if not on_a_border:  # beside a rounded border either formula may hold
        assert ulps(f2, true[3]) <= LIMIT
        assert abs(f3 - float(true[4])) <= LIMIT * EPS * jerk_limit(law)


@pytest.mark.parametrize("half", HALVES.values(), ids=HALVES)
def test_the_value_about_the_centre_is_right_to_8_ulp(half: HalfLaw) -> None:
    r = np.concatenate((np.logspace(-16, -1, 31), np.linspace(0.0, 0.5, 41)))
    law = LAWS[half.name]
    with mp.workdps(DIGITS):
        true = [mpf(1) / 2 - exact_at(law, mpf(1) / 2 - mpf(float(x))) for x in r]
    assert worst_ulps(half.centre(r), true) <= LIMIT


def exact_at(law: Law, z: Number) -> Number:
    """f at a z with more digits than a double has."""
    return exact(law, z)[0]


# What holds for every law ---------------------------------------------------------------------


@attack
@given(law=laws())
def test_a_law_runs_from_0_to_1_through_its_inflection_point(law: Law) -> None:
    f = law(np.array([0.0, law.inflection, 1.0]))[0]
    assert f[0] == 0.0
    assert f[1] == pytest.approx(law.inflection, rel=2 * EPS)
    assert f[2] == 1.0
    assert law.complement(np.array([0.0, 1.0])).tolist() == [1.0, 0.0]


@attack
@given(law=laws(), data=st.data())
def test_f_and_its_complement_add_up_to_one(law: Law, data: st.DataObject) -> None:
    z = np.array([data.draw(places(law))])
    # Both are right to 8 ulp, and at most 1: so is the sum, to 16 ulp of 1.
    assert abs(law(z)[0][0] + law.complement(z)[0] - 1.0) <= 2.0 * LIMIT * EPS


@by_law
def test_a_symmetric_law_is_its_own_mirror_image(law: Law) -> None:
    """F(z) = 1 - f(1 - z); z = k/1024 makes 1 - z exact, both sides are right to 8 ulp."""
    z = np.arange(1, 1024) / 1024.0
    z = z[~np.isin(z, law.borders) & ~np.isin(1.0 - z, law.borders)]
    f, f1, f2, f3 = law(z)
    _, m1, m2, m3 = law(1.0 - z)
    assert np.all(np.abs(law.complement(1.0 - z) - f) <= 2.0 * LIMIT * np.spacing(f))
    assert np.all(np.abs(m1 - f1) <= 2.0 * LIMIT * np.spacing(f1))
    assert np.all(np.abs(m2 + f2) <= 2.0 * LIMIT * np.spacing(np.abs(f2)))
    assert np.all(np.abs(m3 - f3) <= 2.0 * LIMIT * EPS * jerk_limit(law))


@attack
@given(law=laws(), data=st.data())
def test_each_value_is_the_integral_of_its_derivative(law: Law, data: st.DataObject) -> None:
    """Over any stretch of a region. Gauss's rule of 24 points on a function that turns by at most
    pi is exact to 1e-30, so only the 8 ulp of values and integrand are left."""
    region = data.draw(st.sampled_from(law.regions))
    ends = sorted(data.draw(st.floats(0.0, 1.0)) for _ in range(2))
    low, high = (region.start + end * (region.end - region.start) for end in ends)
    nodes, weights = np.polynomial.legendre.leggauss(24)
    z = 0.5 * (low + high) + 0.5 * (high - low) * nodes
    inner = region.formula(z, 1.0 - z)
    corners = np.array([low, high])
    outer = region.formula(corners, 1.0 - corners)
    for order in range(3):
        sign = -1.0 if region.from_end and order == 0 else 1.0
        integral = 0.5 * (high - low) * float(weights @ inner[order + 1])
        change = sign * (outer[order][1] - outer[order][0])
        scale = float(np.max(np.abs(inner[order + 1])) * (high - low))
        scale += float(np.max(np.abs(outer[order])))
        # z itself is rounded: one ulp of 1 moves a value by the derivative times that.
        scale += float(np.max(np.abs(inner[order + 1])))
        assert abs(integral - change) <= 3.0 * LIMIT * EPS * scale


@attack
@given(law=laws())
def test_the_jerk_bound_bounds_f3_in_each_region(law: Law) -> None:
    steps = np.concatenate((np.linspace(0.0, 1.0, 301), np.logspace(-15, -3, 13)))
    for region in law.regions:
        for share in (steps, 1.0 - steps):
            z = region.start + share * (region.end - region.start)
            f3 = region.formula(z, 1.0 - z)[3]
            assert np.max(np.abs(f3)) <= region.jerk_bound * (1.0 + LIMIT * EPS)


@by_law
def test_the_jerk_bound_is_no_wider_than_needed(law: Law) -> None:
    """All bounds are reached somewhere, so that cells need not be smaller than f''' demands."""
    for region in law.regions:
        z = np.linspace(region.start, region.end, 1001)
        most = np.max(np.abs(region.formula(z, 1.0 - z)[3]))
        assert most >= region.jerk_bound * (1.0 - 1e-5)


@attack
@given(law=laws())
def test_regions_fill_the_law_without_gaps(law: Law) -> None:
    assert law.regions[0].start == 0.0
    assert law.regions[-1].end == 1.0
    for before, after in zip(law.regions[:-1], law.regions[1:], strict=True):
        # Both are the same border, rounded on the way from one end of the law or from the other.
        assert abs(before.end - after.start) <= 2.0 * EPS
        assert before.start < before.end


@by_law
def test_velocity_is_continuous_and_only_borders_have_jumps(law: Law) -> None:
    for before, after in zip(law.regions[:-1], law.regions[1:], strict=True):
        z = np.array([after.start])
        left, right = before.formula(z, 1.0 - z), after.formula(z, 1.0 - z)
        assert abs(left[1][0] - right[1][0]) <= 2.0 * LIMIT * EPS * law.characteristic.velocity
        jump = abs(left[2][0] - right[2][0]) + abs(left[3][0] - right[3][0])
        if after.start not in law.borders:
            scale = jerk_limit(law)
            if math.isfinite(law.characteristic.acceleration):
                scale += law.characteristic.acceleration
            assert jump <= 2.0 * LIMIT * EPS * scale


def test_names_and_aliases() -> None:
    for name, law in LAWS.items():
        assert find_law(name) is law
        assert law.name == name
    for alias, name in ALIASES.items():
        assert find_law(alias) is LAWS[name]
    with pytest.raises(KeyError):
        find_law("cycloid")


# The tests themselves -------------------------------------------------------------------------


def spoiled(law: Law, spoil: Callable[[FloatArray, Values], Values]) -> Law:
    """`law` with another formula in all regions."""

    def changed(region: Region) -> Region:
        def formula(z: FloatArray, w: FloatArray) -> Values:
            return spoil(w if region.from_end else z, region.formula(z, w))

        return replace(region, formula=formula)

    return replace(law, regions=tuple(changed(region) for region in law.regions))


def case_of(name: str) -> dict[str, Any]:
    (case,) = [case for case in CASES if LAW_NAMES.get(case["law"]) == name]
    return case


def error_of(case: dict[str, Any], law: Law, key: str) -> float:
    """Largest error in ulp over the points of the reference."""
    points = case["points"]
    z = np.array([float.fromhex(point["z_hex"]) for point in points])
    values = law.complement(z) if key == "g" else law(z)[("f", "f1", "f2").index(key)]
    return worst_ulps(values, [right_value(point, key) for point in points])


def test_the_printed_inclined_sine_fails_at_small_z() -> None:
    def printed(z: FloatArray, values: Values) -> Values:
        return (z - np.sin(2.0 * np.pi * z) / (2.0 * np.pi), *values[1:])

    law = LAWS["inclined-sine"]
    case = case_of("inclined-sine")
    assert error_of(case, law, "f") <= LIMIT
    assert error_of(case, spoiled(law, printed), "f") > 1e15


def test_one_minus_f_fails_as_complement() -> None:
    law = LAWS["polynomial-345"]
    points = case_of("polynomial-345")["points"]
    z = np.array([float.fromhex(point["z_hex"]) for point in points])
    true = [decimal(point["g"]) for point in points]
    assert worst_ulps(1.0 - law(z)[0], true) > 1e15


def test_the_acceleration_by_a_cosine_fails_at_the_inflection() -> None:
    law = LAWS["simple-sine"]

    def printed(z: FloatArray, values: Values) -> Values:
        return values[0], values[1], 0.5 * np.pi**2 * np.cos(np.pi * z), values[3]

    assert error_of(case_of("simple-sine"), law, "f2") <= LIMIT
    assert error_of(case_of("simple-sine"), spoiled(law, printed), "f2") > 1e15


@pytest.mark.parametrize(("key", "order"), [("f", 0), ("f1", 1), ("f2", 2)])
def test_an_error_of_20_ulp_is_seen(key: str, order: int) -> None:
    law = LAWS["modified-sine"]

    def stretched(_: FloatArray, values: Values) -> Values:
        changed = list(values)
        changed[order] = changed[order] * (1.0 + 20.0 * EPS)
        return changed[0], changed[1], changed[2], changed[3]

    assert error_of(case_of("modified-sine"), law, key) <= LIMIT
    assert error_of(case_of("modified-sine"), spoiled(law, stretched), key) > LIMIT
