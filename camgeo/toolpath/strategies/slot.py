"""Slot: one round between two boundaries, with a cutter as wide as their distance."""

from __future__ import annotations

from typing import Final

from camgeo.contour.fit import Effort
from camgeo.toolpath.cut import Cut
from camgeo.toolpath.moves import Feed, Move, Rapid
from camgeo.toolpath.strategies.closed_path import fitted, once_round

NAME: Final = "slot"


def moves(cut: Cut, safe_height: float, tolerance: float, effort: Effort) -> list[Move]:
    """Down on the path itself, once round at each depth, and up at the end.

    Raises
    ------
    GeometryError
        If the cutter is too large for the slot.
    """
    contour = fitted(cut, tolerance, effort)
    x, y = float(contour.vertices[0].real), float(contour.vertices[0].imag)
    found: list[Move] = [Rapid((x, y, safe_height))]
    for z in cut.depths:
        found += (Feed((x, y, z), cut.tool.plunge_feed), *once_round(contour, z, cut.tool.feed))
    return [*found, Rapid((x, y, safe_height))]
