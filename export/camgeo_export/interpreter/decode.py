"""Words of ISO dialects turned into blocks, as far as the controller has the words."""

from __future__ import annotations

from collections.abc import Set
from typing import Final

from camgeo_export.interpreter.controller import ALONE, Controller
from camgeo_export.interpreter.holes import CYCLES
from camgeo_export.interpreter.iso import (
    COORDINATES,
    CYCLE,
    GROUP_OF,
    KNOWN,
    Block,
    Findings,
    Number,
    Words,
    normal,
    shown,
)

READ: Final = frozenset("DEFGHIJKLMNOPQRSTXYZ")
"""Letters whose words are read."""

ADDRESSES: Final = {"CR": "R", "OFFN": "OFFN", "RND": "RND", "TURN": "TURN"}
"""Further addresses that are read, and the names of their values."""

FRAMES: Final = frozenset(
    {"TRANS", "ATRANS", "ROT", "AROT", "SCALE", "ASCALE", "MIRROR", "AMIRROR"}
)
"""Commands that shift or turn the zero; without axes they delete what others have done."""

WHOLE: Final = frozenset("DHLNT")
"""Words whose number must be whole."""


def decode(words: Words, controller: Controller, findings: Findings) -> Block:
    """The block that `words` are; what cannot be run in it is found and left out."""
    block = Block(words.line)
    codes: list[str] = []
    for place, (letter, number) in enumerate(words.words):
        if letter in ("G", "M"):
            codes.append(normal(letter, number.text))
            code(block, codes[-1], controller, findings)
            continue
        if letter == "N" and place and controller.machine.reading.number_first:
            what = f"N{number.text} behind other words"
            findings.add(block.line, "line-number", what, allowed="at the start of the block")
        _value(block, letter, number, controller, findings)
    if len(codes) > 1:
        _check_alone(block, codes, controller, findings)
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


def _check_alone(
    block: Block, codes: list[str], controller: Controller, findings: Findings
) -> None:
    """Find words of which a block may have one, that are not of one modal group."""
    for words in controller.alone:
        found = [word for word in dict.fromkeys(codes) if word in words]
        if len(found) > 1:
            what = f"{' and '.join(found)} exclude each other in a block"
            findings.add(block.line, "conflict", what, allowed="one of them in a block")
            return


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
        if letter not in controller.names:
            what = f"{controller.machine.name} has no address {letter}"
            findings.add(block.line, "unknown-word", what)
            return
        if controller.meanings.get(letter) == "no effect":
            return
        if letter not in ADDRESSES:
            block.broken = True
            findings.add(block.line, "unsupported", f"{letter}= is outside what is read")
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
    meaning = controller.meanings.get(name)
    if name not in controller.names and (meaning is None or arguments is not None):
        word = name if arguments is None else f"{name}(...)"
        findings.add(block.line, "unknown-word", f"{controller.machine.name} has no {shown(word)}")
    elif name == "CYCLE832":
        _smoothing(block, arguments or "", findings)
    elif meaning == "no effect" or (name in FRAMES and block.values.keys() <= {"N"}):
        return
    elif name in ALONE or meaning == "machine position":
        block.actions["machine position"] = "machine position"
        block.words["machine position"] = name
    else:
        block.broken = True
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
    counts = controller.machine.reading.repeats if block.codes.get("motion") in CYCLES else ""
    for letter, number in block.values.items():
        if (
            letter in COORDINATES
            and letter != counts
            and not number.has_point
            and number.value != 0.0
        ):
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
