"""Effects of scenes made up at random: numbers or a clear answer, nothing else.

For every scene that its schema allows, each effect must give finite numbers, a finding that states
why not, or a fault of the scene with its key. A warning of Python is an error here, see
`filterwarnings`.
"""

from __future__ import annotations

import json
import math
import re
from dataclasses import asdict
from functools import cache
from random import Random
from typing import Any, Final

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.check.finding import Finding
from camgeo.design.design import Design
from camgeo.dynamics.effects.effect import Column, MachineTraits, Only
from camgeo.dynamics.effects.graph import describe_machine
from camgeo.dynamics.effects.registry import EFFECTS, find_effect
from camgeo.dynamics.effects.results import FINDERS
from camgeo.errors import EffectError, Fault, GeometryError, SceneError
from camgeo.numeric.arrays import FloatArray
from camgeo.scene.scene import parse_scene
from camgeo.scene.schema import schema, whole_schema
from camgeo.units import TURN
from tests.effects.scenes import SCENES
from tests.long_form import examples

LISTED: Final = ("masses", "moments")
"""Lists of the masses of a train."""

NAMES: Final = tuple(sorted(path.stem for path in SCENES.glob("*.toml")))

WHOLE: Final = whole_schema()


USUAL: Final[dict[str, tuple[float, float]]] = {
    "mass": (1e-3, 1e2),
    "moment": (1e-6, 1e1),
    "force": (1.0, 1e4),
    "load": (1.0, 1e3),
    "torque": (1e-2, 1e3),
    "stiffness": (1e-2, 1e4),
    "torsional_stiffness": (1.0, 1e5),
    "viscous": (1e-4, 1.0),
    "viscous_torque": (1e-4, 1e1),
    "coefficient": (1e-3, 0.4),
    "length": (1e-2, 1e2),
    "coordinate": (1e-1, 3e2),
    "angle": (1.0, 360.0),
    "share": (1e-3, 1.0),
    "speed": (1.0, 1e3),
    "stress": (1e2, 1e6),
    "poisson": (0.1, 0.5),
    "safety": (1.0, 3.0),
    "hours": (1e1, 1e5),
    "frequency": (0.5, 1e4),
    "damping": (1e-3, 0.5),
    "swing": (1e-3, 1e1),
    "ratio": (1e-2, 2e1),
    "density": (1e3, 1e4),
    "grade": (1e-1, 1e4),
    "effect_tolerance": (1e-8, 1e-2),
}
"""Ranges in which designers' numbers lie, by the definition of the schema, in its units."""


TURNED: Final = ("lever", "crank")
"""Far ends of linkages that turn."""

SPRINGS: Final = (
    ("stiffness", "preload"),
    ("torsional_stiffness", "preload_torque", "kind"),
    ("stiffness", "preload", "anchor", "attachment", "kind"),
)


@cache
def scene_text(name: str) -> str:
    return (SCENES / f"{name}.toml").read_text("utf-8")


def number(rng: Random, kind: str, *, wild: bool) -> float:
    """A number that the schema allows for `kind`."""
    node = schema()["$defs"][kind]
    least = float(node.get("minimum", node.get("exclusiveMinimum", 0.0)))
    most = float(node.get("maximum", node.get("exclusiveMaximum", 1.0)))
    if "minimum" in node and rng.random() < 0.1:
        return max(least, 0.0)
    low, high = USUAL[kind]
    if wild:
        low, high = max(least, 1e-12), most
    found = math.exp(rng.uniform(math.log(low), math.log(high)))
    found = float(f"{found:.4g}")
    if kind in ("load", "coordinate", "angle") and rng.random() < 0.5:
        found = -found
    found = min(max(found, least), most)
    if "exclusiveMaximum" in node and found >= most:
        found = 0.5 * most
    return found


