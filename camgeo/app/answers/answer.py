"""The answer of a command: a frozen result, with text, JSON, tables and pictures as renderings.

Each command has a module beside this one: its result, a dataclass that is an `Answer`, and the
function that makes it; `DOCUMENT`, which says what JSON has of the result; `text`, and perhaps
`table` and `figure`, functions of the result alone.
"""

from __future__ import annotations

import ast
import inspect
import math
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from enum import Enum
from functools import cache
from importlib import import_module
from operator import attrgetter
from pathlib import Path
from types import NoneType, UnionType
from typing import (
    TYPE_CHECKING,
    Annotated,
    Any,
    ClassVar,
    Final,
    Literal,
    TypeAlias,
    Union,
    get_args,
    get_origin,
)

from camgeo._version import __version__
from camgeo.errors import CamgeoError, Fault, FileError, GeometryError, SceneError, unreadable
from camgeo.record import Displayed
from camgeo.units import MM_PER, LengthUnit, at_cam_angles, counted, in_unit, small

if TYPE_CHECKING:
    from camgeo.cam.cam import Cam
    from camgeo.check.finding import Finding
    from camgeo.design.value_table import Table
    from camgeo.numeric.extremes import Extreme
    from camgeo.pictures.model import Figure
    from camgeo.reading import Limits


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
    command : that it answers, as on the command line; the name of its module if it states none.
    version : of its JSON document; incremented when a key is removed or changes its meaning.
    """

    __slots__ = ()

    command: ClassVar[str]
    version: ClassVar[int] = 1

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        if "command" not in vars(cls):
            cls.command = cls.__module__.rpartition(".")[2].replace("_", "-")

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
"""Marks printed in front of findings, by their verdict."""

MANY: Final = {**MARKS, "warning": "warnings", "figure": "figures", "note": "notes"}
"""The plurals of these marks."""

NAME_WIDTH: Final = 26
"""Least width of the column with the names of findings."""


def finding_lines(findings: Iterable[Finding]) -> list[str]:
    """One line per finding, marks and sentences aligned."""
    rows = tuple(findings)
    width = max([NAME_WIDTH, *(len(f.name) + 2 for f in rows)])
    return [f"{MARKS[f.verdict]:8}{f.name:{width}}{f.sentence}" for f in rows]


def findings_summary(findings: Iterable[Finding]) -> str:
    """How many findings there are, and how many of each severity that is not "ok"."""
    several = Counter[str](finding.severity for finding in findings)
    bad = [
        counted(several[mark], MARKS[mark], MANY[mark])
        for mark in MARKS
        if several[mark] and mark != "ok"
    ]
    return f"{counted(several.total(), 'finding')}: {', '.join(bad) or 'all limits are kept'}"


def exit_code(findings: Iterable[Finding]) -> int:
    """2 if there is no such mechanism, 1 if a limit is broken or there is no such disc, else 0."""
    severities = {finding.severity for finding in findings}
    if "invalid" in severities:
        return WRONG
    return BROKEN if severities & {"broken", "no-disc"} else FINE


# -- texts ----------------------------------------------------------------------------------------
# What texts of several answers share.


def aligned(rows: Sequence[Sequence[str]], right: Collection[int] = ()) -> list[str]:
    """Rows of cells as lines, columns two spaces apart, those numbered in `right` right-aligned."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  ".join(
            cell.rjust(width) if number in right else cell.ljust(width)
            for number, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    ]


def named_line(name: str, text: str) -> str:
    """A line of a list, with its name in a column of 22 characters."""
    return f"{name:22}{text}"


def small_extreme(extreme: Extreme, unit: str) -> str:
    """A small extreme with its sign and its cam angle."""
    return f"{small(extreme.value, unit, signed=True)} {at_cam_angles(extreme.place)}"


def scaled(extreme: Extreme, factor: float) -> Extreme:
    """The extreme in a unit of which `factor` are 1 mm or rad; a zero has no sign."""
    return replace(extreme, value=extreme.value * factor + 0.0)


