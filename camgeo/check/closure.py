"""Checks of how the pitch curve joins at the breaks and after one turn."""

from __future__ import annotations

import math

import numpy as np

from camgeo.check.finding import Finding, Severity
from camgeo.curve.closure import joints
from camgeo.curve.pitch_curve import PitchCurve

POINT_LIMIT = 1e-12
"""Largest gap as a share of the base radius: four hundred times the rounding of the curve."""

TANGENT_LIMIT = 1e-9
"""Largest angle between the tangents at a joint [rad]."""


def check_closure(curve: PitchCurve, severity: Severity = "fatal") -> tuple[Finding, ...]:
    """Closure of the pitch curve and of its tangent.

    `severity` is that of a corner of the pitch curve: "fatal" if no disc is made of it, else
    "broken".
    """
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
            severity=severity if open_tangent else "ok",
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
    return tuple(found)
