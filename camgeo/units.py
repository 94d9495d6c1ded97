"""Units of a scene and of the engine, and phrases that messages share.

Values are converted once: by the scene loader on the way in, by a writer on the way out. So are
texts: they are composed in mm, as "17.5 mm", and `in_unit` restates them where they leave the
engine.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Sequence
from typing import Final, Literal

LengthUnit = Literal["mm", "inch"]

LiftUnit = Literal["mm", "rad"]
"""Unit of a lift or of a demanded position within the engine."""

MM_PER: Final[dict[LengthUnit, float]] = {"mm": 1.0, "inch": 25.4}

TURN: Final = 2.0 * math.pi
"""One revolution of the cam [rad]."""

RPM: Final = TURN / 60.0
"""One rev/min in rad/s."""

_NUMBER: Final = r"[-+]?\d+(?:,\d{3})*(?:\.\d+)?(?:e[-+]?\d+)?"

_MEASURE: Final = re.compile(
    r'"[^"\n]*"'  # quoted text is matched first, without a unit, and stays as it is
    rf"|(?<![\w.^/])(?P<bound>at least |at most )?(?P<numbers>\({_NUMBER}(?:, {_NUMBER})+\)"
    rf"|[XYZ] {_NUMBER}(?:, (?:[XYZ] )?{_NUMBER})*"
    rf"|{_NUMBER}, {_NUMBER}, {_NUMBER}"
    rf"|between {_NUMBER} and {_NUMBER}"
    rf"|{_NUMBER}(?:(?: to | x ){_NUMBER})*)"
    r"(?P<unit> (?:g |kg )?mm(?:\^(?P<power>\d))?)(?![\w^]|\.\w|/\w+[./])"
)
"""Numbers with a unit that contains a power of mm; not the name of a file, such as "5 mm.dxf"."""

_UNIT: Final = re.compile(r"(?P<head>g |kg )?mm(?:\^(?P<power>\d))?(?P<rest>/.*)?")

FEWEST: Final = 4
"""Significant digits of a restated number, at least; one that is known exactly has `EXACT_DIGITS`.
"""

EXACT_DIGITS: Final = 6

ROUNDING: Final = {"at least ": 1.0, "at most ": -1.0, "": 0.0}
"""Direction in which the number after these words is rounded: 1 up, -1 down, 0 to the nearest."""

SAME: Final = 1e-3
"""Share of a unit in the last digit within which a number counts as exactly representable."""


def unit_and_divisor(unit: str, length: LengthUnit) -> tuple[str, float]:
    """The unit of a scene that replaces `unit`, e.g. inch/s for mm/s, and the divisor of its
    values.

    Replaced are "mm", "mm^2", "mm/s", "g mm" and the like, in a scene with the unit of `length`;
    any other unit, such as N/mm, is returned unchanged, with the divisor 1.
    """
    match = _UNIT.fullmatch(unit)
    if match is None:
        return unit, 1.0
    return unit.replace("mm", length, 1), MM_PER[length] ** int(match["power"] or 1)


def in_unit(text: str, unit: LengthUnit, exact: Collection[float] = ()) -> str:
    """The text with its lengths, areas, speeds, ... converted from mm to the unit of a scene.

    Recognized are "17.5 mm", "3 to 4 mm", "between 3 and 4 mm", "3 x 4 mm", "(3, 4) mm", "X 3, Y 4
    mm", "Z 3, 4 mm" and three numbers with commas, with powers of mm, mm per anything, g mm and kg
    mm^2. A length has one decimal more in inches than in mm, other quantities correspondingly. A
    number after "at least" is rounded up and one after "at most" down, so that the statement stays
    true. Text in double quotes is kept.

    Parameters
    ----------
    exact : exact values of numbers in the text, in the units that it states.
    """
    if unit == "mm":
        return text

    def restated(match: re.Match[str]) -> str:
        if match["unit"] is None:
            return match[0]
        scale = MM_PER[unit] ** int(match["power"] or 1)
        bound = match["bound"] or ""

        def number(number_match: re.Match[str]) -> str:
            return _restated(number_match[0], scale, exact, ROUNDING[bound])

        return bound + re.sub(_NUMBER, number, match["numbers"]) + match["unit"].replace("mm", unit)

    return _MEASURE.sub(restated, text)


def _restated(number: str, scale: float, exact: Collection[float], side: float) -> str:
    """The number of a text divided by `scale`, with a corresponding number of digits.

    Unless it is among the `exact` ones, it is rounded up for `side` +1, down for -1, and to the
    nearest for 0.
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
    # The decimals that the text has, plus those by which the unit is larger: one for inches.
    decimals = len(fraction) - int(exponent or 0) + round(math.log10(scale))
    decimals = max(decimals, digits - 1 - leading)
    # Formatting rounds to the nearest: half a unit more makes it round up, half a unit less down.
    value += side * (0.5 - SAME) * 10.0**-decimals
    if exponent:
        return f"{value:.{decimals + leading + 1}g}"
    text = f"{value:{',' * (',' in number)}.{max(decimals, 0)}f}"
    fixed = fraction.endswith("0") or "." not in text
    return text if fixed else text.rstrip("0").rstrip(".")


