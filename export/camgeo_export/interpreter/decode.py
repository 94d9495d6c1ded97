"""Words of ISO dialects and of the conversational one turned into blocks."""

from __future__ import annotations

import re
from collections.abc import Callable, Set
from typing import Final

from camgeo.reading import number_of
from camgeo.units import MM_PER
from camgeo_export.interpreter.controller import Controller, State
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

ALONE: Final = ("SUPA", "G500")
"""Names that are words themselves, without a number or arguments."""

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


# -- conversational -------------------------------------------------------------------------------
# Heidenhain's conversational format turned into blocks.
#
# Read are BEGIN and END PGM, BLK FORM, TOOL CALL and TOOL DEF, lines L and LP, circles C, CP, CR,
# CT and CTP with the centre CC, STOP, M words, the cycles 9 (dwell), 32 (tolerance), 247 (datum).


NUMBER: Final = r"[-+]?(?:\d+\.?\d*|\.\d+)"

WORD: Final = re.compile(
    rf"""\s*+(?:
      (?P<sense>DR\s*+[-+])(?![\d.])
    | (?P<side>R[0LR])(?![\d.])
    | (?P<fast>FMAX|F\s++MAX)
    | (?P<auto>F\s*+AUTO)
    | (?P<letter>I?(?:PA|PR|[XYZ])|F|S|M|R|DL|DR|T)\s*+(?P<number>{NUMBER})
    )""",
    re.ASCII | re.VERBOSE,
)

HEAD: Final = re.compile(r"(?:\d++(?:\s++|$))?(.*)", re.ASCII | re.DOTALL)

BEGIN: Final = re.compile(r"(BEGIN|END)\s++PGM(?:\s++(.*?))?\s++(MM|INCH)", re.ASCII)

FORM: Final = re.compile(r"(?:BLK\s++FORM|TOOL\s++DEF)\b.*", re.ASCII)
"""Blocks that move nothing: the blank, and the data of a tool."""

CALL: Final = re.compile(r"TOOL\s++CALL(?:\s++(\d++|\"[^\"]*\"))?(?:\s++([XYZ])\b)?(.*)", re.ASCII)

DELTA: Final = re.compile(rf"\bD(?:R\s*+(?P<radius>{NUMBER})|[LR]\d*\s*+[-+]?[\d.]++)", re.ASCII)
"""What a call adds to the length and the radius of the tool in the table."""

CYCLE_BLOCK: Final = re.compile(r"CYCL\s++DEF\s++(\d++)(?:\.(\d++))?\b(.*)", re.ASCII)

PARAMETER: Final = re.compile(r"Q\d++\s*=.*", re.ASCII)

PATHS: Final = {
    "L": ("line", ""),
    "LP": ("line", "polar"),
    "C": ("circle", "pole"),
    "CP": ("circle", "polar"),
    "CR": ("circle", "radius"),
    "CT": ("tangent", "tangent"),
    "CTP": ("tangent", "tangent"),
}
"""Path functions: what they move along, and how an arc is stated."""

SIDES: Final = {
    "R0": "compensation off",
    "RL": "compensation left",
    "RR": "compensation right",
}

COMBINED: Final = {"M13": ("M3", "M8"), "M14": ("M4", "M8")}
"""Words that do what two others do."""

UNREAD: Final = re.compile(r"(APPR|DEP|RND|CHF|FN|LBL|CALL|FL|FC|FCT|FLT|Q|SEL|TCH|PLANE)\b")
"""First words of what is known, but not read."""

STILL: Final = frozenset({"FN", "LBL", "Q", "SEL"})
"""Those of them that move nothing."""

Form = Callable[[int, re.Match[str]], list[Block]]
"""From a line and its text to blocks."""


def _nothing(line: int, found: re.Match[str]) -> list[Block]:  # noqa: ARG001  one of the forms
    return []


