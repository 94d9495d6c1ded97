"""What several effects tell alike."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from camgeo.check.finding import Finding
from camgeo.units import TURN

if TYPE_CHECKING:
    from camgeo.numeric.extremes import Extreme


def extreme_finding(name: str, words: str, end: Extreme, unit: str, sign: str = "") -> Finding:
    """A largest or smallest value [`unit`] with its place; `sign` says what is positive."""
    sentence = (
        f"{words} {end.value:.6g} {unit}{sign}, at cam angle {math.degrees(end.place):.6g} deg"
    )
    place = math.fmod(end.place, TURN)
    return Finding(name, "ok", sentence, end.value, unit=unit, cam_angle=place)