def value(rng: Random, key: str, node: dict[str, Any], *, wild: bool) -> Any:
    """A value for a key of a table; None where it takes a file."""
    kind = node.get("$ref", "").rpartition("/")[2]
    if kind == "file":
        return None
    if kind == "material":
        return rng.choice(("steel", "steel-hardened", "cast-iron"))
    if "enum" in node:
        return rng.choice(node["enum"])
    if kind:
        return number(rng, kind, wild=wild)
    if key in ("coupler_centre", "restitution"):
        return round(rng.random(), 3)
    if key == "segments":
        return [number(rng, "load", wild=wild) for _ in range(5)]
    if key == "output":
        return 1
    if key in LISTED:
        return [stage(rng, node["items"], wild=wild) for _ in range(rng.randint(1, 3))]
    if node["type"] == "array":
        return [number(rng, "coordinate", wild=wild) for _ in range(2)]
    inner = node["properties"]
    return {each: value(rng, each, inner[each], wild=wild) for each in inner}


def stage(rng: Random, node: dict[str, Any], *, wild: bool) -> dict[str, Any]:
    """A mass of a train; its damper is given in one way."""
    inner = node["properties"]
    twice = rng.choice([each for each in inner if each == "damping" or each.startswith("viscous")])
    keys = [
        each for each in inner if each in node["required"] or (each != twice and rng.random() < 0.6)
    ]
    return {each: value(rng, each, inner[each], wild=wild) for each in keys}


@cache
def machine(name: str) -> MachineTraits:
    scene = parse_scene(scene_text(name), str(SCENES / f"{name}.toml"))
    return describe_machine(Design(scene).effects.subject)


def foreign_keys(effect: str, of: MachineTraits) -> set[str]:
    """Keys of a table that do not suit the machine; empty for the effect as a whole."""
    rules = (each for each in find_effect(effect).rules if isinstance(each, Only))
    unfit = (rule for rule in rules if getattr(of, rule.kind.attribute) in rule.kind.others)
    return {key for rule in unfit for key in rule.keys or ("",)}


def keys_of_train(rng: Random, chosen: list[str], of: MachineTraits) -> list[str]:
    """The keys with one that gives the train, and those that suit it."""
    turns = of.demanded == "rad"
    if rng.random() < 0.3:
        listed = "moments" if turns else "masses"
        return [listed, *(each for each in chosen if each.startswith(("limit", "output")))]
    stiff = "torsional_stiffness" if turns else "stiffness"
    if of.far in TURNED:  # the mass of its far end is not known
        stiff = "natural_frequency"
    one = rng.choice(("natural_frequency", stiff))
    several = ("natural_frequency", "stiffness", "torsional_stiffness", *LISTED, "output")
    return [one, *(each for each in chosen if each not in several)]


def keys_of(
    rng: Random, effect: str, properties: dict[str, Any], text: str, of: MachineTraits
) -> list[str]:
    """Some of the keys of a table, most times those that suit the follower."""
    rocks, slides = of.lift == "rad", of.far == "slider"
    foreign = foreign_keys(effect, of)
    keys = [each for each in properties if each not in foreign]
    if rng.random() < 0.03:
        keys = list(properties)
    chosen = [each for each in keys if rng.random() < 0.6]
    if effect == "spring":
        suits = SPRINGS if rocks else SPRINGS[:1]
        chosen = list(
            rng.choice(suits[1:] if rocks and not slides else (*suits, ("wire", "preload")))
        )
    if effect == "vibration":
        chosen = keys_of_train(rng, chosen, of)
    if effect == "load":
        chosen = [
            "segments" if text.count("[[motion]]") == 5 and rng.random() < 0.5 else "constant"
        ]
    if effect == "lift-off" and rng.random() < 0.95:
        chosen = [each for each in chosen if (each == "backlash") == ('"groove"' in text)]
    if effect == "speed-fluctuation":
        chosen = ["moment_of_inertia", "no_load_speed", "stall_torque", *chosen[:1]]
        chosen = [each for each in dict.fromkeys(chosen) if each != "file"]
    if effect == "friction":
        chosen += [f"{each}_diameter" for each in ("pivot", "roller_pin") if each in chosen]
        if "guide_overhang" in chosen or (of.touching == "face" and "guide" in chosen):
            chosen.append("guide_length")
    if effect == "inertia":
        for part, mass in (("rocker", "rocker_mass"), ("coupler", "coupler_mass")):
            if any(each.startswith(part) for each in chosen):
                chosen.append(mass)
    for each, other in (("hole_diameter", "hole_radius"), ("life", "rating")):
        if each in chosen:
            chosen.append(other)
    return list(dict.fromkeys(chosen))


