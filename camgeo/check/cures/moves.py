"""The moves that undercut, and what may change in them without disturbing their joints."""

from __future__ import annotations

import math
from collections.abc import Collection
from decimal import Decimal

import numpy as np

from camgeo.check.cures.discs import Discs, plan_of
from camgeo.check.cures.margin import Pairs, margins_within
from camgeo.motion.laws.law import Law
from camgeo.motion.plan import Dwell, MotionPlan, Move, Segment
from camgeo.numeric.arrays import FloatArray
from camgeo.outline.cusps import CUSP


def undercut_segments(discs: Discs, pairs: Pairs) -> tuple[int, ...]:
    """Indices in the plan of the segments that undercut.

    Those with a cusp or local undercut; if there are none, those of the crossings `pairs`, without
    the dwells if there is a move among them: the move next to a dwell is what can change.
    """
    plan = plan_of(discs)
    numbers = [number for number, segment in enumerate(plan.segments) if segment.span]
    least = margins_within(discs, angles_of_all(plan, numbers))
    if least is None:
        return ()
    local = [number for number, value in zip(numbers, least, strict=True) if value <= CUSP]
    if local:
        return tuple(local)
    angles = [angle for _, *both in pairs for angle in both]
    places = sorted({segment_at(plan, angle) for angle in angles})
    moves = [place for place in places if not isinstance(plan.segments[place], Dwell)]
    return tuple(moves or places)


def angles_of(plan: MotionPlan, number: int) -> tuple[float, float]:
    """Cam angles [rad] at which a segment starts and ends."""
    first, last = plan.joints_deg[number : number + 2]
    return math.radians(float(first)), math.radians(float(last))


def angles_of_all(plan: MotionPlan, numbers: Collection[int]) -> FloatArray:
    """(k, 2) `angles_of` the segments `numbers`."""
    return np.array([angles_of(plan, number) for number in numbers]).reshape(-1, 2)


def segment_at(plan: MotionPlan, angle: float) -> int:
    """Index of the segment that contains the cam angle [rad]; the last with a length if none
    does.
    """
    last = 0
    for number, segment in enumerate(plan.segments):
        if not segment.span:
            continue
        start, end = angles_of(plan, number)
        if start <= angle < end:
            return number
        last = number
    return last


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
