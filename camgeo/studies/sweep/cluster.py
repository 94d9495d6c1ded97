"""The cluster: workers of a Dask scheduler, on one computer or many (`camgeo[cluster]`).

The scheduler forgets: after a restart it knows nothing of what it was given, and it gives up a task
whose workers keep dying. This process therefore keeps what it has handed out, and hands it out
again; finished rows go to the store, which this process alone writes.
"""

from __future__ import annotations

import concurrent.futures
import contextlib
import importlib
import ipaddress
import logging
import pickle
import platform
import queue
import re
import threading
import time
import uuid
import warnings
from collections import deque
from collections.abc import Iterator
from dataclasses import astuple
from functools import lru_cache
from typing import Any, Final

from camgeo.errors import CamgeoError, GeometryError
from camgeo.studies.sweep.family import Point
from camgeo.studies.sweep.rows import (
    AHEAD,
    Chunks,
    DesignRow,
    Pace,
    Versions,
    Work,
    compute_timed_rows,
    dead,
)

ADDRESS: Final = re.compile(
    r"(?P<protocol>tcp|tls)://(?P<host>[\w.-]+|\[[0-9a-fA-F:]+\]):(?P<port>\d{1,5})"
)

EXTRA: Final = "pip install 'camgeo[cluster]'"

REACHED: Final = 5.0
"""Seconds to wait for the first answer of a scheduler."""

RESTARTED: Final = 60.0
"""Seconds to wait for a scheduler that was connected before and is being restarted."""

ABSENT: Final = 60.0
"""Longest time without any worker [s]."""

COUNTED: Final = 2.0
"""Seconds after which workers are counted again, as they come and go."""

SHARE: Final = 0.006
"""Seconds by which a chunk is longer for each worker: twice the processor time that the scheduler
needs for a chunk (`benchmarks/sweep.py`), so that many workers do not wait for it."""

LOOKED: Final = 0.05
"""Interval [s] at which a connection that is being made is checked."""

LOSSES: Final = 5
"""How often in a row everything handed out may be lost, with no chunk finished in between."""

Client = Any
"""A `distributed.Client`; nothing of Dask is imported before an address is given."""

Future = Any
"""A `distributed.Future` of a chunk."""

Chunk = tuple[Point, ...]

Computed = tuple[tuple[DesignRow, ...], float]
"""The rows of a chunk, and the seconds that they took."""

_ONE: Final = threading.Lock()
"""Held while a worker computes a chunk: one at a time."""


class Cluster:
    """Computes chunks by the workers of a scheduler; see `camgeo.studies.sweep.rows.Engine`.

    Parameters
    ----------
    address : of the scheduler, `tcp://HOST:PORT` on this machine or `tls://HOST:PORT`; else
        GeometryError. Certificates are those of the configuration of Dask.
    """

    name = "cluster"

    def __init__(self, address: int | str) -> None:
        match = ADDRESS.fullmatch(str(address))
        if not match or not 1 <= int(match["port"]) <= 65535:
            message = "must be tcp://HOST:PORT or tls://HOST:PORT, with a port up to 65535"
            raise GeometryError(message, "cluster", str(address))
        if match["protocol"] == "tcp" and not _is_here(match["host"].strip("[]")):
            message = (
                "leaves this computer without TLS, so that anybody could run programs on it: use"
                " tls://HOST:PORT, or an SSH tunnel to a port of 127.0.0.1"
            )
            raise GeometryError(message, "cluster", str(address))
        self._address = str(address)

    def rows(self, work: Work, points: Iterator[Point]) -> Chunks:
        """See `Engine.rows`.

        The scheduler gives up a chunk whose workers keep dying. Its designs are then computed one
        at a time, with nothing else handed out, so that it is known which one ends its worker.
        Raises CamgeoError if the scheduler cannot be reached or does not come back, or if there are
        no workers.
        """
        pace, suspects = Pace(), deque[Chunk]()
        alone = False
        with _quiet(), contextlib.closing(_Link(self._address, work)) as link:
            while True:
                if suspects and not link.running:
                    alone = True
                    link.submit(suspects.popleft())
                elif not suspects and not (alone and link.running):
                    alone = False
                    while len(link.running) < AHEAD * link.threads:
                        if not (chunk := pace.take(points)):
                            break
                        link.submit(chunk)
                if not link.running:
                    return
                chunk, outcome = link.finished()
                # A number stands for how often the workers of the chunk died.
                if not isinstance(outcome, int):
                    chunk_rows, seconds = outcome
                    pace.note(len(chunk), seconds, SHARE * link.threads)
                    yield chunk_rows
                elif alone and len(chunk) == 1:
                    yield (dead(work, chunk[0], outcome),)
                else:
                    suspects.extend((point,) for point in chunk)

    def held(self) -> contextlib.AbstractContextManager[None]:
        """See `Engine.held`: the workers of a cluster stay anyway."""
        return contextlib.nullcontext()


