"""Closed contours of lines and arcs, their pieces, and distances from them.

Vertices, sweeps and centres are arrays, so that a contour of 100,000 pieces needs no more memory
than its numbers. Piece i runs from vertex i to vertex i + 1, the last one back to vertex 0, so that
neighbours share their end points exactly.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final, Literal, Protocol, Self

import numpy as np

from camgeo.errors import UndercutError
from camgeo.geometry.outline.path import Moments, segment_areas
from camgeo.numeric.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
    grouped,
    taken,
)
from camgeo.numeric.checked import CheckedFields, Complexes, Floats
from camgeo.units import TURN

EPS: Final = float(np.finfo(np.float64).eps)

POINTS: Final = 500_000
"""Points of a full turn: their chords lie within 2e-11 of the radius of it, a fifth of the finest
tolerance of a cam of that size. Files have arcs of any size."""


def is_straight(
    start: ComplexArray | complex, end: ComplexArray | complex, sweep: FloatArray | float
) -> BoolArray:
    """(n,) whether pieces from `start` to `end` (n,) [mm] that turn by `sweep` (n,) [rad] are
    lines.

    They are if they leave their chord by less than the rounding of their ends: such an arc has no
    centre that could be stated.
    """
    sagitta = 0.5 * np.abs(end - start) * np.tan(0.25 * np.abs(sweep))
    return np.asarray(sagitta <= EPS * np.maximum(np.abs(start), np.abs(end)))


def piece_radii(starts: ComplexArray, sweeps: FloatArray, centres: ComplexArray) -> FloatArray:
    """(n,) [mm] radius of each piece that is an arc; 0 for lines."""
    return np.where(sweeps != 0.0, np.abs(starts - centres), 0.0)


def piece_lengths(
    starts: ComplexArray, ends: ComplexArray, sweeps: FloatArray, radii: FloatArray
) -> FloatArray:
    """(n,) [mm] length of each piece from `starts` to `ends`, with the `radii` of arcs."""
    return np.where(sweeps != 0.0, np.abs(sweeps) * radii, np.abs(ends - starts))


@dataclass(frozen=True, slots=True, eq=False)
class PieceChain(CheckedFields):
    """Lines and circular arcs in the plane, each beginning where the one before it ends: closed as
    a `Contour`, open as a `camgeo.milling.track.Track`.
    """

    vertices: Complexes
    sweeps: Floats
    centres: Complexes

    def __len__(self) -> int:
        return len(self.sweeps)


class Contour(PieceChain):
    """Closed chain of lines and circular arcs in the plane.

    Attributes
    ----------
    vertices : (n,) complex [mm], start of each piece.
    sweeps : (n,) [rad], angle turned along the piece, positive counter-clockwise; 0 is a line.
        At most one turn; a full circle is one piece with sweep +-2 pi.
    centres : (n,) complex [mm], centre of each arc; 0 where the piece is a line.
    """

    __slots__ = ()

    @property
    def ends(self) -> ComplexArray:
        """(n,) complex [mm], end of each piece."""
        return np.roll(self.vertices, -1)

    @property
    def radii(self) -> FloatArray:
        """(n,) [mm] radius of each arc; 0 for lines."""
        return piece_radii(self.vertices, self.sweeps, self.centres)

    @property
    def arc_count(self) -> int:
        """Number of arcs among the pieces."""
        return int(np.count_nonzero(self.sweeps))

    @property
    def lengths(self) -> FloatArray:
        """(n,) [mm] length of each piece."""
        return piece_lengths(self.vertices, self.ends, self.sweeps, self.radii)

    @property
    def length(self) -> float:
        """Length of the whole contour [mm]."""
        return math.fsum(self.lengths)

    @property
    def area(self) -> float:
        """Enclosed area [mm^2], positive if the contour runs counter-clockwise."""
        start, end = self.vertices, self.ends
        chord = 0.5 * (start.real * end.imag - start.imag * end.real)
        segments = segment_areas(np.abs(end - start), self.radii, self.sweeps)
        return math.fsum(np.concatenate((chord, segments)))

    @property
    def moments(self) -> Moments:
        """Area and first moments of the region inside.

        They are computed about the mean of the vertices and shifted from there, so that a small
        contour far from the origin keeps its digits.
        """
        middle = complex(np.mean(self.vertices))
        central = Moments.of_pieces(
            self.vertices - middle, self.ends - middle, self.sweeps, self.centres - middle
        )
        first_error = central.first_error + central.area_error * abs(middle)
        first = central.first + central.area * middle
        return Moments(central.area, first, central.area_error, first_error)

    def reversed(self) -> Self:
        """The same outline in the opposite direction."""
        return type(self)(np.roll(self.vertices[::-1], 1), -self.sweeps[::-1], self.centres[::-1])

    def rolled(self, first: int) -> Self:
        """The same outline, beginning with its piece `first`."""
        return type(self)(
            np.roll(self.vertices, -first),
            np.roll(self.sweeps, -first),
            np.roll(self.centres, -first),
        )

    def counter_clockwise(self) -> Self:
        """The same outline, counter-clockwise."""
        return self if self.area >= 0.0 else self.reversed()

    def split(self, max_sweep: float) -> Self:
        """The same outline with each arc cut into equal parts of at most `max_sweep` [rad]."""
        # Rounding must not cut an arc of exactly `max_sweep` in two, hence the 1e-12.
        parts = np.maximum(1, np.ceil(np.abs(self.sweeps) / max_sweep - 1e-12)).astype(int)
        index, step = grouped(parts)
        sweeps = self.sweeps[index] / parts[index]
        centres = self.centres[index]
        turned = centres + (self.vertices[index] - centres) * np.exp(1j * sweeps * step)
        vertices = np.where(step == 0, self.vertices[index], turned)
        return type(self)(vertices, sweeps, centres)

    def points(self, sagitta: float) -> ComplexArray:
        """(m,) complex [mm] points on the contour, chords at most `sagitta` [mm] off its arcs.

        For topology and pictures only; no geometry is derived from these points. There are at most
        `POINTS` of them a turn.
        """
        radii = np.maximum(self.radii, sagitta)
        # A chord that spans the angle s leaves the sagitta r (1 - cos(s / 2)).
        step = 2.0 * np.arccos(np.clip(1.0 - sagitta / radii, 0.0, 1.0))
        step = np.maximum(step, 2.0 * np.pi / POINTS)
        counts = np.maximum(1, np.ceil(np.abs(self.sweeps) / step)).astype(int)
        index, number = grouped(counts)
        part = number / counts[index]
        arm = self.vertices[index] - self.centres[index]
        arc = self.centres[index] + arm * np.exp(1j * self.sweeps[index] * part)
        return np.where(part == 0.0, self.vertices[index], arc)

    @classmethod
    def polygon(cls, vertices: ComplexArray) -> Self:
        """Straight pieces between `vertices` (n,) [mm]."""
        return cls(vertices, np.zeros(len(vertices)), np.zeros_like(vertices))

    @classmethod
    def through(cls, vertices: ComplexArray, sweeps: FloatArray) -> Self:
        """Pieces between `vertices` (n,) [mm] that turn by `sweeps` (n,) [rad], as in files.

        The centres follow from both, so that each arc passes through its end points; one that is
        straight except for rounding is a line.
        """
        ends = np.roll(vertices, -1)
        straight = is_straight(vertices, ends, sweeps)
        half = np.tan(0.5 * np.where(straight, 1.0, sweeps))
        # From the middle of the chord to its left, by half the chord over tan(sweep / 2).
        middles = vertices + 0.5 * (ends - vertices) * (1.0 + 1j / half)
        return cls(vertices, np.where(straight, 0.0, sweeps), np.where(straight, 0.0, middles))

    @classmethod
    def circle(cls, radius: float, centre: complex = 0j) -> Self:
        """A full circle [mm] as two half arcs, counter-clockwise."""
        vertices = np.array([centre + radius, centre - radius])
        return cls(vertices, np.array([np.pi, np.pi]), np.array([centre, centre]))


def rectangle(half: complex, centre: complex, along: complex = 1.0 + 0j) -> Contour:
    """A rectangle about `centre` [mm], counter-clockwise. `half` holds half its length and half its
    width [mm]; its length lies `along` a unit vector.
    """
    corners = np.array([-half, half.conjugate(), half, -half.conjugate()])
    return Contour.polygon(centre + corners * along)


Effort = Literal["fast", "fewest"]
"""Effort of a fit: one pass, or the fewest pieces and then the least deviation."""

Form = Literal["polyline", "arcs", "spline"]
"""Form of a contour, named by the entities of a drawing."""


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """A contour and its proof.

    Attributes
    ----------
    contour : the closed contour.
    deviation : upper bound [mm] of the distance between contour and exact curve, in both
        directions and for every point; rounding of the arithmetic included.
    tolerance : requested tolerance [mm]; `deviation` never exceeds it.
    """

    contour: Contour
    deviation: float
    tolerance: float


# -- simple ---------------------------------------------------------------------------------------
# Self-crossings and winding number of a contour. Topology only; no geometry comes from shapely.


SAGITTA = 1e-5
"""Sagitta of the chords that are tested for crossings, as a fraction of the contour's length."""


