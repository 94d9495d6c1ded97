"""Extremes in time of a plan made of laws, for a disc that turns evenly: where the laws turn."""

from __future__ import annotations

import numpy as np

from camgeo.motion.plan import Course, MotionPlan, Move
from camgeo.motion.time_course import (
    ConstantSpeed,
    LiftUnit,
    TimeExtremes,
    in_time,
    inertia_torque,
)
from camgeo.numeric.arrays import FloatArray, ascending
from camgeo.numeric.extremes import Extremes, extremes_of


def extremes_at_turns(
    plan: MotionPlan, course: ConstantSpeed, unit: LiftUnit = "mm"
) -> TimeExtremes | None:
    """The same as `camgeo.motion.time_course.time_extremes`, exactly and without a search.

    With constant speed velocity, acceleration, jerk and torque have their extremes where s', s'',
    s''' and s' s'' have theirs (VDI 2143-1, section 5.1): at the turns of the laws and at the
    borders, from either side. None if a part of the plan is motion by data.
    """
    if any(isinstance(segment, Course) for segment in plan.segments):
        return None
    places = [plan.borders]
    for segment, start, end in plan.stretches:
        if isinstance(segment, Move):
            turns = [z for region in segment.law.regions for z in region.turns()]
            places.append(start + np.array(turns) * (end - start))
    phi = ascending(np.concatenate(places))
    sides = [in_time(plan.jet(phi, side), course, phi) for side in ("right", "left")]
    timed = np.concatenate(sides, axis=1)
    torque = inertia_torque(timed, course.rates(np.tile(phi, 2))[0], unit=unit)

    def extremes(values: FloatArray) -> Extremes:
        return extremes_of(np.tile(phi, 2), values)

    return TimeExtremes(
        velocity=extremes(timed[1]),
        acceleration=extremes(timed[2]),
        jerk=extremes(timed[3]),
        torque=extremes(torque),
    )
