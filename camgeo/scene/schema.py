"""The JSON Schema of the scene format: the one definition of its keys, types and ranges.

It is composed: of the file beside this module, and of what followers and linkages declare of their
tables. Besides the keywords of JSON Schema it carries these, for the messages:

x-allowed : what is allowed, in words; else the words follow from type and range.
x-foreign : group of entry points by whose names other distributions add keys to the table.
x-later : values or keys that the format names but this version does not have.
x-siblings : names of the definitions that stand beside this one in a choice.
x-unit : unit of a number.
x-unknown : what to say of any key that is not known here.
x-values : values to suggest where the schema has only a pattern.
"""

from __future__ import annotations

import functools
import json
import pathlib
from typing import Any, Final

from jsonschema_rs import Draft202012Validator

from camgeo.scene.kinds import with_kinds

SCHEMA_FILE: Final = pathlib.Path(__file__).with_name("schema.json")

Node = dict[str, Any]
"""An object of the schema."""


@functools.cache
def schema() -> Node:
    """Return the schema; it is shared and must not be changed."""
    return with_kinds(json.loads(SCHEMA_FILE.read_bytes()))


@functools.cache
def validator() -> Draft202012Validator:
    """Return the compiled schema."""
    return Draft202012Validator(schema())


def definition(name: str) -> Node:
    """Return one of the schema's definitions."""
    node: Node = schema()["$defs"][name]
    return node


def node_at(evaluation: list[str | int]) -> Node:
    """Return the node on whose last keyword an evaluation path of the validator ends.

    What stands beside a reference says more of the key than what is referred to, and wins.
    """
    root = schema()
    node: Any = root
    for step in evaluation[:-1]:
        if step == "$ref":
            beside = {key: value for key, value in node.items() if key != "$ref"}
            node = {**definition(node["$ref"].rpartition("/")[2]), **beside}
        else:
            node = node[step]
    return node if isinstance(node, dict) else {}


def resolved(node: Node | bool) -> Node:
    """Return a property's node with its references followed."""
    if isinstance(node, bool):
        return {}
    while "$ref" in node:
        beside = {key: value for key, value in node.items() if key != "$ref"}
        node = {**definition(node["$ref"].rpartition("/")[2]), **beside}
    return node
