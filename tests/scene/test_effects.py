"""Tables of effects: converted once, checked for what each needs, and left out of a text's hash."""

from __future__ import annotations

import hashlib
import math
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from camgeo.dynamics.effects import registry
from camgeo.dynamics.effects.effect import DataFile, Effect
from camgeo.dynamics.effects.registry import EFFECTS, find_effect
from camgeo.errors import Fault, GeometryError, SceneError
from camgeo.scene import effects as tables
from camgeo.scene.scene import Scene, load_scene, parse_scene, without_effects
from camgeo.scene.schema import Node, resolved
from camgeo.scene.values import SCALES, document
from tests.effects.fakes import fake
from tests.scene.scenes import GROOVE, PLATE, ROCKER, refusal_of

LAST_LINE = len(PLATE.splitlines())

INCH = 25.4

UNITS = {
    "kg": 1e-3,  # t
    "kg m^2": 1e3,  # t mm^2 = 1e3 kg 1e-6 m^2
    "kg/m^3": 1e-12,  # t/mm^3 = 1e3 kg / 1e-9 m^3
    "N": 1.0,
    "N m": 1e3,
    "N/mm": 1.0,
    "N m/rad": 1e3,
    "N s/mm": 1.0,
    "N m s/rad": 1e3,
    "MPa": 1.0,
    "mm/s": 1.0,
    "m/min": 1e3,
    "Hz": 2.0 * math.pi,
    "hours": 3600.0,
    "s": 1.0,
    "rev/min": math.pi / 30.0,
    "degrees": math.pi / 180.0,
}
"""The value of 1 of each unit in mm, s, t, N and rad; of a cutting speed in mm/min."""


def declared(name: str, **options: Any) -> Effect:
    """An effect of that name with its own schema, and else only what a test says."""
    return fake(name, schema=find_effect(name).schema, **options)


@pytest.fixture(autouse=True)
def fakes(monkeypatch: pytest.MonkeyPatch) -> dict[str, Effect]:
    """Effects of camgeo's names that ask for nothing, to be replaced by others in a test."""
    found = {name: declared(name) for name in EFFECTS}
    monkeypatch.setattr(registry, "find_effect", found.__getitem__)
    monkeypatch.setattr(tables, "find_effect", found.__getitem__)
    return found


Fakes = dict[str, Effect]


def table(name: str, text: str, scene: str = PLATE) -> Mapping[str, Any]:
    return parse_scene(f"{scene}[effects.{name}]\n{text}\n").effects[name]


def faults(text: str, scene: str = PLATE) -> tuple[Fault, ...]:
    return refusal_of(f"{scene}{text}").faults


def numbers() -> list[tuple[str, str, Node]]:
    """Every key of every effect that is a single number."""
    found = []
    for name in EFFECTS:
        for key, own in find_effect(name).schema["properties"].items():
            if resolved(own).get("type") == "number":
                found.append((name, key, own))
    return found


def within(node: Node) -> float:
    """A number that the schema allows."""
    allowed: dict[str, Any] = resolved(node)
    low = float(allowed.get("minimum", allowed.get("exclusiveMinimum", -1.0)))
    high = float(allowed.get("maximum", allowed.get("exclusiveMaximum", 1e9)))
    return min(low + 0.375, 0.5 * (low + high))


@pytest.mark.parametrize(("name", "key", "node"), numbers())
def test_each_number_is_converted_by_its_unit(
    fakes: Fakes, name: str, key: str, node: Node
) -> None:
    value = within(node)
    own = find_effect(name).schema
    required = [need for need in own.get("required", ()) if need != key]
    others = "".join(f"{need} = {within(own['properties'][need])!r}\n" for need in required)
    text = f"{others}{key} = {value!r}"
    unit = resolved(node).get("x-unit", "")
    length = node.get("$ref", "").rpartition("/")[2] in ("length", "coordinate")
    assert not (unit and length)
    # Two roundings: of the factor and of the product.
    expected = pytest.approx(value * (UNITS[unit] if unit else 1.0), rel=5e-16)
    assert table(name, text)[key] == expected
    inch = PLATE.replace('length = "mm"', 'length = "inch"')
    found = table(name, text, inch)[key]
    assert found == (pytest.approx(value * INCH, rel=5e-16) if length else expected)


