"""`camgeo sweep`: options, files, messages."""

from __future__ import annotations

import json
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from camgeo.app.cli.main import main
from camgeo.studies.sweep import rows
from camgeo.studies.sweep.rows import rows_of
from tests.sweep.families import FIXTURES, LAWS, RADII

Capture = pytest.CaptureFixture[str]

SCENE = str(FIXTURES / "scenes" / "setzhub.toml")

FAMILY = ("--vary", RADII, "--vary", LAWS, "--ask", "laws,largest-acceleration")


def call(*words: str) -> int:
    return main(["sweep", SCENE, *words])


def test_a_store_and_other_files(tmp_path: Path, capsys: Capture) -> None:
    store, table, document = (tmp_path / f"runs{end}" for end in (".sqlite", ".csv", ".json"))
    words = [word for path in (store, table, document) for word in ("-o", str(path))]
    assert call(*FAMILY, *words) == 0
    out, err = capsys.readouterr()
    assert out.startswith("setzhub: 8 designs\n")
    assert err.splitlines() == [f"{path}: 8 rows" for path in (store, table, document)]
    assert len(table.read_text().splitlines()) == 9
    assert json.loads(document.read_text())["count"] == 8
    with closing(sqlite3.connect(store)) as database:
        assert database.execute("SELECT count(*) FROM designs").fetchone() == (8,)
    assert call(*FAMILY, *words) == 2
    assert "exists: resume it" in capsys.readouterr().err
    assert call(*FAMILY, "-o", str(store), "--resume", "--json") == 0
    out, err = capsys.readouterr()
    assert json.loads(out) == json.loads(document.read_text())
    assert err == f"{store}: 8 rows, 8 of them known before\n"
    assert call(*FAMILY, *words, "--force") == 0


def test_ctrl_c_keeps_what_is_done(
    tmp_path: Path, capsys: Capture, monkeypatch: pytest.MonkeyPatch
) -> None:
    store = tmp_path / "runs.sqlite"
    calls: list[int] = []

    def interrupted(work: object, points: object) -> object:
        calls.append(1)
        if len(calls) > 1:
            raise KeyboardInterrupt
        return rows_of(work, points)  # type: ignore[arg-type]  # passed on

    monkeypatch.setattr(rows, "rows_of", interrupted)
    assert call(*FAMILY, "-o", str(store)) == 130
    err = capsys.readouterr().err
    assert f"{store}: keeps the rows that were finished; --resume computes the others" in err
    monkeypatch.undo()
    assert call(*FAMILY, "-o", str(store), "--resume") == 0
    assert "8 rows, 1 of them known before" in capsys.readouterr().err
    monkeypatch.setattr(rows, "rows_of", interrupted)  # at once, for it was called before
    assert call(*FAMILY, "-o", str(store), "--force") == 130
    assert "were finished, or the old ones if none were; --resume" in capsys.readouterr().err
    monkeypatch.undo()
    assert call(*FAMILY, "-o", str(store), "--resume") == 0
    assert "8 rows, 8 of them known before" in capsys.readouterr().err


def test_what_cannot_be_written_is_told_before_anything_is_computed(
    tmp_path: Path, capsys: Capture, monkeypatch: pytest.MonkeyPatch
) -> None:
    table = tmp_path / "runs.csv"
    table.write_text("someone's")
    monkeypatch.setattr(rows, "rows_of", None)
    assert call(*FAMILY, "-o", str(table)) == 2
    assert f"{table} would be overwritten; allow it with --force" in capsys.readouterr().err
