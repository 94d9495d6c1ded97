"""Unsaved edits on disk: changes survive the end of the designer's process, however it ends.

A journal has one line for each change of a history. The line is written before the change is
answered, and the history can be rebuilt from the lines. Journals are in the user's state folder,
readable by no one else, under a name derived from the path of the scene file. A journal is locked
while its scene is open, so two designers never edit one file; the system releases the lock of a
process that has died.
"""

from __future__ import annotations

import hashlib
import json
import os
import stat
import sys
import zlib
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final, Self

from camgeo.designing.history import History, splice
from camgeo.errors import FileError, unreadable
from camgeo.reading import SCENE

if sys.platform != "win32":
    import fcntl

FORM: Final = 1
"""Version of the format of journals; others are not read."""

MOST_BYTES: Final = 128_000_000
"""Largest journal: more than the longest history needs."""

SPARE: Final = 1_000_000
"""Bytes that a journal may grow beyond twice its first size before it is written anew."""

PRIVATE: Final = 0o600
PRIVATE_FOLDER: Final = 0o700

NO_LINK: Final = getattr(os, "O_NOFOLLOW", 0)
"""Flag with which links are not followed on opening."""


@dataclass(frozen=True, slots=True)
class Kept:
    """What a journal has preserved.

    Attributes
    ----------
    history : with the last text; None if nothing can be read.
    saved : SHA-256 of the scene file when it was last read or saved; empty if there was no file.
    damage : why part of what was written is missing; empty if nothing is.
    """

    history: History | None
    saved: str
    damage: str = ""


class Journal:
    """The journal of one scene file; `opened` makes one.

    Attributes
    ----------
    kept : earlier edits that it had preserved; None if there were none.
    fault : why edits are not kept; empty if they are.
    """

    def __init__(self, file: str, place: Path | None, lock: int | None, fault: str = "") -> None:
        self.kept: Kept | None = None
        self.fault = fault
        self._file = file
        self._place = place
        self._lock = lock
        self._stream: int | None = None
        self._size = self._least = 0

    @classmethod
    def opened(cls, file: str, folder: Path | None = None) -> Self:
        """The journal of the scene file at the absolute path `file`, in `folder`.

        If the journal cannot be written, `fault` says why, and designing goes on without it.

        Raises
        ------
        FileError
            If another process has it open.
        """
        try:
            folder = state_folder() if folder is None else folder
            folder.mkdir(PRIVATE_FOLDER, parents=True, exist_ok=True)
            place = folder / f"{hashlib.sha256(os.fsencode(file)).hexdigest()[:32]}.journal"
            lock = _locked(place.with_suffix(".lock"))
        except (OSError, RuntimeError) as error:
            return cls(file, None, None, unkept(error))
        if lock is None:
            raise FileError(f"{file} is open in another designer; end that one first")
        found = cls(file, place, lock)
        found._read()
        return found

    def add(self, history: History, event: Mapping[str, Any], saved: str) -> None:
        """Record the `event` that led to this `history`; `saved` is the digest of the file."""
        if self._place is None:
            return
        line = _line(event)
        try:
            if self._stream is None or self._size + len(line) > 2 * self._least + SPARE:
                self._write_anew(history, saved)
            else:
                _write(self._stream, line)
                self._size += len(line)
        except OSError as error:
            self._forsake(unkept(error))

    def sync(self) -> None:
        """Wait until everything written is on disk, not only with the system."""
        stream = self._stream
        if stream is not None:
            with suppress(OSError):  # closed in the meantime, which waits too
                os.fsync(stream)

    def close(self, *, keep: bool) -> None:
        """Release the journal; without `keep` nothing is unsaved, and it is removed."""
        if self._place is None:
            return
        if self._stream is not None:
            self.sync()
            os.close(self._stream)
        with suppress(OSError):
            if not keep:
                self._place.unlink(missing_ok=True)
            self._place.with_suffix(".lock").unlink(missing_ok=True)
        if self._lock is not None:
            os.close(self._lock)
        self._place = self._stream = self._lock = None

    def _read(self) -> None:
        """Read what an earlier process has left; a damaged journal is set aside."""
        if self._place is None:
            return
        try:
            data = _content(self._place)
        except FileNotFoundError:
            return
        except (OSError, FileError) as error:
            self._forsake(unkept(error))
            return
        self.kept = kept(data, self._file)
        if self.kept.damage:
            aside = self._place.with_suffix(".damaged")
            self.kept = replace(self.kept, damage=f"{self.kept.damage}; it is kept as {aside}")
            try:
                self._place.replace(aside)
            except OSError as error:
                self._forsake(unkept(error))

    def _write_anew(self, history: History, saved: str) -> None:
        """Replace the journal with a shorter one of the same history."""
        if self._place is None:
            return
        data = b"".join(_lines(self._file, history, saved))
        fresh = self._place.with_suffix(".new")
        fresh.unlink(missing_ok=True)
        stream = os.open(fresh, os.O_WRONLY | os.O_CREAT | os.O_EXCL, PRIVATE)
        try:
            _write(stream, data)
            os.fsync(stream)
        finally:
            os.close(stream)
        if self._stream is not None:
            os.close(self._stream)
            self._stream = None
        fresh.replace(self._place)
        _sync_folder(self._place.parent)
        self._stream = os.open(self._place, os.O_WRONLY | os.O_APPEND | NO_LINK)
        self._size = self._least = len(data)

    def _forsake(self, fault: str) -> None:
        """Stop keeping edits."""
        self.fault = fault
        if self._stream is not None:
            os.close(self._stream)
        self._stream = self._place = None


