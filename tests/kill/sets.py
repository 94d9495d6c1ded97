"""Small sets of files with a certificate, and whether a folder holds one of them, whole."""

from __future__ import annotations

import hashlib
import json
import random
from pathlib import Path
from typing import Final

from camgeo.app.answers.verify import certificate_in
from camgeo.design.writing import CERTIFICATE, STAGING, interrupted

Files = dict[str, bytes]

MEMORY: Final = "/dev/shm" if Path("/dev/shm").is_dir() else None
"""A folder on no disk; None for the usual one."""


def stub_set(seed: int, names: tuple[str, ...], size: int = 500) -> Files:
    """Files of random bytes and a certificate of them, the last one."""
    source = random.Random(seed)
    files = {name: source.randbytes(size) for name in names}
    records = [
        {"file": name, "tolerance_mm": 0.001, "sha256": hashlib.sha256(data).hexdigest()}
        for name, data in files.items()
    ]
    document = {"scene": {"sha256": str(seed)}, "files": records}
    return files | {CERTIFICATE: json.dumps(document).encode()}


BEFORE: Final = stub_set(1, ("a.dxf", "b.ngc", "old.csv"))

WRITTEN: Final = stub_set(2, ("a.dxf", "b.ngc", "c.stl"))

FURTHER: Final = stub_set(3, ("a.dxf", "c.stl"))


def put(folder: Path, files: Files) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for name, data in files.items():
        (folder / name).write_bytes(data)


def everything(folder: Path) -> Files:
    """All files below a folder, hidden ones too."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def is_whole(folder: Path, *sets: Files) -> bool:
    """Whether one of `sets` is all that is there; no folder is the empty set."""
    return not (folder / STAGING).exists() and everything(folder) in sets


def is_safe(folder: Path, old: Files, new: Files) -> bool:
    """What must hold right after a stop: no file is torn, none lies under the certificate of
    another set, and a set that is not whole is called interrupted.

    `new` is the whole state after the run, with what it leaves alone.
    """
    seen = {
        path.name: path.read_bytes() for path in folder.glob("*") if path.is_file()
    }  # what is staged is nobody's file yet
    if any(data not in (old.get(name), new.get(name)) for name, data in seen.items()):
        return False
    if seen in (old, new):
        return True
    certificate = certificate_in(folder)
    said = certificate is not None and "interrupted" in certificate.damage
    return CERTIFICATE not in seen and interrupted(folder) and said
