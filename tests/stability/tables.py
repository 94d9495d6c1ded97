"""Cases of lifts by points: the spline through the rows of a table.

A spline is defined by its conditions, and the exact one solves them directly: a polynomial of
degree 5 between neighbouring points, through both, with four continuous derivatives.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Final

import numpy as np
from mpmath import mp

from camgeo.kinematics.motion import FREE
from camgeo.kinematics.splines import Spline
from camgeo.numeric.arrays import FloatArray
from tests.stability.measure import Case
from tests.stability.series import Number, polynomial, variable

GROUP: Final = "tables"

QUANTITIES: Final = ("s of a table", "s' of a table", "s'' of a table", "s''' of a table")

SHARES: Final = (0.003, 0.11, 0.37, 0.52, 0.68, 0.96)
"""Places as fractions of the span."""

INSIDE: Final = SHARES[2:5]
"""As `SHARES`, away from the ends. At a free end the third derivative passes 0 and is known only to
the rounding of its largest value."""

REST: Final = (0.0, 0.0)

SIZE: Final = 6
"""Coefficients of a piece."""

ROUND: Final = ((0.0, 75.0, 130.0, 250.0), (0.0, 9.5, 17.0, 6.25))

EVEN: Final = ((0.0, 30.0, 60.0, 100.0), (0.0, 2.5, 11.0, 20.0))

UNEVEN: Final = ((0.0, 29.0, 30.0, 31.0, 120.0), (0.0, 4.5, 5.0, 5.375, 20.0))
"""Rows: cam angle [degrees] and lift [mm]."""


def cases() -> tuple[Case, ...]:
    """All cases of this module."""
    return (
        _table("four rows, all round", *ROUND, periodic=True),
        _table("uneven rows from rest to rest", *UNEVEN, periodic=False, rest=True),
        _table("four rows, free ends", *EVEN, periodic=False),
    )


def _table(
    name: str,
    angles: tuple[float, ...],
    lifts: tuple[float, ...],
    *,
    periodic: bool,
    rest: bool = False,
) -> Case:
    span = 360.0 if periodic else angles[-1]
    ends = REST if rest else FREE
    x, y = np.radians(angles), np.array(lifts)
    if periodic:
        spline = Spline.closed(x, y, math.radians(span))
    else:
        spline = Spline.clamped(x, y, ends, ends)
    # Joints are inputs: degrees converted to radians and rounded once. The first one is 0.
    knots = [float(angle) for angle in np.radians([*angles[1:], *([span] if periodic else [])])]

    def found(phi: FloatArray) -> tuple[FloatArray, ...]:
        return tuple(spline.values(phi))

    @cache
    def pieces(numbers: tuple[Number, ...]) -> list[list[Number]]:
        x = [mp.mpf(0), *numbers[: len(knots)]]
        y = list(numbers[len(knots) :])
        return exact_spline(x, [*y, y[0]] if periodic else y, periodic=periodic, rest=rest)

    def exact(phi: Number, *numbers: Number) -> tuple[Number, ...]:
        piece = sum(phi >= knot for knot in numbers[: len(knots) - 1])
        start = numbers[piece - 1] if piece else 0
        lift = polynomial(pieces(numbers)[piece], variable(phi - start, 1, 4))
        return tuple(lift.derivative(order) for order in range(4))

    shares = SHARES if periodic or rest else INSIDE
    places = tuple(share * knots[-1] for share in shares)
    return Case(GROUP, name, QUANTITIES, places, (*knots, *lifts), found, exact)


def exact_spline(
    x: list[Number], y: list[Number], *, periodic: bool, rest: bool
) -> list[list[Number]]:
    """Coefficients of (x - x_i)^k, piece by piece, of the spline through the points x, y.

    If `periodic`, the four derivatives are also continuous from the last point to the first; else
    s' = s'' = 0 at both ends if it is to `rest` there, and s''' = s'''' = 0 if not.
    """
    count = len(x) - 1
    rows, right = mp.matrix(SIZE * count, SIZE * count), mp.matrix(SIZE * count, 1)
    line = 0

    def add(piece: int, at: Number, order: int, sign: int) -> None:
        for power in range(order, SIZE):
            rows[line, SIZE * piece + power] += sign * mp.ff(power, order) * at ** (power - order)

    lengths = [x[k + 1] - x[k] for k in range(count)]
    for k in range(count):
        for at, value in ((mp.mpf(0), y[k]), (lengths[k], y[k + 1])):
            add(k, at, 0, 1)
            right[line] = value
            line += 1
    for k in range(count if periodic else count - 1):
        for order in range(1, 5):
            add(k, lengths[k], order, 1)
            add((k + 1) % count, mp.mpf(0), order, -1)
            line += 1
    if not periodic:
        for order in (1, 2) if rest else (3, 4):
            add(0, mp.mpf(0), order, 1)
            line += 1
            add(count - 1, lengths[-1], order, 1)
            line += 1
    solved = mp.lu_solve(rows, right)
    return [list(solved[SIZE * k : SIZE * (k + 1)]) for k in range(count)]