def state_folder() -> Path:
    """The folder of journals, where the system keeps the state of the user's programs.

    RuntimeError if the user has no home.
    """
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    elif sys.platform == "darwin":
        base = Path.home() / "Library" / "Application Support"
    else:
        stated = Path(os.environ.get("XDG_STATE_HOME", ""))  # to be ignored unless absolute
        base = stated if stated.is_absolute() else Path.home() / ".local" / "state"
    return base / "camgeo" / "designer"


def kept(data: bytes, file: str) -> Kept:
    """What the bytes of a journal say about the scene file at `file`, up to any damage."""
    found = Kept(None, "", "it is empty")
    for number, line in enumerate(data.splitlines(keepends=True), 1):
        try:
            event = _event(line)
            found = (
                _first(event, file)
                if found.history is None
                else _next(found.history, found.saved, event)
            )
        except (ValueError, LookupError, TypeError) as error:
            return replace(found, damage=f"line {number} is damaged: {error}")
    return found


def _first(event: Any, file: str) -> Kept:
    if event["journal"] != FORM:
        raise ValueError(f"its form is {event['journal']}, not {FORM}")
    if event["file"] != file:
        raise ValueError("it is of another file")
    return Kept(History(_text(event["text"])), _text(event["saved"]))


def _next(history: History, saved: str, event: Any) -> Kept:
    match event["do"]:
        case "change":
            at, length, after = event["splice"]
            if not 0 <= at <= at + length <= len(history.text):
                raise ValueError("a change does not fit")
            text = f"{history.text[:at]}{_text(after)}{history.text[at + length :]}"
            history = history.changed(text, _text(event["label"]), _text(event["gesture"]))
        case "undo":
            history = history.undone()
        case "redo":
            history = history.redone()
        case "saved":
            saved = _text(event["saved"])
        case other:
            raise ValueError(f"{other!r} is unknown")
    return Kept(history, saved)


def change(before: str, after: str, label: str, gesture: str = "") -> dict[str, Any]:
    """The event of `History.changed` between two texts."""
    at, gone, there = splice(before, after)
    return {"do": "change", "splice": [at, len(gone), there], "label": label, "gesture": gesture}


def _lines(file: str, history: History, saved: str) -> Iterator[bytes]:
    """The lines of a journal from which this history can be rebuilt."""
    steps = (*history.past, *reversed(history.future))
    start = history
    while start.past:
        start = start.undone()
    yield _line({"journal": FORM, "file": file, "text": start.text, "saved": saved})
    for step in steps:
        event = {"splice": [step.at, len(step.before), step.after], "label": step.label}
        yield _line({"do": "change", **event, "gesture": step.gesture})
    yield from [_line({"do": "undo"})] * len(history.future)


def _line(event: Mapping[str, Any]) -> bytes:
    """An event as a line: a checksum and JSON."""
    data = json.dumps(event, ensure_ascii=False, allow_nan=False, separators=(",", ":")).encode()
    return b"%08x %s\n" % (zlib.crc32(data), data)


def _event(line: bytes) -> Any:
    total, space, rest = line[:8], line[8:9], line[9:-1]
    if line[-1:] != b"\n" or space != b" " or total != b"%08x" % zlib.crc32(rest):
        raise ValueError("its checksum is wrong")
    return json.loads(rest)


def _text(value: Any) -> str:
    if not isinstance(value, str) or len(value) > SCENE.size:
        raise ValueError("a text is none, or too long")
    return value


def _content(place: Path) -> bytes:
    """The bytes of a journal, which is a plain file of the user."""
    stream = os.open(place, os.O_RDONLY | NO_LINK)
    with os.fdopen(stream, "rb") as file:
        found = os.fstat(stream)
        if not stat.S_ISREG(found.st_mode) or found.st_size > MOST_BYTES:
            raise FileError(f"{place}: is no journal")
        return file.read(MOST_BYTES)


def _write(stream: int, data: bytes) -> None:
    while data:
        data = data[os.write(stream, data) :]


def _sync_folder(folder: Path) -> None:
    """Wait until the entries of a folder are on disk, where the system can."""
    if sys.platform == "win32":
        return
    opened = os.open(folder, os.O_RDONLY)
    try:
        with suppress(OSError):
            os.fsync(opened)
    finally:
        os.close(opened)


def _locked(place: Path) -> int | None:
    """The lock file, open and locked; None if another process has it."""
    if sys.platform == "win32":
        try:
            return os.open(place, os.O_CREAT | os.O_EXCL | os.O_TEMPORARY)  # goes when closed
        except FileExistsError:
            return None
    while True:
        lock = os.open(place, os.O_RDWR | os.O_CREAT | NO_LINK, PRIVATE)
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(lock)
            return None
        except OSError:
            return lock  # a file system without locks
        with suppress(FileNotFoundError):
            if os.path.samestat(os.fstat(lock), place.stat()):
                return lock
        os.close(lock)  # its process removed it after it had been opened here


def unkept(error: Exception) -> str:
    """A sentence saying that edits are not kept, and why."""
    reason = unreadable(error) if isinstance(error, OSError | ValueError) else str(error)
    return f"unsaved edits are not kept on disk: {reason}"
