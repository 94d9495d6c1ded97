"""An optimisation: its objectives and limits, its variables, the search, and its result."""

from __future__ import annotations

import contextlib
import math
import re
import time
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field, fields, replace
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal
from itertools import combinations_with_replacement, islice, product
from typing import Any, Final, Literal, cast

import numpy as np

from camgeo.check.finding import NO_OUTLINE, Finding
from camgeo.design.design import Design
from camgeo.errors import GeometryError
from camgeo.numeric.arrays import BoolArray, FloatArray
from camgeo.scene.keys import tree_value
from camgeo.scene.scene import Scene
from camgeo.scene.values import OPTIMISE, Value, plain, value_path
from camgeo.studies.sweep.family import (
    Family,
    Point,
    Range,
    Sample,
    Variable,
    family_of,
    mark,
    stated_variables,
)
from camgeo.studies.sweep.rows import (
    VERDICT,
    DesignReading,
    DesignRow,
    Engine,
    Loop,
    Question,
    Work,
    all_findings,
    canonical,
    failure_reason,
    parse_questions,
)
from camgeo.units import counted

Sense = Literal["least", "largest"]

EVALUATIONS: Final = 2000
"""Number of designs that are tried unless another one is stated."""

MOST_GOALS: Final = 5
"""Largest number of objectives: with more, nearly every design is on the Pareto front."""

FORM: Final = re.compile(r"\s*(?P<word>[^<>=]+?)\s*(?P<sign><=|>=)\s*(?P<bound>[^<>=\s]+)\s*")

ALL: Final = "limits"
"""Leaves all limits of the scene out of account."""


@dataclass(frozen=True, slots=True)
class Goal:
    """An objective: a quantity, and whether it should be small or large."""

    question: Question
    sense: Sense

    def cost(self, value: float) -> float:
        """The value with the sign by which less is better."""
        return value if self.sense == "least" else -value


@dataclass(frozen=True, slots=True)
class Limit:
    """A limit that is stated with the call.

    Attributes
    ----------
    question : what is limited.
    sign : "<=" or ">=".
    bound : the limit, in the unit in which the answer is stated.
    """

    question: Question
    sign: str
    bound: float

    def __str__(self) -> str:
        return f"{self.question.word} {self.sign} {self.bound:g}"

    def margin(self, value: float) -> float:
        """Distance of the value from the limit, relative to the limit; negative beyond it."""
        distance = value - self.bound if self.sign == ">=" else self.bound - value
        return distance / (abs(self.bound) or 1.0)  # a limit of 0 has no scale of its own


@dataclass(frozen=True, slots=True)
class Effort:
    """How much the search may compute, unless the call says otherwise.

    Attributes
    ----------
    seed : of the random numbers.
    evaluations : largest number of designs that are tried.
    seconds : time after which no further design is tried; None for no limit.
    """

    seed: int = 0
    evaluations: int = EVALUATIONS
    seconds: float | None = None

    @classmethod
    def from_table(cls, table: Mapping[str, Any]) -> Effort:
        """The effort that the table `[optimise]` of a scene states."""
        seconds = table.get("seconds")
        return cls(
            int(table.get("seed", 0)),
            int(table.get("evaluations", EVALUATIONS)),
            None if seconds is None else float(seconds),
        )


@dataclass(frozen=True, slots=True)
class Criteria:
    """The criteria by which designs are compared.

    Attributes
    ----------
    goals : the objectives.
    limits : limits stated with the call; one on a finding replaces that of the scene.
    ignored : names of findings whose limits may be exceeded.
    """

    goals: tuple[Goal, ...]
    limits: tuple[Limit, ...]
    ignored: frozenset[str]

    @property
    def questions(self) -> tuple[Question, ...]:
        """The questions to each design, without repetition: objectives, then limits."""
        questions = [
            *(goal.question for goal in self.goals),
            *(limit.question for limit in self.limits),
        ]
        return tuple(dict.fromkeys(questions))

    @property
    def replaced(self) -> frozenset[str]:
        """Names of findings whose limits in the scene are replaced by those of the call."""
        return frozenset(
            limit.question.name for limit in self.limits if limit.question.how == "value"
        )

    @property
    def machining(self) -> bool:
        """Whether findings on the milling programs count.

        They do if the machining time is asked for: who minimizes it means to run the programs.
        """
        return any(question.group == "machining" for question in self.questions)

    def matters(self, name: str) -> bool:
        """Whether the scene's limit for the finding `name` has to be kept."""
        return ALL not in self.ignored and name not in self.ignored | self.replaced


@dataclass(frozen=True, slots=True)
class Task(Criteria):
    """The criteria, and the designs among which the best one is searched for.

    Attributes
    ----------
    family : the designs; its ranges without a count are continuous variables.
    effort : how much the search may compute.
    """

    family: Family
    effort: Effort