def crossing(contour: Contour) -> str | None:
    """Where the contour crosses itself, according to shapely; None if it does not."""
    from shapely import Polygon  # only for writing files: a check must not wait for its import
    from shapely.validation import explain_validity

    points = contour.points(SAGITTA * contour.length)
    polygon = Polygon(np.column_stack((points.real, points.imag)))
    return None if polygon.is_valid else str(explain_validity(polygon))


def require_simple(contour: Contour, name: str) -> None:
    """Raise UndercutError, naming the place, if the contour called `name` crosses itself.

    A curve that is regular everywhere may still cross itself: two flanks closer than the roller's
    diameter cut each other off (global undercut).
    """
    place = crossing(contour)
    if place is not None:
        raise UndercutError(
            f"the {name} crosses itself ({place}): two of its flanks are closer"
            " than the roller allows (global undercut); no disc has this outline"
        )


def winding_number(contour: Contour, point: complex) -> int:
    """Winding number of the contour about `point`, counter-clockwise positive.

    Exact: the turns of its chords, and its segments.

    The point must not lie on the contour.
    """
    pieces = contour.split(0.5 * np.pi)
    start, end = pieces.vertices - point, pieces.ends - point
    # Seen from a point between an arc and its chord, the arc goes round the other way than the
    # chord.
    inside = np.abs(point - pieces.centres) < pieces.radii
    beyond = (np.conj(end - start) * -start).imag * pieces.sweeps < 0.0
    segment_turns = np.where(inside & beyond, np.sign(pieces.sweeps), 0.0)
    chords = float(np.sum(np.angle(end * np.conj(start)))) / (2.0 * np.pi)
    return round(chords + float(np.sum(segment_turns)))


