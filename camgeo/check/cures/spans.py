"""Cure by longer segments: moves that undercut take cam angle from the dwells next to them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from decimal import ROUND_FLOOR, Decimal, localcontext

import numpy as np

from camgeo.check.cures.cure import Change, Cure, no_cure, percent
from camgeo.check.cures.discs import Discs, moved, plan_of
from camgeo.check.cures.margin import Pairs, is_intact, margins_within
from camgeo.check.cures.moves import (
    angles_of_all,
    degrees,
    dwells_around,
    from_rest_to_rest,
    key_of,
    undercut_segments,
)
from camgeo.check.cures.search import nearest_cure, steps
from camgeo.errors import GeometryError
from camgeo.motion.plan import MotionPlan
from camgeo.motion.spans import EXACT
from camgeo.numeric.arrays import FloatArray, IntArray
from camgeo.numeric.roots import indexed_roots
from camgeo.outline.cusps import CUSP

KNOB = "longer segment"

STEP = Decimal("0.000001")
"""Spans are rounded to millionths of a degree, to the next one beyond the limit."""

MOST = 1e-6
"""Accuracy, as a fraction of a span, of the largest growth for which the dwells have room."""


def longer_segment(discs: Discs, pairs: Pairs) -> Cure:
    """Longer spans for the moves that undercut, at the expense of the dwells next to them.

    The curvature over a move depends on its own span only, so against local undercut each move has
    its own limit. Against global undercut all of them grow by one factor. Each takes from the
    dwells before and after it in proportion to their length.
    """
    plan, places = plan_of(discs), undercut_segments(discs, pairs)
    for number in places:
        segment = plan.segments[number]
        if not from_rest_to_rest(plan, number):
            key = key_of(number, segment, "span")
            reason = f"the span of a segment: {key} undercuts and is not a move from rest to rest"
            return no_cure(KNOB, key, segment.span, "deg", reason)
    spans: dict[int, Decimal] = {}
    for number, span in zip(places, _local_limits(discs, places), strict=True):
        if span is None:
            return _too_short(plan, number)
        spans[number] = span
    longer = longer_plan(plan, spans)
    if longer is None:
        return _too_short(plan, places[0])
    if not is_intact(moved(discs, longer)):
        grown = _grown(discs, spans)
        if grown is None:
            return _too_short(plan, places[0])
        spans = grown
        longer = longer_plan(plan, spans)
        assert longer is not None  # it has been made once before
    return _cure(plan, longer, places)


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


def _local_limits(discs: Discs, places: Sequence[int]) -> list[Decimal | None]:
    """For each move its least span without cusp or local undercut in it; None if the dwells beside
    it are short. All moves are tried at once.
    """
    plan = plan_of(discs)
    spans = [plan.segments[number].span for number in places]
    most = [
        span + sum((plan.segments[each].span for each in dwells_around(plan, number)), Decimal(0))
        for number, span in zip(places, spans, strict=True)
    ]
    groups = _apart(plan, places)

    def least(degrees: FloatArray, which: IntArray) -> FloatArray:
        """(k,) margins within the moves `which` (k,) if their spans are `degrees` (k,)."""
        tried = {
            int(k): min(max(Decimal(value), spans[k]), most[k])
            for k, value in zip(which, degrees.tolist(), strict=True)
        }
        found: dict[int, float] = {}
        for group in groups:
            found |= _margins(discs, {places[k]: tried[k] for k in group if k in tried})
        return np.array([found[places[k]] for k in tried])

    start = np.array([float(span) for span in spans])
    tries = [steps(low, float(end), low) for low, end in zip(start.tolist(), most, strict=True)]
    intact = least(start, np.arange(len(places))) > CUSP
    limits: list[Decimal | None] = [
        span if whole else None for span, whole in zip(spans, intact, strict=True)
    ]
    before, after = start.copy(), start.copy()
    left, number = np.flatnonzero(~intact), 0
    while len(left := left[[number < len(tries[k]) for k in left]]):
        after[left] = [tries[k][number] for k in left]
        good = least(after[left], left) > CUSP
        intact[left[good]] = True
        left, number = left[~good], number + 1
        before[left] = after[left]
    found = np.flatnonzero(intact & (after > before))
    roots = indexed_roots(lambda x, which: least(x, found[which]), before[found], after[found])
    for k, root in zip(found, roots.tolist(), strict=True):
        beyond = _rounded_up(root)
        limits[k] = beyond if beyond <= most[k] else None
    return limits


def _margins(discs: Discs, spans: Mapping[int, Decimal]) -> dict[int, float]:
    """The least 1 + d kappa within each of some moves, of which no two have a dwell in common, if
    these are their spans; -1 where there is no mechanism.
    """
    if not spans:
        return {}
    longer = longer_plan(plan_of(discs), spans)
    assert longer is not None  # there is room
    least = margins_within(moved(discs, longer), angles_of_all(longer, spans))
    if least is not None:
        return dict(zip(spans, least.tolist(), strict=True))
    if len(spans) == 1:
        return dict.fromkeys(spans, -1.0)
    return {each: _margins(discs, {each: span})[each] for each, span in spans.items()}


def _apart(plan: MotionPlan, places: Sequence[int]) -> list[list[int]]:
    """The numbers of the `places` in groups of which no two have a dwell beside them in common."""
    groups: list[list[int]] = []
    taken: list[set[int]] = []
    for number, place in enumerate(places):
        beside = set(dwells_around(plan, place))
        for group, dwells in zip(groups, taken, strict=True):
            if not dwells & beside:
                group.append(number)
                dwells |= beside
                break
        else:
            groups.append([number])
            taken.append(beside)
    return groups


def _grown(discs: Discs, spans: dict[int, Decimal]) -> dict[int, Decimal] | None:
    """The spans times the smallest factor that leaves no crossing; None if dwells are short."""

    def plan(growth: float) -> MotionPlan | None:
        with localcontext(EXACT):
            factor = 1 + Decimal(growth)
            every = {number: span * factor for number, span in spans.items()}
        return longer_plan(plan_of(discs), every)

    def make(growth: float) -> Discs:
        longer = plan(growth)
        if longer is None:
            raise GeometryError("the dwells are too short", key="motion")
        return moved(discs, longer)

    most, too_much = 0.0, float(360 / min(spans.values()))
    while too_much - most > MOST * max(1.0, most):
        middle = 0.5 * (most + too_much)
        most, too_much = (most, middle) if plan(middle) is None else (middle, too_much)
    limit = nearest_cure(make, 0.0, most, 1.0)
    if limit is None:
        return None
    grown = {number: _rounded_up(float(span) * (1.0 + limit)) for number, span in spans.items()}
    longer = longer_plan(plan_of(discs), grown)
    return grown if longer is not None and is_intact(moved(discs, longer)) else None


def _rounded_up(span: float) -> Decimal:
    """The next larger multiple of the step."""
    with localcontext(EXACT):
        return Decimal(span).quantize(STEP, rounding=ROUND_FLOOR) + STEP


def _cure(old: MotionPlan, new: MotionPlan, places: tuple[int, ...]) -> Cure:
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
    reason = f"no longer {key} cures it: the dwells next to the undercut leave too little room"
    return no_cure(KNOB, key, segment.span, "deg", reason)
