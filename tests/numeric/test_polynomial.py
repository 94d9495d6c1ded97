from __future__ import annotations

import math
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.numeric.extremes import (
    bernstein,
    derivative,
    horner,
    largest_magnitude,
    product,
    roots_inside,
    scaled_horner,
)

EPS = 2.0**-52

coefficients = st.lists(st.integers(-50, 50).map(float), min_size=2, max_size=8)


def exactly(powers: list[float], x: float) -> Fraction:
    return sum((Fraction(c) * Fraction(x) ** k for k, c in enumerate(powers)), Fraction(0))


@given(powers=coefficients, x=st.floats(0.0, 1.0))
def test_horner_and_bernstein_give_the_value(powers: list[float], x: float) -> None:
    """To a few roundings of the terms: 2 n for Horner's form, n for each power in Bernstein's."""
    true = float(exactly(powers, x))
    place = np.array([x])
    size = sum(abs(c) * x**k for k, c in enumerate(powers))
    degree = len(powers) - 1
    assert horner(powers, place)[0] == pytest.approx(true, abs=2 * degree * EPS * size + 1e-300)
    form = bernstein([Fraction(c) for c in powers])
    terms = sum(abs(c) * x**i * (1.0 - x) ** (degree - i) for i, c in enumerate(form))
    ends = (place, 1.0 - place)
    found = scaled_horner(form, *ends) if x <= 0.5 else scaled_horner(form[::-1], *ends[::-1])
    limit = (3 * degree + 3) * EPS * terms + 1e-300
    assert found[0] == pytest.approx(true, abs=limit)


def test_bernstein_keeps_the_digits_where_powers_cancel() -> None:
    """(1 - z)^7 near z = 1, whose powers leave nothing of it."""
    powers = [(-1) ** k * math.comb(7, k) for k in range(8)]
    form = bernstein([Fraction(c) for c in powers])
    w = np.array([1e-3])
    z = 1.0 - w
    assert scaled_horner(form[::-1], w, z)[0] == pytest.approx(1e-21, rel=16 * EPS)
    assert abs(horner([float(c) for c in powers], z)[0] - 1e-21) > 1e-19


def test_many_polynomials_at_once_are_each_by_itself() -> None:
    rng = np.random.default_rng(4)
    x, powers = rng.uniform(0.0, 1.0, 7), rng.uniform(-1.0, 1.0, (6, 7))
    of_each = horner(powers, x)
    together = horner(powers[:, :, np.newaxis], x)
    for number, own in enumerate(powers.T):
        assert of_each[number] == horner(own.tolist(), x)[number]
        assert np.array_equal(together[number], horner(own.tolist(), x))


@given(powers=coefficients)
def test_derivative_and_product(powers: list[float]) -> None:
    x = 0.375
    slope = sum(
        (k * Fraction(c) * Fraction(x) ** (k - 1) for k, c in enumerate(powers) if k), Fraction(0)
    )
    assert float(exactly(derivative(powers), x)) == float(slope)
    square = product(powers, powers)
    assert exactly(square, x) == exactly(powers, x) ** 2


@given(powers=coefficients)
def test_nothing_is_larger_than_the_largest(powers: list[float]) -> None:
    found = largest_magnitude(powers, 0.0, 0.7)
    x = np.linspace(0.0, 0.7, 2001)
    dense = float(np.max(np.abs(horner(powers, x))))
    size = sum(abs(c) for c in powers)
    assert dense <= found + 16 * EPS * size
    second = sum(k * (k - 1) * abs(c) for k, c in enumerate(powers))
    assert found <= dense + second * (0.7 / 2000.0) ** 2 / 8.0 + 1e-11 * size


@given(
    roots=st.lists(st.integers(-30, 30), min_size=1, max_size=5, unique=True),
    low=st.integers(-35, 20),
    width=st.integers(1, 30),
    scale=st.sampled_from([1.0, -1e-8, 3e9]),
)
def test_the_roots_in_a_range_are_those_in_it(
    roots: list[int], low: int, width: int, scale: float
) -> None:
    """Of a range that begins and ends between whole numbers, and of one that begins at a root."""
    powers = [scale]
    for root in roots:
        powers = product(powers, [-float(root), 1.0])
    ends = low + 0.25, low + width + 0.25
    wanted = sorted(root for root in roots if ends[0] < root < ends[1])
    found = roots_inside(powers, *ends)
    assert found == pytest.approx(wanted, abs=1e-6)
    assert np.all(np.diff(found) > 0.0)
    # Twice, and beside a factor without a real root, with coefficients that vanish.
    square = product(powers, [2.0, 0.0, 1.0])
    assert roots_inside(square, *ends) == pytest.approx(wanted, abs=1e-6)
    tiny = [*powers, 1e-60 * scale, -1e-55 * scale]
    assert roots_inside(tiny, *ends) == pytest.approx(wanted, abs=1e-6)


def test_a_double_root_is_a_root() -> None:
    powers = product([0.25, -1.0, 1.0], [3.0, 1.0])
    found = roots_inside(powers, 0.0, 1.0)
    assert len(found) >= 1
    assert found == pytest.approx(np.full(len(found), 0.5), abs=1e-6)
    assert largest_magnitude(powers, 0.0, 1.0) == pytest.approx(1.0, rel=1e-11)
    assert largest_magnitude(powers, 0.0, 1.0) >= 1.0
    assert largest_magnitude([0.0, 0.0, -3.0], -2.0, 1.0) == pytest.approx(12.0, rel=1e-11)
    assert largest_magnitude([5.0], 0.0, 1.0) == pytest.approx(5.0, rel=1e-11)


@given(powers=st.lists(st.decimals(-9, 9, places=40), min_size=1, max_size=6))
def test_bernstein_rounds_exact_coefficients_once(powers: list[Decimal]) -> None:
    """c_i = sum of C(n - k, i - k) a_k over k, with more digits than a double has."""
    n = len(powers) - 1
    exact = [
        sum(
            (math.comb(n - k, i - k) * Fraction(powers[k]) for k in range(i + 1)),
            Fraction(0),
        )
        for i in range(n + 1)
    ]
    assert bernstein(powers) == tuple(map(float, exact))
