"""Double harmonic: f = (1 - cos pi z)/2 - (1 - cos 2 pi z)/8, from rest to turn and back.

A gentle start into a turn, f''(1) = -pi^2, for moves that need no rest at the top (H. A. Rothbart,
Cams, 1956). With s = sin(pi z/2) it is f = s^4, which keeps its digits at both ends.
"""

from __future__ import annotations

import math
from types import MappingProxyType
from typing import Any

import numpy as np

from camgeo.motion.laws.family import Family, Given
from camgeo.motion.laws.law import Boundary, Law, Region, Values
from camgeo.numeric.arrays import FloatArray

JERK = 4.0 * math.pi**3
"""More than |f'''| = pi^3 |s c (3 - 8 s^2)| anywhere."""


def _stacked(near: FloatArray, sine: FloatArray, cosine: FloatArray) -> Values:
    """`near` with f', f'', f'''."""
    square = sine * sine
    product = sine * cosine
    return np.array((
        near,
        2.0 * math.pi * square * product,
        math.pi**2 * square * (3.0 - 4.0 * square),
        math.pi**3 * product * (3.0 - 8.0 * square),
    ))  # fmt: skip


def _lift(z: FloatArray, _w: FloatArray) -> FloatArray:
    return np.asarray(np.sin(0.5 * math.pi * z) ** 4)


def _complement(_z: FloatArray, w: FloatArray) -> FloatArray:
    cosine, sine = np.sin(0.5 * math.pi * w), np.cos(0.5 * math.pi * w)
    return np.asarray(cosine * cosine * (1.0 + sine * sine))


def _from_start(z: FloatArray, w: FloatArray, _: Any) -> Values:
    half = 0.5 * math.pi * z
    return _stacked(_lift(z, w), np.sin(half), np.cos(half))


def _from_end(z: FloatArray, w: FloatArray, _: Any) -> Values:
    half = 0.5 * math.pi * w
    return _stacked(_complement(z, w), np.cos(half), np.sin(half))


def _turns() -> tuple[float, ...]:
    """Where f'', f''', (f' f'')' and f'''' vanish, by s^2: the last two are quadratics in it.

    f' f'' is s^5 c (3 - 4 s^2), f''' is s c (3 - 8 s^2).
    """
    squares = [0.75, 0.375]
    squares += [(46.0 + sign * 14.0) / 64.0 for sign in (1, -1)]
    squares += [(30.0 + sign * math.sqrt(30.0**2 - 4.0 * 32.0 * 3.0)) / 64.0 for sign in (1, -1)]
    return tuple(2.0 / math.pi * math.asin(math.sqrt(square)) for square in squares)


HALVES: tuple[Region, ...] = (
    Region(0.0, 0.5, _from_start, _complement, JERK, from_end=False, turns=_turns),
    Region(0.5, 1.0, _from_end, _lift, JERK, from_end=True, turns=_turns),
)


def _mirrored(region: Region) -> Region:
    """The region of the mirror image F(z) = 1 - f(1 - z).

    F' = f'(1 - z), F'' = -f''(1 - z), F''' = f'''(1 - z).
    """

    def formula(z: FloatArray, w: FloatArray, numbers: Any) -> Values:
        values = region.formula(w, z, numbers)
        values[2] *= -1.0
        return values

    return Region(
        start=1.0 - region.end,
        end=1.0 - region.start,
        formula=formula,
        far=lambda z, w: region.far(w, z),
        jerk_bound=region.jerk_bound,
        from_end=not region.from_end,
        turns=lambda: tuple(1.0 - z for z in region.turns()),
    )


MIRRORED = tuple(_mirrored(region) for region in reversed(HALVES))
TURN = Boundary(acceleration=-(math.pi**2))


def _make(task: str, _given: Given) -> Law:
    if task == "R-U":
        regions, start, end = HALVES, Boundary(), TURN
    else:
        regions, start, end = MIRRORED, Boundary(acceleration=math.pi**2), Boundary()
    return Law("double-harmonic", task, regions, (), start, end, parameters=MappingProxyType({}))


FAMILY = Family("double-harmonic", {"R-U": (), "U-R": ()}, _make)
