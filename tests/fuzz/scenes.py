"""Scenes: of the fixtures and templates, with effects, or made up, then changed here and there; and
scenes of extreme numbers.
"""

from __future__ import annotations

import copy
import math
import tomllib
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from random import Random
from typing import Any, Final

from camgeo.app.answers.explain import GOALS
from camgeo.errors import SceneError
from camgeo.kinematics.laws import FAMILIES
from camgeo.kinematics.mechanism.declared.registry import FOLLOWERS
from camgeo.pictures import plots
from camgeo.scene.formats.format import FORMATS
from camgeo.scene.formats.threemf import PlateBody
from camgeo.scene.scene import parse_scene
from camgeo.scene.toml import TEMPLATE_KINDS, template
from tests.effects.test_random_scenes import scene_of
from tests.end_to_end.random_mechanisms import drawn
from tests.fuzz.case import PYTHON, SCENE, SCENE_STEPS, Case, Step, changed, paths, toml, value_at
from tests.fuzz.case import Path as TreePath
from tests.fuzz.drawn import WHOLE, edit, table

FIXTURES: Final = Path(__file__).parents[2] / "fixtures"

FOLDERS: Final = ("scenes", "effects", "milling", "pairs", "refused", "found", "tolerance")


@cache
def fixtures() -> tuple[Path, ...]:
    """All scenes of the fixtures."""
    return tuple(path for name in FOLDERS for path in sorted((FIXTURES / name).glob("*.toml")))


def values_of(path: Path) -> dict[str, Any]:
    """What a scene states; its file may begin with a byte order mark."""
    return tomllib.loads(path.read_text("utf-8-sig"))


def scene_case(rng: Random) -> Case:
    """A scene, and some of the commands that take one."""
    values, files, source = scene(rng)
    steps: list[Step] = [(PYTHON, SCENE), ("check", SCENE)]
    if rng.random() < 0.6:
        steps.append(("build", SCENE, "-o", "out"))
        if rng.random() < 0.5:
            steps.append(("verify", "out"))
    if "sweep" in values:
        steps.append(("sweep", SCENE, "-o", "runs.sqlite"))
        search = ("--least", "diameter", "--evaluations", "4")
        steps.append(("optimise", SCENE, *search, "-o", "best.toml"))
    if "tolerance" in values:
        count = rng.choice(("2", "64", "1024"))
        steps.append(("tolerance", SCENE, "--count", count, "-o", "errors.csv"))
    if rng.random() < 0.5:
        steps.append(rng.choice(_others(rng)))
    elif rng.random() < 0.05:  # it takes seconds
        steps.append(("accuracy", SCENE, "--tolerances", rng.choice(("1e-1", "1e-2,1e-3"))))
    return Case({**files, SCENE: toml(values).encode()}, tuple(steps), source)


def _others(rng: Random) -> list[Step]:
    return [
        ("size", SCENE),
        ("size", SCENE, "--scene", "sized.toml"),
        ("plot", SCENE, rng.choice(plots.names()), "-o", "picture.svg"),
        ("table", SCENE, "--step", rng.choice(("1", "0.5", "7", "90"))),
        ("explain", SCENE, rng.choice(tuple(GOALS))),
        ("replay", SCENE, "--step", "1"),
        ("setup", SCENE, "-o", "setup.html"),
        ("report", SCENE, "--quick", "-o", "report.html"),
    ]


def scene(rng: Random) -> tuple[dict[str, Any], dict[str, bytes], str]:
    """The values of a scene, the files that it names, and how it was made.

    In four of five scenes a change that the door refuses is mostly drawn again.
    """
    values, folder, source = start(rng)
    wild = rng.random() < 0.2
    if rng.random() < 0.4 and isinstance(values.get("limits", {}), dict):
        values["limits"] = {**values.get("limits", {}), "undercut": "trim"}
    if rng.random() < 0.8:
        values["output"] = output(rng, values)
    for _ in range(rng.choice((0, 1, 1, 2, 3))):
        for _ in range(4):
            changed = copy.deepcopy(values)
            edit(rng, changed, wild=False)
            if accepted(changed, folder) or rng.random() < 0.05:
                values = changed
                break
    for _ in range(rng.choice((1, 1, 2)) * wild):
        edit(rng, values, wild=True)
    files = {path.name: path.read_bytes() for path in folder.glob("*.csv")}
    text = toml(values)
    return values, {name: data for name, data in files.items() if name in text}, source


