"""What pictures show: the motion plan with its joints and laws, and where a flank is cut off."""

from __future__ import annotations

from typing import Literal

import numpy as np

from camgeo.cam.drive import Demanded
from camgeo.curve.working_curve import WorkingCurve
from camgeo.files.pictured import DWELL, CutOff, PlanSegment, PlanSketch
from camgeo.motion.joints import breaks, joints
from camgeo.motion.plan import Dwell, MotionPlan, Move, Segment
from camgeo.numeric.arrays import frozen
from camgeo.outline.envelope import Envelope
from camgeo.outline.outline import Outline
from camgeo.outline.path import Pivot
from camgeo.units import TURN

SAMPLES = 721
"""Points of a motion by data: half a degree, finer than a printed line. As many of what is cut off
from a flank."""

DATA = "data"
"""What a segment is called whose motion is given by data."""


def plan_sketch(
    plan: MotionPlan,
    of: Demanded,
    unit: Literal["mm", "rad"],
    speed: float | None,
) -> PlanSketch:
    """What a picture shows of `plan`; the arguments are as the attributes of `PlanSketch`."""
    segments = tuple(_segment(plan, *each) for each in plan.stretches)
    return PlanSketch(of, unit, joints(plan), breaks(plan), segments, speed)


def cut_off_sketches(curve: WorkingCurve, outline: Outline, flank: str) -> tuple[CutOff, ...]:
    """What a picture shows of the corners of `outline`, the real one of the flank `curve`.

    Nothing for a knife edge: the corners of its flank are those of the pitch curve, none is cut.
    """
    if curve.distance == 0.0:
        return ()
    envelope, pivots = Envelope(curve), outline.path.pivots
    return tuple(_cut_off(envelope, each, flank) for each in pivots if each.distance == 0.0)


def _cut_off(envelope: Envelope, corner: Pivot, flank: str) -> CutOff:
    start = corner.before % TURN
    first, last = envelope.place_before(start), envelope.place_of(corner.after % TURN)
    last += envelope.total if last < first else 0.0
    # Both sides of the roller's turns, so that the ends of their arcs are drawn.
    turns = [*envelope.starts, *(envelope.starts + envelope.total)]
    inside = [place for place in turns if first < place < last]
    places = np.unique(np.append(np.linspace(first, last, SAMPLES)[1:-1], inside))
    points = envelope.course(places).points
    course = np.concatenate(([corner.centre], points, [corner.centre]))
    end = start + (corner.after - corner.before) % TURN
    return CutOff(flank, start, end, frozen(course, np.complex128))


def _segment(plan: MotionPlan, segment: Segment, start: float, end: float) -> PlanSegment:
    if isinstance(segment, Dwell):
        return PlanSegment(start, end, DWELL)
    if isinstance(segment, Move):
        return PlanSegment(start, end, segment.law.name)
    phi = np.linspace(start, end, SAMPLES)
    positions = np.append(plan.jet(phi[:-1])[0], segment.to)
    return PlanSegment(start, end, DATA, frozen(np.column_stack((phi, positions)), np.float64))
