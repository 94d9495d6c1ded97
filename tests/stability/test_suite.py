"""The suite: every case is as accurate as doubles allow, and a bad algorithm is detected."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from mpmath import mp

from camgeo.errors import GeometryError
from camgeo.numeric.arrays import ComplexArray, FloatArray
from tests.reference import reference
from tests.stability import cams
from tests.stability.cam_case import CamSpec, cases_of
from tests.stability.measure import Case, Reading, measure
from tests.stability.quick import CASES, quick
from tests.stability.suite import GROUPS, LIMIT, table


def spec(name: str) -> CamSpec:
    return next(each for each in cams.specs() if each.name == name)


@pytest.mark.parametrize("group", GROUPS)
def test_no_digits_are_lost_that_the_inputs_have(group: str) -> None:
    readings = [each for each in quick() if each.group == group]
    assert readings
    poor = [each for each in readings if each.ratio > LIMIT]
    assert poor == []


@pytest.mark.parametrize("name", ["HC01", "HC02", "HC03", "HC04", "HC05", "HC06", "HC11", "HC12",
                                  "HC13", "HC14", "HC15", "HC17", "HC18", "HC19", "HC20b", "HC21b",
                                  "HC21c", "HC22", "HC22b", "HC23", "HC26", "HC27",
                                  "HC28"])  # fmt: skip
def test_the_hard_cases_are_among_them(name: str) -> None:
    assert any(case.name.startswith(name) for case in CASES)
    assert name in {case["id"] for case in reference("hard_cases.json")}


# A bad algorithm is seen --------------------------------------------------------------------------


def worsened(name: str, quantity: str, bad: FloatArray | ComplexArray) -> list[Reading]:
    """Readings of a quantity of a cam's rise with other values for it."""
    (case, *_) = cases_of(spec(name))
    index = case.quantities.index(quantity)

    def found(phi: FloatArray) -> tuple[FloatArray | ComplexArray, ...]:
        columns = list(case.found(phi))
        columns[index] = bad
        return tuple(columns)

    return [each for each in measure(replace(case, found=found)) if each.quantity == quantity]


def largest_ratio(name: str, quantity: str, bad: FloatArray | ComplexArray) -> float:
    return max(each.ratio for each in worsened(name, quantity, bad))


def test_an_angle_by_its_cosine_is_seen() -> None:
    """HC12: acos of the scalar product is off by 1e-8 near 90 degrees less mu = 0."""
    name, quantity = "HC12 huge base circle", "pressure angle"
    curve, phi = spec(name).curve, np.array(cases_of(spec(name))[0].places)
    relative = curve.relative_jet(phi, order=1)
    bad = np.arccos(np.minimum(np.abs(relative.u) / curve.speed(relative), 1.0))
    assert largest_ratio(name, quantity, curve.pressure_angle(phi)) <= LIMIT
    assert largest_ratio(name, quantity, bad) > 1e3 * LIMIT


# What is run and reported -------------------------------------------------------------------------


def made_up(quantity: str, case: str, error: float, conditioning: float) -> Reading:
    return Reading(quantity, "cams", case, 1.0, 1.0, error, conditioning)


def test_the_table_has_the_largest_ratio_first() -> None:
    readings = [
        made_up("a", "x", 100.0, 200.0),
        made_up("a", "y", 3.0, 0.1),
        made_up("b", "x", math.inf, 1.0),
        made_up("c", "x", 0.0, 0.0),
    ]
    b, a, c = table(readings)
    assert (b.quantity, b.within_limit) == ("b", False)
    assert (a.largest_error.case, a.largest_ratio.case) == ("x", "y")
    assert (a.count, a.within_limit) == (2, True)
    assert c.largest_ratio.ratio == 0.0


# The measure itself, on numbers whose error and conditioning are known -------------------------

Found = Callable[[FloatArray], FloatArray | ComplexArray]


def reading(found: Found, exact: Callable[..., Any], place: float, *parameters: float) -> Reading:
    def both(places: FloatArray) -> tuple[FloatArray | ComplexArray]:
        return (found(places),)

    case = Case("laws", "known", ("value",), (place,), parameters, both, lambda *x: (exact(*x),))
    (only,) = measure(case)
    return only


def refuse(_: FloatArray) -> FloatArray:
    raise GeometryError("no such cam")


def up_to_one(x: Any) -> Any:
    if x > 1:
        raise GeometryError("beyond 1")
    return x


BESIDE_ONE = 1.0 + 2.0**-20

OFF = 3.0 + 4.0j + 2.0j * math.ulp(5.0)


@pytest.mark.parametrize(
    ("found", "exact", "inputs", "error", "conditioning"),
    [
        # A double off by whole steps between neighbours: half an ulp moves it by half an ulp.
        *(
            (lambda x, k=k: x + k * np.spacing(x), lambda x: x, (place,), k, 0.5)
            for k in (0, 1, 3)
            for place in (1.0, 1.9, 3e-300, 1e200)
        ),
        # x - 1 beside 1: half of 2^-52 against 2^-20 * 2^-52, twice: 2^20 ulp for x and 1.
        (lambda x: x - 1.0, lambda x, one: x - one, (BESIDE_ONE, 1.0), 0.0, 2.0**20),
        # A vector is measured by its length, 5.
        (lambda _: np.array([OFF]), lambda x: x * (3 + 4j), (1.0,), 2.0, 0.625),
        (refuse, lambda x: x, (1.0,), math.inf, 0.5),
        # At an end of its range an input moves the other way.
        (lambda x: x, up_to_one, (1.0,), 0.0, 0.5),
    ],
)
def test_errors_and_conditioning_that_are_known(
    found: Found, exact: Any, inputs: tuple[float, ...], error: float, conditioning: float
) -> None:
    known = reading(found, exact, *inputs)
    assert (known.error, known.conditioning) == (error, conditioning)
    assert known.ratio == error / max(1.0, conditioning)
    assert known.value == float(abs(exact(*inputs)))


def test_where_a_value_passes_zero_the_yardstick_is_what_the_inputs_leave() -> None:
    """sin at the double next to pi: no ulp of 1.2e-16 is meant, but none of 2.2e-16 either."""
    known = reading(lambda x: np.zeros(1), mp.sin, math.pi)
    left = math.ulp(math.pi) / 2.0
    assert known.error == pytest.approx(math.sin(math.pi) / math.ulp(left))
    assert known.ratio == pytest.approx(math.sin(math.pi) / left, rel=1e-9)
    assert known.ratio < 1.0


def test_an_input_without_room_is_reported() -> None:
    def only_one(x: Any) -> Any:
        if x != 1:
            raise GeometryError("not 1")
        return x

    with pytest.raises(GeometryError, match=r"known: no value of input 0 near 1\.0"):
        reading(lambda x: x, only_one, 1.0)
