"""Radius compensation that the control computes: what controls refuse, and what would gouge.

The rules are LinuxCNC's (docs/src/gcode/tool-compensation.adoc); other controls have the same ones,
or run what breaks them with a gouge.
"""

from __future__ import annotations

import math
from typing import Final

from camgeo.numeric.arrays import phase
from camgeo_export.gcode.moves import CutterMove
from camgeo_export.interpreter.offsets import Parallel, meeting
from camgeo_export.interpreter.rules import Findings

TANGENT: Final = 1e-3
"""Change of direction [rad] up to which two moves go on in one another: printed arcs kink so."""

RIGHT: Final = 0.5 * math.pi

SLACK: Final = 1e-9
"""Of a share of a move."""


def kept(side: str, radius: float) -> tuple[str, float]:
    """Side of the path and distance from it [mm], for a negative offset on the other side."""
    if radius < 0.0:
        return {"left": "right", "right": "left"}[side], -radius
    return side, radius


class Compensator:
    """Follows the moves under compensation."""

    def __init__(self, findings: Findings) -> None:
        self._findings = findings
        self._entering = False
        self._before: Parallel | None = None
        self._begun = 0.0

    def enter(self) -> None:
        """Compensation was switched on."""
        self._entering, self._before, self._begun = True, None, 0.0

    def take(self, move: CutterMove, side: str, radius: float) -> None:
        """Judge a move under compensation.

        `radius` is that of the cutter [mm], negative for the other side, NaN if it is not known.
        """
        if move.start == move.end and move.kind != "arc":
            return  # along Z
        side, radius = kept(side, radius)
        if self._entering:
            self._entering = False
            if move.kind == "arc":
                self._add(move, "compensation", "compensation begins with an arc")
            else:
                self._check_length(move, "enters", radius)
                self._before = Parallel(move, 1.0 if side == "left" else -1.0, radius)
            return
        parallel = Parallel(move, 1.0 if side == "left" else -1.0, radius)
        if move.kind == "arc" and parallel.room <= 0.0:
            size = abs(move.start - move.centre)
            what = "an inner arc that is not larger than the cutter"
            self._add(move, "gouge", what, f"radius {size:g} mm", f"above {radius:g} mm")
            self._before, self._begun = None, 0.0
            return
        if math.isfinite(radius):
            self._corner(parallel)
        self._before = parallel

    def leave(self, move: CutterMove, radius: float) -> None:
        """Judge the first move after compensation, with the `radius` [mm] as in `take`."""
        radius = abs(radius)
        if move.kind == "arc":
            what = "an arc right after the end of compensation"
            self._add(move, "compensation", what, "", "a straight move")
        elif move.start != move.end:
            self._check_length(move, "leaves", radius)
        self._before, self._begun = None, 0.0

    def _check_length(self, move: CutterMove, does: str, radius: float) -> None:
        length = abs(move.end - move.start)
        if length <= radius:
            what = f"the move that {does} compensation is not longer than the cutter's radius"
            self._add(move, "compensation", what, f"{length:g} mm", f"above {radius:g} mm")

    def _corner(self, after: Parallel) -> None:
        """Judge the corner between the move before and this one, if it is an inner one."""
        before, begun = self._before, self._begun
        self._begun = 0.0
        if before is None or before.move.end != after.move.start:
            return
        corner = after.move.start
        turn = phase(after.heading(corner) / before.heading(corner)) * after.side
        rounding = before.move.mismatch + after.move.mismatch
        # A corner that is cut off by no more than numbers are rounded is none.
        if turn <= TANGENT or after.radius * turn * turn / 8.0 <= rounding:
            return
        point = meeting(before, after)
        if point is not None:
            left, self._begun = before.share(point), after.share(point)
            # Parallels that meet at a small angle do so elsewhere where they are rounded.
            off = 2.0 * rounding / math.sin(min(turn, RIGHT))
            one, other = (SLACK + off / each.length for each in (before, after))
            if begun - one <= left <= 1.0 + one and -other <= self._begun <= 1.0 + other:
                return
        self._begun = 0.0
        what = "an inner corner that the cutter cannot reach without gouging"
        shorter = min(before.length, after.length)
        value = f"a move of {shorter:g} mm at a turn of {math.degrees(turn):.0f} deg"
        self._add(after.move, "gouge", what, value, f"for a cutter of radius {after.radius:g} mm")

    def _add(
        self, move: CutterMove, rule: str, what: str, value: str = "", allowed: str = ""
    ) -> None:
        self._findings.add(move.line, rule, what, value, allowed)
