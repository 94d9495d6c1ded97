"""The desk of a designer: one scene with its history, its file on disk and its journal."""

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
from typing import Any, Final, Literal, Self

from camgeo.design.writing import PRIVATE, acquire_lock, settle, sync, write_set
from camgeo.errors import FileError, unreadable
from camgeo.reading import SCENE, check_size, read_limited
from camgeo.scene.values import Stamp, stamp_from_stat

RESTORED: Final = (
    "unsaved edits of {name} have been restored; undo takes them back step by step, reload goes"
    " back to the file on disk"
)


class Desk:
    """One scene being edited in a folder; every change is written into its journal at once.

    Parameters
    ----------
    folder : the only one in which scenes are opened and saved.
    states : folder of journals; None for that in the user's home.

    Attributes
    ----------
    history : the present text of the scene, and its earlier ones.
    opened : its file as it was read or saved last; None if it has no file yet.
    """

    def __init__(self, folder: Path, states: Path | None = None) -> None:
        self.folder = folder.resolve()
        self.history = History("")
        self.opened: Opened | None = None
        self._states = states
        self._journal: Journal | None = None
        self._messages: list[str] = []

    @property
    def text(self) -> str:
        """The scene's present text."""
        return self.history.text

    @property
    def name(self) -> str | None:
        """The scene's file, as a path in the folder; None if it has no file yet."""
        if self.opened is None:
            return None
        return self.opened.path.relative_to(self.folder).as_posix()

    @property
    def data_folder(self) -> Path:
        """The folder of the data files that the scene names."""
        return self.folder if self.opened is None else self.opened.path.parent

    @property
    def saved(self) -> bool:
        """Whether the text is the one that was read or saved last."""
        if self.opened is None:
            return not self.text
        return digest(self.text.encode()) == self.opened.digest

    @property
    def disk(self) -> Disk:
        """How the file on disk compares with what was read or saved last."""
        return "same" if self.opened is None else disk(self.opened)

    def take_messages(self) -> list[str]:
        """The messages for the user since the last call, which are then forgotten."""
        messages, self._messages = self._messages, []
        return messages

    def open(self, name: str) -> None:
        """Switch to the scene file `name`, with its unsaved edits; those of the previous scene are
        kept in its journal.

        Raises
        ------
        FileError
            If it cannot or must not be read, or if another process is editing it.
        """
        path = place(self.folder, name)
        if self.opened is not None and self.opened.path == path:
            return
        # First of all: if another designer has the file, the present scene stays open.
        journal = Journal.opened(str(path), self._states)
        try:
            text, scene_file = read(path)
        except FileError:
            # A scene whose file has been deleted can still be restored from its journal.
            if path.exists() or journal.content is None or journal.content.history is None:
                journal.close(keep=True)
                raise
            text, scene_file = "", Opened(path, journal.content.saved)
        self.close()
        self._journal = journal
        self.history, self.opened = self._restored(text, scene_file, journal.content)

    def begin(self) -> None:
        """Switch to the scene of this folder that is in no file yet, with its unsaved edits."""
        if self._journal is not None and self.opened is None:
            return
        journal = Journal.opened(f"{self.folder}{os.sep}", self._states)
        self.close()
        self._journal = journal
        self.history, self.opened = self._restored("", None, journal.content)

    def change(self, text: str, label: str, gesture: str = "") -> None:
        """Give the scene another text, see `History.changed`; FileError if it cannot be encoded."""
        encoded(text, self.name or "scene")
        if text != self.text:
            event = change(self.text, text, label, gesture)
            self._note(self.history.changed(text, label, gesture), event)

    def undo(self) -> None:
        """Undo the latest step, if there is one."""
        if self.history.past:
            self._note(self.history.undone(), {"do": "undo"})

    def redo(self) -> None:
        """Redo the step that was undone last, if there is one."""
        if self.history.future:
            self._note(self.history.redone(), {"do": "redo"})

    def reload(self) -> None:
        """Take the text from disk, as a step that can be undone; FileError if there is none."""
        if self.opened is None:
            raise FileError("the scene is in no file yet")
        text, self.opened = read(self.opened.path)
        self.change(text, f"{self.name} from disk")
        self._note(self.history, {"do": "saved", "saved": self._digest})

    def save(self, name: str | None = None, *, force: bool = False) -> None:
        """Save the scene; if a `name` is given, under that name, which it then keeps.

        Raises
        ------
        OverwriteError
            If that would overwrite something that was not read, and `force` is not set.
        FileError, OutputError
            If it cannot be saved there.
        """
        if name is not None:
            path = place(self.folder, name)
        elif self.opened is not None:
            path = self.opened.path
        else:
            raise FileError("the scene is in no file yet; it needs a name")
        if self.opened is not None and path == self.opened.path:
            self.opened = saved(path, self.text, self.opened, force=force)
        else:
            self._save_elsewhere(path, force=force)
        self._note(self.history, {"do": "saved", "saved": self._digest})

    def sync(self) -> None:
        """Wait until all edits are on disk; callable from another thread."""
        journal = self._journal
        if journal is not None:
            journal.sync()

    def _save_elsewhere(self, path: Path, *, force: bool) -> None:
        journal = Journal.opened(str(path), self._states)
        try:
            preserved = journal.content
            if (
                preserved
                and preserved.history
                and preserved.history.text != self.text
                and not force
            ):
                raise OverwriteError(f"{path.name} has unsaved edits of its own")
            self.opened = saved(path, self.text, None, force=force)
        except BaseException:
            journal.close(keep=True)
            raise
        if self._journal is not None:
            self._journal.close(keep=False)
        self._journal = journal

    def _restored(
        self, text: str, scene_file: Opened | None, preserved: JournalContent | None
    ) -> tuple[History, Opened | None]:
        """The history to continue, and the file as it was when that history was written."""
        if self._journal is not None and self._journal.fault:
            self._messages.append(self._journal.fault)
        if preserved is None:
            return History(text), scene_file
        name = "the new scene" if scene_file is None else scene_file.path.name
        if preserved.damage:
            self._messages.append(
                f"the journal of {name} is damaged, edits may be lost: {preserved.damage}"
            )
        if preserved.history is None:
            return History(text), scene_file
        if preserved.history.text == text:
            return preserved.history, scene_file
        self._messages.append(RESTORED.format(name=name))
        if scene_file is not None and scene_file.digest != preserved.saved:
            self._messages.append(f"{name} has been changed on disk since they were made")
            scene_file = Opened(scene_file.path, preserved.saved)
        return preserved.history, scene_file

    @property
    def _digest(self) -> str:
        """SHA-256 of the file as it was read or saved last; empty if there is none."""
        return "" if self.opened is None else self.opened.digest

    def _note(self, history: History, event: Mapping[str, Any]) -> None:
        """Continue with a history whose latest part is `event`."""
        self.history = history
        if self._journal is not None:
            fault = self._journal.fault
            self._journal.add(history, event, self._digest)
            # A fault is reported once, when it arises.
            if self._journal.fault != fault:
                self._messages.append(self._journal.fault)

    def close(self) -> None:
        """End editing; edits that are not saved stay in the journal."""
        if self._journal is None:
            return
        if not self.saved:
            name = self.name or "the new scene"
            self._messages.append(f"unsaved edits of {name} are kept until it is opened again")
        self._journal.close(keep=not self.saved)
        self._journal = None


