"""The tables of the effects that a scene names: converted, and held against what each asks for."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping
from typing import Any, Final

from camgeo.effects.effect import DataFile, Effect
from camgeo.effects.registry import find_effect
from camgeo.effects.rules import Machine, Table
from camgeo.errors import Fault, GeometryError
from camgeo.scene.data_files import DataFiles
from camgeo.scene.schema import EFFECTS, Node, schema, schema_for
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


class EffectTables:
    """The tables under ``[effects]``.

    Of tables whose keys are among `faulted` nothing more is told.

    Attributes
    ----------
    all : by the names of the effects, in the scene's order; numbers in the units inside. Only those
        of which nothing is wrong.
    faults : what is wrong with them.
    """

    def __init__(
        self, values: SoundValues, files: DataFiles, faulted: Collection[str] = ()
    ) -> None:
        self._values = values
        self._files = files
        named = values.scene.plain.get(EFFECTS)
        self._named: Mapping[str, Any] = named if isinstance(named, dict) else {}
        self.faults: list[Fault] = []
        self.all: dict[str, dict[str, Any]] = {}
        for name, table in self._named.items():
            if f"{EFFECTS}.{name}" in faulted or not values.sound(EFFECTS, name):
                continue
            effect = find_effect(name)
            nodes: Mapping[str, Node] = effect.schema.get("properties", {})
            own = {key: self._converted((EFFECTS, name, key), item, nodes.get(key, {}))
                   for key, item in table.items()}  # fmt: skip
            if any(item is None for item in own.values()):
                continue  # a file that cannot be read, which is told
            self._judge(effect, own)
            self.all[name] = own

    def _judge(self, effect: Effect, table: dict[str, Any]) -> None:
        """Find what the effect's own data lack, and what it needs of the rest of the scene."""
        place = (EFFECTS, effect.name)
        try:
            effect.parse(table)
        except GeometryError as error:
            path = (*place, error.key) if error.key else place
            self.faults.append(self._values.scene.fault(path, error.message))
        for each in _with_inputs(effect, self._named):
            for keys in each.keys:
                if any(not self._values.lacks(*key.split(".")) for key in keys):
                    continue
                who = "" if each.name == effect.name else f"needs {each.name}, which "
                fault = self._values.scene.fault(place, f"{who}needs {_spelled(keys)}")
                self.faults.append(fault)

    def _converted(self, path: tuple[str, ...], value: Any, node: Node) -> Any:
        """A value of a table in the units inside."""
        if isinstance(value, dict):
            inner = node.get("properties", {})
            return {
                key: self._converted((*path, key), item, inner.get(key, {}))
                for key, item in value.items()
            }
        if isinstance(value, list):
            of_items: Node = node.get("items", {})
            return tuple(self._converted(path, item, of_items) for item in value)
        reference = node.get("$ref", "")
        if reference == FILE:
            data = self._files.read(path)
            return None if data is None else DataFile(value, data)
        if isinstance(value, str | bool):
            return value
        if reference in LENGTHS:
            return float(value) * self._values.mm
        unit = {**schema()["$defs"].get(reference.rpartition("/")[2], {}), **node}.get("x-unit", "")
        return float(value) * (SCALES[unit] if unit else 1.0)


def misfits(values: SoundValues) -> Iterator[Fault]:
    """Effects that a scene names, or keys of their tables, that have no place on its machine."""
    machine = _machine(values)
    for effect in schema_for(values.scene.plain).effects:
        name, table = effect.name, values.scene.plain[EFFECTS][effect.name]
        if not isinstance(table, dict):
            continue
        meant = {key for key in effect.schema.get("properties", {})
                 if key not in table and not values.lacks(EFFECTS, name, key)}  # fmt: skip
        own = Table({key: values.get(EFFECTS, name, key) for key in table}, meant)
        for rule in effect.rules:
            for key, message in rule(machine, own):
                yield values.scene.fault((EFFECTS, name, *filter(None, [key])), message)


def _machine(values: SoundValues) -> Machine:
    """The machine as far as it is known."""
    return Machine(
        flat=None if values.follower_kind is None else values.flat,
        far="" if values.lacks("linkage") else values.far_end,
        paired=values.has("follower", "return"),
        yoked=values.has("follower", "yoke"),
    )


def _with_inputs(effect: Effect, named: Mapping[str, Any]) -> list[Effect]:
    """The effect, and all whose results it is given, without their order."""
    found = {effect.name: effect}
    waiting = [effect]
    while waiting:
        each = waiting.pop()
        for name in (*each.needs, *(use for use in each.uses if use in named)):
            if name not in found:
                found[name] = find_effect(name)
                waiting.append(found[name])
    return list(found.values())


def _spelled(keys: tuple[str, ...]) -> str:
    """The keys of which one is needed, as messages tell them."""
    tables = [f"[{key}]" if key.startswith(f"{EFFECTS}.") else f"[{head}] {tail}"
              for key in keys for head, _, tail in [key.rpartition(".")]]  # fmt: skip
    return tables[0] if len(tables) == 1 else f"one of {', '.join(tables)}"
