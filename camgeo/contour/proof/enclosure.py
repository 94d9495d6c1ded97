"""Enclosure of the distance between a leg and its pieces, over cells of the parameter.

The curve is an offset by d of the pitch curve Z, and so is, of a circle about c, the circle of
another radius: the distance of Z from the circle of radius rho_z = rho - s d determines that of the
curve from the arc of radius rho (s = +1 if the outward normal points away from c). With r = |Z - c|
and alpha the angle between Z' and the circle's tangent,

    distance = sqrt((r + s d)^2 - 2 r s d (1 - cos alpha)) - rho,   sin alpha = |dr/dphi| / |Z'|.

r and alpha are enclosed over cells of cam angle: q = r^2/2 lies within the range of the parabola
that it osculates in the middle, give or take a bound of its third derivative, which needs no more
than bounds of |Z'|, |Z''|, |Z'''|. For a line the same with its normal.

The third derivative of q = |Z - p|^2/2 - Re(conj(c - p) (Z - p)) + ... where Z turns rigidly about
a point p is at most |c - p| |Z'''|: zero for an arc about p, such as a rest, so that one cell
encloses all of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgeo.contour.chain import Run
from camgeo.errors import GeometryError
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, IntArray

BOUNDLESS = 1e200
"""Largest square of a distance [mm^2], in place of an infinite bound, as next to a dead centre:
what is computed from it stays finite, and far too large for any tolerance."""


@dataclass(frozen=True, slots=True, eq=False)
class Taylor:
    """Z over each cell: its jet in the middle, and bounds.

    Attributes
    ----------
    jet : (3 or more, n) complex [mm/rad^k] Z, Z', Z''.
    v1, v2, v3 : (n,) bounds of |Z'|, |Z''|, |Z'''|.
    half : (n,) half the cell [rad].
    poles : (n,) complex [mm] the point about which Z turns rigidly; NaN where it is not known to.
    """

    jet: ComplexArray
    v1: FloatArray
    v2: FloatArray
    v3: FloatArray
    half: FloatArray
    poles: ComplexArray

    def take(self, which: BoolArray) -> Taylor:
        """The cells of `which` (n,)."""
        v1, v2, v3, half = (part[which] for part in (self.v1, self.v2, self.v3, self.half))
        return Taylor(self.jet[:, which], v1, v2, v3, half, self.poles[which])

    def value_range(
        self, slope: FloatArray, bend: FloatArray, third: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Least and greatest value of a function over a cell, minus its value in the middle.

        From slope and second derivative there, and a bound of the third: the range of the parabola,
        and the largest difference of the function from it.
        """
        half = self.half
        ends, sag = half * np.abs(slope), 0.5 * half * half * bend
        low, high = sag - ends, sag + ends
        # The vertex of the parabola, where it lies inside.
        steep = np.abs(bend)
        inside = np.abs(slope) < half * steep
        peak = np.divide(slope * slope, 2.0 * steep, out=np.zeros_like(sag), where=inside)
        low = np.where(inside & (bend > 0.0), -peak, low)
        high = np.where(inside & (bend < 0.0), peak, high)
        return low, high, half * half * half * third / 6.0

    def slope_change(self, bend: FloatArray, third: FloatArray) -> FloatArray:
        """Largest difference of the slope of a function over a cell from that in its middle."""
        half = self.half
        return half * (np.abs(bend) + 0.5 * half * third)

    def pace_range(self) -> tuple[FloatArray, FloatArray]:
        """Smallest and largest |Z'| over the cells."""
        pace = np.abs(self.jet[1])
        change = self.half * (np.abs(self.jet[2]) + 0.5 * self.half * self.v3)
        change[~np.isnan(self.poles)] = 0.0
        return np.maximum(pace - change, 0.0), pace + change