def accepted(values: dict[str, Any], folder: Path) -> bool:
    """Whether the door lets a scene pass; a crash there is worth a case."""
    try:
        parse_scene(toml(values), str(folder / SCENE))
    except SceneError:
        return False
    except Exception:
        return True
    return True


def start(rng: Random) -> tuple[dict[str, Any], Path, str]:
    """A scene that is mostly accepted, the folder of its files, and where it is from."""
    for _ in range(10):
        values, folder, source = _drawn(rng)
        if accepted(values, folder) or rng.random() < 0.05:
            break
    return values, folder, source


def _drawn(rng: Random) -> tuple[dict[str, Any], Path, str]:
    chance = rng.random()
    if chance < 0.25:
        path = rng.choice(fixtures())
        return values_of(path), path.parent, path.stem
    if chance < 0.5:
        name, text = scene_of(rng)
        return tomllib.loads(text), Path(name).parent, "effects"
    if chance < 0.56:
        kind = rng.choice(TEMPLATE_KINDS)
        return tomllib.loads(template(kind)), FIXTURES, kind
    if chance < 0.78:
        number = rng.randrange(10**6)
        return drawn(number), FIXTURES, f"random mechanism {number}"
    return made_up(rng), FIXTURES, "made up"


def output(rng: Random, values: dict[str, Any]) -> dict[str, Any]:
    """Formats that the scene can be written in, mostly the fast ones, and a tolerance."""
    slow = rng.random() < 0.15
    possible = [name for name in FORMATS if slow or name in ("dxf", "csv", "gcode", "svg", "asc")]
    if "thickness" not in values.get("part", {}):
        possible = [name for name in possible if name not in ("gcode", "stl", "3mf")]
    if values.get("linkage", {}).get("kind") != "slider-crank":
        possible.remove("asc")
    formats = rng.sample(possible, rng.randint(1, 2))
    found: dict[str, Any] = {
        "formats": formats,
        "tolerance": float(f"{10.0 ** rng.uniform(-5.0, -1.0):.2g}"),
    }
    if "gcode" in formats and ("tool" not in values or rng.random() < 0.3):
        diameter = float(f"{rng.uniform(0.5, 12.0):.2g}")
        values["tool"] = [
            {
                "number": 1,
                "diameter": diameter,
                "spindle_speed": 3000,
                "feed": 300,
                "plunge_feed": 100,
                "stepdown": float(f"{10.0 ** rng.uniform(-0.5, 1.5):.2g}"),
                "stepover": float(f"{diameter * rng.uniform(0.05, 0.6):.2g}"),
            }
        ]
        values["holding"] = {"kind": "fixture", "through": rng.choice([0, 0.5])}
    elif "3mf" in formats and rng.random() < 0.5:
        bodies = rng.sample([each.value for each in PlateBody], rng.randint(1, len(PlateBody)))
        found["3mf"] = {"plate": bodies, **({"roller_bore": 2} if rng.random() < 0.3 else {})}
    elif rng.random() < 0.3:
        table_of = WHOLE["properties"]["output"]["properties"][formats[0]]
        found[formats[0]] = table(rng, table_of)
    return found


# Made up ------------------------------------------------------------------------------------------


def made_up(rng: Random) -> dict[str, Any]:
    """A scene of its own: any follower with usual sizes, and any motion."""
    radius = float(f"{10.0 ** rng.uniform(0.7, 2.3):.4g}")
    kind = rng.choice(tuple(FOLLOWERS))
    rocks = kind.startswith("oscillating")
    follower = FOLLOWER_TABLES[kind](rng, radius)
    if rng.random() < 0.3:
        properties = FOLLOWERS[kind].schema["properties"]
        key = rng.choice([key for key in properties if key not in follower])
        follower |= table(rng, {"properties": {key: properties[key]}, "required": [key]})
    stroke = rng.choice((0.2, 1.0)) * (rng.uniform(2.0, 35.0) if rocks else 0.5 * radius)
    values: dict[str, Any] = {
        "camgeo": 1,
        "name": rng.choice(("cam", "A-1_b", "x" * 100)),
        "cam": {"rotation": rng.choice(("cw", "ccw"))},
        "follower": {"kind": kind, **follower},
        "motion": motion(rng, stroke),
    }
    if rng.random() < 0.6:
        values["cam"]["speed"] = rng.choice((1, 60.0, 300.0, 1e4))
    if rng.random() < 0.5:
        values["part"] = {"thickness": 10, "bore": round(0.4 * radius, 3), **features(rng, radius)}
        if rng.random() < 0.2:
            names = rng.sample(sorted(PRINTING), rng.randint(0, 3))
            values["print"] = filled(rng, radius, {name: PRINTING[name] for name in names})
    if kind.endswith("roller") and rng.random() < 0.2:
        paired(rng, values, radius)
    if rng.random() < 0.15:
        values["sweep"] = family(rng, radius)
    if rng.random() < 0.15:
        values["tolerance"] = tolerances(rng, radius, values)
    return values


