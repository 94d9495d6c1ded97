"""FreeCAD imports drawings, bodies and solids: of our size, closed, and of our volume."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Final

from tests.judges.files import Given
from tests.judges.programs_of_others import Refusal, absent, found, run

VARIABLE: Final = "CAMGEO_FREECAD"
NAMES: Final = ("freecadcmd", "FreeCADCmd", "freecad.cmd")

SCRIPT: Final = Path(__file__).with_name("freecad_script.py")

SIZE = 0.02
"""How far a size may be from ours [mm]."""


def missing() -> str:
    """Why it cannot judge here; empty if it can."""
    return absent(VARIABLE, *NAMES)


def judge(given: Given, exported: Path | None = None) -> float:
    """The difference of size [mm] or of volume, relative; Refusal if it finds fault.

    A solid is written again as a STEP file into `exported`, each cylinder as one face.
    """
    call = [found(VARIABLE, *NAMES), str(SCRIPT)]
    again = {} if exported is None else {"CAMGEO_EXPORTED": str(exported)}
    said = run(call, given.path.parent, CAMGEO_JUDGED=str(given.path), **again)
    lines = [line for line in said.splitlines() if line.startswith("camgeo: ")]
    if not lines:
        raise Refusal(f"{given.path.name} is not read: {said[-300:].strip()}")
    read: dict[str, Any] = json.loads(lines[-1].removeprefix("camgeo: "))
    if "error" in read:
        raise Refusal(f"{given.path.name}: {read['error']}")
    if "size" in read:
        apart: float = max(abs(a - b) for a, b in zip(read["size"], given.size, strict=True))
        if apart > SIZE:
            raise Refusal(f"{given.path.name} is {read['size']} mm large, not {given.size}")
        return apart
    faces = read.get("faces", 0)
    if faces != given.faces:
        raise Refusal(f"{given.path.name} has {faces} faces, not {given.faces}")
    if not read["solid"]:
        raise Refusal(f"{given.path.name} is not one closed body: {read}")
    apart = abs(read["volume"] / given.volume - 1.0)
    if apart > given.near:
        raise Refusal(f"{given.path.name}: its volume is {read['volume']}, not {given.volume:g}")
    return apart
