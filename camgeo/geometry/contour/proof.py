"""Proof of a contour: an upper bound of its distance from the exact curve, for every point.

Each leg of the path is compared with its own run of pieces, and each piece with the part of the leg
between the two places given for its ends. Over cells of the leg's parameter, `enclose` bounds the
distance of the leg from the line or circle of the piece, and the angle alpha between both; cells
that decide the largest distance b are halved until the bound is sharp.

Why b and the distances of the ends bound the distance in both directions: as long as alpha stays
far from a right angle, the place square across on the line or circle moves steadily forward along
the part of the leg, and it turns about the centre by the sweep and not by a further turn.

- A point of the piece that some point of the part lies square across from is within b of it. What
  is left of the piece lies between one of its ends, A, and the place square across from the given
  place P of A, and is no farther from P than A itself.
- A point of the part that lies square across from a point of the piece is within b of it. What is
  left of the part lies between P and the place square across from A, beyond the end of the piece:
  it is within b across and, along, no farther from A than P is.

Either way the distance is at most sqrt(b^2 + c^2), c the chord of the circle of the piece between A
and the place square across from P, drawn at the distance b outside. It does not matter that
neighbours share A and P, as each piece and its part of the leg answer for themselves; nor how far A
lies off the leg across, as this is within b; and P may be any place, only c is small where it is
the foot of A. A leg's own ends are the places of a run's first and last vertex, so that no corner
goes unseen.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeVar

import numpy as np

from camgeo.errors import GeometryError, ToleranceError
from camgeo.geometry.contour.contour import Contour, Fit
from camgeo.geometry.contour.legs import (
    SNAP,
    Chain,
    Leg,
    LegRun,
    StretchLeg,
    TurnLeg,
    closed_contour,
    gap_error,
    join_runs,
    path_legs,
)
from camgeo.geometry.outline.path import Path
from camgeo.geometry.pieces import SmoothPiece
from camgeo.geometry.pitch_curve import WorkingCurve
from camgeo.numeric.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
    grouped,
    joined,
    taken,
)
from camgeo.units import TURN

SHARPNESS = 0.01
"""The bound exceeds the largest distance found by at most this fraction, plus rounding; for a fit
by this fraction of its tolerance, if that is more."""

ENOUGH = 1e-9
"""A bound [mm] that is never made sharper: a hundredth of the finest tolerance of a file. What lies
on the curve, but for rounding, would take millions of cells."""

STEEPEST = 0.5
"""Largest sin(alpha) for which a piece counts as following the curve: 30 degrees."""

ARC_CELLS = 10
"""Initial cells per arc, on average over a run, all of one width: the uncertainty of the distance
is the cube of the width times the bound of its third derivative, the same fraction of the largest
distance whatever the tolerance."""

FEWEST, MOST = 4, 256
"""Fewest and most initial cells of one arc."""

HALVINGS = 40
"""Most rounds of halving; then, or after `MAX_CELLS`, the bound is not sharp, but still one."""

MAX_CELLS = 400_000
"""Most cells [some 80 MB], unless there are as many pieces; a contour within its tolerance needs
a few for each."""

BLOCK = 16_384
"""Cells enclosed at a time [some 15 MB]."""

ROUNDING = 2.0**-52 * 32.0
"""Rounding of a distance, as a fraction of the largest length that enters it."""

HUGE = 1e3
"""Radius of an arc that may count as a line, as a multiple of the contour's reach."""

SHORT = 1e-3
"""Range of a formula [rad] up to which an error names the motion as its cause."""

LEFT_DISTANCE = 2.0 * SNAP
"""Distance before a border at which its left-hand value is taken [rad]: a few ulps, so that the
point there is within its rounding, and beyond the reach of the border."""


@dataclass(frozen=True, slots=True, eq=False)
class _Cells:
    """Cells of the parameter [low, high], each inside one piece of the contour and one formula."""

    low: FloatArray
    high: FloatArray
    piece: IntArray
    poles: ComplexArray

    @property
    def have_middles(self) -> BoolArray:
        """(n,) whether there is a number between the ends of each."""
        middle = 0.5 * (self.low + self.high)
        return np.asarray((self.low < middle) & (middle < self.high))

    def halved(self, which: BoolArray) -> _Cells:
        """The halves of the cells of `which` (n,): all lower ones, then all upper ones."""
        cells = taken(self, which)
        middle = 0.5 * (cells.low + cells.high)
        return joined([replace(cells, high=middle), replace(cells, low=middle)])


def deviation(path: Path, contour: Contour) -> float:
    """Upper bound [mm] of the distance between `contour` and `path`, in both directions.

    Parameters
    ----------
    path : the exact path; regular, 1 + d kappa > 0 except for single points.
    contour : closed, once round the path, in either direction.

    Raises
    ------
    GeometryError
        If the contour does not follow the path once round, so that no bound can be given.
    """
    return proved_bound(locate(path, contour))


