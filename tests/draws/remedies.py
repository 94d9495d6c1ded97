"""Draws undercut and broken mechanisms, and compares each remedy with 400 values of its size.

    python -m tests.draws.remedies [--count N] [--seed HEX] [--rows FILE]

The model is independent: laws are computed here, roller centre, curvature and transmission angle by
`tests.draws.extremes`, in the fixed frame, on a grid of cam angles of each move. A remedy of a size
is right if the fault is there just short of its limit, if what is written cures and breaks no limit
unsaid, and if none of the values nearer to the present one, of which 400 are tried, keeps the
closed limits; where none is offered, if no value of the whole range does. A value at which
something else leaves no disc, as a pitch curve that crosses itself, cures nothing. What the grid
takes for a better value is decided by the exact check.
"""

from __future__ import annotations

import json
import math
import random
import sys
from argparse import Namespace
from collections.abc import Callable, Iterator
from copy import deepcopy
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import tomlkit
from numpy.typing import NDArray

import camgeo
from tests.draws.extremes import centres, quantities
from tests.draws.run import Case, parser_of, run_cases

Values = dict[str, Any]
Floats = NDArray[np.float64]

GRID: Final = 400
"""Values of a size, and cam angles of a move."""

NEAR: Final = 1e-6
"""Share of the scale within which a limit must be."""

CONFIRMED: Final = 8
"""Values that the grid takes for better of which the exact check is asked."""

LAWS: Final[dict[str, Callable[[Floats], tuple[Floats, Floats, Floats]]]] = {
    "polynomial-345": lambda z: (
        z**3 * (10 - 15 * z + 6 * z * z),
        30 * z * z * (1 - z) ** 2,
        60 * z * (1 - z) * (1 - 2 * z),
    ),
    "polynomial-4567": lambda z: (
        z**4 * (35 - 84 * z + 70 * z * z - 20 * z**3),
        140 * (z * (1 - z)) ** 3,
        420 * (z * (1 - z)) ** 2 * (1 - 2 * z),
    ),
    "cycloidal": lambda z: (
        z - np.sin(2 * np.pi * z) / (2 * np.pi),
        1 - np.cos(2 * np.pi * z),
        2 * np.pi * np.sin(2 * np.pi * z),
    ),
    "simple-sine": lambda z: (
        (1 - np.cos(np.pi * z)) / 2,
        np.pi * np.sin(np.pi * z) / 2,
        np.pi**2 * np.cos(np.pi * z) / 2,
    ),
}
"""z -> f, f', f''."""

KINDS: Final = ("translating-roller", "oscillating-roller", "translating-flat")

NO_DISC: Final = ("no-disc", "invalid")

BAD: Final = ("broken", *NO_DISC)

OF_FAULT: Final = {
    "undercut": ("undercut-", "cusp-", "global-undercut-", "outline-"),
    "radius ratio": ("radius-ratio",),
    "transmission angle": ("transmission-angle",),
    "convexity": ("convexity",),
}


OF_ROLLER: Final = ("undercut", "radius ratio", "transmission angle")


# The model ----------------------------------------------------------------------------------------


def courses(values: Values) -> list[tuple[int, Floats]]:
    """Of each segment its number, and (3, n) lift, s', s'' [mm or rad] over it, ends included."""
    found, position = [], 0.0
    unit = math.radians(1.0) if values["follower"]["kind"].startswith("oscillating") else 1.0
    for number, each in enumerate(values["motion"], start=1):
        if "dwell" in each:
            found.append((number, np.array([[position], [0.0], [0.0]])))
            continue
        span, stroke = math.radians(each["span"]), each["to"] * unit - position
        f, f1, f2 = LAWS[each["law"]](np.linspace(0.0, 1.0, GRID))
        found.append(
            (number, np.stack((position + stroke * f, stroke * f1 / span, stroke * f2 / span**2)))
        )
        position += stroke
    return found


