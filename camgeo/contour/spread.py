"""Where the joints of a fit go: equal shares of the difficulty along each smooth piece."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from camgeo.contour.joints import check_regular
from camgeo.curve.pieces import Piece
from camgeo.curve.pitch_curve import curvature_slope
from camgeo.curve.working_curve import WorkingCurve
from camgeo.numeric.arrays import FloatArray

CELLS = 256
"""Cells of a piece over which `bends_of` samples a curve."""

FINER = 8
"""Cells into which one of `Bends` is divided for counts that are as large as theirs."""

RESTING = 4
"""Cells of a rest, which is the same everywhere."""


@dataclass(frozen=True, slots=True, eq=False)
class Bends:
    """How a parallel bends over a smooth piece, in the middle of equal cells of it.

    Attributes
    ----------
    speed : (n,) |Z'| [mm/rad] of the pitch curve.
    curvature, slope : (n,) kappa [1/mm] and dkappa/dphi [1/(mm rad)] of the pitch curve.
    regularity : (n,) 1 + d kappa.
    """

    speed: FloatArray
    curvature: FloatArray
    slope: FloatArray
    regularity: FloatArray

    def refined(self) -> Bends:
        """The same over `FINER` times as many cells, by linear interpolation.

        With their signs, as it is near a zero that a power of one is hardest to interpolate.
        """
        places = np.arange(-1.0, len(self.speed) + 1.0)
        fine = (np.arange(FINER * len(self.speed)) + 0.5) / FINER - 0.5

        def over(values: FloatArray) -> FloatArray:
            before, after = 2.0 * values[0] - values[1], 2.0 * values[-1] - values[-2]
            return np.interp(fine, places, np.concatenate(([before], values, [after])))

        return Bends(*map(over, (self.speed, self.curvature, self.slope, self.regularity)))


def bends_of(curve: WorkingCurve, pieces: Sequence[Piece]) -> list[Bends]:
    """The bends of all `pieces` of a curve, from one evaluation.

    Raises
    ------
    UndercutError
        If a piece is not regular at a sample.
    GeometryError
        If the roller centre stands still at a sample.
    """
    counts = [RESTING if piece.dwell else CELLS for piece in pieces]
    phi = np.concatenate(
        [
            piece.start + (piece.end - piece.start) / count * (np.arange(count) + 0.5)
            for piece, count in zip(pieces, counts, strict=True)
        ]
    )
    pitch = curve.pitch
    jet = pitch.motion.jet(phi)
    speed = pitch.speed(pitch.follower.relative_jet(jet, pitch.rotation, 1))
    tangent = pitch.follower.tangent_jet(jet, pitch.rotation)
    slope = curvature_slope(tangent, pitch.rotation)
    (u, u1), (w, w1) = tangent.u, tangent.w
    against = (u * w1 - w * u1) / (speed * speed)
    kappa = (1.0 - pitch.rotation * (tangent.turning + against)) / speed
    whole = (speed, kappa, slope, 1.0 + curve.distance * kappa)
    stops = np.cumsum(counts)
    found = [
        Bends(*(part[stop - count : stop] for part in whole))
        for stop, count in zip(stops, counts, strict=True)
    ]
    for piece, bends in zip(pieces, found, strict=True):
        check_regular(curve, piece, bends.regularity)
    return found


def evenly_shared(piece: Piece, density: FloatArray, floor: float, count: int) -> FloatArray:
    """(count + 1,) cam angles [rad] of the ends of `count` parts, the piece's ends included.

    Parameters
    ----------
    density : (n,) of the parts, up to a factor, in the middle of n equal cells of the piece.
    floor : smallest density, as a share of its mean: no stretch goes without.
    """
    phi = np.linspace(piece.start, piece.end, len(density) + 1)
    cells = density * np.diff(phi)
    floored = cells + floor * float(np.sum(cells)) / len(cells)
    share = np.concatenate(([0.0], np.cumsum(floored)))
    if share[-1] > 0.0:
        share /= share[-1]
    else:  # a straight line has no difficulty anywhere
        share = np.linspace(0.0, 1.0, len(phi))
    joints = np.interp(np.linspace(0.0, 1.0, count + 1), share, phi)
    joints[0], joints[-1] = phi[0], phi[-1]
    return joints