def proved_bound(
    runs: tuple[LegRun, ...], arc_cells: int = ARC_CELLS, enough: float = ENOUGH
) -> float:
    """Upper bound [mm] of the distance between the contour of `runs` and their legs.

    Each run is compared with its own leg, and its ends with those of the leg, so that a corner of
    the path is one of the contour. `arc_cells` are the initial cells per arc: fewer suffice where
    the arcs are much finer than the distance requires; they only affect the time. A bound of up to
    `enough` [mm] is not made sharper.

    Raises
    ------
    GeometryError
        If a run does not follow its leg.
    """
    reached, largest = 0.0, 0.0
    for run in runs:
        if not len(run.sweeps):
            largest = max(largest, _empty_run_bound(run))
            continue
        reached, bound = _run_bound(run, reached, arc_cells, enough)
        largest = max(largest, bound)
    return largest


def _empty_run_bound(run: LegRun) -> float:
    """Bound [mm] of the distance of a leg without pieces from the only vertex of its run."""
    if not isinstance(run.leg, TurnLeg):
        raise GeometryError("the contour leaves out a stretch of the exact outline")
    return float(abs(run.vertices[0] - run.leg.last)) + run.leg.length


def _run_bound(run: LegRun, reached: float, arc_cells: int, enough: float) -> tuple[float, float]:
    """Largest distance found so far, including `reached` of other runs, and bound for this run.

    Rounding is charged to each piece with the lengths that enter its own distances: the circle of a
    nearly straight arc is large, and no other piece is measured from it.
    """
    run, rounding = _without_flat_arcs(run)
    cells = _first_cells(run, arc_cells)
    # Halving doubles the number of cells.
    most = max(MAX_CELLS, len(cells.low)) // 2
    enclosure, places = _first_enclosure(run, cells)
    largest = 0.0
    turned = np.zeros((2, len(run.sweeps)))
    for halving in range(HALVINGS):
        if np.max(enclosure.steep) > STEEPEST:  # halving would not help
            break
        reached = max(reached, float(np.max(enclosure.reached)))
        cell_rounding = rounding[cells.piece]
        bound = enclosure.bound + cell_rounding
        # A cell is done if it is not steep and its bound is sharp, or small enough.
        steep = enclosure.steepness > STEEPEST
        loose = steep | (
            bound > np.maximum((1.0 + SHARPNESS) * reached + 2.0 * cell_rounding, enough)
        )
        if np.count_nonzero(loose) > most or halving + 1 == HALVINGS:
            loose = steep
        decided = ~loose
        largest = max(largest, float(np.max(bound[decided], initial=0.0)))
        # The turns of a piece add up over its cells, however often these were halved.
        for total, part in zip(turned, (enclosure.least_turn, enclosure.most_turn), strict=True):
            total += np.bincount(cells.piece[decided], part[decided], len(total))
        if not np.any(loose):
            _check_turns(run, turned[0], turned[1])
            return reached, _with_ends(run, places, largest)
        if np.count_nonzero(loose) > most or not np.any(loose & cells.have_middles):
            break
        cells = cells.halved(loose)
        blocks = range(0, len(cells.low), BLOCK)
        enclosure = joined([_enclose_cells(run, taken(cells, slice(k, k + BLOCK))) for k in blocks])
    raise _uncompared_error(run, float(cells.low[np.argmax(enclosure.steepness)]))


def _uncompared_error(run: LegRun, place: float) -> GeometryError:
    """The error for a contour that does not follow the leg at `place` [rad]; it is the motion's if
    a formula of it holds there for no longer than `SHORT`.
    """
    if run.leg.closed:  # its pieces may begin anywhere, and end a turn later
        place %= TURN
    ends = np.concatenate(([run.leg.start], run.leg.borders, [run.leg.end]))
    # The range of the formula in which the place lies.
    start, end = np.max(ends[ends <= place]), np.min(ends[ends > place], initial=run.leg.end)
    if isinstance(run.leg, TurnLeg) or end - start > SHORT:
        here = complex(run.leg.point(np.array([place]))[0])
        return GeometryError(
            f"the contour cannot be compared with the exact curve near X {here.real:.6g}, Y"
            f" {here.imag:.6g} mm, where it may cross that curve steeply"
        )
    first, span = math.degrees(start % TURN), math.degrees(end - start)
    return GeometryError(
        f"the contour cannot be compared with the exact curve from {first:.12g} to"
        f" {first + span:.12g} deg of the cam angle: within these {span:.3g} deg double precision"
        " distinguishes too few cam angles for the move, or the curve turns too sharply; give the"
        " move a longer span or a shorter stroke",
        "motion",
    )


