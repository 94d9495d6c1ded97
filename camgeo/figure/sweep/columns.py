"""Columns of a sweep as numbers that can be drawn, and the colours of a column."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.figure.layout import limits
from camgeo.figure.marks import Fill
from camgeo.figure.model import Axis, Entry, Legend
from camgeo.numeric.arrays import FloatArray, frozen
from camgeo.sweep.sweep import Result

COLOURS: Final = (
    "#440154", "#46327e", "#365c8d", "#277f8e", "#1fa187", "#4ac16d", "#a0da39", "#fde725",
)  # fmt: skip
"""From low to high, ascending in lightness too (viridis of matplotlib, CC0)."""

LETTER: Final = 0.08
"""Width of a letter at a tick [inch]."""

FAILED: Final = Fill("#ffffff", "#b3261e", 0.6, hatched=True)
"""Designs without an answer."""


@dataclass(frozen=True, slots=True, eq=False)
class Column:
    """What varies or was asked, for all designs.

    Attributes
    ----------
    label : its name and unit.
    values : (n,) of all designs, NaN where there is none; of words their places in `words`.
    words : the words, in the order of their first appearance; empty for numbers.
    """

    label: str
    values: FloatArray
    words: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "values", frozen(self.values, np.float64))

    @property
    def room(self) -> float:
        """Width of its words [inch], for the margin beside a vertical axis."""
        return LETTER * max(map(len, self.words), default=0)

    @property
    def axis(self) -> Axis:
        """An axis on which all values lie."""
        if self.words:
            ticks = tuple(float(place) for place in range(len(self.words)))
            return Axis((-0.6, len(self.words) - 0.4), self.label, ticks=ticks, names=self.words)
        return Axis(limits([self.values]), self.label)

    @property
    def levels(self) -> FloatArray:
        """(k + 1,) borders of the ranges that colours stand for, equal in width."""
        if self.words:
            return np.arange(float(len(self.words) + 1)) - 0.5
        known = self.values[np.isfinite(self.values)]
        if not len(known):
            return np.array([0.0, 1.0])
        low, high = float(np.min(known)), float(np.max(known))
        found: FloatArray = np.linspace(low, high, len(COLOURS) + 1 if high > low else 2)
        return found

    def level(self, value: float) -> int:
        """The range that a value lies in, from 0."""
        borders = self.levels
        place = int(np.searchsorted(borders, value, side="right")) - 1
        return max(0, min(place, len(borders) - 2))

    def colour(self, level: int) -> str:
        """Of a range."""
        most = max(len(self.levels) - 2, 1)
        return COLOURS[round(level * (len(COLOURS) - 1) / most)]

    @property
    def legend(self) -> Legend:
        """The ranges with their colours, the highest on top, and what has no answer."""
        borders = self.levels
        entries = [
            Entry(self._range(borders, level), Fill(self.colour(level), width=0.0))
            for level in reversed(range(len(borders) - 1))
        ]
        if np.isnan(self.values).any():
            entries.append(Entry("no answer", FAILED))
        return Legend(tuple(entries), "upper left", (1.02, 1.0), size=7.5, gap=0.0)

    def _range(self, borders: FloatArray, level: int) -> str:
        if self.words:
            return self.words[level]
        return f"{borders[level]:.4g} to {borders[level + 1]:.4g}"


def columns_of(result: Result) -> tuple[list[Column], list[Column]]:
    """What varies and what was asked."""
    rows = list(result.rows)
    keys = [
        column(key, [row.point[place] for row in rows])
        for place, key in enumerate(result.family.keys)
    ]
    asked = []
    for place, each in enumerate(result.asked):
        units = sorted({row.units[place] for row in rows if row.units[place]})
        label = f"{each.word} [{' or '.join(units)}]" if units else each.word
        asked.append(column(label, [row.values[place] for row in rows]))
    return keys, asked


def column(label: str, values: Sequence[object]) -> Column:
    """The column of some values: numbers, or words if any of them is one."""
    if any(isinstance(value, str | bool) for value in values):
        words = dict.fromkeys(_word(value) for value in values if value is not None)
        places = {word: float(place) for place, word in enumerate(words)}
        numbers = [np.nan if value is None else places[_word(value)] for value in values]
        return Column(label, np.array(numbers), tuple(words))
    return Column(label, np.array(list(_numbers(values))))


def _numbers(values: Iterable[object]) -> Iterable[float]:
    return (float(value) if isinstance(value, int | float) else np.nan for value in values)


def _word(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)
