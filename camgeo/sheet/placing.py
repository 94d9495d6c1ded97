"""Where dimensions and symbols stand: nothing is written across edges, lines or other texts."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from camgeo.numeric.arrays import BoolArray, ComplexArray
from camgeo.sheet.ink import (
    ARROW,
    LETTERS,
    LIFTED,
    TEXT_OUTSIDE,
    Boxes,
    Ink,
    chords,
    crossings,
    ink_of,
    number_of,
    together,
)
from camgeo.sheet.lettering import width_of
from camgeo.sheet.marks import Chain, Distance, Mark, line
from camgeo.units import LengthUnit

UPRIGHT: Final = 1e-9
"""Angles [rad] that are meant to be 0 or a quarter turn; programs turn texts over at those."""

CLEAR: Final = 0.7
"""Around a text, where no line is drawn [mm of paper]."""

UNREADABLE: Final = 1000.0
"""Costs of each text that is drawn across something, or that something is drawn across."""

OVER_AN_EDGE, OVER_A_LINE, OVER_AN_AXIS = 2.0, 1.0, 0.2
"""Costs of each crossing of an extension line or leader, and of a text on a centre line."""

ROUNDS: Final = 4
"""Most times that each place is chosen."""

Option = tuple[float, Sequence[Mark]]
"""A place that marks may have, after what it costs by itself."""

Options = Iterable[Option]


def cost(own: Ink, ink: Ink, enough: float = math.inf) -> float:
    """What is bad about own marks next to all that is there, or so much of it as is `enough`."""
    found = 0.0
    for where in _unreadable(own, ink):
        found += UNREADABLE * int(np.count_nonzero(where))
        if found >= enough:
            return found
    drawn = np.concatenate([own.wide, own.thin])
    found += OVER_AN_EDGE * (crossings(drawn, ink.wide) + crossings(own.wide, ink.thin))
    found += OVER_A_LINE * crossings(own.thin, ink.thin)
    found += OVER_A_LINE * int(np.count_nonzero(ink.bars.cut(drawn)))
    for rooms in (own.texts.around(CLEAR), own.frames):
        found += OVER_AN_AXIS * int(np.count_nonzero(rooms.hit(ink.axes)))
    return found


def _unreadable(own: Ink, ink: Ink) -> Iterator[BoolArray]:
    """Where texts, frames and dimension lines meet what they must not."""
    texts = own.texts.around(CLEAR)
    drawn = np.concatenate([own.wide, own.thin])
    lines = np.concatenate([ink.wide, ink.thin])
    yield texts.hit(lines)
    yield texts.overlap(ink.texts.around(CLEAR))
    yield texts.overlap(ink.frames)
    yield ink.texts.around(CLEAR).hit(drawn)
    yield own.bars.overlap(ink.bars)
    yield own.frames.overlap(ink.frames)
    yield own.frames.hit(lines)
    yield ink.frames.hit(drawn)
    yield own.texts.hit(drawn)
    yield np.triu(own.texts.overlap(own.texts), 1)


def chosen(options: Options, ink: Ink, scale: float, unit: LengthUnit) -> tuple[Mark, ...]:
    """The marks of the option that costs least next to what is there; nothing if there is none.

    Options are in the order of what they cost by themselves.
    """
    best: tuple[Mark, ...] = ()
    least = math.inf
    for price, marks in options:
        if price >= least:
            break
        found = price + cost(ink_of(marks, scale, unit), ink, least - price)
        if found < least:
            best, least = tuple(marks), found
    return best


def settled(
    requests: Iterable[Options], fixed: Sequence[Mark], scale: float, unit: LengthUnit
) -> list[Mark]:
    """The fixed marks, and those of the best option of each request, one after the other; those
    that later ones are in the way of are chosen again.
    """
    asked = [sorted(options, key=lambda option: option[0]) for options in requests]
    always = ink_of(fixed, scale, unit)
    places: list[tuple[Mark, ...]] = [() for _ in asked]
    inks = [Ink() for _ in asked]
    for turn in range(ROUNDS):
        for number, options in enumerate(asked):
            others = together([always, *inks[:number], *inks[number + 1 :]])
            if turn and cost(inks[number], others) < UNREADABLE:
                continue
            places[number] = chosen(options, others, scale, unit)
            inks[number] = ink_of(places[number], scale, unit)
    return [*fixed, *(mark for marks in places for mark in marks)]


def has_room(mark: Distance, scale: float, unit: LengthUnit) -> bool:
    """Whether the text of a dimension fits between its extension lines."""
    return width_of(number_of(mark, unit), LETTERS) + 1.0 <= mark.measure * scale


def has_arrows_outside(mark: Distance, scale: float) -> bool:
    """Whether the arrows of a dimension point at it from outside."""
    return mark.measure * scale < 2.0 * ARROW + LIFTED


def upright(mark: Distance) -> Distance:
    """The same dimension, its text to be read from below or from the right, its first end first."""
    angle = math.remainder(mark.angle, math.pi)
    if abs(angle + 0.5 * math.pi) < UPRIGHT:
        angle = 0.5 * math.pi
    angle = 0.0 if abs(angle) < UPRIGHT else angle
    along = cmath.rect(1.0, angle)
    ends = sorted((mark.first, mark.second), key=lambda end: (end * along.conjugate()).real)
    return replace(mark, angle=angle, first=ends[0], second=ends[1])


def placed(mark: Distance, scale: float, unit: LengthUnit, towards: complex) -> Iterator[Option]:
    """The dimension with its text in the middle, if there is room, and outside, rather in the
    direction `towards`.

    Its line goes on below a text outside.
    """
    mark = upright(mark)
    along = cmath.rect(1.0, mark.angle)
    inside = has_room(mark, scale, unit)
    if inside:
        yield 0.0, (mark,)
    wide, room = width_of(number_of(mark, unit), LETTERS), mark.measure * scale
    better = 1.0 if (towards * along.conjugate()).real >= 0.0 else -1.0
    for sense in (better, -better):
        price = (1.0 if inside else 0.0) + (0.5 if sense != better else 0.0)
        moved = replace(mark, aside=sense * (0.5 * room + TEXT_OUTSIDE + 0.5 * wide))
        start = middle_of(moved) + sense * along * (0.5 * room + 0.5 * ARROW) / scale
        end = middle_of(moved) + sense * along * (0.5 * room + TEXT_OUTSIDE + wide) / scale
        yield price, (moved, line(start, end, "DIMENSION"))


def middle_of(mark: Distance) -> complex:
    """The middle of the measured stretch on the dimension line."""
    along = cmath.rect(1.0, mark.angle)
    between = 0.5 * (mark.first + mark.second) - mark.line
    return mark.line + along * (between * along.conjugate()).real


def cleared(
    marks: Iterable[Mark], rooms: Sequence[Boxes], layers: Sequence[str], scale: float
) -> Iterator[Mark]:
    """The marks, with straight lines of some `layers` interrupted, and short chains left out, where
    they would go through a room [mm of paper].
    """
    for mark in marks:
        if not (isinstance(mark, Chain) and mark.layer in layers):
            yield mark
            continue
        lines = chords(scale * mark.vertices, mark.sweeps, closed=mark.closed)
        if len(mark.vertices) == 2 and not mark.sweeps[0]:
            yield from _interrupted(mark, rooms, lines)
        elif not any(np.any(each.cut(lines)) for each in rooms):
            yield mark


def _interrupted(mark: Chain, rooms: Sequence[Boxes], lines: ComplexArray) -> Iterator[Mark]:
    start, end = (complex(each) for each in mark.vertices)
    spans = []
    for low, high in (each.spans(lines) for each in rooms):
        spans += [span for span in zip(low[:, 0].tolist(), high[:, 0].tolist(), strict=True)
                  if span[0] < span[1]]  # fmt: skip
    place = 0.0
    for first, last in sorted(spans):
        if first > place:
            yield line(start + place * (end - start), start + first * (end - start), mark.layer)
        place = max(place, last)
    if not spans:
        yield mark
    elif place < 1.0:
        yield line(start + place * (end - start), end, mark.layer)
