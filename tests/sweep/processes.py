"""A Dask scheduler and workers on loopback, as processes of their own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Sequence
from contextlib import closing, suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Final

from tests.waiting import PATIENCE, ended, until

ROOT: Final = Path(__file__).resolve().parents[2]

LOOPBACK: Final = ("--host", "127.0.0.1", "--dashboard-address", "127.0.0.1:0")

AT_ONCE: Final = {"DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "0"}
"""Makes the scheduler tell the first death of a worker, in place of trying a chunk four times."""

WORKERS: Final = 2


@dataclass
class Processes:
    """A scheduler and some `dask worker`, each of which starts its worker again when that dies.

    Attributes
    ----------
    folder : for their files.
    settings : variables of their environment.
    options : of the command line, e.g. for TLS, besides where to listen.
    workers : how many.
    address : of the scheduler.
    """

    folder: Path
    settings: dict[str, str]
    options: Sequence[str] = ()
    workers: int = WORKERS
    address: str = ""

    def __post_init__(self) -> None:
        self.started: list[subprocess.Popen[bytes]] = []
        self.schedule("0")
        self.start_workers()

    def start_workers(self) -> None:
        """Start all workers."""
        few = ("--nworkers", "1", "--nthreads", "1", "--local-directory", str(self.folder))
        for _ in range(self.workers):
            self.start("worker", self.address, *few)

    def schedule(self, port: str) -> subprocess.Popen[bytes]:
        """Start a scheduler, and wait until it is there."""
        file = self.folder / "scheduler.json"
        file.unlink(missing_ok=True)
        process = self.start("scheduler", "--port", port, "--scheduler-file", str(file))
        self.address = until("the scheduler", partial(_address_in, file))
        return process

    def start(self, what: str, *words: str) -> subprocess.Popen[bytes]:
        """Start `dask WHAT` on loopback."""
        process = subprocess.Popen(
            [sys.executable, "-m", "dask", what, *words, *LOOPBACK, *self.options],
            cwd=ROOT, env={**os.environ, **self.settings, "PYTHONPATH": str(ROOT)},
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        self.started.append(process)
        return process

    def wait(self) -> None:
        """Until all workers are there."""
        with closing(self.client()) as client:
            client.wait_for_workers(self.workers, timeout=PATIENCE)

    def client(self) -> Any:
        """A connection of its own."""
        from distributed import Client

        return Client(self.address, timeout=PATIENCE, set_as_default=False)

    def computing(self) -> list[int]:
        """The processes that compute just now: one is missing while it is started again."""
        import psutil

        found = []
        for process in self.started[1:]:
            with suppress(psutil.NoSuchProcess):
                for each in psutil.Process(process.pid).children():
                    if any("spawn_main" in word for word in each.cmdline()):
                        found.append(each.pid)
        return found

    def listening(self) -> list[str]:
        """The addresses at which any of the processes listens, one for each socket."""
        import psutil

        found = []
        for process in self.started:
            root = psutil.Process(process.pid)
            for each in (root, *root.children(recursive=True)):
                sockets = each.net_connections("inet")
                found += [one.laddr.ip for one in sockets if one.status == "LISTEN"]
        return found

    def end(self) -> None:
        """End all of them."""
        import psutil

        everything = []
        for process in self.started:
            with suppress(psutil.NoSuchProcess):
                everything += psutil.Process(process.pid).children(recursive=True)
            process.terminate()
        for process in self.started:
            ended(process)
        for each in everything:
            with suppress(psutil.NoSuchProcess):
                each.kill()


def _address_in(file: Path) -> str:
    """The address that a scheduler has written there; empty until it has."""
    with suppress(OSError, ValueError):
        return str(json.loads(file.read_text())["address"])
    return ""
