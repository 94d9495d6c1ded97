"""The values of a scene in internal units, with the files that it names, and their faults."""

from __future__ import annotations

import math
import pathlib
from collections.abc import Mapping
from typing import Any, Final

from camgeo.errors import CamgeoError, Fault, unreadable
from camgeo.reading import TABLE
from camgeo.scene.keys import Path, spelled
from camgeo.scene.schema import Node, schema
from camgeo.scene.valid_values import Noted, ValidValues
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
    "m/min": 1e3,
    "Hz": 2.0 * math.pi,
    "hours": 3600.0,
    "s": 1.0,
    "rev/min": RPM,
    "degrees": math.pi / 180.0,
}
"""From the units of a scene to mm, s, t, N and rad (rad/s for Hz), by the schema's `x-unit`.

Cutting speeds are in mm/min, as feeds are."""

LENGTHS: Final = ("#/$defs/length", "#/$defs/coordinate")
"""References of numbers in the scene's unit of length, unless they have a default in mm."""

FILE: Final = "#/$defs/file"


NO_FOLDER: Final = (
    "names a file, which needs a folder: load the scene from a file, or with folder=..."
)


class Inside:
    """Converts the values of a scene, and reads its files; collects the faults of both.

    Parameters
    ----------
    values : of the scene.
    folder : in which its files lie, absolute and without links; None if there is none.
    known : contents of files, by their names; these files are not read again.

    Attributes
    ----------
    faults : what geometry and files forbid.
    contents : of the files that were read, by the names that the scene gives them.
    hashes : SHA-256 of data, hexadecimal, by the same names.
    """

    def __init__(
        self,
        values: ValidValues,
        folder: pathlib.Path | None = None,
        known: Mapping[str, bytes] | None = None,
    ) -> None:
        self.values = values
        self.faults: list[Fault] = []
        self.contents: dict[str, bytes] = {}
        self.hashes: dict[str, str] = {}
        self._folder = folder
        self._known = known or {}

    def noting(self) -> tuple[Inside, Noted]:
        """Another one that notes what is read of the same values, none of which may be wrong."""
        noted = Noted(self.values.scene)
        return Inside(noted, self._folder, {**self._known, **self.contents}), noted

    def take(self, other: Inside) -> None:
        """All that the other one has found."""
        self.faults += [fault for fault in other.faults if fault not in self.faults]
        self.contents |= other.contents
        self.hashes |= other.hashes

    def fault(self, path: Path, message: str, hint: str = "") -> None:
        """Note a fault of the value at `path`, which need not exist, once."""
        found = self.values.scene.fault(path, message, hint)
        if found not in self.faults:
            self.faults.append(found)

    def read(self, key: Path) -> bytes | None:
        """The data that the scene names at `key`, at most one byte too many; None with a fault."""
        if self.path(key) is None:
            return None
        import hashlib  # few scenes name a file

        name: str = self.values.get(*key)
        data = self.contents[name]
        self.hashes[name] = hashlib.sha256(data).hexdigest()
        return data

    def path(self, key: Path) -> str | None:
        """Path of the file that the scene names at `key`; None with a fault.

        Its present content is kept too.
        """
        name: str = self.values.get(*key)
        if self._folder is None:
            self.fault(key, NO_FOLDER)
            return None
        path = (self._folder / name).resolve()
        if not path.is_relative_to(self._folder):
            self.fault(key, "must not leave the folder of the scene")
            return None
        data = self.contents.get(name, self._known.get(name))
        if data is None:
            try:
                with path.open("rb") as stream:
                    data = stream.read(TABLE.size + 1)
            except (OSError, ValueError) as error:
                self.fault(key, f"cannot be read: {unreadable(error)}")
                return None
        self.contents[name] = data
        return str(path)

    def table(self, path: Path, node: Mapping[str, Any]) -> dict[str, Any]:
        """The valid table at `path`, by its schema `node`; None where a file cannot be read."""
        found: dict[str, Any] = self._value(path, self.values.get(*path), dict(node))
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

            data = self.read(path)
            return None if data is None else DataFile(value, data)
        if "x-path" in node and value not in node.get("x-values", ()):
            return self.path(path)
        if isinstance(value, str | bool):
            return value
        if "x-exact" in node:
            return self.values.exact(*path)
        if reference in LENGTHS or "x-default-mm" in node:
            return float(value) * self.values.mm
        unit = {**schema()["$defs"].get(reference.rpartition("/")[2], {}), **node}.get("x-unit", "")
        return float(value) * (_scale(path, unit) if unit else 1.0)


def _scale(path: Path, unit: str) -> float:
    """The factor from `unit` to the unit inside; CamgeoError if there is no such unit."""
    if unit in SCALES:
        return SCALES[unit]
    raise CamgeoError(
        f'{spelled(path)}: the x-unit "{unit}" of its schema is unknown; known: {", ".join(SCALES)}'
    )
