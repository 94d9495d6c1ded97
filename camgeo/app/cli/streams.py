"""Standard output and standard error: the output of commands, made safe for a terminal, and the
progress of long work.
"""

from __future__ import annotations

import signal
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Final

LINES: Final = "\n\t"
"""Characters that belong to a text although they are not printable."""


class StreamError(Exception):
    """Standard output takes no more, e.g. because the disk is full or it is closed."""


def write(text: str) -> None:
    """Write a document on standard output, as it is."""
    try:
        sys.stdout.write(text)
        sys.stdout.flush()
    except BrokenPipeError:
        raise
    except OSError as error:
        raise StreamError(f"standard output: {error.strerror or error}") from error


def say(text: str) -> None:
    """Print lines on standard output."""
    write(f"{printable(text)}\n")


@contextmanager
def until_ctrl_c() -> Iterator[None]:
    """Ctrl-C ends what is within, and is no error; other signals are."""
    try:
        yield
    except KeyboardInterrupt as stop:
        if getattr(stop, "number", signal.SIGINT) != signal.SIGINT:
            raise
        notify("")  # after the ^C that terminals show


def notify(message: str) -> None:
    """Print a line for the person at the terminal, on standard error."""
    with suppress(OSError):  # no one is listening, and there is nowhere else to report it
        clear()
        print(printable(message), file=sys.stderr, flush=True)


def printable(text: str) -> str:
    """The text with escapes for characters that would direct the terminal, as in file names."""
    return "".join(
        each if each.isprintable() or each in LINES else each.encode("unicode_escape").decode()
        for each in text
    )


# -- progress -------------------------------------------------------------------------------------
# Progress of long work on a terminal: one line that is overwritten, and cleared at the end.


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
