"""Smoothing splines: the mixed system of nodal values and moments, and the cut-off length."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.motion.spline_energy import (
    ROOT_3,
    ROOT_5,
    node_scales,
    pieces,
    positions,
)
from camgeo.numeric import checked
from camgeo.numeric.arrays import BoolArray, FloatArray

LONGEST: Final = 1e4
"""Largest cut-off length in mean distances of points; rounding grows with its cube and leaves
eight digits there."""

SHORTEST: Final = 1e-4
"""Smallest cut-off length tried, in shortest distances: its spline interpolates, nearly."""

NEAR_ENOUGH: Final = 0.97
"""The search for a cut-off length ends with a deviation of this share of the allowed one."""

MAX_SEARCH: Final = 40

HIGHEST: Final = 1e100
"""Largest size of y: with it and the spans that `camgeo.numeric.checked` allows no fifth derivative
overflows."""

TINY: Final = 1e-300


class Smoothing:
    """The smoothing problem of one set of points, solved for any cut-off length.

    With lambda = length^6 / mean distance a wave sin(x / length) in evenly spaced data comes out
    with half its height, a longer wave with more (1 / (1 + (length * angular frequency)^6)).

    The moments of s''' are unknowns beside the nodal values: the matrix then has the condition of a
    least squares problem and not its square, and the moments come out as exactly as the values.
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
        one on; then false position, on logarithms, between the first that keeps it and the next.
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
                    f" deviation of {above:g}, from rounding; allowed is more",
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
