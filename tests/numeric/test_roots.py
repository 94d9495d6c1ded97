from __future__ import annotations

import math
from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.kinematics.laws.polynomials import bernstein, scaled_horner
from camgeo.numeric.arrays import FloatArray, IntArray
from camgeo.numeric.extremes import (
    MAX_STEPS,
    Function,
    bracketed_roots,
    derivative,
    horner,
    indexed_roots,
    inverse,
    largest_magnitude,
    product,
    roots_in_rows,
    roots_inside,
    roots_on_grid,
    sign_changes,
)
from tests.strategies import attack

ODD: dict[str, Callable[[FloatArray], FloatArray]] = {
    "straight": lambda x: x,
    "flat at the root": lambda x: x**9,
    "steep at the root": np.cbrt,
    "step": lambda x: np.where(x < 0.0, -1.0, 1.0),
    "saturated": lambda x: np.arctan(1e12 * x),
    "huge": lambda x: 1e300 * x,
}
"""Functions with a root at 0 and no other."""


@attack
@given(
    name=st.sampled_from(sorted(ODD)),
    root=st.floats(0.01, 6.28),
    below=st.floats(1e-6, 5.0),
    above=st.floats(1e-6, 5.0),
)
def test_roots_are_found_to_the_last_bits_whatever_the_function(
    name: str, root: float, below: float, above: float
) -> None:
    low, high = np.array([root - below]), np.array([root + above])
    (found,) = bracketed_roots(lambda x: ODD[name](x - root), low, high)
    # The bracket is closed to two neighbours; x**9 underflows to 0 within 1e-36 of the root.
    assert abs(found - root) <= 2.0 * math.ulp(root)
    assert low[0] <= found <= high[0]


@pytest.mark.parametrize(("low", "high"), [(0.0, 1.0), (-1.0, 0.0)])
def test_a_root_at_an_end_of_the_bracket(low: float, high: float) -> None:
    assert bracketed_roots(lambda x: x, np.array([low]), np.array([high])).tolist() == [0.0]


def test_values_of_the_function_are_left_as_they_are() -> None:
    def remembered(x: FloatArray) -> FloatArray:
        values = x**3 - x
        values.flags.writeable = False
        return values

    (found,) = bracketed_roots(remembered, np.array([0.4]), np.array([2.3]))
    assert abs(found - 1.0) <= 2.0 * math.ulp(1.0)


def test_no_brackets_have_no_roots() -> None:
    assert bracketed_roots(lambda x: x, np.empty(0), np.empty(0)).size == 0


def test_a_smooth_root_takes_few_evaluations_and_a_step_no_more_than_halving() -> None:
    def evaluations(function: Callable[[FloatArray], FloatArray]) -> int:
        calls = 0

        def counted(x: FloatArray) -> FloatArray:
            nonlocal calls
            calls += 1
            return function(x)

        bracketed_roots(counted, np.array([0.0]), np.array([2.0]))
        return calls

    assert evaluations(lambda x: np.cos(x)) <= 12
    # 53 halvings from 2 to its last bit; the method may take two steps for one of them.
    assert evaluations(lambda x: np.where(x < math.pi / 2, -1.0, 1.0)) <= 2 * 53
    assert MAX_STEPS > 2 * 53


def test_sign_changes_name_their_cells_and_zeros_once() -> None:
    grid = np.arange(8.0)
    low, high = sign_changes(grid, np.array([-1.0, 2.0, 0.0, 3.0, -4.0, 0.0, 0.0, 0.0]))
    assert low.tolist() == [0.0, 2.0, 3.0]
    assert high.tolist() == [1.0, 3.0, 4.0]
    low, high = sign_changes(grid[:3], np.array([2.0, 1.0, 0.0]))
    assert (low.tolist(), high.tolist()) == ([1.0], [2.0])


def test_all_roots_on_a_grid_ascending() -> None:
    grid = np.linspace(0.5, 20.0, 60)
    expected = [k * math.pi for k in range(1, 7)]
    # An ulp of 20, and what sin is off at its zero.
    assert roots_on_grid(np.sin, grid) == pytest.approx(expected, abs=8e-15)


@attack
@given(share=st.floats(0.0, 1.0), swing=st.floats(-0.999999, 0.999999))
def test_the_inverse_leads_back(share: float, swing: float) -> None:
    edges = np.array([0.0, 1.0, 2.5, 2.0 * math.pi])
    y = np.array([2.0 * math.pi * share])
    (x,) = inverse(lambda x: x + swing * np.sin(x), lambda x: 1.0 + swing * np.cos(x), edges, y)
    assert edges[0] <= x <= edges[-1]
    # Rounding of the function, and of x times the slope.
    assert abs(x + swing * math.sin(x) - y[0]) <= 8.0 * math.ulp(2.0 * math.pi)


def test_an_edge_is_found_as_it_is() -> None:
    edges = np.array([0.0, 0.1, 0.7, 1.0])
    assert inverse(np.exp, np.exp, edges, np.exp(edges)).tolist() == edges.tolist()


def test_a_flat_place_is_closed_in_on_by_halving() -> None:
    edges = np.array([-1.0, 1.0])
    y = np.array([1e-30, -1e-12, 0.5])
    got = inverse(lambda x: x**3, lambda x: np.maximum(3.0 * x * x, 1e-300), edges, y)
    assert got == pytest.approx([1e-10, -1e-4, 0.5 ** (1.0 / 3.0)], abs=1e-9)


def test_the_roots_of_several_quantities_are_those_of_each() -> None:
    """Their brackets are searched together, each for its own quantity."""
    grid = np.linspace(0.1, 7.0, 24).reshape(2, 12)
    each: tuple[Function, ...] = (np.sin, np.cos, lambda x: x - 10.0, lambda x: x * x - 4.0)
    alone = np.concatenate([roots_on_grid(function, grid) for function in each])
    together = roots_on_grid(lambda x: np.stack([function(x) for function in each]), grid)
    assert np.array_equal(together, alone)


