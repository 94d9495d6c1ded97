"""Fits that are proved before they are returned."""

from __future__ import annotations

from collections.abc import Callable

from camgeo.contour.chain import Chain, closed
from camgeo.contour.deviation import deviation
from camgeo.contour.fit import Fit
from camgeo.curve.pieces import Piece, smooth_pieces
from camgeo.curve.working_curve import WorkingCurve
from camgeo.errors import ToleranceError

ROUNDS = 6
"""Fits at most; the second is within the tolerance wherever double precision can be."""

EASE = 0.95
"""By how much more than the excess the aim is lowered for the next round."""


def proved_fit(
    curve: WorkingCurve, tolerance: float, aim: float, fit_piece: Callable[[Piece, float], Chain]
) -> Fit:
    """Fit each smooth piece of `curve`, prove the whole, and aim lower until the proof holds.

    Parameters
    ----------
    tolerance : that the proved deviation must not exceed [mm].
    aim : deviation that the first round aims at [mm].
    fit_piece : smooth piece, aim [mm] -> its chain.

    Raises
    ------
    ToleranceError
        If the tolerance cannot be reached in double precision.
    """
    reached = 0.0
    for _ in range(ROUNDS):
        contour, angles = closed([fit_piece(piece, aim) for piece in smooth_pieces(curve)])
        reached = deviation(curve, contour, angles)
        if reached <= tolerance:
            return Fit(contour.counter_clockwise(), reached, tolerance)
        aim *= EASE * tolerance / reached
    raise ToleranceError("the pieces of the contour cannot follow the curve", tolerance, reached)
