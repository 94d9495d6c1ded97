from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.numeric.interval import Interval, about, cosine, sine

numbers = st.floats(-1e6, 1e6).filter(lambda x: x == 0.0 or abs(x) > 1e-60)
"""Not so small that a product underflows."""

shares = st.floats(0.0, 1.0)


@st.composite
def ranges(draw: st.DrawFn) -> tuple[float, float, float]:
    """Both ends of a range, and a number in it."""
    low, high = sorted((draw(numbers), draw(numbers)))
    return low, high, min(max(low + draw(shares) * (high - low), low), high)


def interval(low: float, high: float) -> Interval:
    return Interval(np.array([low]), np.array([high]))


def holds(found: Interval, exact: Fraction) -> bool:
    return bool(found.low[0] <= exact <= found.high[0])


@given(one=ranges(), other=ranges(), factor=numbers)
def test_results_hold_for_all_exact_numbers_of_the_ranges(
    one: tuple[float, float, float], other: tuple[float, float, float], factor: float
) -> None:
    a, b = interval(*one[:2]), interval(*other[:2])
    x, y = Fraction(one[2]), Fraction(other[2])
    assert holds(a + b, x + y)
    assert holds(a - b, x - y)
    assert holds(-a, -x)
    assert holds(a * b, x * y)
    assert holds(a.squared(), x * x)
    assert a.squared().low[0] >= 0.0
    assert holds(a.scaled(factor), x * Fraction(factor))
    assert a.mignitude[0] <= abs(x) <= a.magnitude[0]
    if y:
        assert holds(a / b, x / y)


@given(
    low=st.floats(-50.0, 50.0),
    wide=st.floats(0.0, 8.0),
    share=shares,
    pair=st.sampled_from(((cosine, mpmath.cos), (sine, mpmath.sin))),
)
def test_cosines_and_sines_hold(
    low: float,
    wide: float,
    share: float,
    pair: tuple[Callable[[Interval], Interval], Callable[[float], mpmath.mpf]],
) -> None:
    of_range, exact = pair
    found = of_range(interval(low, low + wide))
    with mpmath.workdps(40):
        value = exact(mpmath.mpf(min(low + share * wide, low + wide)))
        assert found.low[0] <= value <= found.high[0]
    assert found.low[0] >= -1.0
    assert found.high[0] <= 1.0


def test_ranges_of_cosines_are_as_narrow_as_they_can_be() -> None:
    found = cosine(interval(-0.5, 1.0))
    assert found.high[0] == 1.0
    assert found.low[0] == pytest.approx(math.cos(1.0), rel=1e-14)
    found = sine(interval(math.pi, 2.0 * math.pi))
    assert found.low[0] == -1.0
    assert found.high[0] == pytest.approx(0.0, abs=1e-14)


def test_what_is_not_known_stays_unknown() -> None:
    unknown = interval(-math.inf, math.inf)
    nothing = interval(0.0, 0.0)
    for found in (unknown * nothing, interval(1.0, 2.0) / interval(-1.0, 1.0)):
        assert np.isinf(found.magnitude[0])
    found = cosine(unknown)
    assert (found.low[0], found.high[0]) == (-1.0, 1.0)
    assert about(np.array([1.0]), np.array([math.inf])).magnitude[0] == math.inf


def test_of_two_ranges_the_common_part_remains() -> None:
    found = interval(0.0, 2.0).within(interval(1.0, 3.0))
    assert (found.low[0], found.high[0]) == (1.0, 2.0)
