"""A set of files is written completely or not at all, whenever the process is stopped and whatever
the disk refuses.
"""

from __future__ import annotations

import errno
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import pytest

from camgeo.app.cli.main import Stopped
from camgeo.design import writing
from camgeo.design.writing import (
    JOURNAL,
    NEW,
    OLD,
    STAGING,
    make_files,
    settle,
    write_files,
    write_set,
)
from camgeo.errors import OutputError
from tests.export.stub_product import StubProduct
from tests.kill.__main__ import BUILDS, BUILT
from tests.kill.stops import (
    BEFORE,
    FURTHER,
    MEMORY,
    SIGNALS,
    WRITTEN,
    Files,
    Killed,
    Steps,
    everything,
    full_after,
    is_safe,
    is_whole,
    put,
    stepping,
)
from tests.long_form import LONG
from tests.waiting import PATIENCE, joined, until

FILES = {"a.dxf": b"new a", "b.ngc": b"new b", "c.stl": b"new c"}


def refusal(folder: Path, files: dict[str, bytes] = FILES, *, force: bool = True) -> str:
    """Why files cannot be written."""
    with pytest.raises(OutputError) as caught:
        write_set(folder, files, force=force)
    return str(caught.value)


@pytest.mark.parametrize(
    ("before", "force", "message"),
    [
        ({}, False, ""),
        (FILES, False, ""),
        ({"notes.txt": b"mine"}, False, ""),
        ({"b.ngc": b"old b"}, False, "b.ngc would be overwritten; allow it with --force"),
        ({"b.ngc": b"old b"}, True, ""),
    ],
)
def test_a_set_is_written_beside_what_is_there(
    before: dict[str, bytes], force: bool, message: str, tmp_path: Path
) -> None:
    """Into a new folder too; what differs is kept unless it is forced."""
    folder = tmp_path / "not" / "there"
    if before:
        put(folder, before)
    if message:
        assert message in refusal(folder, force=force)
        assert everything(folder) == before
        return
    assert write_set(folder, FILES, force=force) == tuple(folder / name for name in FILES)
    assert everything(folder) == before | FILES


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
    assert told == ["account.json of the previous files was removed"]


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


# In which order a set is put on disk: each step is safe before the next ---------------------------


OLD_SET, NEW_SET = ({name: f"{name} {age}".encode() for name in ("a", "b", "certificate")}
            for age in ("old", "new"))  # fmt: skip

Done = list[tuple[str, str]]
"""What was done to which file or folder, below that of the set."""