def _without_flat_arcs(run: LegRun) -> tuple[LegRun, FloatArray]:
    """The run with lines in place of the arcs whose huge circles round by more than their sagittas,
    and (n,) [mm] what its distances then miss: rounding, and those sagittas.
    """
    reach = float(np.max(np.abs(run.vertices))) + abs(run.leg.distance)
    rounding = ROUNDING * (np.abs(run.centres) + run.radii + reach)
    sagittas = 0.5 * np.abs((run.ends - run.starts) * np.tan(0.25 * run.sweeps))
    flat = (run.radii > HUGE * reach) & (sagittas < rounding)
    if not np.any(flat):
        return run, rounding
    sweeps, centres = np.where(flat, 0.0, run.sweeps), np.where(flat, 0.0, run.centres)
    missed = np.where(flat, ROUNDING * reach + sagittas, rounding)
    return replace(run, sweeps=sweeps, centres=centres), missed


def _first_cells(run: LegRun, arc_cells: int) -> _Cells:
    """The range of each piece in equal parts, cut at the borders of the leg's formulas.

    One part for a line, from which the curve departs like a parabola, and for an arc.
    """
    angles, ends = run.angles[:-1], run.angles[1:]
    borders = run.leg.borders
    borders = borders[(borders > angles[0]) & (borders < ends[-1])]
    poles = run.leg.poles(0.5 * (angles + ends))
    spans = np.where((run.sweeps != 0.0) & np.isnan(poles), ends - angles, 0.0)
    # One width for all arcs of the run; about a known pole a single cell is enough.
    width = float(np.sum(spans)) / max(1, arc_cells * int(np.count_nonzero(spans)))
    parts = np.where(
        spans > 0.0, np.clip(np.ceil(spans / (width or 1.0)), min(FEWEST, arc_cells), MOST), 1
    )
    parts = parts.astype(np.intp)
    piece, part = grouped(parts)
    low = angles[piece] + (ends - angles)[piece] * (part / parts[piece])
    if len(borders):
        place = np.searchsorted(low, borders)
        # Borders at which no cell begins divide the cells that they lie in.
        new = borders[low[np.minimum(place, len(low) - 1)] != borders]
        place = np.searchsorted(low, new)
        low = np.insert(low, place, new)
        piece = np.insert(piece, place, piece[place - 1])
        poles = run.leg.poles(0.5 * (low + np.append(low[1:], ends[-1])))
    else:
        poles = poles[piece]
    return _Cells(low, np.append(low[1:], ends[-1]), piece, poles)


def _first_enclosure(run: LegRun, cells: _Cells) -> tuple[Enclosure, ComplexArray]:
    """The enclosure of the first cells, and (2, n) complex [mm] the places of the pieces' starts
    and ends on the leg.

    Both come from one evaluation, because calls cost more than numbers: a place is a cell of zero
    width.
    """
    starts, ends = run.angles[:-1], run.angles[1:]
    # A piece that ends at a border ends in the left-hand value, which is taken just before it.
    at_border = _near_borders(ends, run.leg.borders)
    at_border[-1] = True
    left_angles = ends[at_border] - LEFT_DISTANCE
    low = np.concatenate((cells.low, starts, ends[-1:], left_angles))
    high = np.concatenate((cells.high, starts, ends[-1:], left_angles))
    jet, speeds = run.leg.jet_and_bounds(low, high)
    count, pieces = len(cells.low), len(starts)
    tangent = jet[1, count:] / np.abs(jet[1, count:])
    places = jet[0, count:] + (1j * run.leg.rotation * run.leg.distance) * tangent
    reached = places[1 : pieces + 1].copy()
    reached[at_border] = places[pieces + 1 :]
    both = np.stack((places[:pieces], reached))
    return _enclose_cells(run, cells, (jet[:, :count], speeds[:, :count])), both


def _near_borders(angles: FloatArray, borders: FloatArray) -> BoolArray:
    """(n,) which of `angles` (n,) count as one of the ascending `borders`."""
    if not len(borders):
        return np.zeros(len(angles), dtype=np.bool_)
    place = np.searchsorted(borders, angles)
    next_distance = np.abs(borders[np.minimum(place, len(borders) - 1)] - angles)
    return np.minimum(next_distance, np.abs(borders[place - 1] - angles)) <= SNAP


def _enclose_cells(
    run: LegRun, cells: _Cells, known: tuple[ComplexArray, FloatArray] | None = None
) -> Enclosure:
    """The cells compared with their pieces; `known` are their jets and speeds, if there are any."""
    jet, (v1, v2, v3) = known or run.leg.jet_and_bounds(cells.low, cells.high)
    taylor = Taylor(jet, v1, v2, v3, 0.5 * (cells.high - cells.low), cells.poles)
    return enclose(taylor, run, cells.piece)