def test_units_of_the_schema_are_known() -> None:
    units = {resolved(node).get("x-unit") for _, _, node in numbers()} - {None}
    assert units <= set(SCALES)
    assert set(SCALES) == set(UNITS)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        # the key's own description, and what its definition makes of it
        ("mass", "[kg]"),
        ("moment", "[kg m^2]"),
        ("force", "[N]"),
        ("torque", "[N m]"),
        ("stiffness", "[N/mm]"),
        ("torsional_stiffness", "[N m/rad]"),
        ("stress", "[MPa]"),
        ("frequency", "[Hz]"),
        ("hours", "[hours]"),
        ("density", "[kg/m^3]"),
    ],
)
def test_descriptions_state_the_unit_that_is_converted(text: str, words: str) -> None:
    keys = [(name, key, node) for name, key, node in numbers()
            if node.get("$ref", "") == f"#/$defs/{text}"]  # fmt: skip
    assert keys
    for name, key, node in keys:
        assert words in node["description"], f"{name}.{key}"


def test_places_lists_and_words(fakes: Fakes) -> None:
    text = 'kind = "extension"\nanchor = [1, -2.5]\nattachment = [3, 4]'
    found = table("spring", text)
    assert found == {"kind": "extension", "anchor": (1.0, -2.5), "attachment": (3.0, 4.0)}
    inch = PLATE.replace('length = "mm"', 'length = "inch"')
    assert table("spring", text, inch)["anchor"] == (INCH, -2.5 * INCH)
    assert table("load", "segments = [1, -2, 3.5, 0, 7]")["segments"] == (1.0, -2.0, 3.5, 0.0, 7.0)
    assert table("gravity", "angle = -90")["angle"] == -0.5 * math.pi


def test_names_of_materials(fakes: Fakes) -> None:
    for name in ("steel", "steel-hardened", "en-gjs-600-3", "pom.2"):
        assert table("contact-pressure", f'cam_material = "{name}"') == {"cam_material": name}
    (fault,) = faults('[effects.contact-pressure]\ncam_material = "Steel hardened"\n')
    assert "must be the name of a material" in fault.message


def test_a_table_in_a_table_is_converted(fakes: Fakes) -> None:
    second = "second = { natural_frequency = 2, mass_ratio = 0.25, damping = 0.5 }"
    found = table("vibration", f"natural_frequency = 1\n{second}")
    assert found == {
        "natural_frequency": 2.0 * math.pi,
        "second": {"natural_frequency": 4.0 * math.pi, "mass_ratio": 0.25, "damping": 0.5},
    }


@pytest.mark.parametrize("ending", ["\n", "\r\n"])
def test_a_file_is_read_with_its_hash(fakes: Fakes, tmp_path: Path, ending: str) -> None:
    data = f"0,1{ending}360,1{ending}".encode()
    (tmp_path / "load.csv").write_bytes(data)
    scene = tmp_path / "scene.toml"
    scene.write_text(PLATE + '[effects.load]\nfile = "load.csv"\n', "utf-8")
    loaded: Scene = load_scene(scene)
    assert loaded.effects["load"] == {"file": DataFile("load.csv", data)}
    assert [name for name, _ in loaded.files] == ["load.csv"]


def test_a_file_that_is_not_there_is_reported(fakes: Fakes, tmp_path: Path) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text(PLATE + '[effects.load]\nfile = "load.csv"\n', "utf-8")
    with pytest.raises(SceneError, match=r'effects\.load\.file = "load\.csv": cannot be read'):
        load_scene(scene)
    scene.write_text(PLATE + '[effects.load]\nfile = "../load.csv"\n', "utf-8")
    with pytest.raises(SceneError, match="must not leave the folder"):
        load_scene(scene)


