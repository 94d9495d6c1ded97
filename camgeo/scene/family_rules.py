"""Rules on the families of designs that a scene states in `[sweep]` and `[optimise]`."""

from __future__ import annotations

from collections.abc import Iterator

from camgeo.errors import GeometryError, SceneError
from camgeo.scene.valid_values import Broken, ValidValues
from camgeo.scene.varied import (
    FAMILIES,
    SWEEP,
    design_path,
    faults_of_list,
    faults_of_range,
    keys_in,
    rows_of,
)


def families_vary(values: ValidValues) -> Iterator[Broken]:
    """Each variable has keys that a scene may have, each once, and values for them."""
    for name in FAMILIES:
        table = values.raw(name)
        if not isinstance(table, dict) or not isinstance(table.get("vary"), list):
            continue
        seen: set[str] = set()
        for index in range(len(table["vary"])):
            place = (name, "vary", index)
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
        keys = len(keys_in(table))
        for number, message in faults_of_list(rows_of(table["values"], keys), keys):
            yield (*place, "values", number), message


def _keys(
    values: ValidValues, places: dict[tuple[str | int, ...], str], seen: set[str]
) -> Iterator[Broken]:
    for where, key in places.items():
        try:
            design_path(values.raw(), key, seen)
        except SceneError as error:
            (fault,) = error.faults
            yield where, f"{fault.message} ({fault.hint})" if fault.hint else fault.message
        except GeometryError as error:
            yield where, error.message


def _range(values: ValidValues, place: tuple[str | int, ...]) -> Iterator[Broken]:
    table = values.get(*place)
    start, stop = values.exact(*place, "from"), values.exact(*place, "to")
    if start is None or stop is None:
        yield place, 'must have both "from" and "to"'
        return
    count = table.get("count")
    faults = [((*place, key), why) for key, why in faults_of_range(start, stop, count)]
    if place[0] == SWEEP and count is None and not faults and not values.has(SWEEP, "samples"):
        yield place, 'needs "count", unless [sweep] has "samples"'
    yield from faults
