"""Runs a program in LinuxCNC's interpreter, by the Python module of its Debian package.

`HOME=FOLDER /usr/bin/python3 trace_rs274.py PROGRAM TOOL...` prints a JSON list for every canonical
motion, in full precision: line, kind, end [mm], and centre and turns of arcs; the last one is the
interpreter's verdict. Behind the end stands the feed [mm/min] and the plane; the end of an arc is
that in the plane, and its height. The module needs a table of tools before it reads a T word, and a
folder of its own for it.
"""

from __future__ import annotations

import ctypes
import json
import os
import sys
from pathlib import Path
from typing import Any

INCH = 25.4


def say(*what: object) -> None:
    """Print a line of the answer."""
    sys.stdout.write(json.dumps(what) + "\n")


class Canon:
    """What the interpreter calls; lengths are in inches."""

    parameter_file = "rs274.var"
    line = 0
    feed = 0.0
    plane = 1

    def next_line(self, state: Any) -> None:
        self.line = state.sequence_number

    def put(self, kind: str, end: tuple[float, ...], *rest: object) -> None:
        say(self.line, kind, [INCH * each for each in end], INCH * self.feed, self.plane, *rest)

    def set_feed_rate(self, feed: float) -> None:
        self.feed = feed

    def set_plane(self, plane: int) -> None:
        self.plane = plane

    def straight_traverse(self, x: float, y: float, z: float, *rest: float) -> None:
        self.put("rapid", (x, y, z))

    def straight_feed(self, x: float, y: float, z: float, *rest: float) -> None:
        self.put("line", (x, y, z))

    def arc_feed(
        self, x: float, y: float, u: float, v: float, turns: int, z: float, *rest: float
    ) -> None:
        self.put("arc", (x, y, z), [INCH * u, INCH * v], turns)

    def get_external_length_units(self) -> float:
        return 1.0

    def get_external_angular_units(self) -> float:
        return 1.0

    def get_axis_mask(self) -> int:
        return 7

    def get_block_delete(self) -> bool:
        return False

    def check_abort(self) -> bool:
        return False

    def get_tool(self, pocket: int) -> tuple[float, ...]:
        return (max(pocket, 1), *(0.0,) * 9, 1.0, 0.0, 0.0, 0)

    def __getattr__(self, name: str) -> Any:
        """All else that it calls changes no path."""
        if name.startswith("__"):
            raise AttributeError(name)
        return lambda *arguments: None


def main(program: str, *tools: str) -> None:
    """Print the canonical motions of a program."""
    os.chdir(os.environ["HOME"])
    table = "".join(f"T{tool} P{tool} D0.2 Z0\n" for tool in tools or ("1",))
    Path("tools.tbl").write_text(table)
    Path(Canon.parameter_file).write_text("5161\t0\n5220\t1\n")
    data = ctypes.CDLL("libtooldata.so.0", mode=ctypes.RTLD_GLOBAL)
    data._Z17tool_mmap_creatorPK13EMC_TOOL_STATi(None, 0)
    data._Z13tooldata_initb(ctypes.c_bool(False))
    data._Z13tooldata_loadPKcPPc(b"tools.tbl", None)
    import gcode  # type: ignore[import-not-found]  # of linuxcnc-uspace, once its tools are there

    code, line = gcode.parse(program, Canon(), "G21", "")
    said = gcode.strerror(code) if code > gcode.MIN_ERROR else ""
    say("end", line, said)


main(*sys.argv[1:])
