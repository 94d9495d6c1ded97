"""Two hashes of a scene: of all its values, and of those that determine the bytes of files."""

from __future__ import annotations

import pathlib
import tomllib
from collections.abc import Iterator, Mapping
from decimal import Decimal
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.errors import SceneError
from camgeo.scene.scene import (
    Scene,
    load_scene,
    output_hash,
    parse_scene,
    scene_identity,
    schema_of_all,
)
from camgeo.scene.schema import resolved, table_keys
from camgeo.scene.values import with_edits
from tests.scene.scenes import FIXTURES, GROOVE, LINKED, PLATE, ROCKER, leaves, loaded, spoilt

PAIR = FIXTURES / "conjugate_lever.toml"


def both(scene: Scene) -> tuple[str, str]:
    return scene.identity, scene.made


@pytest.mark.parametrize("other", ["50.0", "5e1", "5.000E+01", "0.5e2", "50.000"])
def test_how_a_number_is_written_does_not_count(other: str) -> None:
    changed = loaded(PLATE, ("base_radius = 50", f"base_radius = {other}"))
    assert both(changed) == both(loaded(PLATE))


@pytest.mark.parametrize(
    "other", ["50.00000000000000000000000000000000001", "-50", "5", "500", "50.5", "0.5"]
)
def test_its_value_does_to_the_last_digit(other: str) -> None:
    tree = loaded(PLATE).stated.scene.exact
    changed = {**tree, "follower": {**tree["follower"], "base_radius": Decimal(other)}}
    assert output_hash(changed, str) != output_hash(tree, str)


@given(st.decimals(allow_nan=False, allow_infinity=False), st.decimals(-5, 5, places=3))
def test_numbers_are_equal_that_have_one_value(one: Decimal, other: Decimal) -> None:
    """But a zero keeps its sign."""
    for number in (other, one * 10, -one, Decimal(float(other))):
        alike = one == number and one.is_signed() == number.is_signed()
        assert (len({scene_identity({"name": each}, str) for each in (one, number)}) == 1) == alike
    assert len({scene_identity({"name": each}, str) for each in (one, f"{one:E}")}) == 2


def reordered(values: Any) -> Any:
    if isinstance(values, Mapping):
        return {key: reordered(values[key]) for key in reversed(list(values))}
    return values


def test_the_order_of_keys_and_the_files_name_do_not_count(tmp_path: pathlib.Path) -> None:
    scene = loaded(PLATE)
    assert both(Scene(reordered(scene.values))) == both(scene)
    (tmp_path / "other.toml").write_text(f"# one more comment\n{PLATE}")
    assert both(load_scene(tmp_path / "other.toml")) == both(scene)


def test_the_order_of_segments_and_formats_counts() -> None:
    scene = loaded(PLATE)
    formats = scene.with_values({"output.formats": scene.values["output"]["formats"][::-1]})
    assert formats.made != scene.made
    first, *middle, last = scene.values["motion"]
    assert scene.with_values({"motion": [last, *middle, first]}).made != scene.made


# -- defaults ------------------------------------------------------------------------------------

COMPLETE = {
    "plate": PLATE,
    "rocker": ROCKER,
    "linked": LINKED,
    "groove": GROOVE,
    "scca": spoilt(ROCKER, ('"cycloidal"', '"scca"')),
    "auto": spoilt(ROCKER, ('"cycloidal"', '"auto"')),
    **{file.stem: file.read_text("utf-8") for file in sorted(FIXTURES.glob("*.toml"))},
    **{
        f"{file.stem} with effects": file.read_text("utf-8")
        for file in sorted((FIXTURES.parent / "effects").glob("*.toml"))
    },
}


