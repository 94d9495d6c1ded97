"""The scene file of a designer: read, watched, and saved without overwriting what is new."""

from __future__ import annotations

import hashlib
import stat
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

from camgeo.errors import FileError, unreadable
from camgeo.reading import SCENE, check_size, read_within
from camgeo.scene.named import Stamp, stamp_of
from camgeo.writing.transaction import settle, write_set

SUFFIX: Final = ".toml"

MOST_LISTED: Final = 500
"""Scenes of a folder that are offered."""

Disk = Literal["same", "changed", "gone"]
"""How a file on disk compares with what was read from it or saved last."""


class OverwriteError(FileError):
    """Saving would overwrite what the designer has not read, and was not forced."""


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
        if _is_link(path):
            raise FileError(f"{name!r}: {part!r} is a link, which is not followed")
    return path


def _is_plain(name: str) -> bool:
    """Whether a name means the same on every system, and can be shown."""
    return name.isprintable() and "\\" not in name and ":" not in name


def scenes(folder: Path) -> tuple[str, ...]:
    """The names of the scene files in `folder`, in order, without links and hidden files."""
    try:
        names = sorted(
            each.name
            for each in folder.iterdir()
            if each.suffix == SUFFIX and each.name[0] != "." and _is_plain(each.name)
            and not each.is_symlink() and each.is_file()
        )  # fmt: skip
    except OSError:
        return ()
    return tuple(names[:MOST_LISTED])


def read(path: Path) -> tuple[str, Opened]:
    """The text of the scene file at `path`, and its state.

    FileError if it cannot be read, is too large, or is not text in UTF-8.
    """
    try:
        before = path.lstat()
        if not stat.S_ISREG(before.st_mode):
            raise FileError(f"{path.name}: is no plain file")
        data = read_within(path, SCENE)
        text = data.decode()
    except FileNotFoundError as error:
        raise FileError(f"{path.name}: there is no such file") from error
    except UnicodeDecodeError as error:
        raise FileError(f"{path.name}: is not text in UTF-8") from error
    except OSError as error:
        raise FileError(f"{path.name}: cannot be read: {unreadable(error)}") from error
    return text, Opened(path, digest(data), stamp_of(before))


def disk(opened: Opened, *, closely: bool = False) -> Disk:
    """How the file is now; a file that was written anew with the same bytes is the same.

    It is read if its stamp differs, or in any case if `closely`: files written within the same tick
    of the clock have the same time.
    """
    try:
        found = opened.path.lstat()
        if stamp_of(found) == opened.stamp and not closely:
            return "same"
        if not stat.S_ISREG(found.st_mode) or found.st_size > SCENE.size:
            return "changed"
        same = digest(read_within(opened.path, SCENE)) == opened.digest
    except FileNotFoundError:
        return "gone"
    except (OSError, FileError):
        return "changed"
    return "same" if same else "changed"


def saved(path: Path, text: str, before: Opened | None, *, force: bool) -> Opened:
    """The file at `path` with this text, put in place in one step.

    `before` is what is known of it. A file that has changed since, or of which nothing is known, is
    overwritten only with `force`, unless it has this text already.

    Raises
    ------
    OverwriteError
        If it would be overwritten without `force`.
    FileError, OutputError
        If the text is too large or cannot be encoded, or the file cannot be written.
    """
    data = encoded(text, path.name)
    if not force:
        _refuse_overwriting(path, data, before)
    mode = stat.S_IMODE(path.stat().st_mode) if path.is_file() else None
    settle(path.parent)
    write_set(path.parent, {path.name: data}, force=True)
    try:
        if mode is not None:
            path.chmod(mode)  # as private as the file that it replaces
        found = path.lstat()
    except OSError as error:
        raise FileError(f"{path.name}: cannot be read: {unreadable(error)}") from error
    return Opened(path, digest(data), stamp_of(found))


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


def _refuse_overwriting(path: Path, data: bytes, before: Opened | None) -> None:
    if before is not None and before.path == path:
        if disk(before, closely=True) == "changed":
            raise OverwriteError(f"{path.name} has been changed on disk since it was read")
        return
    if not path.exists() and not path.is_symlink():
        return
    if read(path)[1].digest != digest(data):
        raise OverwriteError(f"{path.name} exists already")


def _is_link(path: Path) -> bool:
    try:
        return path.is_symlink()
    except (OSError, ValueError):
        return False
