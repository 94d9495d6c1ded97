"""Compensation of the cutter's radius by the controller: which side, how far, and what is written.

The moves of an operation are those of the cutter's centre whatever compensates for its radius.
With "wear" they are also what is programmed, and the controller moves the cutter off them by its
wear; with "control" the programmed path is their parallel through the cutter's edge, the wall.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final

from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import least_distance
from camgeo.geometry.contour.spline import Arc
from camgeo.milling.cut import ContourCut, Cut
from camgeo.milling.machine import Compensation
from camgeo.milling.milling import COMPUTED, CONTROL
from camgeo.milling.moves import ArcFeed, Feed, Move, Operation, Point, Stop, plane_piece
from camgeo.milling.track import Track, track_along

KEY: Final = "output.gcode.compensation"

SHARE: Final = 0.9
"""Share of what geometry allows that is used; the rest is for printed numbers and for what a
controller adds at joints."""

LEAST: Final = 1e-3
"""Wear [mm] below which compensation is of no use; limits are stated in whole steps of it."""

POINT: Final = 1e-6
"""An arc of a smaller radius [mm] is a corner."""

LEAD: Final = 2.0
"""Length of a straight lead in radii, or in wears: some controllers take one radius as too short
for the way on, and LinuxCNC's manual asks for two on the way off."""


def compensation_mode(cut: Cut) -> str:
    """How the cut's radius is compensated: one of `camgeo.milling.milling.COMPENSATIONS`."""
    return cut.compensation if isinstance(cut, ContourCut) else COMPUTED


def compensation_side(cut: Cut) -> str:
    """Side of the path on which the cutter is kept: "left", "right", or "" if it is computed."""
    if compensation_mode(cut) == COMPUTED:
        return ""
    return "left" if cut.climb else "right"


@dataclass(frozen=True, slots=True)
class OffsetLimit:
    """Limit of the difference between the offset of a compensated operation and its nominal one.

    Attributes
    ----------
    operation : its name.
    mode : "wear" or "control".
    tool : its number.
    radius : of the cutter, nominal [mm].
    most : either way [mm].
    """

    operation: str
    mode: str
    tool: int
    radius: float
    most: float

    def sentence(self, compensation: Compensation, length: Callable[[float], str]) -> str:
        """The limit in words, for the operator; `length` formats a length given in mm."""
        most = f"at most {length(self.most)} either way"
        if self.mode == CONTROL:
            return f"compensation control: {self._table(compensation, length)}; {most}"
        if compensation.nominal:
            return f"compensation wear: {self._table(compensation, length)}; wear {most}"
        what = "twice the wear alone" if compensation.table == "diameter" else "the wear alone"
        return (
            f"compensation wear: D{self.tool} holds {what}, 0 for a new cutter, positive leaves"
            f" more on the wall; wear {most}"
        )

    def _table(self, compensation: Compensation, length: Callable[[float], str]) -> str:
        where, table = "tool" if compensation.nominal else "offset", compensation.table
        nominal = length(self.radius * (2.0 if table == "diameter" else 1.0))
        return f"{where} {self.tool} holds the {table} that is measured, {nominal} nominally"


def offset_limit(operation: Operation) -> OffsetLimit | None:
    """The limit of an operation; None if nothing compensates for its cutter's radius.

    Either way the parallel must exist: the controller needs leads longer than its offset, arcs and
    corners that it does not swallow; the cutter stays where the path's room is, clear of clamps.

    Raises
    ------
    GeometryError
        With key "output.gcode.compensation", if there is no room for any wear.
    """
    cut = operation.cut
    if not compensation_side(cut):
        return None
    # The cutter may be moved no farther off the path than there is room beside it.
    least = cut.room if isinstance(cut, ContourCut) else math.inf
    for run in _compensated_runs(operation.moves):
        # In mode "control" the lead must take up the whole radius before any wear.
        lead = min(run[0].length, run[-1].length) / LEAD
        reserved = cut.tool.radius if compensation_mode(cut) == CONTROL else 0.0
        radii = [piece.radius for piece in run if piece.sweep]
        corners = (_corner(incoming, outgoing) for incoming, outgoing in pairwise(run))
        least = min(least, lead - reserved, *radii, *corners)
        for obstacle in cut.obstacles:
            if cut.bottom < obstacle.top:
                outline = Track.around(obstacle.outline.arcs(0.01, "fast").contour)
                least = min(least, least_distance(track_along(run), outline) - cut.tool.radius)
    most = math.floor(SHARE * least / LEAST) * LEAST
    if most < LEAST:
        raise GeometryError(
            f"{cut.name} leaves no room for it, as its leads are {run[0].length:.3g} mm long; a"
            ' larger allowance of the roughing makes room, and "computed" needs none',
            KEY,
            f'"{compensation_mode(cut)}"',
        )
    return OffsetLimit(cut.name, compensation_mode(cut), cut.tool.number, cut.tool.radius, most)


