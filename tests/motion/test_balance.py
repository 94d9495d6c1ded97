"""The inflection point that makes both parts of a law equally hard, against VDI 2143-1."""

from __future__ import annotations

import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.motion.laws import FAMILIES, characteristic, make_law
from camgeo.motion.laws.balance import QUANTITIES, balanced, equal_accelerations
from camgeo.motion.laws.law import Law
from tests.strategies import attack

CLAIMS = [
    ("modified-trapezoid", "acceleration", 0.526294328940461, 0.526),
    ("modified-trapezoid", "jerk", 0.513156266902126, 0.513),
    ("modified-trapezoid", "moment", 0.521792013349567, 0.522),
    ("harmonic-combination", "acceleration", 0.5, 0.5),
    ("harmonic-combination", "jerk", 2.0 / 3.0, 0.667),
    ("harmonic-combination", "moment", 0.528787514567007, 0.529),
]
"""Name, quantity, lambda with 15 digits, lambda as VDI 2143-1 prints it (sections 6.6.1, 6.6.2)."""

NEAR = 1e-14
"""A root of a quadratic with 50 digits, or bracketed to a few ulp of 1; 15 digits are given."""

Q = math.pi / 2.0
M = 2.0 * math.pi**2 / (math.pi + 4.0)
KAPPA = 1.0 - (math.pi + 4.0) / (4.0 * math.pi)


def has_none(v0: float, v1: float) -> bool:
    """Whether no lambda of G-G makes the accelerations equal: N0 or N1 is 0, to rounding."""
    change = v1 - v0
    n0, n1 = M * (1.0 - v1) + Q * change, M * (1.0 - v0) - Q * change
    return min(abs(n0), abs(n1)) < 1e-14


def pair(law: Law, quantity: str) -> tuple[float, float]:
    """The quantity's largest magnitude in both parts, signed."""
    values = characteristic(law)
    first, second = {
        "acceleration": (values.acceleration, values.deceleration),
        "jerk": (values.jerk, values.braking_jerk),
        "moment": (values.moment, values.braking_moment),
    }[quantity]
    return first.value, second.value


@pytest.mark.parametrize(("name", "quantity", "digits", "printed"), CLAIMS)
@pytest.mark.parametrize("task", ["R-U", "U-R"])
def test_claims_of_the_guideline(
    name: str, quantity: str, digits: float, printed: float, task: str
) -> None:
    found = balanced(name, task, quantity, {})
    assert found == pytest.approx(digits, abs=NEAR)
    assert round(found, 3) == printed


@pytest.mark.parametrize("quantity", QUANTITIES)
@pytest.mark.parametrize(
    ("name", "task"),
    [
        (name, task)
        for name, family in FAMILIES.items()
        for task in family.tasks
        if family.parts is not None and not {"v0", "v1"} & set(family.parameters[task])
    ],
)
def test_both_parts_are_equal_there(name: str, task: str, quantity: str) -> None:
    if (name, quantity) == ("quadratic-parabola", "jerk"):
        with pytest.raises(GeometryError, match="makes the jerk equal"):
            balanced(name, task, quantity, {})  # it is 0 in either part, wherever they meet
        return
    law = make_law(name, task, inflection=balanced(name, task, quantity, {}))
    first, second = pair(law, quantity)
    # The sizes go with a power of lambda up to 3, whose error is 1e-15 of it.
    assert abs(first) == pytest.approx(abs(second), rel=1e-13)


@pytest.mark.parametrize("quantity", QUANTITIES)
@given(v0=st.floats(-1.0, 3.0), v1=st.floats(-1.0, 3.0))
@attack
def test_gg_is_equal_or_refused(quantity: str, v0: float, v1: float) -> None:
    given_ = {"v0": v0, "v1": v1}
    try:
        found = balanced("modified-sine", "G-G", quantity, given_)
    except GeometryError:
        # Told apart by the closed form below; the jerk and the moment have none.
        assert quantity != "acceleration" or has_none(v0, v1)
        return
    assert 0.0 < found < 1.0
    # Near 0 and 1 a part's sizes go with its length, whose relative error is 1e-16 / length.
    assume(1e-4 < found < 1.0 - 1e-4)
    first, second = pair(make_law("modified-sine", "G-G", inflection=found, **given_), quantity)
    size = max(abs(first), abs(second))
    assert abs(abs(first) - abs(second)) <= 1e-9 * size + 1e-12


