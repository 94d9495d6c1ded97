"""Waiting for what happens outside of a test: until it does, however busy the machine is.

A test that waits for a time gives another verdict on another machine. So tests wait for events,
barriers, pipes and ends of threads and processes where there are some, and look again and again
where there are none. All that has not come after `PATIENCE` never will.
"""

from __future__ import annotations

import subprocess
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Final, TypeVar

PATIENCE: Final = 600.0
"""Time [s] after which what has not come is taken for what never comes."""

BETWEEN: Final = 0.01
"""Time [s] between two looks; what is looked at costs next to nothing."""

Given = TypeVar("Given")


def until(what: str, look: Callable[[], Given]) -> Given:
    """What `look` gives once it gives anything that is true.

    Raises
    ------
    AssertionError
        With `what` did not come.
    """
    end = time.monotonic() + PATIENCE
    while not (found := look()):
        if time.monotonic() > end:
            raise AssertionError(f"{what}: has not come")
        time.sleep(BETWEEN)
    return found


def give_way() -> None:
    """Let other threads come between; whether one does must not matter to the test."""
    time.sleep(1e-3)


def happened(what: str, event: threading.Event) -> None:
    """Wait until an event is set; AssertionError with `what` if it never is."""
    if not event.wait(PATIENCE):
        raise AssertionError(f"{what}: has not come")


def joined(*threads: threading.Thread) -> None:
    """Wait for the ends of threads; AssertionError with the name of one that does not end."""
    for each in threads:
        each.join(PATIENCE)
        if each.is_alive():
            raise AssertionError(f"{each.name}: does not end")


def ended(process: subprocess.Popen[str] | subprocess.Popen[bytes]) -> int:
    """The exit code of a process, once it has ended by itself."""
    try:
        return process.wait(PATIENCE)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
        raise AssertionError(f"process {process.pid}: does not end") from None


def alive(process: int) -> bool:
    """Whether a process runs, as far as /proc tells; one that waits for its parent has ended."""
    try:
        state = Path(f"/proc/{process}/stat").read_text("ascii").rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state != "Z"
