"""Fit by lines and G1 arcs with the fewest pieces, then the least deviation for their number."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from camgeo.errors import GeometryError, ToleranceError
from camgeo.geometry.contour.arcs import FLAT, fit_arcs, rest_arcs, turn_arc
from camgeo.geometry.contour.contour import Fit
from camgeo.geometry.contour.legs import APART, Bends, Chain, bends_of, clearly_less, in_steps
from camgeo.geometry.contour.proof import Group, fit_by_groups, proved_fit
from camgeo.geometry.outline.path import Path
from camgeo.geometry.pieces import Piece
from camgeo.geometry.pitch_curve import WorkingCurve
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, IntArray

ARC = math.sqrt(3.0) / 216.0
"""The best arcs leave the error ARC |dkappa/ds| h^3 on a span h: a C1 quadratic spline leaves
B_3(t)/6 of a cubic, and the largest value of Bernoulli's polynomial B_3 is sqrt(3)/36."""

AIM = 0.988
"""Fraction of the tolerance that the sampled deviation may reach: the proof adds 1 %, and samples
miss at most 0.15 %."""

TRIALS = 4
"""Numbers of arcs that are tried at once for a piece: usually one of them suffices."""

ATTEMPTS = 8
"""Most rounds of such trials; biarcs, with half as many arcs again, end the search."""

ALL_NUMBERS = 7
"""All numbers of arcs up to 2^7 are tried, even ones up to 2^8, and so on: one per cent of the arcs
is not worth endless trials."""

FINEST = 2.0**-52 * 2.0**10
"""Below this fraction of the distance from the cam axis rounding decides the deviations: there, no
number of arcs is better than another."""


def fewest_arcs(path: Path, tolerance: float) -> Fit:
    """The fewest lines and G1 arcs found within `tolerance` [mm] of `path`.

    Each smooth piece has the smallest number of arcs found to follow it, placed for equal
    deviations. The placing of a number of arcs does not depend on the tolerance, so a wider one
    never needs more. Dwells, turns and corners as in `fit_arcs`, whose fit is used if it has no
    more pieces.

    Raises
    ------
    UndercutError
        If the path is not regular.
    ToleranceError
        If the tolerance cannot be reached in double precision.
    GeometryError
        If the contour cannot be compared with the path.
    """
    groups: list[_Group] = []

    def group(curve: WorkingCurve, pieces: list[Piece]) -> Group:
        groups.append(_Group(curve, pieces))
        return groups[-1].fit

    try:
        fit = proved_fit(
            path, tolerance, AIM * tolerance, fit_by_groups(group, tolerance), turn_arc
        )
    except (ToleranceError, GeometryError, np.linalg.LinAlgError):
        return fit_arcs(path, tolerance)
    if not any(group.missed for group in groups):
        return fit
    fast = fit_arcs(path, tolerance)
    return fast if len(fast.contour) < len(fit.contour) else fit


LAID = 50_000
"""Arcs after which no more numbers of them are tried: the first or second attempt suffices."""


