"""Fit by lines and G1 arcs: biarcs between points of the curve.

Their joints are placed by the law of their distance from it, corrected once by the distances found.
A biarc with turned tangents, see `camgeo.contour.arcs.biarcs`, over a span h of arc length is off
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

from camgeo.contour.arcs.biarcs import PARTS, Biarcs, Ends
from camgeo.contour.chain import Chain
from camgeo.contour.contour import Fit
from camgeo.contour.counts import least_counts
from camgeo.contour.decided import in_steps
from camgeo.contour.joints import CROWDED, Bends, bends_of, joints_apart
from camgeo.contour.legs import TurnLeg
from camgeo.contour.proved import AIM, Group, fit_by_groups, proved_fit
from camgeo.curve.pieces import Piece
from camgeo.curve.working_curve import WorkingCurve
from camgeo.numeric.arrays import FloatArray, taken
from camgeo.outline.path import Path

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
    parts: FloatArray = reached / reached[-1]
    return parts


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
    """Biarcs whose arcs have a parallel on the pitch curve, see `camgeo.contour.proof.deviation`,
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
