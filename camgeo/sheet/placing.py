"""Where the texts of dimensions stand, so that nothing is drawn across them."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final

from camgeo.sheet.lettering import width_of
from camgeo.sheet.marks import Chain, Distance, Mark, line
from camgeo.units import MM_PER, LengthUnit

LETTERS: Final = 3.5
"""Height of the texts of dimensions [mm of paper]."""

ARROW: Final = 3.0
"""Length of their arrows [mm of paper]."""

LIFTED: Final = 0.8
"""Of texts above the dimension line [mm of paper]."""

BEYOND: Final = 7.5
"""From the measured stretch to a text outside of it: an arrow with its tail [mm of paper]."""

UPRIGHT: Final = 1e-9
"""Angles [rad] that are meant to be 0 or a quarter turn; programs turn texts over at those."""

CLEAR: Final = 0.7
"""Around a text, where no thin line is drawn [mm of paper]."""


@dataclass(frozen=True, slots=True)
class Box:
    """The room of a text: its middle, a unit vector along it, and half its sizes [mm]."""

    middle: complex
    along: complex
    half_width: float
    half_height: float

    def around(self, by: float) -> Box:
        """A box that is larger on all sides."""
        return replace(self, half_width=self.half_width + by, half_height=self.half_height + by)

    def span(self, start: complex, end: complex) -> tuple[float, float] | None:
        """The shares of a straight line between which it is inside; None if it is nowhere."""
        low, high = 0.0, 1.0
        for axis, half in ((self.along, self.half_width), (1j * self.along, self.half_height)):
            first = ((start - self.middle) * axis.conjugate()).real
            step = ((end - start) * axis.conjugate()).real
            if step == 0.0:
                if abs(first) > half:
                    return None
                continue
            one, other = sorted(((-half - first) / step, (half - first) / step))
            low, high = max(low, one), min(high, other)
        return (low, high) if low < high else None


def number_of(mark: Distance, unit: LengthUnit) -> str:
    """The text of a dimension, with a decimal point."""
    text = f"{mark.measure / MM_PER[unit]:.{mark.decimals}f}"
    text = text.rstrip("0").rstrip(".") if "." in text else text
    return f"{mark.prefix}{text}{mark.suffix}"


def has_room(mark: Distance, scale: float, unit: LengthUnit) -> bool:
    """Whether the text of a dimension fits between its arrows."""
    return width_of(number_of(mark, unit), LETTERS) + 1.0 <= mark.measure * scale


def placed(mark: Distance, scale: float, unit: LengthUnit, towards: complex) -> Iterator[Mark]:
    """The dimension, its text outside in the direction `towards` if there is no room for it.

    Its line then goes on below the text.
    """
    angle = math.remainder(mark.angle, math.pi)
    if abs(angle + 0.5 * math.pi) < UPRIGHT:
        angle = 0.5 * math.pi
    angle = 0.0 if abs(angle) < UPRIGHT else angle
    along = cmath.rect(1.0, angle)
    ends = sorted((mark.first, mark.second), key=lambda end: (end * along.conjugate()).real)
    mark = replace(mark, angle=angle, first=ends[0], second=ends[1])
    if has_room(mark, scale, unit):
        yield mark
        return
    wide, room = width_of(number_of(mark, unit), LETTERS), mark.measure * scale
    sense = 1.0 if (towards * along.conjugate()).real >= 0.0 else -1.0
    mark = replace(mark, aside=sense * (0.5 * room + BEYOND + 0.5 * wide))
    yield mark
    start = _middle(mark) + sense * along * (0.5 * room + 0.5 * ARROW) / scale
    end = _middle(mark) + sense * along * (0.5 * room + BEYOND + wide) / scale
    yield line(start, end, "DIMENSION")


def _middle(mark: Distance) -> complex:
    """The middle of the measured stretch on the dimension line."""
    along = cmath.rect(1.0, mark.angle)
    between = 0.5 * (mark.first + mark.second) - mark.line
    return mark.line + along * (between * along.conjugate()).real


def box_of(mark: Distance, scale: float, unit: LengthUnit) -> Box:
    """The room of a dimension's text, in millimetres of the part."""
    along = cmath.rect(1.0, mark.angle)
    lift = LIFTED + 0.5 * LETTERS
    middle = _middle(mark) + along * (mark.aside + 1j * lift) / scale
    wide = width_of(number_of(mark, unit), LETTERS)
    return Box(middle, along, 0.5 * wide / scale, 0.5 * LETTERS / scale)


def cleared(
    marks: Iterable[Mark], boxes: Sequence[Box], layers: Sequence[str], scale: float
) -> Iterator[Mark]:
    """The marks, with straight lines of some `layers` interrupted, and short chains left out, where
    they would cross a text.
    """
    wide = [box.around(CLEAR / scale) for box in boxes]
    for mark in marks:
        if not (isinstance(mark, Chain) and mark.layer in layers):
            yield mark
        elif len(mark.vertices) == 2 and not mark.sweeps[0]:
            yield from _cut(mark, wide)
        elif not any(_crosses(mark, box) for box in wide):
            yield mark


def _cut(mark: Chain, boxes: Sequence[Box]) -> Iterator[Mark]:
    start, end = (complex(each) for each in mark.vertices)
    place = 0.0
    for low, high in sorted(span for box in boxes if (span := box.span(start, end)) is not None):
        if low > place:
            yield line(start + place * (end - start), start + low * (end - start), mark.layer)
        place = max(place, high)
    if place < 1.0:
        yield line(start + place * (end - start), end, mark.layer)


def _crosses(mark: Chain, box: Box) -> bool:
    points = mark.vertices.tolist()
    return any(box.span(one, other) is not None for one, other in pairwise(points))
