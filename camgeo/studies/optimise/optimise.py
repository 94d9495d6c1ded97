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
    variables_in,
)
from camgeo.studies.sweep.rows import (
    VERDICT,
    Asked,
    Engine,
    Loop,
    Reading,
    Row,
    Work,
    asked_of,
    canonical,
    judged,
    reason_of,
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

    asked: Asked
    sense: Sense

    def cost(self, value: float) -> float:
        """The value so that less is better."""
        return value if self.sense == "least" else -value


@dataclass(frozen=True, slots=True)
class Limit:
    """A limit that is stated with the call.

    Attributes
    ----------
    asked : what is limited.
    sign : "<=" or ">=".
    bound : the limit, in the unit in which the answer is stated.
    """

    asked: Asked
    sign: str
    bound: float

    def __str__(self) -> str:
        return f"{self.asked.word} {self.sign} {self.bound:g}"

    def margin(self, value: float) -> float:
        """How far the value is within the limit, relative to it; negative beyond."""
        apart = value - self.bound if self.sign == ">=" else self.bound - value
        return apart / (abs(self.bound) or 1.0)


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
    def of(cls, table: Mapping[str, Any]) -> Effort:
        """What a table of a scene states."""
        seconds = table.get("seconds")
        return cls(
            int(table.get("seed", 0)),
            int(table.get("evaluations", EVALUATIONS)),
            None if seconds is None else float(seconds),
        )


@dataclass(frozen=True, slots=True)
class Sought:
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
    def asked(self) -> tuple[Asked, ...]:
        """What is asked of each design, each once: objectives, then limits."""
        found = [*(goal.asked for goal in self.goals), *(limit.asked for limit in self.limits)]
        return tuple(dict.fromkeys(found))

    @property
    def replaced(self) -> frozenset[str]:
        """Findings whose limits in the scene have others in their place."""
        return frozenset(each.asked.name for each in self.limits if each.asked.how == "value")

    @property
    def machining(self) -> bool:
        """Whether the milling programs count: whoever asks for their time means to run them."""
        return any(each.group == "machining" for each in self.asked)

    def matters(self, name: str) -> bool:
        """Whether a broken limit of the scene, of the finding of that name, matters."""
        return ALL not in self.ignored and name not in self.ignored | self.replaced


@dataclass(frozen=True, slots=True)
class Task(Sought):
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
    family = family_of(scene, vary or variables_in(scene, OPTIMISE), Sample(1))
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
    names = [goal.asked.word for goal in goals]
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
    ignored = [each.name for each in asked_of(design, named)] if named else []
    everything = [ALL] if ALL in words else []
    return Task(goals, limits, frozenset([*ignored, *everything]), family, Effort.of(table))


def _number(design: Design, word: str) -> Asked:
    (found,) = asked_of(design, [word])
    if found.name == VERDICT and found.how == "value":
        raise GeometryError("is a word, which is neither small nor large", VERDICT)
    return replace(found, word=canonical(word))


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
        return np.array([_continuous(each) is not None for each in self.variables])

    @property
    def upper(self) -> FloatArray:
        """(n,) upper ends of the sides; the lower ones are 0."""
        return np.array(
            [1.0 if _continuous(each) else each.values.count - 1.0 for each in self.variables]
        )

    @property
    def count(self) -> int | None:
        """How many designs there are; None if a variable is continuous."""
        found = 1
        for each in self.variables:
            if _continuous(each):
                return None
            found *= each.values.count
        return found

    def point(self, place: FloatArray) -> Point:
        """The values of the design at (n,) a place; outside the box, those at its border."""
        values: list[Value] = []
        for variable, at in zip(self.variables, place, strict=True):
            within = _continuous(variable)
            if within is None:
                number = round(min(max(float(at), 0.0), variable.values.count - 1.0))
                values += variable.values.at(number)
            else:
                values += (plain(_between(within, float(at))),) * within.keys
        return tuple(values)

    def everything(self) -> Iterator[FloatArray]:
        """All places, if no variable is continuous."""
        for numbers in product(*(range(each.values.count) for each in self.variables)):
            yield np.array(numbers, dtype=float)

    def place_of(self, scene: Scene) -> FloatArray | None:
        """(n,) where the scene lies; None if it does not state all values, or has others."""
        tree: Any = scene.stated.scene.exact
        found = []
        for variable in self.variables:
            own = tuple(tree_value(tree, value_path(tree, key)) for key in variable.keys)
            within = _continuous(variable)
            at = _number_in(variable, own) if within is None else _share_of_range(within, own)
            if at is None:
                return None
            found.append(at)
        return np.array(found)

    def rounded(self, place: FloatArray, finer: int = 0) -> Iterator[Point]:
        """Designs next to a place with short numbers, all combinations of up and down.

        `finer` adds decimals. Of more than six continuous variables only the nearest is tried, and
        those with one number rounded the other way.
        """
        choices: list[Sequence[tuple[Value, ...]]] = []
        for variable, at in zip(self.variables, place, strict=True):
            within = _continuous(variable)
            if within is None:
                choices.append([variable.values.at(round(float(at)))])
                continue
            value = _between(within, float(at))
            near = _short_numbers(value, within, finer)
            choices.append([(plain(each),) * within.keys for each in near])
        if sum(len(each) > 1 for each in choices) <= 6:
            combined: Iterator[tuple[tuple[Value, ...], ...]] = product(*choices)
        else:
            combined = _one_other(choices)
        for rows in combined:
            yield tuple(value for row in rows for value in row)


def _continuous(variable: Variable) -> Range | None:
    """The range of a variable that takes any number of it."""
    values = variable.values
    return values if isinstance(values, Range) and values.steps is None else None


def _between(within: Range, share: float) -> float:
    start, stop = float(within.start), float(within.stop)
    if share >= 1.0:
        return stop
    return start if share <= 0.0 else start + (stop - start) * share


def _share_of_range(within: Range, own: tuple[Any, ...]) -> float | None:
    if any(isinstance(each, bool) or not isinstance(each, int | Decimal) for each in own):
        return None
    if any(each != own[0] for each in own):
        return None
    at = float((Decimal(own[0]) - within.start) / (within.stop - within.start))
    return at if 0.0 <= at <= 1.0 else None


def _number_in(variable: Variable, own: tuple[Any, ...]) -> float | None:
    for number in range(variable.values.count):
        if all(_same(*pair) for pair in zip(variable.values.at(number), own, strict=True)):
            return float(number)
    return None


def _same(one: Any, other: Any) -> bool:
    if isinstance(one, bool) or isinstance(other, bool) or isinstance(one, str):
        return type(one) is type(other) and bool(one == other)
    return isinstance(other, int | Decimal) and float(one) == float(other)


def _short_numbers(value: float, within: Range, finer: int) -> list[float]:
    """The short numbers below and above a value that lie in its range; itself if there are none."""
    low, high = sorted((within.start, within.stop))
    size = max(
        Decimal(abs(value)).scaleb(-DIGITS), (high - low).scaleb(-SMALL)
    )  # above 0, as the range is not empty
    last = Decimal(1).scaleb(size.adjusted() - finer)
    near = (Decimal(value).quantize(last, way) for way in (ROUND_FLOOR, ROUND_CEILING))
    found = [float(each) for each in dict.fromkeys(near) if low <= each <= high]
    return sorted(found, key=lambda each: abs(each - value)) or [value]


def _one_other(
    choices: Sequence[Sequence[tuple[Value, ...]]],
) -> Iterator[tuple[tuple[Value, ...], ...]]:
    first = [each[0] for each in choices]
    yield tuple(first)
    for number, each in enumerate(choices):
        for other in each[1:]:
            yield (*first[:number], other, *first[number + 1 :])


# -- pareto ---------------------------------------------------------------------------------------
# The Pareto front: designs that no other one beats in every objective.


def front(costs: FloatArray) -> BoolArray:
    """(n,) which rows of `costs` (n, k), less being better, no other row dominates.

    A row dominates another if it is nowhere worse and somewhere better; equal rows stay together. A
    row with a NaN has no place in the order: it neither dominates nor is on the front.
    """
    found = np.zeros(len(costs), dtype=bool)
    whole = np.flatnonzero(~np.isnan(costs).any(axis=1))
    # In lexical order a row can only be dominated by an earlier one that is on the front itself.
    order = whole[np.lexsort(costs[whole].T[::-1])]
    kept = np.empty((0, costs.shape[1]))
    for row in order:
        here = costs[row]
        beaten = np.all(kept <= here, axis=1) & np.any(kept < here, axis=1)
        if not beaten.any():
            found[row] = True
            if not (len(kept) and np.array_equal(kept[-1], here)):
                kept = np.vstack((kept, here))
    return found


# -- optimise -------------------------------------------------------------------------------------
# Running an optimisation.


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

DRAWN: Final = 2
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
        apart = (costs - self.ideal) / self.span
        return float(np.max(self.weights * apart) + 1e-3 * np.sum(apart))

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
    found = [np.eye(count)[number] for number in range(count)]
    for chosen in combinations_with_replacement(range(count), parts):
        weights = np.bincount(chosen, minlength=count) / parts
        if np.max(weights) < 1.0:
            found.append(weights)
    return found


def direction(weights: FloatArray, trials: Trials) -> Direction:
    """The direction with these weights, the range of the costs taken from the trials so far."""
    costs = np.array([each.costs for each in trials.made if each.feasible])
    if not len(costs):
        return Direction(weights, np.zeros_like(weights), np.ones_like(weights))
    # The range is that between the best designs of each objective alone.
    ends = costs[np.argmin(costs, axis=0)]
    span = np.max(ends, axis=0) - np.min(ends, axis=0)
    return Direction(weights, np.min(costs, axis=0), np.where(span > 0.0, span, 1.0))


def evolve(trials: Trials, towards: Direction, seed: int, most: int) -> bool:
    """Differential evolution with at most so many new designs; whether it came together."""
    from scipy.optimize import differential_evolution

    space = trials.space
    sides = np.flatnonzero(space.upper > 0.0)
    size = max(POPULATION, POPULATION * len(sides))
    start = _population(trials, towards, sides, seed, size)
    last = len(trials) + most

    def energies(_: object, generation: Iterable[FloatArray]) -> list[float]:
        members = np.array(list(generation))
        places = np.zeros((len(members), len(space.upper)))
        places[:, sides] = members
        return [towards.energy(each) for each in trials.all_at(places)]

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
    trials: Trials, towards: Direction, sides: np.ndarray, seed: int, size: int
) -> FloatArray:
    """The first generation: a Latin square, in which the best designs so far take places."""
    from scipy.stats import qmc

    space = trials.space
    shares = qmc.LatinHypercube(len(sides), rng=np.random.default_rng(seed)).random(size)
    found: FloatArray = shares * space.upper[sides]
    whole = ~space.continuous[sides]
    # Each number of a list is as likely as the others.
    counts = space.upper[sides][whole] + 1.0
    found[:, whole] = np.minimum(np.floor(shares[:, whole] * counts), counts - 1.0)
    known = sorted((each for each in trials.made if each.place is not None), key=towards.key)
    for row, trial in enumerate(known[: size // 3]):
        assert trial.place is not None
        found[row] = trial.place[sides]
    return found


def polish(trials: Trials, towards: Direction, seed: int) -> None:
    """Local searches from the best design so far, in its continuous variables."""
    free = np.flatnonzero(trials.space.continuous)
    start = towards.best(each for each in trials.made if each.place is not None)
    if not len(free) or not np.isfinite(towards.cost(start)):
        return
    if np.count_nonzero(towards.weights) == 1:  # else the cost has edges
        _follow(trials, towards, start, free)
    start = towards.best(each for each in trials.made if each.place is not None)
    _step(trials, towards, start, free, seed)


def _follow(trials: Trials, towards: Direction, start: Trial, free: np.ndarray) -> None:
    """COBYQA, then bisection to the border of what is allowed if it ended beyond."""
    from scipy.optimize import Bounds, NonlinearConstraint, minimize

    base = start.place
    assert base is not None
    names = tuple(start.margins)
    first = towards.cost(start)
    scale = abs(first) or 1.0

    def at(numbers: FloatArray) -> Trial:
        place = base.copy()
        place[free] = np.clip(numbers, 0.0, 1.0)
        return trials.at(place)

    def cost(numbers: FloatArray) -> float:
        found = towards.cost(at(numbers))
        return found / scale if np.isfinite(found) else 1e6

    def margins(numbers: FloatArray) -> FloatArray:
        found = at(numbers)
        missing = -1.0 if found.violation >= 1.0 else 1.0
        each = [min(found.margins.get(name, missing), 1.0) for name in names]
        return np.array([*each, -min(found.violation, 1e6)])

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
    beyond = at(result.x)
    within = towards.best((start, *trials.made))
    if beyond.feasible or not within.feasible or within.place is None:
        return
    low, high = within.place, np.array(beyond.place)
    if not np.array_equal(low[~trials.space.continuous], high[~trials.space.continuous]):
        return
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        found = trials.at(middle)
        if found.feasible and towards.key(found) <= towards.key(within):
            low, within = middle, found
        else:
            high = middle


def _step(trials: Trials, towards: Direction, best: Trial, free: np.ndarray, seed: int) -> None:
    """Steps along each number, in drawn directions, and on from the last success.

    Where limits meet at an angle only few directions are within both and better.
    """
    drawn = np.random.default_rng(seed)
    step, last = FIRST, np.zeros(len(free))
    while step > FINEST:
        turned = np.eye(len(free))
        if len(free) > 1:
            turned = np.vstack((turned, *(_rotation(drawn, len(free)) for _ in range(DRAWN))))
        ways = np.vstack((last, turned, -turned)) if last.any() else np.vstack((turned, -turned))
        for way in ways:
            assert best.place is not None
            place = best.place.copy()
            place[free] = np.clip(place[free] + step * way, 0.0, 1.0)
            found = trials.at(place)
            if found.place is not None and towards.key(found) < towards.key(best):
                best, last = found, way
                step *= GROW
                break
        else:
            step *= SHRINK
            last = np.zeros(len(free))


def _rotation(drawn: np.random.Generator, count: int) -> FloatArray:
    """(count, count) unit vectors at right angles to each other, drawn evenly."""
    found: FloatArray = np.linalg.qr(drawn.standard_normal((count, count)))[0].T
    return found


def search(trials: Trials, seed: int) -> str:
    """Try designs; why it ended."""
    space, task = trials.space, trials.task
    try:
        start = space.place_of(task.family.scene)
        if start is not None:
            trials.at(start)
        if space.count is not None and space.count <= trials.most:
            places = space.everything()
            while batch := list(islice(places, BATCH)):
                trials.all_at(batch)
            return "all designs were tried"
        ways = directions(len(task.goals))
        whole = True
        for number, weights in enumerate(ways):
            left = (trials.most - len(trials)) // (len(ways) - number)
            towards = direction(weights, trials)
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
        self.space = Space(task.family.variables)
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
        judged = {each.name: getattr(verdict, each.name) for each in fields(verdict)}
        self._known[mark(point)] = Trial(**judged, number=len(self._known) + 1, place=place)
        self._answered |= ~np.isnan(verdict.costs)
        self._told(self)


# -- judging --------------------------------------------------------------------------------------
# What one design answers, and by how much it breaks limits: computed here or in a worker.


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
