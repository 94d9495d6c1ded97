"""What is edited: nothing that was changed is lost, and nothing saved is overwritten unasked."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from camgeo.app.designing.desk import Desk, OverwriteError
from camgeo.errors import FileError


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    found = tmp_path / "scenes"
    found.mkdir()
    (found / "cam.toml").write_bytes(b"a = 1\n")
    (found / "other.toml").write_bytes(b"b = 2\n")
    return found


@pytest.fixture
def states(tmp_path: Path) -> Path:
    return tmp_path / "states"


@pytest.fixture
def desk(folder: Path, states: Path) -> Iterator[Desk]:
    found = Desk(folder, states)
    found.open("cam.toml")
    yield found
    found.close()


def kill(desk: Desk) -> None:
    """What the system does when the process is killed."""
    assert desk._journal is not None
    for each in (desk._journal._lock, desk._journal._stream):
        if each is not None:
            os.close(each)
    desk._journal = None


def again(folder: Path, states: Path, name: str | None = "cam.toml") -> Desk:
    found = Desk(folder, states)
    if name is None:
        found.begin()
    else:
        found.open(name)
    return found


def test_a_scene_is_changed_undone_and_saved(desk: Desk, folder: Path, states: Path) -> None:
    assert (desk.name, desk.text, desk.saved) == ("cam.toml", "a = 1\n", True)
    desk.change("a = 3\n", "a 3")
    assert (desk.saved, desk.history.undo) == (False, "a 3")
    desk.undo()
    assert (desk.saved, desk.history.redo) == (True, "a 3")
    desk.redo()
    desk.save()
    assert (folder / "cam.toml").read_bytes() == b"a = 3\n"
    assert desk.saved
    desk.undo()
    assert (desk.text, desk.saved) == ("a = 1\n", False)
    desk.redo()
    desk.close()
    assert list(states.iterdir()) == []
    assert desk.take_messages() == []


def test_edits_survive_a_kill_with_their_history(desk: Desk, folder: Path, states: Path) -> None:
    desk.change("a = 3\n", "a 3")
    desk.change("a = 4\n", "a 4")
    desk.undo()
    kill(desk)
    found = again(folder, states)
    assert (folder / "cam.toml").read_bytes() == b"a = 1\n"
    assert (found.text, found.history.undo, found.history.redo) == ("a = 3\n", "a 3", "a 4")
    (told,) = found.take_messages()
    assert told.startswith("unsaved edits of cam.toml have been restored")
    found.save()
    found.close()
    assert (folder / "cam.toml").read_bytes() == b"a = 3\n"
    assert list(states.iterdir()) == []


def test_a_kill_after_saving_leaves_nothing_to_restore(
    desk: Desk, folder: Path, states: Path
) -> None:
    desk.change("a = 3\n", "a 3")
    desk.save()
    kill(desk)
    found = again(folder, states)
    assert (found.text, found.saved, found.take_messages()) == ("a = 3\n", True, [])
    assert found.disk == "same"
    found.close()


def test_a_file_that_changed_after_the_edits_is_told(
    desk: Desk, folder: Path, states: Path
) -> None:
    desk.change("a = 3\n", "a 3")
    kill(desk)
    (folder / "cam.toml").write_bytes(b"a = 9\n")
    found = again(folder, states)
    assert (found.text, found.disk, found.saved) == ("a = 3\n", "changed", False)
    assert "changed on disk since" in found.take_messages()[1]
    with pytest.raises(OverwriteError):
        found.save()
    found.reload()
    assert (found.text, found.saved, found.disk) == ("a = 9\n", True, "same")
    found.undo()
    assert (found.text, found.saved) == ("a = 3\n", False)
    found.close()


def test_edits_of_a_file_that_is_gone_are_restored(desk: Desk, folder: Path, states: Path) -> None:
    desk.change("a = 3\n", "a 3")
    kill(desk)
    (folder / "cam.toml").unlink()
    found = again(folder, states)
    assert (found.text, found.disk, found.saved) == ("a = 3\n", "gone", False)
    found.save()
    assert (folder / "cam.toml").read_bytes() == b"a = 3\n"
    found.close()


def test_edits_stay_when_another_scene_is_opened(desk: Desk) -> None:
    desk.change("a = 3\n", "a 3")
    desk.open("other.toml")
    assert (desk.text, desk.history.undo) == ("b = 2\n", None)
    assert desk.take_messages() == ["unsaved edits of cam.toml are kept until it is opened again"]
    desk.open("cam.toml")
    assert (desk.text, desk.history.undo) == ("a = 3\n", "a 3")


def test_a_scene_that_cannot_be_opened_changes_nothing(desk: Desk) -> None:
    desk.change("a = 3\n", "a 3")
    for name in ("none.toml", "../cam.toml"):
        with pytest.raises(FileError):
            desk.open(name)
    assert (desk.name, desk.text) == ("cam.toml", "a = 3\n")
    desk.undo()
    assert desk.saved


def test_it_is_saved_under_another_name_and_goes_on_there(desk: Desk, folder: Path) -> None:
    desk.change("a = 3\n", "a 3")
    with pytest.raises(OverwriteError, match=r"other\.toml exists already"):
        desk.save("other.toml")
    desk.save("new.toml")
    assert (desk.name, desk.saved) == ("new.toml", True)
    assert (folder / "cam.toml").read_bytes() == b"a = 1\n"
    desk.open("cam.toml")
    assert (desk.text, desk.saved) == ("a = 1\n", True)


def test_edits_of_another_file_are_not_overwritten(desk: Desk) -> None:
    desk.change("a = 3\n", "a 3")
    desk.open("other.toml")
    with pytest.raises(OverwriteError, match=r"cam\.toml has unsaved edits of its own"):
        desk.save("cam.toml")
    assert desk.name == "other.toml"
    desk.save("cam.toml", force=True)
    assert (desk.name, desk.text) == ("cam.toml", "b = 2\n")


def test_a_new_scene_is_kept_until_it_has_a_name(folder: Path, states: Path) -> None:
    desk = again(folder, states, None)
    assert (desk.name, desk.text, desk.saved, desk.disk) == (None, "", True, "same")
    desk.change("c = 1\n", "new")
    with pytest.raises(FileError, match="needs a name"):
        desk.save()
    kill(desk)
    found = again(folder, states, None)
    assert (found.text, found.saved) == ("c = 1\n", False)
    found.save("sub/new.toml")
    assert (folder / "sub" / "new.toml").read_bytes() == b"c = 1\n"
    assert (found.name, found.saved) == ("sub/new.toml", True)
    found.close()
    assert list(states.iterdir()) == []


def test_a_damaged_journal_is_told_and_designing_goes_on(
    desk: Desk, folder: Path, states: Path
) -> None:
    desk.change("a = 3\n", "a 3")
    kill(desk)
    (path,) = states.glob("*.journal")
    path.write_bytes(b"damaged")
    found = again(folder, states)
    assert (found.text, found.saved) == ("a = 1\n", True)
    (told,) = found.take_messages()
    assert told.startswith("the journal of cam.toml is damaged, edits may be lost: line 1")
    found.change("a = 4\n", "a 4")
    kill(found)
    assert again(folder, states).text == "a = 4\n"
