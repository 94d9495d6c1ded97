"""The store of a sweep: an SQLite file with a row for each design, written chunk by chunk.

It is keyed by the scene, by what varies and what is asked, and by the versions that decide the bits
of a row; the rows by the values that make a design. One process at a time writes it. A run that is
stopped, in whatever way, leaves all chunks that were finished; the next one computes the others.
"""

from __future__ import annotations

import hashlib
import json
import sqlite3
import weakref
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Literal

from camgeo.errors import FileError, OutputError, unreadable
from camgeo.sweep.family import Family, Point, mark
from camgeo.sweep.local import require_local
from camgeo.sweep.rows import Row, Work

Existing = Literal["refuse", "resume", "replace"]
"""What becomes of a store that exists."""

FORMAT: Final = "camgeo sweep 1"
"""Version of the tables."""

MEMORY: Final = ":memory:"

AT_ONCE: Final = 500
"""Points that are looked up in one query."""

WHAT: Final = {
    "format": "is a store of another format",
    "camgeo": "was computed by another version of camgeo",
    "numpy": "was computed with another version of numpy",
    "python": "was computed with another version of Python",
    "scene": "is of another scene",
    "keys": "varies other keys",
    "asked": "answers other questions",
}
"""What is wrong with a store, by what differs."""

SHOWN: Final = ("camgeo", "numpy", "python", "keys", "asked")
"""What a message states of both; a hash tells nothing."""


@dataclass(frozen=True, slots=True)
class Heading:
    """What all rows of a store have in common.

    Attributes
    ----------
    name : of the scene.
    scene : SHA-256 of all it states, and of the files that designs may name.
    work : keys, what is asked, versions.
    """

    name: str
    scene: str
    work: Work

    @classmethod
    def of(cls, family: Family, work: Work) -> Heading:
        """The heading of a family."""
        found = hashlib.sha256(family.scene.identity.encode())
        for name, data in work.contents:
            found.update(f"{name}:{hashlib.sha256(data).hexdigest()}".encode())
        return cls(family.scene.name, found.hexdigest(), work)

    @property
    def facts(self) -> dict[str, str]:
        """By name, what must be the same."""
        versions = self.work.versions
        return {
            "format": FORMAT,
            "camgeo": versions.camgeo,
            "numpy": versions.numpy,
            "python": versions.python,
            "scene": self.scene,
            "keys": ", ".join(self.work.keys),
            "asked": ", ".join(each.word for each in self.work.asked),
        }


