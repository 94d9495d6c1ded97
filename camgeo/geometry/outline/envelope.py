"""Envelope of the roller on one flank: the working curve, and the turns where its tangent jumps.

Where the follower's velocity jumps the roller centre has a corner, and the roller turns about it:
the flank continues along an arc of the roller's radius. A path parameter runs through both: the cam
angle along the curve, the angle turned along such an arc.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from camgeo.errors import GeometryError
from camgeo.geometry.outline.path import Element, Pivot, Stretch
from camgeo.geometry.pieces import centres_at
from camgeo.geometry.pitch_curve import joints
from camgeo.geometry.working_curve import WorkingCurve
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
from camgeo.numeric.kept import Kept, kept_with_owner
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
    """The turns among m elements, in their places: `Pivot.centre`, `normal` at the start, and +1 or
    -1 for the sense of the sweep; 0 for stretches.
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
        before, after = (curve.tangent(angles, side) for side in ("left", "right"))
        sweeps = np.angle(after * np.conj(before))
        centres = curve.pitch.point(angles)
        found: list[Element] = []
        ends = np.append(angles[1:], angles[0] + TURN)
        for k, (start, end) in enumerate(zip(map(float, angles), map(float, ends), strict=True)):
            normal = 1j * curve.pitch.rotation * complex(before[k])
            found.append(
                Pivot(
                    complex(centres[k]),
                    curve.distance,
                    normal,
                    float(sweeps[k]),
                    before=start if start > 0.0 else TURN,
                    after=start,
                )
            )
            found.append(Stretch(curve, start, end))
        return tuple(found)

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
        return frozen([isinstance(each, Pivot) for each in self.elements], np.bool_)

    @cached_property
    def pivots(self) -> Pivots:
        """The turns about corners of the pitch curve."""
        rows = [
            (each.centre, each.normal, math.copysign(1.0, each.sweep))
            if isinstance(each, Pivot)
            else (0j, 0j, 0.0)
            for each in self.elements
        ]
        centre, normal, sense = np.array(rows, dtype=np.complex128).T
        return Pivots(centre, normal, sense.real)

    @cached_property
    def angle_offsets(self) -> FloatArray:
        """(m,) cam angle minus path parameter along each element; 0 for turns."""
        pairs = zip(self.starts, self.elements, strict=True)
        offsets = [
            each.start - start if isinstance(each, Stretch) else 0.0 for start, each in pairs
        ]
        return frozen(offsets, np.float64)

    @cached_property
    def _spans(self) -> FloatArray:
        return np.array([_span(each) for each in self.elements])

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
        found = [starts]
        for start, each in zip(starts, elements, strict=True):
            if isinstance(each, Stretch):
                within = angles[(angles > each.start) & (angles < each.end)]
                found.append(start + (within - each.start))
        return frozen(ascending(np.concatenate(found)), np.float64)

    @cached_property
    def undivided(self) -> Cells:
        """The first cells if there are no cusps."""
        return first_cells(self, np.empty(0))

    def element_at(self, places: FloatArray) -> IntArray:
        """(n,) index of the element at each of `places` (n,) in [0, total)."""
        return np.asarray(np.searchsorted(self.starts, places, side="right") - 1)

    def within(self, places: FloatArray) -> FloatArray:
        """(n,) `places` reduced to [0, total)."""
        reduced = places - self.total * np.floor(places / self.total)
        return np.asarray(np.where(reduced >= self.total, 0.0, reduced))

    def angles_at(self, places: FloatArray) -> FloatArray:
        """Cam angles [rad] in [0, 2 pi) at path parameters of any shape in [0, total)."""
        index = self.element_at(places)
        angles = self._angles[index] + np.where(
            self.is_pivot[index], 0.0, places - self.starts[index]
        )
        return np.asarray(np.where(angles >= TURN, angles - TURN, angles))

    @cached_property
    def _angles(self) -> FloatArray:
        """(m,) cam angle [rad] at which each stretch begins, or of a turn."""
        return np.array(
            [each.after if isinstance(each, Pivot) else each.start for each in self.elements]
        )

    def place_of(self, angle: float, side: Side = "right") -> float:
        """Path parameter of a cam angle [rad] in [0, 2 pi), after a turn that is there, or before
        it if it is seen from the left.
        """
        left = side == "left"
        for start, each in zip(self.starts, self.elements, strict=True):
            if isinstance(each, Stretch):
                before = angle < each.start or (left and angle == each.start)
                beyond = angle + TURN if before else angle
                if beyond < each.end or (left and beyond == each.end):
                    return float(start) + (beyond - each.start)
        # A turn added to an angle just below the first stretch may round up to the end of the last.
        pairs = zip(self.starts, self.elements, strict=True)
        return next(float(start) for start, each in pairs if isinstance(each, Stretch))

    def samples(self, places: FloatArray) -> EnvelopeSamples:
        """Points, tangents and pace at the path parameters `places` (n,), any number of turns."""
        places = self.within(np.asarray(places, dtype=np.float64))
        if len(self.elements) == 1:
            return self._along(places)
        index = self.element_at(places)
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
        turning = (z1.real * z2.imag - z1.imag * z2.real) / (speed * speed)
        normal = 1j * pitch.rotation * tangents
        return EnvelopeSamples(
            jet[0] + distance * normal, tangents, speed - pitch.rotation * distance * turning
        )


