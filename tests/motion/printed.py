"""The laws of VDI 2143-1 for all tasks as the guideline prints them, errata corrected.

A law is a tuple of pieces, each with one formula in z for f, f', f'' and f''', followed by the
guideline's equation numbers. Corrected equations carry a prime. Evaluate with
`tests.motion.oracle.DIGITS` digits: the printed forms lose most of them near the ends.

Parameters are mpmath numbers under the names of `camgeo.kinematics.laws.make_law`; all formulas
write C_a as `ca` and C_a* as `cb`, m = 1 - lambda.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from mpmath import mp, mpf

Number = Any  # mpmath has no types
Exact = tuple[Number, Number, Number, Number]
Formula = Callable[[Number], Exact]
Parameters = dict[str, Number]
Amplitudes = tuple[Number, Number]  # C_a, C_a*


@dataclass(frozen=True, slots=True)
class Piece:
    """A stretch of a law: `formula` maps z to f, f', f'', f'''."""

    start: Number
    end: Number
    formula: Formula


Pieces = tuple[Piece, ...]


def pieces(places: list[Number], formulas: list[Formula]) -> Pieces:
    """Pieces from place to place; those without length are left out."""
    return tuple(
        Piece(start, end, formula)
        for start, end, formula in zip(places[:-1], places[1:], formulas, strict=True)
        if start < end
    )


def mirrored(law: Pieces) -> Pieces:
    """F(z) = 1 - f(1 - z), F' = f'(1 - z), F'' = -f''(1 - z), F''' = f'''(1 - z)."""

    def image(formula: Formula) -> Formula:
        def turned(z: Number) -> Exact:
            f, f1, f2, f3 = formula(1 - z)
            return 1 - f, f1, -f2, f3

        return turned

    return tuple(Piece(1 - piece.end, 1 - piece.start, image(piece.formula)) for piece in law[::-1])


# R-R: the halves of the symmetric laws, on [0, 1/2] -------------------------------------------


def straight_line(z: Number) -> Exact:
    """Eqs. (21) to (23)."""
    return z, mpf(1), mpf(0), mpf(0)


def quadratic_parabola(z: Number) -> Exact:
    """Eqs. (24) to (26)."""
    return 2 * z**2, 4 * z, mpf(4), mpf(0)


def simple_sine(z: Number) -> Exact:
    """Eqs. (30) to (32)."""
    x = mp.pi * z
    return (
        (1 - mp.cos(x)) / 2,
        mp.pi / 2 * mp.sin(x),
        mp.pi**2 / 2 * mp.cos(x),
        -(mp.pi**3) / 2 * mp.sin(x),
    )


def polynomial_345(z: Number) -> Exact:
    """Eqs. (33) to (35)."""
    return (
        10 * z**3 - 15 * z**4 + 6 * z**5,
        30 * z**2 - 60 * z**3 + 30 * z**4,
        60 * z - 180 * z**2 + 120 * z**3,
        60 - 360 * z + 360 * z**2,
    )


def polynomial_4567(z: Number) -> Exact:
    """35 z^4 - 84 z^5 + 70 z^6 - 20 z^7; not in the guideline."""
    return (
        35 * z**4 - 84 * z**5 + 70 * z**6 - 20 * z**7,
        140 * z**3 - 420 * z**4 + 420 * z**5 - 140 * z**6,
        420 * z**2 - 1680 * z**3 + 2100 * z**4 - 840 * z**5,
        840 * z - 5040 * z**2 + 8400 * z**3 - 4200 * z**4,
    )


def inclined_sine(z: Number) -> Exact:
    """Eqs. (36) to (38)."""
    x = 2 * mp.pi * z
    return (
        z - mp.sin(x) / (2 * mp.pi),
        1 - mp.cos(x),
        2 * mp.pi * mp.sin(x),
        4 * mp.pi**2 * mp.cos(x),
    )


def _modified_trapezoid() -> Pieces:
    """Eqs. (39) to (47)."""
    pi, k = mp.pi, mp.pi + 2

    def first(z: Number) -> Exact:
        x = 4 * pi * z
        return (
            2 / k * (z - mp.sin(x) / (4 * pi)),
            2 / k * (1 - mp.cos(x)),
            8 * pi / k * mp.sin(x),
            32 * pi**2 / k * mp.cos(x),
        )

    def second(z: Number) -> Exact:
        return (
            (4 * pi * z**2 + (2 - pi) * z + (pi**2 - 8) / (16 * pi)) / k,
            (8 * pi * z + 2 - pi) / k,
            8 * pi / k,
            mpf(0),
        )

    def third(z: Number) -> Exact:
        q = 4 * pi * (z - mpf(1) / 4)
        return (
            2 / k * ((pi + 1) * z - mp.sin(q) / (4 * pi) - pi / 4),
            2 / k * (pi + 1 - mp.cos(q)),
            8 * pi / k * mp.sin(q),
            32 * pi**2 / k * mp.cos(q),
        )

    return pieces([mpf(0), mpf(1) / 8, mpf(3) / 8, mpf(1) / 2], [first, second, third])


def _modified_sine() -> Pieces:
    """Eqs. (57) to (62)."""
    pi = mp.pi
    k, a = pi / (4 + pi), 4 * pi**2 / (4 + pi)

    def first(z: Number) -> Exact:
        x = 4 * pi * z
        return (
            k * (z - mp.sin(x) / (4 * pi)),
            k * (1 - mp.cos(x)),
            a * mp.sin(x),
            4 * pi * a * mp.cos(x),
        )

    def second(z: Number) -> Exact:
        q = pi / 3 * (1 + 4 * z)
        return (
            k * (2 / pi + z - 9 / (4 * pi) * mp.sin(q)),
            k * (1 - 3 * mp.cos(q)),
            a * mp.sin(q),
            4 * pi / 3 * a * mp.cos(q),
        )

    return pieces([mpf(0), mpf(1) / 8, mpf(1) / 2], [first, second])


ONE_FORMULA: dict[str, Formula] = {
    "straight-line": straight_line,
    "quadratic-parabola": quadratic_parabola,
    "simple-sine": simple_sine,
    "polynomial-345": polynomial_345,
    "polynomial-4567": polynomial_4567,
    "inclined-sine": inclined_sine,
}


def half(name: str) -> Pieces:
    """The accelerating half of a symmetric law of section 6.1.1."""
    if name == "modified-trapezoid":
        return _modified_trapezoid()
    if name == "modified-sine":
        return _modified_sine()
    return (Piece(mpf(0), mpf(1) / 2, ONE_FORMULA[name]),)


def shifted(base: Pieces, lam: Number) -> Pieces:
    """Shift of the inflection point of a symmetric law given by its half, eqs. (66) to (75)."""

    def stretched(law: Pieces, share: Number) -> Pieces:
        factor = 2 * share

        def scaled(formula: Formula) -> Formula:
            def scaled_formula(z: Number) -> Exact:
                f, f1, f2, f3 = formula(z / factor)
                return factor * f, f1, f2 / factor, f3 / factor**2

            return scaled_formula

        return tuple(
            Piece(factor * piece.start, factor * piece.end, scaled(piece.formula)) for piece in law
        )

    return stretched(base, lam) + mirrored(stretched(base, 1 - lam))


# G-G, R-G, G-R: modified sine, section 6.2 ----------------------------------------------------


def gg_amplitudes(lam: Number, v0: Number, v1: Number) -> Amplitudes:
    """C_a and C_a*: eqs. (90) and (91), lost in print, from the continuity of f and f'."""
    k, q, mean = 2 * mp.pi**2 / (mp.pi + 4), mp.pi / 2, lam * v0 + (1 - lam) * v1
    return (
        (k * (1 - mean) + q * (1 - lam) * (v1 - v0)) / lam,
        -(k * (1 - mean) - q * lam * (v1 - v0)) / (1 - lam),
    )