class Klartext:
    """Turns lines into blocks."""

    def __init__(self, controller: Controller, state: State, findings: Findings) -> None:
        self._controller = controller
        self._state = state
        self._findings = findings
        self._begun = False
        self._tool_feed: Number | None = None
        self._cycle = ""

    def blocks(self, line: int, text: str) -> list[Block]:
        """The blocks of a line in capitals, without comment."""
        head = HEAD.fullmatch(text)
        rest = (head[1] if head else text).rstrip(" ~")
        if not rest or rest.startswith("*"):
            return []
        if found := BEGIN.fullmatch(rest):
            return self._program(line, found)
        if not self._begun:
            self._begun = True
            self._findings.add(line, "frame", "a program begins with BEGIN PGM, its name and MM")
        for form, read in self._forms():
            if found := form.fullmatch(rest):
                return read(line, found)
        self._cycle = ""
        word, _, words = rest.partition(" ")
        if word in PATHS:
            return self._path(line, word, words)
        if word == "CC":
            self._centre(line, words)
            return []
        if word == "STOP":
            block = self._words(line, words)
            block.codes["flow"], block.words["flow"] = "stop", "STOP"
            return [block]
        if re.match(r"M\d", word):
            return [self._words(line, rest)]
        self._refuse(line, rest)
        return []

    def is_end(self, text: str) -> bool:
        """Whether a line is END PGM, which follows the M word that ends a program."""
        head = HEAD.fullmatch(text)
        return bool(head and head[1].startswith("END PGM"))

    def _forms(self) -> tuple[tuple[re.Pattern[str], Form], ...]:
        return (
            (FORM, _nothing),
            (CALL, self._tool_call),
            (CYCLE_BLOCK, self._cycle_of),
            (PARAMETER, self._parameter),
        )

    def _program(self, line: int, found: re.Match[str]) -> list[Block]:
        if found[1] == "BEGIN":
            self._begun = True
            unit = "mm" if found[3] == "MM" else "inch"
            self._state.scale = MM_PER["mm"] if unit == "mm" else MM_PER["inch"]
            self._state.modes["unit"] = unit
            return []
        block = Block(line)
        block.codes["flow"], block.words["flow"] = "end", "END PGM"
        return [block]

    def _tool_call(self, line: int, found: re.Match[str]) -> list[Block]:
        block = self._words(line, DELTA.sub("", found[3]))
        over = [number_of(each["radius"]) for each in DELTA.finditer(found[3]) if each["radius"]]
        self._state.oversize = (over[-1] or 0.0) * self._state.scale if over else 0.0
        if found[1] is None:  # another speed of the same tool
            self._tool_feed = block.values.get("F", self._tool_feed)
            return [block]
        self._tool_feed = block.values.get("F")
        number = found[1]
        if number.startswith('"'):
            what = "a tool called by name: its number is not known"
            self._findings.add(line, "unsupported", what, shown(number))
            return [block]
        block.values["T"] = Number(float(number[:9]), number)
        block.codes["tool"], block.words["tool"] = "tool change", "TOOL CALL"
        if found[2] != "Z":
            what = "TOOL CALL without Z as the axis of the tool"
            self._findings.add(line, "plane", what, allowed="TOOL CALL n Z")
        return [block]

    def _cycle_of(self, line: int, found: re.Match[str]) -> list[Block]:
        number, part, rest = found[1], found[2] or "0", found[3].strip()
        self._cycle = number
        block = Block(line)
        if number == "247":
            block.codes["work offset"] = "work offset"
            block.words["work offset"] = " ".join(found[0].split())
            return [block]
        if number == "32" and part == "1":
            block.codes["smoothing"], block.words["smoothing"] = "smoothing", "CYCL DEF 32"
            tolerance = re.fullmatch(rf"T\s*+({NUMBER})", rest)
            if tolerance and (value := number_of(tolerance[1])):
                block.values["tolerance"] = Number(value, tolerance[1])
            else:
                block.names["smoothing"] = "off"
            return [block]
        if number == "9" and part == "1":
            dwell = re.fullmatch(rf"(?:DWELL|V\.?ZEIT)\s*+({NUMBER})", rest)
            value = number_of(dwell[1]) if dwell else None
            if dwell and value is not None:
                block.actions["dwell"], block.words["dwell"] = "dwell", "CYCL DEF 9"
                block.values["P"] = Number(value, dwell[1])
                return [block]
            self._findings.add(line, "unreadable", "cannot be read", shown(rest))
            return []
        if number not in ("9", "32"):
            what = f"cycle {number} is outside what is read"
            self._findings.add(line, "unsupported", what)
        return []

    def _parameter(self, line: int, found: re.Match[str]) -> list[Block]:
        """A parameter of a cycle on a line of its own."""
        if not self._cycle:
            what = "parameters, expressions and control of flow are outside what is read"
            self._findings.add(line, "unsupported", what, shown(found[0]))
        return []

    def _path(self, line: int, function: str, words: str) -> list[Block]:
        block = self._words(line, words)
        motion, arc = PATHS[function]
        sense = block.names.pop("sense", "")
        if "R" in block.values and arc != "radius":
            self._findings.add(line, "unused-word", f"{function} takes no radius R")
        if motion == "line":
            block.codes["motion"] = "line"
        else:
            block.codes["motion"] = "counter-clockwise arc" if sense == "+" else "clockwise arc"
            if not sense and motion == "circle" and not self._signed(block):
                self._findings.add(line, "arc-form", "a circle without its sense", "", "DR+ or DR-")
        block.arc = arc
        fast = block.names.pop("fast", "")
        if fast and motion == "line":
            block.codes["motion"] = "rapid"
            if arc == "":
                block.arc = "rapid"
        elif fast:
            self._findings.add(line, "feed", "a circle at FMAX")
        return [block]

    @staticmethod
    def _signed(block: Block) -> bool:
        """Whether the sign of an incremental angle says the sense, which it then sets."""
        if not block.relative.get("PA"):
            return False
        if block.value("PA") > 0.0:
            block.codes["motion"] = "counter-clockwise arc"
        return True

    def _centre(self, line: int, words: str) -> None:
        state = self._state
        block = self._words(line, words)
        parts = {"X": state.at.real, "Y": state.at.imag}
        for axis, number in block.values.items():
            if axis not in parts:
                self._findings.add(line, "unused-word", f"CC takes no word {axis}")
                continue
            base = parts[axis] if block.relative.get(axis) else 0.0
            parts[axis] = base + number.value * state.scale
        state.pole = complex(parts["X"], parts["Y"])

    def _words(self, line: int, text: str) -> Block:
        """The words of a path function; what cannot be read of them is found."""
        block = Block(line)
        at, end = 0, len(text.rstrip())
        while at < end:
            found = WORD.match(text, at)
            if found is None:
                self._refuse(line, text[at:].strip())
                block.broken = True
                break
            at = found.end()
            if found["sense"]:
                block.names["sense"] = found["sense"][-1]
            elif found["side"]:
                self._compensate(block, found["side"])
            elif found["fast"]:
                block.names["fast"] = "FMAX"
            elif found["auto"]:
                self._feed_of_tool(block)
            else:
                self._word(block, found["letter"], found["number"])
        return block

    def _feed_of_tool(self, block: Block) -> None:
        """F AUTO: the feed that TOOL CALL states."""
        if self._tool_feed is None:
            what = "F AUTO without a feed F in TOOL CALL"
            self._findings.add(block.line, "missing-word", what, allowed="TOOL CALL n Z S F")
        else:
            block.values["F"] = self._tool_feed

    def _compensate(self, block: Block, side: str) -> None:
        """R0, RL or RR: each block repeats what is active."""
        meaning = SIDES[side]
        if meaning != (self._state.mode("compensation") or "compensation off"):
            block.codes["compensation"], block.words["compensation"] = meaning, side

    def _word(self, block: Block, letter: str, text: str) -> None:
        value = number_of(text)
        if value is None:
            what = f"the number {text[:40]} cannot be one of a program"
            self._findings.add(block.line, "number", what)
            return
        if letter == "M":
            word = normal("M", text)
            for each in COMBINED.get(word, (word,)):
                code(block, each, self._controller, self._findings)
            return
        name = letter.removeprefix("I") if letter != "I" else letter
        if name in block.values:
            self._findings.add(block.line, "repeated-word", f"the word {name} is there twice")
            return
        if letter.startswith("I"):
            block.relative[name] = True
        elif name in ("X", "Y", "Z", "PA"):
            block.relative[name] = False
        block.values[name] = Number(value, text)
        within_reach(block, name, block.values[name], self._controller, self._findings)

    def _refuse(self, line: int, text: str) -> None:
        unread = UNREAD.match(text)
        if not (unread and unread[1] in STILL):
            self._state.lose()
        if unread:
            what = f"{unread[1]} is outside what is read"
            self._findings.add(line, "unsupported", what, shown(text))
        else:
            self._findings.add(line, "unreadable", "cannot be read", shown(text))
