"""Envelope of the roller on one flank: the working curve, and the turns where its tangent jumps;
and the points in which it crosses itself.

Where the follower's velocity jumps the roller centre has a corner, and the roller turns about it:
the flank continues along an arc of the roller's radius. A path parameter runs through both: the cam
angle along the curve, the angle turned along such an arc.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from camgeo.errors import GeometryError
from camgeo.geometry.outline.path import Element, Pivot, Stretch
from camgeo.geometry.pieces import rigid_centres
from camgeo.geometry.pitch_curve import WorkingCurve, joints
from camgeo.numeric.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
    Side,
    ascending,
    frozen,
    grouped,
    joined,
    taken,
)
from camgeo.numeric.kept import Kept
from camgeo.numeric.quadrature import gauss
from camgeo.units import TURN

KINK = 1e-9
"""A smaller angle between the tangents at a joint [rad] is rounding of a smooth joint."""


@dataclass(frozen=True, slots=True, eq=False)
class EnvelopeSamples:
    """Samples of the envelope at n places.

    Attributes
    ----------
    points : (n,) complex [mm].
    tangents : (n,) complex, unit, in the direction of growing cam angle.
    pace : (n,) signed length passed per unit of the path parameter; negative in undercut.
    """

    points: ComplexArray
    tangents: ComplexArray
    pace: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Pivots:
    """The turns about a point among m elements: `Pivot.centre`, `normal` at the start, and +1 or -1
    for the sense of the sweep. All are 0 at the numbers of stretches.
    """

    centre: ComplexArray
    normal: ComplexArray
    sense: FloatArray


@dataclass(frozen=True, eq=False)
class Envelope:
    """The closed envelope at the signed distance of `curve`.

    Attributes
    ----------
    curve : the parallel of the pitch curve; Z' must not vanish.
    kept : the last result of each function of the envelope, see `kept_with_owner`.
    """

    curve: WorkingCurve
    kept: Kept = field(default_factory=dict, init=False, repr=False, compare=False)

    @cached_property
    def elements(self) -> tuple[Element, ...]:
        """One stretch, or turn and stretch for each corner of the pitch curve, in turn."""
        curve = self.curve
        met = joints(curve.pitch)
        angles = met.phi[met.turns > KINK]
        if not len(angles):
            return (Stretch(curve, 0.0, TURN),)
        arriving, leaving = (curve.tangent(angles, side) for side in ("left", "right"))
        sweeps = np.angle(leaving * np.conj(arriving))
        centres = curve.pitch.point(angles)
        chain: list[Element] = []
        ends = np.append(angles[1:], angles[0] + TURN)
        for k, (start, end) in enumerate(zip(map(float, angles), map(float, ends), strict=True)):
            # The outward normal is n = i sigma t.
            normal = 1j * curve.pitch.rotation * complex(arriving[k])
            chain.append(
                Pivot(
                    complex(centres[k]),
                    curve.distance,
                    normal,
                    float(sweeps[k]),
                    # A corner at cam angle 0 ends the stretch before it at a full turn.
                    phi_start=start if start > 0.0 else TURN,
                    phi_end=start,
                )
            )
            chain.append(Stretch(curve, start, end))
        return tuple(chain)

    @cached_property
    def starts(self) -> FloatArray:
        """(m,) path parameter at which each element begins, from 0 on."""
        return frozen(np.concatenate(([0.0], np.cumsum(self._spans)[:-1])), np.float64)

    @cached_property
    def total(self) -> float:
        """Path parameter after one turn; 2 pi if there is no corner."""
        return float(np.sum(self._spans)) if len(self.elements) > 1 else TURN

    @cached_property
    def is_pivot(self) -> BoolArray:
        """(m,) whether each element is a turn about a corner of the pitch curve."""
        return frozen([isinstance(element, Pivot) for element in self.elements], np.bool_)

    @cached_property
    def pivots(self) -> Pivots:
        """The turns about corners of the pitch curve."""
        rows = [
            (element.centre, element.normal, math.copysign(1.0, element.sweep))
            if isinstance(element, Pivot)
            else (0j, 0j, 0.0)
            for element in self.elements
        ]
        centre, normal, sense = np.array(rows, dtype=np.complex128).T
        return Pivots(centre, normal, sense.real)

    @cached_property
    def angle_offsets(self) -> FloatArray:
        """(m,) cam angle minus path parameter along each element; 0 for turns."""
        return frozen(np.where(self.is_pivot, 0.0, self._angles - self.starts), np.float64)

    @cached_property
    def _spans(self) -> FloatArray:
        spans = [
            abs(element.sweep) if isinstance(element, Pivot) else element.end - element.start
            for element in self.elements
        ]
        return np.array(spans)

    @cached_property
    def borders(self) -> FloatArray:
        """(k,) path parameters where the formula changes, from 0 on."""
        return self._places(self.curve.borders)

    @cached_property
    def breaks(self) -> FloatArray:
        """(k,) path parameters where the curvature may jump, from 0 on."""
        return self._places(self.curve.breaks)

    def _places(self, angles: FloatArray) -> FloatArray:
        """Path parameters of the cam angles `angles` in [0, 2 pi) and of all ends of elements."""
        elements, starts = self.elements, self.starts
        angles = np.concatenate((angles, angles + TURN))
        marks = [starts]
        for start, element in zip(starts, elements, strict=True):
            if isinstance(element, Stretch):
                inner = angles[(angles > element.start) & (angles < element.end)]
                marks.append(start + (inner - element.start))
        return frozen(ascending(np.concatenate(marks)), np.float64)

    @cached_property
    def undivided(self) -> FlankCells:
        """The first cells if there are no cusps."""
        return first_cells(self, np.empty(0))

    def element_indices(self, places: FloatArray) -> IntArray:
        """(n,) index of the element at each of `places` (n,) in [0, total)."""
        return np.asarray(np.searchsorted(self.starts, places, side="right") - 1)

    def wrapped(self, places: FloatArray) -> FloatArray:
        """(n,) `places` reduced to [0, total)."""
        # The subtraction may round up to the total itself, which is the start again.
        reduced = places - self.total * np.floor(places / self.total)
        return np.asarray(np.where(reduced >= self.total, 0.0, reduced))

    def cam_angles(self, places: FloatArray) -> FloatArray:
        """Cam angles [rad] in [0, 2 pi) at path parameters of any shape in [0, total)."""
        index = self.element_indices(places)
        angles = self._angles[index] + np.where(
            self.is_pivot[index], 0.0, places - self.starts[index]
        )
        return np.asarray(np.where(angles >= TURN, angles - TURN, angles))

    @cached_property
    def _angles(self) -> FloatArray:
        """(m,) cam angle [rad] at which each stretch begins, or of a turn."""
        return np.array(
            [
                element.phi_end if isinstance(element, Pivot) else element.start
                for element in self.elements
            ]
        )

    def path_parameter(self, angle: float, side: Side = "right") -> float:
        """Path parameter of a cam angle [rad] in [0, 2 pi), after a turn that is there, or before
        it if it is seen from the left.
        """
        left = side == "left"
        for start, element in zip(self.starts, self.elements, strict=True):
            if isinstance(element, Stretch):
                wraps = angle < element.start or (left and angle == element.start)
                beyond = angle + TURN if wraps else angle
                if beyond < element.end or (left and beyond == element.end):
                    return float(start) + (beyond - element.start)
        # A turn added to an angle just below the first stretch may round up to the end of the last.
        pairs = zip(self.starts, self.elements, strict=True)
        return next(float(start) for start, element in pairs if isinstance(element, Stretch))

    def samples(self, places: FloatArray) -> EnvelopeSamples:
        """Points, tangents and pace at the path parameters `places` (n,), any number of turns."""
        places = self.wrapped(np.asarray(places, dtype=np.float64))
        if len(self.elements) == 1:
            return self._along(places)
        index = self.element_indices(places)
        points, tangents = np.empty((2, len(places)), dtype=np.complex128)
        pace = np.empty(len(places))
        on_pivot = self.is_pivot[index]
        turned = places - self.starts[index]
        angles = places + self.angle_offsets[index]
        for here, part in (
            (~on_pivot, self._along(angles[~on_pivot])),
            (on_pivot, self.pivot_samples(index[on_pivot], turned[on_pivot])),
        ):
            points[here], tangents[here], pace[here] = part.points, part.tangents, part.pace
        return EnvelopeSamples(points, tangents, pace)

    def pivot_samples(self, index: IntArray, turned: FloatArray) -> EnvelopeSamples:
        """The arcs about corners of the pitch curve, the elements `index` (n,), `turned` (n,) [rad]
        from their starts.
        """
        sense, rotation = self.pivots.sense[index], self.curve.pitch.rotation
        normal = self.pivots.normal[index] * np.exp(1j * sense * turned)
        distance = self.curve.distance
        points = self.pivots.centre[index] + distance * normal
        return EnvelopeSamples(points, -1j * rotation * normal, -rotation * distance * sense)

    def _along(self, angles: FloatArray) -> EnvelopeSamples:
        """The parallel at cam angles, from the right."""
        pitch, distance = self.curve.pitch, self.curve.distance
        jet = pitch.jet(angles)
        z1, z2 = jet[1], jet[2]
        speed = np.abs(z1)
        tangents = z1 / speed
        # The rate at which the direction of Z' turns: Im(conj(Z') Z'') / |Z'|^2.
        turning = (z1.real * z2.imag - z1.imag * z2.real) / (speed * speed)
        normal = 1j * pitch.rotation * tangents
        return EnvelopeSamples(
            jet[0] + distance * normal, tangents, speed - pitch.rotation * distance * turning
        )


# -- cells ----------------------------------------------------------------------------------------
# Cells of an envelope: boxes that enclose a stretch of it, with the cone of its tangents.
#
# Over a cell of half-width h about its middle m, with Z the pitch curve, theta = arg Z' and the
# pace a = |Z'| - sigma d theta' of the parallel at d:
#
#     W(m + u) - W(m) = integral of a exp(i theta),   |theta - theta_m| <= Theta_1 h,
#
# so that W leaves the tangent at m by at most h^2/2 A_0 Theta_1 to the side and goes at most |a_m|
# h + A_1 h^2/2 along it, with Theta_1 >= |theta'|, A_0 >= |a|, A_1 >= |a'| over the cell. These
# follow from Z', Z'' in the middle and a bound of |Z'''|.
#
# Pairs of cells whose boxes overlap are found by sorting along one axis, then by separating axes.


ROUNDING = 2.0**-52 * 16.0
"""Rounding of a point, as a fraction of the largest length that enters it."""

MOST, MORE = 20_000, 500
"""Most cells in a halving: the first number, plus the second for each border of the flank. A flank
needs some thousand, and a hundred per segment if its motion has very many."""

PLACE = 2.0**-52 * 32.0
"""Rounding of a path parameter [rad]: a few units in the last place of a turn."""


@dataclass(frozen=True, slots=True, eq=False)
class FlankCells:
    """n cells of an envelope, each with a box that encloses that stretch of it.

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

    def some(self, which: IntArray | BoolArray) -> FlankCells:
        """The cells at `which`."""
        return taken(self, which)


