"""Complete results of effects, measured and compared with those of a record.

    python -m tests.effects.recorded [small] [mechanisms] [states] [fixtures]

writes the record, `fixtures/results/effects.json`, or groups of it, anew: all findings of all
effects of the scenes in `fixtures/effects` and of `recorded_scenes`, and of each column its values
at some angles and what is left of it in a few sums over the turn and over both sides of its
borders. Whoever changes an effect on purpose writes it and reads the difference.

Values agree if they are no further apart than the record states as the error of the figure, so a
solver that keeps what is stated keeps the record.
"""

from __future__ import annotations

import json
import math
import re
import sys
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any, Final

import numpy as np

from camgeo import load
from camgeo.check.finding import Finding
from camgeo.design.design import Design
from camgeo.dynamics.effects.effect import Column, Result
from camgeo.errors import EffectError, GeometryError
from camgeo.units import TURN
from tests.effects.recorded_scenes import (
    OF_FIXTURES,
    OF_SMALL,
    OF_STATES,
    TRIMMED,
    of_fixture,
    of_state,
    small,
)
from tests.effects.scenes import SCENES

FIXTURES: Final = SCENES.parent
RECORD: Final = FIXTURES / "results" / "effects.json"

ROUNDED: Final = 1e-8
"""Share of a value, or of the largest of a column, up to which roundings may differ."""

PLACED: Final = 2e-5
"""Accuracy [rad] of the place of an extreme, which is flat there: the root of some roundings."""

STATED: Final = 1.5
"""Factor between stated errors that are estimates of the same."""

NUMBER: Final = re.compile(r"-?\d+(?:\.\d+)?(?:e[+-]?\d+)?")

OFFSET: Final = 0.381966 * TURN
"""The ends of a motion are hardly ever among angles that begin there."""

SHOWN: Final = np.linspace(OFFSET / 5.0, TURN + OFFSET / 5.0, 5, endpoint=False)
"""Angles at which values of columns are kept."""

DENSE: Final = np.linspace(OFFSET / 360.0, TURN + OFFSET / 360.0, 360, endpoint=False)
"""Angles over which they are summed."""

WEIGHTS: Final = np.array([np.ones_like(DENSE), np.cos(DENSE), np.sin(DENSE), np.cos(7.0 * DENSE)])
"""Of the sums, of which no local change is left out; their means are kept."""


def digits(values: Any) -> Any:
    """Numbers as the record has them: with a digit or two more than are compared."""
    if isinstance(values, (float, np.floating)):
        return float(f"{values:.11g}")
    return [digits(each) for each in values]


def measured_column(column: Column) -> dict[str, Any]:
    """A column in a few numbers."""
    dense, borders = column.values(DENSE, "right"), np.asarray(column.borders)
    sides = [column.values(borders, side) for side in ("left", "right")]
    return {
        "unit": column.unit,
        "limit": column.limit,
        "shown": digits(column.values(SHOWN, "right")),
        "sums": digits(WEIGHTS @ dense / DENSE.size),
        "borders": [
            borders.size,
            *digits([float(np.sum(np.cos(borders))), float(np.sum(np.sin(borders)))]),
        ],
        "sides": digits([each @ np.cos(borders) for each in sides]),
        "size": float(f"{np.max(np.abs(dense)):.3g}"),
    }


def measured_finding(finding: Finding) -> dict[str, Any]:
    """A finding without what it does not have."""
    found = {
        "severity": finding.severity,
        "sentence": finding.sentence,
        "value": finding.value,
        "limit": finding.limit,
        "unit": finding.unit,
        "cam_angle": finding.cam_angle,
        "cam_range": finding.cam_range,
    }
    return {
        key: digits(each) if isinstance(each, (float, tuple)) else each
        for key, each in found.items()
        if each is not None
    }


def result_of(design: Design, effect: str) -> Result | None:
    """None where the design has no answer; its findings say why."""
    try:
        result: Result = design.effect(effect)
    except (EffectError, GeometryError):
        return None
    return result


def differences(name: str, design: Design) -> list[str]:
    """Where results of a design are not those of the record."""
    kept = record()[name]
    if list(kept) != list(design.scene.effects):
        return [f"{name}: effects {list(design.scene.effects)} instead of {list(kept)}"]
    found = []
    for effect in design.scene.effects:
        own = json.loads(json.dumps(measured(design, effect)))
        found += [f"{name}, {effect}: {each}" for each in differs(own, kept[effect])]
    return found


@cache
def record() -> dict[str, dict[str, Any]]:
    found: dict[str, dict[str, Any]] = json.loads(RECORD.read_text("utf-8"))
    return found


