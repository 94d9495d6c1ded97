"""The tables of the effects that a scene names: converted, and checked for what each needs."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from typing import Any, Final

from camgeo.dynamics.effects.effect import SPEED, Effect, EffectTable, MachineTraits
from camgeo.dynamics.effects.registry import find_effect
from camgeo.errors import GeometryError
from camgeo.part.materials import KG_M3, USUAL, find_material, table_density
from camgeo.part.spec import PartSpec
from camgeo.scene.keys import KeyPath
from camgeo.scene.schema import EFFECTS_KEY, FINDERS, NAMING, schema_for
from camgeo.scene.values import SceneConverter, ValidValues, linkage_far_end, present_tables

ROUNDING: Final = 1e-12
"""Share by which two densities may differ and be the same in other units."""


def effect_tables(
    converter: SceneConverter, faulted: Collection[str] = ()
) -> dict[str, dict[str, Any]]:
    """The tables under ``[effects]`` by the names of the effects, in internal units.

    Only valid ones; no further faults are reported for those whose keys are among `faulted`.
    """
    values = converter.values
    stated = values.raw(EFFECTS_KEY)
    named = stated if isinstance(stated, dict) else {}
    tables: dict[str, dict[str, Any]] = {}
    for name in named:
        if f"{EFFECTS_KEY}.{name}" in faulted or not values.valid(EFFECTS_KEY, name):
            continue
        effect = find_effect(name)
        table = converter.table((EFFECTS_KEY, name), effect.schema)
        if any(item is None for item in table.values()):
            continue  # a file that cannot be read, which is reported
        _check_needs(effect, table, named, converter)
        tables[name] = table
    return tables


def _check_needs(
    effect: Effect, table: dict[str, Any], named: Mapping[str, Any], converter: SceneConverter
) -> None:
    """Report faults in the table of an effect, and keys elsewhere in the scene that it lacks."""
    place, lacks = (EFFECTS_KEY, effect.name), converter.values.lacks
    try:
        effect.parse(table)
    except GeometryError as error:
        converter.fault((*place, *filter(None, error.key.split("."))), error.message)
    if lacks("follower") and not effect.of_drive:
        converter.fault(place, "needs [follower]")
        return
    # With a motor the speed is computed, so no effect needs it as a key, unless the scene insists.
    finds_speed = FINDERS[0] in named and converter.values.get("state", "speed") != "stated"
    for source in _with_inputs(effect, named):
        for keys in source.keys:
            if keys == SPEED and finds_speed:
                continue
            if all(lacks(*key.split(".")) for key in keys):
                who = "" if source.name == effect.name else f"needs {source.name}, which "
                converter.fault(place, f"{who}needs {_spelled(keys)}")


def with_density(part: PartSpec, table: Mapping[str, Any], converter: SceneConverter) -> PartSpec:
    """The part with its density, which the `table` of the effect `balance` may state instead of
    `[part]`. Both may state it only if they agree.
    """
    stated = table_density(table)
    if part.density is None:
        return replace(part, density=stated or find_material(USUAL).density)
    if stated is not None and not math.isclose(stated, part.density, rel_tol=ROUNDING):
        key = "density" if "density" in table else "material"
        converter.fault(
            (EFFECTS_KEY, "balance", key),
            f"contradicts [part], where the density is {KG_M3 * part.density:g} kg/m^3",
        )
    return part


def misfits(values: ValidValues) -> Iterator[tuple[KeyPath, str]]:
    """Effects that a scene names, or keys of their tables, that do not apply to its machine.

    Each with the reason.
    """
    machine = _machine(values)
    for effect in schema_for(present_tables(values, *NAMING)).effects:
        name, table = effect.name, values.raw(EFFECTS_KEY, effect.name)
        if not isinstance(table, dict):
            continue
        meant = {key for key in effect.schema.get("properties", {})
                 if key not in table and not values.lacks(EFFECTS_KEY, name, key)}  # fmt: skip
        stated = EffectTable({key: values.get(EFFECTS_KEY, name, key) for key in table}, meant)
        messages: dict[str, str] = {}
        for key, message in (fault for rule in effect.rules for fault in rule(machine, stated)):
            messages.setdefault(key, message)
        for key, message in messages.items():
            yield (EFFECTS_KEY, name, *filter(None, [key])), message


def _machine(values: ValidValues) -> MachineTraits:
    """The properties of the cam drive on which rules of effects depend, as far as known."""
    kind = values.follower_kind
    return MachineTraits(
        lift=None if kind is None else kind.unit,
        touching=None if kind is None else kind.touching,
        edged=values.get("follower", "roller_radius") == 0.0,
        far="" if values.lacks("linkage") else linkage_far_end(values),
        paired=values.has("follower", "return"),
        yoked=values.has("follower", "yoke"),
    )


def _with_inputs(effect: Effect, named: Mapping[str, Any]) -> list[Effect]:
    """The effect, and all effects whose results it uses, directly or indirectly, in any order."""
    effects = {effect.name: effect}
    waiting = [effect]
    while waiting:
        current = waiting.pop()
        for name in (*current.needs, *(use for use in current.uses if use in named)):
            if name not in effects:
                effects[name] = find_effect(name)
                waiting.append(effects[name])
    return list(effects.values())


def _spelled(keys: tuple[str, ...]) -> str:
    """The keys of which one is needed, as messages show them."""
    tables = [f"[{key}]" if key.startswith(f"{EFFECTS_KEY}.") else f"[{head}] {tail}"
              for key in keys for head, _, tail in [key.rpartition(".")]]  # fmt: skip
    return tables[0] if len(tables) == 1 else f"one of {', '.join(tables)}"