def enclose(envelope: Envelope, low: FloatArray, high: FloatArray, origin: IntArray) -> FlankCells:
    """Boxes of the cells [low, high] (n,), which must not reach across a border."""
    index = envelope.element_indices(0.5 * (low + high))
    on_pivot = envelope.is_pivot[index]
    places, boxes = [], []
    for which, enclose_part in ((~on_pivot, _stretch_boxes), (on_pivot, _pivot_boxes)):
        if np.any(which):
            places.append(np.flatnonzero(which))
            boxes.append(enclose_part(envelope, low[which], high[which], index[which]))
    order = np.argsort(np.concatenate(places))
    columns = (np.concatenate(column)[order] for column in zip(*boxes, strict=True))
    middle, tangent, pace, along, across, turn, bend, sign = columns
    rounding = ROUNDING * (np.abs(middle) + abs(envelope.curve.distance))
    along, across = along + rounding + PLACE * np.abs(pace), across + rounding
    return FlankCells(low, high, origin, middle, tangent, pace, along, across, turn, bend, sign)


Boxes = tuple[Any, ...]
"""The arrays of `FlankCells` from `middle` to `sign`."""


def _stretch_boxes(envelope: Envelope, low: FloatArray, high: FloatArray, index: IntArray) -> Boxes:
    """The boxes of cells on stretches of the parallel, see above."""
    curve, pitch = envelope.curve, envelope.curve.pitch
    offset = abs(curve.distance)
    half = 0.5 * (high - low)
    shift = envelope.angle_offsets[index]
    middle = 0.5 * (low + high) + shift
    # Bounds are those of one turn: cells are reduced to it, and their ends clipped against
    # rounding.
    turns = np.where(middle >= TURN, TURN, 0.0)
    ends = np.maximum(low + shift - turns, 0.0), np.minimum(high + shift - turns, TURN)
    jet, (_, _, third) = pitch.jet_and_bounds(*ends)
    z1, z2 = jet[1], jet[2]
    speed, size = np.abs(z1), np.abs(z2)
    tangent = z1 / speed
    turning = (z1.real * z2.imag - z1.imag * z2.real) / (speed * speed)
    pace = speed - pitch.rotation * curve.distance * turning
    # Bounds of |Z'| from below and of |Z''| from above over the cell.
    slowest = speed - half * (size + 0.5 * half * third)
    second = size + half * third
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        ratio = np.where(slowest > 0.0, second / slowest, np.inf)
        turning_slope = np.where(slowest > 0.0, third / slowest, np.inf) + 2.0 * ratio * ratio
        pace_slope = second + offset * turning_slope
        # An arc that is run through evenly.
        circular = ~np.isnan(rigid_centres(pitch, middle))
        turning_slope[circular], pace_slope[circular] = 0.0, 0.0
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


