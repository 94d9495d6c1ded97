from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from mpmath import mp, mpf

from camgeo.kinematics.laws.pulse import COEFFICIENTS, x_minus_sin
from tests.motion.exact_laws import DIGITS, Number, worst_ulps

X = np.concatenate((np.logspace(-16, -1, 61), np.linspace(0.1, 0.5 * math.pi, 60)))


def exact(x: float) -> Number:
    with mp.workdps(DIGITS):  # at 1e-16 the difference has lost 32 digits
        return mpf(x) - mp.sin(mpf(x))


def test_the_difference_keeps_all_digits() -> None:
    # The cube of x by 6 rounds three times, the series about once, the product once more.
    assert worst_ulps(x_minus_sin(X), [exact(float(x)) for x in X]) <= 4.0


def test_the_coefficients_are_those_of_the_series_and_enough() -> None:
    ratios = [b / a for a, b in itertools.pairwise(COEFFICIENTS)]
    exact_ratios = [-1.0 / (2 * k * (2 * k + 1)) for k in range(2, len(COEFFICIENTS) + 1)]
    assert ratios == pytest.approx(exact_ratios, rel=4.0 * 2.0**-52)
    assert COEFFICIENTS[0] == 1.0
    x = 0.5 * math.pi
    power = 2 * len(COEFFICIENTS) + 3  # of the first term that is left out
    assert x**power / math.factorial(power) < 1e-17 * (x - math.sin(x))
