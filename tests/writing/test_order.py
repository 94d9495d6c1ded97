"""In which order a set is put on disk, and what is told: each step is safe before the next."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Any

import pytest

from camgeo.design.writing import STAGING, make_files, settle, write_files, write_set
from tests.export.stub_product import StubProduct

OLD, NEW = ({name: f"{name} {age}".encode() for name in ("a", "b", "certificate")}
            for age in ("old", "new"))  # fmt: skip

Steps = list[tuple[str, str]]
"""What was done to which file or folder, below that of the set."""


@pytest.fixture
def steps(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Steps:
    """Of what moves, removes or makes safe anything below the folder of the test."""
    found: Steps = []

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
def test_each_step_is_on_disk_before_the_next_one(tmp_path: Path, steps: Steps) -> None:
    folder = tmp_path / "set"
    write_set(folder, OLD, force=False)
    steps.clear()
    write_set(folder, NEW, force=True)
    journal, new = f"{STAGING}/journal", f"{STAGING}/new"
    names = [f"{new}/{name}" for name in NEW]
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
    assert {name: (folder / name).read_bytes() for name in NEW} == NEW
    assert not (folder / STAGING).exists()


@linux
def test_what_is_taken_back_is_on_disk_before_the_next_step(
    tmp_path: Path, steps: Steps, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Stopped when the certificate was to be moved; the next run puts the old files back."""
    folder = tmp_path / "set"
    write_set(folder, OLD, force=False)
    moving = Path.replace

    def stopping(self: Path, target: Any) -> Path:
        if Path(target) == folder / "certificate":
            raise KeyboardInterrupt
        return moving(self, target)

    with monkeypatch.context() as patch:
        patch.setattr(Path, "replace", stopping)
        patch.setattr("camgeo.design.writing._restore", lambda _: "")
        with pytest.raises(KeyboardInterrupt):
            write_set(folder, NEW, force=True)
    steps.clear()
    assert "the files from before it have been put back" in settle(folder)
    back = [each for each in steps if each[0] != "remove" or "journal" in each[1]]
    assert back == [
        ("move", f"{STAGING}/new/b"), ("move", f"{STAGING}/new/a"), ("safe", "."),
        ("move", "a"), ("move", "b"), ("move", "certificate"), ("safe", "."),
        ("remove", f"{STAGING}/journal"),
    ]  # fmt: skip
    assert {name: (folder / name).read_bytes() for name in OLD} == OLD


def test_nothing_is_overwritten_unless_it_is_asked_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[bool] = []

    def written(_: Path, files: dict[str, bytes], *, force: bool, **__: Any) -> tuple[Path, ...]:
        asked.append(force)
        return tuple(map(Path, files))

    monkeypatch.setattr("camgeo.design.writing.write_set", written)
    monkeypatch.setattr("camgeo.design.writing.make_files", lambda *_, **__: ({"a": b""}, ()))
    write_files((StubProduct(),), tmp_path, ("dxf",), 0.01)
    write_files((StubProduct(),), tmp_path, ("dxf",), 0.01, force=True)
    assert asked == [False, True]


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