class Store:
    """The rows of a family, in a file or in memory.

    Parameters
    ----------
    path : of the file; None keeps the rows in memory.
    heading : what is kept; a file with another one is refused.
    existing : what becomes of a store that exists: it is refused, resumed, or replaced.

    Raises
    ------
    OutputError
        If the file cannot be written, exists though nothing is resumed, lies on a network file
        system, or another process writes it.
    FileError
        If it is no store, or one of another scene, other keys or questions, or other versions.
    """

    def __init__(self, path: Path | None, heading: Heading, existing: Existing = "refuse") -> None:
        self.path = path
        self.heading = heading
        if path is not None:
            _require_place(path, existing)
        self._open = _connected(path)
        self._end = weakref.finalize(self, self._open.close)
        try:
            with _as_ours(path):
                self._prepare(existing)
        except BaseException:
            self.close()
            raise

    def _prepare(self, existing: Existing) -> None:
        database = self._open
        # The lock is taken before anything is read, and kept until the store is settled.
        database.execute("PRAGMA locking_mode=EXCLUSIVE")
        database.execute("BEGIN EXCLUSIVE")
        known = _facts(database)
        if not known and database.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]:
            raise FileError(f"{self.path} is a database of another program; it was not changed")
        if known and existing == "replace":
            database.execute("DROP TABLE designs")
            database.execute("DROP TABLE sweep")
            known = {}
        if known:
            self._refuse_others(known)
        else:
            self._create()
        database.execute("COMMIT")
        database.execute("PRAGMA journal_mode=WAL")

    def _refuse_others(self, known: Mapping[str, str]) -> None:
        facts = self.heading.facts
        for name, what in WHAT.items():
            if known.get(name) != facts[name]:
                shown = f": {known.get(name)} in place of {facts[name]}" if name in SHOWN else ""
                raise FileError(f"{self.path} {what}{shown}; nothing of it was changed")

    def _create(self) -> None:
        work = self.heading.work
        self._open.execute("CREATE TABLE sweep (name TEXT PRIMARY KEY, value TEXT) WITHOUT ROWID")
        facts = {**self.heading.facts, "name": self.heading.name, "text": work.text}
        self._open.executemany("INSERT INTO sweep VALUES (?, ?)", facts.items())
        columns = [_quoted(name) for name in (*work.keys, *(each.word for each in work.asked))]
        own = "".join(f"{column}, " for column in columns)
        self._open.execute(
            f"CREATE TABLE designs (point TEXT PRIMARY KEY, {own}units TEXT, reason TEXT)"
            " WITHOUT ROWID"
        )

    def state(self, sampled: Mapping[str, str]) -> None:
        """Record how designs were drawn last, e.g. the seed; no row depends on it."""
        with _as_ours(self.path), self._open:
            rows = ((f"sample {name}", value) for name, value in sampled.items())
            self._open.executemany("INSERT OR REPLACE INTO sweep VALUES (?, ?)", rows)

    def __len__(self) -> int:
        """How many rows there are."""
        with _as_ours(self.path):
            found: int = self._open.execute("SELECT count(*) FROM designs").fetchone()[0]
            return found

    def missing(self, points: Iterable[Point]) -> Iterator[Point]:
        """Those of the points, in their order, that have no row yet."""
        for group in _grouped(points):
            known = self._known(group, "point")
            yield from (point for point in group if mark(point) not in known)

    def rows(self, points: Iterable[Point]) -> Iterator[Row]:
        """The rows of those of the points that have one, in their order."""
        work = self.heading.work
        first = 1 + len(work.keys)
        for group in _grouped(points):
            known = self._known(group, "*")
            for point in group:
                if (found := known.get(mark(point))) is not None:
                    values = found[first : first + len(work.asked)]
                    units = tuple(json.loads(found[-2]))
                    yield Row(point, tuple(values), units, found[-1])

    def _known(self, points: Sequence[Point], columns: str) -> dict[str, tuple[Any, ...]]:
        marks = ", ".join("?" * len(points))
        query = f"SELECT {columns} FROM designs WHERE point IN ({marks})"
        with _as_ours(self.path):
            found = self._open.execute(query, [mark(point) for point in points])
            return {row[0]: row for row in found}

    def add(self, rows: Sequence[Row]) -> None:
        """Keep rows, all or none; OutputError if the disk is full: earlier ones are kept."""
        work = self.heading.work
        marks = ", ".join("?" * (3 + len(work.keys) + len(work.asked)))
        cells = [
            (mark(row.point), *row.point, *row.values, json.dumps(row.units), row.reason)
            for row in rows
        ]
        with _as_ours(self.path), self._open:
            self._open.execute("BEGIN IMMEDIATE")
            self._open.executemany(f"INSERT INTO designs VALUES ({marks})", cells)

    def settle(self) -> None:
        """Move everything into the one file; others may read it from now on."""
        if self.path is None:
            return
        with _as_ours(self.path):
            self._open.execute("PRAGMA wal_checkpoint(TRUNCATE)")
            self._open.execute("PRAGMA journal_mode=DELETE")
            self._open.execute("PRAGMA locking_mode=NORMAL")
            self._open.execute("SELECT count(*) FROM sweep")  # gives the lock back

    def close(self) -> None:
        """Close the file; rows in memory are gone."""
        self._end()


def _require_place(path: Path, existing: Existing) -> None:
    """OutputError if there can be no store, or none may be there."""
    try:
        if path.exists() and existing == "refuse":
            message = "exists: resume it, replace it, or name another file"
            raise OutputError(f"{path} {message}")
        require_local(path)
    except OutputError:
        raise
    except (OSError, RuntimeError, ValueError) as error:  # a loop of links is a RuntimeError
        raise OutputError(f"{path} cannot be written: {unreadable(error)}") from error


@contextmanager
def _as_ours(path: Path | None) -> Iterator[None]:
    """Errors of SQLite within it become errors of camgeo, with the file and what to do."""
    name = "the rows in memory" if path is None else str(path)
    try:
        yield
    except sqlite3.Error as error:
        code = getattr(error, "sqlite_errorcode", 0) & 0xFF
        if code in (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED):
            message = "another process writes it; only one at a time may"
            raise OutputError(f"{name}: {message}") from error
        if code == sqlite3.SQLITE_FULL:
            message = "the disk is full; the rows finished before are kept, resume the run later"
            raise OutputError(f"{name}: {message}") from error
        if code in (sqlite3.SQLITE_NOTADB, sqlite3.SQLITE_CORRUPT):
            raise FileError(f"{name} is no store of a sweep, or is damaged") from error
        raise OutputError(f"{name} cannot be written: {error}") from error


def _connected(path: Path | None) -> sqlite3.Connection:
    try:
        return sqlite3.connect(MEMORY if path is None else path, timeout=0.0, isolation_level=None)
    except (sqlite3.Error, OSError, ValueError) as error:
        raise OutputError(f"{path} cannot be written: {unreadable(error)}") from error


def _facts(database: sqlite3.Connection) -> dict[str, str]:
    """What a store states of itself; nothing if it is none."""
    query = "SELECT name FROM sqlite_master WHERE type = 'table' AND name = 'sweep'"
    if database.execute(query).fetchone() is None:
        return {}
    return dict(database.execute("SELECT name, value FROM sweep"))


def _grouped(points: Iterable[Point]) -> Iterator[list[Point]]:
    group: list[Point] = []
    for point in points:
        group.append(point)
        if len(group) == AT_ONCE:
            yield group
            group = []
    if group:
        yield group


def _quoted(name: str) -> str:
    doubled = name.replace('"', '""')
    return f'"{doubled}"'
