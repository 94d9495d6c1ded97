"""Designs that an optimisation has tried: what they answer, and by how much they break limits."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping
from contextlib import closing
from dataclasses import dataclass
from typing import Final, cast

import numpy as np

from camgeo.numeric.arrays import FloatArray
from camgeo.optimise.judging import Judge, Verdict
from camgeo.optimise.space import Space
from camgeo.optimise.task import Task
from camgeo.sweep.engine import Engine, Loop
from camgeo.sweep.family import Point, mark
from camgeo.wording import counted

DUMB: Final = 20
"""Designs after which an objective that none has answered will have no answer."""


class SpentError(Exception):
    """The designs for one direction of the search have been tried."""


class StoppedError(Exception):
    """The search ends here; the message is why."""


@dataclass(frozen=True, slots=True, eq=False)
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
    seconds : that may pass before others are; None for no limit.
    told : called after each design.
    engine : where several at once are computed; None for this process.

    Attributes
    ----------
    share : how many there may be before `at` and `all_at` raise SpentError.
    """

    def __init__(
        self,
        task: Task,
        most: int,
        seconds: float | None = None,
        told: Callable[[Trials], None] = lambda _: None,
        engine: Engine | None = None,
    ) -> None:
        self.task = task
        self.space = Space.of(task.family)
        self.most = most
        self.share = most
        self.started = time.monotonic()
        self._judge = Judge.on(task)
        self._engine = engine or Loop()
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
        """The design at a place; see `all_at`."""
        return self.all_at([place])[0]

    def all_at(self, places: Iterable[FloatArray]) -> list[Trial]:
        """The designs at some places, numbered in this order, wherever they are computed.

        Raises StoppedError if no more may be computed, or if an objective is never answered,
        SpentError if no more may be for now; those that still may are computed before.
        """
        points = [(self.space.point(place), np.array(place, dtype=float)) for place in places]
        new = {mark(point): (point, place) for point, place in reversed(points)}
        names = dict.fromkeys(mark(point) for point, _ in points)
        while left := [new[name] for name in names if name not in self._known]:
            self._compute(left[: self._room()], timed=True)
        return [self._known[mark(point)] for point, _ in points]

    def all_of(self, points: Iterable[Point]) -> list[Trial]:
        """The designs with these values, however many were computed before."""
        wanted = {mark(point): point for point in points}
        self._compute([(point, None) for name, point in wanted.items() if name not in self._known])
        return [self._known[name] for name in wanted]

    def _room(self) -> int:
        """How many designs may be computed before this is asked again; at least 1, or it raises."""
        count, silent = len(self._known), not self._answered.all()
        if count >= self.most:
            raise StoppedError(f"{counted(self.most, 'design')} were allowed")
        if self._late:
            raise StoppedError(f"{self._seconds:g} s were allowed")
        if count >= DUMB and silent:
            goal = self.task.goals[int(np.argmin(self._answered))].asked.word
            told = (words for each in self.made for words in each.broken)
            why = next((words for words in told if words.startswith(f"{goal}: ")), goal)
            raise StoppedError(f"no design has an answer to {why}")
        if count >= self.share:
            raise SpentError
        return min(self.most, self.share, DUMB if silent else self.most) - count

    @property
    def _late(self) -> bool:
        return self._seconds is not None and time.monotonic() - self.started > self._seconds

    def _compute(
        self, wanted: list[tuple[Point, FloatArray | None]], *, timed: bool = False
    ) -> None:
        """Compute designs; whatever ends it, those that are finished are kept, in their order."""
        engine = self._engine if len(wanted) > 1 else Loop()
        found: dict[str, Verdict] = {}
        left = list(reversed(wanted))
        try:
            with closing(engine.rows(self._judge, iter([point for point, _ in wanted]))) as chunks:
                for rows in chunks:
                    found |= {mark(row.point): cast("Verdict", row) for row in rows}
                    while left and mark(left[-1][0]) in found:
                        self._add(*left.pop(), found)
                    if timed and self._late:
                        break
        finally:
            for point, place in reversed(left):
                if mark(point) in found:
                    self._add(point, place, found)

    def _add(self, point: Point, place: FloatArray | None, found: Mapping[str, Verdict]) -> None:
        verdict = found[mark(point)]
        self._known[mark(point)] = Trial(
            len(self._known) + 1, point, place, verdict.values, verdict.units,
            verdict.costs, verdict.margins, verdict.violation, verdict.broken, verdict.remarks,
        )  # fmt: skip
        self._answered |= ~np.isnan(verdict.costs)
        self._told(self)
