"""Machine profiles: the program format of a controller, as data."""

from __future__ import annotations

import functools
import math
import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from importlib.resources import files
from pathlib import Path
from string import Formatter
from types import MappingProxyType
from typing import Annotated, Any, Final

from jsonschema_rs import Draft202012Validator, ValidationError

from camgeo.errors import Fault, FileError, GeometryError, SceneError, meant, unreadable
from camgeo.milling.milling import COMPUTED, CONTROL, WEAR, FeedRate, SpinUp, Text, Truth
from camgeo.numeric.checked import (
    CheckedFields,
    check_fields,
    instance,
    instance_from_table,
    instances,
    number,
    one_of,
    positive,
    value_text,
    whole,
)
from camgeo.reading import Limits, check_toml, read_limited
from camgeo.record import allowed, stored_schema
from camgeo.units import MM_PER, LengthUnit

MACHINE: Final = Limits("machine profile", 200_000)

# -- machine fields -------------------------------------------------------------------------------
# Checks of the values in a machine profile, and the types of its fields.


SMALLEST_SWEEP, LARGEST_SWEEP = 1.0, 180.0
"""No arc of a program exceeds half a turn [degrees], beyond which controllers are strict. No
controller needs finely divided arcs."""

MOST_DECIMALS: Final = 10
"""More decimals than a controller's double holds for a length of metres."""

BLOCK_EXCERPT: Final = 60
"""Characters that are shown of a block in messages."""

LONGEST_LINE: Final = 10_000
"""Characters of a line that no controller accepts."""

EVIDENCE: Final = ("manual", "source code", "interpreter", "machine", "post", "none")
"""Kinds of evidence for the statements of a profile, the best first."""

MEANINGS: Final = (
    "rapid", "line", "clockwise arc", "counter-clockwise arc", "holes", "bores", "dwell",
    "plane XY", "plane ZX", "plane YZ", "inch", "mm", "compensation off", "compensation left",
    "compensation right", "length offset", "length offset off", "machine position", "home",
    "work offset", "exact stop", "exact path", "continuous path", "cycle off", "motion off",
    "absolute", "incremental", "absolute centres", "incremental centres", "inverse time",
    "feed per minute", "feed per revolution", "smoothing", "stop", "optional stop", "end",
    "spindle clockwise", "spindle counter-clockwise", "spindle off", "return to start",
    "return to R", "tool change", "flood", "mist", "through", "coolant off", "no effect",
    "not read",
)  # fmt: skip
"""Meanings of G and M words that a profile can give to a word of another common meaning; a word
"not read" is accepted, but programs with it cannot be simulated."""


def texts(key: str, given: Any) -> tuple[str, ...]:
    """`given` as a tuple of texts; GeometryError if it is not a list of them."""
    if isinstance(given, list | tuple) and all(isinstance(line, str) for line in given):
        return tuple(given)
    raise GeometryError("must be a list of texts", key, value_text(given))


def block_check(*names: str) -> Any:
    """The check of blocks that may have `names` in braces."""
    return partial(checked_blocks, names=names)


def checked_blocks(key: str, given: Any, names: tuple[str, ...]) -> tuple[str, ...]:
    """`given` as a tuple of blocks; GeometryError for braces around anything but `names`."""
    blocks = texts(key, given)
    for block in blocks:
        try:
            fields = [part for part in Formatter().parse(block) if part[1] is not None]
        except ValueError:
            fields = [("", None, None, None)]
        if any(name not in names or form or kind for _, name, form, kind in fields):
            allowed = f" but {', '.join(f'{{{name}}}' for name in names)}" if names else ""
            raise GeometryError(f"must hold no braces{allowed}", key, repr(block[:BLOCK_EXCERPT]))
    return blocks


def codes(key: str, given: Any) -> tuple[float, ...]:
    """`given` as the numbers of G or M words; GeometryError if they are none."""
    instance(key, given, tuple, "a tuple of numbers")
    return tuple(number(key, code, least=0.0, most=9999.0) for code in given)


def offsets(key: str, given: Any) -> Mapping[str, str]:
    """Work offsets by name, each with its block, read-only; GeometryError if there is none."""
    table = instance(key, given, Mapping, "a table of names with their blocks")
    if not table:
        raise GeometryError("must name at least one", key, value_text(given))
    blocks = {name: instance(f"{key}.{name}", table[name], str, "a text") for name in table}
    for name, block in blocks.items():
        checked_blocks(f"{key}.{name}", (block,), ())
    return MappingProxyType(blocks)