# -- opened ---------------------------------------------------------------------------------------
# The scene file of a designer: read, watched, and saved without overwriting what is new.


SUFFIX: Final = ".toml"

MOST_LISTED: Final = 500
"""Most scenes of a folder that are offered."""

Disk = Literal["same", "changed", "gone"]
"""How a file on disk compares with what was read from it or saved last."""


class OverwriteError(FileError):
    """Saving would overwrite changes that the designer has not read, and was not forced."""


@dataclass(frozen=True, slots=True)
class Opened:
    """A scene file as it was read or saved last.

    Attributes
    ----------
    path : absolute, without links.
    digest : SHA-256 of its bytes, hexadecimal.
    stamp : its state then; None if that is not known.
    """

    path: Path
    digest: str
    stamp: Stamp = None


def place(folder: Path, name: str) -> Path:
    """The path of the scene file `name` in `folder`, which is absolute and without links.

    Raises
    ------
    FileError
        If it is not the name of a scene, leaves the folder, or goes through a link.
    """
    parts = Path(name).parts
    if not _is_plain(name) or not parts or Path(name).is_absolute() or ".." in parts:
        raise FileError(f"{name!r}: a scene must be named by a path in the folder {folder}")
    if Path(name).suffix != SUFFIX or len(Path(name).name) == len(SUFFIX):
        raise FileError(f"{name!r}: the name of a scene ends in {SUFFIX}")
    path = folder
    for part in parts:
        path /= part
        if os.path.islink(path):  # noqa: PTH114 - also for a path that no file can have
            raise FileError(f"{name!r}: {part!r} is a link, which is not followed")
    return path


