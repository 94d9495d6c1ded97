"""Characteristic values and their places, worked out with many digits, for all tasks.

Those of `fixtures/reference`, and some of laws whose values VDI 2143-1 states.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from camgeo.kinematics.laws import make_law
from camgeo.kinematics.laws.law import Law, characteristic
from tests.reference import law_cases, law_of

LIMIT = 8.0
"""ulp, see test_laws."""

CASES = law_cases()

TABLE: list[tuple[tuple[str, str, dict[str, float]], str]] = [
    (
        ("modified-sine", "G-G", {"inflection": 0.5, "v0": 0.5, "v1": 0.5}),
        (
            "1.37980169297689@0.500000 2.76397853527205@0.125000 -2.76397853527205@0.875000 "
            "34.7331786443621@0 -11.5777262147874@0.500000 "
            "2.51377144572150@0.245919 -2.51377144572150@0.754081"
        ),
    ),
    (
        ("modified-sine", "G-G", {"inflection": 0.5, "v0": 0.5, "v1": 1.5}),
        (
            "1.50000000000000@1.00000 1.57079632679490@0.125000 0@0 "
            "19.7392088021787@0 -19.7392088021787@1.00000 "
            "2.16867986908951@0.882128 0@0"
        ),
    ),
    (
        ("modified-sine", "R-G", {"inflection": 0.5, "v1": 1.0}),
        (
            "1.37980169297689@0.500000 4.33477486206694@0.125000 -1.19318220847715@0.875000 "
            "54.4723874465409@0 -18.1574624821803@0.500000 "
            "3.35596657837405@0.287299 -1.34752984247561@0.819076"
        ),
    ),
    (
        ("sine-straight", "U-U", {"inflection": 0.5, "curved": 0.5}),
        (
            "1.22203094070331@0.250000 7.67824685154591@0 -7.67824685154591@1.00000 "
            "0@0 -48.2438478025312@0.250000 "
            "4.69152761147346@0.125000 -4.69152761147346@0.875000"
        ),
    ),
    (
        ("modified-trapezoid", "R-U", {"inflection": 0.526294328940461}),
        (
            "1.92092499452582@0.526294 4.46029844708141@0.131574 -4.46029844708141@0.644721 "
            "53.2494464167184@0 -59.1609587566358@0.526294 "
            "7.09005555826422@0.413164 -7.21920114230625@0.629854"
        ),
    ),
    (
        ("harmonic-combination", "R-U", {"inflection": 0.528787514567007}),
        (
            "1.66528348932757@0.528788 4.94682857678641@0.132197 -5.55125610838660@1.00000 "
            "58.7794525675433@0 -19.5931508558478@0.528788 "
            "4.62220757116251@0.303841 -4.62220757116251@0.764394"
        ),
    ),
    (
        ("harmonic-combination", "G-U", {"inflection": 0.5, "v0": 0.5}),
        (
            "1.48071294488418@0.500000 3.08100058292856@0.125000 -4.65179690972346@1.00000 "
            "38.7169951881370@0 -14.6140509975789@0.500000 "
            "2.96960766624976@0.249400 -3.44398795059988@0.750000"
        ),
    ),
    (
        ("polynomial-5", "U-U", {"a0": 6.0, "a1": -6.0}),
        (
            "1.50000000000000@0.500000 6.00000000000000@0 -6.00000000000000@1.00000 "
            "-12.0000000000000@0 -12.0000000000000@0 "
            "3.46410161513775@0.211325 -3.46410161513775@0.788675"
        ),
    ),
]
"""max f', max and min f'', max and min f''', max and min f' f'', each with the least z that has it;
15 and 6 digits."""


PAIRS = ((0,), (1, 2), (1, 2), (3, 4), (3, 4), (5, 6), (5, 6))
"""Which of the seven extremes are of the same quantity."""


def assert_extremes(law: Law, expected: list[tuple[str, str]], value_limit: float) -> None:
    """Compare the characteristic values of `law` with max f', max and min f'', max and min of the
    jerk, max and min f' f'', each as value and place, half a unit of the last digit each.

    Where the law runs back, f' is a difference, and no value keeps more than what 1e-15 of the
    largest of its kind is.
    """
    found = characteristic(law)
    extremes = (
        found.velocity,
        found.largest_acceleration,
        found.least_acceleration,
        found.largest_jerk,
        found.least_jerk,
        found.largest_moment,
        found.least_moment,
    )
    largest = [max(abs(float(expected[k][0])) for k in pair) for pair in PAIRS]
    for extreme, (value, place), most in zip(extremes, expected, largest, strict=True):
        true = float(value)
        limit = value_limit * np.spacing(abs(true)) + half_a_unit(value)
        if found.least_velocity.value < 0.0:
            limit += 1e-15 * most
        assert abs(extreme.value - true) <= limit
        assert extreme.place == pytest.approx(
            float(place), abs=PLACE_LIMIT + half_a_unit(place), rel=0
        )


def half_a_unit(text: str) -> float:
    """Half a unit of the last digit of a decimal number; a bare 0 is exact."""
    mantissa, _, exponent = text.partition("e")
    digits = len(mantissa.partition(".")[2])
    return 0.5 * 10.0 ** (int(exponent or 0) - digits) if digits else 0.0


PLACE_LIMIT = 1e-14
"""A turning point comes from a closed form of a dozen roundings in z and 1 - z, or from a root that
Newton's method polished."""


@pytest.mark.parametrize(
    ("terms", "row"), TABLE, ids=[f"{name} {task} {p}" for (name, task, p), _ in TABLE]
)
def test_characteristic_values_and_places(
    terms: tuple[str, str, dict[str, float]], row: str
) -> None:
    name, task, parameters = terms
    cells = [cell.partition("@") for cell in row.split()]
    law = make_law(name, task, **parameters)
    assert_extremes(law, [(value, place) for value, _, place in cells], LIMIT)


@pytest.mark.parametrize("case", CASES, ids=[case["id"] for case in CASES])
def test_characteristic_values_are_the_extremes_of_the_reference(case: dict[str, Any]) -> None:
    extrema = case["extrema"]
    keys = ("f1", "max"), ("f2", "max"), ("f2", "min"), ("f3", "max"), ("f3", "min")
    cells = [extrema[key][end] for key, end in (*keys, ("P", "max"), ("P", "min"))]
    expected = [(cell["value"], cell["z"]) for cell in cells]
    assert_extremes(law_of(case), expected, LIMIT)
    found, true = characteristic(law_of(case)), float(extrema["f1"]["min"]["value"])
    # A difference of end velocity and what the acceleration takes off it.
    limit = 1e-15 * max(abs(found.velocity.value), abs(true))
    assert found.least_velocity.value == pytest.approx(true, abs=limit, rel=0)