def meanings(key: str, given: Any) -> Mapping[str, str]:
    """Words with their `MEANINGS`, read-only; GeometryError for another one."""
    table = instance(key, given, Mapping, "a table of words with their meanings")
    if not table:
        raise GeometryError("must name at least one", key, value_text(given))
    by_word = {word: one_of(f"{key}.{word}", table[word], MEANINGS) for word in table}
    return MappingProxyType(by_word)


Texts = Annotated[tuple[str, ...], texts]
Plain = Annotated[tuple[str, ...], block_check()]
Size = Annotated[float, partial(number, least=0.0)]
LineLength = Annotated[int, partial(whole, least=1, most=LONGEST_LINE)]
DecimalCount = Annotated[int, partial(whole, least=1, most=MOST_DECIMALS)]
Sweep = Annotated[float, partial(number, least=SMALLEST_SWEEP, most=LARGEST_SWEEP)]
Share = Annotated[float, partial(number, least=0.0, most=0.9)]
Codes = Annotated[tuple[float, ...], codes]
Meanings = Annotated[Mapping[str, str], meanings]
WorkOffsets = Annotated[Mapping[str, str], offsets]


# -- machine options ------------------------------------------------------------------------------
# Tables of a machine profile that a controller may lack: dynamics, compensation, smoothing.


MOST_BLOCKS: Final = 10_000
"""Number of blocks that no controller plans ahead."""


@dataclass(frozen=True, slots=True)
class Dynamics(CheckedFields, path="dynamics."):
    """How a machine moves, and how far its controller looks ahead.

    Attributes
    ----------
    acceleration : of each axis [mm/s^2]; a move along a diagonal has more. On an arc it is also the
        largest centripetal acceleration.
    rapid_feed : of each axis in traverses [mm/min]; no cut is faster.
    look_ahead : number of blocks that are planned beyond the one that is run; 1 for a controller of
        which nothing is known.
    junction_deviation : [mm] by which the speed in corners is limited where the path is not
        smoothed: that of an arc which passes the corner at this distance. 0 for a stop there.
    velocity_jump : [mm/s] by which the velocity may change at once in a corner.
    block_time : shortest time of a block [s], which a controller needs to read or to run it.

    Raises
    ------
    GeometryError
        With the key in `dynamics`, if a value is invalid.
    """

    acceleration: Annotated[float, partial(positive, unit="mm/s^2")]
    rapid_feed: FeedRate
    look_ahead: Annotated[int, partial(whole, least=1, most=MOST_BLOCKS)] = 1
    junction_deviation: Annotated[float, partial(number, least=0.0, unit="mm")] = 0.0
    velocity_jump: Annotated[float, partial(number, least=0.0, unit="mm/s")] = 0.0
    block_time: Annotated[float, partial(number, least=0.0, unit="s")] = 0.0


@dataclass(frozen=True, slots=True)
class Compensation:
    """`[compensation]`: words of the controller's own radius compensation.

    Attributes
    ----------
    left, right : switch it on, in the block of a straight move; with {tool} and {nominal}.
    off : switches it off, likewise.
    modes : those of camgeo that it allows: "wear" and "control".
    nominal : with {radius}: takes the cutter's nominal radius off what the tool table holds, so
        that in mode "wear" the table keeps the radius as it is measured; it stands where {nominal}
        is, in `left` and `right` or in `tool_change.change`. Empty: there the offset of the tool
        holds the wear alone.
    table : whether the offsets of tools are a "radius" or a "diameter".
    """

    left: Text
    right: Text
    off: Text
    modes: Texts
    nominal: Text = ""
    table: Annotated[str, partial(one_of, choices=("radius", "diameter"))] = "radius"

    def __post_init__(self) -> None:
        check_fields(self, "compensation.")
        for name in ("left", "right"):
            checked_blocks(f"compensation.{name}", (getattr(self, name),), ("tool", "nominal"))
        checked_blocks("compensation.off", (self.off,), ())
        checked_blocks("compensation.nominal", (self.nominal,), ("radius",))
        for mode in self.modes:
            one_of("compensation.modes", mode, (WEAR, CONTROL))


