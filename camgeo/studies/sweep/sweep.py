"""Runs a sweep: computes the rows that its store lacks, and reads them back."""

from __future__ import annotations

import hashlib
import json
import math
import os
import re
import sqlite3
import sys
import time
import weakref
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Literal

from camgeo.design.design import Design
from camgeo.errors import FileError, OutputError, unreadable
from camgeo.studies.sweep.family import Family, Point, mark
from camgeo.studies.sweep.rows import DesignRow, Engine, Loop, Question, Work, parse_questions
from camgeo.units import clock

Progress = Callable[[str], None]

SETTLED: Final = 3.0
"""Seconds after which the rate is steady enough to estimate how long the rest will take."""


@dataclass(frozen=True, slots=True)
class SweepResult:
    """The rows of a family.

    Attributes
    ----------
    family : the designs.
    questions : the questions that the values of each row answer.
    store : where the rows are; other processes may read a store in a file.
    computed : number of rows that this run computed; the others were there before.
    seconds : time that the run took.
    """

    family: Family
    questions: tuple[Question, ...]
    store: Store
    computed: int
    seconds: float

    @property
    def rows(self) -> Iterator[DesignRow]:
        """The rows in the order of the family, read from the store one after the other."""
        return self.store.rows(self.family.points())

    def close(self) -> None:
        """Close the store; the rows of a store in memory are lost."""
        self.store.close()


def sweep(
    family: Family,
    ask: Iterable[str],
    *,
    store: Path | str | None = None,
    existing: Existing = "refuse",
    engine: Engine | None = None,
    progress: Progress = lambda _: None,
) -> SweepResult:
    """Answer questions for all designs of a family, as far as the store lacks the answers.

    Parameters
    ----------
    ask : questions, see `camgeo.studies.sweep.rows`.
    store : file of the rows, on a local disk; None keeps them in memory.
    existing : what to do with a store that exists; if it is resumed, only rows that it lacks are
        computed.
    engine : where rows are computed; None for one after the other in this process.
    progress : called with words on how far the run is.

    Raises
    ------
    UnknownNameError, GeometryError
        If a question names nothing, or something without a single value.
    OutputError, FileError
        See `Store`. Rows that were finished before are kept.
    VersionError
        If a worker has another version of camgeo, numpy or Python.
    """
    questions = parse_questions(Design(family.scene), ask)
    work = Work.for_family(family, questions)
    path = None if store is None else Path(store)
    row_store = Store(path, Heading.for_family(family, work), existing)
    start = time.monotonic()
    computed = 0
    try:
        there = sum(1 for _ in row_store.rows(family.points())) if row_store.resumed else 0
        if family.sample is not None:
            row_store.state({"method": family.sample.method, "seed": str(family.sample.seed)})
        points = iter(row_store.missing(family.points())) if there else family.points()
        with closing((engine or Loop()).rows(work, points)) as chunks:
            for rows in chunks:
                row_store.add(rows)
                computed += len(rows)
                elapsed = time.monotonic() - start
                progress(progress_words(there + computed, family.count, computed, elapsed))
        row_store.settle()
    except BaseException:
        row_store.close()
        raise
    return SweepResult(family, questions, row_store, computed, time.monotonic() - start)


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


# -- store ----------------------------------------------------------------------------------------
# The store of a sweep: an SQLite file with a row for each design, written chunk by chunk.
#
# A store belongs to a scene, to keys that vary, to questions, and to the versions that decide the
# bits of a row; its rows are identified by the values that make a design. One process at a time
# writes it, and others read it meanwhile. A run that is stopped, in whatever way, leaves all chunks
# that were finished; the next one computes the others. What an earlier run has left is trusted only
# if tables, types and the checksum of each row are right.


Existing = Literal["refuse", "resume", "replace"]
"""What to do with a store that exists."""

ENCODED: Final = json.JSONEncoder(default=repr).encode
"""Encodes cells as text; damaged ones may be of any type."""

