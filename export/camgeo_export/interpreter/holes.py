"""Cycles that make holes along Z, as the moves that they are."""

from __future__ import annotations

import math
from typing import Final

from camgeo.milling.machine import Increments
from camgeo_export.gcode.moves import Kind
from camgeo_export.interpreter.controller import Controller, State
from camgeo_export.interpreter.iso import COORDINATES, Block, Findings, Number

CYCLES: Final = ("holes", "bores")
"""Motions of a hole that is left at a traverse, and of one that is left at the feed up to R."""

MOST: Final = 1_000
"""Holes of one block."""

Step = tuple[Kind, complex, float]
"""What a move is, and where it ends [mm]."""


class HoleReader:
    """Reads blocks of cycles; LinuxCNC's moves (interp_cycles.cc, convert_cycle_xy)."""

    def __init__(self, controller: Controller, state: State, findings: Findings) -> None:
        self._controller = controller
        self._state = state
        self._findings = findings

    def read(self, block: Block, end: complex, scale: float) -> list[Step] | None:
        """The moves of a block that ends over `end`; None if they cannot be told.

        In a cycle that goes on, R and Z need not be repeated; the height before the first one is
        kept, and G98 returns to it.
        """
        state = self._state
        word = block.words.get("motion", state.cycle)
        if word != state.cycle:
            state.cycle, state.hole = word, {}
        if math.isnan(state.above):
            state.above = state.z
        for letter in block.values.keys() & {"R", "Z"}:
            value = coordinate(block, letter, self._controller, state.mode("unit"))
            state.hole[letter] = value * scale
        for letter in ("R", "Z"):
            if letter not in state.hole:
                self._findings.add(block.line, "missing-word", f"{word} without {letter}")
        count = int(block.value(self._controller.machine.reading.repeats, 1.0))
        if not 1 <= count <= MOST:
            self._findings.add(
                block.line, "number", f"{word} makes {count} holes", "", f"1 to {MOST}"
            )
        elif len(state.hole) == 2:
            return self._moves(block, end, count)
        return None

    def _moves(self, block: Block, end: complex, count: int) -> list[Step] | None:
        state = self._state
        incremental = state.mode("distance") == "incremental"
        above = state.above
        r = state.hole["R"] + (above if incremental else 0.0)
        bottom = state.hole["Z"] + (r if incremental else 0.0)
        if r < bottom:
            what = f"{state.cycle} with R, Z {r:g} mm, below the bottom of the hole"
            self._findings.add(block.line, "conflict", what, allowed=f"Z {bottom:g} mm or more")
            return None
        step = end - state.at if incremental else 0j
        found: list[Step] = []
        height = state.z
        if above < r:
            found.append(("rapid", state.at, r))
            above = height = r
        clear = r if state.mode("return") == "return to R" else above
        for k in range(count):
            place = end + k * step
            height = height if k == 0 and height > r else clear
            found += [("rapid", place, height), ("rapid", place, r), ("line", place, bottom)]
            if state.mode("motion") == "bores":
                found.append(("line", place, r))
            found.append(("rapid", place, clear))
        return found


# -- quantities -----------------------------------------------------------------------------------
# What numbers of a block amount to, which without a decimal point may count in increments.


def coordinate(block: Block, letter: str, controller: Controller, unit: str) -> float:
    """The value of a coordinate in units of the program, which are "mm" or "inch"."""
    increments = controller.machine.numbers.increment if letter in COORDINATES else None
    return in_increments(block.values[letter], increments, unit)


def in_increments(number: Number, increments: Increments | None, unit: str) -> float:
    """The value of a number in units of the program."""
    if increments is None or number.has_point:
        return number.value
    return number.value * (increments.inch if unit == "inch" else increments.mm)
