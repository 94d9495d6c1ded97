"""Integrals over smooth pieces compared with known ones, and their error estimates."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.quadrature import (
    MOST_HALVINGS,
    NODES,
    Integral,
    gauss,
    nodes_for_singularity,
    piecewise_integral,
)

EPS = float(np.finfo(np.float64).eps)

ROUNDING = 16.0 * EPS
"""Of the sum of `NODES` products, each of a weight and a value of a few roundings, as a share of
the integral of the magnitude."""

MOST_VALUES = 1_000_000
"""More values than any integral here has a use for: what is asked for more never ends."""

some = settings(deadline=None)


def integral(
    function: Callable[[FloatArray], FloatArray], edges: list[float], tolerance: float
) -> Integral:
    """The integral, of a function that refuses to be asked without end."""
    asked = 0

    def counted(x: FloatArray) -> FloatArray:
        nonlocal asked
        asked += len(x)
        assert asked <= MOST_VALUES, "halved without end"
        return function(x)

    return piecewise_integral(counted, np.array(edges), tolerance)


def exact(coefficients: list[float], low: float, high: float) -> Fraction:
    """The integral of the polynomial, lowest power first, without rounding."""
    a, b = Fraction(low), Fraction(high)
    terms = enumerate(coefficients, start=1)
    return sum((Fraction(c) * (b**k - a**k) / k for k, c in terms), Fraction(0))


@given(
    coefficients=st.lists(st.floats(-10.0, 10.0), min_size=1, max_size=2 * NODES),
    low=st.floats(-1.0, 0.0),
    high=st.floats(0.1, 1.0),
)
@some
def test_polynomials_up_to_degree_31(coefficients: list[float], low: float, high: float) -> None:
    """Gauss's rule of n nodes is exact for them (Abramowitz and Stegun 25.4.29): nothing but
    rounding is left.
    """
    found = integral(np.polynomial.Polynomial(coefficients), [low, high], 1e-3)
    # All values are sums of the terms, so rounding goes by these; twice as many of it by Horner.
    largest = sum(abs(c) * max(-low, high) ** k for k, c in enumerate(coefficients))
    bound = 2.0 * len(coefficients) * ROUNDING * largest * (high - low)
    assert abs(found.value - float(exact(coefficients, low, high))) <= bound + 1e-300


def test_degree_32_is_the_first_that_is_not() -> None:
    """The rule's error for x^32 on [-1, 1] is 2^33 (16!)^4 / (33 (32!)^2), by the same equation."""
    f = math.factorial
    error = Fraction(2**33 * f(16) ** 4, 33 * f(32) ** 2)
    once = integral(lambda x: x**32, [-1.0, 1.0], 1.0)
    # On halves the error of each is 2^-33 of it; the change by the halving is reported.
    assert once.error == pytest.approx(float(error), rel=1e-3)
    assert once.value == pytest.approx(2.0 / 33.0, rel=1e-14)


POWERS: list[tuple[str, Callable[[FloatArray], FloatArray], float, float]] = [
    ("sqrt", np.sqrt, 2.0 / 3.0, 2.0 / 3.0),
    ("x^(1/10)", lambda x: x**0.1, 1.0 / 1.1, 1.0 / 1.1),
    ("x^1.5", lambda x: x**1.5, 0.4, 0.4),
    ("log", np.log, -1.0, 1.0),
]
"""Singular at an edge: function on [0, 1], its integral and that of its magnitude."""

