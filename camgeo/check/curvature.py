"""Checks of the curvature of a flank in use: roller radius against r_K, cusp, local undercut.

All of them read 1 + d kappa of the flank, d = -r_R for the inner, +r_R for the outer working
curve: 1 minus that is r_R / r_K for the sign of curvature that matters, at most 0.7 by the rule of
thumb (Wirsig eq. 3.36); 1 is a cusp, more is undercut. The flanks of a groove with side clearance
c lie at d = -+(r_R + c/2): cusp and undercut follow from that d, the rule of thumb from the roller.
"""

from __future__ import annotations

import math

import numpy as np

from camgeo.check.finding import Finding, Severity, held
from camgeo.curve.extremes import Extremes
from camgeo.curve.working_curve import WorkingCurve
from camgeo.outline.cusps import CUSP, INSIDE, undercut_ranges
from camgeo.units import TURN
from camgeo.wording import at_cam_angles, over_cam_angles


def check_radius_ratio(
    flank: WorkingCurve,
    name: str,
    bends: Extremes,
    limit: float | None,
    roller_radius: float | None = None,
) -> Finding:
    """Compare the roller radius with the smallest r_K that matters: r_R <= `limit` r_K (eq. 3.36);
    with nothing if that is None.

    `roller_radius` [mm] is that of a roller with play; None if the flank is its envelope.
    """
    kappa, phi = _tightest(flank, bends)
    roller = abs(flank.distance) if roller_radius is None else roller_radius
    ratio = -math.copysign(roller, flank.distance) * kappa
    if roller == 0.0 or ratio <= 0.0:
        bend = "concave" if flank.distance < 0.0 else "convex"
        statement = f"{name} flank: the pitch curve is {bend} everywhere, any roller fits"
        if roller == 0.0:
            statement = f"{name} flank: a knife edge, r_R = 0, fits any radius of curvature"
        return Finding(f"radius-ratio-{name}", "ok", statement, 0.0, limit)
    statement = (
        f"{name} flank: r_R/r_K = {ratio:.4f} (r_R {roller:g} mm, smallest r_K"
        f" {1 / abs(kappa):.4f} mm) {at_cam_angles(phi, form='.4f')}"
    )
    if limit is None:
        statement += ", without a limit: the face is no roller's"
    return held(f"radius-ratio-{name}", statement, ratio, limit, cam_angle=phi)


def check_undercut(
    flank: WorkingCurve, name: str, bends: Extremes, severity: Severity = "no-disc"
) -> tuple[Finding, ...]:
    """Cusps and local undercut of a flank: where 1 + d kappa is zero or negative.

    `severity` is that of undercut: "no-disc" if no disc is made then, else "broken".
    """
    kappa, phi = _tightest(flank, bends)
    margin = 1.0 + flank.distance * kappa
    if margin > CUSP:
        statement = f"{name} flank: no cusp and no local undercut"
        return (Finding(f"undercut-{name}", "ok", statement, margin, 0.0, cam_angle=phi),)
    if margin >= -CUSP:
        statement = (
            f"{name} flank: cusp {at_cam_angles(phi, form='.6f')}, {_what(flank)}"
            f" equals the pitch curve's radius of curvature, {1 / abs(kappa):.6g} mm"
        )
        return (Finding(f"cusp-{name}", severity, statement, margin, 0.0, cam_angle=phi),)
    found = []
    for start, end in undercut_ranges(flank, bends):
        span = end - start if end > start else end - start + TURN
        # Every range has an extreme; it may lie at a break that ends the range, whose angle has
        # been rounded differently.
        inside = np.flatnonzero((bends.phi - start + INSIDE) % TURN <= span + 2.0 * INSIDE)
        margins = 1.0 + flank.distance * bends.values[inside]
        worst = int(np.argmin(margins))
        value, place = float(margins[worst]), float(bends.phi[inside[worst]])
        statement = (
            f"{name} flank: undercut {over_cam_angles(start, end, '.6f')}, the roller is larger"
            " than the radius of curvature of the pitch curve; the follower would not make its"
            " motion"
        )
        what = f"undercut-{name}"
        found.append(Finding(what, severity, statement, value, 0.0, "", place, (start, end)))
    return tuple(found)


def _what(flank: WorkingCurve) -> str:
    """What the flank's distance from the pitch curve is called."""
    played = abs(flank.distance) != flank.pitch.follower.roller_radius
    return "half the groove's width" if played else "the roller radius"


def _tightest(flank: WorkingCurve, bends: Extremes) -> tuple[float, float]:
    """The curvature [1/mm] worst for the flank, and its cam angle."""
    return bends.largest() if flank.distance < 0.0 else bends.smallest()