def margins(values: Values, fault: str, segment: int | None = None) -> float:
    """The smallest margin of the condition whose loss is the fault; -1 without a mechanism."""
    follower = values["follower"]
    every = [s for number, s in courses(values) if segment in (None, number)]
    s, s1, s2 = np.concatenate(every, axis=1)
    jet, base = np.stack((s, s1, s2, np.zeros_like(s))), follower["base_radius"]
    if follower["kind"] == "translating-flat":
        return float(np.min(base + s + s2) / base)
    roller, contact = follower["roller_radius"], follower["contact"]
    if contact != "outer" and roller >= base:
        return -1.0
    if follower["kind"] == "translating-roller":
        if abs(follower["offset"]) >= base:
            return -1.0
    else:
        apart, arm = abs(complex(*follower["pivot"])), follower["arm"]
        if not abs(arm - apart) < base < arm + apart:
            return -1.0
    if np.min(np.abs(centres(values, jet)[0])) < 1e-9 * base:
        return -1.0
    found = quantities(values, jet)
    if fault == "transmission angle":
        least = np.min(found["transmission-angle"]) - values["limits"]["transmission_angle"]
        return math.radians(float(least))
    half = roller / (values["limits"]["radius_ratio"] if fault == "radius ratio" else 1.0)
    inner, outer = (float(np.min(1.0 - side * half * found["kappa"])) for side in (1.0, -1.0))
    return {"inner": inner, "outer": outer, "groove": min(inner, outer)}[contact]


# Scenes -------------------------------------------------------------------------------------------


def text_of(values: Values) -> str:
    """As TOML."""
    return tomlkit.dumps({"camgeo": 1, "name": "drawn", **values})


def drawn_motion(draw: random.Random, stroke: float) -> list[Values]:
    """Rests, and two or four moves between 0 and `stroke`."""
    found: list[Values] = []
    count, most = draw.choice([1, 1, 2]), draw.choice([35, 100])  # some are steep
    spans = [round(draw.uniform(20, max(most / count, 30)), 2) for _ in range(2 * count)]
    left = 360 - sum(spans)
    shares = [draw.random() + 0.05 for _ in spans]
    rests = [round(left * share / sum(shares), 2) for share in shares]
    rests[-1] = round(left - sum(rests[:-1]), 2)
    for number, (span, rest) in enumerate(zip(spans, rests, strict=True)):
        to = 0.0 if number % 2 else round(stroke * draw.uniform(0.5, 1.0), 3)
        found += [{"dwell": rest}, {"law": draw.choice([*LAWS]), "span": span, "to": to}]
    return found


def drawn_scene(draw: random.Random) -> Values | None:
    """A scene with a fault, by the model; None if this one has none."""
    kind = draw.choice(
        ["translating-roller"] * 4 + ["oscillating-roller"] * 4 + ["translating-flat"]
    )
    base = round(draw.uniform(15, 60), 3)
    follower: Values = {"kind": kind, "base_radius": base}
    values: Values = {
        "cam": {"rotation": draw.choice(["ccw", "cw"])},
        "follower": follower,
        "limits": {
            "transmission_angle": round(draw.uniform(1, 50), 2),
            "radius_ratio": draw.choice([1.0, 0.7, round(draw.uniform(0.4, 1.0), 2)]),
        },
        "motion": drawn_motion(draw, 25.0 if kind.endswith("flat") else draw.uniform(5, 40)),
    }
    if kind == "translating-flat":
        values["limits"].pop("radius_ratio")
        return values if margins(values, "convexity") < -1e-3 else None
    contact = draw.choice(["inner", "inner", "inner", "outer", "groove"])
    follower |= {"roller_radius": round(0.2 * base, 4), "contact": contact}
    if contact != "inner":
        values["part"] = {"rim": 4000.0}
    if kind == "translating-roller":
        follower["offset"] = round(draw.uniform(-0.6, 0.6) * base, 3)
    else:
        apart, angle = draw.uniform(1.2, 2.5) * base, draw.uniform(-math.pi, math.pi)
        follower["pivot"] = [round(apart * math.cos(angle), 3), round(apart * math.sin(angle), 3)]
        follower["arm"] = round(apart * draw.uniform(0.7, 1.3), 3)
        follower["arm_side"] = draw.choice(["ccw", "cw"])
        values["motion"] = drawn_motion(draw, draw.uniform(10, 35))
        if margins(values, "undercut") == -1.0:
            return None
    if draw.random() < 0.7:  # a roller somewhat larger than the smallest radius of curvature
        tight = 1.0 - margins(values, "undercut")
        if tight <= 0.0:
            return None
        roller = follower["roller_radius"] / tight * draw.uniform(0.8, 1.8)
        if not 1e-3 * base < roller < 0.9 * base:
            return None
        follower["roller_radius"] = float(f"{roller:.6g}")
    worst = min(
        margins(values, fault) for fault in ("undercut", "radius ratio", "transmission angle")
    )
    return values if -1.0 < worst < -1e-3 else None


