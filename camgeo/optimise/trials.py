"""Designs that an optimisation has tried: what they answer, and by how much they break limits."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.check.finding import NO_OUTLINE, Finding
from camgeo.design import Design
from camgeo.numeric.arrays import FloatArray
from camgeo.optimise.space import Space
from camgeo.optimise.task import Task
from camgeo.sweep.family import Point, mark
from camgeo.sweep.reading import judged, read, reason_of
from camgeo.sweep.rows import Work
from camgeo.wording import counted

IMPOSSIBLE: Final = 1e4
"""Violation of a design that there is not."""

UNANSWERED: Final = 1e2
"""Of each answer that is missing, far more than of limits."""

REFUSED: Final = 10.0
"""Of each finding that rules out the disc, besides how far it is beyond its limit."""

DUMB: Final = 20
"""Designs after which an objective that none has answered will have no answer."""


class SpentError(Exception):
    """The designs for one direction of the search have been tried."""


class StoppedError(Exception):
    """The search ends here; the message is why."""


@dataclass(frozen=True, slots=True)
class Trial:
    """One design that was tried.

    Attributes
    ----------
    number : from 1, in the order of the trials.
    point : the values that make it.
    place : where it lies in the space; None of a rounded one.
    values : of what the task asks; None where there is no answer.
    units : of the values, likewise.
    costs : (k,) of the objectives, less being better; NaN where there is no answer.
    margins : relative distances from limits by their names, negative beyond them.
    violation : 0 if all limits are kept, else a measure of how far from that the design is.
    broken : in words, what is violated, the worst first.
    remarks : findings with broken limits that the task leaves out of account.
    """

    number: int
    point: Point
    place: FloatArray | None
    values: tuple[float | None, ...]
    units: tuple[str, ...]
    costs: tuple[float, ...]
    margins: Mapping[str, float]
    violation: float
    broken: tuple[str, ...]
    remarks: tuple[str, ...] = ()

    @property
    def feasible(self) -> bool:
        """Whether it keeps all limits."""
        return self.violation == 0.0


class Trials:
    """All designs that were tried, each computed once.

    Parameters
    ----------
    most : designs that may be computed.
    seconds : that may pass before another is; None for no limit.
    told : called after each design.

    Attributes
    ----------
    share : how many there may be before `at` raises SpentError.
    """

    def __init__(
        self,
        task: Task,
        most: int,
        seconds: float | None = None,
        told: Callable[[Trials], None] = lambda _: None,
    ) -> None:
        self.task = task
        self.space = Space.of(task.family)
        self.most = most
        self.share = most
        self.started = time.monotonic()
        self._work = Work.of(task.family, task.asked)
        self._seconds = seconds
        self._told = told
        self._known: dict[str, Trial] = {}
        self._answered = np.zeros(len(task.goals), dtype=bool)

    @property
    def made(self) -> tuple[Trial, ...]:
        """In their order."""
        return tuple(self._known.values())

    @property
    def last(self) -> Trial:
        """The one that was computed last."""
        return next(reversed(self._known.values()))

    def __len__(self) -> int:
        return len(self._known)

    def at(self, place: FloatArray) -> Trial:
        """The design at a place.

        Raises StoppedError if no more may be computed, or if an objective is never answered,
        SpentError if no more may be for now.
        """
        point = self.space.point(place)
        known = self._known.get(mark(point))
        if known is not None:
            return known
        if len(self._known) >= self.most:
            raise StoppedError(f"{counted(self.most, 'design')} were allowed")
        if self._seconds is not None and time.monotonic() - self.started > self._seconds:
            raise StoppedError(f"{self._seconds:g} s were allowed")
        if len(self._known) >= DUMB and not self._answered.all():
            goal = self.task.goals[int(np.argmin(self._answered))].asked.word
            told = (words for each in self.made for words in each.broken)
            why = next((words for words in told if words.startswith(f"{goal}: ")), goal)
            raise StoppedError(f"no design has an answer to {why}")
        if len(self._known) >= self.share:
            raise SpentError
        return self.of(point, np.array(place, dtype=float))

    def of(self, point: Point, place: FloatArray | None = None) -> Trial:
        """The design with these values, however many were computed before."""
        name = mark(point)
        if name not in self._known:
            found = self._known[name] = self._tried(point, place)
            self._answered |= ~np.isnan(found.costs)
            self._told(self)
        return self._known[name]

    def _tried(self, point: Point, place: FloatArray | None) -> Trial:
        number, asked = len(self._known) + 1, self.task.asked
        try:
            design = Design(self._work.scene_of(point))
        except MemoryError:
            raise
        except Exception as error:
            none = (None,) * len(asked), ("",) * len(asked)
            no_costs = (np.nan,) * len(self.task.goals)
            return Trial(number, point, place, *none, no_costs, {}, IMPOSSIBLE, (reason_of(error),))
        judging = _Judging(self.task)
        readings = {each: read(design, each) for each in asked}
        costs: list[float] = []
        for goal in self.task.goals:
            found = readings[goal.asked]
            if isinstance(found.value, float | int):
                costs.append(goal.cost(float(found.value)))
            else:
                costs.append(np.nan)
                judging.unanswered(goal.asked.word, found.reason or "it does not arise")
        for limit in self.task.limits:
            found = readings[limit.asked]
            if isinstance(found.value, float | int):
                judging.limited(str(limit), limit.margin(float(found.value)), float(found.value))
            elif found.reason:
                judging.unanswered(limit.asked.word, found.reason)
        try:
            for finding in judged(design, machining=self.task.machining):
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
        return Trial(
            number, point, place, values, units, tuple(costs), judging.margins,
            judging.violation, judging.broken, tuple(judging.remarks),
        )  # fmt: skip


class _Judging:
    """Gathers what one design violates."""

    def __init__(self, task: Task) -> None:
        self.margins: dict[str, float] = {}
        self.remarks: list[str] = []
        self._task = task
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
        elif not self._task.matters(name):
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
