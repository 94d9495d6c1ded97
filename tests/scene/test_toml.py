"""A scene as TOML: its values, with the comments and the order of its original text."""

from __future__ import annotations

import json
import pathlib
import tomllib
from decimal import Decimal
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.errors import SceneError
from camgeo.scene import toml
from camgeo.scene.scene import Scene, load_scene, parse_scene
from camgeo.scene.toml import TEMPLATES, written_into
from camgeo.scene.values import with_edits
from tests.long_form import examples
from tests.scene.scenes import FIXTURES, PLATE, leaves

EFFECTS = FIXTURES.parent / "effects"
FILES = sorted([*FIXTURES.glob("*.toml"), *EFFECTS.glob("*.toml"), *TEMPLATES.glob("*.toml")])
NAMES = [f"{file.parent.name}-{file.stem}" for file in FILES]


def read_back(scene: Scene) -> Scene:
    return parse_scene(scene.to_toml(), folder=scene.source.folder)


def comments(text: str) -> list[str]:
    return [line.partition("#")[2] for line in text.splitlines() if "#" in line]


@pytest.mark.parametrize("file", FILES, ids=NAMES)
def test_a_text_stays_as_it_is(file: pathlib.Path) -> None:
    scene = load_scene(file)
    assert scene.to_toml().encode() == file.read_bytes()
    there = scene.with_values({"name": "other"})
    assert there.with_values({"name": scene.name}).to_toml().encode() == file.read_bytes()


@pytest.mark.parametrize("file", FILES, ids=NAMES)
def test_values_are_written_without_a_text(file: pathlib.Path) -> None:
    text = load_scene(file)
    scene = Scene(text.values, folder=text.source.folder)
    found = read_back(scene)
    assert scene == found == text
    assert scene.made == found.made == text.made
    assert (scene.follower, scene.files) == (text.follower, text.files)


