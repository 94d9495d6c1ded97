"""The kinds of roller followers there are; imported by those who need one of them for certain."""

from __future__ import annotations

from typing import cast

from camgeo.errors import GeometryError
from camgeo.mechanism.follower import Follower
from camgeo.mechanism.oscillating_roller import OscillatingRoller
from camgeo.mechanism.translating_roller import TranslatingRoller

RollerFollower = TranslatingRoller | OscillatingRoller


def require_roller(follower: Follower) -> RollerFollower:
    """`follower`, if it has a roller; GeometryError with the key of its kind if a flat face."""
    if follower.rolls:
        return cast("RollerFollower", follower)
    message = f'what is asked for is for roller followers, and this one is "{follower.kind}"'
    raise GeometryError(message, key="follower.kind", value=follower.kind)