def test_on_a_grid_no_place_is_evaluated_twice() -> None:
    asked: list[float] = []

    def remembered(x: FloatArray) -> FloatArray:
        asked.extend(x.tolist())
        return np.sin(x)

    roots_on_grid(remembered, np.linspace(0.5, 20.0, 60))
    assert len(set(asked)) == len(asked)


def test_each_bracket_has_its_own_function() -> None:
    """The numbers of the brackets go with the places, in any subset of them."""
    shifts = np.array([0.1, 5.5, 2.0, 3.3])
    powers = np.array([1, 3, 1, 9])

    def values(x: FloatArray, which: IntArray) -> FloatArray:
        return np.asarray((x - shifts[which]) ** powers[which])

    found = indexed_roots(values, np.full(4, -1.0), np.full(4, 6.0))
    assert found == pytest.approx(shifts, rel=4.0 * 2.0**-52)
    rows = np.array([1, 0])
    both = bracketed_roots(
        lambda x: np.stack((x - 1.0, x - 2.0)), np.zeros(2), np.full(2, 5.0), rows
    )
    assert both.tolist() == [2.0, 1.0]


def test_roots_along_rows_come_with_their_rows() -> None:
    """Waves of several shifts over grids of their own, against their closed roots."""
    shifts = np.array([0.2, 1.1, 2.9])
    grid = np.linspace([0.0, 1.0, 2.0], [6.0, 4.5, 9.0], 40, axis=1)
    values = np.sin(grid - shifts[:, np.newaxis])
    found, row = roots_in_rows(lambda x, which: np.sin(x - shifts[which]), grid, values)
    wanted = [
        (number, shift + k * math.pi)
        for number, shift in enumerate(shifts)
        for k in range(-4, 5)
        if grid[number, 0] < shift + k * math.pi < grid[number, -1]
    ]
    assert row.tolist() == [number for number, _ in wanted]
    assert found == pytest.approx([place for _, place in wanted], abs=8e-15)
    # One grid for two layers of rows: rows are counted over all layers.
    layers = np.stack((values[:, :], -values[::-1]))
    again, rows = roots_in_rows(
        lambda x, which: np.where(which < 3, 1.0, -1.0) * np.sin(
            x - np.where(which < 3, shifts[which % 3], shifts[2 - which % 3])
        ),
        np.stack((grid, grid[::-1])),
        layers,
    )  # fmt: skip
    assert again[rows < 3] == pytest.approx(found, abs=8e-15)
    assert sorted(again[rows >= 3]) == pytest.approx(sorted(found), abs=8e-15)
    assert set(rows) == {0, 1, 2, 3, 4, 5}


def test_zeros_on_the_grid_are_found_once_in_each_row() -> None:
    grid = np.array([0.0, 1.0, 2.0, 3.0])
    for root in (0.0, 1.0, 2.0, 3.0):
        found = roots_on_grid(lambda x, root=root: x - root, grid)  # type: ignore[misc]  # bound at once
        assert found.tolist() == [root]
    low, high = sign_changes(grid, np.array([[0.0, 1.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0]])[0])
    assert (low.tolist(), high.tolist()) == ([0.0], [1.0])
    assert sign_changes(grid, np.array([1.0, -1.0, -1.0, 0.0]))[0].tolist() == [0.0, 2.0]


@pytest.mark.parametrize(
    ("name", "function", "slope", "undone"),
    [
        ("arc", lambda x: np.arctan(200.0 * x), lambda x: 200.0 / (1.0 + 4e4 * x * x),
         lambda y: math.tan(y) / 200.0),
        ("step", lambda x: np.tanh(60.0 * x), lambda x: 60.0 / np.cosh(60.0 * x) ** 2,
         lambda y: math.atanh(y) / 60.0),
        ("flat", lambda x: x**7, lambda x: 7.0 * x**6 + 1e-300,
         lambda y: math.copysign(abs(y) ** (1.0 / 7.0), y)),
    ],
)  # fmt: skip
def test_the_inverse_stays_in_its_bracket_where_newton_would_leave_it(
    name: str, function: Function, slope: Function, undone: Callable[[float], float]
) -> None:
    """Closed inverses; nothing is asked for beyond the edges, and no more than halving takes."""
    edges = np.array([-0.9, -0.3, 0.95])
    ends = function(edges[[0, -1]])
    y = np.clip(np.linspace(ends[0], ends[1], 41) * 0.999 + 1e-4, ends[0], ends[1])
    calls = 0

    def counted(x: FloatArray) -> FloatArray:
        nonlocal calls
        calls += 1
        assert np.all((x >= edges[0]) & (x <= edges[-1]))
        return function(x)

    found = inverse(counted, slope, edges, y)
    miss = np.abs(found - [undone(float(each)) for each in y])
    # Rounding of y over the slope, and that of the range; x^7 is flat to an eps at 0.
    loose = 4.0 * np.spacing(np.abs(y) + 1e-3) / np.maximum(slope(found), 1e-9)
    assert np.all(miss <= 1e-14 + loose)
    assert calls <= 70, name


# Polynomials -----------------------------------------------------------------------------------

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
    assert exactly(product(powers, powers), x) == exactly(powers, x) ** 2


@given(powers=coefficients)
def test_nothing_is_larger_than_the_largest(powers: list[float]) -> None:
    found = largest_magnitude(powers, 0.0, 0.7)
    dense = float(np.max(np.abs(horner(powers, np.linspace(0.0, 0.7, 2001)))))
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
