"""Fit by straight pieces: chords between points of the curve."""

from __future__ import annotations

import math

import numpy as np

from camgeo.contour.chain import Chain
from camgeo.contour.fit import Fit
from camgeo.contour.joints import joints_apart, require_regular
from camgeo.contour.legs import StretchLeg, TurnLeg
from camgeo.contour.proved import proved_fit
from camgeo.contour.spread import Spread
from camgeo.curve.pieces import Piece
from camgeo.curve.working_curve import WorkingCurve
from camgeo.errors import ToleranceError
from camgeo.numeric.arrays import FloatArray
from camgeo.outline.path import Path

MAX_CHORDS = 2_000_000
"""Chords a smooth piece at most."""

MOST_TURN = 0.4
"""A chord's curve turns by at most this angle [rad], however small its sagitta: the proof wants the
two to run the same way."""


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

    def fit_piece(leg: StretchLeg, piece: Piece, aim: float) -> Chain:
        return _chords(leg.curve, piece, aim, tolerance)

    def fit_turn(leg: TurnLeg, aim: float) -> Chain:
        return _arc_chords(leg, aim, tolerance)

    return proved_fit(path, tolerance, tolerance, fit_piece, fit_turn)


def _chords(curve: WorkingCurve, piece: Piece, aim: float, tolerance: float) -> Chain:
    require_regular(curve, piece)
    share = 1.0 / math.sqrt(8.0 * aim)

    def density(phi: FloatArray) -> FloatArray:
        # sqrt(|kappa_d|) ds = sqrt(|kappa| (1 + d kappa)) |Z'| dphi is finite at a cusp too.
        kappa = np.abs(curve.pitch.curvature(phi))
        speed = curve.pitch.speed(curve.pitch.relative_jet(phi, order=1))
        regular = np.maximum(curve.regularity(phi), 0.0)
        speed *= np.maximum(share * np.sqrt(kappa * regular), kappa / MOST_TURN)
        return speed

    spread = Spread(piece, density)
    count = _checked(math.ceil(spread.total), tolerance)
    if piece.end - piece.start > 2.0:
        count = max(count, 4)  # no chord goes more than a quarter round the cam
    joints = joints_apart(curve, spread.joints(count))
    zero = np.zeros(len(joints) - 1)
    return Chain(joints[:-1], curve.point(joints)[:-1], zero, zero.astype(np.complex128))


def _arc_chords(leg: TurnLeg, aim: float, tolerance: float) -> Chain:
    longest = min(math.sqrt(8.0 * aim / leg.radius), MOST_TURN)
    count = _checked(math.ceil(leg.end / longest), tolerance)
    angles = np.linspace(0.0, leg.end, count + 1)[:-1]
    zero = np.zeros(count)
    return Chain(angles, leg.point(angles), zero, zero.astype(np.complex128))


def _checked(count: int, tolerance: float) -> int:
    if count > MAX_CHORDS:
        raise ToleranceError(
            f"more than {MAX_CHORDS:,} straight pieces would be needed", tolerance, math.inf
        )
    return max(count, 1)
