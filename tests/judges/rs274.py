"""LinuxCNC's interpreter, from the Debian package linuxcnc-uspace, where that is installed."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import tempfile
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
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder, "program.ngc")
        program.write_text(text)
        done = subprocess.run(
            [PYTHON, str(SCRIPT), str(program), *sorted(set(TOOL.findall(text)))],
            env={"HOME": folder},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            check=False,
        )
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    if not lines or lines[-1][0] != "end":
        raise RuntimeError(f"rs274 crashed: {done.stderr[-500:]}")
    legs = [_leg(*line) for line in lines[:-1]]
    return legs, lines[-1][2]


def _leg(
    line: int,
    kind: str,
    end: tuple[float, float, float],
    centre: tuple[float, float] | None = None,
    turns: int = 0,
) -> Leg:
    return Leg(line, kind, end, None if centre is None else complex(*centre), turns)
