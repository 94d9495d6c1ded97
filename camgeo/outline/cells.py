"""Cells of an envelope: boxes that surely hold a stretch of it, with the cone of its tangents.

Over a cell of half-width h about its middle m, with Z the pitch curve, theta = arg Z' and the pace
a = |Z'| - sigma d theta' of the parallel at d:

    W(m + u) - W(m) = integral of a exp(i theta),   |theta - theta_m| <= Theta_1 h,

so that W leaves the tangent at m by at most h^2/2 A_0 Theta_1 to the side and goes at most
|a_m| h + A_1 h^2/2 along it, with Theta_1 >= |theta'|, A_0 >= |a|, A_1 >= |a'| over the cell. These
follow from Z', Z'' in the middle and a bound of |Z'''|.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from camgeo.errors import GeometryError
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from camgeo.outline.envelope import Envelope
from camgeo.outline.path import Pivot
from camgeo.units import TURN

ROUNDING = 2.0**-52 * 16.0
"""Rounding of a point, as a share of the largest length that enters it."""

MOST = 1_000_000
"""Cells halved at a time; a flank takes some thousand, and a hundred for each segment of a motion
that has very many."""

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
    bend : (n,) +1 or -1 where the tangent surely turns counter-clockwise or clockwise all through
        the cell, else 0.
    sign : (n,) +1 or -1 where the pace surely has that sign all through the cell, else 0.
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
        """Those at `which`."""
        return Cells(*(getattr(self, name)[which] for name in Cells.__slots__))


def enclose(envelope: Envelope, low: FloatArray, high: FloatArray, origin: IntArray) -> Cells:
    """Boxes of the cells [low, high] (n,), which must not reach across a border."""
    index = envelope.element_at(0.5 * (low + high))
    parts: list[tuple[IntArray, Boxes]] = []
    for k in np.flatnonzero(envelope.is_pivot):
        here = np.flatnonzero(index == k)
        if len(here):
            parts.append((here, _of_pivot(envelope, int(k), low[here], high[here])))
    here = np.flatnonzero(~envelope.is_pivot[index])
    if len(here) == len(low):
        boxes = _of_stretch(envelope, low, high, index)
    else:
        if len(here):
            parts.append((here, _of_stretch(envelope, low[here], high[here], index[here])))
        order = np.argsort(np.concatenate([places for places, _ in parts]))
        columns = zip(*(boxes for _, boxes in parts), strict=True)
        boxes = tuple(np.concatenate(column)[order] for column in columns)
    middle, tangent, pace, along, across, turn, bend, sign = boxes
    rounding = ROUNDING * (np.abs(middle) + abs(envelope.curve.distance))
    along, across = along + rounding + PLACE * np.abs(pace), across + rounding
    return Cells(low, high, origin, middle, tangent, pace, along, across, turn, bend, sign)


Boxes = tuple[Any, ...]
"""The arrays of `Cells` from `middle` to `sign`."""


def _of_stretch(envelope: Envelope, low: FloatArray, high: FloatArray, index: IntArray) -> Boxes:
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
        turning_most = np.minimum(ratio, np.abs(turning) + half * turning_slope)
        pace_slope = second + offset * turning_slope
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


def _of_pivot(envelope: Envelope, number: int, low: FloatArray, high: FloatArray) -> Boxes:
    pivot = envelope.elements[number]
    assert isinstance(pivot, Pivot)  # chosen by the caller
    half = 0.5 * (high - low)
    course = envelope.course_of_pivot(pivot, 0.5 * (low + high) - envelope.starts[number])
    pace = np.abs(course.pace)
    bend = np.full(len(half), np.sign(pivot.sweep))
    return (
        course.points, course.tangents, course.pace, half * pace, 0.5 * half * half * pace, half,
        bend, np.sign(course.pace),
    )  # fmt: skip


def halved(envelope: Envelope, cells: Cells) -> Cells:
    """The cells halved, (2 n,): the lower half of cell k at 2 k, the upper one at 2 k + 1.

    GeometryError if there are more than `MOST`.
    """
    if len(cells) > MOST:
        raise GeometryError(
            "the flank bends more tightly than can be looked into; it has no outline"
        )
    middle = 0.5 * (cells.low + cells.high)
    low = np.column_stack((cells.low, middle)).ravel()
    high = np.column_stack((middle, cells.high)).ravel()
    return enclose(envelope, low, high, np.repeat(cells.origin, 2))
