"""What pictures show: how the follower is held, the motion plan, and where a flank is cut off."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from camgeo.cam.drive import Demanded
from camgeo.curve.working_curve import WorkingCurve
from camgeo.motion.joints import Joint, breaks, joints
from camgeo.motion.plan import Dwell, MotionPlan, Move, Segment
from camgeo.numeric.arrays import ComplexArray, FloatArray, frozen
from camgeo.outline.envelope import Envelope
from camgeo.outline.outline import Outline
from camgeo.outline.path import Pivot
from camgeo.units import TURN

SAMPLES = 721
"""Points of a motion by data: half a degree, finer than a printed line. As many of what is cut off
from a flank."""

DATA = "data"
"""What a segment is called whose motion is given by data."""

DWELL: Final = "dwell"
"""What a segment of the motion plan that is a rest is called."""


@dataclass(frozen=True, slots=True)
class FollowerSketch:
    """What a picture shows of the follower at cam angle 0.

    Attributes
    ----------
    kind : "guide" for a translating follower, "pivot" for an oscillating one.
    end : complex [mm], the pivot, or any point of the guide further out than the roller centre.
    face : complex [mm], the two ends of a flat face; None for a roller.
    """

    kind: Literal["guide", "pivot"]
    end: complex
    face: tuple[complex, complex] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class PlanSegment:
    """A segment of the motion plan, of any length but 0.

    Attributes
    ----------
    start, end : cam angles [rad] in [0, 2 pi].
    label : name of its motion law; "dwell", or "data" for a motion by data.
    course : (n, 2) cam angles [rad] and positions [unit of the plan] of a motion by data, which is
        asked for as a whole; None for the others.
    """

    start: float
    end: float
    label: str
    course: FloatArray | None = None

    @property
    def is_dwell(self) -> bool:
        """Whether it is a rest."""
        return self.label == DWELL


@dataclass(frozen=True, slots=True, eq=False)
class PlanSketch:
    """What a picture shows of the motion plan.

    Attributes
    ----------
    of : whose motion is planned: the follower's, or with a linkage that of its far end.
    unit : of the plan's positions.
    joints : of the plan, as many as segments: joint k is where segment k begins.
    breaks : the joints, and the places inside the laws at which a derivative may jump.
    segments : by ascending cam angle, without those of no length.
    speed : of the disc [rad/s], positive; None if there is none or it varies.
    """

    of: Demanded
    unit: Literal["mm", "rad"]
    joints: tuple[Joint, ...]
    breaks: tuple[Joint, ...]
    segments: tuple[PlanSegment, ...]
    speed: float | None = None


@dataclass(frozen=True, slots=True, eq=False)
class CutOff:
    """What a picture shows of a flank where the disc has a corner.

    Attributes
    ----------
    flank : "inner" or "outer".
    start, end : cam angles [rad] of the flank at the corner, start in [0, 2 pi), end above it.
    course : (n,) complex [mm], the flank between them, which is not on the disc; it begins and ends
        in the corner.
    """

    flank: str
    start: float
    end: float
    course: ComplexArray

    @property
    def corner(self) -> complex:
        """The corner [mm]."""
        return complex(self.course[0])


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
