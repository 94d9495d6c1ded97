"""The legs of a path: the stretches between its corners, each fitted and proved on its own.

A leg is a stretch of a parallel over the cam angle, or the arc of a turn about a point over the
angle turned. Fit and proof treat both alike: a curve Z over a parameter with bounds of its
derivatives, and a signed distance at which the path is its parallel; an arc is its own Z.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Final, Self, TypeVar

import numpy as np

from camgeo.errors import GeometryError, ToleranceError, UndercutError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.outline.path import Path, Pivot, Stretch
from camgeo.geometry.pieces import SmoothPiece, circles, rigid_centres, smooth_pieces
from camgeo.geometry.pitch_curve import WorkingCurve, curvature_slope
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, Side, joined
from camgeo.numeric.kept import kept_with_owner
from camgeo.units import TURN

SNAP = 8.0 * math.ulp(TURN)
"""Two cam angles [rad] closer than this are the same, rounded differently."""

ROUNDING = 2.0**-52 * 32.0
"""Rounding of a point or a centre, as a fraction of the lengths that it is computed from."""


@kept_with_owner
def arc_pieces(curve: WorkingCurve) -> tuple[SmoothPiece, ...]:
    """The smooth pieces of `curve`, with the centres of those that are arcs; neighbouring arcs on
    one circle are one piece.
    """
    pitch, smooth = curve.pitch, smooth_pieces(curve)
    farthest = float(np.max(np.abs(circles(pitch).centres), initial=0.0))
    if farthest == 0.0:  # rests alone
        return smooth
    # Centres are compared to their rounding, that of the lengths they are computed from.
    near = ROUNDING * (farthest + pitch.follower.base_radius)
    borders = np.concatenate((pitch.borders, pitch.borders + TURN))
    pieces: list[SmoothPiece] = []
    for piece in smooth:
        inner = borders[(borders > piece.start) & (borders < piece.end)]
        ends = np.concatenate(([piece.start], inner, [piece.end]))
        centres = rigid_centres(pitch, 0.5 * (ends[:-1] + ends[1:]))
        centre = complex(centres[0]) if np.all(np.abs(centres - centres[0]) <= near) else None
        pieces.append(replace(piece, centre=centre))
        if _share_circle(pieces[-2:], near):
            pieces[-2:] = [replace(pieces[-2], end=piece.end)]
    # The last piece may go on in the first one, across cam angle 0.
    if _share_circle([pieces[-1], pieces[0]], near):
        pieces[-1:] = [replace(pieces[-1], end=pieces.pop(0).end + TURN)]
    return tuple(pieces)


def _share_circle(pieces: list[SmoothPiece], near: float) -> bool:
    """Whether two neighbours have one centre, up to `near` [mm]."""
    one, other = pieces[0], pieces[-1]
    if one is other or one.centre is None or other.centre is None:
        return False
    return abs(one.centre - other.centre) <= near


SLIGHT = 0.01
"""An arc of a turn shorter than this fraction of the tolerance is a corner: files rounded to a
tenth of the tolerance, as programs do, could not keep its ends distinct."""


@dataclass(frozen=True, slots=True)
class StretchLeg:
    """A stretch of a parallel as a leg; t is the cam angle.

    Attributes
    ----------
    curve : the parallel.
    start, end : range of t [rad], start < end.
    closed : True if it is a whole path that closes without a corner; it may then begin anywhere.
    first : its start [mm], shared with the leg before it; None where its own point is used.
    """

    curve: WorkingCurve
    start: float
    end: float
    closed: bool
    first: complex | None

    @property
    def distance(self) -> float:
        """d [mm], signed, of the leg from its Z."""
        return self.curve.distance

    @property
    def rotation(self) -> int:
        """sigma; the outward normal is i sigma Z'/|Z'|."""
        return self.curve.pitch.rotation

    @property
    def borders(self) -> FloatArray:
        """(k,) t at which the formula of Z changes, in [0, end] at least."""
        return np.concatenate((self.curve.borders, self.curve.borders + TURN))

    @property
    def pieces(self) -> tuple[SmoothPiece, ...]:
        """The smooth pieces of the leg, in order; neighbours on one circle are one piece."""
        if self.closed:
            return arc_pieces(self.curve)
        leg_pieces = []
        # Pieces are counted in one turn, but a stretch may begin before it or end after it.
        for turn in (-TURN, 0.0, TURN):
            for piece in arc_pieces(self.curve):
                start, end = piece.start + turn, piece.end + turn
                if min(end, self.end) - max(start, self.start) <= SNAP:
                    continue
                start = self.start if start < self.start + SNAP else start
                end = self.end if end > self.end - SNAP else end
                leg_pieces.append(SmoothPiece(start, end, piece.centre))
        return tuple(leg_pieces)

    @property
    def joints(self) -> FloatArray:
        """(k,) t at which one of its pieces follows another."""
        starts = [piece.start for piece in self.pieces if self.closed or piece.start > self.start]
        return np.array(starts, dtype=np.float64)

    def point(self, t: FloatArray, side: Side = "right") -> ComplexArray:
        """(n,) complex [mm] points at `t` (n,)."""
        return self.curve.point(t, side)

    def traced(self, t: FloatArray) -> tuple[ComplexArray, ComplexArray, FloatArray]:
        """(n,) points [mm], unit tangents of Z, and ds/dt [mm/rad] along the leg, negative where it
        runs against its tangent.
        """
        return self.curve.traced(t)

    def jet_and_bounds(self, low: FloatArray, high: FloatArray) -> tuple[ComplexArray, FloatArray]:
        """(3 or more, n) complex [mm/rad^k] Z, Z', Z'' in the middle of cells [low, high] (n,), and
        (3, n) upper bounds of |Z'|, |Z''|, |Z'''| over them; no border lies inside a cell, so that
        none reaches across cam angle 0.
        """
        # The jet is that of one turn: cells are reduced by their middle, their ends clipped to it.
        turns = TURN * np.floor(0.5 * (low + high) / TURN)
        return self.curve.pitch.jet_and_bounds(
            np.maximum(low - turns, 0.0), np.minimum(high - turns, TURN)
        )

    def poles(self, t: FloatArray) -> ComplexArray:
        """(n,) complex [mm] the point about which Z turns by the angle t, all along the range
        between borders in which `t` (n,) lies; NaN where no such point is known.
        """
        return rigid_centres(self.curve.pitch, t)


@dataclass(frozen=True, slots=True)
class TurnLeg:
    """The arc of a pivot as a leg; t is the angle turned, and the interface is that of
    `StretchLeg`.

    Attributes
    ----------
    centre, first, last : centre, start and end of the arc [mm].
    sweep : angle of the arc [rad], counter-clockwise positive.
    """

    centre: complex
    first: complex
    last: complex
    sweep: float
    start: float = 0.0
    closed: bool = False
    distance: float = 0.0
    rotation: int = 1

    @property
    def end(self) -> float:
        """See `StretchLeg`."""
        return abs(self.sweep)

    @property
    def radius(self) -> float:
        """Radius of the arc [mm]."""
        return abs(self.first - self.centre)

    @property
    def length(self) -> float:
        """Length of the arc [mm]."""
        return self.radius * self.end

    def is_slight(self, tolerance: float) -> bool:
        """Whether it is a corner for a `tolerance` [mm], see `SLIGHT`."""
        return self.length <= SLIGHT * tolerance

    @property
    def borders(self) -> FloatArray:
        """See `StretchLeg`."""
        return np.empty(0)

    def point(self, t: FloatArray, side: Side = "right") -> ComplexArray:
        """See `StretchLeg`."""
        return self.centre + self._arm(t)

    def traced(self, t: FloatArray) -> tuple[ComplexArray, ComplexArray, FloatArray]:
        """See `StretchLeg`."""
        arm = self._arm(t)
        tangents = 1j * math.copysign(1.0, self.sweep) * arm / self.radius
        return self.centre + arm, tangents, np.full(len(t), self.radius)

    def jet_and_bounds(self, low: FloatArray, high: FloatArray) -> tuple[ComplexArray, FloatArray]:
        """See `StretchLeg`."""
        arm = self._arm(0.5 * (low + high))
        jet = np.stack((self.centre + arm, 1j * math.copysign(1.0, self.sweep) * arm, -arm))
        return jet, np.full((3, len(low)), self.radius)

    def poles(self, t: FloatArray) -> ComplexArray:
        """See `StretchLeg`: its centre."""
        return np.full(len(t), self.centre)

    def _arm(self, t: FloatArray) -> ComplexArray:
        turned: ComplexArray = np.exp(1j * math.copysign(1.0, self.sweep) * t)
        turned *= self.first - self.centre
        return turned


Leg = StretchLeg | TurnLeg


def path_legs(path: Path) -> tuple[Leg, ...]:
    """The legs of a path, in order; corners are where they meet.

    Raises
    ------
    GeometryError
        If the path has no stretch.
    UndercutError
        If an arc has turned inside out: the parallel is farther off than a concave part of the path
        allows.
    """
    if not path.stretches:
        raise GeometryError("the path has no stretch of a curve")
    legs: list[Leg] = []
    previous = path.elements[-1]
    for element in path.elements:
        if isinstance(element, Stretch):
            if element.end - element.start <= SNAP:
                continue
            start = previous.end if isinstance(previous, Pivot) else None
            legs.append(StretchLeg(element.curve, element.start, element.end, path.is_whole, start))
        else:
            legs += _pivot_leg(element, path.stretches[0].curve.pitch.rotation)
        previous = element
    return tuple(legs)


def _pivot_leg(pivot: Pivot, rotation: int) -> list[TurnLeg]:
    """The arc of a pivot, or none if it is a corner."""
    size = abs(pivot.centre) + abs(pivot.distance)
    if abs(pivot.distance * pivot.sweep) <= ROUNDING * size:
        return []
    # The direction of travel is t = n/(i sigma); along the arc it is i distance n, in the sense of
    # the sweep.
    if pivot.distance * pivot.sweep * rotation > 0.0:
        raise UndercutError(
            f"the arc about a corner at cam angle {math.degrees(pivot.phi_start):.6g} degrees has"
            " turned inside out: the parallel lies too far on the concave side"
        )
    return [TurnLeg(pivot.centre, pivot.start, pivot.end, pivot.sweep)]


# -- chain ----------------------------------------------------------------------------------------
# Chains of pieces along the legs of a path, and their closing to a contour.


@dataclass(frozen=True, slots=True, eq=False)
class Chain:
    """Pieces along one smooth piece of a leg, open at its end.

    Attributes
    ----------
    angles : (n,) [rad] parameters of the pieces' starts.
    vertices, sweeps, centres : (n,), as of `Contour`.
    """

    angles: FloatArray
    vertices: ComplexArray
    sweeps: FloatArray
    centres: ComplexArray

    @classmethod
    def straight(cls, angles: FloatArray, vertices: ComplexArray) -> Self:
        """Lines that start at `vertices` (n,)."""
        return cls(angles, vertices, np.zeros(len(angles)), np.zeros_like(vertices))

    @classmethod
    def empty(cls) -> Self:
        """No pieces at all."""
        return cls.straight(np.empty(0), np.empty(0, dtype=np.complex128))

    @classmethod
    def arc(cls, angle: float, start: complex, sweep: float, centre: complex) -> Self:
        """A single arc."""
        return cls(np.array([angle]), np.array([start]), np.array([sweep]), np.array([centre]))


@dataclass(frozen=True, slots=True, eq=False)
class LegRun:
    """All pieces of a contour along one leg, in the direction of the leg.

    Attributes
    ----------
    leg : the exact leg.
    angles : (n + 1,) [rad] parameters of the leg that belong to the vertices, ascending.
    vertices : (n + 1,) complex [mm] ends of the pieces; n = 0 if the leg is too short for a piece.
    sweeps, centres : (n,), as of `Contour`.
    """

    leg: Leg
    angles: FloatArray
    vertices: ComplexArray
    sweeps: FloatArray
    centres: ComplexArray

    @property
    def starts(self) -> ComplexArray:
        """(n,) complex [mm], start of each piece."""
        return self.vertices[:-1]

    @property
    def ends(self) -> ComplexArray:
        """(n,) complex [mm], end of each piece."""
        return self.vertices[1:]

    @property
    def radii(self) -> FloatArray:
        """(n,) [mm] radius of each arc; 0 for lines."""
        return np.where(self.sweeps != 0.0, np.abs(self.starts - self.centres), 0.0)


def join_runs(parts: list[tuple[Leg, list[Chain]]]) -> tuple[LegRun, ...]:
    """The runs of all legs in turn, each ending in the first vertex of the next.

    Where a leg begins at a corner or an arc, its first vertex is the exact point there, not that
    point as rounded by its own curve.
    """
    whole = [_joined_chain(leg, chains) for leg, chains in parts]
    runs: list[LegRun] = []
    following: complex = next(complex(chain.vertices[0]) for chain in whole if len(chain.vertices))
    # Backwards, as a run ends in the first vertex of the run after it.
    for (leg, _), chain in reversed(list(zip(parts, whole, strict=True))):
        closing = chain.angles[0] + (leg.end - leg.start) if leg.closed else leg.end
        vertices = np.append(chain.vertices, following)
        angles = np.append(chain.angles, closing)
        runs.insert(0, LegRun(leg, angles, vertices, chain.sweeps, chain.centres))
        following = complex(vertices[0])
    return tuple(runs)


def _joined_chain(leg: Leg, chains: list[Chain]) -> Chain:
    chain = joined(chains)
    if leg.first is not None and len(chain.vertices):
        chain.vertices[0] = leg.first
    return chain


def closed_contour(runs: tuple[LegRun, ...]) -> Contour:
    """The closed contour of all runs in turn."""
    return Contour(
        np.concatenate([run.starts for run in runs]),
        np.concatenate([run.sweeps for run in runs]),
        np.concatenate([run.centres for run in runs]),
    )


# -- joints ---------------------------------------------------------------------------------------
# Joints of a fit along a smooth piece of a curve: conditions on the piece, how it bends, and
# joints that divide the difficulty evenly.


CUSP = 1e-12
"""1 + d kappa within this of zero is a cusp at a single point: twenty times its rounding."""

JOINT_DISTANCE = 2.0**-52 * 1e4
"""Smallest distance of two joints, as a fraction of their distance from the cam axis: the direction
from one to the next is still known to 1e-3 rad. Only next to a cusp does a curve move so little."""

CROWDED = 1e3 * JOINT_DISTANCE
"""Joints with places between them nearer than this share of their distance from the cam axis are
passed to `separate_joints`; a pace that changes thousandfold between two joints is that of a cusp.
"""


def check_regular(curve: WorkingCurve, piece: SmoothPiece, regularity: FloatArray) -> None:
    """Raise UndercutError unless `regularity` (n,), 1 + d kappa at samples, allows an outline."""
    smallest = float(np.min(regularity))
    if smallest < -CUSP or (piece.is_arc and smallest <= CUSP):
        raise UndercutError(
            "the offset curve has a cusp or undercut between cam angles"
            f" {math.degrees(piece.start):.6g} and {math.degrees(piece.end):.6g} degrees"
            f" (offset {curve.distance:g} mm); no outline can be made of it"
        )


def gap_error(angle: float) -> GeometryError:
    """The error for a parallel with a gap at the cam angle `angle` [rad]: it is no single leg."""
    return GeometryError(
        f"the curve has a gap at cam angle {math.degrees(angle):.6g} degrees, where the velocity of"
        " the follower jumps"
    )


def separate_joints(curve: WorkingCurve, joints: FloatArray) -> FloatArray:
    """`joints` (n + 1,) [rad] without those too near to the one before; both ends are kept."""
    points = curve.point(joints)
    points[-1] = curve.point(joints[-1:], "left")[0]
    least = JOINT_DISTANCE * float(np.max(np.abs(points)))
    if len(joints) == 2 or np.min(np.abs(np.diff(points))) >= least:
        return joints
    indices = [0]
    for k in range(1, len(joints) - 1):
        if min(abs(points[k] - points[indices[-1]]), abs(points[k] - points[-1])) >= least:
            indices.append(k)
    return joints[[*indices, -1]]


CELLS = 256
"""Cells of a piece over which `sample_bends` samples a curve."""

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

        def refine(values: FloatArray, least: float = -math.inf) -> FloatArray:
            # One cell is extrapolated at each end, as the fine cells reach beyond the first middle.
            left, right = 2.0 * values[0] - values[1], 2.0 * values[-1] - values[-2]
            ends = max(left, least), max(right, least)
            return np.interp(fine, places, np.concatenate((ends[:1], values, ends[1:])))

        # A speed that triples within a cell would be extrapolated below zero.
        signed = (self.curvature, self.slope, self.regularity)
        return Bends(refine(self.speed, 0.0), *map(refine, signed))


def sample_bends(curve: WorkingCurve, pieces: Sequence[SmoothPiece]) -> list[Bends]:
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
    # kappa = (1 - sigma (turning + q)) / |Z'| as for `curvature_slope`, q the relative turning.
    relative_turning = (u * w1 - w * u1) / (speed * speed)
    kappa = (1.0 - pitch.rotation * (tangent.turning + relative_turning)) / speed
    whole = (speed, kappa, slope, 1.0 + curve.distance * kappa)
    stops = np.cumsum(counts)
    piece_bends = [
        Bends(*(part[stop - count : stop] for part in whole))
        for stop, count in zip(stops, counts, strict=True)
    ]
    for piece, bends in zip(pieces, piece_bends, strict=True):
        check_regular(curve, piece, bends.regularity)
    return piece_bends


# -- counts ---------------------------------------------------------------------------------------
# The number of parts that a smooth piece needs: the least count that passes a trial.
#
# Counts never grow when the tolerance is loosened: a trial depends only on its count, the search
# ascends through counts that are the same for every tolerance, and its first count does not grow
# with the tolerance either.


Fitted = TypeVar("Fitted")

FINE = 200
"""Up to this many parts each count is tried; above, counts grow by this fraction."""

TOGETHER = 64
"""Parts that are tried at once for one piece: the overhead of a call is that of some hundred
points."""

FAR = 0.8
"""Fraction of the expected increase to skip where the distance found is more than twice the aim."""


STUCK_FACTOR, STUCK = 4.0, 0.9
"""Where so many times as many parts, beyond `FINE`, do not reduce the distance below this fraction,
their length is not to blame, because every stretch of a piece gets its share of them: the cam
angles of a step, or the points of a cusp, cannot be told apart."""


Make = Callable[[Sequence[tuple[int, int]]], Sequence[tuple[Fitted, float]]]
"""[(number of the piece, count), ...] -> the result for each and its largest distance [mm] found,
by any rule that depends only on the count."""


def least_counts(
    make: Make[Fitted],
    expected: FloatArray,
    aim: float,
    tolerance: float,
    *,
    order: float,
    most: int,
    together: int = TOGETHER,
) -> list[Fitted]:
    """The results of the least sufficient count for each of n pieces, which share their calls.

    Parameters
    ----------
    expected : (n,) the asymptotic count of each for small tolerances, a real number; the search
        begins there.
    order : power of the count with which the distance decreases.
    most : largest number of parts per piece.
    together : parts that are tried at once for one piece, unless a single count has more.

    Raises
    ------
    ToleranceError
        If no count comes within `aim` [mm].
    """
    counts = [ladder(float(value)) for value in expected]
    marks = [UNTRIED] * len(counts)
    fits: dict[int, Fitted] = {}
    while len(fits) < len(counts):
        wanted = []
        for piece, count in enumerate(counts):
            tried = 0
            while piece not in fits and (not tried or tried + count <= together):
                wanted.append((piece, count))
                tried += count
                count = next_count(count)
        for (piece, count), (fit, distance) in zip(wanted, make(wanted), strict=True):
            if piece in fits:
                continue
            if distance <= aim:
                fits[piece] = fit
                continue
            counts[piece] = next_count(count)
            # Far off, the law of the order tells how many counts may be skipped.
            if not distance <= 2.0 * aim:
                share = (distance / aim) ** (1.0 / order) if aim > 0.0 else np.inf
                counts[piece] = max(counts[piece], ladder(FAR * min(share, 4.0) * count))
            marks[piece] = still_closer(marks[piece], count, distance, tolerance)
            if counts[piece] > most:
                raise stuck_error(distance, tolerance)
    return [fits[piece] for piece in range(len(counts))]


Mark = tuple[int, float]
"""A number of parts that reduced the distance, and that distance [mm]."""

UNTRIED: Mark = (1, math.inf)


def still_closer(mark: Mark, count: int, distance: float, tolerance: float) -> Mark:
    """The last number of parts that reduced the distance, `mark` or `count` with its `distance`.

    Raises ToleranceError if more parts than `count` are no use, see `STUCK`.
    """
    if distance <= STUCK * mark[1]:
        mark = count, distance
    if count >= STUCK_FACTOR * max(mark[0], FINE):
        raise stuck_error(distance, tolerance)
    return mark


def stuck_error(distance: float, tolerance: float) -> ToleranceError:
    """The error for pieces that come no closer than `distance` [mm], whatever their number."""
    reached = distance if math.isfinite(distance) else math.inf
    return ToleranceError("the pieces of the contour cannot follow the curve", tolerance, reached)


def too_many_error(most: int, what: str, tolerance: float) -> ToleranceError:
    """The error for a `tolerance` [mm] that needs more than `most` pieces, called `what`."""
    return ToleranceError(f"more than {most:,} {what} would be needed", tolerance, math.inf)


def next_count(count: int) -> int:
    """The next count to try after `count`."""
    return count + 1 + count // FINE


def ladder(value: float) -> int:
    """The least count on the list of trials that is not below `value`."""
    count = 1
    while count < value:
        count = next_count(count)
    return count


# -- decided --------------------------------------------------------------------------------------
# Decisions of fits that the last digits of deviations do not change.
#
# These digits depend on the processor: numpy, BLAS and the C library choose their kernels by what
# it can do, and a deviation is a small difference of large coordinates. Rounds that move joints
# until deviations are equal would carry them on, multiplied, into the places of joints.


STEP: Final = 2.0**-10
"""Step in which logarithms of deviations are compared. Digits differ by some 1e-11 at a tolerance
of 1e-3 mm, so they hardly ever fall into different steps; and being uneven by half a step costs no
piece."""

CLEARLY: Final = 1.0 - 2.0**-20
"""A deviation below this fraction of another one is less. Of two that are equal to rounding, as of
mirror images, neither is less."""


def in_steps(logarithms: FloatArray) -> FloatArray:
    """(n,) multiples of `STEP`, the nearest to `logarithms` (n,)."""
    return np.asarray(np.rint(logarithms / STEP) * STEP)


def clearly_less(deviation: FloatArray, best: FloatArray) -> BoolArray:
    """(n,) whether a `deviation` is less than `best`, which may be infinite."""
    return np.asarray(deviation < CLEARLY * best)
