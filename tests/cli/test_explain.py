"""`camgeo explain`: what was computed, for what, how long it took, and what was not."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from camgeo.app.answers.explain import GOALS, quantities
from camgeo.app.cli.main import main
from camgeo.dynamics.effects.registry import EFFECTS
from tests.effects.scenes import SCENES

SCENE = SCENES / "plate_translating.toml"
Capture = pytest.CaptureFixture[str]


@pytest.fixture
def sprung(tmp_path: Path) -> str:
    """A scene that names an effect which needs others."""
    path = tmp_path / "sprung.toml"
    tables = "[effects.spring]\nstiffness = 4\npreload = 80\n[effects.drive-torque]\n"
    path.write_text(SCENE.read_text("utf-8") + tables, "utf-8")
    return str(path)


def explained(capsys: Capture, *arguments: str) -> dict[str, Any]:
    assert main(["explain", *arguments, "--json"]) == 0
    found: dict[str, Any] = json.loads(capsys.readouterr().out)
    return found


@pytest.mark.parametrize("goal", GOALS)
def test_what_ran_and_what_did_not_are_all_there_is(goal: str, capsys: Capture) -> None:
    document = explained(capsys, str(SCENE), goal)
    ran = {each["name"] for each in document["computed"]}
    alone = set(document["left_alone"])
    everything = set(quantities())
    assert {f"effects.{name}" for name in EFFECTS} <= everything
    assert not ran & alone
    assert everything <= ran | alone
    assert alone <= everything


def test_effects_stand_below_what_asked_for_them(sprung: str, capsys: Capture) -> None:
    document = explained(capsys, sprung)
    runs = {each["name"]: each for each in document["computed"]}
    assert runs["effects.drive-torque"]["asked_by"] == ""
    assert runs["effects.contact-force"]["asked_by"] == "effects.drive-torque"
    assert document["reasons"] == {
        "effects.contact-force": "needed; from spring",
        "effects.drive-torque": "named by the scene; from contact-force",
        "effects.spring": "named by the scene",
    }
    assert "effects.inertia" not in runs


def test_nothing_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    monkeypatch.chdir(tmp_path)
    document = explained(capsys, str(SCENE), "build")
    assert list(tmp_path.iterdir()) == []
    assert any(each["name"] == "dxf file" for each in document["computed"])
