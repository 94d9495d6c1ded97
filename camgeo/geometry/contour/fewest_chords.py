"""Fit by the fewest straight pieces: chords with the curve on both sides of them."""

from __future__ import annotations

import heapq
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise

import numpy as np

from camgeo.errors import GeometryError, ToleranceError
from camgeo.geometry.contour.chords import MAX_CHORDS, fit_polyline
from camgeo.geometry.contour.contour import Fit
from camgeo.geometry.contour.exact import arc_angles, arc_count, arc_offset
from camgeo.geometry.contour.legs import Chain, StretchLeg, TurnLeg, check_regular, too_many_error
from camgeo.geometry.contour.proof import SHARPNESS, PieceOfLeg, proved_fit
from camgeo.geometry.outline.path import Path
from camgeo.geometry.pieces import SmoothPiece
from camgeo.geometry.pitch_curve import WorkingCurve
from camgeo.kinematics.mechanism.follower import bend_of_path
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, IntArray, ascending, grouped
from camgeo.units import TURN

PROVED = 1.0 + SHARPNESS + 2e-3
"""Expected bound of the proof as a multiple of the deviation found: slightly more, because the
largest deviation lies between the samples."""

FEW = 64
"""Up to this many pieces the fit is compared with chords between points of the curve: on turns of
many radians per millimetre both are limited by the angle of a chord, not by its sagitta. Beyond,
there are 1.4 times as many of the latter."""

EASE = 1.0 - 2.0**-8
"""Factor of the deviation of the next layout if a proof fails. Near tips samples miss up to one
hundredth of the distance; three of the six possible steps make up for that."""

KINK = 2.0**-52 * 256.0
"""A gap above this fraction of the distance from the cam axis, or this many radians between
tangents, is more than rounding: there the curve has a corner or a small gap."""


def fewest_chords(path: Path, tolerance: float) -> Fit:
    """The fewest straight pieces within `tolerance` [mm] of `path`, counter-clockwise.

    A chord of length h with the curve on both sides lies |kappa| h^2/16 off it, so the integral of
    sqrt(|kappa|/(16 tolerance)) ds is their number. Vertices are off the curve, at bends on its
    outer side; only the corners of the path, and the ends of its arcs, are vertices themselves.
    Breaks need not be. There are never more pieces than from `fit_polyline`.

    Raises
    ------
    UndercutError
        If the path is not regular.
    ToleranceError
        If the tolerance cannot be reached in double precision.
    GeometryError
        If the contour cannot be compared with the path.
    """
    ladders: list[list[Ladder]] = []
    deviations: list[float] = []

    def fit_pieces(pieces: Sequence[PieceOfLeg], aim: float) -> list[Chain]:
        for leg, piece in pieces:
            require_regular(leg.curve, piece)
        legs = [list(group) for _, group in groupby(pieces, lambda pair: id(pair[0]))]
        if not ladders:
            ladders.extend(_ladders(leg_pieces[0][0]) for leg_pieces in legs)
        # If the proved deviation of a layout exceeds the one found, a layout with less deviation
        # follows. Which one does not depend on the tolerance, so a looser one takes no more
        # pieces.
        most = max(deviations) * EASE if deviations else aim
        deviations.clear()
        chains: list[Chain] = []
        for leg_pieces, leg_ladders in zip(legs, ladders, strict=True):
            laid = [ladder.fewest(most, PROVED, MAX_CHORDS) for ladder in leg_ladders]
            deviations.extend(deviation for _, deviation in laid)
            # One chain for all of a leg, none for its other pieces.
            chains += [
                _chain([chords for chords, _ in laid]),
                *[Chain.empty()] * (len(leg_pieces) - 1),
            ]
        return chains

    def fit_turn(leg: TurnLeg, aim: float) -> Chain:
        return _arc_chords(leg, aim / (1.0 + SHARPNESS))

    try:
        fit = proved_fit(path, tolerance, tolerance, fit_pieces, fit_turn)
    except (ToleranceError, GeometryError):
        return fit_polyline(path, tolerance)
    if len(fit.contour) <= FEW:
        plain = fit_polyline(path, tolerance)
        if len(plain.contour) < len(fit.contour):
            return plain
    return fit


def require_regular(curve: WorkingCurve, piece: SmoothPiece) -> None:
    """Raise UndercutError if 1 + d kappa is negative at some sample of the piece.

    It may be zero at single points, at a cusp without undercut, but not over a whole dwell.
    """
    grid = np.linspace(piece.start, piece.end, 257)[1:-1]
    check_regular(curve, piece, curve.regularity(grid))


def _ladders(leg: StretchLeg) -> list[Ladder]:
    """The ladders along a whole leg, from corner to corner."""
    cuts = _kinks(leg)
    if leg.closed and not len(cuts):
        return [Ladder.from_stretch(_chord_stretch(leg, leg.start, leg.end, closed=True))]
    ends = [*cuts, cuts[0] + leg.end - leg.start] if leg.closed else [leg.start, *cuts, leg.end]
    parts = [_chord_stretch(leg, low, high, closed=False) for low, high in pairwise(ends)]
    return [Ladder.from_stretch(part) for part in parts]