class _Group:
    """Smooth pieces of one curve, each number of arcs along them tried once.

    Attributes
    ----------
    missed : True once a number of arcs gave no result: there, another method may succeed.
    """

    def __init__(self, curve: WorkingCurve, pieces: list[Piece]) -> None:
        self.missed = False
        self._pieces, self._rests = pieces, rest_arcs(curve, pieces)
        bends = bends_of(curve, pieces)
        self._curved = [k for k, piece in enumerate(pieces) if not piece.is_arc]
        if self._curved:
            chosen = [pieces[k] for k in self._curved], [bends[k] for k in self._curved]
            self._strands = Strands.of(curve, *chosen)
        self._known: dict[tuple[int, int], ArcSpline] = {}

    def fit(self, aim: float, _tolerance: float) -> list[Chain]:
        """A chain for each of the pieces, the same ones at each call."""
        curved, rests = iter(self._least(aim) if self._curved else ()), iter(self._rests)
        return [next(rests) if piece.is_arc else next(curved).chain() for piece in self._pieces]

    def _least(self, aim: float) -> list[ArcSpline]:
        """For each curved piece the spline of the fewest arcs that deviate by at most `aim` [mm].

        ToleranceError if no number of arcs suffices for a piece.
        """
        if aim <= FINEST * float(np.max(np.abs(self._strands.points))):
            raise ToleranceError("arcs cannot be distinguished from the curve", aim, math.inf)
        limits = self._strands.difficulty.totals * (ARC / aim) ** (1.0 / 3.0)
        ladders = [_numbers(int(limit)) for limit in limits]
        found: dict[int, ArcSpline] = {}
        laid = 0
        for attempt in range(ATTEMPTS):
            if laid > LAID:
                break
            rungs = slice(attempt * TRIALS, (attempt + 1) * TRIALS)
            tries = [
                (piece, number)
                for piece, ladder in enumerate(ladders)
                if piece not in found
                for number in ladder[rungs]
            ]
            laid += sum(number for _, number in tries)
            self._lay([pair for pair in tries if pair not in self._known])
            for piece, number in tries:
                spline = self._known[piece, number]
                if piece not in found and spline.deviation <= aim:
                    found[piece] = spline
            if len(found) == len(ladders):
                return [found[piece] for piece in range(len(ladders))]
        raise ToleranceError("arcs cannot follow the curve", aim, math.inf)

    def _lay(self, tries: list[tuple[int, int]]) -> None:
        if not tries:
            return
        pieces, counts = np.array(tries).T
        for pair, spline in zip(tries, arc_splines(self._strands, pieces, counts), strict=True):
            self._known[pair] = spline
            # One arc is G1 at both ends only by chance.
            self.missed = self.missed or (pair[1] > 1 and spline.deviation == math.inf)


def _numbers(limit: int) -> list[int]:
    """Numbers of arcs to be tried in turn where `limit` is a lower bound, see `ALL_NUMBERS`."""
    found: list[int] = []
    number = max(1, limit)
    while len(found) < ATTEMPTS * TRIALS:
        step = 1 << max(0, (number - 1).bit_length() - ALL_NUMBERS)
        number = step * math.ceil(number / step)
        found.append(number)
        number += 1
    return found


# -- arc splines ----------------------------------------------------------------------------------
# G1 arc splines along smooth pieces of a curve: the least deviation for a number of arcs.
#
# A joint lies a little off the curve, on the normal of its cam angle, and its tangent is rotated
# slightly from the curve's. Along the curve the deviation of such arcs is that of a C1 quadratic
# spline from a function with the third derivative dkappa/ds. For given joints least squares find
# it, under the condition of each arc that its chord bisects the angle of its tangents; for joints
# with equal deviations of all arcs, least squares are also the best fit except for the first arcs
# at the ends. Biarcs, which have the curve's points and tangents at every other joint, need 1.45
# times as many.


@dataclass(frozen=True, slots=True, eq=False)
class Strands:
    """Smooth pieces of one parallel, none a dwell, ready for arcs.

    Attributes
    ----------
    curve : the parallel.
    difficulty : of its pieces, p.
    points, tangents : (2, p) complex [mm], unit; one-sided, at starts and ends.
    """

    curve: WorkingCurve
    difficulty: Difficulty
    points: ComplexArray
    tangents: ComplexArray

    @classmethod
    def of(cls, curve: WorkingCurve, pieces: Sequence[Piece], bends: Sequence[Bends]) -> Strands:
        """The `pieces` of `curve`, whose bends along them are `bends`."""
        first = curve.traced(np.array([piece.start for piece in pieces]))
        last = curve.traced(np.array([piece.end for piece in pieces]), "left")
        points, tangents = np.stack((first[0], last[0])), np.stack((first[1], last[1]))
        return cls(curve, Difficulty.of(pieces, bends), points, tangents)


