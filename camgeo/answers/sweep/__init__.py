"""What `camgeo sweep` finds: the rows of a family, and what is least and greatest among them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from camgeo.answers.answer import Answer
from camgeo.sweep.rows import Row
from camgeo.sweep.sweep import Result

if TYPE_CHECKING:
    from camgeo.scene.scene import Scene
    from camgeo.scene.varied import Value
    from camgeo.sweep.family import Sample


@dataclass(frozen=True, slots=True)
class Design:
    """One design of the family.

    Attributes
    ----------
    values : by the keys that vary.
    answers : by what was asked; None where there is none.
    units : of those answers that designs state in different units.
    reason : why something is missing; empty if nothing failed.
    """

    values: Mapping[str, Value]
    answers: Mapping[str, float | str | None]
    units: Mapping[str, str]
    reason: str


@dataclass(frozen=True, slots=True)
class Span:
    """The answers to one question.

    Attributes
    ----------
    word : what was asked.
    units : of the numbers; several if designs state it in different ones.
    count : designs with an answer.
    least, greatest : the designs with the least and the greatest number, the first of several; None
        if no answer is a number, or if units differ.
    words : how often each answer that is a word was given.
    """

    word: str
    units: tuple[str, ...]
    count: int
    least: Design | None
    greatest: Design | None
    words: Mapping[str, int]

    @property
    def mixed(self) -> bool:
        """Whether designs state the numbers in different units."""
        return len(self.units) > 1

    @property
    def unit(self) -> str:
        """Of the numbers; empty if there is none, or if they have different ones."""
        return self.units[0] if len(self.units) == 1 else ""


@dataclass(frozen=True, slots=True)
class Sweep(Answer):
    """The rows of a family; they are read from the store as they are asked for.

    Attributes
    ----------
    result : the family with its rows.
    spans : of the answers to each question, in the order asked.
    reasons : why designs failed, with the number of designs, the most frequent first.
    failed : designs that lack an answer, with a reason.
    count : all designs.
    """

    command: ClassVar[str] = "sweep"

    result: Result
    spans: tuple[Span, ...]
    reasons: Mapping[str, int]
    failed: int
    count: int

    @property
    def scene(self) -> Scene:
        """The scene that the family starts from."""
        return self.result.family.scene

    @property
    def keys(self) -> tuple[str, ...]:
        """The keys that vary."""
        return self.result.family.keys

    @property
    def sample(self) -> Sample | None:
        """How designs were drawn; None for all combinations."""
        return self.result.family.sample

    @property
    def designs(self) -> Iterator[Design]:
        """All designs, in the order of the family."""
        mixed = frozenset(span.word for span in self.spans if span.mixed)
        return (_design(self.result, row, mixed) for row in self.result.rows)


def answer_of(result: Result) -> Sweep:
    """The answer from the rows, which are read once."""
    spans = [_Spanned() for _ in result.asked]
    reasons: dict[str, int] = {}
    failed = count = 0
    for row in result.rows:
        count += 1
        if row.failed:
            failed += 1
            reasons[row.reason] = reasons.get(row.reason, 0) + 1
        for span, value, unit in zip(spans, row.values, row.units, strict=True):
            span.note(row, value, unit)
    ordered = sorted(reasons.items(), key=lambda item: -item[1])
    found = tuple(
        span.span(result, asked.word) for span, asked in zip(spans, result.asked, strict=True)
    )
    return Sweep(result, found, dict(ordered), failed, count)


class _Spanned:
    """Notes the answers to one question."""

    def __init__(self) -> None:
        self._count = 0
        self._units: dict[str, None] = {}
        self._words: dict[str, int] = {}
        self._least: tuple[float, Row] | None = None
        self._greatest: tuple[float, Row] | None = None

    def note(self, row: Row, value: float | str | None, unit: str) -> None:
        if value is None:
            return
        self._count += 1
        if isinstance(value, str):
            self._words[value] = self._words.get(value, 0) + 1
            return
        self._units[unit] = None
        if self._least is None or value < self._least[0]:
            self._least = value, row
        if self._greatest is None or value > self._greatest[0]:
            self._greatest = value, row

    def span(self, result: Result, word: str) -> Span:
        least, greatest = (
            None if found is None or len(self._units) > 1 else _design(result, found[1])
            for found in (self._least, self._greatest)
        )
        words = dict(sorted(self._words.items()))
        return Span(word, tuple(sorted(self._units)), self._count, least, greatest, words)


def _design(result: Result, row: Row, mixed: frozenset[str] = frozenset()) -> Design:
    words = [asked.word for asked in result.asked]
    values = result.family.edits(row.point)
    answers = dict(zip(words, row.values, strict=True))
    units = {word: unit for word, unit in zip(words, row.units, strict=True) if word in mixed}
    return Design(values, answers, units, row.reason)
