"""What the interpreter goes by: a machine profile, prepared for looking words up."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field

from camgeo.milling.machine import Machine
from camgeo_export.interpreter.iso import COMMON, GROUP_OF, normal


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
