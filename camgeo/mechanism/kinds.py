"""The kinds of followers there are, by name; imported by those who need to tell them apart."""

from __future__ import annotations

from camgeo.errors import GeometryError
from camgeo.mechanism.oscillating_flat import OscillatingFlat
from camgeo.mechanism.oscillating_roller import OscillatingRoller
from camgeo.mechanism.translating_flat import TranslatingFlat
from camgeo.mechanism.translating_roller import TranslatingRoller

RollerFollower = TranslatingRoller | OscillatingRoller

AnyFlat = TranslatingFlat | OscillatingFlat

AnyGuided = TranslatingRoller | TranslatingFlat

AnyRocker = OscillatingRoller | OscillatingFlat

AnyFollower = RollerFollower | AnyFlat


def require_roller(follower: AnyFollower) -> RollerFollower:
    """`follower`, if it has a roller; GeometryError with the key of its kind if a flat face."""
    if isinstance(follower, TranslatingRoller | OscillatingRoller):
        return follower
    message = "what is asked for is for roller followers, and this one has a flat face"
    raise GeometryError(message, key="follower.kind", value=follower.kind)