def task_of(
    scene: Scene,
    vary: Sequence[str | Variable] = (),
    *,
    least: Iterable[str] = (),
    largest: Iterable[str] = (),
    keep: Iterable[str] = (),
    ignore: Iterable[str] = (),
) -> Task:
    """The task from texts as on the command line, and from `[optimise]` in the scene.

    Parameters
    ----------
    vary : variables; if there are none, those that the scene states in `[optimise]`, else those in
        `[sweep]`.
    least, largest : objectives, named as in `camgeo.studies.sweep.rows`; if there are none at all,
        those of the scene.
    keep : limits, as "transmission-angle>=50"; if there are none, those of `[optimise]`.
    ignore : names of findings whose limits in the scene do not count, or "limits" for all of them;
        if there are none, those of `[optimise]`.

    Raises
    ------
    SceneError
        For an unknown key, with the nearest one.
    GeometryError
        For an empty range, a malformed limit, and missing, repeated or too many objectives.
    UnknownNameError
        For a name that no finding or column has, with the nearest one.
    """
    # In a sample ranges need no count; the number of samples is not used here.
    family = family_of(scene, vary or stated_variables(scene, OPTIMISE), Sample(1))
    table = scene.values.get(OPTIMISE, {})
    least, largest = tuple(least), tuple(largest)
    if not least and not largest:
        least, largest = table.get("least", ()), table.get("largest", ())
    keep, ignore = tuple(keep) or table.get("keep", ()), tuple(ignore) or table.get("ignore", ())
    design = Design(family.scene)
    goals = (
        *(Goal(_number(design, word), "least") for word in least),
        *(Goal(_number(design, word), "largest") for word in largest),
    )
    names = [goal.question.word for goal in goals]
    if not goals:
        raise GeometryError("names no objective: state one with --least or --largest", "least")
    if len(set(names)) < len(names):
        raise GeometryError("names an objective twice", "least", ", ".join(names))
    if len(goals) > MOST_GOALS:
        message = f"{len(goals)} objectives are more than {MOST_GOALS}"
        raise GeometryError(message, "least", ", ".join(names))
    limits = tuple(_limit(design, text) for text in keep)
    words = [canonical(word) for word in ignore]
    named = [word for word in words if word != ALL]
    ignored = [question.name for question in parse_questions(design, named)] if named else []
    everything = [ALL] if ALL in words else []
    return Task(goals, limits, frozenset([*ignored, *everything]), family, Effort.from_table(table))


def _number(design: Design, word: str) -> Question:
    (question,) = parse_questions(design, [word])
    if question.name == VERDICT and question.how == "value":
        raise GeometryError("is a word, which can be neither small nor large", VERDICT)
    return replace(question, word=canonical(word))


def _limit(design: Design, text: str) -> Limit:
    parts = FORM.fullmatch(text)
    bound = math.nan
    if parts is not None:
        with contextlib.suppress(ValueError):
            bound = float(parts["bound"])
    if parts is None or not math.isfinite(bound):
        message = 'must be NAME>=NUMBER or NAME<=NUMBER, e.g. "transmission-angle>=50"'
        raise GeometryError(message, "keep", text)
    return Limit(_number(design, parts["word"]), parts["sign"], bound)


# -- space ----------------------------------------------------------------------------------------
# Designs as places in a box, with one side for each variable: a range of numbers, or the places of
# a list.


DIGITS: Final = 6
"""Short numbers differ from a value by at most 10^-6 of it."""

SMALL: Final = 9
"""Near 0 they differ from it by at most 10^-9 of the range."""


@dataclass(frozen=True, slots=True)
class Space:
    """The box of the variables of a family.

    The side of a continuous variable goes from 0 at the start of its range to 1 at its end. The
    side of a list, or of a range with a count, has the places from 0 to the count less 1.

    Attributes
    ----------
    variables : those of the family.
    """

    variables: tuple[Variable, ...]

    @property
    def continuous(self) -> BoolArray:
        """(n,) which variables can have any number of their range."""
        return np.array([_continuous(variable) is not None for variable in self.variables])

    @property
    def upper(self) -> FloatArray:
        """(n,) upper ends of the sides; the lower ones are 0."""
        return np.array(
            [
                1.0 if _continuous(variable) else variable.values.count - 1.0
                for variable in self.variables
            ]
        )

    @property
    def count(self) -> int | None:
        """Number of designs; None if a variable is continuous."""
        total = 1
        for variable in self.variables:
            if _continuous(variable):
                return None
            total *= variable.values.count
        return total

    def point(self, place: FloatArray) -> Point:
        """The values of the design at a place (n,), which is first moved into the box."""
        values: list[Value] = []
        for variable, coordinate in zip(self.variables, place, strict=True):
            interval = _continuous(variable)
            if interval is None:
                number = round(min(max(float(coordinate), 0.0), variable.values.count - 1.0))
                values += variable.values.row(number)
            else:
                values += (plain(_interpolate(interval, float(coordinate))),) * interval.keys
        return tuple(values)

    def everything(self) -> Iterator[FloatArray]:
        """All places, if no variable is continuous."""
        for numbers in product(*(range(variable.values.count) for variable in self.variables)):
            yield np.array(numbers, dtype=float)

    def scene_place(self, scene: Scene) -> FloatArray | None:
        """(n,) place of the scene itself; None if it lacks a value, or has one outside the box."""
        tree: Any = scene.stated.scene.exact
        coordinates = []
        for variable in self.variables:
            stated = tuple(tree_value(tree, value_path(tree, key)) for key in variable.keys)
            interval = _continuous(variable)
            coordinate = (
                _list_position(variable, stated)
                if interval is None
                else _share_of_range(interval, stated)
            )
            if coordinate is None:
                return None
            coordinates.append(coordinate)
        return np.array(coordinates)

    def rounded(self, place: FloatArray, finer: int = 0) -> Iterator[Point]:
        """Designs near a place with short numbers: all combinations of rounding up and down.

        `finer` adds decimals. With more than six continuous variables there would be too many
        combinations: then there are only the nearest one and those with one number rounded the
        other way.
        """
        choices: list[Sequence[tuple[Value, ...]]] = []
        for variable, coordinate in zip(self.variables, place, strict=True):
            interval = _continuous(variable)
            if interval is None:
                choices.append([variable.values.row(round(float(coordinate)))])
                continue
            value = _interpolate(interval, float(coordinate))
            near = _short_numbers(value, interval, finer)
            choices.append([(plain(number),) * interval.keys for number in near])
        if sum(len(choice) > 1 for choice in choices) <= 6:
            combined: Iterator[tuple[tuple[Value, ...], ...]] = product(*choices)
        else:
            combined = _one_other(choices)
        for rows in combined:
            yield tuple(value for row in rows for value in row)


