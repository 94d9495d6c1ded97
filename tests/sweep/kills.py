"""A sweep of which workers and driver are killed, again and again.

    python -m tests.sweep.kills --count 10000 --engine cluster --seed 1

Between 10 and 90 % of the rows five workers and five drivers are killed with SIGKILL, at random
moments in a random order; each driver is followed by another one, which resumes the store. Exits
with 1 if the store is damaged, if a row is missing, there twice or other than that of the loop, or
if more designs were begun twice than were in flight at the kills. The engine is `pool`, two
processes, or `cluster`, a Dask scheduler and two `dask worker` on loopback. The tests kill one of
each while the driver waits for it, so that every run does the same.
"""

from __future__ import annotations

import argparse
import os
import random
import signal
import sqlite3
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Final, Literal

from camgeo.design.design import Design
from camgeo.studies.sweep.rows import AHEAD, Work, compute_rows, parse_questions
from camgeo.studies.sweep.sweep import sweep
from tests.findings import known
from tests.seeds import add_seed, moment
from tests.sweep.driver import ASK, in_chunk, killed_family
from tests.sweep.processes import ROOT, WORKERS, Processes
from tests.waiting import alive, until

Victim = Literal["worker", "driver"]

FIRST, LAST = 0.1, 0.9
"""Between these shares of the rows processes are killed."""

DELAY: Final = 0.05
"""Seconds that a kill waits at most, so that it hits any moment of a chunk."""


class Fault(Exception):
    """Something was lost, repeated or damaged."""


@dataclass(frozen=True)
class Report:
    """What a run with kills came to.

    Attributes
    ----------
    killed : who, and how many rows were there then.
    repeated : designs that were begun more often than once.
    allowed : how many of them may be: those in flight at the kills.
    """

    killed: tuple[tuple[Victim, int], ...]
    repeated: int
    allowed: int


def swept(
    folder: Path,
    where: str,
    count: int,
    *,
    each: int,
    seed: int = 1,
    waiting: bool = True,
    computing: Callable[[], list[int]] = list,
    told: Callable[[str], None] = lambda _: None,
) -> Report:
    """Sweep `count` designs while `each` workers and as many drivers are killed.

    Parameters
    ----------
    where : the number of processes of a pool, or the address of a cluster.
    waiting : whether the driver does nothing while it or a worker is killed.
    computing : the workers of a cluster; those of a pool are told by the driver.

    Raises
    ------
    Fault
        If the kills show in the store, or in processes that are left.
    """
    chosen = random.Random(seed)
    victims: list[Victim] = ["worker", "driver"] * each
    chosen.shuffle(victims)
    room = (LAST - FIRST) * count - len(victims) * in_chunk(count)
    moments = sorted(int(FIRST * count + room * chosen.random()) for _ in victims)
    left = list(zip(moments, victims, strict=True))
    store, log = folder / "runs.sqlite", folder / "begun.txt"
    killed: list[tuple[Victim, int]] = []
    while True:
        words = [sys.executable, "-m", "tests.sweep.driver", str(store), where, str(count)]
        before, helpers = None, set[int]()
        with subprocess.Popen(
            [*words, str(log)], cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
            env={**os.environ, "PYTHONPATH": str(ROOT)},
        ) as driver:  # fmt: skip
            for line in known(driver.stdout):
                done, *own = map(int, line.split())
                helpers.update(own)
                before = done
                now = bool(left) and done >= left[0][0]
                if not now or not waiting:
                    _go_on(known(driver.stdin))
                if now:
                    if not waiting:
                        moment(chosen, DELAY)
                    _, victim = left.pop(0)
                    killed.append((victim, done))
                    told(f"{victim} killed at {done:,} rows")
                    _kill(driver.pid if victim == "driver" else _one_of(computing, own, chosen))
                    if waiting:
                        _go_on(known(driver.stdin))
        code = driver.returncode
        _require_ended(helpers)
        _require_whole(store, count, done=before or 0)
        if code == 0:
            break
        if code != -signal.SIGKILL:
            raise Fault(f"a driver ended with {code}")
    if left:
        raise Fault(f"the sweep ended before {len(left)} processes were killed")
    require_rows_of_the_loop(store, count)
    begun = log.read_text().splitlines()
    repeated, allowed = len(begun) - count, len(killed) * AHEAD * WORKERS * in_chunk(count)
    if len(set(begun)) != count or repeated > allowed:
        raise Fault(f"{repeated} designs were begun twice, of {allowed} that may be")
    return Report(tuple(killed), repeated, allowed)