@given(v0=st.floats(-2.0, 4.0), v1=st.floats(-2.0, 4.0))
@attack
def test_gg_equal_accelerations_by_the_closed_form(v0: float, v1: float) -> None:
    """lambda = N0/(C_a - (M - q) D), or N0/((2q - M) D) where f' is monotonous."""
    change, total = v1 - v0, 2.0 - v0 - v1
    n0, n1 = M * (1.0 - v1) + Q * change, M * (1.0 - v0) - Q * change
    # Away from where there is none, and where lambda is badly conditioned.
    assume(min(abs(n0), abs(n1), abs(change)) > 1e-3)
    if n0 * n1 > 0.0:
        root = math.sqrt(M**2 * total**2 + 4.0 * (M - Q) * Q * change**2)
        peak = (M * total + math.copysign(root, total)) / 2.0
        wanted = n0 / (peak - (M - Q) * change)
    else:
        wanted = n0 / ((2.0 * Q - M) * change)
    found = equal_accelerations("modified-sine", "G-G", {"v0": v0, "v1": v1})
    # About ten roundings, over the 1e-3 above.
    assert found == pytest.approx(wanted, abs=1e-11)


@pytest.mark.parametrize(
    ("v0", "v1", "lam", "peaks"),
    [
        (0.0, 1.0, 0.736048394432, (3.32727602442, -3.32727602442)),
        (0.5, 1.5, 0.5, (Q, Q)),
        (0.3, 0.3, 0.5, (2.0 * M * 0.7, -2.0 * M * 0.7)),
    ],
)
def test_gg_check_values(v0: float, v1: float, lam: float, peaks: tuple[float, float]) -> None:
    found = equal_accelerations("modified-sine", "G-G", {"v0": v0, "v1": v1})
    assert found == pytest.approx(lam, abs=1e-12)
    law = make_law("modified-sine", "G-G", inflection=found, v0=v0, v1=v1)
    assert pair(law, "acceleration") == pytest.approx(peaks, rel=1e-11)  # 12 digits are given


def test_gg_without_the_balance() -> None:
    law = make_law("modified-sine", "G-G", inflection=0.4, v0=0.5, v1=1.5)
    values = characteristic(law)
    # 15 digits are given.
    assert values.acceleration.value == pytest.approx(1.66519985637433, rel=1e-14)
    assert values.deceleration.value == pytest.approx(1.50786064040861, rel=1e-14)


@given(velocity=st.floats(0.0, 1.5))
@attack
def test_gu_equal_accelerations_by_the_closed_form(velocity: float) -> None:
    """VDI 2143-1, section 6.8: the smaller root of the quadratic for v_G < pi/2."""
    a = (7.0 * math.pi - 12.0) * velocity
    b = 8.0 * math.pi - 16.0 * velocity + 4.0 * math.pi * velocity
    c = 4.0 * math.pi - 8.0 * velocity
    wanted = 2.0 * c / (b + math.sqrt(b * b - 4.0 * a * c))
    for task, key in (("G-U", "v0"), ("U-G", "v1")):
        found = equal_accelerations("harmonic-combination", task, {key: velocity})
        assert found == pytest.approx(wanted, abs=1e-14)  # ten roundings of numbers up to 1


def test_gu_check_values() -> None:
    found = equal_accelerations("harmonic-combination", "G-U", {"v0": 0.5})
    assert found == pytest.approx(0.399963536211179, abs=NEAR)
    law = make_law("harmonic-combination", "G-U", inflection=found, v0=0.5)
    peaks = pair(law, "acceleration")
    assert peaks == pytest.approx((3.92555940929420, -3.92555940929420), rel=1e-13)


@given(velocity=st.floats(math.pi / 2.0 + 1e-3, 1.0 / KAPPA - 1e-3))
@attack
def test_gu_equal_accelerations_of_one_sign(velocity: float) -> None:
    """pi/2 < v_G < 4 pi/(3 pi - 4): both are -(pi/2) v_G."""
    found = equal_accelerations("harmonic-combination", "G-U", {"v0": velocity})
    wanted = 2.0 - math.sqrt(4.0 - (8.0 - 4.0 * math.pi / velocity) / (4.0 - math.pi))
    assert found == pytest.approx(wanted, abs=1e-12)  # differences of near numbers: 1e-16 / 1e-3
    law = make_law("harmonic-combination", "G-U", inflection=found, v0=velocity)
    assert pair(law, "acceleration") == pytest.approx((-Q * velocity, -Q * velocity), rel=1e-9)


def test_of_the_larger_of_both_it_is_the_least() -> None:
    """Equal accelerations are the smallest possible ones: any other lambda has a larger one."""

    def largest(name: str, lam: float) -> float:
        return max(map(abs, pair(make_law(name, "R-U", inflection=lam), "acceleration")))

    for name in ("modified-trapezoid", "harmonic-combination"):
        equal = equal_accelerations(name, "R-U", {})
        for step in (-0.2, -0.01, 0.01, 0.2):
            assert largest(name, equal + step) > largest(name, equal)


@pytest.mark.parametrize("name", ["polynomial-5", "double-harmonic", "polynomial-7", "polynomial"])
def test_a_law_without_inflection_point_is_refused(name: str) -> None:
    with pytest.raises(GeometryError, match="no inflection point") as caught:
        equal_accelerations(name, FAMILIES[name].tasks[0], {})
    assert caught.value.key == "inflection"