@dataclass(frozen=True, slots=True)
class Smoothing(CheckedFields, path="smoothing."):
    """`[smoothing]`: smoothing of the path, whose error counts against the tolerance.

    Attributes
    ----------
    on : blocks with {p}, the largest deviation, in the program's unit.
    off : blocks of the exact path.
    end : blocks before the end of the program.
    share : the deviation as a share of the tolerance; 0 for the exact path always.
    smallest : deviation [mm] below which the exact path is programmed instead.
    largest : deviation [mm] above which no more is asked for.
    """

    on: Annotated[tuple[str, ...], block_check("p")]
    off: Plain
    share: Share
    smallest: Size
    end: Plain = ()
    largest: Size = 1.0


# -- machine reading ------------------------------------------------------------------------------
# `[reading]` of a machine profile: what the controller takes of programs of any origin.
#
# The other tables say what is written for a controller, within what it takes; these say where
# controllers differ in what they refuse, or in what they do with the same block.


ARC_FORMS: Final = ("radius with centre", "arm across the plane", "half an absolute centre")
"""Ways to state an arc that some controllers reject, or of which they ignore a word."""

COMPENSATED: Final = ("length", "work offset", "path mode", "plane", "cycle of holes")
"""What some controllers reject while the radius is compensated; all of them reject a tool change
and a move to a position of the machine."""

TO_MACHINE: Final = ("cut", "incremental")
"""Blocks with a position of the machine that some controllers reject: cutting moves, and blocks
while distances are incremental."""

RETURNS: Final = ("end", "blank", "unknown")


def _choices(key: str, given: Any, allowed: tuple[str, ...]) -> tuple[str, ...]:
    """`given` as a tuple of some of `allowed`; GeometryError for another."""
    return tuple(one_of(key, choice, allowed) for choice in texts(key, given))


def _sets(key: str, given: Any) -> tuple[str, ...]:
    """`given` as sets of words, each a text of two or more words; GeometryError for fewer."""
    word_sets = texts(key, given)
    for word_set in word_sets:
        if len(word_set.split()) < 2:
            raise GeometryError("must be texts of two words or more", key, value_text(word_set))
    return word_sets


@dataclass(frozen=True, slots=True)
class RadiusDifference(CheckedFields, path="reading.radius_difference."):
    """Difference [mm] that the radii at the two ends of an arc may have, by the program's unit.

    A larger difference is an error if it also exceeds the share `relative` of the radius, and in
    any case if it is 100 times as large.
    """

    mm: Size
    inch: Size
    relative: Size = 0.0


@dataclass(frozen=True, slots=True)
class ReaderRules(CheckedFields, path="reading."):
    """What the controller accepts in programs, lengths in mm; defaults are what most controllers
    do.

    Attributes
    ----------
    counted : what of a line counts towards `text.longest_line`: "line", or the "code" in it.
    carriage_return : one without a line feed is an "end" of the line, a "blank", or "unknown".
    byte_order_mark : whether a program may begin with one.
    percent : % stands "first" and last, alone, "any" way, or "none" may stand.
    number_marks : characters that begin a block with the number of the program.
    number_first : whether N may only begin a block.
    largest_number : of a block.
    alone : sets of words, separated by blanks, of which a block may have one.
    dwell : letters that state the time of a dwell; empty for that of `dwell.blocks`.
    open_comment : whether a comment in brackets may end with its line.
    bare : words that may stand without the coordinates without which they say nothing.
    takes_axes : words of a tool's length that take the coordinates of their block.
    cancelled_axes : whether G28 may take coordinates behind G80, which cancels the motion.
    machine_position : in which of `TO_MACHINE` a position of the machine may be stated, too.
    feed_unit : whether F counts in the unit of its "block", or of that "before" it.
    feed_mode : whether G94 or G95, stated again, "keeps" or "resets" the feed.
    circle : whether an arc without coordinates is a full circle: "modal", also without G2 or G3;
        "stated", with them; "never", and a coordinate of the plane is needed.
    repeats : letter of the number of holes that a block of a cycle makes.
    turns : the address of the number of turns of an arc; empty if there is none.
    arc_forms : those of `ARC_FORMS` that are refused.
    radius_difference : None where it is not known: then that which is written, `arcs`.
    smallest_radius : of an arc by its centre.
    short_radius : by how much an arc's R may be too short; None like `radius_difference`.
    helix : whether Z may change along "any" arc, a "polar" one, or "none".
    compensated : those of `COMPENSATED` that are refused.
    """

    counted: Annotated[str, partial(one_of, choices=("line", "code"))] = "line"
    carriage_return: Annotated[str, partial(one_of, choices=RETURNS)] = "unknown"
    byte_order_mark: Truth = False
    percent: Annotated[str, partial(one_of, choices=("first", "any", "none"))] = "any"
    number_marks: Text = "O:"
    number_first: Truth = False
    largest_number: Annotated[int, partial(whole, least=1, most=2**31 - 1)] = 10_000_000
    alone: Annotated[tuple[str, ...], _sets] = ()
    dwell: Text = ""
    open_comment: Truth = False
    bare: Texts = ()
    takes_axes: Texts = ("G43.1",)
    cancelled_axes: Truth = True
    machine_position: Annotated[tuple[str, ...], partial(_choices, allowed=TO_MACHINE)] = ()
    feed_unit: Annotated[str, partial(one_of, choices=("block", "before"))] = "block"
    feed_mode: Annotated[str, partial(one_of, choices=("keeps", "resets"))] = "keeps"
    circle: Annotated[str, partial(one_of, choices=("modal", "stated", "never"))] = "stated"
    repeats: Text = "L"
    turns: Text = ""
    arc_forms: Annotated[tuple[str, ...], partial(_choices, allowed=ARC_FORMS)] = ()
    radius_difference: RadiusDifference | None = None
    smallest_radius: Size = 0.0
    short_radius: Size | None = None
    helix: Annotated[str, partial(one_of, choices=("any", "polar", "none"))] = "any"
    compensated: Annotated[tuple[str, ...], partial(_choices, allowed=COMPENSATED)] = ()


