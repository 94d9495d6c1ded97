"""Load: the process force over the cam angle.

The load F acts against a positive demanded motion s, so its generalised force on the follower is Q
= -F ds/dq by virtual work, which is -F where the follower itself has the demanded motion. On a
rotating member, a rocker without a linkage or the lever or crank at the far end of one, the load is
a torque against its positive angle.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from camgeo.dynamics.effects.effect import Column, Request
from camgeo.dynamics.effects.forces import Force, output_per_follower, refuse_locked, unmoved
from camgeo.dynamics.effects.results import Acting
from camgeo.dynamics.effects.tables import LoadProfile
from camgeo.dynamics.effects.wording import extreme_findings
from camgeo.errors import GeometryError
from camgeo.kinematics.plan import SNAP, MotionPlan, in_turn
from camgeo.numeric.arrays import FloatArray, Side, frozen, merged
from camgeo.numeric.extremes import piecewise_extremes

N_MM: Final = 1e3
"""Factor from N m to N mm."""


def compute(request: Request[LoadProfile | Sequence[float]]) -> Acting:
    """The load in `request.data`, c0 alone.

    Raises
    ------
    GeometryError
        With the key, see `load_profile`.
    EffectError
        If the follower cannot move the far end of its linkage, on which the load acts, at some cam
        angle.
    """
    subject = request.subject
    is_torque = subject.drive.unit == "rad"
    unit = "N m" if is_torque else "N"
    course = load_profile(request.data, subject.drive.plan, unit)
    scale = N_MM if is_torque else 1.0
    refuse_locked(subject, " against its load")

    def on_member(phi: FloatArray, side: Side) -> FloatArray:
        return np.asarray(-scale * course.values(phi, side))

    def on_follower(phi: FloatArray, side: Side) -> FloatArray:
        return on_member(phi, side) * output_per_follower(subject, phi, side)

    far = subject.drive.far_end

    def free_force(phi: FloatArray, q: FloatArray, _rate: FloatArray) -> FloatArray:
        load = -scale * course.values(phi, "right")
        return load if far is None else load * far.jet(phi, q)[1]

    edges = merged(np.concatenate((subject.state.smooth_angles, course.borders)))
    extremes = piecewise_extremes(course.values, edges)
    return Acting(
        force=Force(
            "load",
            unmoved(on_follower),
            course.borders,
            free_force,
            None if subject.drive.linkage is None else unmoved(on_member),
        ),
        findings=tuple(
            extreme_findings("load", "load", extremes, unit, ", positive against a positive motion")
        ),
        columns=(Column("load", unit, course.values, borders=course.borders),),
    )


def load_profile(data: LoadProfile | Sequence[float], plan: MotionPlan, unit: str) -> LoadProfile:
    """The load of the scene over the cam angle, in `unit`.

    Raises
    ------
    GeometryError
        With key "effects.load.segments", if there is not one value for each segment of non-zero
        length; with "effects.load.file", if its heading states another unit.
    """
    if isinstance(data, LoadProfile):
        if data.unit not in ("", unit):
            raise GeometryError(
                f"the heading states loads in {data.unit}; for this follower the load is in {unit}",
                key="effects.load.file",
            )
        return data
    # A dwell of zero length has no load.
    starts = [start for _, start, _ in plan.stretches]
    if len(data) != len(starts):
        raise GeometryError(
            f"number of values {len(data)}, number of segments of the motion of non-zero"
            f" length {len(starts)}; allowed: one value for each segment",
            key="effects.load.segments",
        )
    return steps(frozen(starts, np.float64), frozen(data, np.float64))


def steps(starts: FloatArray, loads: FloatArray) -> LoadProfile:
    """A load for each segment: `starts` (k,) [rad], ascending from 0, and `loads` (k,)."""

    def values(phi: FloatArray, side: Side) -> FloatArray:
        angle = in_turn(phi, side) + (SNAP if side == "right" else -SNAP)
        return np.asarray(loads[np.maximum(np.searchsorted(starts, angle, side=side) - 1, 0)])

    return LoadProfile(values, starts)
