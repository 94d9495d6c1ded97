"""Text of a STEP file by ISO 10303-21: numbers, strings, and entities with their numbers."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import Union

PLAIN = re.compile(r"[ -~]")
"""A character that a string holds as it is; quotes and backslashes are doubled."""


class Ref(int):
    """The number of an entity."""


class Word(str):
    """What is written as it stands: an enumeration, `$`, `*`."""

    __slots__ = ()


Value = Union[Ref, Word, str, int, float, "Typed", Sequence["Value"]]


class Typed:
    """A value that names its type."""

    def __init__(self, kind: str, value: Value) -> None:
        self.kind = kind
        self.value = value


NONE, DERIVED = Word("$"), Word("*")


def flag(value: bool) -> Word:
    """A truth value."""
    return Word(".T." if value else ".F.")


def spelled(value: Value) -> str:
    """A parameter."""
    match value:
        case Ref():
            return f"#{int(value)}"
        case Word():
            return str(value)
        case str():
            return f"'{encoded(value)}'"
        case float():
            return real(value)
        case int():
            return str(value)
        case Typed():
            return f"{value.kind}({spelled(value.value)})"
    return f"({','.join(map(spelled, value))})"


def real(value: float) -> str:
    """A number with the point that the format demands, shortest, and read as the same double."""
    text = repr(value + 0.0)  # -0.0 becomes 0.0
    mantissa, _, exponent = text.partition("e")
    mantissa = mantissa.removesuffix("0") if mantissa.endswith(".0") else mantissa
    mantissa = mantissa if "." in mantissa else f"{mantissa}."
    return f"{mantissa}E{int(exponent)}" if exponent else mantissa


def encoded(text: str) -> str:
    """A string in the characters of ISO 646, with directives for all others."""
    return "".join(_runs(text))


def _runs(text: str) -> Iterator[str]:
    for digits, run in groupby(text, _digits):
        if not digits:
            yield "".join(run).replace("\\", "\\\\").replace("'", "''")
        else:
            codes = "".join(f"{ord(each):0{digits}X}" for each in run)
            yield f"\\X{digits // 2}\\{codes}\\X0\\"


def _digits(character: str) -> int:
    """Hexadecimal digits of a character; 0 if it needs none."""
    if PLAIN.fullmatch(character):
        return 0
    return 4 if ord(character) <= 0xFFFF else 8


class Entities:
    """The entities of a file, numbered from 1 as they are added."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self._known: dict[str, Ref] = {}

    def add(self, kind: str, *values: Value) -> Ref:
        """A new entity."""
        return self._line(f"{kind}{spelled(values)}")

    def shared(self, kind: str, *values: Value) -> Ref:
        """An entity that others may refer to as well: there is one of each."""
        text = f"{kind}{spelled(values)}"
        if text not in self._known:
            self._known[text] = self._line(text)
        return self._known[text]

    def complex(self, *parts: tuple[str, tuple[Value, ...]]) -> Ref:
        """An entity of several types, in the order of the alphabet."""
        return self._line(f"({''.join(f'{kind}{spelled(values)}' for kind, values in parts)})")

    def _line(self, text: str) -> Ref:
        self.lines.append(f"#{len(self.lines) + 1}={text};")
        return Ref(len(self.lines))