KIND: Final = int.from_bytes(b"cams")
"""SQLite's `application_id`, by which a store is recognised however damaged the rest of it is."""

FORMAT: Final = 2
"""Version of the tables, in SQLite's `user_version`; format 1 had neither that nor checksums."""

HEADING: Final = (
    "CREATE TABLE sweep (name TEXT PRIMARY KEY, value TEXT, checksum TEXT) WITHOUT ROWID"
)

FIRST_HEADING: Final = "CREATE TABLE sweep (name TEXT PRIMARY KEY, value TEXT) WITHOUT ROWID"
"""The same table in format 1."""

AT_ONCE: Final = 500
"""Number of points that are looked up in one query."""

MOST_FACTS: Final = 100
"""Largest number of facts that are read from a heading, which has a dozen."""

WHAT: Final = {
    "camgeo": "was computed by another version of camgeo",
    "numpy": "was computed with another version of numpy",
    "python": "was computed with another version of Python",
    "scene": "is of another scene",
    "keys": "varies other keys",
    "asked": "answers other questions",
}
"""What is wrong with a store, by the fact that differs."""

STATED_FACTS: Final = ("camgeo", "numpy", "python", "keys", "asked")
"""Facts of which a message states both values; a hash would tell nothing."""


@dataclass(frozen=True, slots=True)
class Heading:
    """What all rows of a store have in common.

    Attributes
    ----------
    name : name of the scene.
    scene : SHA-256 of all that the scene states, and of the files that designs may name.
    work : keys, questions and versions.
    """

    name: str
    scene: str
    work: Work

    @classmethod
    def for_family(cls, family: Family, work: Work) -> Heading:
        """The heading of the store of a family."""
        digest = hashlib.sha256(family.scene.identity.encode())
        for name, data in work.contents:
            digest.update(f"{name}:{hashlib.sha256(data).hexdigest()}".encode())
        return cls(family.scene.name, digest.hexdigest(), work)

    @property
    def facts(self) -> dict[str, str]:
        """What must be the same for a store to be resumed, by name."""
        versions = self.work.versions
        return {
            "camgeo": versions.camgeo,
            "numpy": versions.numpy,
            "python": versions.python,
            "scene": self.scene,
            "keys": ", ".join(self.work.keys),
            "asked": ", ".join(question.word for question in self.work.questions),
        }


