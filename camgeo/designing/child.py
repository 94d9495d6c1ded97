"""A process that computes for the designer: it is warm before its first job, and ends by itself.

It ends when the pipe of its jobs is closed, even while it computes: so it never survives the
process that started it, however that ended.
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
    """Do the jobs that come on the standard input until it ends; results go to the standard output.

    Parameters
    ----------
    memory : that jobs may take [bytes]; held where the operating system can limit it.
    prepared : makes what does them, and takes the time for that.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # who started it closes its input
    results = _own_output()
    jobs: queue.SimpleQueue[bytes] = queue.SimpleQueue()
    threading.Thread(target=_read, args=(sys.stdin.buffer, jobs), daemon=True).start()
    run = prepared()
    gc.collect()
    gc.freeze()  # what is there now stays: no job looks through it
    _limit_memory(memory)
    frames.send(results, b"W")
    while True:
        mark, data = _done(jobs.get(), run, memory)
        frames.send(results, mark, data)
        if mark == b"M":
            os._exit(1)  # what is left of its memory is in pieces


def _own_output() -> BinaryIO:
    """The standard output, for results alone: what anything prints goes to the standard error."""
    results = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    return results


def _read(stream: BinaryIO, jobs: queue.SimpleQueue[bytes]) -> None:
    """Take jobs as they come; end the process when there will be no more."""
    try:
        while True:
            jobs.put(frames.receive(stream, LARGEST)[1])
    except BrokenFrame:
        os._exit(0)


def _limit_memory(memory: int) -> None:
    """Limit the address space to what is in use and `memory` [bytes] more, where that is known."""
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
