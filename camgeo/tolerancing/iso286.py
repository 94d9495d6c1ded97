"""Tolerance classes of ISO 286-1, as "H7" of a hole and "g6" of a shaft; values in iso286.json."""

from __future__ import annotations

import re
from bisect import bisect_left
from functools import cache
from typing import Any, Final

from camgeo.declared import schema_beside
from camgeo.errors import GeometryError
from camgeo.wording import listed

FORM: Final = re.compile(r"(?P<letters>[A-Za-z]{1,2})(?P<grade>\d{1,2})")

HOLES: Final = ("D", "E", "F", "G", "H", "JS")
"""Letters of holes: those whose lower deviation is that of the shaft of the same letter, reversed,
and the symmetric one."""

SHAFTS: Final = ("d", "e", "f", "g", "h", "js", "k", "m", "n", "p")

K_GRADES: Final = ("5", "6", "7")
"""In which a shaft k has a fundamental deviation other than 0 (of IT5 to IT11)."""

PER_MM: Final = 1000.0
"""Micrometres."""


def limits_of(name: str, size: float) -> tuple[float, float]:
    """Lower and upper deviation [mm] of a size [mm] of the tolerance class `name`.

    Raises
    ------
    GeometryError
        If there is no such class here, or the size is not above 0 and up to 500 mm.
    """
    data = _data()
    parts = FORM.fullmatch(name)
    letters, grade = (parts["letters"], parts["grade"]) if parts else ("", "")
    if letters not in (*HOLES, *SHAFTS) or grade not in data["grades"]:
        grades = [f"IT{each}" for each in data["grades"]]
        raise GeometryError(
            "is no tolerance class that is known here: a letter of holes"
            f" ({listed(HOLES)}) or of shafts ({listed(SHAFTS)}) and a grade from {grades[0]} to"
            f' {grades[-1]}, e.g. "H7"',
            value=name,
        )
    up_to = data["up_to"]
    if not 0.0 < size <= up_to[-1]:
        message = f"belongs to sizes above 0 up to {up_to[-1]} mm, and this one is {size:g} mm"
        raise GeometryError(message, value=name)
    row = bisect_left(up_to, size)
    width = data["grades"][grade][row] / PER_MM
    letter = letters.lower()
    if letter == "js":
        return -0.5 * width, 0.5 * width
    if letter in data["lower"]:
        without = letter == "k" and grade not in K_GRADES
        low = 0.0 if without else data["lower"][letter][row] / PER_MM
        return low, low + width
    high = data["upper"][letter][row] / PER_MM
    return (high - width, high) if letters in SHAFTS else (-high + 0.0, -high + width)


def is_hole(name: str) -> bool:
    """Whether a valid class is one of holes."""
    return name[:1].isupper()


@cache
def _data() -> dict[str, Any]:
    return schema_beside(__file__)
