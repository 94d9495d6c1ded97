"""Checks of the machine: linkage, form closure, roller and guide, and how the pitch curve joins."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from camgeo.cam.cam import Breadth, Drive
from camgeo.check.finding import Finding, Limits, Severity, held, is_slow
from camgeo.geometry.pieces import extremes
from camgeo.geometry.pitch_curve import PitchCurve, joints
from camgeo.kinematics.mechanism.follower import Follower
from camgeo.kinematics.mechanism.linkage import (
    BACK,
    OUT,
    Linkage,
    LinkedMotion,
    MonotoneRuns,
    clear_range,
    kept_between,
    monotone_runs,
    position_text,
)
from camgeo.numeric.arrays import FloatArray, Side, resolved
from camgeo.numeric.kept import kept_with_owner
from camgeo.units import at_cam_angles, cam_angle

LINKAGE: Final = "linkage"
"""Name of the check of the linkage."""

OF_SLOW_LINKAGE, OF_FAST_LINKAGE = 40.0, 50.0
"""Smallest transmission angles to aim for [degrees] in slow and in fast linkages, as is customary
(Volmer, Getriebetechnik)."""

DEAD_CENTRE = 1e-9
"""Crank and coupler are at a dead centre within this fraction of their lengths, or the sine of a
transmission angle is."""

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

BETWEEN: Final = {
    "slider": (GUIDE_NORMAL, "crank"),
    "lever": ("lever", "crank"),
    "crank": ("crank", GUIDE_NORMAL),
}
"""What makes the transmission angles with the coupler, `OUT` and `BACK`."""


def linkage_findings(drive: Drive, limits: Limits) -> tuple[Finding, ...]:
    """Findings on the linkage, which no size of a disc changes; none without one."""
    motion, limit = drive.motion, limits.linkage_transmission_angle
    if not isinstance(motion, LinkedMotion):
        return ()
    default = OF_SLOW_LINKAGE if is_slow(drive.speed) else OF_FAST_LINKAGE
    return check_linkage(motion, limit or math.radians(default))


@kept_with_owner
def check_linkage(motion: LinkedMotion, limit: float | None = None) -> tuple[Finding, ...]:
    """A dead centre within the motion (no disc), else the distance from one and the smallest
    transmission angles; a coupler not parallel to the guide (warning).

    The force comes from the cam: the angle between coupler and far member is compared with `limit`
    [rad], and where that member cannot be driven there is no disc either. The other angle, between
    coupler and the follower's member, says how well a force at the far end drives the follower
    back; it has no limit.
    """
    runs = monotone_runs(motion.demanded)
    spare = _to_dead_centre(motion, runs)
    branch = _branch(motion.linkage)
    if spare.severity == "no-disc":
        return (spare, *branch)
    return (spare, _out(motion.linkage, runs, limit), _back(motion.linkage, runs), *branch)


def _to_dead_centre(motion: LinkedMotion, runs: MonotoneRuns) -> Finding:
    """The length to spare where the linkage is nearest to a dead centre."""
    linkage = motion.linkage
    position, missing = motion.tightest(runs.range)
    spare = max(0.0, -missing)
    limit = DEAD_CENTRE * (linkage.crank + linkage.coupler)
    place, phi = _place(linkage, runs, position)
    what, infinite = LINES[linkage.member]
    if spare > limit:
        sentence = f"the linkage stays {spare:.6g} mm clear of a dead centre, nearest {place}"
        return Finding("dead-centre", "ok", sentence, spare, limit, "mm", phi)
    sentence = f"{what} {place}: a dead centre, {infinite} becomes infinite there"
    # If the motion starts in one, it cannot stay clear of it.
    kept = [] if 0.0 in clear_range(linkage) else kept_between(linkage)
    sentence += f"; {kept[0]} there is none" if kept else ""
    return Finding("dead-centre", "no-disc", sentence, spare, limit, "mm", phi)


def _out(linkage: Linkage, runs: MonotoneRuns, limit: float | None) -> Finding:
    """The smallest angle between coupler and far member, or where that member cannot be driven."""
    name, (sine, position) = "linkage-transmission-angle", _smallest(linkage, runs, OUT)
    place, phi = _place(linkage, runs, position)
    angle = math.degrees(math.asin(min(1.0, sine)))
    least = None if limit is None else math.degrees(limit)
    if sine > DEAD_CENTRE:
        statement = (
            f"smallest transmission angle {angle:.3f} deg, between coupler and"
            f" {BETWEEN[linkage.member][OUT]}, {place}"
        )
        return held(name, statement, angle, least, "deg", phi, least=True)
    what, stuck = LOCKED[linkage.member]
    sentence = f"{what} {place}: {stuck} there, its transmission angle is 0"
    kept = [] if 0.0 in clear_range(linkage, OUT) else kept_between(linkage, OUT)
    sentence += f"; {kept[0]} it is driven throughout" if kept else ""
    return Finding(name, "no-disc", sentence, 0.0, least, "deg", phi)


def _back(linkage: Linkage, runs: MonotoneRuns) -> Finding:
    """The smallest angle between coupler and the follower's member."""
    sine, position = _smallest(linkage, runs, BACK)
    angle = math.degrees(math.asin(min(1.0, sine)))
    place, phi = _place(linkage, runs, position)
    sentence = (
        f"driven back, smallest transmission angle {angle:.3f} deg, between coupler and"
        f" {BETWEEN[linkage.member][BACK]}, {place}"
    )
    return Finding("linkage-back-angle", "ok", sentence, angle, unit="deg", cam_angle=phi)