# -- machine --------------------------------------------------------------------------------------


KEY: Final = "output.gcode.machine"
"""Key of the scene that names the profile."""

DIALECTS: Final = ("iso", "klartext")

ROUNDING_SHARE: Final = 0.3
"""Share of the tolerance for printed numbers; it decides the number of decimals: four at 1 um."""

ROUNDING_UNITS: Final = 3.0
"""Deviation by rounding, in units of the last decimal: end points and centre each move by at most
half a diagonal, 0.71, and the radii at an arc's two ends then differ by at most 1.42."""


def _evidence(key: str, given: Any) -> tuple[Evidence, ...]:
    instance(key, given, tuple, "a tuple of `Evidence`")
    return instances(key, given, (Evidence,), "`Evidence`")


@dataclass(frozen=True, slots=True)
class Machine:
    """One controller: what programs for it look like, and what it accepts.

    The tables and their keys are those of a profile, see docs/machines.md. `compensation` and
    `smoothing` are None if the controller has none, `dynamics` if the profile does not give them:
    then there is no machining time.

    Attributes
    ----------
    name : in messages and in the comments of a program.
    controller : for which controllers it is meant, in one sentence.
    dialect : "iso", of G and M words, or "klartext".
    extension : ending of the program's file, with its point.
    evidence : what the profile rests on.
    work_offsets : words that select a work offset, by its name in scenes; the first is the default.

    Raises
    ------
    GeometryError
        With the key of the profile, for an invalid value.
    """

    name: Text
    controller: Text
    dialect: Annotated[str, partial(one_of, choices=DIALECTS)]
    extension: Text
    text: TextForm
    numbers: NumberForm
    unit: UnitWords
    program: ProgramFrame
    work_offsets: WorkOffsets
    tool_change: ToolChange
    retract: Retract
    spindle: Spindle
    coolant: Coolant
    dwell: DwellBlocks
    arcs: ArcLimits
    words: Words
    reading: ReaderRules = field(default_factory=ReaderRules)
    evidence: Annotated[tuple[Evidence, ...], _evidence] = ()
    compensation: Compensation | None = None
    smoothing: Smoothing | None = None
    dynamics: Dynamics | None = None

    def __post_init__(self) -> None:
        check_fields(self)
        if not (self.extension.startswith(".") and self.extension[1:].isalnum()):
            raise GeometryError(
                "must be a point and up to eight letters or digits",
                "extension",
                value_text(self.extension),
            )
        compensation = self.compensation
        if compensation is None or not compensation.nominal:
            return
        blocks = (compensation.left, compensation.right, *self.tool_change.change)
        if not any("{nominal}" in block for block in blocks):
            raise GeometryError(
                "must stand as {nominal} in compensation.left and right or tool_change.change",
                "compensation.nominal",
                value_text(compensation.nominal),
            )
        called = any("{nominal}" in block for block in self.tool_change.change)
        if called and not self.tool_change.repeat:
            raise GeometryError(
                "must be true where tool_change.change has {nominal}: it holds up to the next",
                "tool_change.repeat",
                "false",
            )

    @property
    def compensations(self) -> tuple[str, ...]:
        """The kinds of compensation that the controller allows, "computed" first."""
        return (COMPUTED, *(self.compensation.modes if self.compensation else ()))

    def error(self, message: str) -> SceneError:
        """The error for something that the profile does not allow."""
        return SceneError([Fault(KEY, repr(self.name), message)])

    def decimals(self, unit: LengthUnit, tolerance: float) -> int:
        """Number of decimals of coordinates in a program within `tolerance` [mm]: at least as many
        as usual for the controller, more where the tolerance needs them, at most what it resolves.
        """
        finest = ROUNDING_SHARE * tolerance / (ROUNDING_UNITS * MM_PER[unit])
        numbers, needed = self.numbers, math.ceil(-math.log10(finest))
        return min(
            max(numbers.decimals.for_unit(unit), needed), numbers.most_decimals.for_unit(unit)
        )

    def smoothed(self, tolerance: float, most: float = math.inf) -> float | None:
        """Distance [mm], at most `most`, by which the controller may leave the path in a program
        within `tolerance` [mm]; None if it runs the exact path.
        """
        smoothing = self.smoothing
        if smoothing is None:
            return None
        deviation = min(smoothing.share * tolerance, smoothing.largest, most)
        return (
            deviation
            if deviation > 0.0 and deviation >= smoothing.smallest * (1.0 - 1e-9)
            else None
        )