class Store:
    """The rows of a family, in a file or in memory.

    Parameters
    ----------
    path : path of the file; None keeps the rows in memory.
    heading : what all rows have in common; a file with another heading is refused.
    existing : what to do with a store that exists: refuse, resume or replace it.

    Attributes
    ----------
    resumed : whether the file had rows of the family, or at least its heading.

    Raises
    ------
    OutputError
        If the file cannot be written, exists although it is not to be resumed or replaced, lies on
        a network file system, or is being written by another process.
    FileError
        If it is not a store, or one of another scene, other keys or questions, or other versions.
    """

    def __init__(self, path: Path | None, heading: Heading, existing: Existing = "refuse") -> None:
        self.path = path
        self.heading = heading
        self.resumed = False
        self._key = _checksum(list(heading.facts.items()))
        if path is not None:
            _require_place(path, existing)
        self._file = None if path is None else connected(path)
        self._open = connected(None)
        self._end = weakref.finalize(self, _close, self._open, self._file)
        try:
            with translated_errors(path):
                self._prepare(existing)
        except BaseException:
            self.close()
            raise

    def _prepare(self, existing: Existing) -> None:
        """Continue with the rows of the file, or begin a new store in memory.

        A new store is written to the file only when its first rows are finished, so that a file
        that is replaced stays until then.
        """
        if self._file is not None:
            if existing == "replace":  # its schema may be damaged, as it is not needed any more
                self._file.execute("PRAGMA writable_schema = ON")
            (kind,) = self._file.execute("PRAGMA application_id").fetchone()
            take_writing(self._file)
            self.resumed = self._is_resumed(self._file, kind, existing)
            if self.resumed:
                self._open, self._file = self._file, None
                return
        self._open.execute(HEADING)
        self._open.execute(self._designs)
        self._open.execute(f"PRAGMA application_id = {KIND}")
        self._open.execute(f"PRAGMA user_version = {FORMAT}")
        self._state(
            {**self.heading.facts, "name": self.heading.name, "text": self.heading.work.text}
        )

    def _is_resumed(self, file: sqlite3.Connection, kind: int, existing: Existing) -> bool:
        """Whether the file has rows of this family; FileError if that cannot be told.

        At first only SQLite's own tables are read, until they show that the tables of the store are
        as they were made: a view in place of a table could compute without end.
        """
        if kind == KIND and existing == "replace":
            return False
        schema_entries = file.execute("SELECT type, name, sql FROM sqlite_master").fetchall()
        tables = {name: sql for _, name, sql in schema_entries}
        if kind != KIND:
            if not schema_entries:
                return False
            if tables.get("sweep") != FIRST_HEADING:
                raise FileError(f"{self.path} is a database of another program; {ELSEWHERE}")
            if existing == "replace":
                return False
            raise FileError(f"{self.path} is a store of format 1, without checksums; {ANEW}")
        (number,) = file.execute("PRAGMA user_version").fetchone()
        if number != FORMAT:
            raise FileError(f"{self.path} is a store of format {number}, not {FORMAT}; {ANEW}")
        if tables.get("sweep") != HEADING:
            raise self._damaged("its table of facts about all rows was changed")
        self._refuse_others(self._facts(file))
        if tables.get("designs") != self._designs or any(
            entry[0] == "trigger" for entry in schema_entries
        ):
            raise self._damaged("its table of designs was changed")
        # Not the quick check: it overlooks keys in a wrong order, some of which are not found
        # later.
        (integrity,) = file.execute("PRAGMA integrity_check(1)").fetchone()
        if integrity != "ok":
            raise self._damaged(" ".join(integrity.split()))
        return True

    def _facts(self, file: sqlite3.Connection) -> dict[str, str]:
        """The facts in the heading of the file."""
        facts = {}
        for name, value, checksum in file.execute(f"SELECT * FROM sweep LIMIT {MOST_FACTS}"):
            if checksum != _checksum([name, value]):
                raise self._damaged(f"what it states as {name!r} was changed")
            facts[name] = value
        return facts

    def _refuse_others(self, known: Mapping[str, str]) -> None:
        facts = self.heading.facts
        for name, what in WHAT.items():
            if name not in known:
                raise self._damaged(f"it lacks {name!r}")
            if known[name] != facts[name]:
                difference = (
                    f": {known[name]} in place of {facts[name]}" if name in STATED_FACTS else ""
                )
                raise FileError(f"{self.path} {what}{difference}; {ANEW}, or name another file")

    def _damaged(self, what: str) -> FileError:
        return FileError(f"{self.path} is damaged: {what}; {ANEW}")

    @property
    def _designs(self) -> str:
        """The SQL statement that makes the table of designs."""
        work = self.heading.work
        columns = [
            _quoted(name) for name in (*work.keys, *(question.word for question in work.questions))
        ]
        column_list = "".join(f"{column}, " for column in columns)
        return (
            f"CREATE TABLE designs (point TEXT PRIMARY KEY, {column_list}units TEXT, reason TEXT,"
            " checksum TEXT) WITHOUT ROWID"
        )

    def _replace(self, file: sqlite3.Connection) -> None:
        """Replace the contents of the file by what is in memory, as a whole or not at all."""
        replace_contents(file, self._open)
        self._open.close()
        self._open, self._file = file, None
        share_reading(self._open)

    def state(self, sampled: Mapping[str, str]) -> None:
        """Record how designs were drawn last, as the seed; no row depends on it."""
        self._state({f"sample {name}": value for name, value in sampled.items()})

    def _state(self, facts: Mapping[str, str]) -> None:
        rows = [(*fact, _checksum(fact)) for fact in facts.items()]
        self._write("INSERT OR REPLACE INTO sweep VALUES (?, ?, ?)", rows)

    def missing(self, points: Iterable[Point]) -> Iterator[Point]:
        """The points that have no row yet, in their order."""
        for group in _grouped(points):
            known = self._known(group, "point")
            yield from (point for point in group if mark(point) not in known)

    def rows(self, points: Iterable[Point]) -> Iterator[DesignRow]:
        """The rows of the points that have one, in their order; FileError if a row was changed
        since it was computed.
        """
        for group in _grouped(points):
            known = self._known(group, "*")
            for point in group:
                if (stored := known.get(mark(point))) is not None:
                    yield self._row(point, stored)

    def _row(self, point: Point, stored: Sequence[Any]) -> DesignRow:
        work = self.heading.work
        *cells, checksum = stored
        if checksum != _checksum(cells, self._key):
            design = ", ".join(map("{} = {}".format, work.keys, point))
            raise self._damaged(f"the row of {design} was changed")
        values = cells[1 + len(work.keys) : -2]
        return DesignRow(point, tuple(values), tuple(json.loads(cells[-2])), cells[-1])

    def _known(self, points: Sequence[Point], columns: str) -> dict[str, tuple[Any, ...]]:
        marks = ", ".join("?" * len(points))
        query = f"SELECT {columns} FROM designs WHERE point IN ({marks})"
        with translated_errors(self.path):
            cursor = self._open.execute(query, [mark(point) for point in points])
            return {row[0]: row for row in cursor}

    def add(self, rows: Sequence[DesignRow]) -> None:
        """Store rows, all or none; OutputError if the disk is full, with earlier rows kept."""
        work = self.heading.work
        marks = ", ".join("?" * (4 + len(work.keys) + len(work.questions)))
        cells = [
            (mark(row.point), *row.point, *row.values, json.dumps(row.units), row.reason)
            for row in rows
        ]
        sqlite_rows = [tuple(map(_sqlite_value, row)) for row in cells]
        sqlite_rows = [(*row, _checksum(row, self._key)) for row in sqlite_rows]
        self._write(f"INSERT INTO designs VALUES ({marks})", sqlite_rows)
        if self._file is not None:
            with translated_errors(self.path):
                self._replace(self._file)

    def _write(self, query: str, rows: Sequence[Sequence[Any]]) -> None:
        """Write all rows or none; the lock for writing is released for a moment only, see
        `take_writing`.
        """
        with translated_errors(self.path):
            share_reading(self._open)
            if not self._open.in_transaction:
                self._open.execute("BEGIN IMMEDIATE")
            with self._open:
                self._open.executemany(query, rows)
            self._open.execute("BEGIN IMMEDIATE")

    def settle(self) -> None:
        """Move everything from the write-ahead log into the one file.

        If another process is reading it at that moment, SQLite does so when the last one closes it.
        """
        if self.path is None:
            return
        with translated_errors(self.path):
            if self._file is not None:
                self._replace(self._file)
            self._open.commit()
            self._open.execute("PRAGMA busy_timeout = 0")  # readers are not waited for
            with suppress(sqlite3.OperationalError):
                self._open.execute("PRAGMA journal_mode = DELETE")

    def close(self) -> None:
        """Close the file; rows in memory are gone."""
        self._end()