def display_unit(length: LengthUnit, *, is_angle: bool) -> tuple[str, float]:
    """The unit in which lengths or angles are shown, and the factor from mm or rad to it."""
    return ("deg", math.degrees(1.0)) if is_angle else (length, 1.0 / MM_PER[length])


def whose_lift(cam: Cam) -> str:
    """Whose motion the lift of a cam is: that of the rocker of a linkage, or of the follower."""
    return "rocker" if cam.drive.linkage is not None and cam.lift_unit == "rad" else "follower"


def one_line(error: CamgeoError) -> str:
    """The error in one line, without the name of a file."""
    several = error.faults if isinstance(error, SceneError) else (error,)
    return " ".join("; ".join(map(str, several)).split())


def error_faults(error: CamgeoError) -> tuple[Fault, ...]:
    """The faults of a scene; any other error as a single fault, at its key."""
    if isinstance(error, SceneError):
        return error.faults
    if isinstance(error, GeometryError):
        return (Fault(error.key, error.value, error.message),)
    return (Fault("", "", str(error)),)


def read_named(path: Path, limits: Limits, key: str) -> bytes:
    """The bytes of a file that a call names as `key`.

    FileError if the file is larger than allowed, SceneError if it cannot be read.
    """
    from camgeo.reading import read_limited  # few answers read files

    try:
        return read_limited(path, limits)
    except FileError:
        raise
    except (OSError, ValueError) as error:  # the latter for a path that no file can have
        fault = Fault(key, str(path), f"cannot be read: {unreadable(error)}")
        raise SceneError([fault]) from error


# -- renderings -----------------------------------------------------------------------------------
# An answer as text, a table, a picture, or a JSON document.


SENTENCES: Final = (
    "advice", "allowed", "enough", "fault", "infeasible", "message", "note", "reason", "remarks",
    "sentence", "told", "value", "violated", "what",
)  # fmt: skip
"""Keys of texts in documents that state lengths."""


def has(answer: Answer, rendering: str) -> bool:
    """Whether answers of this kind have that rendering, "table" or "figure"."""
    return hasattr(_module(answer), rendering)


def text(answer: Answer) -> str:
    """The answer in words, lines without the last line end, lengths in the unit of its scene."""
    words: str = _module(answer).text(answer)
    return in_unit(words, _unit(answer))


def table(answer: Answer) -> Table:
    """The answer's table, for CSV."""
    rendered: Table = _module(answer).table(answer)
    return rendered


def figure(answer: Answer) -> Figure:
    """The answer's picture."""
    rendered: Figure = _module(answer).figure(answer)
    return rendered


def to_json(answer: Answer) -> dict[str, Any]:
    """The answer as a document that its schema describes (`document_schema`); sentences state
    lengths in the unit of its scene.
    """
    head = {"schema": f"camgeo/{answer.command}", "version": answer.version, "camgeo": __version__}
    document = head | _read_object(answer, _module(answer).DOCUMENT)
    unit = _unit(answer)
    return document if unit == "mm" else _restated(document, unit)


def _module(answer: Answer) -> Any:
    return import_module(type(answer).__module__)


def _unit(answer: Answer) -> LengthUnit:
    """The unit of length of the answer's scene; mm without one."""
    unit: LengthUnit = getattr(getattr(answer, "scene", None), "unit", "mm")
    return unit


def _restated(value: Any, unit: LengthUnit, key: str = "") -> Any:
    """A part of a document, found at `key`, with its sentences in a unit of length."""
    if isinstance(value, dict):
        return {name: _restated(item, unit, name) for name, item in value.items()}
    if isinstance(value, list):
        return [_restated(item, unit, key) for item in value]
    return in_unit(value, unit) if key in SENTENCES and isinstance(value, str) else value


# -- documents ------------------------------------------------------------------------------------
# A document is read from an answer by its keys. A key is the attribute of that name without its
# unit (`cam_angle_deg` is `cam_angle`), or the one that is stated. Its type is that of the
# attribute, from which the JSON Schema follows: it is stated again only where they differ.