# -- wording --------------------------------------------------------------------------------------
# Phrases that messages share: numbers of things, cam angles, times.


FINEST: Final = 7
"""Most decimals of measured values in mm, inch or degrees; further ones are rounding errors."""


def counted(number: int, noun: str, plural: str = "") -> str:
    """A number with its noun, "1 row" or "1,200 rows"; the default plural is `noun` with an "s"."""
    return f"{number:,} {noun if number == 1 else plural or noun + 's'}"


def listed(words: Sequence[str], most: int | None = None) -> str:
    """The words as an enumeration: "a", "a and b" or "a, b and c".

    Of more than `most` words only the first `most` are named, and the others counted.
    """
    more = 0 if most is None else max(0, len(words) - most)
    *first, last = [*words[:most], f"{more} more"] if more else words
    return f"{', '.join(first)} and {last}" if first else last


def shortened(text: str, most: int) -> str:
    """The text, cut to `most` characters with "..." at the end if it is longer."""
    return text if len(text) <= most else f"{text[: most - 3]}..."


def small(value: float, unit: str, *, signed: bool = False) -> str:
    """A measured value with its unit, "0.00512 mm": four digits, at most `FINEST` decimals."""
    rounded = round(value, FINEST) + 0.0
    return f"{rounded:{'+' * signed}.4g} {unit}"


def place_text(place: complex) -> str:
    """A place [mm] in the plane of the disc as text, "(1.5, -2) mm"."""
    return f"({place.real:.6g}, {place.imag:.6g}) mm"


def cam_angle(angle: float, form: str = ".6g") -> str:
    """The cam angle `angle` [rad], of any revolution, in degrees from 0 to below 360."""
    text = format(math.degrees(angle % TURN), form)
    # 359.99999 deg may be printed as 360, which is 0.
    return format(0.0, form) if float(text) == 360.0 else text


def at_cam_angles(*angles: float, form: str = ".6g", most: int | None = None) -> str:
    """The places of something, "at cam angles 30 and 90 deg", from angles [rad].

    Angles that read the same are named once; for `most` see `listed`.
    """
    places = list(dict.fromkeys(cam_angle(angle, form) for angle in angles))
    return f"at cam angle{'s' * (len(places) > 1)} {listed(places, most)} deg"


def cam_angle_range(first: float, last: float, form: str = ".6g") -> str:
    """A range of the cam angle, "from cam angle 30 to 90 deg"; a place if its ends [rad] read the
    same.

    The end is below the start if the range passes cam angle 0; one of 2 pi is the whole turn.
    """
    start, end = cam_angle(first, form), cam_angle(last, form)
    if start != end:
        return f"from cam angle {start} to {end} deg"
    # The ends read the same: they are a whole turn apart, or one place.
    whole = abs(last - first) > math.pi
    return "over the whole turn" if whole else at_cam_angles(first, form=form)


def clock(seconds: float) -> str:
    """A time rounded to the second: "42 s", "3:07 min", "1:03:07 h"."""
    whole = round(seconds)
    minutes, rest = divmod(whole, 60)
    if minutes < 60:
        return f"{minutes}:{rest:02d} min" if minutes else f"{rest} s"
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d} h"
