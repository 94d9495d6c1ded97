"""Rules on the tolerances that a scene states in `[tolerance]`."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from camgeo.scene.valid_values import Broken, ValidValues

TOLERANCE: Final = "tolerance"
"""The table of the scene that states tolerances."""

RANGES: Final = ("plus_minus", "limits", "class")
"""Keys of which a dimension has one."""


def tolerances_are_stated_once(values: ValidValues) -> Iterator[Broken]:
    """Each dimension is there once and has one range."""
    table = values.raw(TOLERANCE)
    if not isinstance(table, dict):
        return
    if not any(each in table for each in ("dimension", "clearance", "form")):
        yield (TOLERANCE,), 'states no tolerance: it needs "dimension", "clearance" or "form"'
    seen: set[str] = set()
    for index in range(len(_tables(table, "dimension"))):
        place = (TOLERANCE, "dimension", index)
        if values.valid(*place):
            yield from _dimension(values, place, seen)
    for index, fit in enumerate(_tables(table, "clearance")):
        place = (TOLERANCE, "clearance", index)
        if values.valid(*place) and fit["at"] != "cam":
            yield from _pinned(values, place)


def _tables(table: dict[str, list[dict[str, str]]], key: str) -> list[dict[str, str]]:
    found = table.get(key)
    return found if isinstance(found, list) else []


def _dimension(
    values: ValidValues, place: tuple[str | int, ...], seen: set[str]
) -> Iterator[Broken]:
    table = values.get(*place)
    if sum(each in table for each in RANGES) != 1:
        yield place, 'must have one of "plus_minus", "limits" and "class"'
    limits = table.get("limits")
    if limits is not None and not limits[0] < limits[1]:
        yield (*place, "limits"), "must end above where it begins, [from, to]"
    if "sigma" in table and table.get("distribution", "normal") != "normal":
        yield (*place, "sigma"), 'belongs to distribution "normal": the others end at their limits'
    if table["key"] in seen:
        yield (*place, "key"), "has a tolerance already"
    seen.add(table["key"])


def _pinned(values: ValidValues, place: tuple[str | int, ...]) -> Iterator[Broken]:
    """A clearance that is not the cam's states its diameter, and the load decides."""
    if not values.has(*place, "size"):
        yield place, 'needs "size", the nominal diameter of the pin'
    if values.has(*place, "shifted"):
        message = 'belongs to at = "cam": a roller is always pushed off the cam by the load'
        yield (*place, "shifted"), message