def paired(rng: Random, values: dict[str, Any], radius: float) -> None:
    """Make a conjugate pair of a roller's cam, at times in one piece."""
    rocks = values["follower"]["kind"].startswith("oscillating")
    key, place = ("arm_angle", 90.0) if rocks else ("spacing", 2.3 * radius)
    values["follower"]["return"] = {key: float(f"{place * rng.uniform(0.8, 1.2):.4g}")}
    if "part" in values and rng.random() < 0.7:
        spacer = float(f"{radius * rng.uniform(0.45, 1.5):.4g}")
        pair: dict[str, Any] = {"gap": rng.choice((0.5, 8)), "spacer": spacer}
        if rng.random() < 0.3:
            pair |= {"upper": rng.choice(("main", "return")), "roller_width": rng.choice((9, 40))}
        values["part"]["pair"] = pair


EDGES: Final = ["upper", "lower", "both"]

HOLES: Final = {
    "count": [1, 2, 3, 5, 7],
    "circle": (0.5, 1.9),
    "hole": (0.02, 0.2),
    "angle": [0, 17.5, -360],
}

DEEPER: Final = {"diameter": (0.05, 0.4), "depth": [0.5, 4, 9.99, 11]}

FEATURES: Final[dict[str, Any]] = {
    "keyway": [{"standard": "DIN 6885-1"}, {"width": (0.05, 0.3), "depth": (0.02, 0.2)}],
    "d_shaft": {"across": (0.21, 0.39)},
    "hub": {"diameter": (0.45, 1.5), "height": (0.01, 0.5), "side": EDGES},
    "mark": {"radius": (0.3, 0.9), "width": (0.01, 0.1), "depth": 1},
    "bolt_circle": {**HOLES, "counterbore": [None, DEEPER]},
    "lightening_holes": HOLES,
    "material": ["steel", "pom"],
    "density": [1, 7850, 1e6],
    "engraving": {},
}
"""What a part has beside its bore, see `filled`: often where there is room, at times where not."""

TEXT: Final = {
    "height": (0.02, 0.2),
    "depth": [0.1, 1],
    "radius": (0.3, 0.9),
    "angle": [0, 90, -123.4],
    "text": [None, "0", "Nr. 7", "Ø8 für Nocke", "façade", "ab\u51f8", "%_@"],
}

WAYS: Final = [{}, {"tops": "inward"}, {"along": "straight"}, {"along": "straight", "turn": 30}]
"""In which a text may run."""

OFTEN: Final = [0.05, 0.2, 0.2, 1.0, 30.0]

PRINTING: Final[dict[str, Any]] = {
    "bore_clearance": OFTEN,
    "key_clearance": OFTEN,
    "elephant_foot": {"inset": OFTEN, "height": [0.2, 0.6, 9.9], "steps": [1, 2, 3, 4]},
    "nozzle": OFTEN,
    "shrinkage": {"xy": [0, 0.7, -10, 20], "z": [0.3, 20]},
}
"""Compensations of usual size, at times of one that no part has room for."""


def filled(rng: Random, radius: float, node: Any) -> Any:
    """What `node` describes: of a list one of its values, for a pair of numbers a size between
    these shares of the cam's radius, and a table without the keys whose value is None.
    """
    match node:
        case dict():
            found = {key: filled(rng, radius, each) for key, each in node.items()}
            return {key: each for key, each in found.items() if each is not None}
        case list():
            return filled(rng, radius, rng.choice(node))
        case (float(), float()):
            return float(f"{radius * rng.uniform(*node):.4g}")
    return node


def features(rng: Random, radius: float) -> dict[str, Any]:
    """Some of the features of a part, and chamfers of some of its edges."""
    chosen = rng.sample(sorted(FEATURES), rng.choice((0, 0, 1, 2)))
    found: dict[str, Any] = filled(rng, radius, {name: FEATURES[name] for name in chosen})
    if "engraving" in found:
        texts = range(rng.choice((1, 1, 2)))
        found["engraving"] = [filled(rng, radius, TEXT) | rng.choice(WAYS) for _ in texts]
    if rng.random() < 0.3:
        edged = sorted({"outline", "bore", "hub", "bolt_circle"} & {"outline", "bore", *found})
        chamfer = {"width": (0.001, 0.08), "edges": EDGES}
        names = rng.sample(edged, rng.randint(1, len(edged)))
        found["chamfers"] = filled(rng, radius, dict.fromkeys(names, chamfer))
    return found