def offset_limits(operations: Sequence[Operation]) -> dict[str, OffsetLimit]:
    """The limits of all compensated operations, by their names.

    Raises
    ------
    GeometryError As `offset_limit`; also if one tool has mode "wear" in one operation and "control"
    in another.
    """
    limits = [limit for operation in operations if (limit := offset_limit(operation)) is not None]
    modes: dict[int, OffsetLimit] = {}
    for stated in limits:
        other = modes.setdefault(stated.tool, stated)
        if other.mode != stated.mode:
            raise GeometryError(
                f'tool {stated.tool} has "{other.mode}" in {other.operation} and "{stated.mode}" in'
                f" {stated.operation}; its offset cannot hold both",
                KEY,
            )
    return {stated.operation: stated for stated in limits}


def programmed(operation: Operation) -> tuple[Move | Stop, ...]:
    """The moves as they are programmed: in mode "control" along the wall.

    At the ends of the leads, where compensation is off, the programmed point is the cutter's
    centre.
    """
    cut = operation.cut
    if compensation_mode(cut) != CONTROL:
        return operation.moves
    # From the centre to the edge of the cutter at the wall, to the left if positive: the cutter is
    # kept on the other side of the programmed path.
    shift = -cut.tool.radius if compensation_side(cut) == "left" else cut.tool.radius
    program: list[Move | Stop] = []
    active = False
    position: Point | None = None
    moves = operation.moves
    for move, following in zip(moves, (*moves[1:], None), strict=True):
        place = position
        position = position if isinstance(move, Stop) else move.end
        switch = move.switch if isinstance(move, Feed) else ""
        active = (active or bool(switch)) and switch != "off"
        if not active or not isinstance(move, Feed | ArcFeed) or place is None:
            program.append(move)
            continue
        # The line of a lead is not parallel to the path behind it: there the next piece gives the
        # direction in which compensation is in force.
        piece = plane_piece(place, move)
        ahead = _headings(piece)[1]
        if switch and isinstance(following, Feed | ArcFeed):
            ahead = _headings(plane_piece(move.end, following))[0]
        shifted = piece.end + 1j * shift * ahead
        end = (shifted.real, shifted.imag, move.end[2])
        if isinstance(move, ArcFeed) and abs(shifted - piece.centre) < POINT:
            # The centre runs around a corner of the wall: programmed, that is a single point.
            program.append(Feed(end, move.feed))
        else:
            program.append(replace(move, end=end))
    return tuple(program)


def _compensated_runs(moves: Sequence[Move | Stop]) -> Iterator[list[Arc]]:
    """The pieces of each stretch under compensation, from its straight lead-in to its lead-off."""
    position: Point | None = None
    run: list[Arc] = []
    active = False
    for move in moves:
        if isinstance(move, Stop):
            continue
        if isinstance(move, Feed) and move.switch:
            active = True
        if active and position is not None and isinstance(move, Feed | ArcFeed):
            piece = plane_piece(position, move)
            if piece.length > 0.0:
                run.append(piece)
        if isinstance(move, Feed) and move.switch == "off":
            yield run
            run, active = [], False
        position = move.end


def _headings(piece: Arc) -> tuple[complex, complex]:
    start, end = piece.heading(piece.start), piece.heading(piece.end)
    return start / abs(start), end / abs(end)


def _corner(incoming: Arc, outgoing: Arc) -> float:
    """Largest offset [mm] at which the parallels of both pieces still meet at their corner."""
    turned = _headings(outgoing)[0] / _headings(incoming)[1]
    half = 0.5 * abs(math.atan2(turned.imag, turned.real))
    shorter = min(incoming.length, outgoing.length)
    # A parallel at distance d loses d tan(half) at the corner; each piece may lose half its length,
    # as it has a corner at its other end too.
    return 0.5 * shorter / math.tan(half) if half > 0.0 else math.inf