def _pivot_boxes(envelope: Envelope, low: FloatArray, high: FloatArray, index: IntArray) -> Boxes:
    """The boxes of cells on arcs about corners of the pitch curve."""
    half = 0.5 * (high - low)
    samples = envelope.pivot_samples(index, 0.5 * (low + high) - envelope.starts[index])
    pace, sign = np.abs(samples.pace), np.sign(samples.pace)
    bend = envelope.pivots.sense[index]
    boxes = (half * pace, 0.5 * half * half * pace, half, bend, sign)
    return samples.points, samples.tangents, samples.pace, *boxes


def halved(envelope: Envelope, cells: FlankCells) -> FlankCells:
    """The cells halved, (2 n,): the lower half of cell k at 2 k, the upper one at 2 k + 1.

    GeometryError if there are more than `MOST` and `MORE` allow.
    """
    if not len(cells):
        return cells
    if len(cells) > MOST + MORE * len(envelope.borders):
        raise unresolved_error(envelope, cells.low[np.argsort(cells.high - cells.low)])
    middle = 0.5 * (cells.low + cells.high)
    # Interleaved: the halves of cell k are the cells 2 k and 2 k + 1.
    low = np.column_stack((cells.low, middle)).ravel()
    high = np.column_stack((middle, cells.high)).ravel()
    return enclose(envelope, low, high, np.repeat(cells.origin, 2))


def unresolved_error(envelope: Envelope, places: FloatArray) -> GeometryError:
    """The error for a division that does not end, with the cam angle of the first of `places`."""
    angle = np.degrees(envelope.cam_angles(envelope.wrapped(places[:1])))[0]
    return GeometryError(
        f"at cam angle {angle:.6f} deg the flank bends too tightly to be resolved, or stays too"
        " close to a cusp: it cannot be decided what is left of it"
    )


MOST_PAIRS = 4_000_000
"""Most pairs examined together; more means a flank that lies on itself."""


def overlapping(envelope: Envelope, cells: FlankCells) -> tuple[IntArray, IntArray]:
    """(k,), (k,) indices i < j of the `cells` of `envelope` whose upright bounding boxes overlap.

    GeometryError if there are more than `MOST_PAIRS`.
    """
    tangent = cells.tangent
    # Half sides of the upright rectangle about a turned box.
    wide = np.abs(tangent.real) * cells.along + np.abs(tangent.imag) * cells.across
    high = np.abs(tangent.imag) * cells.along + np.abs(tangent.real) * cells.across
    left, right = cells.middle.real - wide, cells.middle.real + wide
    order = np.argsort(left, kind="stable")
    # In the order of their left sides, cell k overlaps those that begin before it ends.
    last = np.searchsorted(left[order], right[order], side="right")
    counts = last - np.arange(len(order)) - 1
    if np.sum(counts) > MOST_PAIRS:
        worst = order[[int(np.argmax(counts))]]
        angle = np.degrees(envelope.cam_angles(cells.low[worst]))[0]
        raise GeometryError(
            f"near cam angle {angle:.6f} deg too many stretches of the flank lie too close to be"
            " separated: it cannot be decided what is left of it"
        )
    one, step = grouped(counts)
    first, second = order[one], order[one + 1 + step]
    height_gap = np.abs(cells.middle.imag[first] - cells.middle.imag[second])
    near = height_gap <= high[first] + high[second]
    first, second = first[near], second[near]
    return np.minimum(first, second), np.maximum(first, second)


def meet(one: FlankCells, other: FlankCells) -> BoolArray:
    """(k,) False where the boxes of the cells k of both provably have no point in common."""
    way = other.middle - one.middle
    turned = np.conj(one.tangent) * other.tangent
    cosine, sine = np.abs(turned.real), np.abs(turned.imag)
    from_one, from_other = np.conj(one.tangent) * way, np.conj(other.tangent) * way
    return np.asarray(
        (np.abs(from_one.real) <= one.along + cosine * other.along + sine * other.across)
        & (np.abs(from_one.imag) <= one.across + sine * other.along + cosine * other.across)
        & (np.abs(from_other.real) <= other.along + cosine * one.along + sine * one.across)
        & (np.abs(from_other.imag) <= other.across + sine * one.along + cosine * one.across)
    )


def cross_once(one: FlankCells, other: FlankCells) -> BoolArray:
    """(k,) True where the tangents of both cells provably differ: they cross at most once."""
    turned = np.conj(one.tangent) * other.tangent
    angle = np.abs(np.angle(turned))
    # Between the lines: it does not matter which way either is traversed.
    angle = np.minimum(angle, np.pi - angle)
    return np.asarray(angle > one.turn + other.turn)


