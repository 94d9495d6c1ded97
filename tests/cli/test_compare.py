"""`camgeo compare`: scenes, files, messages."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from camgeo.app.answers.compare import labels_of
from camgeo.app.cli.main import main
from tests.sweep.families import FIXTURES, SETZHUB

Capture = pytest.CaptureFixture[str]

SCENE = str(FIXTURES / "scenes" / "setzhub.toml")


def test_a_table_and_a_picture(tmp_path: Path, capsys: Capture) -> None:
    other, picture = tmp_path / "wide.toml", tmp_path / "both.svg"
    other.write_text(SETZHUB.with_values({"follower.base_radius": 55}).to_toml())
    ask = ["--ask", "transmission-angle,peak:a"]
    assert main(["compare", SCENE, str(other), *ask, "-o", str(picture)]) == 0
    out, err = capsys.readouterr()
    assert out.splitlines()[0].split() == ["setzhub", "wide"]
    assert err == f"{picture}: flanks, motion, acceleration, mu\n"
    assert picture.read_bytes().startswith(b"<?xml")
    assert main(["compare", SCENE, str(other), *ask, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert [each["label"] for each in found["designs"]] == ["setzhub", "wide"]


def test_labels_tell_designs_apart() -> None:
    assert labels_of(["a/x.toml", "b/y.toml"]) == ["x", "y"]
    assert labels_of(["a/x.toml", "b/x.toml"]) == ["a/x.toml", "b/x.toml"]
