"""The findings on a cam, or on the two cams of a conjugate pair."""

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
    findings_in_unit,
    folded,
    forbidding,
    limit_finding,
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
"""Beginnings of the names of all findings against which a cure can be searched for."""

TrialFindings = tuple[Findings, Sequence[Finding]]
"""The findings on a changed design, and those on its parts that break a limit, which are computed
only when they are looked at."""

ByCheck = Mapping[str, tuple[Finding, ...]]
"""Findings by the check that makes them."""


@dataclass(frozen=True)
class Judgement(Pickled, Displayed):
    """The findings of all checks, computed on demand.

    Attributes
    ----------
    drive : drive of the follower: motion plan, linkage and speed.
    cams : the cam; for a conjugate pair the main and the return one, with that drive; empty without
        a follower.
    limits : the limits of the scene.
    tolerance : largest error of a flank along its normal [mm], for the closing error of a pair.
    unit : unit of the scene, in which findings and cures state lengths.
    ledger : records what has been computed.
    trial : returns the findings on the scene with other values by key, given the cams that these
        values make; None if there is no scene, so that cures are judged by the discs alone.
    """

    drive: Drive
    cams: tuple[Cam, ...]
    limits: Limits
    tolerance: float
    unit: LengthUnit = "mm"
    ledger: Ledger = field(default_factory=Ledger, repr=False, compare=False)
    trial: Callable[[tuple[Cam, ...], Mapping[str, Any]], TrialFindings] | None = field(
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
            checks = disc_checks(cam, self.limits, self.ledger)
            if (breadth := cam.breadth) is not None:
                required = cam.yoke_breadth, self.limits.closing_error
                checks.run("yoke", lambda: [check_breadth(breadth, *required)])
        else:
            checks = Checks(self.ledger)
            checks.run(LINKAGE, lambda: linkage_findings(self.drive, self.limits))
        if len(self.cams) > 1:
            self._run_pair_checks(checks)
        checks.run("motion", lambda: motion_findings(self.drive))
        return {name: findings_in_unit(self.unit, findings) for name, findings in checks.items()}

    @lazy
    def findings(self) -> Findings:
        """All findings, worst first."""
        all_findings = chain.from_iterable(self.by_check.values())
        return Findings(
            sorted(all_findings, key=lambda finding: WORST_FIRST.index(finding.severity))
        )

    def _run_pair_checks(self, checks: Checks) -> None:
        """Run the checks of the return disc and of both discs together."""
        main, other = self.cams
        # The linkage, which both discs share, is reported once.
        shared = checks.get(LINKAGE, ())

        def return_findings() -> list[Finding]:
            return [
                replace(
                    finding,
                    name=f"{RETURN}: {finding.name}",
                    sentence=f"{RETURN} disc: {finding.sentence}",
                )
                for finding in disc_findings(other, self.limits)
                if finding not in shared
            ]

        def pair_findings() -> Iterable[Finding]:
            curves = main.disc.pitch_curve, other.disc.pitch_curve
            try:
                return check_pair(*curves, self.tolerance, self.limits.closing_error)
            except GeometryError:  # a cusp, which the findings of its disc report
                return ()

        checks.run(RETURN, return_findings)
        if not forbidding(shared):
            checks.run("pair", pair_findings)

    @property
    def has_outline(self) -> bool:
        """Whether no finding rules out the disc."""
        return not forbidding(self.findings)

    def require_outline(self, cam: Cam) -> None:
        """Raise UndercutError if a finding rules out the disc of `cam`.

        Findings on the return disc do not rule out the main disc, but the other way round they do.
        """
        sentences = [
            finding.sentence
            for finding in forbidding(self.findings)
            if cam is not self.cams[0] or not finding.name.startswith(f"{RETURN}: ")
        ]
        if sentences:
            raise UndercutError("; ".join(sentences))

    @lazy
    def cures(self) -> tuple[Cure, ...]:
        """Cures of undercut and of a broken transmission angle or radius ratio, see
        `camgeo.check.cures.remedies`; empty if there is nothing to cure.
        """
        if not any(
            finding.severity in BROKEN
            and finding.name.removeprefix(f"{RETURN}: ").startswith(CURABLE)
            for finding in self.findings
        ):
            return ()
        from camgeo.check.cures.remedies import remedies  # a search that few cams need

        # Several knobs and both stages of the search ask for the same change.
        known: dict[tuple[tuple[str, object], ...], TrialFindings] = {}

        def judged(cams: tuple[Cam, ...], edits: Mapping[str, Any]) -> TrialFindings:
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
    return min((finding.severity for finding in findings), key=WORST_FIRST.index, default="ok")


def motion_findings(drive: Drive) -> tuple[Finding, ...]:
    """The findings on motion and speed, which need no disc."""
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
"""Order of continuity of the motion at a shock (a step of the velocity) and at a jerk (a step of
the acceleration, as VDI 2143 uses the word)."""


NAMES = ("velocity", "acceleration", "jerk")
"""Names of the first three derivatives of a motion, in the names of findings."""

UNIT_SPEED = ConstantSpeed(1.0)
"""At 1 rad/s derivatives with respect to time equal those with respect to the cam angle."""


@kept_with_owner
def check_motion(plan: MotionPlan, unit: LiftUnit) -> tuple[Finding, ...]:
    """Report shocks (steps of s'), jerks (steps of s''), overshoots and deviations of lift tables.

    Parameters
    ----------
    plan : the motion plan, with lifts in mm or rad.
    unit : unit of the lifts; findings give degrees for rad.
    """
    findings = [_laws(plan), _continuity(plan)]
    scale, display_unit = STATED[unit]
    for joint in breaks(plan):
        if joint.order == SHOCK:
            findings.append(_jump(joint, 1, scale, display_unit))
        # A shock may come with a step of the acceleration, which is reported separately.
        if joint.order in (SHOCK, JERK) and joint.left[2] != joint.right[2]:
            findings.append(_jump(joint, 2, scale, display_unit))
    position = 0.0
    for segment, start in zip(plan.segments, plan.joints_deg, strict=False):
        angle = math.radians(float(segment.span))
        # A move with a scale returns to where it started, so there is no stroke to exceed.
        if isinstance(segment, Move) and segment.scale is None:
            findings += _overshoot(segment, position, float(start), scale, display_unit)
        if isinstance(segment, SplineMove):
            first = math.radians(float(start))
            if segment.report is not None:
                findings.append(_deviation(segment, first, angle, position, scale, display_unit))
            findings += _swing(segment, first, angle, position, scale, display_unit)
        if isinstance(segment, Move | SplineMove):
            position = segment.to
    return tuple(findings)


def _laws(plan: MotionPlan) -> Finding:
    """Report the law of each move, with the parameters chosen or computed for it."""
    moves = [
        f"{float(start):g} to {float(end):g} deg {_law_text(segment)}"
        for segment, (start, end) in zip(plan.segments, pairwise(plan.joints_deg), strict=True)
        if segment.span and not isinstance(segment, Dwell)
    ]
    sentence = "; ".join(moves[:LISTED]) + _more(moves) if moves else "the follower rests"
    return Finding("laws", "ok", sentence, float(len(moves)))


def _more(listed: Sequence[object]) -> str:
    return f" and {len(listed) - LISTED} more" if len(listed) > LISTED else ""


def _law_text(segment: Move | SplineMove) -> str:
    if isinstance(segment, SplineMove):
        return "by data"
    law = segment.law
    parameters = ", ".join(f"{key} {value:.6g}" for key, value in law.parameters.items())
    return f"{law.name} {law.task}" + (f" ({parameters})" if parameters else "")


def _continuity(plan: MotionPlan) -> Finding:
    """Report the classes of all joints, and the order of continuity of the motion there."""
    all_joints = joints(plan)
    worst = min(joint.order for joint in all_joints)
    listed = ", ".join(
        f"{cam_angle(joint.cam_angle)} deg: {_class_text(joint)} C{joint.order}"
        for joint in all_joints[:LISTED]
    )
    sentence = f"the motion is at least C{worst} at its joints ({listed}{_more(all_joints)})"
    return Finding("joints", "ok", sentence, float(worst))


LISTED = 12
"""Most joints or moves listed in a sentence."""


def _class_text(joint: Joint) -> str:
    left, right = joint.before, joint.after
    return f"{left}" if left == right else f"{left}|{right}"


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
    """Report how far a move overshoots its start and its end."""
    stroke = move.to - position
    if stroke == 0.0:
        return []
    values = characteristic(move.law)
    findings = []
    for excess, extreme, what in (
        (values.lift.value - 1.0, values.lift, "end"),
        (-values.least_lift.value, values.least_lift, "start"),
    ):
        if excess > OVERSHOOT:
            angle = start + extreme.place * float(move.span)
            beyond = scale * excess * abs(stroke)
            place = math.radians(angle)
            statement = (
                f"the {move.law.name} move overshoots its {what} by {beyond:.6g} {unit}, to"
                f" {scale * (position + stroke * extreme.value):.6g} {unit} {at_cam_angles(place)}"
            )
            findings.append(Finding("overshoot", "warning", statement, beyond, 0.0, unit, place))
    return findings


def _deviation(
    move: SplineMove, start: float, length: float, position: float, scale: float, unit: str
) -> Finding:
    """Report how far a motion is from the rows of its table, and by how much these were shifted."""
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
        f"{added}the motion deviates from the rows of its lift table by at most {largest:.3g}"
        f" {unit}, {at_cam_angles(angle)} (root mean square {scale * report.rms:.3g} {unit})"
    )
    # Rows that begin with 0 count from where the segment starts; any other shift is worth a look.
    counted_from_start = shift <= _slack(move) or first_row == 0.0
    severity: Severity = "ok" if counted_from_start else "warning"
    return Finding("lift-table", severity, statement, largest, unit=unit, cam_angle=angle)


