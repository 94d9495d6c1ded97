"""Cures by one dimension of the follower: base radius, roller radius, offset or arm."""

from __future__ import annotations

from dataclasses import replace
from functools import partial, singledispatch
from typing import Any, Final

from camgeo.cam.cam import Cam
from camgeo.check.cures.cure import Change, Cure, Length, length_cure, no_cure
from camgeo.check.cures.discs import Discs, sized
from camgeo.check.cures.margin import bends_of, is_intact
from camgeo.check.cures.search import BEYOND, Make, nearest_cure
from camgeo.errors import GeometryError
from camgeo.mechanism.oscillating_roller import OscillatingRoller
from camgeo.mechanism.translating_roller import TranslatingRoller
from camgeo.units import MM_PER, LengthUnit

MOST = 100.0
"""Largest base radius tried, as a multiple of the present one."""

INSIDE = 1e-6
"""Fraction of the base radius by which an offset, arm or base radius stays clear of the value at
which the mechanism locks or is stretched out."""

TABLES: Final = ("follower", "follower.return")
"""The scene's table of each disc's roller."""


def base_radius(discs: Discs, unit: LengthUnit) -> Cure:
    """A larger base circle; an oscillating follower keeps its pivot and arm.

    The return roller of a pair moves with the main one, perhaps towards the cam axis: there a
    smaller one may cure, whichever is the smaller change.
    """
    knob, follower, mm = "base radius", discs[0].follower, MM_PER[unit]
    old = follower.base_radius
    end, why = MOST * old, f"up to {MOST:g} times the present one"
    stretched = follower.farthest
    if stretched * (1.0 - INSIDE) < end:
        end = max(stretched * (1.0 - INSIDE), old)
        why = f"up to {stretched / mm:g} {unit}, where the rocker is stretched out,"

    def made(value: float) -> Discs:
        return sized(discs, base_radius=value)

    limit = nearest_cure(made, old, end, old)
    if len(discs) > 1:
        low = INSIDE * old if limit is None else max(2.0 * old - limit, INSIDE * old)
        down = nearest_cure(made, old, low, old)
        limit, why = (limit if down is None else down), f"from {low / mm:g} {unit} {why}"
    length = _beyond(made, old, limit, unit)
    larger = "larger" if len(discs) == 1 else "other"
    none = f"no {larger} base radius {why} cures it"
    bound = "at least " if len(discs) == 1 else ""
    return length_cure(knob, f"{TABLES[0]}.base_radius", old, length, old, none, unit, bound)


def roller_radius(discs: Discs, unit: LengthUnit) -> Cure:
    """A smaller roller: at most the smallest r_K that matters, in closed form (Wirsig eq. 3.36).

    In a groove with side clearance c at most r_K - c/2; the clearance is kept. Smaller still, by a
    search, if the flank of that roller crosses itself. Of a pair each roller that needs it.
    """
    knob, made = "roller radius", discs
    found: list[Cure] = []
    for number in reversed(range(len(discs))):  # the return roller may have the main one's size
        cam, key = discs[number], f"{TABLES[number]}.roller_radius"
        if is_intact((cam,)):
            continue
        old, none = cam.follower.roller_radius, f"no smaller roller radius cures it ({key})"
        bends = bends_of(cam)
        if bends is None:
            none = f"there is no such mechanism for {key} to cure"
            return length_cure(knob, key, old, None, old, none, unit)
        extremes = bends.smallest()[0], bends.largest()[0]
        kappa = max(-flank.sign * each for flank in cam.contact.flanks for each in extremes)
        regular = min(old, 1.0 / kappa - 0.5 * cam.clearance) if kappa > 0.0 else old
        if regular <= BEYOND * old:
            return length_cure(knob, key, old, None, old, _no_room(cam, kappa, unit), unit)

        alone = partial(_alone, discs, number)
        limit: float | None = regular
        near = regular * (1.0 - BEYOND)
        if not is_intact(alone(near)):
            limit = nearest_cure(alone, near, BEYOND * old, old)
        length = _beyond(alone, old, limit, unit)
        cure = length_cure(knob, key, old, length, old, none, unit, "at most ")
        if length is None:
            return cure
        found.append(cure)
        made = sized(made, number, roller_radius=length.value)
    return _together(found, intact=is_intact(made)) if len(discs) > 1 else found[0]


