"""The motion plan as pictures show it: its joints, and its segments with their laws' names."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from camgeo.files.product import DWELL, PlanSegment, PlanSketch
from camgeo.motion.joints import breaks, joints
from camgeo.motion.plan import Dwell, MotionPlan, Move, Segment
from camgeo.numeric.arrays import frozen

SAMPLES = 721
"""Points of a motion by data: half a degree, finer than a printed line."""

DATA = "data"
"""What a segment is called whose motion is given by data."""


def plan_sketch(
    plan: MotionPlan,
    of: Literal["follower", "slider"],
    unit: Literal["mm", "rad"],
    speed: float | None,
) -> PlanSketch:
    """What a picture shows of `plan`; the arguments are as the attributes of `PlanSketch`."""
    segments = tuple(
        _segment(plan, segment, math.radians(float(first)), math.radians(float(last)))
        for segment, first, last in zip(
            plan.segments, plan.joints_deg[:-1], plan.joints_deg[1:], strict=True
        )
        if segment.span > 0
    )
    return PlanSketch(of, unit, joints(plan), breaks(plan), segments, speed)


def _segment(plan: MotionPlan, segment: Segment, start: float, end: float) -> PlanSegment:
    if isinstance(segment, Dwell):
        return PlanSegment(start, end, DWELL)
    if isinstance(segment, Move):
        return PlanSegment(start, end, segment.law.name)
    phi = np.linspace(start, end, SAMPLES)
    positions = np.append(plan.jet(phi[:-1])[0], segment.to)
    return PlanSegment(start, end, DATA, frozen(np.column_stack((phi, positions)), np.float64))