INNER: list[tuple[str, Callable[[FloatArray], FloatArray], float, float]] = [
    ("abs", lambda x: np.abs(x - 1.0 / 3.0), 5.0 / 18.0, 5.0 / 18.0),
    ("abs off centre", lambda x: np.abs(x - 0.1), 0.41, 0.41),
    ("kinked", lambda x: np.maximum(x - 1.0 / math.pi, 0.0), 0.5 * (1.0 - 1.0 / math.pi) ** 2,
     0.5 * (1.0 - 1.0 / math.pi) ** 2),
    ("step", lambda x: np.where(x < 0.3, -1.0, 2.0), 1.1, 1.7),
    ("root of abs", lambda x: np.sqrt(np.abs(x - 0.2)), (0.2**1.5 + 0.8**1.5) / 1.5,
     (0.2**1.5 + 0.8**1.5) / 1.5),
]  # fmt: skip
"""The same, singular within, where edges should be: what a rule leaves of it is up to chance."""

REST = 30.0 * 2.0 ** (1 - MOST_HALVINGS)
"""The magnitude of any of them over a piece that is halved no more; |log| has 28 as its mean."""


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12])
@pytest.mark.parametrize(
    ("function", "expected", "magnitude"),
    [case[1:] for case in (*POWERS, *INNER)],
    ids=[case[0] for case in (*POWERS, *INNER)],
)
def test_singular_functions_meet_the_tolerance(
    function: Callable[[FloatArray], FloatArray],
    expected: float,
    magnitude: float,
    tolerance: float,
) -> None:
    found = integral(function, [0.0, 1.0], tolerance)
    assert abs(found.value - expected) <= (tolerance + ROUNDING) * magnitude
    # The reported error keeps to the tolerance too, except for a piece that was halved to nothing.
    # The rule finds the magnitude itself to 1 % only where it is loose.
    assert found.error <= 1.01 * tolerance * magnitude + EPS * magnitude + REST


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12])
@pytest.mark.parametrize(
    ("function", "expected", "magnitude"),
    [case[1:] for case in POWERS],
    ids=[case[0] for case in POWERS],
)
def test_the_error_estimate_of_a_power_holds(
    function: Callable[[FloatArray], FloatArray],
    expected: float,
    magnitude: float,
    tolerance: float,
) -> None:
    """Each halving leaves 2^-(1 + p) of the error that x^p makes: what is left is 1/(2^(1 + p) - 1)
    of the change, all of it for the logarithm, p = 0.
    """
    found = integral(function, [0.0, 1.0], tolerance)
    assert abs(found.value - expected) <= found.error + ROUNDING * magnitude


@pytest.mark.parametrize("power", [-0.5, -0.8, -0.9])
def test_what_is_halved_no_more_counts_as_error(power: float) -> None:
    """The last cell at 0 has the width h = 2^-40 and the integral h^(1 + p)/(1 + p)."""
    found = integral(lambda x: np.abs(x) ** power, [0.0, 1.0], 1e-12)
    missing = 1.0 / (1.0 + power) - found.value
    last = 2.0 ** (-MOST_HALVINGS * (1.0 + power)) / (1.0 + power)
    assert 0.0 < missing < last
    assert missing < found.error < 4.0 * last


@given(
    rate=st.floats(-30.0, 30.0),
    wave=st.floats(0.0, 60.0),
    tolerance=st.floats(1e-12, 1e-2),
    cuts=st.lists(st.floats(0.01, 0.99), max_size=4),
)
@some
def test_the_error_estimate_holds(
    rate: float, wave: float, tolerance: float, cuts: list[float]
) -> None:
    """Of Re exp((rate + i wave) x), whose integral is known; waves up to ten on the interval."""
    z = complex(rate, wave)
    edges = sorted({0.0, *cuts, 1.0})
    found = integral(lambda x: np.exp(rate * x) * np.cos(wave * x), edges, tolerance)
    # (e^z - 1)/z by its series where the difference would cancel.
    expected = (np.expm1(z) / z).real if abs(z) > 1e-3 else (1.0 + z / 2.0 + z * z / 6.0).real
    magnitude = math.expm1(rate) / rate if abs(rate) > 1e-9 else 1.0
    off = abs(found.value - expected)
    # exp and cos of arguments up to 30 and 60 have that many roundings, as has e^z.
    rounding = (4.0 + abs(z)) * EPS * magnitude + ROUNDING * magnitude
    series = abs(z) ** 3 / 24.0 if abs(z) <= 1e-3 else 0.0
    assert off <= found.error + rounding + series
    assert found.error >= 0.0


