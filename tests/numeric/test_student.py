"""Quantiles of Student's t against a published table (Abramowitz and Stegun, table 26.10)."""

from __future__ import annotations

from itertools import pairwise

import mpmath
import pytest

from camgeo.studies.inspection import FEWEST_FREEDOMS, quantile


@pytest.mark.parametrize(
    ("freedom", "at_95", "at_975"),
    [(8, 1.860, 2.306), (10, 1.812, 2.228), (20, 1.725, 2.086), (60, 1.671, 2.000),
     (120, 1.658, 1.980)],
)  # fmt: skip
def test_it_is_that_of_the_table(freedom: int, at_95: float, at_975: float) -> None:
    assert quantile(0.95, freedom) == pytest.approx(at_95, abs=5.1e-4)
    assert quantile(0.975, freedom) == pytest.approx(at_975, abs=5.1e-4)


def test_it_is_as_exact_as_stated() -> None:
    """With 8 degrees of freedom the quantile is 2.3060041350333704 (closed form, to its digits)."""
    assert FEWEST_FREEDOMS == 8
    assert quantile(0.975, 8) == pytest.approx(2.3060041350333704, rel=2e-5)
    assert quantile(0.5, 9) == 0.0
    assert quantile(0.025, 9) == pytest.approx(-quantile(0.975, 9), rel=1e-14)


@pytest.mark.parametrize("probability", [0.9, 0.95, 0.975])
def test_its_error_is_of_the_fifth_order(probability: float) -> None:
    """Four terms of the expansion are left out: twice the freedom, a 32nd of the error or less."""
    errors = []
    with mpmath.workdps(30):
        for freedom in (8, 16, 32, 64):
            found = quantile(probability, freedom)

            def beyond(t: mpmath.mpf, freedom: int = freedom) -> mpmath.mpf:
                tail = mpmath.betainc(
                    mpmath.mpf(freedom) / 2, 0.5, 0, freedom / (freedom + t * t), regularized=True
                )
                return 1 - tail / 2 - probability

            errors.append(float(mpmath.findroot(beyond, found) - found))
    assert 0.0 < errors[0] < 2e-5 * found * 1.2
    for before, after in pairwise(errors):
        assert 31.0 < before / after < 36.0
