"""The JSON Schema of the scene format: the one definition of its keys, types and ranges.

It is composed: of the file beside this module, of what followers and linkages declare of their
tables and laws of their parameters, and of the tables of effects. A scene is held against a schema
with the tables of the effects that it names and no others.

Besides the keywords of JSON Schema it carries these, for the messages:

x-allowed : what is allowed, in words; else the words follow from type and range.
x-barring : the name of this key of [follower], with which some effects have no place.
x-default-by-law : what the key's absence means with each law, if always the same.
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
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from jsonschema_rs import Draft202012Validator

from camgeo.scene.kinds import with_kinds
from camgeo.scene.laws import with_laws

if TYPE_CHECKING:
    from camgeo.effects.effect import Effect

SCHEMA_FILE: Final = pathlib.Path(__file__).with_name("schema.json")

EFFECTS: Final = "effects"
"""Key of the table of effects."""

Node = dict[str, Any]
"""An object of the schema."""


@functools.cache
def schema() -> Node:
    """Return the schema without any effects; it is shared and must not be changed."""
    return with_laws(with_kinds(json.loads(SCHEMA_FILE.read_bytes())))


@dataclass(frozen=True, slots=True)
class Composed:
    """A schema with the tables of some effects, and what holds values against it."""

    root: Node
    validator: Draft202012Validator
    effects: tuple[Effect, ...]


def schema_for(values: Mapping[str, Any]) -> Composed:
    """Return the schema for a scene with these values; of effects it has the tables they name.

    Of the other effects it has the names alone, for the messages.
    """
    named = values.get(EFFECTS)
    if not isinstance(named, dict) or not named:
        return _composed(())
    from camgeo.effects import registry  # few scenes name an effect

    known = registry.EFFECTS
    if not named.keys() <= set(known):
        known = registry.effect_names()
    return _composed(
        tuple((name, registry.find_effect(name) if name in named else None) for name in known)
    )


@functools.lru_cache(maxsize=64)
def _composed(effects: tuple[tuple[str, Effect | None], ...]) -> Composed:
    root = with_effects({name: effect.schema if effect else {} for name, effect in effects})
    validator = Draft202012Validator(root)
    return Composed(root, validator, tuple(effect for _, effect in effects if effect))


def with_effects(tables: Mapping[str, Mapping[str, Any]]) -> Node:
    """Return the schema with these tables of effects; what it shares must not be changed."""
    top = schema()["properties"]
    own = {**top[EFFECTS], "properties": {name: dict(table) for name, table in tables.items()}}
    return {**schema(), "properties": {**top, EFFECTS: own}}


def definition(name: str) -> Node:
    """Return one of the schema's definitions."""
    node: Node = schema()["$defs"][name]
    return node


def node_at(root: Node, evaluation: list[str | int]) -> Node:
    """Return the node of `root` on whose last keyword an evaluation path of the validator ends.

    What stands beside a reference says more of the key than what is referred to, and wins.
    """
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
