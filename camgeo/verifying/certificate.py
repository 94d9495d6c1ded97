"""The certificate of a set of files, read back."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from camgeo.errors import FileError, unreadable
from camgeo.formats.format import LARGEST_TOLERANCE
from camgeo.reading import CERTIFICATE as CERTIFIED
from camgeo.reading import read_within
from camgeo.writing.transaction import interrupted
from camgeo.writing.write import CERTIFICATE

LONGEST: Final = 200
"""Most characters shown of the reason why a certificate is invalid."""

HASH: Final = re.compile(r"[0-9a-f]{64}")


@dataclass(frozen=True, slots=True)
class Certificate:
    """The contents of `certificate.json`.

    Attributes
    ----------
    scene : SHA-256 of what decides the files in the scene; earlier ones: of the scene's text.
    scene_files : SHA-256 of the files that the scene reads, by their names.
    tolerances : [mm] of each file, by its name.
    hashes : SHA-256 of each file, by its name, in their order.
    formats : of the files, by their names.
    damage : why it cannot be read; empty if it can.
    """

    scene: str = ""
    scene_files: Mapping[str, str] = field(default_factory=dict)
    tolerances: Mapping[str, float] = field(default_factory=dict)
    hashes: Mapping[str, str] = field(default_factory=dict)
    formats: Mapping[str, str] = field(default_factory=dict)
    damage: str = ""


def certificate_in(folder: Path) -> Certificate | None:
    """The certificate in `folder`; None if there is none."""
    if interrupted(folder):
        return Certificate(damage="is not valid: a run that wrote here was interrupted")
    try:
        data = read_within(folder / CERTIFICATE, CERTIFIED)
    except FileNotFoundError:
        return None
    except FileError as error:
        return Certificate(damage=f"cannot be used: {error}")
    except (OSError, ValueError) as error:
        return Certificate(damage=f"cannot be read: {unreadable(error)}")
    try:
        document = json.loads(data)
        scene, files = document["scene"], document["files"]
        return Certificate(
            _hash(scene["sha256"]),
            {_name(name): _hash(sha256) for name, sha256 in scene.get("files", {}).items()},
            {_name(file["file"]): _tolerance(file["tolerance_mm"]) for file in files},
            {_name(file["file"]): _hash(file["sha256"]) for file in files},
            {_name(file["file"]): str(file.get("format", "")) for file in files},
        )
    except RecursionError:
        return Certificate(damage="is not a certificate of camgeo: it is nested too deeply")
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        what = f"{type(error).__name__}: {error}"[:LONGEST]
        return Certificate(damage=f"is not a certificate of camgeo: {what}")


def _name(value: object) -> str:
    """The name of a file; ValueError if it is not one that a file may have."""
    if not isinstance(value, str) or not value.isprintable():
        raise ValueError(f"{value!r:.60} is not the name of a file")
    return value


def _hash(value: object) -> str:
    """A SHA-256; ValueError if it is none."""
    if not isinstance(value, str) or not HASH.fullmatch(value):
        raise ValueError(f"{value!r:.60} is no SHA-256")
    return value


def _tolerance(value: object) -> float:
    """A tolerance [mm]; ValueError if no file can have it."""
    if not isinstance(value, float | int) or not 0.0 < value <= LARGEST_TOLERANCE:  # or NaN
        raise ValueError(f"{value!r:.60} is not a tolerance in mm")
    return float(value)
