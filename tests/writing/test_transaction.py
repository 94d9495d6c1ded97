"""A set of files is written completely or not at all."""

from __future__ import annotations

import errno
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from camgeo.errors import OutputError
from camgeo.writing import transaction
from camgeo.writing.transaction import write_set

FILES = {"a.dxf": b"new a", "b.ngc": b"new b", "c.stl": b"new c"}


def _everything(folder: Path) -> dict[str, bytes]:
    """All files below a folder, hidden ones too."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def _fails_at(number: int, original: Callable[..., Any], error: BaseException) -> Any:
    """`original`, but its call `number`, counted from 1, raises once."""
    calls = 0

    def failing(*arguments: Any) -> Any:
        nonlocal calls
        calls += 1
        if calls == number:
            raise error
        return original(*arguments)

    return failing


def test_writes_into_a_new_folder(tmp_path: Path) -> None:
    folder = tmp_path / "not" / "there"
    paths = write_set(folder, FILES, force=False)
    assert paths == tuple(folder / name for name in FILES)
    assert _everything(tmp_path) == {f"not/there/{name}": data for name, data in FILES.items()}


def test_same_content_is_accepted(tmp_path: Path) -> None:
    write_set(tmp_path, FILES, force=False)
    write_set(tmp_path, FILES, force=False)
    assert _everything(tmp_path) == FILES


def test_other_files_are_left_alone(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_bytes(b"mine")
    write_set(tmp_path, FILES, force=False)
    assert _everything(tmp_path) == FILES | {"notes.txt": b"mine"}


def test_differing_file_is_kept_unless_forced(tmp_path: Path) -> None:
    (tmp_path / "b.ngc").write_bytes(b"old b")
    with pytest.raises(OutputError, match=r"b\.ngc would be overwritten; allow it with --force"):
        write_set(tmp_path, FILES, force=False)
    assert _everything(tmp_path) == {"b.ngc": b"old b"}
    write_set(tmp_path, FILES, force=True)
    assert _everything(tmp_path) == FILES


@pytest.mark.parametrize("error", [OSError(errno.ENOSPC, "No space left on device"),
                                   KeyboardInterrupt(), MemoryError()])  # fmt: skip
@pytest.mark.parametrize("number", [1, 2, 3])
@pytest.mark.parametrize("existing", [False, True])
def test_failing_write_leaves_nothing(
    number: int, existing: bool, error: BaseException, tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    folder = tmp_path / "out"
    before = {}
    if existing:
        folder.mkdir()
        before = {"out/a.dxf": b"old a", "out/c.stl": b"old c"}
        for name, data in before.items():
            (tmp_path / name).write_bytes(data)
    failing = _fails_at(number, transaction._write_durably, error)
    monkeypatch.setattr(transaction, "_write_durably", failing)
    expected = OutputError if isinstance(error, OSError) else type(error)
    with pytest.raises(expected) as caught:
        write_set(folder, FILES, force=True)
    if isinstance(error, OSError):
        assert "No space left on device; nothing was written" in str(caught.value)
    assert _everything(tmp_path) == before
    assert folder.exists() == existing


@pytest.mark.parametrize("error", [OSError(errno.EIO, "Input/output error"), KeyboardInterrupt()])
@pytest.mark.parametrize("number", range(1, 6))
def test_failing_move_puts_everything_back(
    number: int, error: BaseException, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Moves: a aside, a in, b in, c aside, c in."""
    before = {"a.dxf": b"old a", "c.stl": b"old c"}
    for name, data in before.items():
        (tmp_path / name).write_bytes(data)
    monkeypatch.setattr(os, "replace", _fails_at(number, os.replace, error))
    with pytest.raises(OutputError if isinstance(error, OSError) else KeyboardInterrupt):
        write_set(tmp_path, FILES, force=True)
    assert _everything(tmp_path) == before


def test_interrupt_right_after_a_move(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The signal may come when the move has been made already."""
    (tmp_path / "a.dxf").write_bytes(b"old a")
    original = os.replace
    calls = 0

    def moved_then_interrupted(source: Any, target: Any) -> None:
        nonlocal calls
        original(source, target)
        calls += 1
        if calls in wanted:
            raise KeyboardInterrupt

    monkeypatch.setattr(os, "replace", moved_then_interrupted)
    for number in range(1, 5):
        calls, wanted = 0, {number}
        with pytest.raises(KeyboardInterrupt):
            write_set(tmp_path, FILES, force=True)
        assert _everything(tmp_path) == {"a.dxf": b"old a"}


def test_folder_that_is_a_file(tmp_path: Path) -> None:
    place = tmp_path / "taken"
    place.write_bytes(b"mine")
    with pytest.raises(OutputError, match="is a file, not a folder; nothing was written"):
        write_set(place, FILES, force=True)
    with pytest.raises(OutputError, match=r"nothing was written"):
        write_set(place / "below", FILES, force=True)
    assert _everything(tmp_path) == {"taken": b"mine"}


def test_target_that_is_a_folder(tmp_path: Path) -> None:
    (tmp_path / "b.ngc").mkdir()
    with pytest.raises(OutputError, match=r"b\.ngc: is a folder"):
        write_set(tmp_path, FILES, force=True)
    assert _everything(tmp_path) == {}


@pytest.mark.skipif(not Path("/proc/self").is_dir(), reason="no /proc")
def test_folder_in_which_no_one_may_write() -> None:
    """In /proc not even root can make a file."""
    with pytest.raises(OutputError, match="nothing was written"):
        write_set(Path("/proc"), FILES, force=False)
    with pytest.raises(OutputError, match="cannot create the folder"):
        write_set(Path("/proc/camgeo-test"), FILES, force=False)


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root may write all")
def test_read_only_folder(tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    try:
        with pytest.raises(OutputError, match="Permission denied; nothing was written"):
            write_set(tmp_path, FILES, force=False)
    finally:
        tmp_path.chmod(0o700)
    assert _everything(tmp_path) == {}
