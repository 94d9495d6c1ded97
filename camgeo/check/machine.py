"""Checks of the machine: its linkage, and whether roller and guide make a cam mechanism at all."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from camgeo.cam.cam import Drive
from camgeo.check.finding import Finding, Limits, is_slow, limit_finding
from camgeo.kinematics.mechanism.follower import Follower
from camgeo.kinematics.mechanism.linkage import (
    TO_FAR_END,
    TO_FOLLOWER,
    Linkage,
    LinkedMotion,
    clear_range,
    clear_range_texts,
    position_text,
)
from camgeo.numeric.kept import kept_with_owner
from camgeo.units import cam_angle

LINKAGE: Final = "linkage"
"""Name of the check of the linkage."""

SLOW_LINKAGE_ANGLE, FAST_LINKAGE_ANGLE = 40.0, 50.0
"""Smallest transmission angles to aim for [degrees] in slow and in fast linkages, as is customary
(Volmer, Getriebetechnik)."""

DEAD_CENTRE = 1e-9
"""A linkage counts as being at a dead centre within this fraction of the lengths of crank and
coupler; likewise the sine of a transmission angle up to this counts as 0."""

PARALLEL = math.radians(0.1)
"""The coupler counts as parallel to the guide within this angle: printed dimensions are rounded."""


LINES: Final = {
    "slider": ("crank and coupler come into line", "the rocker's acceleration"),
    "lever": ("crank and coupler come into line", "the rocker's acceleration"),
    "crank": ("the coupler becomes square to the guide", "the slider's velocity"),
}
"""What a dead centre is and what becomes infinite there, by the member whose motion is demanded."""

LOCKED: Final = {
    "slider": ("the coupler becomes square to the guide", "the rocker cannot move the slider"),
    "lever": ("coupler and lever come into line", "the rocker cannot move the lever"),
    "crank": ("crank and coupler come into line", "the slider cannot turn the crank"),
}
"""What a dead centre of the far member is, and what cannot be done there."""

GUIDE_NORMAL: Final = "the perpendicular to the guide"

ANGLE_MEMBERS: Final = {
    "slider": (GUIDE_NORMAL, "crank"),
    "lever": ("lever", "crank"),
    "crank": ("crank", GUIDE_NORMAL),
}
"""The members that make the transmission angles `TO_FAR_END` and `TO_FOLLOWER` with the coupler, by
the member whose motion is demanded."""


def linkage_findings(drive: Drive, limits: Limits) -> tuple[Finding, ...]:
    """The findings on the linkage, which no size of a disc changes; none without a linkage."""
    motion, limit = drive.motion, limits.linkage_transmission_angle
    if not isinstance(motion, LinkedMotion):
        return ()
    default = SLOW_LINKAGE_ANGLE if is_slow(drive.speed) else FAST_LINKAGE_ANGLE
    return check_linkage(motion, limit or math.radians(default))


@kept_with_owner
def check_linkage(motion: LinkedMotion, limit: float | None = None) -> tuple[Finding, ...]:
    """Report a dead centre within the motion (no disc), or else the distance from one and the
    smallest transmission angles; warn of a coupler that is not parallel to the guide.

    The force comes from the cam: the angle between coupler and far member is compared with `limit`
    [rad], and where that member cannot be driven there is no disc either. The other angle, between
    coupler and the follower's member, says how well a force at the far end drives the follower
    back; it has no limit.
    """
    spare = _to_dead_centre(motion)
    branch = _branch(motion.linkage)
    if spare.severity == "no-disc":
        return (spare, *branch)
    return (spare, _forward_angle(motion, limit), _back_angle(motion), *branch)


def _to_dead_centre(motion: LinkedMotion) -> Finding:
    """Report the length to spare where the linkage is nearest to a dead centre."""
    linkage = motion.linkage
    position, missing = motion.tightest(motion.runs.range)
    spare = max(0.0, -missing)
    limit = DEAD_CENTRE * (linkage.crank + linkage.coupler)
    place, phi = _place(motion, position)
    what, infinite = LINES[linkage.member]
    if spare > limit:
        sentence = f"the linkage stays {spare:.6g} mm clear of a dead centre, nearest {place}"
        return Finding("dead-centre", "ok", sentence, spare, limit, "mm", phi)
    sentence = f"{what} {place}: a dead centre, {infinite} becomes infinite there"
    # If the motion starts in one, it cannot stay clear of it.
    ranges = [] if 0.0 in clear_range(linkage) else clear_range_texts(linkage)
    sentence += f"; {ranges[0]} there is none" if ranges else ""
    return Finding("dead-centre", "no-disc", sentence, spare, limit, "mm", phi)


def _forward_angle(motion: LinkedMotion, limit: float | None) -> Finding:
    """Report the smallest angle between coupler and far member, or where that member is stuck."""
    name, linkage = "linkage-transmission-angle", motion.linkage
    sine, position = _smallest_sine(motion, TO_FAR_END)
    place, phi = _place(motion, position)
    angle = math.degrees(math.asin(min(1.0, sine)))
    least = None if limit is None else math.degrees(limit)
    if sine > DEAD_CENTRE:
        statement = (
            f"smallest transmission angle {angle:.3f} deg, between coupler and"
            f" {ANGLE_MEMBERS[linkage.member][TO_FAR_END]}, {place}"
        )
        return limit_finding(name, statement, angle, least, "deg", phi, least=True)
    what, stuck = LOCKED[linkage.member]
    sentence = f"{what} {place}: {stuck} there, its transmission angle is 0"
    ranges = (
        [] if 0.0 in clear_range(linkage, TO_FAR_END) else clear_range_texts(linkage, TO_FAR_END)
    )
    sentence += f"; {ranges[0]} it is driven throughout" if ranges else ""
    return Finding(name, "no-disc", sentence, 0.0, least, "deg", phi)


def _back_angle(motion: LinkedMotion) -> Finding:
    """Report the smallest angle between coupler and the follower's member."""
    sine, position = _smallest_sine(motion, TO_FOLLOWER)
    angle = math.degrees(math.asin(min(1.0, sine)))
    place, phi = _place(motion, position)
    sentence = (
        f"smallest transmission angle when driven back {angle:.3f} deg, between coupler and"
        f" {ANGLE_MEMBERS[motion.linkage.member][TO_FOLLOWER]}, {place}"
    )
    return Finding("linkage-back-angle", "ok", sentence, angle, unit="deg", cam_angle=phi)


