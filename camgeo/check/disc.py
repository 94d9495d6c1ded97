"""Checks of a disc: what a roller or a face demands of its flanks, and what remains of them.

Those of a flank: its curvature, a flat or curved face, standstill, transmission angle, and the play
of a roller in its groove. All of them read 1 + d kappa of the flank, d = -r_R for the inner, +r_R
for the outer working curve: 1 minus that is r_R / r_K for the sign of curvature that matters, at
most 0.7 by the rule of thumb (Wirsig eq. 3.36); 1 is a cusp, more is undercut. The flanks of a
groove with side clearance c lie at d = -+(r_R + c/2): cusp and undercut follow from that d, the
rule of thumb from the roller.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import partial
from itertools import chain
from typing import TYPE_CHECKING, Final

import numpy as np

from camgeo.cam.cam import Cam
from camgeo.check.finding import (
    FINDINGS,
    RULE_OF_THUMB,
    STATED,
    Finding,
    Limits,
    Severity,
    forbidding,
    is_slow,
    limit_finding,
)
from camgeo.check.machine import LINKAGE, check_follower, linkage_findings
from camgeo.errors import GeometryError
from camgeo.geometry.outline.face import contact_places
from camgeo.geometry.outline.outline import CUSP, INSIDE, Outline, undercut_ranges
from camgeo.geometry.outline.path import Flank, Path, area
from camgeo.geometry.pieces import (
    SMALLEST,
    Convexity,
    Extremes,
    convexity,
    extremes,
    extremes_of_members,
    touch,
    turn_cells,
    turn_enclosed,
)
from camgeo.geometry.pitch_curve import STANDSTILL, PitchCurve, WorkingCurve, joints
from camgeo.geometry.together import curves_together
from camgeo.kinematics.mechanism.flat import flat_follower
from camgeo.lazy import Ledger
from camgeo.numeric.arrays import FloatArray, Quantity, Side, resolved
from camgeo.numeric.kept import kept_with_each
from camgeo.units import TURN, LiftUnit, at_cam_angles, cam_angle, cam_angle_range, counted

if TYPE_CHECKING:
    from camgeo.geometry.outline.replay import Replay

NOT_TRIMMABLE: Final = ("outline-", "closure")
"""Beginnings of the names of findings that rule out a disc even where undercut may be trimmed."""

TRIM: Final = 'limits.undercut = "trim" makes the disc that remains'


class Checks(dict[str, tuple[Finding, ...]]):
    """The findings of each check by its name, in the order of running; `ledger` records them."""

    def __init__(self, ledger: Ledger) -> None:
        super().__init__()
        self._ledger = ledger

    def run(self, name: str, check: Callable[[], Iterable[Finding]]) -> tuple[Finding, ...]:
        """Run a check and return its findings, which are stored under its `name`."""
        with self._ledger.entry(f"{FINDINGS}{name}"):
            self[name] = tuple(check())
        return self[name]

    @property
    def findings(self) -> tuple[Finding, ...]:
        """The findings of all checks that have run."""
        return tuple(chain.from_iterable(self.values()))


def disc_findings(cam: Cam, limits: Limits) -> tuple[Finding, ...]:
    """The findings on mechanism and disc, without those on the motion."""
    return disc_checks(cam, limits, cam.ledger).findings


def disc_checks(cam: Cam, limits: Limits, ledger: Ledger) -> Checks:
    """The findings of `disc_findings` by check; `ledger` records each."""
    checks = Checks(ledger)
    inside = cam.contact.runs_inside
    checks.run(
        "follower",
        lambda: check_follower(cam.follower, runs_on_inner=inside, clearance=cam.clearance),
    )
    if cam.drive.linkage is not None:
        findings = checks.run(LINKAGE, lambda: linkage_findings(cam.drive, limits))
        if forbidding(findings):
            return checks
    DISC_CHECKS[cam.follower.touching](cam, limits, checks)
    return checks


def _face_checks(cam: Cam, limits: Limits, checks: Checks) -> None:
    """Check whether there is a cam for a flat face, and which part of the face is used."""
    curve, severity = cam.disc.pitch_curve, _undercut_severity(limits)
    convex_findings = checks.run("convexity", lambda: check_convexity(curve, severity))
    wrong = [finding for finding in convex_findings if finding.severity != "ok"]
    outline_findings: tuple[Finding, ...] = ()
    # A fault of convexity in mm is undercut; only if it is the sole fault is there an outline to be
    # trimmed.
    if len(wrong) == 1 and (wrong[0].name, wrong[0].unit) == ("convexity", "mm"):
        outline_findings = checks.run(
            "outline", lambda: _outline_findings(cam, Flank.INNER, severity)
        )
    if not forbidding((*convex_findings, *outline_findings)):
        checks.run(
            "transmission-angle",
            lambda: [check_transmission_angle(curve, transmission_angle_limit(cam, limits))],
        )
        checks.run("face", lambda: check_face(curve, cam.disc.outline(Flank.INNER).path))
        checks.run("closure", lambda: check_closure(curve))
    _name_trim(checks)


def _undercut_severity(limits: Limits) -> Severity:
    """The severity of undercut and of its consequences: a trimmed disc can still be made."""
    return "broken" if limits.undercut == "trim" else "no-disc"


def _roller_checks(cam: Cam, limits: Limits, checks: Checks) -> None:
    """Check whether a roller can follow the curve, and what remains of the flanks in use."""
    disc = cam.disc
    curve = disc.pitch_curve
    if checks.run("standstill", lambda: check_standstill(curve)):
        return
    severity = _undercut_severity(limits)
    limit = transmission_angle_limit(cam, limits)
    checks.run("transmission-angle", lambda: [check_transmission_angle(curve, limit)])
    # No outline is computed where roller and guide make no mechanism.
    mechanism = not any(finding.severity == "invalid" for finding in checks.findings)
    radius = cam.follower.roller_radius
    try:
        bends = disc.bends
    except GeometryError as error:
        reason = error.message
        checks.run("curvature", lambda: [Finding("curvature", "no-disc", reason)])
        return

    # The rule of thumb is one for rollers, so it does not limit a curved face; any other value has
    # been stated for this follower, whatever it is.
    curved = is_curved_face(cam, bends)
    ratio = None if curved and limits.radius_ratio == RULE_OF_THUMB else limits.radius_ratio

    def flank_findings(flank: WorkingCurve, name: str) -> Iterable[Finding]:
        yield check_radius_ratio(flank, name, bends, ratio, radius)
        yield from check_undercut(flank, name, bends, severity)

    for name, flank in disc.flanks:
        checks.run(f"curvature-{name}", partial(flank_findings, flank, name))
        if mechanism:
            checks.run(f"outline-{name}", partial(_outline_findings, cam, name, severity, flank))
    if curved:
        checks.run("face", lambda: check_curved_face(curve, bends))
    if cam.clearance > 0.0:
        checks.run("side-clearance", lambda: [check_side_clearance(curve, cam.clearance)])
    checks.run("closure", lambda: check_closure(curve, severity))
    if mechanism and severity == "no-disc":
        _name_trim(checks)


def _name_trim(checks: Checks) -> None:
    """Name the key that allows trimming in one of the findings, if trimming would make a disc."""
    refused = [finding.name for finding in checks.findings if finding.severity == "no-disc"]
    if any(name.startswith(NOT_TRIMMABLE) for name in refused):
        return
    # Only the first kind of finding that is there gets the remark.
    for named in ("lost-stroke-", "tangent-closure"):
        if any(name.startswith(named) for name in refused):
            for check, findings in checks.items():
                checks[check] = tuple(
                    replace(finding, sentence=f"{finding.sentence}; {TRIM}")
                    if finding.name.startswith(named)
                    else finding
                    for finding in findings
                )
            return


def _outline_findings(
    cam: Cam, name: str, severity: Severity, flank: WorkingCurve | None = None
) -> list[Finding]:
    """Findings on what remains of the flank `name`, and on the stroke lost where it is trimmed.

    `flank` is the working curve of a roller, whose global undercut and lobes are reported too.
    """
    disc, findings = cam.disc, list[Finding]()
    try:
        outline = disc.outline(name)
        replay = disc.replay(name) if outline.is_trimmed else None
    except GeometryError as error:
        return [Finding(f"outline-{name}", "no-disc", f"{name} flank: {error.message}")]
    if flank is not None:
        ranges = undercut_ranges(flank, disc.bends)
        kinks = [pivot.phi_end for pivot in disc.pitch_path.pivots]
        findings += check_outline(outline, name, ranges, severity, kinks)
    if replay is not None:
        findings.append(check_lost_stroke(replay, name, cam.lift_unit, severity))
    return findings


DISC_CHECKS: Final = {"roller": _roller_checks, "face": _face_checks}
"""The checks of a disc, by what touches it."""


SLOW_ANGLES: Final[dict[LiftUnit, float]] = {"mm": 60.0, "rad": 45.0}
"""Smallest transmission angles to aim for [degrees] in slow mechanisms, by the unit of the lift."""

FAST_ANGLE: Final = 60.0
"""The same in fast mechanisms, whatever the unit of the lift."""


def transmission_angle_limit(cam: Cam, limits: Limits) -> float:
    """Smallest transmission angle allowed [rad]: the stated one, or the default of Wirsig,
    section 2.4.

    The default is 60 degrees at any speed for translating followers, whose lift has the unit mm.
    For all others it is 45 degrees if the mechanism is slow or no speed is given, else 60 degrees.
    """
    if limits.transmission_angle is not None:
        return limits.transmission_angle
    slow = is_slow(cam.drive.speed)
    return math.radians(SLOW_ANGLES[cam.follower.lift_unit] if slow else FAST_ANGLE)


def check_radius_ratio(
    flank: WorkingCurve,
    name: str,
    bends: Extremes,
    limit: float | None,
    roller_radius: float | None = None,
) -> Finding:
    """Compare the roller radius with the smallest r_K that matters: r_R <= `limit` r_K (eq. 3.36).

    A `limit` of None reports the ratio without comparing it. `roller_radius` [mm] is that of a
    roller with play; None if the flank is the roller's envelope.
    """
    kappa, phi = _tightest(flank, bends)
    roller = abs(flank.distance) if roller_radius is None else roller_radius
    # r_R / r_K with the sign of curvature that matters: the inner flank, at a negative distance, is
    # endangered where the pitch curve is convex, kappa > 0, the outer one where it is concave.
    ratio = -math.copysign(roller, flank.distance) * kappa
    if roller == 0.0 or ratio <= 0.0:
        bend = "concave" if flank.distance < 0.0 else "convex"
        statement = f"{name} flank: the pitch curve is {bend} everywhere, so any roller fits"
        if roller == 0.0:
            statement = f"{name} flank: a knife edge, r_R = 0, fits any radius of curvature"
        return Finding(f"radius-ratio-{name}", "ok", statement, 0.0, limit)
    statement = (
        f"{name} flank: r_R/r_K = {ratio:.4f} (r_R {roller:g} mm, smallest r_K"
        f" {1 / abs(kappa):.4f} mm) {at_cam_angles(phi, form='.4f')}"
    )
    if limit is None:
        statement += ", without a limit, as the curved face is not a roller"
    return limit_finding(f"radius-ratio-{name}", statement, ratio, limit, cam_angle=phi)


def check_undercut(
    flank: WorkingCurve, name: str, bends: Extremes, severity: Severity = "no-disc"
) -> tuple[Finding, ...]:
    """Check a flank for cusps and local undercut, where 1 + d kappa is zero or negative.

    `severity` is reported for undercut: "no-disc" if undercut rules out a disc, else "broken".
    """
    kappa, phi = _tightest(flank, bends)
    margin = 1.0 + flank.distance * kappa
    if margin > CUSP:
        statement = f"{name} flank: no cusp and no local undercut"
        return (Finding(f"undercut-{name}", "ok", statement, margin, 0.0, cam_angle=phi),)
    if margin >= -CUSP:
        statement = (
            f"{name} flank: cusp {at_cam_angles(phi, form='.6f')}, {_distance_name(flank)}"
            f" equals the pitch curve's radius of curvature, {1 / abs(kappa):.6g} mm"
        )
        return (Finding(f"cusp-{name}", severity, statement, margin, 0.0, cam_angle=phi),)
    findings = []
    for start, end in undercut_ranges(flank, bends):
        span = end - start if end > start else end - start + TURN  # it may pass cam angle 0
        # Every range has an extreme; it may lie at a break that ends the range, whose angle has
        # been rounded differently.
        inside = np.flatnonzero((bends.phi - start + INSIDE) % TURN <= span + 2.0 * INSIDE)
        margins = 1.0 + flank.distance * bends.values[inside]
        worst = int(np.argmin(margins))
        value, place = float(margins[worst]), float(bends.phi[inside[worst]])
        statement = (
            f"{name} flank: undercut {cam_angle_range(start, end, '.6f')}, where the roller radius"
            " exceeds the pitch curve's radius of curvature: the follower would not make its motion"
        )
        what = f"undercut-{name}"
        findings.append(Finding(what, severity, statement, value, 0.0, "", place, (start, end)))
    return tuple(findings)


def _distance_name(flank: WorkingCurve) -> str:
    """The name of the flank's distance from the pitch curve, for a sentence."""
    played = abs(flank.distance) != flank.pitch.follower.roller_radius
    return "half the groove's width" if played else "the roller radius"


