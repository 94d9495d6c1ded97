"""Tables of a scene in the units inside, converted by the schema that declares them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Final

from camgeo.scene.data_files import DataFiles
from camgeo.scene.keys import Path
from camgeo.scene.schema import Node, schema
from camgeo.scene.sound import SoundValues
from camgeo.units import RPM

SCALES: Final[dict[str, float]] = {
    "kg": 1e-3,
    "kg m^2": 1e3,
    "kg/m^3": 1e-12,
    "N": 1.0,
    "N m": 1e3,
    "N/mm": 1.0,
    "N m/rad": 1e3,
    "N s/mm": 1.0,
    "N m s/rad": 1e3,
    "MPa": 1.0,
    "mm/s": 1.0,
    "Hz": 2.0 * math.pi,
    "hours": 3600.0,
    "rev/min": RPM,
    "degrees": math.pi / 180.0,
}
"""From the units of a scene to mm, s, t, N and rad (rad/s for Hz), by the schema's `x-unit`."""

LENGTHS: Final = ("#/$defs/length", "#/$defs/coordinate")
FILE: Final = "#/$defs/file"


class Inside:
    """Converts the tables of a scene; what is wrong with their files becomes a fault of `files`."""

    def __init__(self, values: SoundValues, files: DataFiles) -> None:
        self._values = values
        self._files = files

    def table(self, path: Path, node: Mapping[str, Any]) -> dict[str, Any]:
        """The sound table at `path`, by its schema `node`; None where a file cannot be read."""
        found: dict[str, Any] = self._value(path, self._values.get(*path), dict(node))
        return found

    def _value(self, path: Path, value: Any, node: Node) -> Any:
        if isinstance(value, dict):
            inner = node.get("properties", {})
            return {
                key: self._value((*path, key), item, inner.get(key, {}))
                for key, item in value.items()
            }
        if isinstance(value, list):
            of_items: Node = node.get("items", {})
            return tuple(
                self._value((*path, index), item, of_items) for index, item in enumerate(value)
            )
        reference = node.get("$ref", "")
        if reference == FILE:
            from camgeo.effects.effect import DataFile  # few scenes name a file

            data = self._files.read(path)
            return None if data is None else DataFile(value, data)
        if "x-path" in node and value not in node.get("x-values", ()):
            return self._files.path(path)
        if isinstance(value, str | bool):
            return value
        if "x-exact" in node:
            return self._values.exact(*path)
        if reference in LENGTHS:
            return float(value) * self._values.mm
        unit = {**schema()["$defs"].get(reference.rpartition("/")[2], {}), **node}.get("x-unit", "")
        return float(value) * (SCALES[unit] if unit else 1.0)