@dataclass(frozen=True, slots=True, eq=False)
class JointedCurve:
    """The curve sampled at the joints of a batch and between them.

    Attributes
    ----------
    angles, points, tangents : (j,) cam angle [rad], point [mm] and unit tangent of the joints.
    samples : (n, m) complex [mm] points of the curve along each arc.
    scale : (j,) [mm] length of the chords about each joint, which makes its turn a length.
    valid : (k,) False for splines that have joints too close to each other.
    """

    layout: Layout
    angles: FloatArray
    points: ComplexArray
    tangents: ComplexArray
    samples: ComplexArray
    scale: FloatArray
    valid: BoolArray

    @classmethod
    def of(
        cls, strands: Strands, layout: Layout, pieces: IntArray, places: FloatArray, probes: int
    ) -> JointedCurve:
        """The curve at the `places` (j,) of joints along `pieces` (k,), and at `probes` per arc."""
        angles = strands.difficulty.angles(layout, pieces, places)
        left, right = layout.left, layout.left + 1
        parts = (np.arange(probes) + 0.5) / probes
        between = angles[left, None] + (angles[right] - angles[left])[:, None] * parts
        points, tangents, _ = strands.curve.traced(np.concatenate((angles, between.ravel())))
        samples = points[len(angles) :].reshape(between.shape)
        points, tangents = points[: len(angles)], tangents[: len(angles)]
        points[layout.first], points[layout.last] = strands.points[:, pieces]
        tangents[layout.first], tangents[layout.last] = strands.tangents[:, pieces]
        chords = np.abs(points[right] - points[left])
        apart = (chords > APART * np.max(np.abs(points))) & (angles[right] > angles[left])
        valid = np.logical_and.reduceat(apart, layout.first_arcs)
        scale = np.zeros(len(angles))
        scale[left] += chords
        scale[right] += chords
        return cls(layout, angles, points, tangents, samples, scale, valid)

    def step(self, system: ArcSystem, off: FloatArray) -> FloatArray:
        """Gauss-Newton step (j, 2) from `off` (j, 2), offsets [mm] and turns [rad] of joints."""
        arcs = Arcs.of(self, off)
        errors, t = arcs.errors(self.samples)
        left, right = self.layout.left, self.layout.left + 1
        # To first order arcs move by the Hermite cubic of the motion of their ends, a quadratic as
        # far as the condition holds. The present residual of the condition is a cubic part of the
        # error.
        rest = 1.0 - t
        errors += (0.5 * arcs.length * arcs.miss)[:, None] * t * rest * (rest - t)
        before, after = arcs.length / self.scale[left], arcs.length / self.scale[right]
        basis = np.stack(
            (
                rest * rest * (1.0 + 2.0 * t),
                rest * rest * t * before[:, None],
                t * t * (1.0 + 2.0 * rest),
                -t * t * rest * after[:, None],
            ),
            axis=1,
        )
        cosine = (np.conj(arcs.along) * self.tangents[left]).real
        end_cosine = (np.conj(arcs.along) * self.tangents[right]).real
        valid = self.valid & np.isfinite(self.layout.largest(np.max(np.abs(errors), axis=1)))
        free = self.layout.of_joints(valid)
        free[self.layout.first] = free[self.layout.last] = False
        found = system.solved(
            basis @ basis.transpose(0, 2, 1),
            (basis @ errors[:, :, None])[:, :, 0],
            np.stack((-2.0 * cosine, -before, 2.0 * end_cosine, -after), axis=1),
            -arcs.length * arcs.miss,
            free,
        )
        # Joints between chords of no length are not free, and do not turn.
        scale = np.where(self.scale > 0.0, self.scale, 1.0)
        return np.asarray(found / np.stack((np.ones(len(found)), scale), axis=1))

    def deviations(self, off: FloatArray) -> FloatArray:
        """(n,) [mm] largest distance of the curve from each arc, from samples."""
        errors = np.abs(Arcs.of(self, off).errors(self.samples)[0])
        joints = np.abs(off[:, 0])
        found = np.maximum(joints[self.layout.left], joints[self.layout.left + 1])
        inside, before, after = errors[:, 1:-1], errors[:, :-2], errors[:, 2:]
        bend = 2.0 * inside - before - after
        top = (inside >= before) & (inside >= after) & (bend > 0.0)
        rise = np.where(top, (after - before) ** 2, 0.0) / np.where(top, 8.0 * bend, 1.0)
        peaks: FloatArray = np.maximum(np.max(errors, axis=1), np.max(inside + rise, axis=1))
        return np.maximum(found, peaks)


