"""Keys determine how documents are made from answers, and the types of attributes their schemas."""

from __future__ import annotations

import importlib
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from decimal import Decimal
from enum import StrEnum
from typing import Any, Literal

import numpy as np
import pytest
from jsonschema_rs import Draft202012Validator, ValidationError, meta

from camgeo.app.answers import answer
from camgeo.app.answers.answer import Answer, Key, Keys
from camgeo.lazy import Ledger, lazy
from camgeo.numeric.arrays import FloatArray
from tests.pages import page_maker

PACKAGES = page_maker("answers_page").packages()


def described(node: Mapping[str, Any]) -> Iterator[str]:
    """The descriptions of all keys of a schema."""
    for each in node.get("properties", {}).values():
        yield each["description"]
        yield from described(each)
    for name in ("items", "additionalProperties"):
        if isinstance(node.get(name), Mapping):
            yield from described(node[name])


@pytest.mark.parametrize("package", PACKAGES)
def test_each_answer_has_a_schema_and_a_text(package: str) -> None:
    module = importlib.import_module(package)
    (kind,) = [
        each for each in vars(module).values()
        if isinstance(each, type) and issubclass(each, Answer) and each.__module__ == package
    ]  # fmt: skip
    schema = answer.document_schema(package)
    meta.validate(schema)
    assert schema["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    assert schema["properties"]["schema"]["const"] == f"camgeo/{kind.command}"
    assert schema["properties"]["version"]["const"] == kind.version
    assert all(described(schema))
    assert callable(module.text)


class Way(StrEnum):
    UP = "up"
    DOWN = "down"


@dataclass(frozen=True)
class Inner:
    turn: float
    place: complex


@dataclass(frozen=True)
class Other:
    turn: float
    place: complex
    note: str


@dataclass(frozen=True)
class Outer:
    angle: float
    span: Decimal
    size: float
    values: FloatArray
    by_name: Mapping[str, Inner | None]
    several: tuple[Inner | Other, ...]
    pairs: tuple[tuple[str, int], ...]
    row: Mapping[str, Any]
    way: Way = Way.UP
    word: Literal["a", "b"] | None = None
    nothing: float | str | None = None
    missing: int | None = None

    ledger = Ledger()

    @lazy
    def computed(self) -> tuple[float, float]:
        return 1.0, 2.0

    @property
    def one(self) -> Inner | Other:
        return self.several[0]


INNER: Keys = {
    "turn_deg": "Turn.",
    "place_mm": "Place.",
    "note": Key("Said.", type=str, optional=True),
}

KEYS = Key(
    "All.",
    {
        "angle_deg": "Angle.",
        "span_deg": "Span.",
        "area_mm2": Key("Area.", of="size"),
        "values": "Values.",
        "by_name": Key("Each by name.", Key("Null if there is none.", INNER)),
        "several": Key("Several.", INNER),
        "turn_deg": Key("Of the first.", of="one.turn"),
        "pairs": Key("Numbers by name.", type=Mapping[str, int]),
        "row": Key("As it is.", {"step_deg": Key("Step.", type=float)}, by_key=True),
        "way": "Way.",
        "word": "Word.",
        "computed": "Two numbers.",
        "nothing": "Nothing.",
        "missing": Key("Left out.", optional=True),
        "absent": Key("Not there.", type=str, optional=True),
    },
)

DOCUMENT = {
    "angle_deg": math.degrees(1.0),
    "span_deg": 0.1,
    "area_mm2": None,
    "values": [1.0, None],
    "by_name": {"a": {"turn_deg": 180.0, "place_mm": [1.0, -2.0]}, "b": None},
    "several": [{"turn_deg": 180.0, "place_mm": [1.0, -2.0]},
                {"turn_deg": 0.0, "place_mm": [0.0, 1.0], "note": "other"}],
    "turn_deg": 180.0,
    "pairs": {"a": 1},
    "row": {"step_deg": math.degrees(1.0)},
    "way": "up",
    "word": None,
    "computed": [1.0, 2.0],
    "nothing": None,
}  # fmt: skip


def outer(size: float = math.inf) -> Outer:
    inner = Inner(math.pi, 1.0 - 2.0j)
    return Outer(
        angle=1.0,
        span=Decimal("0.1"),
        size=size,
        values=np.array([1.0, math.nan]),
        by_name={"a": inner, "b": None},
        several=(inner, Other(0.0, 1j, "other")),
        pairs=(("a", 1),),
        row={"step_deg": 1.0},
    )


def test_values_are_stated_in_the_units_of_people() -> None:
    assert answer._read_object(outer(), KEYS) == DOCUMENT
    assert list(answer._read_object(outer(), KEYS)) == list(DOCUMENT)


def test_types_of_attributes_are_those_of_the_schema() -> None:
    schema = answer._object_schema([Outer], KEYS)
    meta.validate(schema)
    found = {name: {k: v for k, v in node.items() if k in ("type", "enum", "x-unit", "x-attribute")}
             for name, node in schema["properties"].items()}  # fmt: skip
    assert found == {
        "angle_deg": {"type": "number", "x-unit": "deg"},
        "span_deg": {"type": "number", "x-unit": "deg"},
        "area_mm2": {"type": "number", "x-unit": "mm^2", "x-attribute": "size"},
        "values": {"type": "array"},
        "by_name": {"type": "object"},
        "several": {"type": "array"},
        "turn_deg": {"type": "number", "x-unit": "deg", "x-attribute": "one.turn"},
        "pairs": {"type": "object"},
        "row": {"type": "object"},
        "way": {"enum": ["up", "down"]},
        "word": {"enum": ["a", "b", None]},
        "computed": {"type": "array"},
        "nothing": {"type": ["number", "string", "null"]},
        "missing": {"type": "integer"},
        "absent": {"type": "string"},
    }
    inner = schema["properties"]["by_name"]["additionalProperties"]
    assert inner["type"] == ["object", "null"]
    assert inner["description"] == "Null if there is none."
    assert inner["required"] == ["turn_deg", "place_mm"]


def test_a_key_without_a_type_is_an_error() -> None:
    with pytest.raises(AttributeError, match="wrong"):
        answer._object_schema([Outer], Key("", {"wrong": "Not there."}))


@pytest.mark.parametrize("changed", [{"pairs": {"a": "1"}}, {"way": "left"}, {"computed": [1.0]},
                                     {"several": [{"turn_deg": 1.0}]}, {"row": {}},
                                     {"missing": None}, {"other": 1}])  # fmt: skip
def test_other_documents_are_not_valid(changed: dict[str, Any]) -> None:
    schema = Draft202012Validator(answer._object_schema([Outer], KEYS))
    good = DOCUMENT | {"area_mm2": 1.0, "values": [1.0]}
    schema.validate(good)
    with pytest.raises(ValidationError):
        schema.validate(good | changed)
