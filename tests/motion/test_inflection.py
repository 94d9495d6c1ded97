from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mp

from camgeo.kinematics.laws.law import Law, characteristic
from tests.laws import LAWS
from tests.motion.exact_laws import decimal, ulps
from tests.reference import POLYNOMIAL, hard_case, shift
from tests.strategies import BENT, attack, inflections, laws, places

EPS = 2.0**-52
LIMIT = 8.0  # ulp, see test_laws

PARAMS, EXPECTED = hard_case("HC13")
LAMBDA = float(PARAMS["lambda_"])


SHIFTABLE = tuple(name for name, law in LAWS.items() if law.inflection is not None)


@attack
@given(law=laws(), data=st.data())
def test_one_half_is_the_law_itself(law: Law, data: st.DataObject) -> None:
    z = np.array([data.draw(places(law))])
    base, back = LAWS[law.name], shift(law, 0.5)
    assert back.borders == base.borders
    for value, other in zip(back(z), base(z), strict=True):
        assert value == other


@attack
@given(lam=inflections(), name=st.sampled_from(BENT))
def test_the_inflection_point_lies_on_the_diagonal_and_has_the_top_speed(
    lam: float, name: str
) -> None:
    law = shift(LAWS[name], lam)
    assert law.inflection == lam
    (f,), (f1,), _, _ = law(np.array([lam]))
    assert f == pytest.approx(lam, rel=2.0 * EPS)
    top = characteristic(law).velocity.value
    assert f1 == pytest.approx(top, rel=LIMIT * EPS)
    assert top == pytest.approx(characteristic(LAWS[name]).velocity.value, rel=LIMIT * EPS)


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
    found = characteristic(law).acceleration
    assert ulps(found.value, decimal(EXPECTED["max_f2"])) <= LIMIT
    assert found.place == pytest.approx(float(EXPECTED["z_of_max_f2"]), rel=1e-12)
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
@given(lam=inflections(), name=st.sampled_from(SHIFTABLE))
def test_end_values_and_borders_are_stretched(lam: float, name: str) -> None:
    """Eqs. (66) to (81): f' stays, f'' and the jerk are divided by the stretching."""
    base, law = LAWS[name], shift(LAWS[name], lam)
    for old, new, factor in (
        (base.start, law.start, 2.0 * lam),
        (base.end, law.end, 2.0 * (1.0 - lam)),
    ):
        assert new.velocity == old.velocity
        assert new.acceleration == pytest.approx(old.acceleration / factor, rel=4.0 * EPS)
        assert new.jerk == pytest.approx(old.jerk / factor**2, rel=8.0 * EPS)
    assert lam in law.borders or lam == 0.5  # nothing jumps in the middle of most laws


@attack
@given(lam=inflections())
def test_a_straight_line_stays_one(lam: float) -> None:
    assert shift(LAWS["straight-line"], lam).borders == ()  # nothing bends
