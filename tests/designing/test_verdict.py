"""The one verdict on a scene that a page shows: never better than what is known of it."""

from __future__ import annotations

import random
from pathlib import Path
from typing import Any

import pytest

from camgeo.app.designing.children import Job
from camgeo.app.designing.faults import UNKNOWN, WAITING, scene_verdict
from camgeo.app.designing.work import run
from camgeo.scene.toml import template
from tests.designing.scenes import FIXTURES
from tests.draws.designer_header import case, edits, header, switched

SPRING = "\n[effects.spring]\nstiffness = 5\npreload = 200\n"
"""A compression spring, which on a rocker lacks its ends."""

SMALL = """camgeo = 1
name = "small"
[cam]
rotation = "ccw"
[follower]
kind = "translating-roller"
base_radius = 30
roller_radius = 5
[[motion]]
dwell = 120
[[motion]]
law = "polynomial-345"
span = 120
to = 5
[[motion]]
law = "polynomial-345"
span = 120
to = 0
[part]
bore = 10
"""

FAULT = {"key": "part.bore", "message": "is too large", "line": 3, "value": "90", "hint": ""}

KEPT = {"faults": [], "verdict": "2 findings: all limits are kept.", "findings": []}


def found(*severities: str) -> dict[str, Any]:
    return {**KEPT, "findings": [{"severity": each} for each in severities]}


@pytest.mark.parametrize(
    ("results", "severity", "sentence"),
    [
        ({}, WAITING, "Findings are being computed."),
        ({"curves": {"faults": []}}, WAITING, "Findings are being computed."),
        ({"findings": found("ok", "ok")}, "ok", KEPT["verdict"]),
        ({"findings": found("ok", "warning")}, "warning", KEPT["verdict"]),
        ({"findings": found("warning", "broken", "ok")}, "broken", KEPT["verdict"]),
        ({"findings": found("no-disc", "broken")}, "no-disc", KEPT["verdict"]),
        ({"curves": {"faults": [FAULT]}}, "invalid", "The scene has a fault."),
        ({"findings": {"faults": [FAULT]}}, "invalid", "The scene has a fault."),
        ({"curves": {"faults": [FAULT]}, "findings": {"faults": [FAULT]}}, "invalid",
         "The scene has a fault."),
        ({"findings": found("ok"), "build": {"faults": [FAULT]}}, "invalid",
         "There are no files: a fault."),
        ({"findings": {"faults": [], "refused": "findings: took longer than 60 s"}}, UNKNOWN,
         "There is no verdict: findings: took longer than 60 s."),
        ({"findings": found("ok"), "build": {"refused": "build: took too much memory"}}, UNKNOWN,
         "There is no verdict: build: took too much memory."),
    ],
)  # fmt: skip
def test_a_verdict_is_never_better_than_what_is_known(
    results: dict[str, Any], severity: str, sentence: str
) -> None:
    verdict = scene_verdict(results)
    assert (verdict["severity"], verdict["sentence"]) == (severity, sentence)
    assert bool(verdict["faults"]) == (severity == "invalid")


def test_what_only_the_findings_meet_is_at_its_key_and_line() -> None:
    text = template("oscillating-roller") + SPRING
    assert run(Job("curves", text))["faults"] == []
    (fault,) = header(text, Path("cam.toml"))["faults"]
    assert fault["key"] == "effects.spring.anchor"
    assert text.splitlines()[fault["line"] - 1] == "[effects.spring]"
    assert "needs anchor and attachment" in fault["message"]


def test_what_only_the_build_meets_is_told() -> None:
    built = run(Job("build", SMALL, arguments={"formats": ["step"]}))
    (fault,) = built["faults"]
    assert (fault["value"], fault["message"]) == ("step", "needs [part] thickness")
    assert scene_verdict({"findings": found("ok"), "build": built})["severity"] == "invalid"


def test_a_header_says_what_the_command_says(tmp_path: Path) -> None:
    path = FIXTURES / "refused" / "undercut_tappet.toml"
    found = case("tappet", path.read_text("utf-8"), tmp_path / "cam.toml")
    assert (found.severity, found.miss) == ("no-disc", "")


def test_headers_of_edited_scenes_say_what_the_command_says(tmp_path: Path) -> None:
    scene, file = tmp_path / "small.toml", tmp_path / "cam.toml"
    scene.write_text(SMALL, "utf-8")
    drawn = list(edits(4, random.Random(3), [scene], file))
    assert [each.miss for each in drawn] == [""] * 4
    assert len({each.severity for each in drawn}) > 1


@pytest.mark.parametrize(
    ("kind", "effect"),
    [
        ("oscillating-roller", "spring"),
        ("oscillating-roller", "spring-surge"),
        ("translating-roller", "spring-surge"),
    ],
)
def test_an_effect_that_is_switched_on_is_computed(kind: str, effect: str) -> None:
    changed = run(Job("change", template(kind), arguments={"effect": {"name": effect, "on": True}}))
    assert effect in changed["effects"]
    found = run(Job("findings", changed["text"], arguments={"machining": False}))
    assert found["faults"] == []
    assert not [each for each in found["findings"] if "not computed" in each["sentence"]]


def test_an_effect_that_this_follower_cannot_have_is_refused_with_the_reason(
    tmp_path: Path,
) -> None:
    text, file = template("knife-edge"), tmp_path / "cam.toml"
    asked = {"effect": {"name": "contact-pressure", "on": True}}
    assert "a knife edge" in run(Job("change", text, arguments=asked))["refused"]
    assert switched("knife-edge", text, "contact-pressure", file).severity == "refused"