def _continuous(variable: Variable) -> Range | None:
    """The range of a continuous variable; None for others."""
    values = variable.values
    return values if isinstance(values, Range) and values.steps is None else None


def _interpolate(interval: Range, share: float) -> float:
    """The number of a range at a share from 0 to 1, exact at both ends."""
    start, stop = float(interval.start), float(interval.stop)
    if share >= 1.0:
        return stop
    return start if share <= 0.0 else start + (stop - start) * share


def _share_of_range(interval: Range, stated: tuple[Any, ...]) -> float | None:
    """Where the values of tied keys lie in a range, from 0 to 1; None if they differ or are
    outside.
    """
    if any(isinstance(value, bool) or not isinstance(value, int | Decimal) for value in stated):
        return None
    if any(value != stated[0] for value in stated):
        return None
    share = float((Decimal(stated[0]) - interval.start) / (interval.stop - interval.start))
    return share if 0.0 <= share <= 1.0 else None


def _list_position(variable: Variable, stated: tuple[Any, ...]) -> float | None:
    """Where the values lie in a list, from 0; None if they are not in it."""
    for number in range(variable.values.count):
        if all(_same(*pair) for pair in zip(variable.values.row(number), stated, strict=True)):
            return float(number)
    return None


def _same(one: Any, other: Any) -> bool:
    """Whether a value of a list is that of the scene; True is not 1."""
    if isinstance(one, bool) or isinstance(other, bool) or isinstance(one, str):
        return type(one) is type(other) and bool(one == other)
    return isinstance(other, int | Decimal) and float(one) == float(other)


def _short_numbers(value: float, interval: Range, finer: int) -> list[float]:
    """The short numbers next to a value within its range; the value itself without any."""
    low, high = sorted((interval.start, interval.stop))
    size = max(
        Decimal(abs(value)).scaleb(-DIGITS), (high - low).scaleb(-SMALL)
    )  # above 0, as the range is not empty
    last = Decimal(1).scaleb(size.adjusted() - finer)  # the unit of the last digit that is kept
    near = (Decimal(value).quantize(last, way) for way in (ROUND_FLOOR, ROUND_CEILING))
    numbers = [float(number) for number in dict.fromkeys(near) if low <= number <= high]
    return sorted(numbers, key=lambda each: abs(each - value)) or [value]


def _one_other(
    choices: Sequence[Sequence[tuple[Value, ...]]],
) -> Iterator[tuple[tuple[Value, ...], ...]]:
    """The first choice of all, and then each other choice of one with the first of all others."""
    first = [choice[0] for choice in choices]
    yield tuple(first)
    for number, choice in enumerate(choices):
        for other in choice[1:]:
            yield (*first[:number], other, *first[number + 1 :])


# -- pareto ---------------------------------------------------------------------------------------
# The Pareto front: designs that no other one dominates.


def front(costs: FloatArray) -> BoolArray:
    """(n,) which rows of `costs` (n, k), where less is better, are dominated by no other row.

    A row dominates another if it is nowhere worse and somewhere better, so equal rows are on the
    front together. A row with a NaN cannot be compared: it neither dominates nor is on the front.
    """
    undominated = np.zeros(len(costs), dtype=bool)
    whole = np.flatnonzero(~np.isnan(costs).any(axis=1))
    # In lexical order a row can only be dominated by an earlier one that is on the front itself.
    order = whole[np.lexsort(costs[whole].T[::-1])]
    front_costs = np.empty((0, costs.shape[1]))
    for row in order:
        here = costs[row]
        beaten = np.all(front_costs <= here, axis=1) & np.any(front_costs < here, axis=1)
        if not beaten.any():
            undominated[row] = True
            if not (len(front_costs) and np.array_equal(front_costs[-1], here)):
                front_costs = np.vstack((front_costs, here))
    return undominated


# -- optimise -------------------------------------------------------------------------------------
# Running an optimisation.


MOST: Final = 1_000_000

LOST: Final = 2e-6
"""How much worse an objective may become by short numbers, relative to it; else they get another
decimal."""

FINER: Final = 9
"""Largest number of decimals that are added."""

INTERRUPTED: Final = "interrupted"


