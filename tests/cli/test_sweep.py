"""`camgeo sweep`: options, files, messages."""

from __future__ import annotations

import json
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from camgeo.studies.sweep import rows
from camgeo.studies.sweep.rows import compute_rows
from tests.cli.calling import Called, called
from tests.sweep.families import FIXTURES, LAWS, RADII

SCENE = FIXTURES / "scenes" / "setzhub.toml"

FAMILY = ("--vary", RADII, "--vary", LAWS, "--ask", "laws,largest-acceleration")


def call(*words: object) -> Called:
    return called("sweep", SCENE, *FAMILY, *words)


def test_a_store_and_other_files(tmp_path: Path) -> None:
    store, table, document = (tmp_path / f"runs{end}" for end in (".sqlite", ".csv", ".json"))
    words = [word for path in (store, table, document) for word in ("-o", path)]
    first = call(*words)
    assert first.out.startswith("setzhub: 8 designs\n")
    assert first.err.splitlines() == [f"{path}: 8 rows" for path in (store, table, document)]
    assert len(table.read_text().splitlines()) == 9
    assert json.loads(document.read_text())["count"] == 8
    with closing(sqlite3.connect(store)) as database:
        assert database.execute("SELECT count(*) FROM designs").fetchone() == (8,)
    again = call(*words)
    assert again.code == 2
    assert "exists: resume it" in again.err
    resumed = call("-o", store, "--resume", "--json")
    assert resumed.document == json.loads(document.read_text())
    assert resumed.err == f"{store}: 8 rows, 8 of them known before\n"
    assert call(*words, "--force").code == 0


def test_ctrl_c_keeps_what_is_done(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    store = tmp_path / "runs.sqlite"
    calls: list[int] = []

    def interrupted(work: object, points: object) -> object:
        calls.append(1)
        if len(calls) > 1:
            raise KeyboardInterrupt
        return compute_rows(work, points)  # type: ignore[arg-type]  # passed on

    monkeypatch.setattr(rows, "compute_rows", interrupted)
    found = call("-o", store)
    assert found.code == 130
    kept = "keeps the rows that were finished"
    assert f"{store}: {kept}; --resume computes the others" in found.err
    monkeypatch.undo()
    assert "8 rows, 1 of them known before" in call("-o", store, "--resume").err
    monkeypatch.setattr(rows, "compute_rows", interrupted)  # at once, for it was called before
    assert f"{kept}, or the old ones if none were; --resume" in call("-o", store, "--force").err
    monkeypatch.undo()
    assert "8 rows, 8 of them known before" in call("-o", store, "--resume").err


def test_what_cannot_be_written_is_told_before_anything_is_computed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    table = tmp_path / "runs.csv"
    table.write_text("someone's")
    monkeypatch.setattr(rows, "compute_rows", None)
    found = call("-o", table)
    assert found.code == 2
    assert f"{table} would be overwritten; allow that with --force" in found.err
