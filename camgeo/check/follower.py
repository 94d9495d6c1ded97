"""Checks that roller and guide leave the cam a mechanism at all."""

from __future__ import annotations

import math

from camgeo.check.finding import Finding
from camgeo.mechanism.follower import Follower

LOCKED = 1e-9
"""A guide within this share of the base radius of a tangent to the base circle is one."""


def check_follower(
    follower: Follower, *, runs_on_inner: bool, clearance: float = 0.0
) -> tuple[Finding, ...]:
    """A roller that reaches over the cam axis, a guide on which the follower locks; else nothing.

    `runs_on_inner` is True if the roller runs on the inner working curve, alone or in a groove,
    which is wider than the roller by `clearance` [mm].
    """
    found = []
    half = follower.roller_radius + 0.5 * clearance
    if runs_on_inner and half >= follower.base_radius:
        what = "the roller" if clearance == 0.0 else "half the groove's width"
        found.append(
            Finding(
                name="roller-over-axis",
                severity="wrong",
                sentence=(
                    f"{what} ({half:g} mm) is not smaller than the base"
                    f" circle ({follower.base_radius:g} mm): it covers the cam axis, and its inner"
                    " working curve lies on the other side; make follower.roller_radius smaller or"
                    " follower.base_radius larger"
                ),
                value=half,
                limit=follower.base_radius,
                unit="mm",
            )
        )
    beside = abs(follower.offset)
    height = math.sqrt((follower.base_radius - beside) * (follower.base_radius + beside))
    if height <= LOCKED * follower.base_radius:
        found.append(
            Finding(
                name="self-locking",
                severity="wrong",
                sentence=(
                    f"the offset equals the base radius ({follower.base_radius:g} mm): the guide"
                    " touches the base circle, the transmission angle is 0 at cam angle 0 and the"
                    " follower locks; make follower.offset smaller"
                ),
                value=beside,
                limit=follower.base_radius,
                unit="mm",
                cam_angle=0.0,
            )
        )
    return tuple(found)
