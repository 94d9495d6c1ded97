"""Check of a flat face: how long it has to be, and whether the contact keeps its lever."""

from __future__ import annotations

from camgeo.check.convexity import degrees
from camgeo.check.finding import Finding, Severity
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
    told = (
        f"the contact comes to the pivot's foot on the face ({low:.6g} mm at cam angle"
        f" {degrees(at_low)} deg): it has no lever about the pivot there, and the cam cannot move"
        " the rocker on"
    )
    return found, Finding("contact-lever", "broken", told, low, 0.0, "mm", at_low)