@dataclass(frozen=True, slots=True, eq=False)
class Arcs:
    """The arcs of a batch between joints off the curve.

    Attributes
    ----------
    vertices : (j,) complex [mm].
    middle, along, length : (n,) of the chords: middle [mm], unit vector, length [mm].
    halves : (n,) [rad] half the sweeps.
    miss : (n,) [rad] by which the angle from the first tangent to the chord exceeds that from the
        chord to the last tangent; both are half the sweep if the arcs are G1.
    """

    vertices: ComplexArray
    middle: ComplexArray
    along: ComplexArray
    length: FloatArray
    halves: FloatArray
    miss: FloatArray

    @classmethod
    def of(cls, jointed: JointedCurve, off: FloatArray) -> Arcs:
        """The arcs along `jointed` with offsets and turns `off` (j, 2) of the joints."""
        left, right = jointed.layout.left, jointed.layout.left + 1
        vertices = jointed.points + 1j * jointed.tangents * off[:, 0]
        tangents = jointed.tangents * np.exp(1j * off[:, 1])
        chords = vertices[right] - vertices[left]
        length = np.abs(chords)
        none = length == 0.0
        along = chords / np.where(none, 1.0, length)
        length[none] = np.nan
        before = np.angle(along * np.conj(tangents[left]))
        after = np.angle(tangents[right] * np.conj(along))
        middle = 0.5 * (vertices[left] + vertices[right])
        return cls(vertices, middle, along, length, 0.5 * (before + after), before - after)

    def errors(self, points: ComplexArray) -> tuple[FloatArray, FloatArray]:
        """Signed distances (n, m) [mm] of `points` (n, m) from the arcs, positive on their left,
        and the places (n, m) of their feet on the chords, 0 to 1 between the ends.
        """
        local = (points - self.middle[:, None]) * np.conj(self.along)[:, None]
        x = local.real
        y = local.imag + (0.5 * self.length * np.tan(0.5 * self.halves))[:, None]
        # From a circle through the origin along x, without using its centre, which may be far
        # away.
        bend = (2.0 * np.sin(self.halves) / self.length)[:, None]
        root = np.sqrt((bend * x) ** 2 + (1.0 - bend * y) ** 2)
        return (2.0 * y - bend * (x * x + y * y)) / (1.0 + root), x / self.length[:, None] + 0.5


ROUNDS = 14
"""Rounds of evening out the arcs' deviations."""

FIRST_POWER, MOST_POWER, CALMER, BOLDER = 1.0 / 6.0, 0.25, 0.7, 1.2
"""Power of its deviation by which an arc is shortened in a round. Where arcs change alternately,
each at its neighbours' cost, deviations grow with about the sixth power of lengths: any power near
one third would oscillate. An arc that oscillates nevertheless is damped."""

EVEN, REPEATS = 0.15, 3
"""Where an arc still deviates by this much (a logarithm) more than the mean, as where dkappa/ds has
a zero every other arc, the rounds are repeated."""

STEPS = 5
"""Final Gauss-Newton steps. Their conditions have exact derivatives and hold to rounding after
three, or after five if arcs turn by a radian."""

PROBES, CLOSE_PROBES = 12, 16
"""Points per arc at which its deviation is sampled: for least squares, and at the end."""

TANGENT = 2.0**-52 * 8.0
"""Largest angle between neighbouring arcs that is rounding: times the chord, as a fraction of the
distance from the cam axis."""

