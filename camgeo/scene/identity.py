"""What a scene is known by: SHA-256 of all its values, however they are written.

The values are brought into one form: keys in alphabetical order, numbers exactly, as digits and an
exponent, defaults of the schema filled in, and in place of a file's name the SHA-256 of what is in
it. Only a zero keeps its sign, for a sign of zero can decide on which side an angle lies.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping
from decimal import Decimal
from typing import Any, Final

from camgeo.scene.keys import path_of, value_at
from camgeo.scene.schema import Node, keys_of, names_a_file, resolved, schema_of_all
from camgeo.scene.tree import Tree, without

FORM: Final = "camgeo scene 1"
"""Of what is hashed; another one would give other hashes of the same values."""

TOLD_ONLY: Final = (("effects",), ("output", "accuracy"))
"""Tables that affect only what is computed and reported, not drawings, programs or bodies.

An effect adds its columns to a value table; so that a scene's other files stay the same to the last
byte, with and without it, neither does the hash that stands in them know it.
"""

Digests = Callable[[str], str]
"""SHA-256 of the file that a scene calls by this name, hexadecimal."""


def identity_of(tree: Tree, digests: Digests) -> str:
    """Of all that a scene says, hexadecimal."""
    return _hash("all", tree, digests)


def made_of(tree: Tree, digests: Digests) -> str:
    """Of all that decides the bytes of the files made from it, hexadecimal."""
    for path in TOLD_ONLY:
        tree = without(tree, path)
    return _hash("made", tree, digests)


def _hash(what: str, tree: Tree, digests: Digests) -> str:
    text = _Canonical(tree, digests).text(tree, schema_of_all(tree))
    return hashlib.sha256(f"{FORM}, {what}: {text}".encode()).hexdigest()


class _Canonical:
    """Writes values as text, no two different ones alike."""

    def __init__(self, tree: Tree, digests: Digests) -> None:
        self._tree = tree
        self._digests = digests

    def text(self, value: Any, node: Node) -> str:
        """The value, at which the schema has `node`."""
        node = resolved(node)
        if isinstance(value, dict):
            keys = keys_of(node, value)
            filled = {**self._defaults(keys, value), **value}
            pairs = [f"{json.dumps(name)}:{self.text(filled[name], keys.get(name, {}))}"
                     for name in sorted(filled)]  # fmt: skip
            return f"{{{','.join(pairs)}}}"
        if isinstance(value, list):
            return f"[{','.join(self.text(item, node.get('items', {})) for item in value)}]"
        if isinstance(value, bool):
            return "true" if value else "false"
        if isinstance(value, int | float | Decimal):
            return _number(value)
        if names_a_file(node, value):
            return f"<{self._digests(value)}>"
        return json.dumps(value)

    def _defaults(self, keys: Mapping[str, Node], table: Tree) -> Tree:
        """What the keys that the table does not have mean, where a value could be stated for it."""
        found = {name: self._default(resolved(keys[name]), table) for name in keys.keys() - table}
        return {name: value for name, value in found.items() if value is not None}

    def _default(self, node: Node, table: Tree) -> Any:
        if "x-default-mm" in node:  # no number of inches is the same to the last digit
            inches = value_at(self._tree, ("units", "length")) == "inch"
            return None if inches else node["x-default-mm"]
        if "x-default-by-law" in node:
            return node["x-default-by-law"].get(table.get("law"))
        main = value_at(self._tree, path_of(node.get("x-default-key", "")) or ("",))
        return node.get("default") if main is None else main


def _number(value: float | Decimal) -> str:
    """Digits without zeros at either end, and an exponent; 40, 40.0 and 4e1 are all 4e1."""
    number = Decimal(repr(value)) if isinstance(value, float) else Decimal(value)
    sign, digits, exponent = number.as_tuple()
    text = "".join(map(str, digits)).lstrip("0")
    kept = text.rstrip("0")
    assert isinstance(exponent, int)  # a scene has finite numbers only
    return f"{'-' if sign else ''}{kept or 0}e{exponent + len(text) - len(kept) if kept else 0}"
