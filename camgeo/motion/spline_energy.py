"""The energy of a spline, the integral of s''' squared, and its minimisers, exact or smoothed.

With t in [0, 1] and u(t) = s, integral of u''' squared = d0^2 + d1^2 + d2^2, the moments of u'''
with the orthonormal Legendre polynomials. Integrated by parts they are, with the chord
D = u(1) - u(0), p = u'(0), q = u'(1), A = u''(0), B = u''(1):
    d0 = B - A,  d1 = sqrt(3) (A + B + 2 p - 2 q),  d2 = sqrt(5) (B - A - 6 p - 6 q + 12 D).
With respect to x the integral is this sum divided by h^5.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.numeric import checked
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

LONGEST: Final = 1e4
"""Largest cut-off length in mean distances of points; rounding grows with its cube and eight digits
are left there."""

SHORTEST: Final = 1e-4
"""Smallest cut-off length tried, as a multiple of the shortest distance: its spline nearly
interpolates."""

NEAR_ENOUGH: Final = 0.97
"""The search for a cut-off length ends at this fraction of the allowed deviation."""

MAX_SEARCH: Final = 40

HIGHEST: Final = 1e100
"""Largest magnitude of y: with it and the spans that `camgeo.numeric.checked` allows, no fifth
derivative overflows."""

TINY: Final = 1e-300


def node_scales(step: FloatArray, ring: bool) -> FloatArray:
    """(n,) the length unit of the derivatives at each node: that of its shorter piece."""
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
    """(count,) the order of the members of a chain or ring in a banded matrix.

    A ring is folded, 0, count - 1, 1, count - 2, ...: neighbours are at most 2 apart.
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
    p_less, q_less = p - chord, q - chord  # a straight motion leaves no rounding behind
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
    for _ in range(2):  # the second pass corrects the rounding of the first
        strain = np.einsum("mki,mi->mk", rows, unknown[place]) + shift
        force = np.zeros(2 * count)
        np.add.at(force, place, -np.einsum("mki,mk->mi", rows, strain))
        force[held] = 0.0
        unknown += balance * cho_solve_banded((factor, True), balance * force)

    out = nodes.copy()
    free_slopes = unknown[own] / np.stack((scale, scale**2), axis=1)
    out[:, 1:] = np.where(fixed[:, 1:], nodes[:, 1:], free_slopes)
    return out