Names = dict[str, str]
"""Severities by the names of findings."""


def broken(values: Values) -> Names | None:
    """The limits that the exact check finds broken; None if the scene is refused."""
    try:
        found = camgeo.loads(text_of(values)).findings
    except camgeo.CamgeoError:
        return None
    return {each.name: each.severity for each in found if each.severity in BAD}


def has(fault: str, names: Names | None) -> bool:
    return names is None or any(name.startswith(OF_FAULT[fault]) for name in names)


# The comparison -----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Knob:
    """A size: its key in [follower], its range, and what a change is compared with [mm]."""

    field: str
    low: float
    high: float
    scale: float

    def set(self, values: Values, value: float) -> Values:
        other = deepcopy(values)
        other["follower"][self.field] = value
        return other


def knob_of(values: Values, name: str) -> Knob:
    follower = values["follower"]
    base = follower["base_radius"]
    if name == "roller radius":
        return Knob(
            "roller_radius", 1e-6 * base, follower["roller_radius"], follower["roller_radius"]
        )
    if name == "offset":
        return Knob("offset", -base * (1 - 1e-5), base * (1 - 1e-5), base)
    if name == "arm":
        apart = abs(complex(*follower["pivot"]))
        return Knob(
            "arm", abs(apart - base) + 1e-5 * base, apart + base - 1e-5 * base, follower["arm"]
        )
    low, high = 1e-3 * base, 90.0 * base
    if "offset" in follower:
        low = abs(follower["offset"]) * (1 + 1e-5) + 1e-3 * base
    if "arm" in follower:
        apart, arm = abs(complex(*follower["pivot"])), follower["arm"]
        low, high = abs(apart - arm) + 1e-5 * base, apart + arm - 1e-5 * base
    return Knob("base_radius", low, high, base)


def between(knob: Knob, start: float, limit: float | None) -> Floats:
    """Values as far from the present one as the limit at most, or of all of the range, the nearest
    first.
    """
    reach = math.inf if limit is None else abs(limit - start) - NEAR * knob.scale
    low, high = max(knob.low, start - reach), min(knob.high, start + reach)
    found = [np.linspace(low, high, GRID)] if high > low else []
    if limit is None and high > 10.0 * knob.scale:  # far out little changes
        found = [np.geomspace(max(low, 1e-3 * knob.scale), high, GRID)]
    every = np.concatenate(found) if found else np.empty(0)
    return every[np.argsort(np.abs(every - start))]


def complaints(values: Values) -> Iterator[str]:
    """What is wrong with the remedies of a scene."""
    before = broken(values)
    if before is None or any(name in before for name in ("roller-over-axis", "standstill")):
        return
    cures = camgeo.loads(text_of(values)).judgement.cures
    faults = [fault for fault in OF_FAULT if has(fault, before)]
    if "undercut" in faults and values["limits"].get("radius_ratio") == 1.0:
        faults = [each for each in faults if each != "radius ratio"]
    for fault in faults:
        own = [each for each in cures if each.fault == fault]
        if not own:
            yield f"{fault}: no remedies"
        for cure in own:
            head = f"{fault}, {cure.knob}"
            if cure.works:
                yield from (f"{head}: {each}" for each in applied(values, cure, fault, before))
            if cure.knob == "longer segment":
                yield from (f"{head}: {each}" for each in stretched(values, cure, fault, before))
            if cure.knob in ("longer segment", "other law"):
                continue
            knob = knob_of(values, cure.knob)
            yield from (f"{head}: {each}" for each in compared(values, cure, fault, before, knob))


def applied(values: Values, cure: Any, fault: str, before: Names) -> Iterator[str]:
    """What is wrong with the scene that has what the remedy writes."""
    other = deepcopy(values)
    for key, value in [(cure.key, cure.new_value)] + [
        (each.key, each.new_value) for each in cure.also
    ]:
        if key.startswith("follower."):
            other["follower"][key.removeprefix("follower.")] = value
        else:
            number = int(key.partition("[")[2].partition("]")[0]) - 1
            word = value if isinstance(value, str) else float(value)
            other["motion"][number][key.rpartition(".")[2]] = word
    names = broken(other)
    if names is None or has(fault, names):
        yield f"{cure.sentence} does not cure: {names}"
    elif (new := names.keys() - before.keys()) != set(cure.breaks):
        yield f"{cure.sentence} breaks {new}, said {cure.breaks}"


