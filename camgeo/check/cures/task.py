"""What is to be cured: a fault of a design, the limits that held, and the verdict on changes."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import chain
from typing import Final

from camgeo.check.cures.conditions import Condition, Conditions, Discs
from camgeo.check.cures.cure import Change, Cure, Value
from camgeo.check.cures.search import UNKNOWN, Excess, holds
from camgeo.check.finding import BROKEN, NO_OUTLINE, RETURN, Finding
from camgeo.errors import GeometryError, SceneError
from camgeo.units import LengthUnit, in_unit
from camgeo.wording import listed

Edits = Mapping[str, Value]
"""New values by key, in the unit of the scene or in degrees."""

Judge = Callable[[Discs, Edits], Excess]
"""The verdict on changed discs, which the edits make."""

CAUSES: Final = ("outline-", "curvature", "standstill")
"""Beginnings of the names of findings with which nothing is known of undercut."""

NAMED: Final = 3
"""Limits that a sentence names."""


@dataclass(frozen=True, slots=True, eq=False)
class Task:
    """A fault, and what a cure of it must not break.

    Attributes
    ----------
    fault : in words, e.g. "undercut".
    condition : what it breaks.
    held : what else the places of the cam decide, and what they keep now.
    discs : as they are.
    unit : of lengths in sentences.
    before : names of the limits that are broken as it is.
    judged : the findings on changed discs, which the edits make, and on their parts, which are
        looked at only where the discs hold; SceneError or GeometryError if there are no such.
    """

    fault: str
    condition: Condition
    held: Conditions
    discs: Discs
    unit: LengthUnit
    before: frozenset[str]
    judged: Callable[[Discs, Edits], tuple[Iterable[Finding], Iterable[Finding]]]

    @property
    def stages(self) -> Iterator[tuple[Conditions, Judge]]:
        """Conditions and verdicts by which a cure is sought: first one that breaks nothing, then
        one that cures.
        """
        least = (self.condition, *(each for each in self.held if each.vital))
        yield (self.condition, *self.held), self.breaking
        yield least, self.failing

    def breaking(self, discs: Discs, edits: Edits) -> Excess:
        """By how much a change that cures exceeds the limits that held; else what `failing` is."""
        failing = self.failing(discs, edits)
        if not holds(failing):
            return failing
        on_discs, on_parts = self.judged(discs, edits)
        excess = self._excess(on_discs)
        return {**excess, **self._excess(on_parts)} if holds(excess) else excess

    def failing(self, discs: Discs, edits: Edits) -> Excess:
        """Not empty if a change does not cure, or leaves no disc."""
        try:
            found = [each for each in self.judged(discs, edits)[0] if each.severity in BROKEN]
        except (GeometryError, SceneError):
            return UNKNOWN
        fault = (*self.condition.names, *CAUSES)
        if any(each.name.removeprefix(f"{RETURN}: ").startswith(fault) for each in found):
            return UNKNOWN
        return UNKNOWN if any(map(self._is_fatal, found)) else {}

    def _is_fatal(self, found: Finding) -> bool:
        return found.severity in NO_OUTLINE and found.name not in self.before

    def _excess(self, findings: Iterable[Finding]) -> Excess:
        """Of the findings that break a limit that held, and of those that hold."""
        excess: dict[str, float] = {}
        for each in findings:
            broken, beyond = each.severity in BROKEN, math.inf
            if each.value is not None and each.limit is not None:
                beyond = abs(each.value - each.limit)
            if each.name not in self.before and (broken or beyond < math.inf):
                beyond = beyond if broken else -beyond
                excess[each.name] = max(beyond, excess.get(each.name, beyond))
        return excess

    def finished(self, cure: Cure, discs: Discs | None = None) -> Cure:
        """The cure of this fault that makes these `discs`, which says what is broken then."""
        cure = replace(cure, fault=self.fault)
        every = () if discs is None else chain(*self.judged(discs, edits_of(cure)))
        found = [each for each in every if each.severity in BROKEN]
        if not found:
            return cure
        new = [each for each in found if each.name not in self.before]
        old = dict.fromkeys(each.name for each in found if each.name in self.before)
        words = (
            [f"breaks {listed([_stated(each, self.unit) for each in new], NAMED)}"] if new else []
        )
        words += [f"leaves {listed([*old], NAMED)} broken"] if old else []
        names = tuple(dict.fromkeys(each.name for each in new))
        return replace(cure, breaks=names, sentence=f"{cure.sentence}, but {' and '.join(words)}")


def _stated(found: Finding, unit: LengthUnit) -> str:
    """A broken limit, with what it is broken by."""
    if found.value is None or found.limit is None:
        return f"{found.name} ({found.sentence})"
    value, limit = (f"{each:.4g} {found.unit}".rstrip() for each in (found.value, found.limit))
    return in_unit(f"{found.name} ({value}, limit {limit})", unit, (found.value, found.limit))


def edits_of(cure: Cure) -> dict[str, Value]:
    """What a cure, which works, writes into the scene."""
    assert cure.value_to is not None
    changes = (Change(cure.key, cure.value_from, cure.value_to), *cure.also)
    return {each.key: each.value_to for each in changes}