class _Link:
    """A connection to a scheduler, and what was handed out to it.

    Attributes
    ----------
    running : chunks that are handed out, by their keys, each with the future of its rows.
    threads : how many chunks the cluster computes at a time; at least 1.
    """

    def __init__(self, address: str, work: Work) -> None:
        self.running: dict[str, tuple[Chunk, Future]] = {}
        self.threads = 1
        self._address = address
        self._versions = astuple(work.versions)
        self._work = pickle.dumps(work)
        self._done: queue.SimpleQueue[Future] = queue.SimpleQueue()
        self._losses = 0
        self._client = _connected(address, REACHED)
        self._seen = time.monotonic()
        self._due = 0.0
        self._count()

    def close(self) -> None:
        """Give up what is handed out, and close the connection."""
        self.running.clear()
        with contextlib.suppress(Exception):  # it ends either way
            self._client.close(timeout=REACHED)

    def submit(self, chunk: Chunk) -> None:
        """Hand out a chunk to whichever worker is free first."""
        key = f"camgeo-{uuid.uuid4()}"
        arguments = (self._versions, self._work, pickle.dumps(chunk))
        future = self._client.submit(compute_chunk, *arguments, key=key, pure=False)
        self.running[key] = chunk, future
        future.add_done_callback(self._done.put)

    def finished(self) -> tuple[Chunk, Computed | int]:
        """The next chunk that is finished, and its rows, or how often its workers died."""
        while True:
            self._count()
            try:
                future = self._done.get(timeout=COUNTED)
            except queue.Empty:
                continue
            if future.key not in self.running:  # of a connection that was lost
                continue
            try:
                outcome = _outcome(future)
            except _LostError:
                self._connect_again()
                continue
            self._losses = 0
            chunk, _ = self.running.pop(str(future.key))
            return chunk, outcome

    def _connect_again(self) -> None:
        """Connect to a scheduler that was restarted, and hand out everything again."""
        self._losses += 1
        if self._losses > LOSSES:
            raise CamgeoError(f"the scheduler at {self._address} keeps losing what it is given")
        chunks = [chunk for chunk, _ in self.running.values()]
        self.running.clear()
        while self._client.status == "connecting":  # by itself, for as long as at first
            time.sleep(LOOKED)
        if self._client.status != "running":
            self.close()
            self._client = _connected(self._address, RESTARTED)
        self._seen = time.monotonic()
        for chunk in chunks:
            self.submit(chunk)

    def _count(self) -> None:
        """Count the threads of all workers; CamgeoError if there have been none for too long."""
        now = time.monotonic()
        if now < self._due:
            return
        self._due = now + COUNTED
        try:
            threads = sum(self._client.nthreads().values())
        except (OSError, concurrent.futures.CancelledError):
            return  # the connection is lost, and so are the chunks: they say so
        if threads:
            self._seen = now
        elif now - self._seen > ABSENT:
            raise CamgeoError(
                f"the cluster at {self._address} has had no worker for {ABSENT:.0f} s;"
                f" `dask worker {self._address} --nthreads 1` starts one"
            )
        self.threads = max(1, threads)


def _is_here(host: str) -> bool:
    """Whether a host name or address is that of this computer."""
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


class _LostError(Exception):
    """The scheduler does not know a chunk any more."""


def _outcome(future: Future) -> Computed | int:
    """The rows of a chunk, or how often its workers died; _LostError if the scheduler lost it."""
    from distributed.scheduler import KilledWorker

    if future.status == "error":
        error = future.exception()
    else:
        try:
            if future.status == "finished":
                outcome: Computed = future.result()
                return outcome
            raise _LostError
        except (OSError, concurrent.futures.CancelledError) as lost:
            raise _LostError from lost
        except KilledWorker as killed:  # after it had finished, before its rows were here
            error = killed
    if isinstance(error, KilledWorker):
        return int(error.allowed_failures) + 1
    if isinstance(error, CamgeoError | MemoryError):
        raise error
    raise CamgeoError(
        f"the cluster cannot run the work of this camgeo: {type(error).__name__}: {error};"
        " scheduler and workers need the same packages as this process"
    ) from error


def compute_chunk(versions: tuple[str, str, str], work: bytes, chunk: bytes) -> Computed:
    """In a worker: the rows of a chunk, and the seconds that they took.

    Versions are compared before anything is unpickled, as the data of another version may have
    another meaning. VersionError, with the worker's address, if they differ. A worker of several
    threads computes one chunk at a time, which is no slower under Python's global lock.
    """
    from distributed import get_worker

    from camgeo.errors import VersionError

    try:
        Versions(*versions).require_here()
    except VersionError as error:
        address = get_worker().address
        raise VersionError(f"{error} (worker {address} on {platform.node()})") from None
    with _ONE:
        return compute_timed_rows(_unpickled_work(work), pickle.loads(chunk))


@lru_cache(maxsize=1)
def _unpickled_work(data: bytes) -> Work:
    """The work, unpickled once: each chunk brings its data, but the scene is built only once."""
    work: Work = pickle.loads(data)
    return work


def _connected(address: str, seconds: float) -> Client:
    """A connection to the scheduler; CamgeoError if there is none within so many seconds."""
    try:
        from distributed import Client
    except ImportError as error:
        name = error.name or "distributed"
        message = f"a cluster needs packages that are not installed ({name}): {EXTRA}"
        raise CamgeoError(message) from error
    try:
        with warnings.catch_warnings():
            # Dask warns of other versions of any package; those that decide the bits of a row are
            # compared by `compute_chunk`.
            warnings.simplefilter("ignore")
            return Client(address, timeout=seconds, set_as_default=False, direct_to_workers=False)
    except Exception as error:  # whatever answers there, and however it is configured
        raise CamgeoError(f"no Dask scheduler can be reached at {address}: {error}") from error


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """Within this context Dask logs nothing: what matters is reported by camgeo's own errors."""
    with contextlib.suppress(ImportError):  # which is reported where a connection is made
        importlib.import_module("distributed")  # states the levels of its loggers
    names = [name for name in logging.root.manager.loggerDict if name.startswith("distributed")]
    levels = {name: logging.getLogger(name).level for name in names}
    for name in names:
        logging.getLogger(name).setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        for name, level in levels.items():
            logging.getLogger(name).setLevel(level)
