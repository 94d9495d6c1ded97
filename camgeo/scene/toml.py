"""A scene as TOML: its values written into the text that it came from, with the comments kept."""

from __future__ import annotations

import itertools
import pathlib
import re
import tomllib
from collections.abc import Iterator
from decimal import Decimal
from typing import Any, Final

import tomlkit
from tomlkit.exceptions import TOMLKitError
from tomlkit.items import AoT, Array, Float, Table, Trivia

from camgeo.errors import UnknownNameError
from camgeo.kinematics.mechanism.declared.registry import FOLLOWERS, LINKAGES
from camgeo.scene.keys import KeyPath, key_lines
from camgeo.scene.values import Tree

SINGLE: Final = re.compile(r"""([^=#"']*=[ \t]*)([^\s#,\[\]{}"']+)([ \t\r]*(?:\#.*)?)""")
"""A line with a key and one value that is no text."""

SEVERAL: Final = re.compile(r"""([^=#"']*=[ \t]*\[)([^#\[\]{}"']+)(\][ \t\r]*(?:\#.*)?)""")
"""A line with a key and a list of such values."""

ELEMENT: Final = re.compile(r"([ \t]*)([^\s]+)([ \t]*)")
"""One element of such a list, with the space around it."""


def written_into(text: str, tree: Tree) -> str:
    """The text with the values of `tree` in place of its own, or a new text without one.

    Only what differs is written. If the values of a text cannot be changed one by one,
    it is written anew, without its comments.
    """
    try:
        earlier = tomllib.loads(text, parse_float=Decimal)
        replaced = _with_numbers(text, earlier, tree)
        if replaced is not None and _says(replaced, tree):
            return replaced
        parsed = tomlkit.parse(text)
        _change(parsed, earlier, tree)
        written = tomlkit.dumps(parsed)
    except (TOMLKitError, LookupError, AttributeError, TypeError, ValueError):
        # tomlkit stumbles over some texts that are valid: tables in several places, dotted keys.
        return tomlkit.dumps(_item(tree))
    if "\r\n" in text:
        written = written.replace("\r\n", "\n").replace("\n", "\r\n")
    if text and not _says(written, tree):
        return tomlkit.dumps(_item(tree))
    return written


def _with_numbers(text: str, before: Tree, after: Tree) -> str | None:
    """The text with other numbers, written as tomlkit would, which takes ten times as long.

    None if more than numbers differs, or if one does not stand in one line with its key.
    """
    differences = list(_differing(before, after, ()))
    if not all(_is_number(one) and _is_number(other) for _, one, other in differences):
        return None
    known, lines = key_lines(text), text.split("\n")
    for path, _, value in differences:
        step = path[-1]
        place, shape = (path[:-1], SEVERAL) if isinstance(step, int) else (path, SINGLE)
        number = known.get(place, 0) - 1
        match = shape.fullmatch(lines[number]) if number >= 0 else None
        if match is None:
            return None
        new = _item(value).as_string()
        if isinstance(step, int):
            elements = match[2].split(",")
            element = ELEMENT.fullmatch(elements[step])
            if element is None:
                return None
            elements[step] = f"{element[1]}{new}{element[3]}"
            new = ",".join(elements)
        lines[number] = f"{match[1]}{new}{match[3]}"
    return "\n".join(lines)


def _differing(one: Any, other: Any, path: KeyPath) -> Iterator[tuple[KeyPath, Any, Any]]:
    """Paths at which two trees differ, with both values; another order of keys is a difference."""
    if isinstance(one, dict) and isinstance(other, dict) and list(one) == list(other):
        for key in one:
            yield from _differing(one[key], other[key], (*path, key))
    elif isinstance(one, list) and isinstance(other, list) and len(one) == len(other):
        for index, pair in enumerate(zip(one, other, strict=True)):
            yield from _differing(*pair, (*path, index))
    elif not _same(one, other):
        yield path, one, other


def _is_number(value: Any) -> bool:
    return isinstance(value, int | Decimal) and not isinstance(value, bool)


def _says(text: str, tree: Tree) -> bool:
    try:
        return _same(tomllib.loads(text, parse_float=Decimal), tree)
    except tomllib.TOMLDecodeError:
        return False


def _same(one: Any, other: Any) -> bool:
    """Whether two values mean the same in a scene; 0 and -0 differ, and NaN equals itself."""
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() == other.keys() and all(_same(one[key], other[key]) for key in one)
    if isinstance(one, list) and isinstance(other, list):
        return len(one) == len(other) and all(map(_same, one, other))
    if isinstance(one, bool) or isinstance(other, bool):
        return one is other
    if one != one or other != other:  # NaN
        return str(one) == str(other)
    # Zeros are compared by their sign, the first character of their text.
    return bool(one == other) and (bool(one) or str(one)[:1] == str(other)[:1])


