"""A set of files written completely or not at all, overwriting nothing unless told to."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path

from camgeo.errors import OutputError


def write_set(folder: Path, files: Mapping[str, bytes], *, force: bool) -> tuple[Path, ...]:
    """Write `files` (name -> content) into `folder`, which is created if necessary.

    Everything is first written to a hidden folder next to the targets and moved into place only
    when it is complete on disk; a move that fails undoes the moves before it. A file that
    already exists with the same content counts as written.

    Raises
    ------
    OutputError
        If a different file exists and `force` is not set, or on any disk error; in both cases
        nothing has been changed.
    """
    _refuse_overwriting(folder, files, force=force)
    made = _make_folder(folder)
    staging: Path | None = None
    try:
        staging = Path(tempfile.mkdtemp(prefix=".camgeo-", dir=folder))
        for name, data in files.items():
            _write_durably(staging / name, data)
        _move_into_place(folder, staging, files)
    except OSError as error:
        place = Path(error.filename).name if error.filename else folder.name
        raise OutputError(
            f"{folder}: cannot write {place}: {error.strerror or error}; nothing was written"
        ) from error
    finally:  # after Ctrl-C too; then `_move_into_place` has put everything back
        if staging is not None:
            shutil.rmtree(staging, ignore_errors=True)
        for created in reversed(made):
            try:
                created.rmdir()  # only if nothing has been put in it
            except OSError:
                break
    return tuple(folder / name for name in files)


def _refuse_overwriting(folder: Path, files: Mapping[str, bytes], *, force: bool) -> None:
    if folder.exists() and not folder.is_dir():
        raise OutputError(f"{folder}: is a file, not a folder; nothing was written")
    differing = []
    for name, data in files.items():
        target = folder / name
        if target.is_dir():
            raise OutputError(f"{target}: is a folder; nothing was written")
        try:
            if target.exists() and target.read_bytes() != data:
                differing.append(name)
        except OSError as error:
            raise OutputError(
                f"{target}: {error.strerror or error}; nothing was written"
            ) from error
    if differing and not force:
        raise OutputError(
            f"{folder}: {', '.join(differing)} would be overwritten; allow it with --force, or"
            " give another folder with -o; nothing was written"
        )


def _make_folder(folder: Path) -> list[Path]:
    """Create `folder` and its missing parents; return what was created, outermost first."""
    missing = []
    place = folder
    while not place.exists():
        missing.append(place)
        place = place.parent
    made: list[Path] = []
    try:
        for place in reversed(missing):
            place.mkdir()
            made.append(place)
    except OSError as error:
        for place in reversed(made):
            place.rmdir()
        raise OutputError(
            f"{folder}: cannot create the folder: {error.strerror or error}; nothing was written"
        ) from error
    return made


def _write_durably(path: Path, data: bytes) -> None:
    with path.open("wb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())


def _move_into_place(folder: Path, staging: Path, files: Mapping[str, bytes]) -> None:
    kept = staging / "replaced"
    kept.mkdir()
    moved: list[str] = []
    try:
        for name in files:
            target = folder / name
            moved.append(name)  # first: Ctrl-C may come right after a move
            if target.exists():
                target.replace(kept / name)
            (staging / name).replace(target)
    except BaseException:
        for name in reversed(moved):
            target = folder / name
            if (kept / name).exists():
                (kept / name).replace(target)
            elif not (staging / name).exists():
                target.unlink(missing_ok=True)
        raise
