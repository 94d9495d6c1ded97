"""Fit by straight pieces: chords between points of the curve.

A chord over a span h of arc length is off the curve by (|kappa| + c |kappa'| h) h^2 / 8. The second
term matters where the curve has an inflection: a span of kappa' s that begins there is off by more
than its mean curvature implies.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from camgeo.geometry.contour.contour import Contour, Fit
from camgeo.geometry.contour.legs import (
    CROWDED,
    Bends,
    Chain,
    TurnLeg,
    closed_contour,
    least_counts,
    sample_bends,
    separate_joints,
    too_many_error,
)
from camgeo.geometry.contour.proof import (
    AIM,
    Group,
    fit_by_groups,
    path_fit,
    proved_fit,
)
from camgeo.geometry.contour.spline import highest
from camgeo.geometry.outline.path import Path
from camgeo.geometry.pieces import SmoothPiece
from camgeo.geometry.pitch_curve import WorkingCurve
from camgeo.numeric.arrays import ComplexArray, FloatArray

SLOPE = 0.06
"""c: with this value the span from an inflection has its full length, 1/(9 sqrt(3)) of kappa' h^3
off."""

MOST_TURN = 0.4
"""The curve turns by at most this angle [rad] along a chord, however small its sagitta: the proof
needs both to run the same way."""

HALF_ROUND = 2.0
"""A piece of a larger span [rad] has at least four chords: none goes round more than a quarter."""

STEPS = 12
"""Steps of the search for the error of a number of chords."""

CLOSE = 1.01
"""The search ends this close to the requested number of chords."""

MOST_CELLS = 1 << 20
"""A piece with this many cells is not refined further: more chords share its cells evenly."""

FLOOR = 0.005
"""Smallest density of chords, as a fraction of the piece's mean: every stretch gets chords."""


class ChordDensity:
    """Chords along one smooth piece.

    Over the cam angle the density of chords is delta with delta^2 = (a + b / delta) / (8 error),
    a = |kappa| pace^2 and b = c |kappa'| pace^3, finite at a cusp too.
    """

    def __init__(self, piece: SmoothPiece, bends: Bends) -> None:
        self._piece, self._bends = piece, bends
        self._finer: ChordDensity | None = None
        self._width = (piece.end - piece.start) / len(bends.speed)
        regular = np.maximum(bends.regularity, 0.0)
        self._bend = np.abs(bends.curvature) * bends.speed * bends.speed * regular
        # kappa' = dkappa/dphi / (|Z'| regular^3), and pace = |Z'| regular.
        self._slope = SLOPE * np.abs(bends.slope) * bends.speed * bends.speed
        self._turn = np.abs(bends.curvature) * bends.speed / MOST_TURN
        self._total = self._width * float(np.sum(np.sqrt(0.125 * self._bend)))

    def count(self, aim: float) -> float:
        """Estimate of the number of chords needed for `aim` [mm]; not a whole number."""
        expected = self._width * float(np.sum(self._density(aim)))
        least = 4.0 if self._piece.end - self._piece.start > HALF_ROUND else 1.0
        return max(least, expected)

    def joints(self, count: int) -> FloatArray:
        """(count + 1,) cam angles [rad] of the ends of `count` parts, both outer ones included."""
        if len(self._bends.speed) // 2 < min(count, MOST_CELLS // 2):
            if self._finer is None:
                self._finer = ChordDensity(self._piece, self._bends.refined())
            return self._finer.joints(count)
        # From the error that a curve of constant curvature would have, adjusted until the number of
        # chords is about the requested one.
        error = (self._total / count) ** 2
        for _ in range(STEPS):
            density = self._density(error)
            excess = self._width * float(np.sum(density)) / count
            if excess <= CLOSE:
                break
            # The number of chords falls with the square root of the error.
            error *= excess * excess
        return self._shared(density, count)

    def _shared(self, density: FloatArray, count: int) -> FloatArray:
        """Joints between which a density (n,) in the middle of n equal cells has equal sums."""
        phi = np.linspace(self._piece.start, self._piece.end, len(density) + 1)
        cells = density * np.diff(phi)
        floored = cells + FLOOR * float(np.sum(cells)) / len(cells)
        share = np.concatenate(([0.0], np.cumsum(floored)))
        if share[-1] > 0.0:
            share /= share[-1]
        else:  # a straight line has no difficulty anywhere
            share = np.linspace(0.0, 1.0, len(phi))
        joints = np.interp(np.linspace(0.0, 1.0, count + 1), share, phi)
        joints[0], joints[-1] = phi[0], phi[-1]
        return joints

    def _density(self, error: float) -> FloatArray:
        if error <= 0.0:
            return np.maximum(np.sqrt(self._bend), self._turn)
        bend, slope = self._bend / (8.0 * error), self._slope / (8.0 * error)
        # Fixed-point steps of density^2 = bend + slope / density, from the larger term alone.
        density = np.maximum(np.sqrt(bend), np.cbrt(slope))
        floor = np.finfo(float).tiny
        for _ in range(2):
            density = np.sqrt(bend + slope / np.maximum(density, floor))
        return np.maximum(density, self._turn)


