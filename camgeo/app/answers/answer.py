"""What a command finds: a frozen result, with text, JSON, tables and pictures as renderings.

Each command has a package in this stage: its result, a dataclass that is an `Answer`, and the
function that makes it; `rendering`, which has `text` and perhaps `table` and `figure`, functions of
the result alone; and schema.json, the JSON Schema of its document, by which the
document is read from the result (`camgeo.app.answers.answer`).
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping
from decimal import Decimal
from functools import cache
from importlib import import_module
from operator import attrgetter
from typing import TYPE_CHECKING, Any, ClassVar, Final

from camgeo._version import __version__
from camgeo.record import Displayed, schema_beside
from camgeo.units import LengthUnit, counted, in_unit

if TYPE_CHECKING:
    from camgeo.check.finding import Finding
    from camgeo.design.value_table import Table
    from camgeo.pictures.model import Figure


FINE: Final = 0
BROKEN: Final = 1
WRONG: Final = 2
CRASHED: Final = 70
"""Exit codes: all limits kept; a limit is broken; the scene or the call is wrong; an error in
camgeo itself, EX_SOFTWARE of BSD's sysexits.h."""

STOPPED: Final = 128
"""Exit code after a signal, less its number: 130 after Ctrl-C, as shells count it."""


class Answer(Displayed):
    """Base of the results, which are frozen dataclasses; lengths in mm, angles in rad.

    Attributes
    ----------
    command : that it answers, as on the command line.
    version : of its JSON document; incremented when a key is removed or changes its meaning.
    """

    __slots__ = ()

    command: ClassVar[str]
    version: ClassVar[int] = 1

    @property
    def exit_code(self) -> int:
        """How the command ends."""
        return FINE


MARKS: Final = {
    "invalid": "INVALID",
    "no-disc": "NO DISC",
    "broken": "BROKEN",
    "warning": "warning",
    "ok": "ok",
    "figure": "figure",
    "note": "note",
}
"""Words for what is said of findings, by their verdict."""

MANY: Final = {**MARKS, "warning": "warnings", "figure": "figures", "note": "notes"}
"""The same of several findings."""

NAME_WIDTH: Final = 26
"""Of the names of findings, at least."""


def finding_lines(findings: Iterable[Finding]) -> list[str]:
    """One line per finding, marks and sentences aligned."""
    found = tuple(findings)
    width = max([NAME_WIDTH, *(len(f.name) + 2 for f in found)])
    return [f"{MARKS[f.verdict]:8}{f.name:{width}}{f.sentence}" for f in found]


def verdict_on(findings: Iterable[Finding]) -> str:
    """How many findings there are, and how many of each severity that is not "ok"."""
    several = Counter[str](each.severity for each in findings)
    bad = [
        counted(several[each], MARKS[each], MANY[each])
        for each in MARKS
        if several[each] and each != "ok"
    ]
    return f"{counted(several.total(), 'finding')}: {', '.join(bad) or 'all limits are kept'}"


def exit_code(findings: Iterable[Finding]) -> int:
    """2 if there is no such mechanism, 1 if a limit is broken or there is no such disc, else 0."""
    severities = {finding.severity for finding in findings}
    if "invalid" in severities:
        return WRONG
    return BROKEN if severities & {"broken", "no-disc"} else FINE


# -- render ---------------------------------------------------------------------------------------
# The renderings of an answer: text, a JSON document, a table, a picture.
#
# A document is read from an answer by its schema. A key of the schema is the attribute of that
# name, without its unit (`cam_angle_deg` is `cam_angle`), or the one, with dots, that `x-attribute`
# names. A number with the `x-unit` "deg" is an angle in rad, one with another unit is left as it
# is; a Decimal is a number as a scene states it, in its unit. Infinite values and NaN become null;
# a key that is not required is left out where the answer has no value for it.


Node = Mapping[str, Any]
"""An object of a schema."""

SENTENCES: Final = (
    "advice", "allowed", "enough", "fault", "infeasible", "message", "note", "reason", "remarks",
    "sentence", "told", "value", "violated", "what",
)  # fmt: skip
"""Keys of texts in documents that state lengths."""