def _smallest_sine(motion: LinkedMotion, way: int) -> tuple[float, float]:
    """Smallest magnitude of the sine of a transmission angle, and its position [mm or rad].

    The position is exact: the smallest sine is at an end of the motion, where the far member is
    stuck, or where the angle is extreme.
    """
    linkage, runs = motion.linkage, motion.runs
    low, high = runs.range
    positions = [low, high]
    if way == TO_FAR_END:
        positions += linkage.locked_positions(low, high)
        positions += linkage.far_turning_positions(low, high)
    else:  # without a dead centre, where that sine is 0
        positions += linkage.turning_positions(low, high)
    sines = np.abs(linkage.transmission_sines(np.array(positions))[way])
    stuck = [
        position for position, sine in zip(positions, sines, strict=True) if sine <= DEAD_CENTRE
    ]
    if stuck:
        return 0.0, min(stuck, key=runs.first_angle)
    least = int(np.argmin(sines))
    return float(sines[least]), positions[least]


def _place(motion: LinkedMotion, position: float) -> tuple[str, float]:
    """A position in words, and the first cam angle [rad] at which the motion is there."""
    phi = motion.runs.first_angle(position)
    return f"at {position_text(motion.linkage, position)}, cam angle {cam_angle(phi)} deg", phi


def _branch(linkage: Linkage) -> tuple[Finding, ...]:
    """A warning if the dimensions of a slider-crank are meant for the other branch."""
    tilt, limit = math.degrees(linkage.coupler_tilt), math.degrees(PARALLEL)
    if linkage.coupler_tilt <= PARALLEL:
        return ()
    statement = (
        f"at stroke 0 the coupler is {tilt:.3f} deg off the guide's direction, though the"
        " dimensions are defined for a parallel one: the other `branch` may be meant"
    )
    return (Finding("linkage-branch", "warning", statement, tilt, limit, "deg", cam_angle=0.0),)


# -- follower -------------------------------------------------------------------------------------
# Checks that roller and guide make a cam mechanism at all.


TANGENT = 1e-9
"""A guide this close to tangent to the base circle, as a fraction of its radius, is tangent."""


def check_follower(
    follower: Follower, *, runs_on_inner: bool, clearance: float = 0.0
) -> tuple[Finding, ...]:
    """Report a roller that covers the cam axis, or a follower that locks on its guide.

    `runs_on_inner` is True if the roller runs on the inner working curve, alone or in a groove,
    which is wider than the roller by `clearance` [mm].
    """
    findings = []
    base = follower.base_radius
    half = follower.roller_radius + 0.5 * clearance
    if runs_on_inner and half >= base:
        what = "the roller" if clearance == 0.0 else "half the groove's width"
        statement = (
            f"{what} ({half:g} mm) is not smaller than the base circle ({base:g} mm): it covers the"
            " cam axis, and its inner working curve lies on the other side; make"
            " follower.roller_radius smaller or follower.base_radius larger"
        )
        findings.append(Finding("roller-over-axis", "invalid", statement, half, base, "mm"))
    offset = abs(follower.offset)
    # The height of the roller centre at lift 0; the product of sum and difference does not cancel.
    if math.sqrt((base - offset) * (base + offset)) <= TANGENT * base:
        statement = (
            f"the offset equals the base radius ({base:g} mm): the guide touches the base circle,"
            " the transmission angle is 0 at cam angle 0 and the follower locks; make"
            " follower.offset smaller"
        )
        findings.append(
            Finding("self-locking", "invalid", statement, offset, base, "mm", cam_angle=0.0)
        )
    return tuple(findings)
