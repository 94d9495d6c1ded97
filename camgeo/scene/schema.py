"""The JSON Schema of the scene format: the one definition of its keys, types and ranges.

It is composed of the file next to this module, the declarations of followers and linkages for their
tables and of laws for their parameters, and the tables of effects, formats and milling. A scene is
checked against a schema with the tables of those that it names and no others.

In addition to the keywords of JSON Schema it has these, for the messages:

x-allowed : what is allowed, in words; else the words follow from type and range.
x-exact : the number is passed on as written, a Decimal in the unit of the scene.
x-barring : the name of this key of [follower], with which some effects do not apply.
x-added : true for a key or table that came later; with its default it does not enter the hashes.
x-default-by-law : the value that the key's absence stands for with each law, if always the same.
x-default-key : the key whose value is then used.
x-default-mm : the value then used [mm].
x-file : the text is the name of a file in the scene's folder, with data.
x-hints : what to suggest for values that are not allowed, by value.
x-path : the text is the path of a file in the scene's folder, unless it is one of x-values.
x-siblings : names of the other definitions in a choice.
x-unit : unit of a number.
x-unknown : the message for any key that is not known here.
x-values : values to suggest where the schema has only a pattern.
"""

from __future__ import annotations

import copy
import functools
import json
import pathlib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, TypeVar

from jsonschema_rs import Draft202012Validator

from camgeo.errors import CamgeoError
from camgeo.kinematics.laws import ALIASES, FAMILIES, OPTIONS
from camgeo.kinematics.mechanism.declared.registry import FOLLOWERS, LINKAGES
from camgeo.kinematics.mechanism.values import FollowerKind, LinkageKind
from camgeo.kinematics.planning.requests import AUTO
from camgeo.scene.formats.format import FORMATS, NO_FORMATS, Format, find_format, foreign_names

if TYPE_CHECKING:
    from camgeo.dynamics.effects.effect import Effect, Only


SCHEMA_FILE: Final = pathlib.Path(__file__).with_name("schema.json")

EFFECTS_KEY: Final = "effects"
"""Key of the table of effects."""

FINDERS: Final = ("speed-fluctuation", "camshaft-windup")
"""The effects that find how the cam turns: the first one with a motor, instead of a given speed."""

OUTPUT: Final = "output"
"""Key of the table with those of the formats."""

BY_DATA: Final = ("table", "points")
"""Words for motion by data, in place of a law."""

INFLECTION: Final = "inflection"

SHAPES: Final = (INFLECTION, *OPTIONS)
"""Keys of a move that shape its law."""

MILLING: Final = ("tool", "stock", "holding", "operation", "second_side")
"""Keys of the tables on milling."""

Node = dict[str, Any]
"""An object of the schema."""

Tables = Mapping[str, Mapping[str, Any]]
"""Schemas of tables by their names; an empty one allows anything."""

Declared = TypeVar("Declared")


@functools.cache
def schema() -> Node:
    """Return the schema without effects, formats and milling; shared, and never to be changed."""
    return _with_laws(_with_kinds(json.loads(SCHEMA_FILE.read_bytes())))


def _with_kinds(frame: Mapping[str, Any]) -> Node:
    """The schema `frame` with the tables of all kinds of followers and linkages."""
    top = dict(frame["properties"])
    top["follower"] = _choice(top["follower"], FOLLOWERS.values())
    top["linkage"] = _choice(top["linkage"], LINKAGES.values())
    kind_tables = {name: _table(kind.schema) for name, kind in LINKAGES.items()}
    for name, kind in FOLLOWERS.items():
        kind_tables[name] = {**_table(kind.schema), "x-siblings": _siblings(kind)}
    return {**frame, "properties": top, "$defs": {**frame["$defs"], **kind_tables}}


def _choice(node: Mapping[str, Any], kinds: Iterable[FollowerKind] | Iterable[LinkageKind]) -> Node:
    """The node of a table whose keys depend on its key `kind`, by an if/then for each kind."""
    described = [(kind.name, kind.description) for kind in kinds]
    kind = {
        "description": " ".join(f'"{name}": {text}' for name, text in described),
        "enum": [name for name, _ in described],
    }
    cases = [
        {
            "if": {"properties": {"kind": {"const": name}}, "required": ["kind"]},
            "then": {"$ref": f"#/$defs/{name}"},
        }
        for name, _ in described
    ]
    return {**node, "properties": {"kind": kind}, "allOf": cases}


