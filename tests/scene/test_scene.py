"""A scene is data: made from values, read-only, edited into another one, copied and pickled.

An edited scene is the one that its values make, though most of it is that of an earlier one.
"""

from __future__ import annotations

import ast
import copy
import dataclasses
import pathlib
import pickle
import random
import tomllib
from collections.abc import Callable
from dataclasses import is_dataclass
from decimal import Decimal
from functools import partial
from pathlib import Path
from typing import Any, Final

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import camgeo
from camgeo import record
from camgeo.errors import SceneError, VersionError
from camgeo.kinematics.mechanism.rollers import OscillatingRoller
from camgeo.scene import rules
from camgeo.scene.keys import spelled
from camgeo.scene.scene import Scene, load_scene, parse_scene
from camgeo.scene.values import document_of_tree, with_edits
from tests.findings import known
from tests.long_form import examples
from tests.scene.scenes import (
    FIXTURES,
    GROOVE,
    LINKED,
    PLATE,
    ROCKER,
    leaves,
    loaded,
    refusal_of,
    spoilt,
    values_in,
)
from tests.scene.test_messages import FAULTS

PLAIN = {"plate": PLATE, "rocker": ROCKER, "linked": LINKED, "groove": GROOVE}


def tables(text: str) -> dict[str, Any]:
    return tomllib.loads(text)


# -- from values ---------------------------------------------------------------------------------


def test_numbers_of_all_kinds() -> None:
    """A float stands for the decimal number that it prints as."""
    assert Scene(tables(PLATE)) == parse_scene(PLATE)
    changed = tables(ROCKER)
    changed["follower"] |= {"arm": Decimal("80.0"), "base_radius": 55.0, "pivot": (-96, -72.0)}
    assert Scene(changed) == parse_scene(ROCKER)
    changed["motion"][0]["span"] = 159.9
    changed["motion"][1]["span"] = 200.1  # 360 exactly, though not as binary numbers
    assert Scene(changed).plan.segments[0].span == Decimal("159.9")


@pytest.mark.parametrize(("text", "changes", "message"), FAULTS, ids=[f[2] for f in FAULTS])
def test_faults_are_those_of_the_text(
    text: str, changes: list[tuple[str, str]], message: str
) -> None:
    text, folder = spoilt(text, *changes), pathlib.Path()
    try:
        values = tomllib.loads(text, parse_float=Decimal)
    except tomllib.TOMLDecodeError:
        return
    with pytest.raises(SceneError) as of_values:
        Scene(values, folder=folder)
    of_text = refusal_of(text, folder=folder)
    reported = {dataclasses.replace(fault, line=None) for fault in of_text.faults}
    assert set(of_values.value.faults) == reported


class Odd:
    __repr__ = object.__repr__

    def __str__(self) -> str:
        raise AssertionError("an unknown object is not asked for its text")


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (None, "must be text, a number"),
        (b"50", "must be text, a number"),
        (1j, "must be text, a number"),
        ({1, 2}, "must be text, a number"),
        (Odd(), "= <Odd>: must be text, a number"),
        (float("nan"), "= nan: must be a finite number"),
        (Decimal("-Infinity"), "= -inf: must be a finite number"),
        (Decimal("sNaN"), "must be a finite number"),
        (Decimal("1e999999"), "is too large for a number"),
        (10**4000, "is too large for a number"),
        ("\ud800", "not text that UTF-8 can encode"),
        ("50", "must be a positive number"),
        (True, "must be a positive number"),
        (-5.0, "must be a positive number"),
        (1e-300, "must be a positive number"),
        ({1: 2}, "the names of keys must be text"),
    ],
    ids=lambda value: value if isinstance(value, str) and value.isascii() else "",
)
def test_values_of_python_that_are_none(value: Any, message: str) -> None:
    changed = tables(PLATE)
    changed["follower"]["base_radius"] = value
    with pytest.raises(SceneError, match=message) as caught:
        Scene(changed)
    assert any(fault.key.startswith("follower.base_radius") for fault in caught.value.faults)


