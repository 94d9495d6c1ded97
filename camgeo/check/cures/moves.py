"""The moves at fault, the span of one, and what may change in them so that they still join."""

from __future__ import annotations

from dataclasses import dataclass, replace
from decimal import Decimal, localcontext

import numpy as np

from camgeo.check.cures.conditions import (
    Conditions,
    Discs,
    Range,
    angles_of,
    margin_of_either_side,
    moved,
    places_in,
    plan_of,
    segment_at,
    worst_place,
)
from camgeo.check.cures.neck import crossings
from camgeo.check.cures.search import Along
from camgeo.check.cures.task import Task
from camgeo.curve.together import LinkedMotions, Repeated
from camgeo.mechanism.linkage import LinkedMotion
from camgeo.motion.laws.law import Law
from camgeo.motion.motion import FULL_ORDER, Jet, Motion
from camgeo.motion.plan import Dwell, MotionPlan, Move, Segment
from camgeo.motion.spans import EXACT
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.outline.cusps import CUSP


def faulty_segments(task: Task, discs: Discs) -> tuple[int, ...]:
    """Indices in the plan of the segments that are at fault.

    Those in which the condition is broken; if there are none, those whose flanks cross each other,
    without the dwells if there is a move among them: the move next to a dwell is what can change.
    """
    plan = plan_of(discs)
    extremes = [task.condition.over_turn(cam) for cam in discs]

    def broken(within: Range) -> bool:
        parts = ((found.values, places_in(found, within)) for found in extremes)
        return any(np.min(values[slice(*ends)]) <= CUSP for values, ends in parts)

    numbers = [number for number, segment in enumerate(plan.segments) if segment.span]
    local = [number for number in numbers if broken(angles_of(plan, number))]
    if local:
        return tuple(local)
    angles = [angle for _, *both in crossings(discs) for angle in both]
    places = sorted({segment_at(plan, angle) for angle in angles})
    moves = [place for place in places if not isinstance(plan.segments[place], Dwell)]
    return tuple(moves or places or numbers)


def from_rest_to_rest(plan: MotionPlan, number: int) -> bool:
    """Whether a segment is a move whose span can change without affecting its joints."""
    move = plan.segments[number]
    if not isinstance(move, Move) or move.span == 0:
        return False
    return rests_beside(plan, number, move.law)


def rests_beside(plan: MotionPlan, number: int, law: Law) -> bool:
    """Whether `law` joins with its neighbours in place of a segment, going from rest to rest.

    Its velocity is 0 at both ends, and its acceleration too at an end without a dwell next to it.
    """
    sides = zip((law.start, law.end), dwells_beside(plan, number), strict=True)
    return all(
        end.velocity == 0.0 and (end.acceleration == 0.0 or bool(dwells)) for end, dwells in sides
    )


def dwells_beside(plan: MotionPlan, number: int) -> tuple[list[int], list[int]]:
    """Indices of the dwells adjacent to a segment, before and after it, nearest first.

    Dwells of length zero are skipped.
    """

    def run(step: int) -> list[int]:
        segments, found = plan.segments, []
        for away in range(1, len(segments)):
            place = (number + step * away) % len(segments)
            if not isinstance(segments[place], Dwell):
                break
            if segments[place].span:
                found.append(place)
        return found

    return run(-1), run(1)


def dwells_around(plan: MotionPlan, number: int) -> tuple[int, ...]:
    """Indices of the dwells adjacent to a segment on either side, each once."""
    before, after = dwells_beside(plan, number)
    return tuple(dict.fromkeys(before + after))


def key_of(number: int, segment: Segment, what: str) -> str:
    """The scene's key of a segment, e.g. "motion[2].span"; for a dwell that of its length."""
    return f"motion[{number + 1}].{'dwell' if isinstance(segment, Dwell) else what}"


def degrees(value: Decimal) -> str:
    """An angle as a scene would write it, for a sentence."""
    return f"{value.normalize():f}" if value else "0"


@dataclass(frozen=True, slots=True, eq=False)
class Stretched(Repeated):
    """A motion at one cam angle, asked for n times, if the move there has n other spans.

    Attributes
    ----------
    growth : (n,) by how much each of them is longer.
    """

    growth: FloatArray

    def jet(self, phi: FloatArray, side: Side = "right", order: int = FULL_ORDER) -> Jet:
        """See `Motion.jet`: each derivative by the cam angle is divided by the growth once more."""
        found = self.motion.jet(phi, side, order)
        return np.asarray(found / self.growth ** np.arange(len(found))[:, np.newaxis])


@dataclass(frozen=True, slots=True, eq=False)
class Span:
    """The span of a move [deg], a `Knob` of the search: in a motion of that move alone.

    The curvature and the transmission angle over a move depend on its own span only.

    Attributes
    ----------
    discs : with the whole motion.
    number : of the move in its plan.
    """

    discs: Discs
    number: int

    @property
    def start(self) -> float:
        """See `Knob`."""
        return float(plan_of(self.discs).segments[self.number].span)

    @property
    def scale(self) -> float:
        """See `Knob`."""
        return self.start

    def make(self, value: float) -> Discs:
        """See `Knob`: other moves lead from the first position to that of the move, and back."""
        plan = plan_of(self.discs)
        move = plan.segments[self.number]
        assert isinstance(move, Move)
        before = [each.to for each in plan.segments[: self.number] if not isinstance(each, Dwell)]
        first = before[-1] if before else 0.0
        with localcontext(EXACT):
            span = Decimal(value)
            rest = (360 - span) / 2
            there = Move(rest, first, move.law) if first else Dwell(rest)
            back = Move(rest, 0.0, move.law) if move.to else Dwell(rest)
        return moved(self.discs, MotionPlan((there, replace(move, span=span), back)))

    def worst(self, value: float, conditions: Conditions) -> Along | None:
        """See `Knob`."""
        discs = self.make(value)
        found = worst_place(discs, conditions, angles_of(plan_of(discs), 1))
        if found is None:
            return None
        condition, number, phi = found
        cam = discs[number]
        curve = cam.disc.pitch_curve

        def along(values: FloatArray) -> FloatArray:
            motion: Motion
            if isinstance(curve.motion, LinkedMotion):
                demanded = Stretched(curve.motion.demanded, 1, values / value)
                motion = LinkedMotions(demanded, curve.motion.linkage)
            else:
                motion = Stretched(curve.motion, 1, values / value)
            other = replace(curve, motion=motion)
            return margin_of_either_side(condition, other, (cam,), phi, len(values))

        return along
