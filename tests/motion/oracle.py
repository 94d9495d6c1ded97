"""The laws as VDI 2143-1 prints them, with as many digits as they lose, and errors in ulp.

The formulas of the guideline are exact and, in double precision, useless near the ends: the laws of
camgeo are written otherwise, so the print is an independent oracle at 80 digits.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import Any

from mpmath import mp, mpf

from camgeo.motion.laws.law import Law

DIGITS = 80
"""z >= 1e-16 costs the formulas 48 digits at most, in z - sin(4 pi z)/(4 pi)."""

Number = Any  # mpmath has no types
Exact = tuple[Number, Number, Number, Number]
Values = tuple[Number, Number, Number, Number, Number]

TINY = mpf(10) ** -70
ZERO = mpf(10) ** -60
"""Nothing that a law gives at z >= 1e-16 is smaller and not zero."""


def _straight_line(z: Number) -> Exact:
    """Eqs. (21) to (23)."""
    return z, mpf(1), mpf(0), mpf(0)


def _quadratic_parabola(z: Number) -> Exact:
    """Eqs. (24) to (29), first half."""
    return 2 * z**2, 4 * z, mpf(4), mpf(0)


def _simple_sine(z: Number) -> Exact:
    """Eqs. (30) to (32)."""
    x = mp.pi * z
    return (
        (1 - mp.cos(x)) / 2,
        mp.pi / 2 * mp.sin(x),
        mp.pi**2 / 2 * mp.cos(x),
        -(mp.pi**3) / 2 * mp.sin(x),
    )


def _polynomial_345(z: Number) -> Exact:
    """Eqs. (33) to (35)."""
    return (
        10 * z**3 - 15 * z**4 + 6 * z**5,
        30 * z**2 - 60 * z**3 + 30 * z**4,
        60 * z - 180 * z**2 + 120 * z**3,
        60 - 360 * z + 360 * z**2,
    )


def _inclined_sine(z: Number) -> Exact:
    """Eqs. (36) to (38)."""
    x = 2 * mp.pi * z
    return (
        z - mp.sin(x) / (2 * mp.pi),
        1 - mp.cos(x),
        2 * mp.pi * mp.sin(x),
        4 * mp.pi**2 * mp.cos(x),
    )


def _modified_trapezoid(z: Number) -> Exact:
    """Eqs. (39) to (47), first half."""
    pi, k = mp.pi, mp.pi + 2
    if z < mpf(1) / 8:
        x = 4 * pi * z
        return (
            2 / k * (z - mp.sin(x) / (4 * pi)),
            2 / k * (1 - mp.cos(x)),
            8 * pi / k * mp.sin(x),
            32 * pi**2 / k * mp.cos(x),
        )
    if z < mpf(3) / 8:
        return (
            (4 * pi * z**2 + (2 - pi) * z + (pi**2 - 8) / (16 * pi)) / k,
            (8 * pi * z + 2 - pi) / k,
            8 * pi / k,
            mpf(0),
        )
    q = 4 * pi * (z - mpf(1) / 4)
    return (
        2 / k * ((pi + 1) * z - mp.sin(q) / (4 * pi) - pi / 4),
        2 / k * (pi + 1 - mp.cos(q)),
        8 * pi / k * mp.sin(q),
        32 * pi**2 / k * mp.cos(q),
    )


def _modified_sine(z: Number) -> Exact:
    """Eqs. (57) to (62), first half."""
    pi = mp.pi
    k, a = pi / (4 + pi), 4 * pi**2 / (4 + pi)
    if z < mpf(1) / 8:
        x = 4 * pi * z
        return (
            k * (z - mp.sin(x) / (4 * pi)),
            k * (1 - mp.cos(x)),
            a * mp.sin(x),
            4 * pi * a * mp.cos(x),
        )
    q = pi / 3 * (1 + 4 * z)
    return (
        k * (2 / pi + z - 9 / (4 * pi) * mp.sin(q)),
        k * (1 - 3 * mp.cos(q)),
        a * mp.sin(q),
        4 * pi / 3 * a * mp.cos(q),
    )


PRINTED: dict[str, Callable[[Number], Exact]] = {
    "straight-line": _straight_line,
    "quadratic-parabola": _quadratic_parabola,
    "simple-sine": _simple_sine,
    "polynomial-345": _polynomial_345,
    "inclined-sine": _inclined_sine,
    "modified-trapezoid": _modified_trapezoid,
    "modified-sine": _modified_sine,
}


def exact(law: Law, z: Number) -> Values:
    """f, 1 - f, f', f'', f''' at z, the limits from the right; eqs. (66) to (75) for a shift."""
    with mp.workdps(DIGITS):
        printed = PRINTED[law.name]
        place, lam = mpf(z), mpf(law.inflection)
        rising = place < lam
        stretch = 2 * lam if rising else 2 * (1 - lam)
        # The limit from the right is one from the left in 1 - z.
        near, f1, f2, f3 = printed(
            place / stretch if rising else (1 - place) / stretch * (1 - TINY)
        )
        near *= stretch
        f2 /= stretch
        f3 /= stretch**2
        if rising:
            return near, 1 - near, f1, f2, f3
        return 1 - near, near, f1, -f2, f3


def ulps(value: float, true: Number) -> float:
    """Error of `value` in units in the last place of the true value; a true zero must be met."""
    with mp.workdps(DIGITS):
        if abs(true) < ZERO:
            return 0.0 if value == 0.0 else math.inf
        return float(abs(mpf(float(value)) - true) / mpf(math.ulp(float(true))))


def worst_ulps(values: Iterable[float], true: Iterable[Number]) -> float:
    """Largest of the errors in ulp."""
    return max(ulps(value, number) for value, number in zip(values, true, strict=True))


def decimal(text: str) -> Number:
    """A decimal string of the reference, with all its digits."""
    with mp.workdps(DIGITS):
        return mpf(text)
