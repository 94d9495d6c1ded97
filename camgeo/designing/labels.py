"""Short names of changes, for undo."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from camgeo.scene.document import written
from camgeo.scene.keys import Path, path_of

NAMED: Final = 2
"""Values that a label names; more are counted."""


def title_of(path: Path) -> str:
    """What a key is called: "roller radius" for follower.roller_radius."""
    words = [str(step) for step in path if isinstance(step, str)]
    return words[-1].replace("_", " ").replace("-", " ") if words else ""


def label_of(edits: Mapping[str, Any]) -> str:
    """The name of the change that sets these values."""
    named = [f"{title_of(path_of(key) or ())} {written(value)}" for key, value in edits.items()]
    rest = len(named) - NAMED
    return ", ".join(named[:NAMED]) + (f" and {rest} more" if rest > 0 else "")
