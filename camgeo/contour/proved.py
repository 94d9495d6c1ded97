"""Fits that are proved before they are returned.

The smooth pieces of one curve are a group, so that they share the cost of a call.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import TypeVar

import numpy as np

from camgeo.contour.chain import Chain, Run, contour_of, runs_of
from camgeo.contour.contour import Fit
from camgeo.contour.joints import torn_apart
from camgeo.contour.legs import Leg, StretchLeg, TurnLeg, legs_of
from camgeo.contour.proof.deviation import SHARPNESS, proved_bound
from camgeo.curve.pieces import Piece
from camgeo.curve.working_curve import WorkingCurve
from camgeo.errors import GeometryError, ToleranceError
from camgeo.outline.path import Path

AIM = 0.985
"""Fraction of the tolerance that the sampled distance of a fast fit may reach; the rest is for the
proof."""


Group = Callable[[float, float], Sequence[Chain]]
"""Fits the smooth pieces of one curve: aim and tolerance [mm] -> a chain for each of them within
the aim; the tolerance is for messages."""


def fit_by_groups(
    make: Callable[[WorkingCurve, list[Piece]], Group], tolerance: float
) -> FitPieces:
    """The fit of `camgeo.contour.proved.proved_fit`, group by group.

    `make` makes a group from a curve and its pieces, only once however often the aim is lowered.
    """
    groups: list[tuple[Group, list[int]]] = []

    def fit_pieces(pieces: Sequence[PieceOfLeg], aim: float) -> list[Chain]:
        if not groups:
            for curve, places in by_curve(pieces):
                groups.append((make(curve, [pieces[k][1] for k in places]), places))
        found: dict[int, Chain] = {}
        for group, places in groups:
            found.update(zip(places, group(aim, tolerance), strict=True))
        return [found[k] for k in range(len(pieces))]

    return fit_pieces


def by_curve(pieces: Sequence[PieceOfLeg]) -> list[tuple[WorkingCurve, list[int]]]:
    """The curves that the pieces belong to, each with the numbers of its pieces."""
    shared: dict[tuple[int, float], list[int]] = {}
    for number, (leg, _) in enumerate(pieces):
        shared.setdefault((id(leg.curve.pitch), leg.curve.distance), []).append(number)
    return [(pieces[numbers[0]][0].curve, numbers) for numbers in shared.values()]


ROUNDS = 6
"""Most fits; the second is within the tolerance wherever double precision allows."""

HELPS = 0.9
"""A deviation of more than twice the tolerance must fall below this fraction of it in the next
round, which aims at less than half; otherwise a smaller aim does not help, because the curve has a
step between cam angles that can hardly be told apart."""

EASE = 0.95
"""Factor beyond the excess by which the aim is lowered for the next round."""

FINER = 0.125
"""Fraction of the aim to try next where the pieces are too coarse for a proof, which limits how far
they turn, round the tip of a lobe. Arcs become half as long."""

SLIGHT = 0.01
"""An arc of a turn shorter than this fraction of the tolerance is a corner: files rounded to a
tenth of the tolerance, as programs do, could not keep its ends distinct."""

PieceOfLeg = tuple[StretchLeg, Piece]

FitPieces = Callable[[Sequence[PieceOfLeg], float], Sequence[Chain]]
FitTurn = Callable[[TurnLeg, float], Chain]
Made = TypeVar("Made")


def proved_fit(
    path: Path, tolerance: float, aim: float, fit_pieces: FitPieces, fit_turn: FitTurn
) -> Fit:
    """Fit each smooth piece of `path`, prove the whole, and aim lower until the proof holds.

    Parameters
    ----------
    tolerance : that the proved deviation must not exceed [mm].
    aim : deviation that the first round aims at [mm].
    fit_pieces : all smooth pieces, each with its stretch, aim [mm] -> a chain each. They are passed
        together so that a fit can share the cost of a call between them.
    fit_turn : arc between two stretches, aim [mm] -> its chain.

    Raises
    ------
    ToleranceError
        If the tolerance cannot be reached in double precision.
    GeometryError
        If the contour cannot be compared with the path, or the path has a gap.
    """
    prove = partial(proved_bound, enough=SHARPNESS * tolerance)
    runs, reached = proved(fitted(path, tolerance, fit_pieces, fit_turn), prove, aim, tolerance)
    return Fit(contour_of(runs).counter_clockwise(), reached, tolerance)


def fitted(
    path: Path, tolerance: float, fit_pieces: FitPieces, fit_turn: FitTurn
) -> Callable[[float], tuple[Run, ...]]:
    """What `proved_fit` proves: the fit of `path` for an aim [mm], whose distance has been sampled.

    Raises GeometryError if the path has a gap.
    """
    legs = legs_of(path)
    stretches = [leg for leg in legs if isinstance(leg, StretchLeg)]
    _require_joined(stretches, tolerance)
    pieces = [(leg, piece) for leg in stretches for piece in leg.pieces]

    def fit(aim: float) -> tuple[Run, ...]:
        chains = iter(fit_pieces(pieces, aim))
        parts: list[tuple[Leg, list[Chain]]] = []
        for leg in legs:
            if isinstance(leg, StretchLeg):
                parts.append((leg, [next(chains) for _ in leg.pieces]))
            elif leg.length <= SLIGHT * tolerance:
                parts.append((leg, [Chain.empty()]))
            else:
                parts.append((leg, [fit_turn(leg, aim)]))
        return runs_of(parts)

    return fit


def proved(
    fit: Callable[[float], Made], prove: Callable[[Made], float], aim: float, tolerance: float
) -> tuple[Made, float]:
    """The result of `fit` for an aim [mm], `aim` or the first lower one whose deviation according
    to `prove` is at most `tolerance`; and that deviation [mm].

    Raises what `prove` raised last, ToleranceError if the deviation stays too large, and whatever
    `fit` raises.
    """
    reached, before, failed = 0.0, math.inf, None
    for number in range(ROUNDS):
        try:
            made = fit(aim)
        except ToleranceError:
            if number:  # of a lower aim: what matters is what the proof said of the one before
                break
            raise
        try:
            reached, failed = prove(made), None
        except GeometryError as error:  # too coarse to follow the curve
            failed = error
            aim *= FINER
            continue
        if reached <= tolerance:
            return made, reached
        if reached > HELPS * before and before > 2.0 * tolerance:
            break
        before = reached
        aim *= EASE * tolerance / reached
    if failed is not None:
        raise failed
    raise ToleranceError("the pieces of the contour cannot follow the curve", tolerance, reached)


def _require_joined(legs: Sequence[StretchLeg], tolerance: float) -> None:
    """A parallel is torn apart where the follower's velocity jumps: there it is no single leg.

    No contour could be proved across such a gap.
    """
    for leg in legs:
        starts = [piece.start for piece in leg.pieces if leg.closed or piece.start > leg.start]
        inner = np.array(starts)
        gaps = np.abs(leg.point(inner) - leg.point(inner, "left")) if len(inner) else inner
        if np.any(gaps > tolerance):
            raise torn_apart(float(inner[int(np.argmax(gaps))]))
