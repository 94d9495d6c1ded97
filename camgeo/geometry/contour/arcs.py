"""Fit by lines and G1 arcs: biarcs between points of the curve.

Their joints are placed by the law of their distance from it, corrected once by the distances found.
A biarc with turned tangents, see `camgeo.geometry.contour.arcs`, over a span h of arc length is off
the curve by

    C h^3 (|kappa'| + c |kappa''| h),   C = 0.1001^3,

primes for d/ds: the first term is that of the best arcs. A fit based only on the first term
deviates too much wherever the slope of curvature changes its sign.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from camgeo.geometry.contour.contour import Fit
from camgeo.geometry.contour.legs import (
    CROWDED,
    Bends,
    Chain,
    TurnLeg,
    bends_of,
    in_steps,
    joints_apart,
    least_counts,
)
from camgeo.geometry.contour.proof import AIM, Group, fit_by_groups, proved_fit
from camgeo.geometry.contour.spline import at, highest
from camgeo.geometry.outline.path import Path
from camgeo.geometry.pieces import Piece
from camgeo.geometry.pitch_curve import WorkingCurve
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, IntArray, taken

ARC_CONSTANT = 0.2002
"""Arcs needed, asymptotically: 0.2002 eps^(-1/3) times the integral of |dkappa/ds|^(1/3) ds."""

QUARTIC = 0.6
"""c: a single span about a zero of kappa' with free tangents leaves (sqrt(2) - 1)^2 / 384 of
kappa'' h^4, c = 0.45; its neighbours, which need other tangents, make it slightly more."""

OUTER = (0.515, 0.891, 0.927)
"""Lengths of the outermost spans of a piece with which they deviate as the others do, if all others
are 1 and kappa' is constant. The fourth deviates 1.24 times as much."""

ENDS = 0.6
"""Least number of spans that the ends of a piece add; by the lengths above it is 1.3."""

FLOOR = 0.005
"""Smallest density of spans, as a fraction of the piece's mean: every stretch gets spans."""

STEPS = 3
"""Steps of the fixed-point iteration for the density; each divides the error by four or more."""

LEAST_REGULARITY = 1e-3
"""Least 1 + d kappa used, near a cusp: the density there is integrable, but not by samples."""

POWER = 0.25
"""Power of the deviation found of a span that corrects the density there: less than a third,
because part of it comes from the tangents of its neighbours."""

LEAST_FOUND = 0.01
"""Least distance that counts, as a fraction of the largest."""

WIDEST = 2.0
"""Cam angle [rad] of the widest span: a whole turn without a break and with a tiny stroke has no
chord from its start to its end."""


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """The deviations found of spans between given joints.

    Attributes
    ----------
    places : (m,) [rad] middles of the spans.
    needs : (m,) factor by which the density there is too small, up to a common factor.
    """

    places: FloatArray
    needs: FloatArray

    @classmethod
    def of(cls, joints: FloatArray, distances: FloatArray) -> Self:
        """From the `distances` (m,) [mm] of the spans between `joints` (m + 1,)."""
        largest = float(np.max(distances))
        shares = distances / largest if largest > 0.0 else np.ones(len(distances))
        excess = in_steps(np.log(np.maximum(shares, LEAST_FOUND)))
        return cls(0.5 * (joints[:-1] + joints[1:]), np.exp(POWER * excess))


