"""Processes that compute for the designer: warm before they are needed, killed when too slow.

One process does the jobs of a lane one after the other; different lanes work at the same time. A
process that takes too long or too much memory, or ends by itself, fails only its own job: the next
one is done by a spare process that is already warm.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final, Self

from camgeo.designing import frames
from camgeo.designing.frames import LARGEST_RESULT, BrokenFrame
from camgeo.designing.job import Job
from camgeo.errors import CamgeoError

MEMORY: Final = 1_500_000_000
"""Bytes that a job may take beyond those of a warm process."""

START: Final = 60.0
"""Seconds within which a process must be warm, on the slowest machine."""

GRACE: Final = 2.0
"""Seconds within which an idle process ends when its pipe is closed."""

LANES: Final[Mapping[str, str]] = {
    "findings": "findings",
    "solid": "findings",
    "build": "long",
    "size": "long",
}
"""Which process does a kind of job; kinds that are not named here are quick."""

QUICK: Final = "quick"

ALONE: Final = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
"""Unless the user says otherwise: threads make no job faster, and each takes memory."""

CODE: Final = (
    "import importlib, sys; sys.path[:] = sys.argv[3:];"
    " from camgeo.designing.child import serve;"
    " serve(int(sys.argv[1]), importlib.import_module(sys.argv[2]).prepared)"
)
"""What a process runs, with exactly the search path of the process that starts it."""

WORK: Final = "camgeo.designing.work"
"""The module whose `prepared` returns what does jobs."""


class Refused(CamgeoError, RuntimeError):
    """A job has no result: it took too long or too much memory, or its process ended."""


@dataclass(frozen=True)
class Result:
    """The result of a job.

    Attributes
    ----------
    text : a JSON object as the process wrote it, which can be passed on unread.
    """

    text: bytes

    @cached_property
    def data(self) -> dict[str, Any]:
        """The object."""
        found: dict[str, Any] = json.loads(self.text)
        return found


class Child:
    """One process, for one thread at a time."""

    def __init__(self, memory: int, work: str) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-P", "-c", CODE, str(memory), work, *sys.path],
            env={**ALONE, **os.environ},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            start_new_session=True,  # Ctrl-C is for the process that has started it
        )
        assert self.process.stdin is not None  # these are pipes
        assert self.process.stdout is not None
        self._jobs, self._results = self.process.stdin, self.process.stdout
        self._warm = False
        self._killed = ""

    @property
    def lives(self) -> bool:
        """Whether it can do another job."""
        return not self._killed and self.process.poll() is None

    def ask(self, data: bytes, seconds: float) -> bytes:
        """The JSON of the result of the job `data`; the time counts from when it is warm.

        Raises
        ------
        Refused
            If there is no result; the process may have ended then.
        """
        if not self._warm:
            self._within(START, b"")
            self._warm = True
        return self._within(seconds, data)

    def kill(self, why: str) -> None:
        """End it at once, whatever it is doing; its job is refused with the reason `why`."""
        self._killed = self._killed or why
        self.process.kill()

    def close(self) -> None:
        """End it and leave nothing behind: no process, no descriptor."""
        with suppress(OSError):
            self._jobs.close()
        try:
            self.process.wait(0.0 if self._killed else GRACE)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self._results.close()

    def _within(self, seconds: float, data: bytes) -> bytes:
        """Send the job, if it is not empty, and read the next frame; killed after `seconds`."""
        timer = threading.Timer(seconds, self.kill, (f"took longer than {seconds:g} s",))
        timer.daemon = True
        timer.start()
        try:
            if data:
                frames.send(self._jobs, b"J", data)
            mark, found = frames.receive(self._results, LARGEST_RESULT)
        except (BrokenFrame, OSError, ValueError) as error:
            self.process.kill()
            self._killed = self._killed or "ended the process that computed it"
            raise Refused(self._killed) from error
        finally:
            timer.cancel()
        if mark in (b"R", b"M"):
            if mark == b"M":
                self.kill("took too much memory")
            raise Refused(found.decode())
        return found


class Children:
    """The processes of a designer; any number of threads may use them.

    Parameters
    ----------
    memory : that a job may take [bytes].
    work : see `WORK`.
    """

    def __init__(self, memory: int = MEMORY, work: str = WORK) -> None:
        self._memory = memory
        self._work = work
        self._lock = threading.Lock()
        self._turns = {lane: threading.Lock() for lane in (QUICK, *LANES.values())}
        self._busy: dict[str, Child] = {}
        self._spare: Child | None = Child(memory, work)
        self._closed = False

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def submit(self, job: Job, seconds: float) -> Result:
        """The result of a job, waiting for those of its lane that came before.

        Parameters
        ----------
        seconds : that it may take once it has begun.

        Raises
        ------
        JobError
            If its arguments are not JSON data, or if it is too large.
        Refused
            With a sentence that begins with the kind of the job.
        """
        data = job.to_json()
        lane = LANES.get(job.kind, QUICK)
        with self._turns[lane]:
            child = self._child(lane)
            try:
                return Result(child.ask(data, seconds))
            except Refused as error:
                raise Refused(f"{job.kind}: {error}") from error
            finally:
                if not child.lives:
                    self._replace(lane, child)

    def cancel(self, kind: str) -> None:
        """End the job that is being done in the lane of that kind, if any; it is refused."""
        turn = self._turns[LANES.get(kind, QUICK)]
        with self._lock:
            child = self._busy.get(LANES.get(kind, QUICK))
            if child is not None and turn.locked():
                child.kill("was cancelled")

    def close(self) -> None:
        """End all processes; jobs that are being done are refused."""
        with self._lock:
            self._closed = True
            found = [*self._busy.values()]
            if self._spare is not None:
                found.append(self._spare)
            self._busy, self._spare = {}, None
        for child in found:
            child.kill("was cancelled, because the designer ends")
        for child in found:
            child.close()

    def _child(self, lane: str) -> Child:
        """The process of a lane: its own, or else the spare, which is then replaced by a new one.

        Refused if all have been closed.
        """
        with self._lock:
            if self._closed:
                raise Refused("was cancelled, because the designer ends")
            child = self._busy.get(lane)
            if child is not None and child.lives:
                return child
            if child is not None:
                child.close()
            if self._spare is None or not self._spare.lives:
                if self._spare is not None:
                    self._spare.close()
                self._spare = Child(self._memory, self._work)
            self._busy[lane], self._spare = self._spare, Child(self._memory, self._work)
            return self._busy[lane]

    def _replace(self, lane: str, child: Child) -> None:
        """Remove a process that has ended."""
        with self._lock:
            if self._busy.get(lane) is child:
                del self._busy[lane]
        child.close()