def _is_plain(name: str) -> bool:
    """Whether a name means the same on every system, and can be shown."""
    return name.isprintable() and "\\" not in name and ":" not in name


def scenes(folder: Path) -> tuple[str, ...]:
    """The names of the scene files in `folder`, in order, without links and hidden files."""
    try:
        names = sorted(
            path.name
            for path in folder.iterdir()
            if path.suffix == SUFFIX and path.name[0] != "." and _is_plain(path.name)
            and not path.is_symlink() and path.is_file()
        )  # fmt: skip
    except OSError:
        return ()
    return tuple(names[:MOST_LISTED])


def read(path: Path) -> tuple[str, Opened]:
    """The text of the scene file at `path`, and its state.

    FileError if it cannot be read, is too large, or is not text in UTF-8.
    """
    try:
        status = path.lstat()
        if not stat.S_ISREG(status.st_mode):
            raise FileError(f"{path.name}: is not a regular file")
        data = read_limited(path, SCENE)
        text = data.decode()
    except FileNotFoundError as error:
        raise FileError(f"{path.name}: there is no such file") from error
    except UnicodeDecodeError as error:
        raise FileError(f"{path.name}: is not text in UTF-8") from error
    except OSError as error:
        raise FileError(f"{path.name}: cannot be read: {unreadable(error)}") from error
    return text, Opened(path, digest(data), stamp_from_stat(status))


def disk(opened: Opened, *, closely: bool = False) -> Disk:
    """How the file is now; a file that was written anew with the same bytes is the same.

    It is read if its stamp differs, or in any case if `closely`: files written within the same tick
    of the clock have the same time.
    """
    try:
        status = opened.path.lstat()
        if stamp_from_stat(status) == opened.stamp and not closely:
            return "same"
        if not stat.S_ISREG(status.st_mode) or status.st_size > SCENE.size:
            return "changed"
        same = digest(read_limited(opened.path, SCENE)) == opened.digest
    except FileNotFoundError:
        return "gone"
    except (OSError, FileError):
        return "changed"
    return "same" if same else "changed"


def saved(path: Path, text: str, earlier: Opened | None, *, force: bool) -> Opened:
    """The file at `path` with this text, put in place in one step.

    `earlier` is the state in which it was read or saved last. A file that has changed since, or was
    never read, is overwritten only with `force`, unless it has this text already.

    Raises
    ------
    OverwriteError
        If it would be overwritten without `force`.
    FileError, OutputError
        If the text is too large or cannot be encoded, or the file cannot be written.
    """
    data = encoded(text, path.name)
    if not force:
        _refuse_overwriting(path, data, earlier)
    mode = stat.S_IMODE(path.stat().st_mode) if path.is_file() else None
    settle(path.parent)
    write_set(path.parent, {path.name: data}, force=True)
    try:
        if mode is not None:
            path.chmod(mode)  # as private as the file that it replaces
        status = path.lstat()
    except OSError as error:
        raise FileError(f"{path.name}: cannot be read: {unreadable(error)}") from error
    return Opened(path, digest(data), stamp_from_stat(status))


