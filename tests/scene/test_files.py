"""Files that are not scenes, and the origin of a scene."""

from __future__ import annotations

import pathlib

import pytest

import camgeo
from camgeo.errors import SceneError
from camgeo.reading import SCENE
from camgeo.scene.scene import load_scene, parse_scene
from tests.scene.scenes import PLATE

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