@dataclass(frozen=True, slots=True, eq=False)
class Key:
    """A key of a document.

    Attributes
    ----------
    meaning : of its value, in words.
    keys : those of the object that its value is, or of each object in a list or by name; None for
        plain values. Those of another `Key` mean what that says.
    of : path of the attribute that holds the value, with dots; "" if it is named like the key.
    type : of the value, where the annotation of the attribute does not state it; for a whole
        document the class of the answer.
    optional : whether the key is left out where there is no value, or an empty text.
    by_key : whether the object is a mapping by the keys of the document, not an object with
        attributes.
    """

    meaning: str
    keys: Mapping[str, Key | str] | Key | None = None
    of: str = ""
    type: Any = None
    optional: bool = False
    by_key: bool = False


Keys: TypeAlias = Mapping[str, Key | str]
"""The keys of an object in the order of the document; a text is the meaning of a plain key."""

UNITS: Final = {
    "deg": "deg",
    "rad_per_s": "rad/s",
    "kg_per_m3": "kg/m^3",
    "kg_mm2": "kg mm^2",
    "mm": "mm",
    "mm2": "mm^2",
    "mm3": "mm^3",
    "kg": "kg",
    "s": "s",
}
"""Units of numbers, by the end of their key. Angles in rad are stated in degrees, other numbers as
they are; a Decimal is a number as a scene states it, in its unit.
"""

SCENE: Final = Key(
    "A scene.",
    {
        "name": "Name of the scene, the stem of its file names.",
        "sha256": Key(
            "SHA-256 of everything in it that determines the bytes of files, hexadecimal, as"
            " written in them.",
            of="made",
        ),
        "files": Key(
            "SHA-256 of the data files that it names, hexadecimal, by file name.",
            type=Mapping[str, str],
        ),
    },
)

FINDING: Final = Key(
    "The result of one check.",
    {
        "name": 'Name of the check, e.g. "transmission-angle".',
        "severity": "ok: within its limit, or without one, see `verdict`. warning: worth knowing."
        " broken: beyond its limit, though the disc can be made. no-disc: there is no such disc."
        " invalid: the scene describes no cam mechanism.",
        "verdict": "The mark in reports. figure: a value without a limit, neither good nor bad."
        " note: a sentence for which the same holds. Both have the severity ok; all others are"
        " named like their severity.",
        "value": "The computed value, in `unit`; null where the check has no figure.",
        "limit": "The limit, in `unit`; null where there is none.",
        "unit": 'Unit of value and limit: "deg", "mm", ... or empty.',
        "cam_angle_deg": "Cam angle of the value; null for the whole turn.",
        "cam_range_deg": "Range, from and to, over which a limit is exceeded throughout; the end is"
        " below the start if the range passes cam angle 0.",
        "sentence": "The finding in words, with value, limit and place.",
    },
)

FEATURE: Final = Key(
    "A feature of the part, compared with the operations that make it.",
    {
        "name": 'Wall, face, edge or keyway, such as "outline" or "upper edge of the outline".',
        "operations": (
            "Names of the operations that make it; of those that touch it, if none finishes it."
        ),
        "severity": Key(
            "ok: it is made, or nothing is to be done. warning: it is not made as the part"
            " states. broken: more is taken off than the part states.",
            type=Literal["ok", "warning", "broken"],
        ),
        "sentence": "The comparison in words, with the difference between part and operations.",
        "stated_mm": Key(
            "Width of a chamfer, or what is to be left there; null elsewhere.", of="stated"
        ),
        "made_mm": Key(
            "That width, or what is left there, as the operations make it; null elsewhere.",
            of="made",
        ),
    },
)


@cache
def _object_keys(key: Key) -> dict[str, Key] | None:
    """The keys of the object that the value of a key is, or of each one; None for plain values."""
    if key.keys is None or isinstance(key.keys, Key):
        return None if key.keys is None else _object_keys(key.keys)
    return {
        name: Key(stated) if isinstance(stated, str) else stated
        for name, stated in key.keys.items()
    }


