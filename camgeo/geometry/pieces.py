"""Smooth pieces of a curve, its exact arcs, and exact extremes of a quantity over the turn."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from camgeo.errors import GeometryError
from camgeo.geometry.pitch_curve import PitchCurve, in_blocks, joints
from camgeo.geometry.together import curves_together
from camgeo.kinematics.mechanism.flat import Touch, flat_follower
from camgeo.kinematics.motion import MergedDwell, lift_range
from camgeo.kinematics.plan import MotionPlan
from camgeo.numeric.arrays import (
    ONE,
    AnyQuantity,
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
    Many,
    Quantity,
    Side,
    ascending,
    frozen,
    merged,
    read_only,
)
from camgeo.numeric.extremes import cell_places, isolated_roots, isolation_cells
from camgeo.numeric.kept import kept_with_each, kept_with_owner
from camgeo.record import Brief
from camgeo.units import TURN


class HasBreaks(Protocol):
    """Any function of the cam angle that knows its breaks and dwells."""

    @property
    def breaks(self) -> FloatArray: ...

    @property
    def dwells(self) -> tuple[MergedDwell, ...]: ...


class HasBorders(HasBreaks, Protocol):
    """A function that also knows its borders: where its formula changes, the breaks among them."""

    @property
    def borders(self) -> FloatArray: ...


@dataclass(frozen=True, slots=True)
class SmoothPiece:
    """A smooth piece over the cam angles [start, end] [rad]; end may exceed 2 pi, start may
    not.

    Its values are the right-hand ones at `start`, the left-hand ones at `end`. `centre` is the
    point [mm] about which it turns rigidly with the cam, the cam axis in a dwell; else None.
    """

    start: float
    end: float
    centre: complex | None = None

    @property
    def is_arc(self) -> bool:
        """Whether the piece is an arc, of a dwell or any other."""
        return self.centre is not None

    @property
    def dwell(self) -> bool:
        """Whether the piece is an arc about the cam axis."""
        return self.centre == 0.0


def smooth_pieces(curve: HasBreaks) -> tuple[SmoothPiece, ...]:
    """The smooth pieces of one turn, in order; the last may reach across cam angle 0."""
    breaks = [float(angle) for angle in curve.breaks]
    dwell_starts = {dwell.start for dwell in curve.dwells}
    if not breaks:
        return (SmoothPiece(0.0, TURN, 0j if dwell_starts else None),)
    ends = [*breaks[1:], breaks[0] + TURN]
    return tuple(
        SmoothPiece(start, end, 0j if start in dwell_starts else None)
        for start, end in zip(breaks, ends, strict=True)
    )


WIDEST = np.pi / 32.0
"""Longest cell of the first division [rad]."""

MOST = 1_000_000
"""Most cells halved at once; a curve needs some hundred, plus one per segment of its motion."""


@kept_with_owner
def turn_cells(pitch: PitchCurve) -> tuple[FloatArray, FloatArray]:
    """Ends (n,), (n,) [rad] of cells that fill [0, 2 pi], none across a border."""
    grid = np.linspace(0.0, TURN, int(np.ceil(TURN / WIDEST)) + 1)
    ends = read_only(ascending(np.concatenate((grid, pitch.borders))))
    return ends[:-1], ends[1:]


@kept_with_each
def turn_enclosed(pitches: Sequence[PitchCurve]) -> list[tuple[ComplexArray, FloatArray]]:
    """`PitchCurve.jet_and_bounds` over the cells of the turn, for each of `pitches`, which must
    suit `curves_together`.
    """
    low, high = turn_cells(pitches[0])
    enclosures = []
    for curve, times in curves_together(pitches).blocks(len(low)):
        enclosed = curve.jet_and_bounds(np.tile(low, times), np.tile(high, times))
        for one in range(times):
            columns = slice(one * len(low), (one + 1) * len(low))
            # Copies, so that a kept result does not hold the arrays of the whole block in memory.
            jet, bounds = enclosed[0][:, columns].copy(), enclosed[1][:, columns].copy()
            enclosures.append((read_only(jet), read_only(bounds)))
    return enclosures


def halves(low: FloatArray, high: FloatArray, which: BoolArray) -> tuple[FloatArray, FloatArray]:
    """Ends (2 k,), (2 k,) of the halves of the cells [low, high] (n,) [rad] selected by `which`.

    GeometryError if those are more than `MOST`.
    """
    low, high = low[which], high[which]
    if len(low) > MOST:
        place = math.degrees(low[0] % TURN)
        raise GeometryError(
            f"near cam angle {place:.6f} deg the pitch curve is too steep, or stays too close to a"
            f" limit along a stretch: {MOST:,} cells cannot decide what is left of the disc"
        )
    middle = 0.5 * (low + high)
    return np.concatenate((low, middle)), np.concatenate((middle, high))


# -- circles --------------------------------------------------------------------------------------
# The stretches of a pitch curve that are exactly arcs, run through evenly as the cam turns.
#
# Rests are arcs about the cam axis. Under a flat face on a guide so is each stretch with s''' =
# -s', about a point of the cam: an eccentric disc. Z turns rigidly about it, Z' = -i sigma (Z - c),
# and so do all parallels.


NOWHERE = complex(np.nan, np.nan)


@dataclass(frozen=True, slots=True, eq=False)
class Circles:
    """The stretches of a pitch curve that are known to be arcs, in order.

    Attributes
    ----------
    starts, spans : (k,) [rad] cam angles at which they begin, in [0, 2 pi), and their lengths.
    centres : (k,) complex [mm] the point about which each turns rigidly with the cam.
    """

    starts: FloatArray
    spans: FloatArray
    centres: ComplexArray


@kept_with_owner
def circles(pitch: PitchCurve) -> Circles:
    """All stretches known to be arcs."""
    rests = pitch.dwells
    moves: tuple[MergedDwell, ...] = ()
    if pitch.follower.harmonic_is_round and isinstance(pitch.motion, MotionPlan):
        moves = pitch.motion.harmonics
    starts = np.array([dwell.start for dwell in (*rests, *moves)])
    spans = np.array([dwell.span for dwell in (*rests, *moves)])
    centres = np.zeros(len(starts), dtype=np.complex128)
    if moves:
        moving = slice(len(rests), None)
        jet = pitch.jet(starts[moving] + 0.5 * spans[moving])
        # The equation Z' = -i sigma (Z - c) solved for c, in the middle of each stretch.
        centres[moving] = jet[0] - 1j * pitch.rotation * jet[1]
    order = np.argsort(starts)
    return Circles(starts[order], spans[order], centres[order])


def rigid_centres(pitch: PitchCurve, phi: FloatArray) -> ComplexArray:
    """(n,) complex [mm] the point about which the curve turns rigidly with the cam at `phi` (n,)
    [rad], places between borders; NaN where no such point is known.
    """
    known = circles(pitch)
    if not len(known.starts):
        return np.full(len(phi), NOWHERE)
    last = np.searchsorted(known.starts, phi % TURN, side="right") - 1  # before the first: the last
    # Both ends are borders: a place between them is not affected by rounding.
    inside = (phi - known.starts[last]) % TURN < known.spans[last]
    return np.where(inside, known.centres[last], NOWHERE)


# -- extremes -------------------------------------------------------------------------------------
# Exact extremes of a quantity over the turn: bracketed roots of its slope in each smooth piece.
#
# Among them those of the curvature of a pitch curve, which decide the size of the roller. The slope
# is examined in cells between the borders of the motion's formula, which are the knots of a table,
# and no number of samples is fixed, see `camgeo.numeric.extremes`.


@dataclass(frozen=True, slots=True, eq=False)
class Extremes(Brief):
    """Values at all places where a quantity can be extreme.

    Attributes
    ----------
    phi : (k,) cam angles [rad], ascending over one turn from the first break on, which appears
        again as the last; a break appears twice in a row, for its two sides.
    values : (k,) of the quantity there.
    """

    phi: FloatArray
    values: FloatArray

    def smallest(self) -> tuple[float, float]:
        """Smallest value and its cam angle [rad], the first of equals."""
        index = int(np.argmin(self.values))
        return float(self.values[index]), float(self.phi[index]) % TURN

    def largest(self) -> tuple[float, float]:
        """Largest value and its cam angle [rad], the first of equals."""
        index = int(np.argmax(self.values))
        return float(self.values[index]), float(self.phi[index]) % TURN


def extremes(curve: HasBorders, value: Quantity, slopes: Quantity) -> Extremes:
    """All local extremes of `value` over one turn.

    Parameters
    ----------
    curve : gives the smooth pieces, and the borders inside them.
    value : the quantity, (n,) at n cam angles, from the side asked for.
    slopes : what vanishes inside the pieces at the candidates, besides the ends of the pieces seen
        from inside: (n,), or (k, n) for several such quantities.
    """
    return extremes_of_members(curve, ONE, value, slopes)[0]


def extremes_of_members(
    breaks: HasBorders, many: Many[AnyQuantity], value: AnyQuantity, slopes: AnyQuantity
) -> list[Extremes]:
    """The `extremes` of each of `many`, which all have the same `breaks`."""
    turn = cached_turn(breaks) if isinstance(breaks, PitchCurve) else divide_turn(breaks)
    starts, ends = turn.starts, turn.ends
    middle, which = np.empty(0), np.empty(0, dtype=np.intp)
    if len(turn.places):
        middle, which = _slope_roots(many, value, slopes, turn.places)
    at_starts = many.everywhere(value, starts, "right")
    at_ends = many.everywhere(value, ends, "left")
    inner_values = many.paired_values(value, middle, "right", which)
    # At a break the end of one piece comes before the start of the next.
    owner = np.searchsorted(starts, middle, side="right") - 1
    piece_numbers = np.arange(len(starts))
    all_extremes = []
    for one in range(many.count):
        selected = which == one
        phi = np.concatenate((starts, middle[selected], ends))
        values = np.concatenate((at_starts[one], inner_values[selected], at_ends[one]))
        # Sorted by piece; within a piece its start, the places inside and its end, by cam angle.
        rank = np.repeat([0, 1, 2], [len(starts), int(np.count_nonzero(selected)), len(ends)])
        order = np.lexsort(
            (phi, rank, np.concatenate((piece_numbers, owner[selected], piece_numbers)))
        )
        all_extremes.append(
            Extremes(frozen(phi[order], np.float64), frozen(values[order], np.float64))
        )
    return all_extremes


@dataclass(frozen=True, slots=True, eq=False)
class Turn:
    """The smooth pieces of a turn, and the cells in which a slope is examined.

    Attributes
    ----------
    starts, ends : (m,) of the pieces [rad], ascending; the last end may exceed 2 pi.
    places : (n, k) in the cells of the pieces that are no dwells, see `cell_places`.
    """

    starts: FloatArray
    ends: FloatArray
    places: FloatArray


def divide_turn(curve: HasBorders) -> Turn:
    """The pieces and the cells of a curve: none of the cells reaches across a border."""
    pieces = smooth_pieces(curve)
    starts = np.array([piece.start for piece in pieces])
    ends = np.array([piece.end for piece in pieces])
    moving = np.array([not piece.dwell for piece in pieces])
    borders = np.concatenate((curve.borders, curve.borders + TURN))
    inner = borders[(borders > starts[0]) & (borders < ends[-1])]
    low, high = isolation_cells(merged(np.concatenate((starts, inner, ends[-1:]))))
    owner = np.searchsorted(starts, 0.5 * (low + high)) - 1
    low, high, owner = (column[moving[owner]] for column in (low, high, owner))
    return Turn(starts, ends, cell_places(low, high, starts[owner], ends[owner]))


@kept_with_owner
def cached_turn(curve: PitchCurve) -> Turn:
    """`divide_turn` of a pitch curve, kept with it because several quantities are examined."""
    return divide_turn(curve)


def _slope_roots(
    many: Many[AnyQuantity], value: AnyQuantity, slopes: AnyQuantity, places: FloatArray
) -> tuple[FloatArray, IntArray]:
    """(n,) where one of the `slopes` of a member of `many` vanishes, ascending, and (n,) the number
    of that member.
    """
    known = many.everywhere(slopes, places.ravel(), "right")
    # One row for each kind of slope and each member: number `kind * many.count + member`.
    known = known.reshape(-1, many.count, *places.shape)

    def slope_rows(phi: FloatArray, row: IntArray) -> FloatArray:
        kind, one = np.divmod(row, many.count)
        slope_values = many.paired_values(slopes, phi, "right", one)
        return slope_values if slope_values.ndim == 1 else slope_values[kind, np.arange(len(phi))]

    def value_rows(phi: FloatArray, row: IntArray) -> FloatArray:
        return many.paired_values(value, phi, "right", row % many.count)

    roots, row = isolated_roots(slope_rows, value_rows, places, known.reshape(-1, *places.shape))
    order = np.argsort(roots, kind="stable")
    return roots[order], row[order] % many.count


@kept_with_owner
def curvature_extremes(curve: PitchCurve) -> Extremes:
    """All local extremes of the curvature kappa [1/mm] of the pitch curve; Z' must not vanish."""
    return extremes(curve, curve.curvature, curve.curvature_slope)


