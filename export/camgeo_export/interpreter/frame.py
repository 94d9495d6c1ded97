"""What a program must have stated before its first cut."""

from __future__ import annotations

import math
from typing import Final

from camgeo_export.interpreter.codes import GROUPS
from camgeo_export.interpreter.controller import Controller
from camgeo_export.interpreter.rules import Findings
from camgeo_export.interpreter.state import State

NEEDED: Final = (
    "unit", "plane", "distance", "feed mode", "compensation", "cycle", "work offset", "centres",
)  # fmt: skip
"""Groups of which a program must state one word, if the controller has any: what was left active by
the program before is not known."""


class Frame:
    """Checks the modal frame once, at the first cut."""

    def __init__(self, controller: Controller, findings: Findings) -> None:
        self._controller = controller
        self._findings = findings
        self._done = False

    def check(self, state: State, line: int) -> None:
        """Find what was not stated before the cut in `line`."""
        if self._done:
            return
        self._done = True
        missing = [word for group in NEEDED if (word := self._missing(group, state))]
        if missing:
            self._findings.add(line, "frame", f"cut without {', '.join(missing)}")

    def _missing(self, group: str, state: State) -> str:
        """The word of a group that the profile's own programs state, if one is missing."""
        controller = self._controller
        if state.mode(group) or group not in controller.groups:
            return ""
        if group == "unit" and not math.isnan(state.scale):
            return ""  # found at the first coordinate
        words = [word for word, each in controller.meanings.items() if each in GROUPS[group]]
        if group == "centres" and len(words) < 2:
            return ""  # there is no choice
        program = controller.machine.program
        stated = " ".join((*program.safe_start, *controller.machine.work_offsets.values())).split()
        usual = [word for word in stated if word in words]
        return usual[0] if usual else min(words, key=lambda word: (len(word), word))
