"""The form of a scene, valid or not: tables and segments of the motion with their fields."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from decimal import Decimal, localcontext
from itertools import accumulate
from typing import Any, Final, Literal, TypeGuard

from camgeo.errors import GeometryError
from camgeo.kinematics.laws import ALIASES, FAMILIES
from camgeo.kinematics.mechanism.declared.registry import FOLLOWERS, LINKAGES
from camgeo.kinematics.mechanism.values import FollowerKind, LinkageKind
from camgeo.kinematics.plan import EXACT, FULL_TURN, SHORTEST_SPAN
from camgeo.kinematics.planning.requests import AUTO
from camgeo.scene.keys import KeyPath, spelled, tree_value
from camgeo.scene.rules import JERK, law_parameters
from camgeo.scene.schema import SHAPES, Composed, Node, referred, resolved, schema_for, table_keys
from camgeo.scene.values import Document, Tree, ValidValues, document_of_tree
from camgeo.units import in_unit

# -- segments --------------------------------------------------------------------------------------
# Spans of a motion's segments, whose sum is exact and stays whole.


Segment = Mapping[str, Any]
"""A segment of a scene, as it is stated."""


def span_key(segment: Segment) -> str:
    """The key that states the span of a segment."""
    return "dwell" if "dwell" in segment else "span"


def segment_span(segment: Any) -> Decimal | None:
    """The span of a segment [degrees], exactly as written; None if it states no possible one."""
    stated = segment.get(span_key(segment)) if isinstance(segment, dict) else None
    return Decimal(stated) if is_number(stated) and 0 <= stated <= FULL_TURN else None


def motion_spans(motion: Any) -> list[Decimal] | None:
    """The spans of all segments; None if one of them has none."""
    if not isinstance(motion, list):
        return None
    possible = [segment_span(segment) for segment in motion]
    spans = [span for span in possible if span is not None]
    return spans if len(spans) == len(possible) else None


def joints(spans: Sequence[Decimal]) -> list[Decimal]:
    """The cam angles [degrees] at which the segments begin, and that at which the last one ends."""
    with localcontext(EXACT):
        return list(accumulate(spans, initial=Decimal(0)))


def least_span(segment: Segment) -> Decimal:
    """The shortest span [degrees] that the segment may have, by its own values alone."""
    if "dwell" in segment:
        return Decimal(0)
    points = segment.get("points")
    last = points[-1].get("at") if isinstance(points, list) and points else None
    return SHORTEST_SPAN if last is None else Decimal(last) + SHORTEST_SPAN


def is_fixed(segment: Segment) -> bool:
    """Whether a file determines the span of the segment."""
    return segment.get("law") == "table"


def neighbour_span(first: Segment, second: Segment, span: Decimal) -> Decimal:
    """The span of the second of two neighbours if that of the first becomes `span` and their sum
    stays; GeometryError if one of them becomes too short.
    """
    old_spans = segment_span(first), segment_span(second)
    assert old_spans[0] is not None  # only valid scenes have handles
    assert old_spans[1] is not None
    with localcontext(EXACT):
        other = old_spans[1] - (span - old_spans[0])
    for segment, new, name in (
        (first, span, "this segment"),
        (second, other, "the neighbouring segment"),
    ):
        if new < least_span(segment):
            message = f"leaves no room for {name}: {new.normalize():f} degrees"
            raise GeometryError(message, "motion", f"{new.normalize():f}")
    return other


# -- numbers --------------------------------------------------------------------------------------
# Numbers of a scene: their range, decimal steps, and how they are written.


STEPS: Final = (1e-9, 1e6)
"""Smallest and largest step."""

LARGEST: Final = 10**12
"""Largest magnitude of the numbers of a scene."""


def is_number(value: Any) -> TypeGuard[int | Decimal]:
    """Whether a value of a scene, valid or not, is a finite number that a scene can have."""
    real = isinstance(value, int | Decimal) and not isinstance(value, bool)
    return real and Decimal(value).is_finite() and -LARGEST <= value <= LARGEST


def step_near(step: float) -> Decimal:
    """The greatest power of ten, or 2 or 5 times one, that does not exceed `step`."""
    step = min(max(step, STEPS[0]), STEPS[1])
    # Slightly more than the step, so that rounding errors do not make a power of ten the next
    # lower.
    exponent = math.floor(math.log10(step * (1.0 + 1e-12)))
    digits = step / 10.0**exponent * (1.0 + 1e-12)
    return Decimal(max(digit for digit in (1, 2, 5) if digit <= digits)).scaleb(exponent)


def styled(value: Decimal, previous: Any) -> Any:
    """An exact number, as it is written to replace `previous`."""
    if not value:
        value = Decimal(0)  # and not -0
    if value == value.to_integral_value() and not isinstance(previous, Decimal):
        return int(value)
    # normalize() makes 1E+1 of 10, so whole numbers get their digits back.
    plain = value.normalize()
    return plain.quantize(Decimal(1)) if plain == plain.to_integral_value() else plain


# -- form ------------------------------------------------------------------------------------------


Data = dict[str, Any]
"""An object of JSON."""

MOST: Final = 50
"""Most tables of one list, e.g. tools, that a form shows."""

EXCLUDED: Final = ("camgeo", "motion")
"""Keys that are not in the form: the first has only one value, and the motion is a plan."""

KINDS: Final[Mapping[str, Mapping[str, FollowerKind | LinkageKind]]] = {
    "follower": FOLLOWERS,
    "linkage": LINKAGES,
}
"""Tables whose kind can be changed, with their kinds."""


def _section(
    key: str,
    title: str,
    description: str,
    fields: list[Data],
    *,
    stated: bool = True,
    kind: Any = None,
    kinds: list[Data] | None = None,
) -> Data:
    return {
        "key": key,
        "title": title,
        "description": description,
        "stated": stated,
        "kind": kind if isinstance(kind, str) else None,
        "kinds": kinds,
        "fields": fields,
    }


def _inner(fields: Fields, path: KeyPath, node: Node) -> Iterator[Data]:
    """The tables within a table."""
    inner = fields.document.plain if not path else fields.document.exact_value(path)
    for key, child in table_keys(node, inner if isinstance(inner, dict) else {}).items():
        if not path and key in EXCLUDED:
            continue
        yield from _sections(fields, (*path, key), resolved(child))


def _sections(fields: Fields, path: KeyPath, node: Node) -> Iterator[Data]:
    """The table at `path`, or each of a list of tables, with those in it."""
    stated = fields.document.exact_value(path)
    items = resolved(node.get("items", {}))
    if has_keys(items):
        for index in range(min(len(stated), MOST) if isinstance(stated, list) else 0):
            yield from _table(fields, (*path, index), items, node.get("description", ""))
    elif has_keys(node):
        yield from _table(fields, path, node, node.get("description", ""))


def _table(fields: Fields, path: KeyPath, node: Node, description: str) -> Iterator[Data]:
    table = fields.document.exact_value(path)
    kind = table.get("kind") if isinstance(table, dict) else None
    known = KINDS.get(spelled(path))
    kinds = (
        None
        if known is None
        else [
            {"value": name, "title": name.replace("-", " "), "description": declaration.description}
            for name, declaration in known.items()
        ]
    )
    table_fields = [
        table_field
        for table_field in fields.table_fields(path, node)
        if known is None or not table_field["key"].endswith(".kind")
    ]
    if table_fields or kinds is not None:
        yield _section(
            spelled(path),
            key_title(path),
            description,
            table_fields,
            stated=table is not None,
            kind=kind,
            kinds=kinds,
        )
    if table is not None:
        yield from _inner(fields, path, node)


# -- fields ---------------------------------------------------------------------------------------
# Fields of a form: keys of a scene with what the schema says of them, and their values.
#
# Everything said about a key comes from the schema of the scene format; a form adds only ranges for
# sliders.


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
"""Spelling of units on the page, where it differs from the schema."""

FEEDS: Final = ("feed", "plunge_feed")
"""Keys of lengths per minute."""

WIDE: Final = 1000.0
"""Largest range of a slider between the limits of a number; a wider one is of no use."""

FINE: Final = 500.0
"""Least number of steps of a slider."""

ROOM: Final = 1.25
"""Smallest ratio of the reach of a slider to its value."""

FEW: Final = 10.0
"""Smallest reach of the slider of a whole number, or of a number that is 0."""

LEAST: Final = 1e-6
"""Smallest reach of any slider."""

LONGEST: Final = 400
"""Most characters of a text, or items of a list, that a field shows."""


class Fields:
    """The fields of one scene, valid or not: single ones, the form, and those of each segment.

    Attributes
    ----------
    document : its values.
    composed : the schema with the tables that the scene states.
    length, position : units of its lengths, and of its motion.
    """

    def __init__(self, document: Document) -> None:
        self.document = document
        self.composed: Composed = schema_for(document.plain)
        values = ValidValues(document)
        self.length = values.unit
        self.position: str = "°" if _angular(values) else values.unit

    def node(self, path: KeyPath) -> Node:
        """The node of the schema for a key; empty if there is none."""
        node, table = self.composed.root, self.document.plain
        for depth, step in enumerate(path):
            inner: Any = tree_value(table, path[:depth])
            node = resolved(node)
            if isinstance(step, int):
                node = node.get("items", {})
            else:
                node = table_keys(node, inner if isinstance(inner, dict) else {}).get(step, {})
        return node

    def unit(self, path: KeyPath) -> str:
        """The unit of the number at a key."""
        return self.node_unit(path, self.node(path))

    def node_unit(self, path: KeyPath, node: Node) -> str:
        """The unit of the number at a key with that `node`."""
        if path[:1] == ("motion",) and path[-1] in POSITIONS:
            return f"{self.position}{POSITIONS[str(path[-1])]}"
        resolved_node = resolved(node)
        if "x-unit" in resolved_node:
            unit: str = resolved_node["x-unit"]
            return UNITS.get(unit, unit)
        items = resolved_node.get("items", {})
        if "x-default-mm" in resolved_node or is_length(node) or is_length(items):
            return f"{self.length}/min" if path[-1] in FEEDS else self.length
        return str(resolved(items).get("x-unit", ""))

    def field(self, path: KeyPath, node: Node) -> Data | None:
        """The field of a key with that node of the schema; None for a table, or a list of them.

        `key`, as messages spell it; `title`, what it is called, and `description`, what it means;
        `type`, of what is entered; `unit` of a number, or of the numbers of a list; `value`, as
        stated, or else the default, None if there is neither; `stated`, whether the scene states
        it; `default`, the value that holds if none is stated, if that is always the same;
        `choices`, values to choose from, or that can be entered instead of a number; `low` and
        `high`, limits of a number; `slider`, least and greatest value of a sensible range, and its
        step. What is empty is left out, except the value.
        """
        resolved_node = resolved(node)
        if (
            not resolved_node
            or has_keys(resolved_node)
            or has_keys(resolved(resolved_node.get("items", {})))
        ):
            return None
        exact = self.document.exact_value(path)
        default = self._default(path, resolved_node)
        value = default if exact is None else plain(exact)
        kind = _type(resolved_node, value)
        low, high = _limits(resolved_node)
        slider = None
        if kind == "number" and isinstance(value, int | float) and not isinstance(value, bool):
            slider = slider_range(value, low, high, whole=resolved_node.get("type") == "integer")
        rest = {
            "description": in_unit(resolved_node.get("description", ""), self.length),
            "unit": self.node_unit(path, node),
            "default": default,
            "choices": list(_choices(resolved_node)),
            "low": low,
            "high": high,
            "slider": None if slider is None else list(slider),
        }
        return {
            "key": spelled(path),
            "title": key_title(path),
            "type": kind,
            "value": value,
            "stated": exact is not None,
            **{key: item for key, item in rest.items() if item not in (None, "", [])},
        }

    def table_fields(self, path: KeyPath, node: Node) -> Iterator[Data]:
        """The fields of a table, without those of tables in it."""
        inner = tree_value(self.document.plain, path)
        for key, child in table_keys(node, inner if isinstance(inner, dict) else {}).items():
            table_field = self.field((*path, key), child)
            if table_field is not None:
                yield table_field

    def form(self) -> list[Data]:
        """The tables of the scene: those that it has and those that it could have.

        Of each its `key`, `title` and `description`, as of a field, the key empty for the scene
        itself; `stated`, whether the scene has it; its `kind` if there are several, else None;
        `kinds`, those that there are, each with a sentence, None if the kind cannot be changed; and
        its `fields`.
        """
        root = self.composed.root
        scene_fields = [
            scene_field
            for key, node in root["properties"].items()
            if key not in EXCLUDED and (scene_field := self.field((key,), node)) is not None
        ]
        return [_section("", "scene", "", scene_fields), *_inner(self, (), root)]

    def plan(self) -> list[Data]:
        """The segments of the scene; none if its motion is no list.

        Of each its `index`, from 0; its `kind`, "dwell", "move", "points" or "table"; the cam
        angles [degrees] `from` and `to`, None after a segment whose span is not valid; the
        positions `start` and `end` [unit of the plan], None if a file decides; its `law`, None of a
        dwell; and its `fields`, as of a form.
        """
        motion = self.document.exact_value(("motion",))
        if not isinstance(motion, list):
            return []
        node = self.node(("motion",)).get("items", {})
        spans = []
        for segment in motion[:MOST_SEGMENTS]:
            span = segment_span(segment)
            if span is None:
                break
            spans.append(span)
        angles = [float(angle) for angle in joints(spans)]
        rows = []
        position: float | None = 0.0
        for index, segment in enumerate(motion[:MOST_SEGMENTS]):
            table = segment if isinstance(segment, dict) else {}
            law = table.get("law")
            rests = "dwell" in table
            start = position
            if not rests:
                end = plain(table.get("to"))
                position = end if isinstance(end, int | float) else None
            rows.append(
                {
                    "index": index,
                    "kind": "dwell" if rests else law if law in DATA else "move",
                    "from": angles[index] if index < len(angles) else None,
                    "to": angles[index + 1] if index + 1 < len(angles) else None,
                    "start": start,
                    "end": position,
                    "law": law if isinstance(law, str) and not rests else None,
                    "fields": list(_fitting(self.table_fields(("motion", index), node), law)),
                }
            )
        return rows

    def _default(self, path: KeyPath, node: Node) -> Any:
        if "x-default-by-law" in node:
            law = self.document.exact_value((*path[:-1], "law"))
            return node["x-default-by-law"].get(law) if isinstance(law, str) else None
        if "x-default-key" in node:
            path = tuple(node["x-default-key"].split("."))
            there = self.document.exact_value(path)
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
    """A value as JSON data, truncated if it is long; None if it cannot be shown."""
    if isinstance(value, Decimal):
        number = float(value)
        return number if math.isfinite(number) else None
    if isinstance(value, list):
        return [plain(item) for item in value[:LONGEST]]
    if isinstance(value, Mapping):
        return {str(key)[:LONGEST]: plain(value[key]) for key in list(value)[:LONGEST]}
    if isinstance(value, int) and not isinstance(value, bool):
        # JavaScript represents integers exactly only up to 2^53.
        return value if abs(value) <= 2**53 else float(value) if abs(value) < 1e300 else None
    if isinstance(value, str):
        return value[:LONGEST]
    return value if isinstance(value, bool | float) else None


def has_keys(node: Node) -> bool:
    """Whether a resolved node of the schema is of tables."""
    return "properties" in node or "allOf" in node


def _alternatives(node: Node) -> list[Node]:
    among: list[Node] = node.get("anyOf") or [node]
    return [resolved(alternative) for alternative in among]


def _choices(node: Node) -> tuple[Any, ...]:
    choices: list[Any] = list(node.get("x-values") or ())
    for alternative in (*_alternatives(node), resolved(node.get("items", {}))):
        choices += alternative.get("enum", [])
        if "const" in alternative:
            choices.append(alternative["const"])
    return tuple(choices)


def _type(node: Node, value: Any) -> Type:
    kinds = [alternative.get("type") for alternative in _alternatives(node)]
    if "array" in kinds:
        return "list"
    if "boolean" in kinds:
        return "flag"
    if ("number" in kinds or "integer" in kinds) and not isinstance(value, str):
        return "number"
    if any("enum" in alternative or "const" in alternative for alternative in _alternatives(node)):
        return "choice"
    return "file" if "x-file" in node or "x-path" in node else "text"


def _limits(node: Node) -> tuple[float | None, float | None]:
    for alternative in _alternatives(node):
        if alternative.get("type") in ("number", "integer"):
            low = alternative.get("minimum", alternative.get("exclusiveMinimum"))
            return low, alternative.get("maximum", alternative.get("exclusiveMaximum"))
    return None, None


def slider_range(
    value: float, low: float | None, high: float | None, *, whole: bool = False
) -> tuple[float, float, float] | None:
    """A sensible range around a value as (start, end, step), with step 1 for a `whole` number.

    None if there is none.
    """
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
    return next(digit * power for digit in (1.0, 2.0, 5.0, 10.0) if digit * power > value)


def key_title(path: KeyPath) -> str:
    """The title of a key: "roller radius" for follower.roller_radius."""
    words = [str(step) for step in path if isinstance(step, str)]
    if not words:
        return ""
    number = f" {path[-1] + 1}" if isinstance(path[-1], int) else ""
    return words[-1].replace("_", " ").replace("-", " ") + number


# -- plan -----------------------------------------------------------------------------------------
# The motion plan as rows: each segment with its fields, for valid scenes and invalid ones.


MOST_SEGMENTS: Final = 400
"""Most segments of a plan that are shown."""

DATA: Final = ("points", "table")
"""Laws by data; the page treats them as kinds of segments of their own."""

OPTIMISE: Final = "optimise"
"""Key of the quantity that law "auto" minimizes."""


def _fitting(fields: Iterable[Data], law: Any) -> Iterator[Data]:
    """The fields that the law takes, and those that are stated although it does not take them."""
    known = isinstance(law, str) and (law in FAMILIES or law in ALIASES or law == AUTO)
    parameters = law_parameters(law) if known else frozenset(SHAPES)
    for field in fields:
        key = field["key"].rpartition(".")[2]
        idle = (key in (*SHAPES, JERK) and key not in parameters) or (
            key == OPTIMISE and law != AUTO
        )
        if field["stated"] or not idle:
            yield field
