"""Limits of a program as a text: lengths of lines, characters, numbers of blocks, `%`."""

from __future__ import annotations

from typing import Final

from camgeo.toolpath.machine import Machine
from camgeo.toolpath.machine_fields import LONGEST_LINE
from camgeo_export.interpreter.iso import Words
from camgeo_export.interpreter.rules import Findings

LARGEST_LINE_NUMBER: Final = 10_000_000
"""Of Grbl (MAX_LINE_NUMBER in its gcode.h); no controller has a larger one that we know of."""


def check_line(line: int, text: str, machine: Machine, findings: Findings) -> bool:
    """Find what the controller cannot read of a line as a text; whether it is read at all."""
    form = machine.text
    if len(text) > form.longest_line:
        what = f"a line of {len(text)} characters"
        findings.add(line, "line-length", what, allowed=f"at most {form.longest_line}")
        if len(text) > LONGEST_LINE:
            return False
    if text.isascii() and text.isprintable():
        return True
    wrong = next((each for each in text if each != "\t" and not " " <= each <= "~"), "")
    if wrong:
        what = f"the character {wrong!a} at column {text.index(wrong) + 1}"
        findings.add(line, "characters", what, allowed="printable ASCII")
    return True


def check_number(words: Words, findings: Findings) -> None:
    """Find the number of a block that is too large."""
    for letter, number in words.words:
        if letter == "N" and number.value > LARGEST_LINE_NUMBER:
            what, allowed = f"N{number.text} is too large", f"at most {LARGEST_LINE_NUMBER}"
            findings.add(words.line, "line-number", what, allowed=allowed)
