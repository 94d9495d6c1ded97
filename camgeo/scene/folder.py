"""Files that a scene names: relative to the scene, and inside its folder."""

from __future__ import annotations

from pathlib import Path


def beside(scene: str, name: str) -> Path | None:
    """Return the path of the file that a scene calls `name`; None if it leaves the scene's folder.

    A scene without a file of its own counts as lying in the working directory.
    """
    folder = Path(scene).resolve().parent if scene else Path.cwd()
    path = (folder / name).resolve()
    return path if path.is_relative_to(folder) else None
