"""A block of a program in terms that all dialects share."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

AXES = "XYZ"

ARMS = "IJK"
"""Words of an arc's centre, by their axes."""


class Number(NamedTuple):
    """A number as printed, and its value."""

    value: float
    text: str

    @property
    def has_point(self) -> bool:
        return "." in self.text

    @property
    def decimals(self) -> int:
        return len(self.text.partition(".")[2])


@dataclass(slots=True)
class Block:
    """One block.

    Attributes
    ----------
    line : in the file, counted from 1.
    codes : what it switches, by modal group: {"motion": "rapid", "unit": "mm"}.
    actions : what it does once: "dwell", "machine-position", "reference", "change-tool".
    values : of its words, by their letters.
    words : the word, as written, that a group or an action comes from; for messages.
    relative : by axis, whether its value adds to the position, where the block says so itself.
    arc : how it states an arc: "centre", "pole", "radius", "polar", "tangent".
    names : further texts of it, e.g. the name of a tool.
    broken : whether a word of it is not read that may say what it does: then it does nothing.
    """

    line: int
    codes: dict[str, str] = field(default_factory=dict)
    actions: dict[str, str] = field(default_factory=dict)
    values: dict[str, Number] = field(default_factory=dict)
    words: dict[str, str] = field(default_factory=dict)
    relative: dict[str, bool] = field(default_factory=dict)
    arc: str = ""
    names: dict[str, str] = field(default_factory=dict)
    broken: bool = False

    def at_line(self, line: int) -> Block:
        """The same block at another line, with values of its own."""
        return Block(
            line,
            self.codes,
            self.actions,
            dict(self.values),
            self.words,
            self.relative,
            self.arc,
            self.names,
            self.broken,
        )

    def value(self, letter: str, default: float = 0.0) -> float:
        """The value of a word, or `default` if it is not there."""
        number = self.values.get(letter)
        return default if number is None else number.value