def _table(schema: Mapping[str, Any]) -> Node:
    return {**schema, "properties": {"kind": True, **schema["properties"]}}


def _siblings(kind: FollowerKind) -> list[str]:
    """The other kinds of followers: those of the same contact first, then of the same unit."""
    others = (other for other in FOLLOWERS.values() if other is not kind)
    return [
        other.name
        for other in sorted(
            others, key=lambda o: (o.touching != kind.touching, o.unit != kind.unit)
        )
    ]


def _with_laws(frame: Mapping[str, Any]) -> Node:
    """The schema `frame` with the names of all laws and the keys of their parameters."""
    move = frame["$defs"]["move"]
    keys = dict(move["properties"])
    names = (AUTO, *(word for name in FAMILIES for word in (name, *FAMILIES[name].aliases)))
    also = (f'"{alias}" is another name of "{name}".' for alias, name in ALIASES.items())
    described = " ".join((keys["law"]["description"], *also))
    keys["law"] = {**keys["law"], "description": described, "enum": [*names, *BY_DATA]}
    place = list(keys).index(INFLECTION) + 1
    options = {name: _option(name) for name in OPTIONS}
    items = list(keys.items())
    move = {**move, "properties": dict([*items[:place], *options.items(), *items[place:]])}
    return {**frame, "$defs": {**frame["$defs"], "move": move}}


def _option(name: str) -> Node:
    """The node of a parameter that only some families have."""
    options = {
        family.name: option
        for family in FAMILIES.values()
        for option in family.options
        if option.name == name
    }
    first = next(iter(options.values()))
    laws = " and ".join(f'"{law}" (default {option.default:g})' for law, option in options.items())
    return {
        "description": f"{first.symbol}: {first.text}; for {laws}.",
        **first.schema,
        "x-default-by-law": {
            law: option.default for law, option in options.items() if option.always
        },
    }


@dataclass(frozen=True)
class Composed:
    """A schema with the tables of some effects and formats."""

    root: Node
    effects: tuple[Effect, ...]
    formats: tuple[Format[Any], ...]

    @functools.cached_property
    def validator(self) -> Draft202012Validator:
        """Validates documents; CamgeoError if a declaration is not a valid schema."""
        try:
            return Draft202012Validator(self.root)
        except ValueError as error:
            raise CamgeoError(
                f"a declaration of another distribution has no valid JSON Schema: {error}"
            ) from error


NAMING: Final = (EFFECTS_KEY, OUTPUT, *MILLING)
"""The tables by which `schema_for` decides."""

Named = tuple[tuple[str, Declared | None], ...]
"""All known names, each with its declaration if the scene names it, else None."""


def schema_for(values: Mapping[str, Any]) -> Composed:
    """Return the schema for a scene with these values: it has the tables that they name.

    Of the other effects and formats it has only the names, for the messages.
    """
    mills = any(name in values for name in MILLING)
    return _composed(_effects(values.get(EFFECTS_KEY)), _formats(values.get(OUTPUT)), mills=mills)


@functools.cache
def milling_tables() -> Node:
    """Return the schemas of the tables on milling, by their keys; shared, never to be changed."""
    from camgeo.milling.milling import tables  # few scenes mill

    return tables()


def _effects(named: Any) -> Named[Effect]:
    if not isinstance(named, dict) or not named:
        return ()
    from camgeo.dynamics.effects import registry  # few scenes name an effect

    known = registry.EFFECTS
    if not named.keys() <= set(known):
        known = registry.effect_names()
    return tuple((name, registry.find_effect(name) if name in named else None) for name in known)


def _formats(output: Any) -> Named[Format[Any]]:
    """The formats, by what a scene lists and by its tables of options."""
    table = output if isinstance(output, dict) else {}
    listed = table.get("formats")
    words = (*(listed if isinstance(listed, list) else ()), *table)
    frame = schema()["properties"][OUTPUT]["properties"]
    named = {word for word in words if isinstance(word, str) and word not in frame}
    known = FORMATS if named <= set(FORMATS) else (*FORMATS, *foreign_names())
    return tuple((name, find_format(name) if name in named else None) for name in known)


@functools.lru_cache(maxsize=64)
def _composed(effects: Named[Effect], formats: Named[Format[Any]], *, mills: bool) -> Composed:
    root = _with_tables(
        {name: effect.schema if effect else {} for name, effect in effects},
        {name: form.schema if form else {} for name, form in formats},
        milling_tables() if mills else {},
    )
    return Composed(
        root,
        tuple(effect for _, effect in effects if effect),
        tuple(form for _, form in formats if form),
    )


