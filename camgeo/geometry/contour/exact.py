"""Outlines of lines and arcs, e.g. a bore: chords of an arc, and the distance of two outlines."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, IntArray, taken

# -- arc chords -----------------------------------------------------------------------------------
# Chords of circular arcs with the arc on both sides of them, in closed form.
#
# Vertices lie at the radius r + u and chords touch the circle of radius r - u, so that a chord from
# vertex to vertex spans 2 arccos((r - u)/(r + u)). Differences of nearly equal numbers are avoided
# by 1 - cos x = 2 sin^2(x/2).


HALVINGS = 60
"""Halvings in the search for the least offset: double precision resolves no more."""


def arc_count(tolerance: float, radius: float, sweep: float, most_turn: float) -> int:
    """Fewest chords within `tolerance` [mm] of an arc, its ends exact vertices.

    Parameters
    ----------
    sweep : angle of the arc [rad], positive.
    most_turn : largest span of a chord [rad]; those at the ends span less.
    """
    on_arc = min(2.0 * _end_reach(tolerance, radius), most_turn)
    plain = max(1, _ceil(sweep / on_arc))
    # At this offset a chord between two vertices at r + u spans `most_turn`.
    tolerance = min(tolerance, radius * math.tan(0.25 * most_turn) ** 2)
    rest = sweep - 2.0 * _end_reach(tolerance, radius)
    return min(plain, 1 + max(0, _ceil(rest / (2.0 * _reach(tolerance, radius)))))


def arc_offset(count: int, radius: float, sweep: float) -> float:
    """Least u [mm] with which `count` chords with exact ends cover an arc of `sweep` [rad]."""
    low, high = 0.0, radius
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        reach = 2.0 * _end_reach(middle, radius) + 2.0 * (count - 1) * _reach(middle, radius)
        low, high = (middle, high) if reach < sweep else (low, middle)
    return high


def arc_angles(count: int, radius: float, sweep: float, offset: float) -> FloatArray:
    """(count + 1,) [rad] angles of the vertices along the arc, both ends included."""
    last = _end_reach(offset, radius) + _reach(offset, radius)
    if count < 3:
        return np.linspace(0.0, sweep, count + 1)
    inner = np.linspace(last, sweep - last, count - 1)
    return np.concatenate(([0.0], inner, [sweep]))


def circle_count(tolerance: float, radius: float, most_turn: float) -> int:
    """Fewest chords, at least three, within `tolerance` [mm] of a whole circle."""
    widest = min(2.0 * _reach(tolerance, radius), most_turn)
    return max(3, _ceil(2.0 * math.pi / widest))


def _reach(offset: float, radius: float) -> float:
    """Half the angle [rad] of a chord between two vertices at r + u."""
    return 2.0 * math.asin(math.sqrt(min(offset / (radius + offset), 0.5)))


def _end_reach(offset: float, radius: float) -> float:
    """Angle [rad] from a vertex on the circle to where its chord touches that of r - u."""
    return 2.0 * math.asin(math.sqrt(min(0.5 * offset / radius, 0.5)))


def _ceil(share: float) -> int:
    """Smallest whole number not below `share` by more than rounding."""
    return math.ceil(share * (1.0 - 2.0**-46))


# -- distance -------------------------------------------------------------------------------------
# The distance between two closed contours of lines and arcs: a sharp bound of Hausdorff's.
#
# The largest distance of the points of one contour from the other is found by branch and bound. A
# cell, a part of a piece, is compared with all pieces that can be nearest to one of its points:
#
# - As long as the cell lies between the normals at the ends of a piece, the distance is that from
#   the line or circle of the piece; its extremes along the cell are known in closed form.
# - Otherwise one end of the piece bounds the distance.
#
# Cells for which this is not sharp are halved. The distance itself changes by no more than a
# coordinate does, and the bound exceeds it by at most the fraction `SHARPNESS`, so that neither
# jumps where a point passes a corner or a joint.
#
# A line is an arc without a sweep: with S and K the sine and the cosine of half its sweep, c its
# chord, and x, y along and across it, the distance from the circle is
#
#     ((x (x - c) + y^2) S - c y K) / (|(x - c/2) S + i (y S - c K/2)| + c/2),
#
# which neither needs the centre nor loses digits as the arc becomes flat.


SHARPNESS = 1e-9
"""Largest fraction by which the bound exceeds the distance, apart from rounding."""

HALF = 0.5 * SHARPNESS
"""The share of each direction: the second one starts from the bound of the first."""

ROUNDING = 2.0**-52 * 4.0
"""Rounding of a distance, as a fraction of the contours' size."""