def gg_modified_sine(lam: Number, v0: Number, v1: Number) -> Pieces:
    """Eqs. (95) to (110); R-G and G-R have v0 = 0 and v1 = 0."""
    pi, m = mp.pi, 1 - lam
    ca, cb = gg_amplitudes(lam, v0, v1)
    r, s = lam / (2 * pi), m / (2 * pi)

    def third(z: Number) -> Exact:
        p = 2 * pi * (z + (3 - 5 * lam) / 2) / (3 * m)
        f = z - 9 * s * mp.sin(p) + 4 * lam / pi
        return (
            -cb * s * f + v1 * z + (v0 - v1) * (mpf(3) / 4 - 1 / pi) * lam,
            -cb * s * (1 - 3 * mp.cos(p)) + v1,
            -cb * mp.sin(p),
            -2 * pi / (3 * m) * cb * mp.cos(p),
        )

    def fourth(z: Number) -> Exact:
        p = 2 * pi * (z - lam) / m
        return (
            -cb * s * (z - s * mp.sin(p) - 1) + 1 + v1 * (z - 1),
            -cb * s * (1 - mp.cos(p)) + v1,
            -cb * mp.sin(p),
            -2 * pi / m * cb * mp.cos(p),
        )

    def second(z: Number) -> Exact:
        p = 2 * pi * (z + lam / 2) / (3 * lam)
        return (
            ca * r * (z - 9 * r * mp.sin(p) + 4 * lam / pi) + v0 * z,
            ca * r * (1 - 3 * mp.cos(p)) + v0,
            ca * mp.sin(p),
            2 * pi / (3 * lam) * ca * mp.cos(p),
        )

    return pieces(
        [mpf(0), lam / 4, lam, 1 - m / 4, mpf(1)],
        [quick_sine(lam, ca, v0), second, third, fourth],
    )


