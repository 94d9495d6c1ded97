"""SQLite's side of a store: a file that one process writes and others read, and its errors.

The process that writes holds SQLite's lock for writing while it computes; the file's journal is a
write-ahead log, so that others read what is finished. Queries are bounded, whatever the file has.
"""

from __future__ import annotations

import os
import sqlite3
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from camgeo.errors import FileError, OutputError, unreadable

MEMORY: Final = ":memory:"

MOST_STEPS: Final = 10**8
"""Instructions of SQLite in one query, two seconds; a check of 1,000,000 rows takes a tenth."""

LONGEST: Final = 2**26
"""Bytes of a cell, 64 MB: more than any scene."""

PATIENCE: Final = 5000
"""Milliseconds for which the process that writes waits for others to finish a reading."""

SHARED: Final = (("wal",), ("memory",))
"""SQLite's journals with which others read, and that of rows in memory."""

PAUSE: Final = 0.05
"""Seconds in which a process that writes takes its store back, between two chunks."""

ANEW: Final = "nothing of it was changed; --force makes it anew"

BUSY: Final = "another process writes it; only one at a time may"

ELSEWHERE: Final = "it was not changed: name another file, or delete it"

IN_USE: Final = (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED)

OF_THE_DISK: Final = (
    sqlite3.SQLITE_PERM, sqlite3.SQLITE_NOMEM, sqlite3.SQLITE_READONLY, sqlite3.SQLITE_IOERR,
    sqlite3.SQLITE_CANTOPEN, sqlite3.SQLITE_AUTH,
)  # fmt: skip
"""Errors of SQLite that say nothing about the file's contents."""


@contextmanager
def errors_told(path: Path | None) -> Iterator[None]:
    """Errors of SQLite within it become errors of camgeo, with the file and what to do."""
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
            message = f"is no store of a sweep, or not known as one any more; {ELSEWHERE}"
            raise FileError(f"{name} {message}") from error
        raise FileError(f"{name} is damaged: {error}; {ANEW}") from error


def connected(path: Path | None) -> sqlite3.Connection:
    """A connection to a file, or to rows in memory; it gives up at once where others write."""
    try:
        found = sqlite3.connect(MEMORY if path is None else path, timeout=0.0, isolation_level=None)
    except (sqlite3.Error, OSError, ValueError) as error:
        raise OutputError(f"{path} cannot be written: {unreadable(error)}") from error
    found.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, LONGEST)
    found.set_progress_handler(lambda: 1, MOST_STEPS)
    return found


def take_writing(file: sqlite3.Connection) -> None:
    """Become the one process that writes a file.

    It holds SQLite's lock for writing while it computes, and after each chunk gives it back for as
    long as it takes to ask for it again; so whoever got it asks twice.
    """
    file.execute("BEGIN IMMEDIATE")
    file.rollback()
    time.sleep(PAUSE)
    file.execute("BEGIN IMMEDIATE")
    file.execute(f"PRAGMA busy_timeout = {PATIENCE}")


def share_reading(database: sqlite3.Connection) -> None:
    """Let others read a file that this process writes; rows in memory stay as they are."""
    if database.execute("PRAGMA journal_mode").fetchone() not in SHARED:
        database.rollback()
        database.execute("PRAGMA journal_mode = WAL")
        database.execute("BEGIN IMMEDIATE")


def replace_contents(file: sqlite3.Connection, memory: sqlite3.Connection) -> None:
    """Put what is in memory in place of all that a file has, as one step, however damaged it is."""

    def require_free(status: int, *_: int) -> None:
        if status in IN_USE:  # which SQLite's own copying would wait for without end
            error = sqlite3.OperationalError("database is locked")
            error.sqlite_errorcode = status
            raise error

    memory.rollback()
    file.rollback()
    memory.backup(file, progress=require_free)
    file.execute("PRAGMA writable_schema = OFF")