def test_what_is_too_deep_or_too_large_is_refused_in_bounded_time() -> None:
    cyclic = tables(PLATE)
    cyclic["part"] = cyclic
    with pytest.raises(SceneError, match="nested too deeply"):
        Scene(cyclic)
    wide: Any = 1
    for _ in range(12):
        wide = [wide] * 10
    with pytest.raises(SceneError, match="too many values"):
        Scene({"motion": wide})


@pytest.mark.parametrize("values", [None, 3, "camgeo = 1", [1]])
def test_a_scene_is_a_mapping(values: Any) -> None:
    with pytest.raises(SceneError, match="must be a mapping of its tables"):
        Scene(values)


def test_nothing_of_it_can_be_changed() -> None:
    scene = loaded(PLATE)
    with pytest.raises(dataclasses.FrozenInstanceError):
        scene.name = "other"  # type: ignore[misc]  # wrong on purpose
    with pytest.raises(TypeError):
        scene.values["follower"]["base_radius"] = 3
    with pytest.raises(TypeError):
        scene.values["motion"][0] = {}
    given = tables(PLATE)
    own = Scene(given)
    given["follower"]["base_radius"] = 70
    assert own == scene
    assert own.values["follower"]["base_radius"] == 50
    # An identity never belongs to other values than those it is computed from.
    with pytest.raises(TypeError):
        dataclasses.replace(scene, follower=scene.follower)


# -- edits ---------------------------------------------------------------------------------------


def test_an_edit_is_the_scene_that_says_so() -> None:
    scene = loaded(PLATE)
    edits = {
        "follower.roller_radius": 9,
        "motion[2].law": "cycloidal",
        "motion.4.inflection": 0.45,
        "part.keyway": None,
        "tool[1].feed": 250.5,
        "limits": {"radius_ratio": Decimal("0.8")},
    }
    changes = (
        ("roller_radius = 10", "roller_radius = 9"),
        ('"modified-sine"', '"cycloidal"'),
        ("0.4\n", "0.45\n"),
        ("keyway = { width = 6, depth = 2.8 }\n", ""),
        ("\nfeed = 300", "\nfeed = 250.5"),
        ("transmission_angle = 60\nradius_ratio = 0.7", "radius_ratio = 0.8"),
    )
    changed = scene.with_values(edits)
    assert changed == loaded(PLATE, *changes)
    assert changed.follower == loaded(PLATE, *changes).follower
    assert scene == loaded(PLATE)


def test_an_edit_shares_what_does_not_change() -> None:
    for text in PLAIN.values():
        scene = loaded(text)
        roller = scene.with_values({"follower.roller_radius": 8.5})
        assert known(roller.follower).roller_radius == 8.5
        assert roller.plan is scene.plan
        assert roller.linkage is scene.linkage
        output = scene.with_values({"output.tolerance": 0.002})
        assert output.output.tolerance == 0.002
        assert output.plan is scene.plan
        assert output.follower is scene.follower
        assert output.linkage is scene.linkage


def test_an_edit_shares_a_speed_that_comes_from_a_file() -> None:
    scene = load_scene(FIXTURES / "points.toml")
    roller = scene.with_values({"follower.roller_radius": 8.5})
    assert roller.speed_curve is known(scene.speed_curve)
    assert roller.files == scene.files
    assert scene.with_values({"cam.rotation": "cw"}).speed_curve is not scene.speed_curve


def test_an_edit_shares_nothing_that_depends_on_it() -> None:
    scene = loaded(LINKED)
    inches = scene.with_values({"units.length": "inch"})
    assert inches.plan.segments[0].to == 25.4 * scene.plan.segments[0].to  # type: ignore[union-attr]  # the segment is a move
    assert inches.linkage is not scene.linkage
    free = scene.with_values({"linkage": None, "motion[1].to": 5})
    assert free.linkage is None
    assert isinstance(free.follower, OscillatingRoller)
    assert free.follower.direction == 1
    assert free.plan.segments[0].to == pytest.approx(0.08726646259971647)  # type: ignore[union-attr]  # the segment is a move


def test_segments_are_removed_by_the_positions_that_they_had() -> None:
    edits = {"motion[1]": None, "motion[3]": None, "motion[5].dwell": 140}
    assert [str(each.span) for each in loaded(PLATE).with_values(edits).plan.segments] == [
        "100",
        "120",
        "140",
    ]


