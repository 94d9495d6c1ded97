"""A process that is stopped, or whose disk fails, at a chosen step, played in this process."""

from __future__ import annotations

import errno
import os
from collections.abc import Callable, Generator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from camgeo.design import writing

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
