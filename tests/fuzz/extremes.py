"""Scenes of small size and extreme numbers: moves in millionths of a degree, tiny rollers and
strokes, long radii; where most faults were that other random scenes found after hours."""

from __future__ import annotations

from random import Random
from typing import Any, Final

from camgeo.kinematics.laws import FAMILIES
from camgeo.kinematics.mechanism.declared.registry import FOLLOWERS
from tests.fuzz.case import (
    PYTHON,
    SCENE,
    SCENE_STEPS,
    Case,
    Path,
    Step,
    changed,
    paths,
    toml,
    value_at,
)
from tests.fuzz.drawn import WHOLE, table
from tests.fuzz.scenes import FIXTURES, FOLLOWER_TABLES, accepted, fixtures, segments, values_of

USUAL_LAWS: Final = ("polynomial-345", "modified-sine", "auto")

FORMATS: Final = ("dxf", "dxf", "dxf", "csv", "svg", "cut-svg")

COMMANDS: Final = (
    ("size", SCENE),
    ("table", SCENE, "--step", "7"),
    ("replay", SCENE, "--step", "1"),
    ("explain", SCENE, "undercut"),
)


def extreme_case(rng: Random) -> Case:
    """A scene without effects or milling, and the commands that compute its curves."""
    values = _values(rng)
    for _ in range(10):
        if accepted(values, FIXTURES):
            break
        values = _values(rng)
    steps: list[Step] = [(PYTHON, SCENE), ("check", SCENE)]
    if rng.random() < 0.6:
        steps += [("build", SCENE, "-o", "out"), ("verify", "out")]
    elif rng.random() < 0.3:
        steps.append(rng.choice(COMMANDS))
    return Case({SCENE: toml(values).encode()}, tuple(steps), "extremes", both=False)


def _values(rng: Random) -> dict[str, Any]:
    radius = _size(rng, 0.0, 3.0)
    kind = rng.choice(tuple(FOLLOWERS))
    follower = {"kind": kind, **FOLLOWER_TABLES[kind](rng, radius)}
    if "roller_radius" in follower:
        if rng.random() < 0.4:
            follower["roller_radius"] = follower["base_radius"] * _size(rng, -8.0, 0.0)
        if rng.random() < 0.5:
            follower["contact"] = rng.choice(("groove", "outer"))
        if rng.random() < 0.3:
            follower["direction"] = rng.choice(("inward", "outward"))
    usual = rng.uniform(2.0, 35.0) if kind.startswith("oscillating") else 0.5 * radius
    values: dict[str, Any] = {
        "camgeo": 1,
        "name": "extreme",
        "cam": {"rotation": rng.choice(("cw", "ccw"))},
        "follower": follower,
        "motion": _motion(rng, rng.choice((usual, _size(rng, -8.0, 1.0)))),
    }
    if rng.random() < 0.7:
        values["limits"] = {"undercut": "trim"}
    if "contact" in follower:
        values["part"] = {"rim": 10.0 * radius}
    name = rng.choice(FORMATS)
    output = {"formats": [name], "tolerance": _size(rng, -6.0, -0.5)}
    if name == "dxf" and rng.random() < 0.3:
        output["dxf"] = table(rng, WHOLE["properties"]["output"]["properties"]["dxf"])
    elif name == "dxf":
        output["dxf"] = {"entity": rng.choice(("arcs", "polyline", "spline"))}
    return {**values, "output": output}


def _motion(rng: Random, stroke: float) -> list[dict[str, Any]]:
    """2 to 5 segments, of which two in five take a millionth of a degree to one degree."""
    count = rng.choice((2, 3, 3, 4, 5))
    short = [rng.random() < 0.4 for _ in range(count)]
    short[rng.randrange(count)] = False
    spans = [_size(rng, -6.5, 0.0) if each else 0.0 for each in short]
    shares = [0.0 if each else rng.uniform(0.1, 1.1) for each in short]
    left = 360.0 - sum(spans)
    spans = [
        span or round(left * share / sum(shares), 9)
        for span, share in zip(spans, shares, strict=True)
    ]
    longest = spans.index(max(spans))
    spans[longest] = round(spans[longest] + 360.0 - sum(spans), 12)

    def law(span: float) -> dict[str, Any]:
        name = rng.choice(USUAL_LAWS if rng.random() < 0.5 else tuple(FAMILIES))
        if rng.random() < 0.15:
            return {"law": name, "velocity": rng.choice((0.3, stroke, 1e-6, 100.0 * stroke))}
        return {"law": name}

    return segments(rng, spans, stroke, law)


def _size(rng: Random, low: float, high: float) -> float:
    """A number of a magnitude between the powers `low` and `high` of ten."""
    return float(f"{10.0 ** rng.uniform(low, high):.4g}")


# -- numbers ---------------------------------------------------------------------------------------
# Scenes of the fixtures with one number far from where its designer had it.


FACTORS: Final = (1e-6, 1e-3, 0.05, 20.0, 1e3, 1e6)

HUGE: Final = 1e9


def number_case(rng: Random) -> Case:
    """A scene that is accepted with one of its numbers changed; it is checked, built, verified."""
    for _ in range(20):
        path = rng.choice(fixtures())
        values = values_of(path)
        place = rng.choice([each for each in paths(values) if is_number(values, each)])
        size = value_at(values, place)
        other = rng.choice((*(size * factor for factor in FACTORS), HUGE))
        values = changed(values, place, float(f"{other:.6g}"))
        if accepted(values, path.parent):
            break
    text = toml(values)
    files = {each.name: each.read_bytes() for each in path.parent.glob("*.csv")}
    files = {name: data for name, data in files.items() if name in text}
    source = f"{path.stem}, {'.'.join(map(str, place))}"
    return Case({**files, SCENE: text.encode()}, SCENE_STEPS, source, both=False)


def is_number(values: dict[str, Any], place: Path) -> bool:
    """Whether a size is there, and not the version of the format."""
    return type(value_at(values, place)) in (int, float) and place != ("camgeo",)
