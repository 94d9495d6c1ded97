"""What the interpreter is based on: a machine profile prepared for looking up words, the modal
state, the meanings of words, and lines decoded into blocks.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Final, NamedTuple, Self

from camgeo.milling.machine import Increments, Machine
from camgeo.reading import COORDINATE, DIGITS, parse_number
from camgeo.units import MM_PER, shortened
from camgeo_export.interpreter.moves import Findings


@dataclass(frozen=True, slots=True)
class Controller:
    """A machine profile, prepared for the interpreter.

    Attributes
    ----------
    machine : the profile.
    meanings : of every word that the controller accepts and that is read, e.g. {"G1": "line"}; of
        names with more than one letter only those of the profile.
    accepted : every word that it accepts, also those that are not read.
    letters : that may begin a word.
    names : of commands and addresses of more than one letter.
    brackets : whether ( ) hold comments.
    extended : whether it has commands and addresses with an equals sign, as Sinumerik has.
    groups : modal groups of which it has words.
    dwell_letters : of words with a dwell, the one of the profile's own form first.
    length_letter : "H", or "D" where that puts the tool's length into force by itself; "" where no
        word has to.
    changes_tools : whether it has a word that changes tools.
    alone : sets of words of which a block may have one.
    """

    machine: Machine
    meanings: dict[str, str]
    accepted: frozenset[str]
    letters: str
    names: frozenset[str]
    brackets: bool
    extended: bool
    groups: frozenset[str]
    dwell_letters: str
    length_letter: str
    changes_tools: bool
    alone: tuple[frozenset[str], ...]

    @classmethod
    def from_machine(cls, machine: Machine) -> Self:
        """The controller of a profile."""
        words = machine.words
        accepted = {normal("G", f"{code:g}") for code in words.g}
        accepted |= {normal("M", f"{code:g}") for code in words.m}
        meanings = {word: COMMON[word] for word in accepted if word in COMMON}
        meanings |= words.special_meanings
        meanings = {word: meaning for word, meaning in meanings.items() if meaning != "not read"}
        lengths = machine.tool_change.length_offset
        length_letter = ""
        if any("H{tool}" in block for block in lengths):
            length_letter = "H"
        elif any(re.match(r"D\d", block) for block in lengths):
            length_letter = "D"
        dwell_letters = machine.reading.dwell
        dwells = [re.search(r"([A-Z])\{dwell\}", block) for block in machine.dwell.blocks]
        return cls(
            machine,
            meanings,
            frozenset(accepted | set(words.names)),
            words.letters,
            frozenset(words.names),
            machine.dialect == "iso" and machine.text.comment_open.strip().startswith("("),
            any(len(name) > 1 for name in words.names),
            frozenset(MODAL_GROUPS[meaning] for meaning in meanings.values()),
            "".join(
                dict.fromkeys(next((match[1] for match in dwells if match), "P") + dwell_letters)
            ),
            length_letter,
            "tool change" in meanings.values() or machine.dialect == "klartext",
            tuple(frozenset(group.split()) for group in machine.reading.alone),
        )

    def group_words(self, group: str) -> list[str]:
        """The words of a modal group."""
        return [word for word, meaning in self.meanings.items() if MODAL_GROUPS[meaning] == group]

    def smoothing_letter(self, word: str) -> str:
        """Letter of the word with the deviation in the smoothing block that begins with `word`."""
        smoothing = self.machine.smoothing
        for block in smoothing.on if smoothing is not None else ():
            match = re.search(r"([A-Z])\{p\}", block)
            if match and block.split()[0] == word:
                return match[1]
        return ""


# -- state ----------------------------------------------------------------------------------------
# The modal state of a controller while it runs a program.


UNKNOWN = complex(math.nan, math.nan)


@dataclass(slots=True, eq=False)
class State:
    """Lengths in mm, feed in mm/min.

    Attributes
    ----------
    modes : meaning that is active, by modal group; a group without one was never set.
    scale : mm in a unit of the program; NaN before it is stated.
    place, z : position; NaN where it is unknown.
    pole : centre that klartext sets with a block of its own.
    feed : programmed, 0 if none was, or if a change of the feed's mode has cancelled it.
    chosen, tool : numbers of the tool that is prepared, and of the one in the spindle.
    offset : number of the tool whose length is active; 0 if none is.
    measured : the tool that was in the spindle when a length was last activated; 0 after a change
        of the tool.
    radius_offset : number of the radius offset of the compensation.
    stated_radius : of the compensation, where the program states it itself; NaN if it does not.
    oversize : what the program adds to the radius of the tool table [mm].
    work_offset : word of the work offset; empty before one is stated.
    blending, naive_cam : how far the path may leave the programmed one; infinite without a bound.
    operation : the last one named by a comment.
    left_compensation : line of the block that ended compensation, until the next motion; 0 after.
    used_coolant : whether coolant has flowed since the tool came into the spindle.
    dry : line of the tool's first cut below the top of the stock without coolant; 0 if none.
    ended : whether the program has ended.
    step : last printed decimal [mm].
    heading : of the last move, of length 1.
    lost : whether a cut from an unknown position was reported, and none from a known one followed.
    rounding : radius of the corner at which the last move ends; 0 for a sharp one.
    cycle : word of the cycle of holes that is active; empty if none is.
    hole : words of the cycle of holes that is active [mm], which its blocks need not repeat.
    above : height before the cycle of holes began; NaN outside one.
    last_z : last known height, in the tool length that was active then.
    cut_blending, cut_naive_cam : largest ones during a cut; -1 before the first.
    cut_scale : mm in a unit at the first cut.
    """

    modes: dict[str, str] = field(default_factory=dict)
    scale: float = math.nan
    place: complex = UNKNOWN
    z: float = math.nan
    pole: complex = UNKNOWN
    feed: float = 0.0
    speed: float = 0.0
    chosen: int = 0
    tool: int = 0
    offset: int = 0
    measured: int = 0
    radius_offset: int = 0
    stated_radius: float = math.nan
    oversize: float = 0.0
    work_offset: str = ""
    blending: float = math.inf
    naive_cam: float = math.inf
    operation: str = ""
    left_compensation: int = 0
    used_coolant: bool = False
    dry: int = 0
    ended: bool = False
    step: float = math.inf
    heading: complex = UNKNOWN
    lost: bool = False
    rounding: float = 0.0
    cycle: str = ""
    hole: dict[str, float] = field(default_factory=dict)
    above: float = math.nan
    last_z: float = math.nan
    cut_blending: float = -1.0
    cut_naive_cam: float = 0.0
    cut_scale: float = math.nan

    @property
    def unit(self) -> float:
        """mm in a unit of the program; before one is stated a millimetre."""
        return 1.0 if math.isnan(self.scale) else self.scale

    def lose(self) -> None:
        """Go on after a block that cannot be read: where it ends is unknown."""
        self.place, self.z, self.heading = UNKNOWN, math.nan, UNKNOWN

    def mode(self, group: str) -> str:
        """The active meaning of a group; empty if it was never set."""
        return self.modes.get(group, "")

    @property
    def spinning(self) -> bool:
        """Whether the spindle turns."""
        running = ("spindle clockwise", "spindle counter-clockwise")
        return self.mode("spindle") in running and self.speed > 0.0

    @property
    def has_length(self) -> bool:
        """Whether a length offset is active for the tool in the spindle."""
        return self.tool in (self.offset, self.measured)

    @property
    def coolant(self) -> str:
        """The kind of coolant that flows: "flood", "mist", "through" or "off"."""
        meaning = self.mode("coolant")
        return "off" if meaning in ("", "coolant off") else meaning

    @property
    def side(self) -> str:
        """The side of the path on which compensation keeps the cutter: "left", "right" or ""."""
        meaning = self.mode("compensation")
        return (
            meaning.removeprefix("compensation ") if meaning not in ("", "compensation off") else ""
        )


# -- codes ----------------------------------------------------------------------------------------
# What G and M words mean on controllers with the words of ISO 6983.
#
# A meaning is a name in a modal group. A profile lists the words that its controller accepts; those
# whose meaning is not the common one it maps to another of these names.


GROUPS: Final[Mapping[str, tuple[str, ...]]] = MappingProxyType(
    {
        "motion": ("rapid", "line", "clockwise arc", "counter-clockwise arc", "holes", "bores"),
        "plane": ("plane XY", "plane ZX", "plane YZ"),
        "unit": ("inch", "mm"),
        "distance": ("absolute", "incremental"),
        "centres": ("absolute centres", "incremental centres"),
        "feed mode": ("inverse time", "feed per minute", "feed per revolution"),
        "compensation": ("compensation off", "compensation left", "compensation right"),
        "length": ("length offset", "length offset off"),
        "work offset": ("work offset",),
        "path mode": ("exact stop", "exact path", "continuous path"),
        "smoothing": ("smoothing",),
        "cycle": ("cycle off", "motion off"),
        "return": ("return to start", "return to R"),
        "spindle": ("spindle clockwise", "spindle counter-clockwise", "spindle off"),
        "coolant": ("flood", "mist", "through", "coolant off"),
        "flow": ("stop", "optional stop", "end"),
        "tool": ("tool change",),
        "once": ("dwell", "machine position", "home"),
        "none": ("no effect",),
    }
)
"""Meanings by modal group. Those of "once" and "none" are not modal."""

MODAL_GROUPS: Final[Mapping[str, str]] = MappingProxyType(
    {meaning: group for group, meanings in GROUPS.items() for meaning in meanings}
)

COMMON: Final[Mapping[str, str]] = MappingProxyType(
    {
        "G0": "rapid", "G1": "line", "G2": "clockwise arc", "G3": "counter-clockwise arc",
        "G4": "dwell",
        "G17": "plane XY", "G18": "plane ZX", "G19": "plane YZ",
        "G20": "inch", "G21": "mm",
        "G28": "home", "G30": "home",
        "G40": "compensation off", "G41": "compensation left", "G42": "compensation right",
        "G41.1": "compensation left", "G42.1": "compensation right",
        "G43": "length offset", "G43.1": "length offset", "G49": "length offset off",
        "G53": "machine position",
        **dict.fromkeys(
            ("G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3"), "work offset"
        ),
        **{f"G{number}": "work offset" for number in range(505, 600)},
        "G61": "exact path", "G61.1": "exact stop", "G64": "continuous path",
        "G80": "cycle off",
        "G90": "absolute", "G91": "incremental",
        "G90.1": "absolute centres", "G91.1": "incremental centres",
        "G93": "inverse time", "G94": "feed per minute", "G95": "feed per revolution",
        "G81": "holes", "G85": "bores",
        "G97": "no effect",
        "G98": "return to start", "G99": "return to R",
        "M0": "stop", "M1": "optional stop", "M2": "end", "M30": "end",
        "M3": "spindle clockwise", "M4": "spindle counter-clockwise", "M5": "spindle off",
        "M6": "tool change",
        "M7": "mist", "M8": "flood", "M9": "coolant off",
    }
)  # fmt: skip
"""The common meaning of a word, its number without leading zeros."""

CYCLE: Final = "a cycle"
"""Motion of the blocks of a cycle, which is reported and not run: their places in the plane are
known, and the height is taken for that at which the cycle began."""

KNOWN: Final[Mapping[str, str]] = MappingProxyType(
    {
        "G5": "a spline", "G5.1": "a spline", "G5.2": "a spline", "G5.3": "a spline",
        "G10": "data of the controller", "G15": "polar coordinates", "G16": "polar coordinates",
        "G31": "a probe", "G33": "a thread", "G33.1": "a thread",
        **{f"G38.{number}": "a probe" for number in range(2, 6)},
        "G50": "a scale", "G51": "a scale", "G52": "a shifted zero",
        "G65": "a macro", "G66": "a macro", "G68": "a rotation", "G69": "a rotation",
        **{f"G{number}": CYCLE for number in (73, 74, 76, 82, 83, 84, 86, 87, 88, 89)},
        "G92": "a shifted zero", "G92.1": "a shifted zero", "G92.2": "a shifted zero",
        "G96": "a constant surface speed",
        "M19": "an angle of the spindle", "M98": "a subprogram", "M99": "the end of a subprogram",
    }
)  # fmt: skip
"""What further words mean, for messages: none of them is supported."""

CYCLES: Final = ("holes", "bores")
"""Motions of a hole that is left at a traverse, and of one that is left at the feed up to R."""

COORDINATES: Final = frozenset("XYZIJKR")
"""Words whose size depends on the decimal point on controllers that count in increments."""


def normal(letter: str, number: str) -> str:
    """A word as the tables have it: G01 is G1, G43.10 is G43.1."""
    whole, _, part = number.partition(".")
    whole = whole.lstrip("+0") or "0"
    part = part.rstrip("0")
    return f"{letter}{whole}{'.' if part else ''}{part}"


# -- block ----------------------------------------------------------------------------------------
# A block of a program in terms that all dialects share.


AXES = "XYZ"


class Number(NamedTuple):
    """A number as printed, and its value."""

    value: float
    text: str

    @property
    def has_point(self) -> bool:
        return "." in self.text

    @property
    def decimals(self) -> int:
        return len(self.text.partition(".")[2])

    def in_increments(self, increments: Increments | None, unit: str) -> float:
        """The value in units of the program, "mm" or "inch": without a decimal point it may count
        in increments.
        """
        if increments is None or self.has_point:
            return self.value
        return self.value * (increments.inch if unit == "inch" else increments.mm)


@dataclass(slots=True)
class Block:
    """One block.

    Attributes
    ----------
    line : in the file, counted from 1.
    codes : what it switches, by modal group: {"motion": "rapid", "unit": "mm"}.
    actions : what it does once: "dwell", "machine-position", "reference", "change-tool".
    values : of its words, by their letters.
    words : the word, as written, that a group or an action comes from; for messages.
    relative : by axis, whether its value adds to the position, where the block says so itself.
    arc : how it states an arc: "centre", "pole", "radius", "polar", "tangent".
    names : further texts of it, e.g. the name of a tool.
    broken : whether a word of it is not read that may say what it does: then it does nothing.
    """

    line: int
    codes: dict[str, str] = field(default_factory=dict)
    actions: dict[str, str] = field(default_factory=dict)
    values: dict[str, Number] = field(default_factory=dict)
    words: dict[str, str] = field(default_factory=dict)
    relative: dict[str, bool] = field(default_factory=dict)
    arc: str = ""
    names: dict[str, str] = field(default_factory=dict)
    broken: bool = False

    def at_line(self, line: int) -> Block:
        """A copy of the block for another line, with values that can be changed."""
        return Block(
            line,
            self.codes,
            self.actions,
            dict(self.values),
            self.words,
            self.relative,
            self.arc,
            self.names,
            self.broken,
        )

    def value(self, letter: str, default: float = 0.0) -> float:
        """The value of a word, or `default` if it is not there."""
        number = self.values.get(letter)
        return default if number is None else number.value


# -- readers --------------------------------------------------------------------------------------
# What all readers of blocks have.


class BlockReader:
    """Reads blocks for a controller in its present state, and reports what is wrong with them."""

    def __init__(self, controller: Controller, state: State, findings: Findings) -> None:
        self._controller = controller
        self._state = state
        self._findings = findings
        self._reading = controller.machine.reading

    def _report(
        self, block: Block, rule: str, what: str, value: str = "", allowed: str = ""
    ) -> None:
        self._findings.add(block.line, rule, what, value, allowed)

    def _coordinate(self, block: Block, letter: str) -> float:
        """A coordinate of a block [mm]."""
        increments = self._controller.machine.numbers.increment if letter in COORDINATES else None
        unit = self._state.mode("unit")
        return block.values[letter].in_increments(increments, unit) * self._state.unit


# -- decode ---------------------------------------------------------------------------------------
# Lines of programs turned into blocks: words of ISO 6983, and the conversational format.
#
# Covers the dialects of our profiles: comments in brackets or behind a semicolon, `%` and `O`
# around programs, and Sinumerik's commands `CYCLE832(...)`, addresses with an equals sign and
# coordinates with `AC(...)` or `IC(...)`.


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
"""Parameters, expressions and flow control."""


@dataclass(slots=True)
class Words:
    """The words of one line.

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


