"""Values drawn by the schema of scenes, and edits of a scene that follow it or break it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from random import Random
from typing import Any, Final

from camgeo.scene.schema import Node, resolved, table_keys, whole_schema
from tests.effects.test_random_scenes import USUAL
from tests.hostile.mutations import EDGES

WHOLE: Final = whole_schema()

RANGES: Final = {**USUAL, "length": (0.5, 2e2), "derivative": (1e-2, 1e2), "weight": (0.1, 1.0)}
"""Where designers' numbers lie, by the name of a definition."""


WORDS: Final = ("", "a", "Ω", "nan", "../x", "con", "-rf", "\u202e", "\x1b[31m", "x" * 300, "ß-Ä")

WRONG: Final[tuple[Any, ...]] = (True, "12", "", [], {}, [[]], [0], {"x": 1}, [{}], ["a", "a"], 1)

Place = tuple[dict[str, Any], str, Node]
"""A table of the scene, a key, and what the schema says of it."""


def value(rng: Random, node: Node | bool) -> Any:
    """A value that the schema allows at `node`, mostly a usual one."""
    node = node if isinstance(node, dict) else {}
    name = node.get("$ref", "").rpartition("/")[2]
    node = resolved(node)
    if "anyOf" in node:
        return value(rng, rng.choice(node["anyOf"]))
    if "const" in node or "enum" in node:
        return rng.choice(node.get("enum") or [node["const"]])
    match node.get("type"):
        case "boolean":
            return rng.random() < 0.5
        case "integer":
            return rng.randint(int(node.get("minimum", 0)), int(node.get("maximum", 100)))
        case "array":
            most = node.get("maxItems", node.get("minItems", 1) + 2)
            count = rng.randint(node.get("minItems", 1), min(most, 6))
            return [value(rng, node.get("items", {})) for _ in range(count)]
        case "object":
            return table(rng, node)
        case "string":
            return rng.choice(("steel", "missing.csv", "linuxcnc", "a"))
    return number(rng, node, name)


def table(rng: Random, node: Node) -> dict[str, Any]:
    """A table with all keys that it must have, and some of the others."""
    found: dict[str, Any] = {}
    required = resolved(node).get("required", ())
    for key, inner in table_keys(node, found).items():
        if key in required or rng.random() < 0.3:
            found[key] = value(rng, inner)
    return found


def number(rng: Random, node: Node, name: str) -> float:
    """A number: usual for what `name` defines, or anywhere in the range of the schema."""
    stated = {key.removeprefix("exclusive").lower(): bound for key, bound in node.items()}
    least, most = float(stated.get("minimum", -1e6)), float(stated.get("maximum", 1e6))
    chance = rng.random()
    if chance < 0.06:
        return rng.choice((least, most, 0.0))
    if chance < 0.12:
        size = math.exp(rng.uniform(math.log(1e-12), math.log(max(abs(least), most, 1e-11))))
    elif name in RANGES:
        low, high = RANGES[name]
        size = math.exp(rng.uniform(math.log(low), math.log(high)))
    else:
        size = rng.uniform(max(least, 0.0), min(most, 1e3))
    sign = -1.0 if least < 0.0 and rng.random() < 0.4 else 1.0
    return float(f"{min(max(sign * size, least), most):.5g}")


def places(values: dict[str, Any], node: Node | None = None) -> Iterator[Place]:
    """All keys that the tables of a scene have or may have."""
    for key, inner in table_keys(WHOLE if node is None else node, values).items():
        yield values, key, inner
        found, items = values.get(key), resolved(inner).get("items", {})
        for each in found if isinstance(found, list) else ():
            if isinstance(each, dict):
                yield from places(each, items)
        if isinstance(found, dict):
            yield from places(found, inner)


def edit(rng: Random, values: dict[str, Any], *, wild: bool) -> None:
    """Change one place of a scene: a plausible change, or if `wild` any that breaks it."""
    known = list(places(values))
    there = [place for place in known if place[1] in place[0]]
    numbers = [place for place in there if isinstance(place[0][place[1]], float | int)]
    inside, key, node = rng.choice(there)
    if wild:
        match rng.randrange(6):
            case 0:
                del inside[key]
            case 1:
                inside[rng.choice((*WORDS, key + "s", "kind"))] = rng.choice(WRONG)
            case 2:
                inside[key] = rng.choice((*WRONG, *WORDS))
            case _ if numbers:
                inside, key, _ = rng.choice(numbers)
                inside[key] = rng.choice(EDGES)
        return
    match rng.randrange(8):
        case 0 | 1 if numbers:
            inside, key, _ = rng.choice(numbers)
            inside[key] = near(rng, inside[key])
        case 2 if numbers:  # critical where two numbers are equal or nearly so
            inside, key, _ = rng.choice(numbers)
            other = rng.choice(numbers)
            inside[key] = near(rng, other[0][other[1]], critical=True)
        case 3 if len(known) > len(there):
            inside, key, node = rng.choice([place for place in known if place[1] not in place[0]])
            inside[key] = value(rng, node)
        case 4:
            inside[key] = value(rng, node)
        case 5 | 6 if isinstance(values.get("motion"), list):
            edit_motion(rng, values["motion"])
        case _:
            limits = value(rng, WHOLE["properties"]["limits"])
            values["limits"] = {**values.get("limits", {}), **limits}


def near(rng: Random, size: float, *, critical: bool = False) -> float:
    """A number somewhat larger or smaller, from one unit in the last place on."""
    if rng.random() < 0.15:
        return math.nextafter(size, rng.choice((-math.inf, math.inf)))
    if critical and rng.random() < 0.4:
        return size
    share = 10.0 ** rng.uniform(-14.0, -1.0 if critical else 0.0)
    return float(size * (1.0 + rng.choice((-1.0, 1.0)) * share))


def edit_motion(rng: Random, motion: list[Any]) -> None:
    """Move span from a segment to another, take one away, halve one, or reverse their order."""
    spans = [each for each in motion if isinstance(each, dict) and span_of(each) is not None]
    if len(spans) < 2:
        return
    one, other = rng.sample(spans, 2)
    match rng.randrange(4):
        case 0:
            part = (span_of(one) or 0.0) * rng.choice((0.5, 0.9, 0.999, 1.0 - 1e-6))
            part = round(part, 6)
            set_span(one, round((span_of(one) or 0.0) - part, 9))
            set_span(other, round((span_of(other) or 0.0) + part, 9))
        case 1:
            set_span(other, round((span_of(one) or 0.0) + (span_of(other) or 0.0), 9))
            motion.remove(one)
        case 2:
            set_span(one, (span_of(one) or 0.0) / 2.0)
            motion.insert(motion.index(one), dict(one))
        case _:
            motion.reverse()


def span_of(segment: dict[str, Any]) -> float | None:
    """Its span [degrees], if it states one."""
    found = segment.get("span", segment.get("dwell"))
    is_number = isinstance(found, float | int) and not isinstance(found, bool)
    return found if is_number else None


def set_span(segment: dict[str, Any], span: float) -> None:
    """State another span [degrees]."""
    segment["dwell" if "dwell" in segment else "span"] = span
