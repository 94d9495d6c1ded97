"""A profile's table against the JSON Schema next to this module: its faults in words."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

from jsonschema_rs import Draft202012Validator, ValidationError

from camgeo.declared import allowed, schema_beside
from camgeo.errors import Fault, meant
from camgeo.numeric.checked import shown

EARLIER: Final = {
    "preamble": "program.safe_start",
    "spindle_on": "spindle.clockwise",
    "end": "program.end",
    "comment": "text",
    "decimals": "numbers.decimals",
    "blending": "smoothing",
}
"""Keys of earlier profiles, and the keys that took their place."""

MOST_FAULTS: Final = 200
"""Most faults reported of one profile."""


@functools.cache
def schema() -> dict[str, Any]:
    """The JSON Schema of a profile."""
    return schema_beside(str(Path(__file__).with_name("machine.py")), "machine.schema")


@functools.cache
def _validator() -> Draft202012Validator:
    return Draft202012Validator(schema())


def faults_of(table: dict[str, Any]) -> list[Fault]:
    """What is wrong with a profile; empty if nothing is."""
    found: list[Fault] = []
    for error in _validator().iter_errors(table):
        node = _node(error)
        path = list(error.instance_path)
        if error.kind.name == "additionalProperties":
            for name in error.kind.as_dict()["unexpected"]:
                found.append(_unknown([*path, name], node))
        elif error.kind.name == "required":
            name = str(error.kind.as_dict()["property"])
            what = node["properties"][name]["description"].rstrip(".")
            found.append(Fault(_key([*path, name]), "", f"is missing: {what}"))
        else:
            value: Any = table
            for step in path:
                value = value[step]
            close = meant(value, node.get("enum", ()), '"') if isinstance(value, str) else ""
            found.append(Fault(_key(path), shown(value), allowed(node), close))
        if len(found) >= MOST_FAULTS:
            return [*found[:MOST_FAULTS], Fault("", "", "there are more faults than are listed")]
    return found


def _unknown(path: Sequence[str | int], node: dict[str, Any]) -> Fault:
    name = str(path[-1])
    if len(path) == 1 and name in EARLIER:
        return Fault(name, "", f"is a key of earlier profiles; it is {EARLIER[name]} now")
    known = list(node["properties"])
    hint = meant(name, known)
    message = "is not a known key" if hint else f"is not a known key; known: {', '.join(known)}"
    return Fault(_key(path), "", message, hint)


def _node(error: ValidationError) -> dict[str, Any]:
    """The node of the schema that an error is about."""
    node: Any = schema()
    for step in error.evaluation_path[:-1]:
        node = node[step]
    return dict(node)


def _key(path: Sequence[str | int]) -> str:
    """A path as messages show it: ``evidence[2].kind``, counted from 1."""
    text = ""
    for step in path:
        text += f"[{step + 1}]" if isinstance(step, int) else f".{step}" if text else step
    return text
