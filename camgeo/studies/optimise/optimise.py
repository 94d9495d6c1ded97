"""An optimisation: what it seeks and where, the search, and what it finds."""

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
"""Designs that are tried unless another number is stated."""

MOST_GOALS: Final = 5
"""Objectives; of more, nearly every design is on the front."""

FORM: Final = re.compile(r"\s*(?P<word>[^<>=]+?)\s*(?P<sign><=|>=)\s*(?P<bound>[^<>=\s]+)\s*")

ALL: Final = "limits"
"""Leaves all limits of the scene out of account."""


@dataclass(frozen=True, slots=True)
class Goal:
    """An objective: what is asked, and whether it should be small or large."""

    question: Question
    sense: Sense

    def cost(self, value: float) -> float:
        """The value so that less is better."""
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
        """How far the value is within the limit, relative to it; negative beyond."""
        distance = value - self.bound if self.sign == ">=" else self.bound - value
        return distance / (abs(self.bound) or 1.0)


@dataclass(frozen=True, slots=True)
class Effort:
    """How long is sought, unless the call says otherwise.

    Attributes
    ----------
    seed : of what is drawn.
    evaluations : designs that may be tried.
    seconds : after which no other is tried; None for no limit.
    """

    seed: int = 0
    evaluations: int = EVALUATIONS
    seconds: float | None = None

    @classmethod
    def from_table(cls, table: Mapping[str, Any]) -> Effort:
        """What a table of a scene states."""
        seconds = table.get("seconds")
        return cls(
            int(table.get("seed", 0)),
            int(table.get("evaluations", EVALUATIONS)),
            None if seconds is None else float(seconds),
        )


@dataclass(frozen=True, slots=True)
class Criteria:
    """What makes a design good or bad.

    Attributes
    ----------
    goals : the objectives.
    limits : stated with the call; one on a finding replaces that of the scene.
    ignored : findings of which a broken limit does not matter.
    """

    goals: tuple[Goal, ...]
    limits: tuple[Limit, ...]
    ignored: frozenset[str]

    @property
    def questions(self) -> tuple[Question, ...]:
        """What is asked of each design, each once: objectives, then limits."""
        questions = [
            *(goal.question for goal in self.goals),
            *(limit.question for limit in self.limits),
        ]
        return tuple(dict.fromkeys(questions))

    @property
    def replaced(self) -> frozenset[str]:
        """Findings whose limits in the scene have others in their place."""
        return frozenset(
            limit.question.name for limit in self.limits if limit.question.how == "value"
        )

    @property
    def machining(self) -> bool:
        """Whether the milling programs count: whoever asks for their time means to run them."""
        return any(question.group == "machining" for question in self.questions)

    def matters(self, name: str) -> bool:
        """Whether a broken limit of the scene, of the finding of that name, matters."""
        return ALL not in self.ignored and name not in self.ignored | self.replaced


