"""The schema is valid, describes every key, and agrees with the engine."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import jsonschema_rs

from camgeo.check.finding import Limits
from camgeo.kinematics.laws import ALIASES, FAMILIES
from camgeo.kinematics.planning.requests import AUTO
from camgeo.milling.milling import GcodeSpec
from camgeo.record import allowed
from camgeo.scene.formats.csv import CsvSpec
from camgeo.scene.formats.dxf import DxfSpec
from camgeo.scene.formats.format import OutputSpec
from camgeo.scene.schema import Node, definition, resolved, schema, whole_schema


def test_schema_is_valid() -> None:
    jsonschema_rs.meta.validate(json.loads(json.dumps(whole_schema())))
    assert schema()["$schema"] == "https://json-schema.org/draft/2020-12/schema"


def test_every_key_is_described() -> None:
    for name, node in _keys(whole_schema()):
        if name != "kind":
            assert resolved(node).get("description"), name


def test_every_value_can_be_asked_for_in_words() -> None:
    for _, node in _keys(whole_schema()):
        if node is not True:
            assert allowed(resolved(node)).startswith("must be") or "x-allowed" in resolved(node)


def test_laws_are_those_of_the_engine() -> None:
    data = {definition(name)["properties"]["law"]["const"] for name in ("lift-table", "points")}
    names = set(definition("move")["properties"]["law"]["enum"])
    assert names == {*FAMILIES, *ALIASES, AUTO, *data}


def test_defaults_are_those_of_the_engine() -> None:
    output = whole_schema()["properties"]["output"]["properties"]
    assert tuple(output["formats"]["default"]) == OutputSpec().formats
    assert output["csv"]["properties"]["step"]["default"] == CsvSpec().step
    assert output["dxf"]["properties"]["entity"]["default"] == DxfSpec().entity
    gcode = output["gcode"]["properties"]
    assert gcode["machine"]["default"] == GcodeSpec().machine
    limits = schema()["properties"]["limits"]["properties"]
    assert limits["radius_ratio"]["default"] == Limits().radius_ratio
    assert f"{OutputSpec().tolerance:g} mm" in output["tolerance"]["description"]
    assert (
        f"Default {GcodeSpec().clearance_height:g} mm" in gcode["clearance_height"]["description"]
    )


def test_tables_allow_no_unknown_keys() -> None:
    for name, node in _keys(whole_schema()):
        node = resolved(node)
        if node.get("type") == "object":
            assert node.get("additionalProperties") is False or "allOf" in node, name
    for name, node in schema()["$defs"].items():
        if node.get("type") == "object":
            assert node["additionalProperties"] is False, name


def _keys(root: Node) -> Iterator[tuple[str, Any]]:
    """Every key of every table."""
    stack: list[Any] = [root]
    while stack:
        node = stack.pop()
        if isinstance(node, list):
            stack.extend(node)
        elif isinstance(node, dict):
            if isinstance(node.get("properties"), dict) and "type" in node:
                yield from node["properties"].items()
            stack.extend(node.values())
