"""Files that a scene names: relative to the scene, and inside its folder."""

from __future__ import annotations

from pathlib import Path


def beside(folder: Path, name: str) -> Path | None:
    """Return the path of the file that a scene in `folder` calls `name`; None if it is not in it.

    `folder` is an absolute path without links.
    """
    path = (folder / name).resolve()
    return path if path.is_relative_to(folder) else None
