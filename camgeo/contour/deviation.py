"""Proof of a contour: an upper bound of its distance from the exact curve, for every point.

The curve is an offset by d of the pitch curve Z, and so is, of a circle about c, the circle of
another radius: what Z does to the circle of radius rho_z = rho - s d tells what the curve does to
the arc of radius rho (s = +1 if the outward normal points away from c). With r = |Z - c| and alpha
the angle between Z' and the circle's tangent,

    distance = sqrt((r + s d)^2 - 2 r s d (1 - cos alpha)) - rho,   sin alpha = |dr/dphi| / |Z'|.

r and alpha are enclosed over cells of cam angle by r^2 and its first two derivatives in the middle
and a bound of the third, which needs no more than bounds of |Z'|, |Z''|, |Z'''|. Cells that decide
the largest distance are halved until the bound is sharp. For a line the same with its normal.

Contour to curve: as long as alpha stays far from a right angle, each normal of a piece meets the
curve once between the feet of the piece's ends; the tangential gaps at the feet are added.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.contour.locate import locate
from camgeo.curve.working_curve import WorkingCurve
from camgeo.errors import GeometryError
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, IntArray, ascending
from camgeo.units import TURN

SHARPNESS = 0.01
"""The bound exceeds the largest distance found by at most this share, and rounding."""

STEEPEST = 0.5
"""Largest sin(alpha) for which a piece counts as following the curve: 30 degrees."""

CELLS = 4
"""Cells a piece to begin with."""

HALVINGS = 40
"""Rounds of halving at most."""

MAX_CELLS = 4_000_000
"""Cells at most; a contour within its tolerance needs a few for each piece."""

ROUNDING = 2.0**-52 * 32.0
"""Rounding of a distance, as a share of the largest length that enters it."""


@dataclass(frozen=True, slots=True, eq=False)
class _Cells:
    """Cells of cam angle [low, high], each inside one piece of the contour and one formula."""

    low: FloatArray
    high: FloatArray
    piece: IntArray

    def halved(self, which: BoolArray) -> _Cells:
        low, high, piece = self.low[which], self.high[which], self.piece[which]
        middle = 0.5 * (low + high)
        return _Cells(
            np.concatenate((low, middle)),
            np.concatenate((middle, high)),
            np.concatenate((piece, piece)),
        )


def deviation(curve: WorkingCurve, contour: Contour, angles: FloatArray | None = None) -> float:
    """Upper bound [mm] of the distance between `contour` and `curve`, in both directions.

    Parameters
    ----------
    curve : the exact curve; regular, 1 + d kappa > 0.
    contour : closed, once round the curve, in either direction.
    angles : (n,) [rad] cam angles of the contour's vertices, ascending, if known; the contour then
        runs with growing cam angle. Otherwise they are found.

    Raises
    ------
    GeometryError
        If the contour does not follow the curve once round, so that no bound can be given.
    """
    if angles is None:
        contour, angles = locate(curve, contour)
    cells = _first_cells(curve, angles)
    _check_sweeps(curve, contour, cells)
    sizes = np.abs(contour.centres) + contour.radii
    reach = float(np.max(np.abs(contour.vertices)) + np.max(sizes) + abs(curve.distance))
    rounding = ROUNDING * reach
    found = 0.0
    for _ in range(HALVINGS):
        lower, bound, steepness, steep = _distances(curve, contour, cells)
        if np.max(steep) > STEEPEST:  # no halving would mend that
            break
        found = max(found, float(np.max(lower)))
        target = (1.0 + SHARPNESS) * found + rounding
        loose = (bound > target) | (steepness > STEEPEST)
        if not np.any(loose):
            return target + _gaps(curve, contour, angles)
        if np.count_nonzero(loose) > MAX_CELLS // 2:
            break
        cells = cells.halved(loose)
    raise GeometryError("the contour cannot be compared with the exact curve")


def _first_cells(curve: WorkingCurve, angles: FloatArray) -> _Cells:
    """Each piece's range in equal parts, cut at the borders of the curve's formulas."""
    ends = np.append(angles[1:], angles[0] + TURN)
    parts = np.arange(CELLS) / CELLS
    cuts = (angles[:, None] + (ends - angles)[:, None] * parts).ravel()
    borders = np.concatenate((curve.borders, curve.borders + TURN))
    borders = borders[(borders > angles[0]) & (borders < angles[0] + TURN)]
    cuts = ascending(np.concatenate((cuts, borders, [angles[0] + TURN])))
    low, high = cuts[:-1], cuts[1:]
    piece = np.searchsorted(angles, 0.5 * (low + high), side="right") - 1
    return _Cells(low, high, piece)


def _distances(
    curve: WorkingCurve, contour: Contour, cells: _Cells
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """For each cell: distance found in its middle and bound of it, bound of sin alpha and sin alpha
    found in its middle; 1 where the piece runs backwards.
    """
    middle, half = 0.5 * (cells.low + cells.high), 0.5 * (cells.high - cells.low)
    pitch, offset = curve.pitch, curve.distance
    jet = pitch.jet(middle)
    v1, v2, v3 = pitch.speed_bounds(*_in_turn(cells))
    is_arc = contour.sweeps[cells.piece] != 0.0

    lower, bound, steepness, steep = (np.empty(len(middle)) for _ in range(4))
    for which, kind in ((is_arc, _arc_cells), (~is_arc, _line_cells)):
        if np.any(which):
            taylor = _Taylor(jet[:, which], v1[which], v2[which], v3[which], half[which])
            lower[which], bound[which], steepness[which], steep[which] = kind(
                taylor, contour, cells.piece[which], offset, pitch.rotation
            )
    return lower, bound, steepness, steep


def _in_turn(cells: _Cells) -> tuple[FloatArray, FloatArray]:
    """The cells moved into [0, 2 pi]; cam angle 0 is a border, so none reaches across."""
    turns = TURN * np.floor(0.5 * (cells.low + cells.high) / TURN)
    return np.maximum(cells.low - turns, 0.0), np.minimum(cells.high - turns, TURN)


@dataclass(frozen=True, slots=True, eq=False)
class _Taylor:
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


def _arc_cells(
    taylor: _Taylor, contour: Contour, piece: IntArray, offset: float, rotation: int
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    z, z1, z2 = taylor.jet[0], taylor.jet[1], taylor.jet[2]
    arm = z - contour.centres[piece]
    radius = contour.radii[piece]
    side = -rotation * np.sign(contour.sweeps[piece])  # s: +1 if the normal points away from c
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
    forward = (np.conj(arm) * z1).imag * np.sign(contour.sweeps[piece]) > 0.0
    steep = np.where(forward, np.abs(slope) / np.where(forward, r * pace, 1.0), 1.0)
    bound = np.maximum(np.abs(upper), np.abs(lower))
    return found, bound, np.where(forward, high, 1.0), steep


def _line_cells(
    taylor: _Taylor, contour: Contour, piece: IntArray, offset: float, rotation: int
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    z, z1, z2 = taylor.jet[0], taylor.jet[1], taylor.jet[2]
    start, end = contour.vertices[piece], contour.ends[piece]
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


def _gaps(curve: WorkingCurve, contour: Contour, angles: FloatArray) -> float:
    """Largest tangential distance [mm] between a vertex and its foot, for both its pieces."""
    feet = curve.point(angles)
    largest = 0.0
    for vertices, where in ((contour.vertices, feet), (contour.ends, np.roll(feet, -1))):
        chord = contour.ends - contour.vertices
        arm = vertices - contour.centres
        along = np.where(contour.sweeps != 0.0, 1j * arm, chord)
        along = along / np.abs(along)
        ahead = where - vertices
        gap = np.abs(ahead.real * along.real + ahead.imag * along.imag)
        largest = max(largest, float(np.max(gap)))
    return largest


def _check_sweeps(curve: WorkingCurve, contour: Contour, cells: _Cells) -> None:
    """Each arc turns about its centre as far as the curve beside it, not the long way round."""
    first, last = curve.point(cells.low), curve.point(cells.high)
    centre = contour.centres[cells.piece]
    turned = np.angle((last - centre) * np.conj(first - centre))
    total = np.bincount(cells.piece, weights=turned, minlength=len(contour))
    arcs = contour.sweeps != 0.0
    if np.any(np.abs(total[arcs] - contour.sweeps[arcs]) > STEEPEST):
        raise GeometryError("an arc of the contour does not run beside the exact curve")