def _smallest(linkage: Linkage, runs: MonotoneRuns, way: int) -> tuple[float, float]:
    """Smallest magnitude of the sine of a transmission angle, and its position [mm or rad].

    Exact: it is at an end of the motion, where the far member is stuck, or where the angle turns.
    """
    low, high = runs.range
    positions = [low, high]
    if way == OUT:
        positions += linkage.locked_positions(low, high)
        positions += linkage.far_turning_positions(low, high)
    else:  # without a dead centre, where that sine is 0
        positions += linkage.turning_positions(low, high)
    sines = np.abs(linkage.transmission_sines(np.array(positions))[way])
    stuck = [each for each, sine in zip(positions, sines, strict=True) if sine <= DEAD_CENTRE]
    if stuck:
        return 0.0, min(stuck, key=runs.first_angle)
    least = int(np.argmin(sines))
    return float(sines[least]), positions[least]


def _place(linkage: Linkage, runs: MonotoneRuns, position: float) -> tuple[str, float]:
    """A position in words, and the first cam angle [rad] at which the motion is there."""
    phi = runs.first_angle(position)
    return f"at {position_text(linkage, position)}, cam angle {cam_angle(phi)} deg", phi


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


# -- form closure ---------------------------------------------------------------------------------
# Checks of what holds a follower both ways: the two discs of a conjugate pair, or a yoke.
#
# A normal force N of a disc on its roller does the work N dn on the follower, n positive outward
# and dn/dq the leverage (`camgeo.geometry.pitch_curve.PitchCurve.leverage`). Discs can only push.
# So a pair holds the follower both ways where the two leverages have opposite signs, and an error t
# of a flank along its normal moves the follower by t / |dn/dq|.


VANISHING: Final = 1e-12
"""A product of sines of transmission angles up to this is 0: rounding of the rollers' positions."""


def check_pair(
    main: PitchCurve, other: PitchCurve, tolerance: float, limit: float
) -> tuple[Finding, ...]:
    """Form closure of a pair of discs, and the error with which the pair closes.

    Parameters
    ----------
    main, other : pitch curves of the main disc and of the return disc, from one motion.
    tolerance : largest error of either flank along its normal [mm].
    limit : largest closing error allowed, as travel of the main roller [mm].

    Without form closure there is no closing error. Raises GeometryError where Z' of one of the
    curves vanishes.
    """
    closed = _check_form_closure(main, other)
    if closed.severity != "ok":
        return (closed,)
    return (closed, _check_closing_error(main, other, tolerance, limit))


def leverage_slope(curve: PitchCurve, phi: FloatArray, side: Side) -> FloatArray:
    """(n,) d/dphi of `PitchCurve.leverage`, by the chain rule [1 or mm/rad, per rad].

    With dn/dq = reach u / |Z'| and |Z'|^2 = u^2 + w^2 it is reach w (w u' - u w') / |Z'|^3.
    """
    tangent = curve.follower.tangent_jet(curve.motion.jet(phi, side), curve.rotation)
    (u, u1), (w, w1) = tangent.u, tangent.w
    speed = np.hypot(u, w)
    return np.asarray(curve.follower.reach * (w / speed) * ((w * u1 - u * w1) / (speed * speed)))


def _check_form_closure(main: PitchCurve, other: PitchCurve) -> Finding:
    """Whether the product of the leverages, as sines of the transmission angles, is below 0."""
    scale = 1.0 / abs(main.follower.reach * other.follower.reach)

    def product(phi: FloatArray, side: Side) -> FloatArray:
        return scale * main.leverage(phi, side) * other.leverage(phi, side)

    def slope(phi: FloatArray, side: Side) -> FloatArray:
        first, second = main.leverage(phi, side), other.leverage(phi, side)
        one = leverage_slope(main, phi, side) * second
        return np.asarray(one + first * leverage_slope(other, phi, side))

    value, phi = extremes(main, product, slope).largest()
    place = at_cam_angles(phi, form=".4f")
    bound = (
        f"product of the leverages as sines of the transmission angles {value + 0.0:.4f} {place}"
    )
    if value >= -VANISHING:
        sentence = (
            f"the two discs do not hold the follower between them: {bound}, where they do not push"
            " it in opposite senses"
        )
        return Finding("form-closure", "broken", sentence, value + 0.0, 0.0, cam_angle=phi)
    sentence = (
        f"the two discs push the follower in opposite senses over the whole turn; largest {bound}"
    )
    return Finding("form-closure", "ok", sentence, value, 0.0, cam_angle=phi)