def _tightest(flank: WorkingCurve, bends: Extremes) -> tuple[float, float]:
    """The curvature [1/mm] of the pitch curve worst for the flank, and its cam angle [rad]."""
    return bends.largest() if flank.distance < 0.0 else bends.smallest()


# -- outline --------------------------------------------------------------------------------------
# Checks of what remains of a flank: global undercut, and the stroke lost on the real disc.


Range = tuple[float, float]
"""Cam angles [rad], the end below the start if the range passes cam angle 0."""


def check_outline(
    outline: Outline,
    name: str,
    undercut: list[Range],
    severity: Severity,
    kinks: Sequence[float] = (),
) -> tuple[Finding, ...]:
    """Report where the flank `name` is cut off in spite of its curvature, and lobes that fall off.

    Parameters
    ----------
    undercut : ranges of local undercut, which `check_undercut` reports.
    severity : reported for a flank that is cut off: "no-disc" if that rules out a disc, else
        "broken".
    kinks : cam angles [rad] at which the velocity jumps, which `check_closure` reports.
    """
    findings, crossing = [], f"global-undercut-{name}"
    known = np.array([*(start for start, _ in undercut), *kinks])
    for start, end in outline.dropped:
        # What is cut off about an undercut or a kink is reported with that already. All are
        # compared at once, as a noisy table has thousands of both.
        if np.any((known - start) % TURN <= end - start):
            continue
        width, where = math.degrees(end - start), (start, end % TURN)
        sentence = (
            f"{name} flank: cut off {cam_angle_range(start, end, '.6f')} though its radius of"
            " curvature suffices: two of its sides are closer than the roller is wide (global"
            " undercut)"
        )
        findings.append(Finding(crossing, severity, sentence, width, 0.0, "deg", start, where))
    for lobe in outline.lobes:
        size = abs(area(lobe))
        sentence = f"{name} flank: a lobe of {size:.6g} mm^2 is cut off and falls away"
        findings.append(Finding(f"lobe-{name}", severity, sentence, size, 0.0, "mm^2"))
    if not outline.is_trimmed:
        sentence = f"{name} flank: it does not cross itself"
        findings.append(Finding(crossing, "ok", sentence, 0.0, 0.0, "deg"))
    return tuple(findings)


