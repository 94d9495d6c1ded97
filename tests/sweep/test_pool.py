"""The pool: the rows of the loop bit for bit, whichever processes die."""

from __future__ import annotations

import multiprocessing
import os
import random
import signal
import sqlite3
import subprocess
import sys
import time
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass
from multiprocessing.context import SpawnProcess
from pathlib import Path

import pytest

from camgeo.errors import GeometryError, UnknownNameError
from camgeo.lazy import Ledger
from camgeo.sweep.engine import ENGINES, Loop, engine_of
from camgeo.sweep.family import Point
from camgeo.sweep.pool import DEADLY, THREADS, Pool
from camgeo.sweep.rows import Row, Work, rows_of
from camgeo.sweep.sweep import sweep
from tests.long_form import LONG
from tests.sweep.driver import ASK, COUNT, killed_family
from tests.sweep.families import FIXTURES, family
from tests.sweep.test_rows import work_on

ROOT = Path(__file__).resolve().parents[2]

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="kills processes as POSIX does")


def all_rows(engine: Loop | Pool, work: Work, points: list[Point]) -> dict[Point, Row]:
    found = [row for chunk in engine.rows(work, iter(points)) for row in chunk]
    by_point = {row.point: row for row in found}
    assert len(by_point) == len(found)
    return by_point


@dataclass(frozen=True)
class Deadly(Work):
    """Work of which one design kills its process, and one does so the first time only."""

    mark: str = ""

    def rows(self, points: Sequence[Point], ledger: Ledger | None = None) -> list[Row]:
        mark = Path(self.mark)
        first = not mark.exists()
        if any(point[0] == 47 or (point[0] == 50 and first) for point in points):
            mark.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return super().rows(points, ledger)


def starting_as_another_dies(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first process of a pool dies before the second one has started, then as it has."""
    started: list[SpawnProcess] = []
    start = SpawnProcess.start

    def slowly(process: SpawnProcess) -> None:
        started.append(process)
        if len(started) != 2:
            start(process)
        if len(started) in (2, 4):
            started[-2].kill()
            time.sleep(0.2)  # the pool takes notice
        if len(started) == 2:
            start(process)

    monkeypatch.setattr(SpawnProcess, "start", slowly)


def test_the_rows_of_the_loop_whatever_dies(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A design that ends its process twice is a row that says so; all others have their rows."""
    starting_as_another_dies(monkeypatch)
    found = family("follower.base_radius=45:56:12")
    plain = work_on(found, "transmission-angle", "peak:kappa", "laws")
    work = Deadly(plain.text, plain.contents, plain.keys, plain.asked, plain.versions,
                  str(tmp_path / "died"))  # fmt: skip
    points = list(found.points())
    loop = all_rows(Loop(), plain, points)
    pool = all_rows(Pool(2), work, points)
    assert pool.keys() == loop.keys()
    (dead,) = (point for point in points if point[0] == 47)
    assert pool[dead].reason.startswith(f"the process that computed it died, {DEADLY} times")
    assert {**pool, dead: loop[dead]} == loop
    assert not multiprocessing.active_children()


@dataclass(frozen=True)
class Telling(Work):
    """Work whose rows tell how the process is set up."""

    def rows(self, points: Sequence[Point], ledger: Ledger | None = None) -> list[Row]:
        threads = ",".join(os.environ.get(name, "") for name in THREADS)
        ignored = signal.getsignal(signal.SIGINT) is signal.SIG_IGN
        told = threads, str(ignored), float(os.getpid())
        return [Row(point, told, ("", "", "")) for point in points]


def test_a_worker_has_one_thread_and_leaves_ctrl_c_to_the_driver() -> None:
    before = dict(os.environ)
    plain = work_on(family(), "laws")
    work = Telling(plain.text, (), plain.keys, plain.asked, plain.versions)
    chunks = Pool(1).rows(work, family().points())
    (row,) = next(chunks)
    chunks.close()  # ends what was handed out
    assert row.values[:2] == ("1,1,1,1", "True")
    assert row.values[2] != os.getpid()
    assert dict(os.environ) == before
    assert not multiprocessing.active_children()


UNGUARDED = """
from camgeo.sweep.pool import Pool
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


def alive(pid: int) -> bool:
    try:
        status = Path(f"/proc/{pid}/status").read_text()
    except OSError:
        return False
    return "State:\tZ" not in status


def killed(store: Path, whom: str, at: int, delay: float) -> int:
    """Kill the driver or a worker when so many rows are done; the rows that were told as done."""
    words = [sys.executable, "-m", "tests.sweep.driver", str(store), "2", whom, str(at), str(delay)]
    run = subprocess.run(words, cwd=ROOT, stdout=subprocess.PIPE, text=True, check=False)
    assert run.returncode == (-signal.SIGKILL if whom == "driver" else 0)
    lines = [[int(word) for word in line.split()] for line in run.stdout.splitlines()]
    helpers = {pid for line in lines for pid in line[1:]}
    assert len(helpers) >= 2
    for _ in range(500):  # workers end with their driver
        if not any(map(alive, helpers)):
            break
        time.sleep(0.02)
    assert not any(map(alive, helpers))
    return lines[-1][0]


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="looks for workers in /proc")
def test_killed_drivers_and_workers_lose_no_row_and_repeat_none(tmp_path: Path) -> None:
    store, seed = tmp_path / "runs.sqlite", random.Random(1)
    found, kept = killed_family(), 0
    steps = 5 if LONG else 1
    for step in range(steps):  # from a tenth to nine tenths of the rows
        at = int((0.1 + 0.8 * (step + 0.5 * seed.random()) / steps) * COUNT)
        delay = 0.02 * seed.random()
        if LONG and not step:
            killed(tmp_path / f"worker-{step}.sqlite", "worker", at, delay)
        done = killed(store, "driver", max(at, kept), delay)
        with closing(sqlite3.connect(store)) as database:
            assert database.execute("PRAGMA integrity_check").fetchone() == ("ok",)
            kept = database.execute("SELECT count(*) FROM designs").fetchone()[0]
        assert max(at, done) <= kept < COUNT  # what was told is kept
    expected = rows_of(work_on(found, *ASK), found.points())
    assert [row.point for row in expected] == list(found.points())
    for path in sorted(tmp_path.glob("*.sqlite")):
        missing = COUNT - kept if path == store else 0
        with closing(sweep(found, ASK, store=path, existing="resume")) as result:
            assert result.computed == missing
            assert tuple(result.rows) == expected
        with closing(sqlite3.connect(path)) as database:
            assert database.execute("SELECT count(*) FROM designs").fetchone() == (COUNT,)
    assert all(each.suffix == ".sqlite" for each in tmp_path.iterdir())


def test_a_call_with_workers(capsys: pytest.CaptureFixture[str]) -> None:
    from camgeo.cli.main import main

    scene = str(FIXTURES / "scenes" / "setzhub.toml")
    words = ["sweep", scene, "--vary", "follower.base_radius=45:60:3", "--ask", "laws"]
    assert main(words) == 0
    loop = capsys.readouterr().out
    assert main([*words, "--workers", "2"]) == 0
    assert capsys.readouterr().out == loop
    assert main([*words, "--workers", "-1"]) == 2
    assert "workers = -1: must be from 1 to" in capsys.readouterr().err