def _with_tables(effects: Tables, formats: Tables, milling: Tables) -> Node:
    """Return the schema with these tables; what it shares must not be changed."""
    top = schema()["properties"]
    effects_table = {
        **top[EFFECTS_KEY],
        "properties": {name: dict(table) for name, table in effects.items()},
    }
    keys = top[OUTPUT]["properties"]
    listed = {**keys["formats"], "items": {"enum": list(formats), "x-hints": NO_FORMATS}}
    listed["description"] = listed["description"].format(formats=", ".join(formats))
    tables = {name: _optional(table) for name, table in formats.items()}
    output = {**top[OUTPUT], "properties": {**keys, "formats": listed, **tables}}
    added = {EFFECTS_KEY: effects_table, OUTPUT: output, **milling}
    return {**schema(), "properties": {**top, **added}}


def _optional(table: Mapping[str, Any]) -> Node:
    """The table of a format; where it may be empty, a missing one means the same."""
    return dict(table) if "required" in table or not table else {**table, "default": {}}


def whole_schema(names: Iterable[str] = ()) -> Node:
    """Return the schema as an editor or a page of documentation uses it, a copy of its own.

    It has the tables of the effects `names`, by default of all of camgeo, of formats and of
    milling. Where effects do not apply is stated in their descriptions, and in those of the keys of
    [follower] with which they do not: both follow from the effects' own rules.
    """
    from camgeo.dynamics.effects import registry  # no scene needs all of them

    effects = [registry.find_effect(name) for name in names or registry.EFFECTS]
    formats = {name: find_format(name).schema for name in FORMATS}
    named = {effect.name: effect.schema for effect in effects}
    root: Node = copy.deepcopy(_with_tables(named, formats, milling_tables()))
    for effect in effects:
        table = root["properties"]["effects"]["properties"][effect.name]
        for rule in _bounds(effect):
            for node in [table["properties"][key] for key in rule.keys] or [table]:
                node["description"] = (
                    f"{node.get('description', '')} {rule.kind.description}".lstrip()
                )
    for node in _nodes(root):
        if "x-barring" in node:
            node["description"] += f" Not with {', '.join(_barred(effects, node['x-barring']))}."
    return root


def _bounds(effect: Effect) -> Iterator[Only]:
    from camgeo.dynamics.effects.effect import Only

    return (rule for rule in effect.rules if isinstance(rule, Only))


def _barred(effects: Iterable[Effect], key: str) -> Iterator[str]:
    """The effects, or keys of theirs, that do not apply together with the `key` of [follower]."""
    for effect in effects:
        for rule in _bounds(effect):
            if rule.kind.barring == key:
                yield f"[effects.{effect.name}] {' and '.join(rule.keys)}".rstrip()


def _nodes(root: Any) -> Iterator[Node]:
    """All objects of the schema."""
    if isinstance(root, dict):
        yield root
    inside = root.values() if isinstance(root, dict) else root if isinstance(root, list) else ()
    for inner in inside:
        yield from _nodes(inner)


def definition(name: str) -> Node:
    """Return one of the schema's definitions."""
    node: Node = schema()["$defs"][name]
    return node


def resolved(node: Node | bool) -> Node:
    """Return a property's node with its references followed."""
    if isinstance(node, bool):  # JSON Schema's `true`: anything is allowed
        return {}
    while "$ref" in node:
        node = referred(node)
    return node


def referred(node: Node) -> Node:
    """The definition that a node refers to; keywords next to the reference take precedence."""
    overrides = {key: value for key, value in node.items() if key != "$ref"}
    return {**definition(node["$ref"].rpartition("/")[2]), **overrides}


def table_keys(node: Node | bool, table: Node) -> dict[str, Node]:
    """Return the keys of a table with their nodes; for a table with kinds, those of its kind."""
    node = resolved(node)
    keys = dict(node.get("properties", {}))
    for choice in (*node.get("allOf", ()), node):
        if "if" in choice:
            branch = "then" if _meets(choice["if"], table) else "else"
            keys.update(table_keys(choice.get(branch, {}), table))
    return keys


def _meets(condition: Node, table: Node) -> bool:
    """Whether a table has the keys, with the constants, of an ``if`` of the schema."""
    constants = {key: node["const"] for key, node in condition.get("properties", {}).items()}
    return all(key in table for key in condition["required"]) and all(
        table.get(key) == value for key, value in constants.items()
    )
