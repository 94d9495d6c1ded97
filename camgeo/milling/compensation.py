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
from camgeo.milling.moves import ArcFeed, Feed, Move, Operation, Point, Stop, piece_of
from camgeo.milling.track import Track, track_of

KEY: Final = "output.gcode.compensation"

SHARE: Final = 0.9
"""Of what geometry allows, for printed numbers and for what a controller adds at joints."""

LEAST: Final = 1e-3
"""Wear [mm] below which compensation is of no use; limits are told in whole steps of it."""

POINT: Final = 1e-6
"""An arc of a smaller radius [mm] is a corner."""

LEAD: Final = 2.0
"""Length of a straight lead in radii, or in wears: some controllers take one radius as too short
for the way on, and LinuxCNC's manual asks for two on the way off."""


def mode_of(cut: Cut) -> str:
    """One of `camgeo.milling.milling.COMPENSATIONS`."""
    return cut.compensation if isinstance(cut, ContourCut) else COMPUTED


def side_of(cut: Cut) -> str:
    """Side of the path on which the cutter is kept: "left", "right", or "" if it is computed."""
    if mode_of(cut) == COMPUTED:
        return ""
    return "left" if cut.climb else "right"


@dataclass(frozen=True, slots=True)
class Limit:
    """How far the offset of a compensated operation may be from the one it is computed for.

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
        """What the operator has to know; `length` spells one [mm]."""
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


def limit_of(operation: Operation) -> Limit | None:
    """The limit of an operation; None if nothing compensates for its cutter's radius.

    Either way the parallel must exist: the controller needs leads longer than its offset, arcs and
    corners that it does not swallow; the cutter stays where the path's room is, clear of clamps.

    Raises
    ------
    GeometryError
        With key "output.gcode.compensation", if there is no room for any wear.
    """
    cut = operation.cut
    if not side_of(cut):
        return None
    # Beside the path is no more room, and more allowance than that is not left for the wear.
    least = cut.room if isinstance(cut, ContourCut) else math.inf
    for run in _runs(operation.moves):
        # Control itself takes the lead for the whole radius.
        lead = min(run[0].length, run[-1].length) / LEAD
        taken = cut.tool.radius if mode_of(cut) == CONTROL else 0.0
        radii = [each.radius for each in run if each.sweep]
        corners = (_corner(before, after) for before, after in pairwise(run))
        least = min(least, lead - taken, *radii, *corners)
        for obstacle in cut.obstacles:
            if cut.bottom < obstacle.top:
                outline = Track.around(obstacle.outline.arcs(0.01, "fast").contour)
                least = min(least, least_distance(track_of(run), outline) - cut.tool.radius)
    most = math.floor(SHARE * least / LEAST) * LEAST
    if most < LEAST:
        raise GeometryError(
            f"{cut.name} leaves no room for it: its leads are {run[0].length:.3g} mm long; roughing"
            ' with more allowance makes room, "computed" needs none',
            KEY,
            f'"{mode_of(cut)}"',
        )
    return Limit(cut.name, mode_of(cut), cut.tool.number, cut.tool.radius, most)


def limits_of(operations: Sequence[Operation]) -> dict[str, Limit]:
    """The limits of all compensated operations, by their names.

    Raises
    ------
    GeometryError
        As `limit_of`; also if one tool compensates for its wear here and for its radius there.
    """
    found = [limit for each in operations if (limit := limit_of(each)) is not None]
    modes: dict[int, Limit] = {}
    for each in found:
        other = modes.setdefault(each.tool, each)
        if other.mode != each.mode:
            raise GeometryError(
                f'tool {each.tool} has "{other.mode}" in {other.operation} and "{each.mode}" in'
                f" {each.operation}; its offset cannot hold both",
                KEY,
            )
    return {each.operation: each for each in found}


def programmed(operation: Operation) -> tuple[Move | Stop, ...]:
    """The moves as they are programmed: with "control", along the wall.

    The ends of the leads, where compensation is off, stay where the cutter's centre is.
    """
    cut = operation.cut
    if mode_of(cut) != CONTROL:
        return operation.moves
    # To the other side of the path than that on which the cutter is kept.
    shift = -cut.tool.radius if side_of(cut) == "left" else cut.tool.radius
    found: list[Move | Stop] = []
    on = False
    at: Point | None = None
    moves = operation.moves
    for move, after in zip(moves, (*moves[1:], None), strict=True):
        place = at
        at = at if isinstance(move, Stop) else move.end
        switch = move.switch if isinstance(move, Feed) else ""
        on = (on or bool(switch)) and switch != "off"
        if not on or not isinstance(move, Feed | ArcFeed) or place is None:
            found.append(move)
            continue
        # Behind a lead that goes across to its path the next piece says where that is.
        piece = piece_of(place, move)
        ahead = _headings(piece)[1]
        if switch and isinstance(after, Feed | ArcFeed):
            ahead = _headings(piece_of(move.end, after))[0]
        beside = piece.end + 1j * shift * ahead
        end = (beside.real, beside.imag, move.end[2])
        if isinstance(move, ArcFeed) and abs(beside - piece.centre) < POINT:
            found.append(Feed(end, move.feed))  # around a corner of the wall
        else:
            found.append(replace(move, end=end))
    return tuple(found)


def _runs(moves: Sequence[Move | Stop]) -> Iterator[list[Arc]]:
    """The pieces of each stretch under compensation, from its straight way on to that off."""
    at: Point | None = None
    run: list[Arc] = []
    on = False
    for move in moves:
        if isinstance(move, Stop):
            continue
        if isinstance(move, Feed) and move.switch:
            on = True
        if on and at is not None and isinstance(move, Feed | ArcFeed):
            piece = piece_of(at, move)
            if piece.length > 0.0:
                run.append(piece)
        if isinstance(move, Feed) and move.switch == "off":
            yield run
            run, on = [], False
        at = move.end


def _headings(piece: Arc) -> tuple[complex, complex]:
    start, end = piece.heading(piece.start), piece.heading(piece.end)
    return start / abs(start), end / abs(end)


def _corner(before: Arc, after: Arc) -> float:
    """Largest offset [mm] whose parallels still meet at a corner."""
    turned = _headings(after)[0] / _headings(before)[1]
    half = 0.5 * abs(math.atan2(turned.imag, turned.real))
    shorter = min(before.length, after.length)
    return 0.5 * shorter / math.tan(half) if half > 0.0 else math.inf
