"""`[reading]` of a machine profile: what the controller takes of programs of any origin.

The other tables say what is written for a controller, within what it takes; these say where
controllers differ in what they refuse, or in what they do with the same block.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Annotated, Any, Final

from camgeo.errors import GeometryError
from camgeo.numeric.checked import check_fields, one_of, shown, whole
from camgeo.toolpath.machine_fields import Flag, Size, Text, Texts, texts

ARC_FORMS: Final = ("radius with centre", "arm across the plane", "half an absolute centre")
"""Ways to state an arc that controllers refuse, or of which they ignore a word."""

COMPENSATED: Final = ("length", "work offset", "path mode", "plane", "cycle of holes")
"""What controllers refuse to change or to do under compensation of the radius; a change of tools
and a way to a position of the machine none of them makes."""

TO_MACHINE: Final = ("cut", "incremental")
"""Blocks with a position of the machine that some controllers refuse: those that cut, and those
while distances are incremental."""

RETURNS: Final = ("end", "blank", "unknown")


def _choices(key: str, given: Any, allowed: tuple[str, ...]) -> tuple[str, ...]:
    """`given` as a tuple of some of `allowed`; GeometryError for another."""
    return tuple(one_of(key, each, allowed) for each in texts(key, given))


def _sets(key: str, given: Any) -> tuple[str, ...]:
    """`given` as sets of words, each a text of two or more; GeometryError for less."""
    found = texts(key, given)
    for each in found:
        if len(each.split()) < 2:
            raise GeometryError("must be texts of two words or more", key, shown(each))
    return found


@dataclass(frozen=True, slots=True)
class RadiusDifference:
    """By how much the radii at the two ends of an arc may differ in each unit of the program [mm].

    More is refused if it is more than the share `relative` of the radius, and if it is 100 times as
    much in any case.
    """

    mm: Size
    inch: Size
    relative: Size = 0.0

    def __post_init__(self) -> None:
        check_fields(self, "reading.radius_difference.")


@dataclass(frozen=True, slots=True)
class Reading:
    """What the controller takes, lengths in mm; the defaults are what most do.

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
    byte_order_mark: Flag = False
    percent: Annotated[str, partial(one_of, choices=("first", "any", "none"))] = "any"
    number_marks: Text = "O:"
    number_first: Flag = False
    largest_number: Annotated[int, partial(whole, least=1, most=2**31 - 1)] = 10_000_000
    alone: Annotated[tuple[str, ...], _sets] = ()
    dwell: Text = ""
    open_comment: Flag = False
    bare: Texts = ()
    takes_axes: Texts = ("G43.1",)
    cancelled_axes: Flag = True
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

    def __post_init__(self) -> None:
        check_fields(self, "reading.")
