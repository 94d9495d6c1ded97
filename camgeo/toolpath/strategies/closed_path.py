"""What strategies on a closed path share: its fit, and one round of it."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.contour.fit import Effort
from camgeo.errors import GeometryError, UndercutError
from camgeo.toolpath.cut import Cut
from camgeo.toolpath.leads import started
from camgeo.toolpath.moves import ArcFeed, Feed, Move

HALF_TURN = math.pi
"""No arc of a program exceeds half a turn: the rules of controllers grow strict beyond it."""


def fitted(cut: Cut, tolerance: float, effort: Effort) -> Contour:
    """The cutter's path as lines and arcs within `tolerance` [mm], in the direction of cutting.

    It begins in the middle of its longest piece.

    Raises
    ------
    GeometryError
        With key "output.gcode.tool_diameter", if the cutter does not reach all of the boundary.
    """
    try:
        contour = cut.centre.arcs(tolerance, effort).contour
    except UndercutError as error:
        raise GeometryError(
            f"the cutter is too large for the {cut.name}: a concave part of it bends more tightly"
            f" than the cutter ({error.message})",
            key="output.gcode.tool_diameter",
        ) from None
    if not cut.centre.hole:
        contour = contour.reversed()
    longest = int(np.argmax(contour.lengths))
    return started(contour, longest).split(HALF_TURN)


def once_round(contour: Contour, z: float, feed: float) -> Iterator[Move]:
    """The moves from the contour's first vertex back to it, at one height."""
    for end, sweep, middle in zip(contour.ends, contour.sweeps, contour.centres, strict=True):
        point = (float(end.real), float(end.imag), z)
        if sweep == 0.0:
            yield Feed(point, feed)
        else:
            yield ArcFeed(point, (float(middle.real), float(middle.imag)), bool(sweep > 0.0), feed)
