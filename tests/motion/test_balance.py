"""lambda with equal peaks of both parts of a law: VDI 2143-1, sections 6.2, 6.6 and 6.8."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.kinematics.laws import BALANCES, FAMILIES, make_law
from camgeo.kinematics.laws.law import Characteristic, characteristic
from camgeo.kinematics.planning.build import balanced, equal_accelerations
from tests.strategies import attack

CLAIMS = [
    # The guideline says 0.526, 0.513, 0.522 and 0.5, 0.667, 0.529; the digits by mpmath.
    ("modified-trapezoid", "acceleration", 0.526294328940461),
    ("modified-trapezoid", "jerk", 0.513156266902126),
    ("modified-trapezoid", "moment", 0.521792013349567),
    ("harmonic-combination", "acceleration", 0.5),
    ("harmonic-combination", "jerk", 2.0 / 3.0),
    ("harmonic-combination", "moment", 0.528787514567007),
]


def parts_of(values: Characteristic, quantity: str) -> tuple[float, float]:
    pairs = {
        "acceleration": (values.acceleration, values.deceleration),
        "jerk": (values.jerk, values.braking_jerk),
        "moment": (values.moment, values.braking_moment),
    }
    first, second = pairs[quantity]
    return abs(first.value), abs(second.value)


@pytest.mark.parametrize(("law", "quantity", "inflection"), CLAIMS)
def test_the_claims_of_the_guideline(law: str, quantity: str, inflection: float) -> None:
    for task in ("R-U", "U-R"):  # both counted from the rest
        found = balanced(law, task, quantity, {})
        assert found == pytest.approx(inflection, abs=1e-14)
        first, second = parts_of(characteristic(make_law(law, task, inflection=found)), quantity)
        assert first == pytest.approx(second, rel=1e-12)


@pytest.mark.parametrize("law", ["modified-sine", "modified-trapezoid", "polynomial-345", "scca"])
@pytest.mark.parametrize("quantity", BALANCES)
def test_symmetric_laws_are_balanced_in_the_middle(law: str, quantity: str) -> None:
    assert balanced(law, "R-R", quantity, {}) == pytest.approx(0.5, abs=1e-12)


def test_check_values_of_constant_velocities() -> None:
    """v0 = 0, v1 = 1: 0.736048394432 with C_a = 3.32727602442; v0 = 0.5, v1 = 1.5: pi/2 at 1/2."""
    found = equal_accelerations("modified-sine", "R-G", {"v1": 1.0})
    assert found == pytest.approx(0.736048394432, abs=1e-12)
    law = make_law("modified-sine", "R-G", inflection=found, v1=1.0)
    assert characteristic(law).acceleration.value == pytest.approx(3.32727602442, abs=1e-11)
    found = equal_accelerations("modified-sine", "G-G", {"v0": 0.5, "v1": 1.5})
    law = make_law("modified-sine", "G-G", inflection=found, v0=0.5, v1=1.5)
    values = characteristic(law)
    assert values.acceleration.value == pytest.approx(math.pi / 2.0, rel=1e-14)
    assert values.deceleration.value == pytest.approx(math.pi / 2.0, rel=1e-14)
    # v0 = v1 = 1 is a straight line wherever it bends not.
    assert equal_accelerations("modified-sine", "G-G", {"v0": 1.0, "v1": 1.0}) == 0.5


def test_check_value_of_constant_velocity_to_turn() -> None:
    """vG = 0.5: lambda = 0.399963536211179 with C_a = -C_a* = 3.92555940929420."""
    found = equal_accelerations("harmonic-combination", "G-U", {"v0": 0.5})
    assert found == pytest.approx(0.399963536211179, abs=1e-14)
    law = make_law("harmonic-combination", "G-U", inflection=found, v0=0.5)
    values = characteristic(law)
    assert values.acceleration.value == pytest.approx(3.92555940929420, rel=1e-13)
    assert values.deceleration.value == pytest.approx(-3.92555940929420, rel=1e-13)
    assert equal_accelerations("harmonic-combination", "U-G", {"v1": 0.5}) == found


@attack
@given(v0=st.floats(-3.0, 4.0), v1=st.floats(-3.0, 4.0))
def test_any_two_velocities_are_balanced_or_refused(v0: float, v1: float) -> None:
    given_values = {"v0": v0, "v1": v1}
    try:
        found = equal_accelerations("modified-sine", "G-G", given_values)
    except GeometryError:
        # Section 7: there is none only where N0 N1 = 0; here N0 or N1 is nearly 0.
        m, q, d = 2.0 * math.pi**2 / (math.pi + 4.0), math.pi / 2.0, v1 - v0
        n0, n1 = m * (1.0 - v1) + q * d, m * (1.0 - v0) - q * d
        assert min(abs(n0), abs(n1)) < 1e-9
        return
    assume(1e-9 < found < 1.0 - 1e-9)
    law = make_law("modified-sine", "G-G", inflection=found, **given_values)
    values = characteristic(law)
    size = max(1.0, abs(values.acceleration.value))
    first, second = parts_of(values, "acceleration")
    # The rounding of lambda moves the amplitudes by its part of the shorter length.
    assert first == pytest.approx(second, abs=1e-14 * size / min(found, 1.0 - found) + 1e-13 * size)


def test_laws_without_an_inflection_point_are_refused() -> None:
    with pytest.raises(GeometryError, match="no inflection point"):
        equal_accelerations("polynomial-5", "B-B", {})


@pytest.mark.parametrize(
    ("name", "task"),
    [
        (name, task)
        for name, family in FAMILIES.items()
        for task in family.tasks
        if "inflection" in family.parameters[task] and task not in ("R-R", "U-U")
    ],
)
def test_both_parts_have_the_same_extreme_in_samples(name: str, task: str) -> None:
    """Of each quantity at the lambda found for it, and not at another one."""
    taken = FAMILIES[name].parameters[task]
    given_values = {key: value for key, value in (("v0", 0.6), ("v1", 0.9)) if key in taken}
    for quantity in BALANCES:
        found = balanced(name, task, quantity, given_values)
        apart = []
        for shift in (0.0, 0.05):
            law = make_law(name, task, **given_values, inflection=found + shift)
            assert law.inflection is not None
            z = np.concatenate([
                start + (end - start) * np.linspace(1e-9, 1.0 - 1e-9, 2001)
                for start, end in pairwise((0.0, *sorted({*law.borders, law.inflection}), 1.0))
            ])  # fmt: skip
            _, f1, f2, f3 = law(z)
            values = np.abs({"acceleration": f2, "jerk": f3, "moment": f1 * f2}[quantity])
            first = z < law.inflection
            apart.append(np.max(values[first]) / np.max(values[~first]) - 1.0)
        assert abs(apart[0]) <= 1e-5
        assert abs(apart[1]) > 1e-2


@pytest.mark.parametrize(
    ("name", "quantity", "message"),
    [
        ("straight-line", "acceleration", "straight-line has no inflection point"),
        ("straight-line", "jerk", "no inflection point makes the jerk equal in both parts of"),
        ("quadratic-parabola", "jerk", "equal in both parts of quadratic-parabola for R-R"),
    ],
)
def test_where_nothing_makes_them_equal_that_is_said(
    name: str, quantity: str, message: str
) -> None:
    with pytest.raises(GeometryError, match=message) as caught:
        balanced(name, "R-R", quantity, {})
    assert caught.value.key == "inflection"
