"""Rules between the keys of [state] and those of the machine and its effects."""

from __future__ import annotations

from collections.abc import Iterator

from camgeo.scene.schema import EFFECTS, FINDERS
from camgeo.scene.valid_values import Broken, ValidValues


def a_found_speed_is_sought(values: ValidValues) -> Iterator[Broken]:
    """The speed is found by an effect that the scene names, and by one alone."""
    named = [each for each in FINDERS if not values.lacks(EFFECTS, each)]
    if values.get("state", "speed") == "found" and not named:
        yield ("state", "speed"), f"needs [effects.{'] or [effects.'.join(FINDERS)}]"
    yield from (((EFFECTS, each), f"contradicts [effects.{named[0]}]") for each in named[1:])


def a_flank_is_one_of_two(values: ValidValues) -> Iterator[Broken]:
    """Only a follower that is held both ways has a choice of sides."""
    flank = values.get("state", "flank")
    if flank is None:
        return
    place = ("state", "flank")
    if values.get("state", "motion") != "written":
        yield place, 'belongs to motion = "written"; another motion is the same on both sides'
    elif flank == "main":
        if values.lacks("follower", "return") and values.lacks("follower", "yoke"):
            what = "is a disc of a conjugate pair or a side of a yoke"
            yield place, f"{what}: it needs [follower.return] or [follower.yoke]"
    elif flank == "return":
        if values.lacks("follower", "return"):
            yield place, "is a disc of a conjugate pair: it needs [follower.return]"
    elif flank == "opposite":
        if values.lacks("follower", "yoke"):
            yield place, "is a side of a yoke: it needs [follower.yoke]"
    elif values.contact is not None and not values.contact.closed_by_form:
        yield place, 'is a flank of a groove: it needs contact = "groove"'
