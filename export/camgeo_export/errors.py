"""The error of a file that was read back."""

from __future__ import annotations

import math

from camgeo.errors import CamgeoError


class FileError(CamgeoError, ValueError):
    """A file does not hold what its writer puts into such a file: cut short, changed or foreign."""


def finite(text: str, name: str, line: int) -> float:
    """The number `text` in a line of the file `name`; FileError if it is not finite."""
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise FileError(f"{name}, line {line}: {text[:40]!r} is not a finite number")
    return number
