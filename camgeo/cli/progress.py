"""Progress of long work on a terminal: one line that is written over, and taken away at the end."""

from __future__ import annotations

import sys
import time

PATIENCE = 1.0
"""Seconds before the first line: shorter work needs no progress line."""

CLEARED = "\r\x1b[K"
"""Makes a terminal empty its line."""


class Progress:
    """Shows the step at hand, once the work has taken longer than a second; silent in a pipe."""

    def __init__(self) -> None:
        self._start = time.monotonic()

    def __call__(self, step: str) -> None:
        elapsed = time.monotonic() - self._start
        if elapsed > PATIENCE and sys.stderr.isatty():
            sys.stderr.write(f"{CLEARED}{elapsed:5.1f} s  {step}")
            sys.stderr.flush()


def clear() -> None:
    """Take away the line of progress, if there is one, before something else is printed."""
    if sys.stderr.isatty():
        sys.stderr.write(CLEARED)
        sys.stderr.flush()
