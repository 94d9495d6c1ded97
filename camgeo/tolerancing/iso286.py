"""Tolerance classes of ISO 286-1, as "H7" of a hole and "g6" of a shaft; values in iso286.json."""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Sequence
from functools import cache
from typing import Any, Final

from camgeo.declared import schema_beside
from camgeo.errors import GeometryError
from camgeo.wording import listed

FORM: Final = re.compile(r"(?P<letters>[A-Za-z]{1,2})(?P<grade>\d{1,2})")

SHAFTS: Final = (
    "a", "b", "c", "d", "e", "f", "g", "h", "js", "k", "m", "n", "p", "r", "s", "t", "u",
)  # fmt: skip

HOLES: Final = tuple(letter.upper() for letter in SHAFTS)

K_GRADES: Final = range(4, 8)
"""In which a shaft k has a fundamental deviation other than 0."""

SMALLEST: Final = 3.0
"""Sizes [mm] up to which all holes are shafts reversed."""

PER_MM: Final = 1000.0
"""Micrometres."""


def limits_of(name: str, size: float) -> tuple[float, float]:
    """Lower and upper deviation [mm] of a size [mm] of the tolerance class `name`.

    Raises
    ------
    GeometryError
        If there is no such class here, the size is not above 0 and up to 500 mm, or the class has
        no value at this size in ISO 286-1.
    """
    data = _data()
    parts = FORM.fullmatch(name)
    letters, number = (parts["letters"], parts["grade"]) if parts else ("", "")
    if letters not in (*HOLES, *SHAFTS) or number not in data["grades"]:
        grades = [f"IT{each}" for each in data["grades"]]
        raise GeometryError(
            "is no tolerance class that is known here: a letter of holes"
            f" ({listed(HOLES)}) or of shafts ({listed(SHAFTS)}) and a grade from {grades[0]} to"
            f' {grades[-1]}, e.g. "H7"',
            value=name,
        )
    most = data["up_to"][-1]
    if not 0.0 < size <= most:
        message = f"belongs to sizes above 0 up to {most} mm, and this one is {size:g} mm"
        raise GeometryError(message, value=name)
    grade = int(number)
    _require_value(name, letters, grade, size)
    width = _standard(grade, size) / PER_MM
    letter = letters.lower()
    if letter == "js":
        return -0.5 * width, 0.5 * width
    if letter in data["upper"]:
        high = _of_size(data["upper"][letter], size) / PER_MM
        return (0.0 - high, width - high) if is_hole(name) else (high - width, high)
    if is_hole(name):
        high = _highest(letters, grade, size) / PER_MM
        return high - width, high
    zero = letter == "k" and grade not in K_GRADES
    low = 0.0 if zero else _of_size(data["lower"][letter], size) / PER_MM
    return low, low + width


def _require_value(name: str, letters: str, grade: int, size: float) -> None:
    for each in _data()["absent"]:
        (first, last), (above, up_to) = each["grades"], each["sizes"]
        known = letters in each.get("letters", letters)
        if known and first <= grade <= last and above < size <= up_to:
            raise GeometryError(
                f"has no value in ISO 286-1: there are none of {letters}{first} to"
                f" {letters}{last} for sizes above {above} up to {up_to} mm, and this one is"
                f" {size:g} mm",
                value=name,
            )


def _highest(letters: str, grade: int, size: float) -> float:
    """Upper deviation [micrometres] of a hole K to U: its shaft's, reversed, plus delta, by which a
    hole fits the shaft of the next finer grade as it would by the system of the basic hole.
    """
    data = _data()
    high = 0.0 - _of_size(data["lower"][letters.lower()], size)
    if size <= SMALLEST:
        return high
    if grade > data["delta_up_to"][letters]:
        return 0.0 if letters == "N" else high
    nearer = data["exceptions"].get(f"{letters}{grade}")
    if nearer and nearer["sizes"][0] < size <= nearer["sizes"][1]:
        return float(nearer["high"])
    return high + _standard(grade, size) - _standard(grade - 1, size)


def _standard(grade: int, size: float) -> float:
    """The standard tolerance IT of a grade [micrometres]."""
    return _of_size(_data()["grades"][str(grade)], size)


def _of_size(values: Sequence[float], size: float) -> float:
    """The value of the range that a size is in; some letters have more ranges than others."""
    data = _data()
    ranges = next(
        each for each in (data["up_to"], data["up_to_finely"]) if len(each) == len(values)
    )
    return float(values[bisect_left(ranges, size)])


def is_hole(name: str) -> bool:
    """Whether a valid class is one of holes."""
    return name[:1].isupper()


@cache
def _data() -> dict[str, Any]:
    return schema_beside(__file__)
