"""What the checks find in a cam, or in the two cams of a conjugate pair."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import chain
from typing import TYPE_CHECKING, Any, Final

from camgeo.check.closure import check_closure
from camgeo.check.curvature import check_radius_ratio, check_undercut
from camgeo.check.curved_face import check_curved_face, is_curved_face
from camgeo.check.finding import (
    BROKEN,
    CONVEXITY,
    RETURN,
    UNDERCUT,
    Finding,
    Findings,
    Severity,
    folded,
    forbidding,
    stated_in,
)
from camgeo.check.follower import check_follower
from camgeo.check.limits import (
    RULE_OF_THUMB,
    Limits,
    default_linkage_transmission_angle,
    default_transmission_angle,
)
from camgeo.check.linkage import check_linkage
from camgeo.check.motion import check_motion, check_speed
from camgeo.check.standstill import check_standstill
from camgeo.check.transmission_angle import check_transmission_angle
from camgeo.displayed import Displayed
from camgeo.errors import GeometryError, UndercutError
from camgeo.lazy import Ledger, lazy
from camgeo.mechanism.linkage import LinkedMotion
from camgeo.outline.path import Flank
from camgeo.pickled import Pickled
from camgeo.units import LengthUnit

if TYPE_CHECKING:
    from camgeo.cam.cam import Cam
    from camgeo.cam.drive import Drive
    from camgeo.check.cures.cure import Cure
    from camgeo.curve.working_curve import WorkingCurve

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
        self[name] = self._ledger.run(f"{FINDINGS}{name}", lambda: tuple(check()))
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
        from camgeo.check.form_closure import check_pair  # few cams are pairs

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
    from camgeo.check.form_closure import check_breadth

    breadth, given = cam.breadth, cam.yoke_breadth
    found.run("yoke", lambda: [check_breadth(breadth, given, limits.closing_error)])


def _of_face(cam: Cam, limits: Limits, found: Checks) -> None:
    """Whether there is a cam for a flat face, and how the face is used."""
    from camgeo.check.face import (  # few cams have a flat face
        check_convexity,
        check_face,
        is_undercut,
    )

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
    from camgeo.check.outline import check_lost_stroke

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
        from camgeo.check.side_clearance import check_side_clearance  # few grooves have it

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
    from camgeo.check.outline import check_lost_stroke, check_outline
    from camgeo.outline.cusps import undercut_ranges

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