# -- division -------------------------------------------------------------------------------------
# The first division of an envelope into cells, and what is proved of runs of neighbouring cells.
#
# Two points of a run coincide only if the integral of a exp(i theta) between them vanishes (a the
# pace, theta the direction of the tangent). If theta stays within less than pi,
#
# - it does not vanish where a keeps its sign: all of it has a part in the middle direction;
# - nor where a changes sign once, at theta_c, and theta goes on growing or falling: then
#   a sin(theta - theta_c) keeps its sign;
# - nor where a changes sign once and theta stays within a right angle: the way between two points
#   of a branch is never square to a tangent of it then, so that the distance of a point of the
#   branch from the roller centre Z has no extreme but at its own cam angle. It is smallest there,
#   |d|, where a > 0, and largest where a < 0: the roller at the cusp touches neither branch again,
#   one lies outside of it and the other inside;
# - where a changes sign twice, + - +, and theta grows or falls steadily, there is at most one such
#   pair: of two, the one inside the other would need two sums of directions from cones that lie
#   apart to be equal, and two side by side a sum in one half plane to vanish.
#
# So a crossing within a short run takes two cusps, and these make one crossing at most: the swallow
# tail. All other crossings are between cells that lie apart.


WIDEST = math.pi / 16.0
"""Longest initial cell [rad of the path parameter]."""

STEEPEST = 0.3
"""Largest angle between tangents in a cell and in its middle [rad], so that boxes are slim."""

NARROWEST = 4.0 * np.spacing(TURN)
"""Shortest cell [rad of the path parameter] that doubles resolve: reached in 50 halvings."""

STRAIGHT = 0.98 * math.pi
"""Angle [rad] within which the tangents of a short run stay: below pi, with room for rounding."""


@dataclass(frozen=True, slots=True, eq=False)
class Division:
    """An envelope in n cells that follow each other, none across a border or a cusp.

    Attributes
    ----------
    envelope : what is divided.
    cells : in order.
    negative : (n,) True where the pace is negative: undercut.
    turned : (2 n + 1,) sum of the largest turns of the tangent up to each cell, over two turns.
    flips : (2 n + 1,) sign changes of the pace from cell to cell up to each cell, likewise.
    changes : (2 n + 1,) changes of the sense in which the tangent turns, likewise.
    unsure : (2 n + 1,) number of cells up to each that do not provably turn one way.
    """

    envelope: Envelope
    cells: FlankCells
    negative: BoolArray
    turned: FloatArray
    flips: IntArray
    changes: IntArray
    unsure: IntArray

    def is_plain(self, first: IntArray, last: IntArray) -> BoolArray:
        """(k,) True where the run of cells `first` to `last` (k,) provably does not cross itself.

        `last` may be up to n cells beyond the end of the first turn, and is not below `first`.
        """
        short = self.turned[last + 1] - self.turned[first] < STRAIGHT
        flips = self.flips[last] - self.flips[first]
        one_way = self.changes[last] - self.changes[first] == 0
        one_way &= self.unsure[last + 1] == self.unsure[first]
        square = self.turned[last + 1] - self.turned[first] < 0.5 * STRAIGHT
        return np.asarray(short & ((flips == 0) | ((flips == 1) & (one_way | square))))


def divide(envelope: Envelope, cusps: FloatArray) -> Division:
    """Divide `envelope` at its borders, at `cusps` (k,) and as finely as slim boxes require.

    Parameters
    ----------
    cusps : path parameters where the pace passes zero or jumps to the other sign.

    Raises
    ------
    GeometryError
        If a cell as short as doubles resolve still bends, or too many cells do: a curvature beyond
        double precision, as at a dead centre.
    """
    cells = first_cells(envelope, cusps) if len(cusps) else envelope.undivided
    while True:
        wide, sharp = cells.high - cells.low > NARROWEST, cells.turn > STEEPEST
        if np.any(sharp & ~wide):
            raise unresolved_error(envelope, cells.low[sharp & ~wide])
        coarse = sharp | (_touches(cells, cusps) & (cells.bend == 0.0))
        coarse &= wide
        if not np.any(coarse):
            break
        fine = halved(envelope, cells.some(coarse))
        cells = joined([cells.some(~coarse), fine])
        cells = cells.some(np.argsort(cells.low, kind="stable"))
    cells = replace(cells, origin=np.arange(len(cells)))
    negative = cells.pace < 0.0
    return Division(
        envelope,
        cells,
        negative,
        _sums(2.0 * cells.turn),
        _sums(negative != np.roll(negative, -1)),
        _sums(cells.bend != np.roll(cells.bend, -1)),
        _sums(cells.bend == 0.0),
    )


def first_cells(envelope: Envelope, cusps: FloatArray) -> FlankCells:
    """Cells of at most `WIDEST`, none across a border of `envelope` or one of `cusps` (k,)."""
    marks = ascending(np.concatenate((envelope.borders, cusps, [envelope.total])))
    spans = np.diff(marks)
    parts = np.maximum(1, np.ceil(spans / WIDEST)).astype(np.intp)
    index, step = grouped(parts)
    low = marks[index] + spans[index] * step / parts[index]
    high = np.append(low[1:], envelope.total)
    return enclose(envelope, low, high, np.arange(len(low)))


def _touches(cells: FlankCells, cusps: FloatArray) -> BoolArray:
    """(n,) whether a cell begins or ends at one of the `cusps` (k,)."""
    if not len(cusps):
        return np.zeros(len(cells), dtype=np.bool_)
    # The last cell ends where the first one begins.
    high = np.append(cells.low[1:], cells.low[0])
    return np.asarray(np.isin(cells.low, cusps) | np.isin(high, cusps))


def _sums(values: FloatArray | BoolArray) -> NDArray[Any]:
    """Sums before each cell and after the last, over two turns; of truth values, how many hold."""
    # Over two turns, so that runs across the start are differences of two sums as well.
    return np.concatenate(([0], np.cumsum(np.concatenate((values, values)))))


