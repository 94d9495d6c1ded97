"""The result of `camgeo explain`, rendered as text and as JSON."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from camgeo.answers.explain import GOALS, explain
from camgeo.answers.render import text
from camgeo.design import Design
from camgeo.scene.load import load_scene
from tests.answers.documents import FIXTURES, SCENES, document, explained

SPRUNG = FIXTURES / "effects" / "press.toml"
PAIR = FIXTURES / "scenes" / "conjugate_lever.toml"


@pytest.mark.parametrize("scene", SCENES, ids=lambda path: path.stem)
def test_documents_are_what_their_schema_says(scene: Path) -> None:
    document(explained(scene)[1])


@pytest.mark.parametrize("scene", [SPRUNG, PAIR], ids=lambda path: path.stem)
@pytest.mark.parametrize("goal", [goal for goal in GOALS if goal != "build"])
def test_text_and_document_are_of_one_result(goal: str, scene: Path) -> None:
    found = explain(Design(load_scene(scene)), goal)
    reported = document(found)
    assert reported["command"] == goal
    assert [each["name"] for each in reported["computed"]] == [each.name for each in found.computed]
    first, *rest = found.computed
    changed = replace(found, computed=(replace(first, name="the-moon", failed=True), *rest))
    assert document(changed)["computed"][0] == {
        **reported["computed"][0], "name": "the-moon", "failed": True,
    }  # fmt: skip
    (line,) = [line for line in text(changed).splitlines() if "the-moon" in line]
    assert "has no answer" in line
    assert "the-moon" not in text(found)
