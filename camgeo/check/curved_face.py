"""Checks of a curved face, of a mushroom or crowned tappet: its radius is stated as a roller's.

The rule of thumb for r_R / r_K is one for rollers. A face far larger than its cam breaks it at rest
already, and says nothing by it; as of a flat face it matters whether the cam is convex, and over
which part of the face the contact runs. At the angle alpha of the common normal to the follower's
path the contact is r_R sin alpha beside the middle of the face, tan alpha = sigma v / u with the
rates u, v of `camgeo.mechanism.follower`; on a guide to its right, looking away from the cam.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from camgeo.cam.cam import Cam
from camgeo.check.finding import Finding
from camgeo.check.transmission_angle import SLOPES
from camgeo.curve.extremes import Extremes, extremes
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.wording import at_cam_angles

CURVED: Final = 0.9
"""Radius of a face, in base radii, from which on it is no roller's: 9 times the cam's base circle.
Crowned tappets have more than 10 times; levers with curved pads, and rollers, up to 4 times."""


def is_curved_face(cam: Cam, bends: Extremes) -> bool:
    """Whether what is stated as a roller is a face curved about a centre far from the cam, on a
    flank without cusp or undercut.
    """
    radius, base = cam.follower.roller_radius, cam.follower.base_radius
    curved = cam.contact.runs_inside and CURVED * base < radius < base
    return curved and radius * bends.largest()[0] < 1.0


def check_curved_face(curve: PitchCurve, bends: Extremes) -> tuple[Finding, ...]:
    """Whether the cam is convex, and over which part of the face the contact runs."""
    radius = curve.follower.roller_radius
    tightest, phi = bends.largest()
    hollow, there = bends.smallest()
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
    return Finding("convexity", "ok", sentence, value, 0.0, "mm", phi), _run(curve)


def _run(curve: PitchCurve) -> Finding:
    def place(phi: FloatArray, side: Side) -> FloatArray:
        """(n,) of the contact along the face [mm], from its middle."""
        relative = curve.relative_jet(phi, side, order=1)
        sine = np.sign(relative.u) * relative.v / np.hypot(relative.u, relative.v)
        return np.asarray(curve.rotation * curve.follower.roller_radius * sine)

    found = extremes(curve, place, SLOPES["roller"](curve))
    (low, at_low), (high, at_high) = found.smallest(), found.largest()
    first, last = (at_cam_angles(each, form=".4f") for each in (at_low, at_high))
    across = 2.0 * max(-low, high)
    sentence = (
        f"the contact runs along the curved face from {low:.6g} mm {first} to {high:.6g} mm"
        f" {last}, measured from its middle: a face of"
        f" {high - low:.6g} mm is needed, and one of {across:.6g} mm in diameter if it turns"
    )
    return Finding("face-length", "ok", sentence, high - low, unit="mm")
