"""Units of a scene and those inside, and the words that messages share.

Values are converted once: by the scene loader on the way in, by a writer on the way out. So are
texts: they are made in mm, as "17.5 mm", and `in_unit` restates them where they are handed on.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Sequence
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
"""Significant digits of a restated number, at least; one that is known exactly has `EXACT_DIGITS`.
"""

EXACT_DIGITS: Final = 6

ROUNDING: Final = {"at least ": 1.0, "at most ": -1.0, "": 0.0}
"""To which side the number after these words is rounded."""

SAME: Final = 1e-3
"""Of a unit of the last digit, within which a number is that digit."""


def unit_and_divisor(unit: str, length: LengthUnit) -> tuple[str, float]:
    """The unit that stands for "mm", "mm^2", "mm/s", "g mm", ... in a scene with that unit of
    length, and by what values are then divided; any other unit, N/mm among them, as it is, and 1.
    """
    match = _UNIT.fullmatch(unit)
    if match is None:
        return unit, 1.0
    return unit.replace("mm", length, 1), MM_PER[length] ** int(match["power"] or 1)


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
    for known in exact:
        if float(f"{known:.{EXACT_DIGITS}g}") == value:
            value, digits, side = known, EXACT_DIGITS, 0.0
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


# -- wording --------------------------------------------------------------------------------------
# Words that messages share: counts of things, and cam angles.


FINEST: Final = 7
"""Decimals of measured values in mm, inch or degrees; what is beyond is rounding."""


def counted(number: int, noun: str, plural: str = "") -> str:
    """`number` with its noun, "1 row" or "1,200 rows"; the plural is by default `noun` and "s"."""
    return f"{number:,} {noun if number == 1 else plural or noun + 's'}"


def listed(words: Sequence[str], most: int | None = None) -> str:
    """The words as a list, "a", "a and b" or "a, b and c"; of more than `most` words the first, and
    how many more there are.
    """
    more = 0 if most is None else max(0, len(words) - most)
    *first, last = [*words[:most], f"{more} more"] if more else words
    return f"{', '.join(first)} and {last}" if first else last


def shortened(text: str, most: int) -> str:
    """The text; of one longer than `most` characters the beginning, with "..." at its end."""
    return text if len(text) <= most else f"{text[: most - 3]}..."


def small(value: float, unit: str, *, signed: bool = False) -> str:
    """A measured value with its unit, "0.00512 mm", to four digits and no finer than `FINEST`."""
    rounded = round(value, FINEST) + 0.0
    return f"{rounded:{'+' * signed}.4g} {unit}"


def place_text(place: complex) -> str:
    """A place [mm] in the plane of the disc."""
    return f"({place.real:.6g}, {place.imag:.6g}) mm"


def cam_angle(angle: float, form: str = ".6g") -> str:
    """The cam angle `angle` [rad], in any turn, in degrees from 0 to below 360."""
    text = format(math.degrees(angle % TURN), form)
    return format(0.0, form) if float(text) == 360.0 else text


def at_cam_angles(*angles: float, form: str = ".6g", most: int | None = None) -> str:
    """Where something is, "at cam angles 30 and 90 deg"; each place [rad] is named once.

    Beyond `most` places see `listed`.
    """
    places = list(dict.fromkeys(cam_angle(angle, form) for angle in angles))
    return f"at cam angle{'s' * (len(places) > 1)} {listed(places, most)} deg"


def cam_angle_range(first: float, last: float, form: str = ".6g") -> str:
    """A range, "from cam angle 30 to 90 deg"; one place if its ends [rad] read the same.

    The end is below the start if the range passes cam angle 0; one of 2 pi is the whole turn.
    """
    start, end = cam_angle(first, form), cam_angle(last, form)
    if start != end:
        return f"from cam angle {start} to {end} deg"
    whole = abs(last - first) > math.pi
    return "over the whole turn" if whole else at_cam_angles(first, form=form)


def clock(seconds: float) -> str:
    """A time to the second: "42 s", "3:07 min", "1:03:07 h"."""
    whole = round(seconds)
    minutes, rest = divmod(whole, 60)
    if minutes < 60:
        return f"{minutes}:{rest:02d} min" if minutes else f"{rest} s"
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d} h"
