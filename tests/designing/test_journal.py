"""Journals: the history comes back from whatever is left of one, and never one that was not."""

from __future__ import annotations

import os
import stat
import sys
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.app.designing import desk
from camgeo.app.designing.desk import (
    History,
    Journal,
    JournalContent,
    change,
    read_journal,
    state_folder,
)
from camgeo.errors import FileError

FILE = "/scenes/cam.toml"

POSIX = pytest.mark.skipif(sys.platform == "win32", reason="permissions and links of POSIX")


def left(found: Journal) -> JournalContent:
    assert found.content is not None
    return found.content


def edited(folder: Path, *texts: str, start: str = "a") -> History:
    """A journal in which these texts were written, and which was not closed."""
    own = Journal.opened(FILE, folder)
    history = History(start)
    for text in texts:
        event = change(history.text, text, f"to {text}")
        history = history.changed(text, f"to {text}")
        own.add(history, event, "saved")
    release(own)
    return history


def release(own: Journal) -> None:
    """What the system does when a process is killed: only the lock and the file are closed."""
    for each in (own._lock, own._stream):
        if each is not None:
            os.close(each)
    own._lock = own._stream = None


def place(folder: Path) -> Path:
    (found,) = folder.glob("*.journal")
    return found


@given(st.lists(st.sampled_from(["undo", "redo", "a", "ab\n", "äb", "b\r\n", "c", "drag"])))
def test_a_history_comes_back_as_it_was(events: list[str]) -> None:
    history = History("start")
    lines = [desk._line({"journal": 1, "file": FILE, "text": "start", "saved": ""})]
    for number, event in enumerate(events):
        if event == "undo":
            history, line = history.undone(), {"do": "undo"}
        elif event == "redo":
            history, line = history.redone(), {"do": "redo"}
        else:
            gesture = "drag" if event == "drag" else ""
            text = f"{history.text}{number}" if gesture else event
            line = change(history.text, text, event, gesture)
            history = history.changed(text, event, gesture)
        lines.append(desk._line(line))
    assert read_journal(b"".join(lines), FILE) == JournalContent(history, "")
    anew = read_journal(b"".join(desk._lines(FILE, history, "")), FILE)
    assert (anew.damage, anew.saved) == ("", "")
    assert anew.history is not None
    assert anew.history.text == history.text
    assert [step.label for step in anew.history.past] == [step.label for step in history.past]
    assert anew.history.future == history.future


def test_a_journal_is_of_one_file(tmp_path: Path) -> None:
    edited(tmp_path, "b")
    assert Journal.opened("/scenes/other.toml", tmp_path).content is None
    assert "to another file" in read_journal(place(tmp_path).read_bytes(), "/scenes/x.toml").damage


def test_it_is_written_anew_when_it_has_grown(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(desk, "SPARE", 200)
    monkeypatch.setattr("camgeo.app.designing.desk.MOST_STEPS", 3)
    history = edited(tmp_path, *map(str, range(100)))
    assert place(tmp_path).stat().st_size < 2000
    assert left(Journal.opened(FILE, tmp_path)).history == history


@pytest.mark.parametrize("cut", [1, 7, 40, 60])
def test_a_journal_that_was_cut_off_gives_what_is_whole(tmp_path: Path, cut: int) -> None:
    edited(tmp_path, "b", "c")
    path = place(tmp_path)
    path.write_bytes(path.read_bytes()[:-cut])
    found = Journal.opened(FILE, tmp_path)
    history = left(found).history
    assert history is not None
    assert history.text == "b"
    assert "line 3 is damaged" in left(found).damage
    assert [each.suffix for each in sorted(tmp_path.iterdir())] == [".damaged", ".lock"]


@pytest.mark.parametrize(
    "data", [b"", b"\0" * 100, b"nonsense\n", b"00000000 {}\n", b"[" * 100_000, b"\xff" * 50]
)
def test_a_journal_that_is_none_is_told_and_set_aside(tmp_path: Path, data: bytes) -> None:
    edited(tmp_path, "b")
    place(tmp_path).write_bytes(data)
    found = Journal.opened(FILE, tmp_path)
    assert left(found).history is None
    assert left(found).damage
    assert not found.fault
    history = History("a").changed("z", "later")
    found.add(history, change("a", "z", "later"), "")
    found.close(keep=True)
    assert left(Journal.opened(FILE, tmp_path)).history == history


@given(st.data())
def test_a_changed_byte_never_gives_a_text_that_never_was(data: st.DataObject) -> None:
    texts = ["one", "one two", "two"]
    history = History("start")
    for text in texts:
        history = history.changed(text, text)
    whole = b"".join(desk._lines(FILE, history, ""))
    at = data.draw(st.integers(0, len(whole) - 1))
    byte = data.draw(st.integers(0, 255).filter(lambda found: found != whole[at]))
    found = read_journal(whole[:at] + bytes([byte]) + whole[at + 1 :], FILE)
    assert found.damage
    assert found.history is None or found.history.text in ("start", *texts)


def test_a_file_is_edited_by_one_process(tmp_path: Path) -> None:
    own = Journal.opened(FILE, tmp_path)
    with pytest.raises(FileError, match="open in another designer"):
        Journal.opened(FILE, tmp_path)
    own.close(keep=False)
    Journal.opened(FILE, tmp_path).close(keep=False)


@POSIX
def test_journals_are_for_their_user_alone(tmp_path: Path) -> None:
    folder = tmp_path / "states" / "designer"
    edited(folder, "b")
    assert stat.S_IMODE(place(folder).stat().st_mode) == 0o600
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700


@POSIX
def test_a_link_in_place_of_a_journal_is_not_followed(tmp_path: Path) -> None:
    edited(tmp_path / "states", "b")
    path = place(tmp_path / "states")
    target = tmp_path / "mine"
    path.rename(target)
    path.symlink_to(target)
    before = target.read_bytes()
    found = Journal.opened(FILE, tmp_path / "states")
    assert found.content is None
    assert "unsaved edits are not kept" in found.fault
    found.add(History("a").changed("z", "z"), change("a", "z", "z"), "")
    assert target.read_bytes() == before


def test_a_folder_that_cannot_be_made_is_told(tmp_path: Path) -> None:
    (tmp_path / "states").write_text("a file")
    found = Journal.opened(FILE, tmp_path / "states")
    assert "unsaved edits are not kept on disk" in found.fault
    found.add(History("b"), {"do": "undo"}, "")
    found.sync()
    found.close(keep=True)


def test_a_disk_that_takes_no_more_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    own = Journal.opened(FILE, tmp_path)
    history = History("a").changed("b", "b")
    own.add(history, change("a", "b", "b"), "")

    def full(*_: object) -> int:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.write", full)
    own.add(history.undone(), {"do": "undo"}, "")
    assert own.fault == "unsaved edits are not kept on disk: No space left on device"


@pytest.mark.skipif(sys.platform in ("win32", "darwin"), reason="the folders of XDG")
def test_the_folder_is_that_of_the_user(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    assert state_folder() == tmp_path / "camgeo" / "designer"
    monkeypatch.setenv("XDG_STATE_HOME", "relative")
    monkeypatch.setenv("HOME", "/home/someone")
    assert state_folder() == Path("/home/someone/.local/state/camgeo/designer")
