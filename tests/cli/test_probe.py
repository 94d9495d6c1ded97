"""`camgeo probe`: the files it writes, and calls that are refused."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from camgeo.app.cli.main import main

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"

PLATE, GROOVE, PAIR = (
    str(SCENES / f"{name}.toml") for name in ("plate_translating", "groove", "conjugate_lever")
)

Capture = pytest.CaptureFixture[str]


@pytest.mark.parametrize(
    ("scene", "names"),
    [(GROOVE, ["p-inner.csv", "p-outer.csv"]), (PAIR, ["p-return.csv", "p.csv"])],
)
def test_each_flank_has_a_file(scene: str, names: list[str], tmp_path: Path) -> None:
    assert main(["probe", scene, "--spacing", "20", "-o", str(tmp_path / "p.csv")]) == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == names


def test_the_document_sums_the_points_up(capsys: Capture) -> None:
    assert main(["probe", GROOVE, "--flank", "outer", "--step", "10", "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert [each["flank"] for each in record["flanks"]] == ["outer"]
