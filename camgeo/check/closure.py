"""Checks of how the pitch curve joins at its breaks and after a full turn."""

from __future__ import annotations

import math

import numpy as np

from camgeo.check.finding import Finding, Severity
from camgeo.curve.closure import joints
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.numeric.rounding import resolved
from camgeo.wording import at_cam_angles

POINT_LIMIT = 1e-12
"""Largest gap as a fraction of the base radius: four hundred times the rounding of the curve."""

TANGENT_LIMIT = 1e-9
"""Largest angle between the tangents at a joint [rad]."""


def check_closure(curve: PitchCurve, severity: Severity = "no-disc") -> tuple[Finding, ...]:
    """Closure of the pitch curve and of its tangent.

    `severity` is that of a corner in the pitch curve: "no-disc" if no disc is made then, else
    "broken".
    """
    join = joints(curve)
    limit = POINT_LIMIT * (
        curve.follower.base_radius + float(np.max(np.abs(curve.point(join.phi))))
    )
    at_gap, at_turn = int(np.argmax(join.gaps)), int(np.argmax(join.turns))
    gap = float(join.gaps[at_gap])
    turn = math.degrees(resolved(float(join.turns[at_turn]), 1.0))
    place = float(join.phi[at_turn])
    statement = f"largest gap of the pitch curve at a joint {gap:.2g} mm"
    turned = f"largest angle between the tangents at a joint {turn:.2g} deg {at_cam_angles(place)}"
    corner: Severity = "ok"
    if join.turns[at_turn] > TANGENT_LIMIT:
        corner = severity
        turned += ", a shock: the velocity of the follower jumps"
    closed: Severity = "no-disc" if gap > limit else "ok"
    most = math.degrees(TANGENT_LIMIT)
    return (
        Finding("closure", closed, statement, gap, limit, "mm", float(join.phi[at_gap])),
        Finding("tangent-closure", corner, turned, turn, most, "deg", place),
    )