def wire(rng: Random) -> dict[str, float]:
    """A helical spring that can be wound."""
    diameter, active = rng.uniform(0.5, 5.0), rng.uniform(2.0, 12.0)
    return {
        "diameter": diameter,
        "coil_diameter": diameter * rng.uniform(1.5, 15.0),
        "active_coils": active,
        "free_length": diameter * (active + 2.0) * rng.uniform(1.1, 4.0),
    }


def spelled(item: Any) -> str:
    """A value as TOML has it."""
    if isinstance(item, dict):
        return "{ " + ", ".join(f"{key} = {spelled(each)}" for key, each in item.items()) + " }"
    if isinstance(item, list):
        return "[" + ", ".join(spelled(each) for each in item) + "]"
    return json.dumps(item) if isinstance(item, (str, int)) else repr(float(item))


def tables_of(rng: Random, text: str, of: MachineTraits) -> str:
    """Tables of some effects."""
    wild = rng.random() < 0.25
    named = {each for each in EFFECTS if rng.random() < 0.45}
    if rng.random() < 0.9 and named & {"gravity", "lift-off", "speed-fluctuation", "spring-surge"}:
        named |= {"inertia", "spring"}
    if rng.random() < 0.95:
        named -= {name for name in EFFECTS if "" in foreign_keys(name, of)}
    if named >= {*FINDERS}:
        named.remove(rng.choice(FINDERS))
    lines = []
    for effect in EFFECTS:
        if effect not in named or (effect == "load" and of.far in TURNED):
            continue
        lines.append(f"[effects.{effect}]")
        node = find_effect(effect).schema
        properties = node["properties"]
        chosen = keys_of(rng, effect, properties, text, of)
        for key in dict.fromkeys([*node.get("required", ()), *chosen]):
            if key == "kind":
                kind = "torsion" if "torsional_stiffness" in lines[-1] + lines[-2] else "extension"
                lines.append(f'kind = "{kind}"')
                continue
            if key == "wire":
                lines.append(f"wire = {spelled(wire(rng))}")
                continue
            item = value(rng, key, properties[key], wild=wild and rng.random() < 0.5)
            if item is not None:
                lines.append(f"{key} = {spelled(item)}")
    return "\n".join(lines)


def scene_of(rng: Random) -> tuple[str, str]:
    """Name of the file, and text of a scene of the fixtures with effects and another speed."""
    name = rng.choice(NAMES)
    text = scene_text(name)
    speed = f"speed = {number(rng, 'speed', wild=rng.random() < 0.1)!r}"
    if name == "ring" and rng.random() < 0.8:
        text = text.replace('rotation = "ccw"', f'rotation = "ccw"\n{speed}')
    elif rng.random() < 0.5:
        text = re.sub(r"^speed = \d+$", speed, text, count=1, flags=re.MULTILINE)
    return str(SCENES / f"{name}.toml"), f"{text}\n{tables_of(rng, text, machine(name))}\n"


def within(node: dict[str, Any]) -> dict[str, Any]:
    """Keys that a table may have, with what the schema says of each."""
    while "$ref" in node:
        node = schema()["$defs"][node["$ref"].rpartition("/")[2]]
    found = dict(node.get("properties", {}))
    kinds = (each["then"] for each in node.get("allOf", ()))
    for each in (node.get("items"), node.get("then"), node.get("else"), *kinds):
        found.update(within(each) if each else {})
    return found


def known_key(key: str) -> bool:
    """Whether a scene may have `key`, e.g. "effects.spring.preload"."""
    node: dict[str, Any] = WHOLE
    for step in re.sub(r"\[\d+\]", "", key).split("."):
        keys = within(node)
        if step not in keys:
            return False
        node = keys[step]
    return True


def sides_of(column: Column, phi: FloatArray) -> FloatArray:
    return np.stack([column.values(phi, "right"), column.values(phi, "left")])