class ArcDensity:
    """Spans of biarcs along one smooth piece.

    Over the cam angle the density of spans delta obeys delta^4 = (a^3 delta + b) C / error, where
    a^3 = |kappa'| pace^3, the same for all parallels, and b = c |kappa''| pace^4.
    """

    def __init__(self, piece: Piece, bends: Bends) -> None:
        self._piece, self._bends = piece, bends
        self._finer: ArcDensity | None = None
        self._borders = np.linspace(piece.start, piece.end, len(bends.speed) + 1)
        self._width = (piece.end - piece.start) / len(bends.speed)
        regular = np.maximum(bends.regularity, LEAST_REGULARITY)
        slope = bends.slope / (bends.speed * regular**3)
        change = np.abs(np.gradient(slope, self._width))
        self._cubic = np.abs(bends.slope) * bends.speed * bends.speed
        self._quartic = QUARTIC * change * (bends.speed * regular) ** 3
        self._total = self._width * float(np.sum(np.cbrt(self._cubic)))

    def count(self, aim: float) -> float:
        """About the least number of spans within `aim` [mm], a real number."""
        inner = self._width * float(np.sum(self._density(aim / (0.5 * ARC_CONSTANT) ** 3)))
        known = inner * 1.03 + min(max(0.25 * (inner - 1.0), 0.0), ENDS)
        return max(known, (self._piece.end - self._piece.start) / WIDEST)

    def joints(self, count: int, found: Found | None = None) -> FloatArray:
        """(count + 1,) cam angles [rad] of the ends of `count` parts, both outer ones included.

        `found`: the deviations of about as many spans.
        """
        if count > len(self._bends.speed) // 2:
            if self._finer is None:
                self._finer = ArcDensity(self._piece, self._bends.refined())
            return self._finer.joints(count, found)
        error = (self._total / count) ** 3
        density = self._density(error)
        # These are too many spans: find the error that gives about the requested number.
        error *= (self._width * float(np.sum(density)) / count) ** 3
        density = self._density(error)
        if found is not None:
            middles = self._borders[:-1] + 0.5 * self._width
            density *= np.interp(middles, found.places, found.needs)
        density += FLOOR * float(np.mean(density))
        if not density[0] > 0.0:  # a straight line has no difficulty anywhere
            density = np.ones(len(density))
        reached = np.concatenate(([0.0], np.cumsum(density)))
        joints: FloatArray = np.interp(_parts(count) * reached[-1], reached, self._borders)
        joints[0], joints[-1] = self._piece.start, self._piece.end
        return joints

    def _density(self, error: float) -> FloatArray:
        if error <= 0.0:
            return np.cbrt(self._cubic)
        cubic, quartic = self._cubic / error, self._quartic / error
        density: FloatArray = np.maximum(np.cbrt(cubic), np.sqrt(np.sqrt(quartic)))
        for _ in range(STEPS):
            density = np.sqrt(np.sqrt(cubic * density + quartic))
        return density


