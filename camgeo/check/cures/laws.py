"""Cure by another law for the moves at fault, with sizes and spans unchanged."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from camgeo.check.cures.conditions import (
    Conditions,
    Discs,
    angles_of,
    moved,
    plan_of,
    worst_place,
)
from camgeo.check.cures.cure import Change, Cure, no_cure, percent
from camgeo.check.cures.moves import dwells_beside, faulty_segments, key_of, rests_beside
from camgeo.check.cures.search import holds
from camgeo.check.cures.task import Task, edits_of
from camgeo.errors import GeometryError
from camgeo.motion.laws import FAMILIES, law_of
from camgeo.motion.laws.characteristic import acceleration_jumps, characteristic
from camgeo.motion.laws.law import Law
from camgeo.motion.plan import MotionPlan, Move

KNOB = "other law"

TASK = "R-R"


@dataclass(frozen=True, slots=True)
class Offer:
    """A law that could replace another, and what that would cost.

    Attributes
    ----------
    law : with its default parameters.
    growth : relative increase of the peak acceleration, 0 if it does not grow.
    """

    law: Law
    growth: float


def other_law(task: Task) -> Cure:
    """Another family for the moves from rest to rest that are at fault, with default parameters.

    Of those that cure, the one whose peak acceleration grows least; one whose acceleration jumps
    only if the present one's does. Each move gets its own; if the flank then crosses itself, all
    get the same.
    """
    discs = task.discs
    plan, places = plan_of(discs), faulty_segments(task, discs)
    for number in places:
        move = plan.segments[number]
        if not (isinstance(move, Move) and move.law.task == TASK and _at_rest(plan, number, move)):
            key = key_of(number, move, "law")
            reason = f"another law: {key} is at fault and is not a law from rest to rest"
            present = move.law.name if isinstance(move, Move) else ""
            return task.finished(no_cure(KNOB, key, present, "", reason))
    number = places[0]
    for conditions, verdict in task.stages:
        fitting = _fitting(discs, places, conditions)
        number = next((each for each, offers in fitting.items() if not offers), number)
        if not all(fitting.values()):
            continue
        first = {number: offers[0] for number, offers in fitting.items()}
        for offers in (first, *_same_for_all(fitting)):
            cure, made = _cure(plan, offers), _with(discs, offers)
            if holds(verdict(made, edits_of(cure))):
                return task.finished(cure, made)
    move = _move(plan, number)
    key = key_of(number, move, "law")
    reason = f"no other {key} cures it at these sizes"
    return task.finished(no_cure(KNOB, key, move.law.name, "", reason))


@dataclass(frozen=True, slots=True)
class Choice:
    """A law from rest to rest, the peak of its acceleration, and whether this jumps."""

    law: Law
    peak: float
    jerky: bool

    @classmethod
    def of(cls, law: Law) -> Choice:
        """What is known of `law`."""
        return cls(law, _peak(law), _jerks(law))


def choices() -> list[Choice]:
    """All laws that a move can have from rest to rest, with their default parameters."""
    families = [family for family in FAMILIES.values() if TASK in family.tasks]
    return [Choice.of(law_of(family.name, TASK, {})) for family in families]


def offers_for(
    plan: MotionPlan, number: int, present: Choice, laws: Sequence[Choice]
) -> list[Offer]:
    """Those of the `laws` that could take the place of the `present` one, cheapest first."""
    found = []
    for each in laws:
        law, old = each.law, present.law
        same = law.name == old.name and law.parameters == old.parameters
        if not same and (present.jerky or not each.jerky) and rests_beside(plan, number, law):
            found.append((Offer(law, max(0.0, each.peak / present.peak - 1.0)), each.jerky))
    return [offer for offer, _ in sorted(found, key=lambda each: (each[0].growth, each[1]))]


def _fitting(discs: Discs, places: Sequence[int], conditions: Conditions) -> dict[int, list[Offer]]:
    """For each move the offers that keep the conditions in it, the cheapest first.

    As these depend over a move on its own law and on no other, a law is tried in all places at
    once.
    """
    plan, laws = plan_of(discs), choices()
    present = {number: _move(plan, number).law for number in places}
    different = {id(law): law for law in present.values()}
    known = {key: Choice.of(law) for key, law in different.items()}
    offers = {n: offers_for(plan, n, known[id(law)], laws) for n, law in present.items()}
    fit: set[tuple[int, str]] = set()
    for name in {offer.law.name for every in offers.values() for offer in every}:
        tried = {n: each for n, every in offers.items() for each in every if each.law.name == name}
        fit |= {(number, name) for number in _fit(discs, tried, conditions)}
    return {
        number: [offer for offer in every if (number, offer.law.name) in fit]
        for number, every in offers.items()
    }


def _fit(discs: Discs, offers: Mapping[int, Offer], conditions: Conditions) -> list[int]:
    """Those of the moves that keep the conditions by the `offers`."""
    made, plan = _with(discs, offers), plan_of(discs)
    try:
        return [n for n in offers if worst_place(made, conditions, angles_of(plan, n)) is None]
    except GeometryError:  # which may be for one of them alone
        if len(offers) == 1:
            return []
        each = ({number: offer} for number, offer in offers.items())
        return [number for one in each for number in _fit(discs, one, conditions)]


def _same_for_all(fitting: Mapping[int, list[Offer]]) -> list[dict[int, Offer]]:
    """Each law that fits all moves, for all of them, cheapest first."""
    by_name = [{offer.law.name: offer for offer in offers} for offers in fitting.values()]
    names = [name for name in by_name[0] if all(name in offers for offers in by_name)]
    every = [
        {number: offers[name] for number, offers in zip(fitting, by_name, strict=True)}
        for name in names
    ]
    return sorted(every, key=lambda offers: max(offer.growth for offer in offers.values()))


def _with(discs: Discs, offers: Mapping[int, Offer]) -> Discs:
    segments = list(plan_of(discs).segments)
    for number, offer in offers.items():
        segments[number] = replace(_move(plan_of(discs), number), law=offer.law)
    return moved(discs, MotionPlan(tuple(segments)))


def _at_rest(plan: MotionPlan, number: int, move: Move) -> bool:
    """Whether another law can take its place: beside a dwell, or where this one also rests."""
    sides = zip((move.law.start, move.law.end), dwells_beside(plan, number), strict=True)
    return all(dwells or end.velocity == end.acceleration == 0.0 for end, dwells in sides)


def _move(plan: MotionPlan, number: int) -> Move:
    """A segment that is known to be a move."""
    move = plan.segments[number]
    assert isinstance(move, Move)
    return move


def _peak(law: Law) -> float:
    """Largest magnitude of f''; infinite for a law that starts or ends with a shock."""
    if law.start.velocity or law.end.velocity:
        return math.inf
    values = characteristic(law)
    return max(abs(values.largest_acceleration.value), abs(values.least_acceleration.value))


def _jerks(law: Law) -> bool:
    """Whether the acceleration jumps, between two rests."""
    ends = (law.start, law.end)
    return any(end.velocity or end.acceleration for end in ends) or bool(acceleration_jumps(law))


def _cure(plan: MotionPlan, offers: Mapping[int, Offer]) -> Cure:
    changes = {}
    for number, offer in offers.items():
        move = _move(plan, number)
        changes[number] = Change(key_of(number, move, "law"), move.law.name, offer.law.name)
    leading = max(offers, key=lambda number: offers[number].growth)
    cost = offers[leading].growth
    named = " and ".join(
        f'{change.key} "{change.value_to}" instead of "{change.value_from}"'
        for change in changes.values()
    )
    grows = f"grows by {percent(cost)}" if cost > 0.0 else "does not grow"
    sentence = f"{named}, with default parameters (the peak of the acceleration {grows})"
    also = tuple(change for number, change in changes.items() if number != leading)
    return changes[leading].cure(KNOB, "", cost, sentence, also)
