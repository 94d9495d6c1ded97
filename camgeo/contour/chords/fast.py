"""Fit by straight pieces: chords between points of the curve."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from camgeo.contour.chain import Chain
from camgeo.contour.chords.density import MOST_TURN, ChordDensity
from camgeo.contour.counts import Trials, too_many
from camgeo.contour.fit import Fit
from camgeo.contour.groups import AIM, fit_by_groups
from camgeo.contour.joints import CROWDED, joints_apart
from camgeo.contour.legs import TurnLeg
from camgeo.contour.peaks import highest
from camgeo.contour.proved import proved_fit
from camgeo.contour.spread import bends_of
from camgeo.curve.pieces import Piece
from camgeo.curve.working_curve import WorkingCurve
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.outline.path import Path

PARTS = 2
"""Places a chord at which its distance is looked for: where it starts and half way."""

ORDER = 2.0
"""Power of the number of chords with which the distance falls."""

MAX_CHORDS = 2_000_000
"""Chords a smooth piece at most."""


def fit_polyline(path: Path, tolerance: float) -> Fit:
    """Chords within `tolerance` [mm] of `path`, counter-clockwise, vertices on the path.

    A chord of length h lies kappa h^2/8 off its arc, so chords that share out the integral of
    sqrt(kappa / (8 tolerance)) ds evenly are as few as chords with both ends on the curve can be.
    Breaks and corners are vertices.

    Raises
    ------
    UndercutError
        If the path is not regular.
    ToleranceError
        If the tolerance cannot be reached in double precision.
    GeometryError
        If the contour cannot be compared with the path.
    """

    def fit_turn(leg: TurnLeg, aim: float) -> Chain:
        return _arc_chords(leg, aim, tolerance)

    fit_pieces = fit_by_groups(_group, tolerance)
    return proved_fit(path, tolerance, AIM * tolerance, fit_pieces, fit_turn)


@dataclass(frozen=True, slots=True, eq=False)
class _Group:
    """Smooth pieces of one curve, which share its evaluations.

    Attributes
    ----------
    curve : theirs.
    densities, ends, end_rates : of each piece, its last point [mm] and dP/dphi there [mm/rad].
    """

    curve: WorkingCurve
    densities: tuple[ChordDensity, ...]
    ends: ComplexArray
    end_rates: ComplexArray

    def fit(self, aim: float, tolerance: float) -> list[Chain]:
        """A chain for each of the pieces."""
        expected = np.array([density.count(aim) for density in self.densities])
        if np.max(expected) > MAX_CHORDS:
            raise too_many(MAX_CHORDS, "straight pieces", tolerance)
        return Trials(self._trials, ORDER, MAX_CHORDS).least(expected, aim, tolerance)

    def _trials(self, wanted: Sequence[tuple[int, int]]) -> list[tuple[Chain, float]]:
        joints = [self.densities[piece].joints(count) for piece, count in wanted]
        made, steps = self._chords([piece for piece, _ in wanted], joints)
        crowded = [
            k
            for k, (chain, _) in enumerate(made)
            if PARTS * steps[k] < CROWDED * np.max(np.abs(chain.vertices))
        ]
        if crowded:
            apart = [joints_apart(self.curve, joints[k]) for k in crowded]
            again, _ = self._chords([wanted[k][0] for k in crowded], apart)
            for k, found in zip(crowded, again, strict=True):
                made[k] = found
        return made

    def _chords(
        self, pieces: Sequence[int], joints: list[FloatArray]
    ) -> tuple[list[tuple[Chain, float]], list[float]]:
        """Chords along each piece, their largest distance found, and the smallest step [mm]."""
        steps = np.concatenate([np.diff(each) for each in joints]) / PARTS
        starts = np.concatenate([each[:-1] for each in joints])
        phi = starts[:, None] + steps[:, None] * np.arange(PARTS)
        places, tangents, pace = self.curve.traced(phi.ravel())
        stops = np.cumsum([len(each) - 1 for each in joints])
        points, rates = np.empty((2, len(starts), PARTS + 1), dtype=np.complex128)
        for whole, part, ends in (
            (points, places, self.ends), (rates, tangents * pace, self.end_rates)
        ):  # fmt: skip
            whole[:, :-1] = part.reshape(phi.shape)
            whole[:-1, -1] = whole[1:, 0]
            whole[stops - 1, -1] = ends[list(pieces)]
        chord = points[:, -1] - points[:, 0]
        back = np.conj(chord / np.abs(chord))[:, None]
        apart = (back * (points - points[:, :1])).imag
        growth = (back * rates).imag * steps[:, None]
        peaks = highest(apart[:, :-1], apart[:, 1:], growth[:, :-1], growth[:, 1:])
        distances = np.maximum(np.max(peaks, axis=1), np.max(np.abs(apart), axis=1))
        least = np.min(np.abs(np.diff(points, axis=1)), axis=1)
        made, shortest = [], []
        for first, stop in zip(np.append(0, stops[:-1]), stops, strict=True):
            own = slice(int(first), int(stop))
            chain = Chain.straight(starts[own], points[own, 0])
            made.append((chain, float(np.max(distances[own]))))
            shortest.append(float(np.min(least[own])))
        return made, shortest


def _group(curve: WorkingCurve, pieces: list[Piece]) -> _Group:
    bends = bends_of(curve, pieces)
    points, tangents, pace = curve.traced(np.array([piece.end for piece in pieces]), "left")
    densities = tuple(ChordDensity(*each) for each in zip(pieces, bends, strict=True))
    return _Group(curve, densities, points, tangents * pace)


def _arc_chords(leg: TurnLeg, aim: float, tolerance: float) -> Chain:
    longest = min(math.sqrt(8.0 * aim / leg.radius), MOST_TURN)
    count = max(1, math.ceil(leg.end / longest))
    if count > MAX_CHORDS:
        raise too_many(MAX_CHORDS, "straight pieces", tolerance)
    angles = np.linspace(0.0, leg.end, count + 1)[:-1]
    return Chain.straight(angles, leg.point(angles))
