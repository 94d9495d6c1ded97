"""Distances from lines and arcs, in closed form.

That between two pieces is taken at an end of one of them, or on their common normal, or is 0
because they cross.
"""

from __future__ import annotations

import numpy as np

from camgeo.contour.contour import Fit
from camgeo.contour.pieces import HALF_TURN, Pieces, Run
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, taken

BLOCK = 500_000
"""Pairs that are computed at once."""


def distances(points: ComplexArray, run: Run) -> FloatArray:
    """(n,) exact distance [mm] of each of `points` (n,) from the nearest piece of `run`."""
    pieces = Pieces.of(run)
    middles, reaches = _bounds(pieces)
    step = max(1, BLOCK // len(pieces))
    found = [np.empty(0)]
    for k in range(0, len(points), step):
        some = points[k : k + step]
        off = np.abs(some[:, None] - middles)
        nearest = np.min(off + reaches, axis=1)
        row, column = np.nonzero(off - reaches <= nearest[:, None])
        apart = taken(pieces, column).apart(some[row])
        first = np.flatnonzero(np.diff(row, prepend=-1))
        found.append(np.minimum.reduceat(apart, first))
    return np.concatenate(found)


def least_distance(one: Run, other: Run) -> float:
    """The distance [mm] between two chains, each piece beginning where the one before it ends; 0 if
    they meet.
    """
    least = min(
        float(np.min(distances(_ends(one), other))), float(np.min(distances(_ends(other), one)))
    )
    a, b = Pieces.of(one), Pieces.of(other)
    (of_a, reach_a), (of_b, reach_b) = _bounds(a), _bounds(b)
    step = max(1, BLOCK // len(b))
    for k in range(0, len(a), step):
        rows = np.arange(k, min(k + step, len(a)))
        off = np.abs(of_a[rows, None] - of_b) - reach_a[rows, None] - reach_b
        row, column = np.nonzero(off < least)
        if len(row):
            least = min(least, _between(taken(a, rows[row]), taken(b, column)))
    return least


def surely_apart(one: Fit, other: Fit) -> float:
    """Least distance [mm] of the exact curves of two fits; not positive where they may meet."""
    contours = (Pieces.around([each.contour]) for each in (one, other))
    return least_distance(*contours) - one.deviation - other.deviation


def _ends(chain: Run) -> ComplexArray:
    """(n + 1,) complex [mm], the ends of its n pieces."""
    return np.append(chain.starts, chain.ends[-1:])


def _bounds(pieces: Pieces) -> tuple[ComplexArray, FloatArray]:
    """(n,) the middle [mm] of each piece, and a bound of the distance of its points from there."""
    middles = pieces.at(np.full(len(pieces), 0.5))
    # Of an arc up to half a turn the ends are farthest from its middle.
    small = np.abs(pieces.sweeps) <= HALF_TURN
    reaches = np.where(small, np.abs(pieces.starts - middles), 2.0 * pieces.radii)
    return middles, reaches


def _between(a: Pieces, b: Pieces) -> float:
    """The least distance [mm] of inner points of pairs on a common normal, or 0 where they cross.

    Infinite if there is neither.
    """
    return min(_of_arcs(a, b), _of_arc_and_line(a, b), _of_arc_and_line(b, a), _of_lines(a, b))


def _least(values: FloatArray, valid: BoolArray) -> float:
    return float(np.min(values[valid], initial=np.inf))


def _of_arcs(a: Pieces, b: Pieces) -> float:
    between = b.centres - a.centres
    apart = np.abs(between)
    bent = (a.sweeps != 0.0) & (b.sweeps != 0.0) & (apart > 0.0)
    along: ComplexArray = np.divide(np.where(bent, between, 1.0), np.where(bent, apart, 1.0))
    ra, rb = a.radii, b.radii
    least = np.inf
    for one in (1.0, -1.0):
        for other in (1.0, -1.0):
            gap = np.abs(apart + other * rb - one * ra)
            least = min(least, _least(gap, bent & a.faces(one * along) & b.faces(other * along)))
    lever = (apart**2 + ra**2 - rb**2) / (2.0 * np.where(bent, apart, 1.0))
    meet = bent & (np.abs(lever) <= ra)
    height = np.sqrt(np.maximum(ra**2 - lever**2, 0.0))
    for side in (1j, -1j):
        arm: ComplexArray = along * (lever + side * height)
        if np.any(meet & a.faces(arm) & b.faces(a.centres + arm - b.centres)):
            return 0.0
    return least


def _of_arc_and_line(arc: Pieces, line: Pieces) -> float:
    mixed = (arc.sweeps != 0.0) & (line.sweeps == 0.0) & (line.starts != line.ends)
    share = line.feet(arc.centres)
    chord = line.ends - line.starts
    foot = line.starts + share * chord - arc.centres
    inside = mixed & (share >= 0.0) & (share <= 1.0)
    gap = np.abs(np.abs(foot) - arc.radii)
    least = _least(gap, inside & arc.faces(foot))
    length = np.where(mixed, np.abs(chord), 1.0)
    half = np.sqrt(np.maximum(arc.radii**2 - np.abs(foot) ** 2, 0.0)) / length
    meet = mixed & (np.abs(foot) <= arc.radii)
    for side in (1.0, -1.0):
        place = share + side * half
        on = meet & (place >= 0.0) & (place <= 1.0)
        if np.any(on & arc.faces(line.starts + place * chord - arc.centres)):
            return 0.0
    return least


def _of_lines(a: Pieces, b: Pieces) -> float:
    along, across = a.ends - a.starts, b.ends - b.starts
    sine = (np.conj(along) * across).imag
    straight = (a.sweeps == 0.0) & (b.sweeps == 0.0) & (sine != 0.0)
    between, safe = b.starts - a.starts, np.where(straight, sine, 1.0)
    first = (np.conj(between) * across).imag / safe
    second = (np.conj(between) * along).imag / safe
    on = straight & (first >= 0.0) & (first <= 1.0) & (second >= 0.0) & (second <= 1.0)
    return 0.0 if np.any(on) else np.inf
