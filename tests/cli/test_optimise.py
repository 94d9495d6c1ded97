"""`camgeo optimise`: options, files, messages."""

from __future__ import annotations

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


def test_a_picture_of_the_front(tmp_path: Path, capsys: Capture) -> None:
    picture = tmp_path / "front.svg"
    words = ("--vary", "follower.base_radius=51,53", "--largest", "transmission-angle")
    assert call(*words, "--least", "diameter", "-o", str(picture)) == 0
    out, err = capsys.readouterr()
    assert "2 designs that no other beats:" in out
    assert "ended: all designs were tried" in out
    assert err == f"{picture}: picture\n"
    assert picture.read_bytes().startswith(b"<?xml")


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
