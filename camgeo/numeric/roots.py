"""Bracketed roots and inverses of functions, many at once.

scipy's solvers take one bracket at a time and their import takes longer than the rest of a check;
this gives the same guarantee (the root never leaves its bracket) over arrays.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final

import numpy as np

from camgeo.numeric.arrays import BoolArray, FloatArray, IntArray

Function = Callable[[FloatArray], FloatArray]

MAX_STEPS = 200
"""Most steps; bisection alone needs 1,074 for any two doubles and 60 for two of similar size."""


def bracketed_roots(
    function: Function,
    low: FloatArray,
    high: FloatArray,
    rows: IntArray | None = None,
    ends: FloatArray | None = None,
) -> FloatArray:
    """`indexed_roots` of a `function` (k,) -> (k,) that is the same for all brackets.

    `rows` (n,) for a function that gives (m, k) values, m quantities at once: which of them to
    solve for in each bracket.
    """

    def values(x: FloatArray, which: IntArray) -> FloatArray:
        found = function(x)
        return found if rows is None else found[rows[which], np.arange(len(x))]

    return indexed_roots(values, low, high, ends)


def indexed_roots(
    function: Callable[[FloatArray, IntArray], FloatArray],
    low: FloatArray,
    high: FloatArray,
    ends: FloatArray | None = None,
) -> FloatArray:
    """Return one root in each bracket.

    Parameters
    ----------
    function : (k,), (k,) -> (k,), the values at k arguments, given the numbers of their brackets;
        any subset of the brackets may be requested.
    low, high : (n,), ends of the brackets; the values there have opposite signs or are zero.
    ends : (2, n) these values, if they are known.

    Returns
    -------
    (n,) the roots, to the last bits of the argument.

    Chandrupatla's method: inverse quadratic interpolation where it is safe, bisection elsewhere
    (T. R. Chandrupatla, Adv. Eng. Software 28 (1997) 145-149).
    """
    if not len(low):
        return np.array(low, dtype=np.float64)
    # Of each bracket the newest place, the one across the root, and the one before: x, f(x).
    every = np.arange(len(low))
    f_low, f_high = (function(low, every), function(high, every)) if ends is None else ends
    a, b = np.stack((high, f_high)), np.stack((low, f_low))
    c = a.copy()
    step = np.full_like(a[0], 0.5)
    root: FloatArray = np.where(np.abs(a[1]) < np.abs(b[1]), a[0], b[0])
    active = np.flatnonzero((a[1] != 0.0) & (b[1] != 0.0))
    for _ in range(MAX_STEPS):
        if not len(active):
            break
        before, across = a[:, active], b[:, active]
        x = before[0] + step[active] * (across[0] - before[0])
        new = np.stack((x, function(x, active)))
        same = np.sign(new[1]) == np.sign(before[1])
        last = np.where(same, before, across)
        across = np.where(same, across, before)
        a[:, active], b[:, active], c[:, active] = new, across, last
        nearer = np.abs(new[1]) < np.abs(across[1])
        root[active] = np.where(nearer, new[0], across[0])
        width, floor = np.abs(across[0] - new[0]), np.spacing(np.abs(root[active]))
        active = active[(new[1] != 0.0) & (width > 2.0 * floor)]
        step[active] = _next_step(a[:, active], b[:, active], c[:, active])
    return root


def _next_step(newest: FloatArray, across: FloatArray, last: FloatArray) -> FloatArray:
    """Fraction of the way from the `newest` place to that `across` the root for the next step."""
    (a, fa), (b, fb), (c, fc) = newest, across, last
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        xi = (a - b) / (c - b)
        phi = (fa - fb) / (fc - fb)
        quadratic = (phi**2 < xi) & ((1.0 - phi) ** 2 < 1.0 - xi)
        t = fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
        smallest = np.spacing(np.abs(a)) / np.abs(b - a)
    t = np.where(quadratic & np.isfinite(t), t, 0.5)
    smallest = np.minimum(smallest, 0.5)
    share: FloatArray = np.clip(t, smallest, 1.0 - smallest)
    return share


def sign_changes(grid: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the ends (k,), (k,) of the grid cells over which `values` changes sign.

    `values` (..., m) at `grid` (..., m), see `_changing`.
    """
    change = _changing(values)
    return grid[..., :-1][change], grid[..., 1:][change]


