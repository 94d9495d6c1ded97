"""Rules on the family of designs that a scene states in `[sweep]`."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from camgeo.errors import SceneError
from camgeo.scene.keys import spelled
from camgeo.scene.valid_values import Broken, ValidValues

SWEEP: Final = "sweep"
"""The table of the scene that states a family; no design of the family has it."""


def sweep_is_a_family(values: ValidValues) -> Iterator[Broken]:
    """Each variable has keys that a scene may have, each once, and values for them."""
    table = values.scene.plain.get(SWEEP)
    if not isinstance(table, dict) or not isinstance(table.get("vary"), list):
        return
    seen: set[str] = set()
    for index in range(len(table["vary"])):
        place = (SWEEP, "vary", index)
        if values.valid(*place):
            yield from _variable(values, place, seen)


def _variable(
    values: ValidValues, place: tuple[str | int, ...], seen: set[str]
) -> Iterator[Broken]:
    table = values.get(*place)
    if ("key" in table) == ("keys" in table):
        yield place, 'must have either "key" or "keys"'
        return
    if "key" in table:
        places = {(*place, "key"): table["key"]}
    else:
        places = {(*place, "keys", number): key for number, key in enumerate(table["keys"])}
    yield from _keys(values, places, seen)
    ranged = "from" in table or "to" in table or "count" in table
    if ("values" in table) == ranged:
        yield place, 'must have either "values", or "from" and "to"'
    elif ranged:
        yield from _range(values, place)
    else:
        yield from _rows(table["values"], place, len(places))


def _keys(
    values: ValidValues, places: dict[tuple[str | int, ...], str], seen: set[str]
) -> Iterator[Broken]:
    from camgeo.scene.paths import value_path  # few scenes state a family

    for where, key in places.items():
        try:
            path = value_path(values.scene.exact, key)
        except SceneError as error:
            (fault,) = error.faults
            yield where, f"{fault.message} ({fault.hint})" if fault.hint else fault.message
            continue
        if path[0] == SWEEP:
            yield where, "is no key of a design"
        elif spelled(path) in seen:
            yield where, "varies twice"
        seen.add(spelled(path))


def _range(values: ValidValues, place: tuple[str | int, ...]) -> Iterator[Broken]:
    table = values.get(*place)
    if "from" not in table or "to" not in table:
        yield place, 'must have both "from" and "to"'
        return
    same = values.exact(*place, "from") == values.exact(*place, "to")
    count = table.get("count")
    if same and count != 1:
        yield (*place, "to"), 'is an empty range: "from" and "to" are the same'
    elif not same and count == 1:
        yield (*place, "count"), "has one value for two ends: must be at least 2"
    elif count is None and not values.has(SWEEP, "samples"):
        yield place, 'needs "count", unless [sweep] has "samples"'


def _rows(rows: list[object], place: tuple[str | int, ...], keys: int) -> Iterator[Broken]:
    seen: set[str] = set()
    for number, row in enumerate(rows):
        where = (*place, "values", number)
        if isinstance(row, list) and len(row) != keys:
            yield where, f"must have a value for each of {keys} keys"
        if repr(row) in seen:
            yield where, "is listed twice"
        seen.add(repr(row))
