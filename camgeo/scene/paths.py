"""Paths of keys that a scene may have, whether or not it states them."""

from __future__ import annotations

from typing import Any, Final

from camgeo.errors import Fault, SceneError, meant
from camgeo.scene.keys import Path, path_of, spelled
from camgeo.scene.schema import Node, keys_of, resolved, schema_for
from camgeo.scene.tree import Tree
from camgeo.wording import listed

CONTAINERS: Final = {"object": "table", "array": "list"}
"""Types of the schema that are no single value, and their names."""


def value_path(tree: Tree, key: str) -> Path:
    """The path of a single value of a scene with this tree, spelled as messages do.

    Positions are counted from 1, as in motion[2].law or motion.2.law. The path must be one that the
    schema has; the scene need not state it, but a list has no positions beyond those stated.

    Raises
    ------
    SceneError
        If there is no such key, with the nearest name; if it is a table or a list.
    """
    path = path_of(key)
    if not path:
        raise _refused(key, "is no key of a scene; write one as messages do, e.g. motion[2].law")
    node: Node = resolved(schema_for(tree).root)
    value: Any = tree
    found: Path = ()
    for step in path:
        keys = keys_of(node, value if isinstance(value, dict) else {})
        if isinstance(value, list) or "items" in node:
            found = (*found, _position(key, step, value, found))
            node, value = resolved(node.get("items", {})), value[found[-1]]
            continue
        if isinstance(step, int):
            raise _refused(key, f"{_name(found)} is not a list")
        if keys and step not in keys:
            hint = meant(spelled((*found, step)), [spelled((*found, each)) for each in keys])
            message = f"is no key of a scene; {_name(found)} has {listed(sorted(keys))}"
            raise _refused(key, message, hint)
        if not keys and found and _single(node):
            raise _refused(key, f"is no key of a scene; {_name(found)} is a single value")
        found = (*found, step)
        node = resolved(keys.get(step, {}))
        value = value.get(step) if isinstance(value, dict) else None
    kind = CONTAINERS.get(str(node.get("type"))) or _container(value)
    if kind is not None:
        within = "one of its keys" if kind == "table" else "a position in it"
        raise _refused(key, f"is a {kind}: name {within}, as {spelled(found)}{_within(node, kind)}")
    return found


def _position(key: str, step: str | int, value: Any, found: Path) -> int:
    """The position of a list that a step names, from 0; it may be written as a name."""
    if isinstance(step, str) and step.isdecimal():
        step = int(step) - 1
    count = len(value) if isinstance(value, list) else 0
    if not isinstance(step, int) or not 0 <= step < count:
        positions = f"its positions are 1 to {count}" if count else "the scene states none of it"
        raise _refused(key, f"{_name(found)} is a list: {positions}")
    return step


def _name(path: Path) -> str:
    return spelled(path) or "the scene"


def _single(node: Node) -> bool:
    return node.get("type") in ("number", "integer", "string", "boolean") or "enum" in node


def _container(value: Any) -> str | None:
    return "table" if isinstance(value, dict) else "list" if isinstance(value, list) else None


def _within(node: Node, kind: str) -> str:
    """What might follow the name of a table or list."""
    if kind == "list":
        return "[1]"
    return "." + next(iter(keys_of(node, {})), "KEY")


def _refused(key: str, message: str, hint: str = "") -> SceneError:
    return SceneError([Fault(key, "", message, hint)])
