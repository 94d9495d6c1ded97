"""Progress of long work on a terminal: one line that is overwritten, and cleared at the end."""

from __future__ import annotations

import sys
import threading
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    pass


PATIENCE = 1.0
"""Seconds before the first line: shorter work needs no progress line."""

EVERY = 1.0
"""Seconds after which the line is written again, to show that a long step is still running."""

CLEARED = "\r\x1b[K"
"""Makes a terminal clear its line."""


class Progress:
    """Shows the current step, once the work has taken longer than a second; silent in a pipe."""

    def __init__(self) -> None:
        self._start = time.monotonic()
        self._step = "working"
        self._lock, self._ended = threading.Lock(), threading.Event()

    def begin(self) -> None:
        """Show from now on how long the work takes, also between steps, until `end`."""
        if sys.stderr.isatty():
            threading.Thread(target=self._go_on, daemon=True).start()

    def __call__(self, step: str) -> None:
        self._step = step
        self._show()

    def end(self) -> None:
        """Clear the line for good: the output of the command follows."""
        with self._lock:
            self._ended.set()
            clear()

    def _go_on(self) -> None:
        while not self._ended.wait(EVERY):
            self._show()

    def _show(self) -> None:
        elapsed = time.monotonic() - self._start
        with self._lock:
            if elapsed > PATIENCE and sys.stderr.isatty() and not self._ended.is_set():
                sys.stderr.write(f"{CLEARED}{elapsed:5.1f} s  {self._step}")
                sys.stderr.flush()


def clear() -> None:
    """Clear the progress line, if there is one, before something else is printed."""
    if sys.stderr.isatty():
        sys.stderr.write(CLEARED)
        sys.stderr.flush()