# -- clearance -------------------------------------------------------------------------------------
# How near the roller centre comes to the cam axis, and whether it passes it by on one side.


def nearest_to_axis(pitch: PitchCurve) -> tuple[float, float]:
    """Smallest distance of the roller centre from the cam axis [mm] and its cam angle [rad]."""

    def square(phi: FloatArray, side: Side) -> FloatArray:
        relative = pitch.relative_jet(phi, side, order=1)
        return np.asarray(relative.along[0] ** 2 + relative.across[0] ** 2)

    def slope(phi: FloatArray, side: Side) -> FloatArray:
        relative = pitch.relative_jet(phi, side, order=1)
        (a0, a1), (b0, b1) = relative.along[:2], relative.across[:2]
        return np.asarray(a0 * a1 + b0 * b1)

    smallest, phi = extremes(pitch, square, slope).smallest()
    return float(np.sqrt(smallest)), phi


def surely_clear_of_axis(pitch: PitchCurve, radius: float) -> bool:
    """True if bounds over cells show that the roller centre stays farther than `radius` [mm].

    False is inconclusive; `nearest_to_axis` decides then.
    """
    low, high = turn_cells(pitch)
    jet, bounds = turn_enclosed(pitch)
    # From the middle of a cell to its ends |Z| falls by at most half the cell times the bound of
    # |Z'|.
    return bool(np.all(np.abs(jet[0]) - 0.5 * (high - low) * bounds[0] > radius))


