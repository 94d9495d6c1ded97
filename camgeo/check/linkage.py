"""Checks of the linkage: dead centres and the branch."""

from __future__ import annotations

import math

from camgeo.check.finding import Finding
from camgeo.mechanism.linkage import LinkedMotion

DEAD_CENTRE = 1e-9
"""Crank and coupler within this share of their lengths of a straight line are at a dead centre."""

PARALLEL = math.radians(0.1)
"""The coupler counts as parallel to the guide within this angle: printed dimensions are rounded."""


def check_linkage(motion: LinkedMotion) -> tuple[Finding, ...]:
    """Dead centre in the stroke (fatal); coupler not parallel to the guide (warning)."""
    linkage = motion.linkage
    found = []
    stroke, missing = motion.tightest()
    spare = -missing
    limit = DEAD_CENTRE * (linkage.crank + linkage.coupler)
    if spare <= limit:
        found.append(
            Finding(
                name="dead-centre",
                severity="fatal",
                sentence=(
                    f"crank and coupler come to lie on one line at stroke {stroke:.6g} mm: a dead"
                    " centre, the rocker's acceleration becomes infinite there"
                ),
                value=spare,
                limit=limit,
                unit="mm",
            )
        )
    tilt = abs(math.remainder(linkage.coupler_angle, math.pi))
    if tilt > PARALLEL:
        found.append(
            Finding(
                name="linkage-branch",
                severity="warning",
                sentence=(
                    f"at stroke 0 the coupler is {math.degrees(tilt):.3f} deg off the guide's"
                    " direction, though the dimensions are defined by a parallel one: the other"
                    " `branch` may be meant"
                ),
                value=math.degrees(tilt),
                limit=math.degrees(PARALLEL),
                unit="deg",
                cam_angle=0.0,
            )
        )
    return tuple(found)
