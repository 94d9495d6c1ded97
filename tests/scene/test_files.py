"""Files and keys: what is no scene, which files and values it names, and the lines of its keys."""

from __future__ import annotations

import pathlib
import tomllib
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

import camgeo
from camgeo.errors import SceneError
from camgeo.reading import SCENE
from camgeo.scene.keys import key_lines, nearest_line, spelled
from camgeo.scene.scene import load_scene, parse_scene
from camgeo.scene.values import named_files, stamp, value_path
from tests.findings import known
from tests.scene.scenes import FIXTURES, GROOVE, LINKED, PLATE, ROCKER, refusal_by, values_in

BYTES = [
    (b"", "the scene is empty"),
    (b"\n  # nothing yet\n", "the scene is empty"),
    (b"camgeo = \n", "line 1: the scene is not valid TOML: Invalid value"),
    (b"camgeo = 1\nname : x\n", "line 2: the scene is not valid TOML: Expected '='"),
    (b"camgeo = 1\ncamgeo = 1\n", "line 2: the scene is not valid TOML: Cannot overwrite"),
    (b"x = [1, 2", "not valid TOML: .* before the end of the file"),
    (b"{\n", "not valid TOML"),
    (b"camgeo = 1\n# gr\xfcn\n", "line 2: the scene is not UTF-8 text"),
    (PLATE.encode("utf-16"), "the scene is not UTF-8 text"),
    (b"\x00\x01\x02", "not valid TOML"),
    (b"x = " + 5000 * b"9", "a number with too many digits"),
    (b"x = " + 5000 * b"[" + 5000 * b"]", "nested too deeply"),
    (b"x = " + 250 * b"[" + 250 * b"]", "nested too deeply"),
    (b"x" + 250 * b".x" + b" = 1", "nested too deeply"),
    (b"#" * (SCENE.size + 1), "larger than 2,000,000 bytes"),
]


@pytest.mark.parametrize(("data", "message"), BYTES, ids=range(len(BYTES)))
def test_no_scene(data: bytes, message: str, tmp_path: pathlib.Path) -> None:
    file = tmp_path / "scene.toml"
    file.write_bytes(data)
    with pytest.raises(SceneError, match=message) as caught:
        load_scene(file)
    assert caught.value.file == str(file)
    assert str(caught.value).startswith(f"{file}: 1 fault")


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_a_byte_order_mark_is_no_part_of_a_scene(end: str, tmp_path: pathlib.Path) -> None:
    data = PLATE.replace("\n", end).encode()
    marked = tmp_path / "marked.toml"
    marked.write_bytes(b"\xef\xbb\xbf" + data)
    assert load_scene(marked).identity == camgeo.Scene.from_text(data).identity
    found = pathlib.Path(__file__).parents[2] / "fixtures" / "found" / "byte_order_mark.toml"
    assert found.read_bytes().startswith(b"\xef\xbb\xbf")
    assert load_scene(found).follower is not None or load_scene(found).linkage is not None
    with pytest.raises(SceneError, match="line 1: the scene is not valid TOML"):
        camgeo.Scene.from_text(b"\xef\xbb\xbfcamgeo =" + data)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("none.toml", "there is no such file"),
        ("", "cannot be read: it is a folder"),
        ("a\0b", "cannot be read"),
    ],
)
def test_no_file(name: str, message: str, tmp_path: pathlib.Path) -> None:
    with pytest.raises(SceneError, match=message):
        load_scene(tmp_path / name)


def test_text_that_no_file_can_hold() -> None:
    with pytest.raises(SceneError, match="not text that UTF-8 can encode"):
        parse_scene('name = "\ud800"')


@pytest.mark.parametrize("line", ["key{} = 1\n", "[[motion]]\nkey{} = 1\n", "[[motion]]\n#{}\n"])
def test_no_more_faults_than_anyone_reads(line: str) -> None:
    text = PLATE + "".join(line.format(number) for number in range(3000))
    with pytest.raises(SceneError, match="more faults than are listed here") as caught:
        parse_scene(text)
    assert len(caught.value.faults) <= 1001


def test_the_source_is_named(tmp_path: pathlib.Path) -> None:
    file = tmp_path / "scene.toml"
    data = PLATE.replace("\n", "\r\n").encode()
    file.write_bytes(data)
    source = load_scene(file).source
    assert source.file == str(file)
    assert source.text.encode() == data
    assert source.folder == tmp_path
    assert parse_scene(PLATE).source.file == ""


FOLDER = Path("/scenes")


@pytest.mark.parametrize(
    ("text", "names"),
    [
        (
            'name = "a"\n[[motion]]\nfile = "b/c.csv"\n[x]\ny = ["d", 1, {z = "e"}]\n',
            ("a", "b/c.csv", "d", "e"),
        ),
        # None leaves the folder.
        ('a = "../b"\nc = "/etc/passwd"\nd = ""\ne = "f\\u0000"\n', ()),
    ],
)
def test_any_text_of_a_scene_may_be_a_name(text: str, names: tuple[str, ...]) -> None:
    assert named_files(text, FOLDER) == tuple(FOLDER / name for name in names)


@pytest.mark.parametrize("text", ["a = [", "a = 1\na = 2\n", "[" * 5000, f"a{'.a' * 50} = 1"])
def test_a_text_that_is_no_toml_names_nothing_new(text: str) -> None:
    assert named_files(text, FOLDER) is None


