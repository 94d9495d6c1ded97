"""A conjugate pair in one piece, built, certified and verified by the commands."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from camgeo.app.cli.main import main

PAIR = Path(__file__).parents[2] / "fixtures" / "pairs" / "conjugate_pair.toml"

FORMATS = "dxf,stl,3mf,step"


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The scene, and its files beside it."""
    folder = tmp_path_factory.mktemp("pair")
    scene = Path(shutil.copy(PAIR, folder))
    told = ["build", str(scene), "-o", str(folder), "--only", FORMATS, "--tolerance", "0.01"]
    assert main(told) == 0
    return scene


def test_solids_are_of_the_pair_and_drawings_of_its_discs(built: Path) -> None:
    certificate = json.loads(built.with_name("certificate.json").read_text())
    names = {each["file"] for each in certificate["files"]}
    discs = {"conjugate_pair.dxf", "conjugate_pair-return.dxf"}
    assert names == discs | {f"conjugate_pair-pair.{end}" for end in ("stl", "3mf", "step")}
    (angle,) = (each for each in certificate["findings"] if each["name"] == "disc-angle")
    assert (angle["value"], angle["unit"], angle["part"]) == (0.0, "deg", "conjugate_pair-pair")
    parts = {each["part"] for each in certificate["findings"] if "part" in each}
    assert parts == {"conjugate_pair", "conjugate_pair-return", "conjugate_pair-pair"}


def test_the_files_are_verified(built: Path, capsys: pytest.CaptureFixture[str]) -> None:
    capsys.readouterr()
    solids = [str(built.with_name(f"conjugate_pair-pair.{end}")) for end in ("stl", "step")]
    assert main(["verify", *solids]) == 0
    assert capsys.readouterr().out.count(": pass") == 2


def test_a_build_tells_the_angle(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["build", str(PAIR), "-o", str(tmp_path), "--only", "csv"]) == 0
    shown = capsys.readouterr().out
    assert "both discs in one piece: the return disc at 0 deg to the main disc, below it" in shown
