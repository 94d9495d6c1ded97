"""The certificate of a set of files, read back."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from camgeo.writing.transaction import interrupted
from camgeo.writing.write import CERTIFICATE


@dataclass(frozen=True, slots=True)
class Certificate:
    """The contents of `certificate.json`.

    Attributes
    ----------
    scene : SHA-256 of what decides the files in the scene; earlier ones: of the scene's text.
    scene_files : SHA-256 of the files that the scene reads, by their names.
    tolerances : [mm] of each file, by its name.
    hashes : SHA-256 of each file, by its name, in their order.
    damage : why it cannot be read; empty if it can.
    """

    scene: str = ""
    scene_files: Mapping[str, str] = field(default_factory=dict)
    tolerances: Mapping[str, float] = field(default_factory=dict)
    hashes: Mapping[str, str] = field(default_factory=dict)
    damage: str = ""


def certificate_in(folder: Path) -> Certificate | None:
    """The certificate in `folder`; None if there is none."""
    if interrupted(folder):
        return Certificate(damage="is not valid: a run that wrote here was interrupted")
    try:
        data = (folder / CERTIFICATE).read_bytes()
    except FileNotFoundError:
        return None
    except OSError as error:
        return Certificate(damage=f"cannot be read: {error.strerror or error}")
    try:
        document = json.loads(data)
        scene, files = document["scene"], document["files"]
        return Certificate(
            str(scene["sha256"]),
            {str(name): str(sha256) for name, sha256 in scene.get("files", {}).items()},
            {str(file["file"]): float(file["tolerance_mm"]) for file in files},
            {str(file["file"]): str(file["sha256"]) for file in files},
        )
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        return Certificate(damage=f"is no certificate of camgeo: {type(error).__name__}: {error}")