def parse_words(line: int, block: str, extended: bool, findings: Findings) -> Words | None:
    """The words of a block without comments, in capitals; None if it cannot be read.

    `extended` allows Sinumerik's commands and addresses.
    """
    words = Words(line)
    if PLAIN.fullmatch(block):
        for letter, text in WORD.findall(block):
            if not _add_word(words, letter, text, findings):
                return None
        return words
    if not extended and PLAIN.fullmatch(joined := "".join(block.split())):
        return parse_words(line, joined, extended, findings)
    if FLOW.search(block):
        what = "parameters, expressions and flow control are not supported by camgeo"
        findings.add(line, "unsupported", what, excerpt(block))
        return None
    if not extended:
        rest = WORD.sub(" ", block).split()
        findings.add(line, "unreadable", "cannot be read", excerpt(" ".join(rest) or block))
        return None
    return words if _extended(words, block, findings) else None


def _extended(words: Words, block: str, findings: Findings) -> bool:
    position, end = 0, len(block.rstrip())
    while position < end:
        token = TOKEN.match(block, position)
        if token is None:
            findings.add(
                words.line, "unreadable", "cannot be read", excerpt(block[position:].strip())
            )
            return False
        position = token.end()
        if token["command"]:
            words.commands.append((token["command"], token["arguments"].strip()))
        elif token["keyword"]:
            words.commands.append((token["keyword"], None))
        elif token["name"] is not None:
            words.names[token["address"]] = token["name"]
        else:
            address = token["letter"] or token["address"]
            if token["way"]:
                words.ways[address] = token["way"]
            text = token["number"] or token["value"] or token["inner"]
            if not _add_word(words, address, text, findings):
                return False
    return True