def _go_on(driver: IO[str]) -> None:
    """Let a driver go on, if it is still there."""
    with suppress(BrokenPipeError):
        driver.write("\n")
        driver.flush()


def _one_of(computing: Callable[[], list[int]], own: list[int], chosen: random.Random) -> int:
    """A process that computes; waits while all are being started again."""
    return chosen.choice(until("a worker that is started again", lambda: own or computing()))


def _require_ended(helpers: set[int]) -> None:
    """Processes of a pool end with their driver."""
    until("the end of the workers of a driver", lambda: not any(map(alive, helpers)))


def _kill(pid: int) -> None:
    with suppress(ProcessLookupError):
        os.kill(pid, signal.SIGKILL)


def _require_whole(store: Path, count: int, *, done: int) -> None:
    """Fault if a store that a driver left is damaged, or lacks what was told as done."""
    with closing(sqlite3.connect(store)) as database:
        (found,) = database.execute("PRAGMA integrity_check").fetchone()
        query = "SELECT count(*), count(DISTINCT point) FROM designs"
        kept, once = database.execute(query).fetchone()
    if found != "ok":
        raise Fault(f"the store is damaged: {found}")
    if not done <= kept == once <= count:
        raise Fault(f"{kept} rows of {once} designs where {done} were told")


def require_rows_of_the_loop(store: Path, count: int) -> None:
    """Fault if a row is missing, or differs in one bit from that which the loop computes."""
    found = killed_family(count)
    expected = compute_rows(
        Work.for_family(found, parse_questions(Design(found.scene), ASK)), found.points()
    )
    with closing(sweep(found, ASK, store=store, existing="resume")) as result:
        if result.computed:
            raise Fault(f"{result.computed} rows are missing")
        if tuple(result.rows) != expected:
            raise Fault("the rows are not those of the loop")


@contextmanager
def engine(name: str, folder: Path) -> Iterator[tuple[str, Callable[[], list[int]]]]:
    """Where the driver computes, and what tells the workers of a cluster."""
    if name == "pool":
        yield str(WORKERS), list
        return
    processes = Processes(folder, {})
    try:
        processes.wait()
        yield processes.address, processes.computing
    finally:
        processes.end()


def say(words: str) -> None:
    """On the terminal, at once."""
    sys.stdout.write(f"{words}\n")
    sys.stdout.flush()


def main() -> int:
    """Kill, and print what came of it."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0] if __doc__ else None)
    parser.add_argument("--count", type=int, default=10_000, help="designs; default 10,000")
    parser.add_argument("--engine", choices=("pool", "cluster"), default="cluster")
    parser.add_argument("--each", type=int, default=5, help="workers, and drivers, to kill")
    add_seed(parser)
    given = parser.parse_args()
    with (
        tempfile.TemporaryDirectory() as folder,
        engine(given.engine, Path(folder)) as (where, computing),
    ):
        try:
            found = swept(
                Path(folder), where, given.count,
                each=given.each, seed=given.seed, waiting=False, computing=computing, told=say,
            )  # fmt: skip
        except Fault as fault:
            say(f"FAULT: {fault}")
            return 1
    say(
        f"{given.count:,} rows as those of the loop, seed {given.seed};"
        f" {found.repeated:,} designs were begun twice, {found.allowed:,} may be"
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
