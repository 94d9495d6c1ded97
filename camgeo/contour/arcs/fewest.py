"""Fit by lines and G1 arcs with the fewest pieces, then the least deviation for their number."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from camgeo.contour.arcs.arc_splines import ArcSpline, arc_splines
from camgeo.contour.arcs.course import Strands
from camgeo.contour.arcs.fast import dwell_arc, fit_arcs, turn_arc
from camgeo.contour.chain import Chain
from camgeo.contour.fit import Fit
from camgeo.contour.groups import by_curve
from camgeo.contour.least_pieces import ARC
from camgeo.contour.proved import PieceOfLeg, proved_fit
from camgeo.contour.spread import bends_of
from camgeo.errors import GeometryError, ToleranceError
from camgeo.outline.path import Path

AIM = 0.988
"""Share of the tolerance that the sampled deviation may reach: the proof takes 1 % more, and
samples miss 0.15 % at most."""

TRIALS = 4
"""Numbers of arcs that are tried at once for a piece: mostly one of them will do."""

ATTEMPTS = 8
"""Times that as many numbers are tried; biarcs, with half as many arcs again, end the search."""

ALL_NUMBERS = 7
"""All numbers of arcs up to 2^7 are tried, even ones up to 2^8, and so on: for a hundredth of the
arcs there is no end of trials."""

FINEST = 2.0**-52 * 2.0**10
"""Below this share of the distance from the cam axis it is rounding that decides about deviations:
there, no number of arcs is better than another."""


def fewest_arcs(path: Path, tolerance: float) -> Fit:
    """Lines and G1 arcs within `tolerance` [mm] of `path`, as few as there can be.

    Each smooth piece has the smallest number of arcs that was found to follow it, laid so that they
    deviate alike. The tolerance does not enter into how a number of arcs is laid, so that a wider
    one never asks for more. Dwells, turns and corners as of `fit_arcs`; where that fit has no more
    pieces, it is taken.

    Raises
    ------
    UndercutError
        If the path is not regular.
    ToleranceError
        If the tolerance cannot be reached in double precision.
    GeometryError
        If the contour cannot be compared with the path.
    """
    search = _Search()
    try:
        fit = proved_fit(path, tolerance, AIM * tolerance, search.chains, turn_arc)
    except (ToleranceError, GeometryError, np.linalg.LinAlgError):
        return fit_arcs(path, tolerance)
    if not search.missed:
        return fit
    fast = fit_arcs(path, tolerance)
    return fast if len(fast.contour) < len(fit.contour) else fit


class _Search:
    """The fewest arcs for the smooth pieces of a path, each number tried once.

    Attributes
    ----------
    missed : True once a number of arcs came to nothing: there, another method may do better.
    """

    def __init__(self) -> None:
        self.missed = False
        self._groups: list[_Group] = []
        self._dwells: dict[int, Chain] = {}

    def chains(self, pieces: Sequence[PieceOfLeg], aim: float) -> list[Chain]:
        """A chain for each of `pieces`, always the same ones; `aim` [mm] for the sampled deviation.

        Raises
        ------
        UndercutError
            If a piece is not regular.
        ToleranceError
            If no number of arcs was found to be enough for a piece.
        """
        if not self._groups and not self._dwells:
            self._sort(pieces)
        found = dict(self._dwells)
        for group in self._groups:
            for place, spline in zip(group.places, group.least(aim), strict=True):
                found[place] = spline.chain()
            self.missed = self.missed or group.missed
        return [found[place] for place in range(len(pieces))]

    def _sort(self, pieces: Sequence[PieceOfLeg]) -> None:
        for curve, places in by_curve(pieces):
            bends = bends_of(curve, [pieces[k][1] for k in places])
            curved = [i for i, k in enumerate(places) if not pieces[k][1].dwell]
            for k in places:
                if pieces[k][1].dwell:
                    self._dwells[k] = dwell_arc(curve, pieces[k][1])
            if curved:
                own = [places[i] for i in curved]
                strands = Strands.of(curve, [pieces[k][1] for k in own], [bends[i] for i in curved])
                self._groups.append(_Group(own, strands))


class _Group:
    """The pieces of one parallel, at `places` in the order of the path."""

    def __init__(self, places: list[int], strands: Strands) -> None:
        self.places = places
        self.missed = False
        self._strands = strands
        self._known: dict[tuple[int, int], ArcSpline] = {}

    def least(self, aim: float) -> list[ArcSpline]:
        """For each piece the spline of the fewest arcs that deviate by at most `aim` [mm]."""
        if aim <= FINEST * float(np.max(np.abs(self._strands.points))):
            raise ToleranceError("arcs cannot be told from the curve", aim, math.inf)
        limits = self._strands.difficulty.totals * (ARC / aim) ** (1.0 / 3.0)
        ladders = [_numbers(int(limit)) for limit in limits]
        found: dict[int, ArcSpline] = {}
        for attempt in range(ATTEMPTS):
            rungs = slice(attempt * TRIALS, (attempt + 1) * TRIALS)
            tries = [
                (piece, number)
                for piece, ladder in enumerate(ladders)
                if piece not in found
                for number in ladder[rungs]
            ]
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
            # One arc is G1 at both ends by chance alone.
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
