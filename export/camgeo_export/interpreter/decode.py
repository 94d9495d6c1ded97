"""Words of ISO dialects turned into blocks, as far as the controller has the words."""

from __future__ import annotations

from collections.abc import Set
from typing import Final

from camgeo_export.interpreter.block import Block, Number
from camgeo_export.interpreter.codes import COORDINATES, CYCLE, GROUP_OF, KNOWN, normal
from camgeo_export.interpreter.controller import ALONE, Controller
from camgeo_export.interpreter.iso import Words, shown
from camgeo_export.interpreter.rules import Findings

READ: Final = frozenset("DEFGHIJKMNOPQRSTXYZ")
"""Letters whose words are read."""

ADDRESSES: Final = {"CR": "R", "OFFN": "OFFN", "TURN": "TURN"}
"""Further addresses that are read, and the names of their values."""

WHOLE: Final = frozenset("DHNT")
"""Words whose number must be whole."""


def decode(words: Words, controller: Controller, findings: Findings) -> Block:
    """The block that `words` are; what cannot be run in it is found and left out."""
    block = Block(words.line)
    for letter, number in words.words:
        if letter in ("G", "M"):
            code(block, normal(letter, number.text), controller, findings)
        else:
            _value(block, letter, number, controller, findings)
    for address, way in words.ways.items():
        block.relative[address] = way == "IC"
    for name, arguments in words.commands:
        _command(block, name, arguments, controller, findings)
    for address, text in words.names.items():
        if address != "T":
            findings.add(block.line, "unsupported", f'{address}="{shown(text)}" is not read')
        block.names[address] = text
    _check_points(block, controller, findings)
    return block


def code(block: Block, word: str, controller: Controller, findings: Findings) -> None:
    """Put the G or M word `word` into a block; what the controller lacks is found."""
    meaning = controller.meanings.get(word)
    if meaning is None:
        name = controller.machine.name
        use = f", {KNOWN[word]}," if word in KNOWN else ""
        block.broken = block.broken or word.startswith("G")
        if KNOWN.get(word) == CYCLE:
            block.codes["motion"], block.words["motion"] = CYCLE, word
        if word in controller.accepted:
            findings.add(block.line, "unsupported", f"{word}{use} is outside what is read")
        else:
            findings.add(block.line, "unknown-word", f"{name} has no {word}{use}".rstrip(","))
        return
    group = GROUP_OF[meaning]
    if group == "none":
        return
    place = block.actions if group == "once" else block.codes
    key = meaning if group == "once" else group
    if key in place:
        if block.words[key] == word:
            findings.add(block.line, "repeated-word", f"{word} is there twice")
        else:
            what = f"{block.words[key]} and {word} are both of the group {group}"
            findings.add(block.line, "conflict", what, allowed="one of them in a block")
        return
    place[key] = meaning
    block.words[key] = word


def _value(
    block: Block, letter: str, number: Number, controller: Controller, findings: Findings
) -> None:
    if len(letter) > 1:
        if letter not in controller.names or letter not in ADDRESSES:
            findings.add(block.line, "unknown-word", f"the address {letter} is not read")
            return
        letter = ADDRESSES[letter]
    elif letter not in controller.letters:
        name = controller.machine.name
        findings.add(block.line, "unknown-word", f"{name} has no words that begin with {letter}")
        return
    elif letter not in READ:
        what = f"words that begin with {letter} are outside what is read"
        block.broken = True
        findings.add(block.line, "unsupported", what)
        return
    if letter in block.values:
        findings.add(block.line, "repeated-word", f"the word {letter} is there twice")
        return
    within_reach(block, letter, number, controller, findings)
    if letter in WHOLE and (number.value < 0.0 or (number.value % 1.0 and letter != "D")):
        findings.add(block.line, "number", f"{letter} must be a whole number", number.text)
    if letter in "FS" and number.value < 0.0:
        findings.add(block.line, "number", f"{letter} must not be negative", number.text)
    block.values[letter] = number


def within_reach(
    block: Block, letter: str, number: Number, controller: Controller, findings: Findings
) -> None:
    """Find a coordinate that is larger than the controller reads."""
    largest = controller.machine.numbers.largest
    if letter in COORDINATES and abs(number.value) > largest:
        allowed = f"at most {largest:.10g} in magnitude"
        findings.add(block.line, "number", f"{letter} is too large", number.text, allowed)


def _command(
    block: Block,
    name: str,
    arguments: str | None,
    controller: Controller,
    findings: Findings,
) -> None:
    meaning = controller.machine.words.meaning_of(name)
    if name not in controller.names and meaning is None:
        word = name if arguments is None else f"{name}(...)"
        findings.add(block.line, "unknown-word", f"{controller.machine.name} has no {shown(word)}")
    elif name == "CYCLE832":
        _smoothing(block, arguments or "", findings)
    elif name in ALONE or meaning == "machine position":
        block.actions["machine position"] = "machine position"
        block.words["machine position"] = name
    elif meaning == "no effect" or name == "MSG":
        return
    else:
        findings.add(block.line, "unsupported", f"{name} is outside what is read")


def _smoothing(block: Block, arguments: str, findings: Findings) -> None:
    """Sinumerik's CYCLE832: tolerance, kind of machining, version of the call."""
    parts = [part.strip() for part in arguments.split(",")]
    block.words["smoothing"] = "CYCLE832"
    block.codes["smoothing"] = "smoothing"
    if parts in ([""], ["0"], ["0", "0", "1"]) or parts[1:2] == ["0"]:
        block.names["smoothing"] = "off"
        return
    try:
        value = float(parts[0])
    except ValueError:
        findings.add(block.line, "unreadable", "CYCLE832 without its tolerance", shown(arguments))
        return
    if len(parts) < 3:
        findings.add(
            block.line, "missing-word", "CYCLE832 without its third argument", shown(arguments),
            "CYCLE832(tolerance,kind,1)",
        )  # fmt: skip
    block.values["tolerance"] = Number(value, parts[0])


def _check_points(block: Block, controller: Controller, findings: Findings) -> None:
    """Coordinates without a decimal point, where the controller counts them in increments."""
    increment = controller.machine.numbers.increment
    if increment is None:
        return
    for letter, number in block.values.items():
        if letter in COORDINATES and not number.has_point and number.value != 0.0:
            word = f"{letter}{number.text}"
            what = f"{word} without a decimal point counts in {increment.mm:g} mm"
            what = f"{what} or {increment.inch:g} inch"
            findings.add(block.line, "decimal-point", what, allowed=f"{word}.0")


def unused(block: Block, used: Set[str], findings: Findings) -> None:
    """Find the words of a block that nothing in it takes."""
    for letter in block.values:
        if letter not in used and letter != "tolerance":
            what = f"nothing in the block takes the word {letter}"
            findings.add(block.line, "unused-word", what, block.values[letter].text)
