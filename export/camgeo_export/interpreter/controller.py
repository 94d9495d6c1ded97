"""What the interpreter goes by: the meanings of words, a machine profile prepared for looking them
up, the modal state, blocks, and the rules that programs break.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Final, NamedTuple

from camgeo.design.linting import LineFinding
from camgeo.milling.machine import Increments, Machine


@dataclass(frozen=True, slots=True)
class Controller:
    """A profile as the interpreter asks for it.

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

    def smoothing_letter(self, word: str) -> str:
        """Letter of the word with the deviation in the smoothing block that begins with `word`."""
        smoothing = self.machine.smoothing
        for block in smoothing.on if smoothing is not None else ():
            found = re.search(r"([A-Z])\{p\}", block)
            if found and block.split()[0] == word:
                return found[1]
        return ""


def controller_of(machine: Machine) -> Controller:
    """The controller of a profile."""
    words = machine.words
    accepted = {normal("G", f"{code:g}") for code in words.g}
    accepted |= {normal("M", f"{code:g}") for code in words.m}
    meanings = {word: COMMON[word] for word in accepted if word in COMMON}
    meanings |= words.own_meanings
    meanings = {word: meaning for word, meaning in meanings.items() if meaning != "not read"}
    lengths = machine.tool_change.length_offset
    length_letter = ""
    if any("H{tool}" in block for block in lengths):
        length_letter = "H"
    elif any(re.match(r"D\d", block) for block in lengths):
        length_letter = "D"
    own_dwells = machine.reading.dwell
    dwells = [re.search(r"([A-Z])\{dwell\}", block) for block in machine.dwell.blocks]
    return Controller(
        machine,
        meanings,
        frozenset(accepted | set(words.names)),
        words.letters,
        frozenset(words.names),
        machine.text.comment_open.strip().startswith("("),
        any(len(name) > 1 for name in words.names),
        frozenset(GROUP_OF[meaning] for meaning in meanings.values()),
        "".join(dict.fromkeys(next((found[1] for found in dwells if found), "P") + own_dwells)),
        length_letter,
        "tool change" in meanings.values() or machine.dialect == "klartext",
        tuple(frozenset(each.split()) for each in machine.reading.alone),
    )


# -- state ----------------------------------------------------------------------------------------
# The modal state of a controller while it runs a program.


UNKNOWN = complex(math.nan, math.nan)

RETRACTED = math.inf
"""Height of the spindle at its reference, above everything."""


@dataclass(slots=True, eq=False)
class State:
    """Lengths in mm, feed in mm/min.

    Attributes
    ----------
    modes : meaning that is active, by modal group; a group without one was never set.
    scale : mm in a unit of the program; NaN before it is stated.
    at, z : position; NaN where it is unknown.
    pole : centre that klartext sets with a block of its own.
    feed : programmed, 0 if none was, or if a change of the feed's mode has cancelled it.
    chosen, tool : numbers of the tool that is prepared, and of the one in the spindle.
    offset : number of the tool whose length is in force; 0 if none is.
    measured : the tool that was in the spindle when a length was last put into force; 0 after a
        change.
    radius_offset : number of the radius offset of the compensation.
    stated_radius : of the compensation, where the program states it itself; NaN if it does not.
    oversize : what the program adds to the radius of the tool table [mm].
    work_offset : word of the work offset; empty before one is stated.
    blending, naive_cam : how far the path may leave the programmed one; infinite without a bound.
    operation : the last one named by a comment.
    left_compensation : line of the block that ended compensation, until the next motion; 0 after.
    used_coolant : in the present tool's time.
    dry : line of the first cut in it without coolant, and its depth below the stock.
    ended : whether the program has ended.
    step : last printed decimal [mm].
    heading : of the last move, of length 1.
    lost : whether it was told that a cut begins at an unknown position, and none began elsewhere.
    rounding : radius of the corner at which the last move ends; 0 for a sharp one.
    cycle : word of the cycle of holes that is active; empty if none is.
    hole : words of the cycle of holes that is active [mm], which its blocks need not repeat.
    above : height before the cycle of holes began; NaN outside one.
    z_before : last height that was known, in the lengths of its time.
    cut_blending, cut_naive_cam : largest ones during a cut; -1 before the first.
    cut_scale : mm in a unit at the first cut.
    """

    modes: dict[str, str] = field(default_factory=dict)
    scale: float = math.nan
    at: complex = UNKNOWN
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
    z_before: float = math.nan
    cut_blending: float = -1.0
    cut_naive_cam: float = 0.0
    cut_scale: float = math.nan

    @property
    def unit(self) -> float:
        """mm in a unit of the program; before one is stated a millimetre."""
        return 1.0 if math.isnan(self.scale) else self.scale

    def lose(self) -> None:
        """Go on from a block that cannot be read: nobody knows where it ends."""
        self.at, self.z, self.heading = UNKNOWN, math.nan, UNKNOWN

    def mode(self, group: str) -> str:
        """The active meaning of a group; empty if it was never set."""
        return self.modes.get(group, "")

    @property
    def spinning(self) -> bool:
        """Whether the spindle turns."""
        on = ("spindle clockwise", "spindle counter-clockwise")
        return self.mode("spindle") in on and self.speed > 0.0

    @property
    def has_length(self) -> bool:
        """Whether a length was put into force for the tool in the spindle."""
        return self.tool in (self.offset, self.measured)

    @property
    def coolant(self) -> str:
        """What flows: "flood", "mist", "through" or "off"."""
        found = self.mode("coolant")
        return "off" if found in ("", "coolant off") else found

    @property
    def side(self) -> str:
        """Of the path on which compensation keeps the cutter: "left", "right" or ""."""
        found = self.mode("compensation")
        return found.removeprefix("compensation ") if found not in ("", "compensation off") else ""


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


# -- readers --------------------------------------------------------------------------------------
# What all readers of blocks have.


class BlockReader:
    """Reads blocks for a controller, on its state, and adds to the findings what is wrong."""

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