def quick_sine(lam: Number, ca: Number, v0: Number) -> Formula:
    """Eqs. (95) to (98), (151) to (154), (181) to (184), (207) to (210')."""

    def formula(z: Number) -> Exact:
        r = lam / (2 * mp.pi)
        p = z / r
        return (
            ca * r * (z - r * mp.sin(p)) + v0 * z,
            ca * r * (1 - mp.cos(p)) + v0,
            ca * mp.sin(p),
            ca / r * mp.cos(p),
        )

    return formula


# U-U: sine-straight combination, section 6.3 --------------------------------------------------


def uu_sine_straight(lam: Number, c: Number) -> Pieces:
    """Eqs. (111) to (121)."""
    pi, rise, fall = mp.pi, c * lam, c * (1 - lam)
    ca = pi / (2 * c * lam * (1 - c * (1 - 2 / pi)))
    r = 2 * rise / pi

    def first(z: Number) -> Exact:
        return (
            ca * r**2 * (1 - mp.cos(z / r)),
            ca * r * mp.sin(z / r),
            ca * mp.cos(z / r),
            -ca / r * mp.sin(z / r),
        )

    def second(z: Number) -> Exact:
        return ca * r * (z + rise * (2 / pi - 1)), ca * r, mpf(0), mpf(0)

    def third(z: Number) -> Exact:
        q = pi / (2 * fall) * (z - 1 + fall)
        return (
            ca * r * (2 * fall / pi * mp.sin(q) + r + 1 - c),
            ca * r * mp.cos(q),
            -ca * lam / (1 - lam) * mp.sin(q),
            -ca * pi * lam / (2 * c * (1 - lam) ** 2) * mp.cos(q),
        )

    return pieces([mpf(0), rise, 1 - fall, mpf(1)], [first, second, third])


# B-B and the rest: quintic polynomial, section 6.4 --------------------------------------------


