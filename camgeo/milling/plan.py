"""The milling program: the moves of each cut, from its strategy, within a machine's limits; and how
the cutter is engaged along them.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from typing import Final

import numpy as np

from camgeo.check.finding import Finding
from camgeo.geometry.contour.contour import Contour, Effort, Pieces, distances
from camgeo.milling.compensation import offset_limits
from camgeo.milling.cut import AreaCut, Cut
from camgeo.milling.judged import Side, simulation_setup, toolpath_runs
from camgeo.milling.machine import ArcLimits
from camgeo.milling.milling import Heights, MillingSpec
from camgeo.milling.moves import (
    ArcFeed,
    Course,
    Move,
    Operation,
    Point,
    Stop,
    Toolpath,
    feed_course,
    plane_piece,
    too_long,
)
from camgeo.milling.strategies import cut_moves
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, IntArray, frozen, taken
from camgeo.part.part import Part
from camgeo.reading import PROGRAM_LINES


def plan_toolpath(
    cuts: Iterable[Cut],
    heights: Heights,
    limits: ArcLimits,
    tolerance: float,
    effort: Effort = "fewest",
) -> Toolpath:
    """The whole program; its arcs lie within `tolerance` [mm] of the exact cutter paths.

    Arcs are at most as large as `limits` of the machine allow.

    Raises
    ------
    GeometryError
        `ToolError`, if a cutter is too large for its cut; with key "toolpath", if there is no
        strategy for it.
    FileError
        If there are more moves than lines are allowed in a program that is read.
    """
    operations: list[Operation] = []
    left = PROGRAM_LINES
    for cut in cuts:
        moves = cut_moves(cut, heights, tolerance, effort)
        first, *others = islice(divide_arcs(moves, limits.largest_turn), left + 1)
        # The operator may have moved the cutter: after a halt it traverses to its first point
        # again.
        stop = (Stop(cut.stop), first) if cut.stop else ()
        operation = Operation(cut, (first, *stop, *others))
        left -= len(operation.moves)
        if left < 0:
            raise too_long()
        operations.append(operation)
    offset_limits(operations)  # raises where compensation has no room
    return Toolpath(heights, tuple(operations))


def divide_arcs(moves: Iterable[Move | Stop], largest: float) -> Iterator[Move | Stop]:
    """The moves with each arc divided into equal parts of at most `largest` [rad]."""
    position: Point | None = None
    for move in moves:
        if isinstance(move, ArcFeed):
            if position is None:
                raise ValueError("an arc must start at a known point")
            yield from _parts(position, move, largest)
        else:
            yield move
        position = position if isinstance(move, Stop) else move.end


def _parts(position: Point, move: ArcFeed, largest: float) -> Iterator[ArcFeed]:
    whole = plane_piece(position, move)
    if abs(whole.sweep) > largest:
        parts = whole.split(largest)
        rise = (move.end[2] - position[2]) / len(parts)
        for count, arc in enumerate(parts[:-1], start=1):
            yield replace(move, end=(arc.end.real, arc.end.imag, position[2] + count * rise))
    yield move


# -- engaged --------------------------------------------------------------------------------------
# How the cutter of each roughing operation is engaged: its share of air, and the largest angle.
#
# That is computed at the last depth; the others are run by the same rule. Left out are entries,
# declared as such by going down, each with the round that levels its floor; slots, which have a
# depth and a feed of their own; and finishes, which take an allowance off.


QUANTILE: Final = 0.995
"""Share of the length of a cut on which its usual engagement is not exceeded."""

SAMPLES: Final = 1000
"""Approximate number of places of an operation at which the engagement is computed."""

PIECES: Final = 300
"""Pieces of a longer course that are evaluated, evenly chosen: one place on a spiral of many turns
takes milliseconds, as it is compared with all turns that are near.
"""

SPACING: Final = 0.5
"""Least distance of places at which the engagement is computed [mm]."""

SAME: Final = 1e-6
"""Centres and radii [mm] that differ by less are those of one circle."""


@dataclass(frozen=True, slots=True)
class OperationEngagement:
    """The engagement of one roughing operation at its last depth, its entries left out.

    Attributes
    ----------
    operation : its name.
    length : of its course there [mm].
    air : share of that on which the cutter is in no material.
    usual : angle [rad] that is not exceeded on `QUANTILE` of the length.
    largest : of the angles at all places that are evaluated [rad], refined next to the largest one.
    limit : the tool's, or that of a straight wall at the stepover [rad].
    place : of the largest [mm].
    """

    operation: str
    length: float
    air: float
    usual: float
    largest: float
    limit: float
    place: complex

    @property
    def sentence(self) -> str:
        """The engagement in words."""
        largest, limit = math.degrees(self.largest), math.degrees(self.limit)
        return (
            f"{100.0 * self.air:.0f} % of its length is in air, the cutter is engaged over at most"
            f" {largest:.1f} deg, {limit:.1f} deg are allowed"
        )

    @property
    def finding(self) -> Finding | None:
        """The finding that the engagement exceeds its limit; None if it does not."""
        if self.largest <= self.limit:
            return None
        place = f"at X {self.place.real:.4g}, Y {self.place.imag:.4g} mm"
        sentence = f"{self.operation}: {self.sentence}, {place}"
        angles = math.degrees(self.largest), math.degrees(self.limit)
        return Finding("engagement", "warning", sentence, *angles, "deg")


def program_engagements(
    toolpath: Toolpath, part: Part, milling: MillingSpec
) -> tuple[OperationEngagement, ...]:
    """The engagement of each operation of a program that clears an area."""
    cuts = tuple(operation.cut for operation in toolpath.operations)
    if not any(isinstance(cut, AreaCut) for cut in cuts):
        return ()
    setup = simulation_setup(Side(part, milling, cuts, toolpath_runs(toolpath)))
    return operation_engagements(toolpath, setup.blank, setup.top)


def operation_engagements(
    toolpath: Toolpath, blank: Sequence[Contour], top: float
) -> tuple[OperationEngagement, ...]:
    """The engagement of each operation that clears an area.

    Parameters
    ----------
    blank : contours of the blank, of which a point of it is within an odd number.
    top : of the blank, Z [mm].
    """
    engagements = []
    cleared: list[tuple[Course, float]] = []
    for operation in toolpath.operations:
        if isinstance(operation.cut, AreaCut):
            course, radius = feed_course(operation.moves), operation.tool.radius
            engagements.append(
                _operation_engagement(operation.cut, Cutting(course, radius, blank, top, cleared))
            )
        cleared.append(operation.swept)
    return tuple(engagements)


def _operation_engagement(cut: AreaCut, cutting: Cutting) -> OperationEngagement:
    course = cutting.course
    chosen = ~entries(course) & (course.lowest <= np.min(course.lowest, initial=np.inf) + LEVEL)
    length = float(np.sum(course.lengths[chosen]))
    spacing = max(SPACING, length / SAMPLES)
    moves = course.moves[chosen]
    # Every n-th move, at most `PIECES` of them; without moves the step must still be 1.
    judged = moves[:: math.ceil(len(moves) / PIECES) or 1]
    engagement = cutting.engagement(spacing, judged.tolist())
    place = (
        complex(engagement.places[np.argmax(engagement.largest)]) if len(engagement.largest) else 0j
    )
    limit = cut.tool.engagement or math.acos(max(-1.0, 1.0 - cut.stepover / cut.tool.radius))
    return OperationEngagement(
        cut.name,
        length,
        engagement.air_share,
        engagement.quantile(QUANTILE),
        engagement.peak,
        limit,
        place,
    )


def entries(course: Course) -> BoolArray:
    """(n,) whether a piece is part of an entry: it goes down, or it levels the floor that the helix
    before it has left, on the same circle for at most one turn.
    """
    is_entry = course.to_z < course.from_z
    radii = course.radii
    for piece in np.flatnonzero(~is_entry[1:] & is_entry[:-1]) + 1:
        arc = course.sweeps[piece - 1] != 0.0
        turned = 0.0
        for index in range(piece, len(course)):
            joined = course.starts[index] == course.ends[index - 1]
            same = abs(course.centres[index] - course.centres[piece - 1]) < SAME
            same &= abs(radii[index] - radii[piece - 1]) < SAME
            turned += abs(course.sweeps[index])
            if not (arc and joined and same and turned < 2.0 * np.pi + SAME):
                break
            is_entry[index] = True
    return is_entry


# -- engagement -----------------------------------------------------------------------------------
# Engagement: over which angle a cutter is in material, by exact crossings.
#
# At one place of the course the engagement is the part of the leading half of the cutter's circle
# that lies within the blank and has not been passed over before. Its ends are crossings of that
# circle with the outline of the blank, lines and arcs, and with the edge of what the cutter has
# swept so far: parallels of its course, and circles around the ends of its pieces. These are
# computed in closed form, and the parts between two of them are judged at their middle, so that the
# angle at one place is exact to rounding. It is that at the height of the tip: pieces that ran
# higher have left material there.
#
# Along the course, places are sampled: next to both ends of each piece and between them at the
# given spacing. The largest value is then refined between the neighbouring samples by golden
# sections. A peak shorter than the spacing, with lower samples on both sides, can be missed; the
# angle is continuous along a piece except where the circle touches an edge of the same curvature.
# The ends of air are refined by bisection.


FIRST: Final = 8
"""Number of the latest swept pieces with which a place is compared first."""

ROUNDING: Final = 1e-10
"""Share of the radius by which a point must be within reach to be passed over: the edge of the
cutter itself, and that of a neighbouring piece which touches it there, are at its radius."""

NOTHING: Final = 1e-4
"""Angle [rad] below which the cutter is in air: where its edge touches that of its earlier course,
the share above is passed within sqrt(2e-10)."""

INSET: Final = 1e-4
"""Distance [mm] of the first and the last sample from the ends of a piece. At the end of an earlier
course the circle of the cutter is the very edge of what that has swept."""

LEVEL: Final = 1e-9
"""Heights [mm] that differ by less are equal."""

GOLDEN: Final = 0.5 * (3.0 - 5.0**0.5)

REFINED: Final = 24
"""Steps of a golden section: the interval shrinks to a hundred-thousandth."""

BISECTED: Final = 20
"""Steps of a bisection: a millionth."""


@dataclass(frozen=True, slots=True, eq=False)
class Engagement:
    """The engagement along a course; arrays over its pieces of some length.

    Attributes
    ----------
    pieces : (n,) their indices in the course.
    lengths : (n,) [mm].
    largest : (n,) largest angle on each [rad], that of the samples but for the largest of all.
    places : (n,) complex [mm], where that is.
    air : (n,) length [mm] on which it is 0.
    angles : (m,) all samples [rad].
    weights : (m,) length of the course [mm] for which each sample stands.
    """

    pieces: IntArray
    lengths: FloatArray
    largest: FloatArray
    places: ComplexArray
    air: FloatArray
    angles: FloatArray
    weights: FloatArray

    @property
    def peak(self) -> float:
        """The largest angle of all [rad]; 0 without pieces."""
        return float(np.max(self.largest, initial=0.0))

    @property
    def air_share(self) -> float:
        """Share of the length on which the cutter is in air; 0 of no length."""
        whole = float(np.sum(self.lengths))
        return float(np.sum(self.air)) / whole if whole else 0.0

    def quantile(self, share: float) -> float:
        """The angle [rad] that is not exceeded on this share of the length of the cut."""
        if not len(self.angles):
            return 0.0
        order = np.argsort(self.angles)
        total = np.cumsum(self.weights[order])
        place = int(np.searchsorted(total, share * total[-1]))
        return float(self.angles[order][min(place, len(order) - 1)])


def crossings(pieces: Pieces, place: complex, radius: float, distance: float) -> FloatArray:
    """(m,) angles [rad] at which the circle around `place` may meet what is `distance` away.

    All angles at which the distance of a point of the circle from the pieces passes `distance` are
    among them; others are too.
    """
    arcs = pieces.sweeps != 0.0
    angles = []
    lines = ~arcs & (pieces.starts != pieces.ends)
    if np.any(lines):
        along = pieces.ends[lines] - pieces.starts[lines]
        normal = 1j * along / np.abs(along)
        height = np.real((pieces.starts[lines] - place) * np.conj(normal))
        for side in (-distance, distance):
            angles += _pairs(np.angle(normal), (height + side) / radius)
    circles: list[tuple[ComplexArray, FloatArray]] = []
    if distance > 0.0:
        both = np.concatenate((pieces.starts, pieces.ends))
        circles.append((both, np.full(len(both), distance)))
    if np.any(arcs):
        arms = np.abs(pieces.starts[arcs] - pieces.centres[arcs])
        for side in (-distance, distance):
            circles.append((pieces.centres[arcs], np.abs(arms + side)))
    for centres, radii in circles:
        away = np.abs(centres - place)
        # By the law of cosines; a circle about the same middle has no crossings.
        cosine = (away**2 + radius**2 - radii**2) / np.where(
            away > 0.0, 2.0 * away * radius, np.nan
        )
        angles += _pairs(np.angle(centres - place), cosine)
    return np.concatenate(angles) if angles else np.zeros(0)


def inside(boundary: Pieces, places: ComplexArray) -> BoolArray:
    """(k,) whether `places` (k,) lie within an odd number of the closed contours of `boundary`."""
    q = places[:, None]
    start, end = boundary.starts - q, boundary.ends - q
    starts_below = start.imag <= 0.0
    crosses = starts_below != (end.imag <= 0.0)
    along = boundary.ends - boundary.starts
    side = start.real * end.imag - start.imag * end.real  # > 0 where q lies left of the chord
    # On the chord itself as if q lay a little higher, as for the ends of the chord.
    side = np.where(side != 0.0, side, np.where(along.real != 0.0, along.real, -along.imag))
    odd = crosses & (np.where(starts_below, side, -side) > 0.0)
    arcs = boundary.sweeps != 0.0
    if np.any(arcs):
        # Between chord and arc the arc has q on the other side.
        in_circle = np.abs(q - boundary.centres) < np.abs(boundary.starts - boundary.centres)
        beyond = side * np.sign(boundary.sweeps) < 0.0
        odd ^= arcs & in_circle & beyond
    is_inside: BoolArray = np.sum(odd, axis=1) % 2 == 1
    return is_inside


def _pairs(middle: FloatArray, cosine: FloatArray) -> list[FloatArray]:
    """Both angles whose difference from `middle` [rad] has that cosine, where there are any."""
    real = np.abs(cosine) <= 1.0
    half = np.arccos(cosine[real])
    return [middle[real] - half, middle[real] + half]


class _LowPieces:
    """The pieces of a course that have been run as low as `level` [mm]."""

    def __init__(self, course: Course, level: float) -> None:
        self.numbers = np.flatnonzero(course.cleared <= level + LEVEL)
        low = taken(course, self.numbers)
        # The circle around a piece's chord contains the piece, which has at most half a turn.
        self._middles = 0.5 * (low.starts + low.ends)
        self._halves = 0.5 * np.abs(low.ends - low.starts)

    def near(self, place: complex, reach: float, before: int | None = None) -> IntArray:
        """(n,) indices of the pieces that may come closer than `reach` [mm] to `place`; only those
        before the piece `before`, if one is given.
        """
        last = None if before is None else int(np.searchsorted(self.numbers, before))
        close = np.abs(self._middles[:last] - place) < self._halves[:last] + reach
        return self.numbers[:last][close]


class Cutting:
    """A cutter on its course through a blank.

    Attributes
    ----------
    course : of the centre; traverses left out.
    radius : of the cutter [mm].
    blank : contours, of which a point of the blank is within an odd number.
    top : Z of the upper face of the blank [mm]; above it there is air.
    cleared : what other cutters have swept before, each with its radius [mm].
    """

    def __init__(
        self,
        course: Course,
        radius: float,
        blank: Iterable[Contour],
        top: float = 0.0,
        cleared: Sequence[tuple[Course, float]] = (),
    ) -> None:
        self.course, self.radius, self.top, self.cleared = course, radius, top, cleared
        self.boundary = Pieces.around(blank)
        self._lowest = course.lowest
        self._low: dict[tuple[int, float], _LowPieces] = {}

    def engagement(self, spacing: float, only: Sequence[int] | None = None) -> Engagement:
        """The engagement along the course, sampled at most `spacing` [mm] apart.

        `only` names the moves that are judged; all by default.
        """
        lengths = self.course.lengths
        chosen = lengths > 0.0
        if only is not None:
            chosen &= np.isin(self.course.moves, np.asarray(only))
        pieces = np.flatnonzero(chosen)
        shares, angles, weights = [], [], []
        for piece in pieces:
            count = max(2, int(np.ceil(lengths[piece] / spacing)) + 1)
            inset = min(INSET / lengths[piece], 0.1)
            samples = np.linspace(inset, 1.0 - inset, count)
            shares.append(samples)
            angles.append(np.array([self.angle(int(piece), float(share)) for share in samples]))
            # Each sample stands for the length up to half way to its neighbours.
            step = np.full(count, lengths[piece] / (count - 1))
            step[[0, -1]] *= 0.5
            weights.append(step)
        best = [int(np.argmax(values)) for values in angles]
        largest = np.array([values[place] for values, place in zip(angles, best, strict=True)])
        where = np.array([samples[place] for samples, place in zip(shares, best, strict=True)])
        if len(pieces):
            top = int(np.argmax(largest))
            where[top], largest[top] = self.refine_peak(
                int(pieces[top]), shares[top], best[top], float(largest[top])
            )
        air = [
            self.air(int(piece), samples, values) * float(lengths[piece])
            for piece, samples, values in zip(pieces, shares, angles, strict=True)
        ]
        return Engagement(
            frozen(pieces, np.intp),
            frozen(lengths[pieces], np.float64),
            frozen(largest, np.float64),
            frozen(taken(self.course, pieces).points_by_share(where), np.complex128),
            frozen(air, np.float64),
            frozen(np.concatenate(angles or [np.zeros(0)]), np.float64),
            frozen(np.concatenate(weights or [np.zeros(0)]), np.float64),
        )

    def _low_pieces(self, number: int, level: float) -> _LowPieces:
        """The pieces as low as `level` [mm] of an earlier cutter, or of this one for number -1."""
        key = (number, level)
        if key not in self._low:
            self._low[key] = _LowPieces(
                self.course if number < 0 else self.cleared[number][0], level
            )
        return self._low[key]

    def angle(self, piece: int, share: float) -> float:
        """Engagement [rad], 0 to pi, at a share of one piece's length; exact."""
        course, radius = self.course, self.radius
        level = float(self._lowest[piece])
        if level >= self.top:
            return 0.0
        here = taken(course, [piece])
        there = here.points_by_share(np.array([share]))
        place, way = complex(there[0]), complex(here.tangents(there)[0])
        swept: list[tuple[Pieces, float]] = [
            (self._earlier_pieces(piece, share, place, level), radius)
        ]
        for number, (other, size) in enumerate(self.cleared):
            close = self._low_pieces(number, level).near(place, radius + size)
            swept.append((taken(other, close), size))
        edges = [
            crossings(self.boundary, place, radius, 0.0),
            *(crossings(pieces, place, radius, size) for pieces, size in swept if len(pieces)),
        ]
        # Angles from the direction of travel, of the leading half.
        ahead = np.angle(np.exp(1j * (np.concatenate(edges) - np.angle(way))))
        half = 0.5 * np.pi
        ends = np.sort(np.concatenate(([-half, half], ahead[np.abs(ahead) < half])))
        middles = 0.5 * (ends[1:] + ends[:-1])
        points = place + radius * way * np.exp(1j * middles)
        material = inside(self.boundary, points)
        for pieces, size in swept:
            # The latest pieces first, a few and then more: they leave few points for the others.
            stop, count = len(pieces), FIRST
            while stop > 0 and np.any(material):
                some = taken(pieces, np.arange(max(0, stop - count), stop))
                gone = distances(points[material], some) < size - ROUNDING * radius
                material[material] = ~gone
                stop, count = stop - count, 2 * count
        engaged = float(np.sum((ends[1:] - ends[:-1])[material]))
        return engaged if engaged > NOTHING else 0.0

    def _earlier_pieces(self, piece: int, share: float, place: complex, level: float) -> Pieces:
        """The pieces that this cutter has run before, as low as here and near enough to matter."""
        course = self.course
        close = self._low_pieces(-1, level).near(place, 2.0 * self.radius, piece)
        if share <= 0.0:
            return taken(course, close)
        passed = taken(course, np.append(close, piece))  # its own way, down a ramp too
        last = np.ones(len(passed))
        last[-1] = share
        return passed.subpieces(np.zeros(len(passed)), last)

    def refine_peak(
        self, piece: int, shares: FloatArray, best: int, largest: float
    ) -> tuple[float, float]:
        """Share and angle of the maximum between the samples beside the largest one."""
        low = float(shares[max(best - 1, 0)])
        high = float(shares[min(best + 1, len(shares) - 1)])
        peak = (largest, float(shares[best]))
        # Golden sections: one of the two inner places stays inner, so each step costs one angle.
        inner = [low + GOLDEN * (high - low), high - GOLDEN * (high - low)]
        values = [self.angle(piece, share) for share in inner]
        for _ in range(REFINED):
            peak = max(peak, *zip(values, inner, strict=True))
            if values[0] >= values[1]:
                high = inner[1]
                inner = [low + GOLDEN * (high - low), inner[0]]
                values = [self.angle(piece, inner[0]), values[0]]
            else:
                low = inner[0]
                inner = [inner[1], high - GOLDEN * (high - low)]
                values = [values[1], self.angle(piece, inner[1])]
        return peak[1], peak[0]

    def air(self, piece: int, shares: FloatArray, angles: FloatArray) -> float:
        """Share of the piece's length on which the engagement is 0."""
        free_share = 0.0
        ends = np.concatenate(([0.0], shares[1:-1], [1.0]))  # what is inset is like its sample
        for place in range(len(shares) - 1):
            low, high = float(ends[place]), float(ends[place + 1])
            free = angles[place] == 0.0, angles[place + 1] == 0.0
            if all(free):
                free_share += high - low
            elif any(free):  # the border between air and material lies between the samples
                begin, end = low, high
                for _ in range(BISECTED):
                    middle = 0.5 * (begin + end)
                    if (self.angle(piece, middle) == 0.0) == free[0]:
                        begin = middle
                    else:
                        end = middle
                free_share += begin - low if free[0] else high - begin
        return free_share
