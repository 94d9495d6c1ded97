"""Dangers of single moves, told from the move and the state in which it is made."""

from __future__ import annotations

import cmath
import math
from typing import Final

from camgeo.verifying.linting import Bench
from camgeo_export.gcode.moves import CutterMove
from camgeo_export.interpreter.controller import Controller
from camgeo_export.interpreter.rules import Findings
from camgeo_export.interpreter.state import State

SLACK: Final = 1e-9
"""Heights are compared as printed; what lies between is rounding of the change of units [mm]."""


class Hazards:
    """Judges moves one after another."""

    def __init__(self, controller: Controller, bench: Bench, findings: Findings) -> None:
        self._controller = controller
        self._bench = bench
        self._findings = findings
        self._said: set[str] = set()

    def judge(self, move: CutterMove, state: State) -> None:
        """Find what is dangerous in a move."""
        if move.kind == "rapid":
            self._rapid(move)
            if move.z_end != move.z_start and math.isfinite(move.z_end) and state.tool:
                what = "a traverse along Z before the length of the tool is in force"
                self._length(move, state.has_length, what)
        else:
            self._cut(move, state)

    def _rapid(self, move: CutterMove) -> None:
        bench, add = self._bench, self._findings.add
        low = min(move.z_start, move.z_end)
        if math.isnan(move.z_start) or math.isnan(move.z_end):
            low = math.nan
        across = move.end != move.start and not (
            cmath.isnan(move.end) and cmath.isnan(move.start) and math.isinf(move.z_end)
        )
        vertical = move.z_end != move.z_start and not math.isnan(move.z_start)
        top, free = bench.stock_top - SLACK, bench.free - SLACK
        if across and math.isnan(low):
            if math.isnan(move.z_end):
                add(move.line, "rapid-height", "a traverse in the plane at an unknown height")
            elif move.z_end < free:
                what = "a traverse in the plane and down from an unknown height"
                add(move.line, "rapid-diagonal", what)
            return
        if across and vertical and low < free:
            whence = "above" if math.isinf(move.z_start) else f"Z {move.z_start:g} mm"
            what = f"a traverse in the plane and along Z at once, from {whence} to"
            allowed = f"both at once only above Z {bench.free:g} mm"
            add(move.line, "rapid-diagonal", f"{what} Z {move.z_end:g} mm", allowed=allowed)
        elif across and low < top:
            what = f"a traverse in the plane at Z {low:g} mm, below the top of the stock"
            add(move.line, "rapid-in-stock", what, allowed=f"Z {bench.stock_top:g} mm or more")
        elif across and low < free:
            what = f"a traverse in the plane at Z {low:g} mm, below the safe height"
            add(move.line, "rapid-height", what, allowed=f"Z {bench.free:g} mm or more")
        elif move.z_end < top and not move.z_end > move.z_start:
            what = f"a traverse down to Z {move.z_end:g} mm, into the material"
            add(move.line, "rapid-plunge", what, allowed=f"Z {bench.stock_top:g} mm or more")

    def _cut(self, move: CutterMove, state: State) -> None:
        lost = cmath.isnan(move.start) or math.isnan(move.z_start) or math.isinf(move.z_start)
        if lost and not state.lost:
            self._findings.add(move.line, "unknown-position", "a cut from an unknown position")
        state.lost = lost
        self._once(move, "no-feed", move.feed > 0.0, "a cut without feed")
        self._once(move, "no-spindle", move.speed > 0.0, "a cut with the spindle off")
        controller = self._controller
        if controller.changes_tools:
            self._once(move, "no-tool", move.tool > 0, "a cut before a tool is in the spindle")
            in_force = move.offset > 0 and state.has_length
            self._length(move, in_force, "a cut without the length of the tool in force")
        if move.coolant == "off" and min(move.z_start, move.z_end) < self._bench.stock_top:
            state.dry = state.dry or move.line

    def _length(self, move: CutterMove, holds: bool, what: str) -> None:
        """Find that no length of the tool holds, where the controller needs one."""
        needed = self._controller.changes_tools and self._controller.needs_length
        self._once(move, "tool-length", holds or not needed, what)

    def _once(self, move: CutterMove, rule: str, holds: bool, what: str) -> None:
        """Find what does not hold, the first time of several in a row: each further cut breaks it
        too, until it is mended.
        """
        if holds:
            self._said.discard(rule)
        elif rule not in self._said:
            self._said.add(rule)
            self._findings.add(move.line, rule, what)