def quintic(v0: Number, a0: Number, v1: Number, a1: Number) -> Pieces:
    """Eqs. (131) to (150)."""
    k1, k2, k3 = 1 - v0 - a0 / 2, v1 - v0 - a0, a1 - a0
    return power_series(
        [
            mpf(0),
            v0,
            a0 / 2,
            10 * k1 - 4 * k2 + k3 / 2,
            -15 * k1 + 7 * k2 - k3,
            6 * k1 - 3 * k2 + k3 / 2,
        ]
    )


def power_series(coefficients: list[Number]) -> Pieces:
    """The polynomial with these coefficients, lowest power first."""

    def formula(z: Number) -> Exact:
        row, values = list(coefficients), []
        for _ in range(4):
            values.append(mp.fdot(row, [z**power for power in range(len(row))]))
            row = [power * factor for power, factor in enumerate(row)][1:]
        return values[0], values[1], values[2], values[3]

    return (Piece(mpf(0), mpf(1), formula),)


# R-U: modified acceleration trapezoid, section 6.6.1 ------------------------------------------


def ru_trapezoid_amplitudes(lam: Number) -> Amplitudes:
    """C_a and C_a*, eqs. (169) and (171)."""
    pi = mp.pi
    cb = (
        -32
        * pi**2
        / (15 * pi**2 + 8 - 2 * lam * (9 * pi**2 - 4 * pi + 8) + lam**2 * (3 * pi**2 - 8 * pi + 8))
    )
    return -(1 - lam) / lam * (3 * pi + 2) / (2 * (pi + 2)) * cb, cb


def ru_trapezoid(lam: Number) -> Pieces:
    """Eqs. (151) to (168)."""
    pi, m = mp.pi, 1 - lam
    ca, cb = ru_trapezoid_amplitudes(lam)
    r, s = lam / (2 * pi), m / (2 * pi)

    def second(z: Number) -> Exact:
        return (
            ca * ((z - lam / 4) ** 2 / 2 + r * z - r**2),
            ca * (z - lam / 4 + r),
            ca,
            mpf(0),
        )

    def third(z: Number) -> Exact:
        p = (z - 3 * lam / 4) / r
        return (
            r * ca * ((1 + pi) * z - pi * lam / 2 - r * mp.cos(p)),
            r * ca * (1 + pi + mp.sin(p)),
            ca * mp.cos(p),
            -ca / r * mp.sin(p),
        )

    def fourth(z: Number) -> Exact:
        p = (z - lam) / s
        return (
            s * cb * ((3 * pi - 2) * lam / 4 - 3 * pi / 2 * z - s * mp.sin(p)),
            -s * cb * (3 * pi / 2 + mp.cos(p)),
            cb * mp.sin(p),
            cb / s * mp.cos(p),
        )

    def fifth(z: Number) -> Exact:
        return 1 + cb * (z - 1) ** 2 / 2, cb * (z - 1), cb, mpf(0)

    return pieces(
        [mpf(0), lam / 4, 3 * lam / 4, lam, (3 * lam + 1) / 4, mpf(1)],
        [quick_sine(lam, ca, mpf(0)), second, third, fourth, fifth],
    )


# R-U and G-U: harmonic combination, sections 6.6.2 and 6.8 ------------------------------------


def ru_harmonic_amplitudes(lam: Number) -> Amplitudes:
    """C_a and C_a*, eqs. (193) and (195)."""
    cb = -2 * mp.pi**2 / (8 - lam * (12 - mp.pi) + lam**2 * (4 - mp.pi))
    return -(1 - lam) / lam * cb, cb


