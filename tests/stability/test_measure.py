"""The measure itself, on numbers whose error and conditioning are known."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from mpmath import mp

from camgeo.errors import GeometryError
from camgeo.numeric.arrays import ComplexArray, FloatArray
from tests.stability.measure import Case, Reading, measure

Found = Callable[[FloatArray], FloatArray | ComplexArray]


def reading(found: Found, exact: Callable[..., Any], place: float, *parameters: float) -> Reading:
    def both(places: FloatArray) -> tuple[FloatArray | ComplexArray]:
        return (found(places),)

    case = Case("laws", "known", ("value",), (place,), parameters, both, lambda *x: (exact(*x),))
    (only,) = measure(case)
    return only


@pytest.mark.parametrize("steps", [0, 1, 3])
@pytest.mark.parametrize("place", [1.0, 1.9, 3e-300, 1e200])
def test_an_error_of_some_ulp(steps: int, place: float) -> None:
    """A double that is its own exact value, off by whole steps between neighbours."""
    off = place + steps * math.ulp(place)
    known = reading(lambda _: np.array([off]), lambda x: x, place)
    assert known.error == steps
    # Half an ulp of the only input moves it by half an ulp.
    assert known.conditioning == 0.5
    assert known.ratio == steps
    assert known.value == place


def test_a_difference_is_as_badly_conditioned_as_it_cancels() -> None:
    """x - 1 at x = 1 + 2^-20: half of 2^-52 against 2^-20 * 2^-52, twice: 2^20 ulp for x and 1."""
    place = 1.0 + 2.0**-20
    known = reading(lambda x: x - 1.0, lambda x, one: x - one, place, 1.0)
    assert known.error == 0.0
    assert known.conditioning == 2.0**20


def test_where_a_value_passes_zero_the_yardstick_is_what_the_inputs_leave() -> None:
    """sin at the double next to pi: no ulp of 1.2e-16 is meant, but none of 2.2e-16 either."""
    known = reading(lambda x: np.zeros(1), _sine, math.pi)
    left = math.ulp(math.pi) / 2.0
    assert known.error == pytest.approx(math.sin(math.pi) / math.ulp(left))
    assert known.ratio == pytest.approx(math.sin(math.pi) / left, rel=1e-9)
    assert known.ratio < 1.0


def _sine(x: Any) -> Any:
    return mp.sin(x)


def test_a_vector_is_measured_by_its_length() -> None:
    found = np.array([3.0 + 4.0j + math.ulp(5.0) * 2.0j])
    known = reading(lambda _: found, lambda x: x * (3 + 4j), 1.0)
    assert known.error == 2.0
    assert known.value == 5.0


def test_a_refusal_is_an_infinite_error() -> None:
    def refuse(_: FloatArray) -> FloatArray:
        raise GeometryError("no such cam")

    assert reading(refuse, lambda x: x, 1.0).error == math.inf


def test_at_an_end_of_its_range_an_input_moves_the_other_way() -> None:
    def up_to_one(x: Any) -> Any:
        if x > 1:
            raise GeometryError("beyond 1")
        return x

    assert reading(lambda x: x, up_to_one, 1.0).conditioning == 0.5


def test_an_input_without_room_is_reported() -> None:
    def only_one(x: Any) -> Any:
        if x != 1:
            raise GeometryError("not 1")
        return x

    with pytest.raises(GeometryError, match=r"known: no value of input 0 near 1\.0"):
        reading(lambda x: x, only_one, 1.0)