@pytest.mark.parametrize("file", FILES, ids=NAMES)
def test_numbers_are_written_in_their_lines_as_tomlkit_writes_them(
    file: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = file.read_text("utf-8")
    tree = tomllib.loads(text, parse_float=Decimal)
    found = [key for key, value in leaves(tree).items() if toml._is_number(value)]
    values = [Decimal("-0.250"), 7, Decimal("1E+2"), Decimal(4)]
    after = with_edits(tree, dict(zip(found[::3], values, strict=False)))
    quick = toml._with_numbers(text, tree, after)
    assert (quick or text) == text or tomllib.loads(quick or "", parse_float=Decimal) == after
    written = written_into(text, after)
    monkeypatch.setattr(toml, "_with_numbers", lambda *_: None)
    assert written_into(text, after) == written


@pytest.mark.parametrize(
    ("text", "there"),
    [
        ("a = 1\r\n[t]\r\nb = 2.50  # c = 2.50\r\n", True),
        ("a = 1\n[t]\nb = 2.50\n[[u]]\nb = [2.50, 1 , 3]# b\n[[u]]\n  b=[ 2,2 ]", True),
        ('a = 1\ns = """\nb = 2.50\n"""\nb = 2.50\n', True),
        ("a = 1\nt = {b = 2.50}\n", False),
        ("a = [\n1,\n2]\n", False),
    ],
)
def test_numbers_that_stand_in_one_line_with_their_key(text: str, there: bool) -> None:
    tree = tomllib.loads(text, parse_float=Decimal)
    after = with_edits(tree, {key: Decimal("8.0") for key in leaves(tree) if key != "s"})
    found = toml._with_numbers(text, tree, after)
    assert (found is not None) is there
    if found is not None:
        assert tomllib.loads(found, parse_float=Decimal) == after
        assert comments(found) == comments(text)


@settings(max_examples=examples(25, long=60), deadline=None)
@given(data=st.data())
def test_an_edit_changes_its_lines_and_no_others(data: st.DataObject) -> None:
    scene = load_scene(data.draw(st.sampled_from(FILES)))
    numbers = {k: v for k, v in leaves(scene.values).items() if type(v) in (int, Decimal)}
    keys = data.draw(st.lists(st.sampled_from(sorted(numbers)), min_size=1, max_size=3))
    edits = {key: float(numbers[key]) * data.draw(st.floats(0.99, 1.01)) for key in keys}
    try:
        changed = scene.with_values(edits)
    except SceneError:
        return
    written, text = changed.to_toml(), scene.source.text
    assert read_back(changed) == changed
    assert comments(written) == comments(text)
    lines = list(zip(written.splitlines(), text.splitlines(), strict=True))
    assert sum(one != other for one, other in lines) <= len(edits)


TEXT = """\
# A scene of all that TOML has.
camgeo = 1
name = "odd"
cam = { rotation = "ccw", speed = 60 } # short
follower.kind = "translating-roller" # dotted
follower.base_radius = 4e1
follower.roller_radius = 10.0
output.formats = [
  "dxf", # the drawing
  "csv",
]

[[motion]] # first
dwell = 30

# the rise
[[motion]]
law = "points"
span = 150
to = 20 # mm
points = [
  { at = 50, to = 8 }, # low
  { at = 100.50, to = 15 },
]

[[motion]] # last
law = "polynomial-345"
span = 180
to = 0

[effects.kinematics] # end
"""

RISE = TEXT[TEXT.index('[[motion]]\nlaw = "points"') : TEXT.index("[[motion]] # last")]


@pytest.mark.parametrize(
    ("edits", "changes"),
    [
        ({"cam.speed": 61}, [("speed = 60", "speed = 61")]),
        ({"follower.base_radius": Decimal("41.50")}, [("= 4e1", "= 41.50")]),
        ({"motion[2].points[2].at": 101}, [("at = 100.50", "at = 101")]),
        ({"motion[2].to": 2e1, "motion[2].span": 150.0}, []),
        ({"effects": None}, [("[effects.kinematics] # end\n", "")]),
        ({"motion[1].dwell": 29, "motion[3].span": 181}, [("= 30", "= 29"), ("= 180", "= 181")]),
        ({"output.formats": ["dxf", "svg"]}, [('"csv"', '"svg"')]),
        (
            {"motion[2]": None, "motion[1].dwell": 180, "motion[3].law": "cycloidal"},
            [(RISE, ""), ("= 30", "= 180"), ("polynomial-345", "cycloidal")],
        ),
    ],
)
@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_texts_of_all_shapes(
    edits: dict[str, Any], changes: list[tuple[str, str]], end: str
) -> None:
    wanted = TEXT
    for old, new in changes:
        assert wanted.count(old) == 1
        wanted = wanted.replace(old, new)
    changed = parse_scene(TEXT.replace("\n", end)).with_values(edits)
    assert changed.to_toml() == wanted.replace("\n", end)


def test_new_keys_stand_behind_those_set_with_them() -> None:
    edits = {"follower.base_radius": 51, "follower.guide_angle": 80, "limits.undercut": "refuse"}
    written = parse_scene(PLATE).with_values(edits).to_toml()
    assert "base_radius = 51\nguide_angle = 80\nroller_radius = 10\n" in written
    assert 'radius_ratio = 0.7\nundercut = "refuse"\n[part]' in written


def test_new_tables_are_written() -> None:
    edits = {"effects": {"inertia": {"mass": 1}}, "follower.yoke": {}, "follower.offset": 0}
    changed = parse_scene(PLATE).with_values(edits)
    assert read_back(changed) == changed
    assert list(read_back(changed).effects) == ["inertia"]


VALUES = st.one_of(
    st.integers(-(2**63), 2**63 - 1),
    st.decimals(allow_nan=False, allow_infinity=False),
    st.booleans(),
    st.text(st.characters(exclude_categories=["Cs"]), max_size=9),
)
TREES = st.dictionaries(
    st.text(st.characters(exclude_categories=["Cs"]), min_size=1, max_size=5),
    st.recursive(
        VALUES,
        lambda inner: (
            st.lists(inner, max_size=3) | st.dictionaries(st.sampled_from("abc"), inner, max_size=3)
        ),
        max_leaves=8,
    ),
    max_size=5,
)


@settings(deadline=None)
@given(before=TREES, after=TREES)
def test_what_is_written_is_what_is_reported(before: dict[str, Any], after: dict[str, Any]) -> None:
    """Whatever stood in the text before; to the last digit."""
    text = written_into("", before)
    assert tomllib.loads(text, parse_float=Decimal) == before
    assert tomllib.loads(written_into(text, after), parse_float=Decimal) == after


def test_the_first_of_a_list_is_removed() -> None:
    text = "a = [1, 2, 3] # all\n" + "".join(f"[[b]]\nc = {k} # no {k}\n" for k in (1, 2, 3))
    after = {"a": [2, 3], "b": [{"c": 2}, {"c": 3}]}
    written = written_into(text, after)
    assert tomllib.loads(written) == after
    assert comments(written) == [" all", " no 2", " no 3"]


@pytest.mark.parametrize(
    "text",
    [
        "x = nan\ny = -inf # far\nz = 1\n",
        "a.b = 1\na.c = 2\n[x.y]\nz = 1\n[x]\nw = 2\n[v]\n[x.q]\nr = 1\n",
        "[a]\n[a.b]\n[c]\n[a.d]\nx = 1\n[a.e]\n",
        "[[m]]\nd = 1\n[f]\n[[n]]\n[f.g]\nx = 1\n",
    ],
)
def test_any_text_takes_another_value(text: str) -> None:
    tree = tomllib.loads(text, parse_float=Decimal) | {"z": 3}
    written = tomllib.loads(written_into(text, tree), parse_float=Decimal)
    one, other = (json.dumps(each, sort_keys=True, default=str) for each in (written, tree))
    assert one == other