def check_lost_stroke(replay: Replay, name: str, unit: LiftUnit, severity: Severity) -> Finding:
    """Report how much of its lift the follower loses on the real disc, with shocks and drops.

    `unit` is the unit of the lift.
    """
    loss = replay.largest_loss
    scale, display_unit = STATED[unit]
    value = scale * loss.value
    jumps = []
    if len(replay.shocks):
        jumps.append(counted(len(replay.shocks), "shock"))
    if len(replay.drops):
        jumps.append(counted(len(replay.drops), "drop") + " off an edge")
    statement = (
        f"{name} flank: on the real disc the follower loses up to {value:.4g} {display_unit} of its"
        f" lift, {at_cam_angles(loss.place, form='.6f')}"
    )
    if jumps:
        statement += f", with {' and '.join(jumps)}"
    return Finding(f"lost-stroke-{name}", severity, statement, value, 0.0, display_unit, loss.place)


# -- curved face ----------------------------------------------------------------------------------
# Checks of a curved face, of a mushroom or crowned tappet: its radius is stated as a roller's.
#
# The rule of thumb for r_R / r_K is one for rollers. A face far larger than its cam breaks it at
# rest already, and says nothing by it; as of a flat face it matters whether the cam is convex, and
# over which part of the face the contact runs. At the angle alpha of the common normal to the
# follower's path the contact is r_R sin alpha beside the middle of the face, tan alpha = sigma v /
# u with the rates u, v of `camgeo.kinematics.mechanism.follower`; on a guide to its right, looking
# away from the cam.