def _change(node: Any, before: Tree, after: Tree) -> None:
    """Change the table `node` from the values `before` to the values `after`."""
    for key in before.keys() - after:
        del node[key]
    last = ""
    for key, value in after.items():
        if key not in before:
            if isinstance(node, Table) and before.get(last) is not None:
                # tomlkit puts new keys at the end of a table only
                node.value._insert_after(last, key, _item(value))  # noqa: SLF001  # tomlkit has no public function for it
            else:
                node[key] = _item(value)
        else:
            _change_item(node, key, before[key], value)
        last = key if not isinstance(value, dict | list) else ""


def _change_item(node: Any, key: str | int, before: Any, after: Any) -> None:
    """Change the item of `node` at a key or position from `before` to `after`."""
    if isinstance(before, dict) and isinstance(after, dict):
        _change(node[key], before, after)
    elif isinstance(before, list) and isinstance(after, list):
        _change_list(node[key], before, after)
    elif not _same(before, after):
        node[key] = _item(after, inline=isinstance(key, int))


def _change_list(node: Any, before: list[Any], after: list[Any]) -> None:
    """Change the list `node` from `before` to `after`: equal items at either end stay."""
    head = 0
    while head < min(len(before), len(after)) and _same(before[head], after[head]):
        head += 1
    tail = 0
    while tail < min(len(before), len(after)) - head and _same(before[-1 - tail], after[-1 - tail]):
        tail += 1
    # Between head and tail items are first removed or inserted, then compared one by one: so an
    # item that is only edited keeps its comments.
    old, new = before[head : len(before) - tail], after[head : len(after) - tail]
    place, more = head + _place(old, new), len(new) - len(old)
    for _ in range(-more):
        del node[place]
    for index in range(place, place + more):
        node.insert(index, _item(after[index], inline=isinstance(node, Array)))
    aligned = [
        *before[:place],
        *after[place : place + max(0, more)],
        *before[place + max(0, -more) :],
    ]
    for index, (one, other) in enumerate(zip(aligned, after, strict=True)):
        _change_item(node, index, one, other)


def _place(old: list[Any], new: list[Any]) -> int:
    """Index of the extra items in the longer list, chosen so that the fewest values differ."""
    # Extra items at k: the first k of the short list meet the first k of the long one, the others
    # those shifted by `more`. front[k] + (back[-1] - back[k]) is the cost but for a constant.
    short, long = sorted((old, new), key=len)
    more = len(long) - len(short)
    fronts = list(itertools.accumulate(map(_differences, short, long), initial=0))
    backs = list(itertools.accumulate(map(_differences, short, long[more:]), initial=0))
    costs = [front - back for front, back in zip(fronts, backs, strict=True)]
    return costs.index(min(costs)) if more else 0


def _differences(one: Any, other: Any) -> int:
    if isinstance(one, dict) and isinstance(other, dict):
        return sum(not _same(one.get(key), other.get(key)) for key in {*one, *other})
    return int(not _same(one, other))


def _item(value: Any, *, inline: bool = False) -> Any:
    """A value as an item of tomlkit, decimal numbers to the last digit; `inline` for tables in
    lists.
    """
    if isinstance(value, Decimal):
        text = str(value)
        if not value.is_finite():
            text = str(float(value))  # inf, -inf, nan
        elif "." not in text and "E" not in text:
            text = f"{text}.0"  # else TOML would read an integer
        return Float(float(value), Trivia(), text)
    if isinstance(value, dict):
        table = tomlkit.inline_table() if inline else tomlkit.table()
        # Single values before tables: what follows a table's header would belong to that table.
        for key, item in sorted(value.items(), key=lambda pair: isinstance(pair[1], dict)):
            table.append(key, _item(item, inline=inline))
        return table
    if (
        value
        and isinstance(value, list)
        and all(isinstance(item, dict) for item in value)
        and not inline
    ):
        return AoT([_item(item) for item in value])
    if isinstance(value, list):
        array = tomlkit.array()
        array.extend(_item(item, inline=True) for item in value)
        return array
    return tomlkit.item(value)


# -- new ------------------------------------------------------------------------------------------
# Commented scenes to start from, for `camgeo new KIND`.


TEMPLATES: Final = pathlib.Path(__file__).with_name("templates")

MECHANISMS: Final = (
    *FOLLOWERS,
    "knife-edge",
    "groove",
    "conjugate-carriage",
    "conjugate-lever",
    "constant-breadth",
    *(name for kind in LINKAGES.values() for name in kind.templates),
)
"""Kinds with a mechanism of their own."""

TEMPLATE_KINDS: Final = (*MECHANISMS, "milled")
"""Kinds for which `template` has a scene; the first is the default of the command line."""


def template(kind: str) -> str:
    """Return the text of a commented scene of that kind; UnknownNameError if there is
    none.
    """
    if kind not in TEMPLATE_KINDS:
        raise UnknownNameError("template", kind, TEMPLATE_KINDS)
    return (TEMPLATES / f"{kind}.toml").read_text(encoding="utf-8")
