"""Parallels of single moves, and where those of two neighbours meet."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass

from camgeo.numeric.arrays import phase
from camgeo.units import TURN
from camgeo_export.gcode.moves import CutterMove


@dataclass(frozen=True, slots=True)
class Parallel:
    """The path of a cutter's centre beside a straight or circular move.

    Attributes
    ----------
    move : programmed.
    side : +1 for the cutter on the left, -1 on the right.
    radius : of the cutter [mm].
    """

    move: CutterMove
    side: float
    radius: float

    @property
    def length(self) -> float:
        """Of the programmed move."""
        move = self.move
        if move.kind == "arc":
            return abs(move.sweep) * abs(move.start - move.centre)
        return abs(move.end - move.start)

    @property
    def room(self) -> float:
        """Radius of an arc's parallel; not above 0 where the cutter does not fit into it."""
        move = self.move
        inner = self.side if move.sweep > 0.0 else -self.side
        return abs(move.start - move.centre) - inner * self.radius

    def heading(self, point: complex) -> complex:
        """Direction at a point of the programmed move, of length 1."""
        move = self.move
        if move.kind == "arc":
            arm = (point - move.centre) * (1j if move.sweep > 0.0 else -1j)
        else:
            arm = move.end - move.start
        return arm / abs(arm) if arm else 1.0 + 0j

    def beside(self, point: complex) -> complex:
        """The centre of the cutter beside a point of the programmed move."""
        return point + self.side * 1j * self.heading(point) * self.radius

    def share(self, centre: complex) -> float:
        """How far along the move a point of its parallel is, as a share of it."""
        move = self.move
        if move.kind != "arc":
            way = move.end - move.start
            return ((centre - move.start) / way).real
        turned = phase((centre - move.centre) / (move.start - move.centre))
        sign = 1.0 if move.sweep > 0.0 else -1.0
        along = (sign * turned) % TURN
        # Just before the start counts as that, not as a turn less.
        along = along - TURN if along > 0.5 * (abs(move.sweep) + TURN) else along
        return along / abs(move.sweep)


def meeting(before: Parallel, after: Parallel) -> complex | None:
    """Where the parallels of two neighbours meet, next to their corner; None if they do not."""
    corner = after.move.start
    first, second = before.move.kind == "arc", after.move.kind == "arc"
    if first and second:
        found = _circles(before.move.centre, before.room, after.move.centre, after.room)
    elif first or second:
        line, arc = (after, before) if first else (before, after)
        point = line.beside(line.move.start)
        found = _line_and_circle(point, line.heading(point), arc.move.centre, arc.room)
    else:
        found = _lines(before, after)
    return min(found, key=lambda point: abs(point - corner), default=None)


def _lines(before: Parallel, after: Parallel) -> list[complex]:
    way, other = before.heading(0j), after.heading(0j)
    across = (way.conjugate() * other).imag
    if abs(across) < 1e-12:  # straight on, or straight back
        return []
    gap = after.beside(after.move.start) - before.beside(before.move.start)
    return [before.beside(before.move.start) + way * (gap.conjugate() * other).imag / across]


def _line_and_circle(point: complex, way: complex, centre: complex, radius: float) -> list[complex]:
    rest = (point - centre) / way
    square = radius * radius - rest.imag * rest.imag
    if square < 0.0:
        return []
    foot, half = centre + way * complex(0.0, rest.imag), math.sqrt(square)
    return [foot + way * half, foot - way * half]


def _circles(centre: complex, radius: float, other: complex, size: float) -> list[complex]:
    gap = other - centre
    apart = abs(gap)
    if apart == 0.0:
        return []
    along = (radius * radius - size * size + apart * apart) / (2.0 * apart)
    square = radius * radius - along * along
    if square < 0.0:
        return []
    way = cmath.rect(1.0, phase(gap))
    return [centre + way * complex(along, sign * math.sqrt(square)) for sign in (1.0, -1.0)]
