"""A set is whole, whenever the process is stopped and whatever the disk refuses;
`python -m tests.kill` stops processes at random.
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
from collections.abc import Iterator
from pathlib import Path

import pytest

from camgeo.app.cli.main import Stopped
from camgeo.design.writing import settle, write_set
from camgeo.errors import OutputError
from tests.kill.everywhere import BUILDS, BUILT
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
        said = settle(folder)
        assert ("put back" in said) == ("put back" in str(error))
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
    command = [sys.executable, "-m", "tests.kill.everywhere"]
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
