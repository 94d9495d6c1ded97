"""Fits by lines and G1 arcs: the fast one by biarcs, and that of the fewest pieces.

The fast fit has biarcs between points of the curve. Their joints follow from the law of their
distance from the curve, corrected once by the distances that result. A biarc with turned tangents,
see below, over a span h of arc length is off the curve by

    C h^3 (|kappa'| + c |kappa''| h),   C = 0.1001^3,

primes for d/ds: the first term is that of the best arcs. A fit based only on the first term
deviates too much wherever the slope of curvature changes its sign.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self, TypeVar

import numpy as np
from numpy.typing import NDArray

from camgeo.errors import GeometryError, ToleranceError
from camgeo.geometry.contour.contour import Fit
from camgeo.geometry.contour.legs import (
    CROWDED,
    JOINT_DISTANCE,
    Bends,
    Chain,
    TurnLeg,
    clearly_less,
    in_steps,
    least_counts,
    sample_bends,
    separate_joints,
)
from camgeo.geometry.contour.proof import AIM, Group, fit_by_groups, proved_fit
from camgeo.geometry.contour.spline import bezier_points, highest
from camgeo.geometry.outline.path import Path
from camgeo.geometry.pieces import SmoothPiece
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

LEAST_SHARE = 0.01
"""Smallest distance of a span that counts, as a fraction of the largest: it limits the correction.
"""

WIDEST_SPAN = 2.0
"""Cam angle [rad] of the widest span: a whole turn without a break and with a tiny stroke has no
chord from its start to its end."""


@dataclass(frozen=True, slots=True, eq=False)
class DensityCorrection:
    """A correction of the density of spans, by the deviations that a first choice of joints leaves.

    Attributes
    ----------
    places : (m,) [rad] middles of the spans.
    needs : (m,) factor by which the density there is too small, up to a common factor.
    """

    places: FloatArray
    needs: FloatArray

    @classmethod
    def from_distances(cls, joints: FloatArray, distances: FloatArray) -> Self:
        """The correction by the `distances` (m,) [mm] of spans between `joints` (m + 1,) [rad]."""
        largest = float(np.max(distances))
        shares = distances / largest if largest > 0.0 else np.ones(len(distances))
        excess = in_steps(np.log(np.maximum(shares, LEAST_SHARE)))
        return cls(0.5 * (joints[:-1] + joints[1:]), np.exp(POWER * excess))


class ArcDensity:
    """Spans of biarcs along one smooth piece.

    Over the cam angle the density of spans delta obeys delta^4 = (a^3 delta + b) C / error, where
    a^3 = |kappa'| pace^3, the same for all parallels, and b = c |kappa''| pace^4.
    """

    def __init__(self, piece: SmoothPiece, bends: Bends) -> None:
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
        """Estimate of the least number of spans within `aim` [mm]; not a whole number."""
        # A span is two arcs, so that its constant is half of `ARC_CONSTANT`; the error takes its
        # cube.
        inner = self._width * float(np.sum(self._density(aim / (0.5 * ARC_CONSTANT) ** 3)))
        known = inner * 1.03 + min(max(0.25 * (inner - 1.0), 0.0), ENDS)
        return max(known, (self._piece.end - self._piece.start) / WIDEST_SPAN)

    def joints(self, count: int, correction: DensityCorrection | None = None) -> FloatArray:
        """(count + 1,) cam angles [rad] of the ends of `count` parts, both outer ones included.

        `correction`: by the deviations of about as many spans.
        """
        if count > len(self._bends.speed) // 2:
            if self._finer is None:
                self._finer = ArcDensity(self._piece, self._bends.refined())
            return self._finer.joints(count, correction)
        # As if the cubic term were alone: count = total / error^(1/3).
        error = (self._total / count) ** 3
        density = self._density(error)
        # These are too many spans: find the error that gives about the requested number.
        error *= (self._width * float(np.sum(density)) / count) ** 3
        density = self._density(error)
        if correction is not None:
            middles = self._borders[:-1] + 0.5 * self._width
            density *= np.interp(middles, correction.places, correction.needs)
        density += FLOOR * float(np.mean(density))
        if not density[0] > 0.0:  # a straight line has no difficulty anywhere
            density = np.ones(len(density))
        reached = np.concatenate(([0.0], np.cumsum(density)))
        joints: FloatArray = np.interp(_part_ends(count) * reached[-1], reached, self._borders)
        joints[0], joints[-1] = self._piece.start, self._piece.end
        return joints

    def _density(self, error: float) -> FloatArray:
        if error <= 0.0:
            return np.cbrt(self._cubic)
        cubic, quartic = self._cubic / error, self._quartic / error
        density: FloatArray = np.maximum(np.cbrt(cubic), np.sqrt(np.sqrt(quartic)))
        # The equation density^4 = cubic density + quartic, from the larger of the terms alone.
        for _ in range(STEPS):
            density = np.sqrt(np.sqrt(cubic * density + quartic))
        return density


def _part_ends(count: int) -> FloatArray:
    """(count + 1,) ends of `count` parts of [0, 1], equal but for the outermost, see `OUTER`."""
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
"""Most rounds in which spans are halved."""

MANY = 16
"""Up to this many spans are halved again in any case; more of them only if they became fewer."""

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
    """The chain of the single arc of a turn."""
    return Chain.arc(0.0, leg.first, leg.sweep, leg.centre)


@dataclass(frozen=True, slots=True, eq=False)
class _BiarcGroup:
    """Smooth pieces of one curve, which share its evaluations.

    Attributes
    ----------
    curve, pieces : the curve, and its smooth pieces in order.
    densities, ends : of the pieces that are no arcs.
    rests : chains of the pieces that are single arcs, dwells among them.
    """

    curve: WorkingCurve
    pieces: tuple[SmoothPiece, ...]
    densities: tuple[ArcDensity, ...]
    ends: PieceEnds
    rests: tuple[Chain, ...]

    def fit(self, aim: float, tolerance: float) -> list[Chain]:
        """A chain for each of the pieces."""
        expected = np.array([density.count(aim) for density in self.densities])
        most = MAX_ARCS // 2
        biarcs = least_counts(
            self._trials, expected, aim, tolerance, order=ORDER, most=most, together=TOGETHER
        )
        curved = iter(biarcs)
        rests = iter(self.rests)
        return [next(rests) if piece.is_arc else next(curved).chain() for piece in self.pieces]

    def _trials(self, wanted: Sequence[tuple[int, int]]) -> list[tuple[Biarcs, float]]:
        joints = [self.densities[piece].joints(count) for piece, count in wanted]
        ends = taken(self.ends, [piece for piece, _ in wanted])
        fits = _sound_biarcs(self.curve, joints, ends)
        # Each count is tried twice: with the joints of the law, and with joints corrected by what
        # these leave.
        corrected = [
            self.densities[piece].joints(
                count, DensityCorrection.from_distances(used, biarcs.distances)
            )
            for (piece, count), (biarcs, used) in zip(wanted, fits, strict=True)
        ]
        both = zip(fits, _sound_biarcs(self.curve, corrected, ends), strict=True)
        candidates = [
            (biarcs, float(np.max(biarcs.distances))) for pair in both for biarcs, _ in pair
        ]
        # Both tries of a count follow each other; the closer one stands for it.
        pairs = zip(candidates[::2], candidates[1::2], strict=True)
        return [min(pair, key=lambda candidate: candidate[1]) for pair in pairs]


def _group(curve: WorkingCurve, pieces: list[SmoothPiece]) -> Group:
    densities, stops = [], []
    for piece, bends in zip(pieces, sample_bends(curve, pieces), strict=True):
        if not piece.is_arc:
            densities.append(ArcDensity(piece, bends))
            stops.append(piece.end)
    ends = PieceEnds(*curve.traced(np.array(stops, dtype=np.float64), "left"))
    return _BiarcGroup(curve, tuple(pieces), tuple(densities), ends, rest_arcs(curve, pieces)).fit


def rest_arcs(curve: WorkingCurve, pieces: Sequence[SmoothPiece]) -> tuple[Chain, ...]:
    """A chain of one arc for each of `pieces` that is an arc."""
    arcs = [(piece, piece.centre) for piece in pieces if piece.centre is not None]
    if not arcs:
        return ()
    points = curve.point(np.array([piece.start for piece, _ in arcs]))
    # The curve is traversed against the sense in which the cam turns.
    turn = -curve.pitch.rotation
    return tuple(
        Chain.arc(piece.start, point, turn * (piece.end - piece.start), centre)
        for (piece, centre), point in zip(arcs, points, strict=True)
    )


def _sound_biarcs(
    curve: WorkingCurve, joints: list[FloatArray], ends: PieceEnds
) -> list[tuple[Biarcs, FloatArray]]:
    """Biarcs whose arcs have a parallel on the pitch curve, see `camgeo.geometry.contour.proof`,
    with their joints.

    Near a cusp the curvature may grow so fast between two joints that the second arc has to turn
    back, with less than the roller's radius: such spans are halved. Where that makes more of them,
    the curve itself bends so much, and no halving helps.
    """
    fits = _biarcs(curve, joints, ends)
    bad_counts = [len(chain_joints) for chain_joints in joints]
    for _ in range(HALVINGS):
        again = []
        for k, biarcs in enumerate(fits):
            bad = biarcs.inverted_spans(curve)
            crowded = np.min(biarcs.least_step) * PARTS < CROWDED * np.max(np.abs(biarcs.ends))
            if not np.any(bad) and not crowded:
                continue
            spans = np.flatnonzero(bad)
            # More bad spans than before: the curve itself bends too much, and no halving helps.
            if len(spans) > max(bad_counts[k], MANY):
                continue
            bad_counts[k] = len(spans)
            halves = 0.5 * (joints[k][spans] + joints[k][spans + 1])
            # Inserted before the joint at which the bad span ends.
            separated = separate_joints(curve, np.insert(joints[k], spans + 1, halves))
            if not np.array_equal(separated, joints[k]):
                joints[k] = separated
                again.append(k)
        if not again:
            break
        more = _biarcs(curve, [joints[k] for k in again], taken(ends, again))
        for k, biarcs in zip(again, more, strict=True):
            fits[k] = biarcs
    return list(zip(fits, joints, strict=True))


def _biarcs(curve: WorkingCurve, joints: list[FloatArray], ends: PieceEnds) -> list[Biarcs]:
    stops = np.cumsum([len(chain_joints) for chain_joints in joints]) - 1
    biarcs = Biarcs.along(curve, np.concatenate(joints), stops, ends)
    # The joints of all chains lie in one array, and a chain has one span less than joints.
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


def tangent_turns(offsets: FloatArray, lengths: FloatArray, last: IntArray) -> FloatArray:
    """(2, S) [rad] by which the tangents at the start and at the end of each span turn.

    Spans that join have the same rotation there; at both ends of a chain it is 0.

    Parameters
    ----------
    offsets : (S, p) [mm] how far the curve lies to the right of the biarcs with its own tangents,
        at p places that divide each span evenly.
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
    places = np.arange(1, offsets.shape[1] + 1) / (offsets.shape[1] + 1)
    ahead = np.where(places < 0.5, places - 1.5 * places * places, 0.5 * (1.0 - places) ** 2)
    behind = -ahead[::-1]
    pull = weight * lengths
    end_residuals, start_residuals = pull * (offsets @ behind), pull * (offsets @ ahead)
    square = pull * lengths
    joined = ~closes[:-1]
    both = joined[:-1] & joined[1:]
    # Normal equations. The turn at a joint moves the span before it by its end and the span after
    # it by its start.
    diagonal = float(ahead @ ahead) * (square[:-1] + square[1:])
    cross = np.where(both, float(ahead @ behind) * square[1:-1], 0.0)
    joint_turns = _tridiagonal(
        cross, diagonal, np.where(joined, -(end_residuals[:-1] + start_residuals[1:]), 0.0)
    )
    turns[1, :-1] = joint_turns
    turns[0, 1:] = joint_turns
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
class PieceEnds:
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
    def along(
        cls, curve: WorkingCurve, joints: FloatArray, stops: IntArray, ends: PieceEnds
    ) -> Self:
        """Biarcs along several chains of spans, one after the other.

        Parameters
        ----------
        joints : (S + k,) [rad] of all k chains, each with its last one.
        stops : (k,) places of the last joints in `joints`.
        ends : of each chain.
        """
        # Every joint but the last of each chain begins a span.
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
            # A span ends where the next one begins; the last of a chain ends in its left-hand
            # value.
            whole[:-1, -1] = whole[1:, 0]
            whole[last, -1] = end
        # Paces per radian become arc lengths per part of a span.
        slopes *= step[:, None]
        outer = tangents[:, (0, -1)].T
        # First with the curve's own tangents; what these leave determines how far to turn them.
        plain = _Arcs.with_end_tangents(points, *outer)
        lengths = np.abs(points[:, -1] - points[:, 0])
        turns = tangent_turns(plain.approximate_offsets(points[:, 1:-1]), lengths, last)
        arcs = _Arcs.with_end_tangents(points, *(outer * np.exp(1j * turns)))
        angles, offsets, peaks = arcs.measure_offsets(points, tangents, slopes)
        distances = np.maximum(peaks, np.max(np.abs(offsets), axis=1))
        least = np.min(np.abs(np.diff(points, axis=1)), axis=1)
        parts = arcs.vertices, arcs.tangents, arcs.curvatures, points[:, -1]
        return cls(first[:, None] + step[:, None] * angles, *parts, distances, least)

    @classmethod
    def along_cubics(cls, pieces: ComplexArray) -> Self:
        """Biarcs along Bezier `pieces` (S, 4) [mm], tangent at the ends; `angles` count parts."""
        t = np.linspace(0.0, 1.0, PARTS + 1)
        points, sides = bezier_points(pieces, t), 3.0 * np.diff(pieces, axis=1)
        # Bernstein's polynomials of degree 2 give the derivative from the sides of the control
        # polygon.
        rates = sides @ np.stack(((1.0 - t) ** 2, 2.0 * t * (1.0 - t), t * t))
        # Where the first side has no length the tangent is that of the next one, or of the chord.
        for place, side in ((0, points[:, 1] - points[:, 0]), (-1, points[:, -1] - points[:, -2])):
            rates[:, place] = np.where(rates[:, place] == 0.0, side, rates[:, place])
        slopes = np.abs(rates)
        tangents = rates / np.where(slopes > 0.0, slopes, 1.0)
        arcs = _Arcs.with_end_tangents(points, tangents[:, 0], tangents[:, -1])
        angles, offsets, peaks = arcs.measure_offsets(points, tangents, slopes / PARTS)
        distances = np.maximum(peaks, np.max(np.abs(offsets), axis=1))
        parts = arcs.vertices, arcs.tangents, arcs.curvatures, points[:, -1]
        return cls(angles, *parts, distances, np.min(np.abs(np.diff(points, axis=1)), axis=1))

    def inverted_spans(self, curve: WorkingCurve) -> BoolArray:
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
    def with_end_tangents(cls, points: ComplexArray, t0: ComplexArray, t1: ComplexArray) -> Self:
        """Biarcs from the first to the last of `points` (S, PARTS + 1), with the unit tangents `t0`
        and `t1` (S,) there.
        """
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
        # The common tangent runs from the corner of the first arc's tangents to that of the second
        # one's.
        across = (chord - length * both) / (2.0 * length)
        vertices, directions = np.stack((start, middle), 1), np.stack((t0, across), 1)
        chords = np.stack((middle - start, end - middle), 1)
        # Where the curve turns back at once, one of the arcs has no length.
        squares = np.abs(chords) ** 2
        squares = np.where(squares > 0.0, squares, 1.0)
        # A circle that leaves along d and passes through the chord c has the curvature 2 Im(conj(d)
        # c) / |c|^2.
        curvatures = 2.0 * (np.conj(directions) * chords).imag / squares
        return cls(vertices, directions, curvatures)

    def approximate_offsets(self, places: ComplexArray) -> FloatArray:
        """(S, PARTS - 1) [mm] how far the inner `places` lie to the right of the arcs, to first
        order.
        """
        # Places in the second half of the span belong to the second arc.
        arc = (np.arange(1, PARTS) > 0.5 * PARTS).astype(np.intp)
        arm = places - self.vertices[:, arc]
        bend, ahead = self.curvatures[:, arc], self.tangents[:, arc]
        right = arm.real * ahead.imag - arm.imag * ahead.real
        return np.asarray(0.5 * bend * (arm.real**2 + arm.imag**2) + right)

    def measure_offsets(
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
        # The common normal of both arcs lies in the part whose number is that of the inner places
        # before it.
        middle_part = np.sum(local[:, 1:-1].real < 0.0, axis=1)
        near, far = (rows, middle_part), (rows, middle_part + 1)
        t, middle_offset, middle_slope = _crossing(local[near], local[far], rates[near], rates[far])

        # From the first arc up to the part with the middle, from the second after it.
        second = np.arange(PARTS + 1) > middle_part[:, None]
        arc = second.astype(np.intp)
        row = rows[:, None]
        arm = points - self.vertices[row, arc]
        bend, ahead = self.curvatures[row, arc], 1j * self.tangents[row, arc]
        # The distance from a circle without its centre, which may be far away: bent / (1 + root).
        bent = bend * (arm.real**2 + arm.imag**2) - 2.0 * (np.conj(ahead) * arm).real
        root = np.sqrt(np.maximum(1.0 + bend * bent, 0.0))
        offsets = bent / (1.0 + root)
        outward = (bend * arm - ahead) / root
        # The slope of the distance: what of the curve's direction points along the arc's normal.
        growth = (np.conj(outward) * tangents).real * slopes
        peaks = highest(offsets[:, :-1], offsets[:, 1:], growth[:, :-1], growth[:, 1:])
        # Within the part with the middle the second arc takes over from the first.
        sides = highest(
            np.stack((offsets[near], middle_offset)), np.stack((middle_offset, offsets[far])),
            np.stack((t * growth[near], (1.0 - t) * middle_slope)),
            np.stack((t * middle_slope, (1.0 - t) * growth[far])),
        )  # fmt: skip
        peaks[near] = np.maximum(np.abs(middle_offset), np.max(sides, axis=0))
        angles = np.stack((np.zeros(len(t)), middle_part + t), 1)
        return angles, offsets, np.max(peaks, axis=1)


def _crossing(
    here: ComplexArray, there: ComplexArray, rate: ComplexArray, rate_there: ComplexArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """(n,) the place in [0, 1] where Hermite's cubic from `here` to `there` (n,) has the real part
    0; (n,), (n,) minus its imaginary part there, and the slope of that. `rate`, `rate_there` (n,)
    are its derivatives at both ends.
    """
    chord = there - here
    square, cube = 3.0 * chord - 2.0 * rate - rate_there, rate + rate_there - 2.0 * chord
    a, b, c, d = here.real, rate.real, square.real, cube.real
    t = np.clip(-a / np.where(chord.real > 0.0, chord.real, 1.0), 0.0, 1.0)
    for _ in range(NEWTON_STEPS):
        slope = b + t * (2.0 * c + 3.0 * t * d)
        value = a + t * (b + t * (c + t * d))
        t = np.clip(t - value / np.where(slope > 0.0, slope, np.inf), 0.0, 1.0)
    offset = here.imag + t * (rate.imag + t * (square.imag + t * cube.imag))
    offset_slope = rate.imag + t * (2.0 * square.imag + 3.0 * t * cube.imag)
    return t, -offset, -offset_slope


# -- fewest arcs -----------------------------------------------------------------------------------
# Fit by lines and G1 arcs with the fewest pieces, then the least deviation for their number.


ARC = math.sqrt(3.0) / 216.0
"""The best arcs leave the error ARC |dkappa/ds| h^3 on a span h: a C1 quadratic spline leaves
B_3(t)/6 of a cubic, and the largest value of Bernoulli's polynomial B_3 is sqrt(3)/36."""

FEWEST_AIM = 0.988
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
    groups: list[_FewestGroup] = []

    def group(curve: WorkingCurve, pieces: list[SmoothPiece]) -> Group:
        groups.append(_FewestGroup(curve, pieces))
        return groups[-1].fit

    try:
        fit = proved_fit(
            path, tolerance, FEWEST_AIM * tolerance, fit_by_groups(group, tolerance), turn_arc
        )
    except (ToleranceError, GeometryError, np.linalg.LinAlgError):
        return fit_arcs(path, tolerance)
    if not any(group.missed for group in groups):
        return fit
    fast = fit_arcs(path, tolerance)
    return fast if len(fast.contour) < len(fit.contour) else fit


LAID = 50_000
"""Arcs after which no more numbers of them are tried: the first or second attempt suffices."""


class _FewestGroup:
    """Smooth pieces of one curve, each number of arcs along them tried once.

    Attributes
    ----------
    missed : True once a number of arcs gave no result: there, another method may succeed.
    """

    def __init__(self, curve: WorkingCurve, pieces: list[SmoothPiece]) -> None:
        self.missed = False
        self._pieces, self._rests = pieces, rest_arcs(curve, pieces)
        bends = sample_bends(curve, pieces)
        self._curved = [k for k, piece in enumerate(pieces) if not piece.is_arc]
        if self._curved:
            chosen = [pieces[k] for k in self._curved], [bends[k] for k in self._curved]
            self._strands = Strands.from_pieces(curve, *chosen)
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
        # The asymptotic number of arcs, from the law `ARC`.
        limits = self._strands.difficulty.totals * (ARC / aim) ** (1.0 / 3.0)
        ladders = [_arc_counts(int(limit)) for limit in limits]
        splines: dict[int, ArcSpline] = {}
        laid = 0
        for attempt in range(ATTEMPTS):
            if laid > LAID:
                break
            rungs = slice(attempt * TRIALS, (attempt + 1) * TRIALS)
            tries = [
                (piece, number)
                for piece, ladder in enumerate(ladders)
                if piece not in splines
                for number in ladder[rungs]
            ]
            laid += sum(number for _, number in tries)
            self._lay([pair for pair in tries if pair not in self._known])
            for piece, number in tries:
                spline = self._known[piece, number]
                if piece not in splines and spline.deviation <= aim:
                    splines[piece] = spline
            if len(splines) == len(ladders):
                return [splines[piece] for piece in range(len(ladders))]
        raise ToleranceError("arcs cannot follow the curve", aim, math.inf)

    def _lay(self, tries: list[tuple[int, int]]) -> None:
        if not tries:
            return
        pieces, counts = np.array(tries).T
        for pair, spline in zip(tries, arc_splines(self._strands, pieces, counts), strict=True):
            self._known[pair] = spline
            # One arc is G1 at both ends only by chance.
            self.missed = self.missed or (pair[1] > 1 and spline.deviation == math.inf)


def _arc_counts(limit: int) -> list[int]:
    """Numbers of arcs to be tried in turn where `limit` is a lower bound, see `ALL_NUMBERS`."""
    numbers: list[int] = []
    number = max(1, limit)
    while len(numbers) < ATTEMPTS * TRIALS:
        step = 1 << max(0, (number - 1).bit_length() - ALL_NUMBERS)
        number = step * math.ceil(number / step)
        numbers.append(number)
        number += 1
    return numbers


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
    """Smooth pieces of one parallel, none of them an arc, prepared for fits by arcs.

    Attributes
    ----------
    curve : the parallel.
    difficulty : that of its p pieces.
    points, tangents : (2, p) complex [mm], unit; one-sided, at starts and ends.
    """

    curve: WorkingCurve
    difficulty: Difficulty
    points: ComplexArray
    tangents: ComplexArray

    @classmethod
    def from_pieces(
        cls, curve: WorkingCurve, pieces: Sequence[SmoothPiece], bends: Sequence[Bends]
    ) -> Strands:
        """The `pieces` of `curve`, whose bends along them are `bends`."""
        first = curve.traced(np.array([piece.start for piece in pieces]))
        last = curve.traced(np.array([piece.end for piece in pieces]), "left")
        points, tangents = np.stack((first[0], last[0])), np.stack((first[1], last[1]))
        return cls(curve, Difficulty.from_bends(pieces, bends), points, tangents)


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

    layout: ArcLayout
    angles: FloatArray
    points: ComplexArray
    tangents: ComplexArray
    samples: ComplexArray
    scale: FloatArray
    valid: BoolArray

    @classmethod
    def sample(
        cls, strands: Strands, layout: ArcLayout, pieces: IntArray, places: FloatArray, probes: int
    ) -> JointedCurve:
        """The curve at the `places` (j,) of joints along `pieces` (k,), and at `probes` per arc."""
        angles = strands.difficulty.angles(layout, pieces, places)
        left, right = layout.left, layout.left + 1
        parts = (np.arange(probes) + 0.5) / probes
        probe_angles = angles[left, None] + (angles[right] - angles[left])[:, None] * parts
        points, tangents, _ = strands.curve.traced(np.concatenate((angles, probe_angles.ravel())))
        samples = points[len(angles) :].reshape(probe_angles.shape)
        points, tangents = points[: len(angles)], tangents[: len(angles)]
        points[layout.first], points[layout.last] = strands.points[:, pieces]
        tangents[layout.first], tangents[layout.last] = strands.tangents[:, pieces]
        chords = np.abs(points[right] - points[left])
        separate = (chords > JOINT_DISTANCE * np.max(np.abs(points))) & (
            angles[right] > angles[left]
        )
        valid = np.logical_and.reduceat(separate, layout.first_arcs)
        scale = np.zeros(len(angles))
        scale[left] += chords
        scale[right] += chords
        return cls(layout, angles, points, tangents, samples, scale, valid)

    def step(self, system: ArcSystem, offsets: FloatArray) -> FloatArray:
        """Gauss-Newton step (j, 2) from `offsets` (j, 2), those [mm] and turns [rad] of joints."""
        arcs = Arcs.from_offsets(self, offsets)
        errors, t = arcs.errors(self.samples)
        left, right = self.layout.left, self.layout.left + 1
        # To first order arcs move by the Hermite cubic of the motion of their ends, a quadratic as
        # far as the condition holds. The present residual of the condition is a cubic part of the
        # error.
        rest = 1.0 - t
        errors += (0.5 * arcs.length * arcs.miss)[:, None] * t * rest * (rest - t)
        left_scale, right_scale = arcs.length / self.scale[left], arcs.length / self.scale[right]
        # Its rows: offset and turn of the joint on the left, then of that on the right. A turn
        # counts as a length, times `scale`.
        basis = np.stack(
            (
                rest * rest * (1.0 + 2.0 * t),
                rest * rest * t * left_scale[:, None],
                t * t * (1.0 + 2.0 * rest),
                -t * t * rest * right_scale[:, None],
            ),
            axis=1,
        )
        cosine = (np.conj(arcs.along) * self.tangents[left]).real
        end_cosine = (np.conj(arcs.along) * self.tangents[right]).real
        valid = self.valid & np.isfinite(self.layout.largest(np.max(np.abs(errors), axis=1)))
        # Both ends of a spline have the curve's point and tangent.
        free = self.layout.of_joints(valid)
        free[self.layout.first] = free[self.layout.last] = False
        unknowns = system.solve(
            basis @ basis.transpose(0, 2, 1),
            (basis @ errors[:, :, None])[:, :, 0],
            np.stack((-2.0 * cosine, -left_scale, 2.0 * end_cosine, -right_scale), axis=1),
            -arcs.length * arcs.miss,
            free,
        )
        # Joints between chords of no length are not free, and do not turn.
        scale = np.where(self.scale > 0.0, self.scale, 1.0)
        return np.asarray(unknowns / np.stack((np.ones(len(unknowns)), scale), axis=1))

    def deviations(self, offsets: FloatArray) -> FloatArray:
        """(n,) [mm] largest distance of the curve from each arc, from samples."""
        errors = np.abs(Arcs.from_offsets(self, offsets).errors(self.samples)[0])
        joints = np.abs(offsets[:, 0])
        end_offsets = np.maximum(joints[self.layout.left], joints[self.layout.left + 1])
        inside, previous, following = errors[:, 1:-1], errors[:, :-2], errors[:, 2:]
        # The peak of the parabola through three neighbouring samples.
        bend = 2.0 * inside - previous - following
        top = (inside >= previous) & (inside >= following) & (bend > 0.0)
        rise = np.where(top, (following - previous) ** 2, 0.0) / np.where(top, 8.0 * bend, 1.0)
        peaks: FloatArray = np.maximum(np.max(errors, axis=1), np.max(inside + rise, axis=1))
        return np.maximum(end_offsets, peaks)


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
    def from_offsets(cls, jointed: JointedCurve, offsets: FloatArray) -> Arcs:
        """The arcs along `jointed` with the `offsets` (j, 2) [mm] and turns [rad] of its joints."""
        left, right = jointed.layout.left, jointed.layout.left + 1
        vertices = jointed.points + 1j * jointed.tangents * offsets[:, 0]
        tangents = jointed.tangents * np.exp(1j * offsets[:, 1])
        chords = vertices[right] - vertices[left]
        length = np.abs(chords)
        none = length == 0.0
        along = chords / np.where(none, 1.0, length)
        # A chord without a length has no direction: NaN makes its spline invalid.
        length[none] = np.nan
        start_angle = np.angle(along * np.conj(tangents[left]))
        end_angle = np.angle(tangents[right] * np.conj(along))
        middle = 0.5 * (vertices[left] + vertices[right])
        return cls(
            vertices,
            middle,
            along,
            length,
            0.5 * (start_angle + end_angle),
            start_angle - end_angle,
        )

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
"""Rounds in which the deviations of the arcs are equalised."""

FIRST_POWER, MOST_POWER, CALMER, BOLDER = 1.0 / 6.0, 0.25, 0.7, 1.2
"""Power of its deviation by which an arc is shortened in a round. Where arcs change alternately,
each at its neighbours' cost, deviations grow with about the sixth power of lengths: any power near
one third would oscillate. An arc that oscillates nevertheless is damped."""

UNEVENNESS, REPEATS = 0.15, 3
"""Where an arc still deviates by this much (a logarithm) more than the mean, as where dkappa/ds has
a zero every other arc, the rounds are repeated."""

FINAL_STEPS = 5
"""Final Gauss-Newton steps. Their conditions have exact derivatives and hold to rounding after
three, or after five if arcs turn by a radian."""

PROBES, CLOSE_PROBES = 12, 16
"""Points per arc at which its deviation is sampled: for least squares, and at the end."""

TANGENT = 2.0**-52 * 8.0
"""Largest angle between neighbouring arcs that is rounding: times the chord, as a fraction of the
distance from the cam axis."""

WIDEST_HALF = 1.5
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
    layout = ArcLayout.from_counts(counts)
    best, excess = _equal_error_places(
        strands, layout, pieces, strands.difficulty.joints(layout, pieces)
    )
    # Splines that stay uneven get more rounds from their best places; the others are done.
    uneven = np.flatnonzero(excess > UNEVENNESS)
    if len(uneven):
        part = ArcLayout.from_counts(counts[uneven])
        chosen = layout.of_joints(excess > UNEVENNESS)
        for _ in range(REPEATS):
            best[chosen] = _equal_error_places(strands, part, pieces[uneven], best[chosen])[0]
    jointed = JointedCurve.sample(strands, layout, pieces, best, PROBES)
    system = ArcSystem.from_layout(layout)
    offsets = np.zeros((len(best), 2))
    for _ in range(FINAL_STEPS):
        offsets = offsets + jointed.step(system, offsets)
    return _splines(
        strands.curve, JointedCurve.sample(strands, layout, pieces, best, CLOSE_PROBES), offsets
    )


def _equal_error_places(
    strands: Strands, layout: ArcLayout, pieces: IntArray, places: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Places (j,) of joints for equal deviations, by iteration from `places` (j,): those of the
    round with the smallest largest deviation; and (k,) the excess of that deviation in each spline,
    see `ArcLayout.excess`.
    """
    system = ArcSystem.from_layout(layout)
    count = len(layout.first)
    best, least, uneven = places, np.full(count, np.inf), np.full(count, np.inf)
    power, last = np.full(len(layout.left), FIRST_POWER), np.zeros(len(layout.left))
    for _ in range(ROUNDS):
        jointed = JointedCurve.sample(strands, layout, pieces, places, PROBES)
        deviations = jointed.deviations(jointed.step(system, np.zeros((len(places), 2))))
        worst, excess = layout.largest(deviations), layout.excess(deviations)
        better = clearly_less(worst, least)
        best = np.where(layout.of_joints(better), places, best)
        uneven = np.where(better, layout.largest(excess), uneven)
        least = np.where(better, worst, least)
        # An arc whose excess changes its sign oscillates: its power is reduced, that of others
        # raised.
        swings = excess * last < 0.0
        power = np.where(swings, CALMER * power, np.minimum(BOLDER * power, MOST_POWER))
        places, last = move_joints(layout, places, power * excess), excess
    return best, uneven


def _splines(curve: WorkingCurve, jointed: JointedCurve, offsets: FloatArray) -> list[ArcSpline]:
    """The splines of a batch, for the final `offsets` (j, 2) [mm] and turns [rad] of its joints."""
    arcs, layout = Arcs.from_offsets(jointed, offsets), jointed.layout
    # A proof adds the distance of joints from their feet along the arcs.
    gaps = np.abs(offsets[:, 0] * np.sin(offsets[:, 1]))
    total = jointed.deviations(offsets) + np.maximum(gaps[layout.left], gaps[layout.left + 1])
    # Each arc has a parallel on the pitch curve.
    side = -curve.pitch.rotation * np.sign(arcs.halves) * curve.distance
    good = (arcs.length > 2.0 * np.abs(np.sin(arcs.halves)) * side) & np.isfinite(total)
    good &= np.abs(arcs.length * arcs.miss) <= TANGENT * np.max(np.abs(jointed.points))
    good &= np.abs(arcs.halves) <= WIDEST_HALF
    valid = jointed.valid & np.logical_and.reduceat(good, layout.first_arcs)
    deviations = np.where(valid, layout.largest(total), np.inf)
    splines = []
    for k, (first, last) in enumerate(zip(layout.first, layout.last, strict=True)):
        joints, arc_range = slice(first, last + 1), slice(first - k, last - k)
        angles, vertices = jointed.angles[joints], arcs.vertices[joints]
        splines.append(ArcSpline(angles, vertices, arcs.halves[arc_range], float(deviations[k])))
    return splines


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
class ArcLayout:
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
    def from_counts(cls, counts: IntArray) -> ArcLayout:
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
        logarithms: FloatArray = np.log(
            np.where(usable, np.maximum(deviations, LEAST * worst), 1.0)
        )
        mean: FloatArray = np.bincount(self.spline, weights=logarithms) / self.counts
        return in_steps(logarithms - mean[self.spline])


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
    def from_bends(cls, pieces: Sequence[SmoothPiece], bends: Sequence[Bends]) -> Difficulty:
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

    def joints(self, layout: ArcLayout, pieces: IntArray) -> FloatArray:
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
        # The outermost arcs, shorter by `END`, deviate as much as the others: they count as longer.
        stress = np.ones(len(layout.left))
        stress[layout.first_arcs] = (1.0 - END) ** -3.0
        stress[layout.first_arcs + layout.counts - 1] = (1.0 - END) ** -3.0
        left, right = layout.left, layout.left + 1
        for _ in range(EQUALISING_ROUNDS):
            # An arc of length h deviates by a constant times h^2 and the integral of |dkappa|.
            turns = np.interp(places, self.places, self.turns)
            lengths = np.interp(places, self.places, self.lengths)
            deviations = (turns[right] - turns[left]) * (lengths[right] - lengths[left]) ** 2
            places = move_joints(layout, places, ALONE * layout.excess(stress * deviations))
        return places

    def angles(self, layout: ArcLayout, pieces: IntArray, places: FloatArray) -> FloatArray:
        """(j,) cam angles [rad] of `places` (j,), see `joints`."""
        part = places - 2.0 * layout.of_joints(pieces)
        starts, spans = layout.of_joints(self.starts[pieces]), layout.of_joints(self.spans[pieces])
        return np.asarray(starts + spans * part)


def move_joints(layout: ArcLayout, places: FloatArray, shrink: FloatArray) -> FloatArray:
    """Places (j,) of joints, moved from `places` so that each arc's share of its spline shrinks by
    the factor exp(shrink), shrink (n,), as against the others.
    """
    share = np.exp(shrink)
    share *= (layout.counts / np.bincount(layout.spline, weights=share))[layout.spline]
    # The shares of a spline add up to its arcs, so joint i of the batch belongs at i.
    cumulative = np.zeros(len(places))
    cumulative[layout.left + 1] = share
    cumulative = np.cumsum(cumulative) + layout.of_joints(np.arange(len(layout.first)))
    moved = np.interp(np.arange(len(places), dtype=np.float64), cumulative, places)
    moved[layout.first], moved[layout.last] = places[layout.first], places[layout.last]
    return moved


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

    layout: ArcLayout
    cells: IntArray

    @classmethod
    def from_layout(cls, layout: ArcLayout) -> ArcSystem:
        """The equations of `layout`: where coefficients stand. Their values come with `solve`."""
        size = 3 * (int(layout.last[-1]) + 1)
        # Offset and turn of the joint on the left, then of that on the right.
        joint_unknowns = 3 * layout.left[:, None] + np.array([0, 1, 3, 4])
        bond = np.broadcast_to(3 * layout.left[:, None] + 2, joint_unknowns.shape)
        blocks = (len(joint_unknowns), 4, 4)
        rows = np.broadcast_to(joint_unknowns[:, :, None], blocks)
        columns = np.broadcast_to(joint_unknowns[:, None, :], blocks)
        diagonal = np.arange(size)

        def cell(row: IntArray, column: IntArray) -> IntArray:
            # Row BAND + i - j, column j of the banded storage, flattened.
            return ((BAND + row - column) * size + column).ravel()

        cells = (
            cell(rows, columns),
            cell(joint_unknowns, bond),
            cell(bond, joint_unknowns),
            cell(diagonal, diagonal),
        )
        return cls(layout, np.concatenate(cells))

    def solve(
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
        # An unknown that is not free gets the equation x = 0, and so does an unused multiplier.
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
