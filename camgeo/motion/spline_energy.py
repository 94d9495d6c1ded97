"""The energy of a spline, the integral of s''' squared, and the interpolant that has the least.

With t in [0, 1] and u(t) = s, integral of u''' squared = d0^2 + d1^2 + d2^2, the moments of u'''
with the orthonormal Legendre polynomials. Integrated by parts they are, with the chord
D = u(1) - u(0), p = u'(0), q = u'(1), A = u''(0), B = u''(1):
    d0 = B - A,  d1 = sqrt(3) (A + B + 2 p - 2 q),  d2 = sqrt(5) (B - A - 6 p - 6 q + 12 D).
In x the integral is that divided by h^5.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from camgeo.numeric.arrays import BoolArray, FloatArray, IntArray

ROOT_3, ROOT_5 = math.sqrt(3.0), math.sqrt(5.0)

MOMENTS: Final = np.array(
    [
        [0.0, 0.0, -1.0, 0.0, 0.0, 1.0],
        [0.0, 2.0 * ROOT_3, ROOT_3, 0.0, -2.0 * ROOT_3, ROOT_3],
        [-12.0 * ROOT_5, -6.0 * ROOT_5, -ROOT_5, 12.0 * ROOT_5, -6.0 * ROOT_5, ROOT_5],
    ]
)
"""(d0, d1, d2) from u, u', u'' at t = 0 and at t = 1."""

OF_CHORD: Final = np.array([0.0, 0.0, 12.0 * ROOT_5])

SLOPES: Final = [1, 2, 4, 5]
"""Columns of MOMENTS that belong to derivatives."""


def node_scales(step: FloatArray, ring: bool) -> FloatArray:
    """(n,) for each node the length in which its derivatives are counted: its shorter piece."""
    if ring:
        return np.minimum(step, np.roll(step, 1))
    padded = np.concatenate((step[:1], step, step[-1:]))
    return np.minimum(padded[:-1], padded[1:])


def pieces(step: FloatArray, scale: FloatArray, ring: bool) -> tuple[FloatArray, IntArray]:
    """(m, 3, 6) the moments of each piece from scaled nodal values; (m, 2) its nodes."""
    count = len(scale)
    first = np.arange(len(step))
    ends = np.stack((first, (first + 1) % count if ring else first + 1), axis=1)
    powers = (step[:, np.newaxis] / scale[ends])[:, :, np.newaxis] ** np.arange(3.0)
    return MOMENTS * powers.reshape(-1, 1, 6), ends


def positions(count: int, ring: bool) -> IntArray:
    """(count,) the order in which the members of a chain or ring stand in a banded matrix.

    A ring is laid double, 0, count - 1, 1, count - 2, ...: neighbours are at most 2 apart.
    """
    number = np.arange(count)
    if not ring:
        return number
    return np.where(2 * number < count, 2 * number, 2 * (count - 1 - number) + 1)


def hermite(
    step: FloatArray, chord: FloatArray, starts: FloatArray, ends: FloatArray
) -> FloatArray:
    """(m, 6) Taylor coefficients of the quintics with these nodal values (m, 3)."""
    p, q = starts[:, 1] * step, ends[:, 1] * step
    a, b = starts[:, 2] * step**2, ends[:, 2] * step**2
    p_less, q_less = p - chord, q - chord  # a straight motion leaves no rest of rounding
    return np.stack(
        (
            starts[:, 0],
            p,
            0.5 * a,
            -6.0 * p_less - 4.0 * q_less - 1.5 * a + 0.5 * b,
            8.0 * p_less + 7.0 * q_less + 1.5 * a - b,
            -3.0 * p_less - 3.0 * q_less - 0.5 * a + 0.5 * b,
        ),
        axis=1,
    )


def interpolate(
    step: FloatArray, chord: FloatArray, nodes: FloatArray, fixed: BoolArray, ring: bool
) -> FloatArray:
    """(n, 3) nodal values with the least energy, by a banded Cholesky factorisation.

    `nodes` holds the prescribed ones.
    """
    from scipy.linalg import cho_solve_banded, cholesky_banded

    count = len(nodes)
    scale = node_scales(step, ring)
    moments, ends = pieces(step, scale, ring)
    # The moments see the positions only through the chord, which is exact where positions cancel.
    rows = moments[:, :, SLOPES] * ((step / np.min(step)) ** -2.5)[:, np.newaxis, np.newaxis]
    shift = OF_CHORD * (chord * (step / np.min(step)) ** -2.5)[:, np.newaxis]
    place = 2 * positions(count, ring)[ends][:, :, np.newaxis] + np.arange(2)
    place = place.reshape(-1, 4)

    held = np.zeros(2 * count, dtype=np.bool_)
    own = 2 * positions(count, ring)[:, np.newaxis] + np.arange(2)
    held[own] = fixed[:, 1:]
    unknown = np.zeros(2 * count)
    unknown[own] = nodes[:, 1:] * np.stack((scale, scale**2), axis=1)

    width = 5 if ring else 3
    stiffness = np.einsum("mki,mkj->mij", rows, rows)
    diagonal = np.zeros(2 * count)
    np.add.at(diagonal, place, np.einsum("mii->mi", stiffness))
    balance = 1.0 / np.sqrt(diagonal)
    banded = np.zeros((width + 1, 2 * count))
    for i in range(4):
        for j in range(4):
            low, high = place[:, i], place[:, j]
            free = (low >= high) & ~held[low] & ~held[high]
            entry = stiffness[free, i, j] * balance[low[free]] * balance[high[free]]
            np.add.at(banded, (low[free] - high[free], high[free]), entry)
    banded[0, held] = 1.0
    factor = cholesky_banded(banded, lower=True)
    for _ in range(2):  # the second time with what rounding has left
        strain = np.einsum("mki,mi->mk", rows, unknown[place]) + shift
        force = np.zeros(2 * count)
        np.add.at(force, place, -np.einsum("mki,mk->mi", rows, strain))
        force[held] = 0.0
        unknown += balance * cho_solve_banded((factor, True), balance * force)

    out = nodes.copy()
    free_slopes = unknown[own] / np.stack((scale, scale**2), axis=1)
    out[:, 1:] = np.where(fixed[:, 1:], nodes[:, 1:], free_slopes)
    return out