@functools.cache
def names() -> tuple[str, ...]:
    """Names of the profiles in the package."""
    folder = files("camgeo.milling").joinpath("machines")
    return tuple(
        sorted(
            entry.name.removesuffix(".toml")
            for entry in folder.iterdir()
            if entry.name.endswith(".toml")
        )
    )


def load(machine: str, key: str = KEY) -> Machine:
    """The machine profile with that name or in that file; raises SceneError with all its faults.

    `key` is what messages call the name of the profile.
    """
    known = names()
    if machine in known:
        return _packaged_profile(machine)
    if not machine.endswith(".toml"):
        message = f"no such machine profile; allowed: {', '.join(known)}, or a .toml file"
        raise SceneError([Fault(key, repr(machine), message, meant(machine, known))])
    try:
        text = read_limited(Path(machine), MACHINE).decode("utf-8-sig")
    except (OSError, ValueError) as error:  # the latter also for a path that no file can have
        raise SceneError(
            [Fault(key, repr(machine), f"the profile cannot be read: {unreadable(error)}")]
        ) from None
    return parse(text, machine)


@functools.cache
def _packaged_profile(name: str) -> Machine:
    """A profile in the package; it does not change, so it is read once."""
    resource = files("camgeo.milling").joinpath("machines", f"{name}.toml")
    return parse(resource.read_text(encoding="utf-8"), f"{name}.toml")


def parse(text: str, file: str) -> Machine:
    """The profile in `text`; `file` is its name for messages."""
    try:
        check_toml(text)
        table = tomllib.loads(text)
    except FileError as error:
        raise SceneError([Fault("", "", str(error))], file) from None
    except RecursionError:
        raise SceneError([Fault("", "", "is nested too deeply for a profile")], file) from None
    except ValueError as error:  # also of an integer of thousands of digits
        raise SceneError([Fault("", "", f"not TOML: {error}")], file) from None
    if faults := profile_faults(table):
        raise SceneError(faults, file)
    try:
        return instance_from_table(Machine, table)
    except GeometryError as error:
        raise SceneError([Fault(error.key, error.value, error.message)], file) from None


# -- machine schema -------------------------------------------------------------------------------
# A profile's table against the JSON Schema next to this module: its faults in words.


EARLIER: Final = {
    "preamble": "program.safe_start",
    "spindle_on": "spindle.clockwise",
    "end": "program.end",
    "comment": "text",
    "decimals": "numbers.decimals",
    "blending": "smoothing",
}
"""Keys of earlier profiles, and the keys that took their place."""

MOST_FAULTS: Final = 200
"""Most faults reported of one profile."""


@functools.cache
def schema() -> dict[str, Any]:
    """The JSON Schema of a profile."""
    return stored_schema(str(Path(__file__).with_name("machine.py")), "machine.schema")


