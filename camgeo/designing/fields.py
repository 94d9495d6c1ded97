"""Fields of a form: keys of a scene with what the schema says of them, and their values.

Everything said about a key comes from the schema of the scene format; a form adds only ranges for
sliders.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from decimal import Decimal
from typing import Any, Final, Literal

from camgeo.designing.labels import title_of
from camgeo.designing.snapping import step_near
from camgeo.scene.document import Document, document_of_tree
from camgeo.scene.keys import Path, spelled, value_at
from camgeo.scene.schema import Composed, Node, keys_of, referred, resolved, schema_for
from camgeo.scene.tree import Tree
from camgeo.scene.valid_values import ValidValues
from camgeo.units import in_unit

Type = Literal["number", "choice", "text", "flag", "file", "list"]

LENGTHS: Final = {
    f"#/$defs/{name}" for name in ("length", "coordinate", "roller_radius", "side_clearance")
}
"""References to definitions of the schema whose numbers are in the scene's unit of length."""

POSITIONS: Final = {
    "to": "", "smoothing": "", "velocity": "/rad", "acceleration": "/rad²", "jerk": "/rad³",
}  # fmt: skip
"""Keys of a segment in the unit of its positions, with what follows that unit."""

UNITS: Final = {"degrees": "°", "kg/m^3": "kg/m³", "kg m^2": "kg m²"}
"""Units that are written differently from the schema."""

FEEDS: Final = ("feed", "plunge_feed")
"""Keys of lengths per minute."""

WIDE: Final = 1000.0
"""Range above which the limits of a number are of no use to a slider."""

FINE: Final = 500.0
"""Least number of steps of a slider."""

ROOM: Final = 1.25
"""Least factor by which a slider reaches beyond its value."""

FEW: Final = 10.0
"""Least reach of the slider of a whole number, or of a number that is 0."""

LEAST: Final = 1e-6
"""Least reach of any slider."""

LONGEST: Final = 400
"""Characters of a text, or items of a list, that a field shows."""


@dataclass(frozen=True, slots=True)
class Field:
    """A key of a scene.

    Attributes
    ----------
    key : as messages spell it.
    title, description : what it is called, and what it means.
    type : of what is entered.
    unit : of a number, or of the numbers of a list; empty if it has none.
    value : as stated, or else the default; None if there is neither.
    stated : whether the scene states it.
    default : the value that holds if none is stated, if that is always the same.
    choices : values to choose from, or that can be entered instead of a number.
    low, high : limits of a number.
    slider : least and greatest value of a sensible range, and its step.
    """

    key: str
    title: str
    description: str
    type: Type
    unit: str
    value: Any
    stated: bool
    default: Any
    choices: tuple[Any, ...]
    low: float | None
    high: float | None
    slider: tuple[float, float, float] | None

    def to_data(self) -> dict[str, Any]:
        """For JSON; what is empty is left out, except the value."""
        rest = {
            "description": self.description, "unit": self.unit, "default": self.default,
            "choices": list(self.choices), "low": self.low, "high": self.high,
            "slider": None if self.slider is None else list(self.slider),
        }  # fmt: skip
        return {
            "key": self.key,
            "title": self.title,
            "type": self.type,
            "value": self.value,
            "stated": self.stated,
            **{key: value for key, value in rest.items() if value not in (None, "", [])},
        }


class Fields:
    """The fields of one scene, right or wrong.

    Attributes
    ----------
    document : its values.
    composed : the schema with the tables that it names.
    length, position : units of its lengths, and of its motion.
    """

    def __init__(self, document: Document) -> None:
        self.document = document
        self.composed: Composed = schema_for(document.plain)
        values = ValidValues(document)
        self.length = values.unit
        self.position: str = "°" if _angular(values) else values.unit

    def node(self, path: Path) -> Node:
        """The schema's node for a key; empty if there is none."""
        node, table = self.composed.root, self.document.plain
        for depth, step in enumerate(path):
            inner: Any = value_at(table, path[:depth])
            node = resolved(node)
            if isinstance(step, int):
                node = node.get("items", {})
            else:
                node = keys_of(node, inner if isinstance(inner, dict) else {}).get(step, {})
        return node

    def unit(self, path: Path) -> str:
        """The unit of the number at a key."""
        return self.unit_of(path, self.node(path))

    def unit_of(self, path: Path, node: Node) -> str:
        """The unit of the number at a key with that `node`."""
        if path[:1] == ("motion",) and path[-1] in POSITIONS:
            return f"{self.position}{POSITIONS[str(path[-1])]}"
        found = resolved(node)
        if "x-unit" in found:
            unit: str = found["x-unit"]
            return UNITS.get(unit, unit)
        items = found.get("items", {})
        if "x-default-mm" in found or is_length(node) or is_length(items):
            return f"{self.length}/min" if path[-1] in FEEDS else self.length
        return str(resolved(items).get("x-unit", ""))

    def field(self, path: Path, node: Node) -> Field | None:
        """The field of a key with that node of the schema; None for a table, or a list of them."""
        found = resolved(node)
        if not found or has_keys(found) or has_keys(resolved(found.get("items", {}))):
            return None
        exact = self.document.at(path)
        default = self._default(path, found)
        value = default if exact is None else plain(exact)
        kind = _type(found, value)
        low, high = _limits(found)
        slider = None
        if kind == "number" and isinstance(value, int | float) and not isinstance(value, bool):
            slider = slider_of(value, low, high, whole=found.get("type") == "integer")
        return Field(
            spelled(path), title_of(path), in_unit(found.get("description", ""), self.length), kind,
            self.unit_of(path, node), value, exact is not None, default, _choices(found), low,
            high, slider,
        )  # fmt: skip

    def of_table(self, path: Path, node: Node) -> Iterator[Field]:
        """The fields of a table, without those of tables in it."""
        inner = value_at(self.document.plain, path)
        for key, each in keys_of(node, inner if isinstance(inner, dict) else {}).items():
            found = self.field((*path, key), each)
            if found is not None:
                yield found

    def _default(self, path: Path, node: Node) -> Any:
        if "x-default-by-law" in node:
            law = self.document.at((*path[:-1], "law"))
            return node["x-default-by-law"].get(law) if isinstance(law, str) else None
        if "x-default-key" in node:
            path = tuple(node["x-default-key"].split("."))
            there = self.document.at(path)
            return node.get("default") if there is None else plain(there)
        if "x-default-mm" in node:
            return node["x-default-mm"] if self.length == "mm" else node["x-default-mm"] / 25.4
        return plain(node.get("default"))


