"""The local pool: a number of processes on this computer, each with one BLAS thread."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import threading
from collections import deque
from collections.abc import Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import connection
from multiprocessing.context import SpawnContext, SpawnProcess
from typing import Any, Final

from camgeo.errors import CamgeoError, GeometryError
from camgeo.studies.sweep.family import Point
from camgeo.studies.sweep.rows import AHEAD, Chunks, DesignRow, Pace, Work, compute_timed_rows, dead

THREADS: Final = (
    "OPENBLAS_NUM_THREADS",
    "OMP_NUM_THREADS",
    "MKL_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
)
"""Environment variables that state how many threads the BLAS of a process starts; it reads them
when it is loaded."""

MOST_WORKERS: Final = 512

DEADLY: Final = 2
"""How often a design alone may end its process before its row says so."""

NO_START: Final = (
    "the processes of the pool end as they start; a program that uses the pool must do its own work"
    ' under `if __name__ == "__main__":`, because they import it'
)

Chunk = tuple[Point, ...]

Computed = Future[tuple[tuple[DesignRow, ...], float]]
"""The rows of a chunk, and the seconds that they took."""


class Pool:
    """Computes chunks in processes on this computer; see `camgeo.studies.sweep.rows.Engine`.

    The processes end with this one, however it ends. They import the program that uses the pool, so
    its own work must be under `if __name__ == "__main__"`.

    Parameters
    ----------
    workers : number of processes; GeometryError if it is out of range.
    """

    name = "pool"

    def __init__(self, workers: int | str) -> None:
        if not isinstance(workers, int) or not 1 <= workers <= MOST_WORKERS:
            message = f"must be from 1 to {MOST_WORKERS}"
            raise GeometryError(message, "workers", str(workers))
        self._workers = workers
        self._held: _Processes | None = None

    @contextlib.contextmanager
    def held(self) -> Iterator[None]:
        """See `Engine.held`."""
        with contextlib.closing(_Processes(self._workers)) as self._held:
            try:
                yield
            finally:
                self._held = None

    def rows(self, work: Work, points: Iterator[Point]) -> Chunks:
        """See `Engine.rows`.

        If a process dies, all chunks that were handed out are lost, and any of them may have caused
        it. They are computed again one at a time, and a chunk that ends its process again is split
        into its designs. Raises CamgeoError if processes end before they compute anything.
        """
        pace, suspects = Pace(self._workers), deque[Chunk]()
        deaths: dict[Point, int] = {}
        processes = self._held or _Processes(self._workers)
        running: dict[Computed, Chunk] = {}
        try:
            while True:
                # A suspect runs alone, so that it is known which one ends its process.
                if suspects and not running:
                    chunk = suspects.popleft()
                    running[processes.submit(work, chunk)] = chunk
                alone = len(running) == 1
                while not suspects and len(running) < AHEAD * self._workers:
                    if not (chunk := pace.take(points)):
                        break
                    running[processes.submit(work, chunk)] = chunk
                    alone = False
                if not running:
                    return
                finished, _ = wait(running, return_when=FIRST_COMPLETED)
                lost: list[Chunk] = []
                for future in finished:
                    chunk = running.pop(future)
                    try:
                        chunk_rows, seconds = future.result()
                    except BrokenProcessPool:
                        lost.append(chunk)
                    else:
                        pace.note(len(chunk), seconds)
                        yield chunk_rows
                # One process that dies breaks the whole pool: what still ran is lost too.
                if lost:
                    lost += running.values()
                    running.clear()
                    processes.end()
                    processes.require_to_run()
                    if not alone:
                        suspects.extendleft(reversed(lost))
                    elif len(lost[0]) > 1:
                        suspects.extendleft((point,) for point in reversed(lost[0]))
                    else:
                        (point,) = lost[0]
                        deaths[point] = deaths.get(point, 0) + 1
                        if deaths[point] < DEADLY:
                            suspects.appendleft(lost[0])
                        else:
                            yield (dead(work, point, deaths[point]),)
        finally:
            if running:
                processes.end()
            if processes is not self._held:
                processes.close()


class _Context(SpawnContext):
    """A context that lists the processes it starts, so that they can be ended."""

    def __init__(self) -> None:
        super().__init__()
        self.listed: list[SpawnProcess] = []

    def Process(self, *arguments: Any, **keywords: Any) -> SpawnProcess:  # type: ignore[override]  # a class there
        """See `multiprocessing.context.BaseContext`."""
        self.listed.append(SpawnProcess(*arguments, **keywords))
        return self.listed[-1]


class _Processes:
    """The processes of a pool, started when there is work for them; each has one BLAS thread."""

    def __init__(self, workers: int) -> None:
        self._workers = workers
        self._context = _Context()
        self._executor: ProcessPoolExecutor | None = None

    def submit(self, work: Work, chunk: Chunk) -> Computed:
        """Hand out a chunk; its rows are the result of the future."""
        try:
            with _one_thread():
                try:
                    return self._running.submit(compute_timed_rows, work, chunk)
                except OSError:  # a process died as another was started; now the pool is broken
                    return self._running.submit(compute_timed_rows, work, chunk)
        except BrokenProcessPool as error:  # a process died while none of its chunks was waited for
            failed: Computed = Future()
            failed.set_exception(error)
            return failed

    def require_to_run(self) -> None:
        """Raise CamgeoError if processes end as they start, which no design can have caused."""
        try:
            with _one_thread():
                started = self._running.submit(os.getpid)
            started.result()
        except BrokenProcessPool as error:
            raise CamgeoError(NO_START) from error

    def end(self) -> None:
        """End the processes at once; others are started if there is more work.

        A broken executor ends its processes itself, except one that was being started at that
        moment: it would stay, and the executor might wait for it forever.
        """
        started = [process for process in self._context.listed if process.pid is not None]
        for process in started:
            process.kill()
        self.close(cancelled=True)
        for process in started:
            process.join()
        self._context.listed.clear()

    def close(self, *, cancelled: bool = False) -> None:
        """Let the processes end when they have finished their work."""
        if self._executor is not None:
            self._executor.shutdown(cancel_futures=cancelled)
            self._executor = None

    @property
    def _running(self) -> ProcessPoolExecutor:
        if self._executor is None:
            self._executor = ProcessPoolExecutor(
                self._workers, mp_context=self._context, initializer=_begin
            )
        return self._executor


@contextlib.contextmanager
def _one_thread() -> Iterator[None]:
    """Within this context, processes are started with one BLAS thread each."""
    previous = {name: os.environ.get(name) for name in THREADS}
    os.environ.update(dict.fromkeys(THREADS, "1"))
    try:
        yield
    finally:
        for name, value in previous.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


def _begin() -> None:
    """In a worker: leave Ctrl-C to the parent process, and end with it even if it is killed."""
    with contextlib.suppress(ValueError):
        signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_exit_with_parent, args=(parent.sentinel,), daemon=True).start()


def _exit_with_parent(sentinel: int) -> None:
    """Wait until the parent process has ended, and end this one."""
    connection.wait([sentinel])
    os._exit(1)
