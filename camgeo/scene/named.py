"""Files that a scene may name, and whether they have changed."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

from camgeo.errors import FileError
from camgeo.reading import check_toml

LONGEST: Final = 1024
"""Characters of a text that may be the name of a file; longer ones are none."""

Stamp = tuple[int, int, int] | None
"""What tells one state of a file from another: its number, time of change and size; None if there
is no such file. A file that is replaced by another, as editors do on saving, has another number."""


def stamp(path: Path) -> Stamp:
    """The present state of one file."""
    try:
        return stamp_of(path.stat())
    except (OSError, ValueError):
        return None


def stamp_of(found: os.stat_result) -> Stamp:
    """The state of a file of which the system says this."""
    return found.st_ino, found.st_mtime_ns, found.st_size


def named(text: str, folder: Path) -> tuple[Path, ...] | None:
    """Files in `folder` that the scene in a text may name: any of its texts; None if it is no TOML.

    A scene may be broken for the moment, and a file may be missing: neither matters here.
    """
    try:
        check_toml(text)
        found = tomllib.loads(text)
    except (FileError, ValueError, RecursionError):
        return None
    return tuple(sorted({folder / each for each in _texts(found)}))


def _texts(value: Any) -> Iterator[str]:
    """All texts in a TOML value that may be names of files of a folder, or below it."""
    if isinstance(value, str):
        if 0 < len(value) <= LONGEST and value.isprintable() and _is_inside(value):
            yield value
    elif isinstance(value, dict | list):
        for each in value.values() if isinstance(value, dict) else value:
            yield from _texts(each)


def _is_inside(name: str) -> bool:
    """Whether a name leads nowhere else; a scene must not name files elsewhere."""
    path = Path(name)
    return not path.is_absolute() and ".." not in path.parts