@pytest.mark.parametrize(
    ("edits", "key", "message"),
    [
        ({"follower.roller_radius": -1}, "follower.roller_radius", "must be 0"),
        ({"follower.rollerradius": 1}, "follower.rollerradius", "is not a known key"),
        ({"follower.base_radius": None}, "follower.base_radius", "is missing"),
        ({"motion[2].law": "sine"}, "motion[2].law", "must be one of"),
        ({"motion[6].law": "scca"}, "motion[6].law", "its positions are 1 to 5"),
        ({"motion[0].law": "scca"}, "motion[0].law", "its positions are 1 to 5"),
        ({"motion.x": 1}, "motion.x", "motion is a list"),
        ({"name.x": 1}, "name.x", "name is not a table"),
        ({"cam[1]": 1}, "cam[1]", "cam is not a list"),
        ({"part.": 1}, "part.", "is not a key"),
        ({"": 1}, "", "is not a key"),
        ({"a" + ".a" * 40: 1}, "", "nested too deeply"),
        ({"motion[2].to": 3, "motion[4].to": 1}, "motion[4].to", "must return to 0"),
    ],
)
def test_faults_of_an_edit_name_the_key(edits: dict[str, Any], key: str, message: str) -> None:
    with pytest.raises(SceneError, match="1 fault") as caught:
        loaded(PLATE).with_values(edits)
    (fault,) = caught.value.faults
    assert fault.key == key
    assert message in fault.message


@settings(max_examples=60, deadline=None)
@given(data=st.data(), name=st.sampled_from(sorted(PLAIN)))
def test_an_edit_back_is_the_scene_again(data: st.DataObject, name: str) -> None:
    scene = loaded(PLAIN[name])
    found = leaves(scene.values)
    numbers = [key for key, value in found.items() if type(value) in (int, Decimal)]
    key = data.draw(st.sampled_from(sorted(numbers)))
    other = float(found[key]) * data.draw(st.floats(0.9, 1.1))
    try:
        there = scene.with_values({key: other})
    except SceneError:
        return
    assert there.with_values({key: found[key]}) == scene
    assert (there == scene) == (Decimal(repr(other)) == found[key])


# -- copies --------------------------------------------------------------------------------------

COPIES: list[Callable[[Scene], Scene]] = [
    copy.copy,
    copy.deepcopy,
    *(lambda scene, p=p: pickle.loads(pickle.dumps(scene, p)) for p in range(2, 6)),
]


@pytest.mark.parametrize("copied", COPIES)
@pytest.mark.parametrize("stem", ["plate_translating", "measured", "setzhub", "conjugate_lever"])
def test_copies_are_the_same(copied: Callable[[Scene], Scene], stem: str) -> None:
    scene = load_scene(FIXTURES / f"{stem}.toml")
    other = copied(scene)
    assert other == scene
    assert hash(other) == hash(scene)
    assert (other.made, other.text_hash) == (scene.made, scene.text_hash)
    assert other.source == scene.source
    assert other.follower == scene.follower
    assert camgeo.Design(other).findings == camgeo.Design(scene).findings


def test_its_files_travel_with_it(tmp_path: pathlib.Path) -> None:
    """What was read once is not read again, neither by a copy nor by an edit."""
    for file in ("measured.toml", "measured.csv"):
        (tmp_path / file).write_bytes((FIXTURES / file).read_bytes())
    scene = load_scene(tmp_path / "measured.toml")
    data = pickle.dumps(scene)
    for path in tmp_path.iterdir():
        path.unlink()
    assert pickle.loads(data) == scene
    edited = pickle.loads(data).with_values({"follower.base_radius": 41})
    assert edited.files == scene.files
    with pytest.raises(SceneError, match=r"lift\.csv.*cannot be read"):
        scene.with_values({"motion[1].file": "lift.csv"})


def test_another_version_refuses_it(monkeypatch: pytest.MonkeyPatch) -> None:
    data = pickle.dumps(loaded(PLATE))
    monkeypatch.setattr(record, "__version__", "another")
    with pytest.raises(VersionError, match=r"a scene pickled by camgeo .* cannot be read"):
        pickle.loads(data)


