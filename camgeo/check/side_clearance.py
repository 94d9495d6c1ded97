"""How far the play of a roller in its groove lets the follower deviate from its motion."""

from __future__ import annotations

import math

from camgeo.check.finding import TOLD, Finding
from camgeo.check.transmission_angle import transmission_angle_extremes
from camgeo.curve.pitch_curve import PitchCurve


def largest_deviation(curve: PitchCurve, clearance: float) -> tuple[float, float]:
    """Largest deviation of the lift to either side [mm or rad], and its cam angle [rad].

    With half the `clearance` c [mm] on each side the roller centre may be c/2 off the pitch curve
    along its normal, which is (c/2)/|dn/dq| of lift, to first order in c. |dn/dq|, the leverage,
    is sin mu, or l_3 sin mu for a rocker, so that it is least with the transmission angle mu.
    Infinite where mu is 0.
    """
    angle, phi = transmission_angle_extremes(curve).smallest()
    lever = abs(curve.follower.reach) * math.sin(angle)
    return (0.5 * clearance / lever if lever > 0.0 else math.inf), phi


def check_side_clearance(curve: PitchCurve, clearance: float) -> Finding:
    """Tell what the side clearance [mm] comes to as lift, worst over the turn; Z' must not vanish.

    Nothing is held to a limit: how much play is good is not a matter of geometry.
    """
    deviation, phi = largest_deviation(curve, clearance)
    scale, unit = TOLD[curve.follower.lift_unit]
    who = curve.follower.mover
    place = f"at cam angle {math.degrees(phi):.4f} deg"
    head = f"side clearance {clearance:g} mm: the play lets the {who} deviate from its motion by"
    value = None if math.isinf(deviation) else scale * deviation
    if value is None:
        sentence = f"{head} any amount {place}, where the transmission angle is 0"
    else:
        sentence = f"{head} up to ±{value:.4g} {unit}, {place}"
    return Finding("side-clearance", "ok", sentence, value, unit=unit, cam_angle=phi)
