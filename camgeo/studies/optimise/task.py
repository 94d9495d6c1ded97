"""What an optimisation seeks: objectives, limits, and the family in which it looks."""

from __future__ import annotations

import contextlib
import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal
from itertools import product
from typing import Any, Final, Literal

import numpy as np

from camgeo.design.design import Design
from camgeo.errors import GeometryError
from camgeo.numeric.arrays import BoolArray, FloatArray
from camgeo.scene.scene import Scene
from camgeo.scene.values import value_path
from camgeo.scene.varied import OPTIMISE, Value, plain
from camgeo.studies.sweep.family import (
    Family,
    Point,
    Range,
    Sample,
    Variable,
    family_of,
    variables_in,
)
from camgeo.studies.sweep.rows import VERDICT, Asked, asked_of, canonical

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

    @classmethod
    def of(cls, family: Family) -> Space:
        """The box of a family."""
        return cls(family.variables)

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
            own = tuple(_stated(tree, value_path(tree, key)) for key in variable.keys)
            within = _continuous(variable)
            at = _number_in(variable, own) if within is None else _share(within, own)
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
            near = _short(value, within, finer)
            choices.append([(plain(each),) * within.keys for each in near])
        if sum(len(each) > 1 for each in choices) <= 6:
            combined: Iterator[tuple[tuple[Value, ...], ...]] = product(*choices)
        else:
            combined = _one_other(choices)
        for rows in combined:
            yield tuple(value for row in rows for value in row)

    def edits(self, family: Family, place: FloatArray) -> Mapping[str, Value]:
        """The values at a place by their keys."""
        return family.edits(self.point(place))


def _continuous(variable: Variable) -> Range | None:
    """The range of a variable that takes any number of it."""
    values = variable.values
    return values if isinstance(values, Range) and values.steps is None else None


def _between(within: Range, share: float) -> float:
    start, stop = float(within.start), float(within.stop)
    if share >= 1.0:
        return stop
    return start if share <= 0.0 else start + (stop - start) * share


def _stated(tree: Any, path: Sequence[Any]) -> Any:
    for step in path:
        if isinstance(step, int) and not (isinstance(tree, list) and step < len(tree)):
            return None
        if isinstance(step, str) and not (isinstance(tree, dict) and step in tree):
            return None
        tree = tree[step]
    return tree


def _share(within: Range, own: tuple[Any, ...]) -> float | None:
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


def _short(value: float, within: Range, finer: int) -> list[float]:
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
