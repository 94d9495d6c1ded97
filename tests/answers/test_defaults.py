"""What is not stated in Python is what is not stated on the command line."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from camgeo.app.answers.answer import Answer
from camgeo.app.answers.compare import compare
from camgeo.app.answers.inspect import inspect
from camgeo.app.answers.laws import laws_of_task
from camgeo.app.answers.probe import probe
from camgeo.app.answers.replay import replay
from camgeo.app.answers.setup import setup_sheet
from camgeo.app.answers.size import size
from camgeo.app.answers.slotted_lever import slotted_lever
from camgeo.app.cli.main import main
from camgeo.design.design import Design
from camgeo.scene.scene import load_scene
from tests.answers.documents import FIXTURES, document

INCH = "scenes/inch.toml"
TAPPET = "scenes/tappet.toml"


def design(name: str) -> Design:
    return Design(load_scene(FIXTURES / name))


CASES: dict[str, Callable[[Path], Answer]] = {
    f"probe {INCH}": lambda _: probe(design(INCH)),
    f"replay {INCH}": lambda _: replay(design(INCH)),
    "inspect scenes/groove.toml {}": lambda points: inspect(design("scenes/groove.toml"), points),
    f"size {TAPPET}": lambda _: size(design(TAPPET)),
    f"setup {INCH}": lambda _: setup_sheet(design(INCH)),
    f"compare {INCH} {TAPPET} --ask diameter": lambda _: compare(
        [("inch", design(INCH)), ("tappet", design(TAPPET))], ["diameter"]
    ),
    "laws": lambda _: laws_of_task("R-R", {}),
    "slotted-lever --frame 50 --crank 80 --speed 90": lambda _: slotted_lever(50, 90, crank=80),
}
"""Calls without options, and the same in Python; {} is a file of measured points."""


@pytest.mark.parametrize("call", CASES)
def test_defaults_are_those_of_the_command(
    call: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(FIXTURES)
    points = tmp_path / "points-outer.csv"
    if "{}" in call:
        words = ["probe", "scenes/groove.toml", "--flank", "outer", "--step", "9"]
        assert main([*words, "-o", str(tmp_path / "points.csv")]) == 0
        capsys.readouterr()
    code = main([*call.replace("{}", str(points)).split(), "--json"])
    found = CASES[call](points)
    assert json.loads(capsys.readouterr().out) == document(found)
    assert code == found.exit_code