# -- pieces ---------------------------------------------------------------------------------------
# Lines and arcs in the plane, each for itself: the places on them and the distances from them.


HALF_TURN = 0.5 * TURN


class PieceRun(Protocol):
    """Anything made of lines and arcs: `Pieces`, a chain of them, a course."""

    @property
    def starts(self) -> ComplexArray: ...
    @property
    def ends(self) -> ComplexArray: ...
    @property
    def sweeps(self) -> FloatArray: ...
    @property
    def centres(self) -> ComplexArray: ...


@dataclass(frozen=True, slots=True, eq=False)
class Pieces(CheckedFields):
    """Lines and arcs that need not join.

    Attributes
    ----------
    starts, ends : (n,) complex [mm].
    sweeps : (n,) [rad], angle turned along the piece, positive counter-clockwise; 0 is a line.
    centres : (n,) complex [mm], centre of each arc; 0 where the piece is a line.
    """

    starts: Complexes
    ends: Complexes
    sweeps: Floats
    centres: Complexes

    def __len__(self) -> int:
        return len(self.starts)

    @classmethod
    def from_run(cls, run: PieceRun) -> Pieces:
        """The lines and arcs of `run`."""
        return Pieces(run.starts, run.ends, run.sweeps, run.centres)

    @classmethod
    def around(cls, contours: Iterable[Contour]) -> Pieces:
        """The lines and arcs of closed contours, arcs cut into parts of at most half a turn."""
        parts = [contour.split(HALF_TURN) for contour in contours]
        names = ("vertices", "ends", "sweeps", "centres")
        columns = ([getattr(contour, name) for contour in parts] for name in names)
        return Pieces(*(np.concatenate([np.empty(0), *column]) for column in columns))

    @property
    def radii(self) -> FloatArray:
        """(n,) [mm] radius of each arc; 0 for lines."""
        return piece_radii(self.starts, self.sweeps, self.centres)

    @property
    def lengths(self) -> FloatArray:
        """(n,) [mm] length of each piece."""
        return piece_lengths(self.starts, self.ends, self.sweeps, self.radii)

    def points_by_share(self, shares: FloatArray) -> ComplexArray:
        """(n,) complex [mm] the place on each piece at the share (n,) of its length; at 0 and 1
        exactly its ends.
        """
        straight = self.starts + (self.ends - self.starts) * shares
        turned = self.centres + (self.starts - self.centres) * np.exp(1j * self.sweeps * shares)
        inner = np.where(self.sweeps == 0.0, straight, turned)
        points: ComplexArray = np.where(shares == 1.0, self.ends, inner)
        return np.where(shares == 0.0, self.starts, points)

    def tangents(self, places: ComplexArray) -> ComplexArray:
        """(n,) unit tangents at `places` (n,) [mm] on the pieces; 0 on one without a length."""
        turned = 1j * np.sign(self.sweeps) * (places - self.centres)
        along = np.where(self.sweeps == 0.0, self.ends - self.starts, turned)
        size = np.abs(along)
        return np.asarray(np.divide(along, np.where(size > 0.0, size, 1.0)))

    def subpieces(self, first: FloatArray, last: FloatArray) -> Pieces:
        """The part of each piece from the share `first` (n,) to the share `last` (n,) of its
        length.
        """
        ends = (self.points_by_share(first), self.points_by_share(last))
        return Pieces(*ends, self.sweeps * (last - first), self.centres)

    def halves(self) -> tuple[IntArray, FloatArray, FloatArray]:
        """The pieces in equal parts of at most half a turn: (m,) number of the piece of each part,
        and (m,), (m,) the shares of its length between which the part lies.
        """
        counts = np.maximum(1, np.ceil(np.abs(self.sweeps) / HALF_TURN - 1e-12)).astype(np.intp)
        index, step = grouped(counts)
        return index, step / counts[index], (step + 1) / counts[index]

    def chords(self, sagitta: float) -> tuple[IntArray, ComplexArray]:
        """Chords within `sagitta` [mm] of the pieces: (m,) number of the piece of each, and (m,)
        complex [mm] where it ends.
        """
        flat = np.maximum(0.0, 1.0 - sagitta / np.where(self.sweeps == 0.0, np.inf, self.radii))
        steps = np.maximum(2.0 * np.arccos(flat), TURN / POINTS)
        counts = np.maximum(1, np.ceil(np.abs(self.sweeps) / steps)).astype(np.intp)
        index, number = grouped(counts)
        return index, taken(self, index).points_by_share((number + 1) / counts[index])

    def faces(self, arms: ComplexArray) -> BoolArray:
        """(n,) whether the ray along `arms` (n,) from the centre of each arc meets it."""
        turned = np.angle(arms * np.conj(self.starts - self.centres))
        turned = np.mod(np.where(self.sweeps < 0.0, -turned, turned), TURN)
        return np.asarray((self.sweeps != 0.0) & (turned <= np.abs(self.sweeps)))

    def feet(self, places: ComplexArray) -> FloatArray:
        """(n,) where the foot of `places` (n,) [mm] lies on each line, as a share of its length."""
        chords = self.ends - self.starts
        squares = np.where(chords == 0.0, 1.0, np.abs(chords) ** 2)
        return np.asarray(((places - self.starts) * np.conj(chords)).real / squares)

    def distances(self, places: ComplexArray) -> FloatArray:
        """(n,) distance [mm] of each of `places` (n,) from its piece; (k, n) for places (k, 1).

        The nearest point of a piece is the foot of the perpendicular, if that lies on it, or an
        end.
        """
        shares = np.clip(self.feet(places), 0.0, 1.0)
        to_line = np.abs(places - (self.starts + shares * (self.ends - self.starts)))
        at_ends = np.minimum(np.abs(places - self.starts), np.abs(places - self.ends))
        arms = places - self.centres
        to_arc = np.where(self.faces(arms), np.abs(np.abs(arms) - self.radii), at_ends)
        return np.asarray(np.where(self.sweeps == 0.0, to_line, to_arc))