@given(width=st.floats(1e-6, 1.0), tolerance=st.floats(1e-13, 1e-3))
@some
def test_a_tall_peak_is_followed_to_its_rounding(width: float, tolerance: float) -> None:
    """Its values are many times the mean: their rounding can exceed the tolerance there.

    1/(x^2 + w^2) has the integral 2 atan(1/w)/w over [-1, 1], and all of it is positive.
    """
    found = integral(lambda x: 1.0 / (x * x + width * width), [-1.0, 0.0, 1.0], tolerance)
    expected = 2.0 * math.atan2(1.0, width) / width
    assert abs(found.value - expected) <= found.error + ROUNDING * expected
    assert (
        0.9 * EPS * expected <= found.error <= 1.01 * tolerance * expected + 256.0 * EPS * expected
    )


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-9])
def test_a_peak_on_a_node_does_not_pass_for_all_there_is(tolerance: float) -> None:
    """The first pass then takes the integral for a hundred thousand times as large."""
    node, width = float(np.polynomial.legendre.leggauss(NODES)[0][3]), 1e-6
    found = integral(lambda x: 1.0 / ((x - node) ** 2 + width**2), [-1.0, 1.0], tolerance)
    expected = (math.atan((1.0 - node) / width) + math.atan((1.0 + node) / width)) / width
    # x - node near the node is rounded: half a digit of 0.6 in a peak 1e-6 wide.
    assert found.value == pytest.approx(expected, rel=tolerance + EPS / width)


@pytest.mark.parametrize("noise", [1e-12, 1e-9, 1e-6])
def test_noise_beyond_the_tolerance_ends_and_is_reported(noise: float) -> None:
    """As with forces that are small differences of large ones."""

    def rough(x: FloatArray) -> FloatArray:
        return np.sin(5.0 * x) + noise * np.sin(3e15 * x)

    found = integral(rough, [0.0, 1.0], 1e-14)
    expected = (1.0 - math.cos(5.0)) / 5.0
    assert abs(found.value - expected) <= noise
    assert 1e-14 < found.error <= 4.0 * noise


def test_zero_and_cancelling_integrals() -> None:
    assert integral(np.zeros_like, [0.0, 1.0, 2.0], 1e-9) == Integral(0.0, 0.0, 0.0)
    # The tolerance is of the magnitude, not of an integral that vanishes.
    assert abs(integral(np.sin, [-1.0, 1.0], 1e-12).value) <= ROUNDING * 2.0 * (1.0 - math.cos(1.0))


def test_pieces_add_up_and_jumps_at_edges_cost_nothing() -> None:
    calls: list[int] = []

    def stairs(x: FloatArray) -> FloatArray:
        calls.append(len(x))
        return np.floor(x) + 0.0 * x

    found = piecewise_integral(stairs, np.arange(6.0), 1e-12)
    assert found.value == pytest.approx(10.0, rel=ROUNDING)
    # The rule on each piece and on its halves, and no more.
    assert calls == [5 * NODES, 10 * NODES]


@pytest.mark.parametrize("place", [-1.02, -1.5, -3.0, -30.0])
def test_nodes_for_a_root_that_branches_outside(place: float) -> None:
    """Integral of the root of x - place over [-1, 1], to rounding."""
    places, half, weights = gauss(np.array([-1.0]), np.array([1.0]), nodes_for_singularity(place))
    found = float(half[0] * (np.sqrt(places[0] - place) @ weights))
    wanted = 2.0 / 3.0 * ((1.0 - place) ** 1.5 - (-1.0 - place) ** 1.5)
    assert found == pytest.approx(wanted, rel=128.0 * EPS)
