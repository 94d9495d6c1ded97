"""What varies in a family: keys of the scene, and the values that they take."""

from __future__ import annotations

import re
from dataclasses import dataclass
from decimal import Decimal, InvalidOperation
from fractions import Fraction
from typing import Final

from camgeo.errors import GeometryError
from camgeo.scene.varied import Rows, Value, faults_of_list, faults_of_range, plain

QUOTED: Final = r"\"[^\"]*\"|'[^']*'"
"""Text in a list that may have commas and colons."""

TIED: Final = "/"
"""Between the values of tied keys: `A,B=1/2,3/4` gives A 1 with B 2, and A 3 with B 4."""

FORMS: Final = (
    "must be START:STOP:COUNT, a list as 1,2,3, or START:STOP where designs are samples,"
    " e.g. follower.base_radius=30:60:31"
)


@dataclass(frozen=True, slots=True)
class Listed:
    """Values that are stated.

    Attributes
    ----------
    rows : a row for each step of the variable, with a value for each of its keys.
    """

    rows: tuple[tuple[Value, ...], ...]

    @property
    def count(self) -> int:
        """How many there are."""
        return len(self.rows)

    def at(self, place: int) -> tuple[Value, ...]:
        """The row at a place, from 0."""
        return self.rows[place]

    def share(self, share: float) -> tuple[Value, ...]:
        """The row at a share, from 0 to below 1, of the list."""
        return self.rows[min(int(share * self.count), self.count - 1)]


@dataclass(frozen=True, slots=True)
class Range:
    """Evenly spaced numbers, the same for all keys of a variable.

    Attributes
    ----------
    start, stop : the first and the last number, exactly as stated.
    steps : how many numbers; None for a range that is only sampled.
    keys : how many keys take the number.
    """

    start: Decimal
    stop: Decimal
    steps: int | None
    keys: int = 1

    @property
    def count(self) -> int:
        """How many there are; 0 if it is only sampled."""
        return self.steps or 0

    def at(self, place: int) -> tuple[Value, ...]:
        """The number at a place, from 0, for each key: exact, rounded once."""
        first, last = Fraction(self.start), Fraction(self.stop)
        parts = max(self.count - 1, 1)
        return (plain(float(first + (last - first) * place / parts)),) * self.keys

    def share(self, share: float) -> tuple[Value, ...]:
        """The number at a share, from 0 to below 1, of the range, for each key."""
        if self.steps is not None:
            return self.at(min(int(share * self.count), self.count - 1))
        start, stop = float(self.start), float(self.stop)
        return (plain(start + (stop - start) * share),) * self.keys


@dataclass(frozen=True, slots=True)
class Variable:
    """Keys of a scene that vary together.

    Attributes
    ----------
    keys : as messages spell them.
    values : that they take.
    """

    keys: tuple[str, ...]
    values: Listed | Range


def parse(text: str) -> Variable:
    """The variable that `KEY=VALUES` states on a command line, as `--vary`.

    Raises
    ------
    GeometryError
        With the key of the scene, if it states none.
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
    """A checked range; GeometryError with `key` if it has no number, or one for two ends."""
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
    """The values of tied keys in one word of a list; a single one is for all of them."""
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