def _parts(count: int) -> FloatArray:
    """(count + 1,) from 0 to 1, the outermost parts shorter."""
    sizes = np.ones(count)
    for number, size in enumerate(OUTER[: (count + 1) // 2]):
        sizes[[number, -1 - number]] = size
    reached = np.concatenate(([0.0], np.cumsum(sizes)))
    return np.asarray(reached / reached[-1])


ORDER = 3.0
"""Power of the number of arcs with which the distance decreases."""

TOGETHER = 16
"""Spans that are tried at once for one piece: for more, a second call costs no more."""

HALVINGS = 8
"""Rounds of halving at most."""

MANY = 16
"""Spans to be halved again, above which they must have become fewer."""

MAX_ARCS = 200_000
"""Most arcs of a smooth piece; a tolerance that needs more is beyond double precision."""


def fit_arcs(path: Path, tolerance: float) -> Fit:
    """Biarcs within `tolerance` [mm] of `path`, counter-clockwise.

    Breaks are joints of the contour, each dwell is one arc about the cam axis, of any sweep, and
    each arc of the path is one arc. Corners are where the path has them and nowhere else.

    Raises
    ------
    UndercutError
        If the path is not regular.
    ToleranceError
        If the tolerance cannot be reached in double precision.
    GeometryError
        If the contour cannot be compared with the path.
    """
    fit_pieces = fit_by_groups(_group, tolerance)
    return proved_fit(path, tolerance, AIM * tolerance, fit_pieces, turn_arc)


def turn_arc(leg: TurnLeg, _aim: float) -> Chain:
    """The one arc that a turn is."""
    return Chain.arc(0.0, leg.first, leg.sweep, leg.centre)


@dataclass(frozen=True, slots=True, eq=False)
class _Group:
    """Smooth pieces of one curve, which share its evaluations.

    Attributes
    ----------
    curve, pieces : these.
    densities, ends : of the pieces that are not rests.
    rests : of the others.
    """

    curve: WorkingCurve
    pieces: tuple[Piece, ...]
    densities: tuple[ArcDensity, ...]
    ends: Ends
    rests: tuple[Chain, ...]

    def fit(self, aim: float, tolerance: float) -> list[Chain]:
        """A chain for each of the pieces."""
        expected = np.array([density.count(aim) for density in self.densities])
        most = MAX_ARCS // 2
        found = least_counts(
            self._trials, expected, aim, tolerance, order=ORDER, most=most, together=TOGETHER
        )
        curved = iter(found)
        rests = iter(self.rests)
        return [next(rests) if piece.is_arc else next(curved).chain() for piece in self.pieces]

    def _trials(self, wanted: Sequence[tuple[int, int]]) -> list[tuple[Biarcs, float]]:
        joints = [self.densities[piece].joints(count) for piece, count in wanted]
        ends = taken(self.ends, [piece for piece, _ in wanted])
        made = _sound_biarcs(self.curve, joints, ends)
        again = [
            self.densities[piece].joints(count, Found.of(used, biarcs.distances))
            for (piece, count), (biarcs, used) in zip(wanted, made, strict=True)
        ]
        both = zip(made, _sound_biarcs(self.curve, again, ends), strict=True)
        found = [(biarcs, float(np.max(biarcs.distances))) for pair in both for biarcs, _ in pair]
        pairs = zip(found[::2], found[1::2], strict=True)
        return [min(pair, key=lambda each: each[1]) for pair in pairs]


def _group(curve: WorkingCurve, pieces: list[Piece]) -> Group:
    densities, stops = [], []
    for piece, bends in zip(pieces, bends_of(curve, pieces), strict=True):
        if not piece.is_arc:
            densities.append(ArcDensity(piece, bends))
            stops.append(piece.end)
    ends = Ends(*curve.traced(np.array(stops, dtype=np.float64), "left"))
    return _Group(curve, tuple(pieces), tuple(densities), ends, rest_arcs(curve, pieces)).fit


def rest_arcs(curve: WorkingCurve, pieces: Sequence[Piece]) -> tuple[Chain, ...]:
    """The one arc that each of `pieces` is that is one."""
    arcs = [(piece, piece.centre) for piece in pieces if piece.centre is not None]
    if not arcs:
        return ()
    points = curve.point(np.array([piece.start for piece, _ in arcs]))
    turn = -curve.pitch.rotation
    return tuple(
        Chain.arc(piece.start, point, turn * (piece.end - piece.start), centre)
        for (piece, centre), point in zip(arcs, points, strict=True)
    )


def _sound_biarcs(
    curve: WorkingCurve, joints: list[FloatArray], ends: Ends
) -> list[tuple[Biarcs, FloatArray]]:
    """Biarcs whose arcs have a parallel on the pitch curve, see `camgeo.geometry.contour.proof`,
    with their joints.

    Near a cusp the curvature may grow so fast between two joints that the second arc has to turn
    back, with less than the roller's radius: such spans are halved. Where that makes more of them,
    the curve itself bends so much, and no halving helps.
    """
    found = _biarcs(curve, joints, ends)
    before = [len(each) for each in joints]
    for _ in range(HALVINGS):
        again = []
        for k, biarcs in enumerate(found):
            bad = biarcs.turned_over(curve)
            crowded = np.min(biarcs.least_step) * PARTS < CROWDED * np.max(np.abs(biarcs.ends))
            if not np.any(bad) and not crowded:
                continue
            spans = np.flatnonzero(bad)
            if len(spans) > max(before[k], MANY):
                continue
            before[k] = len(spans)
            halves = 0.5 * (joints[k][spans] + joints[k][spans + 1])
            apart = joints_apart(curve, np.insert(joints[k], spans + 1, halves))
            if not np.array_equal(apart, joints[k]):
                joints[k] = apart
                again.append(k)
        if not again:
            break
        more = _biarcs(curve, [joints[k] for k in again], taken(ends, again))
        for k, biarcs in zip(again, more, strict=True):
            found[k] = biarcs
    return list(zip(found, joints, strict=True))


def _biarcs(curve: WorkingCurve, joints: list[FloatArray], ends: Ends) -> list[Biarcs]:
    stops = np.cumsum([len(each) for each in joints]) - 1
    biarcs = Biarcs.along(curve, np.concatenate(joints), stops, ends)
    last = stops - np.arange(len(joints))
    first = np.concatenate(([0], last[:-1]))
    return [taken(biarcs, slice(int(a), int(b))) for a, b in zip(first, last, strict=True)]


# -- biarcs ---------------------------------------------------------------------------------------
# Biarcs between points of a curve, many at once, and their distance from it.
#
# At the ends of a smooth piece they have the curve's own tangents, between them those that deviate
# least. The curve is evaluated at `PARTS` places per span, in one call for all spans. Its crossing
# of the middle of a biarc, and its distance between the places, follow from Hermite cubics.
#
# The best G1 arcs, two of equal length h a span, pass through the curve at the joints and in the
# middles, but not along its tangent: e = kappa' h^3 B_3(t) / 6 over each arc, B_3 Bernoulli's
# polynomial, has the slope kappa' h^2 / 12 there. So biarcs whose tangents are turned by that
# follow a curve as closely as any arcs, 3.08 times as closely as biarcs with its own tangents. As
# kappa' varies and as pieces end with given tangents the angles come from least squares, which have
# the same limit.


OUTERMOST = 0.5
"""Weight of a piece's outermost spans, whose outer tangent is given. With less, the neighbouring
rotations are those of a piece that continues, and the outermost spans have to be short; with more,
the others deviate more."""


def tangent_turns(apart: FloatArray, lengths: FloatArray, last: IntArray) -> FloatArray:
    """(2, S) [rad] by which the tangents at the start and at the end of each span turn.

    Spans that join have the same rotation there; at both ends of a chain it is 0.

    Parameters
    ----------
    apart : (S, p) [mm] how far the curve lies to the right of the biarcs with its own tangents, at
        p places that divide each span evenly.
    lengths : (S,) [mm] of the spans' chords.
    last : (k,) number of the last span of each chain.
    """
    turns = np.zeros((2, len(lengths)))
    if len(lengths) == len(last):
        return turns
    closes = np.zeros(len(lengths), dtype=np.bool_)
    closes[last] = True
    weight = np.where(closes | np.roll(closes, 1), OUTERMOST, 1.0)
    # Displacement of the biarc by a rotation of 1 at the start, or at the end, of a span of length
    # 1.
    places = np.arange(1, apart.shape[1] + 1) / (apart.shape[1] + 1)
    ahead = np.where(places < 0.5, places - 1.5 * places * places, 0.5 * (1.0 - places) ** 2)
    behind = -ahead[::-1]
    pull = weight * lengths
    before, after = pull * (apart @ behind), pull * (apart @ ahead)
    square = pull * lengths
    joined = ~closes[:-1]
    both = joined[:-1] & joined[1:]
    own = float(ahead @ ahead) * (square[:-1] + square[1:])
    cross = np.where(both, float(ahead @ behind) * square[1:-1], 0.0)
    found = _tridiagonal(cross, own, np.where(joined, -(before[:-1] + after[1:]), 0.0))
    turns[1, :-1] = found
    turns[0, 1:] = found
    return turns


def _tridiagonal(outer: FloatArray, middle: FloatArray, right: FloatArray) -> FloatArray:
    """Solution (n,) with the main band `middle` (n,) and `outer` (n - 1,) on both sides of it."""
    from scipy.linalg import solveh_banded  # only for making a contour

    if len(middle) == 1:  # which scipy does not accept
        return right / middle
    bands = np.zeros((2, len(middle)))
    bands[0, 1:], bands[1] = outer, middle
    return np.asarray(solveh_banded(bands, right, overwrite_ab=True, check_finite=False))


PARTS = 6
"""Places per span: for a curve whose curvature has a constant slope the distance is a cubic over
each of the two arcs, and Hermite cubics are exact."""

NEWTON_STEPS = 4
"""Newton steps to the middle, which lies near half way."""

FLAT = 2e-12
"""An arc whose sagitta is a smaller fraction of the largest distance from the cam axis is a line:
its centre has no significant digits."""


@dataclass(frozen=True, slots=True, eq=False)
class Ends:
    """Points, unit tangents and paces (k,) at the ends of smooth pieces, left-hand values there."""

    points: ComplexArray
    tangents: ComplexArray
    paces: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Biarcs:
    """Biarcs along smooth pieces, span by span; S spans.

    Attributes
    ----------
    angles : (S, 2) [rad] of the start of each arc: the first joint, and where the curve crosses
        the middle, square to both arcs.
    vertices, tangents : (S, 2) complex [mm], starts of the arcs and unit tangents there.
    curvatures : (S, 2) [1/mm], counter-clockwise positive; 0 is a line.
    ends : (S,) complex [mm] ends of the second arcs.
    distances : (S,) [mm] largest distance found from the curve.
    least_step : (S,) [mm] smallest distance between neighbouring places.
    """

    angles: FloatArray
    vertices: ComplexArray
    tangents: ComplexArray
    curvatures: FloatArray
    ends: ComplexArray
    distances: FloatArray
    least_step: FloatArray

    @classmethod
    def along(cls, curve: WorkingCurve, joints: FloatArray, stops: IntArray, ends: Ends) -> Self:
        """Biarcs along several chains of spans, one after the other.

        Parameters
        ----------
        joints : (S + k,) [rad] of all k chains, each with its last one.
        stops : (k,) places of the last joints in `joints`.
        ends : of each chain.
        """
        inner = np.ones(len(joints), dtype=np.bool_)
        inner[stops] = False
        starts = np.flatnonzero(inner)
        first, step = joints[starts], np.diff(joints)[inner[:-1]] / PARTS
        phi = first[:, None] + step[:, None] * np.arange(PARTS)
        shape = (len(starts), PARTS + 1)
        points, tangents = np.empty((2, *shape), dtype=np.complex128)
        slopes = np.empty(shape)
        last = stops - np.arange(1, len(stops) + 1)
        traced, at_ends = curve.traced(phi.ravel()), (ends.points, ends.tangents, ends.paces)
        for whole, part, end in zip((points, tangents, slopes), traced, at_ends, strict=True):
            whole[:, :-1] = part.reshape(phi.shape)
            whole[:-1, -1] = whole[1:, 0]
            whole[last, -1] = end
        slopes *= step[:, None]
        outer = tangents[:, (0, -1)].T
        plain = _Arcs.between(points, *outer)
        lengths = np.abs(points[:, -1] - points[:, 0])
        turns = tangent_turns(plain.near(points[:, 1:-1]), lengths, last)
        arcs = _Arcs.between(points, *(outer * np.exp(1j * turns)))
        angles, apart, peaks = arcs.distances_to(points, tangents, slopes)
        distances = np.maximum(peaks, np.max(np.abs(apart), axis=1))
        least = np.min(np.abs(np.diff(points, axis=1)), axis=1)
        parts = arcs.vertices, arcs.tangents, arcs.curvatures, points[:, -1]
        return cls(first[:, None] + step[:, None] * angles, *parts, distances, least)

    @classmethod
    def along_cubics(cls, pieces: ComplexArray) -> Self:
        """Biarcs along Bezier `pieces` (S, 4) [mm], with its tangents; `angles` are parts."""
        t = np.linspace(0.0, 1.0, PARTS + 1)
        points, sides = at(pieces, t), 3.0 * np.diff(pieces, axis=1)
        rates = sides @ np.stack(((1.0 - t) ** 2, 2.0 * t * (1.0 - t), t * t))
        # Where the first side has no length the tangent is that of the next one, or of the chord.
        for place, side in ((0, points[:, 1] - points[:, 0]), (-1, points[:, -1] - points[:, -2])):
            rates[:, place] = np.where(rates[:, place] == 0.0, side, rates[:, place])
        slopes = np.abs(rates)
        tangents = rates / np.where(slopes > 0.0, slopes, 1.0)
        arcs = _Arcs.between(points, tangents[:, 0], tangents[:, -1])
        angles, apart, peaks = arcs.distances_to(points, tangents, slopes / PARTS)
        distances = np.maximum(peaks, np.max(np.abs(apart), axis=1))
        parts = arcs.vertices, arcs.tangents, arcs.curvatures, points[:, -1]
        return cls(angles, *parts, distances, np.min(np.abs(np.diff(points, axis=1)), axis=1))

    def turned_over(self, curve: WorkingCurve) -> BoolArray:
        """(S,) spans with an arc whose parallel on the pitch curve has turned inside out."""
        return np.asarray(
            np.any(-curve.pitch.rotation * curve.distance * self.curvatures >= 1.0, axis=1)
        )

    def chain(self) -> Chain:
        """The arcs one after the other; the flattest are lines."""
        starts, tangents = self.vertices.ravel(), self.tangents.ravel()
        chords = np.append(starts[1:], self.ends[-1]) - starts
        half = np.angle(chords * np.conj(tangents))
        lengths = np.abs(chords)
        flat = lengths * np.abs(half) <= 4.0 * FLAT * np.max(np.abs(starts), initial=0.0)
        radii = lengths / (2.0 * np.sin(np.where(flat, 1.0, half)))
        centres = np.where(flat, 0.0, starts + 1j * tangents * radii)
        return Chain(self.angles.ravel(), starts, np.where(flat, 0.0, 2.0 * half), centres)


@dataclass(frozen=True, slots=True, eq=False)
class _Arcs:
    """Vertices, tangents and curvatures (S, 2) of biarcs, as of `Biarcs`."""

    vertices: ComplexArray
    tangents: ComplexArray
    curvatures: FloatArray

    @classmethod
    def between(cls, points: ComplexArray, t0: ComplexArray, t1: ComplexArray) -> Self:
        """From the first to the last of `points` (S, PARTS + 1), with the unit tangents there."""
        start, end = points[:, 0], points[:, -1]
        # Next to a cusp two joints may be one point; they are too near to each other to be kept.
        end = np.where(np.abs(end - start) <= 4.0 * np.spacing(np.abs(end)), start + t0, end)
        chord = end - start
        # Equal tangent lengths d at both ends: |chord - d (t0 + t1)| = 2 d.
        both = t0 + t1
        square = chord.real**2 + chord.imag**2
        along = chord.real * both.real + chord.imag * both.imag
        opening = 2.0 * (1.0 - (t0.real * t1.real + t0.imag * t1.imag))
        length = square / (along + np.sqrt(along * along + opening * square))
        middle = 0.5 * (start + end + length * (t0 - t1))
        across = (chord - length * both) / (2.0 * length)
        vertices, directions = np.stack((start, middle), 1), np.stack((t0, across), 1)
        chords = np.stack((middle - start, end - middle), 1)
        # Where the curve turns back at once, one of the arcs has no length.
        squares = np.abs(chords) ** 2
        squares = np.where(squares > 0.0, squares, 1.0)
        curvatures = 2.0 * (np.conj(directions) * chords).imag / squares
        return cls(vertices, directions, curvatures)

    def near(self, places: ComplexArray) -> FloatArray:
        """How far (S, PARTS - 1) [mm] the `places` inside lie to the right of the arcs, nearly."""
        arc = (np.arange(1, PARTS) > 0.5 * PARTS).astype(np.intp)
        arm = places - self.vertices[:, arc]
        bend, ahead = self.curvatures[:, arc], self.tangents[:, arc]
        right = arm.real * ahead.imag - arm.imag * ahead.real
        return np.asarray(0.5 * bend * (arm.real**2 + arm.imag**2) + right)

    def distances_to(
        self, points: ComplexArray, tangents: ComplexArray, slopes: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Parts of the span (S, 2) at which the arcs begin, distances (S, PARTS + 1) [mm] of the
        places to the right of the arcs, and the largest such distance (S,) between places.

        `slopes`: of the arc length over a part of a span [mm].
        """
        # The curve seen from the middle: its way along the common tangent, and off it.
        middle, across = self.vertices[:, 1], self.tangents[:, 1]
        back = np.conj(across)[:, None]
        local, rates = back * (points - middle[:, None]), back * tangents * slopes
        rows = np.arange(len(points))
        before = np.sum(local[:, 1:-1].real < 0.0, axis=1)
        t, off, turn = _crossing(local[rows, before], local[rows, before + 1],
                                 rates[rows, before], rates[rows, before + 1])  # fmt: skip

        # From the first arc up to the part with the middle, from the second after it.
        second = np.arange(PARTS + 1) > before[:, None]
        arc = second.astype(np.intp)
        row = rows[:, None]
        arm = points - self.vertices[row, arc]
        bend, ahead = self.curvatures[row, arc], 1j * self.tangents[row, arc]
        bent = bend * (arm.real**2 + arm.imag**2) - 2.0 * (np.conj(ahead) * arm).real
        root = np.sqrt(np.maximum(1.0 + bend * bent, 0.0))
        apart = bent / (1.0 + root)
        outward = (bend * arm - ahead) / root
        growth = (np.conj(outward) * tangents).real * slopes
        peaks = highest(apart[:, :-1], apart[:, 1:], growth[:, :-1], growth[:, 1:])
        # Within the part with the middle the second arc takes over from the first.
        near, far = (rows, before), (rows, before + 1)
        sides = highest(
            np.stack((apart[near], off)), np.stack((off, apart[far])),
            np.stack((t * growth[near], (1.0 - t) * turn)),
            np.stack((t * turn, (1.0 - t) * growth[far])),
        )  # fmt: skip
        peaks[near] = np.maximum(np.abs(off), np.max(sides, axis=0))
        angles = np.stack((np.zeros(len(t)), before + t), 1)
        return angles, apart, np.max(peaks, axis=1)


def _crossing(
    here: ComplexArray, there: ComplexArray, rate: ComplexArray, rate_there: ComplexArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Where in [0, 1] Hermite's cubic between `here` and `there` has the real part 0, and minus its
    imaginary part and the slope of that there.
    """
    chord = there - here
    square, cube = 3.0 * chord - 2.0 * rate - rate_there, rate + rate_there - 2.0 * chord
    a, b, c, d = here.real, rate.real, square.real, cube.real
    t = np.clip(-a / np.where(chord.real > 0.0, chord.real, 1.0), 0.0, 1.0)
    for _ in range(NEWTON_STEPS):
        slope = b + t * (2.0 * c + 3.0 * t * d)
        value = a + t * (b + t * (c + t * d))
        t = np.clip(t - value / np.where(slope > 0.0, slope, np.inf), 0.0, 1.0)
    off = here.imag + t * (rate.imag + t * (square.imag + t * cube.imag))
    turn = rate.imag + t * (2.0 * square.imag + 3.0 * t * cube.imag)
    return t, -off, -turn