@dataclass(frozen=True, slots=True)
class Task(Criteria):
    """What is sought, and where.

    Attributes
    ----------
    family : its variables, of which ranges without a count are continuous.
    effort : how long is sought.
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
    """The task from texts as of the command line, and from `[optimise]` in the scene.

    Parameters
    ----------
    vary : variables; if there are none, those that the scene states in `[optimise]`, else in
        `[sweep]`.
    least, largest : objectives, see `camgeo.studies.sweep.rows`; if there are none at all, those
    of the
        scene.
    keep : limits, as "transmission-angle>=50"; if there are none, those of `[optimise]`.
    ignore : findings whose limits in the scene do not count, or "limits" for all of them; likewise.

    Raises
    ------
    SceneError
        With a key that there is not, and the nearest one.
    GeometryError
        For an empty range, a limit that is none, and objectives that are none.
    UnknownNameError
        For a name that no finding or column has, with the nearest one.
    """
    # Of designs that are drawn, ranges need no count; how many is not used.
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
        raise GeometryError("names no objective: say what should be --least or --largest", "least")
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
        raise GeometryError("is a word, which is neither small nor large", VERDICT)
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
# Designs as places in a box: a side for each variable, with its numbers or places of a list.


DIGITS: Final = 6
"""A value is rounded by at most 10^-6 of itself."""

SMALL: Final = 9
"""Values near 0 are rounded to at most 10^-9 of the range."""


@dataclass(frozen=True, slots=True)
class Space:
    """The box of the variables of a family.

    A continuous variable has a side from 0 to 1, from the start of its range to its end; of a list,
    or a range with a count, the side has the places from 0.

    Attributes
    ----------
    variables : of the family.
    """

    variables: tuple[Variable, ...]

    @property
    def continuous(self) -> BoolArray:
        """(n,) which variables take any number of their range."""
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
        """How many designs there are; None if a variable is continuous."""
        total = 1
        for variable in self.variables:
            if _continuous(variable):
                return None
            total *= variable.values.count
        return total

    def point(self, place: FloatArray) -> Point:
        """The values of the design at (n,) a place; outside the box, those at its border."""
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
        """(n,) where the scene lies; None if it does not state all values, or has others."""
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
        """Designs next to a place with short numbers, all combinations of up and down.

        `finer` adds decimals. Of more than six continuous variables only the nearest is tried, and
        those with one number rounded the other way.
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
    """The range of a variable that takes any number of it."""
    values = variable.values
    return values if isinstance(values, Range) and values.steps is None else None


def _interpolate(interval: Range, share: float) -> float:
    start, stop = float(interval.start), float(interval.stop)
    if share >= 1.0:
        return stop
    return start if share <= 0.0 else start + (stop - start) * share


def _share_of_range(interval: Range, stated: tuple[Any, ...]) -> float | None:
    if any(isinstance(value, bool) or not isinstance(value, int | Decimal) for value in stated):
        return None
    if any(value != stated[0] for value in stated):
        return None
    share = float((Decimal(stated[0]) - interval.start) / (interval.stop - interval.start))
    return share if 0.0 <= share <= 1.0 else None


def _list_position(variable: Variable, stated: tuple[Any, ...]) -> float | None:
    for number in range(variable.values.count):
        if all(_same(*pair) for pair in zip(variable.values.row(number), stated, strict=True)):
            return float(number)
    return None


def _same(one: Any, other: Any) -> bool:
    if isinstance(one, bool) or isinstance(other, bool) or isinstance(one, str):
        return type(one) is type(other) and bool(one == other)
    return isinstance(other, int | Decimal) and float(one) == float(other)


def _short_numbers(value: float, interval: Range, finer: int) -> list[float]:
    """The short numbers below and above a value that lie in its range; itself if there are none."""
    low, high = sorted((interval.start, interval.stop))
    size = max(
        Decimal(abs(value)).scaleb(-DIGITS), (high - low).scaleb(-SMALL)
    )  # above 0, as the range is not empty
    last = Decimal(1).scaleb(size.adjusted() - finer)
    near = (Decimal(value).quantize(last, way) for way in (ROUND_FLOOR, ROUND_CEILING))
    numbers = [float(number) for number in dict.fromkeys(near) if low <= number <= high]
    return sorted(numbers, key=lambda each: abs(each - value)) or [value]


def _one_other(
    choices: Sequence[Sequence[tuple[Value, ...]]],
) -> Iterator[tuple[tuple[Value, ...], ...]]:
    first = [choice[0] for choice in choices]
    yield tuple(first)
    for number, choice in enumerate(choices):
        for other in choice[1:]:
            yield (*first[:number], other, *first[number + 1 :])


# -- pareto ---------------------------------------------------------------------------------------
# The Pareto front: designs that no other one beats in every objective.


