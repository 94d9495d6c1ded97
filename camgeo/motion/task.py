"""Motion tasks (Bewegungsaufgaben): the conditions at the ends of a move (VDI 2143-1, section 3).

| class | German | velocity | acceleration |
|---|---|---|---|
| R, rest | Rast | 0 | 0 |
| G, constant velocity | konstante Geschwindigkeit | not 0 | 0 |
| U, turn | Umkehr | 0 | not 0 |
| B, general motion | Bewegung | not 0 | not 0 |
"""

from __future__ import annotations

from typing import Final, Literal

End = Literal["R", "G", "U", "B"]

ENDS: Final[tuple[End, ...]] = ("R", "G", "U", "B")

TASKS: Final[tuple[str, ...]] = tuple(f"{start}-{end}" for start in ENDS for end in ENDS)
"""All sixteen pairs, "R-R" to "B-B" (VDI 2143-1, Tafel 1)."""

NAMES: Final[dict[End, str]] = {
    "R": "rest",
    "G": "constant velocity",
    "U": "turn",
    "B": "general motion",
}


def end_of(velocity: float, acceleration: float) -> End:
    """The class of an end with that velocity and acceleration, in any unit."""
    if velocity == 0.0:
        return "R" if acceleration == 0.0 else "U"
    return "G" if acceleration == 0.0 else "B"


def ends_of(task: str) -> tuple[str, str]:
    """The classes at the start and at the end of `task`, one of `TASKS`."""
    return task[0], task[-1]
