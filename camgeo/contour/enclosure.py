"""Enclosure of the distance between a leg and the pieces beside it, over cells of the parameter.

The curve is an offset by d of the pitch curve Z, and so is, of a circle about c, the circle of
another radius: what Z does to the circle of radius rho_z = rho - s d tells what the curve does to
the arc of radius rho (s = +1 if the outward normal points away from c). With r = |Z - c| and alpha
the angle between Z' and the circle's tangent,

    distance = sqrt((r + s d)^2 - 2 r s d (1 - cos alpha)) - rho,   sin alpha = |dr/dphi| / |Z'|.

r and alpha are enclosed over cells of cam angle by r^2 and its first two derivatives in the middle
and a bound of the third, which needs no more than bounds of |Z'|, |Z''|, |Z'''|. For a line the
same with its normal.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgeo.contour.chain import Run
from camgeo.errors import GeometryError
from camgeo.numeric.arrays import ComplexArray, FloatArray, IntArray


@dataclass(frozen=True, slots=True, eq=False)
class Taylor:
    """What is known of Z over each cell: its jet in the middle, and bounds."""

    jet: ComplexArray
    v1: FloatArray
    v2: FloatArray
    v3: FloatArray
    half: FloatArray

    def spread(
        self, slope: FloatArray, bend: FloatArray, third: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """By how much a function and its slope may differ over a cell from those in its middle."""
        half = self.half
        value = half * (np.abs(slope) + half * (np.abs(bend) / 2.0 + half * third / 6.0))
        return value, half * (np.abs(bend) + half * third / 2.0)

    def pace_range(self) -> tuple[FloatArray, FloatArray]:
        """Smallest and largest |Z'| over the cells."""
        pace = np.abs(self.jet[1])
        change = self.half * (np.abs(self.jet[2]) + self.half * self.v3 / 2.0)
        return np.maximum(pace - change, 0.0), pace + change


def _versines(low: FloatArray, high: FloatArray) -> tuple[FloatArray, FloatArray]:
    """1 - cos alpha for the smallest and largest |sin alpha|, alpha acute."""
    return 1.0 - np.sqrt(1.0 - low * low), 1.0 - np.sqrt(1.0 - high * high)


def _sines(
    slope: FloatArray, change: FloatArray, smallest: FloatArray, largest: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Range of |slope| / pace, kept inside [0, 1]."""
    low = np.maximum(np.abs(slope) - change, 0.0) / largest
    with np.errstate(divide="ignore", invalid="ignore"):
        high = (np.abs(slope) + change) / smallest
    return np.minimum(low, 1.0), np.where(smallest > 0.0, np.minimum(high, 1.0), 1.0)


def arc_cells(
    taylor: Taylor, run: Run, piece: IntArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Cells beside arcs of `run`; `piece` (n,) tells which.

    Returns
    -------
    For each cell (n,): distance [mm] found in its middle and bound of it, bound of sin alpha and
    sin alpha found in its middle; 1 where the piece runs backwards.

    Raises
    ------
    GeometryError
        If the parallel of an arc on Z has turned inside out.
    """
    z, z1, z2 = taylor.jet[0], taylor.jet[1], taylor.jet[2]
    offset, rotation = run.leg.distance, run.leg.rotation
    arm = z - run.centres[piece]
    radius = run.radii[piece]
    side = -rotation * np.sign(run.sweeps[piece])  # s: +1 if the normal points away from c
    pitch_radius = radius - side * offset
    if np.any(pitch_radius <= 0.0):
        raise GeometryError("an arc of the contour bends far more than the exact curve")
    # q = (r^2 - rho_z^2)/2 and its derivatives; q' = r r'.
    r = np.abs(arm)
    square = 0.5 * (r - pitch_radius) * (r + pitch_radius)
    slope = arm.real * z1.real + arm.imag * z1.imag
    pace = np.abs(z1)
    bend = pace * pace + arm.real * z2.real + arm.imag * z2.imag
    third = 3.0 * taylor.v1 * taylor.v2 + (r + taylor.half * taylor.v1) * taylor.v3
    change, slope_change = taylor.spread(slope, bend, third)
    nearest = np.sqrt(np.maximum(pitch_radius**2 + 2.0 * (square - change), 0.0))
    farthest = np.sqrt(np.maximum(pitch_radius**2 + 2.0 * (square + change), 0.0))
    slowest, fastest = taylor.pace_range()
    low, high = _sines(slope, slope_change, nearest * slowest, farthest * fastest)
    small, large = _versines(low, high)

    def distance(reach: FloatArray, versine: FloatArray) -> FloatArray:
        # Radius r -> signed distance of the offset point from the arc, see the module.
        outer = reach + side * offset
        inner = outer * outer - 2.0 * reach * side * offset * versine
        signed: FloatArray = np.sqrt(np.maximum(inner, 0.0)) - radius
        return signed

    pulls_in = side * offset > 0.0
    upper = distance(farthest, np.where(pulls_in, small, large))
    lower = distance(nearest, np.where(pulls_in, large, small))
    normal = 1j * rotation * z1 / pace
    found = np.abs(np.abs(arm + offset * normal) - radius)
    forward = (np.conj(arm) * z1).imag * np.sign(run.sweeps[piece]) > 0.0
    steep = np.where(forward, np.abs(slope) / np.where(forward, r * pace, 1.0), 1.0)
    bound = np.maximum(np.abs(upper), np.abs(lower))
    return found, bound, np.where(forward, high, 1.0), steep


def line_cells(
    taylor: Taylor, run: Run, piece: IntArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Cells beside lines of `run`; `piece` (n,) tells which.

    Returns
    -------
    For each cell (n,): distance [mm] found in its middle and bound of it, bound of sin alpha and
    sin alpha found in its middle; 1 where the piece runs backwards.
    """
    z, z1, z2 = taylor.jet[0], taylor.jet[1], taylor.jet[2]
    offset, rotation = run.leg.distance, run.leg.rotation
    start, end = run.starts[piece], run.ends[piece]
    along = (end - start) / np.abs(end - start)
    shift = rotation * offset
    value = (np.conj(along) * (z - start)).imag + shift
    slope, bend = (np.conj(along) * z1).imag, (np.conj(along) * z2).imag
    change, slope_change = taylor.spread(slope, bend, taylor.v3)
    low, high = _sines(slope, slope_change, *taylor.pace_range())
    small, large = _versines(low, high)
    upper = value + change - shift * (small if shift > 0.0 else large)
    lower = value - change - shift * (large if shift > 0.0 else small)
    normal = 1j * rotation * z1 / np.abs(z1)
    found = np.abs((np.conj(along) * (z + offset * normal - start)).imag)
    forward = (np.conj(along) * z1).real > 0.0
    steep = np.where(forward, np.abs(slope) / np.abs(z1), 1.0)
    bound = np.maximum(np.abs(upper), np.abs(lower))
    return found, bound, np.where(forward, high, 1.0), steep