def test_the_order_is_the_scene_s(fakes: Fakes) -> None:
    text = "[effects.spring]\n[effects.balance]\n[effects.inertia]\n[effects.contact-force]\n"
    found = parse_scene(PLATE + text).effects
    assert list(found) == ["spring", "balance", "inertia", "contact-force"]
    assert all(found[name] == {} for name in found)


def test_without_effects_there_are_none() -> None:
    assert parse_scene(PLATE).effects == {}
    assert parse_scene(PLATE + "[effects]\n").effects == {}


# What is missing ----------------------------------------------------------------------------------


def parse_spring(given: Mapping[str, Any]) -> Mapping[str, Any]:
    if "preload" not in given:
        raise GeometryError("is missing: the spring's force at cam angle 0", key="preload")
    if given["preload"] > 100.0:
        raise GeometryError("must not exceed 100 N", key="preload", value="x")
    if "stiffness" in given and "torsional_stiffness" in given:
        raise GeometryError("has two rates")
    return given


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", Fault("effects.spring.preload", "", "is missing: the spring's force at cam angle 0",
                   line=LAST_LINE + 1)),
        ("preload = 120", Fault("effects.spring.preload", "120", "must not exceed 100 N",
                                line=LAST_LINE + 2)),
        ("preload = 1\nstiffness = 1\ntorsional_stiffness = 2",
         Fault("effects.spring", "", "has two rates", line=LAST_LINE + 1)),
    ],
)  # fmt: skip
def test_what_parse_refuses_is_reported_with_key_and_line(
    fakes: Fakes, text: str, expected: Fault
) -> None:
    fakes["spring"] = declared("spring", parse=parse_spring)
    assert faults(f"[effects.spring]\n{text}\n") == (expected,)


SPEED = ("cam.speed", "cam.speed_curve")


@pytest.mark.parametrize(
    ("name", "keys", "message", "enough"),
    [
        ("kinematics", SPEED, "needs one of [cam] speed, [cam] speed_curve", ""),
        ("gravity", ("effects.inertia",), "needs [effects.inertia]", "[effects.inertia]"),
        (
            "contact-force",
            ("effects.inertia", "effects.load", "effects.spring"),
            "needs one of [effects.inertia], [effects.load], [effects.spring]",
            "[effects.load]\nconstant = 1",
        ),
    ],
)
def test_what_is_missing_is_reported_with_the_line_of_the_table(
    fakes: Fakes, name: str, keys: tuple[str, ...], message: str, enough: str
) -> None:
    fakes[name] = declared(name, keys=(keys,))
    (fault,) = faults(f"[effects.{name}]\n", ROCKER)
    line = len(ROCKER.splitlines()) + 1
    assert (fault.key, fault.message, fault.line) == (f"effects.{name}", message, line)
    assert name in parse_scene(f"{PLATE}[effects.{name}]\n{enough}\n").effects


def test_what_a_needed_effect_lacks_is_reported_for_the_named_one(fakes: Fakes) -> None:
    fakes["balance"] = declared("balance", needs=("inertia",))
    fakes["inertia"] = declared("inertia", needs=("kinematics",), uses=("load",))
    fakes["kinematics"] = declared("kinematics", keys=(SPEED,))
    fakes["load"] = declared("load", keys=(("part.bore",),))
    (fault,) = faults("[effects.balance]\n", ROCKER)
    assert fault.key == "effects.balance"
    assert fault.message == "needs kinematics, which needs one of [cam] speed, [cam] speed_curve"
    # What is used counts only if the scene names it, and then for both.
    found = faults("[effects.balance]\n[effects.load]\nconstant = 1\n", ROCKER)
    assert [(each.key, each.message) for each in found if "bore" in each.message] == [
        ("effects.balance", "needs load, which needs [part] bore"),
        ("effects.load", "needs [part] bore"),
    ]


