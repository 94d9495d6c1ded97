"""JSON documents of answers, validated against their schemas."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

from jsonschema_rs import Draft202012Validator, meta

from camgeo.app.answers.answer import Answer, document_schema, to_json
from camgeo.app.answers.explain import Explanation, explain
from camgeo.design.design import Design
from camgeo.scene.scene import load_scene

FIXTURES = Path(__file__).parents[2] / "fixtures"

FOLDERS = ("effects", "refused", "scenes")

SCENES = [path for name in FOLDERS for path in sorted((FIXTURES / name).glob("*.toml"))]

RING = FIXTURES / "scenes" / "ring.toml"

UNHELD = RING.read_text().replace(
    'kind = "fixture"\nthrough = 0.5',
    'kind = "clamps"\nthrough = 0.5\n'
    "clamp = [{ place = [85, 0], length = 12, width = 20, height = 4 }]",
)
"""The ring clamped, and the core that is cut out of it not held by anything."""


@cache
def explained(scene: Path) -> tuple[Design, Explanation]:
    """The design of a scene with all that a check computes, and the answer that says so."""
    design = Design(load_scene(scene))
    return design, explain(design)


@cache
def validator(package: str) -> Draft202012Validator:
    schema = document_schema(package)
    meta.validate(schema)
    return Draft202012Validator(schema)


def document(answer: Answer) -> dict[str, Any]:
    """The answer's document, as it is printed; it is what its schema says."""
    found: dict[str, Any] = json.loads(json.dumps(to_json(answer), allow_nan=False))
    validator(type(answer).__module__).validate(found)
    assert found["schema"] == f"camgeo/{answer.command}"
    assert found["version"] == answer.version
    return found
