"""Joints of a fit along a smooth piece of a curve: one-sided values, and what a piece must be."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from camgeo.curve.pieces import Piece
from camgeo.curve.working_curve import WorkingCurve
from camgeo.errors import GeometryError, UndercutError
from camgeo.motion.motion import Side
from camgeo.numeric.arrays import ComplexArray, FloatArray

CUSP = 1e-12
"""1 + d kappa within this of zero is a cusp in one point: twenty times its rounding."""

APART = 2.0**-52 * 1e4
"""Nearest two joints, as a share of their distance from the cam axis: the direction from one to the
next is still known to 1e-3 rad. Only beside a cusp does a curve move so little."""

CROWDED = 1e3 * APART
"""Joints with places between them nearer than this share of their distance from the cam axis are
looked at for `joints_apart`; a pace that changes thousandfold between two joints is that of a cusp.
"""


def require_regular(curve: WorkingCurve, piece: Piece) -> None:
    """Raise UndercutError if 1 + d kappa is negative at some sample of the piece.

    It may be zero in single points, at a cusp without undercut, but not for all of a dwell.
    """
    grid = np.linspace(piece.start, piece.end, 257)[1:-1]
    check_regular(curve, piece, curve.regularity(grid))


def check_regular(curve: WorkingCurve, piece: Piece, regularity: FloatArray) -> None:
    """`require_regular` where `regularity` (n,), 1 + d kappa at samples, is known already."""
    smallest = float(np.min(regularity))
    if smallest < -CUSP or (piece.dwell and smallest <= CUSP):
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


def values_at_joints(
    function: Callable[[FloatArray, Side], ComplexArray], joints: FloatArray
) -> ComplexArray:
    """Values at the joints of one smooth piece: right-hand at its start, left-hand at its end."""
    values = function(joints, "right")
    values[-1] = function(joints[-1:], "left")[0]
    return values


def joints_apart(curve: WorkingCurve, joints: FloatArray) -> FloatArray:
    """`joints` (n + 1,) [rad] without those too near to the one before; both ends stay."""
    points = values_at_joints(curve.point, joints)
    least = APART * float(np.max(np.abs(points)))
    if len(joints) == 2 or np.min(np.abs(np.diff(points))) >= least:
        return joints
    kept = [0]
    for k in range(1, len(joints) - 1):
        if min(abs(points[k] - points[kept[-1]]), abs(points[k] - points[-1])) >= least:
            kept.append(k)
    return joints[[*kept, -1]]