def ru_harmonic(lam: Number, amplitudes: Amplitudes | None = None) -> Pieces:
    """Eqs. (181) to (192); `amplitudes` other than those of (193) and (195) for trial."""
    pi, m = mp.pi, 1 - lam
    ca, cb = amplitudes or ru_harmonic_amplitudes(lam)
    r = lam / (2 * pi)

    def second(z: Number) -> Exact:
        p = 2 * pi / (3 * lam) * (z - lam / 4)
        return (
            r**2 * ca * (8 + z / r - 9 * mp.cos(p)),
            r * ca * (1 + 3 * mp.sin(p)),
            ca * mp.cos(p),
            -2 * pi / (3 * lam) * ca * mp.sin(p),
        )

    def third(z: Number) -> Exact:
        p = pi / (2 * m) * (z - lam)
        return (
            -m / pi * cb * (4 * m / pi * mp.sin(p) + r * (4 + pi)),
            -2 * m / pi * cb * mp.cos(p),
            cb * mp.sin(p),
            pi / (2 * m) * cb * mp.cos(p),
        )

    return pieces([mpf(0), lam / 4, lam, mpf(1)], [quick_sine(lam, ca, mpf(0)), second, third])


def kappa() -> Number:
    """(3 pi - 4)/(4 pi), the factor of f'_G lambda in eqs. (206a), (216) and (220)."""
    return (3 * mp.pi - 4) / (4 * mp.pi)


def gu_harmonic_amplitudes(lam: Number, v0: Number) -> Amplitudes:
    """C_a and C_a*, eqs. (220) and (221)."""
    pi = mp.pi
    cb = -2 * pi**2 * (1 - kappa() * v0 * lam) / ((1 - lam) * (8 - (4 - pi) * lam))
    return (-cb * (1 - lam) - v0 * pi / 2) / lam, cb


def gu_harmonic(lam: Number, v0: Number) -> Pieces:
    """Eqs. (207) to (218), (208'), (209'), (212'), (213') and (216') with f'_G z outside."""
    pi, m = mp.pi, 1 - lam
    ca, cb = gu_harmonic_amplitudes(lam, v0)
    r = lam / (2 * pi)

    def second(z: Number) -> Exact:
        p = 2 * pi * (z - lam / 4) / (3 * lam)
        return (
            ca * r * (z - 9 * r * mp.cos(p) + 4 * lam / pi) + v0 * z,
            ca * r * (1 + 3 * mp.sin(p)) + v0,
            ca * mp.cos(p),
            -2 * pi / (3 * lam) * ca * mp.sin(p),
        )

    def third(z: Number) -> Exact:
        p = pi * (z - lam) / (2 * m)
        return (
            -cb * m / pi**2 * (lam * (pi + 4) / 2 + 4 * m * mp.sin(p)) + kappa() * v0 * lam,
            -2 * m / pi * cb * mp.cos(p),
            cb * mp.sin(p),
            pi / (2 * m) * cb * mp.cos(p),
        )

    return pieces([mpf(0), lam / 4, lam, mpf(1)], [quick_sine(lam, ca, v0), second, third])


# Beyond the guideline -------------------------------------------------------------------------


def double_harmonic(z: Number) -> Exact:
    """R-U: (1 - cos(pi z))/2 - (1 - cos(2 pi z))/8."""
    pi = mp.pi
    x = pi * z
    return (
        (1 - mp.cos(x)) / 2 - (1 - mp.cos(2 * x)) / 8,
        pi / 2 * mp.sin(x) - pi / 4 * mp.sin(2 * x),
        pi**2 / 2 * (mp.cos(x) - mp.cos(2 * x)),
        -(pi**3) / 2 * mp.sin(x) + pi**3 * mp.sin(2 * x),
    )


def least_degree(values: dict[tuple[int, int], Number]) -> Pieces:
    """The polynomial of least degree with f(0) = 0, f(1) = 1 and these derivatives.

    `values` maps (place, order), place 0 or 1, to the derivative there.
    """
    given = {(0, 0): mpf(0), (1, 0): mpf(1), **values}
    powers = range(len(given))
    rows = [
        [mp.ff(power, order) * mpf(place) ** max(power - order, 0) for power in powers]
        for place, order in given
    ]
    return power_series(list(mp.lu_solve(mp.matrix(rows), mp.matrix(list(given.values())))))
