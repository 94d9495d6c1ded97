"""Progress of long work on a terminal: one line that is written over, and taken away at the end."""

from __future__ import annotations

import sys
import time
from types import TracebackType
from typing import Self

PATIENCE = 1.0
"""Seconds before the first line: shorter work needs no progress line."""


class Progress:
    """Shows the step at hand, once the work has taken longer than a second; silent in a pipe."""

    def __init__(self) -> None:
        self._start = time.monotonic()
        self._width = 0

    def __enter__(self) -> Self:
        return self

    def __call__(self, step: str) -> None:
        elapsed = time.monotonic() - self._start
        if elapsed > PATIENCE and sys.stderr.isatty():
            line = f"{elapsed:5.1f} s  {step}"
            sys.stderr.write("\r" + line.ljust(self._width))
            sys.stderr.flush()
            self._width = len(line)

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._width:
            sys.stderr.write("\r" + " " * self._width + "\r")
            sys.stderr.flush()
