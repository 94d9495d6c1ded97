"""The motion laws from rest to rest as textbooks define them, for series of any z.

VDI 2143-1, section 6.1; each law by its lift alone; derivatives are those of the series. A law is
given by its first half, f over [0, 1/2] with f(1/2) = 1/2; the second half is its mirror image, and
lambda stretches the halves to [0, lambda] and [lambda, 1] (eqs. (66) to (75)).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Final

from tests.stability.high_precision import Number, multiprecision
from tests.stability.series import Series, cosine, polynomial, sine

Half = Callable[[Series], Series]


def _straight_line(z: Series) -> Series:
    return z


def _quadratic_parabola(z: Series) -> Series:
    return 2 * z**2


def _simple_sine(z: Series) -> Series:
    return (1 - cosine(multiprecision().pi * z)) / 2


def _polynomial_345(z: Series) -> Series:
    third = z**3
    fourth = third * z
    return 10 * third - 15 * fourth + 6 * (fourth * z)


def _polynomial_4567(z: Series) -> Series:
    fourth = z**4
    fifth = fourth * z
    sixth = fifth * z
    return 35 * fourth - 84 * fifth + 70 * sixth - 20 * (sixth * z)


def _inclined_sine(z: Series) -> Series:
    turn = 2 * multiprecision().pi
    f: Series = z - sine(turn * z) / turn
    return f


def _modified_trapezoid(z: Series) -> Series:
    """Eqs. (39), (42) and (45)."""
    pi = +multiprecision().pi
    f: Series
    if z.terms[0] < 0.125:
        f = 2 * z - sine(4 * pi * z) / (2 * pi)
    elif z.terms[0] < 0.375:
        f = 4 * pi * z**2 + (2 - pi) * z + (pi**2 - 8) / (16 * pi)
    else:
        f = 2 * (pi + 1) * z - sine(4 * pi * z - pi) / (2 * pi) - pi / 2
    f = f / (pi + 2)
    return f


def _modified_sine(z: Series) -> Series:
    """Eqs. (57) and (60)."""
    pi = +multiprecision().pi
    f: Series
    if z.terms[0] < 0.125:
        f = pi * z - sine(4 * pi * z) / 4
    else:
        f = 2 + pi * z - 9 * sine((4 * pi * z + pi) / 3) / 4
    f = f / (pi + 4)
    return f


HALVES: Final[Mapping[str, Half]] = {
    "straight-line": _straight_line,
    "quadratic-parabola": _quadratic_parabola,
    "simple-sine": _simple_sine,
    "polynomial-345": _polynomial_345,
    "polynomial-4567": _polynomial_4567,
    "inclined-sine": _inclined_sine,
    "modified-trapezoid": _modified_trapezoid,
    "modified-sine": _modified_sine,
}
"""The first halves by the names of the laws."""


def lift(name: str, z: Series, rest: Series, inflection: Number) -> tuple[Series, Series]:
    """f and 1 - f of the law `name` at `z`, `rest` = 1 - z, shifted to lambda = `inflection`."""
    half = HALVES[name]
    if z.terms[0] <= inflection:
        near = 2 * inflection * half(z / (2 * inflection))
        return near, 1 - near
    long = 2 * (1 - inflection)
    near = long * half(rest / long)
    return 1 - near, near


def scca_lift(z: Series, rest: Series, sine_share: Number, cosine_share: Number) -> Series:
    """f of the symmetric sine-constant-cosine law (Norton, SCCA family) without a straight part.

    f'' over the first half is a quarter sine over the share b, a constant, a quarter cosine over
    the share d; twice integrated, and scaled to f(1/2) = 1/2.
    """
    if z.terms[0] > 0.5:
        return 1 - scca_lift(rest, z, sine_share, cosine_share)
    middle = multiprecision().mpf(1) / 2
    whole = _scca(Series((middle,)), sine_share, cosine_share).terms[0]
    f: Series = _scca(z, sine_share, cosine_share) / (2 * whole)
    return f


def _scca(z: Series, b: Number, d: Number) -> Series:
    """The lift with an acceleration of height 1."""
    pi = +multiprecision().pi
    rising, level, falling = b / 2, (1 - b - d) / 2, d / 2
    f: Series
    k = pi / (2 * rising)
    if z.terms[0] < rising:
        f = (z - sine(k * z) / k) / k
        return f
    u, lift_there, speed = z - rising, (rising - 1 / k) / k, 1 / k
    if z.terms[0] < rising + level:
        f = lift_there + speed * u + u**2 / 2
        return f
    lift_there, speed = lift_there + speed * level + level**2 / 2, speed + level
    u, k = u - level, pi / (2 * falling)
    f = lift_there + speed * u + (1 - cosine(k * u)) / k**2
    return f


def septic_lift(z: Series, rest: Series, jerk_start: Number, jerk_end: Number) -> Series:
    """f of the polynomial of degree 7 from rest to rest with these f''' at its ends.

    The 4-5-6-7 polynomial and, for each end, the polynomial that has f''' = 1 there and no other
    value up to f''' at either end.
    """
    first, last = z**3 * rest**4 / 6, z**4 * rest**3 / -6
    f: Series = _polynomial_4567(z) + jerk_start * first + jerk_end * last
    return f


def boundary_lift(z: Series, start: Mapping[int, Number], end: Mapping[int, Number]) -> Series:
    """f of the polynomial of least degree from 0 to 1 with these derivatives at its ends.

    `start`, `end`: the values by their orders, 1 to 3. The coefficients solve the equations that
    say so (VDI 2143-1, section 6.4).
    """
    mp = multiprecision()
    wanted = [(0, 0, mp.mpf(0)), (1, 0, mp.mpf(1))]
    wanted += [(0, order, value) for order, value in start.items()]
    wanted += [(1, order, value) for order, value in end.items()]
    size = len(wanted)
    rows = mp.matrix(size, size)
    for row, (place, order, _) in enumerate(wanted):
        for power in range(order, size):
            if place == 1 or power == order:
                rows[row, power] = mp.ff(power, order)
    return polynomial(list(mp.lu_solve(rows, [value for _, _, value in wanted])), z)


def double_harmonic_lift(z: Series) -> Series:
    """f from rest to turn and back (Rothbart): (1 - cos pi z)/2 - (1 - cos 2 pi z)/8."""
    pi = +multiprecision().pi
    f: Series = (1 - cosine(pi * z)) / 2 - (1 - cosine(2 * pi * z)) / 8
    return f
