"""Checks that roller and guide make a cam mechanism at all."""

from __future__ import annotations

import math

from camgeo.check.finding import Finding
from camgeo.mechanism.follower import Follower

LOCKED = 1e-9
"""A guide this close to tangent to the base circle, as a fraction of its radius, is tangent."""


def check_follower(
    follower: Follower, *, runs_on_inner: bool, clearance: float = 0.0
) -> tuple[Finding, ...]:
    """Whether the roller covers the cam axis, or the follower locks on its guide; else nothing.

    `runs_on_inner` is True if the roller runs on the inner working curve, alone or in a groove,
    which is wider than the roller by `clearance` [mm].
    """
    found = []
    base = follower.base_radius
    half = follower.roller_radius + 0.5 * clearance
    if runs_on_inner and half >= base:
        what = "the roller" if clearance == 0.0 else "half the groove's width"
        statement = (
            f"{what} ({half:g} mm) is not smaller than the base circle ({base:g} mm): it covers the"
            " cam axis, and its inner working curve lies on the other side; make"
            " follower.roller_radius smaller or follower.base_radius larger"
        )
        found.append(Finding("roller-over-axis", "invalid", statement, half, base, "mm"))
    offset = abs(follower.offset)
    if math.sqrt((base - offset) * (base + offset)) <= LOCKED * base:
        statement = (
            f"the offset equals the base radius ({base:g} mm): the guide touches the base circle,"
            " the transmission angle is 0 at cam angle 0 and the follower locks; make"
            " follower.offset smaller"
        )
        found.append(
            Finding("self-locking", "invalid", statement, offset, base, "mm", cam_angle=0.0)
        )
    return tuple(found)
