"""FreeCAD imports drawings, bodies and solids: of our size, closed, and of our volume."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from tests.judges.files import Given
from tests.judges.programs_of_others import Program, Refusal, answer

FREECAD: Final = Program("CAMGEO_FREECAD", "freecadcmd", "FreeCADCmd", "freecad.cmd")

SCRIPT: Final = Path(__file__).with_name("freecad_script.py")

SIZE = 0.02
"""How far a size may be from ours [mm]."""


def judge(given: Given, exported: Path | None = None) -> float:
    """The difference of size [mm] or of volume, relative; Refusal if it finds fault.

    A solid is written again as a STEP file into `exported`, each cylinder as one face.
    """
    again = {} if exported is None else {"CAMGEO_EXPORTED": str(exported)}
    path = given.path
    said = FREECAD.run([str(SCRIPT)], path.parent, CAMGEO_JUDGED=str(path), **again)
    read = answer(said, path)
    if "size" in read:
        apart: float = max(abs(a - b) for a, b in zip(read["size"], given.size, strict=True))
        if apart > SIZE:
            raise Refusal(f"{path.name} is {read['size']} mm large, not {given.size}")
        return apart
    if not read["solid"]:
        raise Refusal(f"{path.name} is not one closed body: {read}")
    return given.compare(read["volume"], read.get("faces", 0))
