"""Taylor arithmetic against mpmath's own Taylor expansion."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from mpmath import mp, mpc, mpf

from tests.stability.series import (
    Series,
    cosine,
    direction,
    exponential,
    logarithm,
    root,
    sine,
    variable,
)

TERMS = 5

DIGITS = 50


def inner(t: Any) -> Any:
    """A real function that is nowhere zero near 0, with all derivatives."""
    return mpf(2) + 3 * t - t**2 / 7 + t**3


def inner_series() -> Series:
    t = variable(mpf(0), 1, TERMS)
    return 2 + 3 * t - t**2 / 7 + t**3


FUNCTIONS: list[tuple[str, Callable[[Series], Series], Callable[[Any], Any]]] = [
    ("sum", lambda x: x + x * 2 - 1, lambda x: 3 * x - 1),
    ("less", lambda x: 5 - x, lambda x: 5 - x),
    ("product", lambda x: x * (x + 1), lambda x: x * (x + 1)),
    ("power", lambda x: x**4, lambda x: x**4),
    ("quotient", lambda x: (x - 1) / (x * x), lambda x: (x - 1) / x**2),
    ("root", root, mp.sqrt),
    ("exponential", exponential, mp.exp),
    ("logarithm", logarithm, mp.log),
    ("sine", sine, mp.sin),
    ("cosine", cosine, mp.cos),
    ("direction", direction, mp.expj),
    ("complex", lambda x: logarithm(x * mpc(1, 2) + 3), lambda x: mp.log(x * mpc(1, 2) + 3)),
]


@pytest.mark.parametrize(("name", "ours", "theirs"), FUNCTIONS)
def test_terms_are_those_of_the_function(
    name: str, ours: Callable[[Series], Series], theirs: Callable[[Any], Any]
) -> None:
    """mpmath differentiates by differences at twice the digits; 30 of 50 are sure."""
    with mp.workdps(DIGITS):
        found = ours(inner_series())
        for order in range(TERMS):
            expected = mp.diff(lambda t: theirs(inner(t)), 0, order)
            error = abs(found.derivative(order) - expected)
            assert error <= mpf(10) ** -30 * max(1, abs(expected)), (name, order)


def test_parts_and_slope() -> None:
    with mp.workdps(DIGITS):
        found = inner_series() * mpc(2, -1)
        assert all(abs(a - 2 * b) < 1e-48 for a, b in zip(found.real.terms, inner_series().terms,
                                                          strict=True))  # fmt: skip
        assert all(abs(a + b) < 1e-48 for a, b in zip(found.imag.terms, inner_series().terms,
                                                      strict=True))  # fmt: skip
        slope = inner_series().slope()
        assert [slope.derivative(k) for k in range(TERMS - 1)] == [
            inner_series().derivative(k + 1) for k in range(TERMS - 1)
        ]
