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
from camgeo.dynamics.effects.effect import Bound, Column, Result
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


def apart(name: str, own: Any, other: Any, error: float) -> Iterator[str]:
    """Where numbers differ by more than an error."""
    if np.shape(own) != np.shape(other):
        yield f"{name}: {own} instead of {other}"
        return
    one, two = np.asarray(own, dtype=float), np.asarray(other, dtype=float)
    if one.size and not np.all(np.abs(one - two) <= error):
        worst = float(np.max(np.abs(one - two)))
        yield f"{name}: {own} instead of {other}, off by {worst:.3g}, allowed {error:.3g}"


def column_differs(own: Mapping[str, Any], kept: Mapping[str, Any], error: float) -> Iterator[str]:
    allowed, count = max(error, ROUNDED * kept["size"]), max(kept["borders"][0], 1)
    for key, times in (("shown", 1), ("sums", 1), ("sides", count)):
        yield from apart(key, own[key], kept[key], times * allowed)
    yield from apart("borders", own["borders"], kept["borders"], PLACED * count)
    for key in ("unit", "limit"):
        if own[key] != kept[key]:
            yield f"{key}: {own[key]} instead of {kept[key]}"


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


def finding_differs(own: Mapping[str, Any], kept: Mapping[str, Any], error: float) -> Iterator[str]:
    if own.keys() != kept.keys():
        yield f"has {[*own]} instead of {[*kept]}"
        return
    for key in ("severity", "unit", "sentence"):
        same = said_alike(own[key], kept[key]) if key == "sentence" else own[key] == kept[key]
        if not same:
            yield f"{key}: {own[key]!r} instead of {kept[key]!r}"
    for key in ("value", "limit"):
        if key in kept:
            yield from apart(key, own[key], kept[key], max(error, ROUNDED * abs(kept[key])))
    for key in ("cam_angle", "cam_range"):
        if key in kept:
            turned = (np.asarray(own[key]) - np.asarray(kept[key]) + math.pi) % TURN - math.pi
            yield from apart(key, turned, np.zeros_like(turned), PLACED)


def differs(own: Mapping[str, Any], kept: Mapping[str, Any]) -> Iterator[str]:
    """Where a result of an effect is not that of the record."""
    for key in ("fault", "state"):
        if own.get(key) != kept.get(key):
            yield f"{key}: {own.get(key)} instead of {kept.get(key)}"
    errors: Mapping[str, list[float]] = kept.get("errors", {})
    names = [[name for name, _ in each.get("findings", ())] for each in (own, kept)]
    if names[0] != names[1]:
        yield f"findings: {names[0]} instead of {names[1]}"
        return
    for (name, one), (_, other) in zip(
        own.get("findings", ()), kept.get("findings", ()), strict=True
    ):
        for each in finding_differs(one, other, errors.get(name, [0.0])[0]):
            yield f"{name}: {each}"
    columns: list[Mapping[str, Any]] = [each.get("columns", {}) for each in (own, kept)]
    if list(columns[0]) != list(columns[1]):
        yield f"columns: {list(columns[0])} instead of {list(columns[1])}"
        return
    for name, column in columns[1].items():
        for each in column_differs(columns[0][name], column, errors.get(name, [0.0])[0]):
            yield f"{name}: {each}"
    stated: Mapping[str, list[float]] = own.get("errors", {})
    if stated.keys() != errors.keys():
        yield f"errors: of {sorted(stated)} instead of {sorted(errors)}"
        return
    for name, bound in errors.items():
        if not alike(Bound(*stated[name]), Bound(*bound)):
            yield f"error of {name}: {stated[name]} instead of {bound}"


def alike(own: Bound, kept: Bound) -> bool:
    """Whether errors are estimates of the same; up to rounding they may be anything."""
    low, high = sorted((own.error, kept.error))
    near = math.isclose(own.scale, kept.scale, rel_tol=1e-4, abs_tol=1e-12)
    return near and (high <= STATED * low or high <= ROUNDED * kept.scale)


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
