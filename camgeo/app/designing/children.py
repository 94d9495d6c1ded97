"""Processes that compute for the designer: warmed up in advance, killed when too slow.

One process does the jobs of a lane one after the other; different lanes work at the same time. A
process that takes too long or too much memory, or ends by itself, fails only its own job: the next
one is done by a spare process that is already warm.
"""

from __future__ import annotations

import gc
import json
import os
import queue
import signal
import struct
import subprocess
import sys
import threading
import traceback
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from functools import cached_property
from pathlib import Path
from typing import IO, Any, BinaryIO, Final, Literal, Self

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
"""Environment unless the user sets it: threads make no job faster, and each takes memory."""

CODE: Final = (
    "import importlib, sys; sys.path[:] = sys.argv[3:];"
    " from camgeo.app.designing.children import serve;"
    " serve(int(sys.argv[1]), importlib.import_module(sys.argv[2]).prepared)"
)
"""The program of a process, which gets exactly the search path of the process that starts it."""

WORK: Final = "camgeo.app.designing.work"
"""The module whose `prepared` returns what does jobs."""


class Refused(CamgeoError, RuntimeError):
    """A job has no result: it took too long or too much memory, or its process ended."""


@dataclass(frozen=True)
class JobResult:
    """The result of a job.

    Attributes
    ----------
    text : a JSON object as the process wrote it, which can be passed on unread.
    """

    text: bytes

    @cached_property
    def data(self) -> dict[str, Any]:
        """The result as Python data, parsed on first use."""
        loaded: dict[str, Any] = json.loads(self.text)
        return loaded


