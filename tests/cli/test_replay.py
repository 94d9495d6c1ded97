"""`camgeo replay` on the real outline, on a drawing and on a table of vertices."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import camgeo
from camgeo.app.cli.main import main, parser
from camgeo.errors import CamgeoError

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"

SETZHUB = str(SCENES / "setzhub.toml")

PLATE = str(SCENES / "plate_translating.toml")

Capture = pytest.CaptureFixture[str]


def replay(*words: str) -> int:
    arguments = parser(("replay",)).parse_args(["replay", *words])
    code: int = arguments.run(arguments)
    return code


def document(capsys: Capture, *words: str) -> dict[str, Any]:
    assert replay(*words, "--json") == 0
    record: dict[str, Any] = json.loads(capsys.readouterr().out)
    (disc,) = record["discs"]
    return {**record, **disc}


@pytest.fixture(scope="module")
def drawings(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("drawings")
    for scene in ("plate_translating", "groove"):
        design = camgeo.load(SCENES / f"{scene}.toml")
        design.write(folder, formats=["dxf", "cut-svg"], force=True)
    return folder


def test_a_drawing(drawings: Path, capsys: Capture) -> None:
    record = document(capsys, PLATE, str(drawings / "plate_translating.dxf"))
    # The scene's tolerance is 1 um across the flank; its steepest place makes less than 2 of it.
    assert 0.0 < abs(record["lift_error"]["value"]) < 2e-3
    assert 0.01 < record["ripple"]["value"] < 0.5
    assert record["shocks"]["count"] == 0


def test_a_drawing_for_cutting_is_the_same(drawings: Path, capsys: Capture) -> None:
    """As SVG at true size, of the same arcs."""
    names = ("plate_translating.dxf", "plate_translating.cut.svg")
    found = [document(capsys, PLATE, str(drawings / name)) for name in names]
    for key in ("lift_error", "ripple"):
        first, second = (record[key]["value"] for record in found)
        assert second == pytest.approx(first, rel=1e-6)


@pytest.mark.parametrize("side", ["inner", "outer"])
def test_both_flanks_of_a_groove(drawings: Path, capsys: Capture, side: str) -> None:
    groove = str(SCENES / "groove.toml")
    record = document(capsys, groove, str(drawings / "groove.dxf"), "--flank", side)
    assert record["flank"] == side
    # The flank's own contour, not rim, bore or the other flank: 1 um over an arm of 80 mm.
    assert abs(record["lift_error"]["value"]) < 2e-3
    # It is drawn by straight pieces, so it rattles.
    assert record["ripple"]["value"] > 1.0


def points_of(scene: str, count: int) -> str:
    phi = np.linspace(0.0, 2.0 * math.pi, count, endpoint=False)
    rows = camgeo.load(scene).disc.pictured.curve("inner", phi).tolist()
    return "x,y\n" + "".join(f"{x!r},{y!r}\n" for x, y in rows)


def test_points_from_a_table(tmp_path: Path, capsys: Capture) -> None:
    file = tmp_path / "points.csv"
    file.write_text(points_of(PLATE, 720))
    record = document(capsys, PLATE, str(file))
    # The chord's sagitta, 60 mm (pi/720)^2/2 = 0.6 um, and no tolerance would cure the ripple.
    assert abs(record["lift_error"]["value"]) < 2e-3
    assert record["ripple"]["value"] > 5.0
    inch = document(capsys, PLATE, str(file), "--unit", "inch", "--step", "5")
    assert inch["lift_error"]["value"] > 1000.0


def test_wrong_files(tmp_path: Path) -> None:
    broken = tmp_path / "broken.csv"
    broken.write_text("0,0\n1,a\n")
    with pytest.raises(CamgeoError, match=r"broken.csv, line 2: 'a': not a number"):
        replay(PLATE, str(broken))
    aside = tmp_path / "aside.csv"
    aside.write_text("100,100\n110,100\n110,110\n")
    with pytest.raises(CamgeoError, match=r"does not go round the cam axis, .* say with --origin"):
        replay(PLATE, str(aside))


def test_a_contour_that_crosses_itself_is_refused(tmp_path: Path, capsys: Capture) -> None:
    eight = tmp_path / "eight.csv"
    eight.write_text("x,y\n60,-50\n60,50\n-40,-30\n-60,30\n", encoding="utf-8")
    assert main(["replay", SETZHUB, str(eight)]) == 2
    assert "crosses itself" in capsys.readouterr().err
