"""The faults of a scene against its schema, in terms that a designer uses."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Any, Final

from jsonschema_rs import ValidationError

from camgeo.errors import Fault, meant, nearest
from camgeo.record import allowed
from camgeo.scene.keys import KeyPath, quoted
from camgeo.scene.schema import Composed, Node, definition, referred, resolved, schema
from camgeo.scene.values import Document

UNKNOWN: Final = "additionalProperties"
"""What the validator calls an unknown key."""

MOST_FAULTS: Final = 1000
"""Most faults reported of one scene; a file with more is probably not a scene."""


@dataclass(frozen=True, slots=True)
class Verdict:
    """The faults of a scene against the schema.

    Attributes
    ----------
    faults : in words.
    bad : paths of the values that are at fault; no conclusions may be drawn from them.
    meant : paths of missing keys that a misspelt key was meant to be.
    """

    faults: tuple[Fault, ...]
    bad: frozenset[KeyPath]
    meant: frozenset[KeyPath]


def judged(scene: Document, schema: Composed) -> Verdict:
    """Check a document against a schema, which for a scene is that of what it names."""
    found = itertools.islice(schema.validator.iter_errors(scene.plain), MOST_FAULTS)
    errors = [(tuple(each.instance_path), each, _node_at(schema.root, each.evaluation_path))
              for each in found]  # fmt: skip
    faults: list[Fault] = []
    bad = set(scene.bad)
    meant: set[KeyPath] = set()
    excused: set[KeyPath] = set()
    # Unknown keys first: one of them may be a misspelt key that is missing.
    for path, error, node in sorted(errors, key=lambda each: each[1].kind.name != UNKNOWN):
        if error.kind.name == UNKNOWN:
            for name in error.kind.as_dict()["unexpected"][:MOST_FAULTS]:
                fault, known, sibling = _unknown_key(scene, path, name, node)
                faults.append(fault)
                bad.add((*path, name))
                meant |= {(*path, known)} if known else set()
                excused |= {path} if sibling else set()
        elif error.kind.name == "required":
            name = str(error.kind.as_dict()["property"])
            bad.add((*path, name))
            if (*path, name) not in meant and path not in excused:
                faults.append(_missing(scene, (*path, name), node))
        elif path not in scene.bad:
            bad.add(path)
            fault = _refused(scene, path, error, node)
            if fault not in faults:
                faults.append(fault)
    if len(errors) == MOST_FAULTS or len(faults) >= MOST_FAULTS:
        # What was not checked may be wrong too: nothing in the scene counts as valid.
        bad.add(())
        faults = [
            *faults[:MOST_FAULTS],
            Fault("", "", "there are more faults than are listed here"),
        ]
    return Verdict(tuple(faults), frozenset(bad), frozenset(meant))


def _node_at(root: Node, evaluation: list[str | int]) -> Node:
    """The node of `root` on whose last keyword an evaluation path of the validator ends."""
    node: Any = root
    for step in evaluation[:-1]:
        node = referred(node) if step == "$ref" else node[step]
    return node if isinstance(node, dict) else {}


def _missing(scene: Document, path: KeyPath, table: Node) -> Fault:
    node = resolved(table.get("properties", {}).get(path[-1], {}))
    return scene.fault(path, f"is missing: {node.get('description', 'it is needed')}".rstrip("."))


def _refused(scene: Document, path: KeyPath, error: ValidationError, node: Node) -> Fault:
    value = scene.at(path)
    hint = ""
    choices: list[Any] = node.get("enum") or node.get("x-values") or []
    values = [str(item) for item in choices]
    if isinstance(value, str):
        close = node.get("x-hints", {}).get(value) or meant(value, values, '"')
        if close:
            hint = close
        elif error.kind.name == "type" and _reads_as_number(value):
            hint = "leave out the quotes"
    known = {
        "x-allowed",
        "enum",
        "type",
    } & node.keys()  # a declaration of another distribution may have none
    return scene.fault(path, allowed(node) if known else str(error.message), hint)


def _unknown_key(scene: Document, path: KeyPath, name: str, node: Node) -> tuple[Fault, str, bool]:
    """The fault, the key of the same table that was meant, and whether a sibling's key was."""
    place = (*path, name)
    if "x-unknown" in node:
        return scene.fault(place, node["x-unknown"]), "", False
    siblings = [definition(sibling) for sibling in node.get("x-siblings", [])]
    for sibling in siblings:
        if name in sibling["properties"]:
            message = f"belongs to {sibling['title']}; this is {node['title']}"
            return scene.fault(place, message), "", False
    table: Any = scene.at(path)
    free = [key for key in node["properties"] if key not in table]
    known = nearest(name, free)
    if known:
        return scene.fault(place, "is not a known key", meant(name, free)), known, False
    for sibling in siblings:
        hint = meant(name, sibling["properties"])
        if hint:
            return scene.fault(place, "is not a known key", hint), "", True
    if path and name in schema()["properties"]:
        message = f"belongs to the top of the file; it stands in [{quoted(str(path[0]))}] here"
        return scene.fault(place, message), "", False
    keys = ", ".join(node["properties"]) or "none"
    return scene.fault(place, f"is not a known key; known here: {keys}"), "", False


def _reads_as_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
