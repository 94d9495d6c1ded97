"""Radius compensation that the controller computes: what it refuses, and what it would gouge.

The rules are LinuxCNC's (docs/src/gcode/tool-compensation.adoc); other controllers have the same
ones, or run what breaks them with a gouge.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

from camgeo.numeric.arrays import phase
from camgeo_export.gcode.moves import CutterMove
from camgeo_export.interpreter.arcs import TURN
from camgeo_export.interpreter.rules import Findings

TANGENT: Final = 1e-3
"""Change of direction [rad] up to which two moves go on in one another: printed arcs kink so."""


@dataclass(frozen=True, slots=True)
class _Element:
    """A compensated move as an offset line or arc; `side` is +1 with the cutter on the left."""

    move: CutterMove
    side: float
    radius: float

    @property
    def first(self) -> complex:
        """Its direction at the start."""
        return _way(self.move, self.move.start)

    @property
    def last(self) -> complex:
        """Its direction at the end."""
        return _way(self.move, self.move.end)

    @property
    def length(self) -> float:
        move = self.move
        if move.kind == "arc":
            return abs(move.sweep) * abs(move.start - move.centre)
        return abs(move.end - move.start)

    def trimmed(self, turn: float) -> float:
        """Roughly how much of its length the corner with a concave `turn` [rad] takes away."""
        return self.radius * math.tan(0.5 * min(turn, math.pi - 1e-9))


class Compensator:
    """Follows the moves under compensation."""

    def __init__(self, findings: Findings) -> None:
        self._findings = findings
        self._entering = False
        self._before: _Element | None = None
        self._taken = 0.0

    def enter(self) -> None:
        """Compensation was switched on."""
        self._entering, self._before, self._taken = True, None, 0.0

    def take(self, move: CutterMove, side: str, radius: float) -> None:
        """Judge a move under compensation; `radius` of the cutter [mm], NaN if it is not known."""
        add = self._findings.add
        if self._entering:
            if move.kind == "arc":
                add(move.line, "compensation", "compensation begins with an arc")
            elif move.start == move.end:
                return  # along Z: the entry is still to come
            elif abs(move.end - move.start) <= radius:
                what = "the move that enters compensation is not longer than the cutter's radius"
                length = abs(move.end - move.start)
                add(move.line, "compensation", what, f"{length:g} mm", f"above {radius:g} mm")
            self._entering = False
            return
        if move.start == move.end and move.kind != "arc":
            return
        sign = 1.0 if side == "left" else -1.0
        element = _Element(move, sign, radius)
        if move.kind == "arc" and move.sweep * sign > 0.0:
            size = abs(move.start - move.centre)
            if size <= radius:
                what = "an inner arc that is not larger than the cutter"
                add(move.line, "gouge", what, f"radius {size:g} mm", f"above {radius:g} mm")
        if math.isfinite(radius):
            self._corner(element)
        self._before = element

    def leave(self, move: CutterMove, radius: float) -> None:
        """Judge the first move after compensation."""
        add = self._findings.add
        if move.kind == "arc":
            what = "an arc right after the end of compensation"
            add(move.line, "compensation", what, allowed="a straight move")
        elif move.start != move.end and abs(move.end - move.start) <= radius:
            what = "the move that leaves compensation is not longer than the cutter's radius"
            length = abs(move.end - move.start)
            add(move.line, "compensation", what, f"{length:g} mm", f"above {radius:g} mm")
        self._before, self._taken = None, 0.0

    def _corner(self, element: _Element) -> None:
        """Judge the corner between the move before and this one, if it is an inner one."""
        before, taken = self._before, self._taken
        self._taken = 0.0
        if before is None or before.move.end != element.move.start:
            return
        ratio = element.first / before.last if before.last else 1.0
        turn = phase(ratio) * element.side
        if turn <= TANGENT:
            return
        cut = element.trimmed(turn)
        for each, used in ((before, taken + before.trimmed(turn)), (element, cut)):
            if used > each.length:
                what = "an inner corner that the cutter cannot reach without gouging"
                degrees = f"a move of {each.length:g} mm at a turn of {math.degrees(turn):.0f} deg"
                add = self._findings.add
                add(element.move.line, "gouge", what, degrees, f"at least {used:.4g} mm")
                break
        self._taken = cut


def _way(move: CutterMove, point: complex) -> complex:
    """The direction of a move at one of its ends."""
    if move.kind == "arc":
        arm = (point - move.centre) * (1j if move.sweep > 0.0 else -1j)
        return arm / abs(arm) if arm and abs(move.sweep) < 2.0 * TURN else arm
    way = move.end - move.start
    return way / abs(way) if way else way