class Smoothing:
    """The smoothing problem of one set of points, to be solved for any cut-off length.

    With lambda = length^6 / mean distance a wave sin(x / length) in evenly spaced data comes out
    with half its height, a longer wave with more (1 / (1 + (length * angular frequency)^6)).

    The moments of s''' are unknowns along with the nodal values: the matrix then has the condition
    of a least-squares problem instead of its square, and the moments are as exact as the values.
    """

    def __init__(self, step: FloatArray, nodes: FloatArray, fixed: BoolArray, ring: bool) -> None:
        self.step, self.nodes, self.fixed, self.ring = step, nodes, fixed, ring
        self.scale = node_scales(step, ring)
        self.mean = float(np.mean(step))
        self.moments, self.ends = pieces(step, self.scale, ring)
        members = 2 * len(step) if ring else 2 * len(step) + 1
        place = 3 * positions(members, ring)[:, np.newaxis] + np.arange(3)
        self.size = 3 * members
        self.width = 8 if ring else 5
        self.of_node = place[0::2]
        self.of_piece = place[1::2]
        self.of_ends = self.of_node[self.ends].reshape(-1, 6)

    def solve(self, length: float) -> tuple[FloatArray, FloatArray]:
        """(n, 3) nodal values, and (m, 3) moments d0, d1, d2 of each piece."""
        from scipy.linalg import solve_banded

        unit = self.scale[:, np.newaxis] ** np.arange(3.0)
        weight = (length / self.mean) ** 3 * (self.mean / self.step) ** 2.5
        # With all pieces at a point soft, the rows of its s' and s'' have small numbers only.
        nearest = np.zeros(len(self.nodes))
        np.maximum.at(nearest, self.ends, weight[:, np.newaxis])
        balance = np.ones((len(self.nodes), 3))
        balance[:, 1:] = 1.0 / np.minimum(nearest, 1.0)[:, np.newaxis]
        rows = self.moments * weight[:, np.newaxis, np.newaxis]
        columns = rows * balance[self.ends].reshape(-1, 1, 6)
        width = self.width
        banded = np.zeros((2 * width + 1, self.size))
        right = np.zeros(self.size)
        banded[width, self.of_piece] = 1.0
        for k in range(3):
            for j in range(6):
                node, piece = self.of_ends[:, j], self.of_piece[:, k]
                banded[width + piece - node, node] = -rows[:, k, j]
                banded[width + node - piece, piece] = columns[:, k, j]
        banded[width, self.of_node[:, 0]] = 1.0  # the sum of squares
        right[self.of_node[:, 0]] = self.nodes[:, 0]
        held = self.of_node[self.fixed]
        for offset in range(-width, width + 1):  # a prescribed value: its row becomes value = given
            column = held - offset
            inside = (column >= 0) & (column < self.size)
            banded[width + offset, column[inside]] = 1.0 if offset == 0 else 0.0
        right[held] = (self.nodes * unit)[self.fixed]
        solution = solve_banded(
            (width, width), banded, right, overwrite_ab=True, overwrite_b=True, check_finite=False
        )
        found = np.where(self.fixed, self.nodes, solution[self.of_node] / unit)
        return found, solution[self.of_piece] / weight[:, np.newaxis]

    def within(self, largest_deviation: float) -> tuple[FloatArray, FloatArray, float]:
        """Nodal values, moments and the longest cut-off length found that keeps the deviation.

        The largest deviation need not grow with the length, so lengths are halved from the longest
        one down; then false position, on logarithms, between the first that keeps it and its
        predecessor.
        """
        allowed = checked.number("largest_deviation", largest_deviation, above=0.0, largest=HIGHEST)
        length, above = min(LONGEST * self.mean, float(np.sum(self.step))), 0.0
        while True:
            nodes, moments = self.solve(length)
            deviation = float(np.max(np.abs(nodes[:, 0] - self.nodes[:, 0])))
            if deviation <= allowed:
                break
            high, above = length, deviation
            length *= 0.5
            if length < SHORTEST * float(np.min(self.step)):
                raise GeometryError(
                    f"no spline was found within {allowed:g} of all points; the nearest one has a"
                    f" deviation of {above:g}, from rounding; allowed: more",
                    key="largest_deviation",
                    value=repr(allowed),
                )
        best = nodes, moments, length
        if not above:
            return best
        log_low, log_high = math.log(length), math.log(high)
        below = deviation
        for _ in range(MAX_SEARCH):
            if below >= NEAR_ENOUGH * allowed or log_high - log_low < 1e-4:
                break
            wanted = math.log(0.5 * (1.0 + NEAR_ENOUGH) * allowed)
            share = (wanted - math.log(max(below, TINY))) / (
                math.log(above) - math.log(max(below, TINY))
            )
            middle = log_low + min(max(share, 0.1), 0.9) * (log_high - log_low)
            nodes, moments = self.solve(math.exp(middle))
            deviation = float(np.max(np.abs(nodes[:, 0] - self.nodes[:, 0])))
            if deviation <= allowed:
                best = nodes, moments, math.exp(middle)
                log_low, below = middle, deviation
            else:
                log_high, above = middle, deviation
        return best


def from_stress(step: FloatArray, starts: FloatArray, moments: FloatArray) -> FloatArray:
    """(m, 6) Taylor coefficients from u, u', u'' at the left ends and the moments of u'''.

    u''' = e0 + e1 (2 t - 1) + e2 (6 t^2 - 6 t + 1) with e = d (1, sqrt 3, sqrt 5).
    """
    e0, e1, e2 = (moments * (1.0, ROOT_3, ROOT_5)).T
    return np.stack(
        (
            starts[:, 0],
            starts[:, 1] * step,
            0.5 * starts[:, 2] * step**2,
            (e0 - e1 + e2) / 6.0,
            (2.0 * e1 - 6.0 * e2) / 24.0,
            6.0 * e2 / 60.0,
        ),
        axis=1,
    )
