"""What is wrong in a scene, as data for the page."""

from __future__ import annotations

from typing import Any

from camgeo.errors import CamgeoError, Fault, SceneError


def told(error: CamgeoError) -> list[dict[str, Any]]:
    """The faults of a scene; any other error as a single fault."""
    found = error.faults if isinstance(error, SceneError) else (Fault("", "", str(error)),)
    return [
        {
            "key": each.key,
            "value": each.value,
            "message": each.message,
            "hint": each.hint,
            "line": each.line,
        }
        for each in found
    ]


def sentence(error: CamgeoError) -> str:
    """The error in one line, without the name of the file."""
    found = error.faults if isinstance(error, SceneError) else (error,)
    return " ".join("; ".join(map(str, found)).split())
