"""The scene file on disk: found in its folder alone, and not overwritten when it has changed."""

from __future__ import annotations

import os
import stat
import sys
from pathlib import Path

import pytest

from camgeo.app.designing.desk import OverwriteError, disk, place, read, saved, scenes
from camgeo.errors import CamgeoError, FileError
from camgeo.reading import SCENE

POSIX = pytest.mark.skipif(sys.platform == "win32", reason="links and pipes of POSIX")


@pytest.fixture
def cam(tmp_path: Path) -> Path:
    path = tmp_path / "cam.toml"
    path.write_bytes(b"a = 1\r\n# \xc3\xa4\n")
    return path


@pytest.mark.parametrize(
    "name",
    [
        "", ".", "..", "../cam.toml", "a/../../cam.toml", "/etc/cam.toml", "cam", ".toml",
        "cam.txt",
        "a\\..\\cam.toml", "C:cam.toml", "a\0.toml", "a\n.toml", "\u202elmot.toml",
    ],
)  # fmt: skip
def test_names_that_leave_the_folder_or_name_no_scene_are_refused(
    tmp_path: Path, name: str
) -> None:
    with pytest.raises(FileError):
        place(tmp_path, name)


def test_names_in_the_folder_and_below_are_taken(tmp_path: Path) -> None:
    assert place(tmp_path, "cam.toml") == tmp_path / "cam.toml"
    assert place(tmp_path, "a/b/cam.toml") == tmp_path / "a" / "b" / "cam.toml"


@POSIX
def test_links_are_not_followed(tmp_path: Path, cam: Path) -> None:
    folder = tmp_path / "folder"
    folder.mkdir()
    (folder / "link.toml").symlink_to(cam)
    (folder / "out").symlink_to(tmp_path)
    for name in ("link.toml", "out/cam.toml"):
        with pytest.raises(FileError, match="is a link"):
            place(folder, name)
    with pytest.raises(FileError, match="not a regular file"):
        read(folder / "link.toml")
    assert scenes(folder) == ()


@POSIX
def test_what_is_no_plain_text_is_refused(tmp_path: Path, cam: Path) -> None:
    os.mkfifo(tmp_path / "pipe.toml")
    (tmp_path / "bytes.toml").write_bytes(b"\xff")
    (tmp_path / "large.toml").write_bytes(b"#" * (SCENE.size + 1))
    for name, message in {
        "pipe.toml": "not a regular file",
        "bytes.toml": "not text in UTF-8",
        "large.toml": "at most 2,000,000 are allowed",
        "none.toml": "no such file",
    }.items():
        with pytest.raises(FileError, match=message):
            read(tmp_path / name)


@POSIX
def test_scenes_of_a_folder_are_listed_if_they_can_be_opened(tmp_path: Path) -> None:
    hidden = (".hidden.toml", "c.txt", "c:a.toml", "a\\b.toml", "a\nb.toml")
    for name in ("b.toml", "a.toml", "<.toml", *hidden):
        (tmp_path / name).write_text("")
    (tmp_path / "d.toml").mkdir()
    assert scenes(tmp_path) == ("<.toml", "a.toml", "b.toml")
    assert all(read(place(tmp_path, name))[0] == "" for name in scenes(tmp_path))
    assert scenes(tmp_path / "none") == ()


def test_a_text_is_read_and_saved_byte_by_byte(cam: Path) -> None:
    before = cam.read_bytes()
    text, found = read(cam)
    assert text == "a = 1\r\n# ä\n"
    assert disk(found) == "same"
    again = saved(cam, text, found, force=False)
    assert cam.read_bytes() == before
    assert again.digest == found.digest


def test_a_change_on_disk_is_seen_and_not_overwritten(cam: Path) -> None:
    _, found = read(cam)
    cam.write_text("theirs")
    assert disk(found) == "changed"
    with pytest.raises(OverwriteError, match=r"cam\.toml has been changed on disk"):
        saved(cam, "mine", found, force=False)
    assert cam.read_text() == "theirs"
    assert disk(saved(cam, "mine", found, force=True)) == "same"
    assert cam.read_text() == "mine"


def test_a_change_within_the_same_tick_of_the_clock_is_not_overwritten(cam: Path) -> None:
    text, found = read(cam)
    times = cam.stat()
    cam.write_bytes(cam.read_bytes().replace(b"1", b"2"))
    os.utime(cam, ns=(times.st_atime_ns, times.st_mtime_ns))
    with pytest.raises(OverwriteError):
        saved(cam, text, found, force=False)


def test_a_file_written_anew_with_the_same_bytes_is_the_same(cam: Path) -> None:
    _, found = read(cam)
    data = cam.read_bytes()
    cam.unlink()
    assert disk(found) == "gone"
    cam.write_bytes(data)
    os.utime(cam, ns=(1, 1))
    assert disk(found) == "same"


def test_another_file_is_not_overwritten(tmp_path: Path, cam: Path) -> None:
    _, found = read(cam)
    other = tmp_path / "other.toml"
    other.write_text("theirs")
    with pytest.raises(OverwriteError, match=r"other\.toml exists already"):
        saved(other, "mine", found, force=False)
    saved(other, "theirs", found, force=False)  # nothing would change
    assert disk(saved(other, "mine", found, force=True)) == "same"


@pytest.mark.parametrize("text", ["\ud800", "#" * (SCENE.size + 1)])
def test_a_text_that_is_none_or_too_large_is_not_saved(cam: Path, text: str) -> None:
    before = cam.read_bytes()
    with pytest.raises(FileError):
        saved(cam, text, None, force=True)
    assert cam.read_bytes() == before


@POSIX
def test_a_private_file_stays_private(cam: Path) -> None:
    cam.chmod(0o600)
    saved(cam, "mine", None, force=True)
    assert stat.S_IMODE(cam.stat().st_mode) == 0o600


def test_a_folder_that_is_not_there_is_told(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(CamgeoError):
        saved(tmp_path / "file" / "cam.toml", "text", None, force=False)
