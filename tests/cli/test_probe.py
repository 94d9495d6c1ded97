"""`camgeo probe`: the files it writes, and calls that are refused."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest

from camgeo.app.cli.main import main

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"

PLATE, GROOVE, PAIR = (
    str(SCENES / f"{name}.toml") for name in ("plate_translating", "groove", "conjugate_lever")
)

Capture = pytest.CaptureFixture[str]


def test_points_and_lift_curve_are_written_as_a_set(tmp_path: Path, capsys: Capture) -> None:
    points, lift = tmp_path / "p.csv", tmp_path / "l.csv"
    words = ["probe", PLATE, "--step", "5", "--ball", "1.5", "--tolerance", "0.02"]
    assert main([*words, "-o", str(points), "--lift", str(lift)]) == 0
    rows = list(csv.reader(points.read_text().splitlines()))
    assert rows[0] == [
        "phi [deg]", "x [mm]", "y [mm]", "nx", "ny", "s [mm]", "ball x [mm]", "ball y [mm]",
        "upper [mm]", "lower [mm]",
    ]  # fmt: skip
    assert [row[0] for row in rows[1:4]] == ["0.0", "5.0", "10.0"]
    assert len(rows) == 73
    assert lift.read_text().startswith("phi [deg],s [mm]\n0.0,0.0\n5.0,")
    out, err = capsys.readouterr()
    assert out.startswith("plate_translating: 72 points of the inner flank, every 5 deg")
    assert f"{points}: 72 rows" in err
    assert f"{lift}: lift curve, 72 rows" in err


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
