"""Checks of how the motion and the curve join at the breaks and after one turn."""

from __future__ import annotations

import math

import numpy as np

from camgeo.check.finding import Finding
from camgeo.curve.closure import joints
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.units import TURN

POINT_LIMIT = 1e-12
"""Largest gap as a share of the base radius: four hundred times the rounding of the curve."""

TANGENT_LIMIT = 1e-9
"""Largest angle between the tangents at a joint [rad]."""


def check_closure(curve: PitchCurve) -> tuple[Finding, ...]:
    """Closure of curve and tangent; shocks (jumps of s') and jerks (jumps of s'')."""
    join = joints(curve)
    limit = POINT_LIMIT * (
        curve.follower.base_radius + float(np.max(np.abs(curve.point(join.phi))))
    )
    gap, turn = int(np.argmax(join.gaps)), int(np.argmax(join.turns))
    open_point = join.gaps[gap] > limit
    open_tangent = join.turns[turn] > TANGENT_LIMIT
    shock = ", a shock: the velocity of the follower jumps" if open_tangent else ""
    found = [
        Finding(
            name="closure",
            severity="fatal" if open_point else "ok",
            sentence=f"largest gap of the pitch curve at a joint {join.gaps[gap]:.2g} mm",
            value=float(join.gaps[gap]),
            limit=limit,
            unit="mm",
            cam_angle=float(join.phi[gap]),
        ),
        Finding(
            name="tangent-closure",
            severity="fatal" if open_tangent else "ok",
            sentence=(
                "largest angle between the tangents at a joint"
                f" {math.degrees(join.turns[turn]):.2g} deg at cam angle"
                f" {math.degrees(join.phi[turn]):.6g} deg{shock}"
            ),
            value=math.degrees(join.turns[turn]),
            limit=math.degrees(TANGENT_LIMIT),
            unit="deg",
            cam_angle=float(join.phi[turn]),
        ),
    ]
    jumps = np.abs(join.acceleration_jumps)
    scale = _acceleration(curve)
    worst = int(np.argmax(jumps))
    if jumps[worst] > TANGENT_LIMIT * max(scale, 1e-300):
        found.append(
            Finding(
                name="jerk",
                severity="warning",
                sentence=(
                    f"the acceleration jumps by {jumps[worst]:.4g} (per rad^2) at cam angle"
                    f" {math.degrees(join.phi[worst]):.6g} deg"
                ),
                value=float(jumps[worst]),
                cam_angle=float(join.phi[worst]),
            )
        )
    return tuple(found)


def _acceleration(curve: PitchCurve) -> float:
    """Size of s'', by which its jumps are rounding or not [mm or rad, per rad^2].

    Sampled inside the pieces: at their ends it may vanish, and its rounding would count as a jump.
    """
    starts = curve.borders
    if not len(starts):
        return 0.0
    lengths = np.diff(np.append(starts, starts[0] + TURN))
    phi = np.concatenate([starts + share * lengths for share in (0.0, 0.25, 0.5, 0.75)])
    return float(np.max(np.abs(curve.motion.jet(phi)[2])))