@dataclass(frozen=True, slots=True)
class OptimisationResult:
    """The result of an optimisation.

    Attributes
    ----------
    task : what was optimised.
    seed : of the random numbers.
    most : number of designs that were allowed.
    trials : all designs that were tried, in their order.
    start : the design of the scene itself; None if it lies outside the ranges.
    best : the best design; with several objectives one in the middle of the front; if none keeps
        the limits, the one that violates them least.
    made : the best design with short numbers; None if no design keeps the limits.
    front : the Pareto front of the designs that keep the limits.
    ended : why the search ended.
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
        return None if self.made is None else self.task.family.design_scene(self.made.point)

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
) -> OptimisationResult:
    """Search for the best design; the same seed finds the same one, unless time ends the search.

    Parameters
    ----------
    seed, evaluations, seconds : as in `Effort`, in place of those of the task; a few more designs
        are tried for short numbers.
    engine : where the designs of a generation are computed; None for this process. The result does
        not depend on it.
    progress : called with words on how far the search is.

    Ctrl-C ends the search; the result is then that of the designs tried so far, if there are any.

    Raises
    ------
    GeometryError
        For a seed, a number of designs or a time out of range.
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
        on_front = _front(trials.computed)
        best = _best(trials, on_front)
        short = _short(trials, best) if best.feasible else None
    place = trials.space.scene_place(task.family.scene)
    scene_point = None if place is None else trials.space.point(place)
    start = next((trial for trial in trials.computed if trial.point == scene_point), None)
    return OptimisationResult(
        task, seed, evaluations, trials.computed, start, best, short, on_front, ended
    )


def _searched(trials: Trials, seed: int) -> str:
    """Search, and return why the search ended; KeyboardInterrupt if there is no design yet."""
    try:
        return search(trials, seed)
    except KeyboardInterrupt as stop:
        if type(stop) is not KeyboardInterrupt and stop.args[:1] != (2,):  # not Ctrl-C
            raise
        if not len(trials):
            raise
        return INTERRUPTED


class _Watch:
    """Reports how far a search is."""

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
            words += f", {self._goal.question.word} {value:.7g}"
        else:
            words += ", none keeps all limits yet"
        self._progress(words)


def _front(trials: tuple[Trial, ...]) -> tuple[Trial, ...]:
    """The Pareto front of the designs within limits, ordered by the first objective."""
    feasible = [trial for trial in trials if trial.feasible]
    if not feasible:
        return ()
    mask = front(np.array([trial.costs for trial in feasible]))
    front_trials = [trial for trial, undominated in zip(feasible, mask, strict=True) if undominated]
    return tuple(sorted(front_trials, key=lambda each: (*each.costs, each.number)))


def _best(trials: Trials, on_front: tuple[Trial, ...]) -> Trial:
    """The best design: by the first objective alone if none keeps the limits, else of the front."""
    ways = directions(len(trials.task.goals))
    if not on_front:
        return scaled_direction(ways[0], trials).best(trials.computed)
    if len(ways[0]) == 1:
        return scaled_direction(ways[0], trials).best(on_front)
    equal_weights = np.full(len(ways[0]), 1.0 / len(ways[0]))
    return scaled_direction(equal_weights, trials).best(on_front)


def _short(trials: Trials, best: Trial) -> Trial:
    """The best design with the shortest numbers that keep the limits and cost next to nothing."""
    if best.place is None or not trials.space.continuous.any():
        return best
    for finer in range(FINER):
        tried = trials.evaluate_points(trials.space.rounded(best.place, finer))
        feasible = [trial for trial in tried if trial.feasible and _equal(trial, best)]
        if feasible:
            return min(feasible, key=lambda each: each.costs)
    return best


def _equal(one: Trial, best: Trial) -> bool:
    """Whether no cost of a design is more than a little above that of the best."""
    pairs = zip(one.costs, best.costs, strict=True)
    return all(mine <= cost + LOST * (abs(cost) or 1.0) for mine, cost in pairs)


# -- search ---------------------------------------------------------------------------------------
# The search: differential evolution over the whole box, then local searches in its continuous
# variables.
#
# A design that exceeds a limit is worse than any that exceeds none, and the less it violates, the
# better (after K. Deb, Comput. Methods Appl. Mech. Engrg. 186, 2000, p. 311). Differential
# evolution (R. Storn and K. Price, J. Global Optim. 11, 1997, p. 341) is that of scipy, with whole
# numbers where there is a list; a generation is computed as a whole, so that several processes may
# share it. From its best design COBYQA (T. M. Ragonneau, Model-Based Derivative-Free Optimization
# Methods and Software, 2022) goes on with limits as constraints; then steps along each number and
# in random directions become smaller until they are negligible.


WALL: Final = 1e30
"""Least energy of designs that exceed limits: above that of all others."""

POPULATION: Final = 12
"""Number of designs of a generation for each variable, and its least number."""

CONVERGED: Final = 1e-7
"""Relative spread of a generation's energies at which it has converged."""

FIRST: Final = 0.02
"""First steps of local searches, as a fraction of a range."""

FINEST: Final = 1e-9
"""Last steps of local searches, as a fraction of a range."""

SHRINK, GROW = 0.5, 1.5
"""Factors of the step where no direction helps, and where one does."""

RANDOM_SETS: Final = 2
"""Number of random sets of orthogonal directions for each step."""

HALVINGS: Final = 34
"""Number of bisections between a design within limits and one beyond: to 10^-10 of the way."""