@functools.cache
def _validator() -> Draft202012Validator:
    return Draft202012Validator(schema())


def profile_faults(table: dict[str, Any]) -> list[Fault]:
    """What is wrong with a profile; empty if nothing is."""
    faults: list[Fault] = []
    for error in _validator().iter_errors(table):
        node = _node(error)
        path = list(error.instance_path)
        if error.kind.name == "additionalProperties":
            for name in error.kind.as_dict()["unexpected"]:
                faults.append(_unknown([*path, name], node))
        elif error.kind.name == "required":
            name = str(error.kind.as_dict()["property"])
            what = node["properties"][name]["description"].rstrip(".")
            faults.append(Fault(_key([*path, name]), "", f"is missing: {what}"))
        else:
            value: Any = table  # the value at fault, for the message
            for step in path:
                value = value[step]
            close = meant(value, node.get("enum", ()), '"') if isinstance(value, str) else ""
            faults.append(Fault(_key(path), value_text(value), allowed(node), close))
        if len(faults) >= MOST_FAULTS:
            return [*faults[:MOST_FAULTS], Fault("", "", "there are more faults than are listed")]
    return faults


def _unknown(path: Sequence[str | int], node: dict[str, Any]) -> Fault:
    name = str(path[-1])
    if len(path) == 1 and name in EARLIER:
        return Fault(name, "", f"is a key of earlier profiles; it is {EARLIER[name]} now")
    known = list(node["properties"])
    hint = meant(name, known)
    message = "is not a known key" if hint else f"is not a known key; known: {', '.join(known)}"
    return Fault(_key(path), "", message, hint)


def _node(error: ValidationError) -> dict[str, Any]:
    """The node of the schema that was violated."""
    node: Any = schema()
    for step in error.evaluation_path[:-1]:
        node = node[step]
    return dict(node)


def _key(path: Sequence[str | int]) -> str:
    """A path as messages show it: ``evidence[2].kind``, counted from 1."""
    text = ""
    for step in path:
        text += f"[{step + 1}]" if isinstance(step, int) else f".{step}" if text else step
    return text


# -- machine tables -------------------------------------------------------------------------------
# The tables of a machine profile. machine.schema.json next to it describes every key.


RANGE: Final = re.compile(r"([GM])(\d{1,4})-\1(\d{1,4})", re.ASCII)
"""A range of words with consecutive numbers, as in "M100-M199"."""


@dataclass(frozen=True, slots=True)
class Evidence:
    """The evidence for a part of a profile.

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
class Decimals(CheckedFields, path="numbers."):
    """A number of decimals in each unit of length."""

    mm: DecimalCount
    inch: DecimalCount

    def for_unit(self, unit: LengthUnit) -> int:
        """The number of decimals in `unit`."""
        return self.mm if unit == "mm" else self.inch


@dataclass(frozen=True, slots=True)
class Increments(CheckedFields, path="numbers."):
    """What 1 means in a number without a decimal point, in the unit itself."""

    mm: Annotated[float, partial(number, above=0.0, most=1.0)]
    inch: Annotated[float, partial(number, above=0.0, most=1.0)]


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
            raise GeometryError(
                'must be given if point is "required", and only then', "numbers.increment", ""
            )


@dataclass(frozen=True, slots=True)
class UnitWords(CheckedFields, path="unit."):
    """`[unit]`: words that switch to a unit of length; None if the controller has none."""

    mm: Text
    inch: Text

    def for_unit(self, unit: LengthUnit) -> str:
        """The word that switches to `unit`."""
        return self.mm if unit == "mm" else self.inch


@dataclass(frozen=True, slots=True)
class ProgramFrame(CheckedFields, path="program."):
    """`[program]`: blocks around the operations.

    Attributes
    ----------
    start : the first lines, before any comment; with {name}, {number} and {unit}.
    blank : blocks behind them with the blank, where it is known; with {x0} to {z1}.
    safe_start : the modal state, stated at each operation; with {unit} and {work_offset}.
    end : the last lines, with spindle and coolant off; with {name} and {unit}.
    stop : halt until the operator starts again.
    """

    safe_start: Annotated[tuple[str, ...], block_check("unit", "work_offset")]
    end: Annotated[tuple[str, ...], block_check("name", "unit")]
    stop: Plain
    start: Annotated[tuple[str, ...], block_check("name", "number", "unit")] = ()
    blank: Annotated[tuple[str, ...], block_check("x0", "y0", "z0", "x1", "y1", "z1")] = ()


@dataclass(frozen=True, slots=True)
class ToolChange(CheckedFields, path="tool_change."):
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

    change: Annotated[tuple[str, ...], block_check("tool", "speed", "nominal")]
    length_offset: Annotated[tuple[str, ...], block_check("tool", "z")]
    repeat: Truth = False
    approach: Annotated[str, partial(one_of, choices=("z-first", "xy-first"))] = "z-first"


@dataclass(frozen=True, slots=True)
class Retract:
    """`[retract]`: away from the part before a tool change, a stop and the end.

    Attributes
    ----------
    blocks : up along Z alone; with {z}, the height of clearance or of tool changes.
    first : whether it also stands before the first tool change.
    """

    blocks: Annotated[tuple[str, ...], block_check("z")]
    first: Truth = False

    def __post_init__(self) -> None:
        check_fields(self, "retract.")
        if self.first and self.is_a_height:
            raise GeometryError(
                "must be false for a retract to {z}: no tool length is active before a tool change",
                "retract.first",
                "true",
            )

    @property
    def is_a_height(self) -> bool:
        """Whether the retract goes to a height above the part, not to the machine's reference."""
        return any("{z}" in block for block in self.blocks)