CURVED: Final = 0.9
"""Radius of a face, as a fraction of the base radius, above which it does not count as a roller: 9
times the radius of the cam's own base circle. Crowned tappets have more than 10 times that radius;
levers with curved pads, and rollers, have up to 4 times."""


def is_curved_face(cam: Cam, bends: Extremes) -> bool:
    """Whether the stated roller is in fact a curved face, whose centre is far from the cam, on a
    flank without cusp or undercut.
    """
    radius, base = cam.follower.roller_radius, cam.follower.base_radius
    curved = cam.contact.runs_inside and CURVED * base < radius < base
    return curved and radius * bends.largest()[0] < 1.0


def check_curved_face(curve: PitchCurve, bends: Extremes) -> tuple[Finding, ...]:
    """Check whether the cam is convex, and over which part of the face the contact runs."""
    radius = curve.follower.roller_radius
    tightest, phi = bends.largest()
    hollow, there = bends.smallest()
    # The flank is the parallel of the pitch curve at the radius of the face.
    value = 1.0 / tightest - radius if tightest > 0.0 else None
    sentence = "the cam has no convex part"
    if value is not None:
        sentence = f"smallest radius of curvature {value:.6g} mm {at_cam_angles(phi, form='.4f')}"
    if hollow < 0.0:
        place = at_cam_angles(there, form=".4f")
        sentence += (
            f"; the cam is hollow, with a radius of {radius - 1.0 / hollow:.6g} mm {place},"
            " larger than that of the face"
        )
    else:
        sentence += ": the cam is convex"
    return Finding("convexity", "ok", sentence, value, 0.0, "mm", phi), _contact_range(curve)


