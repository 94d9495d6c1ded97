"""Extremes in time of a plan: where its laws turn, or by a search where that does not tell."""

from __future__ import annotations

import numpy as np

from camgeo.motion.plan import Course, MotionPlan, Move
from camgeo.motion.time_course import (
    ConstantSpeed,
    LiftUnit,
    TimeCourse,
    TimeExtremes,
    in_time,
    inertia_torque,
    time_extremes,
)
from camgeo.numeric.arrays import FloatArray, ascending
from camgeo.numeric.extremes import Extremes, extremes_of


def plan_extremes(plan: MotionPlan, course: TimeCourse, unit: LiftUnit = "mm") -> TimeExtremes:
    """As `camgeo.motion.time_course.time_extremes`; for a disc that turns evenly without a search.

    With constant speed velocity, acceleration, jerk and torque have their extremes where s', s'',
    s''' and s' s'' have theirs (VDI 2143-1, section 5.1): at the turns of the laws and at the
    borders, from either side. Motion by data is searched.
    """
    by_data = any(isinstance(segment, Course) for segment in plan.segments)
    if by_data or not isinstance(course, ConstantSpeed):
        return time_extremes(plan, course, unit)
    places = [plan.borders]
    for segment, start, end in plan.stretches:
        if isinstance(segment, Move):
            turns = np.concatenate([region.places[1:-1] for region in segment.law.regions])
            places.append(start + turns * (end - start))
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