def _guided(rng: Random, radius: float) -> dict[str, Any]:
    found = {"base_radius": radius, "guide_angle": rng.choice((0.0, 90.0, -37.5, 360.0))}
    found["roller_radius"] = radius * rng.choice((0.0, 0.1, 0.3, 0.8, 1.0, 1.0 - 1e-9))
    if rng.random() < 0.4:
        found["offset"] = radius * rng.choice((0.1, -0.5, 0.999999, 1.0))
    return found


def _rocker(rng: Random, radius: float) -> dict[str, Any]:
    start = rng.choice((rng.uniform(0.2, 2.9), 10.0 ** rng.uniform(-9.0, -1.0)))
    distance = radius * rng.uniform(1.1, 3.0)
    arm = distance * rng.uniform(0.3, 1.2)
    base = math.sqrt(abs(distance**2 + arm**2 - 2.0 * distance * arm * math.cos(start)))
    return {
        "pivot": [round(distance, 9), 0.0],
        "arm": arm,
        "arm_side": rng.choice(("cw", "ccw")),
        "base_radius": max(base, 1e-9),
        "roller_radius": base * rng.choice((0.0, 0.1, 0.3, 0.8)),
    }


def _flat(rng: Random, radius: float) -> dict[str, Any]:
    return {"base_radius": radius, "guide_angle": rng.choice((90.0, 0.0, 12.5))}


def _flat_rocker(rng: Random, radius: float) -> dict[str, Any]:
    pivot = [radius * rng.uniform(1.2, 4.0), radius * rng.uniform(-1.0, 1.0)]
    return {
        "pivot": pivot,
        "base_radius": radius,
        "face_offset": radius * rng.choice((0.0, 0.1, -0.1)),
    }


FOLLOWER_TABLES: Final = {
    "translating-roller": _guided,
    "oscillating-roller": _rocker,
    "translating-flat": _flat,
    "oscillating-flat": _flat_rocker,
}
"""Tables of followers with usual numbers, for a cam of a radius."""


def motion(rng: Random, stroke: float) -> list[dict[str, Any]]:
    """Segments that add up to 360 degrees, up to 50 of them."""
    count = rng.choice((1, 2, 2, 3, 3, 4, 4, 5, 8, 20, 50))
    weights = [rng.choice((1e-3, 1.0, 1.0, 1.0, 2.0, 3.0)) for _ in range(count)]
    spans = [max(round(360.0 * each / sum(weights), 3), 1e-3) for each in weights]
    spans[0] = round(360.0 - sum(spans[1:]), 9)
    named = ("polynomial-345", "auto", "modified-sine", "auto", rng.choice(tuple(FAMILIES)))

    def law(span: float) -> dict[str, Any]:
        name = rng.choice(named)
        if rng.random() < 0.1 and span > 1.0:
            points = [{"at": round(span * z, 6), "to": stroke * rng.random()} for z in (0.3, 0.6)]
            return {"law": "points", "points": points}
        if rng.random() < 0.1:
            key = rng.choice(("velocity", "acceleration", "inflection"))
            return {"law": name, key: rng.choice((0.0, 0.3, stroke))}
        return {"law": name}

    return segments(rng, spans, stroke, law)


def segments(
    rng: Random, spans: Sequence[float], stroke: float, law: Callable[[float], dict[str, Any]]
) -> list[dict[str, Any]]:
    """Dwells, and moves to random places by what `law` states for a span, back at the end."""
    found: list[dict[str, Any]] = []
    position = 0.0
    for place, span in enumerate(spans):
        last = place == len(spans) - 1
        if rng.random() < 0.35 and not (last and position != 0.0):
            found.append({"dwell": span})
            continue
        position = 0.0 if last else float(f"{rng.uniform(0.0, stroke):.4g}")
        found.append({"span": span, "to": position, **law(span)})
    return found


assert set(FOLLOWER_TABLES) == set(FOLLOWERS), "a new follower needs usual numbers here"


# -- many ------------------------------------------------------------------------------------------
# What a scene states of many designs, or of many machines for one.


