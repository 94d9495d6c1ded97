"""The whole JSON Schema of scenes, as an editor or a page of documentation uses it.

Where effects do not apply is stated in their descriptions, and in those of the keys of [follower]
with which they do not: both follow from the effects' own rules.
"""

from __future__ import annotations

import copy
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any

from camgeo.dynamics.effects.effect import Effect
from camgeo.dynamics.effects.registry import EFFECTS, find_effect
from camgeo.dynamics.effects.rules import Only
from camgeo.scene.formats.format import FORMATS, find_format
from camgeo.scene.schema import Node, milling_tables, with_tables

if TYPE_CHECKING:
    pass


def whole_schema(names: Iterable[str] = EFFECTS) -> Node:
    """Return the schema with the tables of the effects `names`; the caller's own to change."""
    effects = [find_effect(name) for name in names]
    formats = {name: find_format(name).schema for name in FORMATS}
    named = {each.name: each.schema for each in effects}
    root: Node = copy.deepcopy(with_tables(named, formats, milling_tables()))
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
    for inner in (
        root.values() if isinstance(root, dict) else root if isinstance(root, list) else ()
    ):
        yield from _nodes(inner)
