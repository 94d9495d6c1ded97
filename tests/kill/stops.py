"""Small sets of files, and processes that are stopped, or whose disk fails, while writing them."""

from __future__ import annotations

import errno
import hashlib
import json
import os
import random
import signal
import traceback
from collections.abc import Callable, Generator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

import pytest

from camgeo.app.answers.answer import STOPPED
from camgeo.app.answers.verify import read_certificate
from camgeo.app.cli.main import Stopped, stop_on_signals
from camgeo.design import writing
from camgeo.design.writing import CERTIFICATE, STAGING, interrupted

# Sets of files with a certificate, and whether a folder holds one of them, whole ------------------


Files = dict[str, bytes]

MEMORY: Final = "/dev/shm" if Path("/dev/shm").is_dir() else None
"""A folder on no disk; None for the usual one."""


def stub_set(seed: int, names: tuple[str, ...], size: int = 500) -> Files:
    """Files of random bytes and a certificate of them, the last one."""
    source = random.Random(seed)
    files = {name: source.randbytes(size) for name in names}
    records = [
        {"file": name, "tolerance_mm": 0.001, "sha256": hashlib.sha256(data).hexdigest()}
        for name, data in files.items()
    ]
    document = {"scene": {"sha256": str(seed)}, "files": records}
    return files | {CERTIFICATE: json.dumps(document).encode()}


BEFORE: Final = stub_set(1, ("a.dxf", "b.ngc", "old.csv"))

WRITTEN: Final = stub_set(2, ("a.dxf", "b.ngc", "c.stl"))

FURTHER: Final = stub_set(3, ("a.dxf", "c.stl"))


def put(folder: Path, files: Files) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for name, data in files.items():
        (folder / name).write_bytes(data)


def everything(folder: Path) -> Files:
    """All files below a folder, hidden ones too."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def is_whole(folder: Path, *sets: Files) -> bool:
    """Whether one of `sets` is all that is there; no folder is the empty set."""
    return not (folder / STAGING).exists() and everything(folder) in sets


def is_safe(folder: Path, old: Files, new: Files) -> bool:
    """What must hold right after a stop: no file is torn, none lies under the certificate of
    another set, and a set that is not whole is called interrupted.

    `new` is the whole state after the run, with what it leaves alone.
    """
    seen = {
        path.name: path.read_bytes() for path in folder.glob("*") if path.is_file()
    }  # what is staged is nobody's file yet
    if any(data not in (old.get(name), new.get(name)) for name, data in seen.items()):
        return False
    if seen in (old, new):
        return True
    certificate = read_certificate(folder)
    said = certificate is not None and "interrupted" in certificate.damage
    return CERTIFICATE not in seen and interrupted(folder) and said


# Processes that are stopped by signals ------------------------------------------------------------


SIGNALS: Final = (signal.SIGKILL, signal.SIGTERM, signal.SIGHUP, signal.SIGINT)

SCENE: Final = Path(__file__).parents[2] / "fixtures" / "scenes" / "vorschub.toml"

BUILD: Final = ("build", str(SCENE), "--force", "--only", "csv,dxf", "-o")


class Fault(Exception):
    """A folder holds what it must not hold, or a process ended as it must not."""


def forked(work: Callable[[], object]) -> int:
    """Start a process that does `work`, and wait until it begins; return its number."""
    reading, writing = os.pipe()
    if (child := os.fork()) != 0:
        os.close(writing)
        os.read(reading, 1)
        os.close(reading)
        return child
    code = 1
    try:
        stop_on_signals()
        os.write(writing, b".")
        work()
        code = 0
    except Stopped as stop:
        code = STOPPED + stop.number
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else 1
    except Exception:  # the parent sees the exit code alone
        traceback.print_exc()
    finally:
        os._exit(code)


def stopped(child: int, number: int) -> bool:
    """Wait for the end of a process: whether signal `number` ended it, before its work was done.

    Raises
    ------
    Fault
        If it has ended for another reason.
    """
    code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    if code not in (0, -number if number == signal.SIGKILL else STOPPED + number):
        raise Fault(f"exit code {code}")
    return code != 0


def require(held: bool, folder: Path) -> None:
    if not held:
        raise Fault(f"the folder holds {sorted(everything(folder))}")


def usual_signals() -> None:
    """Let none be ignored: started in the background of a shell, all processes here would."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGHUP, signal.SIG_DFL)


# A stop at a chosen step, played in this process --------------------------------------------------


STEPS = ("mkdir", "link", "replace", "unlink", "rmdir", "fsync")
"""Functions of `os` that change the disk; the writing of a file is a step, too."""


class Killed(BaseException):
    """The process is no more: each further step raises it again."""


class Steps:
    """Counts steps, and lets `number`, counted from 1, and perhaps all later ones, fail.

    Attributes
    ----------
    number : of the step that fails; 0 for none.
    error : what it raises.
    after : whether the step is done all the same, as if a signal came right after it.
    forever : whether all later ones fail, too, and are not done.
    done : how many there were.
    """

    def __init__(
        self, number: int, error: BaseException, *, after: bool = False, forever: bool = False
    ) -> None:
        self.number, self.error, self.after, self.forever = number, error, after, forever
        self.done = 0

    def wrapped(self, original: Callable[..., Any], half: Callable[..., Any]) -> Any:
        """`original` as a step; `half` is done of it if it fails before its end."""

        def step(*arguments: Any, **options: Any) -> Any:
            self.done += 1
            if self.done < self.number or self.number == 0:
                return original(*arguments, **options)
            if self.done > self.number:
                if self.forever:
                    raise self.error
                return original(*arguments, **options)
            (original if self.after else half)(*arguments, **options)
            raise self.error

        return step


@contextmanager
def stepping(steps: Steps) -> Generator[Steps]:
    """Let all steps pass through `steps`; nothing waits for the disk."""

    def nothing(*_: Any, **__: Any) -> None:
        pass

    def write(path: Path, data: bytes) -> None:
        path.write_bytes(data)

    def half(path: Path, data: bytes) -> None:
        path.write_bytes(data[: len(data) // 2])

    with pytest.MonkeyPatch.context() as patch:
        for name in STEPS:
            original = nothing if name == "fsync" else getattr(os, name)
            patch.setattr(os, name, steps.wrapped(original, nothing))
        patch.setattr(writing, "_write_durably", steps.wrapped(write, half))
        yield steps


@contextmanager
def full_after(room: int) -> Generator[None]:
    """A disk with room for `room` bytes."""
    left = room

    def write(path: Path, data: bytes) -> None:
        nonlocal left
        path.write_bytes(data[:left])
        if len(data) > left:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))
        left -= len(data)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(writing, "_write_durably", write)
        yield
