"""A family: a scene with other values at some keys. What it has is known before anything runs."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final, Literal, get_args

import numpy as np

from camgeo.errors import GeometryError, SceneError
from camgeo.numeric.arrays import FloatArray
from camgeo.scene.keys import spelled
from camgeo.scene.scene import Scene
from camgeo.scene.varied import FAMILIES, Value, design_path
from camgeo.sweep.variables import Listed, Variable
from camgeo.wording import counted

Method = Literal["sobol", "random"]

METHODS: Final[tuple[str, ...]] = get_args(Method)

MOST: Final = 1_000_000
"""Designs of a family: at the 5 ms that a cheap question takes, an hour and a half."""

Point = tuple[Value, ...]
"""The values at the keys of a family, in their order: what makes one of its designs."""


@dataclass(frozen=True, slots=True)
class Sample:
    """How designs are drawn from the ranges and lists of a family.

    Attributes
    ----------
    count : of the designs.
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
        """(count, dimensions) numbers from 0 to below 1."""
        generator = np.random.default_rng(self.seed)
        if self.method == "random":
            return generator.random((self.count, dimensions))
        from scipy.stats import qmc  # half a second, which no grid needs

        # Only a power of two is balanced; the first of one are what the sequence has first anyway.
        power = max(self.count - 1, 0).bit_length()
        found: FloatArray = qmc.Sobol(dimensions, rng=generator).random_base2(power)
        return found[: self.count]


@dataclass(frozen=True)
class Family:
    """The designs of a sweep: all combinations of the variables' values, or a sample of them.

    Attributes
    ----------
    scene : the one in which values are replaced; the families that it states are left out.
    variables : what varies; the last one fastest.
    sample : how designs are drawn; None for all combinations.

    Raises
    ------
    SceneError
        With a key that there is not, and the nearest one, or that is varied twice.
    GeometryError
        With the number of designs, if they are too many; with the key of a range that has no count
        while all combinations are asked for.
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
        found = []
        for variable in self.variables:
            keys = [spelled(design_path(tree, key, seen)) for key in variable.keys]
            found.append(Variable(tuple(keys), variable.values))
            if self.sample is None and not variable.values.count:
                message = "needs a COUNT, START:STOP:COUNT, unless designs are samples"
                raise GeometryError(message, keys[0])
        object.__setattr__(self, "variables", tuple(found))
        if self.count > MOST:
            message = (
                f"{counted(self.count, 'design')} are more than {MOST:,}; nothing was computed"
            )
            raise GeometryError(message, "sweep.vary")

    @property
    def keys(self) -> tuple[str, ...]:
        """The keys that vary, of tied ones all."""
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
        values = [variable.values for variable in self.variables]
        if self.sample is not None:
            rows = [
                each.share(float(share))
                for each, share in zip(values, self._shares[number], strict=True)
            ]
        else:
            rows = []
            for each in reversed(values):
                number, place = divmod(number, each.count)
                rows.append(each.at(place))
            rows.reverse()
        return tuple(value for row in rows for value in row)

    def points(self) -> Iterator[Point]:
        """The values of all designs in their order; a point that comes again is left out."""
        drawn = self.sample is not None
        seen: set[str] = set()
        for number in range(self.count):
            point = self.point(number)
            if drawn:  # samples of lists repeat themselves
                name = mark(point)
                if name in seen:
                    continue
                seen.add(name)
            yield point

    def scene_of(self, point: Point) -> Scene:
        """The scene of a design; SceneError with its faults."""
        return self.scene.with_values(self.edits(point))

    def edits(self, point: Point) -> dict[str, Value]:
        """The values of a design by their keys."""
        return dict(zip(self.keys, point, strict=True))

    def contents(self) -> Mapping[str, bytes]:
        """The contents of all files that designs may name, by these names.

        A file that cannot be read is left out: designs that name it are rows with that reason.
        """
        found = dict(self.scene.source.contents)
        for variable in self.variables:
            if not isinstance(variable.values, Listed):
                continue
            for row in variable.values.rows:
                if not any(isinstance(value, str) for value in row):
                    continue
                edits: dict[str, Any] = dict(zip(variable.keys, row, strict=True))
                try:
                    found |= self.scene.with_values(edits).source.contents
                except SceneError:
                    continue
        return found


def mark(point: Point) -> str:
    """The point as text by which its row is kept: a JSON list."""
    return json.dumps(point, ensure_ascii=False, separators=(",", ":"))
