"""Profile: round one boundary, outside of material or inside of a hole, with tangential leads."""

from __future__ import annotations

from typing import Final

from camgeo.contour.fit import Effort
from camgeo.part.part import Wall
from camgeo.toolpath.cut import Cut, passes
from camgeo.toolpath.leads import quarter_circle_lead
from camgeo.toolpath.moves import ArcFeed, Feed, Move, Rapid
from camgeo.toolpath.strategies.closed_path import fitted, once_round
from camgeo.toolpath.tool import Tool

NAME: Final = "profile"


def cut(wall: Wall, tool: Tool, pass_depth: float | None, room: float, note: str = "") -> Cut:
    """The cut of a wall from its upper edge to its lower one, the material on the right."""
    return Cut(
        name=wall.boundary.name,
        strategy=NAME,
        tool=tool,
        centre=wall.boundary.beside(tool.radius),
        right=wall.boundary.name,
        left="",
        depths=passes(wall.z1, wall.z0, pass_depth),
        room=room,
        note=note,
    )


def moves(cut: Cut, safe_height: float, tolerance: float, effort: Effort) -> list[Move]:
    """At each depth: down beside the path, onto it and once round, off it and up.

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
    found: list[Move] = []
    for z in cut.depths:
        found += (
            Rapid((lead.start.real, lead.start.imag, safe_height)),
            Feed((lead.start.real, lead.start.imag, z), cut.tool.plunge_feed),
            ArcFeed((point.real, point.imag, z), centre, ccw=True, feed=feed),
            *once_round(contour, z, feed),
            ArcFeed((lead.end.real, lead.end.imag, z), centre, ccw=True, feed=feed),
            Rapid((lead.end.real, lead.end.imag, safe_height)),
        )
    return found
