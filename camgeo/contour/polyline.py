"""Fit by straight pieces: chords between points of the curve."""

from __future__ import annotations

import math

import numpy as np

from camgeo.contour.arcs import require_regular
from camgeo.contour.chain import Chain
from camgeo.contour.fit import Fit
from camgeo.contour.proved import proved_fit
from camgeo.contour.spread import Spread
from camgeo.curve.pieces import Piece
from camgeo.curve.working_curve import WorkingCurve
from camgeo.errors import ToleranceError
from camgeo.numeric.arrays import FloatArray

MAX_CHORDS = 2_000_000
"""Chords a smooth piece at most."""


def fit_polyline(curve: WorkingCurve, tolerance: float) -> Fit:
    """Chords within `tolerance` [mm] of `curve`, counter-clockwise, vertices on the curve.

    A chord of length h lies kappa h^2/8 off its arc, so chords that share out the integral of
    sqrt(kappa / (8 tolerance)) ds evenly are as few as chords with both ends on the curve can be.
    Breaks are vertices.

    Raises
    ------
    UndercutError
        If the curve is not regular.
    ToleranceError
        If the tolerance cannot be reached in double precision.
    """

    def fit_piece(piece: Piece, aim: float) -> Chain:
        return _chords(curve, piece, aim, tolerance)

    return proved_fit(curve, tolerance, tolerance, fit_piece)


def _chords(curve: WorkingCurve, piece: Piece, aim: float, tolerance: float) -> Chain:
    require_regular(curve, piece)

    def density(phi: FloatArray) -> FloatArray:
        return np.sqrt(np.abs(curve.curvature(phi))) * curve.pace(phi)

    spread = Spread(piece, density)
    count = max(1, math.ceil(spread.total / math.sqrt(8.0 * aim)))
    if piece.end - piece.start > 2.0:
        count = max(count, 4)  # no chord goes more than a quarter round the cam
    if count > MAX_CHORDS:
        raise ToleranceError(
            f"more than {MAX_CHORDS:,} straight pieces would be needed", tolerance, math.inf
        )
    joints = spread.joints(count)
    zero = np.zeros(count)
    return Chain(joints[:-1], curve.point(joints)[:-1], zero, zero.astype(np.complex128))