def compared(values: Values, cure: Any, fault: str, before: Names, knob: Knob) -> Iterator[str]:
    """What is wrong with the limit of a size, or with the statement that there is none."""
    start = values["follower"][knob.field]
    flat = values["follower"]["kind"].endswith("flat")
    conditions = ("convexity",) if flat else OF_ROLLER
    held = [each for each in conditions if each == fault or not has(each, before)]

    def kept(value: float, names: list[str]) -> bool:
        other = knob.set(values, value)
        return all(margins(other, name) > 1e-9 for name in names)

    def good(value: float, *, breaks: bool) -> bool:
        names = broken(knob.set(values, value))
        if names is None or has(fault, names):
            return False
        new = names.keys() - before.keys()
        return not new or (breaks and all(names[each] not in NO_DISC for each in new))

    limit, breaks = cure.limit if cure.works else None, bool(cure.breaks)
    if limit is not None:
        step = math.copysign(NEAR * knob.scale, limit - start)
        if abs(limit - start) > 2 * abs(step) and good(limit - step, breaks=breaks):
            yield f"{limit - step!r} cures, nearer than {limit!r}"
        if not good(limit + step, breaks=breaks):
            yield f"just beyond {limit!r} it is not cured"
    lenient = not cure.works or breaks
    searched = [(limit, [fault], True)] if lenient else [(limit, held, False)]
    if breaks:  # no value at all may keep everything
        searched.append((None, held, False))
    for up_to, names, allowed in searched:
        better = [float(each) for each in between(knob, start, up_to) if kept(float(each), names)]
        for value in better[:: max(1, len(better) // CONFIRMED)]:
            if good(value, breaks=allowed):
                yield f"{value!r} cures, {cure.sentence}"
                break


def longer(values: Values, number: int, span: float) -> Values | None:
    """With another span of a move, taken from the rests beside it; None if they are too short."""
    other = deepcopy(values)
    motion = other["motion"]
    missing = span - motion[number - 1]["span"]
    motion[number - 1]["span"] = span
    for beside in (number % len(motion), number - 2):
        taken = min(missing, motion[beside]["dwell"])
        motion[beside]["dwell"] -= taken
        missing -= taken
    total = sum(each.get("dwell", each.get("span")) for each in motion)
    motion[number % len(motion)]["dwell"] += 360.0 - total  # rounding
    return other if missing <= 1e-9 else None


def stretched(values: Values, cure: Any, fault: str, before: Names) -> Iterator[str]:
    """What is wrong with the longer span of a move that alone is at fault."""
    moves = [number for number, each in enumerate(values["motion"], start=1) if "law" in each]
    faulty = [number for number, _ in courses(values) if margins(values, fault, number) <= 0.0]
    if len(faulty) != 1 or faulty[0] not in moves or cure.breaks:
        return
    (number,) = faulty
    start = values["motion"][number - 1]["span"]
    room = start + values["motion"][number - 2]["dwell"]
    room += values["motion"][number % len(values["motion"])]["dwell"]
    most = float(cure.new_value) - 2e-6 if cure.works else room - 1e-6
    conditions = [fault] if values["follower"]["kind"].endswith("flat") else [*OF_ROLLER]
    held = [each for each in conditions if each == fault or not has(each, before)]
    confirmed = 0
    for span in np.linspace(start, most, GRID).tolist():
        other = longer(values, number, span)
        if other is None or not all(margins(other, each, number) > 1e-9 for each in held):
            continue
        names, confirmed = broken(other), confirmed + 1
        if names is not None and not has(fault, names) and names.keys() <= before.keys():
            yield f"a span of {span!r} cures, {cure.sentence}"
        if confirmed == CONFIRMED:
            return


def cases(seed: int) -> Iterator[Values]:
    """Scenes with a fault, without end."""
    draw = random.Random(seed)
    while True:
        values = drawn_scene(draw)
        if values is not None:
            yield values


def compared_cases(asked: Namespace) -> Iterator[Case]:
    """As many as are asked for, each with what is wrong with its remedies."""
    for number, values in zip(range(asked.count), cases(asked.seed), strict=False):
        yield f"{number} {json.dumps(text_of(values))}", [*complaints(values)]


if __name__ == "__main__":
    sys.exit(run_cases(parser_of(__doc__, 60), compared_cases))
