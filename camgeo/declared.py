"""The JSON Schema of a declaration, stored next to its module, and what it allows in words."""

from __future__ import annotations

import json
import pathlib
from collections.abc import Mapping
from typing import Any, Final

TYPES: Final = {
    "array": "a list in square brackets",
    "boolean": "true or false, without quotes",
    "integer": "a whole number",
    "number": "a number",
    "object": "a table",
    "string": "text in quotes",
}


def schema_beside(file: str, name: str = "") -> dict[str, Any]:
    """The JSON Schema `name` in the folder of the module `file`.

    By default the one with the module's stem, or schema.json for a package.
    """
    path = pathlib.Path(file)
    stem = name or ("schema" if path.stem == "__init__" else path.stem)
    found: dict[str, Any] = json.loads(path.with_name(f"{stem}.json").read_bytes())
    return found


def allowed(node: Mapping[str, Any]) -> str:
    """What a node of a schema allows, in words: "must be ..."."""
    if "x-allowed" in node:
        return str(node["x-allowed"])
    if "enum" in node:
        return "must be one of " + ", ".join(f'"{item}"' for item in node["enum"])
    text = "must be " + TYPES[node["type"]]
    lowest = node.get("minimum", node.get("exclusiveMinimum"))
    highest = node.get("maximum", node.get("exclusiveMaximum"))
    if lowest is not None and highest is not None:
        above = " above" if "exclusiveMinimum" in node else " from"
        below = " to" if "maximum" in node else " and below"
        text += f"{above} {lowest:g}{below} {highest:g}"
    elif lowest is not None:
        text += f", {'above' if 'exclusiveMinimum' in node else 'at least'} {lowest:g}"
    elif highest is not None:
        text += f", {'at most' if 'maximum' in node else 'below'} {highest:g}"
    unit = node.get("x-unit")
    return f"{text} ({unit})" if unit else text
