"""The form of a scene."""

from __future__ import annotations

import json
import pathlib
from decimal import Decimal
from typing import Any

import pytest

from camgeo.app.designing.form import Fields
from camgeo.scene.keys import parse_path
from camgeo.scene.values import Document, document
from tests.designing.scenes import CHOSEN, name_of


def fields(data: bytes) -> dict[str, Any]:
    return {
        each["key"]: each for section in Fields(document(data)).form() for each in section["fields"]
    }


@pytest.mark.parametrize("file", CHOSEN, ids=name_of)
def test_every_value_of_a_scene_has_its_field(file: pathlib.Path) -> None:
    data = file.read_bytes()
    found = fields(data)
    assert len(json.dumps(Fields(document(data)).form(), allow_nan=False)) < 120_000
    stated = {key for key, each in found.items() if each["stated"]}
    for path in leaves(document(data).exact):
        key = ".".join(str(step) for step in path)
        if path[0] not in ("camgeo", "motion") and path[-1:] != ("kind",):
            assert any(parse_path(each) == path for each in stated), key
    for key, each in found.items():
        assert each["title"], key
        if "slider" in each:
            low, high, step = each["slider"]
            assert low <= each["value"] <= high, key
            assert 0 < step < high - low
            assert each.get("low", low) <= low
            assert each.get("high", high) >= high


def leaves(node: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Paths to the values of a scene's tables; a list of values, or of inline tables, is one."""
    if isinstance(node, dict):
        return [found for key, each in node.items() for found in leaves(each, (*path, key))]
    if isinstance(node, list) and node and isinstance(node[0], dict) and len(path) == 1:
        return [f for index, each in enumerate(node) for f in leaves(each, (*path, index))]
    return [] if isinstance(node, list) and node and isinstance(node[0], dict) else [path]


@pytest.mark.parametrize(
    "values",
    [
        {"a": 1}, {"follower": 3}, {"follower": []}, {"follower": {"kind": 3}},
        {"follower": {"kind": "no"}}, {"linkage": {"kind": "no"}}, {"effects": {"no": {}}},
        {"effects": [1]}, {"effects": {"spring": 3}}, {"tool": {}}, {"tool": [1, {"number": "x"}]},
        {"output": {"formats": [1, {}], "dxf": 3}}, {"motion": {}}, {"cam": {"speed": "fast"}},
        {"limits": {"radius_ratio": Decimal("NaN")}}, {"part": {"keyway": [1]}},
        {"part": {"bore": 10**400}}, {"units": {"length": ["mm"]}}, {"name": "x" * 100_000},
        {"follower": {"kind": "translating-roller", "return": 3, "base_radius": {"a": [1]}}},
        {"follower": {"kind": {}}, "linkage": {"kind": []}},
    ],
)  # fmt: skip
def test_any_values_have_a_form(values: dict[str, Any]) -> None:
    assert len(json.dumps(Fields(Document.from_values(values)).form(), allow_nan=False)) < 120_000
