"""The result of `camgeo explain`, rendered as text and as JSON."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from camgeo.app.answers.answer import text
from camgeo.app.answers.check import check
from camgeo.app.answers.explain import GOALS, explain
from camgeo.design.design import Design
from camgeo.scene.scene import load_scene
from tests.answers.documents import FIXTURES, SCENES, document, explained

SPRUNG = FIXTURES / "effects" / "lift_off_elastic.toml"
PAIR = FIXTURES / "scenes" / "conjugate_lever.toml"
MILLED = FIXTURES / "scenes" / "ring.toml"
REFUSED = sorted((FIXTURES / "refused").glob("*.toml"))


@pytest.mark.long  # tests/answers/test_kept.py validates those of each kind
@pytest.mark.parametrize("scene", SCENES, ids=lambda path: path.stem)
def test_documents_are_what_their_schema_says(scene: Path) -> None:
    document(explained(scene)[1])


@pytest.mark.long  # tests/answers/test_kept.py has both whole
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


@pytest.mark.parametrize("scene", [SPRUNG, PAIR, MILLED, *REFUSED], ids=lambda path: path.stem)
def test_each_finding_of_a_check_stands_at_what_made_it(scene: Path) -> None:
    design, found = explained(scene)
    told = [each for own in found.findings.values() for each in own]
    assert sorted(told, key=repr) == sorted(check(design).everything, key=repr)
    runs = [each.name for each in found.computed if each.name in found.findings]
    assert sorted(runs) == sorted(found.findings)


@pytest.mark.long  # tests/cli/test_explain.py does it by the command
def test_a_command_that_judges_nothing_has_no_findings() -> None:
    found = explain(Design(load_scene(FIXTURES / "effects" / "lever.toml")), "table")
    assert not found.findings
    assert "findings" in found.left_alone


def test_text_names_findings_with_severities_other_than_ok() -> None:
    found = explained(SPRUNG)[1]
    (name, own), *_ = ((name, own) for name, own in found.findings.items() if len(own) > 1)
    changed = replace(own[0], name="the-moon", severity="broken")
    words = text(replace(found, findings={**found.findings, name: (changed, changed, *own[2:])}))
    (line,) = [line for line in words.splitlines() if f"  {name}: " in line]
    assert "2 the-moon (broken)" in line
