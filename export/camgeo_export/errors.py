"""The error of a file that was read back, and the numbers in files."""

from __future__ import annotations

from camgeo.errors import FileError
from camgeo.reading import COORDINATE, number_of

__all__ = ["FileError", "finite"]


def finite(text: str, name: str, line: int) -> float:
    """The number `text` in a line of the file `name`.

    Raises FileError if it is none, not finite, or beyond the limits of `camgeo.reading`.
    """
    number = number_of(text)
    if number is None:
        what = f"is not a finite number of at most {COORDINATE:g}"
        raise FileError(f"{name}, line {line}: {text[:40]!r} {what}")
    return number