# -- crossings ------------------------------------------------------------------------------------
# The crossings of an envelope with itself, all of them: boxes exclude, halving decides, Newton
# refines.
#
# Cells that lie apart are excluded by their boxes or halved; where the tangents of two cells
# provably differ they cross at most once, and Newton's method finds whether they do. So it does for
# the one crossing of a swallow tail, far below the size at which points of the flank are distinct.


HALVINGS = 60
"""Most rounds of halving."""

MOST_UNDECIDED = 20_000
"""Most pairs of cells in a round; more means a flank that lies on itself along a stretch."""

NEWTON = 8
"""Newton steps; from a cell in which the tangents provably differ they converge at once."""

OUTSIDE = 0.05
"""Distance outside its cell at which a crossing still counts for it, as a fraction of the cell; a
crossing found by two neighbours counts once."""

SAME, TOUCHING = 1e-9, 1e-5
"""Crossings, and contacts, whose path parameters differ by less are the same."""


@dataclass(frozen=True, slots=True)
class Node:
    """A crossing by its path parameters in [0, total), first < second.

    `touching` if the flank only touches itself there, to rounding.
    """

    first: float
    second: float
    point: complex
    touching: bool = False


def find_nodes(envelope: Envelope, backward: list[tuple[float, float]]) -> tuple[Node, ...]:
    """All crossings and contacts of `envelope`, given the ranges in which it runs backwards."""
    ends = np.array([place for span in backward for place in span])
    division = divide(envelope, envelope.wrapped(ends) if len(ends) else ends)
    tails = swallow_tails(division, backward) if backward else []
    pairs = _candidate_pairs(division, [run for _, run in tails])
    nodes = [node for node, _ in tails]
    nodes += _decide(envelope, division.cells, pairs)
    return _distinct_nodes(nodes, envelope.total)


def _candidate_pairs(division: Division, runs: list[CellRun]) -> tuple[IntArray, IntArray]:
    """Pairs of cells that may cross and do not belong to one of the `runs`, whose crossing is
    known.
    """
    first, second = overlapping(division.envelope, division.cells)
    count = len(division.cells)
    plain = division.is_plain(first, second) | division.is_plain(second, first + count)
    # Both inside a run is what is known: how far a run gets that holds each cell.
    reach = np.zeros(count, dtype=np.intp)
    for run in runs:
        reach[run.first] = max(reach[run.first], run.first + run.cells)
        # A run across the end goes on from the first cell.
        reach[0] = max(reach[0], run.first + run.cells - count)
    reach = np.maximum.accumulate(reach)
    plain |= (reach[first] > second) | (reach[second] > first + count)
    first, second = first[~plain], second[~plain]
    both = meet(division.cells.some(first), division.cells.some(second))
    return first[both], second[both]


def _decide(envelope: Envelope, cells: FlankCells, pairs: tuple[IntArray, IntArray]) -> list[Node]:
    """Halve until each pair is apart, crosses once, or is too small to be halved."""
    all_nodes: list[Node] = []
    first, second = pairs
    for _ in range(HALVINGS):
        if not len(first):
            return all_nodes
        if len(first) > MOST_UNDECIDED:
            break
        one, other = cells.some(first), cells.some(second)
        once = cross_once(one, other)
        resolved = np.zeros(len(first), dtype=np.bool_)
        small = ~once & _slim(envelope, one) & _slim(envelope, other)
        if np.any(once):
            known, blurred, nodes = _newton(envelope, one.some(once), other.some(once))
            resolved[once], small[once] = known, blurred
            all_nodes += nodes
        small |= ~resolved & _tiny(envelope, one) & _tiny(envelope, other)
        for k in np.flatnonzero(small):
            point = complex(one.middle[k])
            all_nodes.append(_node(float(one.low[k]), float(other.low[k]), point, touching=True))
        resolved |= small
        cells, first, second = _refine_pairs(envelope, cells, first[~resolved], second[~resolved])
    if not len(first):
        return all_nodes
    one, other = cells.some(first), cells.some(second)
    gaps = np.abs(one.middle - other.middle)
    nearest = [int(np.argmin(gaps))]
    angles = [math.degrees(envelope.cam_angles(branch.low[nearest])[0]) for branch in (one, other)]
    raise GeometryError(
        f"near the cam angles {angles[0]:.6f} and {angles[1]:.6f} deg two stretches of the flank"
        f" lie on each other, to {gaps[nearest[0]]:.2g} mm: it cannot be decided what is left of it"
    )


def _slim(envelope: Envelope, cells: FlankCells) -> BoolArray:
    """Cells that bend by no more than rounding: their neighbours there touch them."""
    size = np.abs(cells.middle) + abs(envelope.curve.distance)
    return np.asarray(cells.across <= 2.0 * ROUNDING * size)


def _tiny(envelope: Envelope, cells: FlankCells) -> BoolArray:
    """Cells no longer than rounding, on the curve or in the path parameter."""
    size = np.abs(cells.middle) + abs(envelope.curve.distance)
    tiny: BoolArray = cells.along <= 4.0 * ROUNDING * size
    tiny |= cells.high - cells.low <= 4.0 * np.spacing(cells.high)
    return tiny


def _refine_pairs(
    envelope: Envelope, cells: FlankCells, first: IntArray, second: IntArray
) -> tuple[FlankCells, IntArray, IntArray]:
    """The pairs of the halves of each pair whose boxes still meet."""
    if not len(first):
        return cells, first, second
    # A cell that belongs to several pairs is halved once.
    used, place = np.unique_inverse(np.concatenate((first, second)))
    fine = halved(envelope, cells.some(used))
    one, other = 2 * place[: len(first)], 2 * place[len(first) :]
    # All four pairs of halves.
    one = np.concatenate((one, one, one + 1, one + 1))
    other = np.concatenate((other, other + 1, other, other + 1))
    both = meet(fine.some(one), fine.some(other))
    return fine, one[both], other[both]