def encoded(text: str, name: str) -> bytes:
    """The bytes of a scene's text; FileError if they are too many, or cannot be encoded."""
    try:
        data = text.encode()
    except UnicodeEncodeError as error:
        raise FileError(f"{name}: is not text that UTF-8 can encode") from error
    check_size(len(data), SCENE, name)
    return data


def digest(data: bytes) -> str:
    """SHA-256 of data, hexadecimal."""
    return hashlib.sha256(data).hexdigest()


def _refuse_overwriting(path: Path, data: bytes, earlier: Opened | None) -> None:
    if earlier is not None and earlier.path == path:
        if disk(earlier, closely=True) == "changed":
            raise OverwriteError(f"{path.name} has been changed on disk since it was read")
        return
    if not path.exists() and not path.is_symlink():
        return
    if read(path)[1].digest != digest(data):
        raise OverwriteError(f"{path.name} exists already")


# -- journal --------------------------------------------------------------------------------------
# Unsaved edits on disk: changes survive the end of the designer's process, however it ends.
#
# A journal has one line for each change of a history. The line is written before the change is
# answered, and the history can be rebuilt from the lines. Journals are in the user's state folder,
# readable by no one else, under a name derived from the path of the scene file. A journal is locked
# while its scene is open, so two designers never edit one file; the system releases the lock of a
# process that has died.


FORM: Final = 1
"""Version of the format of journals; others are not read."""

MOST_BYTES: Final = 128_000_000
"""Largest journal: more than the longest history needs."""

SPARE: Final = 1_000_000
"""Bytes that a journal may grow beyond twice its first size before it is written anew."""

PRIVATE_FOLDER: Final = 0o700

NO_LINK: Final = getattr(os, "O_NOFOLLOW", 0)
"""Flag with which links are not followed on opening."""


@dataclass(frozen=True, slots=True)
class JournalContent:
    """The contents of a journal.

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
    content : edits of an earlier process; None if there were none.
    fault : why edits are not being kept; empty if they are.
    """

    def __init__(self, file: str, place: Path | None, lock: int | None, fault: str = "") -> None:
        self.content: JournalContent | None = None
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
        journal = cls(file, place, lock)
        journal._read(place)
        return journal

    def add(self, history: History, event: Mapping[str, Any], saved: str) -> None:
        """Record the `event` that led to this `history`; `saved` is the digest of the file."""
        if self._place is None:
            return
        line = _line(event)
        try:
            if self._stream is None or self._size + len(line) > 2 * self._least + SPARE:
                self._write_anew(self._place, history, saved)
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

    def _read(self, place: Path) -> None:
        """Read the edits of an earlier process; a damaged journal is set aside."""
        try:
            data = _content(place)
        except FileNotFoundError:
            return
        except (OSError, FileError) as error:
            self._forsake(unkept(error))
            return
        self.content = read_journal(data, self._file)
        if self.content.damage:
            aside = place.with_suffix(".damaged")
            self.content = replace(
                self.content, damage=f"{self.content.damage}; it is kept as {aside}"
            )
            try:
                place.replace(aside)
            except OSError as error:
                self._forsake(unkept(error))

    def _write_anew(self, place: Path, history: History, saved: str) -> None:
        """Replace the journal with a shorter one of the same history."""
        # The new journal is complete on disk before it replaces the old one.
        data = b"".join(_lines(self._file, history, saved))
        fresh = place.with_suffix(".new")
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
        fresh.replace(place)
        sync(place.parent)
        self._stream = os.open(place, os.O_WRONLY | os.O_APPEND | NO_LINK)
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