def _add_word(words: Words, letter: str, text: str, findings: Findings) -> bool:
    value = parse_number(text)
    if value is None:
        word = (letter + text)[:40]
        what = f"the word {word} has more than {DIGITS} digits or is beyond {COORDINATE:g}"
        findings.add(words.line, "number", what)
        return False
    words.words.append((letter, Number(value, text)))
    return True


def excerpt(text: str) -> str:
    """The beginning of a text that a finding shows, at most `LONGEST` characters."""
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

    def without_comments(self, line: int, text: str) -> tuple[str, list[str]]:
        """The block in a line, and its comments."""
        if not self._controller.brackets or not ("(" in text or ")" in text):
            block, mark, note = text.partition(";")
            return block, [note.strip()] if mark else []
        notes: list[str] = []
        while match := BRACKETS.search(text):
            # A semicolon before the bracket turns the rest of the line into one comment.
            cut = text.find(";", 0, match.start())
            if cut >= 0:
                break
            notes.append(match[1].strip())
            text = f"{text[: match.start()]} {text[match.end() :]}"
            if notes and text.count("(") and match.start() > text.find("("):
                self._findings.add(line, "comment", "a comment in brackets contains another one")
                return text.partition("(")[0], notes
        block, mark, note = text.partition(";")
        if mark:
            notes.append(note.strip())
        for bracket in "()":
            if bracket in block and not (bracket == "(" and self._reading.open_comment):
                what = (
                    "a comment does not end in its line"
                    if bracket == "("
                    else "a closing bracket without an opening one"
                )
                self._findings.add(line, "comment", what, bracket)
            if bracket in block:
                block = block.partition(bracket)[0] if bracket == "(" else block.replace(")", " ")
        return block, notes

    def read_block(self, line: int, text: str) -> Block | None:
        """The block in a line of an ISO dialect; None if it cannot be read. What cannot be run of
        it is reported and left out.
        """
        words = parse_words(line, text, self._controller.extended, self._findings)
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
                what = f"N{number.text} after other words"
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
                self._report(block, "unsupported", f'{address}="{excerpt(text)}" is not read')
            block.names[address] = text
        self._check_points(block)
        return block

    def _check_alone(self, block: Block, codes: list[str]) -> None:
        """Report words that exclude each other in a block though their modal groups differ."""
        for words in self._controller.alone:
            conflicting = [word for word in dict.fromkeys(codes) if word in words]
            if len(conflicting) > 1:
                what = f"{' and '.join(conflicting)} exclude each other in a block"
                self._report(block, "conflict", what, allowed="one of them in a block")
                return

    def _code(self, block: Block, word: str) -> None:
        """Put the G or M word `word` into a block; report it if the controller does not have it."""
        meaning = self._controller.meanings.get(word)
        if meaning is None:
            name = self._controller.machine.name
            use = f", {KNOWN[word]}," if word in KNOWN else ""
            block.broken = block.broken or word.startswith("G")
            if KNOWN.get(word) == CYCLE:
                block.codes["motion"], block.words["motion"] = CYCLE, word
            if word in self._controller.accepted:
                self._report(block, "unsupported", f"{word}{use} is not supported by camgeo")
            else:
                self._report(block, "unknown-word", f"{name} has no {word}{use}".rstrip(","))
            return
        group = MODAL_GROUPS[meaning]
        if group == "none":
            return
        place = block.actions if group == "once" else block.codes
        key = meaning if group == "once" else group
        if key in place:
            if block.words[key] == word:
                self._report(block, "repeated-word", f"{word} appears twice")
            else:
                what = f"{block.words[key]} and {word} are both of the modal group {group}"
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
                self._report(block, "unsupported", f"{letter}= is not supported by camgeo")
                return
            letter = ADDRESSES[letter]
        elif letter not in self._controller.letters:
            name = self._controller.machine.name
            self._report(block, "unknown-word", f"{name} has no words that begin with {letter}")
            return
        elif letter not in READ:
            what = f"words that begin with {letter} are not supported by camgeo"
            block.broken = True
            self._report(block, "unsupported", what)
            return
        if letter in block.values:
            self._report(block, "repeated-word", f"the word {letter} appears twice")
            return
        self._check_reach(block, letter, number)
        if letter in WHOLE and (number.value < 0.0 or (number.value % 1.0 and letter != "D")):
            self._report(block, "number", f"{letter} must be a whole number", number.text)
        if letter in "FS" and number.value < 0.0:
            self._report(block, "number", f"{letter} must not be negative", number.text)
        block.values[letter] = number

    def _check_reach(self, block: Block, letter: str, number: Number) -> None:
        """Report a coordinate that is larger than the controller reads."""
        largest = self._controller.machine.numbers.largest
        if letter in COORDINATES and abs(number.value) > largest:
            allowed = f"at most {largest:.10g} in magnitude"
            self._report(block, "number", f"{letter} is too large", number.text, allowed)

    def _command(self, block: Block, name: str, arguments: str | None) -> None:
        meaning = self._controller.meanings.get(name)
        if name not in self._controller.names and (meaning is None or arguments is not None):
            word = name if arguments is None else f"{name}(...)"
            self._report(
                block, "unknown-word", f"{self._controller.machine.name} has no {excerpt(word)}"
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
            self._report(block, "unsupported", f"{name} is not supported by camgeo")

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
            self._report(block, "unreadable", "CYCLE832 without its tolerance", excerpt(arguments))
            return
        if len(parts) < 3:
            self._report(
                block, "missing-word", "CYCLE832 without its third argument", excerpt(arguments),
                "CYCLE832(tolerance,kind,1)",
            )  # fmt: skip
        block.values["tolerance"] = Number(value, parts[0])

    def _check_points(self, block: Block) -> None:
        """Report coordinates without a decimal point that the controller counts in increments."""
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
                what = (
                    f"{word} without a decimal point counts in {increment.mm:g} mm or"
                    f" {increment.inch:g} inch"
                )
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
"""Those of the known but unread words that move nothing."""


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
        if match := BEGIN.fullmatch(rest):
            return self._program(line, match)
        if not self._begun:
            self._begun = True
            what = "the program does not begin with BEGIN PGM, its name and MM"
            self._findings.add(line, "frame", what)
        if FORM.fullmatch(rest):
            return []
        if match := CALL.fullmatch(rest):
            return [self._tool_call(line, match)]
        if match := CYCLE_BLOCK.fullmatch(rest):
            return self._read_cycle(line, match)
        if PARAMETER.fullmatch(rest):
            if not self._cycle:  # of which it would be one on a line of its own
                what = "parameters, expressions and flow control are not supported by camgeo"
                self._findings.add(line, "unsupported", what, excerpt(rest))
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

    def _program(self, line: int, match: re.Match[str]) -> list[Block]:
        if match[1] == "BEGIN":
            self._begun = True
            unit = "mm" if match[3] == "MM" else "inch"
            self._state.scale = MM_PER["mm"] if unit == "mm" else MM_PER["inch"]
            self._state.modes["unit"] = unit
            return []
        return [Block(line, {"flow": "end"}, words={"flow": "END PGM"})]

    def _tool_call(self, line: int, match: re.Match[str]) -> Block:
        block = self._words(line, DELTA.sub("", match[3]))
        oversizes = [
            parse_number(delta["radius"]) for delta in DELTA.finditer(match[3]) if delta["radius"]
        ]
        self._state.oversize = (oversizes[-1] or 0.0) * self._state.scale if oversizes else 0.0
        if match[1] is None:  # another speed of the same tool
            self._tool_feed = block.values.get("F", self._tool_feed)
            return block
        self._tool_feed = block.values.get("F")
        number = match[1]
        if number.startswith('"'):
            self._findings.add(
                line,
                "unsupported",
                "a tool is called by its name, so its number is not known",
                excerpt(number),
            )
            return block
        block.values["T"] = Number(float(number[:9]), number)
        block.codes["tool"], block.words["tool"] = "tool change", "TOOL CALL"
        if match[2] != "Z":
            what = "TOOL CALL without Z as the tool axis"
            self._findings.add(line, "plane", what, allowed="TOOL CALL n Z")
        return block

    def _read_cycle(self, line: int, match: re.Match[str]) -> list[Block]:
        number, part, rest = match[1], match[2] or "0", match[3].strip()
        self._cycle = number
        if number == "247":
            words = {"work offset": " ".join(match[0].split())}
            return [Block(line, {"work offset": "work offset"}, words=words)]
        block = Block(line)
        if number == "32" and part == "1":
            block.codes["smoothing"], block.words["smoothing"] = "smoothing", "CYCL DEF 32"
            tolerance = re.fullmatch(rf"T\s*+({NUMBER})", rest)
            if tolerance and (value := parse_number(tolerance[1])):
                block.values["tolerance"] = Number(value, tolerance[1])
            else:
                block.names["smoothing"] = "off"
            return [block]
        if number == "9" and part == "1":
            dwell = re.fullmatch(rf"(?:DWELL|V\.?ZEIT)\s*+({NUMBER})", rest)
            value = parse_number(dwell[1]) if dwell else None
            if dwell and value is not None:
                block.actions["dwell"], block.words["dwell"] = "dwell", "CYCL DEF 9"
                block.values["P"] = Number(value, dwell[1])
                return [block]
            self._findings.add(line, "unreadable", "cannot be read", excerpt(rest))
            return []
        if number not in ("9", "32"):
            self._findings.add(line, "unsupported", f"cycle {number} is not supported by camgeo")
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
                what = "a circle without a direction of rotation"
                self._findings.add(line, "arc-form", what, "", "DR+ or DR-")
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
        parts = {"X": state.place.real, "Y": state.place.imag}
        for axis, number in block.values.items():
            if axis not in parts:
                self._findings.add(line, "unused-word", f"CC takes no word {axis}")
                continue
            base = parts[axis] if block.relative.get(axis) else 0.0
            parts[axis] = base + number.value * state.scale
        state.pole = complex(parts["X"], parts["Y"])

    def _words(self, line: int, text: str) -> Block:
        """The words of a path function; what cannot be read of them is reported."""
        block = Block(line)
        position, end = 0, len(text.rstrip())
        while position < end:
            term = TERM.match(text, position)
            if term is None:
                self._refuse(line, text[position:].strip())
                block.broken = True
                break
            position = term.end()
            if term["sense"]:
                block.names["sense"] = term["sense"][-1]
            elif term["side"]:
                self._compensate(block, term["side"])
            elif term["fast"]:
                block.names["fast"] = "FMAX"
            elif term["auto"]:
                self._feed_of_tool(block)
            else:
                self._word(block, term["letter"], term["number"])
        return block

    def _feed_of_tool(self, block: Block) -> None:
        """Take F AUTO: the feed that TOOL CALL states."""
        if self._tool_feed is None:
            what = "F AUTO without a feed F in TOOL CALL"
            self._report(block, "missing-word", what, allowed="TOOL CALL n Z S F")
        else:
            block.values["F"] = self._tool_feed

    def _compensate(self, block: Block, side: str) -> None:
        """Take R0, RL or RR: each block repeats what is active, so only a change is a code."""
        meaning = SIDES[side]
        if meaning != (self._state.mode("compensation") or "compensation off"):
            block.codes["compensation"], block.words["compensation"] = meaning, side

    def _word(self, block: Block, letter: str, text: str) -> None:
        value = parse_number(text)
        if value is None:
            self._report(block, "number", f"the number {text[:40]} is too long or too large")
            return
        if letter == "M":
            word = normal("M", text)
            for code in COMBINED.get(word, (word,)):
                self._code(block, code)
            return
        name = letter.removeprefix("I") if letter != "I" else letter
        if name in block.values:
            self._report(block, "repeated-word", f"the word {name} appears twice")
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
                line, "unsupported", f"{unread[1]} is not supported by camgeo", excerpt(text)
            )
        else:
            self._findings.add(line, "unreadable", "cannot be read", excerpt(text))
