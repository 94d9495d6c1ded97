"""What is to be cured: a fault of a design, the limits that held, and the verdict on changes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Final

from camgeo.check.cures.conditions import Condition, Conditions, Discs
from camgeo.check.cures.cure import Change, Cure, Value
from camgeo.check.finding import BROKEN, NO_OUTLINE, RETURN, Finding
from camgeo.errors import GeometryError, SceneError
from camgeo.units import LengthUnit, in_unit
from camgeo.wording import listed

Edits = Mapping[str, Value]
"""New values by key, in the unit of the scene or in degrees."""

CAUSES: Final = ("outline-", "curvature", "standstill")
"""Beginnings of the names of findings with which nothing is known of undercut."""

PART: Final = "part"
"""Name of the finding that a disc is there, and its part is not."""

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
    judged : the findings on changed discs, which the edits make; SceneError or GeometryError if
        there are no such.
    """

    fault: str
    condition: Condition
    held: Conditions
    discs: Discs
    unit: LengthUnit
    before: frozenset[str]
    judged: Callable[[Discs, Edits], Iterable[Finding]]

    @property
    def stages(self) -> Iterator[tuple[Conditions, Callable[[Discs, Edits], bool]]]:
        """Conditions and verdicts by which a cure is sought: first one that breaks nothing, then
        one that cures.
        """
        least = (self.condition, *(each for each in self.held if each.vital))
        every = (self.condition, *self.held)
        yield every, lambda discs, edits: self.newly_broken(discs, edits) == ()
        yield least, lambda discs, edits: self.newly_broken(discs, edits) is not None

    def newly_broken(self, discs: Discs, edits: Edits) -> tuple[Finding, ...] | None:
        """The limits that held and are broken by a change; None if it does not cure, or leaves no
        disc.
        """
        found = self._broken(discs, edits)
        new = tuple(each for each in found or () if each.name not in self.before)
        fatal = any(each.severity in NO_OUTLINE and each.name != PART for each in new)
        return None if found is None or fatal else new

    def _broken(self, discs: Discs, edits: Edits) -> list[Finding] | None:
        """All that is broken after a change; None if the fault is among it."""
        try:
            found = [each for each in self.judged(discs, edits) if each.severity in BROKEN]
        except (GeometryError, SceneError):
            return None
        fault = (*self.condition.names, *CAUSES)
        if any(each.name.removeprefix(f"{RETURN}: ").startswith(fault) for each in found):
            return None
        return found

    def finished(self, cure: Cure, discs: Discs | None = None) -> Cure:
        """The cure of this fault that makes these `discs`, which says what is broken then."""
        cure = replace(cure, fault=self.fault)
        found = None if discs is None else self._broken(discs, edits_of(cure))
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