@pytest.fixture
def steps(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Done:
    """Of what moves, removes or makes safe anything below the folder of the test."""
    found: Done = []

    def named(path: object) -> str:
        return os.path.relpath(str(path), tmp_path / "set")

    fsync, replaced, unlink = os.fsync, Path.replace, Path.unlink

    def syncing(file: int) -> None:
        found.append(("safe", named(Path(f"/proc/self/fd/{file}").readlink())))
        fsync(file)

    def replacing(self: Path, target: Any) -> Path:
        found.append(("move", named(target)))
        return replaced(self, target)

    def unlinking(self: Path, *, missing_ok: bool = False) -> None:
        found.append(("remove", named(self)))
        unlink(self, missing_ok=missing_ok)

    monkeypatch.setattr(os, "fsync", syncing)
    monkeypatch.setattr(Path, "replace", replacing)
    monkeypatch.setattr(Path, "unlink", unlinking)
    return found


linux = pytest.mark.skipif(sys.platform != "linux", reason="tells files by /proc")


@linux
def test_each_step_is_on_disk_before_the_next_one(tmp_path: Path, steps: Done) -> None:
    folder = tmp_path / "set"
    write_set(folder, OLD_SET, force=False)
    steps.clear()
    write_set(folder, NEW_SET, force=True)
    journal, new = f"{STAGING}/journal", f"{STAGING}/new"
    names = [f"{new}/{name}" for name in NEW_SET]
    counts = steps.index(("move", journal))
    staged = [path for what, path in steps[:counts] if what == "safe"]
    assert set(staged) == {*names, new, f"{STAGING}/old", f"{STAGING}/names"}
    assert staged.index(new) > max(map(staged.index, names))
    assert staged[-1] == f"{STAGING}/names"
    # What counts, the journal, is safe before anything is touched; the certificate goes first.
    assert steps[counts + 1 : counts + 11] == [
        ("safe", STAGING), ("safe", "."),
        ("remove", "certificate"), ("safe", "."),
        ("move", "a"), ("move", "b"), ("safe", "."),
        ("move", "certificate"), ("safe", "."),
        ("remove", journal),
    ]  # fmt: skip
    assert {name: (folder / name).read_bytes() for name in NEW_SET} == NEW_SET
    assert not (folder / STAGING).exists()


@linux
def test_what_is_taken_back_is_on_disk_before_the_next_step(
    tmp_path: Path, steps: Done, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Stopped when the certificate was to be moved; the next run puts the old files back."""
    folder = tmp_path / "set"
    write_set(folder, OLD_SET, force=False)
    moving = Path.replace

    def stopping(self: Path, target: Any) -> Path:
        if Path(target) == folder / "certificate":
            raise KeyboardInterrupt
        return moving(self, target)

    with monkeypatch.context() as patch:
        patch.setattr(Path, "replace", stopping)
        patch.setattr("camgeo.design.writing._restore", lambda _: "")
        with pytest.raises(KeyboardInterrupt):
            write_set(folder, NEW_SET, force=True)
    steps.clear()
    assert "the files from before it have been put back" in settle(folder)
    back = [each for each in steps if each[0] != "remove" or "journal" in each[1]]
    assert back == [
        ("move", f"{STAGING}/new/b"), ("move", f"{STAGING}/new/a"), ("safe", "."),
        ("move", "a"), ("move", "b"), ("move", "certificate"), ("safe", "."),
        ("remove", f"{STAGING}/journal"),
    ]  # fmt: skip
    assert {name: (folder / name).read_bytes() for name in OLD_SET} == OLD_SET


def test_nothing_is_overwritten_unless_it_is_asked_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    written = Mock(return_value=(Path("a"),))
    monkeypatch.setattr("camgeo.design.writing.write_set", written)
    monkeypatch.setattr("camgeo.design.writing.make_files", lambda *_, **__: ({"a": b""}, ()))
    write_files((StubProduct(),), tmp_path, ("dxf",), 0.01)
    write_files((StubProduct(),), tmp_path, ("dxf",), 0.01, force=True)
    assert [each.kwargs["force"] for each in written.call_args_list] == [False, True]


def test_progress_tells_each_file_twice() -> None:
    """As it is computed and as it is read back, with the disc where that is not the main one."""
    import camgeo
    from tests.contour.cams import SCENES

    said: list[str] = []
    discs = camgeo.load(SCENES / "conjugate_carriage.toml").discs
    make_files(discs, ("csv",), 0.05, progress=said.append)
    assert said == [
        "csv: computing", "csv: reading back",
        "csv of conjugate_carriage-return: computing",
        "csv of conjugate_carriage-return: reading back",
    ]  # fmt: skip


# Processes that are stopped, and disks that fail, at every step -----------------------------------


VERIFICATION = "verification.json"

FOLDERS = {"fresh": {}, "full": BEFORE, "verified": BEFORE | {VERIFICATION: b"of the files before"}}


def after(old: Files, files: Files = WRITTEN) -> Files:
    """The state after writing `files` into a folder with `old`."""
    return {name: data for name, data in (old | files).items() if name != VERIFICATION}


def write(folder: Path, files: Files = WRITTEN) -> None:
    write_set(folder, files, force=True, accounts={VERIFICATION: Path.exists})


@pytest.fixture(autouse=True)
def quick_disk(monkeypatch: pytest.MonkeyPatch) -> None:
    """These processes never really end: what they write need not wait for the disk."""
    monkeypatch.setattr(os, "fsync", lambda _: None)


@pytest.fixture
def folder() -> Iterator[Path]:
    """A folder to write into, in memory if there is such a place."""
    with tempfile.TemporaryDirectory(dir=MEMORY) as place:
        yield Path(place) / "out"


Folder = pytest.mark.parametrize("old", FOLDERS.values(), ids=FOLDERS)


def stops(folder: Path, old: Files, steps: Iterator[Steps]) -> Iterator[BaseException]:
    """What `write_set` into a folder with `old` ends with, for each of `steps`, until it ends well.

    The caller looks at the folder between the runs.
    """
    for each in steps:
        shutil.rmtree(folder, ignore_errors=True)
        put(folder, old)
        try:
            with stepping(each):
                write(folder)
        except (OSError, Killed, Stopped) as error:
            yield error
        else:
            if each.done < each.number:
                return


def counted(error: BaseException, **options: bool) -> Iterator[Steps]:
    return (Steps(number, error, **options) for number in range(1, 200))


@Folder
@pytest.mark.parametrize("done", [False, True])
def test_killed_at_every_step(old: Files, done: bool, folder: Path) -> None:
    kills = 0
    for _ in stops(folder, old, counted(Killed(), after=done, forever=True)):
        kills += 1
        assert is_safe(folder, old, after(old))
        settle(folder)
        assert is_whole(folder, old, after(old))
    assert kills > 20


def test_restoring_killed_at_every_step(folder: Path) -> None:
    """Wherever the first process was killed, the one that restores may be killed, too."""
    left, old = folder.with_name("left"), FOLDERS["verified"]
    new = after(old)
    for _ in stops(folder, old, counted(Killed(), forever=True)):
        shutil.rmtree(left, ignore_errors=True)
        shutil.copytree(folder, left)
        settle(folder)
        found = everything(folder)
        for steps in counted(Killed(), forever=True):
            shutil.rmtree(folder)
            shutil.copytree(left, folder)
            try:
                with stepping(steps):
                    settle(folder)
            except Killed:
                assert is_safe(folder, old, new)
                write(folder, FURTHER)
                assert is_whole(folder, after(found, FURTHER))
            else:
                break


@Folder
@pytest.mark.parametrize("done", [False, True])
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_stopped_at_every_step(number: int, done: bool, old: Files, folder: Path) -> None:
    """A signal that is handled leaves nothing to the next run."""
    stopped = 0
    for error in stops(folder, old, counted(Stopped(number), after=done)):
        stopped += 1
        assert isinstance(error, Stopped)
        assert is_whole(folder, old, after(old))
    assert stopped > 20


@Folder
def test_each_step_refused(old: Files, folder: Path) -> None:
    """The error is reported and nothing has changed, or else, late, everything is in place."""
    refused = 0
    for error in stops(folder, old, counted(OSError(errno.EACCES, "Permission denied"))):
        refused += 1
        assert isinstance(error, OutputError)
        assert "Permission denied; nothing was written" in str(error)
        assert is_whole(folder, old)
    assert refused > 20


@Folder
def test_each_step_and_all_later_ones_refused(old: Files, folder: Path) -> None:
    """As if the disk were gone: the next run restores, and the message says so."""
    failing = counted(OSError(errno.EIO, "Input/output error"), forever=True)
    told = set()
    for error in stops(folder, old, failing):
        assert is_safe(folder, old, after(old))
        told.add(str(error).rpartition("; ")[2])
        assert ("put back" in settle(folder)) == ("put back" in str(error))
        assert is_whole(folder, old, after(old))
    assert len(told) == 2


@Folder
def test_full_disk(old: Files, folder: Path) -> None:
    """At every file, and at a hundred numbers of bytes."""
    source = random.Random(7)
    most = sum(map(len, WRITTEN.values()))
    ends = [sum(map(len, list(WRITTEN.values())[:count])) for count in range(len(WRITTEN))]
    for room in [*ends, *(source.randrange(most) for _ in range(100))]:
        put(folder, old)
        with full_after(room), pytest.raises(OutputError, match="No space left on device; nothing"):
            write(folder)
        assert is_whole(folder, old)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes are forked")
def test_processes_stopped_at_every_step() -> None:
    """Forked where nothing but the test runs: a process with threads should not be."""
    command = [sys.executable, "-m", "tests.kill", "--everywhere"]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert run.returncode == 0, f"{run.stdout}\n{run.stderr}"
    told = json.loads(run.stdout)
    steps = told["alone, SIGKILL"]
    assert steps > 40
    caught = [told[f"alone, {number.name}"] for number in SIGNALS[1:]]
    assert caught == [steps] * 3 if LONG else sum(caught) == steps
    for number in SIGNALS:
        assert told[f"beside, {number.name}"] > (20 if LONG else 5)
    assert [told[f"builds, {number.name}"] for number in BUILT] == [BUILDS] * len(BUILT)