# -- without a file ------------------------------------------------------------------------------


def test_a_text_needs_a_folder_only_if_it_names_files() -> None:
    assert camgeo.loads(PLATE).scene == loaded(PLATE)
    text = (FIXTURES / "measured.toml").read_text("utf-8")
    with pytest.raises(SceneError, match="names a file, which needs a folder") as caught:
        camgeo.loads(text)
    assert caught.value.faults[0].key.endswith(".file")
    with pytest.raises(SceneError, match="names a file, which needs a folder"):
        Scene(tables(text))
    there = camgeo.loads(text, folder=FIXTURES).scene
    assert there == load_scene(FIXTURES / "measured.toml")


ROOT: Final = Path(__file__).parents[2]

SCENES: Final = sorted(
    path
    for folder in ("scenes", "effects", "milling")
    for path in (ROOT / "fixtures" / folder).glob("*.toml")
)

ODD: Final = (0, -1, 1, 2.5, 1e9, "inner", "groove", "mm", "inch", "no such word", True, None)
"""Values that suit many keys, and none of which suits all."""

LATER: Final = {"source", "stated"}
"""Attributes that hold the values themselves."""


def shown(value: Any) -> str:
    """All that is in a value; of an object that has no fields, its type."""
    if is_dataclass(value) and not isinstance(value, type):
        inner = {name: shown(getattr(value, name)) for name in value.__dataclass_fields__
                 if value.__dataclass_fields__[name].compare}  # fmt: skip
        return f"{type(value).__name__}({inner})"
    if isinstance(value, tuple | list):
        return str([shown(each) for each in value])
    text = repr(value)
    return type(value).__name__ if " at 0x" in text else text


def all_of(scene: Scene) -> dict[str, str]:
    return {name: shown(value) for name, value in vars(scene).items() if name not in LATER}


def outcome(make: Any) -> Any:
    try:
        scene = make()
    except SceneError as error:
        return sorted((each.key, each.message, each.hint) for each in error.faults), None
    return all_of(scene), scene


def fresh(scene: Scene, edits: dict[str, Any]) -> Scene:
    """The edited scene, made of its values alone."""
    return Scene.from_document(
        document_of_tree(with_edits(scene.stated.scene.exact, edits)), scene.source
    )


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_a_chain_of_edits_makes_the_scene_of_its_values(path: Path) -> None:
    """The same attributes or the same faults, whatever earlier scenes have in common with it."""
    rng = random.Random(path.stem)
    scene = load_scene(path)
    for _ in range(examples(12, long=60)):
        place, old = rng.choice(list(values_in(scene.stated.scene.exact)))
        number = isinstance(old, int | Decimal) and not isinstance(old, bool)
        near = [float(old) * 1.01, float(old) * 0.999] if number else []
        edits = {spelled(place): rng.choice([*near, *near, *ODD])}
        here, found = outcome(partial(scene.with_values, edits))
        there, _ = outcome(partial(fresh, scene, edits))
        assert here == there, edits
        scene = found or scene


def test_what_an_edit_does_not_concern_is_not_asked_again(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []

    def counted(rule: rules.Rule) -> rules.Rule:
        def counting(values: Any) -> Any:
            asked.append(rule.__name__)
            return rule(values)

        return counting

    monkeypatch.setattr(rules, "RULES", tuple(map(counted, rules.RULES)))
    scene = load_scene(ROOT / "fixtures" / "scenes" / "setzhub.toml").with_values(
        {"follower.base_radius": 51}
    )
    asked.clear()
    scene.with_values({"follower.base_radius": 52})
    assert set(asked) == {"followers_keep_their_own_rules", "tolerance_is_possible"}


def test_rules_read_by_what_notes_it() -> None:
    """Who looks at the document itself would not be noted."""
    folder = Path(camgeo.__file__).parent
    modules = [*(folder / "scene").glob("*_rules.py"), folder / "scene" / "rules.py"]
    modules += [folder / "scene" / name for name in ("milling.py", "effects.py")]
    for module in modules:
        for node in ast.walk(ast.parse(module.read_text("utf-8"))):
            if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Attribute):
                assert node.value.attr != "scene" or node.attr == "fault", module.name
