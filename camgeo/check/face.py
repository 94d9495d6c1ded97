"""Check of a flat face: how long it has to be, and whether the contact keeps its lever."""

from __future__ import annotations

from camgeo.check.convexity import degrees
from camgeo.check.finding import Finding
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.mechanism.face import flat_follower
from camgeo.outline.convex import contact_extremes

ROUNDING = 1e-12
"""Rounding of the contact's place, as a share of the base radius."""


def check_face(curve: PitchCurve) -> tuple[Finding, ...]:
    """The stretch of the face that the contact runs over; on a rocker also that it has a lever.

    The cam must be convex. Places are counted along the face as `FlatFollower` counts them.
    """
    follower = flat_follower(curve.follower)
    places = contact_extremes(curve)
    (low, at_low), (high, at_high) = places.smallest(), places.largest()
    sentence = (
        f"the contact runs along the face from {low:.6g} mm at cam angle {degrees(at_low)} deg to"
        f" {high:.6g} mm at {degrees(at_high)} deg, counted from the {follower.origin}: a face of"
        f" {high - low:.6g} mm is needed"
    )
    found = []
    slack = ROUNDING * follower.base_radius
    face = follower.face
    if face is None:
        found.append(Finding("face-length", "ok", sentence, high - low, unit="mm"))
    else:
        short_of = face[0] - low, high - face[1]
        worst = 0 if short_of[0] > short_of[1] else 1
        broken = short_of[worst] > slack
        value, phi = (low, at_low) if worst == 0 else (high, at_high)
        has = f"; it reaches from {face[0]:g} to {face[1]:g} mm"
        short = f", {short_of[worst]:.6g} mm too short there" if broken else ""
        found.append(
            Finding(
                name="face-length",
                severity="broken" if broken else "ok",
                sentence=sentence + has + short,
                value=value,
                limit=face[worst],
                unit="mm",
                cam_angle=phi,
            )
        )
    if low <= follower.least_place + slack:
        found.append(
            Finding(
                name="contact-lever",
                severity="broken",
                sentence=(
                    f"the contact comes to the pivot's foot on the face ({low:.6g} mm at cam angle"
                    f" {degrees(at_low)} deg): it has no lever about the pivot there, and the cam"
                    " cannot move the rocker on"
                ),
                value=low,
                limit=0.0,
                unit="mm",
                cam_angle=at_low,
            )
        )
    return tuple(found)
