"""Parts of cubics against the arcs through their ends and middles: the bound of the distance.

With c and r of the arc, q(t) = (|x(t) - c|^2 - r^2) / 2r is a polynomial of degree 6; its Bernstein
coefficients over quarters of the part enclose it, and the distance of x(t) from the circle follows
from q. For a line the same with its normal, of degree 3.
"""

from __future__ import annotations

import math
from functools import cache
from itertools import pairwise
from typing import Final

import numpy as np

from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, frozen

WIDEST = 0.5
"""A part turns from its chord, and a ray from the middle one, by at most this angle [rad]; the two
together stay far from a right angle."""

QUARTERS = 4
"""Parts of [0, 1] over each of which the Bernstein coefficients bound: they are too large by half
over the whole, and by a twentieth over quarters."""

ORDER: Final = 6
"""Degree of q."""


@cache
def _over_quarters() -> FloatArray:
    """(7, 28): Bernstein coefficients of degree 6 over [0, 1] -> those over each quarter."""
    rows = np.zeros((ORDER + 1, QUARTERS, ORDER + 1))
    for k in range(ORDER + 1):
        for quarter in range(QUARTERS):
            low, high = quarter / QUARTERS, (quarter + 1) / QUARTERS
            for upper in range(ORDER + 1):
                values = [float(j == k) for j in range(ORDER + 1)]
                for level in range(ORDER):
                    place = high if level < upper else low
                    values = [
                        (1.0 - place) * one + place * other for one, other in pairwise(values)
                    ]
                rows[k, quarter, upper] = values[0]
    return frozen(rows.reshape(ORDER + 1, -1), np.float64)


PAIRS = tuple(
    (i, j, math.comb(3, i) * math.comb(3, j) / math.comb(ORDER, i + j))
    for i in range(4)
    for j in range(4)
)
"""Product of two cubics in Bernstein form: coefficient i + j gets its share of b_i b_j."""

ELEVATION = np.array(
    [
        [
            math.comb(3, i) * math.comb(3, k - i) / math.comb(ORDER, k) if 0 <= k - i <= 3 else 0.0
            for k in range(ORDER + 1)
        ]
        for i in range(4)
    ]
)
"""(4, 7): a cubic in Bernstein form of degree 6."""


def bounds_beside_arcs(
    parts: ComplexArray, aim: float, flattest: float
) -> tuple[FloatArray, FloatArray]:
    """Sagitta of the arc beside each part, 0 for a line, positive where it turns counter-clockwise;
    bound of the distance, infinite where the part does not surely run beside its arc.

    Where an arc would have more than the radius `flattest` the bound is such that the part is
    halved, until it is a line.
    """
    chords = parts[:, 3] - parts[:, 0]
    lengths = np.abs(chords)
    safe_lengths = np.where(lengths > 0.0, lengths, 1.0)
    local = (parts - parts[:, :1]) * np.conj(chords / safe_lengths)[:, None]
    local[:, 3] = lengths
    x, y = local.real, local.imag
    sides = np.diff(local, axis=1)
    forward = lengths > 0.0
    forward &= np.all(np.abs(sides.imag) <= math.tan(WIDEST) * sides.real, axis=1)

    from_line = np.max(np.abs((y @ ELEVATION) @ _over_quarters()), axis=1)
    line = from_line <= aim
    middle = 0.125 * (local[:, 0] + 3.0 * local[:, 1] + 3.0 * local[:, 2] + local[:, 3])
    # Through both ends and m: centre on x = L/2 at height h with |m|^2 = L m_x + 2 h m_y.
    height = np.where(line | (middle.imag == 0.0), 1.0, middle.imag)
    square = middle.real * (middle.real - lengths) + middle.imag * middle.imag
    centre = square / (2.0 * height)
    radius = np.where(forward, np.hypot(0.5 * lengths, centre), 1.0)
    from_arc, beside = _from_arcs(x, y, lengths, centre, radius)
    deep = 0.25 * lengths * lengths / (radius + np.abs(centre))
    sagitta = np.where(line, 0.0, np.sign(centre) * deep)
    from_arc = np.where(radius > flattest, np.maximum(from_arc, 8.0 * aim), from_arc)
    bound = np.where(line, from_line, np.where(beside, from_arc, np.inf))
    return sagitta, np.where(forward, bound, np.inf)


def _from_arcs(
    x: FloatArray, y: FloatArray, lengths: FloatArray, centre: FloatArray, radius: FloatArray
) -> tuple[FloatArray, BoolArray]:
    """Bound of the distance of parts, in the frame of their chords, from their circles; whether
    all rays from the centre to the part are near the middle one.
    """
    half = 0.5 / radius
    q = np.zeros((len(x), ORDER + 1))
    for i, j, share in PAIRS:
        q[:, i + j] += share * (x[:, i] * x[:, j] + y[:, i] * y[:, j])
    q *= half[:, None]
    # |x - c|^2 - r^2 = |x|^2 - 2 c x, for the circle passes through the origin.
    dot = (0.5 * lengths)[:, None] * x + centre[:, None] * y
    q -= ((2.0 * half)[:, None] * dot) @ ELEVATION
    off = np.max(np.abs(q @ _over_quarters()), axis=1)
    # |x - c| = sqrt(r^2 + 2 r q): the distance is q for small q, and at most this.
    inner = 1.0 - 2.0 * off / radius
    bound = 2.0 * off / (1.0 + np.sqrt(np.maximum(inner, 0.0)))
    arm = -np.sign(centre)[:, None] * (y - centre[:, None])
    aside = np.abs(x - 0.5 * lengths[:, None])
    beside = np.all((arm > 0.0) & (aside <= math.tan(WIDEST) * arm), axis=1)
    return bound, beside & (inner > 0.0)
