"""A set of files is written completely or not at all."""

from __future__ import annotations

import errno
import os
import threading
from pathlib import Path

import pytest

from camgeo.design import writing
from camgeo.design.writing import JOURNAL, NEW, OLD, STAGING, settle, write_set
from camgeo.errors import OutputError
from tests.kill.sets import everything
from tests.waiting import PATIENCE, joined, until

FILES = {"a.dxf": b"new a", "b.ngc": b"new b", "c.stl": b"new c"}


def refusal(folder: Path, files: dict[str, bytes] = FILES, *, force: bool = True) -> str:
    """Why files cannot be written."""
    with pytest.raises(OutputError) as caught:
        write_set(folder, files, force=force)
    return str(caught.value)


def test_writes_into_a_new_folder(tmp_path: Path) -> None:
    folder = tmp_path / "not" / "there"
    paths = write_set(folder, FILES, force=False)
    assert paths == tuple(folder / name for name in FILES)
    assert everything(tmp_path) == {f"not/there/{name}": data for name, data in FILES.items()}


def test_same_content_is_accepted(tmp_path: Path) -> None:
    write_set(tmp_path, FILES, force=False)
    write_set(tmp_path, FILES, force=False)
    assert everything(tmp_path) == FILES


def test_what_speaks_of_other_files_is_removed_with_them(tmp_path: Path) -> None:
    """Unless nothing changes, or it is something else of that name."""
    told: list[str] = []

    def write(content: bytes, *, ours: bool = True) -> list[str]:
        write_set(
            tmp_path, FILES | {"a.dxf": content}, force=True, progress=told.append,
            accounts={"account.json": lambda path: ours and path.exists()},
        )  # fmt: skip
        return sorted(path.name for path in tmp_path.iterdir())

    write(b"1")
    (tmp_path / "account.json").write_bytes(b"of 1")
    with_account = ["account.json", *FILES]
    assert write(b"1") == sorted(with_account)
    assert write(b"2", ours=False) == sorted(with_account)
    assert told == []
    assert write(b"3") == sorted(FILES)
    assert told == ["account.json of the files before: removed"]


