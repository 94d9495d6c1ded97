"""The tables of a machine profile. machine.schema.json next to it describes every key."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass
from functools import partial
from typing import Annotated, Final

from camgeo.errors import GeometryError
from camgeo.numeric.checked import check_fields, number, one_of, whole
from camgeo.toolpath.machine_fields import (
    EVIDENCE,
    MOST_DECIMALS,
    Codes,
    DecimalCount,
    Flag,
    LineLength,
    Meanings,
    Plain,
    Seconds,
    Size,
    Sweep,
    Text,
    Texts,
    blocks_with,
)
from camgeo.units import LengthUnit

RANGE: Final = re.compile(r"([GM])(\d{1,4})-\1(\d{1,4})", re.ASCII)
"""Words whose numbers follow each other."""


@dataclass(frozen=True, slots=True)
class Evidence:
    """What a part of a profile rests on.

    Attributes
    ----------
    kind : one of `EVIDENCE`.
    about : keys or tables of the profile, e.g. "arcs.radius_tolerance".
    text : what it says, in our words; for kind "none" what is not confirmed.
    source : manual with page or section, public page, program and revision; empty for "none".
    """

    kind: Annotated[str, partial(one_of, choices=EVIDENCE)]
    about: Texts
    text: Text
    source: Text = ""

    def __post_init__(self) -> None:
        check_fields(self, "evidence.")
        if not self.source and self.kind != "none":
            raise GeometryError('must name one, unless kind is "none"', "evidence.source", "")


@dataclass(frozen=True, slots=True)
class TextForm:
    """`[text]`: the form of a program as a text.

    Attributes
    ----------
    comment_open, comment_close : around a comment; `comment_close` may be empty.
    line_length : characters of the longest line that is written.
    longest_line : of the longest line that the controller reads.
    letters : "upper" if comments, too, are written in capitals; else "any".
    forbidden : characters that must not stand in a comment; "_" takes their place.
    line_ending : "lf" or "crlf".
    line_numbers : step of the numbers of the blocks; None for none.
    """

    comment_open: Text
    comment_close: Text
    line_length: LineLength
    longest_line: LineLength
    letters: Annotated[str, partial(one_of, choices=("any", "upper"))] = "any"
    forbidden: Text = ""
    line_ending: Annotated[str, partial(one_of, choices=("lf", "crlf"))] = "lf"
    line_numbers: Annotated[int, partial(whole, least=1, most=1000)] | None = None

    def __post_init__(self) -> None:
        check_fields(self, "text.")
        brackets = len(self.comment_open) + len(self.comment_close)
        whole("text.line_length", self.line_length, brackets + 1, self.longest_line)


@dataclass(frozen=True, slots=True)
class Decimals:
    """A number of decimals in each unit of length."""

    mm: DecimalCount
    inch: DecimalCount

    def __post_init__(self) -> None:
        check_fields(self, "numbers.")

    def of(self, unit: LengthUnit) -> int:
        """That of `unit`."""
        return self.mm if unit == "mm" else self.inch


@dataclass(frozen=True, slots=True)
class Increments:
    """What 1 means in a number without a decimal point, in the unit itself."""

    mm: Annotated[float, partial(number, above=0.0, most=1.0)]
    inch: Annotated[float, partial(number, above=0.0, most=1.0)]

    def __post_init__(self) -> None:
        check_fields(self, "numbers.")


@dataclass(frozen=True, slots=True)
class NumberForm:
    """`[numbers]`: how coordinates are written and read.

    Attributes
    ----------
    point : "required" if a coordinate without a decimal point counts in `increment`s.
    decimals : fewest that are written; a finer tolerance takes more.
    most_decimals : that the controller resolves.
    increment : only if `point` is "required".
    largest : magnitude of a coordinate that the controller reads, in either unit.
    feed_decimals : most that are written of a feed.
    inch_feed : what a feed of 1 means in a program in inches [inch/min].
    feed_increment : what a feed of 1 without a decimal point means; None if the point is no matter.
    """

    point: Annotated[str, partial(one_of, choices=("required", "optional"))]
    decimals: Decimals
    most_decimals: Decimals
    largest: Annotated[float, partial(number, above=0.0)]
    increment: Increments | None = None
    feed_decimals: Annotated[int, partial(whole, least=1, most=6)] = 2
    inch_feed: Annotated[float, partial(number, above=0.0, most=1.0)] = 1.0
    feed_increment: Increments | None = None

    def __post_init__(self) -> None:
        check_fields(self, "numbers.")
        for unit in ("mm", "inch"):
            least = getattr(self.decimals, unit)
            whole(f"numbers.most_decimals.{unit}", getattr(self.most_decimals, unit), least,
                  MOST_DECIMALS)  # fmt: skip
        if (self.increment is None) != (self.point == "optional"):
            message = 'must be given if point is "required", and only then'
            raise GeometryError(message, "numbers.increment", "")

    def feed_step(self, unit: LengthUnit) -> float:
        """The last printed decimal of a feed [mm/min or inch/min]."""
        return 10.0**-self.feed_decimals * (1.0 if unit == "mm" else self.inch_feed)


@dataclass(frozen=True, slots=True)
class UnitWords:
    """`[unit]`: words that switch to a unit of length; None if the controller has none."""

    mm: Text
    inch: Text

    def __post_init__(self) -> None:
        check_fields(self, "unit.")

    def of(self, unit: LengthUnit) -> str:
        """That of `unit`."""
        return self.mm if unit == "mm" else self.inch


@dataclass(frozen=True, slots=True)
class ProgramFrame:
    """`[program]`: blocks around the operations.

    Attributes
    ----------
    start : the first lines, before any comment; with {name}, {number} and {unit}.
    blank : blocks behind them with the blank, where it is known; with {x0} to {z1}.
    safe_start : the modal state, stated at each operation; with {unit} and {work_offset}.
    end : the last lines, with spindle and coolant off; with {name} and {unit}.
    stop : halt until the operator starts again.
    """

    safe_start: Annotated[tuple[str, ...], blocks_with("unit", "work_offset")]
    end: Annotated[tuple[str, ...], blocks_with("name", "unit")]
    stop: Plain
    start: Annotated[tuple[str, ...], blocks_with("name", "number", "unit")] = ()
    blank: Annotated[tuple[str, ...], blocks_with("x0", "y0", "z0", "x1", "y1", "z1")] = ()

    def __post_init__(self) -> None:
        check_fields(self, "program.")


@dataclass(frozen=True, slots=True)
class ToolChange:
    """`[tool_change]`: how a tool comes into the spindle.

    Attributes
    ----------
    change : blocks, with {tool}, {speed} and {nominal} of the compensation; none if each tool gets
        a program, at the start of which it is in the spindle with its length set.
    length_offset : blocks that put its length into force; with {z} they move to that height.
    repeat : whether the tool is called at each operation, also if it is in the spindle.
    approach : "z-first": to the clearance height, then across; "xy-first": across where the retract
        has left the tool, then down to the clearance height.
    """

    change: Annotated[tuple[str, ...], blocks_with("tool", "speed", "nominal")]
    length_offset: Annotated[tuple[str, ...], blocks_with("tool", "z")]
    repeat: Flag = False
    approach: Annotated[str, partial(one_of, choices=("z-first", "xy-first"))] = "z-first"

    def __post_init__(self) -> None:
        check_fields(self, "tool_change.")


@dataclass(frozen=True, slots=True)
class Retract:
    """`[retract]`: away from the part before a tool change, a stop and the end.

    Attributes
    ----------
    blocks : up along Z alone; with {z}, the height of clearance or of tool changes.
    first : whether it also stands before the first tool change.
    """

    blocks: Annotated[tuple[str, ...], blocks_with("z")]
    first: Flag = False

    def __post_init__(self) -> None:
        check_fields(self, "retract.")
        if self.first and self.is_a_height:
            message = "must be false for a retract to {z}: before a tool change no length holds"
            raise GeometryError(message, "retract.first", "true")

    @property
    def is_a_height(self) -> bool:
        """Whether it goes to a height over the part, not to the machine's reference."""
        return any("{z}" in block for block in self.blocks)


