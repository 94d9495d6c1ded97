"""`camgeo replay` on the real outline, on a drawing and on a table of vertices."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

import camgeo
from tests.cli.calling import SCENES, called

PLATE = SCENES / "plate_translating.toml"


def document(*words: object) -> dict[str, Any]:
    record = called("replay", *words, "--json").document
    (disc,) = record["discs"]
    return {**record, **disc}


@pytest.fixture(scope="module")
def drawings(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("drawings")
    for scene in ("plate_translating", "groove"):
        design = camgeo.load(SCENES / f"{scene}.toml")
        design.write(folder, formats=["dxf", "cut-svg"], force=True)
    return folder


def test_a_drawing_and_the_same_for_cutting(drawings: Path) -> None:
    """As SVG at true size, of the same arcs."""
    record, other = (
        document(PLATE, drawings / f"plate_translating.{kind}") for kind in ("dxf", "cut.svg")
    )
    # The scene's tolerance is 1 um across the flank; its steepest place makes less than 2 of it.
    assert 0.0 < abs(record["lift_error"]["value"]) < 2e-3
    assert 0.01 < record["ripple"]["value"] < 0.5
    assert record["shocks"]["count"] == 0
    for key in ("lift_error", "ripple"):
        assert other[key]["value"] == pytest.approx(record[key]["value"], rel=1e-6)


@pytest.mark.parametrize("side", ["inner", "outer"])
def test_both_flanks_of_a_groove(drawings: Path, side: str) -> None:
    record = document(SCENES / "groove.toml", drawings / "groove.dxf", "--flank", side)
    assert record["flank"] == side
    # The flank's own contour, not rim, bore or the other flank: 1 um over an arm of 80 mm.
    assert abs(record["lift_error"]["value"]) < 2e-3
    # It is drawn by straight pieces, so it rattles.
    assert record["ripple"]["value"] > 1.0


@pytest.mark.parametrize(
    ("vertices", "message"),
    [
        ("0,0\n1,a\n", r"own.csv, line 2: 'a': not a number"),
        ("100,100\n110,100\n110,110\n", "not go round the cam axis, .* say with --origin"),
        ("x,y\n60,-50\n60,50\n-40,-30\n-60,30\n", "crosses itself"),
    ],
)
def test_wrong_files_are_refused(vertices: str, message: str, tmp_path: Path) -> None:
    file = tmp_path / "own.csv"
    file.write_text(vertices)
    found = called("replay", PLATE, file)
    assert found.code == 2
    assert re.search(message, found.err)
