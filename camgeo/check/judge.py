"""What the checks find in a cam, or in the two cams of a conjugate pair."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import chain, pairwise
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from camgeo.check.finding import (
    BROKEN,
    CONVEXITY,
    RETURN,
    RULE_OF_THUMB,
    STATED,
    UNDERCUT,
    Finding,
    Findings,
    Limits,
    Severity,
    default_linkage_transmission_angle,
    default_transmission_angle,
    folded,
    forbidding,
    stated_in,
)
from camgeo.check.flank import (
    check_curved_face,
    check_radius_ratio,
    check_standstill,
    check_transmission_angle,
    check_undercut,
    is_curved_face,
)
from camgeo.check.machine import check_closure, check_follower, check_linkage
from camgeo.errors import GeometryError, UndercutError
from camgeo.geometry.outline.path import Flank
from camgeo.kinematics.laws.law import characteristic
from camgeo.kinematics.mechanism.linked_motion import LinkedMotion
from camgeo.kinematics.plan import Dwell, Joint, MotionPlan, Move, SplineMove, breaks, joints
from camgeo.kinematics.time_course import ConstantSpeed, TimeCourse, plan_extremes
from camgeo.lazy import Ledger, lazy
from camgeo.numeric.extremes import Extremes
from camgeo.numeric.kept import kept_with_owner
from camgeo.record import Displayed, Pickled
from camgeo.units import LengthUnit, LiftUnit, at_cam_angles, cam_angle

if TYPE_CHECKING:
    from camgeo.cam.cam import Cam, Drive
    from camgeo.check.cures.search import Cure
    from camgeo.geometry.working_curve import WorkingCurve


WORST_FIRST: Final = ("invalid", "no-disc", "broken", "warning", "ok")
"""Order of the findings, by severity."""

LINKAGE: Final = "linkage"
"""Name of the check of the linkage."""

CURABLE: Final = (*UNDERCUT, CONVEXITY, "transmission-angle", "radius-ratio-")
"""The same for any cure."""

UNMENDED: Final = ("outline-", "closure")
"""Beginnings of the names of findings that rule out a disc even if undercut is trimmed."""

TRIM: Final = 'limits.undercut = "trim" makes the disc that is left'

FINDINGS: Final = "findings."
"""Prefix of the names under which ledgers record checks."""

Tried = tuple[Findings, Sequence[Finding]]
"""What is found on a changed design, and what of its parts breaks a limit, once it is looked at."""

ByCheck = Mapping[str, tuple[Finding, ...]]
"""Findings by the check that makes them."""


class Checks(dict[str, tuple[Finding, ...]]):
    """What checks find, by their names in the order of running; `ledger` records each."""

    def __init__(self, ledger: Ledger) -> None:
        super().__init__()
        self._ledger = ledger

    def run(self, name: str, check: Callable[[], Iterable[Finding]]) -> tuple[Finding, ...]:
        """The findings of `check`, kept by `name`."""
        with self._ledger.entry(f"{FINDINGS}{name}"):
            self[name] = tuple(check())
        return self[name]

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Of all checks."""
        return tuple(chain.from_iterable(self.values()))


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
            found = disc_checks(self.cams[0], self.limits, self.ledger)
            _of_yoke(self.cams[0], self.limits, found)
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
        from camgeo.check.machine import check_pair  # few cams are pairs

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


def transmission_angle_limit(cam: Cam, limits: Limits) -> float:
    """Smallest transmission angle allowed [rad]: the one stated, or the default of the sources."""
    if limits.transmission_angle is not None:
        return limits.transmission_angle
    return default_transmission_angle(cam.follower.lift_unit, cam.drive.speed)


def motion_findings(drive: Drive) -> tuple[Finding, ...]:
    """What the checks find in the motion and the speed, without any disc."""
    speed = check_speed(drive.plan, drive.time_course, drive.unit)
    return folded((*check_motion(drive.plan, drive.unit), *speed))


def disc_findings(cam: Cam, limits: Limits) -> tuple[Finding, ...]:
    """What the checks find in the mechanism and the disc, without the motion."""
    return disc_checks(cam, limits, cam.ledger).findings


def disc_checks(cam: Cam, limits: Limits, ledger: Ledger) -> Checks:
    """The findings of `disc_findings` by check; `ledger` records each."""
    found = Checks(ledger)
    inside = cam.contact.runs_inside
    found.run(
        "follower",
        lambda: check_follower(cam.follower, runs_on_inner=inside, clearance=cam.clearance),
    )
    if cam.drive.linkage is not None:
        of_linkage = found.run(LINKAGE, lambda: linkage_findings(cam.drive, limits))
        if forbidding(of_linkage):
            return found
    OF_DISC[cam.follower.touching](cam, limits, found)
    return found


def linkage_findings(drive: Drive, limits: Limits) -> tuple[Finding, ...]:
    """Findings on the linkage, which no size of a disc changes; none without one."""
    motion, limit = drive.motion, limits.linkage_transmission_angle
    if not isinstance(motion, LinkedMotion):
        return ()
    return check_linkage(motion, limit or default_linkage_transmission_angle(drive.speed))


def _of_yoke(cam: Cam, limits: Limits, found: Checks) -> None:
    """Whether both sides of a yoke touch throughout the turn; nothing without one."""
    if cam.breadth is None:
        return
    from camgeo.check.machine import check_breadth

    breadth, given = cam.breadth, cam.yoke_breadth
    found.run("yoke", lambda: [check_breadth(breadth, given, limits.closing_error)])