def _close(*connections: sqlite3.Connection | None) -> None:
    for database in connections:
        if database is not None:
            database.close()


def _require_place(path: Path, existing: Existing) -> None:
    """Raise OutputError if there can be no store at `path`, or if one exists and is refused."""
    try:
        if path.exists() and existing == "refuse":
            message = "exists: resume it, replace it, or name another file"
            raise OutputError(f"{path} {message}")
        require_local(path)
    except OutputError:
        raise
    except (OSError, RuntimeError, ValueError) as error:  # a loop of links is a RuntimeError
        raise OutputError(f"{path} cannot be written: {unreadable(error)}") from error


def _checksum(cells: Sequence[object], key: str = "") -> str:
    """Checksum of the cells of a row and of its heading's `key`; it depends on types too."""
    return hashlib.sha256(ENCODED([key, *cells]).encode()).hexdigest()


def _sqlite_value(value: object) -> object:
    """A value in the type in which SQLite returns it: no booleans, and no NaN."""
    if isinstance(value, bool):
        return int(value)
    return None if isinstance(value, float) and math.isnan(value) else value


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


# -- database -------------------------------------------------------------------------------------
# The database of a store: a file that one process writes and others read, and its errors.
#
# The process that writes holds SQLite's write lock while it computes. The journal of the file is a
# write-ahead log, so that others can read what is finished. Queries are bounded, whatever the file
# contains.