def stays_on_one_side(pitch: PitchCurve) -> bool:
    """True if the roller centre never passes the foot of the guide, or the line of centres.

    There the transmission angle is 0, and a distance from the cam axis occurs twice.
    """
    middle, bounds = pitch.motion.jet_and_bounds(*turn_cells(pitch))
    reach = np.array([np.min(middle[0] - bounds[0]), np.max(middle[0] + bounds[0])])
    if pitch.follower.on_one_side(reach):
        return True
    # The bounds are too wide to decide: the exact range of the lift does.
    return pitch.follower.on_one_side(np.array(lift_range(pitch.motion)))


# -- convex ----------------------------------------------------------------------------------------
# Whether a flat face can touch all of a cam: the extremes of the quantities that must be positive.
#
# A face touches only what is convex. With the turn tau and the radius of curvature rho of
# `camgeo.kinematics.mechanism.flat`, the outline's tangent turns in one sense where tau > 0, by one
# turn in all, because the follower returns to its start; and the outline is traversed forwards
# where rho > 0. A closed curve whose tangent turns once in one sense has no crossing and is convex:
# no search is needed to show that all of it remains. The cam axis lies inside if the face keeps
# clear of it, h > 0.


SMALLEST = 1e-9
"""Radius of curvature, as a fraction of the base radius, that counts as a cusp: a thousand times
the rounding of the sums."""