def _newton(
    envelope: Envelope, one: FlankCells, other: FlankCells
) -> tuple[BoolArray, BoolArray, list[Node]]:
    """The crossings of pairs of cells that cross at most once.

    (k,) True where a pair crosses; (k,) True where both are too nearly parallel for their points to
    decide; and the crossings.
    """
    x, y = 0.5 * (one.low + one.high), 0.5 * (other.low + other.high)
    wide_x, wide_y = one.high - one.low, other.high - other.low
    points = one.middle
    inside = np.ones(len(x), dtype=np.bool_)
    for _ in range(NEWTON):
        at_x, at_y = envelope.samples(x), envelope.samples(y)
        gap = at_y.points - at_x.points
        points = 0.5 * (at_x.points + at_y.points)
        # a_x t_x dx - a_y t_y dy = gap
        sine = (np.conj(at_x.tangents) * at_y.tangents).imag
        if not np.any(inside):  # no place moves any more
            break
        with np.errstate(divide="ignore", invalid="ignore"):
            # Cramer's rule for the two parts of that equation.
            dx = (np.conj(at_y.tangents) * gap).imag / (-sine * at_x.pace)
            dy = (np.conj(at_x.tangents) * gap).imag / (-sine * at_y.pace)
        inside &= np.isfinite(dx) & np.isfinite(dy)
        x = np.where(inside, x + np.clip(dx, -wide_x, wide_x), x)
        y = np.where(inside, y + np.clip(dy, -wide_y, wide_y), y)
        inside &= _near_cells(x, one, 1.0) & _near_cells(y, other, 1.0)
    size = np.abs(points) + abs(envelope.curve.distance)
    inside &= _near_cells(x, one, OUTSIDE) & _near_cells(y, other, OUTSIDE)
    # Where the pace is large, the rounding of the cam angle counts as well.
    fastest = np.maximum(np.abs(at_x.pace), np.abs(at_y.pace))
    inside &= np.abs(gap) <= 4.0 * ROUNDING * size + PLACE * fastest
    with np.errstate(divide="ignore", invalid="ignore"):
        blur = ROUNDING * size / np.abs(sine)
        clear = blur < OUTSIDE * np.abs(at_x.pace) * wide_x
        clear &= blur < OUTSIDE * np.abs(at_y.pace) * wide_y
    blurred = ~clear & _slim(envelope, one) & _slim(envelope, other)
    inside &= clear
    nodes = []
    for k in np.flatnonzero(inside):
        places = envelope.wrapped(np.array([x[k], y[k]]))
        nodes.append(_node(float(places[0]), float(places[1]), complex(points[k])))
    return inside, blurred, nodes


def _node(one: float, other: float, point: complex, *, touching: bool = False) -> Node:
    """The node with these two path parameters, in any order."""
    return Node(min(one, other), max(one, other), point, touching)


def _near_cells(places: FloatArray, cells: FlankCells, share: float) -> BoolArray:
    """(n,) whether `places` (n,) are in their cells, or outside by at most that `share` of them."""
    room = share * (cells.high - cells.low)
    return np.asarray((places >= cells.low - room) & (places <= cells.high + room))


def _distinct_nodes(nodes: list[Node], total: float) -> tuple[Node, ...]:
    """Each node once; of a crossing and a contact next to it, the crossing."""
    distinct: list[Node] = []
    fields = max(1, int(total / TOUCHING))
    near: dict[int, list[Node]] = {}  # the nodes kept, by the fields about both of their places
    for node in sorted(nodes, key=lambda node: (node.touching, node.first, node.second)):
        limit = TOUCHING if node.touching else SAME
        field = int(node.first / TOUCHING)
        if any(_same_node(node, other, limit, total) for other in near.get(field % fields, ())):
            continue
        distinct.append(node)
        # Nodes that are the same lie in the same field of the path parameter or in neighbouring
        # ones.
        nearby = {
            int(place / TOUCHING) + step
            for place in (node.first, node.second)
            for step in (-1, 0, 1)
        }
        for bucket in {field % fields for field in nearby}:
            near.setdefault(bucket, []).append(node)
    return tuple(sorted(distinct, key=lambda node: (node.first, node.second)))


def _same_node(one: Node, other: Node, limit: float, total: float) -> bool:
    """Whether both places of two nodes agree to `limit`, in either order and across the end."""
    pairs = [(other.first, other.second), (other.second, other.first)]
    gaps = np.abs(np.array(pairs) - [one.first, one.second])
    return bool(np.any(np.all(np.minimum(gaps, total - gaps) < limit, axis=1)))


# -- swallow tail ---------------------------------------------------------------------------------
# Swallow tails: between two cusps the flank runs back and crosses itself once.
#
# At the crossing the displacement from one side to the other, the integral of a exp(i theta),
# vanishes. It is computed by Gauss-Legendre quadrature where the tail is small: the pace a has its
# digits also where the points of the flank differ by less than their own rounding.
#
# That there is one crossing at most is sure of a run of cells about the two cusps in which the
# tangent turns one way, see the division above. Where it turns back at the cusps, as next to a
# corner of the pitch curve, a run is known if what runs back is short, of length L: along the
# tangent there, the parts before and after it add up to at most L for a pair of points that
# coincide. So both lie within 1.2 L of the cusps, if the tangent turns by less than half a radian
# there, and by less than a right angle farther out. Of two such pairs one would be inside the
# other, and the two sums of directions between them equal. They are not if the tangents of both
# parts lie in cones apart; nor if both parts of a pair, 1.2 L together, turn by less than the
# tangent turns back between the cusps: going from one pair to the other, the tangent of one part
# would be ahead of that of the other all the way.


REACH = 1.2
"""Length of the parts next to the cusps in which a crossing must lie, as a multiple of what runs
back; more than 1 / cos(0.5)."""

SLIGHT = 0.5
"""Largest angle [rad] by which the tangent turns in the parts next to the cusps."""

SQUARE = 1.5
"""Largest angle [rad] by which the tangent turns in a short run: less than a right angle."""

SAMPLES = 33
"""Places at which the tangents of a part are sampled; over so short a part, with few borders, they
turn steadily."""


STEPS = 60
"""Most Newton steps; from the guess six suffice."""

SMALL = 1e-2
"""A tail whose flank is shorter than this fraction of its distance from the axis is small."""

NODES = 12
"""Nodes of a quadrature over each smooth part."""

MOST_BREAKS = 4
"""Most borders inside a tail that is integrated by quadrature, or in a run of short parts."""

