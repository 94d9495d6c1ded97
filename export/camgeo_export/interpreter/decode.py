"""Lines of programs turned into blocks: words of ISO 6983, and the conversational format.

Covers the dialects of our profiles: comments in brackets or behind a semicolon, `%` and `O`
around programs, and Sinumerik's commands `CYCLE832(...)`, addresses with an equals sign and
coordinates with `AC(...)` or `IC(...)`.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Final

from camgeo.reading import COORDINATE, DIGITS, number_of
from camgeo.units import MM_PER, shortened
from camgeo_export.interpreter.controller import (
    COORDINATES,
    CYCLE,
    CYCLES,
    GROUP_OF,
    KNOWN,
    Block,
    BlockReader,
    Controller,
    Findings,
    Number,
    State,
    normal,
)

NUMBER: Final = r"[-+]?(?:\d+\.?\d*|\.\d+)"

PLAIN: Final = re.compile(rf"(?:\s*+[A-Z]\s*+{NUMBER})*+\s*+", re.ASCII)
"""A block of words only."""

WORD: Final = re.compile(rf"([A-Z])\s*+({NUMBER})", re.ASCII)

TOKEN: Final = re.compile(
    rf"""\s*+(?:
      (?P<command>[A-Z_][A-Z_0-9]*+)\s*+\((?P<arguments>(?:"[^"]*+"|[^()"]++)*+)\)
    | (?P<address>[A-Z]+\d*+)\s*+=\s*+(?:
          (?P<value>{NUMBER}) | (?P<way>AC|IC)\s*+\(\s*+(?P<inner>{NUMBER})\s*+\)
        | "(?P<name>[^"]*+)" )
    | (?P<letter>[A-Z])\s*+(?P<number>{NUMBER})(?![\d.=])
    | (?P<keyword>[A-Z_]{{2,}}+[A-Z_0-9]*+)
    )""",
    re.ASCII | re.VERBOSE,
)

BRACKETS: Final = re.compile(r"\(([^()]*+)\)", re.ASCII)

LONGEST: Final = 60
"""Characters of a block that a finding shows."""

FLOW: Final = re.compile(
    r"[#\[\]]|\bR\d+\s*=|\b(?:IF|WHILE|GOTO[BFCS]?|FOR|LOOP|DEF|PROC|SUB|ENDSUB|CALL|DO|REPEAT)\b"
)
"""Parameters, expressions and control of flow."""


@dataclass(slots=True)
class Words:
    """One line taken apart.

    Attributes
    ----------
    line : in the file, counted from 1.
    words : letters or addresses with their numbers, in their order.
    ways : of Sinumerik's coordinates: "AC" or "IC", by address.
    commands : names with what is in their brackets; keywords have None.
    names : texts in quotes by their addresses.
    """

    line: int
    words: list[tuple[str, Number]] = field(default_factory=list)
    ways: dict[str, str] = field(default_factory=dict)
    commands: list[tuple[str, str | None]] = field(default_factory=list)
    names: dict[str, str] = field(default_factory=dict)


def without_comments(
    line: int, text: str, brackets: bool, findings: Findings, *, may_end: bool = False
) -> tuple[str, list[str]]:
    """The block in a line, and its comments; `brackets` says whether ( ) hold some, which with
    `may_end` may end with the line.
    """
    if not brackets or not ("(" in text or ")" in text):
        block, mark, note = text.partition(";")
        return block, [note.strip()] if mark else []
    notes: list[str] = []
    while found := BRACKETS.search(text):
        cut = text.find(";", 0, found.start())
        if cut >= 0:
            break
        notes.append(found[1].strip())
        text = f"{text[: found.start()]} {text[found.end() :]}"
        if notes and text.count("(") and found.start() > text.find("("):
            findings.add(line, "comment", "a comment in brackets holds another")
            return text.partition("(")[0], notes
    block, mark, note = text.partition(";")
    if mark:
        notes.append(note.strip())
    for bracket in "()":
        if bracket in block and not (bracket == "(" and may_end):
            what = "a comment does not end in its line" if bracket == "(" else "a bracket too many"
            findings.add(line, "comment", what, bracket)
        if bracket in block:
            block = block.partition(bracket)[0] if bracket == "(" else block.replace(")", " ")
    return block, notes


def words_of(line: int, block: str, extended: bool, findings: Findings) -> Words | None:
    """The words of a block without comments, in capitals; None if it cannot be read.

    `extended` allows Sinumerik's commands and addresses.
    """
    found = Words(line)
    if PLAIN.fullmatch(block):
        for letter, text in WORD.findall(block):
            if not _put(found, letter, text, findings):
                return None
        return found
    if not extended and PLAIN.fullmatch(joined := "".join(block.split())):
        return words_of(line, joined, extended, findings)
    if FLOW.search(block):
        what = "parameters, expressions and control of flow are outside what is read"
        findings.add(line, "unsupported", what, shown(block))
        return None
    if not extended:
        rest = WORD.sub(" ", block).split()
        findings.add(line, "unreadable", "cannot be read", shown(" ".join(rest) or block))
        return None
    return found if _extended(found, block, findings) else None


def _extended(found: Words, block: str, findings: Findings) -> bool:
    at, end = 0, len(block.rstrip())
    while at < end:
        token = TOKEN.match(block, at)
        if token is None:
            findings.add(found.line, "unreadable", "cannot be read", shown(block[at:].strip()))
            return False
        at = token.end()
        if token["command"]:
            found.commands.append((token["command"], token["arguments"].strip()))
        elif token["keyword"]:
            found.commands.append((token["keyword"], None))
        elif token["name"] is not None:
            found.names[token["address"]] = token["name"]
        else:
            address = token["letter"] or token["address"]
            if token["way"]:
                found.ways[address] = token["way"]
            text = token["number"] or token["value"] or token["inner"]
            if not _put(found, address, text, findings):
                return False
    return True


def _put(found: Words, letter: str, text: str, findings: Findings) -> bool:
    value = number_of(text)
    if value is None:
        what = f"the word {(letter + text)[:40]} has more than {DIGITS} digits or is beyond"
        findings.add(found.line, "number", f"{what} {COORDINATE:g}")
        return False
    found.words.append((letter, Number(value, text)))
    return True


def shown(text: str) -> str:
    """What a finding shows of a text."""
    return shortened(text, LONGEST)


# -- words -----------------------------------------------------------------------------------------
# Words turned into a block.


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


class Decoder(BlockReader):
    """Turns blocks without comments, in capitals, into what they do."""

    def block_of(self, line: int, text: str) -> Block | None:
        """The block in a line of an ISO dialect; None if it cannot be read. What cannot be run in
        it is found and left out.
        """
        words = words_of(line, text, self._controller.extended, self._findings)
        if words is None:
            return None
        block, largest = Block(line), self._reading.largest_number
        for letter, number in words.words:
            if letter == "N" and number.value > largest:
                what = f"N{number.text} is too large"
                self._report(block, "line-number", what, allowed=f"at most {largest}")
        codes: list[str] = []
        for place, (letter, number) in enumerate(words.words):
            if letter in ("G", "M"):
                codes.append(normal(letter, number.text))
                self._code(block, codes[-1])
                continue
            if letter == "N" and place and self._reading.number_first:
                what = f"N{number.text} behind other words"
                self._report(block, "line-number", what, allowed="at the start of the block")
            self._value(block, letter, number)
        if len(codes) > 1:
            self._check_alone(block, codes)
        for address, way in words.ways.items():
            block.relative[address] = way == "IC"
        for name, arguments in words.commands:
            self._command(block, name, arguments)
        for address, text in words.names.items():
            if address != "T":
                self._report(block, "unsupported", f'{address}="{shown(text)}" is not read')
            block.names[address] = text
        self._check_points(block)
        return block

    def _check_alone(self, block: Block, codes: list[str]) -> None:
        """Find words of which a block may have one, that are not of one modal group."""
        for words in self._controller.alone:
            found = [word for word in dict.fromkeys(codes) if word in words]
            if len(found) > 1:
                what = f"{' and '.join(found)} exclude each other in a block"
                self._report(block, "conflict", what, allowed="one of them in a block")
                return

    def _code(self, block: Block, word: str) -> None:
        """Put the G or M word `word` into a block; what the controller lacks is found."""
        meaning = self._controller.meanings.get(word)
        if meaning is None:
            name = self._controller.machine.name
            use = f", {KNOWN[word]}," if word in KNOWN else ""
            block.broken = block.broken or word.startswith("G")
            if KNOWN.get(word) == CYCLE:
                block.codes["motion"], block.words["motion"] = CYCLE, word
            if word in self._controller.accepted:
                self._report(block, "unsupported", f"{word}{use} is outside what is read")
            else:
                self._report(block, "unknown-word", f"{name} has no {word}{use}".rstrip(","))
            return
        group = GROUP_OF[meaning]
        if group == "none":
            return
        place = block.actions if group == "once" else block.codes
        key = meaning if group == "once" else group
        if key in place:
            if block.words[key] == word:
                self._report(block, "repeated-word", f"{word} is there twice")
            else:
                what = f"{block.words[key]} and {word} are both of the group {group}"
                self._report(block, "conflict", what, allowed="one of them in a block")
            return
        place[key] = meaning
        block.words[key] = word

    def _value(self, block: Block, letter: str, number: Number) -> None:
        if len(letter) > 1:
            if letter not in self._controller.names:
                what = f"{self._controller.machine.name} has no address {letter}"
                self._report(block, "unknown-word", what)
                return
            if self._controller.meanings.get(letter) == "no effect":
                return
            if letter not in ADDRESSES:
                block.broken = True
                self._report(block, "unsupported", f"{letter}= is outside what is read")
                return
            letter = ADDRESSES[letter]
        elif letter not in self._controller.letters:
            name = self._controller.machine.name
            self._report(block, "unknown-word", f"{name} has no words that begin with {letter}")
            return
        elif letter not in READ:
            what = f"words that begin with {letter} are outside what is read"
            block.broken = True
            self._report(block, "unsupported", what)
            return
        if letter in block.values:
            self._report(block, "repeated-word", f"the word {letter} is there twice")
            return
        self._check_reach(block, letter, number)
        if letter in WHOLE and (number.value < 0.0 or (number.value % 1.0 and letter != "D")):
            self._report(block, "number", f"{letter} must be a whole number", number.text)
        if letter in "FS" and number.value < 0.0:
            self._report(block, "number", f"{letter} must not be negative", number.text)
        block.values[letter] = number

    def _check_reach(self, block: Block, letter: str, number: Number) -> None:
        """Find a coordinate that is larger than the controller reads."""
        largest = self._controller.machine.numbers.largest
        if letter in COORDINATES and abs(number.value) > largest:
            allowed = f"at most {largest:.10g} in magnitude"
            self._report(block, "number", f"{letter} is too large", number.text, allowed)

    def _command(self, block: Block, name: str, arguments: str | None) -> None:
        meaning = self._controller.meanings.get(name)
        if name not in self._controller.names and (meaning is None or arguments is not None):
            word = name if arguments is None else f"{name}(...)"
            self._report(
                block, "unknown-word", f"{self._controller.machine.name} has no {shown(word)}"
            )
        elif name == "CYCLE832":
            self._smoothing(block, arguments or "")
        elif meaning == "no effect" or (name in FRAMES and block.values.keys() <= {"N"}):
            return
        elif name in ALONE or meaning == "machine position":
            block.actions["machine position"] = "machine position"
            block.words["machine position"] = name
        else:
            block.broken = True
            self._report(block, "unsupported", f"{name} is outside what is read")

    def _smoothing(self, block: Block, arguments: str) -> None:
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
            self._report(block, "unreadable", "CYCLE832 without its tolerance", shown(arguments))
            return
        if len(parts) < 3:
            self._report(
                block, "missing-word", "CYCLE832 without its third argument", shown(arguments),
                "CYCLE832(tolerance,kind,1)",
            )  # fmt: skip
        block.values["tolerance"] = Number(value, parts[0])

    def _check_points(self, block: Block) -> None:
        """Coordinates without a decimal point, where the controller counts them in increments."""
        increment = self._controller.machine.numbers.increment
        if increment is None:
            return
        counts = self._reading.repeats if block.codes.get("motion") in CYCLES else ""
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
                self._report(block, "decimal-point", what, allowed=f"{word}.0")


# -- conversational -------------------------------------------------------------------------------
# Heidenhain's conversational format turned into blocks.
#
# Read are BEGIN and END PGM, BLK FORM, TOOL CALL and TOOL DEF, lines L and LP, circles C, CP, CR,
# CT and CTP with the centre CC, STOP, M words, the cycles 9 (dwell), 32 (tolerance), 247 (datum).


TERM: Final = re.compile(
    rf"""\s*+(?:
      (?P<sense>DR\s*+[-+])(?![\d.])
    | (?P<side>R[0LR])(?![\d.])
    | (?P<fast>FMAX|F\s++MAX)
    | (?P<auto>F\s*+AUTO)
    | (?P<letter>I?(?:PA|PR|[XYZ])|F|S|M|R|DL|DR|T)\s*+(?P<number>{NUMBER})
    )""",
    re.ASCII | re.VERBOSE,
)

HEAD: Final = re.compile(r"\A\d++(?:\s++|\Z)", re.ASCII)
"""The number of a block."""

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


class Klartext(Decoder):
    """Turns lines into blocks."""

    def __init__(self, controller: Controller, state: State, findings: Findings) -> None:
        super().__init__(controller, state, findings)
        self._begun = False
        self._tool_feed: Number | None = None
        self._cycle = ""

    def blocks(self, line: int, text: str) -> list[Block]:
        """The blocks of a line in capitals, without comment."""
        rest = HEAD.sub("", text).rstrip(" ~")
        if not rest or rest.startswith("*"):
            return []
        if found := BEGIN.fullmatch(rest):
            return self._program(line, found)
        if not self._begun:
            self._begun = True
            self._findings.add(line, "frame", "a program begins with BEGIN PGM, its name and MM")
        if FORM.fullmatch(rest):
            return []
        if found := CALL.fullmatch(rest):
            return [self._tool_call(line, found)]
        if found := CYCLE_BLOCK.fullmatch(rest):
            return self._cycle_of(line, found)
        if PARAMETER.fullmatch(rest):
            if not self._cycle:  # of which it would be one on a line of its own
                what = "parameters, expressions and control of flow are outside what is read"
                self._findings.add(line, "unsupported", what, shown(rest))
            return []
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
        return HEAD.sub("", text).startswith("END PGM")

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

    def _tool_call(self, line: int, found: re.Match[str]) -> Block:
        block = self._words(line, DELTA.sub("", found[3]))
        over = [number_of(each["radius"]) for each in DELTA.finditer(found[3]) if each["radius"]]
        self._state.oversize = (over[-1] or 0.0) * self._state.scale if over else 0.0
        if found[1] is None:  # another speed of the same tool
            self._tool_feed = block.values.get("F", self._tool_feed)
            return block
        self._tool_feed = block.values.get("F")
        number = found[1]
        if number.startswith('"'):
            self._findings.add(
                line, "unsupported", "a tool called by name: its number is not known", shown(number)
            )
            return block
        block.values["T"] = Number(float(number[:9]), number)
        block.codes["tool"], block.words["tool"] = "tool change", "TOOL CALL"
        if found[2] != "Z":
            what = "TOOL CALL without Z as the axis of the tool"
            self._findings.add(line, "plane", what, allowed="TOOL CALL n Z")
        return block

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
            self._findings.add(line, "unsupported", f"cycle {number} is outside what is read")
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
            found = TERM.match(text, at)
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
            self._report(block, "missing-word", what, allowed="TOOL CALL n Z S F")
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
            self._report(block, "number", f"the number {text[:40]} cannot be one of a program")
            return
        if letter == "M":
            word = normal("M", text)
            for each in COMBINED.get(word, (word,)):
                self._code(block, each)
            return
        name = letter.removeprefix("I") if letter != "I" else letter
        if name in block.values:
            self._report(block, "repeated-word", f"the word {name} is there twice")
            return
        if letter.startswith("I"):
            block.relative[name] = True
        elif name in ("X", "Y", "Z", "PA"):
            block.relative[name] = False
        block.values[name] = Number(value, text)
        self._check_reach(block, name, block.values[name])

    def _refuse(self, line: int, text: str) -> None:
        unread = UNREAD.match(text)
        if not (unread and unread[1] in STILL):
            self._state.lose()
        if unread:
            self._findings.add(
                line, "unsupported", f"{unread[1]} is outside what is read", shown(text)
            )
        else:
            self._findings.add(line, "unreadable", "cannot be read", shown(text))
