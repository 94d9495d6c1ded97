"""Writes docs/scene.md and docs/scene.schema.json: `python docs/scene_page.py`.

Both are generated from the schema of the scene format, the only definition of keys, types and
ranges, composed of the format's own part and of what is declared elsewhere; a test compares them.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from camgeo.scene.schema import whole_schema

PAGE = Path(__file__).with_name("scene.md")
SCHEMA = PAGE.with_suffix(".schema.json")

HEAD = """# The scene file

<!-- Made from the declarations that `camgeo.scene.schema` composes, by docs/scene_page.py. -->

A scene is one TOML file that states what is wanted. `camgeo new KIND` writes one to start from,
with a comment on every key; `fixtures/scenes` has more. Lengths are in the unit of `[units]`,
angles in degrees, speed in rev/min.

Frame and signs: the cam axis is the origin, x points right, y up, counter-clockwise is positive;
cam and fixed frame coincide at cam angle 0, and the drawings show the cam there.

A wrong scene reports all its faults at once, and nothing is written. Spans are decimal numbers and
are added exactly as written: 359.999 is not 360.
"""


def page() -> str:
    """The page's text."""
    schema = whole_schema()
    parts = [HEAD]
    for heading, description, rows in _tables(schema):
        parts.append(f"\n## {heading}\n" + (f"\n{description}\n" if description else ""))
        if rows:
            parts.append("\n| key | meaning |\n|---|---|\n")
            parts += [f"| `{key}` | {text} |\n" for key, text in rows]
    return "".join(parts)


def editors_schema() -> str:
    """The schema as editors read it."""
    return json.dumps(whole_schema(), indent=2) + "\n"


Rows = list[tuple[str, str]]


def _tables(schema: dict[str, Any]) -> Iterator[tuple[str, str, Rows]]:
    """Heading, description and rows (key, meaning) of each table of the format."""
    top = schema["properties"]
    tables = {name: node for name, node in top.items() if _is_table(schema, node)}
    plain = {name: node for name, node in top.items() if name not in tables}
    yield "Top of the file", "", _rows(schema, plain, schema.get("required", []))
    for name, node in tables.items():
        yield from _table(schema, f"[{name}]", node)


def _table(schema: dict[str, Any], name: str, node: dict[str, Any]) -> Iterator[Any]:
    node = _resolved(schema, node)
    if "x-as" in node:  # its keys are those of another table
        yield f"`[{name}]`" if node["type"] == "array" else f"`{name}`", node["description"], []
        return
    if node.get("type") == "array":
        name, node = f"[{name}]", {**node, **_resolved(schema, node["items"])}
    inner = {k: v for k, v in node.get("properties", {}).items() if _is_table(schema, v)}
    own = {k: v for k, v in node.get("properties", {}).items() if k not in inner}
    yield f"`{name}`", node.get("description", ""), _rows(schema, own, node.get("required", []))
    for label, variant in _variants(schema, node):
        rows = _rows(schema, variant.get("properties", {}), variant.get("required", []))
        shown = [row for row in rows if row[0].split("`")[0] not in own]
        yield f"`{name}` {label}", variant.get("description", ""), shown
    for key, child in inner.items():
        yield from _table(schema, f"{name[:-1]}.{key}]", child)


def _variants(schema: dict[str, Any], node: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    """The kinds of a table, each with the keys of its own."""
    for choice in node.get("allOf", []):
        kind = choice["if"]["properties"]["kind"]["const"]
        yield f'of kind "{kind}"', _resolved(schema, choice["then"])
    while "then" in node:
        law = node["if"].get("properties", {}).get("law")
        label = "that rests" if law is None else f'of law "{law["const"]}"'
        yield label, _resolved(schema, node["then"])
        node = _resolved(schema, node["else"])
        if "then" not in node:
            yield "that moves by another law", node


def _rows(schema: dict[str, Any], nodes: dict[str, Any], required: list[str]) -> Rows:
    rows = []
    for key, node in nodes.items():
        if isinstance(node, bool):  # the key is allowed here and described elsewhere
            continue
        merged = {**_resolved(schema, node), **node}
        text = merged.get("description", "").replace("|", "\\|")
        if not text:
            continue
        mark = "" if key not in required else "**Required.** "
        rows.append((key, mark + text))
        merged = {**_resolved(schema, merged.get("items", {})), **merged}
        inner = merged.get("properties", {})
        rows += [(f"{key}.{k}", t) for k, t in _rows(schema, inner, merged.get("required", []))]
    return rows


def _resolved(schema: dict[str, Any], node: dict[str, Any]) -> dict[str, Any]:
    reference = node.get("$ref")
    if reference is None:
        return node
    target: dict[str, Any] = schema["$defs"][reference.rsplit("/", 1)[1]]
    return target


def _is_table(schema: dict[str, Any], node: dict[str, Any]) -> bool:
    """Tables get a heading; an inline table, the keyway, is a row with its keys below it."""
    kind = _resolved(schema, node).get("type")
    return (kind in ("object", "array") and "x-allowed" not in node and "items" not in node) or (
        kind == "array"
        and "items" in node
        and _resolved(schema, node["items"]).get("type") == "object"
    )


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
    SCHEMA.write_text(editors_schema(), encoding="utf-8")