WIDEST = 1.5
"""Largest half sweep of an arc [rad]: chords do not determine arcs of half a turn."""


@dataclass(frozen=True, slots=True, eq=False)
class ArcSpline:
    """Arcs along one smooth piece.

    Attributes
    ----------
    angles : (n + 1,) [rad] cam angles of the vertices' feet, ascending.
    vertices : (n + 1,) complex [mm].
    halves : (n,) [rad] half the sweep of each arc.
    deviation : sampled distance of curve and arcs [mm]; infinite if the arcs are invalid.
    """

    angles: FloatArray
    vertices: ComplexArray
    halves: FloatArray
    deviation: float

    def chain(self) -> Chain:
        """The arcs as a chain, very flat ones as lines, see `FLAT`."""
        chords = np.diff(self.vertices)
        sagittas = np.abs(chords) * np.abs(self.halves) / 4.0
        flat = sagittas <= FLAT * np.max(np.abs(self.vertices))
        middle = 0.5 * (self.vertices[1:] + self.vertices[:-1])
        centres = middle + 0.5j * chords / np.tan(np.where(flat, 1.0, self.halves))
        return Chain(
            self.angles[:-1],
            self.vertices[:-1],
            np.where(flat, 0.0, 2.0 * self.halves),
            np.where(flat, 0.0, centres),
        )


def arc_splines(strands: Strands, pieces: IntArray, counts: IntArray) -> list[ArcSpline]:
    """Arc splines of `counts` (k,) arcs along `pieces` (k,), G1 and exact in point and tangent
    at both ends.

    Their deviation is nearly the least possible. Each depends only on its piece and number of arcs.
    """
    layout = Layout.of(counts)
    best, excess = _settled(strands, layout, pieces, strands.difficulty.joints(layout, pieces))
    uneven = np.flatnonzero(excess > EVEN)
    if len(uneven):
        part = Layout.of(counts[uneven])
        chosen = layout.of_joints(excess > EVEN)
        for _ in range(REPEATS):
            best[chosen] = _settled(strands, part, pieces[uneven], best[chosen])[0]
    jointed = JointedCurve.of(strands, layout, pieces, best, PROBES)
    system = ArcSystem.of(layout)
    off = np.zeros((len(best), 2))
    for _ in range(STEPS):
        off = off + jointed.step(system, off)
    return _splines(
        strands.curve, JointedCurve.of(strands, layout, pieces, best, CLOSE_PROBES), off
    )


