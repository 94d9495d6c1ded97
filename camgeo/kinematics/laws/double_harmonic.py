"""Double harmonic: f = (1 - cos pi z)/2 - (1 - cos 2 pi z)/8, from rest to reversal and back.

A gentle way into a reversal, f''(1) = -pi^2, for moves that need no rest at the top (H. A.
Rothbart, Cams, 1956). With s = sin(pi z/2), f = s^4, which keeps its digits at both ends.
"""

from __future__ import annotations

import math
from types import MappingProxyType
from typing import Any

import numpy as np

from camgeo.kinematics.laws.family import Family, LawParameters
from camgeo.kinematics.laws.law import Boundary, Law, Region, Values
from camgeo.numeric.arrays import FloatArray

JERK = 4.0 * math.pi**3
"""An upper bound of |f'''| = pi^3 |s c (3 - 8 s^2)|."""


def _turns() -> tuple[float, ...]:
    """The z at which f'', f''', (f' f'')' and f'''' vanish: the roots of equations in s^2, of which
    the last two are quadratic.

    f' f'' is s^5 c (3 - 4 s^2), f''' is s c (3 - 8 s^2).
    """
    squares = [0.75, 0.375]
    squares += [(46.0 + sign * 14.0) / 64.0 for sign in (1, -1)]
    squares += [(30.0 + sign * math.sqrt(30.0**2 - 4.0 * 32.0 * 3.0)) / 64.0 for sign in (1, -1)]
    return tuple(2.0 / math.pi * math.asin(math.sqrt(square)) for square in squares)


def _regions(*, back: bool) -> tuple[Region, ...]:
    """The regions from rest to reversal; with `back` those of the mirror image from reversal to
    rest, F(z) = 1 - f(1 - z), F'' = -f''(1 - z).
    """

    def way(z: FloatArray, w: FloatArray, *, from_turn: bool) -> FloatArray:
        return 0.5 * math.pi * (z if from_turn == back else w)

    def lift(z: FloatArray, w: FloatArray) -> FloatArray:
        return np.asarray(np.sin(way(z, w, from_turn=False)) ** 4)

    def left(z: FloatArray, w: FloatArray) -> FloatArray:
        angle = way(z, w, from_turn=True)
        # The angle is counted from the reversal, a quarter of a period away from where s is 0: sine
        # and cosine change places.
        cosine, sine = np.sin(angle), np.cos(angle)
        return np.asarray(cosine * cosine * (1.0 + sine * sine))

    def values(near: FloatArray, sine: FloatArray, cosine: FloatArray) -> Values:
        square = sine * sine
        product = sine * cosine
        bend = math.pi**2 * square * (3.0 - 4.0 * square)
        return np.array((
            near,
            2.0 * math.pi * square * product,
            -bend if back else bend,
            math.pi**3 * product * (3.0 - 8.0 * square),
        ))  # fmt: skip

    def from_rest(z: FloatArray, w: FloatArray, _: Any) -> Values:
        angle = way(z, w, from_turn=False)
        return values(lift(z, w), np.sin(angle), np.cos(angle))

    def from_turn(z: FloatArray, w: FloatArray, _: Any) -> Values:
        angle = way(z, w, from_turn=True)
        return values(left(z, w), np.cos(angle), np.sin(angle))

    def turns() -> tuple[float, ...]:
        return tuple(1.0 - z if back else z for z in _turns())

    halves = [(from_rest, left), (from_turn, lift)]
    return tuple(
        Region(0.5 * k, 0.5 * (k + 1), formula, far, JERK, from_end=k == 1, turns=turns)
        for k, (formula, far) in enumerate(halves[::-1] if back else halves)
    )


RISING, FALLING = _regions(back=False), _regions(back=True)
TURN = math.pi**2


def _make(task: str, _parameters: LawParameters) -> Law:
    if task == "R-U":
        regions, start, end = RISING, Boundary(), Boundary(acceleration=-TURN)
    else:
        regions, start, end = FALLING, Boundary(acceleration=TURN), Boundary()
    return Law("double-harmonic", task, regions, (), start, end, parameters=MappingProxyType({}))


FAMILY = Family("double-harmonic", {"R-U": (), "U-R": ()}, _make)
