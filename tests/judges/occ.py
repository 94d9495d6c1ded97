"""OpenCASCADE itself reads solids, where the variable names a Python that has OCP: one valid solid,
of our faces and our volume."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from pathlib import Path
from typing import Any, Final

from tests.judges.files import Given
from tests.judges.programs_of_others import Refusal, run

VARIABLE: Final = "CAMGEO_OCC"

SCRIPT: Final = Path(__file__).with_name("occ_script.py")


def missing() -> str:
    """Why it cannot judge here; empty if it can."""
    named = os.environ.get(VARIABLE, "")
    if not named:
        return f"{VARIABLE} names no Python that has OCP"
    if not shutil.which(named):
        return f"{named} is not there"
    has = subprocess.run([named, "-c", "import OCP"], capture_output=True, check=False)
    return f"{named} has no OCP" if has.returncode else ""


def judge(given: Given) -> float:
    """The relative difference of the volume; Refusal if it finds fault."""
    said = run([os.environ[VARIABLE], str(SCRIPT), str(given.path)], given.path.parent)
    lines = [line for line in said.splitlines() if line.startswith("camgeo: ")]
    if not lines:
        raise Refusal(f"{given.path.name} is not read: {said[-300:].strip()}")
    read: dict[str, Any] = json.loads(lines[-1].removeprefix("camgeo: "))
    if "error" in read:
        raise Refusal(f"{given.path.name}: {read['error']}")
    if (read["solids"], read["shells"], read["valid"]) != (1, 1, True):
        raise Refusal(f"{given.path.name} is not one valid solid: {read}")
    if read["faces"] != given.faces:
        raise Refusal(f"{given.path.name} has {read['faces']} faces, not {given.faces}")
    apart: float = abs(read["volume"] / given.volume - 1.0)
    if apart > given.near:
        raise Refusal(f"{given.path.name}: its volume is {read['volume']}, not {given.volume:g}")
    return apart
