"""What one design answers, and by how much it breaks limits: computed here or in a worker."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from camgeo.check.finding import NO_OUTLINE, Finding
from camgeo.design import Design
from camgeo.optimise.task import Sought, Task
from camgeo.sweep.family import Point
from camgeo.sweep.reading import Reading, judged, reason_of
from camgeo.sweep.rows import Row, Work

IMPOSSIBLE: Final = 1e4
"""Violation of a design that there is not."""

UNANSWERED: Final = 1e2
"""Of each answer that is missing, far more than of limits."""

REFUSED: Final = 10.0
"""Of each finding that rules out the disc, besides how far it is beyond its limit."""


@dataclass(frozen=True, slots=True, eq=False)
class Verdict(Row):
    """A row with what a search needs of it.

    Attributes
    ----------
    values : as of a row, all of them numbers.
    costs : (k,) of the objectives, less being better; NaN where there is no answer.
    margins : relative distances from limits by their names, negative beyond them.
    violation : 0 if all limits are kept, else a measure of how far from that the design is.
    broken : in words, what is violated, the worst first.
    remarks : findings with broken limits that are left out of account.
    """

    values: tuple[float | None, ...]
    costs: tuple[float, ...] = ()
    margins: Mapping[str, float] = field(default_factory=dict)
    violation: float = 0.0
    broken: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()

    # Not as rows are compared, of which it has more than they: costs may be NaN.
    __eq__ = object.__eq__
    __hash__ = object.__hash__


@dataclass(frozen=True)
class Judge(Work):
    """Work whose rows are verdicts.

    Attributes
    ----------
    sought : the objectives and the limits.
    """

    sought: Sought

    @classmethod
    def on(cls, task: Task) -> Judge:
        """The work on the designs of a task."""
        work = Work.of(task.family, task.asked)
        sought = Sought(task.goals, task.limits, task.ignored)
        return cls(work.text, work.contents, work.keys, work.asked, work.versions, sought)

    def nothing(self, point: Point, reason: str) -> Verdict:
        """See `Work.nothing`."""
        count, costs = len(self.asked), (np.nan,) * len(self.sought.goals)
        return Verdict(
            point, (None,) * count, ("",) * count, reason, costs, {}, IMPOSSIBLE, (reason,)
        )

    def answers(self, design: Design, point: Point, found: Sequence[Reading]) -> Verdict:
        """See `Work.answers`."""
        judging = _Judging(self.sought)
        readings = dict(zip(self.asked, found, strict=True))
        costs: list[float] = []
        for goal in self.sought.goals:
            reading = readings[goal.asked]
            if isinstance(reading.value, float | int):
                costs.append(goal.cost(float(reading.value)))
            else:
                costs.append(np.nan)
                judging.unanswered(goal.asked.word, reading.reason or "it does not arise")
        for limit in self.sought.limits:
            reading = readings[limit.asked]
            if isinstance(reading.value, float | int):
                value = float(reading.value)
                judging.limited(str(limit), limit.margin(value), value)
            elif reading.reason:
                judging.unanswered(limit.asked.word, reading.reason)
        try:
            for finding in judged(design, machining=self.sought.machining):
                judging.judge(finding)
        except MemoryError:
            raise
        except Exception as error:
            judging.unanswered("findings", reason_of(error))
        values = tuple(
            float(each.value) if isinstance(each.value, float | int) else None
            for each in readings.values()
        )
        units = tuple(each.unit for each in readings.values())
        return Verdict(
            point, values, units, "", tuple(costs), judging.margins, judging.violation,
            judging.broken, tuple(judging.remarks),
        )  # fmt: skip


class _Judging:
    """Gathers what one design violates."""

    def __init__(self, sought: Sought) -> None:
        self.margins: dict[str, float] = {}
        self.remarks: list[str] = []
        self._sought = sought
        self._found: list[tuple[float, str]] = []

    @property
    def violation(self) -> float:
        return sum((share for share, _ in self._found), 0.0)

    @property
    def broken(self) -> tuple[str, ...]:
        return tuple(words for _, words in sorted(self._found, key=lambda each: -each[0]))

    def unanswered(self, word: str, why: str) -> None:
        self._found.append((UNANSWERED, f"{word}: {why}"))

    def limited(self, name: str, margin: float, value: float) -> None:
        """A limit stated with the call."""
        self.margins[name] = margin
        if margin < 0.0:
            self._found.append((_share(margin), f"{name}: it is {value:.7g}"))

    def judge(self, finding: Finding) -> None:
        """A limit of the scene, or what rules out the disc."""
        margin, name = _margin(finding), "-".join(finding.name.split())
        if finding.severity in NO_OUTLINE:
            self._found.append((REFUSED + _share(margin), finding.sentence))
        elif not self._sought.matters(name):
            if finding.severity == "broken":
                self.remarks.append(finding.sentence)
            return
        elif finding.severity == "broken":
            self._found.append((_share(margin), finding.sentence))
        if finding.limit is not None and finding.severity != "warning":
            self.margins[name] = min(margin, self.margins.get(name, np.inf))


def _margin(finding: Finding) -> float:
    """Relative distance of a value from its limit, negative if that is broken."""
    if finding.value is None or finding.limit is None:
        return 1.0 if finding.severity in ("ok", "warning") else -1.0
    apart = abs(finding.value - finding.limit) / (abs(finding.limit) or 1.0)
    return apart if finding.severity in ("ok", "warning") else -apart


def _share(margin: float) -> float:
    """A measure above 0 and below 1 of how far a limit is exceeded."""
    beyond = min(abs(margin), 1e9)
    return max(beyond / (1.0 + beyond), 1e-12)
