"""The textbook lifts of the suite, compared with the independent oracle of the motion laws."""

from __future__ import annotations

from typing import Any

import pytest
from mpmath import mp, mpf

from tests.motion import oracle
from tests.stability.lifts import (
    HALVES,
    boundary_lift,
    double_harmonic_lift,
    lift,
    scca_lift,
    septic_lift,
)
from tests.stability.series import Series, variable

DIGITS = 60

ENOUGH = mpf(10) ** -50
"""Both are exact but for the last of 60 digits, and derivatives up to f''' of the sharpest of these
laws are 4 pi^2 / lambda^2 times as large."""

PLACES = ("0.003", "0.11", "0.2", "0.31", "0.47", "0.52", "0.77", "0.9", "0.96", "0.9991")

Number = Any


def both(z: Number) -> tuple[Series, Series]:
    return variable(z, 1, 4), variable(1 - z, -1, 4)


def differences(f: Series, expected: oracle.Values) -> list[Number]:
    f0, _, f1, f2, f3 = expected
    return [abs(f.derivative(k) - value) for k, value in enumerate((f0, f1, f2, f3))]


@pytest.mark.parametrize("name", HALVES)
@pytest.mark.parametrize("inflection", [0.5, 0.25, 0.875])
def test_lifts_are_those_of_the_guideline(name: str, inflection: float) -> None:
    with mp.workdps(DIGITS):
        for place in PLACES:
            z = mpf(place)
            f, rest = lift(name, *both(z), mpf(inflection))
            expected = oracle.exact(name, "R-R", {"inflection": inflection}, z)
            assert max(differences(f, expected)) < ENOUGH, place
            assert abs(f.terms[0] + rest.terms[0] - 1) < ENOUGH


def test_the_sine_constant_cosine_law() -> None:
    given = {"inflection": 0.5, "curved": 1.0, "sine": 0.375, "cosine": 0.25}
    with mp.workdps(DIGITS):
        for place in PLACES:
            z = mpf(place)
            f = scca_lift(*both(z), mpf(0.375), mpf(0.25))
            assert max(differences(f, oracle.exact("scca", "R-R", given, z))) < ENOUGH, place


def test_the_septic() -> None:
    given = {"j0": 20.0, "j1": -30.0}
    with mp.workdps(DIGITS):
        for place in PLACES:
            z = mpf(place)
            f = septic_lift(*both(z), mpf(20), mpf(-30))
            assert max(differences(f, oracle.exact("polynomial-7", "R-R", given, z))) < ENOUGH


def test_polynomials_of_boundary_values() -> None:
    """The oracle solves for the same polynomial in Bernstein form or by its own equations."""
    given = {"v0": -0.25, "a0": 3.0, "v1": 1.5, "a1": -2.0}
    start, end = {1: mpf(-0.25), 2: mpf(3)}, {1: mpf(1.5), 2: mpf(-2)}
    with mp.workdps(DIGITS):
        for place in PLACES:
            z = mpf(place)
            f = boundary_lift(both(z)[0], start, end)
            assert max(differences(f, oracle.exact("polynomial-5", "B-B", given, z))) < ENOUGH


def test_a_polynomial_meets_its_boundary_values() -> None:
    start, end = {1: mpf(2), 3: mpf(-7)}, {2: mpf(5)}
    with mp.workdps(DIGITS):
        for place, known, lifted in ((0, start, 0), (1, end, 1)):
            f = boundary_lift(both(mpf(place))[0], start, end)
            assert abs(f.terms[0] - lifted) < ENOUGH
            assert all(abs(f.derivative(k) - value) < ENOUGH for k, value in known.items())


def test_the_double_harmonic() -> None:
    with mp.workdps(DIGITS):
        for place in PLACES:
            z = mpf(place)
            f = double_harmonic_lift(both(z)[0])
            assert max(differences(f, oracle.exact("double-harmonic", "R-U", {}, z))) < ENOUGH
