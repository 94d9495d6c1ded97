"""LinuxCNC's interpreter, from the Debian package linuxcnc-uspace, where that is installed."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import tempfile
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Final

from tests.judges.paths import Leg

PYTHON: Final = "/usr/bin/python3"
"""The interpreter that the package's module is for."""

SCRIPT: Final = Path(__file__).with_name("trace_rs274.py")

TOOL: Final = re.compile(r"\bT(\d+)")


@cache
def absent() -> str:
    """Why it cannot judge here; empty if it can."""
    if shutil.which("rs274") is None:
        return "rs274 is not installed"
    probe = [PYTHON, "-c", "import gcode, ctypes; ctypes.CDLL('libtooldata.so.0')"]
    done = subprocess.run(probe, capture_output=True, check=False)
    return "" if done.returncode == 0 else "its Python module is not installed"


def run(text: str) -> tuple[list[Leg], str]:
    """The moves of a program, and what the interpreter says if it stops; empty if it does not."""
    done = _run(text, [PYTHON, str(SCRIPT), "program.ngc", *sorted(set(TOOL.findall(text)))])
    lines = [json.loads(line) for line in done.stdout.split("\n") if line]
    if not lines or lines[-1][0] != "end":
        raise RuntimeError(f"rs274 crashed: {done.stderr[-500:]}")
    legs = [_leg(*line) for line in lines[:-1]]
    return legs, lines[-1][2]


def refusal(text: str) -> tuple[str, str] | None:
    """What the interpreter itself says of a program, and the text of the block; None if nothing.

    Its Python module takes any change of the unit for a feed, because it does not ask its canon.
    """
    numbers = sorted(set(TOOL.findall(text))) or ["1"]
    table = "".join(f"T{tool} P{tool} D0.2 Z0\n" for tool in numbers)
    files = {"tools.tbl": table, "rs274.var": "5161\t0\n5220\t1\n"}
    call = ["rs274", "-g", "-t", "tools.tbl", "-v", "rs274.var", "program.ngc", os.devnull]
    done = _run(text, call, files)
    lines = [line for line in done.stderr.split("\n") if line not in ("executing", "")]
    if done.returncode and not lines:
        raise RuntimeError(f"rs274 crashed: {done.returncode}")
    return (lines[0], lines[-1] if len(lines) > 1 else "") if lines else None


def _run(
    text: str, call: list[str], files: Mapping[str, str] | None = None
) -> subprocess.CompletedProcess[str]:
    """A program run in a folder of its own, where the interpreter keeps its tools."""
    with tempfile.TemporaryDirectory() as folder:
        for name, content in {"program.ngc": text, **(files or {})}.items():
            Path(folder, name).write_bytes(content.encode())
        done = subprocess.run(
            call,
            cwd=folder,
            env={**os.environ, "HOME": folder},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            check=False,
        )
    said, wrong = (part.decode(errors="replace") for part in (done.stdout, done.stderr))
    return subprocess.CompletedProcess(call, done.returncode, said, wrong)


PLANES: Final = {1: "XY", 2: "YZ", 3: "ZX"}
"""As the interpreter numbers them."""


def _leg(
    line: int,
    kind: str,
    end: tuple[float, float, float],
    feed: float,
    plane: int,
    centre: tuple[float, float] | None = None,
    turns: int = 0,
) -> Leg:
    if centre is None:
        return Leg(line, kind, end, feed=feed)
    axes = PLANES[plane]
    across = next(axis for axis in "XYZ" if axis not in axes)
    places = dict(zip((*axes, across), end, strict=True))
    own = (places["X"], places["Y"], places["Z"])
    return Leg(line, kind, own, complex(*centre), turns, axes, feed)
