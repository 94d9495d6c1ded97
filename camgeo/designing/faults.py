"""What is wrong in a scene, as data for the page."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from camgeo.errors import CamgeoError, Fault, GeometryError, SceneError
from camgeo.scene.keys import key_lines, line_of, path_of


def told(error: CamgeoError, text: str = "") -> list[dict[str, Any]]:
    """The faults of a scene with that `text`; any other error as a single fault, at its key."""
    return [
        {
            "key": each.key,
            "value": each.value,
            "message": each.message,
            "hint": each.hint,
            "line": each.line,
        }
        for each in _with_lines(_faults(error), text)
    ]


def _faults(error: CamgeoError) -> tuple[Fault, ...]:
    if isinstance(error, SceneError):
        return error.faults
    if isinstance(error, GeometryError):
        return (Fault(error.key, error.value, error.message),)
    return (Fault("", "", str(error)),)


def _with_lines(faults: tuple[Fault, ...], text: str) -> tuple[Fault, ...]:
    """The faults, those that a computation found with the lines of their keys as well."""
    if all(each.line is not None or not each.key for each in faults):
        return faults
    lines = key_lines(text.replace("\r\n", "\n"))  # only a text that is TOML has faults with keys
    return tuple(
        each if each.line else replace(each, line=line_of(path_of(each.key) or (), lines))
        for each in faults
    )


def sentence(error: CamgeoError) -> str:
    """The error in one line, without the name of the file."""
    found = error.faults if isinstance(error, SceneError) else (error,)
    return " ".join("; ".join(map(str, found)).split())
