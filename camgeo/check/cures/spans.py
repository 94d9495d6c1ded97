"""Cure by longer segments: moves at fault take cam angle from the dwells next to them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import ROUND_FLOOR, Decimal, localcontext
from typing import Final

from camgeo.check.cures.conditions import (
    Conditions,
    Discs,
    moved,
    plan_of,
    worst_place,
)
from camgeo.check.cures.cure import Change, Cure, no_cure, percent
from camgeo.check.cures.moves import (
    Span,
    degrees,
    dwells_around,
    faulty_segments,
    from_rest_to_rest,
    key_of,
)
from camgeo.check.cures.search import UNKNOWN, Along, Excess, Way, holds
from camgeo.check.cures.task import Judge, Task, edits_of
from camgeo.errors import GeometryError
from camgeo.motion.plan import MotionPlan
from camgeo.motion.spans import EXACT

KNOB: Final = "longer segment"

STEP: Final = Decimal("0.000001")
"""Spans are rounded to millionths of a degree, to the next one beyond the limit."""

MOST: Final = 1e-6
"""Accuracy, as a fraction of a span, of the largest growth for which the dwells have room."""


@dataclass(frozen=True, slots=True, eq=False)
class Growth:
    """The growth of several moves by one factor, less 1, a `Knob` of the search.

    Attributes
    ----------
    discs : as they are.
    spans : of the moves, by their numbers in the plan, at growth 0.
    """

    discs: Discs
    spans: Mapping[int, Decimal]
    start: float = 0.0
    scale: float = 1.0

    def plan(self, growth: float, *, rounded: bool = True) -> MotionPlan | None:
        """The plan, with spans that are rounded up; None if the dwells are too short."""
        with localcontext(EXACT):
            factor = 1 + Decimal(growth)
            spans = {number: span * factor for number, span in self.spans.items()}
        if rounded:
            spans = {number: _rounded_up(span) for number, span in spans.items()}
        return longer_plan(plan_of(self.discs), spans)

    def make(self, value: float) -> Discs:
        """See `Knob`."""
        longer = self.plan(value, rounded=False)
        if longer is None:
            raise GeometryError("the dwells are too short", key="motion")
        return moved(self.discs, longer)

    def worst(self, value: float, conditions: Conditions) -> Along | None:
        """See `Knob`; longer than they must be, moves hardly break anything."""
        if worst_place(self.make(value), conditions) is not None:
            raise GeometryError("these moves are too short", key="motion")
        return None

    @property
    def most(self) -> float:
        """The largest one for which the dwells have room, up to `MOST` of it."""
        most, too_much = 0.0, float(360 / min(self.spans.values()))
        while too_much - most > MOST * max(1.0, most):
            middle = 0.5 * (most + too_much)
            most, too_much = (most, middle) if self.plan(middle) is None else (middle, too_much)
        return most


def longer_segment(task: Task) -> Cure:
    """Longer spans for the moves at fault, at the expense of the dwells next to them.

    Each move has its own limit. Against global undercut all of them grow by one factor. Each takes
    from the dwells before and after it in proportion to their length.
    """
    discs = task.discs
    plan, places = plan_of(discs), faulty_segments(task, discs)
    for number in places:
        segment = plan.segments[number]
        if not from_rest_to_rest(plan, number):
            key = key_of(number, segment, "span")
            reason = f"the span of a segment: {key} is at fault and is not a move from rest to rest"
            return task.finished(no_cure(KNOB, key, segment.span, "deg", reason))
    for conditions, verdict in task.stages:
        longer = _longer(task, places, conditions, verdict)
        if longer is not None:
            return task.finished(_cure(plan, longer, places), moved(discs, longer))
    return task.finished(_too_short(plan, places[0]))


def _longer(
    task: Task,
    places: Sequence[int],
    conditions: Conditions,
    verdict: Judge,
) -> MotionPlan | None:
    """The plan with moves that are long enough; None if there is no room for them."""
    discs, plan = task.discs, plan_of(task.discs)

    def judged(longer: MotionPlan | None) -> Excess:
        if longer is None or longer == plan:
            return UNKNOWN
        return verdict(moved(discs, longer), edits_of(_cure(plan, longer, places)))

    spans = _limits(discs, places, conditions)
    longer = None if spans is None else longer_plan(plan, spans)
    if spans is None or longer is None:
        return None
    if holds(judged(longer)):
        return longer
    growth = Growth(discs, spans)
    way = Way(growth, growth.most, conditions, lambda value: judged(growth.plan(value)))
    limit = way.nearest()
    longer = None if limit is None else growth.plan(limit)
    return longer if holds(judged(longer)) else None


def _limits(
    discs: Discs, places: Sequence[int], conditions: Conditions
) -> dict[int, Decimal] | None:
    """For each move its least span that keeps the conditions; None if the dwells beside one are
    too short.
    """
    plan = plan_of(discs)
    spans: dict[int, Decimal] = {}
    for number in places:
        present = plan.segments[number].span
        beside = (plan.segments[each].span for each in dwells_around(plan, number))
        most = sum(beside, present)
        knob = Span(discs, number)
        limit = Way(knob, float(most), conditions, lambda _: {}).nearest()
        if limit is None:
            return None
        spans[number] = present if limit == float(present) else _rounded_up(Decimal(limit))
        if spans[number] > most:
            return None
    return spans


def longer_plan(plan: MotionPlan, spans: Mapping[int, Decimal]) -> MotionPlan | None:
    """The plan with other spans of the moves at some indices; None if the dwells are too short.

    A move takes first from dwells that are next to no other of these moves.
    """
    segments = list(plan.segments)
    beside = {number: dwells_around(plan, number) for number in spans}
    users = Counter(place for places in beside.values() for place in places)
    with localcontext(EXACT):
        rests = {place: segments[place].span for place in users}
        for number, span in spans.items():
            missing = span - segments[number].span
            for shared in (False, True):
                among = [place for place in beside[number] if (users[place] > 1) == shared]
                missing = _take(rests, among, missing)
            if missing > 0:
                return None
            segments[number] = replace(segments[number], span=span)
    for place, rest in rests.items():
        segments[place] = replace(segments[place], span=rest)
    return MotionPlan(tuple(segments))


def _take(rests: dict[int, Decimal], among: list[int], wanted: Decimal) -> Decimal:
    """Take `wanted` degrees from the dwells in proportion to their length; return what lacks."""
    there = sum((rests[place] for place in among), Decimal(0))
    part = min(wanted, there)
    if part <= 0:
        return wanted
    left = part
    for place in among:
        share = (rests[place] * part / there).quantize(STEP, rounding=ROUND_FLOOR)
        share = min(share, rests[place], left)
        rests[place] -= share
        left -= share
    for place in among:  # what the rounding left over
        share = min(left, rests[place])
        rests[place] -= share
        left -= share
    return wanted - part


def _rounded_up(span: Decimal) -> Decimal:
    """The next larger multiple of the step."""
    with localcontext(EXACT):
        return span.quantize(STEP, rounding=ROUND_FLOOR) + STEP


def _cure(old: MotionPlan, new: MotionPlan, places: Sequence[int]) -> Cure:
    changes = {
        number: Change(key_of(number, before, "span"), before.span, after.span)
        for number, (before, after) in enumerate(zip(old.segments, new.segments, strict=True))
        if before.span != after.span
    }
    shares = {
        number: float(new.segments[number].span / old.segments[number].span - 1)
        for number in places
    }
    leading = max(shares, key=shares.__getitem__)
    also = [changes[number] for number in places if number != leading and number in changes]
    dwells = [change for number, change in changes.items() if number not in places]
    moves = " and ".join(_told(changes[number]) for number in places if number in changes)
    taken = " and ".join(_told(change) for change in dwells)
    cost = shares[leading]
    sentence = f"longer: {moves} (a change by {percent(cost)}), taken from {taken}"
    return changes[leading].cure(KNOB, "deg", cost, sentence, (*also, *dwells))


def _told(change: Change) -> str:
    old, new = change.value_from, change.value_to
    assert isinstance(old, Decimal)
    assert isinstance(new, Decimal)
    return f"{change.key} {degrees(new)} deg instead of {degrees(old)}"


def _too_short(plan: MotionPlan, number: int) -> Cure:
    segment = plan.segments[number]
    key = key_of(number, segment, "span")
    reason = f"no longer {key} cures it: the dwells next to it leave too little room"
    return no_cure(KNOB, key, segment.span, "deg", reason)
