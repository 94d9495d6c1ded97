"""Limits of a program as a text: lengths of lines, characters, numbers of blocks, `%`."""

from __future__ import annotations

import re
from codecs import BOM_UTF8
from typing import Final

from camgeo.toolpath.machine import Machine
from camgeo.toolpath.machine_fields import LONGEST_LINE
from camgeo_export.interpreter.iso import Words
from camgeo_export.interpreter.rules import Findings

UNCOUNTED: Final = re.compile(r"\([^)]*+\)?+|;.*+|\s++", re.ASCII)
"""Comments and blanks of a line."""

CARRIAGE_RETURNS: Final = {"blank": "\n", "end": None, "unknown": None}
"""How the lines of a program are told apart, by what the controller does with a carriage return
alone: as `io.TextIOWrapper` has it."""


def check_line(line: int, text: str, machine: Machine, findings: Findings) -> bool:
    """Find what the controller cannot read of a line as a text; whether it is read at all."""
    form = machine.text
    long = len(text) > LONGEST_LINE
    code = machine.reading.counted == "code" and not long
    counted = UNCOUNTED.sub("", text) if code and len(text) > form.longest_line else text
    size = len(counted if counted.isascii() else counted.encode("utf-8", "replace"))
    if size > form.longest_line:
        what = f"a line of {size} characters"
        findings.add(line, "line-length", what, allowed=f"at most {form.longest_line}")
        if long:
            return False
    shown = text.removesuffix("\r")
    if shown.isascii() and shown.isprintable():
        return True
    wrong = next((each for each in text if each not in "\t\r" and not " " <= each <= "~"), "")
    if wrong:
        what = f"the character {wrong!a} at column {text.index(wrong) + 1}"
        findings.add(line, "characters", what, allowed="printable ASCII")
    return True


def check_ends(data: bytes, machine: Machine, findings: Findings) -> None:
    """Find what of a program's bytes the controller takes otherwise than an editor shows."""
    if data.startswith(BOM_UTF8) and not machine.reading.byte_order_mark:
        what = "the program begins with a byte order mark"
        findings.add(1, "characters", what, allowed="printable ASCII")
    if machine.reading.carriage_return == "end" or b"\r" not in data:
        return
    before, alone, _ = data.replace(b"\r\n", b"\n").partition(b"\r")
    if alone:
        does = {"blank": "which this controller reads over: the block goes on behind it"}
        what = does.get(machine.reading.carriage_return, "of which it is not known what it does")
        line = 1 + before.count(b"\n")
        findings.add(line, "line-end", f"a carriage return without a line feed, {what}")


def check_number(words: Words, largest: int, findings: Findings) -> None:
    """Find the number of a block that is too large."""
    for letter, number in words.words:
        if letter == "N" and number.value > largest:
            what, allowed = f"N{number.text} is too large", f"at most {largest}"
            findings.add(words.line, "line-number", what, allowed=allowed)