def _contact_range(curve: PitchCurve) -> Finding:
    """Over which part of a curved face the contact runs, as no limit applies to that."""

    def place(phi: FloatArray, side: Side) -> FloatArray:
        """(n,) position of the contact along the face [mm], from the middle of the face."""
        relative = curve.relative_jet(phi, side, order=1)
        sine = np.sign(relative.u) * relative.v / np.hypot(relative.u, relative.v)
        return np.asarray(curve.rotation * curve.follower.roller_radius * sine)

    ends = extremes(curve, place, SLOPES["roller"](curve))
    (low, at_low), (high, at_high) = ends.smallest(), ends.largest()
    first, last = (at_cam_angles(phi, form=".4f") for phi in (at_low, at_high))
    across = 2.0 * max(-low, high)
    sentence = (
        f"the contact runs along the curved face from {low:.6g} mm {first} to {high:.6g} mm"
        f" {last}, measured from its middle: a face of"
        f" {high - low:.6g} mm is needed, or of {across:.6g} mm in diameter if it rotates"
    )
    return Finding("face-length", "ok", sentence, high - low, unit="mm")


# -- face -----------------------------------------------------------------------------------------
# Checks of a flat face: whether a convex cam exists for it, how long it must be, and its lever.


ROUNDING = 1e-12
"""Rounding of the contact's position, as a fraction of the base radius."""


