"""Milling strategies: each makes the moves of a cut. A new one is a function and a line below.

Every strategy runs around the closed path of the cutter's centre, and begins and ends with a
traverse at the safe height.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from types import MappingProxyType
from typing import Final

import numpy as np

from camgeo.contour.contour import Contour, Effort
from camgeo.errors import GeometryError, UndercutError
from camgeo.toolpath.cut import Cut
from camgeo.toolpath.leads import quarter_circle_lead, started
from camgeo.toolpath.moves import ArcFeed, Feed, Move, Rapid

HALF_TURN = math.pi
"""No arc of a program exceeds half a turn: controllers are strict beyond that."""


def profile(cut: Cut, safe_height: float, tolerance: float, effort: Effort) -> Iterator[Move]:
    """Along one boundary, outside material or inside a hole, with tangential leads.

    At each depth: down next to the path, onto it and once around, off it and up.

    Raises
    ------
    GeometryError
        If the cutter is too large for the boundary, or there is no room for leads.
    """
    contour = fitted(cut, tolerance, effort)
    point = complex(contour.vertices[0])
    lead = quarter_circle_lead(contour, cut.room)
    centre = (lead.centre.real, lead.centre.imag)
    feed = cut.tool.feed
    for z in cut.depths:
        yield Rapid((lead.start.real, lead.start.imag, safe_height))
        yield Feed((lead.start.real, lead.start.imag, z), cut.tool.plunge_feed)
        yield ArcFeed((point.real, point.imag, z), centre, ccw=True, feed=feed)
        yield from once_round(contour, z, feed)
        yield ArcFeed((lead.end.real, lead.end.imag, z), centre, ccw=True, feed=feed)
        yield Rapid((lead.end.real, lead.end.imag, safe_height))


def slot(cut: Cut, safe_height: float, tolerance: float, effort: Effort) -> Iterator[Move]:
    """One round between two boundaries, with a cutter as wide as the gap.

    Down on the path itself, once around at each depth, and up at the end.

    Raises
    ------
    GeometryError
        If the cutter is too large for the slot.
    """
    contour = fitted(cut, tolerance, effort)
    x, y = float(contour.vertices[0].real), float(contour.vertices[0].imag)
    yield Rapid((x, y, safe_height))
    for z in cut.depths:
        yield Feed((x, y, z), cut.tool.plunge_feed)
        yield from once_round(contour, z, cut.tool.feed)
    yield Rapid((x, y, safe_height))


Strategy = Callable[[Cut, float, float, Effort], Iterable[Move]]
"""Yields the moves of a cut from it, the safe height [mm], the tolerance of its path [mm] and the
effort of fitting."""

STRATEGIES: Final[Mapping[str, Strategy]] = MappingProxyType({"profile": profile, "slot": slot})


def fitted(cut: Cut, tolerance: float, effort: Effort) -> Contour:
    """The cutter's path as lines and arcs within `tolerance` [mm], in the direction of cutting.

    It begins in the middle of its longest piece.

    Raises
    ------
    GeometryError
        With key "output.gcode.tool_diameter", if the cutter cannot reach the whole boundary.
    """
    try:
        contour = cut.centre.arcs(tolerance, effort).contour
    except UndercutError as error:
        raise GeometryError(
            f"the cutter is too large for the {cut.name}: a concave part of it is more tightly"
            f" curved than the cutter ({error.message})",
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
