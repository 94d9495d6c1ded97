"""From a scene file to a design."""

from __future__ import annotations

from pathlib import Path

from camgeo.design import Design
from camgeo.scene.load import load_scene


def load(path: str | Path) -> Design:
    """Read a scene file and return its design; nothing is computed yet.

    Raises
    ------
    SceneError
        If anything in the file is wrong; all faults at once.
    """
    return Design(load_scene(path))