class Child:
    """One process, for one thread at a time."""

    def __init__(self, memory: int, work: str) -> None:
        self.process = subprocess.Popen(
            # -P keeps the current folder, which may hold anything, off the search path.
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
            # The first frame of a process says that it is warm.
            self._exchange(START, b"")
            self._warm = True
        return self._exchange(seconds, data)

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

    def _exchange(self, seconds: float, data: bytes) -> bytes:
        """Send the job, if it is not empty, and read the next frame; killed after `seconds`."""
        timer = threading.Timer(seconds, self.kill, (f"took longer than {seconds:g} s",))
        timer.daemon = True
        timer.start()
        try:
            if data:
                send(self._jobs, b"J", data)
            mark, answer = receive(self._results, LARGEST_RESULT)
        except (BrokenFrame, OSError, ValueError) as error:
            self.process.kill()
            self._killed = self._killed or "ended the process that computed it"
            raise Refused(self._killed) from error
        finally:
            timer.cancel()
        if mark in (b"R", b"M"):
            if mark == b"M":
                self.kill("took too much memory")
            raise Refused(answer.decode())
        return answer


class Children:
    """The processes of a designer, which any number of threads may use.

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

    def submit(self, job: Job, seconds: float) -> JobResult:
        """The result of a job, waiting for those of its lane that came before.

        Parameters
        ----------
        seconds : time that it may take once it has begun.

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
                return JobResult(child.ask(data, seconds))
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
            # The lock of a lane is held while a job is done: an idle process is not killed.
            if child is not None and turn.locked():
                child.kill("was cancelled")

    def close(self) -> None:
        """End all processes; jobs that are being done are refused."""
        with self._lock:
            self._closed = True
            children = [*self._busy.values()]
            if self._spare is not None:
                children.append(self._spare)
            self._busy, self._spare = {}, None
        for child in children:
            child.kill("was cancelled, because the designer ends")
        for child in children:
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


# -- frames ---------------------------------------------------------------------------------------
# What goes through the pipes between the designer and the processes that compute for it.


HEAD: Final = struct.Struct(">cQ")
"""Head of a frame: its mark, and how many bytes follow."""

Mark = Literal[b"J", b"W", b"R", b"M"]
"""J: a job, or the JSON of its result. W: the process is warm. R: a sentence that says why there is
no result. M: the same because memory ran out, after which the process ends."""

LARGEST_RESULT: Final = 200_000_000
"""Bytes of a result as JSON: the files of a large part in all formats."""

MARKS: Final[dict[bytes, Mark]] = {b"J": b"J", b"W": b"W", b"R": b"R", b"M": b"M"}


class BrokenFrame(Exception):
    """The other end is gone, or what it sent is not a frame of an allowed size."""


def send(stream: IO[bytes], mark: Mark, data: bytes = b"") -> None:
    """Write a frame; OSError or ValueError if the other end is gone."""
    stream.write(HEAD.pack(mark, len(data)) + data)
    stream.flush()


def receive(stream: IO[bytes], most: int) -> tuple[Mark, bytes]:
    """The next frame, with at most `most` bytes of data.

    Raises
    ------
    BrokenFrame
        If there is none.
    """
    try:
        head = _exactly(stream, HEAD.size)
        mark, size = HEAD.unpack(head)
        if mark not in MARKS or size > most:
            raise BrokenFrame
        return MARKS[mark], _exactly(stream, size)
    except (OSError, ValueError) as error:  # a stream closed in the meantime
        raise BrokenFrame from error


def _exactly(stream: IO[bytes], size: int) -> bytes:
    data = stream.read(size)
    if len(data) < size:
        raise BrokenFrame
    return data


# -- job ------------------------------------------------------------------------------------------
# A job of the designer, and how it is sent between processes.


LARGEST: Final = 16_000_000
"""Most bytes of a job as JSON: more than the largest scene and any change of it."""


class JobError(CamgeoError, ValueError):
    """A job that cannot be done: an unknown kind, or wrong arguments."""


@dataclass(frozen=True, slots=True)
class Job:
    """A computation that the designer requests for a scene.

    Attributes
    ----------
    kind : one of `camgeo.app.designing.work.WORK`.
    text : of the scene, TOML.
    file : path that messages name; empty for a scene that is in no file yet.
    folder : that contains the files named by the scene; empty if there is none.
    arguments : of that kind of job, JSON data.
    """

    kind: str
    text: str = ""
    file: str = ""
    folder: str = ""
    arguments: Mapping[str, Any] = field(default_factory=dict)

    def to_json(self) -> bytes:
        """The job as JSON.

        Raises
        ------
        JobError
            If its arguments are not JSON data, or if it is larger than `LARGEST`.
        """
        try:
            text = json.dumps(asdict(self), allow_nan=False).encode()
        except (TypeError, ValueError, RecursionError) as error:
            raise JobError(f"arguments of a job must be JSON data: {error}") from error
        if len(text) > LARGEST:
            raise JobError(f"is larger than {LARGEST:,} bytes, too large for a job")
        return text

    @classmethod
    def from_json(cls, text: bytes) -> Self:
        """The job that `to_json` wrote: a process gets jobs from the one that started it alone."""
        return cls(**json.loads(text))


# -- child ----------------------------------------------------------------------------------------
# A process that computes for the designer: warm before its first job, and ending by itself.
#
# It ends when the pipe that brings its jobs is closed, even while it computes, so it never survives
# the process that started it, however that one ends.


Run = Callable[[Job], dict[str, Any]]


def serve(memory: int, prepared: Callable[[], Run]) -> None:
    """Do the jobs that arrive on standard input until it ends; results go to standard output.

    Parameters
    ----------
    memory : that jobs may take [bytes], where the operating system can limit it.
    prepared : returns what does the jobs, after warming it up.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # whoever started it closes its input
    results = _reserve_output()
    jobs: queue.SimpleQueue[bytes] = queue.SimpleQueue()
    threading.Thread(target=_read, args=(sys.stdin.buffer, jobs), daemon=True).start()
    run = prepared()
    gc.collect()
    gc.freeze()  # what exists now stays: no collection examines it again
    _limit_memory(memory)
    send(results, b"W")
    while True:
        mark, data = _execute(jobs.get(), run, memory)
        send(results, mark, data)
        if mark == b"M":
            os._exit(1)  # its memory is in an unknown state


def _reserve_output() -> BinaryIO:
    """Standard output, reserved for results: whatever is printed goes to standard error."""
    results = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    return results


def _read(stream: BinaryIO, jobs: queue.SimpleQueue[bytes]) -> None:
    """Take jobs as they arrive; end the process when no more can come."""
    try:
        while True:
            jobs.put(receive(stream, LARGEST)[1])
    except BrokenFrame:
        os._exit(0)


def _limit_memory(memory: int) -> None:
    """Limit the address space to what is in use plus `memory` [bytes], where that is known."""
    try:
        import resource  # not on Windows

        pages = int(Path("/proc/self/statm").read_text("ascii").split()[0])
    except (ImportError, OSError):
        return
    most = pages * resource.getpagesize() + memory
    resource.setrlimit(resource.RLIMIT_AS, (most, most))


def _execute(data: bytes, run: Run, memory: int) -> tuple[Mark, bytes]:
    """The result of a job, or why there is none."""
    try:
        result = run(Job.from_json(data))
        text = json.dumps(result, allow_nan=False, separators=(",", ":")).encode()
    except JobError as error:
        return b"R", str(error).encode()
    except MemoryError:
        return b"M", f"took more than {memory / 1e9:g} GB of memory".encode()
    except RecursionError:
        return b"R", b"is nested too deeply"
    except Exception as error:
        traceback.print_exc()
        return b"R", f"met an error in camgeo itself: {type(error).__name__}: {error}".encode()
    if len(text) > LARGEST_RESULT:
        return b"R", f"has a result of more than {LARGEST_RESULT:,} bytes".encode()
    return b"J", text
