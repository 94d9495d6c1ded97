"""Keys of a scene: their paths and their line numbers, which tomllib does not report.

The path ("motion", 1, "span") is written motion[2].span, counted from 1.
"""

from __future__ import annotations

import json
import re
from typing import Any, Final

KeyPath = tuple[str | int, ...]
"""Names of tables and keys, and positions in arrays counted from 0."""

BARE: Final = re.compile(r"[A-Za-z0-9_-]+")

STEP: Final = re.compile(
    r'(?:^|\.)(?:(?P<bare>[A-Za-z0-9_-]+)|(?P<quoted>"(?:\\.|[^"\\])*"))|\[(?P<position>\d{1,9})\]'
)
"""One step of a spelled path: a bare or quoted name, with a point before it, or a [position]."""

LONGEST_NAME: Final = 60
"""Characters shown of a key's name; a longer one would bury the message."""

NAME: Final = re.compile(
    r"""[ \t]*(?:(?P<bare>[A-Za-z0-9_-]+)|"(?P<basic>(?:\\.|[^"\\\n])*)"|'(?P<literal>[^'\n]*)')"""
    r"[ \t]*"
)
"""One part of a dotted key."""

VALUE: Final = re.compile(
    r'''"""(?:\\.|[^\\])*?"{3,5}'''
    r"""|'''.*?'{3,5}"""
    r"""|"(?:\\.|[^"\\\n])*"|'[^'\n]*'|\#[^\n]*|[\[\]{}\n]|[^\[\]{}\n"'\#]+""",
    re.DOTALL,
)
"""One piece of a value: strings and comments whole, brackets and line ends singly."""

BLANK: Final = re.compile(r"(?:[ \t\r\n]|\#[^\n]*)*")


def spelled(path: KeyPath) -> str:
    """Return the path as messages show it; positions in arrays are counted from 1."""
    text = ""
    for step in path:
        if isinstance(step, int):
            text += f"[{step + 1}]"
        else:
            text += ("." if text else "") + quoted(step)
    return text


def parse_path(key: str) -> KeyPath | None:
    """Return the path that is spelled `key`, () for an empty one; None if nothing is spelled so."""
    path: KeyPath = ()
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


def tree_value(tree: Any, path: KeyPath) -> Any:
    """Return the value at `path` in tables and arrays; None if there is none."""
    for step in path:
        if isinstance(tree, dict):
            tree = tree.get(step)
        elif isinstance(tree, list) and isinstance(step, int) and step < len(tree):
            tree = tree[step]
        else:
            return None
    return tree


def key_lines(text: str) -> dict[KeyPath, int]:
    """Return the line, counted from 1, of each table, key and array element of a TOML `text`.

    The text must be valid TOML. Keys inside inline tables have no entry of their own; where the
    scanner loses its way (an escape in a quoted key), the rest of the file has none.
    """
    lines: dict[KeyPath, int] = {}
    counts: dict[KeyPath, int] = {}
    table: KeyPath = ()
    line, seen = 1, 0
    place = _skip(BLANK, text, 0)
    while place < len(text):
        line += text.count("\n", seen, place)
        seen = place
        opening = "[[" if text.startswith("[[", place) else "[" if text[place] == "[" else ""
        names, place = _names(text, place + len(opening))
        if not names or text[place : place + 1] != ("]" if opening else "="):
            return lines
        if opening:
            table = _placed(names[:-1], counts)
            if opening == "[[":
                array = (*table, names[-1])
                counts[array] = counts.get(array, -1) + 1
            table = _placed((*table, names[-1]), counts, len(table))
            # An array begins at its first table, and so does a table without a header of its own.
            for depth in range(1, len(table)):
                lines.setdefault(table[:depth], line)
            lines[table] = line
            place += len(opening)
        else:
            for depth in range(1, len(names) + 1):
                lines.setdefault((*table, *names[:depth]), line)
            starts, place = _past_value(text, place + 1)
            position, row = seen, line
            for index, start in enumerate(starts):
                row += text.count("\n", position, start)
                position = start
                lines[(*table, *names, index)] = row
        place = _skip(BLANK, text, place)
    return lines


def nearest_line(path: KeyPath, lines: dict[KeyPath, int]) -> int | None:
    """Return the line of the key at `path`, else of the nearest thing around it, else None."""
    while path:
        if path in lines:
            return lines[path]
        path = path[:-1]
    return None


def _names(text: str, place: int) -> tuple[tuple[str, ...], int]:
    """Parts of the dotted key at `place`, and the place behind it; no parts if it is unclear."""
    names: list[str] = []
    while match := NAME.match(text, place):
        place = match.end()
        name = match[match.lastgroup or 0]
        if "\\" in name and match.lastgroup == "basic":
            return (), place
        names.append(name)
        if text[place : place + 1] != ".":
            return tuple(names), place
        place += 1
    return (), place


def _placed(names: KeyPath, counts: dict[KeyPath, int], known: int = 0) -> KeyPath:
    """`names` with the position of the array's last table behind each name of an array of tables.

    The first `known` steps are placed already.
    """
    path: KeyPath = names[:known]
    for name in names[known:]:
        path = (*path, name)
        if path in counts:
            path = (*path, counts[path])
    return path


def _past_value(text: str, place: int) -> tuple[list[int], int]:
    """Offsets in `text` at which the elements of the array at `place` start, if it is one, and the
    offset of the line end after the value.
    """
    depth = 0
    starts: list[int] = []
    expected = array = False  # whether an element may start here; whether the value is an array
    while match := VALUE.match(text, place):
        piece = match[0]
        if piece == "\n" and depth == 0:
            return starts, place
        if depth == 0 and piece == "[":
            array = expected = True
        elif depth == 1 and array and piece[0] not in "]\n#":
            # A piece of plain text may hold several elements, and the commas between them.
            for number, part in enumerate(piece.split(",") if piece[0] not in "\"'" else [piece]):
                expected = expected or number > 0
                if expected and part.strip():
                    starts.append(place)
                    expected = False
        if piece in ("[", "{"):
            depth += 1
        elif piece in ("]", "}"):
            depth -= 1
        place = match.end()
    return starts, len(text)


def _skip(pattern: re.Pattern[str], text: str, place: int) -> int:
    match = pattern.match(text, place)
    return match.end() if match else place
