"""`camgeo optimise`: options, files, messages."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Sequence
from pathlib import Path

import pytest

from camgeo.app.cli.main import main
from camgeo.design.design import Design
from camgeo.studies.optimise.optimise import Judge
from camgeo.studies.sweep.family import Point
from camgeo.studies.sweep.rows import Reading, Row
from tests.sweep.families import FIXTURES

Capture = pytest.CaptureFixture[str]

SCENE = FIXTURES / "scenes" / "setzhub.toml"

RANGE = ("--vary", "follower.base_radius=45:55")

TASK = (*RANGE, "--least", "diameter")


def call(*words: str) -> int:
    return main(["optimise", str(SCENE), *words])


@pytest.mark.long  # tests/cli/test_kept.py has scene, record and rows of such a search
def test_the_scene_of_the_best_design_and_the_record(tmp_path: Path, capsys: Capture) -> None:
    """The scene keeps its comments and its limits; the same seed writes the same bytes."""
    files = [tmp_path / f"best.{end}" for end in ("toml", "json", "csv")]
    words = [word for path in files for word in ("-o", str(path))]
    search = (*TASK, "--seed", "3", "--evaluations", "12")
    assert call(*search, *words) == 0
    out, err = capsys.readouterr()
    assert out.startswith("setzhub: least diameter\n")
    assert "ended: 12 designs were allowed" in out
    assert f"{files[0]}: the best design" in err
    record = json.loads(files[1].read_text())
    scene = tomllib.loads(files[0].read_text())
    radius = record["written"]["values"]["follower.base_radius"]
    assert scene["follower"]["base_radius"] == radius
    assert record["written"]["answers"]["diameter"] < 86.398  # the scene's own
    assert record["start"]["values"] == {"follower.base_radius": 50.199}
    before, after = SCENE.read_text(), files[0].read_text()
    assert after == before.replace("base_radius = 50.199", f"base_radius = {radius}")
    assert len(files[2].read_text().splitlines()) == record["evaluations"] + 1
    first = [path.read_bytes() for path in files]
    capsys.readouterr()
    assert call(*search, *words, "--force", "--json") == 0
    assert json.loads(capsys.readouterr().out) == record
    assert [path.read_bytes() for path in files] == first


def test_a_picture_of_the_front(tmp_path: Path, capsys: Capture) -> None:
    picture = tmp_path / "front.svg"
    words = ("--vary", "follower.base_radius=51,53", "--largest", "transmission-angle")
    assert call(*words, "--least", "diameter", "-o", str(picture)) == 0
    out, err = capsys.readouterr()
    assert "2 designs that no other beats:" in out
    assert "ended: all designs were tried" in out
    assert err == f"{picture}: picture\n"
    assert picture.read_bytes().startswith(b"<?xml")


@pytest.mark.long  # tests/answers/test_kept.py has such a search
def test_no_design_that_keeps_the_limits(tmp_path: Path, capsys: Capture) -> None:
    best = tmp_path / "best.toml"
    limits = ("--keep", "transmission-angle>=80", "--evaluations", "14")
    assert call(*TASK, *limits, "-o", str(best)) == 1
    out, err = capsys.readouterr()
    assert "no design that was tried keeps all limits; the nearest violates:" in out
    assert "  transmission-angle >= 80: it is 4" in out
    assert err == "nothing was written: no design that was tried keeps all limits\n"
    assert not best.exists()


def test_what_cannot_be_written_is_told_before_the_search(tmp_path: Path, capsys: Capture) -> None:
    table = tmp_path / "best.csv"
    table.write_text("someone's")
    assert call(*TASK, "-o", str(table)) == 2
    message = f"{table} would be overwritten; allow it with --force, or name others; nothing was"
    assert message in capsys.readouterr().err
    assert table.read_text() == "someone's"


def test_ctrl_c_gives_the_best_so_far(
    tmp_path: Path, capsys: Capture, monkeypatch: pytest.MonkeyPatch
) -> None:
    answers, judged = Judge.answers, list[Point]()

    def interrupted(judge: Judge, design: Design, point: Point, found: Sequence[Reading]) -> Row:
        judged.append(point)
        if len(judged) == 4:
            raise KeyboardInterrupt
        return answers(judge, design, point, found)

    monkeypatch.setattr(Judge, "answers", interrupted)
    best = tmp_path / "best.toml"
    assert call(*TASK, "-o", str(best)) == 130
    assert "ended: interrupted" in capsys.readouterr().out
    assert best.exists()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--vary", "follower.base_radis=1:2", "--least", "diameter"], "did you mean follower.ba"),
        (["--vary", "follower.base_radius=3:3", "--least", "diameter"], "is an empty range"),
        (["--least", "diameter"], "nothing varies"),
        ([*RANGE], "names no objective"),
        ([*RANGE, "--least", "diametre"], 'did you mean "diameter"?'),
        ([*TASK, "--keep", "transmission-angle=50"], "must be NAME>=NUMBER or NAME<=NUMBER"),
        ([*TASK, "--evaluations", "0"], "must be from 1 to 1,000,000"),
        ([*TASK, "--evaluations", "1000000000"], "must be from 1 to 1,000,000"),
        ([*TASK, "--seed", "-1"], "must be a whole number from 0"),
        ([*TASK, "--seconds", "0"], "must be above 0"),
        ([*TASK, "--workers", "1000"], "workers = 1000: must be from 1 to 512"),
        ([*TASK, "-o", "best.xls"], "'best.xls' must end in one of .toml"),
        ([*TASK, "-o", "a.toml", "-o", "b/a.json"], "must name different files in one folder"),
    ],
)
def test_wrong_calls(words: list[str], message: str, capsys: Capture) -> None:
    try:
        code: object = call(*words)
    except SystemExit as end:
        code = end.code
    assert code == 2
    assert message in capsys.readouterr().err


def test_a_scene_beside_the_files_that_it_names(tmp_path: Path, capsys: Capture) -> None:
    scene = FIXTURES / "scenes" / "measured.toml"
    with pytest.raises(SystemExit) as end:
        main(["optimise", str(scene), *TASK, "-o", str(tmp_path / "best.toml")])
    assert end.value.code == 2
    assert "must be in the folder of SCENE" in capsys.readouterr().err