def _with_ends(run: LegRun, places: ComplexArray, bound: float) -> float:
    """The bound of the distance across [mm], including the contribution of the ends of the pieces.

    With g and n the distance of the place from the end along and across the piece, n outward, the
    chord c of the circle of radius rho + b is c^2 = 2 rho (rho + b) g^2 / (r (r + rho + n)), r the
    distance of the place from the centre: the law of cosines without its cancellation. The distance
    of an arc's end from the circle about its centre through its start is added.
    """
    is_arc = run.sweeps != 0.0
    radii = np.where(is_arc, run.radii, 1.0)
    end_errors = np.where(is_arc, np.abs(np.abs(run.ends - run.centres) - radii), 0.0)
    chord = run.ends - run.starts
    largest = 0.0
    for vertices, on_leg in zip((run.starts, run.ends), places, strict=True):
        # Of a line the normal on its right, so that both axes serve lines and arcs alike.
        outward = np.where(is_arc, vertices - run.centres, -1j * chord)
        local = (on_leg - vertices) * np.conj(outward / np.abs(outward))
        square = local.imag * local.imag
        across = np.where(is_arc, radii + local.real, radii)
        reach = np.hypot(across, local.imag)
        bottom = reach * (reach + across)
        with np.errstate(divide="ignore", invalid="ignore"):
            share = np.where(is_arc, 2.0 * radii * (radii + bound) / bottom, 1.0)
        share = np.where(bottom > 0.0, share, np.inf)
        largest = max(largest, float(np.max(np.where(square > 0.0, square * share, 0.0))))
    ends = float(np.max(end_errors))
    return float(np.hypot(bound, np.sqrt(largest))) + ends


def _check_turns(run: LegRun, least: FloatArray, most: FloatArray) -> None:
    """GeometryError unless each arc turns about its centre as far as the curve, not the long way
    round.

    `least` and `most` (n,) [rad] bound how far the curve turns. It is the sweep, except for the
    deviations of the ends and whole turns: only one such value lies between the bounds.
    """
    arcs = run.sweeps != 0.0
    sweep, least, most = np.abs(run.sweeps[arcs]), least[arcs], most[arcs]
    plausible = (least <= sweep + STEEPEST) & (most >= sweep - STEEPEST)
    single = (least > sweep - TURN + STEEPEST) & (most < sweep + TURN - STEEPEST)
    if not np.all(plausible & single):
        raise GeometryError("an arc of the contour does not run along the exact curve")


# -- enclosure ------------------------------------------------------------------------------------
# Enclosure of the distance between a leg and its pieces, over cells of the parameter.
#
# The curve is an offset by d of the pitch curve Z, and so is, of a circle about c, the circle of
# another radius: the distance of Z from the circle of radius rho_z = rho - s d determines that of
# the curve from the arc of radius rho (s = +1 if the outward normal points away from c). With r =
# |Z - c| and alpha the angle between Z' and the circle's tangent,
#
#     distance = sqrt((r + s d)^2 - 2 r s d (1 - cos alpha)) - rho,   sin alpha = |dr/dphi| / |Z'|.
#
# r and alpha are enclosed over cells of cam angle: q = r^2/2 lies within the range of the parabola
# that it osculates in the middle, give or take a bound of its third derivative, which needs no more
# than bounds of |Z'|, |Z''|, |Z'''|. For a line the same with its normal.
#
# The third derivative of q = |Z - p|^2/2 - Re(conj(c - p) (Z - p)) + ... where Z turns rigidly
# about a point p is at most |c - p| |Z'''|: zero for an arc about p, such as a rest, so that one
# cell encloses all of it.


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
    reached : (n,) [mm] a distance that is certainly reached.
    bound : (n,) [mm] bound of the distance.
    steepness : (n,) bound of sin alpha, 1 where the piece runs backwards.
    steep : (n,) sin alpha in the middle of the cell, 1 where the piece runs backwards.
    least_turn, most_turn : (n,) [rad] bounds of the angle by which the curve turns about the centre
        of an arc; 0 along lines.
    """

    reached: FloatArray
    bound: FloatArray
    steepness: FloatArray
    steep: FloatArray
    least_turn: FloatArray
    most_turn: FloatArray


def enclose(taylor: Taylor, run: LegRun, piece: IntArray) -> Enclosure:
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
    columns = np.empty((6, len(piece)))
    for which, kind in ((is_arc, _arc_cells), (~is_arc, _line_cells)):
        columns[:, which] = kind(taylor.take(which), run, piece[which])
    return Enclosure(*columns)


def _sines(
    slope: FloatArray, change: FloatArray, smallest: FloatArray, largest: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Range of |slope| / pace, kept inside [0, 1]."""
    low = np.maximum(np.abs(slope) - change, 0.0) / largest
    with np.errstate(divide="ignore", invalid="ignore"):
        # A pace that may be 0 leaves the angle unknown: 1.
        high = (np.abs(slope) + change) / smallest
    return np.minimum(low, 1.0), np.where(smallest > 0.0, np.minimum(high, 1.0), 1.0)