POLISHED: Final = 0.3
"""Share of the designs that is reserved for local searches."""

BATCH: Final = 1000
"""Number of designs that are handed out at once where all are tried."""

LATTICE: Final = {1: 1, 2: 6, 3: 3}
"""Number of parts into which weights are divided, by the number of objectives; 2 for more."""


@dataclass(frozen=True, slots=True, eq=False)
class Direction:
    """One way to weigh the objectives against each other.

    Attributes
    ----------
    weights : (k,) weights of the costs, with the sum 1.
    ideal, span : (k,) least costs and range of the costs on the front so far; used where several
        weights are not 0.
    """

    weights: FloatArray
    ideal: FloatArray
    span: FloatArray

    def cost(self, trial: Trial) -> float:
        """The weighted cost, where less is better; NaN where an objective has no answer.

        It is the largest weighted distance from the ideal (Chebyshev), plus a small part of all
        distances, so that the best design is not dominated by another one with the same distance.
        """
        costs = np.array(trial.costs)
        if np.isnan(costs).any():
            return float("nan")
        if np.count_nonzero(self.weights) == 1:
            return float(costs[self.weights > 0.0][0])
        distances = (costs - self.ideal) / self.span
        return float(np.max(self.weights * distances) + 1e-3 * np.sum(distances))

    def key(self, trial: Trial) -> tuple[float, float]:
        """Key by which designs are ordered, the best first; the first of equal ones wins."""
        if not trial.feasible:
            return (trial.violation, 0.0)
        return (0.0, self.cost(trial))

    def energy(self, trial: Trial) -> float:
        """The order as one number, for differential evolution."""
        return self.cost(trial) if trial.feasible else WALL * (1.0 + trial.violation)

    def best(self, trials: Iterable[Trial]) -> Trial:
        """The best of some trials."""
        return min(trials, key=self.key)


def directions(count: int) -> list[FloatArray]:
    """Weights of `count` objectives: each objective alone, then evenly spaced combinations."""
    parts = LATTICE.get(count, 2)
    all_weights = [np.eye(count)[number] for number in range(count)]
    for chosen in combinations_with_replacement(range(count), parts):
        weights = np.bincount(chosen, minlength=count) / parts
        if np.max(weights) < 1.0:
            all_weights.append(weights)
    return all_weights


def scaled_direction(weights: FloatArray, trials: Trials) -> Direction:
    """The direction with these weights, with the range of the costs of the trials so far."""
    costs = np.array([trial.costs for trial in trials.computed if trial.feasible])
    if not len(costs):
        return Direction(weights, np.zeros_like(weights), np.ones_like(weights))
    # The range is that between the best designs of each objective alone.
    ends = costs[np.argmin(costs, axis=0)]
    span = np.max(ends, axis=0) - np.min(ends, axis=0)
    return Direction(weights, np.min(costs, axis=0), np.where(span > 0.0, span, 1.0))


def evolve(trials: Trials, direction: Direction, seed: int, most: int) -> bool:
    """Differential evolution with at most `most` new designs; returns whether it converged."""
    from scipy.optimize import differential_evolution

    space = trials.space
    # A variable with a single value has no side along which to search.
    sides = np.flatnonzero(space.upper > 0.0)
    size = max(POPULATION, POPULATION * len(sides))
    start = _population(trials, direction, sides, seed, size)
    last = len(trials) + most

    def energies(_: object, generation: Iterable[FloatArray]) -> list[float]:
        members = np.array(list(generation))
        places = np.zeros((len(members), len(space.upper)))
        places[:, sides] = members
        return [direction.energy(trial) for trial in trials.evaluate_all(places)]

    def ended(*_: object, **__: object) -> bool:
        return len(trials) + size > last

    if ended():
        return False
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that it did not converge, which is reported elsewhere
        result = differential_evolution(
            float,  # a generation is computed as a whole
            [(0.0, space.upper[side]) for side in sides],
            integrality=~space.continuous[sides],
            init=start,
            rng=np.random.default_rng(seed),
            maxiter=10 * most // size + 10,  # more than `ended` allows
            tol=CONVERGED,
            polish=False,
            updating="deferred",
            workers=energies,
            callback=ended,
        )
    return bool(result.success)