MEMORY: Final = ":memory:"

MOST_STEPS: Final = 10**8
"""Largest number of SQLite instructions in one query, about two seconds; a check of 1,000,000 rows
takes a tenth of that."""

LONGEST: Final = 2**26
"""Largest size of a cell [bytes], 64 MB: more than any scene."""

PATIENCE: Final = 5000
"""Milliseconds for which the process that writes waits for others to finish reading."""

SHARED: Final = (("wal",), ("memory",))
"""Answers of SQLite to which journal it has: one with which others can read, or rows in memory."""

PAUSE: Final = 0.05
"""Seconds within which a process that writes takes its lock back, between two chunks."""

ANEW: Final = "it was not changed; --force makes it anew"

BUSY: Final = "another process is writing it; only one at a time may"

ELSEWHERE: Final = "it was not changed: name another file, or delete it"

IN_USE: Final = (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED)

OF_THE_DISK: Final = (
    sqlite3.SQLITE_PERM, sqlite3.SQLITE_NOMEM, sqlite3.SQLITE_READONLY, sqlite3.SQLITE_IOERR,
    sqlite3.SQLITE_CANTOPEN, sqlite3.SQLITE_AUTH,
)  # fmt: skip
"""Errors of SQLite that are not about the contents of the file."""


@contextmanager
def translated_errors(path: Path | None) -> Iterator[None]:
    """Within this context, errors of SQLite become errors of camgeo with the file and a remedy."""
    name = "the rows in memory" if path is None else str(path)
    try:
        yield
    except (sqlite3.Error, UnicodeDecodeError) as error:  # messages quote what the file has
        code = getattr(error, "sqlite_errorcode", 0) & 0xFF
        if code in IN_USE:
            raise OutputError(f"{name}: {BUSY}") from error
        if code == sqlite3.SQLITE_FULL:
            message = "the disk is full; the rows finished before are kept, resume the run later"
            raise OutputError(f"{name}: {message}") from error
        # A header that names a later SQLite makes a file read-only, whatever the disk allows.
        if code == sqlite3.SQLITE_READONLY and path is not None and os.access(path, os.W_OK):
            code = sqlite3.SQLITE_NOTADB
        if code in OF_THE_DISK:
            raise OutputError(f"{name} cannot be written: {error}") from error
        if code == sqlite3.SQLITE_NOTADB:
            message = f"is not a store of a sweep, or is too damaged to be one; {ELSEWHERE}"
            raise FileError(f"{name} {message}") from error
        raise FileError(f"{name} is damaged: {error}; {ANEW}") from error


def connected(path: Path | None) -> sqlite3.Connection:
    """A connection to a file, or to rows in memory; it does not wait for a process that writes."""
    try:
        database = sqlite3.connect(
            MEMORY if path is None else path, timeout=0.0, isolation_level=None
        )
    except (sqlite3.Error, OSError, ValueError) as error:
        raise OutputError(f"{path} cannot be written: {unreadable(error)}") from error
    database.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, LONGEST)
    database.set_progress_handler(lambda: 1, MOST_STEPS)
    return database


