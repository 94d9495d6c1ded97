"""A process of its own that runs cases, with a limit on its memory; replaced when it dies."""

from __future__ import annotations

import contextlib
import io
import multiprocessing
import os
import resource
import sys
import tempfile
import warnings
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Final

from tests.fuzz.case import Case
from tests.fuzz.cases import draw
from tests.fuzz.invariants import Failure, Outcome, limited, run
from tests.speed import cpu_second
from tests.waiting import PATIENCE

MOST_MEMORY: Final = 1 << 30
"""Bytes of the process."""

MOST_WAIT: Final = 6.0 * PATIENCE
"""Seconds after which a worker that hears no signal is ended: one that sleeps hears one earlier."""


Request = tuple[int, int, str | None]
"""A seed, the number of a case, and its kind if not any."""

Drawn = tuple[str, Case, Outcome]
"""The kind of a case, empty for one that was not drawn; the case; what it did."""


class Worker:
    """Runs cases one after the other, each in a new folder."""

    def __init__(self) -> None:
        self._process: multiprocessing.process.BaseProcess | None = None
        self._pipe: Connection | None = None

    def run(self, case: Case) -> Outcome:
        """What the case did; a failure if the process dies or has to be ended."""
        return self._asked(case, case)[2]

    def draw(self, seed: int, number: int, kind: str | None) -> Drawn:
        """The case of that number of a run, its kind, and what it did."""
        return self._asked((seed, number, kind), Case({}, ()))

    def _asked(self, request: Case | Request, case: Case) -> Drawn:
        pipe = self._pipe or self._start()
        pipe.send(request)
        problem = "died"
        with contextlib.suppress(EOFError, OSError):
            while pipe.poll(MOST_WAIT):
                drawn: Drawn = pipe.recv()
                if drawn[2].done:
                    return drawn
                _, case, _ = drawn  # it was drawn, and is being run
            problem = "hang"
        code = self.close(killing=problem == "hang")  # one that has died keeps its own code
        detail = f"the worker had to be ended, or ended with {code}"
        step = case.steps[0] if case.steps else ("draw",)
        return "", case, Outcome([Failure(f"{problem} in {step[0]}", step, detail)])

    def close(self, *, killing: bool = True) -> int | None:
        """End the process; its exit code."""
        process, pipe = self._process, self._pipe
        self._process = self._pipe = None
        if process is None:
            return None
        if pipe is not None:
            pipe.close()  # which ends one that waits for a case
        if not killing:
            process.join(PATIENCE)
        process.kill()
        process.join()
        return process.exitcode

    def _start(self) -> Connection:
        context = multiprocessing.get_context("spawn")
        ours, theirs = context.Pipe()
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # read when the worker imports numpy
        cpu_second()  # the worker knows what is measured here
        # Not a daemon, which may start no processes; it ends with the pipe.
        self._process = context.Process(target=serve, args=(theirs,))
        self._process.start()
        theirs.close()
        self._pipe = ours
        return ours


def serve(pipe: Connection) -> None:
    """Run the cases that come through the pipe until it is closed."""
    sys.stdin = io.StringIO()
    warnings.simplefilter("error")
    limit_memory()
    home = Path.cwd()
    while True:
        try:
            case = pipe.recv()
        except EOFError:
            return
        kind = ""
        if not isinstance(case, Case):
            with limited("draw"):
                kind, case = draw(*case)
            pipe.send((kind, case, Outcome()))
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            outcome = run(case)
            os.chdir(home)
        pipe.send((kind, case, outcome))


def limit_memory() -> None:
    """Let the process grow to MOST_MEMORY; what is mapped but never touched does not count."""
    try:
        mapped, resident = map(int, Path("/proc/self/statm").read_text("ascii").split()[:2])
    except OSError:  # not Linux: no limit
        return
    page = resource.getpagesize()
    most = MOST_MEMORY + (mapped - resident) * page
    resource.setrlimit(resource.RLIMIT_AS, (most, most))
