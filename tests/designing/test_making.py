"""What is made of a scene: the bytes of the command line, solids, the smallest cam, offers."""

from __future__ import annotations

import base64
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camgeo.app.designing.children import Job, JobError
from camgeo.app.designing.work import Recent, run
from camgeo.design.design import Design
from camgeo.dynamics.effects.registry import effect_names
from camgeo.scene.scene import load_scene, parse_scene
from camgeo.scene.toml import TEMPLATE_KINDS, template
from tests.designing.scenes import FIXTURES, SETZHUB, TEXT, job

SCENES = FIXTURES / "scenes"
ROLLER = template("translating-roller")


@pytest.mark.parametrize("name", ["setzhub", "conjugate_lever"])
def test_files_are_those_of_the_command_line(name: str, tmp_path: Path) -> None:
    formats = ["dxf", "csv", "stl"]
    found = run(job("build", SCENES / f"{name}.toml", formats=formats))
    Design(load_scene(SCENES / f"{name}.toml")).write(tmp_path, formats)
    made = {each["name"]: base64.b64decode(each["bytes"]) for each in found["files"]}
    assert made == {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    assert found["certificate"] == json.loads(made["certificate.json"])
    for each in found["files"]:
        assert each["size"] == len(made[each["name"]])


def test_a_cam_without_outline_has_no_files_but_findings() -> None:
    path = FIXTURES / "refused" / "undercut_tappet.toml"
    found = run(Job("build", path.read_text("utf-8")))
    assert found["files"] == []
    assert found["findings"]


def test_solids_are_triangles_within_the_disc() -> None:
    path = SCENES / "setzhub.toml"
    (found,) = run(job("solid", SETZHUB))["solids"]
    places = np.frombuffer(base64.b64decode(found["places"]), "<f4").reshape(-1, 3, 3)
    scene = load_scene(path)
    assert scene.follower is not None
    radius = np.hypot(places[..., 0], places[..., 1])
    assert np.all(np.isfinite(places))
    assert 0.5 * scene.follower.base_radius < np.max(radius) < 3.0 * scene.follower.base_radius
    assert np.ptp(places[..., 2]) == pytest.approx(12.0)


def test_the_smallest_cam_keeps_its_requirement() -> None:
    found = run(job("size", SETZHUB))
    assert found["sentence"].startswith("The smallest base radius is ")
    smaller = parse_scene(TEXT).with_values(found["edits"])
    assert smaller.follower is not None
    (own,) = (each for each in found["sizes"] if each["name"] == "smallest")
    assert smaller.follower.base_radius == pytest.approx(own["base_radius"])
    broken = [each for each in Design(smaller).findings if each.severity not in ("ok", "warning")]
    assert broken == []
    applied = run(Job("change", TEXT, arguments={"edits": found["edits"]}), Recent())
    assert applied["faults"] == []


def test_what_is_required_of_the_smallest_cam_can_be_stated() -> None:
    one, other = (run(job("size", SETZHUB, transmission_angle=each)) for each in (42, 50.5))
    radii = [each["sizes"][-1]["base_radius"] for each in (one, other)]
    assert radii[0] < radii[1]


def test_what_changes_with_the_smallest_size_is_said() -> None:
    """A rocker's pivot or arm, which its table of sizes does not show."""
    found = run(Job("size", template("oscillating-roller")))
    others = found["edits"].keys() - {"follower.base_radius"}
    assert others
    assert all(f"{key} = " in found["sentence"] for key in others)


@pytest.mark.parametrize(
    ("kind", "arguments"),
    [("size", {"arm": [1]}), ("size", {"arm": 3}), ("size", {"radius_ratio": "x"}),
     ("size", {"transmission_angle": 10**400}), ("size", {"arm": [None, 1]}),
     ("build", {"formats": "dxf"}), ("build", {"formats": [1]}), ("laws", {}),
     *(("findings", {"machining": value}) for value in (1, "yes", [True], None)),
     ("laws", {"segment": -1}), ("laws", {"segment": 99}), ("laws", {"segment": True})],
)  # fmt: skip
def test_wrong_arguments_are_told(kind: str, arguments: dict[str, Any]) -> None:
    with pytest.raises(JobError):
        run(Job(kind, ROLLER, arguments=arguments))


def offered(text: str = TEXT) -> dict[str, dict[str, Any]]:
    """The laws for the second segment of a scene."""
    found = run(Job("laws", text, arguments={"segment": 1}))
    json.dumps(found, allow_nan=False)
    return {each["name"]: each for each in found["laws"]}


def facts(name: str, text: str = TEXT) -> dict[str, str]:
    return {each["name"]: each["value"] for each in offered(text)[name]["facts"]}


def test_every_law_offered_makes_a_valid_scene() -> None:
    assert run(Job("laws", TEXT, arguments={"segment": 1}))["law"] == "polynomial-345"
    assert {"polynomial-345", "modified-sine", "straight-line"} <= offered().keys()
    for name, each in offered().items():
        assert parse_scene(TEXT).with_values(each["edits"]).values["motion"][1]["law"] == name
        assert each["facts"]


def test_laws_are_shown_for_the_task_that_they_have_in_the_plan() -> None:
    """A straight line from rest to rest is a shock at both ends; within a rise it is none."""
    assert facts("straight-line") == {"C_v": "1", "C_a": "∞", "C_j": "∞"}
    moves = (("polynomial-5", 60, 4), ("straight-line", 60, 10), ("polynomial-5", 60, 14))
    head, *_ = TEXT.partition("[[motion]]")
    text = head + "".join(
        f'[[motion]]\nlaw = "{law}"\nspan = {span}\nto = {to}\n'
        for law, span, to in (*moves, ("polynomial-5", 180, 0))
    )
    assert facts("straight-line", text) == {"C_v": "1", "C_a": "0", "C_j": "0"}


def test_one_motion_has_one_pair_of_extremes() -> None:
    """With jerks 60 (1 - 6 z + 6 z^2), and 840 (z - 6 z^2 + 10 z^3 - 5 z^4)."""
    assert facts("polynomial-345") == facts("polynomial-5")
    assert facts("polynomial-345")["C_j"] == "−30 to 60"
    assert facts("polynomial-4567") == facts("polynomial-7")
    assert facts("polynomial-4567")["C_j"] == "−52.5 to 42"


def test_parameters_of_other_laws_are_dropped_with_them() -> None:
    text = TEXT.replace('law = "polynomial-345"', 'law = "scca"\ncurved = 0.5', 1)
    scene, found = parse_scene(text), offered(text)
    for name, stays in (("scca", True), ("modified-sine", False)):
        move = scene.with_values(found[name]["edits"]).values["motion"][1]
        assert ("curved" in move) == stays


def test_laws_are_offered_for_a_segment_whose_law_is_wrong() -> None:
    text = TEXT.replace('law = "polynomial-345"', 'law = "sine-straight"', 1)
    assert run(Job("curves", text))["faults"]
    assert "polynomial-345" in offered(text)
    assert "sine-straight" not in offered(text)


def test_a_dwell_has_no_law() -> None:
    with pytest.raises(JobError, match="dwell"):
        run(job("laws", SETZHUB, segment=0))


def test_all_templates_and_effects_are_offered() -> None:
    templates = run(Job("templates"))["templates"]
    assert [each["name"] for each in templates] == list(TEMPLATE_KINDS)
    assert run(Job("curves", templates[0]["text"]))["faults"] == []
    effects = run(Job("effects"))["effects"]
    assert [each["name"] for each in effects] == list(effect_names())
    assert all(each["sentence"] for each in effects)
