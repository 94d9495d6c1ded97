"""`camgeo inspect`: reports, files, exit codes, and calls that are refused."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest

from camgeo.app.cli.main import main

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"

PLATE = str(SCENES / "plate_translating.toml")

Capture = pytest.CaptureFixture[str]


@pytest.fixture(scope="module")
def points(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("probed") / "points.csv"
    assert main(["probe", PLATE, "--step", "4", "--ball", "2", "-o", str(path)]) == 0
    return path


def moved(points: Path, path: Path, by: float) -> str:
    """The points as a file with decimal commas, shifted along x by `by` [mm]."""
    rows = list(csv.DictReader(points.read_text().splitlines()))
    lines = [f"{float(row['x [mm]']) + by!r};{row['y [mm]']}" for row in rows]
    path.write_text("x;y\n" + "\n".join(lines).replace(".", ","))
    return str(path)


def test_eccentricity_shows_by_datum_and_as_a_shift(
    points: Path, tmp_path: Path, capsys: Capture
) -> None:
    path = moved(points, tmp_path / "moved.csv", 0.005)
    assert main(["inspect", PLATE, path, "--tolerance", "0.009"]) == 1
    assert "BROKEN  profile" in capsys.readouterr().out
    assert main(["inspect", PLATE, path, "--align", "free", "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert record["shift_mm"] == pytest.approx([0.005, 0.0], abs=1e-9)
    assert record["align"] == "free"
    assert record["deviation"]["profile_mm"] < 1e-9


def test_a_table_and_a_picture_are_written(points: Path, tmp_path: Path) -> None:
    for name in ("t.csv", "p.svg"):
        assert main(["inspect", PLATE, str(points), "-o", str(tmp_path / name)]) == 0
    head, *rows = list(csv.reader((tmp_path / "t.csv").read_text().splitlines()))
    assert head[-2:] == ["deviation [mm]", "lift error [mm]"]
    assert len(rows) == 90
    assert (tmp_path / "p.svg").read_bytes().startswith(b"<?xml")


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (None, "MEASURED = "),
        (b"1,2\n", "p.csv, line 1: 1 row of numbers; allowed: 12 to 50,000"),
        (b"x;y;nx;ny\n" + b"1,5;2;0;0\n" * 12, "p.csv, line 13: fewer than 12 different points"),
        (bytes(16_000_001), "at most 16,000,000 are allowed"),
    ],
)
def test_wrong_files_are_refused(
    content: bytes | None, message: str, tmp_path: Path, capsys: Capture
) -> None:
    path = tmp_path / "p.csv"
    if content is not None:
        path.write_bytes(content)
    assert main(["inspect", PLATE, str(path)]) == 2
    assert message in capsys.readouterr().err