def _arc_cells(taylor: Taylor, run: LegRun, piece: IntArray) -> tuple[FloatArray, ...]:
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
    # The third derivative of |Z - c|^2 / 2: 3 Re(conj(Z') Z'') + Re(conj(Z - c) Z''').
    third = 3.0 * taylor.v1 * taylor.v2 + (r + taylor.half * taylor.v1) * taylor.v3
    rigid = ~np.isnan(taylor.poles)
    third[rigid] = np.abs(centre[rigid] - taylor.poles[rigid]) * taylor.v3[rigid]
    least, most, rest = taylor.value_range(slope, bend, third)
    square_z = pitch_radius * pitch_radius + 2.0 * square

    def centre_distance(growth: FloatArray) -> FloatArray:
        return np.asarray(np.sqrt(np.clip(square_z + 2.0 * growth, 0.0, BOUNDLESS)))

    nearest, farthest = centre_distance(least - rest), centre_distance(most + rest)
    slowest, fastest = taylor.pace_range()
    change = taylor.slope_change(bend, third)
    low, high = _sines(slope, change, nearest * slowest, farthest * fastest)
    # 1 - cos alpha for the smallest and largest |sin alpha|, alpha acute.
    small, large = 1.0 - np.sqrt(1.0 - low * low), 1.0 - np.sqrt(1.0 - high * high)

    def distance(reach: FloatArray, versine: FloatArray) -> FloatArray:
        # Radius r -> signed distance of the offset point from the arc, see the module.
        total = reach + shift
        square = total * total - 2.0 * reach * shift * versine
        return np.asarray(np.sqrt(np.maximum(square, 0.0)) - radius)

    # The distance falls with 1 - cos alpha where s d > 0 and grows with it where s d < 0.
    inward = shift > 0.0
    outer, inner = np.where(inward, small, large), np.where(inward, large, small)
    upper, lower = distance(farthest, outer), distance(nearest, inner)
    # The parabola reaches both ends of its range, so the distance does at least this.
    sure = np.maximum(
        distance(centre_distance(most - rest), inner),
        -distance(centre_distance(least + rest), outer),
    )
    normal = (1j * rotation * offset) * z1 / pace
    reached = np.maximum(np.abs(np.abs(arm + normal) - radius), sure)
    forward = (arm.real * z1.imag - arm.imag * z1.real) * sense > 0.0
    steep = np.where(forward, np.abs(slope) / np.where(forward, r * pace, 1.0), 1.0)
    bound = np.maximum(np.abs(upper), np.abs(lower))
    whole = 2.0 * taylor.half
    with np.errstate(divide="ignore", invalid="ignore"):
        least_turn = whole * slowest * np.sqrt(1.0 - high * high) / farthest
        most_turn = np.where(nearest > 0.0, whole * fastest / nearest, np.inf)
    return reached, bound, np.where(forward, high, 1.0), steep, least_turn, most_turn


