"""OpenCASCADE itself reads solids, where the variable names a Python that has OCP: one valid solid,
of our faces and our volume."""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import Final

from tests.judges.files import Given
from tests.judges.programs_of_others import Program, Refusal, answer

PYTHON: Final = Program("CAMGEO_OCC", what="Python that has OCP")

SCRIPT: Final = Path(__file__).with_name("occ_script.py")


def missing() -> str:
    """Why it cannot judge here; empty if it can."""
    if absent := PYTHON.absent():
        return absent
    has = subprocess.run([PYTHON.path, "-c", "import OCP"], capture_output=True, check=False)
    return f"{PYTHON.path} has no OCP" if has.returncode else ""


def judge(given: Given) -> float:
    """The relative difference of the volume; Refusal if it finds fault."""
    read = answer(PYTHON.run([str(SCRIPT), str(given.path)], given.path.parent), given.path)
    if (read["solids"], read["shells"], read["valid"]) != (1, 1, True):
        raise Refusal(f"{given.path.name} is not one valid solid: {read}")
    return given.compare(read["volume"], read["faces"])
