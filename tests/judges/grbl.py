"""Grbl's own parser, where the variable names a program made of it.

The program reads a milling program and prints a line for each thing that Grbl's parser hands on,
the number of the line of the program first: `12 rapid X Y Z`, `12 line X Y Z F`, `12 arc cw X Y Z
CX CY F A` or `ccw`, and `12 error N`. Of an arc CX and CY are its centre in its plane, and A is the
place in XYZ of the plane's first axis, `axis_0` of mc_arc; without it the plane is XY.
"""

from __future__ import annotations

import math
import subprocess
from typing import Final

from tests.judges.paths import Leg
from tests.judges.programs_of_others import Program

PARSER: Final = Program("CAMGEO_GRBL", what="build of Grbl's parser")


def run(text: str) -> tuple[list[Leg], list[str]]:
    """The moves of a program, and the errors."""
    done = subprocess.run([PARSER.path], input=text.encode(), capture_output=True, check=True)
    legs: list[Leg] = []
    errors: list[str] = []
    for line in done.stdout.decode().splitlines():
        number, what, *rest = line.split()
        if what == "error":
            errors.append(f"line {number}: error {rest[0]}")
        elif what in ("rapid", "line"):
            x, y, z, *speed = map(float, rest[:4])
            legs.append(Leg(int(number), what, (x, y, z), feed=speed[0] if speed else math.nan))
        elif what == "arc":
            x, y, z, u, v, feed = map(float, rest[1:7])
            plane = ("XY", "YZ", "ZX")[int(rest[7])] if len(rest) > 7 else "XY"
            turn = 1 if rest[0] == "ccw" else -1
            legs.append(Leg(int(number), what, (x, y, z), complex(u, v), turn, plane, feed))
    return legs, errors