def _line_cells(taylor: Taylor, run: LegRun, piece: IntArray) -> tuple[FloatArray, ...]:
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
    # How far slope^2 may be off if the slope is off by `blur`.
    blur *= 2.0 * (np.abs(slope) + taylor.half * np.abs(bend)) + blur

    def signed(k: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        growth = 1.0 - 2.0 * shift * k * bend
        least, most, rest = taylor.value_range(growth * slope, growth * bend, taylor.v3)
        here = value - shift * k * slope * slope
        return here + least, here + most, rest + abs(shift) * k * blur

    outer, inner = (least_k, most_k) if shift > 0.0 else (most_k, least_k)
    with np.errstate(invalid="ignore"):
        outer_low, outer_high, outer_unsure = signed(outer)
        inner_low, inner_high, inner_unsure = signed(inner)
        upper, lower = outer_high + outer_unsure, inner_low - inner_unsure
        # The parabola reaches both ends of its range, so the distance does at least this.
        sure = np.maximum(inner_high - inner_unsure, -(outer_low + outer_unsure))
    pace = np.abs(z1)
    reached = np.abs(arm.imag + shift * ahead.real / pace)
    reached = np.where(slowest > 0.0, np.maximum(reached, sure), reached)
    forward = ahead.real > 0.0
    steep = np.where(forward, np.abs(slope) / pace, 1.0)
    bound = np.maximum(np.abs(upper), np.abs(lower))
    bound = np.where(slowest > 0.0, bound, np.inf)
    none = np.zeros(len(piece))
    return reached, bound, np.where(forward, high, 1.0), steep, none, none


# -- locate ---------------------------------------------------------------------------------------
# The place of a path for a vertex of a contour: the one across from it on the curve.


SAMPLES = 4096
"""Samples of a leg from which the search for places starts."""

A_FORMULA = 64
"""Least number of samples between two borders: a whole steep move may lie within a degree."""

STEPS = 30
"""Most Newton steps; from a good start three suffice."""

SMALL = 1e-9
"""A step [rad] below this is the last one: the remaining error is its square."""

ASKEW = 0.5
"""Least cosine of the angle between a vertex's direction and the leg for it to count."""


def _places(leg: Leg, points: ComplexArray, ahead: ComplexArray, guess: FloatArray) -> FloatArray:
    """Parameters (n,) [rad] of the places of `leg` next to `points` (n,), near `guess` (n,).

    The place lies square to the direction `ahead` (n,) of the contour, which leaves the proof no
    gap along it; where that is too oblique, it is the foot of the perpendicular. A search stops
    where the leg does not move forward.
    """
    t = guess
    for _ in range(STEPS):
        feet, tangent, pace = leg.traced(t)
        # Both directions have the length 1.
        cosine = ahead.real * tangent.real + ahead.imag * tangent.imag
        along = np.where(cosine >= ASKEW, ahead, tangent)
        offsets = points - feet
        forward = pace > 0.0
        way = offsets.real * along.real + offsets.imag * along.imag
        rate = np.where(cosine >= ASKEW, cosine, 1.0) * pace
        step = np.where(forward, way, 0.0) / np.where(forward, rate, 1.0)
        step = np.clip(step, -0.2, 0.2)
        t = t + step
        if np.max(np.abs(step), initial=0.0) < SMALL:
            break
    return t


def _directions(vertices: ComplexArray, contour: Contour) -> ComplexArray:
    """(n - 1,) unit directions at the inner ones of `vertices` (n,), the ends of the pieces of an
    open `contour`: half way between those of the two pieces.
    """
    chord = vertices[1:] - vertices[:-1]
    chord = np.where(chord == 0.0, 1.0, chord)
    turned = np.exp(0.5j * contour.sweeps)
    # Each chord turned by half its sweep gives the tangents at both of its ends.
    arriving, leaving = (chord * turned)[:-1], (chord * np.conj(turned))[1:]
    both = arriving / np.abs(arriving) + leaving / np.abs(leaving)
    size = np.abs(both)
    return np.asarray(np.where(size > 0.0, both / np.where(size > 0.0, size, 1.0), 0.0))


def locate(path: Path, contour: Contour) -> tuple[LegRun, ...]:
    """Orient `contour` as `path`, cut it where legs meet, and find the places of its vertices.

    A vertex belongs to each corner of the path and to each end of an arc: the nearest one.

    Raises
    ------
    GeometryError
        If the contour does not follow the path once round.
    """
    legs = path_legs(path)
    samples = [_samples(leg) for leg in legs]
    points = np.concatenate([sampled.points[:-1] for sampled in samples])
    # The sense of the path, by the area of its samples.
    area = 0.5 * float(np.sum((np.conj(points) * np.roll(points, -1)).imag))
    if area * contour.area < 0.0:
        contour = contour.reversed()
    if legs[0].closed:
        return (_closed_run(legs[0], samples[0], contour),)
    firsts = [
        leg.point(np.array([leg.start]))[0] if leg.first is None else leg.first for leg in legs
    ]
    corners = np.array(firsts)
    nearest = np.array([int(np.argmin(np.abs(contour.vertices - corner))) for corner in corners])
    contour = contour.rolled(int(nearest[0]))
    counts = _counts(legs, nearest, len(contour))
    stops = np.cumsum(counts)
    return tuple(
        _open_run(leg, sampled, contour, int(stop - count), int(stop))
        for leg, sampled, count, stop in zip(legs, samples, counts, stops, strict=True)
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Samples:
    """Samples of a leg: parameters (n,) [rad], points (n,) [mm] and arc lengths (n,) [mm]."""

    grid: FloatArray
    points: ComplexArray
    along: FloatArray


def _samples(leg: Leg) -> _Samples:
    """Samples of a leg, at least `A_FORMULA` between two borders."""
    inner = leg.borders[(leg.borders > leg.start) & (leg.borders < leg.end)]
    ends = np.concatenate(([leg.start], inner, [leg.end]))
    spans = np.diff(ends)
    # Every range has its share of the samples, by its length, but not too few.
    parts = np.maximum(A_FORMULA, np.ceil(SAMPLES * spans / (leg.end - leg.start))).astype(int)
    span, part = grouped(parts)
    inside = ends[:-1][span] + (spans / parts)[span] * part
    grid = np.append(inside, leg.end)
    points = np.append(leg.point(inside), leg.point(grid[-1:], "left"))
    along = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(points)))))
    return _Samples(grid, points, along)


