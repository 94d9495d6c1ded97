"""Cells of an envelope: boxes that enclose a stretch of it, with the cone of its tangents.

Over a cell of half-width h about its middle m, with Z the pitch curve, theta = arg Z' and the pace
a = |Z'| - sigma d theta' of the parallel at d:

    W(m + u) - W(m) = integral of a exp(i theta),   |theta - theta_m| <= Theta_1 h,

so that W leaves the tangent at m by at most h^2/2 A_0 Theta_1 to the side and goes at most
|a_m| h + A_1 h^2/2 along it, with Theta_1 >= |theta'|, A_0 >= |a|, A_1 >= |a'| over the cell. These
follow from Z', Z'' in the middle and a bound of |Z'''|.

Pairs of cells whose boxes overlap are found by sorting along one axis, then by separating axes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from camgeo.curve.circles import centres_at
from camgeo.errors import GeometryError
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, IntArray, grouped, taken
from camgeo.outline.envelope import Envelope
from camgeo.units import TURN

ROUNDING = 2.0**-52 * 16.0
"""Rounding of a point, as a fraction of the largest length that enters it."""

MOST, MORE = 20_000, 500
"""Most cells in a halving: the first number, plus the second for each border of the flank. A flank
needs some thousand, and a hundred per segment if its motion has very many."""

PLACE = 2.0**-52 * 32.0
"""Rounding of a path parameter [rad]: a few units in the last place of a turn."""


@dataclass(frozen=True, slots=True, eq=False)
class Cells:
    """n cells.

    Attributes
    ----------
    low, high : (n,) path parameters; no border of the envelope lies inside.
    origin : (n,) index of the cell of the first division that it comes from.
    middle : (n,) complex [mm], the envelope in the middle of the cell.
    tangent : (n,) complex, unit, there.
    pace : (n,) signed, there.
    along, across : (n,) half sides of the box [mm] along the tangent and across it.
    turn : (n,) largest angle between the tangent in the cell and that in its middle [rad].
    bend : (n,) +1 or -1 where the tangent provably turns counter-clockwise or clockwise throughout
        the cell, else 0.
    sign : (n,) +1 or -1 where the pace provably has that sign throughout the cell, else 0.
    """

    low: FloatArray
    high: FloatArray
    origin: IntArray
    middle: ComplexArray
    tangent: ComplexArray
    pace: FloatArray
    along: FloatArray
    across: FloatArray
    turn: FloatArray
    bend: FloatArray
    sign: FloatArray

    def __len__(self) -> int:
        return len(self.low)

    def some(self, which: IntArray | BoolArray) -> Cells:
        """The cells at `which`."""
        return taken(self, which)


def enclose(envelope: Envelope, low: FloatArray, high: FloatArray, origin: IntArray) -> Cells:
    """Boxes of the cells [low, high] (n,), which must not reach across a border."""
    index = envelope.element_at(0.5 * (low + high))
    on_pivot = envelope.is_pivot[index]
    places, boxes = [], []
    for which, boxes_of in ((~on_pivot, _of_stretches), (on_pivot, _of_pivots)):
        if np.any(which):
            places.append(np.flatnonzero(which))
            boxes.append(boxes_of(envelope, low[which], high[which], index[which]))
    order = np.argsort(np.concatenate(places))
    columns = (np.concatenate(column)[order] for column in zip(*boxes, strict=True))
    middle, tangent, pace, along, across, turn, bend, sign = columns
    rounding = ROUNDING * (np.abs(middle) + abs(envelope.curve.distance))
    along, across = along + rounding + PLACE * np.abs(pace), across + rounding
    return Cells(low, high, origin, middle, tangent, pace, along, across, turn, bend, sign)


Boxes = tuple[Any, ...]
"""The arrays of `Cells` from `middle` to `sign`."""


def _of_stretches(envelope: Envelope, low: FloatArray, high: FloatArray, index: IntArray) -> Boxes:
    curve, pitch = envelope.curve, envelope.curve.pitch
    offset = abs(curve.distance)
    half = 0.5 * (high - low)
    shift = envelope.angle_offsets[index]
    middle = 0.5 * (low + high) + shift
    turns = np.where(middle >= TURN, TURN, 0.0)
    ends = np.maximum(low + shift - turns, 0.0), np.minimum(high + shift - turns, TURN)
    jet, (_, _, third) = pitch.jet_and_bounds(*ends)
    z1, z2 = jet[1], jet[2]
    speed, size = np.abs(z1), np.abs(z2)
    tangent = z1 / speed
    turning = (z1.real * z2.imag - z1.imag * z2.real) / (speed * speed)
    pace = speed - pitch.rotation * curve.distance * turning
    slowest = speed - half * (size + 0.5 * half * third)
    second = size + half * third
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        ratio = np.where(slowest > 0.0, second / slowest, np.inf)
        turning_slope = np.where(slowest > 0.0, third / slowest, np.inf) + 2.0 * ratio * ratio
        pace_slope = second + offset * turning_slope
        # An arc that is run through evenly.
        even = ~np.isnan(centres_at(pitch, middle))
        turning_slope[even], pace_slope[even] = 0.0, 0.0
        turning_most = np.minimum(ratio, np.abs(turning) + half * turning_slope)
        along = half * (np.abs(pace) + 0.5 * half * pace_slope)
        across = 0.5 * half * half * (np.abs(pace) + half * pace_slope) * turning_most
    known = np.isfinite(along) & np.isfinite(across)
    # The roller's centre stays within the cell's length of the middle, the flank within d of that.
    loose = half * (speed + half * second) + 2.0 * offset
    return (
        jet[0] + curve.distance * 1j * pitch.rotation * tangent,
        tangent,
        pace,
        np.where(known, along, loose),
        np.where(known, across, loose),
        np.where(known, np.minimum(half * turning_most, np.pi), np.pi),
        np.where(np.abs(turning) > half * turning_slope, np.sign(turning), 0.0),
        np.where(np.abs(pace) > half * pace_slope, np.sign(pace), 0.0),
    )


def _of_pivots(envelope: Envelope, low: FloatArray, high: FloatArray, index: IntArray) -> Boxes:
    half = 0.5 * (high - low)
    samples = envelope.pivot_samples(index, 0.5 * (low + high) - envelope.starts[index])
    pace, sign = np.abs(samples.pace), np.sign(samples.pace)
    bend = envelope.pivots.sense[index]
    boxes = (half * pace, 0.5 * half * half * pace, half, bend, sign)
    return samples.points, samples.tangents, samples.pace, *boxes


def halved(envelope: Envelope, cells: Cells) -> Cells:
    """The cells halved, (2 n,): the lower half of cell k at 2 k, the upper one at 2 k + 1.

    GeometryError if there are more than `MOST` and `MORE` allow.
    """
    if not len(cells):
        return cells
    if len(cells) > MOST + MORE * len(envelope.borders):
        raise unresolved(envelope, cells.low[np.argsort(cells.high - cells.low)])
    middle = 0.5 * (cells.low + cells.high)
    low = np.column_stack((cells.low, middle)).ravel()
    high = np.column_stack((middle, cells.high)).ravel()
    return enclose(envelope, low, high, np.repeat(cells.origin, 2))


def unresolved(envelope: Envelope, places: FloatArray) -> GeometryError:
    """The error of a division that does not end, at the first of `places` (n,)."""
    angle = np.degrees(envelope.angles_at(envelope.within(places[:1])))[0]
    return GeometryError(
        f"at cam angle {angle:.6f} deg the flank bends more tightly than can be resolved, or keeps"
        " too near to a cusp: it cannot be decided what is left of it"
    )


MOST_PAIRS = 4_000_000
"""Most pairs examined together; more means a flank that lies on itself."""


def overlapping(envelope: Envelope, cells: Cells) -> tuple[IntArray, IntArray]:
    """(k,), (k,) indices i < j of the `cells` of `envelope` whose upright bounding boxes overlap.

    GeometryError if there are more than `MOST_PAIRS`.
    """
    tangent = cells.tangent
    wide = np.abs(tangent.real) * cells.along + np.abs(tangent.imag) * cells.across
    high = np.abs(tangent.imag) * cells.along + np.abs(tangent.real) * cells.across
    left, right = cells.middle.real - wide, cells.middle.real + wide
    order = np.argsort(left, kind="stable")
    # In the order of their left sides, cell k overlaps those that begin before it ends.
    last = np.searchsorted(left[order], right[order], side="right")
    counts = last - np.arange(len(order)) - 1
    if np.sum(counts) > MOST_PAIRS:
        worst = order[[int(np.argmax(counts))]]
        angle = np.degrees(envelope.angles_at(cells.low[worst]))[0]
        raise GeometryError(
            f"about cam angle {angle:.6f} deg too many stretches of the flank lie too close to be"
            " separated: it cannot be decided what is left of it"
        )
    one, step = grouped(counts)
    first, second = order[one], order[one + 1 + step]
    apart = np.abs(cells.middle.imag[first] - cells.middle.imag[second])
    near = apart <= high[first] + high[second]
    first, second = first[near], second[near]
    return np.minimum(first, second), np.maximum(first, second)


def meet(one: Cells, other: Cells) -> BoolArray:
    """(k,) False where the boxes of the cells k of both provably have no point in common."""
    way = other.middle - one.middle
    turned = np.conj(one.tangent) * other.tangent
    cosine, sine = np.abs(turned.real), np.abs(turned.imag)
    from_one, from_other = np.conj(one.tangent) * way, np.conj(other.tangent) * way
    touching: BoolArray = (
        (np.abs(from_one.real) <= one.along + cosine * other.along + sine * other.across)
        & (np.abs(from_one.imag) <= one.across + sine * other.along + cosine * other.across)
        & (np.abs(from_other.real) <= other.along + cosine * one.along + sine * one.across)
        & (np.abs(from_other.imag) <= other.across + sine * one.along + cosine * one.across)
    )
    return touching


def cross_once(one: Cells, other: Cells) -> BoolArray:
    """(k,) True where the tangents of both cells provably differ: they cross at most once."""
    turned = np.conj(one.tangent) * other.tangent
    between = np.abs(np.angle(turned))
    between = np.minimum(between, np.pi - between)
    once: BoolArray = between > one.turn + other.turn
    return once
