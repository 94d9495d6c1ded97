"""Files that a scene may name: those of its folder alone."""

from __future__ import annotations

from pathlib import Path

from hypothesis import given
from hypothesis import strategies as st

from camgeo.scene.values import named, stamp

FOLDER = Path("/scenes")


def test_any_text_of_a_scene_may_be_a_name() -> None:
    text = 'name = "a"\n[[motion]]\nfile = "b/c.csv"\n[x]\ny = ["d", 1, {z = "e"}]\n'
    assert named(text, FOLDER) == tuple(FOLDER / name for name in ("a", "b/c.csv", "d", "e"))


def test_names_that_leave_the_folder_are_none() -> None:
    assert named('a = "../b"\nc = "/etc/passwd"\nd = ""\ne = "f\\u0000"\n', FOLDER) == ()


def test_a_text_that_is_no_toml_names_nothing_new() -> None:
    for text in ("a = [", "a = 1\na = 2\n", f"{'[' * 5000}", f"a{'.a' * 50} = 1"):
        assert named(text, FOLDER) is None


@given(st.text(max_size=30))
def test_any_text_has_files_in_the_folder_or_none(text: str) -> None:
    for path in named(text, FOLDER) or ():
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
