from __future__ import annotations

import math
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.numeric.interval import Angles, Interval

numbers = st.floats(-1e6, 1e6).filter(lambda x: x == 0.0 or abs(x) > 1e-60)
"""Large enough that no product underflows."""

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
    middle=st.floats(-50.0, 50.0),
    reach=st.one_of(st.floats(0.0, 8.0), st.floats(0.0, 1e-6)),
    share=st.floats(-1.0, 1.0),
)
def test_cosines_and_sines_hold(middle: float, reach: float, share: float) -> None:
    angles = Angles.from_middles(np.array([middle]), np.array([reach]))
    with mpmath.workdps(40):
        angle = mpmath.mpf(middle) + mpmath.mpf(share) * mpmath.mpf(reach)
        for found, exact in ((angles.cosine, mpmath.cos(angle)), (angles.sine, mpmath.sin(angle))):
            assert found.low[0] <= exact <= found.high[0]
            assert found.low[0] >= -1.0
            assert found.high[0] <= 1.0


@given(
    middles=st.tuples(st.floats(-9.0, 9.0), st.floats(-9.0, 9.0)),
    reaches=st.tuples(st.floats(0.0, 1.0), st.floats(0.0, 1.0)),
    shares=st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0)),
)
def test_differences_of_angles_hold(
    middles: tuple[float, float], reaches: tuple[float, float], shares: tuple[float, float]
) -> None:
    one, other = (
        Angles.from_middles(np.array([middle]), np.array([reach]))
        for middle, reach in zip(middles, reaches, strict=True)
    )
    with mpmath.workdps(40):
        first, second = (
            mpmath.mpf(middle) + mpmath.mpf(share) * mpmath.mpf(reach)
            for middle, reach, share in zip(middles, reaches, shares, strict=True)
        )
        found = one - other
        assert found.cosine.low[0] <= mpmath.cos(first - second) <= found.cosine.high[0]
        assert found.sine.low[0] <= mpmath.sin(first - second) <= found.sine.high[0]


def test_what_is_not_known_stays_unknown() -> None:
    unknown = interval(-math.inf, math.inf)
    nothing = interval(0.0, 0.0)
    for found in (unknown * nothing, interval(1.0, 2.0) / interval(-1.0, 1.0)):
        assert np.isinf(found.magnitude[0])
    for middle in (0.0, 1.0, 0.5 * math.pi):
        found = Angles.from_middles(np.array([middle]), np.array([math.inf])).cosine
        assert (found.low[0], found.high[0]) == (-1.0, 1.0)


def test_of_two_ranges_the_common_part_remains() -> None:
    found = interval(0.0, 2.0).intersection(interval(1.0, 3.0))
    assert (found.low[0], found.high[0]) == (1.0, 2.0)


@given(one=ranges(), other=ranges(), factor=numbers)
def test_results_are_no_wider_than_rounding_makes_them(
    one: tuple[float, float, float], other: tuple[float, float, float], factor: float
) -> None:
    """Each end is an exact end of the range of results, but for 2^-47 of its magnitude."""
    a, b = interval(*one[:2]), interval(*other[:2])
    ends, others = [Fraction(each) for each in one[:2]], [Fraction(each) for each in other[:2]]
    pairs = [(x, y) for x in ends for y in others]
    cases = [
        (a + b, [ends[0] + others[0], ends[1] + others[1]]),
        (a - b, [ends[0] - others[1], ends[1] - others[0]]),
        (-a, [-ends[1], -ends[0]]),
        (a * b, [x * y for x, y in pairs]),
        (a.scaled(factor), [x * Fraction(factor) for x in ends]),
        (
            a.squared(),
            [*(x * x for x in ends), *([Fraction(0)] if one[0] <= 0.0 <= one[1] else [])],
        ),
    ]
    if others[0] > 0 or others[1] < 0:
        cases.append((a / b, [x / y for x, y in pairs]))
        cases.append((b.inverse, [1 / y for y in others]))
    elif 0.0 in (b.low[0], b.high[0]) or b.low[0] < 0.0 < b.high[0]:
        assert (b.inverse.low[0], b.inverse.high[0]) == (-math.inf, math.inf)
    for found, exact in cases:
        least, most = float(min(exact)), float(max(exact))
        assert found.low[0] == pytest.approx(least, rel=2.0**-47, abs=5e-324)
        assert found.high[0] == pytest.approx(most, rel=2.0**-47, abs=5e-324)
    size = [abs(each) for each in one[:2]]
    assert a.magnitude[0] == max(size)
    assert a.mignitude[0] == (0.0 if one[0] <= 0.0 <= one[1] else min(size))


@pytest.mark.parametrize("reach", [3.9, 4.0, 4.1, 1e9])
def test_ranges_of_more_than_a_turn_are_all_of_it_and_no_more(reach: float) -> None:
    for middle in np.linspace(-3.0, 3.0, 13):
        angles = Angles.from_middles(np.array([middle]), np.array([reach]))
        for found in (angles.cosine, angles.sine):
            assert (found.low[0], found.high[0]) == (-1.0, 1.0)


def test_several_ranges_are_each_by_itself() -> None:
    """One that reaches 0 or is unknown leaves its neighbours as they are."""
    low, high = np.array([1.0, -1.0, -4.0, 0.0]), np.array([2.0, 1.0, -2.0, 3.0])
    found = Interval(low, high).inverse
    assert found.low == pytest.approx([0.5, -math.inf, -0.5, -math.inf], rel=1e-14)
    assert found.high == pytest.approx([1.0, math.inf, -0.25, math.inf], rel=1e-14)
    unknown = np.full(4, np.inf)
    product = Interval(low, high) * Interval(-unknown, unknown)
    assert np.all(product.low == -np.inf)
    assert np.all(product.high == np.inf)
    mixed = Interval(low, high) * Interval(np.zeros(4), np.array([1.0, np.inf, 1.0, np.inf]))
    assert mixed.low == pytest.approx([0.0, -math.inf, -4.0, -math.inf], rel=1e-14)
    assert mixed.high == pytest.approx([2.0, math.inf, 0.0, math.inf], rel=1e-14)


@given(middle=st.floats(-9.0, 9.0), reach=st.floats(1e-6, 0.5))
def test_ranges_of_cosines_and_sines_are_close(middle: float, reach: float) -> None:
    """Too wide by no more than the second order of the reach."""
    angles = Angles.from_middles(np.array([middle]), np.array([reach]))
    dense = middle + reach * np.linspace(-1.0, 1.0, 201)
    for found, values in ((angles.cosine, np.cos(dense)), (angles.sine, np.sin(dense))):
        assert found.low[0] >= np.min(values) - 0.5 * reach**2 - 1e-9
        assert found.high[0] <= np.max(values) + 0.5 * reach**2 + 1e-9
    both = angles - Angles.from_middles(np.array([0.3]), np.array([0.1]))
    assert both.reach[0] == pytest.approx(reach + 0.1, abs=1e-14)
    assert both.reaching(np.array([0.25])).reach.tolist() == [0.25]
    assert both.reaching(np.array([0.25])).cosine.low[0] <= math.cos(middle - 0.3)
