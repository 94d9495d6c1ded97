"""Exact roots are cached by their initial guesses."""

from __future__ import annotations

import math

import pytest
from mpmath import mp, mpf

from camgeo.errors import GeometryError
from tests.stability.high_precision import Roots, newton


def test_the_first_root_of_a_guess_is_kept() -> None:
    roots = Roots(7)
    guess = mpf(1.2345678)
    assert roots.near(guess) is guess
    roots.keep(guess, mpf("1.23456779"))
    roots.keep(guess, mpf("9"))
    assert roots.near(guess) == mpf("1.23456779")


def test_half_an_ulp_is_no_other_guess_but_another_decimal_is() -> None:
    roots = Roots(7)
    roots.keep(mpf(1.2345678), mpf(2))
    assert roots.near(mpf(1.2345678) + mpf(math.ulp(1.2)) / 2) == 2
    other = mpf(1.2345679)
    assert roots.near(other) is other


def test_newton_settles_or_says_that_it_does_not() -> None:
    with mp.workdps(50):
        root = newton(lambda x: (x * x - 2, 2 * x), mpf("1.4"), 20)
        assert abs(root - mp.sqrt(2)) < mpf(10) ** -40
        with pytest.raises(GeometryError, match=r"no root near 1\.4"):
            newton(lambda x: (x * x + 2, 2 * x), mpf("1.4"), 20)
