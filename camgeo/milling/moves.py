"""Moves of a cutter: what a toolpath consists of and what a G-code writer prints.

Millimetres, mm/min, Z = 0 on the upper face of the part, Z up. Positions are of the cutter's tip.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any, Final

from camgeo.errors import FileError, GeometryError
from camgeo.geometry.contour.spline import Arc
from camgeo.milling.cut import Cut
from camgeo.milling.milling import Heights, Text, Tool
from camgeo.numeric.arrays import phase
from camgeo.numeric.checked import (
    LARGEST,
    CheckedFields,
    finite,
    instance,
    one_of,
    positive,
    shown,
)
from camgeo.reading import PROGRAM_LINES

Point = tuple[float, float, float]

SWITCHES: Final = ("", "left", "right", "off")


def _require(point: Any, size: int) -> None:
    """Raise GeometryError unless `point` has `size` finite coordinates."""
    if not (isinstance(point, tuple) and len(point) == size):
        raise GeometryError(f"must be {size} coordinates", "toolpath", shown(point))
    for each in point:
        if type(each) is not float or not -LARGEST <= each <= LARGEST:
            finite("toolpath", each, "mm")


@dataclass(frozen=True, slots=True)
class Rapid:
    """Traverse to `end` [mm] without cutting; moves either in Z or in XY, never in both."""

    end: Point

    def __post_init__(self) -> None:
        _require(self.end, 3)


@dataclass(frozen=True, slots=True)
class Feed:
    """Straight cut to `end` [mm] at `feed` [mm/min].

    `switch` is what it does to the controller's compensation of the cutter's radius: it leads onto
    its path with the cutter on the "left" or the "right" of what is programmed, it leads "off" it,
    or it changes nothing, "".
    """

    end: Point
    feed: float
    switch: str = ""

    def __post_init__(self) -> None:
        _require(self.end, 3)
        positive("toolpath", self.feed, "mm/min")
        one_of("toolpath", self.switch, SWITCHES)


@dataclass(frozen=True, slots=True)
class ArcFeed:
    """Circular cut to `end` [mm] around the axis through `centre` (x, y) [mm] at `feed` [mm/min].

    At most half a turn; `ccw` seen from +Z. If `end` has another Z, it is a helix of constant
    pitch.
    """

    end: Point
    centre: tuple[float, float]
    ccw: bool
    feed: float

    def __post_init__(self) -> None:
        _require(self.end, 3)
        _require(self.centre, 2)
        instance("toolpath", self.ccw, bool, "true or false")
        positive("toolpath", self.feed, "mm/min")


@dataclass(frozen=True, slots=True)
class Stop(CheckedFields):
    """A halt for the operator, at the clearance height, with the spindle off.

    `note` says what has to be done.
    """

    note: Annotated[Text, "toolpath"]


def too_long() -> FileError:
    """The error for a program that would not be read back."""
    return FileError(
        f"the program would have more than {PROGRAM_LINES:,} lines, the limit for a program that is"
        " read; a larger tolerance or a larger stepdown needs fewer"
    )


Move = Rapid | Feed | ArcFeed


@dataclass(frozen=True, slots=True)
class Operation:
    """One operation of the program, with all its passes; it can be restarted alone.

    Attributes
    ----------
    cut : what it cuts, with its tool.
    moves : in order; the first is a traverse to the clearance height above the first point, the
        last one leads up to that height again.

    Raises
    ------
    GeometryError
        With key "toolpath" if there is no cut, or it does not begin with a traverse.
    """

    cut: Cut
    moves: tuple[Move | Stop, ...]

    def __post_init__(self) -> None:
        instance("toolpath", self.cut, Cut, "a cut")
        instance("toolpath", self.moves, tuple, "a tuple of moves")
        if not self.moves or not isinstance(self.moves[0], Rapid):
            message = f"the operation {self.cut.name} must begin with a traverse"
            raise GeometryError(message, "toolpath", shown(self.moves[:1]))

    @property
    def travel(self) -> tuple[Move, ...]:
        """The moves without the halts between them."""
        return tuple(move for move in self.moves if not isinstance(move, Stop))

    @property
    def name(self) -> str:
        """Unique in the program."""
        return self.cut.name

    @property
    def tool(self) -> Tool:
        """What cuts, and how it is run."""
        return self.cut.tool


@dataclass(frozen=True, slots=True)
class Toolpath:
    """A whole milling program.

    Attributes
    ----------
    heights : of its traverses.
    operations : in the order of cutting, each with its own name.

    Raises
    ------
    GeometryError
        With key "toolpath", if two operations have the same name.
    """

    heights: Heights
    operations: tuple[Operation, ...]

    def __post_init__(self) -> None:
        instance("toolpath", self.heights, Heights, "heights")
        for each in instance("toolpath", self.operations, tuple, "a tuple of operations"):
            instance("toolpath", each, Operation, "an operation")
        names = [each.cut.name for each in self.operations]
        if len(set(names)) < len(names):
            raise GeometryError("each operation needs its own name", "toolpath", ", ".join(names))


# -- pieces ---------------------------------------------------------------------------------------
# Moves as lines and arcs in the plane.


def piece_of(at: Point, move: Move) -> Arc:
    """The line or the arc of a move that begins `at` a point, in the plane."""
    start, end = complex(at[0], at[1]), complex(move.end[0], move.end[1])
    if not isinstance(move, ArcFeed):
        return Arc(start, end, 0.0, 0j)
    centre = complex(*move.centre)
    return Arc(start, end, arc_sweep(start - centre, end - centre, ccw=move.ccw), centre)


def arc_sweep(start: complex, end: complex, *, ccw: bool) -> float:
    """Signed angle [rad] from arm `start` to arm `end`, at most half a turn in that direction.

    An angle slightly below 0 is a rounded 0; one slightly beyond half a turn is not taken for a
    turn in the other direction.
    """
    turn = phase(end / start) * (1.0 if ccw else -1.0)
    if turn < -0.5 * math.pi:
        turn += 2.0 * math.pi
    turn = max(turn, 0.0)
    return turn if ccw else -turn