@dataclass(frozen=True, slots=True)
class Spindle:
    """`[spindle]`: blocks that start it clockwise, with {speed}, and stop it.

    `spin_up` is the dwell [s] after starting it; `whole_speed` whether {speed} is rounded to one.
    """

    clockwise: Annotated[tuple[str, ...], blocks_with("speed")]
    off: Plain
    spin_up: Seconds = 0.0
    whole_speed: Flag = False

    def __post_init__(self) -> None:
        check_fields(self, "spindle.")


@dataclass(frozen=True, slots=True)
class Coolant:
    """`[coolant]`: blocks that switch it; None for what the controller does not have."""

    off: Plain
    flood: Plain | None = None
    mist: Plain | None = None
    through: Plain | None = None

    def __post_init__(self) -> None:
        check_fields(self, "coolant.")

    @property
    def kinds(self) -> tuple[str, ...]:
        """Those that the controller has, "off" first."""
        names = ("flood", "mist", "through")
        return ("off", *(name for name in names if getattr(self, name) is not None))

    def blocks(self, kind: str) -> tuple[str, ...]:
        """Of one of `kinds`; GeometryError for another."""
        found: tuple[str, ...] = getattr(self, one_of("coolant", kind, self.kinds))
        return found


@dataclass(frozen=True, slots=True)
class Dwell:
    """`[dwell]`: blocks of a pause, with {dwell} in `unit`, "s" or "ms".

    `point_seconds` : whether a time with a decimal point is in seconds although `unit` is "ms".
    """

    blocks: Annotated[tuple[str, ...], blocks_with("dwell")]
    unit: Annotated[str, partial(one_of, choices=("s", "ms"))]
    point_seconds: Flag = False

    def __post_init__(self) -> None:
        check_fields(self, "dwell.")


