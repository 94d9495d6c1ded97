from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mp

from camgeo.errors import GeometryError
from camgeo.motion.inflection import shift
from camgeo.motion.laws import LAWS
from camgeo.motion.laws.law import Law
from tests.motion.oracle import decimal, ulps
from tests.reference import POLYNOMIAL, hard_case
from tests.strategies import BENT, attack, inflections, laws, places

EPS = 2.0**-52
LIMIT = 8.0  # ulp, see test_laws

PARAMS, EXPECTED = hard_case("HC13")
LAMBDA = float(PARAMS["lambda_"])


@pytest.mark.parametrize("inflection", [0.0, 1.0, -0.25, 1.5, math.nan, math.inf])
@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_the_inflection_must_lie_inside(law: Law, inflection: float) -> None:
    assert EXPECTED["lambda_0_or_1"] == "error"
    with pytest.raises(GeometryError, match="strictly between 0 and 1") as caught:
        shift(law, inflection)
    assert caught.value.key == "inflection"
    assert caught.value.value == repr(inflection)


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_one_half_is_the_law_itself(law: Law) -> None:
    assert shift(law, 0.5) is law


@attack
@given(law=laws(), data=st.data())
def test_mirror_image_has_the_mirrored_inflection(law: Law, data: st.DataObject) -> None:
    """f(z; lam) = 1 - f(1 - z; 1 - lam); in 30 and 20 bits 1 - z and 1 - lam are exact."""
    lam = round(law.inflection * 2**20) / 2**20
    base = LAWS[law.name]
    one, other = shift(base, lam), shift(base, 1.0 - lam)
    z = data.draw(st.integers(1, 2**30 - 1)) / 2**30
    if any(abs(z - border) < 4.0 * EPS for border in (lam, *one.borders)):
        return  # there either one-sided value may come
    here, there = np.array([z]), np.array([1.0 - z])
    assert abs(one(here)[0] - other.complement(there))[0] <= 2.0 * LIMIT * math.ulp(one(here)[0][0])
    for order, sign in ((1, 1.0), (2, -1.0)):
        value, mirrored = one(here)[order][0], sign * other(there)[order][0]
        assert abs(value - mirrored) <= 2.0 * LIMIT * math.ulp(value)
    jerk = max(region.jerk_bound for region in one.regions)
    assert abs(one(here)[3] - other(there)[3])[0] <= 2.0 * LIMIT * EPS * jerk


@attack
@given(lam=inflections(), name=st.sampled_from(BENT))
def test_the_inflection_point_lies_on_the_diagonal_and_has_the_top_speed(
    lam: float, name: str
) -> None:
    law = shift(LAWS[name], lam)
    (f,), (f1,), _, _ = law(np.array([lam]))
    assert f == pytest.approx(lam, rel=2.0 * EPS)
    assert f1 == pytest.approx(law.characteristic.velocity, rel=LIMIT * EPS)
    assert law.characteristic.velocity == LAWS[name].characteristic.velocity


@attack
@given(law=laws(), data=st.data())
def test_a_shifted_law_never_turns_back(law: Law, data: st.DataObject) -> None:
    z = data.draw(places(law))
    f, f1, _, _ = law(np.array([z]))
    assert 0.0 <= f[0] <= 1.0
    assert f1[0] >= 0.0


def hc13(z: float) -> tuple[float, float, float, float, float]:
    law, place = shift(POLYNOMIAL, LAMBDA), np.array([z])
    f, f1, f2, f3 = law(place)
    return f[0], f1[0], f2[0], f3[0], law.complement(place)[0]


@pytest.mark.parametrize("name", ["z_half_lambda", "z_lambda", "z_05"])
def test_hc13_inflection_at_a_millionth(name: str) -> None:
    expected: dict[str, Any] = EXPECTED[name]
    z = {"z_half_lambda": 0.5 * LAMBDA, "z_lambda": LAMBDA, "z_05": 0.5}[name]
    f, f1, f2, f3, _ = hc13(z)
    # 1e-6 as a double is off by half an ulp, and f, f', f'' scale with it.
    limit = LIMIT + 2.0
    for key, value in {"f": f, "f1": f1, "f2": f2, "f3": f3}.items():
        if key in expected:
            assert ulps(value, decimal(str(expected[key]))) <= limit


def test_hc13_greatest_acceleration_and_jerk_at_the_start() -> None:
    law = shift(POLYNOMIAL, LAMBDA)
    assert ulps(law.characteristic.acceleration, decimal(EXPECTED["max_f2"])) <= LIMIT
    # A maximum is flat: half the digits of its place are enough for all of its value.
    z = float(EXPECTED["z_of_max_f2"])
    assert ulps(hc13(z)[2], decimal(EXPECTED["max_f2"])) <= LIMIT
    assert ulps(hc13(0.0)[3], decimal(str(EXPECTED["f3_at_0"]))) <= LIMIT


def test_hc13_the_other_end_by_symmetry() -> None:
    law = shift(POLYNOMIAL, 1.0 - LAMBDA)
    expected = EXPECTED["z_05"]
    place = np.array([0.5])
    _, f1, f2, _ = law(place)
    # 1 - 1e-6 is rounded by 2^-54, which is 6e-11 of 1e-6, but at z = 1/2 only 1e-16 of lambda.
    assert ulps(law.complement(place)[0], decimal(expected["f"])) <= LIMIT
    assert ulps(f1[0], decimal(expected["f1"])) <= LIMIT
    with mp.workdps(40):
        assert ulps(-f2[0], decimal(expected["f2"])) <= LIMIT


@attack
@given(lam=inflections(), name=st.sampled_from(tuple(LAWS)))
def test_end_values_and_borders_are_stretched(lam: float, name: str) -> None:
    base, law = LAWS[name], shift(LAWS[name], lam)
    assert law.end_velocity == base.end_velocity
    start, end = base.end_acceleration
    assert law.end_acceleration == pytest.approx(
        (start / (2.0 * lam), end / (2.0 * (1.0 - lam))), rel=4.0 * EPS
    )
    if base.end_velocity:
        assert law.borders == ()  # nothing bends
    else:
        assert lam in law.borders or lam == 0.5  # nothing jumps in the middle of most laws
        assert list(law.borders) == sorted(law.borders)
        assert all(0.0 < border < 1.0 for border in law.borders)
