"""Cure of a flat face that undercuts: one that lies farther out."""

from __future__ import annotations

from dataclasses import replace
from decimal import Decimal

from camgeo.cam.cam import Cam
from camgeo.check.cures.cure import Change, Cure, Length, length_cure, shown
from camgeo.errors import GeometryError
from camgeo.mechanism.face import flat_follower
from camgeo.outline.convex import convexity
from camgeo.units import MM_PER, LengthUnit

KNOB = "base radius"


def face_cures(cam: Cam, unit: LengthUnit = "mm") -> tuple[Cure, ...]:
    """The least base radius, on a rocker with as much more face offset, that leaves no undercut.

    Moved out by D, a face has the parallel outline, all of whose radii are larger by D. Empty if
    something else is wrong, which that does not cure. Lengths are rounded in `unit`.
    """
    found = convexity(cam.disc.pitch_curve)
    if found.is_convex or found.turn[0] <= 0.0 or found.jumps:
        return ()
    follower = flat_follower(cam.follower)
    old = follower.base_radius

    mm = MM_PER[unit]
    present = {key: getattr(follower, _name(key)) / mm for key in follower.raised_by}

    def raised(value: float) -> dict[str, float]:
        """Each length in `unit` that goes with the base radius `value` [mm], by its key."""
        more = Decimal(repr(value / mm)) - Decimal(repr(old / mm))
        return {key: float(Decimal(repr(each)) + more) for key, each in present.items()}

    def cures(value: float) -> bool:
        try:
            other = cam.sized(**{_name(key): mm * each for key, each in raised(value).items()})
            return convexity(other.disc.pitch_curve).is_convex
        except GeometryError:
            return False

    length = Length.beyond(old, old - found.radius[0], cures, unit, upward=True)
    first, *others = follower.raised_by
    none = f"no larger {' and '.join(follower.raised_by)} cures it"
    cure = length_cure(KNOB, first, old, length, old, none, unit, "at least ")
    if length is None or not others:
        return (cure,)
    lengths = raised(length.value)
    also = tuple(Change(key, present[key], lengths[key]) for key in others)
    beside = " and ".join(f"{key} {shown(lengths[key])} {unit}" for key in others)
    return (replace(cure, sentence=f"{cure.sentence}, with {beside}", also=also),)


def _name(key: str) -> str:
    """The field of a key of the scene."""
    return key.removeprefix("follower.")
