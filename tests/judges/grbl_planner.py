"""Grbl's planner, where the variable names a program made of it: the time of each block.

The program reads the acceleration [mm/s^2] and the rapid feed [mm/min] of the axes and the junction
deviation [mm], then a line for each block: its end x, y, z [mm] and its feed [mm/min], 0 for a
traverse. The first block is the place of the start. It keeps the planner's buffer full, as while a
program is streamed, and prints the seconds of each block but the first, those of the ramps which
st_prep_buffer (grbl/stepper.c) makes of its entry, exit and nominal speed.
"""

from __future__ import annotations

import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.design.design import Design
from camgeo.milling.machine import Dynamics, load
from camgeo.milling.machining_time import SECONDS, Blocks, block_times, controller_blocks
from camgeo.milling.moves import Point
from camgeo.numeric.arrays import FloatArray
from tests.judges.programs_of_others import Program, Refusal

PLANNER: Final = Program("CAMGEO_GRBL_PLANNER", what="build of Grbl's planner")

MACHINE: Final = Dynamics(500.0, 8000.0, look_ahead=14, junction_deviation=0.02)
"""Grbl's buffer has 16 places, of which 15 are used: one block runs, 14 are planned. The other
values are those of its X-Carve (grbl/defaults.h)."""

FLOAT: Final = 1e-6
"""Grbl computes in single precision: a time may be off by some 2^-24 of itself for each of a dozen
operations."""

TOLERANCE: Final = 0.01


@dataclass(frozen=True)
class Times:
    """Seconds of each block of an operation: ours, and those of Grbl's planner.

    `places` is by how much a time may be off because places are floats.
    """

    own: FloatArray
    other: FloatArray
    places: float


def planned(blocks: Blocks, start: Point) -> FloatArray:
    """Seconds of each block by Grbl's planner."""
    lines = [f"{MACHINE.acceleration} {MACHINE.rapid_feed} {MACHINE.junction_deviation}"]
    lines.append(" ".join(map(repr, (*start, 0))))
    ends = np.array(start) + np.cumsum(blocks.lengths[:, None] * blocks.starts, axis=0)
    feeds = np.where(np.isinf(blocks.feeds), 0.0, SECONDS * blocks.feeds)
    for end, feed in zip(ends.tolist(), feeds.tolist(), strict=True):
        lines.append(" ".join(map(repr, (*end, feed))))
    done = subprocess.run(
        [PLANNER.path], input="\n".join(lines), text=True, capture_output=True, check=True
    )
    return np.array([float(line) for line in done.stdout.split()])


def times_of(design: Design) -> Iterator[Times]:
    """The times of the operations of a design, its arcs in the chords that Grbl makes of them."""
    chord = load("grbl").arcs.interpolation
    for operation in design.disc.milled.toolpath(TOLERANCE).operations:
        first, *moves = operation.travel
        blocks = controller_blocks(moves, first.end, chord=chord)
        places = 8e-6 / float(np.min(blocks.feeds))  # lengths are off by 8e-6 mm at 100 mm
        yield Times(block_times(blocks, MACHINE)[0], planned(blocks, first.end), places)


def judge(design: Design) -> float:
    """The largest relative difference of the time of an operation; Refusal if it is too large."""
    apart = [abs(np.sum(each.other) / np.sum(each.own) - 1.0) for each in times_of(design)]
    if max(apart) > FLOAT:
        raise Refusal(f"{design.name}: an operation takes {max(apart):.1e} of its time more")
    return float(max(apart))
