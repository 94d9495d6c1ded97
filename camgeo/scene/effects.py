"""The tables of the effects that a scene names: converted, and checked for what each needs."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from typing import Any, Final

from camgeo.dynamics.effects.effect import SPEED, Effect, Machine, Table
from camgeo.dynamics.effects.registry import find_effect
from camgeo.errors import GeometryError
from camgeo.part.materials import KG_M3, USUAL, find_material, table_density
from camgeo.part.spec import PartSpec
from camgeo.scene.keys import KeyPath
from camgeo.scene.schema import EFFECTS_KEY, FINDERS, NAMING, schema_for
from camgeo.scene.values import Inside, ValidValues, far_end_of, tables_of

ROUNDING: Final = 1e-12
"""Share by which two densities may differ and be the same in other units."""


def effect_tables(inside: Inside, faulted: Collection[str] = ()) -> dict[str, dict[str, Any]]:
    """The tables under ``[effects]`` by the names of the effects, in the units inside.

    Only valid ones; no further faults are reported for those whose keys are among `faulted`.
    """
    values = inside.values
    given = values.raw(EFFECTS_KEY)
    named = given if isinstance(given, dict) else {}
    found: dict[str, dict[str, Any]] = {}
    for name in named:
        if f"{EFFECTS_KEY}.{name}" in faulted or not values.valid(EFFECTS_KEY, name):
            continue
        effect = find_effect(name)
        own = inside.table((EFFECTS_KEY, name), effect.schema)
        if any(item is None for item in own.values()):
            continue  # a file that cannot be read, which is reported
        _judge(effect, own, named, inside)
        found[name] = own
    return found


def _judge(effect: Effect, table: dict[str, Any], named: Mapping[str, Any], inside: Inside) -> None:
    """Report what the effect's own data lack, and what it needs from the rest of the scene."""
    place, lacks = (EFFECTS_KEY, effect.name), inside.values.lacks
    try:
        effect.parse(table)
    except GeometryError as error:
        inside.fault((*place, *filter(None, error.key.split("."))), error.message)
    if lacks("follower") and not effect.of_drive:
        inside.fault(place, "needs [follower]")
        return
    speed_found = FINDERS[0] in named and inside.values.get("state", "speed") != "stated"
    for each in _with_inputs(effect, named):
        for keys in each.keys:
            if keys == SPEED and speed_found:
                continue
            if all(lacks(*key.split(".")) for key in keys):
                who = "" if each.name == effect.name else f"needs {each.name}, which "
                inside.fault(place, f"{who}needs {_spelled(keys)}")


def weighed(part: PartSpec, table: Mapping[str, Any], inside: Inside) -> PartSpec:
    """The part with its density, which the `table` of the effect `balance` may state in its place.

    That both state it is a fault unless they agree.
    """
    stated = table_density(table)
    if part.density is None:
        return replace(part, density=stated or find_material(USUAL).density)
    if stated is not None and not math.isclose(stated, part.density, rel_tol=ROUNDING):
        key = "density" if "density" in table else "material"
        inside.fault(
            (EFFECTS_KEY, "balance", key),
            f"contradicts [part], where the density is {KG_M3 * part.density:g} kg/m^3",
        )
    return part


def misfits(values: ValidValues) -> Iterator[tuple[KeyPath, str]]:
    """Effects that a scene names, or keys of their tables, that do not apply to its machine.

    Each with the reason.
    """
    machine = _machine(values)
    for effect in schema_for(tables_of(values, *NAMING)).effects:
        name, table = effect.name, values.raw(EFFECTS_KEY, effect.name)
        if not isinstance(table, dict):
            continue
        meant = {key for key in effect.schema.get("properties", {})
                 if key not in table and not values.lacks(EFFECTS_KEY, name, key)}  # fmt: skip
        own = Table({key: values.get(EFFECTS_KEY, name, key) for key in table}, meant)
        messages: dict[str, str] = {}
        for key, message in (each for rule in effect.rules for each in rule(machine, own)):
            messages.setdefault(key, message)
        for key, message in messages.items():
            yield (EFFECTS_KEY, name, *filter(None, [key])), message


def _machine(values: ValidValues) -> Machine:
    """The machine, as far as it is known."""
    kind = values.follower_kind
    return Machine(
        lift=None if kind is None else kind.unit,
        touching=None if kind is None else kind.touching,
        edged=values.get("follower", "roller_radius") == 0.0,
        far="" if values.lacks("linkage") else far_end_of(values),
        paired=values.has("follower", "return"),
        yoked=values.has("follower", "yoke"),
    )


def _with_inputs(effect: Effect, named: Mapping[str, Any]) -> list[Effect]:
    """The effect, and all effects whose results it receives, in no particular order."""
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
    """The keys of which one is needed, as messages show them."""
    tables = [f"[{key}]" if key.startswith(f"{EFFECTS_KEY}.") else f"[{head}] {tail}"
              for key in keys for head, _, tail in [key.rpartition(".")]]  # fmt: skip
    return tables[0] if len(tables) == 1 else f"one of {', '.join(tables)}"
