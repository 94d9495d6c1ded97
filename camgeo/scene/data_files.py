"""Files that a scene names: read once, and kept with the scene."""

from __future__ import annotations

import hashlib
import pathlib
from collections.abc import Mapping

from camgeo.errors import Fault
from camgeo.scene.folder import beside
from camgeo.scene.keys import Path
from camgeo.scene.sound import SoundValues

NO_FOLDER = "names a file, which needs a folder: load the scene from a file, or with folder=..."


class DataFiles:
    """Reads the files of a scene that lies in `folder`; those that are `known` are not read again.

    Attributes
    ----------
    faults : of files that cannot be read.
    contents : of those that were, by the names that the scene gives them.
    hashes : SHA-256 of data, hexadecimal, by the same names.
    """

    def __init__(
        self,
        values: SoundValues,
        folder: pathlib.Path | None = None,
        known: Mapping[str, bytes] | None = None,
    ) -> None:
        self.values = values
        self.faults: list[Fault] = []
        self.contents: dict[str, bytes] = {}
        self.hashes: dict[str, str] = {}
        self._folder = folder
        self._known = known or {}

    def read(self, key: Path) -> bytes | None:
        """The data that the scene names at `key`, up to one byte too many; None with a fault."""
        if self._path(key) is None:
            return None
        data = self.contents[self.values.get(*key)]

        self.hashes[self.values.get(*key)] = hashlib.sha256(data).hexdigest()
        return data

    def path(self, key: Path) -> str | None:
        """Path of what the scene names at `key`, a file that another part reads; None with a fault.

        What is in it now is kept too.
        """
        path = self._path(key)
        return None if path is None else str(path)

    def _path(self, key: Path) -> pathlib.Path | None:
        """Path of the file at `key`, whose content is kept; None with a fault."""
        from camgeo.motion.two_columns import MOST_BYTES  # few scenes name a file

        name: str = self.values.get(*key)
        known = self.contents.get(name, self._known.get(name))
        if self._folder is None:
            return self._fault(key, NO_FOLDER)
        path = beside(self._folder, name)
        if path is None:
            return self._fault(key, "must not leave the folder of the scene")
        if known is None:
            try:
                with path.open("rb") as stream:
                    known = stream.read(MOST_BYTES + 1)
            except (OSError, ValueError) as error:
                reason = getattr(error, "strerror", None) or str(error)
                return self._fault(key, f"cannot be read: {reason}")
        self.contents[name] = known
        return path

    def _fault(self, key: Path, message: str) -> pathlib.Path | None:
        self.faults.append(self.values.scene.fault(key, message))
        return None