NO_JUMP = 1e-12
"""Jump of the contact, as a fraction of the base radius, that is ignored: below the tolerance for
the closure of a curve."""

HALVINGS = 40
"""Most rounds of halving, until no cell is left in which a cusp could hide."""

Extreme = tuple[float, float]
"""A value and its cam angle [rad]."""


@dataclass(frozen=True, slots=True)
class Convexity:
    """The quantities that decide whether a flat face can touch all of the cam.

    Attributes
    ----------
    turn : smallest tau.
    radius : smallest rho [mm]; minus infinity where tau <= 0, which admits no radius.
    clearance : smallest distance h of the face from the cam axis [mm].
    jump : largest jump of the contact along the face [mm], positive in the direction of travel
        along the outline: there a straight stretch of the outline lies flush with the face.
        Negative where it jumps back, which no outline permits. 0 without a shock.
    jumps : number of cam angles at which it jumps.
    size : length [mm] with which the other values are to be compared.
    """

    turn: Extreme
    radius: Extreme
    clearance: Extreme
    jump: Extreme
    jumps: int
    size: float

    @property
    def is_convex(self) -> bool:
        """Whether such a cam exists."""
        least = SMALLEST * self.size
        return (
            self.turn[0] > 0.0
            and self.jumps == 0
            and min(self.radius[0], self.clearance[0]) > least
        )


