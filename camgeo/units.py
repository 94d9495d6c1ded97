"""Conversion between the units of a scene and those inside: millimetres and radians.

Values are converted once: by the scene loader on the way in, by a writer on the way out. So are
texts: they are made in mm, as "17.5 mm", and `in_unit` restates them where they are handed on.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection
from typing import Final, Literal

LengthUnit = Literal["mm", "inch"]

LiftUnit = Literal["mm", "rad"]
"""Unit of a lift or of a demanded position, inside."""

MM_PER: Final[dict[LengthUnit, float]] = {"mm": 1.0, "inch": 25.4}

TURN: Final = 2.0 * math.pi
"""One turn of the cam [rad]."""

RPM: Final = TURN / 60.0
"""One rev/min in rad/s."""

_NUMBER: Final = r"[-+]?\d+(?:,\d{3})*(?:\.\d+)?(?:e[-+]?\d+)?"

_MEASURE: Final = re.compile(
    r'"[^"\n]*"'  # what is quoted stays
    rf"|(?<![\w.^/])(?P<bound>at least |at most )?(?P<numbers>\({_NUMBER}(?:, {_NUMBER})+\)"
    rf"|[XYZ] {_NUMBER}(?:, (?:[XYZ] )?{_NUMBER})*"
    rf"|{_NUMBER}, {_NUMBER}, {_NUMBER}"
    rf"|between {_NUMBER} and {_NUMBER}"
    rf"|{_NUMBER}(?:(?: to | x ){_NUMBER})*)"
    r"(?P<unit> (?:g |kg )?mm(?:\^(?P<power>\d))?)(?![\w^]|\.\w|/\w+[./])"
)
"""Numbers and their unit, a power of mm and perhaps something per something, not a file's name."""

_UNIT: Final = re.compile(r"(?P<head>g |kg )?mm(?:\^(?P<power>\d))?(?P<rest>/.*)?")

FEWEST: Final = 4
"""Significant digits of a restated number, at least; `SHOWN` of one that is known exactly."""

SHOWN: Final = 6

ROUNDING: Final = {"at least ": 1.0, "at most ": -1.0, "": 0.0}
"""To which side the number after these words is rounded."""

SAME: Final = 1e-3
"""Of a unit of the last digit, within which a number is that digit."""


def unit_in(unit: str, length: LengthUnit) -> tuple[str, float]:
    """The unit that stands for "mm", "mm^2", "mm/s", "g mm", ... in a scene with that unit of
    length, and by what values are then divided; any other unit, N/mm among them, as it is, and 1.
    """
    found = _UNIT.fullmatch(unit)
    if found is None:
        return unit, 1.0
    return unit.replace("mm", length, 1), MM_PER[length] ** int(found["power"] or 1)


def in_unit(text: str, unit: LengthUnit, exact: Collection[float] = ()) -> str:
    """The text with all lengths, areas, speeds, ... that it states in mm in the unit of a scene.

    Known are "17.5 mm", "3 to 4 mm", "between 3 and 4 mm", "3 x 4 mm", "(3, 4) mm", "X 3, Y 4 mm",
    "Z 3, 4 mm" and three numbers with commas, with powers of mm, mm per anything, g mm and kg mm^2.
    A length has one decimal more in inches than in mm, the other quantities accordingly; what
    follows "at least" is rounded up, what follows "at most" down, so that it holds. What is in
    double quotes stays.

    Parameters
    ----------
    exact : numbers of the text before they were rounded, in the units that it states.
    """
    if unit == "mm":
        return text

    def restated(found: re.Match[str]) -> str:
        if found["unit"] is None:
            return found[0]
        scale = MM_PER[unit] ** int(found["power"] or 1)
        bound = found["bound"] or ""

        def number(each: re.Match[str]) -> str:
            return _restated(each[0], scale, exact, ROUNDING[bound])

        return bound + re.sub(_NUMBER, number, found["numbers"]) + found["unit"].replace("mm", unit)

    return _MEASURE.sub(restated, text)


def _restated(number: str, scale: float, exact: Collection[float], side: float) -> str:
    """The number of a text divided by `scale`, with the digits that it then has; one that is not
    `exact` is rounded to the `side`, +1 or -1, or for 0 to the nearest.
    """
    plain = number.replace(",", "")
    value, digits = float(plain), FEWEST
    for each in exact:
        if float(f"{each:.{SHOWN}g}") == value:
            value, digits, side = each, SHOWN, 0.0
    value /= scale
    mantissa, _, exponent = plain.partition("e")
    fraction = mantissa.partition(".")[2]
    leading = math.floor(math.log10(abs(value))) if value else 0
    decimals = len(fraction) - int(exponent or 0) + round(math.log10(scale))
    decimals = max(decimals, digits - 1 - leading)
    value += side * (0.5 - SAME) * 10.0**-decimals
    if exponent:
        return f"{value:.{decimals + leading + 1}g}"
    text = f"{value:{',' * (',' in number)}.{max(decimals, 0)}f}"
    fixed = fraction.endswith("0") or "." not in text
    return text if fixed else text.rstrip("0").rstrip(".")
