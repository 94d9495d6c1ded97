"""`python -m tests.sweep.driver STORE WHERE WHOM AT DELAY`: a sweep during which a process dies.

WHERE is how many processes a pool has, or the address of a cluster.
Once AT rows are stored, and DELAY seconds have passed, it kills itself (WHOM is `driver`) or one of
its workers (`worker`). It prints the numbers of the rows stored, and of its workers.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
from pathlib import Path
from typing import Final

from camgeo.sweep import engine
from camgeo.sweep.family import Family
from camgeo.sweep.sweep import sweep
from tests.long_form import LONG
from tests.sweep.families import family

ASK: Final = ("largest-acceleration",)

COUNT: Final = 10_000 if LONG else 400

CHUNK: Final = 0.01
"""Seconds of a chunk here, so that a small family has many."""


def killed_family() -> Family:
    """The designs of the test."""
    return family(f"follower.base_radius=45:60:{COUNT}")


def main() -> None:
    """Resume the store."""
    store, where, whom = Path(sys.argv[1]), sys.argv[2], sys.argv[3]
    at, delay = int(sys.argv[4]), float(sys.argv[5])
    engine.CHUNK = CHUNK  # type: ignore[misc]  # smaller chunks for the test
    pool = where.isdecimal()
    chosen = engine.engine_of("pool" if pool else "cluster", int(where) if pool else where)
    timers: list[threading.Timer] = []

    def kill() -> None:
        others = multiprocessing.active_children()
        pid = os.getpid() if whom == "driver" else others[0].pid
        assert pid is not None
        os.kill(pid, signal.SIGKILL)

    def say(words: str) -> None:
        done = int(words.split()[0].replace(",", ""))
        workers = " ".join(str(each.pid) for each in multiprocessing.active_children())
        sys.stdout.write(f"{done} {workers}\n")
        sys.stdout.flush()
        if done >= at and not timers:
            timers.append(threading.Timer(delay, kill))
            timers[0].start()

    sweep(killed_family(), ASK, store=store, existing="resume", engine=chosen, progress=say).close()


if __name__ == "__main__":
    main()