@cache
def _stem_and_unit(name: str) -> tuple[str, str]:
    """The name of a key without its unit, and the unit; "" for none."""
    for ending, unit in UNITS.items():
        if name.endswith(f"_{ending}"):
            return name.removesuffix(f"_{ending}"), unit
    return name, ""


def _read_object(value: Any, key: Key) -> dict[str, Any]:
    """The object of a document for a value that has the keys of `key`."""
    document = {}
    for name, child in (_object_keys(key) or {}).items():
        item = _read(_attribute(value, name, child, by_key=key.by_key), name, child)
        if item not in (None, "") or not child.optional:
            document[name] = item
    return document


def _attribute(value: Any, name: str, key: Key, *, by_key: bool) -> Any:
    """The attribute or item that the key of this name stands for; None if an optional one is
    absent.
    """
    if by_key:
        return value.get(name)
    try:
        return attrgetter(key.of or _stem_and_unit(name)[0])(value)
    except AttributeError:
        if key.optional:
            return None
        raise


def _read(value: Any, name: str, key: Key) -> Any:
    """The value of a key as JSON data; infinite numbers and NaN become null."""
    # Booleans are ints, and StrEnums are strings: all of them are JSON data already.
    if value is None or isinstance(value, str | int):
        return value
    if isinstance(value, float):
        number = math.degrees(value) if _stem_and_unit(name)[1] == "deg" else float(value)
        return number if math.isfinite(number) else None
    if isinstance(value, Decimal):
        return float(value)
    if isinstance(value, complex):
        return [value.real, value.imag]
    # A mapping by names of the scene; one with `by_key` has the keys of the document.
    if get_origin(key.type) is Mapping or (isinstance(value, Mapping) and not key.by_key):
        return {str(item_name): _read(item, name, key) for item_name, item in dict(value).items()}
    if _object_keys(key) is not None and not isinstance(value, Sequence | Iterator):
        return _read_object(value, key)
    return [_read(item, name, key) for item in value]


# -- schemas --------------------------------------------------------------------------------------
# The JSON Schema of a document, from its keys and the types of the attributes that these are.


DRAFT: Final = "https://json-schema.org/draft/2020-12/schema"

PLAIN: Final = {
    bool: "boolean",
    int: "integer",
    float: "number",
    Decimal: "number",
    str: "string",
    Path: "string",
}
"""Types of JSON."""


def document_schema(package: str) -> dict[str, Any]:
    """The JSON Schema of the documents of the module `package`, which has an answer.

    `x-unit` is the unit of a number, `x-attribute` the attribute of a key that has another name.
    """
    document: Key = import_module(package).DOCUMENT
    kind: type[Answer] = document.type
    head: dict[str, dict[str, Any]] = {
        "schema": {
            "description": "Name of this kind of document.",
            "const": f"camgeo/{kind.command}",
        },
        "version": {
            "description": "Version of its schema; it changes if a key is removed or changes its"
            " meaning.",
            "const": kind.version,
        },
        "camgeo": {
            "description": "Version of camgeo that wrote the document.",
            "type": "string",
        },
    }
    schema = _object_schema([kind], document)
    return {
        "$schema": DRAFT,
        "title": f"camgeo {kind.command}",
        "description": document.meaning,
        **schema,
        "required": [*head, *schema["required"]],
        "properties": head | schema["properties"],
    }


def _object_schema(kinds: Sequence[Any], key: Key) -> dict[str, Any]:
    """The schema of objects of one of these types."""
    table = _object_keys(key) or {}
    properties = {}
    for name, child in table.items():
        stem, unit = _stem_and_unit(name)
        types = [child.type]
        if child.type is None:
            types = list(kinds)
            for attribute in (child.of or stem).split("."):
                types = _attribute_types(types, attribute)
        if child.optional:  # it is left out, never null
            types = [
                member for kind in types for member in _members(kind) if member is not NoneType
            ]
        node = {"description": child.meaning, **_schema(types, child)}
        node |= {"x-unit": unit} if unit else {}
        properties[name] = node | ({"x-attribute": child.of} if child.of else {})
    return {
        "type": "object",
        "additionalProperties": False,
        "required": [name for name, child in table.items() if not child.optional],
        "properties": properties,
    }