def is_angular(tree: Tree) -> bool:
    """Whether the positions of a scene are angles; False if wrong values leave that open."""
    return _angular(ValidValues(document_of_tree(tree)))


def _angular(values: ValidValues) -> bool:
    try:
        return values.angular
    except (KeyError, TypeError):  # kinds that there are not
        return False


def is_length(node: Node | bool) -> bool:
    """Whether a node of the schema is of numbers in the scene's unit of length."""
    while isinstance(node, dict) and "$ref" in node:
        if node["$ref"] in LENGTHS:
            return True
        node = referred(node)
    return False


def plain(value: Any) -> Any:
    """A value for JSON, cut if it is long; None if it cannot be shown."""
    if isinstance(value, Decimal):
        found = float(value)
        return found if math.isfinite(found) else None
    if isinstance(value, list):
        return [plain(each) for each in value[:LONGEST]]
    if isinstance(value, Mapping):
        return {str(key)[:LONGEST]: plain(value[key]) for key in list(value)[:LONGEST]}
    if isinstance(value, int) and not isinstance(value, bool):
        return value if abs(value) <= 2**53 else float(value) if abs(value) < 1e300 else None
    if isinstance(value, str):
        return value[:LONGEST]
    return value if isinstance(value, bool | float) else None


def has_keys(node: Node) -> bool:
    """Whether a resolved node of the schema is of tables."""
    return "properties" in node or "allOf" in node


def _alternatives(node: Node) -> list[Node]:
    among: list[Node] = node.get("anyOf") or [node]
    return [resolved(each) for each in among]


def _choices(node: Node) -> tuple[Any, ...]:
    found: list[Any] = list(node.get("x-values") or ())
    for each in (*_alternatives(node), resolved(node.get("items", {}))):
        found += each.get("enum", [])
        if "const" in each:
            found.append(each["const"])
    return tuple(found)


def _type(node: Node, value: Any) -> Type:
    kinds = [each.get("type") for each in _alternatives(node)]
    if "array" in kinds:
        return "list"
    if "boolean" in kinds:
        return "flag"
    if ("number" in kinds or "integer" in kinds) and not isinstance(value, str):
        return "number"
    if any("enum" in each or "const" in each for each in _alternatives(node)):
        return "choice"
    return "file" if "x-file" in node or "x-path" in node else "text"


def _limits(node: Node) -> tuple[float | None, float | None]:
    for each in _alternatives(node):
        if each.get("type") in ("number", "integer"):
            low = each.get("minimum", each.get("exclusiveMinimum"))
            return low, each.get("maximum", each.get("exclusiveMaximum"))
    return None, None


def slider_of(
    value: float, low: float | None, high: float | None, *, whole: bool = False
) -> tuple[float, float, float] | None:
    """A sensible range about a value, in steps of 1 for a `whole` number; None if there is none."""
    if low is not None and high is not None and high - low <= WIDE:
        start, end = float(low), float(high)
    else:
        reach = _round_above(max(ROOM * abs(value), LEAST)) if value else FEW
        reach = max(reach, FEW) if whole else reach
        start = -reach if low is None else max(-reach, float(low))
        end = reach if high is None else min(reach, float(high))
    if not start < end:
        return None
    step = 1.0 if whole else float(step_near((end - start) / FINE))
    if 0.0 < start < step:
        start = step  # a least value such as 1e-9 mm only keeps 0 out
    return (start, end, step) if start <= value <= end else None


def _round_above(value: float) -> float:
    """The least power of ten, or 2 or 5 times one, above `value`."""
    power = 10.0 ** math.floor(math.log10(value))
    return next(each * power for each in (1.0, 2.0, 5.0, 10.0) if each * power > value)
