"""A process that computes for the designer: warm before its first job, and ending by itself.

It ends when the pipe that brings its jobs is closed, even while it computes, so it never survives
the process that started it, however that one ends.
"""

from __future__ import annotations

import gc
import json
import os
import queue
import signal
import sys
import threading
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any, BinaryIO

from camgeo.designing import frames
from camgeo.designing.frames import LARGEST_RESULT, BrokenFrame, Mark
from camgeo.designing.job import LARGEST, Job, JobError

Run = Callable[[Job], dict[str, Any]]


def serve(memory: int, prepared: Callable[[], Run]) -> None:
    """Do the jobs that arrive on standard input until it ends; results go to standard output.

    Parameters
    ----------
    memory : that jobs may take [bytes], where the operating system can limit it.
    prepared : returns what does the jobs, after warming it up.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # whoever started it closes its input
    results = _own_output()
    jobs: queue.SimpleQueue[bytes] = queue.SimpleQueue()
    threading.Thread(target=_read, args=(sys.stdin.buffer, jobs), daemon=True).start()
    run = prepared()
    gc.collect()
    gc.freeze()  # what exists now stays: no collection examines it again
    _limit_memory(memory)
    frames.send(results, b"W")
    while True:
        mark, data = _done(jobs.get(), run, memory)
        frames.send(results, mark, data)
        if mark == b"M":
            os._exit(1)  # its memory is in an unknown state


def _own_output() -> BinaryIO:
    """Standard output, reserved for results: whatever is printed goes to standard error."""
    results = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    return results


def _read(stream: BinaryIO, jobs: queue.SimpleQueue[bytes]) -> None:
    """Take jobs as they arrive; end the process when no more can come."""
    try:
        while True:
            jobs.put(frames.receive(stream, LARGEST)[1])
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


def _done(data: bytes, run: Run, memory: int) -> tuple[Mark, bytes]:
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
