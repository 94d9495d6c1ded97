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
from itertools import islice
from typing import Final, Protocol

from camgeo.errors import GeometryError, UnknownNameError
from camgeo.sweep.family import Point
from camgeo.sweep.rows import Row, Work, rows_of

CHUNK: Final = 1.0
"""Seconds that a chunk of designs should take: far more than the 6 ms that handing one over costs,
and no more than a run should lose when it is stopped."""

MOST_IN_CHUNK: Final = 1000

GROWTH: Final = 8
"""Largest factor from one chunk to the next: the first designs may be no measure of the others."""

MOST_WORKERS: Final = 512


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


class Pace:
    """How many designs make a chunk of about a second, from the chunks so far."""

    def __init__(self) -> None:
        self._size = 1

    def take(self, points: Iterator[Point]) -> tuple[Point, ...]:
        """The points of the next chunk; none if there are none left."""
        return tuple(islice(points, self._size))

    def note(self, count: int, seconds: float) -> None:
        """A chunk of so many designs took so long."""
        fitting = int(CHUNK * count / max(seconds, 1e-9))
        self._size = max(1, min(fitting, GROWTH * self._size, MOST_IN_CHUNK))


class Loop:
    """Computes one design after the other, in this process."""

    name = "loop"

    def __init__(self, _workers: int = 1) -> None:
        pass

    def rows(self, work: Work, points: Iterator[Point]) -> Chunks:
        """See `Engine.rows`."""
        pace = Pace()
        while chunk := pace.take(points):
            start = time.perf_counter()
            found = rows_of(work, chunk)
            pace.note(len(chunk), time.perf_counter() - start)
            yield found


ENGINES: Final = {
    "loop": "camgeo.sweep.engine:Loop",
    "pool": "camgeo.sweep.pool:Pool",
}
"""The classes of engines by their names; each takes the number of workers."""


def engine_of(name: str, workers: int = 1) -> Engine:
    """The engine `name` with so many workers.

    Raises UnknownNameError if there is none, GeometryError for a number of workers it cannot have.
    """
    if name not in ENGINES:
        raise UnknownNameError("engine", name, ENGINES)
    if not 1 <= workers <= MOST_WORKERS:
        message = f"must be from 1 to {MOST_WORKERS}"
        raise GeometryError(message, "workers", str(workers))
    found: Engine = pkgutil.resolve_name(ENGINES[name])(workers)
    return found
