"""Running a sweep: what is missing in its store is computed, and its rows are read back."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from camgeo.design import Design
from camgeo.sweep.asked import Asked, asked_of
from camgeo.sweep.engine import Engine, Loop
from camgeo.sweep.family import Family
from camgeo.sweep.rows import Row, Work
from camgeo.sweep.store import Existing, Heading, Store
from camgeo.wording import clock

Progress = Callable[[str], None]

SETTLED: Final = 3.0
"""Seconds after which the rate says how long the rest will take."""


@dataclass(frozen=True, slots=True)
class Result:
    """The rows of a family.

    Attributes
    ----------
    family : whose designs they are.
    asked : what the values of each row answer.
    store : has the rows; of one in a file others may read the file.
    computed : rows that this run computed; the others were there.
    seconds : that it took.
    """

    family: Family
    asked: tuple[Asked, ...]
    store: Store
    computed: int
    seconds: float

    @property
    def rows(self) -> Iterator[Row]:
        """The rows in the order of the family, read from the store as they are asked for."""
        return self.store.rows(self.family.points())

    def close(self) -> None:
        """Close the store: rows of one in memory are gone."""
        self.store.close()


def sweep(
    family: Family,
    ask: Iterable[str],
    *,
    store: Path | str | None = None,
    existing: Existing = "refuse",
    engine: Engine | None = None,
    progress: Progress = lambda _: None,
) -> Result:
    """Compute what is asked of the designs of a family, as far as the store does not have it.

    Parameters
    ----------
    ask : names, see `camgeo.sweep.asked`.
    store : file of the rows, on a local disk; None keeps them in memory.
    existing : what becomes of a store that exists; of one that is resumed, only what it lacks is
        computed.
    engine : where rows are computed; None for one after the other, in this process.
    progress : called with words on how far the run is.

    Raises
    ------
    UnknownNameError, GeometryError
        If what is asked has no name or no single value.
    OutputError, FileError
        As `camgeo.sweep.store.Store`. Rows that were finished before are kept.
    VersionError
        If a worker has another version of camgeo, numpy or Python.
    """
    asked = asked_of(Design(family.scene), ask)
    work = Work.of(family, asked)
    path = None if store is None else Path(store)
    kept = Store(path, Heading.of(family, work), existing)
    start = time.monotonic()
    computed = 0
    try:
        there = sum(1 for _ in kept.rows(family.points())) if kept.resumed else 0
        if family.sample is not None:
            kept.state({"method": family.sample.method, "seed": str(family.sample.seed)})
        points = iter(kept.missing(family.points())) if there else family.points()
        with closing((engine or Loop()).rows(work, points)) as chunks:
            for rows in chunks:
                kept.add(rows)
                computed += len(rows)
                elapsed = time.monotonic() - start
                progress(progress_words(there + computed, family.count, computed, elapsed))
        kept.settle()
    except BaseException:
        kept.close()
        raise
    return Result(family, asked, kept, computed, time.monotonic() - start)


def progress_words(done: int, count: int, computed: int, elapsed: float) -> str:
    """How far a run is, how fast, and how long the rest will take."""
    words = f"{done:,} of {count:,} designs"
    if elapsed <= 0.0:
        return words
    rate = computed / elapsed
    words += f", {rate:.3g}/s"
    if elapsed < SETTLED:
        return words
    return f"{words}, {clock((count - done) / rate)} left"
