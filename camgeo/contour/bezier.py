"""Cubic Bezier pieces: B-splines split into them, cut, measured and bounded.

A piece is a row of four complex control points [mm]; (n, 4) is n pieces.
"""

from __future__ import annotations

import math

import numpy as np

from camgeo.errors import GeometryError
from camgeo.numeric.arrays import ComplexArray, FloatArray, IntArray, grouped
from camgeo.wording import counted

CUBIC = 3

MOMENTS = (
    (0, 1, 0.3), (0, 2, 0.15), (0, 3, 0.05), (1, 2, 0.15), (1, 3, 0.15), (2, 3, 0.3),
)  # fmt: skip
"""Half the integral of x dy - y dx of a piece: weights of the products b_i x b_j."""

GAUSS = 16
"""Nodes of Gauss's quadrature of the length of a quarter of a piece."""


def beziers_of_spline(degree: int, knots: FloatArray, controls: ComplexArray) -> ComplexArray:
    """(n, 4) the pieces of a B-spline that is not rational, in order.

    Each piece is the blossom of the spline at the two ends of its span. Knots may be multiple, and
    the ends need not be clamped.

    Parameters
    ----------
    degree : 1, 2 or 3.
    knots : (m + degree + 1,) ascending.
    controls : (m,) complex [mm].

    Raises
    ------
    GeometryError
        If the degree is another, the numbers do not match or no span is left.
    """
    if not 1 <= degree <= CUBIC:
        raise GeometryError(f"a spline of degree {degree}; degrees 1 to 3 can be taken")
    count = len(controls)
    if count <= degree or len(knots) != count + degree + 1:
        raise GeometryError(
            f"a spline of degree {degree} with {counted(count, 'control point')} and"
            f" {counted(len(knots), 'knot')}"
        )
    if np.any(np.diff(knots) < 0.0):
        raise GeometryError("the knots of a spline do not ascend")
    inside = np.arange(degree, count)
    spans = inside[knots[inside + 1] > knots[inside]]
    if not len(spans):
        raise GeometryError("a spline without a span: its knots are all the same")
    low, high = knots[spans], knots[spans + 1]
    points = np.empty((len(spans), degree + 1), dtype=np.complex128)
    for upper in range(degree + 1):  # this many arguments are the upper end of the span
        rows = [controls[spans - degree + k] for k in range(degree + 1)]
        for level in range(1, degree + 1):
            place = high if level <= upper else low
            rows = [
                _between(rows[k - 1], rows[k], place, knots, spans - degree + k, degree + 1 - level)
                for k in range(level, degree + 1)
            ]
            rows = [*([rows[0]] * level), *rows]
        points[:, upper] = rows[-1]
    return elevated(points)


def _between(
    before: ComplexArray,
    after: ComplexArray,
    place: FloatArray,
    knots: FloatArray,
    index: IntArray,
    width: int,
) -> ComplexArray:
    share = (place - knots[index]) / (knots[index + width] - knots[index])
    return before + share * (after - before)


def elevated(points: ComplexArray) -> ComplexArray:
    """Pieces of degree 1 or 2 as cubics; the curve stays the same."""
    while points.shape[1] < CUBIC + 1:
        degree = points.shape[1]
        inner = np.arange(1, degree) / degree
        middle = inner * points[:, :-1] + (1.0 - inner) * points[:, 1:]
        points = np.column_stack((points[:, 0], middle, points[:, -1]))
    return points


def cut(pieces: ComplexArray, counts: IntArray) -> ComplexArray:
    """(sum of counts, 4): each of the `pieces` (n, 4) in `counts` (n,) equal parts, in order."""
    index, step = grouped(counts)
    low = (step / counts[index])[:, None]
    high = ((step + 1) / counts[index])[:, None]
    b = pieces[index]
    # Blossoms: one of the three arguments, then two, then all.
    at_low = b[:, :-1] + low * (b[:, 1:] - b[:, :-1])
    at_high = b[:, :-1] + high * (b[:, 1:] - b[:, :-1])
    low_low = at_low[:, :-1] + low * (at_low[:, 1:] - at_low[:, :-1])
    high_high = at_high[:, :-1] + high * (at_high[:, 1:] - at_high[:, :-1])
    low_high = at_low[:, :-1] + high * (at_low[:, 1:] - at_low[:, :-1])
    parts = np.empty((len(index), 4), dtype=np.complex128)
    parts[:, :1] = low_low[:, :1] + low * (low_low[:, 1:] - low_low[:, :1])
    parts[:, 1:2] = low_low[:, :1] + high * (low_low[:, 1:] - low_low[:, :1])
    parts[:, 2:3] = low_high[:, :1] + high * (low_high[:, 1:] - low_high[:, :1])
    parts[:, 3:4] = high_high[:, :1] + high * (high_high[:, 1:] - high_high[:, :1])
    parts[step == 0, 0] = b[step == 0, 0]
    last = step == counts[index] - 1
    parts[last, 3] = b[last, 3]
    return parts


def at(pieces: ComplexArray, t: FloatArray) -> ComplexArray:
    """(n, k) complex [mm] points of the `pieces` (n, 4) at `t` (k,) in [0, 1]."""
    w = 1.0 - t
    powers = np.stack((w**3, 3.0 * w * w * t, 3.0 * w * t * t, t**3))
    points: ComplexArray = pieces @ powers
    return points


def area(pieces: ComplexArray) -> float:
    """Half the integral of x dy - y dx along the `pieces` (n, 4) [mm^2], exact but for rounding."""
    total = np.zeros(len(pieces))
    for one, other, weight in MOMENTS:
        total += weight * (np.conj(pieces[:, one]) * pieces[:, other]).imag
    return math.fsum(total)


def length(pieces: ComplexArray) -> float:
    """Length of the `pieces` (n, 4) [mm]."""
    if not len(pieces):
        return 0.0
    quarters = cut(pieces, np.full(len(pieces), 4, dtype=np.intp))
    sides = 3.0 * np.diff(quarters, axis=1)
    nodes, weights = np.polynomial.legendre.leggauss(GAUSS)  # numpy loads it on first use
    t = 0.5 + 0.5 * nodes
    w = 1.0 - t
    speeds = np.abs(sides @ np.stack((w * w, 2.0 * w * t, t * t)))
    return math.fsum(0.5 * (speeds @ weights))
