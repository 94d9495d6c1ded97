"""What the numbers of a block amount to: lengths, feeds and dwells."""

from __future__ import annotations

import math

from camgeo_export.interpreter.block import Block
from camgeo_export.interpreter.codes import COORDINATES
from camgeo_export.interpreter.controller import Controller
from camgeo_export.interpreter.rules import Findings

SHORTEST_DWELL, LONGEST_DWELL = 0.05, 60.0
"""Seconds that a dwell may reasonably take; others are in another unit, probably."""


def coordinate(block: Block, letter: str, controller: Controller, unit: str) -> float:
    """The value of a coordinate in units of the program, which are "mm" or "inch"."""
    number = block.values[letter]
    increment = controller.machine.numbers.increment
    if increment is None or number.has_point or letter not in COORDINATES:
        return number.value
    return number.value * (increment.inch if unit == "inch" else increment.mm)


def feed(block: Block, controller: Controller, unit: str) -> float:
    """The value of F in units of the program a minute or a turn."""
    number = block.values["F"]
    increment = controller.machine.numbers.feed_increment
    if increment is None or number.has_point:
        return number.value
    return number.value * (increment.inch if unit == "inch" else increment.mm)


def dwell_of(
    block: Block, controller: Controller, speed: float, findings: Findings
) -> float | None:
    """Seconds that a block waits, with the spindle at a `speed` [rev/min]; None without its time.

    The word that states it is taken from the block.
    """
    letter = next((each for each in controller.dwell_letters if each in block.values), "")
    if not letter:
        what = f"{block.words['dwell']} without its time"
        findings.add(block.line, "missing-word", what, allowed=controller.dwell_letters)
        return None
    number = block.values.pop(letter)
    text, form = f"{letter}{number.text}", controller.machine.dwell
    seconds = number.value
    if letter == "S":  # revolutions of the spindle
        seconds *= 60.0 / (speed or math.inf)
    elif letter == controller.dwell_letters[0] and form.unit != "s":
        if number.has_point and not form.point_seconds:
            what = "a dwell in whole milliseconds takes no decimal point"
            findings.add(block.line, "number", what, text)
        seconds /= 1.0 if number.has_point and form.point_seconds else 1000.0
    if seconds != 0.0 and not SHORTEST_DWELL <= seconds <= LONGEST_DWELL:
        what = f"a dwell of {seconds:g} s: {text} counts in {form.unit} here"
        allowed = f"{SHORTEST_DWELL:g} to {LONGEST_DWELL:g} s"
        findings.add(block.line, "dwell", what, allowed=allowed)
    return seconds
