"""Stretches of a turn in which something holds."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from camgeo.numeric.arrays import BoolArray, FloatArray, merged
from camgeo.numeric.peaks import grid_of
from camgeo.numeric.roots import roots_on_grid
from camgeo.units import TURN


def stretch_below(
    function: Callable[[FloatArray], FloatArray], edges: FloatArray, place: float
) -> tuple[float, float] | None:
    """From, to [rad] of the stretch around `place` in which `function` is negative.

    Parameters
    ----------
    function : (n,) -> (n,), smooth between neighbouring edges.
    edges : (k,) angles from 0 to 2 pi, both included, ascending.
    place : where it is lowest [rad].

    Returns
    -------
    As of `stretch_around`; None if it is negative at `place` alone, if anywhere. A root nearer to
    an edge than `camgeo.numeric.peaks.INSET` of a piece is taken to be at the edge.
    """
    cuts = merged(np.concatenate((edges, [place])))
    cuts = merged(np.concatenate((cuts, roots_on_grid(function, grid_of(cuts)))))
    return stretch_around(cuts, function(0.5 * (cuts[:-1] + cuts[1:])) < 0.0, place)


def stretch_around(cuts: FloatArray, inside: BoolArray, place: float) -> tuple[float, float] | None:
    """From, to [rad] of the stretch around `place` of which all is inside.

    Parameters
    ----------
    cuts : (n + 1,) angles from 0 to 2 pi, both included, ascending; `place` is one of them.
    inside : (n,) which of the pieces between two cuts belong to it.

    Returns
    -------
    (0, 2 pi) for all of the turn; else the end lies in [0, 2 pi), below the start if the stretch
    passes the end of the turn. None if no piece beside `place` is inside.
    """
    if np.all(inside):
        return 0.0, TURN
    pieces = len(inside)
    after = int(np.searchsorted(cuts, place)) % pieces
    if not (inside[after] or inside[after - 1]):
        return None
    first = last = after if inside[after] else (after - 1) % pieces
    while inside[first - 1]:
        first -= 1
    while inside[(last + 1) % pieces]:
        last += 1
    return float(cuts[first % pieces]), float(cuts[last % pieces + 1]) % TURN