# -- nearness -------------------------------------------------------------------------------------
# Distances from lines and arcs, in closed form.
#
# That between two pieces is taken at an end of one of them, or on their common normal, or is 0
# because they cross.


BLOCK = 500_000
"""Pairs of a point and a piece, or of two pieces, that are computed at a time."""


def distances(points: ComplexArray, run: PieceRun) -> FloatArray:
    """(n,) exact distance [mm] of each of `points` (n,) from the nearest piece of `run`."""
    pieces = Pieces.from_run(run)
    middles, reaches = _bounds(pieces)
    step = max(1, BLOCK // len(pieces))
    blocks = [np.empty(0)]
    for k in range(0, len(points), step):
        some = points[k : k + step]
        middle_distances = np.abs(some[:, None] - middles)
        # No nearest point lies farther off than this, so that most pieces are out of question.
        nearest = np.min(middle_distances + reaches, axis=1)
        row, column = np.nonzero(middle_distances - reaches <= nearest[:, None])
        piece_distances = taken(pieces, column).distances(some[row])
        # Each point keeps at least one piece; the pairs ascend by point.
        first = np.flatnonzero(np.diff(row, prepend=-1))
        blocks.append(np.minimum.reduceat(piece_distances, first))
    return np.concatenate(blocks)


def least_distance(one: PieceRun, other: PieceRun) -> float:
    """The distance [mm] between two chains, each piece beginning where the one before it ends; 0 if
    they meet.
    """
    # Ends against pieces first: pairs that could come nearer inside are then few.
    least = min(
        float(np.min(distances(_ends(one), other))), float(np.min(distances(_ends(other), one)))
    )
    a, b = Pieces.from_run(one), Pieces.from_run(other)
    (of_a, reach_a), (of_b, reach_b) = _bounds(a), _bounds(b)
    step = max(1, BLOCK // len(b))
    for k in range(0, len(a), step):
        rows = np.arange(k, min(k + step, len(a)))
        gaps = np.abs(of_a[rows, None] - of_b) - reach_a[rows, None] - reach_b
        row, column = np.nonzero(gaps < least)
        if len(row):
            some, others = taken(a, rows[row]), taken(b, column)
            mixed = _arc_line_gap(some, others), _arc_line_gap(others, some)
            least = min(least, _arc_gap(some, others), _line_gap(some, others), *mixed)
    return least


def proved_gap(one: Fit, other: Fit) -> float:
    """Lower bound [mm] of the distance between the exact curves of two fits; not positive where
    they may meet.
    """
    contours = (Pieces.around([fit.contour]) for fit in (one, other))
    return least_distance(*contours) - one.deviation - other.deviation


def _ends(chain: PieceRun) -> ComplexArray:
    """(n + 1,) complex [mm] the ends of the n pieces of a chain."""
    return np.append(chain.starts, chain.ends[-1:])


def _bounds(pieces: Pieces) -> tuple[ComplexArray, FloatArray]:
    """(n,) the middle [mm] of each piece, and a bound of the distance of its points from there."""
    middles = pieces.points_by_share(np.full(len(pieces), 0.5))
    # Of an arc up to half a turn the ends are farthest from its middle.
    small = np.abs(pieces.sweeps) <= HALF_TURN
    reaches = np.where(small, np.abs(pieces.starts - middles), 2.0 * pieces.radii)
    return middles, reaches


def _least_valid(values: FloatArray, valid: BoolArray) -> float:
    """The least of the `valid` values; infinite if there are none."""
    return float(np.min(values[valid], initial=np.inf))


def _arc_gap(a: Pieces, b: Pieces) -> float:
    """Least distance [mm] between inner points of pairs of arcs, along their common normals; 0
    where arcs cross, infinite if no pair has such points.
    """
    centre_line = b.centres - a.centres
    centre_distance = np.abs(centre_line)
    bent = (a.sweeps != 0.0) & (b.sweeps != 0.0) & (centre_distance > 0.0)
    along: ComplexArray = np.divide(
        np.where(bent, centre_line, 1.0), np.where(bent, centre_distance, 1.0)
    )
    ra, rb = a.radii, b.radii
    least = np.inf
    # The common normal is the line of centres; it leaves each circle on one side or the other.
    for one in (1.0, -1.0):
        for other in (1.0, -1.0):
            gap = np.abs(centre_distance + other * rb - one * ra)
            least = min(
                least, _least_valid(gap, bent & a.faces(one * along) & b.faces(other * along))
            )
    # From the centre of the first circle along the line of centres to the common chord.
    lever = (centre_distance**2 + ra**2 - rb**2) / (2.0 * np.where(bent, centre_distance, 1.0))
    meet = bent & (np.abs(lever) <= ra)
    height = np.sqrt(np.maximum(ra**2 - lever**2, 0.0))
    for side in (1j, -1j):
        arm: ComplexArray = along * (lever + side * height)
        if np.any(meet & a.faces(arm) & b.faces(a.centres + arm - b.centres)):
            return 0.0
    return least


def _arc_line_gap(arc: Pieces, line: Pieces) -> float:
    """Least distance [mm] between arc and line of a pair, as `_arc_gap` is between arcs."""
    mixed = (arc.sweeps != 0.0) & (line.sweeps == 0.0) & (line.starts != line.ends)
    share = line.feet(arc.centres)
    chord = line.ends - line.starts
    foot = line.starts + share * chord - arc.centres
    inside = mixed & (share >= 0.0) & (share <= 1.0)
    gap = np.abs(np.abs(foot) - arc.radii)
    least = _least_valid(gap, inside & arc.faces(foot))
    length = np.where(mixed, np.abs(chord), 1.0)
    # Half the chord that the circle cuts from the line, as a share of the line.
    half = np.sqrt(np.maximum(arc.radii**2 - np.abs(foot) ** 2, 0.0)) / length
    meet = mixed & (np.abs(foot) <= arc.radii)
    for side in (1.0, -1.0):
        place = share + side * half
        hit = meet & (place >= 0.0) & (place <= 1.0)
        if np.any(hit & arc.faces(line.starts + place * chord - arc.centres)):
            return 0.0
    return least


def _line_gap(a: Pieces, b: Pieces) -> float:
    """0 where two lines of a pair cross, else infinite: an end of one of them is nearest then."""
    along, across = a.ends - a.starts, b.ends - b.starts
    sine = (np.conj(along) * across).imag
    straight = (a.sweeps == 0.0) & (b.sweeps == 0.0) & (sine != 0.0)
    offset, safe = b.starts - a.starts, np.where(straight, sine, 1.0)
    first = (np.conj(offset) * across).imag / safe
    second = (np.conj(offset) * along).imag / safe
    crossed = straight & (first >= 0.0) & (first <= 1.0) & (second >= 0.0) & (second <= 1.0)
    return 0.0 if np.any(crossed) else np.inf