PARTS = 2
"""Places per chord at which its distance is sampled: its start and half way."""

ORDER = 2.0
"""Power of the number of chords with which the distance decreases."""

MAX_CHORDS = 500_000
"""Most chords of the smooth pieces of a curve: more than any file that is read again has."""


def fit_polyline(path: Path, tolerance: float) -> Fit:
    """Chords within `tolerance` [mm] of `path`, counter-clockwise, vertices on the path.

    A chord of length h lies kappa h^2/8 off its arc, so chords that divide the integral of
    sqrt(kappa / (8 tolerance)) ds evenly are the fewest with both ends on the curve. Breaks and
    corners are vertices.

    Raises
    ------
    UndercutError
        If the path is not regular.
    ToleranceError
        If the tolerance cannot be reached in double precision.
    GeometryError
        If the contour cannot be compared with the path.
    """
    fit_turn = partial(_arc_chords, tolerance=tolerance)
    fit_pieces = fit_by_groups(_group, tolerance)
    return proved_fit(path, tolerance, AIM * tolerance, fit_pieces, fit_turn)


def sampled_polyline(path: Path, tolerance: float) -> Contour:
    """The chords from which `fit_polyline` starts, for pictures: at `PARTS` places of each chord
    the path is within `tolerance` [mm] of it. Nothing is proved, as a proof takes longer than the
    fit.

    Raises
    ------
    ToleranceError
        If the tolerance cannot be reached in double precision.
    GeometryError
        If the path has a gap.
    """
    fit_turn = partial(_arc_chords, tolerance=tolerance)
    fit = path_fit(path, tolerance, fit_by_groups(_group, tolerance), fit_turn)
    return closed_contour(fit(AIM * tolerance)).counter_clockwise()


