"""The certificate beside a set of files, read again."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

from camgeo.files.write import CERTIFICATE


@dataclass(frozen=True, slots=True)
class Certificate:
    """What `certificate.json` says.

    Attributes
    ----------
    scene : SHA-256 of what the scene says of files; one of before says that of its text.
    scene_files : SHA-256 of the files that the scene reads, by their names.
    tolerances : [mm] of each file, by its name.
    hashes : SHA-256 of each file, by its name.
    damage : why it cannot be read, or empty.
    """

    scene: str = ""
    scene_files: tuple[tuple[str, str], ...] = ()
    tolerances: tuple[tuple[str, float], ...] = ()
    hashes: tuple[tuple[str, str], ...] = ()
    damage: str = ""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the files, in their order."""
        return tuple(name for name, _ in self.hashes)

    def sha256(self, name: str) -> str:
        """SHA-256 of the file, or empty if it is not named."""
        return dict(self.hashes).get(name, "")

    def tolerance(self, name: str) -> float | None:
        """Tolerance of the file [mm], or None if it is not named."""
        return dict(self.tolerances).get(name)

    @classmethod
    def of(cls, document: Any) -> Self:
        """From the JSON document; raises KeyError or TypeError if it is none of ours."""
        scene = document["scene"]
        files = {str(name): str(sha256) for name, sha256 in scene.get("files", {}).items()}
        records = document["files"]
        return cls(
            str(scene["sha256"]),
            tuple(files.items()),
            tuple((str(file["file"]), float(file["tolerance_mm"])) for file in records),
            tuple((str(file["file"]), str(file["sha256"])) for file in records),
        )


def certificate_in(folder: Path) -> Certificate | None:
    """The certificate in `folder`; None if there is none."""
    try:
        data = (folder / CERTIFICATE).read_bytes()
    except FileNotFoundError:
        return None
    except OSError as error:
        return Certificate(damage=f"cannot be read: {error.strerror or error}")
    try:
        return Certificate.of(json.loads(data))
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        return Certificate(damage=f"is no certificate of camgeo: {type(error).__name__}: {error}")
