"""Moves of a cutter: what a toolpath is made of and what a G-code writer spells.

Millimetres, mm/min, Z = 0 on the upper face of the part, Z up. What moves is the cutter's tip.
"""

from __future__ import annotations

from dataclasses import dataclass

from camgeo.toolpath.cut import Cut

Point = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Rapid:
    """Traverse to `end` [mm] without cutting; moves either in Z or in XY, never in both."""

    end: Point


@dataclass(frozen=True, slots=True)
class Feed:
    """Straight cut to `end` [mm] at `feed` [mm/min]."""

    end: Point
    feed: float


@dataclass(frozen=True, slots=True)
class ArcFeed:
    """Circular cut in the XY plane to `end` [mm] about `centre` (x, y) [mm] at `feed` [mm/min].

    At constant Z, at most half a turn; `ccw` seen from +Z.
    """

    end: Point
    centre: tuple[float, float]
    ccw: bool
    feed: float


Move = Rapid | Feed | ArcFeed


@dataclass(frozen=True, slots=True)
class Operation:
    """One operation of the program, with all its passes.

    Attributes
    ----------
    cut : what it cuts, and with which tool.
    moves : in order; the first and the last are traverses at the safe height.
    """

    cut: Cut
    moves: tuple[Move, ...]


@dataclass(frozen=True, slots=True)
class Toolpath:
    """A whole milling program.

    Attributes
    ----------
    safe_height : Z of all traverses [mm].
    operations : in the order of cutting.
    """

    safe_height: float
    operations: tuple[Operation, ...]