def read_journal(data: bytes, file: str) -> JournalContent:
    """The contents of a journal of the scene file at `file`, from its bytes, up to any damage."""
    content = JournalContent(None, "", "it is empty")
    for number, line in enumerate(data.splitlines(keepends=True), 1):
        try:
            event = _event(line)
            content = (
                _first(event, file)
                if content.history is None
                else _next(content.history, content.saved, event)
            )
        except (ValueError, LookupError, TypeError) as error:
            return replace(content, damage=f"line {number} is damaged: {error}")
    return content


def _first(event: Any, file: str) -> JournalContent:
    if event["journal"] != FORM:
        raise ValueError(f"its form is {event['journal']}, not {FORM}")
    if event["file"] != file:
        raise ValueError("it belongs to another file")
    return JournalContent(History(_text(event["text"])), _text(event["saved"]))


def _next(history: History, saved: str, event: Any) -> JournalContent:
    match event["do"]:
        case "change":
            position, length, inserted = event["splice"]
            if not 0 <= position <= position + length <= len(history.text):
                raise ValueError("a change does not fit")
            text = f"{history.text[:position]}{_text(inserted)}{history.text[position + length :]}"
            history = history.changed(text, _text(event["label"]), _text(event["gesture"]))
        case "undo":
            history = history.undone()
        case "redo":
            history = history.redone()
        case "saved":
            saved = _text(event["saved"])
        case other:
            raise ValueError(f"{other!r} is unknown")
    return JournalContent(history, saved)


def change(old: str, new: str, label: str, gesture: str = "") -> dict[str, Any]:
    """The event of `History.changed` between two texts."""
    position, gone, there = splice(old, new)
    return {
        "do": "change",
        "splice": [position, len(gone), there],
        "label": label,
        "gesture": gesture,
    }


def _lines(file: str, history: History, saved: str) -> Iterator[bytes]:
    """The lines of a journal from which this history can be rebuilt."""
    steps = (*history.past, *reversed(history.future))
    start = history
    while start.past:
        start = start.undone()
    yield _line({"journal": FORM, "file": file, "text": start.text, "saved": saved})
    for step in steps:
        event = {"splice": [step.position, len(step.removed), step.inserted], "label": step.label}
        yield _line({"do": "change", **event, "gesture": step.gesture})
    # All steps were written as changes: the undone ones, the last of them, are undone again.
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
        raise ValueError("a text is missing or too long")
    return value


def _content(place: Path) -> bytes:
    """The bytes of a journal, which is a plain file of the user."""
    stream = os.open(place, os.O_RDONLY | NO_LINK)
    with os.fdopen(stream, "rb") as file:
        status = os.fstat(stream)
        if not stat.S_ISREG(status.st_mode) or status.st_size > MOST_BYTES:
            raise FileError(f"{place}: is not a journal")
        return file.read(MOST_BYTES)


def _write(stream: int, data: bytes) -> None:
    while data:
        data = data[os.write(stream, data) :]


def _locked(place: Path) -> int | None:
    """The lock file, open and locked; None if another process has it."""
    while (lock := acquire_lock(place, os.O_RDWR | os.O_CREAT | NO_LINK)) is not None:
        with suppress(FileNotFoundError):
            if sys.platform == "win32" or os.path.samestat(os.fstat(lock), place.stat()):
                return lock
        os.close(lock)  # its process removed it after it had been opened here
    return None


def unkept(error: Exception) -> str:
    """A sentence saying that edits are not kept, and why."""
    reason = unreadable(error) if isinstance(error, OSError | ValueError) else str(error)
    return f"unsaved edits are not kept on disk: {reason}"


# -- history --------------------------------------------------------------------------------------
# The texts that a scene has had, for undo and redo: the present one and the steps between them.
#
# A step keeps what it replaces, not the whole text, so a long scene can have as many steps as a
# short one.


MOST_STEPS: Final = 1000
"""Most steps that can be undone."""

MOST_CHARACTERS: Final = 16_000_000
"""Most characters in all that these steps remove and insert."""

