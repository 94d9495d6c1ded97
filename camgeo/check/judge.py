"""What the checks find in a cam, or in the two cams of a conjugate pair."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain, pairwise
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from camgeo.cam.cam import Breadth, Cam, Drive
from camgeo.check.disc import Checks, disc_checks, disc_findings, transmission_angle_limit
from camgeo.check.finding import (
    BROKEN,
    CONVEXITY,
    RETURN,
    STATED,
    UNDERCUT,
    Finding,
    Findings,
    Limits,
    Severity,
    folded,
    forbidding,
    held,
    stated_in,
)
from camgeo.check.machine import LINKAGE, linkage_findings
from camgeo.errors import GeometryError, UndercutError
from camgeo.geometry.pieces import extremes
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.kinematics.laws.law import characteristic
from camgeo.kinematics.plan import Dwell, Joint, MotionPlan, Move, SplineMove, breaks, joints
from camgeo.kinematics.time_course import ConstantSpeed, TimeCourse, plan_extremes
from camgeo.lazy import Ledger, lazy
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.numeric.extremes import Extremes
from camgeo.numeric.kept import kept_with_owner
from camgeo.record import Displayed, Pickled
from camgeo.units import LengthUnit, LiftUnit, at_cam_angles, cam_angle

if TYPE_CHECKING:
    from camgeo.check.cures.remedies import Cure


WORST_FIRST: Final = ("invalid", "no-disc", "broken", "warning", "ok")
"""Order of the findings, by severity."""

CURABLE: Final = (*UNDERCUT, CONVEXITY, "transmission-angle", "radius-ratio-")
"""The same for any cure."""

Tried = tuple[Findings, Sequence[Finding]]
"""What is found on a changed design, and what of its parts breaks a limit, once it is looked at."""

ByCheck = Mapping[str, tuple[Finding, ...]]
"""Findings by the check that makes them."""


@dataclass(frozen=True)
class Judgement(Pickled, Displayed):
    """What the checks find, on demand.

    Attributes
    ----------
    drive : what moves the follower.
    cams : the cam; for a conjugate pair the main and the return one, with that drive; empty without
        a follower.
    limits : what they are compared with.
    tolerance : largest error of a flank along its normal [mm], for the closing error of a pair.
    unit : that of the scene, in which findings and cures state lengths.
    ledger : records what has been computed.
    trial : what is found on the scene with other values by key, which make the cams that it is
        given; None if there is no scene, where cures are judged by the discs alone.
    """

    drive: Drive
    cams: tuple[Cam, ...]
    limits: Limits
    tolerance: float
    unit: LengthUnit = "mm"
    ledger: Ledger = field(default_factory=Ledger, repr=False, compare=False)
    trial: Callable[[tuple[Cam, ...], Mapping[str, Any]], Tried] | None = field(
        default=None, repr=False, compare=False
    )

    @lazy
    def by_check(self) -> ByCheck:
        """The findings of each check, good and bad.

        For a conjugate pair also those of the return disc, and of both together; without a
        follower those of the linkage and of the motion.
        """
        if self.cams:
            cam = self.cams[0]
            found = disc_checks(cam, self.limits, self.ledger)
            if (breadth := cam.breadth) is not None:
                asked = cam.yoke_breadth, self.limits.closing_error
                found.run("yoke", lambda: [check_breadth(breadth, *asked)])
        else:
            found = Checks(self.ledger)
            found.run(LINKAGE, lambda: linkage_findings(self.drive, self.limits))
        if len(self.cams) > 1:
            self._of_pair(found)
        found.run("motion", lambda: motion_findings(self.drive))
        return {name: stated_in(self.unit, each) for name, each in found.items()}

    @lazy
    def findings(self) -> Findings:
        """All findings, worst first."""
        found = chain.from_iterable(self.by_check.values())
        return Findings(sorted(found, key=lambda finding: WORST_FIRST.index(finding.severity)))

    def _of_pair(self, found: Checks) -> None:
        """What is found in the return disc and in both discs together."""
        main, other = self.cams
        # The linkage, which both discs share, is reported once.
        shared = found.get(LINKAGE, ())

        def of_return() -> list[Finding]:
            return [
                replace(
                    each, name=f"{RETURN}: {each.name}", sentence=f"{RETURN} disc: {each.sentence}"
                )
                for each in disc_findings(other, self.limits)
                if each not in shared
            ]

        def of_both() -> Iterable[Finding]:
            curves = main.disc.pitch_curve, other.disc.pitch_curve
            try:
                return check_pair(*curves, self.tolerance, self.limits.closing_error)
            except GeometryError:  # a cusp, which the findings of its disc report
                return ()

        found.run(RETURN, of_return)
        if not forbidding(shared):
            found.run("pair", of_both)

    @property
    def has_outline(self) -> bool:
        """Whether no finding rules out the disc."""
        return not forbidding(self.findings)

    def require_outline(self, cam: Cam) -> None:
        """Raise UndercutError if there is no such disc; for a return cam, also no main disc."""
        found = [
            each.sentence
            for each in forbidding(self.findings)
            if cam is not self.cams[0] or not each.name.startswith(f"{RETURN}: ")
        ]
        if found:
            raise UndercutError("; ".join(found))

    @lazy
    def cures(self) -> tuple[Cure, ...]:
        """What would cure undercut, a broken transmission angle and a broken radius ratio, see
        `camgeo.check.cures.remedies`; empty if nothing is wrong with them.
        """
        if not any(
            each.severity in BROKEN and each.name.removeprefix(f"{RETURN}: ").startswith(CURABLE)
            for each in self.findings
        ):
            return ()
        from camgeo.check.cures.remedies import remedies  # a search that few cams need

        known: dict[tuple[tuple[str, object], ...], Tried] = {}

        def judged(cams: tuple[Cam, ...], edits: Mapping[str, Any]) -> Tried:
            question = tuple(edits.items())
            if question not in known:
                if self.trial is None:
                    other = replace(self, drive=cams[0].drive, cams=cams, ledger=Ledger())
                    known[question] = other.findings, ()
                else:
                    known[question] = self.trial(cams, edits)
            return known[question]

        limits = transmission_angle_limit(self.cams[0], self.limits), self.limits.radius_ratio
        return remedies(self.cams, *limits, self.findings, self.unit, judged)


def worst(findings: Iterable[Finding]) -> Severity:
    """The worst severity of the findings; "ok" if there are none."""
    return min((each.severity for each in findings), key=WORST_FIRST.index, default="ok")


def motion_findings(drive: Drive) -> tuple[Finding, ...]:
    """What the checks find in the motion and the speed, without any disc."""
    speed = check_speed(drive.plan, drive.time_course, drive.unit)
    return folded((*check_motion(drive.plan, drive.unit), *speed))


# -- motion ---------------------------------------------------------------------------------------
# Checks of the motion plan: its joints, overshoots, and how closely it follows its data.
#
# And its extremes, in time if the cam has a speed; these have no limit.


OVERSHOOT = 1e-9
"""Fraction of the stroke beyond which a move overshoots; rounding is a million times smaller."""

SWING = 1e-4
"""Fraction of the stroke beyond which a motion by data swings between its rows or points. A spline
through exact rows of a law swings a little where the jerk jumps: 1e-7 of the stroke with rows at
every degree of a move over 110 degrees, 6e-5 at every 10 degrees, 2e-3 at every 20."""

SHOCK, JERK = 0, 1
"""Order of continuity of the motion at a shock, and at a jerk."""


NAMES = ("velocity", "acceleration", "jerk")

OVER_ANGLE = ConstantSpeed(1.0)
"""At 1 rad/s derivatives over time are those over the cam angle."""


@kept_with_owner
def check_motion(plan: MotionPlan, unit: LiftUnit) -> tuple[Finding, ...]:
    """Shocks (jumps of s'), jerks (jumps of s''), overshoots, and deviations from lift tables.

    Parameters
    ----------
    plan : in mm or rad.
    unit : which of the two; findings give degrees for rad.
    """
    found = [_laws(plan), _continuity(plan)]
    scale, shown = STATED[unit]
    for joint in breaks(plan):
        if joint.order == SHOCK:
            found.append(_jump(joint, 1, scale, shown))
        if joint.order in (SHOCK, JERK) and joint.left[2] != joint.right[2]:
            found.append(_jump(joint, 2, scale, shown))
    position = 0.0
    for segment, start in zip(plan.segments, plan.joints_deg, strict=False):
        angle = math.radians(float(segment.span))
        if isinstance(segment, Move) and segment.scale is None:
            found += _overshoot(segment, position, float(start), scale, shown)
        if isinstance(segment, SplineMove):
            first = math.radians(float(start))
            if segment.report is not None:
                found.append(_deviation(segment, first, angle, position, scale, shown))
            found += _swing(segment, first, angle, position, scale, shown)
        if isinstance(segment, Move | SplineMove):
            position = segment.to
    return tuple(found)


def _laws(plan: MotionPlan) -> Finding:
    """The law of each move, with the parameters chosen or computed for it."""
    moves = [
        f"{float(start):g} to {float(end):g} deg {_made_of(segment)}"
        for segment, (start, end) in zip(plan.segments, pairwise(plan.joints_deg), strict=True)
        if segment.span and not isinstance(segment, Dwell)
    ]
    sentence = "; ".join(moves[:LISTED]) + _more(moves) if moves else "the follower rests"
    return Finding("laws", "ok", sentence, float(len(moves)))


def _more(listed: Sequence[object]) -> str:
    return f" and {len(listed) - LISTED} more" if len(listed) > LISTED else ""


def _made_of(segment: Move | SplineMove) -> str:
    if isinstance(segment, SplineMove):
        return "by data"
    law = segment.law
    given = ", ".join(f"{key} {value:.6g}" for key, value in law.parameters.items())
    return f"{law.name} {law.task}" + (f" ({given})" if given else "")


def _continuity(plan: MotionPlan) -> Finding:
    """The classes of all joints, and the order of continuity of the motion there."""
    met = joints(plan)
    worst = min(joint.order for joint in met)
    listed = ", ".join(
        f"{cam_angle(joint.cam_angle)} deg: {_both(joint)} C{joint.order}" for joint in met[:LISTED]
    )
    sentence = f"the motion is at least C{worst} at its joints ({listed}{_more(met)})"
    return Finding("joints", "ok", sentence, float(worst))


LISTED = 12
"""Most joints or moves listed in a sentence."""


def _both(joint: Joint) -> str:
    before, after = joint.before, joint.after
    return f"{before}" if before == after else f"{before}|{after}"


def _jump(joint: Joint, order: int, scale: float, unit: str) -> Finding:
    jump = scale * float(joint.right[order] - joint.left[order])
    place = at_cam_angles(joint.cam_angle)
    if order == 1:
        per = f"{unit}/rad"
        statement = (
            f"the velocity jumps by {jump:.6g} {per} {place}, a shock: the acceleration is infinite"
        )
        return Finding("shock", "broken", statement, jump, 0.0, per, joint.cam_angle)
    per = f"{unit}/rad^2"
    statement = f"the acceleration jumps by {jump:.6g} {per} {place}"
    return Finding("jerk", "warning", statement, jump, 0.0, per, joint.cam_angle)


def _overshoot(move: Move, position: float, start: float, scale: float, unit: str) -> list[Finding]:
    """How far a move goes beyond its start and its end."""
    stroke = move.to - position
    if stroke == 0.0:
        return []
    values = characteristic(move.law)
    found = []
    for excess, extreme, what in (
        (values.lift.value - 1.0, values.lift, "end"),
        (-values.least_lift.value, values.least_lift, "start"),
    ):
        if excess > OVERSHOOT:
            angle = start + extreme.place * float(move.span)
            beyond = scale * excess * abs(stroke)
            place = math.radians(angle)
            statement = (
                f"the move by {move.law.name} goes {beyond:.6g} {unit} beyond its {what}, to"
                f" {scale * (position + stroke * extreme.value):.6g} {unit} {at_cam_angles(place)}"
            )
            found.append(Finding("overshoot", "warning", statement, beyond, 0.0, unit, place))
    return found


def _deviation(
    move: SplineMove, start: float, length: float, position: float, scale: float, unit: str
) -> Finding:
    """How far a motion is from the rows of its table, and by how much these were shifted."""
    report = move.report
    assert report is not None  # only those are passed
    angle = start + report.place * length
    largest = scale * report.largest_deviation
    first_row, shift = position - move.shift, abs(move.shift)
    added = ""
    if shift > OVERSHOOT * _stroke(move):
        what = "added to" if move.shift > 0.0 else "subtracted from"
        added = (
            f"with {scale * shift:.6g} {unit} {what} each row, so that the first one,"
            f" {scale * first_row:.6g} {unit}, lies where the segment starts, at"
            f" {scale * position:.6g} {unit}, "
        )
    statement = (
        f"{added}the motion is at most {largest:.3g} {unit} off the rows of its lift table,"
        f" {at_cam_angles(angle)} (root mean square {scale * report.rms:.3g} {unit})"
    )
    counted_from_start = shift <= _slack(move) or first_row == 0.0
    severity: Severity = "ok" if counted_from_start else "warning"
    return Finding("lift-table", severity, statement, largest, unit=unit, cam_angle=angle)


def _swing(
    move: SplineMove, start: float, length: float, position: float, scale: float, unit: str
) -> list[Finding]:
    """How far a motion by data goes beyond two neighbouring rows or points between them."""
    extreme = move.spline.beyond_knots()
    beyond = abs(extreme.value)
    allowed = _slack(move)
    if beyond <= allowed:
        return []
    angle = start + extreme.place * length
    knots = move.spline.knots
    after = int(np.searchsorted(knots[1:-1], extreme.place)) + 1
    first, last = (
        math.degrees(start + float(knot) * length) for knot in knots[after - 1 : after + 1]
    )
    there = position + float(move.spline.values(np.array([extreme.place]), 0)[0, 0])
    side = "below" if extreme.value < 0.0 else "above"
    statement = (
        f"the motion from data goes {scale * beyond:.6g} {unit} {side} both its"
        f" {'points' if move.report is None else 'rows'} at {first:.6g} and {last:.6g} deg, to"
        f" {scale * there:.6g} {unit} {at_cam_angles(angle)}"
    )
    return [
        Finding("overshoot", "warning", statement, scale * beyond, scale * allowed, unit, angle)
    ]


def _slack(move: SplineMove) -> float:
    """The uncertainty of rows or points [mm or rad]."""
    deviation = 0.0 if move.report is None else move.report.largest_deviation
    return max(SWING * _stroke(move), deviation)


def _stroke(move: SplineMove) -> float:
    """Largest distance between rows or points [mm or rad]."""
    return float(np.ptp(move.spline.values(move.spline.knots, 0)[0]))


@kept_with_owner
def check_speed(plan: MotionPlan, course: TimeCourse | None, unit: LiftUnit) -> tuple[Finding, ...]:
    """Smallest and largest velocity, acceleration and jerk, and the torque to move a unit of mass.

    Parameters
    ----------
    plan : in mm or rad.
    course : how the cam turns; None gives the derivatives over the cam angle, and no torque.
    unit : mm or rad.
    """
    reached = plan_extremes(plan, course or OVER_ANGLE, unit)
    scale, shown = STATED[unit]
    base = "rad" if course is None else "s"
    order = min(joint.order for joint in breaks(plan))
    found = []
    for power, (name, values) in enumerate(
        zip(NAMES, (reached.velocity, reached.acceleration, reached.jerk), strict=True), start=1
    ):
        per = f"{shown}/{base}" if power == 1 else f"{shown}/{base}^{power}"
        # Where a derivative jumps the next one is infinite.
        found.append(_finding(name, values, scale, per, bounded=order >= power - 1))
    if course is not None:
        per = "N m/kg" if unit == "mm" else "N m/(kg m^2)"
        found.append(_finding("inertia-torque", reached.torque, 1.0, per, bounded=order >= 1))
    return tuple(found)


def _finding(name: str, values: Extremes, scale: float, unit: str, *, bounded: bool) -> Finding:
    low, high = values.lowest, values.highest
    worst = max(low, high, key=lambda end: abs(end.value))
    sentence = (
        f"from {scale * low.value:.6g} to {scale * high.value:.6g} {unit},"
        f" {at_cam_angles(low.place, high.place)}"
    )
    if low.value == high.value:
        sentence = f"{scale * low.value:.6g} {unit} over the whole turn"
    if not bounded:
        jumps = "a shock" if name != "jerk" else "a shock or a jerk"
        sentence = f"infinite at {jumps}; elsewhere {sentence}"
        return Finding(f"largest-{name}", "ok", sentence, unit=unit)
    value = scale * worst.value
    return Finding(f"largest-{name}", "ok", sentence, value, unit=unit, cam_angle=worst.place)


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
