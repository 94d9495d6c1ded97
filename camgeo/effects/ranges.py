"""Ranges of the turn where a quantity is below a limit."""

from __future__ import annotations

import numpy as np

from camgeo.effects.effect import Quantity
from camgeo.effects.lost_contact import Range
from camgeo.numeric.arrays import BoolArray, FloatArray, merged
from camgeo.numeric.extremes import Extreme, grid_of, piecewise_lowest
from camgeo.numeric.roots import roots_on_grid


def ranges_below(
    quantity: Quantity, edges: FloatArray, limit: float, lowest: Extreme
) -> tuple[Range, ...]:
    """The ranges where `quantity` is below `limit`, by ascending start.

    Parameters
    ----------
    quantity : smooth between neighbouring `edges`.
    edges : (k,) [rad] from 0 to 2 pi.
    lowest : its smallest value; the range around it is found however short it is. Others are found
        if they are longer than 1/32 of a piece.
    """

    def above(phi: FloatArray) -> FloatArray:
        return quantity(phi, "right") - limit

    cuts = merged(np.concatenate((edges, [lowest.place])))
    cuts = merged(np.concatenate((cuts, roots_on_grid(above, grid_of(cuts)))))
    below = above(0.5 * (cuts[:-1] + cuts[1:])) < 0.0
    found = []
    for pieces in runs(below):
        passing = pieces.index(0) if 0 in pieces else 0  # a run may pass the end of the turn
        halves = [half for half in (pieces[:passing], pieces[passing:]) if half]
        low = min(
            (piecewise_lowest(quantity, cuts[half[0] : half[-1] + 2]) for half in halves),
            key=lambda each: each.value,
        )
        found.append(Range(float(cuts[pieces[0]]), float(cuts[pieces[-1] + 1]), low))
    if not found and lowest.value < limit:
        found.append(Range(lowest.place, lowest.place, lowest))
    return tuple(found)


def runs(inside: BoolArray) -> list[list[int]]:
    """The pieces of a turn that are `inside` (n,), grouped into runs of neighbours.

    A run that passes the end of the turn counts as one, and comes last.
    """
    found: list[list[int]] = []
    for piece in np.flatnonzero(inside):
        if found and found[-1][-1] == piece - 1:
            found[-1].append(int(piece))
        else:
            found.append([int(piece)])
    if len(found) > 1 and inside[0] and inside[-1]:
        found.append(found.pop() + found.pop(0))
    return found