def _settled(
    strands: Strands, layout: Layout, pieces: IntArray, places: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Places (j,) of joints with the smallest deviation found from `places` (j,) on, and the excess
    (k,) of the largest one of each spline, see `Layout.excess`.
    """
    system = ArcSystem.of(layout)
    count = len(layout.first)
    best, least, uneven = places, np.full(count, np.inf), np.full(count, np.inf)
    power, last = np.full(len(layout.left), FIRST_POWER), np.zeros(len(layout.left))
    for _ in range(ROUNDS):
        jointed = JointedCurve.of(strands, layout, pieces, places, PROBES)
        deviations = jointed.deviations(jointed.step(system, np.zeros((len(places), 2))))
        worst, excess = layout.largest(deviations), layout.excess(deviations)
        better = clearly_less(worst, least)
        best = np.where(layout.of_joints(better), places, best)
        uneven = np.where(better, layout.largest(excess), uneven)
        least = np.where(better, worst, least)
        swings = excess * last < 0.0
        power = np.where(swings, CALMER * power, np.minimum(BOLDER * power, MOST_POWER))
        places, last = evened(layout, places, power * excess), excess
    return best, uneven


def _splines(curve: WorkingCurve, jointed: JointedCurve, off: FloatArray) -> list[ArcSpline]:
    """The splines of a batch, for the final offsets and turns `off` (j, 2) of its joints."""
    arcs, layout = Arcs.of(jointed, off), jointed.layout
    # A proof adds the distance of joints from their feet along the arcs.
    gaps = np.abs(off[:, 0] * np.sin(off[:, 1]))
    total = jointed.deviations(off) + np.maximum(gaps[layout.left], gaps[layout.left + 1])
    # Each arc has a parallel on the pitch curve.
    side = -curve.pitch.rotation * np.sign(arcs.halves) * curve.distance
    good = (arcs.length > 2.0 * np.abs(np.sin(arcs.halves)) * side) & np.isfinite(total)
    good &= np.abs(arcs.length * arcs.miss) <= TANGENT * np.max(np.abs(jointed.points))
    good &= np.abs(arcs.halves) <= WIDEST
    valid = jointed.valid & np.logical_and.reduceat(good, layout.first_arcs)
    deviations = np.where(valid, layout.largest(total), np.inf)
    found = []
    for k, (first, last) in enumerate(zip(layout.first, layout.last, strict=True)):
        joints, own = slice(first, last + 1), slice(first - k, last - k)
        angles, vertices = jointed.angles[joints], arcs.vertices[joints]
        found.append(ArcSpline(angles, vertices, arcs.halves[own], float(deviations[k])))
    return found


# -- joints ---------------------------------------------------------------------------------------
# The joints of arc splines, placed for equal deviations of all arcs; and their least squares.
#
# Splines come in batches, one after the other in the same arrays: they are short, and the overhead
# of calls exceeds the arithmetic.


Scalar = TypeVar("Scalar", bound=np.generic)

EQUALISING_ROUNDS = 10
"""Rounds of equalising the deviations predicted by the tables; they need no evaluation of the
curve."""

END = 0.325
"""Fraction of an arc by which the first and the last one are shorter than the others if the
difficulty is uniform, because point and tangent are given there: found with dkappa/ds constant, 3
to 20 arcs."""

ALONE = 1.0 / 3.0
"""Power of its deviation by which an arc is shortened: its deviation grows with the third power of
its length if the others keep theirs, as the tables assume."""

LEAST = 1e-3
"""Smallest deviation of an arc that counts, as a fraction of the largest of its spline."""


@dataclass(frozen=True, slots=True, eq=False)
class Layout:
    """Places of the joints and arcs of k splines in the arrays of a batch.

    Attributes
    ----------
    first, last : (k,) first and last joint of each spline.
    left : (n,) joint at which each arc begins; it ends at the next.
    spline : (n,) spline of each arc.
    """

    first: IntArray
    last: IntArray
    left: IntArray
    spline: IntArray

    @classmethod
    def of(cls, counts: IntArray) -> Layout:
        """Splines of `counts` (k,) arcs each."""
        last = np.cumsum(counts + 1) - 1
        left = np.delete(np.arange(last[-1] + 1), last)
        return cls(last - counts, last, left, np.repeat(np.arange(len(counts)), counts))

    @property
    def counts(self) -> IntArray:
        """(k,) arcs of each spline."""
        return self.last - self.first

    @property
    def first_arcs(self) -> IntArray:
        """(k,) first arc of each spline."""
        return self.first - np.arange(len(self.first))

    def of_joints(self, values: NDArray[Scalar]) -> NDArray[Scalar]:
        """(j,) for each joint the value (k,) of its spline."""
        return np.repeat(values, self.counts + 1)

    def largest(self, values: FloatArray) -> FloatArray:
        """(k,) for each spline the largest value (n,) of its arcs."""
        return np.asarray(np.maximum.reduceat(values, self.first_arcs))

    def excess(self, deviations: FloatArray) -> FloatArray:
        """(n,) logarithms of the arcs' `deviations` (n,) over their geometric mean in a spline,
        in steps; 0 where a spline has no deviation at all, or not a number.
        """
        worst = self.largest(deviations)[self.spline]
        usable = np.isfinite(worst) & (worst > 0.0)
        found: FloatArray = np.log(np.where(usable, np.maximum(deviations, LEAST * worst), 1.0))
        mean: FloatArray = np.bincount(self.spline, weights=found) / self.counts
        return in_steps(found - mean[self.spline])


@dataclass(frozen=True, slots=True, eq=False)
class Difficulty:
    """The difficulty of following smooth pieces by arcs, tabulated along each of them.

    The third root of |dkappa/ds|, over the length, is the density of arcs. It is the same for all
    parallels, also where one has a cusp, so the tables are of the pitch curve. The place of a cam
    angle is 2 p at the start of piece p and 2 p + 1 at its end, and even between.

    Attributes
    ----------
    starts, spans : (p,) [rad] of the pieces.
    totals : (p,) [mm^(1/3)] integral of the density along each piece.
    places : (m,) ascending, of the tables.
    shares : (m,) 2 p and the share of the density before each place.
    turns, lengths : (m,) integrals of |dkappa| [1/mm] and of ds [mm] before each place.
    """

    starts: FloatArray
    spans: FloatArray
    totals: FloatArray
    places: FloatArray
    shares: FloatArray
    turns: FloatArray
    lengths: FloatArray

    @classmethod
    def of(cls, pieces: Sequence[Piece], bends: Sequence[Bends]) -> Difficulty:
        """Tables of `pieces`, none a rest, from how the curve bends along each."""
        starts = np.array([piece.start for piece in pieces])
        spans = np.array([piece.end - piece.start for piece in pieces])
        speed = np.stack([bend.speed for bend in bends])
        slope = np.abs(np.stack([bend.slope for bend in bends]))
        cells = speed.shape[1]

        def integral(values: FloatArray) -> FloatArray:
            parts = values * (spans / cells)[:, None]
            return np.cumsum(np.pad(parts, ((0, 0), (1, 0))), axis=1)

        grid = np.linspace(0.0, 1.0, cells + 1)
        density = integral(np.cbrt(slope * speed * speed))
        totals = density[:, -1].copy()
        density[totals == 0.0] = grid  # a straight line has no difficulty anywhere
        base = 2.0 * np.arange(len(pieces))[:, None]
        return cls(
            starts,
            spans,
            totals,
            (base + grid).ravel(),
            (base + density / density[:, -1:]).ravel(),
            integral(slope).ravel(),
            integral(speed).ravel(),
        )

    def joints(self, layout: Layout, pieces: IntArray) -> FloatArray:
        """(j,) places of joints with equal deviations of the arcs according to the tables.

        Spline i of `layout` lies along piece `pieces[i]`.
        """
        counts = layout.of_joints(layout.counts)
        index = np.arange(len(counts)) - layout.of_joints(layout.first)
        share = np.clip((index - END) / (counts - 2.0 * END), 0.0, 1.0)
        places: FloatArray = np.interp(
            2.0 * layout.of_joints(pieces) + share, self.shares, self.places
        )
        places[layout.first], places[layout.last] = 2.0 * pieces, 2.0 * pieces + 1.0
        stress = np.ones(len(layout.left))
        stress[layout.first_arcs] = (1.0 - END) ** -3.0
        stress[layout.first_arcs + layout.counts - 1] = (1.0 - END) ** -3.0
        left, right = layout.left, layout.left + 1
        for _ in range(EQUALISING_ROUNDS):
            # An arc of length h deviates by a constant times h^2 and the integral of |dkappa|.
            turns = np.interp(places, self.places, self.turns)
            lengths = np.interp(places, self.places, self.lengths)
            deviations = (turns[right] - turns[left]) * (lengths[right] - lengths[left]) ** 2
            places = evened(layout, places, ALONE * layout.excess(stress * deviations))
        return places

    def angles(self, layout: Layout, pieces: IntArray, places: FloatArray) -> FloatArray:
        """(j,) cam angles [rad] of `places` (j,), see `joints`."""
        part = places - 2.0 * layout.of_joints(pieces)
        starts, spans = layout.of_joints(self.starts[pieces]), layout.of_joints(self.spans[pieces])
        return np.asarray(starts + spans * part)


def evened(layout: Layout, places: FloatArray, shrink: FloatArray) -> FloatArray:
    """Places (j,) of joints, moved from `places` so that each arc's share of its spline shrinks by
    the factor exp(shrink), shrink (n,), as against the others.
    """
    share = np.exp(shrink)
    share *= (layout.counts / np.bincount(layout.spline, weights=share))[layout.spline]
    # The shares of a spline add up to its arcs, so joint i of the batch belongs at i.
    before = np.zeros(len(places))
    before[layout.left + 1] = share
    before = np.cumsum(before) + layout.of_joints(np.arange(len(layout.first)))
    found = np.interp(np.arange(len(places), dtype=np.float64), before, places)
    found[layout.first], found[layout.last] = places[layout.first], places[layout.last]
    return found


BAND = 4
"""Distance of the farthest two unknowns that meet in an equation."""


@dataclass(frozen=True, slots=True, eq=False)
class ArcSystem:
    """The equations of a batch of splines.

    Joint j has the unknowns 3 j and 3 j + 1; 3 j + 2 is Lagrange's multiplier of the arc that
    begins there.

    Attributes
    ----------
    layout : of the batch.
    cells : places of all coefficients in the banded matrix, row by row.
    """

    layout: Layout
    cells: IntArray

    @classmethod
    def of(cls, layout: Layout) -> ArcSystem:
        """The form of the equations; numbers come with `solved`."""
        size = 3 * (int(layout.last[-1]) + 1)
        own = 3 * layout.left[:, None] + np.array([0, 1, 3, 4])
        bond = np.broadcast_to(3 * layout.left[:, None] + 2, own.shape)
        blocks = (len(own), 4, 4)
        rows = np.broadcast_to(own[:, :, None], blocks)
        columns = np.broadcast_to(own[:, None, :], blocks)
        diagonal = np.arange(size)

        def cell(row: IntArray, column: IntArray) -> IntArray:
            return ((BAND + row - column) * size + column).ravel()

        cells = (cell(rows, columns), cell(own, bond), cell(bond, own), cell(diagonal, diagonal))
        return cls(layout, np.concatenate(cells))

    def solved(
        self,
        square: FloatArray,
        pull: FloatArray,
        bond: FloatArray,
        gap: FloatArray,
        free: BoolArray,
    ) -> FloatArray:
        """Unknowns (j, 2) x that make the sum over the arcs of x' A x / 2 - b' x stationary, with
        c' x = d for each arc; x are the four unknowns of an arc's two joints.

        Parameters
        ----------
        square, pull, bond, gap : (n, 4, 4) A, (n, 4) b, (n, 4) c and (n,) d of each arc.
        free : (j,) False for joints whose unknowns are zero.
        """
        from scipy.linalg import solve_banded  # only for making files

        left, right = self.layout.left, self.layout.left + 1
        mask = np.stack((free[left], free[left], free[right], free[right]), axis=1)
        square = np.where(mask[:, :, None] & mask[:, None, :], square, 0.0)
        pull, bond = np.where(mask, pull, 0.0), np.where(mask, bond, 0.0)
        held = np.ones((len(free), 3))
        held[:, 0] = held[:, 1] = ~free
        bound = free[left] | free[right]
        held[left, 2] = ~bound
        values = (square.ravel(), bond.ravel(), bond.ravel(), held.ravel())
        matrix = np.bincount(
            self.cells, weights=np.concatenate(values), minlength=(2 * BAND + 1) * held.size
        )
        sides = np.zeros_like(held)
        sides[left, :2] += pull[:, :2]
        sides[right, :2] += pull[:, 2:]
        sides[left, 2] = np.where(bound, gap, 0.0)
        unknowns = solve_banded(
            (BAND, BAND),
            matrix.reshape(2 * BAND + 1, held.size),
            sides.ravel(),
            overwrite_ab=True,
            overwrite_b=True,
            check_finite=False,
        )
        return np.asarray(unknowns.reshape(-1, 3)[:, :2])