def test_other_files_are_left_alone(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_bytes(b"mine")
    write_set(tmp_path, FILES, force=False)
    assert everything(tmp_path) == FILES | {"notes.txt": b"mine"}


def test_differing_file_is_kept_unless_forced(tmp_path: Path) -> None:
    (tmp_path / "b.ngc").write_bytes(b"old b")
    assert "b.ngc would be overwritten; allow it with --force" in refusal(tmp_path, force=False)
    assert everything(tmp_path) == {"b.ngc": b"old b"}
    write_set(tmp_path, FILES, force=True)
    assert everything(tmp_path) == FILES


def test_a_link_to_nothing_is_not_overwritten(tmp_path: Path) -> None:
    (tmp_path / "a.dxf").symlink_to("nowhere")
    assert "a.dxf would be overwritten" in refusal(tmp_path, force=False)
    assert (tmp_path / "a.dxf").is_symlink()
    write_set(tmp_path, FILES, force=True)
    assert everything(tmp_path) == FILES
    assert not (tmp_path / "a.dxf").is_symlink()


@pytest.mark.skipif(not Path(os.devnull).is_char_device(), reason="no devices")
def test_a_device_is_no_file() -> None:
    null = Path(os.devnull)
    assert "is not a regular file; nothing was written" in refusal(null.parent, {null.name: b"new"})
    assert null.is_char_device()


@pytest.mark.parametrize("length", [256, 5000])
def test_names_that_are_too_long(length: int, tmp_path: Path) -> None:
    name, told = "a" * length, f"{os.strerror(errno.ENAMETOOLONG)}; nothing was written"
    assert told in refusal(tmp_path, {name: b"new"})
    assert told in refusal(tmp_path / name)
    assert "; nothing was written" in refusal(tmp_path / "\0")
    assert not any(tmp_path.iterdir())


def test_a_parent_that_cannot_be_synchronised(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As with a folder that may be written but not read."""
    original = writing.sync

    def refused(path: Path) -> None:
        if path == tmp_path:
            raise PermissionError(errno.EACCES, "Permission denied", str(path))
        original(path)

    monkeypatch.setattr(writing, "sync", refused)
    write_set(tmp_path / "out", FILES, force=False)
    assert everything(tmp_path / "out") == FILES


# -- one at a time ---------------------------------------------------------------------------------


def test_another_writer_is_waited_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A thread is excluded like another process."""
    monkeypatch.setattr(writing, "PATIENCE", PATIENCE)
    messages: list[str] = []
    written = threading.Event()

    def write() -> None:
        write_set(tmp_path, FILES, force=False, progress=messages.append)
        written.set()

    with writing._locked(tmp_path, messages.append):
        (tmp_path / STAGING).mkdir()
        (tmp_path / STAGING / writing.WRITER).write_text("4711")
        with monkeypatch.context() as patch:
            patch.setattr(writing, "PATIENCE", 0.1)
            message = "process 4711 is writing there; nothing was written"
            assert message in refusal(tmp_path, force=False)
            with pytest.raises(OutputError, match=message):
                settle(tmp_path)
        thread = threading.Thread(target=write)
        thread.start()
        until("a writer that waits", lambda: messages)
        assert not written.is_set()
    joined(thread)
    assert set(messages) == {f"waiting for process 4711, which is writing into {tmp_path}"}
    assert everything(tmp_path) == FILES


# -- what an interrupted run leaves ----------------------------------------------------------------


def _interrupted(folder: Path, journal: str = '["a.dxf", "b.ngc"]') -> None:
    """As after a kill: a.dxf is new, b.ngc, the last one, has been removed."""
    for place in (NEW, OLD):
        (folder / STAGING / place).mkdir(parents=True)
    (folder / "a.dxf").write_bytes(b"new a")
    (folder / STAGING / NEW / "b.ngc").write_bytes(b"new b")
    for name in ("a.dxf", "b.ngc"):
        (folder / STAGING / OLD / name).write_bytes(b"old")
    (folder / STAGING / JOURNAL).write_text(journal)


def test_settle_restores_and_says_so(tmp_path: Path) -> None:
    assert settle(tmp_path) == settle(tmp_path / "none") == ""
    _interrupted(tmp_path)
    assert "interrupted here; the files from before it have been put back" in settle(tmp_path)
    assert everything(tmp_path) == {"a.dxf": b"old", "b.ngc": b"old"}
    assert settle(tmp_path) == ""
    (tmp_path / STAGING).mkdir()
    assert "interrupted here before it had replaced anything" in settle(tmp_path)
    assert everything(tmp_path) == {"a.dxf": b"old", "b.ngc": b"old"}


def test_what_the_user_put_there_meanwhile_is_kept(tmp_path: Path) -> None:
    _interrupted(tmp_path)
    (tmp_path / "b.ngc").write_bytes(b"mine")
    settle(tmp_path)
    assert everything(tmp_path) == {"a.dxf": b"old", "b.ngc": b"mine"}


def test_a_folder_in_the_way_is_kept(tmp_path: Path) -> None:
    _interrupted(tmp_path)
    (tmp_path / "a.dxf").unlink()
    (tmp_path / "a.dxf").mkdir()
    (tmp_path / "a.dxf" / "notes").write_bytes(b"mine")
    for _ in range(2):
        with pytest.raises(OutputError, match="cannot be put back: is a folder now"):
            settle(tmp_path)
        with pytest.raises(OutputError, match=r"cannot write a\.dxf: is a folder now.*put back"):
            write_set(tmp_path, FILES, force=True)
    (tmp_path / "a.dxf").rename(tmp_path / "elsewhere")
    settle(tmp_path)
    assert everything(tmp_path) == {
        "a.dxf": b"old", "b.ngc": b"old", "elsewhere/notes": b"mine",
    }  # fmt: skip


@pytest.mark.parametrize("journal", ["", "[1]", "{}", '["../a.dxf"]', '["/a.dxf"]', '["a'])
def test_a_damaged_journal_is_not_followed(journal: str, tmp_path: Path) -> None:
    folder = tmp_path / "out"
    _interrupted(folder, journal)
    (tmp_path / "a.dxf").write_bytes(b"mine")
    before = everything(tmp_path)
    with pytest.raises(OutputError, match=f"which are in {STAGING}, cannot be put back"):
        settle(folder)
    assert "put back by the next camgeo build or verify there" in refusal(folder)
    assert everything(tmp_path) == before


def test_a_link_in_place_of_the_staging_folder_is_not_followed(tmp_path: Path) -> None:
    folder, elsewhere = tmp_path / "out", tmp_path / "elsewhere"
    _interrupted(elsewhere)
    before = everything(elsewhere)
    folder.mkdir()
    (folder / STAGING).symlink_to(elsewhere / STAGING)
    assert settle(folder) == ""
    assert os.strerror(errno.EEXIST) in refusal(folder)
    assert everything(elsewhere) == before


def test_folder_that_is_a_file(tmp_path: Path) -> None:
    place = tmp_path / "taken"
    place.write_bytes(b"mine")
    assert "is a file, not a folder; nothing was written" in refusal(place)
    assert "nothing was written" in refusal(place / "below")
    assert everything(tmp_path) == {"taken": b"mine"}


def test_target_that_is_a_folder(tmp_path: Path) -> None:
    (tmp_path / "b.ngc").mkdir()
    assert "b.ngc: is a folder" in refusal(tmp_path)
    assert everything(tmp_path) == {}


@pytest.mark.skipif(not Path("/proc/self").is_dir(), reason="no /proc")
def test_folder_in_which_no_one_may_write() -> None:
    """In /proc not even root can make a file."""
    assert "nothing was written" in refusal(Path("/proc"), force=False)
    assert "cannot create the folder" in refusal(Path("/proc/camgeo-test"), force=False)


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root may write all")
def test_read_only_folder(tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    try:
        assert f"{os.strerror(errno.EACCES)}; nothing was written" in refusal(tmp_path, force=False)
    finally:
        tmp_path.chmod(0o700)
    assert everything(tmp_path) == {}
