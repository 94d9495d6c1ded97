"""Cures by a dimension of the follower: base radius, roller radius, offset, arm."""

from __future__ import annotations

from functools import singledispatch
from typing import Any

from camgeo.cam.cam import Cam
from camgeo.check.cures.cure import Cure, length_cure, no_cure
from camgeo.check.cures.margin import Pairs, bends_of, is_sound
from camgeo.check.cures.search import BEYOND, Make, nearest_cure
from camgeo.mechanism.oscillating_roller import OscillatingRoller
from camgeo.mechanism.translating_roller import TranslatingRoller

MOST = 100.0
"""Times the present base radius up to which a larger one is looked for."""

INSIDE = 1e-6
"""Share of the base radius by which an offset, arm or base radius stays off the value at which the
mechanism locks or lies stretched out."""


def base_radius(cam: Cam, _: Pairs) -> Cure:
    """A larger base circle; an oscillating follower keeps pivot and arm."""
    key, old = "follower.base_radius", cam.follower.base_radius
    end, why = MOST * old, f"up to {MOST:g} times the present one"
    stretched = cam.follower.farthest
    if stretched * (1.0 - INSIDE) < end:
        end = max(stretched * (1.0 - INSIDE), old)
        why = f"up to {stretched:g} mm, where the rocker lies stretched out,"
    limit = nearest_cure(lambda r: cam.sized(base_radius=r), old, end, old)
    if limit is None:
        return no_cure("base radius", key, old, "mm", f"no larger base radius {why} cures it")
    return length_cure("base radius", key, old, limit, old, upward=True)


def roller_radius(cam: Cam, _: Pairs) -> Cure:
    """A smaller roller: at most the smallest r_K that matters, in closed form (Wirsig eq. 3.36).

    In a groove with side clearance c at most r_K - c/2; the clearance is kept. Smaller still, by
    bisection, where the flank of that roller crosses itself.
    """
    key, old = "follower.roller_radius", cam.follower.roller_radius
    bends = bends_of(cam)
    assert bends is not None  # there is something to cure
    extremes = bends.smallest()[0], bends.largest()[0]
    kappa = max(-flank.sign * each for flank in cam.contact.flanks for each in extremes)
    regular = min(old, 1.0 / kappa - 0.5 * cam.clearance) if kappa > 0.0 else old
    if regular <= BEYOND * old:
        reason = "the play of the groove alone exceeds the radius of curvature"
        return no_cure("roller radius", key, old, "mm", reason)
    limit: float | None = regular
    near = regular * (1.0 - BEYOND)
    if not is_sound(cam.sized(roller_radius=near)):
        limit = nearest_cure(lambda r: cam.sized(roller_radius=r), near, BEYOND * old, old)
    if limit is None:
        return no_cure("roller radius", key, old, "mm", "no smaller roller radius cures it")
    return length_cure("roller radius", key, old, limit, old, upward=False)


def offset_or_arm(cam: Cam, _: Pairs) -> Cure:
    """Another offset |e| < r_G of a guide, another arm of a rocker with the same pivot and r_G.

    The nearer one of the two directions in which it can be changed.
    """
    knob, old, low, high, scale = _knob(cam.follower)
    key = f"follower.{knob}"

    def made(value: float) -> Cam:
        return cam.sized(**{knob: value})

    found = _either_way(made, old, low, high, scale)
    if found is None:
        reason = f"no other {knob} between {low:g} and {high:g} mm cures it"
        return no_cure(knob, key, old, "mm", reason)
    limit, upward = found
    return length_cure(knob, key, old, limit, scale, upward=upward)


@singledispatch
def _knob(follower: Any) -> tuple[str, float, float, float, float]:
    """Key of what may be changed beside radii, its value, its bounds, and a scale for it [mm]."""
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


def _either_way(
    make: Make, old: float, low: float, high: float, scale: float
) -> tuple[float, bool] | None:
    """The nearer of the limits in both directions within [low, high]; True if it is above."""
    up = nearest_cure(make, old, max(high, old), scale)
    if up is not None:
        low = max(low, old - (up - old))
    down = nearest_cure(make, old, min(low, old), scale)
    if down is not None:
        return down, False
    return None if up is None else (up, True)