def _kinks(leg: StretchLeg) -> list[float]:
    """Cam angles [rad] inside the leg where its pieces do not meet smoothly to rounding."""
    joints = leg.joints
    right, left = leg.point(joints), leg.point(joints, "left")
    turned = np.abs(leg.curve.tangent(joints) - leg.curve.tangent(joints, "left"))
    gapped = np.abs(right - left) > KINK * np.abs(right)
    return [float(angle) for angle in joints[gapped | (turned > KINK)]]


def _chord_stretch(leg: StretchLeg, start: float, end: float, *, closed: bool) -> ChordStretch:
    """The stretch of `leg` from cam angle `start` to `end` [rad], without a corner inside."""
    curve = leg.curve

    def place(phi: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        points, tangents = curve.points_and_tangents(phi)
        if not closed:
            points[-1] = curve.point(phi[-1:], "left")[0]
            tangents[-1] = curve.tangent(phi[-1:], "left")[0]
        return points, tangents

    return ChordStretch(stretch_table(curve, start, end), place, curve.point, leg.rotation, closed)


def _chain(laid: Sequence[Chords]) -> Chain:
    """The chain of consecutive stretches: the last vertex of each is the first of the next."""
    angles = np.concatenate([chords.angles[: len(chords.worst)] for chords in laid])
    vertices = np.concatenate([chords.vertices[: len(chords.worst)] for chords in laid])
    return Chain.straight(angles, vertices)


def _arc_chords(leg: TurnLeg, aim: float) -> Chain:
    """The fewest chords within `aim` [mm] of an arc, which lies on both sides of them."""
    count = arc_count(aim, leg.radius, leg.end, MOST_TURN)
    if count > MAX_CHORDS:
        raise too_many_error(MAX_CHORDS, "straight pieces", aim)
    offset = arc_offset(count, leg.radius, leg.end)
    angles = arc_angles(count, leg.radius, leg.end, offset)[:-1]
    vertices = leg.centre + (1.0 + offset / leg.radius) * (leg.point(angles) - leg.centre)
    vertices[0] = leg.first
    return Chain.straight(angles, vertices)


# -- ladder ---------------------------------------------------------------------------------------
# Number of straight pieces for each bend of a stretch: one ladder for all tolerances.
#
# The ladder is a property of the stretch. Its rungs are numbers of pieces, placed for equal
# deviations whatever the tolerance; a tolerance takes the fewest pieces that meet it. So a looser
# one, which can choose among all of these and more, never takes more.


MOST_TURN = 0.5
"""The curve turns by at most this angle [rad] along a piece, however small its sagitta: the proof
needs both to run the same way."""

RUNGS = 1024
"""Rungs on which the number of pieces doubles: 0.07 % between two, less than a piece of 1000."""

FINEST = 60 * RUNGS
"""Last rung: beyond it there are more pieces than double precision can count."""

SHORT = 12
"""Bends of fewer pieces may get single pieces more than by the formula: it is asymptotic, and gives
too few between inflections close to each other."""

LAYOUTS, LAID = 250, 250_000
"""Most layouts tried, and most pieces in all of them; usually the first or second suffices."""


@dataclass(frozen=True, slots=True, eq=False)
class Ladder:
    """The possible numbers of pieces along a stretch.

    Attributes
    ----------
    stretch : of the pieces.
    unit : [mm] deviation on rung 0, where the table counts one piece.
    """

    stretch: ChordStretch
    unit: float

    @classmethod
    def from_stretch(cls, stretch: ChordStretch) -> Ladder:
        """The ladder of a stretch; the unit of a straight one is its own length."""
        table = stretch.table
        whole = 0.25 * float(np.sum(table.bends))
        return cls(stretch, whole * whole or float(np.sum(table.steps)))

    def fewest(self, most: float, share: float, most_pieces: int) -> tuple[Chords, float]:
        """The fewest pieces whose proved deviation is at most `most` [mm], and that deviation.

        Parameters
        ----------
        share : upper bound of the proved deviation, as a multiple of the deviation of the layout.
        most_pieces : largest number of pieces.

        Raises
        ------
        ToleranceError
            If no such number of pieces can meet the deviation in double precision.
        """
        # The rung on which the formula expects this deviation.
        rung = max(math.ceil(0.5 * RUNGS * math.log2(share * self.unit / most)), -FINEST)
        reached = math.inf
        seen: set[bytes] = set()
        waiting: list[tuple[int, int, bytes, int, bool]] = []

        def wait(counts: IntArray, rung: int, *, plain: bool) -> None:
            key = counts.tobytes()
            if key not in seen:
                seen.add(key)
                # Fewest pieces first, and among equals the layout of a rung before one with an
                # added piece.
                heapq.heappush(waiting, (int(np.sum(counts)), -plain, key, rung, plain))

        wait(self._counts(rung), rung, plain=True)
        pieces = 0
        for _ in range(LAYOUTS):
            if pieces > LAID:
                break
            number, _, key, rung, plain = heapq.heappop(waiting)
            pieces += number
            if number > most_pieces:
                raise too_many_error(most_pieces, "straight pieces", most)
            counts = np.frombuffer(key, dtype=np.intp)
            rung = self._last_rung(counts, rung)
            bends = self._bends(rung)
            aim = self._aim(rung) * bends.least(counts)
            laid = place_equal_error(self.stretch, aim, counts, MOST_TURN)
            chords = laid.chords
            # As in the proof: distances across the pieces, and of the ends along them.
            deviation = math.hypot(share * float(np.max(chords.worst)), chords.gap)
            if np.max(chords.turns) <= MOST_TURN * EVENNESS:
                reached = min(reached, deviation)
                if deviation <= most:
                    return chords, deviation
            if plain and rung < FINEST:
                wait(self._counts(rung + 1), rung + 1, plain=True)
            for bend in _worst(laid, counts, aim):
                more = counts.copy()
                more[bend] += 1
                wait(more, rung, plain=False)
        raise ToleranceError("straight pieces cannot follow the curve", most, reached)

    def _aim(self, rung: int) -> float:
        """Deviation [mm] on a `rung`: half of that `RUNGS / 2` rungs before."""
        return self.unit * math.exp2(-2.0 * rung / RUNGS)

    def _bends(self, rung: int) -> StretchBends:
        """The bends of the stretch for the deviation on a `rung`."""
        table = self.stretch.table
        shares = table.shares(self._aim(rung), MOST_TURN)
        return stretch_bends(self.stretch, shares, np.ones(len(table.inflections)))

    def _counts(self, rung: int) -> IntArray:
        """(b,) pieces for the bends on a rung; no later rung has fewer."""
        counts = self._bends(rung).counts()
        return np.maximum(counts, 3) if self.stretch.closed and len(counts) == 1 else counts

    def _last_rung(self, counts: IntArray, rung: int) -> int:
        """The last rung on which no bend needs more than its `counts` (b,); `rung` is one such."""
        low, step = rung, 1
        # Doubled steps bracket the last rung, then halving finds it.
        while low + step <= FINEST and np.all(self._counts(low + step) <= counts):
            low, step = low + step, 2 * step
        high = min(low + step, FINEST + 1)
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (middle, high) if np.all(self._counts(middle) <= counts) else (low, middle)
        return low


def _worst(laid: EqualErrorPieces, counts: IntArray, aim: float) -> set[int]:
    """The one or two short bends of the piece with the largest deviation."""
    chords = laid.chords
    worst = int(np.argmax(np.maximum(chords.worst / aim, chords.turns / MOST_TURN)))
    bend = int(laid.bend[worst])
    bends = {bend, (bend + 1) % len(counts)} if laid.through[worst] else {bend}
    return {k for k in bends if counts[k] < SHORT}


# -- equal error ---------------------------------------------------------------------------------
# Straight pieces placed so that all of them have equal deviations, bend by bend.
#
# One chord runs through each inflection, from eps off on one side to eps off on the other. It is
# the longest of all; between two such chords lies a bend.


THROUGH = (2.0 / 3.0) * 1.5**0.5
"""Fraction of a chord of a bend that the chord through an inflection covers on each side: on a
cubic y = c s^3/6 it reaches to h^3 = 24 eps/c, where the integral of sqrt(c s/(16 eps)) is (2/3)
sqrt(24/16)."""

CORNER = 0.5 - 0.5 * 0.5**0.5
"""Fraction of a chord that is lost where it ends on the curve itself: there its sagitta b obeys (4
b - eps)^2 = 16 b eps, and its length is sqrt(b/(2 eps)) of the others'."""


@dataclass(frozen=True, slots=True, eq=False)
class StretchBends:
    """Starts and ends of the bends between inflections, in chords, see `StretchTable.shares`.

    Attributes
    ----------
    low, high : (b,) ends of the bends; equal where two inflections leave no room between.
    extra : (b,) chords that a bend needs in addition because it ends at corners.
    beyond : (b,) chords of it that those through inflections replace.
    narrow : (b,) whether chords through inflections could reach farther into it.
    """

    low: FloatArray
    high: FloatArray
    extra: FloatArray
    beyond: FloatArray
    narrow: BoolArray

    def counts(self) -> IntArray:
        """(b,) the least number of chords of each bend."""
        length = self.high - self.low
        needed = np.ceil((length + self.extra) * (1.0 - 1e-9))
        return np.where(length > 0.0, np.maximum(needed, 1.0), 0.0).astype(np.intp)

    def least(self, counts: IntArray) -> float:
        """Fraction of the tolerance at which the bends need exactly `counts` (b,) chords."""
        some = self.high > self.low
        if not np.any(some):
            return 1.0
        spare = (counts - self.extra + self.beyond)[some]
        needed = (self.high - self.low + self.beyond)[some]
        return min(float(np.max(needed / spare)) ** 2, 1.0)


def stretch_bends(
    stretch: ChordStretch,
    shares: FloatArray,
    reaches: FloatArray,
    counts: IntArray | None = None,
) -> StretchBends:
    """The bends of a stretch if the chords through its inflections reach `reaches` (k,) `THROUGH`
    to both sides.

    Two of these chords may leave no room for a bend and meet in the middle, as where `counts` (b,)
    is 0; where it is not, its chords get at least half of the bend.
    """
    total = float(shares[-1])
    inflections = shares[list(stretch.table.inflections)]
    left, right = inflections - THROUGH * reaches, inflections + THROUGH * reaches
    if stretch.closed and not len(inflections):
        none = np.zeros(1)
        return StretchBends(none, np.array([total]), none, none, none > 0.0)
    if stretch.closed:
        # Bend k lies between the inflections k and k + 1, the last one across the start.
        low, high = right, np.append(left[1:], left[0] + total)
        first, last = inflections, np.append(inflections[1:], inflections[0] + total)
        extra = np.zeros(len(low))
    else:
        low, high = np.append(0.0, right), np.append(left, total)
        first, last = np.append(0.0, inflections), np.append(inflections, total)
        extra = np.zeros(len(low))
        extra[0] += CORNER
        extra[-1] += CORNER
    room = np.zeros(len(low)) if counts is None else np.where(counts > 0, 0.5 * (last - first), 0.0)
    narrow = high - low < room
    if counts is not None:
        narrow |= counts == 0
    start, end = 0.5 * (first + last - room), 0.5 * (first + last + room)
    if not stretch.closed:  # its ends are vertices
        start[0], end[0] = 0.0, room[0]
        start[-1], end[-1] = total - room[-1], total
    low, high = np.where(narrow, start, low), np.where(narrow, end, high)
    return StretchBends(low, high, extra, last - first - (high - low), narrow)


ROUNDS = 8
"""Most rounds of placing the vertices."""

EVENNESS = 1.001
"""Deviations are even enough if the largest is at most this multiple of the target."""

UNEVEN, SINGLE = 1.003, 24
"""Vertices of pieces that deviate by more than this multiple are placed one by one in the next
rounds, up to this many: near tips the least squares are not the least deviation."""

LEAST_COST = 0.05
"""A chord with almost no deviation, on a straight stretch, may become 20 times as long in one
round."""


@dataclass(frozen=True, slots=True, eq=False)
class EqualErrorPieces:
    """Pieces placed along a stretch.

    Attributes
    ----------
    chords : the pieces.
    bend : (c,) index of the bend of each piece; of a chord through an inflection that before it.
    through : (c,) whether a piece runs through an inflection.
    """

    chords: Chords
    bend: IntArray
    through: BoolArray


def place_equal_error(
    stretch: ChordStretch, tolerance: float, counts: IntArray, most_turn: float
) -> EqualErrorPieces:
    """Pieces that deviate by `tolerance` [mm] if they can: `counts` (b,) of them in the bends.

    Vertices are placed by equal shares of the table first, then of the deviations found. The chords
    through inflections are shortened where they deviate more, and pieces that still do are placed
    vertex by vertex.
    """
    shares = stretch.table.shares(tolerance, most_turn)
    total = float(shares[-1])
    reaches = np.ones(len(stretch.table.inflections))
    marks = costs = shares
    best, least = None, math.inf
    single = np.zeros(0, dtype=np.bool_)
    for number in range(ROUNDS):
        bends = stretch_bends(stretch, shares, reaches, counts)
        places, bend, through = _places(stretch, bends, counts, marks, costs)
        full = stretch.table.sagittas(tolerance, most_turn, shares, places % total)
        held, offsets, loose = _offsets(stretch, bends, bend, through, full)
        single = single if len(single) else np.zeros(len(places), dtype=np.bool_)
        loose |= single & ~held
        chords = lay_chords(stretch, stretch.angles(shares, places), held, offsets, loose)
        size = len(chords.worst)
        through = through[:size]
        turned = float(np.max(chords.turns)) / most_turn
        score = max(float(np.max(chords.worst)) / tolerance, turned)
        gain = least / score
        if gain > 1.0:
            best, least = EqualErrorPieces(chords, bend[:size], through), score
        excess = np.maximum(chords.worst[through] / tolerance, 1.0)
        converged = number > 2 and gain < EVENNESS and np.max(excess, initial=0.0) <= EVENNESS
        if score <= EVENNESS or converged:
            break
        single = _with_ends(single, np.flatnonzero(chords.worst > UNEVEN * tolerance))
        piece_deviation = 0.5 * (chords.span + chords.worst)
        # The number of ideal chords that a piece is worth: a deviation grows with the square of the
        # length.
        cost = np.maximum(np.sqrt(piece_deviation / tolerance), chords.turns / most_turn)
        marks, costs = _cumulative_costs(
            places, np.maximum(cost, LEAST_COST), total, stretch.closed
        )
        # Through an inflection the deviation grows with the cube of the length.
        reaches = reaches / np.cbrt(np.roll(excess, 1) if stretch.closed else excess)
    assert best is not None
    return best


def _places(
    stretch: ChordStretch,
    bends: StretchBends,
    counts: IntArray,
    marks: FloatArray,
    costs: FloatArray,
) -> tuple[FloatArray, IntArray, BoolArray]:
    """Places (m,) of the vertices, the bend of each, and whether it is the last before an
    inflection; `costs` over the places `marks` define equal parts.
    """
    round_and_round = stretch.closed and not len(stretch.table.inflections)
    sizes = counts if round_and_round else counts + 1
    bend, number = grouped(sizes)
    low, high = monotone(marks, costs, bends.low), monotone(marks, costs, bends.high)
    part = number / np.maximum(counts, 1)[bend]
    places = monotone(costs, marks, low[bend] + (high - low)[bend] * part)
    places = np.where(number == 0, bends.low[bend], places)
    places = np.where((number == counts[bend]) & (number > 0), bends.high[bend], places)
    through = number == counts[bend]
    if not stretch.closed:
        through[-1] = False
    return places, bend, through


def _offsets(
    stretch: ChordStretch, bends: StretchBends, bend: IntArray, through: BoolArray, full: FloatArray
) -> tuple[BoolArray, FloatArray, BoolArray]:
    """The vertices that are held, their offsets [mm] from the curve, and those that are loose.

    The ends of a stretch lie on the curve, and the vertices next to them as far off as others, by
    the `full` (m,) of bends. So do the ends of a chord through an inflection of full length; those
    of a shorter one are loose.
    """
    sides = stretch.table.sides
    if stretch.closed and len(sides) > 1:
        sides = sides[1:]
    # Both ends of each chord through an inflection.
    ends = through | np.roll(through, 1)
    loose = ends & bends.narrow[bend]
    held = ends & ~loose
    if not stretch.closed:
        held[[1, -2]] = True
    offsets = np.where(held, full * sides[bend], 0.0)
    held &= offsets != 0.0
    if not stretch.closed:
        held[[0, -1]] = True
        offsets[[0, -1]] = 0.0
    return held, offsets, loose & ~held


def _with_ends(single: BoolArray, pieces: IntArray) -> BoolArray:
    """`single` (m,) with the vertices at both ends of `pieces`, if these are not too many."""
    more = single.copy()
    more[pieces] = True
    more[(pieces + 1) % len(single)] = True
    return more if np.count_nonzero(more) <= SINGLE else single


def _cumulative_costs(
    places: FloatArray, cost: FloatArray, total: float, closed: bool
) -> tuple[FloatArray, FloatArray]:
    """Places of the vertices and the sum of the costs up to each; of a closed stretch with one more
    chord at both ends, so that the table covers a whole turn.
    """
    if closed:
        places = np.concatenate((places[-1:] - total, places, places[:2] + total))
        cost = np.concatenate((cost[-1:], cost, cost[:1]))
    return places, np.concatenate(([0.0], np.cumsum(cost)))


# -- two sided ------------------------------------------------------------------------------------
# Straight pieces with the curve on both sides of them: vertices off the curve, for given angles.
#
# On a bend chord and curve lie within eps of each other if each vertex is eps off on the outer side
# and each chord as far on the inner. The offset of each vertex follows from least squares over the
# deviations at the vertices and inside the chords.
#
# Such a chord spans sqrt(16 eps/|kappa|). So the integral of sqrt(|kappa|/(16 eps)) ds counts the
# chords needed, and equal shares of it are chords of equal deviation; an inflection counts with the
# chord that runs through it.


CELLS = 512
"""Cells of the table in each smooth piece; they only place vertices, and the result is measured."""

NEAR = 64
"""Cells on each side of an inflection, over two of the others: the chord through it may be short,
and near it the density is a square root."""

STRAIGHT = 1e-9
"""Cells that turn by less than this fraction of the largest turn are straight: changes of their
sign are not inflections."""

FLOOR = 1e-3
"""Fraction of the chords that is spread evenly, so that straight stretches get some."""


@dataclass(frozen=True, slots=True, eq=False)
class StretchTable:
    """Bend, turn and length of a stretch, cell by cell over the cam angle.

    Attributes
    ----------
    grid : (n + 1,) cam angles [rad], ascending.
    bends : (n,) [sqrt(mm)] integral of sqrt(|kappa|) ds over each cell, kappa of the parallel.
    turns : (n,) [rad] angle by which the curve turns in each cell, positive.
    steps : (n,) [mm] length of each cell.
    inflections : (k,) indices of the points of `grid` where the curvature changes its sign.
    sides : (k + 1,) sign of the curvature before, between and after the inflections.
    """

    grid: FloatArray
    bends: FloatArray
    turns: FloatArray
    steps: FloatArray
    inflections: tuple[int, ...]
    sides: FloatArray

    def shares(self, tolerance: float, most_turn: float) -> FloatArray:
        """(n + 1,) chords needed up to each point of the grid, none turning by over `most_turn`."""
        cells = np.maximum(self.bends / (4.0 * np.sqrt(tolerance)), self.turns / most_turn)
        uniform = self.steps / np.sum(self.steps)
        cells += uniform * (FLOOR * np.sum(cells) + 1e-9)
        return np.concatenate(([0.0], np.cumsum(cells)))

    def sagittas(
        self, tolerance: float, most_turn: float, shares: FloatArray, places: FloatArray
    ) -> FloatArray:
        """Deviation [mm] of chords that are one share long, where `shares` reach `places` (m,).

        It is `tolerance` unless they are shorter so as not to turn by over `most_turn`.
        """
        cell = np.clip(np.searchsorted(shares, places) - 1, 0, len(self.bends) - 1)
        bend, turn = self.bends[cell], self.turns[cell]
        longest = most_turn * bend / np.where(turn > 0.0, 4.0 * np.sqrt(tolerance) * turn, 1.0)
        return tolerance * np.where(turn > 0.0, np.minimum(longest, 1.0), 1.0) ** 2

    def angles(self, shares: FloatArray, places: FloatArray) -> FloatArray:
        """Cam angles [rad] at which the `shares` reach the values `places`."""
        return monotone(shares, self.grid, places)


def stretch_table(curve: WorkingCurve, start: float, end: float) -> StretchTable:
    """The table of `curve` from cam angle `start` to `end` [rad]."""
    breaks = np.concatenate((curve.breaks - TURN, curve.breaks, curve.breaks + TURN))
    inner = breaks[(breaks > start) & (breaks < end)]
    cuts = ascending(np.concatenate(([start], inner, [end])))
    parts = np.arange(CELLS) / CELLS
    grid = (cuts[:-1, None] + np.diff(cuts)[:, None] * parts).ravel()
    grid = np.append(grid, end)
    # A chord through an inflection may be short, so that the table is finer there.
    crossings = _sign_changes(curve, grid)
    if len(crossings):
        width = 2.0 * (end - start) / len(grid)
        near = crossings[:, None] + width * np.linspace(-1.0, 1.0, 2 * NEAR + 1)
        near = near[(near > start) & (near < end)]
        grid = ascending(np.concatenate((grid, near, crossings)))
    kappa, bends, turns, steps = _cells(curve, grid)
    places = np.searchsorted(grid, crossings)
    edges = [0, *(int(place) for place in places), len(kappa)]
    sides = [float(np.sign(np.sum(turns[a:b] * np.sign(kappa[a:b])))) for a, b in pairwise(edges)]
    return StretchTable(grid, bends, turns, steps, tuple(edges[1:-1]), np.array(sides))


def _cells(
    curve: WorkingCurve, grid: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Curvature of the pitch curve in the middle of each cell, and the cell's bends, turns, steps.

    sqrt(|kappa_d|) ds = sqrt(|kappa| (1 + d kappa)) |Z'| dphi is finite at a cusp too.
    """
    middle, width = 0.5 * (grid[:-1] + grid[1:]), np.diff(grid)
    relative = curve.pitch.relative_jet(middle, order=2)
    speed = curve.pitch.speed(relative)
    kappa = bend_of_path(relative, speed, curve.pitch.rotation)
    regular = np.maximum(1.0 + curve.distance * kappa, 0.0)
    way = speed * width
    return kappa, way * np.sqrt(np.abs(kappa) * regular), way * np.abs(kappa), way * regular


def _sign_changes(curve: WorkingCurve, grid: FloatArray) -> FloatArray:
    """(k,) cam angles [rad] where the curvature changes its sign; straight parts have none."""
    kappa, _, turns, _ = _cells(curve, grid)
    bent = np.flatnonzero(turns > STRAIGHT * np.max(turns))
    if len(bent) < 2:
        return np.empty(0)
    change = np.flatnonzero(np.sign(kappa[bent[:-1]]) != np.sign(kappa[bent[1:]]))
    if not len(change):
        return np.empty(0)
    middle = 0.5 * (grid[:-1] + grid[1:])
    low, high = middle[bent[change]], middle[bent[change + 1]]
    sign = np.sign(kappa[bent[change]])
    # Bisection until the cam angle is exact to rounding.
    for _ in range(40):
        half = 0.5 * (low + high)
        same = np.sign(curve.pitch.curvature(half)) == sign
        low, high = np.where(same, half, low), np.where(same, high, half)
    return ascending(0.5 * (low + high))


COARSE, FINE, FINEST_SPLIT = 3, 7, 31
"""Points inside each chord at which the deviation is sampled: the more chords, the closer each is
to a parabola; a few long ones may have a sharp bend near an end. Odd, with one in the middle."""

MANY, POINTS = 1500, 2000
"""Number of chords from which `COARSE` suffices; below, about this many points in all."""

SWEEPS = 20
"""Sweeps of Jacobi's iteration for the offsets: each leaves a third of the error."""

MOST_CUTS = 40
"""Most steps in which the place of least deviation is bracketed: each drops one line."""

ROUNDING = 1e-12
"""Lines above others by less than this fraction count as equal."""

Place = Callable[[FloatArray], tuple[ComplexArray, ComplexArray]]
"""Points [mm] and unit tangents at ascending cam angles [rad] of one stretch."""


@dataclass(frozen=True, slots=True, eq=False)
class ChordStretch:
    """A stretch for straight pieces, from corner to corner or all round.

    Attributes
    ----------
    table : its bends, turns and lengths.
    place, points : points with tangents, and points alone, at ascending cam angles inside it.
    rotation : sigma; the outward normal is i sigma times the tangent.
    closed : whether it goes all round without a corner; else its ends are vertices.
    """

    table: StretchTable
    place: Place
    points: Callable[[FloatArray], ComplexArray]
    rotation: int
    closed: bool

    def angles(self, shares: FloatArray, places: FloatArray) -> FloatArray:
        """Cam angles [rad] at which the `shares` of the table reach `places` (m,), ascending.

        All round, places before the start and past the end are those of the neighbouring turns.
        """
        if not self.closed:
            return self.table.angles(shares, places)
        turns, rest = np.divmod(places, shares[-1])
        return self.table.angles(shares, rest) + TURN * turns


@dataclass(frozen=True, slots=True, eq=False)
class Chords:
    """Vertices of straight pieces along a stretch, and their deviations.

    Attributes
    ----------
    angles : (m,) cam angles [rad] of the vertices, ascending.
    vertices : (m,) complex [mm].
    worst : (c,) [mm] largest distance between each piece and the curve; c = m all round, else
        m - 1.
    span : (c,) [mm] half the range of the signed distance of each piece.
    turns : (c,) [rad] angle between the tangents at the ends of each piece.
    gap : [mm] largest distance of a vertex from its foot along its pieces.
    """

    angles: FloatArray
    vertices: ComplexArray
    worst: FloatArray
    span: FloatArray
    turns: FloatArray
    gap: float


def lay_chords(
    stretch: ChordStretch,
    angles: FloatArray,
    held: BoolArray,
    offsets: FloatArray,
    loose: BoolArray,
) -> Chords:
    """Straight pieces with vertices on the normals at `angles` (m,).

    Where `held` (m,), a vertex is off the curve by its `offsets` (m,) [mm], outward positive; least
    squares place the others, and `loose` (m,) ones are then moved to where the largest deviation of
    the vertex and its two pieces is least.
    """
    last = angles[0] + TURN if stretch.closed else angles[-1]
    count = len(angles) if stretch.closed else len(angles) - 1
    points, tangents = stretch.place(angles)
    normals = 1j * stretch.rotation * tangents
    ends = np.append(angles[1:], last)[:count]
    # The | 1 makes the number odd, so that one sample lies in the middle.
    samples = min(max(POINTS // count | 1, FINE), FINEST_SPLIT) if count < MANY else COARSE
    parts = (np.arange(samples) + 1.0) / (samples + 1.0)
    inner = angles[:count, None] + (ends - angles[:count])[:, None] * parts
    inner_points = stretch.points(inner.ravel()).reshape(inner.shape)

    height, share = _heights(points, inner_points, count, stretch.rotation)
    # Of each chord only the farthest sample enters the least squares.
    highest = np.argmax(np.abs(height), axis=1)[:, None]
    vertex_offsets = _least_squares(
        np.take_along_axis(height, highest, axis=1)[:, 0],
        np.take_along_axis(share, highest, axis=1)[:, 0],
        held,
        offsets,
    )
    for number in np.flatnonzero(loose):
        vertex_offsets[number] = _least_worst(int(number), vertex_offsets, height, share)
    vertices = points + vertex_offsets * normals
    height, _ = _heights(vertices, inner_points, count, stretch.rotation)
    # Seen from the chord, the curve at a vertex lies opposite to the vertex's offset.
    heights = np.column_stack(
        (-vertex_offsets[:count], height, -np.roll(vertex_offsets, -1)[:count])
    )
    top, bottom = np.max(heights, axis=1), np.min(heights, axis=1)
    peaks = _peaks(heights)
    top = np.maximum(top, np.max(peaks, axis=1))
    bottom = np.minimum(bottom, np.min(peaks, axis=1))

    chord = (np.roll(vertices, -1) - vertices)[:count]
    along = chord / np.abs(chord)
    next_tangents = np.roll(tangents, -1)[:count]
    gap = max(
        float(np.max(np.abs(vertex_offsets[:count] * (np.conj(tangents[:count]) * along).imag))),
        float(
            np.max(
                np.abs(np.roll(vertex_offsets, -1)[:count] * (np.conj(next_tangents) * along).imag)
            )
        ),
    )
    turns = np.abs(np.angle(next_tangents * np.conj(tangents[:count])))
    return Chords(angles, vertices, np.maximum(top, -bottom), 0.5 * (top - bottom), turns, gap)


def _heights(
    vertices: ComplexArray, points: ComplexArray, count: int, rotation: int
) -> tuple[FloatArray, FloatArray]:
    """Heights (c, p) of points outward of their chords, and fractions of the chords' lengths."""
    start = vertices[:count]
    chord = (np.roll(vertices, -1) - vertices)[:count]
    local = (points - start[:, None]) * np.conj(chord / np.abs(chord) ** 2)[:, None]
    return rotation * local.imag * np.abs(chord)[:, None], local.real


def _least_squares(
    height: FloatArray, share: FloatArray, held: BoolArray, offsets: FloatArray
) -> FloatArray:
    """Offsets (m,) that minimise the squares of themselves and of the remaining heights.

    `height`, `share` (c,): that of the highest point over each chord between points of the curve.
    For a parabola half the sagitta remains on each side.
    """
    size, count = len(held), len(height)
    weight = np.zeros(size)
    part, rise = np.zeros(size), np.zeros(size)
    weight[:count], part[:count], rise[:count] = 1.0, share, height
    rest = 1.0 - part
    # Normal equations; each vertex is coupled with its neighbours by their common chords.
    diagonal = 1.0 + weight * rest * rest + np.roll(weight * part * part, 1)
    coupling = weight * rest * part
    right = weight * rest * rise + np.roll(weight * part * rise, 1)
    vertex_offsets = np.where(held, offsets, right / diagonal)
    for _ in range(SWEEPS):
        around = coupling * np.roll(vertex_offsets, -1) + np.roll(coupling * vertex_offsets, 1)
        vertex_offsets = np.where(held, offsets, (right - around) / diagonal)
    return vertex_offsets


def _least_worst(
    number: int, vertex_offsets: FloatArray, height: FloatArray, share: FloatArray
) -> float:
    """Offset of one vertex that minimises the largest deviation there and of its pieces.

    The maximum of straight lines over the offset has one lowest point; cutting planes, one falling
    and one rising, find it.
    """
    count, following = len(height), (number + 1) % len(vertex_offsets)
    lines = [(0.0, 1.0)]
    if number < count:
        rest = height[number] - share[number] * vertex_offsets[following]
        lines += zip(rest, 1.0 - share[number], strict=True)
    previous = (number - 1) % len(vertex_offsets)
    if previous < count:
        rest = height[previous] - (1.0 - share[previous]) * vertex_offsets[previous]
        lines += zip(rest, share[previous], strict=True)
    base, slope = np.array(lines).T
    line_heights, line_rises = np.concatenate((base, -base)), np.concatenate((-slope, slope))
    falling, rising = int(np.argmin(line_rises)), int(np.argmax(line_rises))
    offset = 0.0
    for _ in range(MOST_CUTS):
        offset = (line_heights[falling] - line_heights[rising]) / (
            line_rises[rising] - line_rises[falling]
        )
        values = line_heights + line_rises * offset
        top = int(np.argmax(values))
        if values[top] <= values[falling] + ROUNDING * abs(values[falling]):
            break
        if line_rises[top] < 0.0:
            falling = top
        else:
            rising = top
    return float(offset)


def _peaks(heights: FloatArray) -> FloatArray:
    """Values at the vertices of parabolas through three neighbours each, where inside them."""
    previous, here, following = heights[:, :-2], heights[:, 1:-1], heights[:, 2:]
    slope, bend = 0.5 * (following - previous), previous - 2.0 * here + following
    inside = np.abs(slope) < np.abs(bend)
    return here - np.where(inside, 0.5 * slope * slope / np.where(inside, bend, 1.0), 0.0)


def monotone(x: FloatArray, y: FloatArray, places: FloatArray) -> FloatArray:
    """(m,) values at `places` (m,) of the table `y` (n,) over `x` (n,), both strictly ascending.

    Piecewise cubic, its slopes at the points the harmonic means of those on both sides (F. N.
    Fritsch, J. Butland, SIAM J. Sci. Stat. Comput. 5, 1984): it ascends as the table does. Beyond
    the ends the first and last cubic continue.
    """
    width = np.diff(x)
    slope = np.diff(y) / width
    slopes = np.empty(len(x))
    left_weight, right_weight = 2.0 * width[1:] + width[:-1], width[1:] + 2.0 * width[:-1]
    slopes[1:-1] = (left_weight + right_weight) / (
        left_weight / slope[:-1] + right_weight / slope[1:]
    )
    slopes[0], slopes[-1] = slope[0], slope[-1]
    # Beyond the ends the outermost cubics go on.
    k = np.clip(np.searchsorted(x, places, side="right") - 1, 0, len(width) - 1)
    s = (places - x[k]) / width[k]
    m0, m1, d = slopes[k], slopes[k + 1], slope[k]
    rise: FloatArray = s * (m0 + s * ((3.0 * d - 2.0 * m0 - m1) + s * (m0 + m1 - 2.0 * d)))
    return y[k] + width[k] * rise
