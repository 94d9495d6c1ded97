"""`camgeo optimise`: options, files, messages."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pytest

from camgeo.design.design import Design
from camgeo.studies.optimise.optimise import Judge
from camgeo.studies.sweep.family import Point
from camgeo.studies.sweep.rows import DesignReading, DesignRow
from tests.cli.calling import called
from tests.sweep.families import FIXTURES

SCENE = FIXTURES / "scenes" / "setzhub.toml"

TASK = ("optimise", SCENE, "--vary", "follower.base_radius=45:55", "--least", "diameter")


def test_what_cannot_be_written_is_told_before_the_search(tmp_path: Path) -> None:
    table = tmp_path / "best.csv"
    table.write_text("someone's")
    found = called(*TASK, "-o", table)
    assert found.code == 2
    message = f"{table} would be overwritten; allow that with --force, or name other files; nothing"
    assert message in found.err
    assert table.read_text() == "someone's"


def test_ctrl_c_gives_the_best_so_far(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    answers, judged = Judge.answers, list[Point]()

    def interrupted(
        judge: Judge, design: Design, point: Point, found: Sequence[DesignReading]
    ) -> DesignRow:
        judged.append(point)
        if len(judged) == 4:
            raise KeyboardInterrupt
        return answers(judge, design, point, found)

    monkeypatch.setattr(Judge, "answers", interrupted)
    best = tmp_path / "best.toml"
    ended = called(*TASK, "-o", best)
    assert ended.code == 130
    assert "ended: interrupted" in ended.out
    assert best.exists()
