"""One verdict by every door: what a result of an effect says in Python is what the command says."""

from __future__ import annotations

from random import Random
from typing import Final

import pytest

from camgeo.design.design import Design
from camgeo.scene.scene import load_scene
from tests.draws.doors import FIXTURES, contradictions, random_scene
from tests.effects.scenes import design

LOOSE: Final = FIXTURES / "effects" / "pressure_off_the_cam.toml"
"""Its follower leaves the cam."""


@pytest.mark.parametrize("name", ["effects/pressure_off_the_cam", "effects/valve_spring"])
def test_no_door_says_otherwise(name: str) -> None:
    path = FIXTURES / f"{name}.toml"
    assert list(contradictions(str(path), path.read_text("utf-8"))) == []


@pytest.mark.parametrize("seed", [2, 8])
def test_no_door_says_otherwise_of_a_random_scene(seed: int) -> None:
    assert list(contradictions(*random_scene(Random(seed)), page=False)) == []


def test_an_effect_that_the_scene_does_not_name_tells_it_too() -> None:
    named = Design(load_scene(LOOSE))
    others = {each: dict(table) for each, table in named.scene.values["effects"].items()}
    del others["contact-pressure"]
    alone = Design(named.scene.with_values({"effects": others}))
    assert "drive-torque" not in alone.scene.effects
    assert alone.effect("drive-torque").findings[0].name == "contact-lost"


def test_findings_are_made_once_and_only_when_looked_at() -> None:
    made = design("setzhub", "[effects.inertia]\nmass = 1.0\n[effects.drive-torque]")
    result = made.effect("drive-torque")
    judged = "findings.effects.drive-torque"
    assert judged not in [each.name for each in made.ledger.runs]
    assert made.effects.findings("drive-torque") == tuple(result.findings)
    assert [each.name for each in made.ledger.runs].count(judged) == 1
