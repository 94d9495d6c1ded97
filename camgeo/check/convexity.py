"""Check that a flat face can touch the cam: convex all round, and the cam axis inside."""

from __future__ import annotations

import math

from camgeo.check.finding import Finding
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.mechanism.face import flat_follower
from camgeo.outline.convex import SMALLEST, Convexity, convexity


def check_convexity(curve: PitchCurve) -> tuple[Finding, ...]:
    """Findings of a flat follower's cam; with a fatal one among them there is no such cam.

    The smallest radius of curvature is told in any case. An outline whose face lies D farther from
    the cam axis throughout is the parallel of this one, and has radii larger by D: so much more
    base radius, and for a rocker as much more face offset, mends what is missing, exactly.
    """
    found = convexity(curve)
    if found.turn[0] <= 0.0:
        return (_turns_back(found),)
    findings = [_radius(found, flat_follower(curve.follower).raised_by)]
    if found.jumps:
        findings.append(_jump(found))
    if found.lowest <= SMALLEST * found.size:
        findings.append(_over_axis(found))
    return tuple(findings)


def _turns_back(found: Convexity) -> Finding:
    turn, phi = found.turn
    return Finding(
        name="convexity",
        severity="fatal",
        sentence=(
            f"the face turns back in the cam at cam angle {degrees(phi)} deg: the rocker turns"
            f" with the cam and {1.0 - turn:.4g} times as fast, and no convex cam makes a flat face"
            " do that; give the move a larger span or a smaller swing"
        ),
        value=turn,
        limit=0.0,
        cam_angle=phi,
    )


def _radius(found: Convexity, sizes: tuple[str, ...]) -> Finding:
    radius, phi = found.radius
    least = SMALLEST * found.size
    place = f"at cam angle {degrees(phi)} deg"
    if radius > least:
        sentence = f"smallest radius of curvature {radius:.6g} mm {place}: the cam is convex"
    else:
        what = (
            f"the outline has a cusp {place}: its radius of curvature is 0 there"
            if radius >= -least
            else f"undercut, the radius of curvature falls to {radius:.6g} mm {place}: a flat face"
            " touches only what is convex"
        )
        keys = " and ".join(sizes) + (" both" if len(sizes) > 1 else "")
        missing = f"by more than {max(-radius, 0.0):.6g} mm" if radius < -least else "a little"
        sentence = f"{what}; make {keys} larger {missing}"
    return Finding(
        name="convexity",
        severity="ok" if radius > least else "fatal",
        sentence=sentence,
        value=radius,
        limit=0.0,
        unit="mm",
        cam_angle=phi,
    )


def _jump(found: Convexity) -> Finding:
    length, phi = found.jump
    others = f", the worst of {found.jumps} jumps" if found.jumps > 1 else ""
    which = (
        "back, against the way in which it runs along the outline"
        if length < 0.0
        else "ahead, over a straight stretch that would be flush with it"
    )
    return Finding(
        name="contact-jump",
        severity="fatal",
        sentence=(
            f"the velocity of the follower jumps at cam angle {degrees(phi)} deg, and the contact"
            f" by {abs(length):.6g} mm along the face, {which}{others}; a flat face needs a motion"
            " without shocks"
        ),
        value=length,
        limit=0.0,
        unit="mm",
        cam_angle=phi,
    )


def _over_axis(found: Convexity) -> Finding:
    lowest, phi = found.clearance
    return Finding(
        name="face-over-axis",
        severity="fatal",
        sentence=(
            f"the face comes as near as {lowest:.6g} mm to the cam axis at cam angle"
            f" {degrees(phi)} deg: the cam does not go round its axis; make follower.base_radius"
            " larger"
        ),
        value=lowest,
        limit=0.0,
        unit="mm",
        cam_angle=phi,
    )


def degrees(angle: float) -> str:
    """A cam angle [rad] in words."""
    return f"{math.degrees(angle):.4f}"
