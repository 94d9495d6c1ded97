"""Rounds along the closed path of the cutter's centre, at each depth."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from camgeo.contour.contour import Contour, Effort
from camgeo.errors import GeometryError, UndercutError
from camgeo.toolpath.cut import ContourCut, Cut
from camgeo.toolpath.leads import quarter_circle_lead, started
from camgeo.toolpath.moves import ArcFeed, Feed, Heights, Move, Rapid

HALF_TURN = math.pi
"""No arc of a program exceeds half a turn: controllers are strict beyond that."""


def profile(cut: Cut, heights: Heights, tolerance: float, effort: Effort) -> list[Move]:
    """Along one boundary, outside material or inside a hole, with tangential leads.

    At each depth: down next to the path, onto it and once around, off it and up.

    Raises
    ------
    GeometryError
        If the cutter is too large for the boundary, or there is no room for leads.
    """
    cut = contour_cut(cut)
    contour = fitted(cut, tolerance, effort)
    point = complex(contour.vertices[0])
    lead = quarter_circle_lead(contour, cut.room)
    centre = (lead.centre.real, lead.centre.imag)
    feed = cut.tool.feed
    found: list[Move] = []
    for z in cut.depths:
        found += (
            Rapid((lead.start.real, lead.start.imag, heights.clearance)),
            Feed((lead.start.real, lead.start.imag, z), cut.tool.plunge_feed),
            ArcFeed((point.real, point.imag, z), centre, ccw=True, feed=feed),
            *(move for _ in range(rounds(cut, z)) for move in once_round(contour, z, feed)),
            ArcFeed((lead.end.real, lead.end.imag, z), centre, ccw=True, feed=feed),
            Rapid((lead.end.real, lead.end.imag, heights.clearance)),
        )
    return found


def slot(cut: Cut, heights: Heights, tolerance: float, effort: Effort) -> list[Move]:
    """One round between two boundaries, with a cutter as wide as the gap.

    Down on the path itself, once around at each depth, and up at the end.

    Raises
    ------
    GeometryError
        If the cutter is too large for the slot.
    """
    cut = contour_cut(cut)
    contour = fitted(cut, tolerance, effort)
    x, y = float(contour.vertices[0].real), float(contour.vertices[0].imag)
    found: list[Move] = [Rapid((x, y, heights.clearance))]
    for z in cut.depths:
        found.append(Feed((x, y, z), cut.tool.plunge_feed))
        for _ in range(rounds(cut, z)):
            found += once_round(contour, z, cut.tool.feed)
    return [*found, Rapid((x, y, heights.clearance))]


def contour_cut(cut: Cut) -> ContourCut:
    """The cut, if it is one along a path; else TypeError."""
    if not isinstance(cut, ContourCut):
        raise TypeError(f"{cut.name}: the strategy {cut.strategy} runs along a path")
    return cut


def fitted(cut: ContourCut, tolerance: float, effort: Effort) -> Contour:
    """The cutter's path as lines and arcs within `tolerance` [mm], in the direction of cutting.

    It begins in the middle of its longest piece.

    Raises
    ------
    GeometryError
        With key "tool", if the cutter cannot reach the whole boundary.
    """
    try:
        contour = cut.centre.arcs(tolerance, effort).contour
    except UndercutError as error:
        raise GeometryError(
            f"the cutter is too large for the {cut.name}: a concave part of it is more tightly"
            f" curved than the cutter ({error.message})",
            key="tool",
        ) from None
    if not cut.centre.hole:
        contour = contour.reversed()
    longest = int(np.argmax(contour.lengths))
    return started(contour, longest).split(HALF_TURN)


def rounds(cut: ContourCut, z: float) -> int:
    """How often the cut goes round at a depth."""
    return 1 + cut.springs if z == cut.bottom else 1


def once_round(contour: Contour, z: float, feed: float) -> Iterator[Move]:
    """The moves from the contour's first vertex back to it, at one height."""
    for end, sweep, middle in zip(contour.ends, contour.sweeps, contour.centres, strict=True):
        point = (float(end.real), float(end.imag), z)
        if sweep == 0.0:
            yield Feed(point, feed)
        else:
            yield ArcFeed(point, (float(middle.real), float(middle.imag)), bool(sweep > 0.0), feed)
