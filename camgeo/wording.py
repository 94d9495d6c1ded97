"""Words that messages share: counts of things, and cam angles."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from camgeo.units import TURN

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


def told_apart(one: float, other: float) -> tuple[str, str]:
    """Two numbers with as many digits as it takes to see which is larger, six at least."""
    found = [(f"{one:.{digits}g}", f"{other:.{digits}g}") for digits in range(6, 18)]
    return next((pair for pair in found if pair[0] != pair[1]), found[0])


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


def over_cam_angles(first: float, last: float, form: str = ".6g") -> str:
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
