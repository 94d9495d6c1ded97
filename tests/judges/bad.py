"""LinuxCNC's programs that must fail, `tests/interp/bad`, where the variable names a checkout."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Final

from camgeo.design.linting import LineFinding
from camgeo.milling.machine import load
from camgeo_export.interpreter.run import run

VARIABLE: Final = "CAMGEO_LINUXCNC"

FOLDER: Final = Path("tests", "interp", "bad")

LINES: Final = {"words", "path", "form", "safety"}
"""Concerns of findings that say why a program must fail: not that it states no plane, or no end."""


def absent() -> str:
    """Why they cannot be read here; empty if they can."""
    named = os.environ.get(VARIABLE, "")
    if not named:
        return f"{VARIABLE} names no checkout of LinuxCNC"
    return "" if programs() else f"{Path(named, FOLDER)} is not there"


def programs() -> list[Path]:
    """The programs."""
    return sorted(Path(os.environ.get(VARIABLE, ""), FOLDER).glob("*.ngc"))


def found(path: Path) -> list[LineFinding]:
    """The findings that say, with a line, why a program must fail."""
    findings = run(path.read_bytes(), load("linuxcnc")).findings
    return [each for each in findings if each.line and each.concerns in LINES]
