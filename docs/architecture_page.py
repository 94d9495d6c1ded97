"""The picture of the rooms in docs/architecture.md: `python docs/architecture_page.py` draws it."""

from __future__ import annotations

import ast
import re
from pathlib import Path
from typing import Final

ROOT: Final = Path(__file__).parents[1]

PAGE: Final = ROOT / "docs" / "architecture.md"

ROOMS: Final = (
    "numeric", "kinematics", "geometry", "cam", "check", "part", "dynamics", "milling", "scene",
    "design", "studies", "pictures", "app", "camgeo_export",
)  # fmt: skip
"""The rooms of camgeo, lowest first, and the writers."""

BLOCK: Final = re.compile(r"(?<=<!-- Drawn by docs/architecture_page.py -->\n).*?```\n", re.DOTALL)


def picture() -> str:
    """A row for each room, with a mark below each room that it imports."""
    lines = ["```text"]
    for place, room in enumerate(ROOMS):
        used = _imported(room)
        marks = "".join(" o" if each in used else " ." for each in ROOMS[:place])
        lines.append(f"{room:13}{marks} {room}")
    return "\n".join((*lines, "```")) + "\n"


def _imported(room: str) -> set[str]:
    folder = ROOT / ("export" if room == ROOMS[-1] else "camgeo") / room
    found = set()
    for path in folder.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("camgeo."):
                found.add((node.module or "").split(".")[1])
    return found


if __name__ == "__main__":
    PAGE.write_text(BLOCK.sub(lambda _: picture(), PAGE.read_text("utf-8")), "utf-8")