def check_convexity(curve: PitchCurve, severity: Severity = "no-disc") -> tuple[Finding, ...]:
    """Check that the cam of a flat face exists; with "no-disc" among the findings it does not.

    `severity` is reported for undercut: "no-disc" if undercut rules out a disc, else "broken".

    The smallest radius of curvature is always reported. Moving the face outward by D gives the
    parallel outline, whose radii are larger by D: so exactly that much more base radius, and on a
    rocker as much more face offset, supplies what is missing.
    """
    shape = convexity(curve)
    if shape.turn[0] <= 0.0:
        return (_turns_back(shape),)
    findings = [_radius(shape, flat_follower(curve.follower).raising_keys, severity)]
    if shape.jumps:
        findings.append(_jump(shape))
    if shape.clearance[0] <= SMALLEST * shape.size:
        findings.append(_face_over_axis(shape))
    return tuple(findings)


def _turns_back(shape: Convexity) -> Finding:
    turn, phi = shape.turn
    sentence = (
        f"the face turns back in the cam {place_text(phi)}: the rocker turns with"
        f" the cam, {1.0 - turn:.4g} times as fast, and no convex cam makes a flat face do that;"
        " give the move a larger span or a smaller swing"
    )
    return Finding("convexity", "no-disc", sentence, turn, 0.0, cam_angle=phi)


def _radius(shape: Convexity, sizes: tuple[str, ...], severity: Severity) -> Finding:
    radius, phi = shape.radius
    least = SMALLEST * shape.size
    place = place_text(phi)
    if radius > least:
        sentence = f"smallest radius of curvature {radius:.6g} mm {place}: the cam is convex"
        return Finding("convexity", "ok", sentence, radius, 0.0, "mm", phi)
    keys = " and ".join(sizes) + (" both" if len(sizes) > 1 else "")
    if radius >= -least:
        sentence = (
            f"the outline has a cusp {place}: its radius of curvature is 0 there; make {keys}"
            " a little larger"
        )
    else:
        sentence = (
            f"undercut, the radius of curvature falls to {radius:.6g} mm {place}: a flat face"
            f" touches only what is convex; make {keys} larger"
        )
    return Finding("convexity", severity, sentence, radius, 0.0, "mm", phi)


def _jump(shape: Convexity) -> Finding:
    length, phi = shape.jump
    others = f", the worst of {counted(shape.jumps, 'jump')}" if shape.jumps > 1 else ""
    which = (
        "back, against its direction along the outline"
        if length < 0.0
        else "ahead, over a straight part of the outline flush with the face"
    )
    sentence = (
        f"the velocity of the follower jumps {place_text(phi)}, and the contact by"
        f" {abs(length):.6g} mm along the face, {which}{others}; a flat face needs a motion without"
        " shocks"
    )
    return Finding("contact-jump", "no-disc", sentence, length, 0.0, "mm", phi)


def _face_over_axis(shape: Convexity) -> Finding:
    lowest, phi = shape.clearance
    sentence = (
        f"the face comes within {lowest:.6g} mm of the cam axis {place_text(phi)}: the"
        " cam does not go round its axis; make follower.base_radius larger"
    )
    return Finding("face-over-axis", "no-disc", sentence, lowest, 0.0, "mm", phi)


def place_text(phi: float) -> str:
    """The cam angle `phi` [rad] in words."""
    return at_cam_angles(phi, form=".4f")