WIDEST_PART = 0.5 * math.pi
"""Arcs are cut into parts of at most this sweep [rad]: a part then lies within the rectangle over
its chord, and the normals at its ends enclose all points that it is nearest to."""

FEW = 12
"""Pieces per cell up to which the distances from all of them are bounded."""

ROUNDS = 60
"""Most rounds of halving; then, or before `MOST` cells, the bound is not sharp, but still one."""

MOST = 100_000
"""Most cells that are halved [some 50 MB]."""

PAIRS = 250_000
"""Pairs of a cell and a piece that are examined at a time [some 60 MB]."""


@dataclass(frozen=True, slots=True, eq=False)
class _Pieces:
    """Lines and arcs through two points, by sweep; none has length 0.

    Attributes
    ----------
    start, end : (n,) complex [mm].
    sweep : (n,) [rad] at most `WIDEST_PART`; 0 is a line.
    """

    start: ComplexArray
    end: ComplexArray
    sweep: FloatArray

    @property
    def chord(self) -> ComplexArray:
        """(n,) complex [mm] from start to end."""
        return self.end - self.start

    @property
    def rise(self) -> ComplexArray:
        """(n,) complex [mm] from the middle of the chord to that of the piece."""
        return -0.5j * self.chord * np.tan(0.25 * self.sweep)

    @property
    def middle(self) -> ComplexArray:
        """(n,) complex [mm] the point half way along each piece."""
        return 0.5 * (self.start + self.end) + self.rise

    def points_by_share(self, share: FloatArray) -> ComplexArray:
        """(n,) complex [mm] the point of each piece at the `share` (n,) of its length."""
        half = 0.5 * self.sweep
        safe = np.where(half == 0.0, 1.0, half)
        # From the chord alone: the centre of a flat arc is far away and has no digits left.
        bent = np.exp(1j * half * (share - 1.0)) * np.sin(safe * share) / np.sin(safe)
        return self.start + self.chord * np.where(half == 0.0, share, bent)

    def halves(self) -> _Pieces:
        """(2 n,) the first half of each piece, then the second halves."""
        middle, sweep = self.middle, 0.5 * self.sweep
        return _Pieces(
            np.concatenate((self.start, middle)),
            np.concatenate((middle, self.end)),
            np.concatenate((sweep, sweep)),
        )