def measured(design: Design, effect: str) -> dict[str, Any]:
    """All that an effect says of a design."""
    try:
        findings = design.effects.findings(effect)
    except GeometryError as error:
        return {"fault": f"{error.key}: {error.message}"}
    found: dict[str, Any] = {"findings": [[each.name, measured_finding(each)] for each in findings]}
    result = result_of(design, effect)
    if result is not None:
        found["columns"] = {each.name: measured_column(each) for each in result.columns}
        found["errors"] = {
            name: [float(f"{bound.error:.3g}"), float(f"{bound.scale:.6g}")]
            for name, bound in sorted(result.errors.items())
        }
        used = result.state
        found["state"] = None if used is None else [used.motion, used.speed, used.sense]
    return found


# Comparison --------------------------------------------------------------------------------------


Way = tuple[Any, ...]
"""Keys and numbers that lead to a value."""


def leaves(of: Any, way: Way = ()) -> Iterator[tuple[Way, Any]]:
    """All numbers and texts of a result, with the way to each."""
    if isinstance(of, dict | list):
        for key, each in of.items() if isinstance(of, dict) else enumerate(of):
            yield from leaves(each, (*way, key))
    else:
        yield way, of


def said_alike(own: str, kept: str) -> bool:
    """Whether sentences are the same but for the last digits of their numbers."""
    if NUMBER.sub("", own) != NUMBER.sub("", kept):
        return False
    return all(
        math.isclose(float(one), float(other), rel_tol=1e-12, abs_tol=1.01 * last_digit(other))
        for one, other in zip(NUMBER.findall(own), NUMBER.findall(kept), strict=True)
    )


def last_digit(number: str) -> float:
    """What its last digit counts; nothing in a whole number."""
    digits_, _, power = number.partition("e")
    places = len(digits_.partition(".")[2])
    return 10.0 ** (int(power or 0) - places) if places else 0.0


def agree(way: Way, own: Any, other: Any, kept: Mapping[str, Any]) -> bool:
    """Whether a value is the `other` one of the record `kept`, as far as it states."""
    if way[-1] == "sentence":
        return said_alike(own, other)
    if not isinstance(other, float):
        return bool(own == other)
    if way[0] == "errors":  # estimates of the same; up to rounding they may be anything
        low, high = sorted((own, other))
        if way[-1] == 1:
            return math.isclose(own, other, rel_tol=1e-4, abs_tol=1e-12)
        return bool(high <= STATED * low or high <= ROUNDED * kept["errors"][way[1]][1])
    off, many = abs(own - other), 1
    if way[0] == "findings":
        name, size = kept["findings"][way[1]][0], abs(other)
        if way[3] in ("cam_angle", "cam_range"):
            return abs(math.remainder(own - other, TURN)) <= PLACED
    else:
        name, column = way[1], kept["columns"][way[1]]
        size, count = column["size"], max(column["borders"][0], 1)
        if way[2] in ("size", "limit"):
            return bool(way[2] == "size" or own == other)
        if way[2] == "borders":
            return bool(off <= PLACED * count)
        many = count if way[2] == "sides" else 1
    error = kept.get("errors", {}).get(name, [0.0])[0]
    return bool(off <= many * max(error, ROUNDED * size))


def differs(own: Mapping[str, Any], kept: Mapping[str, Any]) -> Iterator[str]:
    """Where a result of an effect is not that of the record."""
    mine, its = dict(leaves(own)), dict(leaves(kept))
    if mine.keys() != its.keys():
        lost, more = (
            sorted(each, key=str) for each in (its.keys() - mine.keys(), mine.keys() - its.keys())
        )
        yield f"lacks {lost}, has {more}"
        return
    for way, value in its.items():
        if not agree(way, mine[way], value, kept):
            yield f"{'.'.join(map(str, way))}: {mine[way]!r} instead of {value!r}"


# The record --------------------------------------------------------------------------------------


def designs(group: str) -> Iterator[tuple[str, Design]]:
    """The designs of the record with their names, of a group of `GROUPS`."""
    if group == "fixtures":
        for path in sorted((FIXTURES / "effects").glob("*.toml")):
            yield path.stem, load(path)
    elif group == "small":
        yield from ((name, small(name)) for name in OF_SMALL)
    elif group == "states":
        yield from ((name, of_state(name)) for name in (*OF_STATES, *TRIMMED))
    else:
        yield from ((name, of_fixture(name)) for name in OF_FIXTURES)


GROUPS: Final = ("small", "mechanisms", "states", "fixtures")


def write(groups: Iterable[str] = GROUPS, path: Path = RECORD) -> None:
    """Write the record of `groups` anew, and keep that of the others."""
    kept = json.loads(path.read_text("utf-8")) if path.exists() else {}
    lines = []
    for group in GROUPS:
        for name, design in designs(group):
            results = kept.get(name) if group not in groups else None
            results = results or {each: measured(design, each) for each in design.scene.effects}
            effects = ",\n".join(
                f"  {json.dumps(effect)}: {json.dumps(each)}" for effect, each in results.items()
            )
            lines.append(f" {json.dumps(name)}: {{\n{effects}\n }}")
    path.write_text("{\n" + ",\n".join(lines) + "\n}\n", "utf-8")


if __name__ == "__main__":
    write(sys.argv[1:] or GROUPS)