def _counts(legs: tuple[Leg, ...], nearest: IntArray, pieces: int) -> IntArray:
    """Number of pieces along each leg, of `pieces`; none along a leg too short to have its own."""
    counts: IntArray = (np.roll(nearest, -1) - nearest) % pieces
    if not np.any(counts):
        stretches = [k for k, leg in enumerate(legs) if isinstance(leg, StretchLeg)]
        if len(stretches) == 1:
            counts[stretches[0]] = pieces
    if int(np.sum(counts)) != pieces:
        raise GeometryError("the contour does not follow the exact outline from corner to corner")
    return counts


def _open_run(leg: Leg, sampled: _Samples, contour: Contour, start: int, stop: int) -> LegRun:
    """The run of the pieces `start` to `stop` along a leg."""
    vertices = np.append(contour.vertices, contour.vertices[0])[start : stop + 1]
    along_contour = np.concatenate(([0.0], np.cumsum(contour.lengths[start:stop])))
    angles = np.full(len(vertices), leg.end)
    if stop > start:
        # First guess: the same share of both lengths.
        place = along_contour * (sampled.along[-1] / along_contour[-1])
        angles[0] = leg.start
        guess = np.interp(place[1:-1], sampled.along, sampled.grid)
        pieces = Contour(
            contour.vertices[start:stop], contour.sweeps[start:stop], contour.centres[start:stop]
        )
        ahead = _directions(vertices, pieces)
        angles[1:-1] = _places(leg, vertices[1:-1], ahead, guess)
        if np.any(np.diff(angles) <= 0.0):
            raise GeometryError("the contour does not follow the exact curve once round")
    return LegRun(leg, angles, vertices, contour.sweeps[start:stop], contour.centres[start:stop])


def _closed_run(leg: Leg, sampled: _Samples, contour: Contour) -> LegRun:
    """The run of a contour without corners, along a closed leg."""
    first = int(np.argmin(np.abs(sampled.points - contour.vertices[0])))
    along_contour = np.concatenate(([0.0], np.cumsum(contour.lengths)))
    share = along_contour[:-1] / along_contour[-1]
    place = sampled.along[first] + share * sampled.along[-1]
    turns, rest = np.divmod(place, sampled.along[-1])
    guess = np.interp(rest, sampled.along, sampled.grid) + TURN * turns
    # With the last piece in front, so that the first vertex has a piece on both sides.
    around = Contour(
        np.append(contour.vertices[-1], contour.vertices),
        np.append(contour.sweeps[-1], contour.sweeps),
        np.append(contour.centres[-1], contour.centres),
    )
    ahead = _directions(np.append(around.vertices, contour.vertices[0]), around)
    phi = _places(leg, contour.vertices, ahead, guess)
    if np.any(np.diff(phi) <= 0.0) or phi[-1] - phi[0] >= TURN:
        raise GeometryError("the contour does not follow the exact curve once round")
    # Counted from the turn in which the first place lies in [0, 2 pi).
    phi = phi - TURN * np.floor(phi[0] / TURN)
    phi = phi - TURN if phi[0] >= TURN else phi  # a tiny negative angle rounds to a full turn
    vertices = np.append(contour.vertices, contour.vertices[0])
    return LegRun(leg, np.append(phi, phi[0] + TURN), vertices, contour.sweeps, contour.centres)


# -- proved ---------------------------------------------------------------------------------------
# Fits that are proved before they are returned.
#
# The smooth pieces of one curve are a group, so that they share the cost of a call.


AIM = 0.985
"""Fraction of the tolerance that the sampled distance of a fast fit may reach; the rest is for the
proof."""


Group = Callable[[float, float], Sequence[Chain]]
"""Fits the smooth pieces of one curve: aim and tolerance [mm] -> a chain for each of them within
the aim; the tolerance is for messages."""


def fit_by_groups(
    make: Callable[[WorkingCurve, list[SmoothPiece]], Group], tolerance: float
) -> FitPieces:
    """The fit of the smooth pieces for `proved_fit`, group by group.

    `make` makes a group from a curve and its pieces, only once however often the aim is lowered.
    """
    groups: list[tuple[Group, list[int]]] = []

    def fit_pieces(pieces: Sequence[PieceOfLeg], aim: float) -> list[Chain]:
        if not groups:
            for curve, places in group_by_curve(pieces):
                groups.append((make(curve, [pieces[k][1] for k in places]), places))
        chains: dict[int, Chain] = {}
        for group, places in groups:
            chains.update(zip(places, group(aim, tolerance), strict=True))
        return [chains[k] for k in range(len(pieces))]

    return fit_pieces


def group_by_curve(pieces: Sequence[PieceOfLeg]) -> list[tuple[WorkingCurve, list[int]]]:
    """The curves to which `pieces` belong, each with the numbers of its pieces."""
    shared: dict[tuple[int, float], list[int]] = {}
    for number, (leg, _) in enumerate(pieces):
        # Equal parallels of one pitch curve are one curve, whether or not they are one object.
        shared.setdefault((id(leg.curve.pitch), leg.curve.distance), []).append(number)
    return [(pieces[numbers[0]][0].curve, numbers) for numbers in shared.values()]


