"""What `camgeo optimise` finds: the best design, its scene, and the record of the search."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from camgeo.answers.answer import BROKEN, FINE, Answer
from camgeo.optimise.optimise import Found
from camgeo.optimise.trials import Trial
from camgeo.scene.scene import Scene
from camgeo.scene.varied import Value
from camgeo.sweep.variables import Range, Variable


@dataclass(frozen=True, slots=True)
class Tried:
    """One design.

    Attributes
    ----------
    number : in the order of the trials, from 1.
    values : by the keys that vary.
    answers : by what was asked; None where there is none.
    violated : in words, the limits that it breaks, or why there is no such design; the worst first.
    """

    number: int
    values: Mapping[str, Value]
    answers: Mapping[str, float | None]
    violated: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Bound:
    """What a variable could be: numbers from `start` to `stop`, or one of `values`."""

    keys: tuple[str, ...]
    start: float | None
    stop: float | None
    values: tuple[tuple[Value, ...], ...]


@dataclass(frozen=True, slots=True)
class Objective:
    """What was sought, and in which unit it is stated."""

    asked: str
    sense: str
    unit: str


@dataclass(frozen=True, slots=True)
class Optimum(Answer):
    """What an optimisation found.

    Attributes
    ----------
    found : the task, all trials and the best.
    """

    command: ClassVar[str] = "optimise"

    found: Found

    @property
    def scene(self) -> Scene:
        """The scene that the search starts from."""
        return self.found.task.family.scene

    @property
    def objectives(self) -> tuple[Objective, ...]:
        """In their order."""
        asked = self.found.task.asked
        return tuple(
            Objective(goal.asked.word, goal.sense, self.units[asked.index(goal.asked)])
            for goal in self.found.task.goals
        )

    @property
    def units(self) -> tuple[str, ...]:
        """Of what was asked; empty where no design has an answer."""
        places = range(len(self.found.task.asked))
        rows = [each.units for each in self.found.trials if each.units]
        return tuple(next((row[place] for row in rows if row[place]), "") for place in places)

    @property
    def limits(self) -> tuple[str, ...]:
        """Stated with the call."""
        return tuple(map(str, self.found.task.limits))

    @property
    def ignored(self) -> tuple[str, ...]:
        """Findings whose limits in the scene were left out of account."""
        return tuple(sorted(self.found.task.ignored))

    @property
    def bounds(self) -> tuple[Bound, ...]:
        """Of the variables."""
        return tuple(map(_bound, self.found.task.family.variables))

    @property
    def evaluations(self) -> int:
        """Designs that were tried."""
        return len(self.found.trials)

    @property
    def kept(self) -> int:
        """Designs that keep all limits."""
        return sum(each.feasible for each in self.found.trials)

    @property
    def start(self) -> Tried | None:
        """The design of the scene; None if it is not within the bounds."""
        return None if self.found.start is None else self.tried(self.found.start)

    @property
    def best(self) -> Tried:
        """The best design as the search found it, or, if none keeps the limits, the nearest."""
        return self.tried(self.found.best)

    @property
    def written(self) -> Tried | None:
        """The best design with short numbers, as it is written; None if none keeps the limits."""
        return None if self.found.made is None else self.tried(self.found.made)

    @property
    def remarks(self) -> tuple[str, ...]:
        """Limits of the scene that the design breaks, and that were left out of account."""
        return () if self.found.made is None else self.found.made.remarks

    @property
    def front(self) -> tuple[Tried, ...]:
        """Of several objectives, the designs that no other one beats; else none."""
        several = len(self.found.task.goals) > 1
        return tuple(map(self.tried, self.found.front)) if several else ()

    @property
    def exit_code(self) -> int:
        """1 if no design keeps the limits."""
        return BROKEN if self.found.made is None else FINE

    def tried(self, trial: Trial) -> Tried:
        """A design with its keys and what was asked."""
        words = [each.word for each in self.found.task.asked]
        values = self.found.task.family.edits(trial.point)
        answers = dict(zip(words, trial.values, strict=True))
        return Tried(trial.number, values, answers, trial.broken)


def _bound(variable: Variable) -> Bound:
    values = variable.values
    if isinstance(values, Range) and values.steps is None:
        return Bound(variable.keys, float(values.start), float(values.stop), ())
    listed = tuple(values.at(place) for place in range(values.count))
    return Bound(variable.keys, None, None, listed)
