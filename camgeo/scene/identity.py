"""The identity of a scene: SHA-256 of all its values, however they are written.

The values are brought into one form: keys in alphabetical order, numbers exactly, as digits and an
exponent, defaults of the schema filled in (but for keys that came later: the hashes of scenes of
before must not change), and the name of a file replaced by the SHA-256 of its
content. Only zero keeps its sign, which can decide on which side an angle lies.

Files of earlier versions name the hash of the scene's text instead, without the tables of effects,
which change no file. Such files are still verified.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterator, Mapping
from decimal import Decimal
from pathlib import Path
from typing import Any, Final

from camgeo.errors import SceneError
from camgeo.reading import SCENE, TABLE, read_within
from camgeo.scene.document import Document, document
from camgeo.scene.keys import path_of, value_at
from camgeo.scene.schema import EFFECTS, Node, keys_of, names_a_file, resolved, schema_of_all
from camgeo.scene.tree import Tree, without

FORM: Final = "camgeo scene 1"
"""Version of the hashed form; another one would give other hashes of the same values."""

REPORTED_ONLY: Final = (
    ("effects",),
    ("state",),
    ("output", "accuracy"),
    ("part", "material"),
    ("part", "density"),
    ("sweep",),
    ("optimise",),
    ("tolerance",),
)
"""Tables and keys that affect only what is computed and reported, not drawings, programs or bodies.

An effect adds its columns to a value table; so that a scene's other files stay the same to the last
byte with and without it, the hash in them does not depend on it either.
"""

Digests = Callable[[str], str]
"""Gives the SHA-256 of the file that a scene names so, hexadecimal."""


def identity_of(tree: Tree, digests: Digests) -> str:
    """SHA-256 of all that a scene states, hexadecimal."""
    return _hash("all", tree, digests)


def made_of(tree: Tree, digests: Digests) -> str:
    """SHA-256 of all that decides the bytes of the files made from it, hexadecimal."""
    for path in REPORTED_ONLY:
        tree = without(tree, path)
    return _hash("made", tree, digests)


def _hash(what: str, tree: Tree, digests: Digests) -> str:
    text = _Canonical(tree, digests).text(tree, schema_of_all(tree))
    return hashlib.sha256(f"{FORM}, {what}: {text}".encode()).hexdigest()


class _Canonical:
    """Writes values as text that differs for different values."""

    def __init__(self, tree: Tree, digests: Digests) -> None:
        self._tree = tree
        self._digests = digests

    def text(self, value: Any, node: Node) -> str:
        """The value, at which the schema has `node`."""
        node = resolved(node)
        if isinstance(value, dict):
            keys = keys_of(node, value)
            filled = {**self._defaults(keys, value), **value}
            texts = {name: self.text(filled[name], keys.get(name, {})) for name in sorted(filled)}
            pairs = [f"{json.dumps(name)}:{text}" for name, text in texts.items()
                     if not self._is_silent(text, keys.get(name, {}))]  # fmt: skip
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

    def _is_silent(self, text: str, node: Node) -> bool:
        """Whether a key that came after this form says what its absence says."""
        node = resolved(node)
        return "x-added" in node and text == self.text(node["default"], node)

    def _defaults(self, keys: Mapping[str, Node], table: Tree) -> Tree:
        """The meaning of keys missing in the table, where it can be stated as a value."""
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


def hashes_of(path: Path, known: Mapping[str, str]) -> Iterator[str]:
    """The hashes by which files may name the scene file at `path`: of its text, and of its values.

    None if it is not TOML; OSError, or ValueError, if it, or a file that it names, cannot be read
    or is larger than allowed. Files whose SHA-256 is `known` are taken as they were then.
    """

    def digest(name: str) -> str:
        return known.get(name) or hashlib.sha256(read_within(path.parent / name, TABLE)).hexdigest()

    data = read_within(path, SCENE)
    try:
        scene = document(data)
    except SceneError:
        return
    yield hash_of(data, scene)
    if not scene.faults:
        yield made_of(scene.exact, digest)


def hash_of(data: bytes, scene: Document) -> str:
    """SHA-256 of the bytes of a scene file without its effects, hexadecimal.

    `scene` is the parsed file.
    """
    return hashlib.sha256(without_effects(data, scene)).hexdigest()


def without_effects(data: bytes, scene: Document) -> bytes:
    """The bytes of a scene without the lines of what is under ``[effects]``.

    With these go the comments directly above and the empty lines below, or at the end of the file
    the empty lines above. A scene without effects is left as it is, and so is one in which
    these lines cannot be identified.
    """
    if EFFECTS not in scene.exact or not any(path[0] == EFFECTS for path in scene.lines):
        return data
    lines = data.splitlines(keepends=True)
    starts = sorted({line - 1 for line in scene.lines.values()})
    own = {line - 1 for path, line in scene.lines.items() if path[0] == EFFECTS}
    kept = [True] * len(lines)
    for number, start in enumerate(starts):
        if start not in own:
            continue
        end = starts[number + 1] if number + 1 < len(starts) else len(lines)
        last = max((k for k in range(start, end) if not _idle(lines[k])), default=start)
        after = last + 1
        while after < end and not lines[after].strip():
            after += 1
        before = start
        while before and lines[before - 1].lstrip().startswith(b"#"):
            before -= 1
        for k in range(before, after):
            kept[k] = False
    if own and lines and not kept[-1]:
        k = len(lines) - 1
        while k >= 0 and (not kept[k] or not lines[k].strip()):
            kept[k] = False
            k -= 1
    return b"".join(line for line, keep in zip(lines, kept, strict=True) if keep)


def _idle(line: bytes) -> bool:
    """Whether a line is empty or a comment."""
    text = line.strip()
    return not text or text.startswith(b"#")