@dataclass(frozen=True, slots=True, eq=False)
class Enclosure:
    """The curve relative to a piece, over each of n cells.

    Attributes
    ----------
    found : (n,) [mm] a distance that is certainly reached.
    bound : (n,) [mm] bound of the distance.
    steepness : (n,) bound of sin alpha, 1 where the piece runs backwards.
    steep : (n,) sin alpha found in its middle, 1 where the piece runs backwards.
    least_turn, most_turn : (n,) [rad] bounds of the angle by which the curve turns about the centre
        of an arc; 0 along lines.
    """

    found: FloatArray
    bound: FloatArray
    steepness: FloatArray
    steep: FloatArray
    least_turn: FloatArray
    most_turn: FloatArray


def enclose(taylor: Taylor, run: Run, piece: IntArray) -> Enclosure:
    """The cells of `taylor` compared with the pieces `piece` (n,) of `run`.

    Raises
    ------
    GeometryError
        If the parallel of an arc on Z has turned inside out.
    """
    is_arc = run.sweeps[piece] != 0.0
    if np.all(is_arc):
        return Enclosure(*_arc_cells(taylor, run, piece))
    if not np.any(is_arc):
        return Enclosure(*_line_cells(taylor, run, piece))
    out = np.empty((6, len(piece)))
    for which, kind in ((is_arc, _arc_cells), (~is_arc, _line_cells)):
        out[:, which] = kind(taylor.take(which), run, piece[which])
    return Enclosure(*out)