def _schema(types: Sequence[Any], key: Key) -> dict[str, Any]:
    """The schema of a value of one of these types."""
    members = [member for candidate in types for member in _members(candidate)]
    kinds = [member for member in members if member is not NoneType]
    null = ["null"] if len(kinds) < len(members) else []
    if all(kind in PLAIN for kind in kinds):
        names = dict.fromkeys(PLAIN[kind] for kind in kinds)
        if "number" in names:
            names.pop("integer", None)  # which is one
        return _typed([*names, *null])
    kind, origin, inner = kinds[0], get_origin(kinds[0]), get_args(kinds[0])
    if origin is Literal:
        return {"enum": [*inner, *([None] if null else [])]}
    if isinstance(kind, type) and issubclass(kind, Enum):
        return {"enum": [member.value for member in kind]}
    # Only plain types are mixed in unions; of tables and lists the first type shows the form.
    is_mapping = isinstance(origin, type) and issubclass(origin, Mapping)
    if _object_keys(key) is not None and (origin is None or (is_mapping and key.by_key)):
        return _object_schema(kinds, key) | _typed(["object", *null])
    if is_mapping:
        return _typed(["object", *null]) | {"additionalProperties": _item_schema(inner[1], key)}
    node = _typed(["array", *null])
    if kind is complex:
        return node | {"items": _typed(["number"]), "minItems": 2, "maxItems": 2}
    # tuple[float, float] has a fixed length, tuple[float, ...] has any.
    if origin is tuple and ... not in inner:
        node |= {"minItems": len(inner), "maxItems": len(inner)}
    is_array = getattr(origin, "__module__", "").startswith("numpy")  # or an alias of its
    item = float if is_array else inner[0]
    return node | {"items": _item_schema(item, key)}


def _item_schema(kind: Any, key: Key) -> dict[str, Any]:
    """The schema of each item of a list, or of each value of a mapping."""
    node = _schema([kind], key)
    is_last = "items" not in node and not isinstance(node.get("additionalProperties"), Mapping)
    said = {"description": key.keys.meaning} if isinstance(key.keys, Key) and is_last else {}
    return said | node


def _typed(names: Sequence[str]) -> dict[str, Any]:
    return {"type": names[0] if len(names) == 1 else list(names)}


def _members(kind: Any) -> list[Any]:
    """The types of a union, without `Annotated` metadata."""
    if get_origin(kind) is Annotated:
        return _members(get_args(kind)[0])
    if get_origin(kind) in (Union, UnionType):
        return [inner for member in get_args(kind) for inner in _members(member)]
    return [kind]


def _attribute_types(kinds: Sequence[Any], attribute: str) -> list[Any]:
    """The types of an attribute of objects of these types, where they have it."""
    types = []
    for kind in (member for owner in kinds for member in _members(owner)):
        for base in getattr(kind, "__mro__", ()):
            stated = inspect.get_annotations(base).get(attribute)
            definition = vars(base).get(attribute)
            # Annotations are texts, as in any module with postponed evaluation.
            for name in ("fget", "func", "make"):  # of a property, a cached and a lazy one
                if hasattr(definition, name):
                    stated = getattr(definition, name).__annotations__["return"]
            if stated is not None:
                types.append(eval(stated, _module_names(base.__module__)))
                break
    if not types:
        raise AttributeError(f"{attribute} has no type in {kinds}")
    return types


@cache
def _module_names(module: str) -> dict[str, Any]:
    """The names of a module, including those that it imports for type checking only."""
    names = dict(vars(import_module(module)))
    for node in ast.walk(ast.parse(inspect.getsource(import_module(module)))):
        if isinstance(node, ast.ImportFrom) and node.module is not None:
            others = vars(import_module(node.module))
            known = (alias for alias in node.names if alias.name in others)
            names |= {alias.asname or alias.name: others[alias.name] for alias in known}
    return names