def touch(curve: PitchCurve, phi: FloatArray, side: Side = "right") -> Touch:
    """The contact of the flat follower of `curve` at `phi` (n,) [rad]."""
    return flat_follower(curve.follower).touch(curve.motion.jet(phi, side), curve.rotation)


@kept_with_owner
def convexity(curve: PitchCurve) -> Convexity:
    """The quantities of the contact curve of a flat follower."""
    size = curve.follower.base_radius
    turn = smallest_turn(curve)
    clearance = _distances(curve).smallest()
    radius = (-np.inf, turn[1]) if turn[0] <= 0.0 else _proved_radius(curve)
    jump, count = _contact_jumps(curve, NO_JUMP * size)
    return Convexity(turn, radius, clearance, jump, count, size)


def smallest_turn(curve: PitchCurve) -> Extreme:
    """The smallest tau and its cam angle."""
    return extremes(
        curve,
        lambda phi, side: touch(curve, phi, side).turn[0],
        lambda phi, side: touch(curve, phi, side).turn[1],
    ).smallest()


def contact_extremes(curve: PitchCurve) -> Extremes:
    """All local extremes [mm] of the place of the contact along the face; tau must be positive."""
    return extremes(
        curve,
        lambda phi, side: touch(curve, phi, side).contact[0],
        lambda phi, side: touch(curve, phi, side).contact[1],
    )


def _distances(curve: PitchCurve) -> Extremes:
    """All local extremes of h [mm]: at reversals of the follower, and where a rocker's face is
    square to the line of centres.
    """

    def slopes(phi: FloatArray, side: Side) -> FloatArray:
        return np.stack((curve.motion.jet(phi, side)[1], touch(curve, phi, side).contact[0]))

    return extremes(curve, lambda phi, side: touch(curve, phi, side).distance, slopes)


def smallest_radius(curve: PitchCurve) -> Extreme:
    """The smallest rho = p / tau [mm] where its slope changes its sign; tau must be positive."""

    def radius(phi: FloatArray, side: Side) -> FloatArray:
        contact = touch(curve, phi, side)
        return np.asarray(contact.pace[0] / contact.turn[0])

    def slope(phi: FloatArray, side: Side) -> FloatArray:
        contact = touch(curve, phi, side)
        return np.asarray(contact.pace[1] * contact.turn[0] - contact.pace[0] * contact.turn[1])

    return extremes(curve, radius, slope).smallest()


@in_blocks
def _pace_and_turn(curve: PitchCurve, phi: FloatArray, side: Side = "right") -> FloatArray:
    """(2, n) p and tau: near a cusp of a long flank cells are many."""
    contact = touch(curve, phi, side)
    return np.stack((contact.pace[0], contact.turn[0]))


def _proved_radius(curve: PitchCurve) -> Extreme:
    """`smallest_radius`, or a cam angle that it misses where rho <= 0.

    Cells are halved until p is bounded away from 0 over each. |Z''| bounds |p'|.
    """
    smallest = smallest_radius(curve)
    if smallest[0] <= SMALLEST * curve.follower.base_radius:
        return smallest
    low, high = turn_cells(curve)
    for _ in range(HALVINGS):
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        pace, turn = _pace_and_turn(curve, middle)
        least = int(np.argmin(pace))
        if pace[least] <= 0.0:  # missed by every sample
            return float(pace[least] / turn[least]), float(middle[least])
        # Along a circle p is the same all over.
        near = np.isnan(rigid_centres(curve, middle))
        near &= pace <= half * curve.speed_bounds(low, high)[1]
        if not np.any(near):
            break
        low, high = halves(low, high, near)
    return smallest


def _contact_jumps(curve: PitchCurve, least: float) -> tuple[Extreme, int]:
    """The worst jump of the contact along the outline: the largest one backwards, else forwards."""
    phi = ascending(np.append(curve.breaks, 0.0))
    left, right = (touch(curve, phi, side).contact[0] for side in ("left", "right"))
    gaps = joints(curve).gaps
    jumping = gaps > least
    if not np.any(jumping):
        return (0.0, 0.0), 0
    facing = flat_follower(curve.follower).facing
    # The outline runs along the face, to the right for sigma = +1: t = -i sigma n.
    ways = curve.rotation * facing * (right - left)
    worst = int(np.argmin(np.where(jumping, ways, np.inf)))
    if ways[worst] > 0.0:
        worst = int(np.argmax(np.where(jumping, ways, -np.inf)))
    return (float(ways[worst]), float(phi[worst])), int(np.count_nonzero(jumping))
