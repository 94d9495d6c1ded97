"""Cure by longer segments: moves that undercut take cam angle from the dwells next to them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from decimal import ROUND_FLOOR, Decimal, localcontext

from camgeo.cam.cam import Cam
from camgeo.check.cures.cure import Change, Cure, no_cure, percent
from camgeo.check.cures.margin import Pairs, bends_of, is_sound, margin_within
from camgeo.check.cures.moves import (
    angles_of,
    degrees,
    dwells_around,
    from_rest_to_rest,
    key_of,
    undercut_segments,
)
from camgeo.check.cures.search import nearest_cure, root, steps
from camgeo.errors import GeometryError
from camgeo.motion.plan import MotionPlan
from camgeo.outline.cusps import CUSP

KNOB = "longer segment"

STEP = Decimal("0.000001")
"""Spans are rounded to millionths of a degree, to the next one beyond the limit."""

MOST = 1e-6
"""Accuracy, as a fraction of a span, of the largest growth for which the dwells have room."""

EXACT = 400
"""Digits with which spans are added and subtracted, as in `camgeo.motion.plan`."""


def longer_segment(cam: Cam, pairs: Pairs) -> Cure:
    """Longer spans for the moves that undercut, at the expense of the dwells next to them.

    The curvature over a move depends on its own span only, so against local undercut each move has
    its own limit. Against global undercut all of them grow by one factor. Each takes from the
    dwells before and after it in proportion to their length.
    """
    plan, places = cam.drive.plan, undercut_segments(cam, pairs)
    for number in places:
        segment = plan.segments[number]
        if not from_rest_to_rest(plan, number):
            key = key_of(number, segment, "span")
            reason = f"the span of a segment: {key} undercuts and is not a move from rest to rest"
            return no_cure(KNOB, key, segment.span, "deg", reason)
    spans: dict[int, Decimal] = {}
    for number in places:
        span = _local_limit(cam, number)
        if span is None:
            return _too_short(plan, number)
        spans[number] = span
    longer = longer_plan(plan, spans)
    if longer is None:
        return _too_short(plan, places[0])
    if not is_sound(cam.moved(longer)):
        grown = _grown(cam, spans)
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
    users = [place for places in beside.values() for place in places]
    with localcontext() as context:
        context.prec = EXACT
        rests = {place: segments[place].span for place in users}
        for number, span in spans.items():
            missing = span - segments[number].span
            for shared in (False, True):
                among = [place for place in beside[number] if (users.count(place) > 1) == shared]
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


def _local_limit(cam: Cam, number: int) -> Decimal | None:
    """Shortest span of a move without cusp or local undercut in it; None if dwells are short."""
    plan = cam.drive.plan
    span = plan.segments[number].span
    room = sum((plan.segments[each].span for each in dwells_around(plan, number)), Decimal(0))

    def least(degrees: float) -> float:
        longer = longer_plan(plan, {number: min(max(Decimal(degrees), span), span + room)})
        assert longer is not None  # there is room
        changed = cam.moved(longer)
        bends = bends_of(changed)
        return -1.0 if bends is None else margin_within(changed, bends, *angles_of(longer, number))

    start = float(span)
    before = start
    if least(start) > CUSP:
        return span
    for value in steps(start, float(span + room), start):
        if least(float(value)) > CUSP:
            limit = root(least, before, float(value))
            beyond = _rounded_up(limit)
            return beyond if beyond <= span + room else None
        before = float(value)
    return None


def _grown(cam: Cam, spans: dict[int, Decimal]) -> dict[int, Decimal] | None:
    """The spans times the smallest factor that leaves no crossing; None if dwells are short."""

    def plan(growth: float) -> MotionPlan | None:
        with localcontext() as context:
            context.prec = EXACT
            factor = 1 + Decimal(growth)
            every = {number: span * factor for number, span in spans.items()}
        return longer_plan(cam.drive.plan, every)

    def make(growth: float) -> Cam:
        longer = plan(growth)
        if longer is None:
            raise GeometryError("the dwells are too short", key="motion")
        return cam.moved(longer)

    most, too_much = 0.0, float(360 / min(spans.values()))
    while too_much - most > MOST:
        middle = 0.5 * (most + too_much)
        most, too_much = (most, middle) if plan(middle) is None else (middle, too_much)
    limit = nearest_cure(make, 0.0, most, 1.0)
    if limit is None:
        return None
    grown = {number: _rounded_up(float(span) * (1.0 + limit)) for number, span in spans.items()}
    longer = longer_plan(cam.drive.plan, grown)
    return grown if longer is not None and is_sound(cam.moved(longer)) else None


def _rounded_up(span: float) -> Decimal:
    """The next larger multiple of the step."""
    with localcontext() as context:
        context.prec = EXACT
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