def _of_face(cam: Cam, limits: Limits, found: Checks) -> None:
    """Whether there is a cam for a flat face, and how the face is used."""
    from camgeo.check.flank import check_convexity, check_face, is_undercut

    curve, severity = cam.disc.pitch_curve, _of_undercut(limits)
    bent = found.run("convexity", lambda: check_convexity(curve, severity))
    wrong = [finding for finding in bent if finding.severity != "ok"]
    left: tuple[Finding, ...] = ()
    if len(wrong) == 1 and is_undercut(wrong[0]):
        left = found.run("outline", lambda: _left_of_face(cam, severity))
    if not forbidding((*bent, *left)):
        found.run(
            "transmission-angle",
            lambda: [check_transmission_angle(curve, transmission_angle_limit(cam, limits))],
        )
        found.run("face", lambda: check_face(curve, cam.disc.outline(Flank.INNER).path))
        found.run("closure", lambda: check_closure(curve))
    _name_trim(found)


def _left_of_face(cam: Cam, severity: Severity) -> list[Finding]:
    """What a flat face does on the disc that is left of an undercut cam."""
    from camgeo.check.flank import check_lost_stroke

    disc, name = cam.disc, Flank.INNER
    try:
        if not disc.outline(name).is_trimmed:
            return []
        return [check_lost_stroke(disc.replay(name), name, cam.lift_unit, severity)]
    except GeometryError as error:
        return [Finding(f"outline-{name}", "no-disc", f"{name} flank: {error.message}")]


def _of_undercut(limits: Limits) -> Severity:
    """Severity of undercut and of what follows from it: a trimmed disc can still be made."""
    return "broken" if limits.undercut == "trim" else "no-disc"


def _of_roller(cam: Cam, limits: Limits, found: Checks) -> None:
    """Whether a roller can follow the curve, and what remains of the flanks in use."""
    disc = cam.disc
    curve = disc.pitch_curve
    if found.run("standstill", lambda: check_standstill(curve)):
        return
    severity = _of_undercut(limits)
    limit = transmission_angle_limit(cam, limits)
    found.run("transmission-angle", lambda: [check_transmission_angle(curve, limit)])
    mechanism = not any(finding.severity == "invalid" for finding in found.findings)
    radius = cam.follower.roller_radius
    try:
        bends = disc.bends
    except GeometryError as error:
        reason = error.message
        found.run("curvature", lambda: [Finding("curvature", "no-disc", reason)])
        return

    # A limit other than the rule of thumb for rollers is meant for what is there.
    curved = is_curved_face(cam, bends)
    ratio = None if curved and limits.radius_ratio == RULE_OF_THUMB else limits.radius_ratio

    def of_flank(flank: WorkingCurve, name: str) -> Iterable[Finding]:
        yield check_radius_ratio(flank, name, bends, ratio, radius)
        yield from check_undercut(flank, name, bends, severity)

    for name, flank in disc.flanks:
        found.run(f"curvature-{name}", partial(of_flank, flank, name))
        if mechanism:
            found.run(f"outline-{name}", partial(_of_outline, cam, name, flank, severity))
    if curved:
        found.run("face", lambda: check_curved_face(curve, bends))
    if cam.clearance > 0.0:
        from camgeo.check.flank import check_side_clearance  # few grooves have it

        found.run("side-clearance", lambda: [check_side_clearance(curve, cam.clearance)])
    found.run("closure", lambda: check_closure(curve, severity))
    if mechanism and severity == "no-disc":
        _name_trim(found)


def _name_trim(found: Checks) -> None:
    """If the disc is refused but could be trimmed, one of the findings names the key for that."""
    refused = [finding.name for finding in found.findings if finding.severity == "no-disc"]
    if any(name.startswith(UNMENDED) for name in refused):
        return
    for named in ("lost-stroke-", "tangent-closure"):
        if any(name.startswith(named) for name in refused):
            for part, own in found.items():
                found[part] = tuple(
                    replace(each, sentence=f"{each.sentence}; {TRIM}")
                    if each.name.startswith(named)
                    else each
                    for each in own
                )
            return


def _of_outline(cam: Cam, name: str, flank: WorkingCurve, severity: Severity) -> list[Finding]:
    """What remains of a flank, and what the follower does on it."""
    from camgeo.check.flank import check_lost_stroke, check_outline
    from camgeo.geometry.outline.outline import undercut_ranges

    disc = cam.disc
    try:
        outline = disc.outline(name)
        replay = disc.replay(name) if outline.is_trimmed else None
    except GeometryError as error:
        return [Finding(f"outline-{name}", "no-disc", f"{name} flank: {error.message}")]
    ranges = undercut_ranges(flank, disc.bends)
    kinks = [pivot.after for pivot in disc.pitch_path.pivots]
    found = [*check_outline(outline, name, ranges, severity, kinks)]
    if replay is not None:
        found.append(check_lost_stroke(replay, name, cam.lift_unit, severity))
    return found


OF_DISC: Final = {"roller": _of_roller, "face": _of_face}
"""The findings of a disc, by what touches it."""


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
    extremes = plan_extremes(plan, course or OVER_ANGLE, unit)
    scale, shown = STATED[unit]
    base = "rad" if course is None else "s"
    order = min(joint.order for joint in breaks(plan))
    found = []
    for power, (name, values) in enumerate(
        zip(NAMES, (extremes.velocity, extremes.acceleration, extremes.jerk), strict=True), start=1
    ):
        per = f"{shown}/{base}" if power == 1 else f"{shown}/{base}^{power}"
        # Where a derivative jumps the next one is infinite.
        found.append(_finding(name, values, scale, per, bounded=order >= power - 1))
    if course is not None:
        per = "N m/kg" if unit == "mm" else "N m/(kg m^2)"
        found.append(_finding("inertia-torque", extremes.torque, 1.0, per, bounded=order >= 1))
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