def take_writing(file: sqlite3.Connection) -> None:
    """Become the one process that writes a file.

    That process holds SQLite's write lock while it computes, and releases it after each chunk for a
    moment. Whoever gets the lock in that moment must not keep it; so it is requested twice, with a
    pause between.
    """
    file.execute("BEGIN IMMEDIATE")
    file.rollback()
    time.sleep(PAUSE)
    file.execute("BEGIN IMMEDIATE")
    file.execute(f"PRAGMA busy_timeout = {PATIENCE}")


def share_reading(database: sqlite3.Connection) -> None:
    """Let others read a file that this process writes; for rows in memory there is no need."""
    if database.execute("PRAGMA journal_mode").fetchone() not in SHARED:
        database.rollback()
        database.execute("PRAGMA journal_mode = WAL")
        database.execute("BEGIN IMMEDIATE")


def replace_contents(file: sqlite3.Connection, memory: sqlite3.Connection) -> None:
    """Replace all that a file has by what is in memory, in one step, however damaged it is."""

    def require_free(status: int, *_: int) -> None:
        if status in IN_USE:  # which SQLite's own copying would wait for without end
            error = sqlite3.OperationalError("database is locked")
            error.sqlite_errorcode = status
            raise error

    memory.rollback()
    file.rollback()
    memory.backup(file, progress=require_free)
    file.execute("PRAGMA writable_schema = OFF")


# -- local ----------------------------------------------------------------------------------------
# Whether a file lies on a disk of this computer: SQLite's locks do not work across a network.


NETWORKED: Final = frozenset(
    {
        "afs", "beegfs", "ceph", "cifs", "coda", "fuse.ceph", "fuse.cephfs", "fuse.glusterfs",
        "fuse.rclone", "fuse.s3fs", "fuse.sshfs", "gfs2", "glusterfs", "gpfs", "lustre", "ncpfs",
        "nfs", "nfs4", "ocfs2", "orangefs", "pvfs2", "smb3", "smbfs",
    }
)  # fmt: skip
"""Types of network file systems, as Linux names them."""

MOUNTS: Final = Path("/proc/self/mounts")

REMOTE_DRIVE: Final = 4
"""Type of a network drive, as Windows numbers it."""


def require_local(path: Path) -> None:
    """Raise OutputError if `path` lies on a network file system.

    That is known on Linux and Windows; elsewhere every file passes.
    """
    kind = file_system_kind(path.resolve())
    if kind in NETWORKED:
        raise OutputError(
            f"{path} lies on a network file system ({kind}), on which a store may be damaged: name"
            " a file on a local disk, and copy it when the run has ended"
        )


def file_system_kind(path: Path) -> str:
    """The type of the file system of an absolute path; empty if it is not known."""
    if sys.platform == "win32":
        return "smbfs" if _is_remote(path) else ""
    try:
        lines = MOUNTS.read_text("utf-8", "surrogateescape").splitlines()
    except OSError:
        return ""
    return mounted(lines, path)


def mounted(lines: list[str], path: Path) -> str:
    """The type of the file system of a path, from the mounts as Linux lists them."""
    longest, kind = -1, ""
    for line in lines:
        fields = line.split()
        if len(fields) < 3:
            continue
        # Spaces and other characters in mount points are written as octal numbers.
        place = re.sub(r"\\([0-7]{3})", lambda octal: chr(int(octal[1], 8)), fields[1])
        inside = path.is_relative_to(place)
        if inside and len(place) >= longest:  # the last one mounted at a place hides the others
            longest, kind = len(place), fields[2]
    return kind


def _is_remote(path: Path) -> bool:
    if str(path).startswith("\\\\"):
        return True
    import ctypes

    drive = os.path.splitdrive(path)[0] + "\\"
    kernel = ctypes.windll.kernel32  # type: ignore[attr-defined]  # there is one on Windows
    return bool(kernel.GetDriveTypeW(drive) == REMOTE_DRIVE)