def _no_room(cam: Cam, kappa: float, unit: LengthUnit) -> str:
    """Why no roller at all fits a disc whose smallest r_K is 1/`kappa`."""
    if cam.follower.roller_radius == 0.0:
        return "a knife edge has no roller to make smaller"
    beside = " beside the play of the groove" if cam.clearance > 0.0 else ""
    smallest = 1.0 / (kappa * MM_PER[unit])
    return f"the smallest radius of curvature, {smallest:.3g} {unit}, is too small{beside}"


def offset_or_arm(discs: Discs, unit: LengthUnit) -> Cure:
    """Another offset |e| < r_G of a guide, or another arm of a rocker with the same pivot and r_G.

    In whichever direction the change is smaller. Of a pair whose return disc alone is at fault,
    that of the return roller.
    """
    number = 1 if len(discs) > 1 and is_intact(discs[:1]) else 0
    knob, old, low, high, scale = _knob(discs[number].follower)
    ends = f"{low / MM_PER[unit]:g} and {high / MM_PER[unit]:g} {unit}"
    none = f"no other {knob} between {ends} cures it"

    def made(value: float) -> Discs:
        return sized(discs, number, **{knob: value})

    up = nearest_cure(made, old, max(high, old), scale)
    if up is not None:
        low = max(low, old - (up - old))
    down = nearest_cure(made, old, min(low, old), scale)
    limit = up if down is None else down
    length = _beyond(made, old, limit, unit)
    return length_cure(knob, f"{TABLES[number]}.{knob}", old, length, scale, none, unit)


def _alone(discs: Discs, number: int, radius: float) -> Discs:
    """One of the discs with another roller."""
    return (sized(discs, number, roller_radius=radius)[number],)


def _beyond(made: Make, old: float, limit: float | None, unit: LengthUnit) -> Length | None:
    """The length beyond the `limit`, which is nearest to the `old` one, that cures."""
    if limit is None:
        return None

    def cures(value: float) -> bool:
        try:
            return is_intact(made(value))
        except GeometryError:
            return False

    ways = (False, True) if limit == old else (limit > old,)
    found = (Length.beyond(old, limit, cures, unit, upward=upward) for upward in ways)
    return next(filter(None, found), None)


def _together(found: list[Cure], *, intact: bool) -> Cure:
    """The cures of all discs as one, led by the most costly; no cure unless that is `intact`."""
    leading = max(found, key=lambda cure: cure.cost or 0.0)
    knob, key, old = leading.knob, leading.key, leading.value_from
    if not intact:
        reason = "no smaller roller radii cure both discs"
        return no_cure(knob, key, old, leading.unit, reason)
    others = [cure for cure in found if cure is not leading]
    sentence = " and ".join(cure.sentence for cure in (leading, *others))
    also = tuple(Change(each.key, each.value_from, each.value_to or 0.0) for each in others)
    return replace(leading, sentence=sentence, also=also)


@singledispatch
def _knob(follower: Any) -> tuple[str, float, float, float, float]:
    """The dimension to change besides the radii: key, value, bounds, and a scale for it [mm]."""
    raise TypeError(type(follower))


@_knob.register
def _(follower: TranslatingRoller) -> tuple[str, float, float, float, float]:
    high = (1.0 - INSIDE) * follower.base_radius
    return "offset", follower.offset, -high, high, follower.base_radius


@_knob.register
def _(follower: OscillatingRoller) -> tuple[str, float, float, float, float]:
    distance, base = follower.centre_distance, follower.base_radius
    low, high = abs(distance - base) + INSIDE * base, (distance + base) - INSIDE * base
    return "arm", follower.arm, low, high, follower.arm