@dataclass(frozen=True, slots=True)
class ArcLimits:
    """`[arcs]`: arcs that the controller accepts, lengths in mm.

    Attributes
    ----------
    smallest_radius, largest_radius : arcs beyond are written as chords.
    radius_tolerance : largest difference of an arc's radii at its two ends that is written.
    centre : "incremental" from the start of the arc, "absolute", or "block": a block of its own.
    helical : whether Z may change along an arc.
    full_circle : whether an arc that ends where it begins is a full circle.
    largest_sweep : [degrees] from 1 to 180; larger arcs are divided.
    interpolation : how far the path that the controller runs departs from the arc.
    """

    smallest_radius: Size
    largest_radius: Size
    radius_tolerance: Size
    centre: Annotated[str, partial(one_of, choices=("incremental", "absolute", "block"))] = (
        "incremental"
    )
    helical: Flag = True
    full_circle: Flag = True
    largest_sweep: Sweep = 180.0
    interpolation: Size = 0.0

    def __post_init__(self) -> None:
        check_fields(self, "arcs.")

    @property
    def largest_turn(self) -> float:
        """`largest_sweep` [rad]."""
        return math.radians(self.largest_sweep)


@dataclass(frozen=True, slots=True)
class Words:
    """`[words]`: all words that the controller accepts.

    Attributes
    ----------
    g, m : codes.
    letters : that may begin a word.
    names : of cycles and keywords of more than one letter.
    meaning : of words whose meaning is not the common one, one of `MEANINGS`; see `own_meanings`.
    """

    g: Codes
    m: Codes
    letters: Text
    names: Texts = ()
    meaning: Meanings | None = None

    def __post_init__(self) -> None:
        check_fields(self, "words.")

    @property
    def own_meanings(self) -> dict[str, str]:
        """`meaning` by single words: its keys may be several, with blanks between, and ranges of
        numbers, as in "M100-M199".
        """
        found: dict[str, str] = {}
        for key, meaning in (self.meaning or {}).items():
            for word in key.split():
                words = [word]
                if ends := RANGE.fullmatch(word):
                    words = [f"{ends[1]}{k}" for k in range(int(ends[2]), int(ends[3]) + 1)]
                found |= dict.fromkeys(words, meaning)
        return found


def filled(blocks: Iterable[str], **words: str) -> list[str]:
    """`blocks` with `words` in place of the names in braces."""
    return [block.format(**words) for block in blocks]