def test_a_misspelt_key_is_not_missing_too(fakes: Fakes) -> None:
    fakes["kinematics"] = declared("kinematics", keys=(SPEED,))
    scene = PLATE.replace("speed = 60", "sped = 60")
    (fault,) = faults("[effects.kinematics]\n", scene)
    assert fault.key == "cam.sped"


def test_a_ring_ends_the_search(fakes: Fakes) -> None:
    """The graph refuses it when one of them is asked for."""
    fakes["load"] = declared("load", needs=("spring",))
    fakes["spring"] = declared("spring", needs=("load",))
    assert set(parse_scene(PLATE + "[effects.load]\n").effects) == {"load"}


def test_all_faults_are_reported_at_once(fakes: Fakes) -> None:
    """Of several tables: faults against the schema, together with those that an effect finds."""
    fakes["spring"] = declared("spring", parse=parse_spring)
    keys = (("effects.inertia",),)
    fakes["gravity"] = declared("gravity", keys=keys)
    text = "[effects.friction]\nguide = -1\n[effects.spring]\n[effects.gravity]\n"
    assert [fault.key for fault in faults(text)] == [
        "effects.friction.guide",
        "effects.spring.preload",
        "effects.gravity",
    ]


def test_a_table_with_a_wrong_value_is_not_judged_any_further(fakes: Fakes) -> None:
    fakes["spring"] = declared("spring", parse=parse_spring)
    (fault,) = faults("[effects.spring]\nstiffness = -1\n")
    assert fault.key == "effects.spring.stiffness"


@pytest.mark.parametrize("text", ["effects = 5\n", "effects = []\n", "[[effects.spring]]\n"])
def test_what_is_no_table_is_refused(fakes: Fakes, text: str) -> None:
    scene = f"{text}{PLATE}" if text.startswith("effects") else f"{PLATE}{text}"
    with pytest.raises(SceneError, match=r"effects.*must be a table"):
        parse_scene(scene)


SPRING = "[effects.spring]\npreload = 40\nstiffness = 2.5\n"


@pytest.fixture(scope="module")
def of_plate() -> str:
    return parse_scene(PLATE).text_hash


def kept(text: str) -> str:
    data = text.encode()
    return without_effects(data, document(data)).decode()


def hash_of(text: str) -> str:
    """Of the bytes themselves: text would have its line ends translated."""
    found = parse_scene(text).text_hash
    assert found == hashlib.sha256(kept(text).encode()).hexdigest()
    return found


def test_without_effects_it_is_the_hash_of_the_file() -> None:
    assert hash_of(PLATE) == hashlib.sha256(PLATE.encode()).hexdigest()
    # Not even a comment or an empty line is left out.
    text = f"# no [effects]\n\n{PLATE}\n\n# end\n\n"
    assert hash_of(text) == hashlib.sha256(text.encode()).hexdigest()
    # A file with the line ends of Windows has a hash of its own.
    assert hash_of(PLATE.replace("\n", "\r\n")) != hash_of(PLATE)


HEADS = [
    "",
    "\n",
    "\n\n# The spring.\n# It is strong.\n",
    "\n# one\n# two\n",
]

BODIES = [
    SPRING,
    "[effects]\n",
    "[effects.gravity]\n",
    "[ effects . gravity ]  # weights\n",
    '["effects".gravity]\n',
    "[effects.load]\nsegments = [\n    1, 2,  # two\n\n    # of five\n    3, 4, 5,\n]\n",
    "[effects.spring]\n# the preload\npreload = 40  # N\n\n# the rate\nstiffness = 2.5\n",
    "[effects]\ngravity = {}\nspring = { preload = 40, stiffness = 2.5 }\n",
    "[effects]\nspring.preload = 40\nspring.stiffness = 2.5\ngravity.angle = -90\n",
    "[effects.spring]\npreload = 40\n\n[effects.gravity]\nangle = -90\n\n[effects.balance]\n",
    "[effects.vibration]\n[effects.vibration.second]\nnatural_frequency = 9\nmass_ratio = 0.5\n",
    '[effects.balance]\nmaterial = """steel"""\n',
]