def family(rng: Random, radius: float) -> dict[str, Any]:
    """A few designs, and what is asked of them."""
    variables: list[dict[str, Any]] = [
        {"key": "follower.base_radius", "from": radius, "to": 1.2 * radius, "count": 2},
        {"key": "motion[1].law", "values": rng.sample(sorted(FAMILIES), 2)},
        {"keys": ["cam.speed", "limits.diameter"], "values": [[10, 20 * radius], [1e5, 1]]},
        {"key": "cam.rotation", "values": ["cw", "ccw"]},
    ]
    asked = ("transmission-angle", "peak:s'", "min:kappa", "verdict", "diameter", "closure")
    found: dict[str, Any] = {
        "vary": rng.sample(variables, rng.randint(1, 2)),
        "ask": rng.sample(asked, rng.randint(1, 3)),
    }
    if rng.random() < 0.3:
        found |= {"samples": rng.randint(1, 4), "method": rng.choice(("sobol", "random"))}
    return found


DISTRIBUTIONS: Final = ("normal", "uniform", "triangular")


def tolerances(rng: Random, radius: float, values: dict[str, Any]) -> dict[str, Any]:
    """Tolerances of usual size, at times of any, of dimensions that the machine may have."""

    def size() -> float:
        return float(f"{radius * 10.0 ** rng.choice((-4.0, -4.0, -3.0, rng.uniform(-12, 0))):.3g}")

    def dimension(key: str) -> dict[str, Any]:
        found: dict[str, Any] = {"key": key}
        match rng.choice(("plus_minus", "plus_minus", "limits", "class")):
            case "plus_minus":
                found["plus_minus"] = size()
            case "limits":
                found["limits"] = sorted((size(), rng.choice((-1.0, 1.0)) * size()))
            case _:
                found["class"] = rng.choice(("h6", "H7", "js9", "g6"))
        if rng.random() < 0.3:
            found["distribution"] = rng.choice(DISTRIBUTIONS)
        return found

    others = ("mounting.x", "mounting.angle", "shaft.y", "follower.pivot[2]", "linkage.crank")
    numbers = [key for key, value in values["follower"].items() if isinstance(value, float | int)]
    known = [*(f"follower.{key}" for key in numbers), *others]
    found: dict[str, Any] = {
        "dimension": [dimension(key) for key in rng.sample(known, rng.randint(1, 3))]
    }
    if rng.random() < 0.5:
        found["limit"] = size()
    if rng.random() < 0.2:
        found["set_at"] = rng.choice((0, 123.4, 360))
    if rng.random() < 0.3:
        found["form"] = [{"plus_minus": size(), "waves": rng.choice((1, 12, 1000))}]
    if rng.random() < 0.3:
        fit = {"size": 20, "hole": "H7", "shaft": rng.choice(("g6", "h6", "p6"))}
        found["clearance"] = [{"at": rng.choice(("cam", "roller")), **fit}]
        if rng.random() < 0.5:
            found["clearance"][0]["shifted"] = "by-load"
    return found


# Scenes of small size and extreme numbers: moves in millionths of a degree, tiny rollers and
# strokes, long radii; where most faults were that other random scenes found after hours


USUAL_LAWS: Final = ("polynomial-345", "modified-sine", "auto")

FAST_FORMATS: Final = ("dxf", "dxf", "dxf", "csv", "svg", "cut-svg")

CURVE_COMMANDS: Final = (
    ("size", SCENE),
    ("table", SCENE, "--step", "7"),
    ("replay", SCENE, "--step", "1"),
    ("explain", SCENE, "undercut"),
)


def extreme_case(rng: Random) -> Case:
    """A scene without effects or milling, and the commands that compute its curves."""
    values = _extreme_values(rng)
    for _ in range(10):
        if accepted(values, FIXTURES):
            break
        values = _extreme_values(rng)
    steps: list[Step] = [(PYTHON, SCENE), ("check", SCENE)]
    if rng.random() < 0.6:
        steps += [("build", SCENE, "-o", "out"), ("verify", "out")]
    elif rng.random() < 0.3:
        steps.append(rng.choice(CURVE_COMMANDS))
    return Case({SCENE: toml(values).encode()}, tuple(steps), "extremes", both=False)


def _extreme_values(rng: Random) -> dict[str, Any]:
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
    name = rng.choice(FAST_FORMATS)
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


def is_number(values: dict[str, Any], place: TreePath) -> bool:
    """Whether a size is there, and not the version of the format."""
    return type(value_at(values, place)) in (int, float) and place != ("camgeo",)
