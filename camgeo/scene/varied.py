"""What may vary in a family of designs, and what values it may take: the one definition, for tables
of a scene as for the options of commands.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from decimal import Decimal
from typing import Any, Final

from camgeo.errors import GeometryError
from camgeo.scene.keys import KeyPath, spelled
from camgeo.scene.values import Tree, value_path

Value = int | float | str | bool
"""A value at a key of a scene, in the units of the scene."""

Rows = Sequence[tuple[Value, ...]]
"""Values of a list, each for all keys that are tied together."""

SWEEP: Final = "sweep"
OPTIMISE: Final = "optimise"
FAMILIES: Final = (SWEEP, OPTIMISE)
"""Tables of the scene that state families; no design of a family has them."""

LARGEST_WHOLE: Final = 2**53
"""Whole numbers below it are written without a fraction, as a key for a whole number needs."""


def plain(number: float) -> int | float:
    """The number, as an integer if it is whole."""
    if number.is_integer() and abs(number) < LARGEST_WHOLE:
        return int(number)
    return number


def design_path(tree: Tree, key: str, seen: set[str]) -> KeyPath:
    """The path of a key that varies, which is added to those `seen`.

    Raises
    ------
    SceneError
        For a key that there is not, with the nearest one.
    GeometryError
        If no design has the key, or it is among those that vary already.
    """
    path = value_path(tree, key)
    if path[0] in FAMILIES:
        raise GeometryError("is no key of a design", key)
    name = spelled(path)
    if name in seen:
        raise GeometryError("varies twice", name)
    seen.add(name)
    return path


def faults_of_range(start: Decimal, stop: Decimal, count: int | None) -> Iterator[tuple[str, str]]:
    """What is wrong with a range of so many numbers, or of any: which key of its table, and why."""
    if count is not None and count < 1:
        yield "count", "is an empty range: there must be at least 1 number"
    elif start == stop and count != 1:
        yield "to", "is an empty range: both ends are the same"
    elif start != stop and count == 1:
        yield "count", "is one number for two ends: there must be at least 2"
    elif not all(math.isfinite(float(each)) for each in (start, stop, stop - start)):
        yield "to", "is too large a number"


def rows_of(values: Sequence[Any], keys: int) -> Rows:
    """The values of a list in a table of a scene; a single one is for all tied keys."""
    rows = ((each if isinstance(each, tuple | list) else (each,) * keys) for each in values)
    return [tuple(_value(each) for each in row) for row in rows]


def faults_of_list(rows: Rows, keys: int) -> Iterator[tuple[int, str]]:
    """What is wrong with a list: at which place, from 0, and why."""
    seen = set()
    for place, row in enumerate(rows):
        if len(row) != keys:
            yield place, f"must have a value for each of {keys} keys"
        if any(isinstance(value, str) and not _encodable(value) for value in row):
            yield place, "has a text that UTF-8 cannot encode"
        if repr(row) in seen:
            yield place, "is listed twice"
        seen.add(repr(row))


def keys_in(table: Mapping[str, Any]) -> tuple[str, ...]:
    """The keys of a variable that a table of a scene states."""
    return tuple(table["keys"]) if "keys" in table else (table["key"],)


def _value(value: Any) -> Value:
    if isinstance(value, Decimal | float):
        return plain(float(value))
    found: Value = value
    return found


def _encodable(text: str) -> bool:
    """Whether UTF-8, in which scenes and stores are written, has a form of the text."""
    try:
        text.encode()
    except UnicodeEncodeError:
        return False
    return True
