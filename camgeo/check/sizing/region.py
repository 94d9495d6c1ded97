"""Where the cam axis may lie, for each row of a grid, with exact borders.

The region of the transmission angle is convex: a row of equal Im P meets it in one interval. Its
ends are the largest lower and the smallest upper bound of Re P over the cam angles.
"""

from __future__ import annotations

import numpy as np

from camgeo.check.sizing.conditions import conditions, samples_of
from camgeo.check.sizing.flocke import Flocke
from camgeo.check.sizing.task import Task
from camgeo.curve.pieces import smooth_pieces
from camgeo.numeric.arrays import FloatArray

SAMPLES = 65
SECTIONS, STEPS = 8, 12
"""A bracket is divided into sections; the two about the best cut form the next one."""


def row_limits(task: Task, tangent: float, rows: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Lower and upper end (k,), (k,) of Re P [mm] at Im P = `rows` (k,) [mm].

    In a row that does not meet the region the lower end is above the upper one. Ends are exact up
    to rounding where the decisive bound is smooth over the cam angle.
    """
    share = np.linspace(1e-9, 1.0 - 1e-9, SAMPLES)
    pieces = [
        each.start + (each.end - each.start) * (share[:1] if each.dwell else share)
        for each in smooth_pieces(task.motion)
    ]
    phi = np.concatenate(pieces)
    left = np.concatenate([np.append(each[:1], each[:-1]) for each in pieces])
    right = np.concatenate([np.append(each[1:], each[-1:]) for each in pieces])
    low = np.full(len(rows), -np.inf)
    high = np.full(len(rows), np.inf)
    for t in (tangent, -tangent):
        for upper in (False, True):
            values = _bound(task, t, phi[np.newaxis, :], rows[:, np.newaxis], upper=upper)
            best = np.argmax(values, axis=1)
            ends = _refined(task, t, left[best], right[best], rows, upper=upper)
            ends = np.maximum(ends, values[np.arange(len(rows)), best])
            if upper:
                high = np.minimum(high, -ends)
            else:
                low = np.maximum(low, ends)
    start = task.terms(np.zeros(1))
    low = np.where(rows < start.p[0], low, np.inf)
    return low, high


def _bound(
    task: Task, tangent: float, phi: FloatArray, rows: FloatArray, *, upper: bool
) -> FloatArray:
    """Lower bound of Re P, or minus the upper one, from u >= `tangent` v; -inf where it has none.

    `phi` and `rows` are broadcast; the motion is evaluated once at each cam angle.
    """
    terms = task.terms(phi.ravel())
    factor = (tangent + 1j) * terms.turn
    along, across = factor.real.reshape(phi.shape), factor.imag.reshape(phi.shape)
    constant = (tangent * terms.q - terms.p).reshape(phi.shape)
    rest = constant + across * rows
    used = np.broadcast_to(along < 0.0 if upper else along > 0.0, rest.shape)
    out = np.full(rest.shape, -np.inf)
    np.divide(rest, np.broadcast_to(along, rest.shape), out=out, where=used)
    if upper:
        out[used] *= -1.0
    return out


def _refined(
    task: Task,
    tangent: float,
    left: FloatArray,
    right: FloatArray,
    rows: FloatArray,
    *,
    upper: bool,
) -> FloatArray:
    """The largest bound (k,) in each bracket of cam angles, one for each row."""
    share = np.arange(1.0, SECTIONS) / SECTIONS
    best = np.full(len(rows), -np.inf)
    each = np.arange(len(rows))
    for _ in range(STEPS):
        grid = left[:, np.newaxis] + (right - left)[:, np.newaxis] * share
        values = _bound(task, tangent, grid, rows[:, np.newaxis], upper=upper)
        index = np.argmax(values, axis=1)
        best = np.maximum(best, values[each, index])
        width = (right - left) / SECTIONS
        left, right = grid[each, index] - width, grid[each, index] + width
    return best


def ratio_map(task: Task, columns: FloatArray, rows: FloatArray, most: float) -> FloatArray:
    """(rows, columns) largest r_R/r_K for the sign that matters, for a picture.

    On a grid of cam angles; `most` where it is larger or the roller centre stands still.
    """
    places = columns + 1j * rows[:, np.newaxis]
    now = conditions(task, 0.0, most, samples_of(task))
    with np.errstate(all="ignore"):  # a pitch curve may have cusps here
        worst = np.array([now.worst_ratio(row) for row in places])
    return np.where(worst <= most, np.maximum(worst, 0.0), most)


def flocke_limits(found: Flocke, rows: FloatArray) -> tuple[FloatArray, FloatArray]:
    """As `row_limits`, for the region of Flocke's construction."""
    low, high = np.full(len(rows), -np.inf), np.full(len(rows), np.inf)
    for normal, bound in zip(found.normals, found.bounds, strict=True):
        rest = bound - normal.imag * rows
        if normal.real > 0.0:
            low = np.maximum(low, rest / normal.real)
        elif normal.real < 0.0:
            high = np.minimum(high, rest / normal.real)
    return low, high
