"""Programs in the words of ISO 6983: their text, codes and blocks, and the rules that they break.

Covers the dialects of our profiles: comments in brackets or behind a semicolon, `%` and `O`
around programs, and Sinumerik's commands `CYCLE832(...)`, addresses with an equals sign and
coordinates with `AC(...)` or `IC(...)`.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Final, NamedTuple

from camgeo.design.linting import LineFinding
from camgeo.reading import COORDINATE, DIGITS, number_of
from camgeo.units import shortened

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
    if not brackets:
        block, mark, note = text.partition(";")
        return block, [note.strip()] if mark else []
    if "(" not in text and ")" not in text:
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
"""Meanings by modal group. Those of "once" and "none" are no modes."""

GROUP_OF: Final[Mapping[str, str]] = MappingProxyType(
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
"""Motion of the blocks of a cycle, which is found and not run: their places in the plane are known,
and the height is taken for that at which it began."""

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
"""What further words are for, for messages: none of them is read."""

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

ARMS = "IJK"
"""Words of an arc's centre, by their axes."""


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
        """The same block at another line, with values of its own."""
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


# -- rules ----------------------------------------------------------------------------------------
# What the interpreter finds fault with: the names of its rules, and the list of what was found.


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