def front(costs: FloatArray) -> BoolArray:
    """(n,) which rows of `costs` (n, k), less being better, no other row dominates.

    A row dominates another if it is nowhere worse and somewhere better; equal rows stay together. A
    row with a NaN has no place in the order: it neither dominates nor is on the front.
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
"""Of an objective that short numbers may cost, relative to it; else they get another decimal."""

FINER: Final = 9
"""Decimals that may be added."""

INTERRUPTED: Final = "interrupted"


@dataclass(frozen=True, slots=True)
class OptimisationResult:
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
    """Search for the best design; the same seed finds the same, unless time ends the search.

    Parameters
    ----------
    seed, evaluations, seconds : as of `Effort`, in place of what the task says; a few more designs
        are tried for short numbers.
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
            words += f", {self._goal.question.word} {value:.7g}"
        else:
            words += ", none keeps all limits yet"
        self._progress(words)


def _front(trials: tuple[Trial, ...]) -> tuple[Trial, ...]:
    """The designs within limits that no other one beats, ordered by the first objective."""
    feasible = [trial for trial in trials if trial.feasible]
    if not feasible:
        return ()
    mask = front(np.array([trial.costs for trial in feasible]))
    front_trials = [trial for trial, undominated in zip(feasible, mask, strict=True) if undominated]
    return tuple(sorted(front_trials, key=lambda each: (*each.costs, each.number)))


def _best(trials: Trials, on_front: tuple[Trial, ...]) -> Trial:
    ways = directions(len(trials.task.goals))
    if not on_front:
        return scaled_direction(ways[0], trials).best(trials.computed)
    if len(ways[0]) == 1:
        return scaled_direction(ways[0], trials).best(on_front)
    equal_weights = np.full(len(ways[0]), 1.0 / len(ways[0]))
    return scaled_direction(equal_weights, trials).best(on_front)


def _short(trials: Trials, best: Trial) -> Trial:
    """The best design with numbers as short as keep the limits and cost next to nothing."""
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
# The search: differential evolution over the whole box, then local searches of the numbers in it.
#
# A design that breaks a limit is worse than any that breaks none, and the less it violates, the
# better (after K. Deb, Comput. Methods Appl. Mech. Engrg. 186, 2000, p. 311). Differential
# evolution (R. Storn and K. Price, J. Global Optim. 11, 1997, p. 341) is that of scipy, with whole
# numbers where there is a list; a generation is computed as a whole, so that several processes may
# share it. From its best design COBYQA (T. M. Ragonneau, Model-Based Derivative-Free Optimization
# Methods and Software, 2022) goes on with limits as constraints; then steps along each number and
# in drawn directions become smaller until they are nothing.


WALL: Final = 1e30
"""Energy of designs that break limits: above that of all others."""

POPULATION: Final = 12
"""Designs of a generation for each variable, and at least."""

CONVERGED: Final = 1e-7
"""Spread of a generation's energies, relative to them, at which it has come together."""

FIRST: Final = 0.02
"""First steps of local searches, as a fraction of a range."""

FINEST: Final = 1e-9
"""Last ones."""

SHRINK, GROW = 0.5, 1.5
"""Factors of the step where no direction helps, and where one does."""

RANDOM_SETS: Final = 2
"""Sets of directions at right angles to each other that are drawn for each step."""

HALVINGS: Final = 34
"""Of a way between a design within limits and one beyond them: to 10^-10 of it."""

POLISHED: Final = 0.3
"""Share of the designs that is kept for local searches."""

BATCH: Final = 1000
"""Designs that are handed out at once where all are tried."""

LATTICE: Final = {1: 1, 2: 6, 3: 3}
"""Parts into which the weights of so many objectives are divided; else 2."""