@dataclass(frozen=True, slots=True)
class Spindle(CheckedFields, path="spindle."):
    """`[spindle]`: blocks that start it clockwise, with {speed}, and stop it.

    `spin_up` is the dwell [s] after starting it; `whole_speed` whether {speed} is rounded to one.
    """

    clockwise: Annotated[tuple[str, ...], block_check("speed")]
    off: Plain
    spin_up: SpinUp = 0.0
    whole_speed: Truth = False


@dataclass(frozen=True, slots=True)
class Coolant(CheckedFields, path="coolant."):
    """`[coolant]`: blocks that switch it; None for what the controller does not have."""

    off: Plain
    flood: Plain | None = None
    mist: Plain | None = None
    through: Plain | None = None

    @property
    def kinds(self) -> tuple[str, ...]:
        """The kinds of coolant that the controller has, "off" first."""
        names = ("flood", "mist", "through")
        return ("off", *(name for name in names if getattr(self, name) is not None))

    def blocks(self, kind: str) -> tuple[str, ...]:
        """The blocks that switch to one of `kinds`; GeometryError for another word."""
        kind_blocks: tuple[str, ...] = getattr(self, one_of("coolant", kind, self.kinds))
        return kind_blocks


@dataclass(frozen=True, slots=True)
class DwellBlocks(CheckedFields, path="dwell."):
    """`[dwell]`: blocks of a pause, with {dwell} in `unit`, "s" or "ms".

    `point_seconds` : whether a time with a decimal point is in seconds although `unit` is "ms".
    """

    blocks: Annotated[tuple[str, ...], block_check("dwell")]
    unit: Annotated[str, partial(one_of, choices=("s", "ms"))]
    point_seconds: Truth = False


@dataclass(frozen=True, slots=True)
class ArcLimits(CheckedFields, path="arcs."):
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
    helical: Truth = True
    full_circle: Truth = True
    largest_sweep: Sweep = 180.0
    interpolation: Size = 0.0

    @property
    def largest_turn(self) -> float:
        """`largest_sweep` [rad]."""
        return math.radians(self.largest_sweep)


@dataclass(frozen=True, slots=True)
class Words(CheckedFields, path="words."):
    """`[words]`: all words that the controller accepts.

    Attributes
    ----------
    g, m : codes.
    letters : that may begin a word.
    names : of cycles and keywords of more than one letter.
    meaning : of words whose meaning is not the common one, one of `MEANINGS`; see
        `special_meanings`.
    """

    g: Codes
    m: Codes
    letters: Text
    names: Texts = ()
    meaning: Meanings | None = None

    @property
    def special_meanings(self) -> dict[str, str]:
        """`meaning` by single words: each of its keys may hold several words with blanks between,
        and ranges of numbers, as in "M100-M199".
        """
        by_word: dict[str, str] = {}
        for key, meaning in (self.meaning or {}).items():
            for word in key.split():
                words = [word]
                if ends := RANGE.fullmatch(word):
                    words = [f"{ends[1]}{k}" for k in range(int(ends[2]), int(ends[3]) + 1)]
                by_word |= dict.fromkeys(words, meaning)
        return by_word
