"""The smallest wall of random parts, against shapely and distances of circles."""

from __future__ import annotations

import cmath
import math
import random
import sys
from collections.abc import Iterator
from typing import Any, Final

import numpy as np
import shapely
import tomlkit

import camgeo
from camgeo.design.judged_part import part_findings
from tests.draws.run import Case, parser_of, run_cases
from tests.end_to_end.independent import Model

OFF: Final = 2e-6
"""Of walls [mm]: a chord of 0.01 degree leaves a flank of radius 70 by 3e-7, and the wall is known
within twice the finest tolerance of its fits."""

Shape = tuple[str, shapely.Geometry, float]
"""A boundary: its name, points or a ring [mm], and the radius [mm] of the circles about these."""


def drawn(source: random.Random) -> dict[str, Any]:
    """The values of a disc with some of bore, keyway, hub, bolt circle, lightening holes, rim."""
    base, lift = source.uniform(45.0, 70.0), source.uniform(3.0, 15.0)
    spans = [120.0, source.choice([60.0, 100.0, 140.0]), 0.0]
    spans[2] = 360.0 - sum(spans)
    groove = source.random() < 0.3
    low = base - 8.0
    part: dict[str, Any] = {"thickness": 12.0}
    if source.random() < 0.8:
        part["bore"] = bore = source.uniform(8.0, 0.9 * low)
        if source.random() < 0.5:
            turn = {"angle": source.uniform(0.0, 360.0)}
            part["keyway"] = {"width": bore * source.uniform(0.2, 0.5), "depth": 3.0, **turn}
    inside = 0.5 * part.get("bore", 8.0) + 3.5
    if source.random() < 0.4:
        radius = inside + source.uniform(0.5, 8.0)
        part["hub"] = {"diameter": 2.0 * radius, "height": 6.0}
        inside = radius
    for table in ("bolt_circle", "lightening_holes"):
        if source.random() < 0.7:
            hole = source.uniform(2.0, 10.0)
            part[table] = {
                "count": source.randint(1, 6),
                "circle": 2.0 * source.uniform(inside, low + lift),
                "hole": hole,
                "angle": source.uniform(0.0, 360.0),
            }
    if groove:
        part["rim"] = 2.0 * (base + lift + 8.0) + source.uniform(1.0, 20.0)
        part["groove_depth"] = 5.0
    return {
        "camgeo": 1,
        "name": "walls",
        "cam": {"rotation": source.choice(["cw", "ccw"])},
        "follower": {
            "kind": "translating-roller",
            "base_radius": base,
            "roller_radius": 8.0,
            "contact": "groove" if groove else "inner",
        },
        "motion": [
            {"dwell": spans[0]},
            {"law": "inclined-sine", "span": spans[1], "to": lift},
            {"law": "inclined-sine", "span": spans[2], "to": 0.0},
        ],
        "part": part,
    }


def flank(values: dict[str, Any], side: int, step: float = 0.01) -> shapely.LinearRing:
    """The parallel of the path of the roller's centre, outside it for 1, inside it for -1, by
    places `step` [degrees] apart.
    """
    points = Model(values).flank(np.radians(np.arange(0.0, 360.0, step)), side)
    return shapely.LinearRing(np.column_stack((points.real, points.imag)))


def circles(table: dict[str, Any], name: str) -> list[Shape]:
    """Round holes."""
    first, count = math.radians(table["angle"]), table["count"]
    middles = [
        cmath.rect(0.5 * table["circle"], first + math.tau * k / count) for k in range(count)
    ]
    return [
        (f"{name} {k}", shapely.Point(each.real, each.imag), 0.5 * table["hole"])
        for k, each in enumerate(middles, start=1)
    ]


def bore(part: dict[str, Any]) -> Shape:
    """A circle about the cam axis; with a keyway a ring of chords."""
    radius = 0.5 * part["bore"]
    keyway = part.get("keyway")
    if keyway is None:
        return "bore", shapely.Point(0.0, 0.0), radius
    half, turn = 0.5 * keyway["width"], cmath.exp(1j * math.radians(keyway["angle"]))
    opening = math.asin(half / radius)
    around = radius * np.exp(1j * np.linspace(opening, math.tau - opening, 20_001))
    bottom = radius + keyway["depth"]
    points = turn * np.concatenate((around, [bottom - 1j * half, bottom + 1j * half]))
    return "bore", shapely.LinearRing(np.column_stack((points.real, points.imag))), 0.0


def walls(values: dict[str, Any]) -> dict[frozenset[str], float]:
    """Every wall [mm], by the names of its two boundaries."""
    part = values["part"]
    groove = values["follower"]["contact"] == "groove"
    inner = flank(values, -1)
    within: list[Shape] = [("inner flank" if groove else "outline", inner, 0.0)]
    holes: list[Shape] = [bore(part)] if "bore" in part else []
    drilled = [
        hole
        for table, name in (("bolt_circle", "bolt hole"), ("lightening_holes", "lightening hole"))
        for hole in circles(part.get(table, {"angle": 0, "count": 0}), name)
    ]
    pairs: list[tuple[Shape, Shape]] = [(a, b) for a in within for b in (*holes, *drilled)]
    if groove:
        rim: Shape = ("rim", shapely.Point(0.0, 0.0), -0.5 * part["rim"])
        pairs += [
            (rim, each) for each in (*holes, *drilled, ("outer flank", flank(values, 1), 0.0))
        ]
    if "hub" in part and holes:
        pairs.append((("hub", shapely.Point(0.0, 0.0), -0.5 * part["hub"]["diameter"]), holes[0]))
    cut = (*holes, *drilled)
    pairs += [(a, b) for k, a in enumerate(cut) for b in cut[k + 1 :]]
    return {frozenset((a[0], b[0])): distance(a, b) for a, b in pairs}


def distance(one: Shape, other: Shape) -> float:
    """Between two boundaries [mm]; a circle of negative radius is around the other."""
    (_, a, around), (_, b, radius) = one, other
    if around < 0.0:
        return -around - radius - float(shapely.hausdorff_distance(b, a))
    return float(shapely.distance(a, b)) - around - radius


def misses(count: int, seed: int) -> Iterator[Case]:
    """Parts that have a smallest wall, and what differs."""
    source, compared = random.Random(seed), 0
    while compared < count:
        values = drawn(source)
        try:
            findings = part_findings(camgeo.loads(tomlkit.dumps(values)).disc)
        except camgeo.CamgeoError:
            continue
        told = next((each for each in findings if each.name == "smallest-wall"), None)
        if told is None:
            continue
        compared += 1
        right = walls(values)
        least = min(right.values())
        names = [pair for pair, wall in right.items() if wall <= least + OFF]
        found = []
        if told.value is None or abs(told.value - least) > OFF:
            found.append(f"{told.value} told, {least} right")
        elif not any(all(name in told.sentence for name in pair) for pair in names):
            found.append(f"{told.sentence!r}, between {names} right")
        yield f"{values}", found


if __name__ == "__main__":
    sys.exit(run_cases(parser_of(__doc__, 100), lambda asked: misses(asked.count, asked.seed)))