@dataclass(frozen=True, slots=True, eq=False)
class Direction:
    """One way to weigh the objectives against each other.

    Attributes
    ----------
    weights : (k,) of the costs, 1 together; of one objective alone 1 and else 0.
    ideal, span : (k,) least costs and range of the costs on the front so far, for several.
    """

    weights: FloatArray
    ideal: FloatArray
    span: FloatArray

    def cost(self, trial: Trial) -> float:
        """Less is better; NaN where an objective has no answer.

        The largest weighted distance from the ideal, and a little of all of them, so that no other
        design with that distance beats the best.
        """
        costs = np.array(trial.costs)
        if np.isnan(costs).any():
            return float("nan")
        if np.count_nonzero(self.weights) == 1:
            return float(costs[self.weights > 0.0][0])
        distances = (costs - self.ideal) / self.span
        return float(np.max(self.weights * distances) + 1e-3 * np.sum(distances))

    def key(self, trial: Trial) -> tuple[float, float]:
        """By which designs are ordered, the best first; the first of equal ones wins."""
        if not trial.feasible:
            return (trial.violation, 0.0)
        return (0.0, self.cost(trial))

    def energy(self, trial: Trial) -> float:
        """The order as one number."""
        return self.cost(trial) if trial.feasible else WALL * (1.0 + trial.violation)

    def best(self, trials: Iterable[Trial]) -> Trial:
        """The best of some."""
        return min(trials, key=self.key)


def directions(count: int) -> list[FloatArray]:
    """Weights of `count` objectives: each alone, then evenly spaced."""
    parts = LATTICE.get(count, 2)
    all_weights = [np.eye(count)[number] for number in range(count)]
    for chosen in combinations_with_replacement(range(count), parts):
        weights = np.bincount(chosen, minlength=count) / parts
        if np.max(weights) < 1.0:
            all_weights.append(weights)
    return all_weights


def scaled_direction(weights: FloatArray, trials: Trials) -> Direction:
    """The direction with these weights, the range of the costs taken from the trials so far."""
    costs = np.array([trial.costs for trial in trials.computed if trial.feasible])
    if not len(costs):
        return Direction(weights, np.zeros_like(weights), np.ones_like(weights))
    # The range is that between the best designs of each objective alone.
    ends = costs[np.argmin(costs, axis=0)]
    span = np.max(ends, axis=0) - np.min(ends, axis=0)
    return Direction(weights, np.min(costs, axis=0), np.where(span > 0.0, span, 1.0))


