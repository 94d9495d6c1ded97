"""The outermost of many pieces over a turn, each of which covers a range of it.

This shows what holds a follower: of the branches that its path meets, over the cam angle, or of the
circles that a flat face touches, over the direction of its normal. Which piece is outermost changes
only at the ends of ranges and where two pieces cross, so it is known everywhere, not just at
samples.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from camgeo.errors import GeometryError
from camgeo.numeric.arrays import BoolArray, FloatArray, IntArray, Side, ascending, grouped
from camgeo.units import TURN

NONE = -1
"""Number in place of a piece where there is none."""

MOST_PAIRS = 2_000_000
"""Most pairs of a piece and a cell: 25 layers of a contour of 20,000 pieces. A contour that is
smooth except for a few corners has one layer."""

Pairs = tuple[IntArray, IntArray]
"""(p,) cells, ascending, and (p,) pieces that cover them, ascending in each cell."""


@dataclass(frozen=True, slots=True, eq=False)
class Cells:
    """Ranges (m,) of an angle [rad] between neighbouring ends of ranges; the last crosses 0."""

    low: FloatArray
    high: FloatArray

    @classmethod
    def between(cls, nodes: FloatArray) -> Cells:
        """Those between `nodes` (m,) in [0, 2 pi), ascending."""
        return cls(nodes, np.append(nodes[1:], nodes[0] + TURN))

    def __len__(self) -> int:
        return len(self.low)


def covered(cells: Cells, first: IntArray, count: IntArray, what: str) -> Pairs:
    """The pieces k (n,) that cover `count` (n,) cells from `first` (n,) on, cell by cell.

    Raises GeometryError if there are too many pairs; `what` are the pieces, in a message.
    """
    if np.sum(count) > MOST_PAIRS:
        raise too_rough(what, np.sum(count) / len(cells))
    piece, rank = grouped(count)
    cell = np.remainder(first[piece] + rank, len(cells))
    order = np.argsort(cell, kind="stable")
    return cell[order], piece[order]


def too_rough(what: str, layers: float) -> GeometryError:
    """The error for a contour of too many layers."""
    return GeometryError(
        f"the contour is too rough to be replayed: its {what} in {layers:.0f} layers; smooth it"
        " first"
    )


def seen(cell: IntArray, low: FloatArray, high: FloatArray) -> BoolArray:
    """(p,) False for pieces that lie behind another one throughout their `cell` (p,), where their
    heights are between `low` and `high` (p,).
    """
    least = np.full(int(np.max(cell, initial=-1)) + 1, -np.inf)
    np.maximum.at(least, cell, low)
    return np.asarray(high >= least[cell])


def together(cell: IntArray) -> Iterator[Pairs]:
    """All pairs of places in `cell` (p,), ascending, that have the same one, in batches."""
    step = 1
    while np.any(same := cell[step:] == cell[:-step]):
        index = np.flatnonzero(same)
        yield index, index + step
        step += 1


def outermost(
    cells: Cells,
    pairs: Pairs,
    crossings: FloatArray,
    height: Callable[[IntArray, FloatArray], FloatArray],
) -> tuple[FloatArray, IntArray, IntArray]:
    """Borders (g,) [rad]; the cell that each of them lies in or begins; and (g,) the highest piece
    from each to the next, the last one of several, or `NONE`.

    Parameters
    ----------
    crossings : (k,) [rad] in [0, 2 pi), where pieces of `pairs` in one cell are of the same height.
    height : of the pieces (q,) at angles (q,) [rad].
    """
    cell, piece = pairs
    borders = ascending(np.concatenate((cells.low, crossings)))
    # Before the first node it is still the last cell, which reaches across 0.
    parent = np.remainder(np.searchsorted(cells.low, borders, "right") - 1, len(cells))
    first = np.searchsorted(cell, parent, "left")
    count = np.searchsorted(cell, parent, "right") - first
    fine, rank = grouped(count)
    candidate = piece[first[fine] + rank]
    several = count[fine] > 1
    middle = 0.5 * (borders + np.append(borders[1:], borders[0] + TURN))
    heights = np.zeros(len(fine))
    heights[several] = height(candidate[several], middle[fine[several]])
    order = np.lexsort((heights, fine))
    fine, candidate = fine[order], candidate[order]
    top = np.flatnonzero(np.diff(fine, append=-1))
    held = np.full(len(borders), NONE)
    held[fine[top]] = candidate[top]
    return borders, parent, held


def changes(borders: FloatArray, held: IntArray) -> tuple[FloatArray, IntArray]:
    """Those of `borders` (g,) at which the piece changes, at least one, each with the piece that
    follows.
    """
    changed = held != np.roll(held, 1)
    changed[0] |= not np.any(changed)
    return borders[changed], held[changed]


def piece_at(borders: FloatArray, held: IntArray, angle: FloatArray, side: Side) -> IntArray:
    """(n,) the piece at `angle` (n,) [rad] of any turn, seen from that side; see `changes`."""
    found: IntArray = held[np.searchsorted(borders, np.remainder(angle, TURN), side) - 1]
    return found