def check_face(curve: PitchCurve, outline: Path) -> tuple[Finding, ...]:
    """Check which part of the face the contact runs over, and on a rocker whether it has a lever.

    `outline` is the real one, so the contact also rests on its corners. Positions along the face
    are measured as in `FlatFollower`.
    """
    follower = flat_follower(curve.follower)
    places, angles = contact_places(curve, outline)
    (low, at_low), (high, at_high) = (
        (float(places[k]), float(angles[k])) for k in (np.argmin(places), np.argmax(places))
    )
    sentence = (
        f"the contact runs along the face from {low:.6g} mm {place_text(at_low)} to"
        f" {high:.6g} mm at {cam_angle(at_high, '.4f')} deg, measured from the {follower.origin}: a"
        f" face of {high - low:.6g} mm is needed"
    )
    length_finding = Finding("face-length", "ok", sentence, high - low, unit="mm")
    slack = ROUNDING * follower.base_radius
    face = follower.face
    if face is not None:
        sentence += f"; it reaches from {face[0]:g} to {face[1]:g} mm"
        # The end of the face that the contact passes farthest, or comes closest to.
        short, place, end, phi = max(
            (high - face[1], high, face[1], at_high), (face[0] - low, low, face[0], at_low)
        )
        severity: Severity = "ok"
        if short > slack:
            severity = "broken"
            sentence += f", {short:.6g} mm too short there"
        length_finding = Finding("face-length", severity, sentence, place, end, "mm", phi)
    if low > follower.least_place + slack:
        return (length_finding,)
    statement = (
        f"the contact reaches the pivot's foot on the face ({low:.6g} mm"
        f" {place_text(at_low)}): it has no lever about the pivot there, and the cam cannot move"
        " the rocker any further"
    )
    return length_finding, Finding("contact-lever", "broken", statement, low, 0.0, "mm", at_low)


# -- standstill -----------------------------------------------------------------------------------
# Check that the roller centre never stands still in the turning cam.


STANDSTILL_SHARE = math.sqrt(STANDSTILL)
"""Smallest |Z'| as a fraction of the base radius per rad; below it the curvature has no digits."""


def least_speed(pitch: PitchCurve) -> float:
    """A lower bound of |Z'| [mm/rad] over the turn; negative where the cells are too wide to tell.

    |Z'| changes over half a cell of width 2 h by at most h |Z''| + h^2/2 max |Z'''|.
    """
    low, high = turn_cells(pitch)
    half = 0.5 * (high - low)
    jet, (_, _, third) = turn_enclosed(pitch)
    return float(np.min(np.abs(jet[1]) - half * (np.abs(jet[2]) + 0.5 * half * third)))


def check_standstill(curve: PitchCurve) -> tuple[Finding, ...]:
    """Report that there is no disc if |Z'| vanishes anywhere; nothing if it does not."""
    limit = STANDSTILL_SHARE * curve.follower.base_radius
    # The bound needs no search and decides nearly all designs.
    if least_speed(curve) > limit:
        return ()

    def square(phi: FloatArray, side: Side) -> FloatArray:
        relative = curve.relative_jet(phi, side, order=1)
        return np.asarray(relative.u**2 + relative.v**2)

    def slope(phi: FloatArray, side: Side) -> FloatArray:
        relative = curve.relative_jet(phi, side, order=2)
        # Half the slope, which has the same roots.
        (_, a1, a2), (_, b1, b2) = relative.along, relative.across
        return np.asarray(a1 * a2 + b1 * b2)

    smallest, phi = extremes(curve, square, slope).smallest()
    speed = math.sqrt(smallest)
    if speed > limit:
        return ()
    statement = (
        f"the roller centre stands still in the turning cam {at_cam_angles(phi, form='.6f')}"
        " (Z' = 0): the pitch curve has a cusp and no normal; the rocker lies on the line of"
        " centres and l_3 (1 - sigma psi') = l_1"
    )
    return (Finding("standstill", "no-disc", statement, speed, limit, "mm/rad", phi),)


# -- transmission angle ---------------------------------------------------------------------------
# Check of the smallest transmission angle.


@kept_with_each
def transmission_angle_extremes(curves: Sequence[PitchCurve]) -> list[Extremes]:
    """All local extremes of the transmission angle [rad] of each curve; Z' must not vanish.

    The curves must have the same motion and sense of rotation, and followers that are `alike`.
    """
    first, many = curves[0], curves_together(curves)
    return extremes_of_members(
        first, many, lambda curve: curve.transmission_angle, SLOPES[first.follower.touching]
    )