Splice = tuple[int, str, str]
"""Where two texts differ: the first position, and the differing parts of the one and the other."""


@dataclass(frozen=True, slots=True)
class EditStep:
    """The change that one step made.

    Attributes
    ----------
    label : its name, e.g. ``roller radius 8 mm``.
    position : of the first character in which the texts differ, from 0.
    removed, inserted : the differing parts of the earlier and of the later text.
    gesture : changes of the same gesture, a drag say, are one step; empty for a step by itself.
    """

    label: str
    position: int
    removed: str
    inserted: str
    gesture: str = ""

    def __len__(self) -> int:
        return len(self.removed) + len(self.inserted)


@dataclass(frozen=True, slots=True)
class History:
    """A text with the steps that led to it, and those that were undone.

    Attributes
    ----------
    text : the present one.
    past : steps to be undone, the latest last.
    future : steps to be redone, the next last.
    """

    text: str
    past: tuple[EditStep, ...] = ()
    future: tuple[EditStep, ...] = ()

    @property
    def undo(self) -> str | None:
        """The label of what can be undone; None if there is nothing."""
        return self.past[-1].label if self.past else None

    @property
    def redo(self) -> str | None:
        """The label of what can be redone; None if there is nothing."""
        return self.future[-1].label if self.future else None

    def changed(self, text: str, label: str, gesture: str = "") -> Self:
        """The history with a new text and nothing left to redo.

        A change with the gesture of the latest step becomes part of that step. If the text is
        then what it was before the gesture, the step disappears.
        """
        past = self.past
        earlier = self.text
        if gesture and past and past[-1].gesture == gesture:
            earlier = spliced(earlier, past[-1].position, past[-1].inserted, past[-1].removed)
            past = past[:-1]
        if earlier != text:
            past = (*past, EditStep(label, *splice(earlier, text), gesture))
        return replace(self, text=text, past=_bounded(past), future=())

    def undone(self) -> Self:
        """The history one step back; the same history if there is none."""
        if not self.past:
            return self
        *past, step = self.past
        text = spliced(self.text, step.position, step.inserted, step.removed)
        # Nothing becomes part of its gesture after it has been undone.
        future = (*self.future, replace(step, gesture=""))
        return replace(self, text=text, past=tuple(past), future=future)

    def redone(self) -> Self:
        """The history one step forward; the same history if there is none."""
        if not self.future:
            return self
        *future, step = self.future
        text = spliced(self.text, step.position, step.removed, step.inserted)
        return replace(self, text=text, past=(*self.past, step), future=tuple(future))


def splice(old: str, new: str) -> Splice:
    """Where the texts `old` and `new` differ: what is equal at both ends is left out."""
    head = _alike(old, new)
    old, new = old[head:], new[head:]
    # After the common start has been removed, so that start and end never overlap.
    tail = _alike(old[::-1], new[::-1])
    return head, old[: len(old) - tail], new[: len(new) - tail]


def _alike(one: str, other: str) -> int:
    """How many characters two texts have in common at the start; by bisection, comparing slices."""
    low, high = 0, min(len(one), len(other))
    while low < high:
        middle = (low + high + 1) // 2
        if one[low:middle] == other[low:middle]:
            low = middle
        else:
            high = middle - 1
    return low


def spliced(text: str, position: int, removed: str, inserted: str) -> str:
    """The text with `inserted` in place of `removed`; ValueError if that is not there."""
    if text[position : position + len(removed)] != removed:
        raise ValueError("a step does not fit the text")
    return f"{text[:position]}{inserted}{text[position + len(removed) :]}"


def _bounded(past: tuple[EditStep, ...]) -> tuple[EditStep, ...]:
    """The latest steps that are within the limits; the last one always is."""
    past = past[-MOST_STEPS:]
    size = sum(map(len, past))
    first = 0
    while size > MOST_CHARACTERS and first < len(past) - 1:
        size -= len(past[first])
        first += 1
    return past[first:]
