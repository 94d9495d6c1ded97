"""Load: the force of the process over the cam angle.

The load F acts against a positive demanded motion s, so that its generalised force on the follower
is Q = -F ds/dq by virtual work: -F where the follower makes the demanded motion itself. A positive
load on what turns, a rocker without linkage, or the lever or crank at the far end of one, is a
torque against its positive angle.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from camgeo.effects.effect import Column, Request, Subject
from camgeo.effects.force import Force, unmoved
from camgeo.effects.immovable import refuse_locked
from camgeo.effects.load.course import Course, constant, steps
from camgeo.effects.load.spec import LoadSpec
from camgeo.effects.results import Acting
from camgeo.effects.told import extreme_findings
from camgeo.errors import GeometryError
from camgeo.motion.motion import Side
from camgeo.motion.plan import MotionPlan
from camgeo.numeric.arrays import FloatArray, frozen, merged
from camgeo.numeric.extremes import piecewise_extremes

N_MM: Final = 1e3
"""N mm a N m."""


def compute(request: Request[LoadSpec]) -> Acting:
    """The load of `request.spec`, c0 alone.

    A constant load has a potential energy F s; others do work over a turn and have none.

    Raises
    ------
    GeometryError
        With the key, see `course_of`.
    EffectError
        If the load acts on the far end of a linkage that the follower cannot move at some cam
        angle.
    """
    subject = request.subject
    is_torque = subject.drive.unit == "rad"
    unit = "N m" if is_torque else "N"
    course = course_of(request.spec, subject.drive.plan, unit)
    scale = N_MM if is_torque else 1.0
    refuse_locked(subject, " against its load")

    def on_follower(phi: FloatArray, side: Side) -> FloatArray:
        return -scale * course.values(phi, side) * _way(subject, phi, side)

    def work(phi: FloatArray, side: Side) -> FloatArray:
        """Against a constant load, from the start of the stroke on."""
        found: FloatArray = scale * course.values(phi, side) * subject.drive.plan.jet(phi, side)[0]
        return found

    potential = None if request.spec.constant is None else work
    edges = merged(np.concatenate((subject.drive.smooth_angles, course.borders)))
    extremes = piecewise_extremes(course.values, edges)
    return Acting(
        force=Force("load", unmoved(on_follower), potential, course.borders),
        findings=tuple(
            extreme_findings("load", "load", extremes, unit, ", positive against a positive motion")
        ),
        columns=(Column("load", unit, course.values, borders=course.borders),),
    )


def course_of(spec: LoadSpec, plan: MotionPlan, unit: str) -> Course:
    """The load of a scene over the cam angle, in `unit`.

    Raises
    ------
    GeometryError
        With key "effects.load.segments", if there is not one value for each segment that has
        a length; with "effects.load.file", if its heading tells another unit.
    """
    if spec.table is not None:
        if spec.table.unit not in ("", unit):
            raise GeometryError(
                f"the heading tells loads in {spec.table.unit}; of this follower the load is in"
                f" {unit}",
                key="effects.load.file",
            )
        return spec.table
    if spec.segments is None:
        assert spec.constant is not None  # `parse` sees to it
        return constant(spec.constant)
    # A rest of no length has no load; the plan of a scene does not keep it either.
    starts = [start for _, start, _ in plan.stretches]
    if len(spec.segments) != len(starts):
        raise GeometryError(
            f"{len(spec.segments)} values for the {len(starts)} segments of the motion that"
            " have a length; allowed is one for each",
            key="effects.load.segments",
        )
    return steps(frozen(starts, np.float64), frozen(spec.segments, np.float64))


def _way(subject: Subject, phi: FloatArray, side: Side) -> FloatArray:
    """ds/dq (n,): way of the demanded motion a unit of the follower's."""
    if subject.drive.linkage is None:
        return np.ones(len(phi))
    return subject.drive.linkage.per_follower(subject.drive.plan.jet(phi, side)[0])
