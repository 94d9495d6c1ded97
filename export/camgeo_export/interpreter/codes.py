"""What G and M words mean on controllers with the words of ISO 6983.

A meaning is a name in a modal group. A profile lists the words that its controller accepts; those
whose meaning is not the common one it maps to another of these names.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

GROUPS: Final[Mapping[str, tuple[str, ...]]] = MappingProxyType(
    {
        "motion": ("rapid", "line", "clockwise arc", "counter-clockwise arc", "holes", "bores"),
        "plane": ("plane XY", "plane ZX", "plane YZ"),
        "unit": ("inch", "mm"),
        "distance": ("absolute", "incremental"),
        "centres": ("absolute centres", "incremental centres"),
        "feed mode": ("inverse time", "feed per minute", "feed per revolution"),
        "compensation": ("compensation off", "compensation left", "compensation right"),
        "length": ("length offset", "length offset off"),
        "work offset": ("work offset",),
        "path mode": ("exact stop", "exact path", "continuous path"),
        "smoothing": ("smoothing",),
        "cycle": ("cycle off", "motion off"),
        "return": ("return to start", "return to R"),
        "spindle": ("spindle clockwise", "spindle counter-clockwise", "spindle off"),
        "coolant": ("flood", "mist", "through", "coolant off"),
        "flow": ("stop", "optional stop", "end"),
        "tool": ("tool change",),
        "once": ("dwell", "machine position", "home"),
        "none": ("no effect",),
    }
)
"""Meanings by modal group. Those of "once" and "none" are no modes."""

GROUP_OF: Final[Mapping[str, str]] = MappingProxyType(
    {meaning: group for group, meanings in GROUPS.items() for meaning in meanings}
)

COMMON: Final[Mapping[str, str]] = MappingProxyType(
    {
        "G0": "rapid", "G1": "line", "G2": "clockwise arc", "G3": "counter-clockwise arc",
        "G4": "dwell",
        "G17": "plane XY", "G18": "plane ZX", "G19": "plane YZ",
        "G20": "inch", "G21": "mm",
        "G28": "home", "G30": "home",
        "G40": "compensation off", "G41": "compensation left", "G42": "compensation right",
        "G41.1": "compensation left", "G42.1": "compensation right",
        "G43": "length offset", "G43.1": "length offset", "G49": "length offset off",
        "G53": "machine position",
        **dict.fromkeys(
            ("G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3"), "work offset"
        ),
        **{f"G{number}": "work offset" for number in range(505, 600)},
        "G61": "exact path", "G61.1": "exact stop", "G64": "continuous path",
        "G80": "cycle off",
        "G90": "absolute", "G91": "incremental",
        "G90.1": "absolute centres", "G91.1": "incremental centres",
        "G93": "inverse time", "G94": "feed per minute", "G95": "feed per revolution",
        "G81": "holes", "G85": "bores",
        "G97": "no effect",
        "G98": "return to start", "G99": "return to R",
        "M0": "stop", "M1": "optional stop", "M2": "end", "M30": "end",
        "M3": "spindle clockwise", "M4": "spindle counter-clockwise", "M5": "spindle off",
        "M6": "tool change",
        "M7": "mist", "M8": "flood", "M9": "coolant off",
    }
)  # fmt: skip
"""The common meaning of a word, its number without leading zeros."""

CYCLE: Final = "a cycle"
"""Motion of the blocks of a cycle, which is found and not run: their places in the plane are known,
and the height is taken for that at which it began."""

KNOWN: Final[Mapping[str, str]] = MappingProxyType(
    {
        "G5": "a spline", "G5.1": "a spline", "G5.2": "a spline", "G5.3": "a spline",
        "G10": "data of the controller", "G15": "polar coordinates", "G16": "polar coordinates",
        "G31": "a probe", "G33": "a thread", "G33.1": "a thread",
        **{f"G38.{number}": "a probe" for number in range(2, 6)},
        "G50": "a scale", "G51": "a scale", "G52": "a shifted zero",
        "G65": "a macro", "G66": "a macro", "G68": "a rotation", "G69": "a rotation",
        **{f"G{number}": CYCLE for number in (73, 74, 76, 82, 83, 84, 86, 87, 88, 89)},
        "G92": "a shifted zero", "G92.1": "a shifted zero", "G92.2": "a shifted zero",
        "G96": "a constant surface speed",
        "M19": "an angle of the spindle", "M98": "a subprogram", "M99": "the end of a subprogram",
    }
)  # fmt: skip
"""What further words are for, for messages: none of them is read."""

COORDINATES: Final = frozenset("XYZIJKR")
"""Words whose size depends on the decimal point on controllers that count in increments."""


def normal(letter: str, number: str) -> str:
    """A word as the tables have it: G01 is G1, G43.10 is G43.1."""
    whole, _, part = number.partition(".")
    whole = whole.lstrip("+0") or "0"
    part = part.rstrip("0")
    return f"{letter}{whole}{'.' if part else ''}{part}"
