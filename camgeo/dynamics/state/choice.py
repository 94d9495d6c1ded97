"""Which state of motion the effects of a scene are computed for."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from camgeo.cam.cam import Cam, Drive
from camgeo.check.finding import Limits
from camgeo.dynamics.state.state import FIRST, SECOND, Carrier, Demanded, Model, State
from camgeo.errors import GeometryError


def model_of(stated: Model | None, limits: Limits) -> Model:
    """What a scene states, or its default: a trimmed disc is meant to move the follower."""
    return stated or ("outline" if limits.undercut == "trim" else "demanded")


SIDES: Final[Mapping[Carrier, int]] = {
    "inner": FIRST,
    "main": FIRST,
    "outer": SECOND,
    "return": SECOND,
    "opposite": SECOND,
}


def side_named(flank: Carrier | None) -> int:
    """The side that a scene states, or its default, as `State.sense`."""
    return FIRST if flank is None else SIDES[flank]


def state_of(drive: Drive, cam: Cam | None, model: Model, *, paired: bool) -> State:
    """The state of motion of `drive` and `cam`, None without a follower.

    The motion of the outline, if that is the `model`, follows from the disc where a single flank is
    trimmed. Otherwise the state is the demanded motion: where the flank is whole, where there is no
    disc, where the lift jumps, and where the far end of a linkage cannot follow. So it is, too, for
    a follower that is held both ways, in a groove, between the discs of a pair (`paired`) or by a
    yoke.
    """
    demanded = Demanded(drive, cam, drive.time_course)
    if cam is None or model == "demanded" or paired or _is_held_both_ways(cam):
        return demanded
    flank = cam.contact.main
    try:
        if not cam.disc.outline(flank).is_trimmed:
            return demanded
        replay = cam.disc.replay(flank)
    except GeometryError:  # the checks report it
        return demanded
    if len(replay.drops):
        return demanded
    from camgeo.dynamics.state.outline import OfOutline  # few discs are trimmed

    found = OfOutline(cam, replay, drive.time_course)
    return found if found.is_followed else demanded


def _is_held_both_ways(cam: Cam) -> bool:
    return cam.contact.closed_by_form or cam.yoke is not None