@kept_with_owner
def envelope_of(curve: WorkingCurve) -> Envelope:
    """The envelope at the distance of `curve`."""
    return Envelope(curve)


def _span(element: Element) -> float:
    return abs(element.sweep) if isinstance(element, Pivot) else element.end - element.start


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
# of
#   a branch is never square to a tangent of it then, so that the distance of a point of the branch
#   from the roller centre Z has no extreme but at its own cam angle. It is smallest there, |d|,
# where
#   a > 0, and largest where a < 0: the roller at the cusp touches neither branch again, one lies
#   outside of it and the other inside;
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
    cells: Cells
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
        plain: BoolArray = short & ((flips == 0) | ((flips == 1) & (one_way | square)))
        return plain


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
            raise unresolved(envelope, cells.low[sharp & ~wide])
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
        _counts(negative != np.roll(negative, -1)),
        _counts(cells.bend != np.roll(cells.bend, -1)),
        _counts(cells.bend == 0.0),
    )


def first_cells(envelope: Envelope, cusps: FloatArray) -> Cells:
    """Cells of at most `WIDEST`, none across a border of `envelope` or one of `cusps` (k,)."""
    marks = ascending(np.concatenate((envelope.borders, cusps, [envelope.total])))
    spans = np.diff(marks)
    parts = np.maximum(1, np.ceil(spans / WIDEST)).astype(np.intp)
    index, step = grouped(parts)
    low = marks[index] + spans[index] * step / parts[index]
    high = np.append(low[1:], envelope.total)
    return enclose(envelope, low, high, np.arange(len(low)))


def _touches(cells: Cells, cusps: FloatArray) -> BoolArray:
    if not len(cusps):
        return np.zeros(len(cells), dtype=np.bool_)
    # The last cell ends where the first one begins.
    high = np.append(cells.low[1:], cells.low[0])
    touched: BoolArray = np.isin(cells.low, cusps) | np.isin(high, cusps)
    return touched


def _sums(values: FloatArray) -> FloatArray:
    """Sums before each cell and after the last, over two turns."""
    return np.concatenate(([0.0], np.cumsum(np.concatenate((values, values)))))


def _counts(values: BoolArray) -> IntArray:
    """Number of True before each cell and after the last, over two turns."""
    counted = np.cumsum(np.concatenate((values, values)), dtype=np.intp)
    return np.concatenate((np.zeros(1, dtype=np.intp), counted))
