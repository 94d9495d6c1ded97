"""The renderings of an answer: text, a JSON document, a table, a picture.

A document is read off an answer by its schema. A key of the schema is the attribute of its name,
without its unit (`cam_angle_deg` is `cam_angle`), or the one, with dots, that `x-attribute` names.
A number with the `x-unit` "deg" is an angle in rad, one with another unit stands as it is; a
Decimal is a number as a scene states it, in its unit. What is infinite or no number is null; a key
that is not required is left out where the answer has nothing of it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from decimal import Decimal
from functools import cache
from importlib import import_module
from operator import attrgetter
from typing import TYPE_CHECKING, Any

from camgeo._version import __version__
from camgeo.answers.answer import Answer
from camgeo.declared import schema_beside

if TYPE_CHECKING:
    from camgeo.figure.model import Figure
    from camgeo.product.value_table import Table

Node = Mapping[str, Any]
"""An object of a schema."""


def text(answer: Answer) -> str:
    """The answer in words, lines without the last line end."""
    told: str = _rendering(answer).text(answer)
    return told


def table(answer: Answer) -> Table:
    """The answer's table, for CSV."""
    found: Table = _rendering(answer).table(answer)
    return found


def figure(answer: Answer) -> Figure:
    """The answer's picture."""
    found: Figure = _rendering(answer).figure(answer)
    return found


def to_json(answer: Answer) -> dict[str, Any]:
    """The answer as a document that the schema of its package describes."""
    head = {"schema": f"camgeo/{answer.command}", "version": answer.version, "camgeo": __version__}
    schema = schema_of(type(answer).__module__)
    own = {key: node for key, node in schema["properties"].items() if key not in head}
    body: dict[str, Any] = _Reading(schema.get("$defs", {})).value(
        answer, {**schema, "properties": own}
    )
    return head | body


@cache
def schema_of(package: str) -> dict[str, Any]:
    """The JSON Schema of the answers of a package; it must not be changed."""
    file = import_module(package).__file__
    assert file is not None  # it is no namespace
    return schema_beside(file)


def _rendering(answer: Answer) -> Any:
    return import_module(f"{type(answer).__module__}.rendering")


class _Reading:
    """Reads documents off values, by a schema with these definitions."""

    def __init__(self, definitions: Node) -> None:
        self._definitions = definitions

    def value(self, value: Any, node: Node) -> Any:
        """What JSON has of a value, of which the schema says `node`."""
        if value is None or isinstance(value, bool):
            return value
        node = self._resolved(node)
        if isinstance(value, str | int | Decimal) and "x-unit" not in node:
            return float(value) if isinstance(value, Decimal) else value
        if isinstance(value, float | Decimal):
            degrees = node.get("x-unit") == "deg" and isinstance(value, float)
            number = math.degrees(value) if degrees else float(value)
            return number if math.isfinite(number) else None
        if isinstance(value, complex):
            return [value.real, value.imag]
        if "properties" in node:
            return self._object(value, node)
        if "additionalProperties" in node:
            each = node["additionalProperties"]
            return {key: self.value(item, each) for key, item in dict(value).items()}
        assert isinstance(value, Iterable)  # all else that an answer has
        return [self.value(item, node["items"]) for item in value]

    def _object(self, value: Any, node: Node) -> dict[str, Any]:
        needed = node.get("required", ())
        found = {key: self.value(_attribute(value, key, each, needed=key in needed), each)
                 for key, each in node["properties"].items()}  # fmt: skip
        return {key: item for key, item in found.items() if key in needed or item is not None}

    def _resolved(self, node: Node) -> Node:
        """The node with its reference followed; of alternatives the one that is not null."""
        for each in node.get("anyOf", ()):
            if each.get("type") != "null":
                return self._resolved(each)
        if "$ref" in node:
            return self._resolved(self._definitions[node["$ref"].rpartition("/")[2]])
        return node


def _attribute(value: Any, key: str, node: Node, *, needed: bool) -> Any:
    """What a value has for a key of its document; None for one that is not needed."""
    if isinstance(value, Mapping):
        return value.get(key)
    unit = node.get("x-unit", "").replace("/", " per ").replace("^", "")
    name = node.get("x-attribute", key.removesuffix("_" + "_".join(unit.split())))
    try:
        return attrgetter(name)(value)
    except AttributeError:
        if needed:
            raise
        return None