def distance(one: Contour, other: Contour) -> float:
    """Upper bound [mm] of the largest distance of a point of either contour from the other one.

    It exceeds that distance by at most the fraction `SHARPNESS` and rounding. Arcs count as those
    of their sweep through their end points.
    """
    size = max(float(np.max(np.abs(contour.vertices))) for contour in (one, other))
    rounding = ROUNDING * size
    a, b = _pieces(one), _pieces(other)
    if len(a.sweep) < len(b.sweep):
        a, b = b, a  # many cells with few pieces each take one round, and the others then few
    bound = 0.0
    for cells, pieces in ((a, b), (b, a)):
        reached, some = bound, max(1, PAIRS // len(pieces.sweep))
        for first in range(0, len(cells.sweep), some):
            block = taken(cells, slice(first, first + some))
            reached, block_bound = _largest_distance(block, pieces, rounding, reached)
            bound = max(bound, block_bound)
    return bound + 2.0 * rounding


def _pieces(contour: Contour) -> _Pieces:
    parts = contour.split(WIDEST_PART)
    moving = parts.vertices != parts.ends
    return _Pieces(parts.vertices[moving], parts.ends[moving], parts.sweeps[moving])


def _largest_distance(
    cells: _Pieces, pieces: _Pieces, rounding: float, known: float
) -> tuple[float, float]:
    """Largest distance [mm] found of a point of `cells` from `pieces`, and a bound of it; both at
    least `known`.
    """
    count, others = len(cells.sweep), len(pieces.sweep)
    pairs = np.repeat(np.arange(count), others), np.tile(np.arange(others), count)
    starts = _group_least(_distances(cells.start[pairs[0]], taken(pieces, pairs[1])), pairs[0])
    reached, bound = max(known, float(np.max(starts))), known
    for _ in range(ROUNDS):
        # In the order of the cells, each of which has at least one piece.
        pairs, reached, most = _bound_cells(cells, pieces, pairs, reached, rounding)
        loose = most > reached * (1.0 + HALF) + rounding
        bound = max(bound, float(np.max(most[~loose], initial=0.0)))
        if not np.any(loose):
            return reached, bound
        if np.count_nonzero(loose) > MOST:
            break
        # The numbers that the loose cells have once the others are dropped.
        place = np.cumsum(loose) - 1
        undecided = loose[pairs[0]]
        cell, piece = place[pairs[0][undecided]], pairs[1][undecided]
        number = int(place[-1]) + 1
        # `halves` lists all first halves, then all second ones; both keep the pieces of their cell.
        pairs = np.concatenate((cell, cell + number)), np.concatenate((piece, piece))
        cells = taken(cells, loose).halves()
    return reached, max(bound, float(np.max(most[loose])))


Pairs = tuple[IntArray, IntArray]
"""(m,), (m,) numbers of cells, ascending, and of pieces."""


def _bound_cells(
    cells: _Pieces, pieces: _Pieces, pairs: Pairs, reached: float, rounding: float
) -> tuple[Pairs, float, FloatArray]:
    """The pairs in which the piece may be nearest to a point of the cell, the largest distance
    found [mm], and the bound (cells,) of each cell's [mm].
    """
    middle = cells.middle
    reach = np.maximum(np.abs(cells.start - middle), np.abs(cells.end - middle))
    distances = _distances(middle[pairs[0]], taken(pieces, pairs[1]))
    nearest = _group_least(distances, pairs[0])
    reached = max(reached, float(np.max(nearest)))
    # A piece that is farther from the middle than the nearest one, by twice the reach, is never
    # the nearest to a point of the cell.
    near = distances <= (nearest + 2.0 * reach)[pairs[0]] + rounding
    pairs = pairs[0][near], pairs[1][near]
    # No point of a cell lies farther from its middle than `reach`, and distances change no faster.
    most = nearest + reach
    few = (np.bincount(pairs[0], minlength=len(most)) <= FEW) & (most > reached)
    chosen = few[pairs[0]]
    if np.any(chosen):
        cell, piece = pairs[0][chosen], pairs[1][chosen]
        chosen_cells, chosen_pieces = taken(cells, cell), taken(pieces, piece)
        share, largest = _extremes(chosen_cells, chosen_pieces, rounding)
        least = _group_least(largest, cell)
        most[few] = np.minimum(most[few], least)
        # Where the piece that decides is farthest off, the distance is found, not only bounded.
        place = np.cumsum(few) - 1
        deciding = np.flatnonzero(largest == least[place[cell]])
        shares = np.zeros(len(least))
        shares[place[cell[deciding]]] = share[deciding]
        points = taken(cells, few).points_by_share(shares)
        there = _group_least(_distances(points[place[cell]], chosen_pieces), cell)
        reached = max(reached, float(np.max(there)))
    return pairs, reached, most


def _group_least(values: FloatArray, group: IntArray) -> FloatArray:
    """The least of `values` (m,) in each run of equal numbers in the ascending `group` (m,)."""
    first = np.flatnonzero(np.diff(group, prepend=-1))
    return np.asarray(np.minimum.reduceat(values, first))


@dataclass(frozen=True, slots=True, eq=False)
class _Frame:
    """Pieces in the axes of their chords, mirrored so that all turn counter-clockwise.

    Attributes
    ----------
    along : (n,) complex unit vectors of the chords.
    chord : (n,) [mm].
    sine, cosine : (n,) of half the sweeps.
    mirrored : (n,) whether a piece turns clockwise.
    """

    along: ComplexArray
    chord: FloatArray
    sine: FloatArray
    cosine: FloatArray
    mirrored: BoolArray

    def local(self, vectors: ComplexArray) -> ComplexArray:
        """(n,) `vectors` in these axes."""
        turned = vectors * np.conj(self.along)
        return np.where(self.mirrored, np.conj(turned), turned)

    def outside(self, vectors: ComplexArray) -> ComplexArray:
        """(n,) `vectors` in these axes, in those of the contours: the inverse of `local`."""
        return np.where(self.mirrored, np.conj(vectors), vectors) * self.along

    def from_centre(self, points: ComplexArray) -> ComplexArray:
        """(n,) from the centre to `points` (n,) in these axes, times `sine`."""
        return (points - 0.5 * self.chord) * self.sine - 0.5j * self.chord * self.cosine

    def circle_distances(self, points: ComplexArray) -> FloatArray:
        """(n,) [mm] distance of `points` in these axes from line or circle, positive outside."""
        x, y = points.real, points.imag
        power = (x * (x - self.chord) + y * y) * self.sine - self.chord * y * self.cosine
        return np.asarray(power / (np.abs(self.from_centre(points)) + 0.5 * self.chord))

    def beyond(self, points: ComplexArray) -> FloatArray:
        """(n,) [mm] how far `points` in these axes lie beyond the normals at the ends."""
        heading = self.cosine + 1j * self.sine  # at the end, and mirrored at the start
        start_excess = -(points * heading).real
        end_excess = ((points - self.chord) * np.conj(heading)).real
        return np.maximum(start_excess, end_excess)


def _frame(pieces: _Pieces) -> _Frame:
    chord = np.abs(pieces.chord)
    half = 0.5 * np.abs(pieces.sweep)
    along = pieces.chord / chord
    return _Frame(along, chord, np.sin(half), np.cos(half), pieces.sweep < 0.0)


def _distances(points: ComplexArray, pieces: _Pieces) -> FloatArray:
    """(n,) distance of each of `points` (n,) from its piece."""
    frame = _frame(pieces)
    local = frame.local(points - pieces.start)
    at_ends = np.minimum(np.abs(points - pieces.start), np.abs(points - pieces.end))
    return np.where(frame.beyond(local) <= 0.0, np.abs(frame.circle_distances(local)), at_ends)


def _extremes(cells: _Pieces, pieces: _Pieces, rounding: float) -> tuple[FloatArray, FloatArray]:
    """(n,) where a cell is farthest from the line or circle of its piece, as a share of its length,
    and (n,) a bound of the largest distance of its points from the piece [mm].
    """
    frame = _frame(pieces)
    shares = np.stack(
        (np.zeros(len(cells.sweep)), np.ones(len(cells.sweep)), _parallel_share(cells, pieces))
    )
    offsets = np.stack(
        [
            np.abs(frame.circle_distances(frame.local(cells.points_by_share(t) - pieces.start)))
            for t in shares
        ]
    )
    farthest = np.argmax(offsets, axis=0)
    share, largest = (
        np.take_along_axis(rows, farthest[None, :], axis=0)[0] for rows in (shares, offsets)
    )
    # The cell lies in the rectangle over its chord, so bounds at its four corners hold for it.
    hull = [end + rise for end in (cells.start, cells.end) for rise in (0.0, cells.rise)]
    beyond = np.max([frame.beyond(frame.local(corner - pieces.start)) for corner in hull], axis=0)
    end_distances = [
        np.max([np.abs(corner - end) for corner in hull], axis=0)
        for end in (pieces.start, pieces.end)
    ]
    bound = np.where(beyond <= rounding, largest, np.minimum(end_distances[0], end_distances[1]))
    return share, bound


def _parallel_share(cells: _Pieces, pieces: _Pieces) -> FloatArray:
    """(n,) where a cell runs parallel to the line or circle of its piece, as a share of its length;
    if it does so nowhere, any share.

    There its normal passes through the centre of the piece.
    """
    cell_frame, frame = _frame(cells), _frame(pieces)
    gradient = frame.outside(frame.from_centre(frame.local(cells.start - pieces.start)))
    bent = cells.sweep != 0.0
    arm = cell_frame.outside(cell_frame.from_centre(np.zeros_like(cells.start)))
    # From the piece's centre to the cell's own, times both sines.
    centre_offset = cell_frame.sine * gradient - frame.sine * arm
    turned = np.angle(centre_offset * np.conj(arm)) * np.where(cells.sweep < 0.0, -1.0, 1.0)
    on_arc = np.mod(turned, math.pi) / np.where(bent, np.abs(cells.sweep), 1.0)
    round_piece = frame.sine > 0.0
    square = np.where(round_piece, frame.sine, 1.0) * cell_frame.chord * cell_frame.chord
    # Of a line cell: where the way from the piece's centre is square to it.
    foot = -(gradient * np.conj(cells.chord)).real / square
    share = np.where(bent, on_arc, np.where(round_piece, foot, 0.0))
    return np.asarray(np.clip(share, 0.0, 1.0))


def deviation_bound(exact: Contour, contour: Contour) -> float:
    """Upper bound [mm] of the distance between two closed contours, in both directions.

    It changes no faster than the numbers of `contour` do, see above.

    Raises
    ------
    GeometryError
        If `contour` does not follow `exact` once round.
    """
    if abs(abs(exact.area) - abs(contour.area)) > 0.5 * abs(exact.area):
        raise GeometryError("the contour does not run once round the exact outline")
    return distance(exact, contour)
