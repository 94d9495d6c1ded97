"""Data files that a scene names: read once, with their hashes."""

from __future__ import annotations

import hashlib
import pathlib

from camgeo.errors import Fault
from camgeo.scene.folder import beside
from camgeo.scene.keys import Path
from camgeo.scene.sound import SoundValues


class DataFiles:
    """Reads the data files of a scene.

    Attributes
    ----------
    faults : of files that cannot be read.
    hashes : SHA-256 of those that were, hexadecimal, by the name that the scene gives them.
    """

    def __init__(self, values: SoundValues) -> None:
        self.values = values
        self.faults: list[Fault] = []
        self.hashes: dict[str, str] = {}

    def read(self, key: Path) -> bytes | None:
        """The file that the scene names at `key`, up to one byte too many; None with a fault."""
        name: str = self.values.get(*key)
        from camgeo.motion.two_columns import MOST_BYTES  # few scenes name a file

        path = self._inside(key)
        if path is None:
            return None
        try:
            with path.open("rb") as stream:
                data = stream.read(MOST_BYTES + 1)
        except (OSError, ValueError) as error:
            reason = getattr(error, "strerror", None) or str(error)
            self._fault(key, f"cannot be read: {reason}")
            return None
        self.hashes[name] = hashlib.sha256(data).hexdigest()
        return data

    def path(self, key: Path) -> str | None:
        """Path of the file that the scene names at `key`, not read; None with a fault."""
        path = self._inside(key)
        if path is not None and not path.is_file():
            self._fault(key, "is no file in the folder of the scene")
            return None
        return None if path is None else str(path)

    def _inside(self, key: Path) -> pathlib.Path | None:
        path = beside(self.values.scene.file, self.values.get(*key))
        if path is None:
            self._fault(key, "must not leave the folder of the scene")
        return path

    def _fault(self, key: Path, message: str) -> None:
        self.faults.append(self.values.scene.fault(key, message))
