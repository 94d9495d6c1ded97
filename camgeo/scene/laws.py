"""The motion laws in the schema of the scene: names and parameters as their registry has them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from camgeo.motion.laws import ALIASES, FAMILIES, OPTIONS
from camgeo.motion.planning.request import AUTO

BY_DATA: Final = ("table", "points")
"""Words for motion by data, in place of a law."""

INFLECTION: Final = "inflection"

SHAPES: Final = (INFLECTION, *OPTIONS)
"""Keys of a move that shape its law."""


def with_laws(frame: Mapping[str, Any]) -> dict[str, Any]:
    """The schema `frame` with the names of all laws and the keys of their parameters."""
    move = frame["$defs"]["move"]
    keys = dict(move["properties"])
    names = (AUTO, *(each for name in FAMILIES for each in (name, *FAMILIES[name].aliases)))
    also = (f'"{alias}" is another name of "{name}".' for alias, name in ALIASES.items())
    described = " ".join((keys["law"]["description"], *also))
    keys["law"] = {**keys["law"], "description": described, "enum": [*names, *BY_DATA]}
    place = list(keys).index(INFLECTION) + 1
    own = {name: _option(name) for name in OPTIONS}
    items = list(keys.items())
    move = {**move, "properties": dict([*items[:place], *own.items(), *items[place:]])}
    return {**frame, "$defs": {**frame["$defs"], "move": move}}


def _option(name: str) -> dict[str, Any]:
    """The node of a parameter that families have of their own."""
    found = {
        family.name: option
        for family in FAMILIES.values()
        for option in family.options
        if option.name == name
    }
    first = next(iter(found.values()))
    told = " and ".join(f'"{law}" (default {each.default:g})' for law, each in found.items())
    return {
        "description": f"{first.symbol}: {first.text}; for {told}.",
        **first.schema,
        "x-default-by-law": {law: each.default for law, each in found.items() if each.always},
    }