def has(answer: Answer, rendering: str) -> bool:
    """Whether answers of this kind have that rendering, "table" or "figure"."""
    return hasattr(_rendering(answer), rendering)


def text(answer: Answer) -> str:
    """The answer in words, lines without the last line end, lengths in the unit of its scene."""
    words: str = _rendering(answer).text(answer)
    return in_unit(words, _unit(answer))


def table(answer: Answer) -> Table:
    """The answer's table, for CSV."""
    found: Table = _rendering(answer).table(answer)
    return found


def figure(answer: Answer) -> Figure:
    """The answer's picture."""
    found: Figure = _rendering(answer).figure(answer)
    return found


def to_json(answer: Answer) -> dict[str, Any]:
    """The answer as a document that the schema of its package describes; sentences state lengths
    in the unit of its scene.
    """
    head = {"schema": f"camgeo/{answer.command}", "version": answer.version, "camgeo": __version__}
    schema = schema_of(type(answer).__module__)
    own = {key: node for key, node in schema["properties"].items() if key not in head}
    found = _read_object(answer, {**schema, "properties": own}, schema.get("$defs", {}))
    unit = _unit(answer)
    return head | (found if unit == "mm" else _restated(found, unit))


@cache
def schema_of(package: str) -> dict[str, Any]:
    """The JSON Schema of the answers of a package; it must not be changed."""
    file = import_module(package).__file__
    assert file is not None  # it is no namespace
    return schema_beside(file)


def _rendering(answer: Answer) -> Any:
    return import_module(type(answer).__module__)


def _unit(answer: Answer) -> LengthUnit:
    """The unit of length of the answer's scene; mm without one."""
    unit: LengthUnit = getattr(getattr(answer, "scene", None), "unit", "mm")
    return unit


def _restated(value: Any, unit: LengthUnit, key: str = "") -> Any:
    """A part of a document, found at `key`, with its sentences in a unit of length."""
    if isinstance(value, dict):
        return {each: _restated(item, unit, each) for each, item in value.items()}
    if isinstance(value, list):
        return [_restated(item, unit, key) for item in value]
    return in_unit(value, unit) if key in SENTENCES and isinstance(value, str) else value


def _read(value: Any, node: Node, definitions: Node) -> Any:
    """What JSON has of a value that the schema describes by `node`."""
    if value is None or isinstance(value, bool):
        return value
    node = _resolved(node, definitions)
    if isinstance(value, str | int | Decimal) and "x-unit" not in node:
        return float(value) if isinstance(value, Decimal) else value
    if isinstance(value, float | Decimal):
        degrees = node.get("x-unit") == "deg" and isinstance(value, float)
        number = math.degrees(value) if degrees else float(value)
        return number if math.isfinite(number) else None
    if isinstance(value, complex):
        return [value.real, value.imag]
    if "properties" in node:
        return _read_object(value, node, definitions)
    if "additionalProperties" in node:
        each = node["additionalProperties"]
        return {key: _read(item, each, definitions) for key, item in dict(value).items()}
    assert isinstance(value, Iterable)  # all else that an answer has
    return [_read(item, node["items"], definitions) for item in value]


def _read_object(value: Any, node: Node, definitions: Node) -> dict[str, Any]:
    needed = node.get("required", ())
    found = {}
    for key, each in node["properties"].items():
        found[key] = _read(_attribute(value, key, each, needed=key in needed), each, definitions)
    return {key: item for key, item in found.items() if key in needed or item is not None}


def _resolved(node: Node, definitions: Node) -> Node:
    """The node with its reference followed; of alternatives the one that is not null."""
    for each in node.get("anyOf", ()):
        if each.get("type") != "null":
            return _resolved(each, definitions)
    if "$ref" in node:
        return _resolved(definitions[node["$ref"].rpartition("/")[2]], definitions)
    return node


def _attribute(value: Any, key: str, node: Node, *, needed: bool) -> Any:
    """The attribute of a value for a key of its document; None if absent and not required."""
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