@given(st.text(max_size=30))
def test_any_text_has_files_in_the_folder_or_none(text: str) -> None:
    for path in named_files(text, FOLDER) or ():
        assert path.is_relative_to(FOLDER)


def test_a_stamp_tells_what_is_there(tmp_path: Path) -> None:
    path = tmp_path / "a"
    assert stamp(path) is None
    assert stamp(tmp_path / "a\0") is None
    path.write_text("a")
    assert stamp(path) == stamp(path)
    before = stamp(path)
    path.unlink()
    path.write_text("ab")
    assert stamp(path) != before


TRICKY = '''
# [not.a.table]
a = 1 # b = 2
"quoted key" = 'x # y'
c.d."e f" = """
[inside]
f = 1
"""
g = [
  1, # [h]
  [2, 3],
  { i = 4 },
]
[table]   # comment
j = "]"
[ table . sub ]
k = { l = [1], m = "}" }
[[array]]
n = 1
[array.inner]
o = \'\'\'
[[array]]
\'\'\'
[[array]]
[[array.deep]]
p = 1
[[array.deep]]
p = 2
'''

EXPECTED = {
    ("a",): 3,
    ("quoted key",): 4,
    ("c",): 5,
    ("c", "d"): 5,
    ("c", "d", "e f"): 5,
    ("g",): 9,
    ("g", 0): 10,
    ("g", 1): 11,
    ("g", 2): 12,
    ("table",): 14,
    ("table", "j"): 15,
    ("table", "sub"): 16,
    ("table", "sub", "k"): 17,
    ("array",): 18,
    ("array", 0): 18,
    ("array", 0, "n"): 19,
    ("array", 0, "inner"): 20,
    ("array", 0, "inner", "o"): 21,
    ("array", 1): 24,
    ("array", 1, "deep"): 25,
    ("array", 1, "deep", 0): 25,
    ("array", 1, "deep", 0, "p"): 26,
    ("array", 1, "deep", 1): 27,
    ("array", 1, "deep", 1, "p"): 28,
}


def test_tricky_file() -> None:
    tomllib.loads(TRICKY)
    assert key_lines(TRICKY) == EXPECTED
    # It gives up on an escape in a key.
    assert key_lines('a = 1\n"b\\n" = 2\nc = 3\n') == {("a",): 1}


def test_nearest_line_around_a_key() -> None:
    lines = key_lines(TRICKY)
    assert nearest_line(("table", "sub", "k", "l", 0), lines) == 17
    assert nearest_line(("array", 1, "deep", 1, "q"), lines) == 27
    assert nearest_line(("nothing",), lines) is None
    without_header = key_lines("a = 1\n[effects.spring]\n[effects.load]\n")
    assert nearest_line(("effects", "inertia"), without_header) == 2
    assert nearest_line((), lines) is None


def test_paths_are_counted_from_one() -> None:
    assert spelled(("motion", 1, "span")) == "motion[2].span"
    assert spelled(("odd key", "a.b", 0)) == '"odd key"."a.b"[1]'
    assert spelled((200 * "x",)) == '"' + 60 * "x" + '..."'
    assert spelled(()) == ""


SCENES = [PLATE, ROCKER, LINKED, GROOVE, *(f.read_text() for f in sorted(FIXTURES.glob("*.toml")))]


@pytest.mark.parametrize("text", SCENES, ids=range(len(SCENES)))
def test_every_key_has_its_line(text: str) -> None:
    lines = key_lines(text)
    rows = text.splitlines()
    for path, _ in values_in(tomllib.loads(text)):
        if isinstance(path[-1], str):
            line = known(nearest_line(path, lines))
            assert path[-1] in rows[line - 1]


@pytest.mark.parametrize(
    "name", ["scenes/setzhub", "scenes/hub_and_holes", "effects/press", "effects/four_bar"]
)
def test_every_value_of_a_scene_has_a_path(name: str) -> None:
    tree = load_scene(FIXTURES.parent / f"{name}.toml").stated.scene.exact
    for path, value in values_in(tree):
        if isinstance(value, dict | list):
            continue
        assert value_path(tree, spelled(path)) == path
        dotted = ".".join(str(step + 1) if isinstance(step, int) else step for step in path)
        assert value_path(tree, dotted) == path


def test_keys_that_a_scene_may_state_have_one_too() -> None:
    tree = load_scene(FIXTURES / "setzhub.toml").stated.scene.exact
    assert value_path(tree, "limits.diameter") == ("limits", "diameter")
    assert value_path(tree, "motion[2].inflection") == ("motion", 1, "inflection")


@pytest.mark.parametrize(
    ("key", "message"),
    [
        ("", "is not a key of a scene"),
        ("motion[2", "is not a key of a scene"),
        ("folower.base_radius", "did you mean follower?"),
        ("follower.arm.length", "follower.arm is a single value"),
        ("follower[1]", "follower is not a list"),
        ("motion", "is a list: name a position in it"),
        ("motion[0].law", "its positions are 1 to 5"),
        ("operation[1].kind", "the scene states none of it"),
        ("part", "is a table: name one of its keys"),
    ],
)
def test_what_is_no_single_value(key: str, message: str) -> None:
    tree = load_scene(FIXTURES / "setzhub.toml").stated.scene.exact
    assert message in str(refusal_by(value_path, tree, key))