def _roller_angle_slopes(curve: PitchCurve) -> Quantity:
    """A function of the cam angle that vanishes where the transmission angle of a roller can be
    extreme.
    """

    def slopes(phi: FloatArray, side: Side) -> FloatArray:
        """(3, n) rows that vanish where the angle has slope 0, where it is 0, and where it is 90
        degrees: at the last two its magnitude has a kink.
        """
        motion = curve.motion.jet(phi, side)
        tangent = curve.follower.tangent_jet(motion, curve.rotation)
        turning = tangent.u[0] * tangent.w[1] - tangent.w[0] * tangent.u[1]
        relative = curve.follower.relative_jet(motion, curve.rotation, 1)
        return np.stack((turning, relative.u, relative.v))

    return slopes


def _face_angle_slope(curve: PitchCurve) -> Quantity:
    """Slope of the angle at a flat face, which depends on the place of contact alone."""
    return lambda phi, side: touch(curve, phi, side).contact


SLOPES: Final = {"roller": _roller_angle_slopes, "face": _face_angle_slope}
"""What vanishes at extremes of the transmission angle, by what touches the cam."""


def check_transmission_angle(curve: PitchCurve, limit: float) -> Finding:
    """Compare the smallest transmission angle with `limit` [rad]."""
    smallest, phi = transmission_angle_extremes(curve).smallest()
    value, bound = math.degrees(smallest), math.degrees(limit)
    place = at_cam_angles(phi, form=".4f")
    statement = f"smallest transmission angle {value:.4f} deg {place}"
    return limit_finding("transmission-angle", statement, value, bound, "deg", phi, least=True)


# -- side clearance -------------------------------------------------------------------------------
# How far the play of a roller in its groove lets the follower deviate from its motion.


def largest_deviation(curve: PitchCurve, clearance: float) -> tuple[float, float]:
    """Largest deviation of the lift to either side [mm or rad], and its cam angle [rad].

    With half the `clearance` c [mm] on each side the roller centre may be c/2 from the pitch
    curve along its normal, which is (c/2)/|dn/dq| of lift, to first order in c. The leverage
    |dn/dq| is sin mu, or l_3 sin mu for a rocker, so it is smallest where the transmission angle
    mu is. Infinite where mu is 0.
    """
    angle, phi = transmission_angle_extremes(curve).smallest()
    lever = abs(curve.follower.reach) * math.sin(angle)
    return (0.5 * clearance / lever if lever > 0.0 else math.inf), phi


def check_side_clearance(curve: PitchCurve, clearance: float) -> Finding:
    """Report what the side clearance [mm] amounts to as lift at its worst; Z' must not vanish.

    There is no limit: how much play is acceptable is not a matter of geometry.
    """
    deviation, phi = largest_deviation(curve, clearance)
    scale, unit = STATED[curve.follower.lift_unit]
    who = curve.follower.mover
    place = at_cam_angles(phi, form=".4f")
    head = f"side clearance {clearance:g} mm: the play lets the {who} deviate from its motion by"
    value = None if math.isinf(deviation) else scale * deviation
    if value is None:
        sentence = f"{head} any amount {place}, where the transmission angle is 0"
    else:
        sentence = f"{head} up to ±{value:.4g} {unit}, {place}"
    return Finding("side-clearance", "ok", sentence, value, unit=unit, cam_angle=phi)


# -- closure --------------------------------------------------------------------------------------
# Checks of how the pitch curve joins at its breaks and after a full turn.


POINT_LIMIT = 1e-12
"""Largest gap as a fraction of the base radius: four hundred times the rounding of the curve."""

TANGENT_LIMIT = 1e-9
"""Largest angle between the tangents at a joint [rad]."""


def check_closure(curve: PitchCurve, severity: Severity = "no-disc") -> tuple[Finding, ...]:
    """Check that the pitch curve and its tangent are continuous at all joints, and close.

    `severity` is reported for a corner of the pitch curve: "no-disc" if that rules out a disc, else
    "broken".
    """
    join = joints(curve)
    # Rounding grows with the size of the curve's coordinates, not only with its base circle.
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
