"""What the interpreter finds fault with: the names of its rules, and the list of what was found."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from types import MappingProxyType
from typing import Final

from camgeo.verifying.linting import LineFinding

WORDS, PATH, FORM, SAFETY, FRAME, LIMITS = "words", "path", "form", "safety", "frame", "limits"
"""What a finding concerns: a block that cannot be run as it stands; a path that is not known; the
form of a path that is known, mostly of its arcs; a danger while it runs; what a program must say
before it cuts and when it ends; limits of the controller."""

RULES: Final[Mapping[str, str]] = MappingProxyType(
    {
        # A block that the controller cannot run, or that is outside what is read.
        "unreadable": WORDS,
        "unknown-word": WORDS,
        "unsupported": WORDS,
        "repeated-word": WORDS,
        "conflict": WORDS,
        "missing-word": WORDS,
        "unused-word": WORDS,
        "number": WORDS,
        "comment": WORDS,
        # A path that is not known: its size, its place.
        "unit": PATH,
        "no-motion": PATH,
        "plane": PATH,
        "no-arc": PATH,
        "unknown-position": PATH,
        # The form of the path.
        "unit-change": FORM,
        "order": FORM,
        "decimal-point": FORM,
        "arc-radius": FORM,
        "arc-form": FORM,
        "arc-sweep": FORM,
        "full-circle": FORM,
        "helix": FORM,
        "compensation": FORM,
        "gouge": FORM,
        # Dangers.
        "rapid-in-stock": SAFETY,
        "rapid-plunge": SAFETY,
        "rapid-height": SAFETY,
        "rapid-diagonal": SAFETY,
        "no-feed": SAFETY,
        "feed": SAFETY,
        "no-spindle": SAFETY,
        "spindle-sense": SAFETY,
        "no-tool": SAFETY,
        "tool-length": SAFETY,
        "coolant": SAFETY,
        "dwell": SAFETY,
        "low-stop": SAFETY,
        # What a program must say.
        "frame": FRAME,
        "no-end": FRAME,
        "after-end": FRAME,
        "left-on": FRAME,
        "nothing": FRAME,
        # Limits of the controller.
        "line-length": LIMITS,
        "line-end": LIMITS,
        "line-number": LIMITS,
        "characters": LIMITS,
        "decimals": LIMITS,
    }
)
"""Every rule and what it concerns; docs/lint.md says what each finds."""


class Enough(Exception):
    """As many findings as were asked for: the program is not read further."""


class Findings:
    """What was found in a program, in the order of finding.

    Attributes
    ----------
    found : so far.
    """

    def __init__(self, most: int, fatal: Collection[str] = ()) -> None:
        self.found: list[LineFinding] = []
        self._most = most
        self._fatal = fatal

    def add(self, line: int, rule: str, what: str, value: str = "", allowed: str = "") -> None:
        """Add a finding; raises Enough if it is one too many, or of a concern that is fatal."""
        self.found.append(LineFinding(line, rule, RULES[rule], what, value, allowed))
        if len(self.found) >= self._most or RULES[rule] in self._fatal:
            raise Enough
