"""Running an optimisation: the search, the best design, and that with short numbers."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.optimise.search import direction, directions, search
from camgeo.optimise.task import Task
from camgeo.optimise.trials import Trial, Trials
from camgeo.scene.scene import Scene
from camgeo.sweep.engine import Engine, Loop
from camgeo.sweep.pareto import front
from camgeo.wording import counted

MOST: Final = 1_000_000

LOST: Final = 2e-6
"""Of an objective that short numbers may cost, relative to it; else they get another decimal."""

FINER: Final = 9
"""Decimals that may be added."""

INTERRUPTED: Final = "interrupted"


@dataclass(frozen=True, slots=True)
class Found:
    """What an optimisation found.

    Attributes
    ----------
    task : what was sought.
    seed : of what was drawn.
    most : designs that were allowed.
    trials : all designs that were tried, in their order.
    start : the design of the scene itself; None if it lies outside the ranges.
    best : the best design; of several objectives one in the middle of the front; if none keeps the
        limits, that which violates them least.
    made : the best design with short numbers; None if no design keeps the limits.
    front : designs that no other one beats in all objectives; those that keep the limits.
    ended : why no more were tried.
    """

    task: Task
    seed: int
    most: int
    trials: tuple[Trial, ...]
    start: Trial | None
    best: Trial
    made: Trial | None
    front: tuple[Trial, ...]
    ended: str

    @property
    def scene(self) -> Scene | None:
        """The scene with the values of `made`."""
        return None if self.made is None else self.task.family.scene_of(self.made.point)

    @property
    def interrupted(self) -> bool:
        """Whether Ctrl-C ended the search."""
        return self.ended == INTERRUPTED


def optimise(
    task: Task,
    *,
    seed: int | None = None,
    evaluations: int | None = None,
    seconds: float | None = None,
    engine: Engine | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> Found:
    """Search for the best design; the same seed finds the same, unless time ends the search.

    Parameters
    ----------
    seed, evaluations, seconds : as of `camgeo.optimise.task.Effort`, in place of what the task
        says; a few more designs are tried for short numbers.
    engine : where designs are computed of which several are known at once, those of a generation;
        None for this process. Where they are computed changes nothing of what is found.
    progress : called with words on how far the search is.

    Ctrl-C ends the search; what was found until then is the answer, if there is anything.

    Raises
    ------
    GeometryError
        For numbers that are none.
    """
    effort = task.effort
    seed = effort.seed if seed is None else seed
    evaluations = effort.evaluations if evaluations is None else evaluations
    seconds = effort.seconds if seconds is None else seconds
    if not 1 <= evaluations <= MOST:
        message = f"must be from 1 to {MOST:,}"
        raise GeometryError(message, "evaluations", str(evaluations))
    if not 0 <= seed < 2**63:
        raise GeometryError("must be a whole number from 0 to 2^63 - 1", "seed", str(seed))
    if seconds is not None and not seconds > 0.0:
        raise GeometryError("must be above 0", "seconds", f"{seconds:g}")
    engine = engine or Loop()
    trials = Trials(task, evaluations, seconds, _Watch(task, progress), engine)
    with engine.held():
        ended = _searched(trials, seed)
        on_front = _front(trials.made)
        best = _best(trials, on_front)
        short = _short(trials, best) if best.feasible else None
    place = trials.space.place_of(task.family.scene)
    own = None if place is None else trials.space.point(place)
    start = next((each for each in trials.made if each.point == own), None)
    return Found(task, seed, evaluations, trials.made, start, best, short, on_front, ended)


def _searched(trials: Trials, seed: int) -> str:
    """Search; why it ended, if that was not before anything was found."""
    try:
        return search(trials, seed)
    except KeyboardInterrupt as stop:
        if type(stop) is not KeyboardInterrupt and stop.args[:1] != (2,):  # not Ctrl-C
            raise
        if not len(trials):
            raise
        return INTERRUPTED


class _Watch:
    """Tells how far a search is."""

    def __init__(self, task: Task, progress: Callable[[str], None]) -> None:
        self._goal = task.goals[0]
        self._progress = progress
        self._best = np.inf

    def __call__(self, trials: Trials) -> None:
        last = trials.last
        if last.feasible:
            self._best = min(self._best, last.costs[0])
        count, elapsed = len(trials), time.monotonic() - trials.started
        words = f"{count:,} of at most {counted(trials.most, 'design')}"
        if elapsed > 0.0:
            words += f", {count / elapsed:.3g}/s"
        if np.isfinite(self._best):
            value = self._best if self._goal.sense == "least" else -self._best
            words += f", {self._goal.asked.word} {value:.7g}"
        else:
            words += ", none keeps all limits yet"
        self._progress(words)


def _front(trials: tuple[Trial, ...]) -> tuple[Trial, ...]:
    """The designs within limits that no other one beats, ordered by the first objective."""
    kept = [each for each in trials if each.feasible]
    if not kept:
        return ()
    mask = front(np.array([each.costs for each in kept]))
    found = [each for each, on in zip(kept, mask, strict=True) if on]
    return tuple(sorted(found, key=lambda each: (*each.costs, each.number)))


def _best(trials: Trials, on_front: tuple[Trial, ...]) -> Trial:
    ways = directions(len(trials.task.goals))
    if not on_front:
        return direction(ways[0], trials).best(trials.made)
    if len(ways[0]) == 1:
        return direction(ways[0], trials).best(on_front)
    even = np.full(len(ways[0]), 1.0 / len(ways[0]))
    return direction(even, trials).best(on_front)


def _short(trials: Trials, best: Trial) -> Trial:
    """The best design with numbers as short as keep the limits and cost next to nothing."""
    if best.place is None or not trials.space.continuous.any():
        return best
    for finer in range(FINER):
        tried = trials.all_of(trials.space.rounded(best.place, finer))
        kept = [each for each in tried if each.feasible and _equal(each, best)]
        if kept:
            return min(kept, key=lambda each: each.costs)
    return best


def _equal(one: Trial, best: Trial) -> bool:
    """Whether no cost of a design is more than a little above that of the best."""
    pairs = zip(one.costs, best.costs, strict=True)
    return all(mine <= cost + LOST * (abs(cost) or 1.0) for mine, cost in pairs)
