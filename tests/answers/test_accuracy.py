"""The result of `camgeo accuracy`, rendered as text, as JSON and as a picture."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from camgeo.app.answers.accuracy import accuracy
from camgeo.app.answers.answer import figure, text
from camgeo.design.design import Design
from camgeo.scene.scene import load_scene
from camgeo.studies.accuracy import survey as surveys
from tests.answers.documents import FIXTURES, SCENES, document
from tests.cli.test_accuracy import made_up


@pytest.mark.long  # tests/answers/test_kept.py validates those of each kind
@pytest.mark.parametrize("scene", SCENES, ids=lambda path: path.stem)
def test_documents_are_what_their_schema_says(scene: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a made-up survey, in the units of every scene."""
    monkeypatch.setattr(surveys, "survey", lambda *_, **__: made_up())
    answer = accuracy(Design(load_scene(scene)))
    reported = document(answer)
    assert [row["bytes"] for row in reported["tables"]] == [249_114]
    assert f"error [{reported['tables'][0]['unit']}]" in text(answer)
    survey = replace(answer.survey, solids=(replace(made_up().solids[1], fault="it has gone"),))
    changed = replace(answer, survey=survey)
    assert document(changed)["solids"][0]["fault"] == "it has gone"
    assert "it has gone" in text(changed)
    assert "it has gone" not in text(answer)
    assert figure(answer).panels


@pytest.mark.long  # tests/answers/test_kept.py has the same answer whole
def test_a_document_of_what_is_measured() -> None:
    found = accuracy(Design(load_scene(FIXTURES / "scenes" / "inch.toml")), (0.1,), ripple=True)
    reported = document(found)
    assert {row["contour"] for row in reported["contours"]} == {"polyline", "arcs", "spline"}
    assert reported["knee"]["tolerance_mm"] == 0.1
    assert text(found).endswith(f"advice: {reported['advice']}")