ROUNDS = 6
"""Most fits; the second is within the tolerance wherever double precision allows."""

HELPS = 0.9
"""A deviation of more than twice the tolerance must fall below this fraction of it in the next
round, which aims at less than half; otherwise a smaller aim does not help, because the curve has a
step between cam angles that can hardly be told apart."""

EASE = 0.95
"""Factor beyond the excess by which the aim is lowered for the next round."""

FINER = 0.125
"""Fraction of the aim to try next where the pieces are too coarse for a proof, which limits how far
they turn, round the tip of a lobe. Arcs become half as long."""

PieceOfLeg = tuple[StretchLeg, SmoothPiece]

FitPieces = Callable[[Sequence[PieceOfLeg], float], Sequence[Chain]]
FitTurn = Callable[[TurnLeg, float], Chain]
Candidate = TypeVar("Candidate")


def proved_fit(
    path: Path, tolerance: float, aim: float, fit_pieces: FitPieces, fit_turn: FitTurn
) -> Fit:
    """Fit each smooth piece of `path`, prove the whole, and aim lower until the proof holds.

    Parameters
    ----------
    tolerance : that the proved deviation must not exceed [mm].
    aim : deviation that the first round aims at [mm].
    fit_pieces : all smooth pieces, each with its stretch, aim [mm] -> a chain each. They are passed
        together so that a fit can share the cost of a call between them.
    fit_turn : arc between two stretches, aim [mm] -> its chain.

    Raises
    ------
    ToleranceError
        If the tolerance cannot be reached in double precision.
    GeometryError
        If the contour cannot be compared with the path, or the path has a gap.
    """
    prove = partial(proved_bound, enough=SHARPNESS * tolerance)
    runs, reached = fit_until_proved(
        path_fit(path, tolerance, fit_pieces, fit_turn), prove, aim, tolerance
    )
    return Fit(closed_contour(runs).counter_clockwise(), reached, tolerance)


def path_fit(
    path: Path, tolerance: float, fit_pieces: FitPieces, fit_turn: FitTurn
) -> Callable[[float], tuple[LegRun, ...]]:
    """The fit that `proved_fit` proves: aim [mm] -> runs along `path`, their distance only sampled.

    Raises GeometryError if the path has a gap.
    """
    legs = path_legs(path)
    stretches = [leg for leg in legs if isinstance(leg, StretchLeg)]
    _require_joined(stretches, tolerance)
    pieces = [(leg, piece) for leg in stretches for piece in leg.pieces]

    def fit(aim: float) -> tuple[LegRun, ...]:
        chains = iter(fit_pieces(pieces, aim))
        parts: list[tuple[Leg, list[Chain]]] = []
        for leg in legs:
            if isinstance(leg, StretchLeg):
                parts.append((leg, [next(chains) for _ in leg.pieces]))
            elif leg.is_slight(tolerance):
                parts.append((leg, [Chain.empty()]))
            else:
                parts.append((leg, [fit_turn(leg, aim)]))
        return join_runs(parts)

    return fit


def fit_until_proved(
    fit: Callable[[float], Candidate],
    prove: Callable[[Candidate], float],
    aim: float,
    tolerance: float,
) -> tuple[Candidate, float]:
    """Fit with ever lower aims, from `aim` [mm] on, until the deviation that `prove` gives is at
    most `tolerance` [mm]: the result of `fit`, and that deviation [mm].

    Raises what `prove` raised last, ToleranceError if the deviation stays too large, and whatever
    `fit` raises.
    """
    reached, previous, failed = 0.0, math.inf, None
    for number in range(ROUNDS):
        try:
            candidate = fit(aim)
        except ToleranceError:
            if number:  # of a lower aim: what matters is what the proof said of the one before
                break
            raise
        try:
            reached, failed = prove(candidate), None
        except GeometryError as error:  # too coarse to follow the curve
            failed = error
            aim *= FINER
            continue
        if reached <= tolerance:
            return candidate, reached
        if reached > HELPS * previous and previous > 2.0 * tolerance:
            break
        previous = reached
        # A deviation is proportional to the aim, nearly.
        aim *= EASE * tolerance / reached
    if failed is not None:
        raise failed
    raise ToleranceError("the pieces of the contour cannot follow the curve", tolerance, reached)


def _require_joined(legs: Sequence[StretchLeg], tolerance: float) -> None:
    """Raise GeometryError where a parallel has a gap: a jump of the follower's velocity tears it.

    No contour could be proved across such a gap.
    """
    for leg in legs:
        inner = leg.joints
        gaps = np.abs(leg.point(inner) - leg.point(inner, "left"))
        if np.any(gaps > tolerance):
            raise gap_error(float(inner[int(np.argmax(gaps))]))
