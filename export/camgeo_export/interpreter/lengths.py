"""Lengths and feeds in blocks: decimal points and increments."""

from __future__ import annotations

from camgeo_export.interpreter.block import Block
from camgeo_export.interpreter.codes import COORDINATES
from camgeo_export.interpreter.controller import Controller


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