def _check_closing_error(
    main: PitchCurve, other: PitchCurve, tolerance: float, limit: float
) -> Finding:
    """Compare the play or squeeze of two discs true to `tolerance` with `limit`."""
    scale = tolerance * abs(main.follower.reach)

    def play(phi: FloatArray, side: Side) -> FloatArray:
        either = (1.0 / np.abs(curve.leverage(phi, side)) for curve in (main, other))
        return scale * sum(either, start=np.zeros(len(phi)))

    def slope(phi: FloatArray, side: Side) -> FloatArray:
        total = np.zeros(len(phi))
        for curve in (main, other):
            lever = curve.leverage(phi, side)
            total -= leverage_slope(curve, phi, side) / (lever * np.abs(lever))
        return total

    value, phi = extremes(main, play, slope).largest()
    statement = (
        f"with both discs true to {tolerance:g} mm the rollers have at most {value:.6f} mm of"
        f" play or squeeze, as travel of the main roller, {at_cam_angles(phi, form='.4f')}"
    )
    return held("closing-error", statement, value, limit, "mm", phi)


def check_breadth(cam: Breadth, breadth: float, limit: float) -> Finding:
    """Compare how far the width of `cam` is from the `breadth` [mm] of a yoke with `limit` [mm].

    Where the cam is wider the yoke is squeezed, where it is narrower the yoke has play.
    """
    (least, narrow), (most, wide) = cam.range
    error, phi = max((most - breadth, wide), (breadth - least, narrow))
    statement = (
        f"yoke of breadth {breadth:.6g} mm: the cam is {least:.6g} to {most:.6g} mm wide, off"
        f" by up to {error + 0.0:.3g} mm {at_cam_angles(phi, form='.4f')}"
    )
    return held("closing-error", statement, error, limit, "mm", phi)


# -- follower -------------------------------------------------------------------------------------
# Checks that roller and guide make a cam mechanism at all.


TANGENT = 1e-9
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
    if math.sqrt((base - offset) * (base + offset)) <= TANGENT * base:
        statement = (
            f"the offset equals the base radius ({base:g} mm): the guide touches the base circle,"
            " the transmission angle is 0 at cam angle 0 and the follower locks; make"
            " follower.offset smaller"
        )
        found.append(
            Finding("self-locking", "invalid", statement, offset, base, "mm", cam_angle=0.0)
        )
    return tuple(found)


# -- closure --------------------------------------------------------------------------------------
# Checks of how the pitch curve joins at its breaks and after a full turn.


POINT_LIMIT = 1e-12
"""Largest gap as a fraction of the base radius: four hundred times the rounding of the curve."""

TANGENT_LIMIT = 1e-9
"""Largest angle between the tangents at a joint [rad]."""


def check_closure(curve: PitchCurve, severity: Severity = "no-disc") -> tuple[Finding, ...]:
    """Closure of the pitch curve and of its tangent.

    `severity` is that of a corner in the pitch curve: "no-disc" if no disc is made then, else
    "broken".
    """
    join = joints(curve)
    limit = POINT_LIMIT * (
        curve.follower.base_radius + float(np.max(np.abs(curve.point(join.phi))))
    )
    at_gap, at_turn = int(np.argmax(join.gaps)), int(np.argmax(join.turns))
    gap = float(join.gaps[at_gap])
    turn = math.degrees(resolved(float(join.turns[at_turn]), 1.0))
    place = float(join.phi[at_turn])
    statement = f"largest gap of the pitch curve at a joint {gap:.2g} mm"
    turned = f"largest angle between the tangents at a joint {turn:.2g} deg {at_cam_angles(place)}"
    corner: Severity = "ok"
    if join.turns[at_turn] > TANGENT_LIMIT:
        corner = severity
        turned += ", a shock: the velocity of the follower jumps"
    closed: Severity = "no-disc" if gap > limit else "ok"
    most = math.degrees(TANGENT_LIMIT)
    return (
        Finding("closure", closed, statement, gap, limit, "mm", float(join.phi[at_gap])),
        Finding("tangent-closure", corner, turned, turn, most, "deg", place),
    )
