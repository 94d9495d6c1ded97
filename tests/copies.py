"""Copies of the package, to which a test adds something new."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import camgeo


def copied(folder: Path) -> Path:
    """The package as it stands in a copy in `folder`."""
    package = folder / "camgeo"
    ignored = shutil.ignore_patterns("__pycache__")
    shutil.copytree(Path(camgeo.__file__).parent, package, ignore=ignored)
    return package


def replaced(path: Path, *changes: tuple[str, str]) -> None:
    """Put other text in place of some that stands once in a file of the copy."""
    text = path.read_text(encoding="utf-8")
    for old, new in changes:
        assert text.count(old) == 1
        text = text.replace(old, new)
    path.write_text(text, encoding="utf-8")


def run_copy(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run Python on the copy in `folder`."""
    return subprocess.run(
        [sys.executable, *arguments],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(folder)},
        capture_output=True,
        text=True,
        check=False,
    )
