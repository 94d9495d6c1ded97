"""Paths of keys in a scene: ("motion", 1, "span") is written motion[2].span, counted from 1."""

from __future__ import annotations

import json
import re
from typing import Any, Final

Path = tuple[str | int, ...]
"""Names of tables and keys, and positions in arrays counted from 0."""

BARE: Final = re.compile(r"[A-Za-z0-9_-]+")

STEP: Final = re.compile(
    r'(?:^|\.)(?:(?P<bare>[A-Za-z0-9_-]+)|(?P<quoted>"(?:\\.|[^"\\])*"))|\[(?P<position>\d{1,9})\]'
)
"""One step of a path as it is spelled."""

LONGEST_NAME: Final = 60
"""Characters shown of a key's name; a longer one would bury the message."""


def spelled(path: Path) -> str:
    """Return the path as messages show it; positions in arrays are counted from 1."""
    text = ""
    for step in path:
        if isinstance(step, int):
            text += f"[{step + 1}]"
        else:
            text += ("." if text else "") + quoted(step)
    return text


def path_of(key: str) -> Path | None:
    """Return the path that is spelled `key`, () for an empty one; None if nothing is spelled so."""
    path: Path = ()
    place = 0
    while place < len(key):
        step = STEP.match(key, place)
        if step is None:
            return None
        if step["position"]:
            path = (*path, int(step["position"]) - 1)
        else:
            try:
                path = (*path, step["bare"] or str(json.loads(step["quoted"])))
            except ValueError:  # an escape that there is not
                return None
        place = step.end()
    return path


def quoted(name: str) -> str:
    """Return a key's name as it stands in TOML: in quotes unless it is bare."""
    if len(name) > LONGEST_NAME:
        name = name[:LONGEST_NAME] + "..."
    elif BARE.fullmatch(name):
        return name
    return json.dumps(name)


def value_at(tree: Any, path: Path) -> Any:
    """Return the value at `path` in tables and arrays; None if there is none."""
    for step in path:
        if isinstance(tree, dict):
            tree = tree.get(step)
        elif isinstance(tree, list) and isinstance(step, int) and step < len(tree):
            tree = tree[step]
        else:
            return None
    return tree
