"""Scenes in mm with the same lengths in inches."""

from __future__ import annotations

from collections.abc import Mapping
from decimal import Decimal
from typing import Any, Final

import tomlkit

from camgeo.app.designing.form import Fields
from camgeo.scene.scene import Scene
from camgeo.scene.values import Document

INCH: Final = Decimal("25.4")
"""Millimetres."""

DIGITS: Final = 15


def in_inches(scene: Scene, edits: Mapping[str, Any] | None = None) -> str:
    """TOML of a scene that states its lengths in mm, in inches to `DIGITS` digits."""
    values = scene.with_values(edits or {}).values
    fields = Fields(
        Document.from_values({**values, "units": {**values.get("units", {}), "length": "inch"}})
    )
    found = _converted((), values, fields)
    found["units"] = {**found.get("units", {}), "length": "inch"}
    return tomlkit.dumps(found)


def _converted(path: tuple[str | int, ...], value: Any, fields: Fields) -> Any:
    if isinstance(value, Mapping):
        return {key: _converted((*path, key), each, fields) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_converted((*path, place), each, fields) for place, each in enumerate(value)]
    if isinstance(value, bool) or not isinstance(value, int | float | Decimal):
        return value
    around = path[:-1] if isinstance(path[-1], int) else path
    is_length = any(fields.unit(each).startswith("inch") for each in (path, around))
    number = Decimal(str(value)) / INCH if is_length else value
    return float(f"{number:.{DIGITS}g}") if isinstance(number, Decimal) else number