def stateable(tree: Mapping[str, Any], node: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Keys that a scene does not have, with the values that the schema says they mean."""
    node = resolved(node)
    for name, each in table_keys(node, dict(tree)).items():
        each, place = resolved(each), f"{path}.{name}".lstrip(".")
        value = tree.get(name)
        if isinstance(value, Mapping) or (value is None and each.get("default") == {}):
            yield from stateable(value or {}, each, place)
        elif isinstance(value, tuple) and name == "motion":
            for number, item in enumerate(value, 1):
                yield from stateable(item, each["items"], f"{place}[{number}]")
        elif value is None and "default" in each:
            yield place, each["default"]
        elif value is None and "x-default-mm" in each:
            yield place, each["x-default-mm"]
        elif value is None and tree.get("law") in each.get("x-default-by-law", {}):
            yield place, each["x-default-by-law"][tree["law"]]


def stated_at_once(scene: Scene, edits: dict[str, Any]) -> int:
    """How many of the edits are refused by themselves; the others do not change the hashes.

    A hash differs as soon as one value does, so that as many as the scene takes are made together.
    """
    try:
        changed = scene.with_values(edits)
    except SceneError:  # a key that has its place elsewhere only
        if len(edits) == 1:
            return 1
        every = list(edits.items())
        half = len(every) // 2
        return sum(stated_at_once(scene, dict(each)) for each in (every[:half], every[half:]))
    assert both(changed) == both(scene), edits
    return 0


@pytest.mark.parametrize("name", COMPLETE)
def test_defaults_may_be_spelled_out(name: str) -> None:
    folder = FIXTURES.parent / "effects" if name.endswith("effects") else FIXTURES
    scene = parse_scene(COMPLETE[name], folder=folder)
    found = dict(stateable(scene.values, schema_of_all(scene.stated.scene.plain)))
    assert len(found) > 3
    if scene.unit == "inch":  # no number of inches is a thousandth of a millimetre
        found.pop("output.tolerance", None)
        found.pop("limits.closing_error", None)
    refused = stated_at_once(scene, found)
    assert 2 * refused < len(found)  # others are not passed over


def test_a_return_roller_is_as_the_main_one() -> None:
    scene = load_scene(PAIR)
    for key in ("roller_radius", "arm"):
        stated = scene.with_values({f"follower.return.{key}": None})
        value = stated.values["follower"][key]
        assert both(stated.with_values({f"follower.return.{key}": value})) == both(stated)


def test_a_default_in_millimetres_is_none_of_inches() -> None:
    scene = load_scene(PAIR).with_values({"limits.closing_error": None})
    assert scene.with_values({"limits.closing_error": 0.02}).made == scene.made
    inches = scene.with_values({"units.length": "inch", "output.tolerance": 0.0001})
    assert inches.with_values({"limits.closing_error": 0.02}).made != inches.made


def test_hashes_of_scenes_of_before_stay_what_they_are() -> None:
    """Files name them. Keys and formats that come later are marked `x-added` in their schemas."""
    scene = load_scene(FIXTURES / "setzhub.toml")
    assert scene.made == "bc084945a6c879eac666b6811b7823f852958891331b7343f796d2ef40f120fe"


def test_a_format_that_came_later_counts_by_what_it_states() -> None:
    scene = load_scene(FIXTURES / "setzhub.toml")
    assert both(scene.with_values({"output.cut-svg": {}})) == both(scene)
    assert both(scene.with_values({"output.step.walls": "arcs"})) == both(scene)
    assert scene.with_values({"output.step.walls": "spline"}).made != scene.made


# -- what counts ---------------------------------------------------------------------------------


def test_files_count_by_what_is_in_them(tmp_path: pathlib.Path) -> None:
    scene = load_scene(FIXTURES / "measured.toml")
    data = (FIXTURES / "measured.csv").read_bytes()
    (tmp_path / "measured.csv").write_bytes(data)
    (tmp_path / "other.csv").write_bytes(data)
    (tmp_path / "changed.csv").write_bytes(data + b"\n")
    same = Scene(scene.values, folder=tmp_path)
    assert both(same) == both(scene)
    place = scene.stated.scene
    (index,) = [k for k, each in enumerate(place.exact["motion"]) if each.get("law") == "table"]
    key = f"motion[{index + 1}].file"
    assert both(same.with_values({key: "other.csv"})) == both(scene)
    changed = same.with_values({key: "changed.csv"})
    assert changed.made != scene.made
    assert changed.identity != scene.identity


def test_a_machine_profile_counts_by_what_is_in_it(tmp_path: pathlib.Path) -> None:
    texts = {"a.toml": "name = 'a'", "b.toml": "name = 'a'", "c.toml": "name = 'c'"}
    for file, text in texts.items():
        (tmp_path / file).write_text(text)
    scene = Scene(tomllib.loads(PLATE), folder=tmp_path)
    a, b, c = (scene.with_values({"output.gcode.machine": file}) for file in texts)
    assert a.made == b.made
    assert len({scene.made, a.made, c.made}) == 3


@pytest.mark.parametrize(
    "edit",
    [
        {"effects": {"kinematics": {}}},
        {"effects": {"inertia": {"mass": 2}, "gravity": {}}},
        {"output.accuracy.ripple": True},
    ],
    ids=str,
)
def test_what_changes_no_file_is_not_of_what_is_made(edit: dict[str, Any]) -> None:
    scene = loaded(PLATE)
    changed = scene.with_values(edit)
    assert changed.made == scene.made
    assert changed.identity != scene.identity


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("name", "other"),
        ("units.length", "inch"),
        ("cam.rotation", "cw"),
        ("cam.speed", 61),
        ("limits.radius_ratio", 0.71),
        ("part.thickness", 13),
        ("output.dxf.auxiliary", False),
        ("output.formats", ["dxf"]),
        ("follower.yoke", {}),
        ("follower.offset", -0.0),
    ],
)
def test_all_else_is(key: str, value: Any) -> None:
    scene = loaded(PLATE).with_values({"follower.offset": 0, "output.tolerance": 0.0001})
    changed = scene.with_values({key: value})
    assert changed.made != scene.made
    assert changed.identity != scene.identity


def test_no_two_edits_of_one_key_have_one_hash() -> None:
    """Every number counts, each by its key; of its digits see above."""
    for text in (PLATE, ROCKER, LINKED, GROOVE):
        tree = loaded(text).stated.scene.exact
        keys = [key for key, value in leaves(tree).items() if type(value) in (int, Decimal)]
        others = [output_hash(with_edits(tree, {key: leaves(tree)[key] + 1}), str) for key in keys]
        assert len({output_hash(tree, str), *others}) == 1 + len(keys)