def _changing(values: FloatArray) -> BoolArray:
    """(..., m - 1) the grid cells over which `values` (..., m) changes sign.

    Each row has a grid of its own; the cells come row by row. A grid point that is a root itself
    makes one cell, to its right (to its left for the last of a row).
    """
    sign = np.sign(values)
    change: BoolArray = sign[..., :-1] * sign[..., 1:] < 0.0
    change |= (sign[..., :-1] == 0.0) & (sign[..., 1:] != 0.0)
    change[..., -1] |= (sign[..., -1] == 0.0) & (sign[..., -2] != 0.0)
    return change


def roots_on_grid(function: Function, grid: FloatArray) -> FloatArray:
    """Roots of `function` indicated by a sign change on a row of `grid` (..., m), row by row.

    One call of the function evaluates all rows, however many there are. A function that gives
    several quantities at once, (k, n), has the roots of all of them, one quantity after the other.
    """
    found = function(grid.ravel())
    values = found.reshape(found.shape[:-1] + grid.shape)
    of_each = math.prod(grid.shape[:-1])

    def in_row(x: FloatArray, row: IntArray) -> FloatArray:
        found = function(x)
        return found if found.ndim == 1 else found[row // of_each, np.arange(len(x))]

    return roots_in_rows(in_row, grid, values)[0]


def roots_in_rows(
    function: Callable[[FloatArray, IntArray], FloatArray], grid: FloatArray, values: FloatArray
) -> tuple[FloatArray, IntArray]:
    """(k,), (k,) roots indicated by a sign change along a row of `values` (..., m), and the numbers
    of their rows, counted over all rows.

    Parameters
    ----------
    function : (n,), (n,) -> (n,), the values at n arguments, given the numbers of their rows.
    grid : (m,), or (..., m) for the last of the rows, the arguments of `values`.
    """
    change = _changing(values)
    sides = (slice(None, -1), slice(1, None))
    low, high = (np.broadcast_to(grid[..., each], change.shape)[change] for each in sides)
    ends = np.stack([values[..., each][change] for each in sides])
    row = np.flatnonzero(change) // change.shape[-1]
    return indexed_roots(lambda x, which: function(x, row[which]), low, high, ends), row


MOST_STEPS: Final = 80
"""Most steps; halving alone needs 60."""

CLOSE: Final = 2.0 * float(np.finfo(np.float64).eps)
"""Fraction of the range of x below which a step of Newton's method counts as rounding."""


def inverse(function: Function, slope: Function, edges: FloatArray, y: FloatArray) -> FloatArray:
    """(n,) x with function(x) = `y` (n,), to the last bits.

    Parameters
    ----------
    function : (k,) -> (k,), ascending over `edges`.
    slope : its derivative, above 0.
    edges : (m + 1,) ascending, with `y` between the values at the first and the last; at the value
        of an edge the result is the edge itself.

    Newton's method, kept in its bracket by halving.
    """
    marks = function(edges)
    piece = np.clip(np.searchsorted(marks, y, "right") - 1, 0, len(edges) - 2)
    low, high = edges[piece], edges[piece + 1]
    width = float(edges[-1] - edges[0])
    x = low + (y - marks[piece]) / (marks[piece + 1] - marks[piece]) * (high - low)
    x = np.where(y >= marks[-1], edges[-1], x)
    for _ in range(MOST_STEPS):
        miss = function(x) - y
        low, high = np.where(miss < 0.0, x, low), np.where(miss > 0.0, x, high)
        step = x - miss / slope(x)
        step = np.where((step >= low) & (step <= high), step, 0.5 * (low + high))
        step = np.where(miss == 0.0, x, step)
        done = np.abs(step - x) <= CLOSE * width
        x = step
        if np.all(done):
            break
    return x
