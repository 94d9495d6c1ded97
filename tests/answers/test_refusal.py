"""The reason why there is no answer, as text and as JSON."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from camgeo.app.answers.answer import text
from camgeo.app.answers.refusal import Refusal, refusal
from camgeo.app.cli.main import main
from camgeo.errors import (
    CamgeoError,
    Fault,
    GeometryError,
    SceneError,
    ToleranceError,
    UndercutError,
    UnsafeError,
)
from tests.answers.documents import document, validator
from tests.cli.test_bad_input import BAD

Capture = pytest.CaptureFixture[str]

ERRORS: list[tuple[CamgeoError, int]] = [
    (SceneError([Fault("a.b", "1", "is wrong", "try 2", 3), Fault("", "", "is odd")], "x.toml"), 2),
    (GeometryError("cannot close", "linkage", "7"), 2),
    (UndercutError("has a cusp"), 1),
    (UnsafeError("a core comes loose"), 1),
    (ToleranceError("arcs cannot follow", 0.1, 0.2), 2),
]


@pytest.mark.parametrize(("error", "code"), ERRORS, ids=lambda each: type(each).__name__)
def test_text_and_document_are_of_one_result(error: CamgeoError, code: int) -> None:
    found = refusal(error)
    assert found.exit_code == code
    reported = document(found)
    assert reported["error"] == type(error).__name__
    assert text(found) == f"camgeo: {reported['message']}"
    for fault in reported["faults"]:
        assert fault["message"] in text(found)


@pytest.mark.parametrize("bad", BAD)
def test_a_wrong_scene_is_reported_as_json_too(bad: str, tmp_path: Path, capsys: Capture) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text(BAD[bad][0], encoding="utf-8")
    assert main(["check", str(scene)]) == 2
    words = capsys.readouterr().err
    assert main(["check", str(scene), "--json"]) == 2
    out, err = capsys.readouterr()
    assert err == ""
    reported = json.loads(out)
    validator(Refusal.__module__).validate(reported)
    assert words == f"camgeo: {reported['message']}\n"
    assert reported["file"] in {str(scene), ""}


@pytest.mark.parametrize(
    "command", ["accuracy", "build", "check", "explain", "replay", "size", "table"]
)
def test_each_command_reports_it(command: str, tmp_path: Path, capsys: Capture) -> None:
    assert main([command, str(tmp_path / "none.toml"), "--json"]) == 2
    reported = json.loads(capsys.readouterr().out)
    assert reported["faults"][0]["message"] == "there is no such file"
