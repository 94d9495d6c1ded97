"""The form of a scene: its tables with their fields, for right scenes and wrong ones."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Final

from camgeo.designing.fields import Field, Fields, has_keys
from camgeo.designing.labels import title_of
from camgeo.mechanism.declared.registry import FOLLOWERS, LINKAGES
from camgeo.mechanism.kind import FollowerKind, LinkageKind
from camgeo.scene.document import Document
from camgeo.scene.keys import Path, spelled
from camgeo.scene.schema import Node, keys_of, resolved

MOST: Final = 50
"""Tables of one list, e.g. tools, that a form shows."""

APART: Final = ("camgeo", "motion")
"""Keys that are not in the form: the first has only one value, and the motion is a plan."""

KINDS: Final[Mapping[str, Mapping[str, FollowerKind | LinkageKind]]] = {
    "follower": FOLLOWERS,
    "linkage": LINKAGES,
}
"""Tables whose kind can be changed, with their kinds."""


@dataclass(frozen=True, slots=True)
class Section:
    """A table of a scene.

    Attributes
    ----------
    key, title, description : as of a `Field`; the key is empty for the scene itself.
    stated : whether the scene has it.
    kind : its kind, if there are several; None otherwise.
    kinds : the kinds that there are, each with a sentence; None if the kind cannot be changed.
    fields : its keys.
    """

    key: str
    title: str
    description: str
    stated: bool
    kind: str | None
    kinds: tuple[tuple[str, str], ...] | None
    fields: tuple[Field, ...]

    def to_data(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "key": self.key,
            "title": self.title,
            "description": self.description,
            "stated": self.stated,
            "kind": self.kind,
            "kinds": None
            if self.kinds is None
            else [
                {"value": name, "title": name.replace("-", " "), "description": text}
                for name, text in self.kinds
            ],
            "fields": [each.to_data() for each in self.fields],
        }


def form(document: Document) -> tuple[Section, ...]:
    """The tables of a scene: those that it has and those that it could have."""
    fields = Fields(document)
    root = fields.composed.root
    own = [
        found
        for key, node in root["properties"].items()
        if key not in APART and (found := fields.field((key,), node)) is not None
    ]
    top = Section("", "scene", "", True, None, None, tuple(own))
    return (top, *_inner(fields, (), root))


def _inner(fields: Fields, path: Path, node: Node) -> Iterator[Section]:
    """The tables within a table."""
    inner = fields.document.plain if not path else fields.document.at(path)
    for key, each in keys_of(node, inner if isinstance(inner, dict) else {}).items():
        if not path and key in APART:
            continue
        yield from _sections(fields, (*path, key), resolved(each))


def _sections(fields: Fields, path: Path, node: Node) -> Iterator[Section]:
    """The table at `path`, or each of a list of tables, with those in it."""
    stated = fields.document.at(path)
    items = resolved(node.get("items", {}))
    if has_keys(items):
        for index in range(min(len(stated), MOST) if isinstance(stated, list) else 0):
            yield from _table(fields, (*path, index), items, node.get("description", ""))
    elif has_keys(node):
        yield from _table(fields, path, node, node.get("description", ""))


def _table(fields: Fields, path: Path, node: Node, description: str) -> Iterator[Section]:
    table = fields.document.at(path)
    kind = table.get("kind") if isinstance(table, dict) else None
    known = KINDS.get(spelled(path))
    kinds = None
    if known is not None:
        kinds = tuple((name, each.description) for name, each in known.items())
    own = [each for each in fields.of_table(path, node) if known is None or not _is_kind(each)]
    if own or kinds is not None:
        yield Section(
            spelled(path), title_of(path), description, table is not None,
            kind if isinstance(kind, str) else None, kinds, tuple(own),
        )  # fmt: skip
    if table is not None:
        yield from _inner(fields, path, node)


def _is_kind(field: Field) -> bool:
    return field.key.endswith(".kind")
