"""A family: a scene with other values at some keys. Its designs are known before anything runs."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal, InvalidOperation
from fractions import Fraction
from functools import cached_property
from typing import Any, Final, Literal, get_args

import numpy as np

from camgeo.errors import GeometryError, SceneError
from camgeo.numeric.arrays import FloatArray
from camgeo.scene.keys import spelled
from camgeo.scene.scene import Scene
from camgeo.scene.values import (
    FAMILIES,
    SWEEP,
    Rows,
    Value,
    design_path,
    faults_of_list,
    faults_of_range,
    plain,
    variable_keys,
    variable_rows,
)
from camgeo.units import counted

Method = Literal["sobol", "random"]

METHODS: Final[tuple[str, ...]] = get_args(Method)

MOST: Final = 1_000_000
"""Largest number of designs of a family: at 5 ms each, for a cheap question, an hour and a half."""

Point = tuple[Value, ...]
"""The values at the keys of a family, in their order: what makes one of its designs."""


@dataclass(frozen=True, slots=True)
class Sample:
    """How designs are drawn from the ranges and lists of a family.

    Attributes
    ----------
    count : number of designs.
    method : "sobol", a scrambled Sobol sequence, which fills the ranges evenly, or "random".
    seed : the same seed draws the same designs.
    """

    count: int
    method: Method = "sobol"
    seed: int = 0

    def __post_init__(self) -> None:
        if self.method not in METHODS:
            message = f"must be one of {', '.join(METHODS)}"
            raise GeometryError(message, "sweep.method", str(self.method))
        if self.count < 1:
            raise GeometryError("must be at least 1", "sweep.samples", str(self.count))
        if not 0 <= self.seed < 2**63:
            message = "must be a whole number from 0 to 2^63 - 1"
            raise GeometryError(message, "sweep.seed", str(self.seed))

    def shares(self, dimensions: int) -> FloatArray:
        """(count, dimensions) numbers from 0 to less than 1."""
        generator = np.random.default_rng(self.seed)
        if self.method == "random":
            return generator.random((self.count, dimensions))
        from scipy.stats import qmc  # half a second, which no grid needs

        # Only a power of two is balanced, and scipy warns of other numbers. The first `count` of it
        # are also the first ones of the sequence.
        power = max(self.count - 1, 0).bit_length()
        samples: FloatArray = qmc.Sobol(dimensions, rng=generator).random_base2(power)
        return samples[: self.count]


@dataclass(frozen=True)
class Family:
    """The designs of a sweep: all combinations of the variables' values, or a sample of them.

    Attributes
    ----------
    scene : the scene in which values are replaced, without the families that it states itself.
    variables : what varies; in the order of the designs, the last one varies fastest.
    sample : how designs are drawn; None for all combinations.

    Raises
    ------
    SceneError
        For an unknown key, with the nearest one, and for a key that varies twice.
    GeometryError
        If there are too many designs, or a range has no count although all combinations are
        required.
    """

    scene: Scene
    variables: tuple[Variable, ...]
    sample: Sample | None = None

    def __post_init__(self) -> None:
        stated = dict.fromkeys(name for name in FAMILIES if name in self.scene.values)
        if stated:
            object.__setattr__(self, "scene", self.scene.with_values(stated))
        if not self.variables:
            raise GeometryError("states no key: nothing varies", "sweep.vary")
        tree = self.scene.stated.scene.exact
        seen: set[str] = set()
        variables = []
        for variable in self.variables:
            keys = [spelled(design_path(tree, key, seen)) for key in variable.keys]
            variables.append(Variable(tuple(keys), variable.values))
            if self.sample is None and not variable.values.count:
                message = "needs a COUNT, START:STOP:COUNT, unless designs are samples"
                raise GeometryError(message, keys[0])
        object.__setattr__(self, "variables", tuple(variables))
        if self.count > MOST:
            message = (
                f"{counted(self.count, 'design')} are more than {MOST:,}; nothing was computed"
            )
            raise GeometryError(message, "sweep.vary")

    @property
    def keys(self) -> tuple[str, ...]:
        """All keys that vary, including those of tied variables."""
        return tuple(key for variable in self.variables for key in variable.keys)

    @property
    def count(self) -> int:
        """How many designs there are."""
        if self.sample is not None:
            return self.sample.count
        return math.prod(variable.values.count for variable in self.variables)

    @cached_property
    def _shares(self) -> FloatArray:
        assert self.sample is not None
        return self.sample.shares(len(self.variables))

    def point(self, number: int) -> Point:
        """The values of the design `number`, from 0."""
        choices = [variable.values for variable in self.variables]
        if self.sample is not None:
            rows = [
                choice.row_at_share(float(share))
                for choice, share in zip(choices, self._shares[number], strict=True)
            ]
        else:
            rows = []
            # The digits of `number` in a mixed base: the last variable is the lowest digit.
            for choice in reversed(choices):
                number, place = divmod(number, choice.count)
                rows.append(choice.row(place))
            rows.reverse()
        return tuple(value for row in rows for value in row)

    def points(self) -> Iterator[Point]:
        """The values of all designs in their order; repeated samples are left out."""
        sampled = self.sample is not None
        seen: set[str] = set()
        for number in range(self.count):
            point = self.point(number)
            if sampled:  # samples of lists repeat themselves
                name = mark(point)
                if name in seen:
                    continue
                seen.add(name)
            yield point

    def design_scene(self, point: Point) -> Scene:
        """The scene of a design; SceneError with all its faults if it is wrong."""
        return self.scene.with_values(self.edits(point))

    def edits(self, point: Point) -> dict[str, Value]:
        """The values of a design by their keys."""
        return dict(zip(self.keys, point, strict=True))

    def contents(self) -> Mapping[str, bytes]:
        """The contents of all files that designs may name, by these names.

        A file that cannot be read is left out: the rows of designs that name it state the reason.
        """
        file_contents = dict(self.scene.source.contents)
        for variable in self.variables:
            if not isinstance(variable.values, Listed):
                continue
            for row in variable.values.rows:
                if not any(isinstance(value, str) for value in row):
                    continue
                edits: dict[str, Any] = dict(zip(variable.keys, row, strict=True))
                try:
                    file_contents |= self.scene.with_values(edits).source.contents
                except SceneError:
                    continue
        return file_contents


def mark(point: Point) -> str:
    """The point as text, a JSON list, by which its row is stored."""
    return json.dumps(point, ensure_ascii=False, separators=(",", ":"))


# -- variables ------------------------------------------------------------------------------------
# What varies in a family: keys of the scene, and their values.


QUOTED: Final = r"\"[^\"]*\"|'[^']*'"
"""Pattern of quoted text in a list, which may have commas and colons."""

TIED: Final = "/"
"""Separates the values of tied keys: `A,B=1/2,3/4` is A = 1 with B = 2, and A = 3 with B = 4."""

FORMS: Final = (
    "must be START:STOP:COUNT, a list as 1,2,3, or START:STOP where designs are samples,"
    " e.g. follower.base_radius=30:60:31"
)


@dataclass(frozen=True, slots=True)
class Listed:
    """A list of stated values.

    Attributes
    ----------
    rows : a row for each value of the variable, with one value for each of its keys.
    """

    rows: tuple[tuple[Value, ...], ...]

    @property
    def count(self) -> int:
        """Number of rows."""
        return len(self.rows)

    def row(self, place: int) -> tuple[Value, ...]:
        """The row at a place, from 0."""
        return self.rows[place]

    def row_at_share(self, share: float) -> tuple[Value, ...]:
        """The row at a share of the list, from 0 to less than 1."""
        return self.rows[min(int(share * self.count), self.count - 1)]


@dataclass(frozen=True, slots=True)
class Range:
    """Evenly spaced numbers, the same for all keys of a variable.

    Attributes
    ----------
    start, stop : the first and the last number, exactly as stated.
    steps : how many numbers; None for a range that is only sampled.
    keys : how many tied keys have the number.
    """

    start: Decimal
    stop: Decimal
    steps: int | None
    keys: int = 1

    @property
    def count(self) -> int:
        """Number of values; 0 if the range is only sampled."""
        return self.steps or 0

    def row(self, place: int) -> tuple[Value, ...]:
        """The number at a place, from 0, for each key; the exact one rounded once."""
        # With fractions, so that 0.1:0.5:5 gives 0.3 and not 0.30000000000000004.
        first, last = Fraction(self.start), Fraction(self.stop)
        parts = max(self.count - 1, 1)
        return (plain(float(first + (last - first) * place / parts)),) * self.keys

    def row_at_share(self, share: float) -> tuple[Value, ...]:
        """The number at a share of the range, from 0 to less than 1, for each key."""
        if self.steps is not None:
            return self.row(min(int(share * self.count), self.count - 1))
        start, stop = float(self.start), float(self.stop)
        return (plain(start + (stop - start) * share),) * self.keys


@dataclass(frozen=True, slots=True)
class Variable:
    """Keys of a scene that vary together.

    Attributes
    ----------
    keys : as messages spell them.
    values : their values.
    """

    keys: tuple[str, ...]
    values: Listed | Range


def parse(text: str) -> Variable:
    """The variable that `KEY=VALUES` states on a command line, after `--vary`.

    Raises
    ------
    GeometryError
        With the key of the scene, if the text states no variable.
    """
    names, equals, values = text.partition("=")
    keys = tuple(name.strip() for name in names.split(","))
    if not equals or not all(keys) or not values.strip():
        raise GeometryError(FORMS, "vary", text)
    if ":" in re.sub(QUOTED, "", values):
        parts = [_decimal(word) for word in values.split(":")]
        if len(parts) not in (2, 3) or None in parts:
            raise GeometryError(FORMS, names, values)
        start, stop, *count = [part for part in parts if part is not None]
        whole = int(count[0]) if count and count[0] == count[0].to_integral_value() else None
        if count and whole is None:
            raise GeometryError("COUNT must be a whole number from 1", names, values)
        return Variable(keys, spaced(names, start, stop, whole, len(keys)))
    words = re.findall(rf"\s*(?:{QUOTED})\s*|[^,]+", values)
    return Variable(keys, listed(names, [_row(word, len(keys)) for word in words], len(keys)))


def spaced(key: str, start: Decimal, stop: Decimal, steps: int | None, keys: int = 1) -> Range:
    """A checked range; GeometryError with `key` if its count is wrong, or its ends are."""
    for _, message in faults_of_range(start, stop, steps):
        stated = f"{start}:{stop}" + ("" if steps is None else f":{steps}")
        raise GeometryError(message, key, stated)
    return Range(start, stop, steps, keys)


def listed(key: str, rows: Rows, keys: int) -> Listed:
    """A checked list; GeometryError with `key` if it is empty, repeats a row or is not Unicode."""
    if not rows:
        raise GeometryError("is an empty list", key)
    for place, message in faults_of_list(rows, keys):
        raise GeometryError(message, key, TIED.join(str(value) for value in rows[place]))
    return Listed(tuple(rows))


def _row(word: str, keys: int) -> tuple[Value, ...]:
    """The values of tied keys in one word of a list; a single value is for all of them."""
    parts = word.split(TIED) if keys > 1 else [word]
    return tuple(map(_value, parts)) if len(parts) > 1 else (_value(word),) * keys


def _value(word: str) -> Value:
    """What a word means: a truth value, a number, or text, which may be quoted."""
    word = word.strip()
    if word[:1] in "\"'" and word[-1:] == word[:1] and len(word) > 1:
        return word[1:-1]
    if word in ("true", "false"):
        return word == "true"
    number = _decimal(word)
    return word if number is None else plain(float(number))


def _decimal(word: str) -> Decimal | None:
    try:
        number = Decimal(word.strip())
    except InvalidOperation:
        return None
    return number if number.is_finite() else None


# -- stated ---------------------------------------------------------------------------------------
# The family that a scene states in a table, or a command line in its options.


def family_of(
    scene: Scene, vary: Sequence[str | Variable] = (), sample: Sample | None = None
) -> Family:
    """The family of a scene.

    Parameters
    ----------
    vary : variables, or texts as after `--vary`; if there are none, those that the scene states.
    sample : how designs are drawn; None for all combinations, or, if the variables of the scene
        are used, for the sample that it states.

    Raises
    ------
    SceneError, GeometryError
        As `Family`.
    """
    table = scene.values.get(SWEEP, {})
    if not vary and sample is None and "samples" in table:
        sample = Sample(
            int(table["samples"]), table.get("method", "sobol"), int(table.get("seed", 0))
        )
    variables = tuple(_parsed(vary)) if vary else stated_variables(scene, SWEEP)
    return Family(scene, variables, sample)


def stated_variables(scene: Scene, name: str) -> tuple[Variable, ...]:
    """The variables that the scene states in the table `name`; none if there is no such table.

    The rules of the scene have checked them already.
    """
    return tuple(_stated(scene.values.get(name, {}).get("vary", ())))


def question_names(scene: Scene, ask: Iterable[str] = ()) -> tuple[str, ...]:
    """The names in `ask`, or if there are none, those that the scene states in `[sweep]`.

    Each text may have several names, separated by commas.
    """
    return split_names(ask) or tuple(scene.values.get(SWEEP, {}).get("ask", ()))


def split_names(texts: Iterable[str]) -> tuple[str, ...]:
    """All names in texts that may each have several, separated by commas."""
    return tuple(word.strip() for text in texts for word in text.split(",") if word.strip())


def _parsed(vary: Iterable[str | Variable]) -> Iterator[Variable]:
    return (parse(variable) if isinstance(variable, str) else variable for variable in vary)


def _stated(tables: Iterable[Mapping[str, Any]]) -> Iterator[Variable]:
    """The variables of tables like `[[sweep.vary]]`."""
    for table in tables:
        keys = variable_keys(table)
        yield Variable(keys, _values(keys, table))


def _values(keys: tuple[str, ...], table: Mapping[str, Any]) -> Listed | Range:
    if "values" in table:
        return listed(keys[0], variable_rows(table["values"], len(keys)), len(keys))
    steps = table.get("count")
    start, stop = Decimal(table["from"]), Decimal(table["to"])
    return spaced(keys[0], start, stop, None if steps is None else int(steps), len(keys))