def _swing(
    move: SplineMove, start: float, length: float, position: float, scale: float, unit: str
) -> list[Finding]:
    """Report how far a motion from data leaves the range of two neighbouring rows or points."""
    extreme = move.spline.beyond_knots()
    beyond = abs(extreme.value)
    allowed = _slack(move)
    if beyond <= allowed:
        return []
    angle = start + extreme.place * length
    knots = move.spline.knots
    # Only the inner knots are searched, so that an extreme at an end has a knot on either side.
    right = int(np.searchsorted(knots[1:-1], extreme.place)) + 1
    first, last = (
        math.degrees(start + float(knot) * length) for knot in knots[right - 1 : right + 1]
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
    """The uncertainty of the rows or points [mm or rad], within which a swing is not reported."""
    deviation = 0.0 if move.report is None else move.report.largest_deviation
    return max(SWING * _stroke(move), deviation)


def _stroke(move: SplineMove) -> float:
    """The range of the rows or points [mm or rad]."""
    return float(np.ptp(move.spline.values(move.spline.knots, 0)[0]))


@kept_with_owner
def check_speed(plan: MotionPlan, course: TimeCourse | None, unit: LiftUnit) -> tuple[Finding, ...]:
    """Report the smallest and largest velocity, acceleration and jerk, and the torque that moves a
    unit of mass.

    Parameters
    ----------
    plan : the motion plan, with lifts in mm or rad.
    course : the cam's speed variation; None gives the derivatives with respect to the cam angle,
        and no torque.
    unit : unit of the lifts, mm or rad.
    """
    peaks = plan_extremes(plan, course or UNIT_SPEED, unit)
    scale, display_unit = STATED[unit]
    base = "rad" if course is None else "s"
    order = min(joint.order for joint in breaks(plan))
    findings = []
    for power, (name, values) in enumerate(
        zip(NAMES, (peaks.velocity, peaks.acceleration, peaks.jerk), strict=True), start=1
    ):
        per = f"{display_unit}/{base}" if power == 1 else f"{display_unit}/{base}^{power}"
        # Where a derivative jumps the next one is infinite.
        findings.append(_extreme_finding(name, values, scale, per, bounded=order >= power - 1))
    if course is not None:
        per = "N m/kg" if unit == "mm" else "N m/(kg m^2)"
        findings.append(
            _extreme_finding("inertia-torque", peaks.torque, 1.0, per, bounded=order >= 1)
        )
    return tuple(findings)


def _extreme_finding(
    name: str, values: Extremes, scale: float, unit: str, *, bounded: bool
) -> Finding:
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
    """Check a pair of discs for form closure, and for the error with which the pair closes.

    Parameters
    ----------
    main, other : pitch curves of the main disc and of the return disc, from one motion.
    tolerance : largest error of either flank along its normal [mm].
    limit : largest closing error allowed, as travel of the main roller [mm].

    Without form closure there is no closing error. Raises GeometryError if Z' of one of the curves
    vanishes anywhere.
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
    """Check that the product of the leverages, as sines of the transmission angles, is below 0."""
    # A leverage is the reach times the sine of the transmission angle: without the reaches the
    # product does not depend on the size of the mechanism.
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
    """Compare the play or interference of two discs true to `tolerance` [mm] with `limit` [mm]."""
    scale = tolerance * abs(main.follower.reach)

    def play(phi: FloatArray, side: Side) -> FloatArray:
        either = (1.0 / np.abs(curve.leverage(phi, side)) for curve in (main, other))
        return scale * sum(either, start=np.zeros(len(phi)))

    def slope(phi: FloatArray, side: Side) -> FloatArray:
        # d/dphi of 1/|l| is -l' / (l |l|).
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
    return limit_finding("closing-error", statement, value, limit, "mm", phi)


def check_breadth(cam: Breadth, breadth: float, limit: float) -> Finding:
    """Compare the deviation of the cam's width from the `breadth` [mm] of a yoke with `limit` [mm].

    Where the cam is wider the yoke is squeezed, where it is narrower the yoke has play.
    """
    (least, narrow), (most, wide) = cam.range
    error, phi = max((most - breadth, wide), (breadth - least, narrow))
    statement = (
        f"yoke of breadth {breadth:.6g} mm: the cam is {least:.6g} to {most:.6g} mm wide, which"
        f" differs by up to {error + 0.0:.3g} mm {at_cam_angles(phi, form='.4f')}"
    )
    return limit_finding("closing-error", statement, error, limit, "mm", phi)
