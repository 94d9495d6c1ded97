"""How far the play of a roller in its groove lets the follower deviate from its motion."""

from __future__ import annotations

import math

from camgeo.check.finding import STATED, Finding
from camgeo.check.transmission_angle import transmission_angle_extremes
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.wording import at_cam_angles


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
