"""The pool: the rows of the loop bit for bit, whichever processes die."""

from __future__ import annotations

import math
import multiprocessing
import os
import signal
import sqlite3
import subprocess
import sys
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from multiprocessing.context import SpawnProcess
from pathlib import Path

import pytest

from camgeo.design.design import Design
from camgeo.errors import GeometryError, UnknownNameError
from camgeo.lazy import Ledger
from camgeo.studies.sweep.family import Point
from camgeo.studies.sweep.pool import DEADLY, THREADS, Pool
from camgeo.studies.sweep.rows import (
    ENGINES,
    DesignRow,
    Loop,
    Work,
    compute_rows,
    engine_of,
    parse_questions,
)
from camgeo.studies.sweep.sweep import Heading, Store, sweep
from tests.sweep.driver import ASK, killed_family
from tests.sweep.families import FIXTURES, family
from tests.sweep.kills import Fault, require_rows_of_the_loop, swept
from tests.sweep.logged import Deadly, by_point
from tests.sweep.test_rows import work_on

ROOT = Path(__file__).resolve().parents[2]

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="kills processes as POSIX does")


def starting_as_another_dies(monkeypatch: pytest.MonkeyPatch) -> list[SpawnProcess]:
    """The first process of a pool dies before the second one has started, then as it has."""
    started: list[SpawnProcess] = []
    start = SpawnProcess.start

    def slowly(process: SpawnProcess) -> None:
        started.append(process)
        if len(started) == 2:
            started[0].kill()
            started[0].join()
        start(process)
        if len(started) == 4:
            started[2].kill()
            started[2].join()

    monkeypatch.setattr(SpawnProcess, "start", slowly)
    return started


def test_the_rows_of_the_loop_whatever_dies(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A design that ends its process twice is a row that says so; all others have their rows."""
    started = starting_as_another_dies(monkeypatch)
    found = family("follower.base_radius=45:56:12")
    plain = work_on(found, "transmission-angle", "peak:kappa", "laws")
    work = Deadly.made_of(plain, tmp_path / "died")
    loop = by_point(Loop().rows(plain, found.points()))
    pool = by_point(Pool(2).rows(work, found.points()))
    assert pool.keys() == loop.keys()
    (dead,) = (point for point in loop if point[0] == 47)
    assert pool[dead].reason.startswith(f"the process that computed it died, {DEADLY} times")
    assert {**pool, dead: loop[dead]} == loop
    assert len(started) > 4
    assert not multiprocessing.active_children()


@dataclass(frozen=True)
class Telling(Work):
    """Work whose rows tell how the process is set up."""

    def rows(self, points: Sequence[Point], ledger: Ledger | None = None) -> list[DesignRow]:
        threads = ",".join(os.environ.get(name, "") for name in THREADS)
        ignored = signal.getsignal(signal.SIGINT) is signal.SIG_IGN
        told = threads, str(ignored), float(os.getpid())
        return [DesignRow(point, told, ("", "", "")) for point in points]


def test_a_worker_has_one_thread_and_leaves_ctrl_c_to_the_driver() -> None:
    before = dict(os.environ)
    plain = work_on(family(), "laws")
    work = Telling(plain.text, (), plain.keys, plain.questions, plain.versions)
    chunks = Pool(1).rows(work, family().points())
    (row,) = next(chunks)
    chunks.close()  # ends what was handed out
    assert row.values[:2] == ("1,1,1,1", "True")
    assert row.values[2] != os.getpid()
    assert dict(os.environ) == before
    assert not multiprocessing.active_children()


UNGUARDED = """
from camgeo.studies.sweep.pool import Pool
from tests.sweep.families import family
from tests.sweep.test_rows import work_on

found = family("follower.base_radius=45,46")
list(Pool(1).rows(work_on(found, "laws"), found.points()))
"""


def test_a_program_that_cannot_be_imported_is_told_so(tmp_path: Path) -> None:
    program = tmp_path / "unguarded.py"
    program.write_text(UNGUARDED)
    words = [sys.executable, str(program)]
    paths = {**os.environ, "PYTHONPATH": str(ROOT)}
    run = subprocess.run(words, stderr=subprocess.PIPE, text=True, check=False, env=paths)
    assert run.returncode == 1
    assert "CamgeoError: the processes of the pool end as they start" in run.stderr


def test_an_engine_by_its_name() -> None:
    where: dict[str, int | str] = {"loop": 1, "pool": 2, "cluster": "tcp://127.0.0.1:8786"}
    assert where.keys() == ENGINES.keys()
    for name, place in where.items():
        assert engine_of(name, place).name == name
    with pytest.raises(UnknownNameError, match='did you mean "pool"'):
        engine_of("pol")
    with pytest.raises(GeometryError, match="must be from 1 to"):
        engine_of("pool", 0)


# Kills --------------------------------------------------------------------------------------------


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="looks for workers in /proc")
def test_killed_drivers_and_workers_lose_no_row_and_repeat_few(tmp_path: Path) -> None:
    """The small form of `python -m tests.sweep.kills --engine pool`."""
    found = swept(tmp_path, "2", 120, each=1)
    assert sorted(victim for victim, _ in found.killed) == ["driver", "worker"]
    assert {each.name for each in tmp_path.iterdir()} == {"runs.sqlite", "begun.txt"}


def test_a_row_that_differs_in_a_bit_is_seen(tmp_path: Path) -> None:
    store, count = tmp_path / "runs.sqlite", 4
    sweep(killed_family(count), ASK, store=store).close()
    require_rows_of_the_loop(store, count)
    found = killed_family(count)
    work = Work.for_family(found, parse_questions(Design(found.scene), ASK))
    with closing(Store(store, Heading.for_family(found, work), "replace")) as kept:
        rows = compute_rows(work, found.points())
        beyond = (
            (math.nextafter(float(value or 0.0), 90.0) for value in row.values) for row in rows
        )
        others = [replace(row, values=tuple(each)) for row, each in zip(rows, beyond, strict=True)]
        kept.add(others)
        kept.settle()
    with pytest.raises(Fault, match="not those of the loop"):
        require_rows_of_the_loop(store, count)
    with closing(sqlite3.connect(store)) as database, database:
        database.execute("DELETE FROM designs WHERE point = (SELECT min(point) FROM designs)")
    with pytest.raises(Fault, match="1 rows are missing"):
        require_rows_of_the_loop(store, count)


def test_a_call_with_workers(capsys: pytest.CaptureFixture[str]) -> None:
    from camgeo.app.cli.main import main

    scene = str(FIXTURES / "scenes" / "setzhub.toml")
    words = ["sweep", scene, "--vary", "follower.base_radius=45:60:3", "--ask", "laws"]
    assert main(words) == 0
    loop = capsys.readouterr().out
    assert main([*words, "--workers", "2"]) == 0
    assert capsys.readouterr().out == loop
    assert main([*words, "--workers", "-1"]) == 2
    assert "workers = -1: must be from 1 to" in capsys.readouterr().err