SMALL_STEP = 1e-7
"""After a Newton step of this fraction of the tail's width the next one is mere rounding."""

NOISE = 2.0**-52 * 64.0
"""Rounding of the pace, as a fraction of the speed of the roller centre."""


@dataclass(frozen=True, slots=True)
class CellRun:
    """Consecutive cells in which there is at most one crossing.

    Attributes
    ----------
    first, cells : number of the first cell, and how many there are.
    low, high : path parameters between which the crossing lies, counted so that the cusps between
        them begin in [0, total).
    """

    first: int
    cells: int
    low: float
    high: float


class UnrolledCells:
    """The cells of a division over three turns, so that none of them is at an end."""

    def __init__(self, division: Division) -> None:
        cells, total = division.cells, division.envelope.total
        self.count = len(cells)
        thrice = joined([cells, cells, cells])
        turns = np.repeat([-total, 0.0, total], self.count)
        self.low, self.high, bend = thrice.low + turns, thrice.high + turns, thrice.bend
        self.negative: BoolArray = np.tile(division.negative, 3)
        self.turn = np.tile(2.0 * cells.turn, 3)
        # A sense of 0 asks for no bend: all cells qualify.
        self.bending = {0.0: bend == bend, 1.0: bend == 1.0, -1.0: bend == -1.0}

    def steady_run(self, start: float, end: float) -> CellRun | None:
        """The longest run about the range [start, end] in which the tangent turns one way, below
        pi. None if it does not turn one way between the cusps.
        """
        inner = slice(*self._cell_range(start, end))
        for sense in (1.0, -1.0):
            if np.all(self.bending[sense][inner]):
                run = self._grown(inner, STRAIGHT, sense)
                return run if run is not None and run.low < start and end < run.high else None
        return None

    def short_run(self, start: float, end: float) -> CellRun | None:
        """The run about the range [start, end] that turns by less than a right angle, either way,
        for `small_runs` to look at.
        """
        run = self._grown(slice(*self._cell_range(start, end)), SQUARE, 0.0)
        return run if run is not None and run.low < start and end < run.high else None

    def _cell_range(self, start: float, end: float) -> tuple[int, int]:
        """First cell, and the one after the last, of a range that begins and ends with cells."""
        return int(np.searchsorted(self.low, start)), int(np.searchsorted(self.high, end)) + 1

    def _grown(self, inner: slice, most: float, sense: float) -> CellRun | None:
        """The run of the cells `inner`, backward ones, with cells added on both sides in turn.

        As long as the pace is positive there, they bend in the `sense`, 0 for any, and all turn by
        less than `most` [rad]. None if there are none, or they turn by more.
        """
        left, right = inner.start, inner.stop - 1
        turned = float(np.sum(self.turn[inner]))
        if turned >= most or right < left or not np.all(self.negative[inner]):
            return None
        fit, is_open = self.bending[sense], [True, True]
        while any(is_open):
            for side in (0, 1):
                k = right + 1 if side else left - 1
                is_open[side] &= bool(
                    fit[k]
                    and not self.negative[k]
                    and turned + self.turn[k] < most
                    and right - left + 1 < self.count
                )
                if is_open[side]:
                    turned += float(self.turn[k])
                    left, right = (left, k) if side else (k, right)
        cells = right - left + 1
        return CellRun(left % self.count, cells, float(self.low[left]), float(self.high[right]))


def small_runs(
    envelope: Envelope, runs: Sequence[CellRun], start: FloatArray, end: FloatArray
) -> list[CellRun | None]:
    """The `runs` about short ranges [start, end] (m,), cut to where a crossing must lie; None for
    those that may hold more than one, see above.
    """
    half, shares = 0.5 * (end - start), (np.arange(SAMPLES) + 0.5) / SAMPLES
    backward = _samples(envelope, start[:, None] + (end - start)[:, None] * shares)
    length = 2.0 * half * np.max(np.abs(backward.pace), axis=1)
    sure = np.ones(len(runs), dtype=np.bool_)
    reaches, tangents, rates = [], [], []
    for cusp, limit in ((start, [run.low for run in runs]), (end, [run.high for run in runs])):
        away, room = np.sign(limit - cusp), np.abs(limit - cusp)
        pace = envelope.samples(cusp + 1e-3 * away * half).pace
        # As far as the parts must reach at the pace next to the cusp, or as the run goes.
        reach = cusp + away * np.minimum(REACH * length / np.maximum(pace, 1e-300), room)
        way = reach - cusp
        along = _samples(
            envelope, cusp[:, None] + way[:, None] * np.linspace(0.0, 1.0, SAMPLES)[1:]
        )
        # It must hold the length of what runs back, and the pace stays positive.
        sure &= np.mean(along.pace, axis=1) * np.abs(way) >= length
        sure &= np.min(along.pace, axis=1) > 0.0
        steps = np.abs(np.angle(along.tangents[:, 1:] * np.conj(along.tangents[:, :-1])))
        with np.errstate(divide="ignore", invalid="ignore"):  # where the pace is not above 0
            # The fastest turn of the tangent per unit of length.
            fastest = np.max(steps / along.pace[:, 1:], axis=1) * SAMPLES / np.abs(way)
        reaches.append(reach)
        tangents.append(along.tangents)
        rates.append(fastest)
    start_angles, end_angles = (
        np.angle(side_tangents * np.conj(tangents[0][:, :1])) for side_tangents in tangents
    )
    separated = np.max(start_angles, axis=1) < np.min(end_angles, axis=1)
    separated |= np.max(end_angles, axis=1) < np.min(start_angles, axis=1)
    first, last = _samples(envelope, np.stack((start, end))).tangents
    separated |= np.maximum(*rates) * REACH * length < np.abs(np.angle(last * np.conj(first)))
    sure &= separated & (np.max(np.abs(np.hstack((start_angles, end_angles))), axis=1) < SLIGHT)
    inside = np.searchsorted(_borders(envelope), reaches)
    sure &= inside[1] - inside[0] <= MOST_BREAKS
    return [
        replace(run, low=float(low), high=float(high)) if one else None
        for run, low, high, one in zip(runs, *reaches, sure, strict=True)
    ]