@dataclass(frozen=True, slots=True, eq=False)
class _ChordGroup:
    """Smooth pieces of one curve, which share its evaluations.

    Attributes
    ----------
    curve : the curve of the pieces.
    densities, ends, end_rates : of each piece, its last point [mm] and dP/dphi there [mm/rad].
    """

    curve: WorkingCurve
    densities: tuple[ChordDensity, ...]
    ends: ComplexArray
    end_rates: ComplexArray

    def fit(self, aim: float, tolerance: float) -> list[Chain]:
        """A chain for each of the pieces."""
        expected = np.array([density.count(aim) for density in self.densities])
        if np.sum(expected) > MAX_CHORDS:
            raise too_many_error(MAX_CHORDS, "straight pieces", tolerance)
        return least_counts(self._trials, expected, aim, tolerance, order=ORDER, most=MAX_CHORDS)

    def _trials(self, wanted: Sequence[tuple[int, int]]) -> list[tuple[Chain, float]]:
        joints = [self.densities[piece].joints(count) for piece, count in wanted]
        trials, steps = self._chords([piece for piece, _ in wanted], joints)
        # Places crowd only next to a cusp; there joints that cannot be told apart are dropped.
        crowded = [
            k
            for k, (chain, _) in enumerate(trials)
            if PARTS * steps[k] < CROWDED * np.max(np.abs(chain.vertices))
        ]
        if crowded:
            separated = [separate_joints(self.curve, joints[k]) for k in crowded]
            again, _ = self._chords([wanted[k][0] for k in crowded], separated)
            for k, trial in zip(crowded, again, strict=True):
                trials[k] = trial
        return trials

    def _chords(
        self, pieces: Sequence[int], joints: list[FloatArray]
    ) -> tuple[list[tuple[Chain, float]], list[float]]:
        """Chords along each piece, their largest distance found, and the smallest step [mm]."""
        steps = np.concatenate([np.diff(piece_joints) for piece_joints in joints]) / PARTS
        starts = np.concatenate([piece_joints[:-1] for piece_joints in joints])
        phi = starts[:, None] + steps[:, None] * np.arange(PARTS)
        places, tangents, pace = self.curve.traced(phi.ravel())
        stops = np.cumsum([len(piece_joints) - 1 for piece_joints in joints])
        points, rates = np.empty((2, len(starts), PARTS + 1), dtype=np.complex128)
        for whole, part, ends in (
            (points, places, self.ends), (rates, tangents * pace, self.end_rates)
        ):  # fmt: skip
            whole[:, :-1] = part.reshape(phi.shape)
            # A chord ends where the next one starts; the last of a piece ends in its left-hand
            # value.
            whole[:-1, -1] = whole[1:, 0]
            whole[stops - 1, -1] = ends[list(pieces)]
        chord = points[:, -1] - points[:, 0]
        # Next to a cusp two joints may be one point; they are too near to each other to be kept.
        chord[chord == 0.0] = 1.0
        # In the axes of its chord a point's imaginary part is its distance from it.
        back = np.conj(chord / np.abs(chord))[:, None]
        offsets = (back * (points - points[:, :1])).imag
        growth = (back * rates).imag * steps[:, None]
        peaks = highest(offsets[:, :-1], offsets[:, 1:], growth[:, :-1], growth[:, 1:])
        distances = np.maximum(np.max(peaks, axis=1), np.max(np.abs(offsets), axis=1))
        least = np.min(np.abs(np.diff(points, axis=1)), axis=1)
        trials, shortest = [], []
        for first, stop in zip(np.append(0, stops[:-1]), stops, strict=True):
            chord_range = slice(int(first), int(stop))
            chain = Chain.straight(starts[chord_range], points[chord_range, 0])
            trials.append((chain, float(np.max(distances[chord_range]))))
            shortest.append(float(np.min(least[chord_range])))
        return trials, shortest


def _group(curve: WorkingCurve, pieces: list[SmoothPiece]) -> Group:
    bends = sample_bends(curve, pieces)
    points, tangents, pace = curve.traced(np.array([piece.end for piece in pieces]), "left")
    densities = tuple(ChordDensity(*pair) for pair in zip(pieces, bends, strict=True))
    return _ChordGroup(curve, densities, points, tangents * pace).fit


def _arc_chords(leg: TurnLeg, aim: float, tolerance: float) -> Chain:
    # A chord that spans the angle s leaves the sagitta r s^2 / 8.
    longest = min(math.sqrt(8.0 * aim / leg.radius), MOST_TURN)
    count = max(1, math.ceil(leg.end / longest))
    if count > MAX_CHORDS:
        raise too_many_error(MAX_CHORDS, "straight pieces", tolerance)
    angles = np.linspace(0.0, leg.end, count + 1)[:-1]
    return Chain.straight(angles, leg.point(angles))
