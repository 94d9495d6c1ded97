"""A milling program run by an interpreter of a few lines: modal words, lines and arcs."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

import numpy as np

from tests.measuring import Outline

WORD = re.compile(r"([A-Z])(-?\d+(?:\.\d+)?)")

SCALE = {20: 25.4, 21: 1.0}


@dataclass
class Move:
    """One move [mm]; `code` is that of its G word."""

    code: int
    start: complex
    end: complex
    z_start: float
    z_end: float
    centre: complex
    tool: int

    @property
    def sweep(self) -> float:
        """Angle turned [rad], 0 for lines."""
        if self.code < 2:
            return 0.0
        arms = (self.end - self.centre) / (self.start - self.centre)
        turned = float(np.angle(arms)) % (2.0 * np.pi)
        return turned if self.code == 3 else turned - 2.0 * np.pi


@dataclass
class Program:
    """What a program did, operation by operation (named by comments)."""

    scale: float = 0.0
    blending: float = 0.0
    operations: dict[str, list[Move]] = field(default_factory=dict)

    def passes(self, operation: str) -> list[list[Move]]:
        """Runs of cuts at one depth."""
        runs: list[list[Move]] = [[]]
        for move in self.operations[operation]:
            if move.code > 0 and move.z_start == move.z_end:
                runs[-1].append(move)
            elif runs[-1]:
                runs.append([])
        return [run for run in runs if run]


def run(text: str) -> Program:
    """Run the program; positions are known from the first words of each axis on."""
    program = Program()
    at = {"X": np.nan, "Y": np.nan, "Z": np.nan}
    code, operation, tool = 0, "", 0
    for line in text.splitlines():
        if line.startswith("("):
            if line.startswith("(operation "):
                operation = line[len("(operation ") : -1]
            continue
        words = WORD.findall(line)
        assert " ".join(letter + number for letter, number in words) == line
        values = {letter: float(number) for letter, number in words}
        for letter, number in words:
            if letter == "G" and float(number) in SCALE:
                program.scale = SCALE[int(number)]
            if letter == "G" and float(number) in (0, 1, 2, 3):
                code = int(number)
        tool = int(values.get("T", tool))
        if "G64" in line:
            program.blending = (values["P"] + values["Q"]) * program.scale
        if not values.keys() & {"X", "Y", "Z"}:
            continue
        before = dict(at)
        at |= {axis: values[axis] * program.scale for axis in "XYZ" if axis in values}
        start = complex(before["X"], before["Y"])
        centre = start + complex(values.get("I", 0.0), values.get("J", 0.0)) * program.scale
        program.operations.setdefault(operation, []).append(
            Move(
                code,
                start,
                complex(at["X"], at["Y"]),
                before["Z"],
                at["Z"],
                centre if code > 1 else 0j,
                tool,
            )
        )
    return program


def outline(moves: list[Move]) -> Outline:
    """The path of the moves in the plane, arcs about their programmed centres."""
    return Outline(
        np.array([move.start for move in moves]),
        np.array([move.end for move in moves]),
        np.array([move.sweep for move in moves]),
        np.array([move.centre for move in moves]),
    )
