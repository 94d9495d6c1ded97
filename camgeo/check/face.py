"""Checks of a flat face: whether a convex cam exists for it, how long it must be, and its lever."""

from __future__ import annotations

import numpy as np

from camgeo.check.finding import Finding, Severity
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.mechanism.face import flat_follower
from camgeo.outline.convex import SMALLEST, Convexity, convexity
from camgeo.outline.face_lift import contact_places
from camgeo.outline.path import Path
from camgeo.wording import at_cam_angles, cam_angle, counted

ROUNDING = 1e-12
"""Rounding of the contact's position, as a fraction of the base radius."""


def check_convexity(curve: PitchCurve, severity: Severity = "no-disc") -> tuple[Finding, ...]:
    """Findings of a flat follower's cam; with "no-disc" among them there is no such cam.

    `severity` is that of undercut: "no-disc" if no disc is made then, else "broken".

    The smallest radius of curvature is always reported. Moving the face outward by D gives the
    parallel outline, whose radii are larger by D: so exactly that much more base radius, and on a
    rocker as much more face offset, supplies what is missing.
    """
    found = convexity(curve)
    if found.turn[0] <= 0.0:
        return (_turns_back(found),)
    findings = [_radius(found, flat_follower(curve.follower).raised_by, severity)]
    if found.jumps:
        findings.append(_jump(found))
    if found.clearance[0] <= SMALLEST * found.size:
        findings.append(_over_axis(found))
    return tuple(findings)


def _turns_back(found: Convexity) -> Finding:
    turn, phi = found.turn
    sentence = (
        f"the face turns back in the cam {at(phi)}: the rocker turns with"
        f" the cam, {1.0 - turn:.4g} times as fast, and no convex cam makes a flat face do that;"
        " give the move a larger span or a smaller swing"
    )
    return Finding("convexity", "no-disc", sentence, turn, 0.0, cam_angle=phi)


def _radius(found: Convexity, sizes: tuple[str, ...], severity: Severity) -> Finding:
    radius, phi = found.radius
    least = SMALLEST * found.size
    place = at(phi)
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


def is_undercut(found: Finding) -> bool:
    """Whether a finding of `check_convexity` is that a face undercuts, or just does not."""
    return found.name == "convexity" and found.unit == "mm" and found.severity != "ok"


def _jump(found: Convexity) -> Finding:
    length, phi = found.jump
    others = f", the worst of {counted(found.jumps, 'jump')}" if found.jumps > 1 else ""
    which = (
        "back, against its direction along the outline"
        if length < 0.0
        else "ahead, over a straight part of the outline flush with the face"
    )
    sentence = (
        f"the velocity of the follower jumps {at(phi)}, and the contact by"
        f" {abs(length):.6g} mm along the face, {which}{others}; a flat face needs a motion without"
        " shocks"
    )
    return Finding("contact-jump", "no-disc", sentence, length, 0.0, "mm", phi)


def _over_axis(found: Convexity) -> Finding:
    lowest, phi = found.clearance
    sentence = (
        f"the face comes within {lowest:.6g} mm of the cam axis {at(phi)}: the"
        " cam does not go round its axis; make follower.base_radius larger"
    )
    return Finding("face-over-axis", "no-disc", sentence, lowest, 0.0, "mm", phi)


def at(phi: float) -> str:
    """The place `phi` [rad] in words."""
    return at_cam_angles(phi, form=".4f")


def check_face(curve: PitchCurve, outline: Path) -> tuple[Finding, ...]:
    """The part of the face that the contact runs over; on a rocker, also whether it has a lever.

    The contact is that with `outline`, the real one: over its corners too. Positions along the face
    are measured as in `FlatFollower`.
    """
    follower = flat_follower(curve.follower)
    places, angles = contact_places(curve, outline)
    (low, at_low), (high, at_high) = (
        (float(places[k]), float(angles[k])) for k in (np.argmin(places), np.argmax(places))
    )
    sentence = (
        f"the contact runs along the face from {low:.6g} mm {at(at_low)} to"
        f" {high:.6g} mm at {cam_angle(at_high, '.4f')} deg, measured from the {follower.origin}: a"
        f" face of {high - low:.6g} mm is needed"
    )
    found = Finding("face-length", "ok", sentence, high - low, unit="mm")
    slack = ROUNDING * follower.base_radius
    face = follower.face
    if face is not None:
        sentence += f"; it reaches from {face[0]:g} to {face[1]:g} mm"
        short, place, end, phi = max(
            (high - face[1], high, face[1], at_high), (face[0] - low, low, face[0], at_low)
        )
        severity: Severity = "ok"
        if short > slack:
            severity = "broken"
            sentence += f", {short:.6g} mm too short there"
        found = Finding("face-length", severity, sentence, place, end, "mm", phi)
    if low > follower.least_place + slack:
        return (found,)
    statement = (
        f"the contact reaches the pivot's foot on the face ({low:.6g} mm"
        f" {at(at_low)}): it has no lever about the pivot there, and the cam cannot move"
        " the rocker any further"
    )
    return found, Finding("contact-lever", "broken", statement, low, 0.0, "mm", at_low)
