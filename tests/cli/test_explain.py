"""`camgeo explain`: what was computed, for what, how long it took, and what was not."""

from __future__ import annotations

from pathlib import Path

import pytest

from camgeo.app.answers.explain import GOALS, quantities
from camgeo.dynamics.effects.registry import EFFECTS
from tests.cli.calling import called, changed
from tests.effects.scenes import SCENES

SCENE = SCENES / "plate_translating.toml"


@pytest.mark.parametrize("goal", GOALS)
def test_what_ran_and_what_did_not_are_all_there_is(goal: str) -> None:
    document = called("explain", SCENE, goal, "--json").document
    ran = {each["name"] for each in document["computed"]}
    alone = set(document["left_alone"])
    everything = set(quantities())
    assert {f"effects.{name}" for name in EFFECTS} <= everything
    assert not ran & alone
    assert everything <= ran | alone
    assert alone <= everything


def test_effects_stand_below_what_asked_for_them(tmp_path: Path) -> None:
    tables = "[effects.spring]\nstiffness = 4\npreload = 80\n[effects.drive-torque]\n"
    scene = changed(SCENE, tmp_path / "sprung.toml", more=tables)
    document = called("explain", scene, "--json").document
    runs = {each["name"]: each for each in document["computed"]}
    assert runs["effects.drive-torque"]["asked_by"] == ""
    assert runs["effects.contact-force"]["asked_by"] == "effects.drive-torque"
    assert document["reasons"] == {
        "effects.contact-force": "needed; from spring",
        "effects.drive-torque": "named by the scene; from contact-force",
        "effects.spring": "named by the scene",
    }
    assert "effects.inertia" not in runs


def test_nothing_is_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    document = called("explain", SCENE, "build", "--json").document
    assert list(tmp_path.iterdir()) == []
    assert any(each["name"] == "dxf file" for each in document["computed"])
