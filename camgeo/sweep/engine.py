"""Engines compute the rows of a family: where, and how many at a time.

An engine has a name and `rows`; it is registered in `ENGINES` by the place of its class, which is
imported when it is asked for. It neither writes the store nor decides what is computed: it takes
points from the iterator as it can use them, and gives back rows in any order. If its iterator is
closed, it ends what it has started. A row depends on its design alone, so all engines give the same
rows.
"""

from __future__ import annotations

import pkgutil
import time
from collections.abc import Generator, Iterator
from contextlib import AbstractContextManager, nullcontext
from itertools import islice
from operator import length_hint
from typing import Final, Protocol

from camgeo.errors import UnknownNameError
from camgeo.sweep.family import Point
from camgeo.sweep.rows import Row, Work, rows_of
from camgeo.wording import counted

CHUNK: Final = 1.0
"""Seconds that a chunk of designs should take: far more than the 6 ms that handing one over costs,
and no more than a run should lose when it is stopped."""

MOST_IN_CHUNK: Final = 1000

GROWTH: Final = 8
"""Largest factor from one chunk to the next: the first designs may be no measure of the others."""

AHEAD: Final = 2
"""Chunks handed out for each worker: one is computed, the next one is there when it is done."""

DIED: Final = "the process that computed it died, {times}: killed, or out of memory"


Chunks = Generator[tuple[Row, ...], None, None]
"""Rows in chunks, as they are finished; closing it ends the work."""


class Engine(Protocol):
    """Where rows are computed."""

    @property
    def name(self) -> str: ...

    def rows(self, work: Work, points: Iterator[Point]) -> Chunks:
        """The rows of all points, in any order, in chunks as they are finished.

        A worker that dies costs its chunk a second computation. A design that keeps ending its
        worker is a row that says so. Raises VersionError if a worker has other versions.
        """
        ...

    def held(self) -> AbstractContextManager[None]:
        """Within it, the workers of one call of `rows` stay for the next one."""
        ...


class Pace:
    """How many designs make a chunk of about a second, from the chunks so far.

    Parameters
    ----------
    workers : that share the designs; where it is known how few are left, each gets some of them.
    """

    def __init__(self, workers: int = 1) -> None:
        self._size = 1
        self._workers = workers

    def take(self, points: Iterator[Point]) -> tuple[Point, ...]:
        """The points of the next chunk; none if there are none left."""
        share = -(-length_hint(points, MOST_IN_CHUNK * self._workers) // self._workers)
        return tuple(islice(points, min(self._size, max(share, 1))))

    def note(self, count: int, seconds: float, least: float = 0.0) -> None:
        """A chunk of so many designs took so long; the next ones take at least `least` seconds."""
        fitting = int(max(CHUNK, least) * count / max(seconds, 1e-9))
        self._size = max(1, min(fitting, GROWTH * self._size, MOST_IN_CHUNK))


class Loop:
    """Computes one design after the other, in this process."""

    name = "loop"

    def __init__(self, _where: int | str = 1) -> None:
        pass

    def rows(self, work: Work, points: Iterator[Point]) -> Chunks:
        """See `Engine.rows`."""
        pace = Pace()
        while chunk := pace.take(points):
            start = time.perf_counter()
            found = rows_of(work, chunk)
            pace.note(len(chunk), time.perf_counter() - start)
            yield found

    def held(self) -> AbstractContextManager[None]:
        """See `Engine.held`: there is no other process."""
        return nullcontext()


ENGINES: Final = {
    "loop": "camgeo.sweep.engine:Loop",
    "pool": "camgeo.sweep.pool:Pool",
    "cluster": "camgeo.sweep.cluster:Cluster",
}
"""The classes of engines by their names; each takes where it computes: the pool the number of its
processes, a cluster its address."""


def engine_of(name: str, where: int | str = 1) -> Engine:
    """The engine `name` that computes there.

    Raises UnknownNameError if there is none, GeometryError for a number of workers or an address
    that it cannot have.
    """
    if name not in ENGINES:
        raise UnknownNameError("engine", name, ENGINES)
    found: Engine = pkgutil.resolve_name(ENGINES[name])(where)
    return found


def dead(work: Work, point: Point, times: int) -> Row:
    """The row of a design that ended its process so many times."""
    return work.nothing(point, DIED.format(times=counted(times, "time")))