def _sines(
    slope: FloatArray, change: FloatArray, smallest: FloatArray, largest: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Range of |slope| / pace, kept inside [0, 1]."""
    low = np.maximum(np.abs(slope) - change, 0.0) / largest
    with np.errstate(divide="ignore", invalid="ignore"):
        high = (np.abs(slope) + change) / smallest
    return np.minimum(low, 1.0), np.where(smallest > 0.0, np.minimum(high, 1.0), 1.0)


def _arc_cells(taylor: Taylor, run: Run, piece: IntArray) -> tuple[FloatArray, ...]:
    """The parts of an `Enclosure` for cells of arcs."""
    z, z1, z2 = taylor.jet[0], taylor.jet[1], taylor.jet[2]
    offset, rotation = run.leg.distance, run.leg.rotation
    centre, sense = run.centres[piece], np.sign(run.sweeps[piece])
    arm = z - centre
    radius = run.radii[piece]
    shift = (-rotation * offset) * sense  # s d: s = +1 if the normal points away from c
    pitch_radius = radius - shift
    if np.any(pitch_radius <= 0.0):
        raise GeometryError("an arc of the contour bends far more than the exact curve")
    # q = (r^2 - rho_z^2)/2 and its derivatives; q' = r r'.
    r, pace = np.abs(arm), np.abs(z1)
    square = 0.5 * (r - pitch_radius) * (r + pitch_radius)
    slope = arm.real * z1.real + arm.imag * z1.imag
    bend = pace * pace + arm.real * z2.real + arm.imag * z2.imag
    third = 3.0 * taylor.v1 * taylor.v2 + (r + taylor.half * taylor.v1) * taylor.v3
    rigid = ~np.isnan(taylor.poles)
    third[rigid] = np.abs(centre[rigid] - taylor.poles[rigid]) * taylor.v3[rigid]
    least, most, rest = taylor.value_range(slope, bend, third)
    square_z = pitch_radius * pitch_radius + 2.0 * square

    def reach_at(growth: FloatArray) -> FloatArray:
        reach: FloatArray = np.sqrt(np.clip(square_z + 2.0 * growth, 0.0, BOUNDLESS))
        return reach

    nearest, farthest = reach_at(least - rest), reach_at(most + rest)
    slowest, fastest = taylor.pace_range()
    change = taylor.slope_change(bend, third)
    low, high = _sines(slope, change, nearest * slowest, farthest * fastest)
    # 1 - cos alpha for the smallest and largest |sin alpha|, alpha acute.
    small, large = 1.0 - np.sqrt(1.0 - low * low), 1.0 - np.sqrt(1.0 - high * high)

    def distance(reach: FloatArray, versine: FloatArray) -> FloatArray:
        # Radius r -> signed distance of the offset point from the arc, see the module.
        total = reach + shift
        square = total * total - 2.0 * reach * shift * versine
        signed: FloatArray = np.sqrt(np.maximum(square, 0.0)) - radius
        return signed

    pulls_in = shift > 0.0
    outer, inner = np.where(pulls_in, small, large), np.where(pulls_in, large, small)
    upper, lower = distance(farthest, outer), distance(nearest, inner)
    # The parabola reaches both ends of its range, so the distance does at least this.
    sure = np.maximum(
        distance(reach_at(most - rest), inner), -distance(reach_at(least + rest), outer)
    )
    normal = (1j * rotation * offset) * z1 / pace
    found = np.maximum(np.abs(np.abs(arm + normal) - radius), sure)
    forward = (arm.real * z1.imag - arm.imag * z1.real) * sense > 0.0
    steep = np.where(forward, np.abs(slope) / np.where(forward, r * pace, 1.0), 1.0)
    bound = np.maximum(np.abs(upper), np.abs(lower))
    whole = 2.0 * taylor.half
    with np.errstate(divide="ignore", invalid="ignore"):
        least_turn = whole * slowest * np.sqrt(1.0 - high * high) / farthest
        most_turn = np.where(nearest > 0.0, whole * fastest / nearest, np.inf)
    return found, bound, np.where(forward, high, 1.0), steep, least_turn, most_turn


def _line_cells(taylor: Taylor, run: Run, piece: IntArray) -> tuple[FloatArray, ...]:
    """The parts of an `Enclosure` for cells of lines."""
    z, z1, z2 = taylor.jet[0], taylor.jet[1], taylor.jet[2]
    offset, rotation = run.leg.distance, run.leg.rotation
    start, chord = run.starts[piece], (run.ends - run.starts)[piece]
    length = np.abs(chord)
    if np.any(length == 0.0):
        raise GeometryError("a line of the contour has no length")
    back = np.conj(chord / length)
    shift = rotation * offset
    arm, ahead = back * (z - start), back * z1
    value, slope, bend = arm.imag + shift, ahead.imag, (back * z2).imag
    slowest, fastest = taylor.pace_range()
    change = taylor.slope_change(bend, taylor.v3)
    low, high = _sines(slope, change, slowest, fastest)
    # 1 - cos alpha = k slope^2, k between these two: with the parabola that the slope is a line of,
    # one more parabola. Where the two have opposite signs, adding their ranges would overestimate.
    least_k = 1.0 / (fastest * fastest * (1.0 + np.sqrt(1.0 - low * low)))
    with np.errstate(divide="ignore"):
        most_k = 1.0 / (slowest * slowest * (1.0 + np.sqrt(1.0 - high * high)))
    blur = 0.5 * taylor.half * taylor.half * taylor.v3
    blur *= 2.0 * (np.abs(slope) + taylor.half * np.abs(bend)) + blur

    def signed(k: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        growth = 1.0 - 2.0 * shift * k * bend
        least, most, rest = taylor.value_range(growth * slope, growth * bend, taylor.v3)
        here = value - shift * k * slope * slope
        return here + least, here + most, rest + abs(shift) * k * blur

    outer, inner = (least_k, most_k) if shift > 0.0 else (most_k, least_k)
    with np.errstate(invalid="ignore"):
        low_out, high_out, unsure_out = signed(outer)
        low_in, high_in, unsure_in = signed(inner)
        upper, lower = high_out + unsure_out, low_in - unsure_in
        # The parabola reaches both ends of its range, so the distance does at least this.
        sure = np.maximum(high_in - unsure_in, -(low_out + unsure_out))
    pace = np.abs(z1)
    found = np.abs(arm.imag + shift * ahead.real / pace)
    found = np.where(slowest > 0.0, np.maximum(found, sure), found)
    forward = ahead.real > 0.0
    steep = np.where(forward, np.abs(slope) / pace, 1.0)
    bound = np.maximum(np.abs(upper), np.abs(lower))
    bound = np.where(slowest > 0.0, bound, np.inf)
    none = np.zeros(len(piece))
    return found, bound, np.where(forward, high, 1.0), steep, none, none
