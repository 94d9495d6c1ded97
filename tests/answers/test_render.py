"""Schemas determine how documents are made from answers."""

from __future__ import annotations

import importlib
import math
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from jsonschema_rs import meta

from camgeo.app import answers
from camgeo.app.answers import answer
from camgeo.app.answers.answer import Answer
from camgeo.numeric.arrays import FloatArray

PACKAGES = sorted(
    f"{answers.__name__}.{path.stem}" for path in Path(answers.__path__[0]).glob("*.json")
)


def nodes(node: Any) -> list[dict[str, Any]]:
    """All objects of a schema that have properties."""
    if isinstance(node, list):
        return [found for each in node for found in nodes(each)]
    if not isinstance(node, dict):
        return []
    inner = [found for each in node.values() for found in nodes(each)]
    return [node, *inner] if isinstance(node.get("properties"), dict) else inner


@pytest.mark.parametrize("package", PACKAGES)
def test_each_answer_has_a_schema_and_a_text(package: str) -> None:
    module = importlib.import_module(package)
    (kind,) = [
        each for each in vars(module).values()
        if isinstance(each, type) and issubclass(each, Answer) and each.__module__ == package
    ]  # fmt: skip
    schema = answer.schema_of(package)
    meta.validate(schema)
    assert schema["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    assert schema["properties"]["schema"]["const"] == f"camgeo/{kind.command}"
    assert schema["properties"]["version"]["const"] == kind.version
    assert callable(module.text)


@pytest.mark.parametrize("package", PACKAGES)
def test_schemas_describe_all_and_name_units(package: str) -> None:
    for node in nodes(answer.schema_of(package)):
        assert node["additionalProperties"] is False
        for key, each in node["properties"].items():
            assert each is True or each.keys() & {"description", "$ref"}, key
            words = each.get("x-unit", "").replace("/", " per ").replace("^", "").split()
            assert key.endswith("_".join(words)), key


@pytest.mark.parametrize("name", ["scene", "finding"])
def test_what_answers_share_they_describe_alike(name: str) -> None:
    found = [answer.schema_of(package).get("$defs", {}).get(name) for package in PACKAGES]
    known = [each for each in found if each is not None]
    assert all(each == known[0] for each in known)


@dataclass(frozen=True)
class Inner:
    turn: float
    place: complex


@dataclass(frozen=True)
class Outer:
    angle: float
    span: Decimal
    size: float
    values: FloatArray
    by_name: dict[str, Inner | None]
    nothing: None = None
    missing: None = None


NODE: dict[str, Any] = {
    "required": ["area_mm2", "nothing"],
    "properties": {
        "angle_deg": {"x-unit": "deg"},
        "span_deg": {"x-unit": "deg"},
        "area_mm2": {"x-unit": "mm^2", "x-attribute": "size"},
        "values": {"items": {}},
        "by_name": {"additionalProperties": {"anyOf": [{"type": "null"}, {"$ref": "#/$defs/in"}]}},
        "nothing": {},
        "missing": {},
    },
}

DEFINITIONS: dict[str, Any] = {
    "in": {
        "required": ["turn_deg", "place_mm"],
        "properties": {"turn_deg": {"x-unit": "deg"}, "place_mm": {"x-unit": "mm"}},
    }
}


def test_values_are_stated_in_the_units_of_people() -> None:
    inner = Inner(math.pi, 1.0 - 2.0j)
    given = Outer(1.0, Decimal("0.1"), math.inf, np.array([1.0, math.nan]), {"a": inner, "b": None})
    assert answer._read(given, NODE, DEFINITIONS) == {
        "angle_deg": math.degrees(1.0),
        "span_deg": 0.1,
        "area_mm2": None,
        "values": [1.0, None],
        "by_name": {"a": {"turn_deg": 180.0, "place_mm": [1.0, -2.0]}, "b": None},
        "nothing": None,
    }


def test_the_page_of_documents_is_shipped_with_its_schemas() -> None:
    for package in PACKAGES:
        file = importlib.import_module(package).__file__
        assert file is not None
        assert Path(file).with_suffix(".json").is_file()
