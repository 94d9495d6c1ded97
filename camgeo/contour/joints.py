"""Joints of a fit along a smooth piece of a curve: conditions on the piece, how it bends, and
joints that divide the difficulty evenly.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from camgeo.curve.pieces import Piece
from camgeo.curve.pitch_curve import curvature_slope
from camgeo.curve.working_curve import WorkingCurve
from camgeo.errors import GeometryError, UndercutError
from camgeo.numeric.arrays import FloatArray

CUSP = 1e-12
"""1 + d kappa within this of zero is a cusp at a single point: twenty times its rounding."""

APART = 2.0**-52 * 1e4
"""Smallest distance of two joints, as a fraction of their distance from the cam axis: the direction
from one to the next is still known to 1e-3 rad. Only next to a cusp does a curve move so little."""

CROWDED = 1e3 * APART
"""Joints with places between them nearer than this share of their distance from the cam axis are
looked at for `joints_apart`; a pace that changes thousandfold between two joints is that of a cusp.
"""


def require_regular(curve: WorkingCurve, piece: Piece) -> None:
    """Raise UndercutError if 1 + d kappa is negative at some sample of the piece.

    It may be zero at single points, at a cusp without undercut, but not over a whole dwell.
    """
    grid = np.linspace(piece.start, piece.end, 257)[1:-1]
    check_regular(curve, piece, curve.regularity(grid))


def check_regular(curve: WorkingCurve, piece: Piece, regularity: FloatArray) -> None:
    """`require_regular` where `regularity` (n,), 1 + d kappa at samples, is known already."""
    smallest = float(np.min(regularity))
    if smallest < -CUSP or (piece.is_arc and smallest <= CUSP):
        raise UndercutError(
            "the offset curve has a cusp or undercut between cam angles"
            f" {math.degrees(piece.start):.6g} and {math.degrees(piece.end):.6g} degrees"
            f" (offset {curve.distance:g} mm); no outline can be made of it"
        )


def torn_apart(angle: float) -> GeometryError:
    """The error of a parallel that is no single leg, torn apart at the cam angle `angle` [rad]."""
    return GeometryError(
        f"the curve is torn apart at cam angle {math.degrees(angle):.6g} degrees: the velocity of"
        " the follower jumps there"
    )


def joints_apart(curve: WorkingCurve, joints: FloatArray) -> FloatArray:
    """`joints` (n + 1,) [rad] without those too near to the one before; both ends are kept."""
    points = curve.point(joints)
    points[-1] = curve.point(joints[-1:], "left")[0]
    least = APART * float(np.max(np.abs(points)))
    if len(joints) == 2 or np.min(np.abs(np.diff(points))) >= least:
        return joints
    kept = [0]
    for k in range(1, len(joints) - 1):
        if min(abs(points[k] - points[kept[-1]]), abs(points[k] - points[-1])) >= least:
            kept.append(k)
    return joints[[*kept, -1]]


CELLS = 256
"""Cells of a piece over which `bends_of` samples a curve."""

FINER = 8
"""Cells into which one of `Bends` is divided for counts as large as theirs."""

RESTING = 4
"""Cells of a rest, which is uniform."""


@dataclass(frozen=True, slots=True, eq=False)
class Bends:
    """Bend of a parallel over a smooth piece, in the middle of equal cells of it.

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

        With their signs, because a power of a value is hardest to interpolate near a zero of the
        value.
        """
        places = np.arange(-1.0, len(self.speed) + 1.0)
        fine = (np.arange(FINER * len(self.speed)) + 0.5) / FINER - 0.5

        def over(values: FloatArray, least: float = -math.inf) -> FloatArray:
            before, after = 2.0 * values[0] - values[1], 2.0 * values[-1] - values[-2]
            ends = max(before, least), max(after, least)
            return np.interp(fine, places, np.concatenate((ends[:1], values, ends[1:])))

        # A speed that triples within a cell would be extrapolated below zero.
        signed = (self.curvature, self.slope, self.regularity)
        return Bends(over(self.speed, 0.0), *map(over, signed))


def bends_of(curve: WorkingCurve, pieces: Sequence[Piece]) -> list[Bends]:
    """The bends of all `pieces` of a curve, from one evaluation.

    Raises
    ------
    UndercutError
        If a piece is not regular at a sample.
    GeometryError
        If the roller centre stands still at a sample.
    """
    counts = [RESTING if piece.is_arc else CELLS for piece in pieces]
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
    floor : smallest density, as a fraction of its mean, so that every stretch gets joints.
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
