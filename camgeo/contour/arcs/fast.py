"""Fit by lines and G1 arcs: biarcs between points of the curve.

Their joints are spread by the law of their distance from it, corrected once by what was found.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from camgeo.contour.arcs.biarcs import FLAT as FLAT
from camgeo.contour.arcs.biarcs import PARTS, Biarcs, Ends
from camgeo.contour.arcs.density import ArcDensity, Found
from camgeo.contour.chain import Chain
from camgeo.contour.counts import Trials
from camgeo.contour.fit import Fit
from camgeo.contour.groups import AIM, fit_by_groups
from camgeo.contour.joints import CROWDED, joints_apart
from camgeo.contour.legs import TurnLeg
from camgeo.contour.proved import proved_fit
from camgeo.contour.spread import bends_of
from camgeo.curve.pieces import Piece
from camgeo.curve.working_curve import WorkingCurve
from camgeo.numeric.arrays import FloatArray
from camgeo.outline.path import Path

ORDER = 3.0
"""Power of the number of arcs with which the distance falls."""

TOGETHER = 16
"""Spans that are tried at once for one piece: a call for more costs as much as another."""

HALVINGS = 8
"""Rounds of halving at most."""

MAX_ARCS = 200_000
"""Arcs a smooth piece at most; more is a tolerance beyond the arithmetic."""


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
    densities, ends : of the pieces that are no rests.
    rests : of the others.
    """

    curve: WorkingCurve
    pieces: tuple[Piece, ...]
    densities: tuple[ArcDensity, ...]
    ends: tuple[Ends, ...]
    rests: tuple[Chain, ...]

    def fit(self, aim: float, tolerance: float) -> list[Chain]:
        """A chain for each of the pieces."""
        expected = np.array([density.count(aim) for density in self.densities])
        search = Trials(self._trials, ORDER, MAX_ARCS // 2, TOGETHER)
        curved = iter(search.least(expected, aim, tolerance))
        rests = iter(self.rests)
        return [next(rests) if piece.dwell else next(curved).chain() for piece in self.pieces]

    def _trials(self, wanted: Sequence[tuple[int, int]]) -> list[tuple[Biarcs, float]]:
        joints = [self.densities[piece].joints(count) for piece, count in wanted]
        ends = [self.ends[piece] for piece, _ in wanted]
        made = _sound_biarcs(self.curve, joints, ends)
        again = [
            self.densities[piece].joints(count, Found.of(used, biarcs.distances))
            for (piece, count), (biarcs, used) in zip(wanted, made, strict=True)
        ]
        both = zip(made, _sound_biarcs(self.curve, again, ends), strict=True)
        found = [(biarcs, float(np.max(biarcs.distances))) for pair in both for biarcs, _ in pair]
        return [min(pair, key=_distance) for pair in zip(found[::2], found[1::2], strict=True)]


def _distance(found: tuple[Biarcs, float]) -> float:
    return found[1]


def _group(curve: WorkingCurve, pieces: list[Piece]) -> _Group:
    densities, stops = [], []
    for piece, bends in zip(pieces, bends_of(curve, pieces), strict=True):
        if not piece.dwell:
            densities.append(ArcDensity(piece, bends))
            stops.append(piece.end)
    ends = zip(*curve.traced(np.array(stops), "left"), strict=True) if stops else ()
    of_curved = tuple(densities), tuple(Ends(*end) for end in ends)
    return _Group(curve, tuple(pieces), *of_curved, rest_arcs(curve, pieces))


def rest_arcs(curve: WorkingCurve, pieces: Sequence[Piece]) -> tuple[Chain, ...]:
    """The one arc about the cam axis that each rest among `pieces` is."""
    rests = [piece for piece in pieces if piece.dwell]
    if not rests:
        return ()
    points = curve.point(np.array([piece.start for piece in rests]))
    turn = -curve.pitch.rotation
    return tuple(
        Chain.arc(piece.start, point, turn * (piece.end - piece.start), 0j)
        for piece, point in zip(rests, points, strict=True)
    )


def _sound_biarcs(
    curve: WorkingCurve, joints: list[FloatArray], ends: list[Ends]
) -> list[tuple[Biarcs, FloatArray]]:
    """Biarcs whose arcs have a parallel on the pitch curve, see `camgeo.contour.proof.deviation`,
    each with their joints.

    Beside a cusp the curvature may grow so fast between two joints that the second arc has to turn
    back, with less than the roller's radius: such spans are halved.
    """
    found = _biarcs(curve, joints, ends)
    for _ in range(HALVINGS):
        again = []
        for k, biarcs in enumerate(found):
            bad = biarcs.turned_over(curve)
            crowded = np.min(biarcs.least_step) * PARTS < CROWDED * np.max(np.abs(biarcs.ends))
            if not np.any(bad) and not crowded:
                continue
            spans = np.flatnonzero(bad)
            halves = 0.5 * (joints[k][spans] + joints[k][spans + 1])
            apart = joints_apart(curve, np.insert(joints[k], spans + 1, halves))
            if not np.array_equal(apart, joints[k]):
                joints[k] = apart
                again.append(k)
        if not again:
            break
        more = _biarcs(curve, [joints[k] for k in again], [ends[k] for k in again])
        for k, biarcs in zip(again, more, strict=True):
            found[k] = biarcs
    return list(zip(found, joints, strict=True))


def _biarcs(curve: WorkingCurve, joints: list[FloatArray], ends: list[Ends]) -> list[Biarcs]:
    stops = np.cumsum([len(each) for each in joints]) - 1
    biarcs = Biarcs.along(curve, np.concatenate(joints), stops, ends)
    last = stops - np.arange(len(joints))
    first = np.concatenate(([0], last[:-1]))
    return [biarcs.take(slice(int(a), int(b))) for a, b in zip(first, last, strict=True)]