def _samples(envelope: Envelope, places: FloatArray) -> EnvelopeSamples:
    """The envelope at `places` of any shape."""
    samples = envelope.samples(places.ravel())
    return EnvelopeSamples(
        samples.points.reshape(places.shape),
        samples.tangents.reshape(places.shape),
        samples.pace.reshape(places.shape),
    )


def swallow_tails(
    division: Division, backward: list[tuple[float, float]]
) -> list[tuple[Node, CellRun]]:
    """The crossings of the ranges `backward` that cross within a short run of cells, each with that
    run, in which there is no other.
    """
    envelope, line = division.envelope, UnrolledCells(division)
    spans = [span for span in backward if span[1] - span[0] < envelope.total]
    runs = [line.steady_run(*span) for span in spans]
    short = {k: line.short_run(*span) for k, span in enumerate(spans) if runs[k] is None}
    candidates = {k: run for k, run in short.items() if run is not None}
    if candidates:
        start, end = np.array([spans[k] for k in candidates]).T
        small = small_runs(envelope, tuple(candidates.values()), start, end)
        for k, run in zip(candidates, small, strict=True):
            runs[k] = run
    known = [(span, run) for span, run in zip(spans, runs, strict=True) if run is not None]
    return _tails(envelope, known) if known else []


def _tails(
    envelope: Envelope, known: list[tuple[tuple[float, float], CellRun]]
) -> list[tuple[Node, CellRun]]:
    """The crossings in runs about backward ranges, all by Newton's method at once."""
    start, end, low, high = np.array([(*span, run.low, run.high) for span, run in known]).T
    middle, half = 0.5 * (start + end), 0.5 * (end - start)
    # Of a pace that is a parabola between the cusps the crossing lies root 3 times as far out.
    x = np.maximum(middle - np.sqrt(3.0) * half, 0.5 * (low + start))
    y = np.minimum(middle + np.sqrt(3.0) * half, 0.5 * (end + high))
    speed = np.abs(envelope.curve.pitch.jet(envelope.cam_angles(start))[1])
    small_step = np.zeros(len(x), dtype=np.bool_)
    converged = small_step.copy()
    k = np.arange(len(x))  # those still iterated
    for _ in range(STEPS):
        ends = _samples(envelope, np.stack((x[k], y[k])))
        gap = _displacements(envelope, x[k], y[k], ends)
        (t_x, t_y), (a_x, a_y) = ends.tangents, ends.pace
        sine = _cross_product(t_x, t_y)
        forward = (sine != 0.0) & (a_x > 0.0) & (a_y > 0.0)
        k, gap, sine, t_x, t_y, a_x, a_y = (
            part[forward] for part in (k, gap, sine, t_x, t_y, a_x, a_y)
        )
        if not len(k):
            break
        dx, dy = _cross_product(t_y, gap) / (-sine * a_x), _cross_product(t_x, gap) / (-sine * a_y)
        # Stay on the same side of the cusps, and inside the run.
        room = np.minimum(
            _step_share(x[k], dx, low[k], start[k]), _step_share(y[k], dy, end[k], high[k])
        )
        # One factor for both steps keeps the direction of Newton's step.
        share = np.minimum(1.0, room)
        x[k], y[k] = x[k] + share * dx, y[k] + share * dy
        converged[k] = small_step[k]
        # The pace is a difference of speeds; of a tiny tail it has few digits left.
        noise = NOISE * speed[k] / np.minimum(a_x, a_y)
        least = (SMALL_STEP + noise) * (y[k] - x[k]) + 8.0 * np.spacing(y[k])
        small_step[k] = np.abs(dx) + np.abs(dy) <= least
        k = k[~converged[k]]
    converged &= (low <= x) & (x < start) & (end < y) & (y <= high)
    chosen = np.flatnonzero(converged)
    places = envelope.wrapped(np.stack((x[chosen], y[chosen])))
    points = np.mean(_samples(envelope, places).points, axis=0)
    return [
        (_node(first, second, complex(point)), known[k][1])
        for k, (first, second), point in zip(
            chosen, places.T.tolist(), points.tolist(), strict=True
        )
    ]


def _borders(envelope: Envelope) -> FloatArray:
    """(k,) path parameters of the borders over three turns, ascending."""
    turns = envelope.total * np.array([[-1.0], [0.0], [1.0]])
    return np.sort((envelope.borders + turns), axis=None)


def _cross_product(one: ComplexArray, other: ComplexArray) -> FloatArray:
    """(n,) the part of `other` (n,) to the left of the unit vectors `one` (n,)."""
    return one.real * other.imag - one.imag * other.real


def _step_share(
    place: FloatArray, step: FloatArray, low: FloatArray, high: FloatArray
) -> FloatArray:
    """Fraction of `step` that stays short of the end it goes towards."""
    room = 0.9 * np.where(step > 0.0, high - place, place - low)
    size = np.abs(step)
    return np.divide(room, size, out=np.ones_like(size), where=size > room)


def _displacements(
    envelope: Envelope, x: FloatArray, y: FloatArray, ends: EnvelopeSamples
) -> ComplexArray:
    """(n,) complex [mm] the way along the envelope from x (n,) to y (n,), whose samples are `ends`
    (2, n).
    """
    way: ComplexArray = ends.points[1] - ends.points[0]
    size = np.max(np.abs(ends.points), axis=0) + abs(envelope.curve.distance)
    small = np.sum(np.abs(ends.pace), axis=0) * (y - x) <= SMALL * size
    breaks = _borders(envelope)
    first = np.searchsorted(breaks, x, side="right")
    count = np.searchsorted(breaks, y) - first
    for inside in range(MOST_BREAKS + 1):
        k = np.flatnonzero(small & (count == inside))
        if len(k):
            inner = breaks[first[k, None] + np.arange(inside)]
            marks = np.column_stack((x[k], inner, y[k]))
            places, half, weights = gauss(marks[:, :-1].ravel(), marks[:, 1:].ravel(), NODES)
            samples = _samples(envelope, places.reshape(len(k), -1))
            parts = (half[:, None] * weights).reshape(len(k), -1) * samples.pace * samples.tangents
            way[k] = np.sum(parts, axis=1)
    return way
