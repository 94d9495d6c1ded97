"""What is painted: of every scene, right or wrong, and small."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from camgeo.app.designing.children import Job, JobError
from camgeo.app.designing.work import Recent, run
from tests.answers.documents import FIXTURES
from tests.designing.scenes import CHOSEN, SETZHUB, TEXT, job, name_of

MOST = 150_000
"""Bytes of the pictures of a common cam."""


def written(found: dict[str, Any]) -> str:
    return json.dumps(found, allow_nan=False)


@pytest.mark.parametrize("path", CHOSEN, ids=name_of)
def test_every_scene_is_painted(path: Path) -> None:
    found = run(job("curves", path))
    assert json.loads(written(found)) == found
    assert found["faults"] == []
    assert [each["name"] for each in found["charts"]][:1] == ["motion"]
    assert all(each["sentence"] for each in found["charts"])
    assert found["animation"] is not None


def test_the_pictures_of_a_common_cam_are_small() -> None:
    found = run(job("curves", SETZHUB))
    pictures = {key: value for key, value in found.items() if key != "form"}
    assert len(json.dumps(pictures, separators=(",", ":"))) <= MOST


EDITS = {
    "nothing": [],
    "plan": [("to = 58.5", "to = 50")],
    "roller": [("roller_radius = 7.0", "roller_radius = 6")],
    "linkage": [("crank = 160.5", "crank = 161")],
    "limits": [("transmission_angle = 41", "transmission_angle = 50")],
    "two": [("speed = 90", "speed = 80"), ("bore = 16", "bore = 15")],
}


@pytest.mark.parametrize("edits", EDITS.values(), ids=EDITS)
def test_an_edit_is_painted_as_if_it_were_the_first(edits: list[tuple[str, str]]) -> None:
    text = TEXT
    after = text
    for one, other in edits:
        assert one in text
        after = after.replace(one, other)
    recent = Recent()
    run(Job("curves", text, "a.toml"), recent)
    edited = run(Job("curves", after, "a.toml"), recent)
    assert edited == run(Job("curves", after, "a.toml"))


CHANGES: list[dict[str, Any]] = [
    {"handle": "joint 3", "to": [180, 50], "step": 0.5},
    {"edits": {"follower.roller_radius": 6}},
    {"handle": "pivot", "to": [-41, -62]},
    {"segment": {"action": "split", "at": 0}},
    {"edits": {"follower.roller_radius": "wrong"}},
    {"edits": {"follower.roller_radius": 8, "name": "other"}},
]


def test_changes_one_after_another_are_painted_as_their_texts() -> None:
    recent = Recent()
    now = job("curves", SETZHUB)
    for arguments in CHANGES:
        found = run(replace(now, kind="change", arguments=arguments), recent)
        now = replace(now, text=found.pop("text"))
        assert found.pop("label")
        assert written(found) == written(run(now))


def test_what_moves_in_a_drag_is_as_in_the_whole() -> None:
    recent = Recent()
    now = job("curves", SETZHUB)
    shown = run(now, recent)
    drags: list[dict[str, Any]] = [
        {"handle": "joint 3", "to": [180, 50], "step": 0.5},
        {"handle": "pivot", "to": [-41, -62]},
        {"edits": {"follower.base_radius": 51}},
        {"handle": "joint 3", "to": [181, 51], "step": 0.5},
    ]
    told = []
    for arguments in drags:
        found = run(replace(now, kind="change", arguments={**arguments, "moving": True}), recent)
        assert list(found)[:4] == ["faults", "text", "moving", "label"]
        assert not {"form", "plan", "effects"} & found.keys()
        now = replace(now, text=found["text"])
        told.append([each["name"] for each in found["charts"]])
        newer = {each["name"]: each for each in found["charts"]}
        charts = [newer.get(each["name"], each) for each in shown["charts"]]
        whole = run(now)
        assert charts == whole["charts"]
        assert all(found[key] == whole[key] for key in ("animation", "handles", "name", "unit"))
        shown = {**shown, **found, "charts": charts}
    assert [("motion" in names) for names in told] == [True, False, False, True]
    wrong = {"edits": {"follower.roller_radius": "wrong"}, "moving": True}
    found = run(replace(now, kind="change", arguments=wrong), recent)
    assert "moving" not in found
    assert found["faults"]
    assert found["form"]


def test_a_change_that_cannot_be_made_leaves_the_text() -> None:
    text = TEXT
    for arguments in ({}, {"handle": "none", "to": [1, 2]}, {"edits": {}, "cure": 1}, {"cure": 9}):
        found = run(Job("change", text, arguments=arguments))
        assert found["text"] == text
        assert found["refused"]
        written(found)


def test_a_scene_with_faults_tells_them_with_their_lines() -> None:
    text = TEXT.replace("arm = 61.29", "arm = -1\nlenght = 3")
    recent = Recent()
    run(Job("curves", TEXT), recent)
    found = run(Job("curves", text), recent)
    lines = text.splitlines()
    told = {each["key"]: each for each in found["faults"]}
    assert {"follower.arm", "follower.lenght"} <= told.keys()
    assert lines[told["follower.arm"]["line"] - 1] == "arm = -1"
    assert "animation" not in found


@pytest.mark.parametrize("text", ["", "=", "\ud800", "camgeo = 1", "a = [[[", "x" * 3_000_000])
def test_a_text_that_is_no_scene_has_faults(text: str) -> None:
    recent = Recent()
    run(Job("curves", TEXT), recent)
    for memory in (None, recent):
        found = run(Job("curves", text), memory)
        assert found["faults"]
        written(found)


def test_a_file_that_a_scene_names_is_read_again(tmp_path: Path) -> None:
    for name in ("measured.toml", "measured.csv"):
        (tmp_path / name).write_bytes((FIXTURES / "scenes" / name).read_bytes())
    recent = Recent()
    asked = job("curves", tmp_path / "measured.toml")
    before = run(asked, recent)
    assert run(asked, recent) == before
    data = (tmp_path / "measured.csv").read_text("utf-8")
    (tmp_path / "measured.csv").write_text("not a table\n", "utf-8")
    assert run(asked, recent)["faults"]
    (tmp_path / "measured.csv").write_text(data, "utf-8")
    assert run(asked, recent) == before


def test_a_job_comes_out_as_it_went_in() -> None:
    sent = Job("change", 'name = "ü\ud800</script>"', "a.toml", "/tmp", {"edits": {"cam.speed": 3}})
    assert Job.from_json(sent.to_json()) == sent


@pytest.mark.parametrize(
    "arguments", [{"a": float("nan")}, {"a": object()}, {"a": "x" * 17_000_000}]
)
def test_a_job_of_other_data_or_too_large_is_refused(arguments: dict[str, Any]) -> None:
    with pytest.raises(JobError):
        Job("curves", "", "", "", arguments).to_json()
