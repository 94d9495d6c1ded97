"""Fit by lines and G1 arcs with the fewest pieces, then the least deviation for their number."""

from __future__ import annotations

import math

import numpy as np

from camgeo.contour.arcs.arc_splines import ArcSpline, Strands, arc_splines
from camgeo.contour.arcs.fast import fit_arcs, rest_arcs, turn_arc
from camgeo.contour.chain import Chain
from camgeo.contour.contour import Fit
from camgeo.contour.joints import bends_of
from camgeo.contour.least_pieces import ARC
from camgeo.contour.proved import Group, fit_by_groups, proved_fit
from camgeo.curve.pieces import Piece
from camgeo.curve.working_curve import WorkingCurve
from camgeo.errors import GeometryError, ToleranceError
from camgeo.outline.path import Path

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
