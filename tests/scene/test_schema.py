"""The schema is valid, describes every key and agrees with the engine; templates explain all."""

from __future__ import annotations

import itertools
import json
import re
import tomllib
from collections.abc import Iterator
from typing import Any

import jsonschema_rs
import pytest

from camgeo.check.finding import Limits
from camgeo.design.design import Design
from camgeo.errors import SceneError, UnknownNameError
from camgeo.kinematics.laws import ALIASES, FAMILIES
from camgeo.kinematics.planning.requests import AUTO
from camgeo.milling.milling import GcodeSpec
from camgeo.record import allowed
from camgeo.scene.formats.csv import CsvSpec
from camgeo.scene.formats.dxf import DxfSpec
from camgeo.scene.formats.format import OutputSpec
from camgeo.scene.keys import key_lines, spelled, tree_value
from camgeo.scene.scene import Scene, parse_scene, schema_of_all
from camgeo.scene.schema import Node, definition, resolved, schema, table_keys, whole_schema
from camgeo.scene.toml import TEMPLATE_KINDS, template
from tests.findings import effect_findings


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


@pytest.mark.parametrize("kind", TEMPLATE_KINDS)
def test_template_loads(kind: str) -> None:
    scene = parse_scene(template(kind))
    assert isinstance(scene, Scene)
    assert scene.name == kind
    member = None if scene.linkage is None else scene.linkage.member
    members = {"slider-crank": "slider", "slider-driven-crank": "crank", "four-bar": "lever"}
    assert member == members.get(kind)
    assert (scene.contact == "groove") == (kind == "groove")
    assert (scene.returning is not None) == kind.startswith("conjugate-")


@pytest.mark.parametrize("kind", TEMPLATE_KINDS)
def test_template_explains_each_key_and_fits_a_screen(kind: str) -> None:
    assert max(map(len, template(kind).splitlines())) <= 100
    known: set[str] = set()
    for line in template(kind).splitlines():
        key, _, rest = line.partition("=")
        if not rest or line.lstrip().startswith("#"):
            continue
        # A key that comes again needs no second comment.
        assert "#" in rest or key.strip() in known or key.strip() in ("thickness", "roller_radius")
        known.add(key.strip())


CHOSEN = ("kind", "law")
"""Keys whose values are too many for a comment; it says where they are listed."""


def choices(text: str) -> Iterator[tuple[str, str, set[str]]]:
    """Key, line with the comments below it, and allowed values of each key with a choice."""
    tree, lines = tomllib.loads(text), text.splitlines()
    for path, line in key_lines(text).items():
        node: Any = schema_of_all(tree)
        for place, step in enumerate(path):
            table = tree_value(tree, path[:place])
            inner = (
                node.get("items", {}) if isinstance(step, int) else table_keys(node, table)[step]
            )
            node = resolved(inner)
        if values := node.get("enum") or node.get("items", {}).get("enum"):
            below = itertools.takewhile(re.compile(r" +#").match, lines[line:])
            yield spelled(path), "\n".join((lines[line - 1], *below)), set(values)


@pytest.mark.parametrize("kind", TEMPLATE_KINDS)
def test_comments_name_every_value_of_a_choice(kind: str) -> None:
    """All values that the schema allows, except those ruled out by the template's machine."""
    text = template(kind)
    found = [each for each in choices(text) if not each[0].endswith(CHOSEN)]
    assert {key for key, _, _ in found} >= {"units.length", "cam.rotation", "output.formats"}
    for key, entry, values in found:
        named = set(re.findall(r'"([^"\n]*)"', entry))
        for value in values - named:
            other = re.sub(r'= "\w+"', f'= "{value}"', entry, count=1)
            with pytest.raises(SceneError, match=rf"{key} = "):
                parse_scene(text.replace(entry, other))


@pytest.mark.parametrize("kind", TEMPLATE_KINDS)
def test_effects_that_are_offered_work(kind: str) -> None:
    """Taken out of their comments as the template says, they break no limit."""
    head, mark, rest = template(kind).partition("# Effects:")
    offered, output, tail = rest.partition("\n[output]\n")
    asked = re.sub(r"^# (?=\[|\w+ = )", "", offered, flags=re.MULTILINE)
    text = head + mark + asked + output + tail
    design = Design(parse_scene(text))
    # Most effects are for rollers, and some for a single contact.
    flat = not design.cam.follower.rolls
    core = {"kinematics"} if flat else {"inertia", "drive-torque"}
    if not flat and len(design.discs) == 1:
        core |= {"contact-force", "lift-off"}
    assert core <= set(design.scene.effects)
    assert [f for f in effect_findings(design) if f.severity not in ("ok", "warning")] == []


def test_unknown_kind() -> None:
    with pytest.raises(UnknownNameError, match='no template "elephant"; there are translating'):
        template("elephant")
