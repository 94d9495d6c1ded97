"""Designs as places in a box: a side for each variable, with its numbers or places of a list."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal
from itertools import product
from typing import Any, Final

import numpy as np

from camgeo.numeric.arrays import BoolArray, FloatArray
from camgeo.scene.paths import value_path
from camgeo.scene.scene import Scene
from camgeo.scene.varied import Value, plain
from camgeo.sweep.family import Family, Point
from camgeo.sweep.variables import Range, Variable

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
            at = _number(variable, own) if within is None else _share(within, own)
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


def _number(variable: Variable, own: tuple[Any, ...]) -> float | None:
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
