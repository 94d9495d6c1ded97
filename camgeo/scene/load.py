"""Reading a scene file: all its faults are reported at once."""

from __future__ import annotations

import errno
from os import PathLike
from pathlib import Path

from camgeo.errors import Fault, SceneError, unreadable
from camgeo.reading import SCENE
from camgeo.scene.document import data_of
from camgeo.scene.scene import Scene


def load_scene(path: str | PathLike[str]) -> Scene:
    """Read the scene file at `path`.

    Raises
    ------
    SceneError
        If the file cannot be read or anything in it is wrong; it lists all faults.
    """
    return Scene.from_text(read_file(path, SCENE.size), str(path))


def read_file(path: str | PathLike[str], most: int) -> bytes:
    """The bytes of the file at `path`, one more than `most` if it has more.

    Raises
    ------
    SceneError
        If it cannot be read.
    """
    try:
        if Path(path).is_dir():
            raise IsADirectoryError(errno.EISDIR, "it is a folder")
        with Path(path).open("rb") as stream:
            return stream.read(most + 1)
    except FileNotFoundError as error:
        raise SceneError([Fault("", "", "there is no such file")], str(path)) from error
    except (OSError, ValueError) as error:
        fault = Fault("", "", f"the file cannot be read: {unreadable(error)}")
        raise SceneError([fault], str(path)) from error


def parse_scene(text: str, file: str = "", folder: str | Path | None = None) -> Scene:
    """Read a scene from its TOML; `file` is the path it came from, for messages.

    `folder` holds the files that the scene names, if it is not that of `file`. Raises SceneError
    as `load_scene` does.
    """
    try:
        data = data_of(text)
    except SceneError as error:
        raise SceneError(error.faults, file) from error
    return Scene.from_text(data, file, folder)