def evolve(trials: Trials, direction: Direction, seed: int, most: int) -> bool:
    """Differential evolution with at most so many new designs; whether it came together."""
    from scipy.optimize import differential_evolution

    space = trials.space
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
        warnings.simplefilter("ignore")  # that it did not converge, which is told
        result = differential_evolution(
            float,  # a generation is computed as a whole
            [(0.0, space.upper[side]) for side in sides],
            integrality=~space.continuous[sides],
            init=start,
            rng=np.random.default_rng(seed),
            maxiter=10 * most // size + 10,
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
    """The first generation: a Latin square, in which the best designs so far take places."""
    from scipy.stats import qmc

    space = trials.space
    shares = qmc.LatinHypercube(len(sides), rng=np.random.default_rng(seed)).random(size)
    generation: FloatArray = shares * space.upper[sides]
    whole = ~space.continuous[sides]
    # Each number of a list is as likely as the others.
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
    """Local searches from the best design so far, in its continuous variables."""
    free = np.flatnonzero(trials.space.continuous)
    start = direction.best(trial for trial in trials.computed if trial.place is not None)
    if not len(free) or not np.isfinite(direction.cost(start)):
        return
    if np.count_nonzero(direction.weights) == 1:  # else the cost has edges
        _follow(trials, direction, start, free)
    start = direction.best(trial for trial in trials.computed if trial.place is not None)
    _step(trials, direction, start, free, seed)


def _follow(trials: Trials, direction: Direction, start: Trial, free: np.ndarray) -> None:
    """COBYQA, then bisection to the border of what is allowed if it ended beyond."""
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
        return trial_cost / scale if np.isfinite(trial_cost) else 1e6

    def margins(numbers: FloatArray) -> FloatArray:
        trial = evaluate(numbers)
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
    """Steps along each number, in drawn directions, and on from the last success.

    Where limits meet at an angle only few directions are within both and better.
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
    """(count, count) unit vectors at right angles to each other, drawn evenly."""
    rotation: FloatArray = np.linalg.qr(generator.standard_normal((count, count)))[0].T
    return rotation


def search(trials: Trials, seed: int) -> str:
    """Try designs; why it ended."""
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
        ways = directions(len(task.goals))
        whole = True
        for number, weights in enumerate(ways):
            left = (trials.most - len(trials)) // (len(ways) - number)
            towards = scaled_direction(weights, trials)
            trials.share = len(trials) + left
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
# Designs that an optimisation has tried: what they answer, and by how much they break limits.


DUMB: Final = 20
"""Designs after which an objective that none has answered will have no answer."""


class SpentError(Exception):
    """The designs for one direction of the search have been tried."""


class StoppedError(Exception):
    """The search ends here; the message is why."""


class Trials:
    """All designs that were tried, each computed once.

    Parameters
    ----------
    most : designs that may be computed.
    seconds : that may pass before others are; None for no limit.
    notify : called after each design.
    engine : where several at once are computed; None for this process.

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
        """In their order."""
        return tuple(self._known.values())

    @property
    def last(self) -> Trial:
        """The one that was computed last."""
        return next(reversed(self._known.values()))

    def __len__(self) -> int:
        return len(self._known)

    def evaluate(self, place: FloatArray) -> Trial:
        """The design at a place; see `evaluate_all`."""
        return self.evaluate_all([place])[0]

    def evaluate_all(self, places: Iterable[FloatArray]) -> list[Trial]:
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

    def evaluate_points(self, points: Iterable[Point]) -> list[Trial]:
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
        """Compute designs; whatever ends it, those that are finished are kept, in their order."""
        engine = self._engine if len(wanted) > 1 else Loop()
        verdicts: dict[str, Verdict] = {}
        left = list(reversed(wanted))
        try:
            with closing(engine.rows(self._judge, iter([point for point, _ in wanted]))) as chunks:
                for rows in chunks:
                    verdicts |= {mark(row.point): cast("Verdict", row) for row in rows}
                    while left and mark(left[-1][0]) in verdicts:
                        self._add(*left.pop(), verdicts)
                    if timed and self._late:
                        break
        finally:
            for point, place in reversed(left):
                if mark(point) in verdicts:
                    self._add(point, place, verdicts)

    def _add(self, point: Point, place: FloatArray | None, verdicts: Mapping[str, Verdict]) -> None:
        verdict = verdicts[mark(point)]
        judged = {attribute.name: getattr(verdict, attribute.name) for attribute in fields(verdict)}
        self._known[mark(point)] = Trial(**judged, number=len(self._known) + 1, place=place)
        self._answered |= ~np.isnan(verdict.costs)
        self._notify(self)


# -- judging --------------------------------------------------------------------------------------
# What one design answers, and by how much it breaks limits: computed here or in a worker.


IMPOSSIBLE: Final = 1e4
"""Violation of a design that there is not."""

UNANSWERED: Final = 1e2
"""Of each answer that is missing, far more than of limits."""

REFUSED: Final = 10.0
"""Of each finding that rules out the disc, besides how far it is beyond its limit."""


@dataclass(frozen=True, slots=True, eq=False)
class Verdict(DesignRow):
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


@dataclass(frozen=True, slots=True, eq=False)
class Trial(Verdict):
    """One design that was tried.

    Attributes
    ----------
    number : from 1, in the order of the trials.
    place : where it lies in the space; None of a rounded one.
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

    def nothing(self, point: Point, reason: str) -> Verdict:
        """See `Work.nothing`."""
        count, costs = len(self.questions), (np.nan,) * len(self.criteria.goals)
        return Verdict(
            point, (None,) * count, ("",) * count, reason, costs, {}, IMPOSSIBLE, (reason,)
        )

    def answers(self, design: Design, point: Point, readings: Sequence[DesignReading]) -> Verdict:
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
        return Verdict(
            point, values, units, "", tuple(costs), judging.margins, judging.violation,
            judging.broken, tuple(judging.remarks),
        )  # fmt: skip


class _Judging:
    """Gathers what one design violates."""

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
    """A measure above 0 and below 1 of how far a limit is exceeded."""
    beyond = min(abs(margin), 1e9)
    return max(beyond / (1.0 + beyond), 1e-12)