def assert_well_formed(design: Design) -> dict[str, str]:
    """That all effects of `design` answer in finite numbers; gives why not, by effect, where not.

    A design that is no cam mechanism is left alone, as commands leave it.
    """
    if any(each.severity == "invalid" for each in design.findings):
        return {}
    failed = {name: fault_of(design, name) for name in design.scene.effects}
    for name in (name for name, fault in failed.items() if not fault):
        result = design.effect(name)
        assert result.error is None or (math.isfinite(result.error) and result.error >= 0.0), name
        assert_columns(design, name, result.columns)
    return {name: fault for name, fault in failed.items() if fault}


def fault_of(design: Design, name: str) -> str:
    """The finding or the key that says why there is no result; empty if there is one."""
    key = ""
    findings: tuple[Finding, ...] | None = None
    try:
        findings = design.effects.findings(name)
    except GeometryError as error:
        key = error.key
    if findings is None:
        assert known_key(key), (name, key)
        return f"key {key}"
    assert_findings(name, findings)
    try:
        design.effect(name)
    except (EffectError, GeometryError) as error:
        reported = str(error)
    else:
        return ""
    *qualifying, refusal = findings  # what a trimmed disc does not make comes first
    assert all(each.name == "trimmed-motion" for each in qualifying)
    assert reported in refusal.sentence
    assert refusal.severity == "broken"
    return refusal.name


def assert_findings(name: str, findings: tuple[Finding, ...]) -> None:
    for each in findings:
        assert re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", each.name), each
        assert each.severity in ("ok", "warning", "broken", "no-disc", "invalid"), each
        assert not re.search(r"\b(nan|inf|None)\b|\{", each.sentence), (name, each)
        assert json.loads(json.dumps(asdict(each), allow_nan=False))["sentence"], each
        numbers = (each.value, each.limit, each.cam_angle, *(each.cam_range or ()))
        assert all(math.isfinite(one) for one in numbers if one is not None), (name, each)
        assert each.cam_angle is None or 0.0 <= each.cam_angle < TURN, (name, each)
        assert each.value is None or isinstance(each.value, float), (name, each)
        for end in each.cam_range or ():
            assert 0.0 <= end <= TURN, (name, each)


def assert_columns(design: Design, name: str, columns: tuple[Column, ...]) -> None:
    for column in columns:
        borders = np.asarray(column.borders)
        assert np.all((borders >= 0.0) & (borders < TURN)), (name, column.name)
        phi = np.concatenate(
            (np.linspace(0.0, TURN, 97, endpoint=False), design.drive.smooth_angles, borders)
        )
        values = sides_of(column, phi)
        assert values.shape == (2, len(phi)), (name, column.name)
        bad = ~np.all(np.isfinite(values), axis=0)
        assert not np.any(bad), (name, column.name, np.degrees(phi[bad][:3]))
        assert column.limit is None or math.isfinite(column.limit), (name, column.name)


def accepted_or_refused(file: str, text: str) -> dict[str, str]:
    """Why effects of a scene have no answer, by effect; or its faults, by key."""
    faults: tuple[Fault, ...] = ()
    design = None
    try:
        design = Design(parse_scene(text, file))
    except SceneError as error:
        faults = error.faults
    if design is not None:
        return assert_well_formed(design)
    assert faults
    for fault in faults:
        assert known_key(fault.key), fault
        assert fault.message
    return {fault.key: "fault" for fault in faults}


@settings(max_examples=examples(4, long=25))
@given(st.randoms(use_true_random=False))
def test_effects_of_any_scene_are_finite_or_refused(rng: Random) -> None:
    accepted_or_refused(*scene_of(rng))


def test_the_scenes_are_not_all_refused() -> None:
    """Most are computed: what is held above is held of effects, not of faults alone."""
    seeds = range(30)
    files, texts = zip(*(scene_of(Random(seed)) for seed in seeds), strict=True)
    accepted = 0
    for file, text in zip(files, texts, strict=True):
        try:
            accepted += len(parse_scene(text, file).effects) > 0
        except SceneError:
            continue
    assert accepted >= len(seeds) // 2


@pytest.mark.parametrize(
    ("key", "known"),
    [
        ("effects.spring.preload", True),
        ("effects.vibration.second.mass_ratio", True),
        ("motion[2].span", True),
        ("cam.speed", True),
        ("effects.spring.load", False),
        ("effects.springs", False),
    ],
)
def test_keys_are_distinguished_from_others(key: str, known: bool) -> None:
    assert known_key(key) == known
