"""Cures by one dimension of the follower: base radius, roller radius, offset or arm."""

from __future__ import annotations

from functools import singledispatch
from typing import Any

from camgeo.cam.cam import Cam
from camgeo.check.cures.cure import Cure, length_cure
from camgeo.check.cures.margin import Pairs, bends_of, is_sound
from camgeo.check.cures.search import BEYOND, nearest_cure
from camgeo.mechanism.oscillating_roller import OscillatingRoller
from camgeo.mechanism.translating_roller import TranslatingRoller

MOST = 100.0
"""Largest base radius tried, as a multiple of the present one."""

INSIDE = 1e-6
"""Fraction of the base radius by which an offset, arm or base radius stays clear of the value at
which the mechanism locks or is stretched out."""


def base_radius(cam: Cam, _: Pairs) -> Cure:
    """A larger base circle; an oscillating follower keeps its pivot and arm."""
    old = cam.follower.base_radius
    end, why = MOST * old, f"up to {MOST:g} times the present one"
    stretched = cam.follower.farthest
    if stretched * (1.0 - INSIDE) < end:
        end = max(stretched * (1.0 - INSIDE), old)
        why = f"up to {stretched:g} mm, where the rocker is stretched out,"
    limit = nearest_cure(lambda r: cam.sized(base_radius=r), old, end, old)
    return length_cure("base radius", old, limit, old, f"no larger base radius {why} cures it")


def roller_radius(cam: Cam, _: Pairs) -> Cure:
    """A smaller roller: at most the smallest r_K that matters, in closed form (Wirsig eq. 3.36).

    In a groove with side clearance c at most r_K - c/2; the clearance is kept. Smaller still, by a
    search, if the flank of that roller crosses itself.
    """
    knob, old, none = (
        "roller radius",
        cam.follower.roller_radius,
        "no smaller roller radius cures it",
    )
    bends = bends_of(cam)
    assert bends is not None  # there is something to cure
    extremes = bends.smallest()[0], bends.largest()[0]
    kappa = max(-flank.sign * each for flank in cam.contact.flanks for each in extremes)
    regular = min(old, 1.0 / kappa - 0.5 * cam.clearance) if kappa > 0.0 else old
    if regular <= BEYOND * old:
        none = "the play of the groove alone exceeds the radius of curvature"
        return length_cure(knob, old, None, old, none)
    limit: float | None = regular
    near = regular * (1.0 - BEYOND)
    if not is_sound(cam.sized(roller_radius=near)):
        limit = nearest_cure(lambda r: cam.sized(roller_radius=r), near, BEYOND * old, old)
    return length_cure(knob, old, limit, old, none, upward=False)


def offset_or_arm(cam: Cam, _: Pairs) -> Cure:
    """Another offset |e| < r_G of a guide, or another arm of a rocker with the same pivot and r_G.

    In whichever direction the change is smaller.
    """
    knob, old, low, high, scale = _knob(cam.follower)
    none = f"no other {knob} between {low:g} and {high:g} mm cures it"

    def made(value: float) -> Cam:
        return cam.sized(**{knob: value})

    up = nearest_cure(made, old, max(high, old), scale)
    if up is not None:
        low = max(low, old - (up - old))
    down = nearest_cure(made, old, min(low, old), scale)
    limit = up if down is None else down
    return length_cure(knob, old, limit, scale, none, upward=down is None)


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