def _population(
    trials: Trials, direction: Direction, sides: np.ndarray, seed: int, size: int
) -> FloatArray:
    """The first generation: a Latin hypercube, whose first rows are the best designs so far."""
    from scipy.stats import qmc

    space = trials.space
    shares = qmc.LatinHypercube(len(sides), rng=np.random.default_rng(seed)).random(size)
    generation: FloatArray = shares * space.upper[sides]
    whole = ~space.continuous[sides]
    # Each place of a list is equally likely: shares are cut into equal parts, and not rounded.
    counts = space.upper[sides][whole] + 1.0
    generation[:, whole] = np.minimum(np.floor(shares[:, whole] * counts), counts - 1.0)
    known = sorted(
        (trial for trial in trials.computed if trial.place is not None), key=direction.key
    )
    for row, trial in enumerate(known[: size // 3]):
        assert trial.place is not None
        generation[row] = trial.place[sides]
    return generation


def polish(trials: Trials, direction: Direction, seed: int) -> None:
    """Search locally from the best design so far, in the continuous variables."""
    free = np.flatnonzero(trials.space.continuous)
    start = direction.best(trial for trial in trials.computed if trial.place is not None)
    if not len(free) or not np.isfinite(direction.cost(start)):
        return
    # With several objectives the cost has edges, which no quadratic model of COBYQA fits.
    if np.count_nonzero(direction.weights) == 1:
        _follow(trials, direction, start, free)
    start = direction.best(trial for trial in trials.computed if trial.place is not None)
    _step(trials, direction, start, free, seed)


def _follow(trials: Trials, direction: Direction, start: Trial, free: np.ndarray) -> None:
    """COBYQA; if it ends beyond a limit, bisection back to the border of the allowed region."""
    from scipy.optimize import Bounds, NonlinearConstraint, minimize

    base = start.place
    assert base is not None
    names = tuple(start.margins)
    first = direction.cost(start)
    scale = abs(first) or 1.0

    def evaluate(numbers: FloatArray) -> Trial:
        place = base.copy()
        place[free] = np.clip(numbers, 0.0, 1.0)
        return trials.evaluate(place)

    def cost(numbers: FloatArray) -> float:
        trial_cost = direction.cost(evaluate(numbers))
        # A finite wall, as a model of the cost cannot be fitted to NaN.
        return trial_cost / scale if np.isfinite(trial_cost) else 1e6

    def margins(numbers: FloatArray) -> FloatArray:
        trial = evaluate(numbers)
        # A limit on which this design has no finding is kept, unless the design is impossible or
        # has no answer.
        missing = -1.0 if trial.violation >= 1.0 else 1.0
        limit_margins = [min(trial.margins.get(name, missing), 1.0) for name in names]
        return np.array([*limit_margins, -min(trial.violation, 1e6)])

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        result = minimize(
            cost,
            base[free],
            method="COBYQA",
            bounds=Bounds(np.zeros(len(free)), np.ones(len(free))),
            constraints=NonlinearConstraint(margins, 0.0, np.inf),
            options={
                "initial_tr_radius": FIRST,
                "final_tr_radius": FINEST,
                "maxfev": 60 * (len(free) + 1),
            },
        )
    beyond = evaluate(result.x)
    best = direction.best((start, *trials.computed))
    if beyond.feasible or not best.feasible or best.place is None:
        return
    low, high = best.place, np.array(beyond.place)
    # Between different places of a list there is nothing to bisect.
    if not np.array_equal(low[~trials.space.continuous], high[~trials.space.continuous]):
        return
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        trial = trials.evaluate(middle)
        if trial.feasible and direction.key(trial) <= direction.key(best):
            low, best = middle, trial
        else:
            high = middle


def _step(trials: Trials, direction: Direction, best: Trial, free: np.ndarray, seed: int) -> None:
    """Steps along each number, in random directions, and along the last successful direction.

    Where two limits meet at an angle, only few directions lie within both and improve the design:
    the axes alone would not find them.
    """
    generator = np.random.default_rng(seed)
    step, last = FIRST, np.zeros(len(free))
    while step > FINEST:
        turned = np.eye(len(free))
        if len(free) > 1:
            turned = np.vstack(
                (turned, *(_rotation(generator, len(free)) for _ in range(RANDOM_SETS)))
            )
        ways = np.vstack((last, turned, -turned)) if last.any() else np.vstack((turned, -turned))
        for way in ways:
            assert best.place is not None
            place = best.place.copy()
            place[free] = np.clip(place[free] + step * way, 0.0, 1.0)
            trial = trials.evaluate(place)
            if trial.place is not None and direction.key(trial) < direction.key(best):
                best, last = trial, way
                step *= GROW
                break
        else:
            step *= SHRINK
            last = np.zeros(len(free))


def _rotation(generator: np.random.Generator, count: int) -> FloatArray:
    """(count, count) orthonormal vectors in random directions, uniformly distributed."""
    rotation: FloatArray = np.linalg.qr(generator.standard_normal((count, count)))[0].T
    return rotation


def search(trials: Trials, seed: int) -> str:
    """Try designs until the search ends; returns why it ended."""
    space, task = trials.space, trials.task
    try:
        start = space.scene_place(task.family.scene)
        if start is not None:
            trials.evaluate(start)
        if space.count is not None and space.count <= trials.most:
            places = space.everything()
            while batch := list(islice(places, BATCH)):
                trials.evaluate_all(batch)
            return "all designs were tried"
        # One search for each direction, each with an equal part of the designs that are left.
        ways = directions(len(task.goals))
        whole = True
        for number, weights in enumerate(ways):
            left = (trials.most - len(trials)) // (len(ways) - number)
            towards = scaled_direction(weights, trials)
            trials.share = len(trials) + left  # beyond which SpentError ends this direction
            try:
                together = evolve(trials, towards, seed + number, int((1.0 - POLISHED) * left))
                polish(trials, towards, seed + number)
            except SpentError:
                together = False
            whole &= together
    except StoppedError as stop:
        return str(stop)
    return "converged" if whole else f"{counted(trials.most, 'design')} were allowed"


# -- trials ---------------------------------------------------------------------------------------
# The designs that an optimisation has tried: their answers, and by how much they exceed limits.


DUMB: Final = 20
"""Number of designs without any answer after which an objective is given up."""


class SpentError(Exception):
    """The designs for one direction of the search have been tried."""


class StoppedError(Exception):
    """The search ends here; the message is why."""


class Trials:
    """All designs that were tried; each is computed once.

    Parameters
    ----------
    most : largest number of designs.
    seconds : time after which no further design is computed; None for no limit.
    notify : called after each design.
    engine : where several designs are computed at once; None for this process.

    Attributes
    ----------
    share : number of designs from which `evaluate` and `evaluate_all` raise SpentError.
    """

    def __init__(
        self,
        task: Task,
        most: int,
        seconds: float | None = None,
        notify: Callable[[Trials], None] = lambda _: None,
        engine: Engine | None = None,
    ) -> None:
        self.task = task
        self.space = Space(task.family.variables)
        self.most = most
        self.share = most
        self.started = time.monotonic()
        self._judge = Judge.for_task(task)
        self._engine = engine or Loop()
        self._seconds = seconds
        self._notify = notify
        self._known: dict[str, Trial] = {}
        self._answered = np.zeros(len(task.goals), dtype=bool)

    @property
    def computed(self) -> tuple[Trial, ...]:
        """The trials in the order in which they were computed."""
        return tuple(self._known.values())

    @property
    def last(self) -> Trial:
        """The trial that was computed last."""
        return next(reversed(self._known.values()))

    def __len__(self) -> int:
        return len(self._known)

    def evaluate(self, place: FloatArray) -> Trial:
        """The design at a place; see `evaluate_all`."""
        return self.evaluate_all([place])[0]

    def evaluate_all(self, places: Iterable[FloatArray]) -> list[Trial]:
        """The designs at some places, numbered in this order, wherever they are computed.

        Raises StoppedError if no more designs are allowed or an objective is never answered, and
        SpentError if no more are allowed for now. Designs that are still allowed are computed
        before that.
        """
        # Several places may be the same design, which keeps the first of them.
        points = [(self.space.point(place), np.array(place, dtype=float)) for place in places]
        new = {mark(point): (point, place) for point, place in reversed(points)}
        names = dict.fromkeys(mark(point) for point, _ in points)
        while left := [new[name] for name in names if name not in self._known]:
            self._compute(left[: self._room()], timed=True)
        return [self._known[mark(point)] for point, _ in points]

    def evaluate_points(self, points: Iterable[Point]) -> list[Trial]:
        """The designs with these values, even beyond the number of designs that is allowed."""
        wanted = {mark(point): point for point in points}
        self._compute([(point, None) for name, point in wanted.items() if name not in self._known])
        return [self._known[name] for name in wanted]

    def _room(self) -> int:
        """How many designs may be computed before this is called again: at least 1.

        Raises StoppedError or SpentError, see `evaluate_all`, if none may.
        """
        count, silent = len(self._known), not self._answered.all()
        if count >= self.most:
            raise StoppedError(f"{counted(self.most, 'design')} were allowed")
        if self._late:
            raise StoppedError(f"{self._seconds:g} s were allowed")
        if count >= DUMB and silent:
            goal = self.task.goals[int(np.argmin(self._answered))].question.word
            sentences = (words for trial in self.computed for words in trial.broken)
            why = next((words for words in sentences if words.startswith(f"{goal}: ")), goal)
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
        """Compute designs. Whatever interrupts it, finished ones are kept, in their order."""
        engine = self._engine if len(wanted) > 1 else Loop()
        verdicts: dict[str, RowVerdict] = {}
        left = list(reversed(wanted))
        try:
            with closing(engine.rows(self._judge, iter([point for point, _ in wanted]))) as chunks:
                for rows in chunks:
                    verdicts |= {mark(row.point): cast("RowVerdict", row) for row in rows}
                    # An engine returns rows in any order; trials are numbered in the order wanted.
                    while left and mark(left[-1][0]) in verdicts:
                        self._add(*left.pop(), verdicts)
                    if timed and self._late:
                        break
        finally:
            for point, place in reversed(left):
                if mark(point) in verdicts:
                    self._add(point, place, verdicts)

    def _add(
        self, point: Point, place: FloatArray | None, verdicts: Mapping[str, RowVerdict]
    ) -> None:
        verdict = verdicts[mark(point)]
        judged = {attribute.name: getattr(verdict, attribute.name) for attribute in fields(verdict)}
        self._known[mark(point)] = Trial(**judged, number=len(self._known) + 1, place=place)
        self._answered |= ~np.isnan(verdict.costs)
        self._notify(self)


# -- judging --------------------------------------------------------------------------------------
# The answers of one design, and by how much it exceeds limits: computed here or in a worker.


IMPOSSIBLE: Final = 1e4
"""Violation of a design that is impossible."""

UNANSWERED: Final = 1e2
"""Violation for each missing answer, far more than for exceeded limits."""

REFUSED: Final = 10.0
"""Violation for each finding that rules out the disc, in addition to that of its limit."""


@dataclass(frozen=True, slots=True, eq=False)
class RowVerdict(DesignRow):
    """A row with what a search needs to know of its design.

    Attributes
    ----------
    values : as in a row, all of them numbers.
    costs : (k,) costs of the objectives, where less is better; NaN where there is no answer.
    margins : relative distances from limits by their names, negative beyond them.
    violation : 0 if all limits are kept, else a measure of how much they are violated.
    broken : what is violated, in words, the worst first.
    remarks : sentences of findings whose exceeded limits do not count.
    """

    values: tuple[float | None, ...]
    costs: tuple[float, ...] = ()
    margins: Mapping[str, float] = field(default_factory=dict)
    violation: float = 0.0
    broken: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()

    # Compared by identity: costs may be NaN, which equals nothing, not even itself.
    __eq__ = object.__eq__
    __hash__ = object.__hash__


@dataclass(frozen=True, slots=True, eq=False)
class Trial(RowVerdict):
    """One design that was tried.

    Attributes
    ----------
    number : from 1, in the order of the trials.
    place : where it lies in the space; None for a design with rounded numbers.
    """

    number: int = 0
    place: FloatArray | None = None

    __eq__ = object.__eq__
    __hash__ = object.__hash__

    @property
    def feasible(self) -> bool:
        """Whether it keeps all limits."""
        return self.violation == 0.0


@dataclass(frozen=True)
class Judge(Work):
    """Work whose rows are verdicts.

    Attributes
    ----------
    criteria : the objectives and the limits.
    """

    criteria: Criteria

    @classmethod
    def for_task(cls, task: Task) -> Judge:
        """The work on the designs of a task."""
        work = Work.for_family(task.family, task.questions)
        criteria = Criteria(task.goals, task.limits, task.ignored)
        return cls(work.text, work.contents, work.keys, work.questions, work.versions, criteria)

    def nothing(self, point: Point, reason: str) -> RowVerdict:
        """See `Work.nothing`."""
        count, costs = len(self.questions), (np.nan,) * len(self.criteria.goals)
        return RowVerdict(
            point, (None,) * count, ("",) * count, reason, costs, {}, IMPOSSIBLE, (reason,)
        )

    def answers(
        self, design: Design, point: Point, readings: Sequence[DesignReading]
    ) -> RowVerdict:
        """See `Work.answers`."""
        judging = _Judging(self.criteria)
        reading_by_question = dict(zip(self.questions, readings, strict=True))
        costs: list[float] = []
        for goal in self.criteria.goals:
            reading = reading_by_question[goal.question]
            if isinstance(reading.value, float | int):
                costs.append(goal.cost(float(reading.value)))
            else:
                costs.append(np.nan)
                judging.unanswered(goal.question.word, reading.reason or "it does not arise")
        for limit in self.criteria.limits:
            reading = reading_by_question[limit.question]
            if isinstance(reading.value, float | int):
                value = float(reading.value)
                judging.limited(str(limit), limit.margin(value), value)
            elif reading.reason:
                judging.unanswered(limit.question.word, reading.reason)
        try:
            for finding in all_findings(design, machining=self.criteria.machining):
                judging.judge(finding)
        except MemoryError:
            raise
        except Exception as error:
            judging.unanswered("findings", failure_reason(error))
        values = tuple(
            float(reading.value) if isinstance(reading.value, float | int) else None
            for reading in reading_by_question.values()
        )
        units = tuple(reading.unit for reading in reading_by_question.values())
        return RowVerdict(
            point, values, units, "", tuple(costs), judging.margins, judging.violation,
            judging.broken, tuple(judging.remarks),
        )  # fmt: skip


class _Judging:
    """Collects what one design violates."""

    def __init__(self, criteria: Criteria) -> None:
        self.margins: dict[str, float] = {}
        self.remarks: list[str] = []
        self._criteria = criteria
        self._violations: list[tuple[float, str]] = []

    @property
    def violation(self) -> float:
        return sum((share for share, _ in self._violations), 0.0)

    @property
    def broken(self) -> tuple[str, ...]:
        return tuple(words for _, words in sorted(self._violations, key=lambda each: -each[0]))

    def unanswered(self, word: str, why: str) -> None:
        self._violations.append((UNANSWERED, f"{word}: {why}"))

    def limited(self, name: str, margin: float, value: float) -> None:
        """A limit stated with the call."""
        self.margins[name] = margin
        if margin < 0.0:
            self._violations.append((_share(margin), f"{name}: it is {value:.7g}"))

    def judge(self, finding: Finding) -> None:
        """A limit of the scene, or what rules out the disc."""
        margin, name = _margin(finding), "-".join(finding.name.split())
        if finding.severity in NO_OUTLINE:
            self._violations.append((REFUSED + _share(margin), finding.sentence))
        elif not self._criteria.matters(name):
            if finding.severity == "broken":
                self.remarks.append(finding.sentence)
            return
        elif finding.severity == "broken":
            self._violations.append((_share(margin), finding.sentence))
        if finding.limit is not None and finding.severity != "warning":
            self.margins[name] = min(margin, self.margins.get(name, np.inf))


def _margin(finding: Finding) -> float:
    """Relative distance of a value from its limit, negative if that is broken."""
    if finding.value is None or finding.limit is None:
        return 1.0 if finding.severity in ("ok", "warning") else -1.0
    distance = abs(finding.value - finding.limit) / (abs(finding.limit) or 1.0)
    return distance if finding.severity in ("ok", "warning") else -distance


def _share(margin: float) -> float:
    """A measure of how far a limit is exceeded, above 0 and below 1.

    It is bounded, so that no single limit outweighs a missing answer.
    """
    beyond = min(abs(margin), 1e9)
    return max(beyond / (1.0 + beyond), 1e-12)
