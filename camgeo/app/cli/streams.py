"""Standard output and standard error: the output of commands, made safe for a terminal."""

from __future__ import annotations

import io
import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Final

from camgeo.app.cli.progress import clear

if TYPE_CHECKING:
    pass


LINES: Final = "\n\t"
"""Characters that belong to a text although they are not printable."""


class StreamError(Exception):
    """Standard output takes no more, e.g. because the disk is full or it is closed."""


def mend() -> None:
    """Replace closed streams: no file opened later may take their place.

    Writing to a closed standard output fails, as to a full one; messages are lost.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDONLY if number == 1 else os.O_RDWR)
    sys.stdout = sys.stdout or open(1, "w", encoding="utf-8", closefd=False)  # noqa: SIM115 - no path
    sys.stderr = sys.stderr or open(2, "w", encoding="utf-8", closefd=False)  # noqa: SIM115 - no path
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


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


def discard_output() -> None:
    """Drop what standard output has not taken, so that the end of the process does not fail."""
    with suppress(OSError):  # under test it is no file
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def printable(text: str) -> str:
    """The text with escapes for characters that would direct the terminal, as in file names."""
    return "".join(
        each if each.isprintable() or each in LINES else each.encode("unicode_escape").decode()
        for each in text
    )