@pytest.mark.parametrize("head", HEADS)
@pytest.mark.parametrize("body", BODIES)
def test_at_the_end(head: str, body: str, of_plate: str) -> None:
    assert hash_of(f"{PLATE}{head}{body}") == of_plate
    assert kept(f"{PLATE}{head}{body}".replace("\n", "\r\n")) == PLATE.replace("\n", "\r\n")


@pytest.mark.parametrize(
    "text",
    [
        "effects.spring.preload = 40\neffects.gravity = {}\n",
        "effects = { spring = { preload = 40 } }\n",
        "# forces\neffects.load.segments = [1, 2,\n# more\n3, 4, 5]\n\n",
    ],
)
def test_dotted_keys_at_the_top(text: str) -> None:
    head, rest = PLATE.split("[units]\n")
    assert hash_of(f"{head}{text}[units]\n{rest}") == hash_of(PLATE)


BEFORE, AFTER = PLATE.split("[limits]\n")


@pytest.mark.parametrize(
    ("text", "left"),
    [
        (f"{BEFORE}{SPRING}\n# all\n[limits]\n{AFTER}", f"{BEFORE}# all\n[limits]\n{AFTER}"),
        (f"{BEFORE}{SPRING}# all\n[limits]\n{AFTER}", f"{BEFORE}# all\n[limits]\n{AFTER}"),
        (f"{BEFORE}\n\n{SPRING}\n[limits]\n{AFTER}", f"{BEFORE}\n\n[limits]\n{AFTER}"),
        (f"{PLATE}\n{SPRING}".rstrip("\n"), PLATE),
    ],
    ids=["comment after a line", "comment", "empty lines", "no last line end"],
)
def test_what_belongs_to_others_stays(text: str, left: str) -> None:
    assert kept(text) == left


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("base_radius = 50", "base_radius = 51"),
        ("[limits]", "# limits\n[limits]"),
        ("[limits]", "\n[limits]"),
        ('name = "plate"', 'name = "plates"'),
        ("inflection = 0.4", "inflection = 0.40"),
    ],
)
def test_a_change_elsewhere_changes_it(old: str, new: str) -> None:
    assert PLATE.count(old) == 1
    changed = PLATE.replace(old, new)
    assert hash_of(changed) != hash_of(PLATE)
    assert hash_of(f"{changed}\n{SPRING}") == hash_of(changed)
    assert hash_of(f"{changed}\n{SPRING}") != hash_of(f"{PLATE}\n{SPRING}")


def sections(scene: str) -> list[str]:
    """A scene cut before each of its headers."""
    parts = scene.replace("\n[", "\n\x00[").split("\x00")
    assert "".join(parts) == scene
    return parts


@settings(deadline=None)
@given(
    scene=st.sampled_from([PLATE, GROOVE]),
    place=st.integers(1, 30),
    body=st.sampled_from(BODIES),
    head=st.sampled_from(["", "# a comment\n", "# what moves\n", "# [effects]\n#\n"]),
    tail=st.sampled_from(["", "\n", "\n\n\n"]),
)
@example(scene=PLATE, place=1, body=BODIES[0], head="", tail="")
def test_wherever_they_stand(scene: str, place: int, body: str, head: str, tail: str) -> None:
    parts = sections(scene)
    place = min(place, len(parts))
    # Keys of `[units]` under `[effects]`: a header of its own follows each part.
    text = "".join((*parts[:place], head, body, tail, *parts[place:]))
    left = kept(text)
    assert left == scene
    assert "effects" not in tomllib.loads(left)
