"""Which cam angle a vertex of a contour belongs to: its foot point on the exact curve."""

from __future__ import annotations

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.curve.working_curve import WorkingCurve
from camgeo.errors import GeometryError
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.units import TURN

SAMPLES = 4096
"""Points of the curve from which the search for foot points starts."""

STEPS = 30
"""Newton steps at most; from a good start four do."""


def foot_points(curve: WorkingCurve, points: ComplexArray, guess: FloatArray) -> FloatArray:
    """Cam angles (n,) [rad] of the feet of perpendiculars from `points` (n,) near `guess` (n,)."""
    phi = guess
    for _ in range(STEPS):
        tangent = curve.tangent(phi)
        ahead = points - curve.point(phi)
        along = ahead.real * tangent.real + ahead.imag * tangent.imag
        pace = curve.pace(phi)
        if np.any(pace <= 0.0):
            break
        step = np.clip(along / pace, -0.2, 0.2)
        phi = phi + step
        if np.max(np.abs(step)) < 1e-15 * TURN:
            break
    return phi


def locate(curve: WorkingCurve, contour: Contour) -> tuple[Contour, FloatArray]:
    """Run `contour` the way of growing cam angle and find the cam angle of each of its vertices.

    Returns
    -------
    The contour, reversed if need be, and (n,) cam angles [rad], strictly ascending, less than one
    turn from first to last.

    Raises
    ------
    GeometryError
        If the contour does not follow the curve once round.
    """
    grid = np.linspace(0.0, TURN, SAMPLES + 1)
    path = curve.point(grid)
    area = 0.5 * float(np.sum((np.conj(path[:-1]) * path[1:]).imag))
    if area * contour.area < 0.0:
        contour = contour.reversed()
    first = int(np.argmin(np.abs(path - contour.vertices[0])))
    along_curve = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(path)))))
    along_contour = np.concatenate(([0.0], np.cumsum(contour.lengths)))
    share = along_contour[:-1] / along_contour[-1]
    place = along_curve[first] + share * along_curve[-1]
    turns, rest = np.divmod(place, along_curve[-1])
    guess = np.interp(rest, along_curve, grid) + TURN * turns
    phi = foot_points(curve, contour.vertices, guess)
    if np.any(np.diff(phi) <= 0.0) or phi[-1] - phi[0] >= TURN:
        raise GeometryError("the contour does not follow the exact curve once round")
    shift = TURN * np.floor(phi[0] / TURN)
    return contour, phi - shift
