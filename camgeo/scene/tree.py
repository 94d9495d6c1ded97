"""The values of a scene as tables, lists and single values: taken from Python, shown, edited.

A tree consists of dicts, lists, text, booleans, integers and Decimals, and is never changed:
an edit makes a new one, which shares all unchanged parts with the first.
"""

from __future__ import annotations

from collections.abc import Mapping
from decimal import Decimal
from types import MappingProxyType
from typing import Any, Final

from camgeo.errors import Fault, SceneError
from camgeo.scene.keys import Path, path_of, spelled

DEEPEST: Final = 16
"""Largest depth of nesting that is read; a scene needs 4."""

MOST_VALUES: Final = 1_000_000
"""Single values, lists and tables of the largest scene; a file of allowed size has no more."""

Tree = dict[str, Any]


class Taking:
    """Takes values that come from Python; a float is the decimal number that Python prints.

    A value that no scene may have stays as it is, to be reported among the scene's faults.
    """

    def __init__(self) -> None:
        self._count = 0

    def take(self, value: Any, path: Path = ()) -> Any:
        """An independent tree; SceneError if it is too deep or too large, or a name is not text."""
        self._count += 1
        if len(path) > DEEPEST:
            raise refused("is nested too deeply for a scene")
        if self._count > MOST_VALUES:
            raise refused("has too many values")
        if isinstance(value, Mapping):
            return {self._name(key, path): self.take(value[key], (*path, key)) for key in value}
        if isinstance(value, list | tuple):
            return [self.take(item, (*path, index)) for index, item in enumerate(value)]
        if isinstance(value, float):
            return Decimal(float.__repr__(value))
        if isinstance(value, int) and not isinstance(value, bool):
            return int(value)
        return str.__str__(value) if isinstance(value, str) else value

    def _name(self, key: Any, path: Path) -> str:
        if isinstance(key, str):
            return str.__str__(key)
        message = "the names of keys must be text"
        raise SceneError([Fault(spelled(path), repr(key)[:60], message)])


def read_only(tree: Any) -> Any:
    """The same values in mappings and tuples that cannot be changed."""
    if isinstance(tree, dict):
        return MappingProxyType({key: read_only(item) for key, item in tree.items()})
    if isinstance(tree, list):
        return tuple(read_only(item) for item in tree)
    return tree


def edited(tree: Tree, edits: Mapping[str, Any]) -> Tree:
    """The tree with other values at keys that are spelled as messages do; None removes a key.

    Missing tables are created; a new key follows the one that the previous edit set in
    its table. Values are set before any are removed, so that positions are those in the tree as it
    was.

    Raises
    ------
    SceneError
        With each key that is invalid, or leads into something other than a table or list.
    """
    taking = Taking()
    faults: list[Fault] = []
    removed: list[Path] = []
    last: Path = ()
    for key, value in edits.items():
        try:
            path = _path(tree, key)
            if value is None:
                removed.append(path)
            else:
                tree = _with(tree, path, taking.take(value, path), last)
                last = path
        except _NoPlaceError as error:
            faults.append(Fault(str(key), "", str(error)))
    if faults:
        raise SceneError(faults)
    for path in sorted(removed, key=_order, reverse=True):
        tree = without(tree, path)
    return tree


class _NoPlaceError(Exception):
    """A key leads nowhere."""


def _path(tree: Tree, key: Any) -> Path:
    """The path of `key`; a position may be written as a name too, motion.2.law."""
    path = path_of(key) if isinstance(key, str) else None
    if not path:
        raise _NoPlaceError("is not a key; write it as messages do, e.g. motion[2].law")
    node: Any = tree
    found: Path = ()
    for step in path:
        if isinstance(node, list):
            if isinstance(step, str) and step.isdecimal():
                step = int(step) - 1
            if not isinstance(step, int) or not 0 <= step < len(node):
                positions = f"its positions are 1 to {len(node)}"
                raise _NoPlaceError(f"{spelled(found)} is a list: {positions}")
            node = node[step]
        elif isinstance(node, dict | None):
            if isinstance(step, int):
                raise _NoPlaceError(f"{spelled(found) or 'the scene'} is not a list")
            node = None if node is None else node.get(step)
        else:
            raise _NoPlaceError(f"{spelled(found)} is not a table")
        found = (*found, step)
    return found


def _with(node: Any, path: Path, value: Any, last: Path) -> Any:
    """The node with a value at `path`; a new key follows `last`, if that is in the same table."""
    if not path:
        return value
    step, rest = path[0], path[1:]
    below = last[1:] if last[:1] == path[:1] else ()
    if isinstance(step, int):
        return [*node[:step], _with(node[step], rest, value, below), *node[step + 1 :]]
    table = node or {}
    made = {**table, step: _with(table.get(step), rest, value, below)}
    if step in table or len(last) != 1 or last[0] not in table:
        return made
    names = [name for name in made if name != step]
    names.insert(names.index(last[0]) + 1, step)
    return {name: made[name] for name in names}


def without(node: Any, path: Path) -> Any:
    """The node without what is at `path`, if there is anything."""
    step, rest = path[0], path[1:]
    if isinstance(step, int):
        return [*node[:step], *([without(node[step], rest)] if rest else []), *node[step + 1 :]]
    if not node or step not in node:
        return node
    if rest:
        return {**node, step: without(node[step], rest)}
    return {key: item for key, item in node.items() if key != step}


def _order(path: Path) -> list[tuple[int, str]]:
    return [(step, "") if isinstance(step, int) else (-1, step) for step in path]


def refused(message: str, line: int | None = None) -> SceneError:
    """An error of the scene as a whole."""
    return SceneError([Fault("", "", f"the scene {message}", line=line)])
