"""The part of the disc that holds the roller at each cam angle, and the resulting lift.

The roller is pressed along the follower's path until it touches: of all branches that the path
meets, the outermost holds a roller that is pressed inward, the innermost one that is pressed
outward, see `camgeo.geometry.outline.outline`.

A roller with play touches one flank of its groove, which lies half the groove's width from the
pitch curve, so that its centre runs on the pitch curve's parallel at half the clearance. At the cam
angle phi it touches the flank where the demanded motion would touch it at another cam angle theta:
the one at which the follower's path at phi meets the parallel.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Final, Literal, Self

import numpy as np

from camgeo.errors import GeometryError
from camgeo.geometry.outline.outline import (
    NONE,
    AngleCells,
    Pairs,
    changes,
    cover_cells,
    outermost,
    pairs_in_cells,
    visible_pieces,
)
from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
from camgeo.kinematics.mechanism.follower_path import Bows, FollowerPath, path_of
from camgeo.kinematics.motion import Motion
from camgeo.numeric.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
    Side,
    ascending,
    dot,
    grouped,
    joined,
)
from camgeo.units import TURN

if TYPE_CHECKING:
    from camgeo.geometry.contour.contour import Contour
    from camgeo.geometry.contour.spline import Arc, SplineContour

STEPS = 40
"""Most Newton steps; the parallel is near the pitch curve, so five are already many."""

SMALL_STEP = 64.0 * 2.0**-52
"""A step [rad] below this, a few roundings of a cam angle, is the last one."""

LONGEST = 0.2
"""Longest Newton step [rad]."""

BREAK_DISTANCE = 1e-9
"""Within this distance of a break [rad] theta counts as the break, seen from the requested side."""


@dataclass(frozen=True)
class PlayedLift:
    """The lift of a roller whose centre runs on a parallel of the pitch curve.

    Attributes
    ----------
    path : of the follower.
    parallel : the curve of the roller centres: the pitch curve's parallel at -c/2 for a roller on
        the inner flank of a groove with the clearance c, at +c/2 on the outer one. Regular, and
        without corners.
    """

    path: FollowerPath
    parallel: WorkingCurve

    @cached_property
    def breaks(self) -> FloatArray:
        """(m,) cam angles [rad] in [0, 2 pi) at which the roller passes breaks of the curve."""
        return self._passed(self.parallel.breaks)

    @cached_property
    def borders(self) -> FloatArray:
        """(m,) cam angles [rad] in [0, 2 pi) at which it passes borders of the curve."""
        return self._passed(self.parallel.borders)

    def _passed(self, theta: FloatArray) -> FloatArray:
        """(m,) cam angles [rad], ascending, at which the centre is at `theta` (m,) [rad]."""
        angles, _ = self.path.cam_coordinates(self.parallel.point(theta))
        return ascending(angles)

    def leverage(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        """(n,) dn/dq of this lift, see `camgeo.geometry.pitch_curve.PitchCurve.leverage`."""
        points, tangents, _ = self.parallel.traced(self._snap_to_breaks(self.touching(phi)), side)
        angles, q = self.path.cam_coordinates(points)
        normals = 1j * self.parallel.pitch.rotation * tangents
        along, _ = self.path.along(angles, q)
        return np.asarray(self.path.outward * dot(normals, along))

    def jet(self, phi: FloatArray, side: Side = "right", order: int = 2) -> FloatArray:
        """(3, n) lift with two derivatives [mm or rad per rad^k] at `phi` (n,) [rad], whatever the
        `order`.

        The path meets the circle of curvature of the parallel there as it does the parallel itself
        up to the second order.

        Raises
        ------
        GeometryError
            If the path does not meet the parallel nearby, or is tangent to it.
        """
        theta = self.touching(phi)
        snapped = self._snap_to_breaks(theta)
        points, tangents, _ = self.parallel.traced(snapped, side)
        normals = 1j * self.parallel.pitch.rotation * tangents
        _, q = self.path.cam_coordinates(points)
        bows = Bows(points, normals, self.parallel.curvature(snapped, side))
        return bows.lift_jet(self.path, phi, q)[:3]

    def touching(self, phi: FloatArray) -> FloatArray:
        """(n,) theta [rad] at `phi` (n,) [rad], by Newton's method; raises as `jet`."""
        theta = np.asarray(phi, dtype=np.float64)
        for _ in range(STEPS):
            points, tangents, pace = self.parallel.traced(theta)
            angles, q = self.path.cam_coordinates(points)
            # Along the parallel dZ = (Z_phi) dphi + (Z_q) dq; the part across the path is dphi's.
            across = np.conj(self.path.along(angles, q)[0])
            turning = (across * (-1j * self.path.rotation) * points).imag
            rate = (across * tangents).imag * pace
            # Where the path is tangent to the parallel, or beyond that, no step leads on.
            if np.any(rate * turning <= 0.0):
                break
            step = np.clip(_signed_angles(phi - angles) * turning / rate, -LONGEST, LONGEST)
            theta = theta + step
            if np.max(np.abs(step), initial=0.0) <= SMALL_STEP * TURN:
                return theta
        raise GeometryError(
            "the side clearance is too large: near the demanded position the follower's path does"
            " not meet the curve of the roller centre on that flank"
        )

    def _snap_to_breaks(self, theta: FloatArray) -> FloatArray:
        """`theta` in one turn, on the breaks themselves where it is there to rounding."""
        breaks = np.append(self.parallel.breaks, self.parallel.breaks[:1] + TURN)
        turned = np.remainder(theta, TURN)
        above = np.searchsorted(breaks, turned)
        for index in (above - 1, np.minimum(above, len(breaks) - 1)) if len(breaks) else ():
            near = np.abs(turned - breaks[index]) <= BREAK_DISTANCE
            turned = np.where(near, breaks[index], turned)
        return np.where(turned >= TURN, turned - TURN, turned)


CORNER = 1e-7
"""Corners up to this angle [rad] are ignored: the directions of two pieces at their common end are
known to the rounding of its coordinates over their length, 1e-14 mm over 1e-7 mm at worst."""

AS_DEMANDED = NONE
"""Number of the branch that is the demanded motion itself, or that with the roller's play."""

SEAM = 1e-9
"""Width [rad] up to which a range without any branch is a seam: two branches meet there, and their
ends differ by rounding."""

HALF_ARC = 0.52
"""Largest ratio of half an arc of up to an eighth of a turn to its chord: pi/16 / sin(pi/8)."""


def piece_numbers(borders: FloatArray, held: IntArray, angle: FloatArray, side: Side) -> IntArray:
    """(n,) number of the piece at `angle` (n,) [rad] of any turn, approached from `side`; `borders`
    and `held` are those of `changes`.
    """
    return np.asarray(held[np.searchsorted(borders, np.remainder(angle, TURN), side) - 1])


@dataclass(frozen=True, slots=True, eq=False)
class DiscLift(ABC):
    """The actual lift of a follower that is pressed against a disc, over the cam angle.

    Attributes
    ----------
    path : of the follower.
    pitch : the pitch curve of a roller, the contact curve of a flat face, of the demanded motion.
    borders : (k,) cam angles [rad] in [0, 2 pi), ascending, at which what holds it changes.
    numbers : (k,) what holds it from each border to the next, or AS_DEMANDED.
    """

    path: Any
    pitch: PitchCurve
    borders: FloatArray
    numbers: IntArray

    @property
    def motion(self) -> Motion:
        """The demanded lift."""
        return self.pitch.motion

    @property
    def outward(self) -> int:
        """+1 if a positive lift moves the follower outward, else -1."""
        return int(self.path.outward)

    @property
    def free_motion(self) -> Motion | PlayedLift:
        """The motion of the follower where its number is AS_DEMANDED."""
        return self.motion

    @property
    def as_demanded(self) -> bool:
        """Whether the motion is exactly the demanded one where AS_DEMANDED: no roller with play."""
        return self.free_motion is self.motion

    @property
    def breaks(self) -> FloatArray:
        """(m,) cam angles [rad] where a derivative of the demanded or the played lift may jump."""
        return ascending(np.concatenate((self.motion.breaks, self.free_motion.breaks)))

    @property
    def knots(self) -> FloatArray:
        """(m,) the `breaks` and all other cam angles [rad] where the formula of either changes."""
        return ascending(np.concatenate((self.motion.borders, self.free_motion.borders)))

    @abstractmethod
    def holding_elements(self, numbers: IntArray) -> tuple[IntArray, FloatArray]:
        """(n,) the contour's elements, as of `camgeo.geometry.outline.replay.Replay`, and (n,) the
        turns of the contour [rad] at vertices, a full turn elsewhere, for `numbers` (n,) other than
        AS_DEMANDED.
        """

    @abstractmethod
    def heading(self, phi: FloatArray, jet: FloatArray) -> ComplexArray:
        """(n,) complex, where the follower runs in the cam: a direction that turns where the
        velocity of `jet` (3, n) jumps.
        """

    @abstractmethod
    def joint_shift(self, joint: float, error: FloatArray) -> FloatArray:
        """(n,) [rad] how far from a joint of the demanded motion its place on the disc may lie, by
        the `error` (3, n) of the lift and its derivatives around it.
        """

    @abstractmethod
    def held_jet(self, phi: FloatArray, numbers: IntArray, order: Literal[0, 2, 3]) -> FloatArray:
        """(order + 1, n) lift with derivatives where `numbers` (n,) hold it at `phi` (n,) [rad]."""

    def without_corners(self, corner: float) -> Self:
        """The same lift where the follower does not turn about corners of up to `corner` [rad]:
        what held it before one goes on, off by less than the square of the turn.
        """
        retained = self.retained_borders(self.holding_elements(self.numbers)[1], corner)
        return replace(self, borders=self.borders[retained], numbers=self.numbers[retained])

    def retained_borders(self, turns: FloatArray, corner: float) -> BoolArray:
        """(k,) which `borders`, with `turns` (k,) [rad] behind them, `without_corners` keeps."""
        return turns > corner

    def number(self, phi: FloatArray, side: Side = "right") -> IntArray:
        """(n,) number of what holds the follower at `phi` (n,) [rad]."""
        return piece_numbers(self.borders, self.numbers, phi, side)

    def displacement(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        """(n,) lift [mm or rad] at `phi` (n,) [rad]."""
        return np.asarray(self._rows(phi, side, 0)[0])

    def jet(self, phi: FloatArray, side: Side = "right", order: Literal[2, 3] = 2) -> FloatArray:
        """(order + 1, n) lift with derivatives [mm or rad per rad^k] at `phi` (n,) [rad].

        With play there is no third one.

        Raises
        ------
        GeometryError
            Where the lift jumps, because its velocity is unbounded there.
        """
        return self._rows(phi, side, order)

    def _rows(self, phi: FloatArray, side: Side, order: Literal[0, 2, 3]) -> FloatArray:
        """(order + 1, n) lift with derivatives, of what holds the follower at `phi` (n,) [rad]."""
        number = self.number(phi, side)
        held = number != AS_DEMANDED
        jet = np.empty((order + 1, len(phi)))
        if not np.all(held):
            jet[:, ~held] = self.free_motion.jet(phi[~held], side, max(order, 1))[: order + 1]
        if np.any(held):
            jet[:, held] = self.held_jet(phi[held], number[held], order)
        return jet


@dataclass(frozen=True, slots=True, eq=False)
class ActualLift(DiscLift):
    """The actual lift of a roller; its numbers are those of branches.

    Attributes
    ----------
    branches : those that the roller may run on.
    played : the motion that a roller with play makes where it is AS_DEMANDED; None without play.
    """

    path: FollowerPath
    branches: Branches | SplineBranches
    played: PlayedLift | None = None

    @property
    def free_motion(self) -> Motion | PlayedLift:
        """See `DiscLift`."""
        return self.played or self.motion

    def holding_elements(self, numbers: IntArray) -> tuple[IntArray, FloatArray]:
        """See `DiscLift`."""
        return self.branches.elements[numbers], self.branches.corners[numbers]

    def held_jet(self, phi: FloatArray, numbers: IntArray, order: Literal[0, 2, 3]) -> FloatArray:
        """See `DiscLift`."""
        return self.branches.jet(self.path, phi, numbers, order)

    def heading(self, phi: FloatArray, jet: FloatArray) -> ComplexArray:
        """See `DiscLift`: of the roller centre."""
        q = self.path.start + self.outward * jet[0]
        # The cam turns under the follower, so that in the cam the centre turns the other way.
        turn = -1j * self.path.rotation * self.path.point(phi, q)
        along, _ = self.path.along(phi, q)
        return np.asarray(turn + along * self.outward * jet[1])

    def joint_shift(self, _: float, error: FloatArray) -> FloatArray:
        """See `DiscLift`: as far as the roller centre is off."""
        at_start = np.zeros(1), np.full(1, self.path.start)
        along, point = self.path.along(*at_start)[0], self.path.point(*at_start)
        return np.asarray(abs(complex(along[0]) / complex(point[0])) * np.abs(error[0]))

    @classmethod
    def from_contour(cls, pitch: PitchCurve, contour: Contour, press: int) -> ActualLift:
        """The lift of the roller of `pitch` on a closed contour of lines and arcs,
        counter-clockwise.

        `press` is as for `holding_branches`. Raises GeometryError as `parallel` and
        `holding_branches` do.
        """
        path = path_of(pitch.follower, pitch.rotation)
        roller_branches = branches(parallel(contour, -press * pitch.follower.roller_radius), path)
        whole = (np.zeros(1), np.full(1, TURN))
        return cls(
            path, pitch, *holding_branches(roller_branches, path, press, whole), roller_branches
        )

    @classmethod
    def from_splines(cls, pitch: PitchCurve, contour: SplineContour, press: int) -> ActualLift:
        """The lift of the roller of `pitch` on a closed contour of cubics, arcs and lines,
        counter-clockwise; `press` is as for `holding_branches`.

        Raises
        ------
        GeometryError
            If the contour turns in at a corner or has a curvature that the roller does not fit
            into, or does not run once round the cam axis within the follower's reach.
        """
        path = path_of(pitch.follower, pitch.rotation)
        chain, lows, highs = _spline_branches(contour, -press * pitch.follower.roller_radius, path)
        order = np.argsort(lows, kind="stable")
        spans = np.remainder(highs - lows, TURN)
        # Branches of no width are rounding.
        order = order[spans[order] > GAP]
        gaps = np.abs(_signed_angles(np.roll(lows[order], -1) - highs[order]))
        if not np.all(gaps <= GAP) or not abs(float(np.sum(spans[order])) - TURN) <= GAP * len(
            order
        ):
            raise GeometryError("the spline does not lead the roller once round the cam axis")
        return cls(path, pitch, lows[order], order, chain)

    @classmethod
    def from_corners(
        cls,
        pitch: PitchCurve,
        corners: ComplexArray,
        press: int,
        radius: float,
        ranges: tuple[FloatArray, FloatArray],
        played: PlayedLift | None,
    ) -> ActualLift:
        """The lift of a roller of `radius` [mm] that runs over the `corners` (k,) [mm] of an
        outline in the `ranges`, as of `holding_branches`; elsewhere it moves as demanded, or as
        `played`.
        """
        path = path_of(pitch.follower, pitch.rotation)
        none, normals = np.zeros(len(corners)), np.ones(len(corners), dtype=np.complex128)
        # Full circles about the corners, each begun on its right-hand side.
        points, number = corners + radius, -1 - np.arange(len(corners))
        circles = cut(points, points, normals, none + 1.0 / radius, none + TURN, none, number)
        roller_branches = branches(circles, path)
        borders, numbers = np.zeros(1), np.full(1, AS_DEMANDED)
        if len(ranges[0]):
            borders, numbers = holding_branches(roller_branches, path, press, ranges)
        return cls(path, pitch, borders, numbers, roller_branches, played)


def holding_branches(
    branches: Branches, path: FollowerPath, press: int, ranges: tuple[FloatArray, FloatArray]
) -> tuple[FloatArray, IntArray]:
    """Borders (k,) [rad] and the branch (k,) that holds the roller from each of them on.

    Parameters
    ----------
    press : -1 if the roller is pressed inward and the outermost branch holds it, +1 if outward.
    ranges : starts (r,) in [0, 2 pi) and ends (r,) [rad] of the ranges of cam angle to examine, at
        most a turn each, without overlap.

    Raises
    ------
    GeometryError
        If no branch covers some cam angle of them.
    """
    starts, ends = ranges
    nodes = ascending(np.concatenate((branches.lows, branches.highs, starts, ends % TURN)))
    wanted = _wanted_cells(nodes, starts, ends)
    cells = AngleCells.from_nodes(nodes)
    first = np.searchsorted(nodes, branches.lows)
    count = np.remainder(np.searchsorted(nodes, branches.highs) - first, len(nodes))
    cell, branch = cover_cells(
        cells, first, count, "the pieces of its parallel at the roller radius overlap"
    )
    used = wanted[cell]
    cell, branch = cell[used], branch[used]
    _require_cover(cells, wanted, cell)
    cell, branch = _without_hidden(cells, cell, branch, branches, path, press)
    inner = _crossings(cells, cell, branch, branches, path)

    def height(chosen: IntArray, phi: FloatArray) -> FloatArray:
        return -press * path.meet(phi, branches.bows.take(chosen), branches.facing[chosen])

    borders, parent, held = outermost(cells, (cell, branch), inner, height)
    seam = np.flatnonzero(wanted[parent] & (held == AS_DEMANDED))
    # In a seam nothing holds the roller: what held it before goes on.
    for number in seam:
        held[number] = held[number - 1]
    return changes(borders, held)


def _wanted_cells(nodes: FloatArray, starts: FloatArray, ends: FloatArray) -> BoolArray:
    """(m,) whether the cell from each node on is in one of the ranges, whose ends are nodes."""
    cell = np.arange(len(nodes))
    wanted = np.zeros(len(nodes), dtype=np.bool_)
    for start, end in zip(starts, ends, strict=True):
        first, last = np.searchsorted(nodes, (start, end % TURN))
        # A range of a whole turn ends in the node where it begins.
        count = (last - first) % len(nodes) if end - start < TURN else len(nodes)
        wanted |= np.remainder(cell - first, len(nodes)) < count
    return wanted


def _without_hidden(
    cells: AngleCells,
    cell: IntArray,
    branch: IntArray,
    branches: Branches,
    path: FollowerPath,
    press: int,
) -> Pairs:
    """The pairs without those whose branch lies behind another one throughout their cell."""
    several = np.bincount(cell, minlength=len(cells))[cell] > 1
    inner, held = cell[several], branch[several]
    if not len(inner):
        return cell, branch
    bows, facing = branches.bows.take(held), branches.facing[held]
    ends = []
    for angles in (cells.low[inner], cells.high[inner]):
        ends.append(path.point(angles, path.meet(angles, bows, facing)))
    # The branch between both ends keeps within half its length of their mean distance.
    middle = 0.5 * (np.abs(ends[0]) + np.abs(ends[1]))
    half = HALF_ARC * np.abs(ends[1] - ends[0])
    near, far = path.coordinate(np.maximum(middle - half, 0.0)), path.coordinate(middle + half)
    low, high = (near, far) if press < 0 else (-far, -near)
    visible = np.ones(len(cell), dtype=np.bool_)
    visible[several] = visible_pieces(inner, low, high)
    return cell[visible], branch[visible]


def _require_cover(cells: AngleCells, wanted: BoolArray, cell: IntArray) -> None:
    """Raise GeometryError if a `wanted` cell wider than a seam has no branch."""
    bare = wanted & (np.bincount(cell, minlength=len(wanted)) == 0)
    bare &= cells.high - cells.low > SEAM
    if np.any(bare):
        place = np.degrees(cells.low[np.flatnonzero(bare)[0]])
        raise GeometryError(
            f"at cam angle {place:.6g} degrees the follower's path does not meet the contour; the"
            " contour must run once round the cam axis, within the follower's reach"
        )


def _crossings(
    cells: AngleCells, cell: IntArray, branch: IntArray, branches: Branches, path: FollowerPath
) -> FloatArray:
    """Cam angles (k,) [rad] inside cells at which two branches that cover them cross."""
    low, high = path.reach
    crossings = [np.empty(0)]
    for index, with_index in pairs_in_cells(cell):
        one, other = (
            branches.bows.take(branch[pair_places]) for pair_places in (index, with_index)
        )
        for places in one.crossings(other):
            real = np.flatnonzero(np.isfinite(places))
            points = one.take(real).evaluate(places[real])
            reached = np.flatnonzero((np.abs(points) > low) & (np.abs(points) < high))
            phi, _ = path.cam_coordinates(points[reached])
            inside = cell[index[real[reached]]]
            wide = cells.high[inside] - cells.low[inside]
            offset = np.remainder(phi - cells.low[inside], TURN)
            crossings.append(phi[(offset > 0.0) & (offset < wide)])
    return np.concatenate(crossings)


# -- roller path ----------------------------------------------------------------------------------
# The curve on which the roller centre runs when the roller is pressed against lines and arcs.
#
# It is the contour's parallel at the roller radius: a line gives a line, an arc a concentric arc, a
# corner the arc of the roller radius about it. Nothing is trimmed: where the contour turns in, or
# is too narrow for the roller, the parallel crosses itself, and the follower's place decides (see
# `holding_branches`). Each of its points is a roller radius from some point of the
# contour, so none can represent a place that the roller does not reach.


MOST_TURN = math.pi / 4.0
"""Largest sweep of a cut arc [rad]: the parameter of a bow is infinite at half a turn."""

POINT = 1e-12
"""An arc whose parallel has less than this fraction of its radius is a point of the roller path."""

SHARP = 0.75 * math.pi
"""A vertex at which the contour turns by more [rad] is a spike or a slot's end."""

BACKWARDS = TURN - 1e-6
"""A branch that seems to cover nearly the whole turn covers none: its ends differ by rounding, the
wrong way round. No branch covers more than a turn less the eighth by which arcs are cut."""


@dataclass(frozen=True, slots=True, eq=False)
class Parallel:
    """Pieces of a parallel of a contour, each a line or an arc.

    Attributes
    ----------
    bows : (m,) on which the pieces lie, known at their starts.
    lengths : (m,) parameters of the ends on the bows [mm]; negative where the piece runs back.
    ends : (m,) complex [mm], its ends.
    elements : (m,) numbers of the contour's pieces; -1 - k of those about vertex k.
    corners : (m,) [rad] turn of the contour at the vertex that a piece goes about; a full turn for
        all other pieces.
    """

    bows: Bows
    lengths: FloatArray
    ends: ComplexArray
    elements: IntArray
    corners: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Branches:
    """Stretches of lines and arcs that each cross the follower's path once at each cam angle.

    Attributes
    ----------
    bows : (m,) on which they lie.
    facing : (m,) +1 where the bow's normal has a part outward along the follower's path, else -1.
    lows, highs : (m,) cam angles [rad] in [0, 2 pi) between which they lie; high < low where a
        branch reaches across cam angle 0. Equal angles cover nothing.
    elements, corners : (m,), as of `Parallel`.
    """

    bows: Bows
    facing: FloatArray
    lows: FloatArray
    highs: FloatArray
    elements: IntArray
    corners: FloatArray

    def jet(
        self, path: FollowerPath, phi: FloatArray, index: IntArray, order: Literal[0, 2, 3]
    ) -> FloatArray:
        """(order + 1, n) lift with derivatives [mm or rad per rad^k] where the path at `phi` (n,)
        [rad] meets the branches `index` (n,).
        """
        bows = self.bows.take(index)
        q = path.meet(phi, bows, self.facing[index])
        if order:
            return bows.lift_jet(path, phi, q)[: order + 1]
        lift: FloatArray = path.outward * (q - path.start)
        return lift[np.newaxis]


def parallel(contour: Contour, distance: float) -> Parallel:
    """The parallel of `contour` at `distance` [mm], positive to its right-hand side.

    Between pieces that meet at an angle the arc about the vertex, run backwards where the contour
    turns in; none at distance 0, where a knife edge goes from piece to piece.

    Raises
    ------
    GeometryError
        If the contour has no extent or does not run counter-clockwise.
    """
    starts, ends = contour.vertices, contour.ends
    used = np.flatnonzero((starts != ends) | (contour.sweeps != 0.0))
    if not len(used) or not contour.area > 0.0:
        raise GeometryError("the contour must enclose an area and run counter-clockwise")
    starts, ends = starts[used], ends[used]
    sweeps, centres = contour.sweeps[used], contour.centres[used]
    arc, sense = sweeps != 0.0, np.sign(sweeps)
    chords = ends - starts
    first = _unit(np.where(arc, sense * (starts - centres), -1j * chords))
    last = np.where(arc, _unit(np.where(arc, sense * (ends - centres), 1.0)), first)
    curvatures = np.where(arc, sense / np.where(arc, np.abs(starts - centres), 1.0), 0.0)
    # The parallel at d scales the radius of an arc by 1 + kappa d; near 0 it is a point.
    share = 1.0 + curvatures * distance
    extended = np.flatnonzero(np.abs(share) > POINT)
    pieces = cut(
        starts[extended] + distance * first[extended],
        ends[extended] + distance * last[extended],
        first[extended],
        curvatures[extended] / share[extended],
        sweeps[extended],
        np.where(arc, 0.0, np.abs(chords))[extended],
        used[extended],
    )
    if distance == 0.0:
        return pieces
    following = np.roll(first, -1)
    turns = np.angle(following * last.conj())
    # Of a spike the sign of the turn is rounding, and beside a cusp of two arcs they may cross:
    # all places about such a vertex.
    sharp = np.abs(turns) > SHARP
    turns = np.where(sharp, TURN, turns)
    corners = cut(
        ends + distance * last,
        ends + distance * np.where(sharp, last, following),
        last,
        np.full(len(ends), 1.0 / distance),
        turns,
        np.zeros(len(ends)),
        -1 - np.roll(used, -1),
    )
    return joined([pieces, corners])


def branches(pieces: Parallel, path: FollowerPath) -> Branches:
    """Cut `pieces` where the follower's path is tangent to them, and where its reach ends.

    Parts beyond the reach are omitted.
    """
    low, high = path.reach
    bows = pieces.bows
    places = [path.touching(bows), bows.at_distance(low)]
    if math.isfinite(high):
        places.append(bows.at_distance(high))
    inner = np.concatenate(places)
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = inner / pieces.lengths
        # Places outside of a piece sort behind its end.
        shares[~((shares > 0.0) & (shares < 1.0))] = np.inf
    count = len(bows)
    shares = np.sort(np.concatenate((np.zeros((1, count)), shares, np.ones((1, count)))), axis=0)
    parts = np.sum(shares <= 1.0, axis=0) - 1
    index, rank = grouped(parts)
    begin, end = shares[rank, index], shares[rank + 1, index]
    bows, lengths = bows.take(index), pieces.lengths[index]
    middle = bows.evaluate(0.5 * (begin + end) * lengths)
    inside = (np.abs(middle) > low) & (np.abs(middle) < high)
    keep = np.flatnonzero(inside)
    index, begin, end, middle = index[keep], begin[keep], end[keep], middle[keep]
    bows, lengths = bows.take(keep), lengths[keep]
    phi, q = path.cam_coordinates(middle)
    along, _ = path.along(phi, q)
    normal = bows.unit_normals(middle)
    facing = np.where((normal.conj() * along).real < 0.0, -1.0, 1.0)
    starts = np.where(begin == 0.0, bows.points, bows.evaluate(begin * lengths))
    ends = np.where(end == 1.0, pieces.ends[index], bows.evaluate(end * lengths))
    first, _ = path.cam_coordinates(_clip_to_reach(starts, path.reach))
    last, _ = path.cam_coordinates(_clip_to_reach(ends, path.reach))
    # dphi along the curve has the sign of -sigma * facing, with its normal on the right.
    forward = path.rotation * facing * np.sign(lengths) < 0.0
    lows, highs = np.where(forward, first, last), np.where(forward, last, first)
    none = np.remainder(highs - lows, TURN) > BACKWARDS
    return Branches(
        bows=bows,
        facing=facing,
        lows=lows,
        highs=np.where(none, lows, highs),
        elements=pieces.elements[index],
        corners=pieces.corners[index],
    )


def cut(
    starts: ComplexArray,
    ends: ComplexArray,
    normals: ComplexArray,
    curvatures: FloatArray,
    turns: FloatArray,
    lengths: FloatArray,
    elements: IntArray,
) -> Parallel:
    """Arcs cut into parts of at most MOST_TURN; `lengths` (n,) of those that are lines, else 0."""
    parts = np.maximum(1, np.ceil(np.abs(turns) / MOST_TURN)).astype(np.intp)
    index, rank = grouped(parts)
    step = turns[index] / parts[index]
    normal = normals[index] * np.exp(1j * step * rank)
    kappa = curvatures[index]
    bent = kappa != 0.0
    # On a circle the point moves by the change of the normal over the curvature.
    shift = np.divide(normal - normals[index], kappa, out=np.zeros_like(normal), where=bent)
    point = starts[index] + shift
    # A part ends where the next one begins; the last one ends where its arc does.
    finish = np.where(rank + 1 == parts[index], ends[index], np.roll(point, -1))
    way = np.divide(2.0 * np.tan(0.5 * step), kappa, out=np.zeros_like(step), where=bent)
    return Parallel(
        Bows(point, normal, kappa),
        np.where(bent, way, lengths[index]),
        finish,
        elements[index],
        np.where(elements < 0, np.abs(turns), TURN)[index],
    )


def _unit(vectors: ComplexArray) -> ComplexArray:
    """(n,) in the directions of `vectors` (n,); 0 of 0."""
    size = np.abs(vectors)
    return np.asarray(np.divide(vectors, size, out=np.zeros_like(vectors), where=size > 0.0))


def _clip_to_reach(points: ComplexArray, reach: tuple[float, float]) -> ComplexArray:
    """(n,) `points` with those just beyond the reach moved to its border."""
    distance = np.abs(points)
    wanted = np.clip(distance, *reach)
    scale = np.divide(wanted, distance, out=np.ones_like(distance), where=distance > 0.0)
    return np.asarray(points * scale)


# -- spline contours ------------------------------------------------------------------------------
# The roller on a contour of cubic splines, arcs and lines.
#
# Its centre runs on the contour's parallel at the roller radius. That of a cubic has no closed
# form: the parameter at which the roller touches it is found by Newton's method to rounding, and
# the lift and its derivatives follow from the curvature of the parallel there and its change along
# it.
#
# All parallels together, with the arcs about the corners that turn out, are one chain. If the cam
# angle runs one way along each of them, the chain is the graph of a lift over the cam angle, so no
# other part of it holds the roller; else the replay is refused.


BEYOND: Final = 0.1
"""How far beyond [0, 1] parameters of a cubic are still tried."""

LOOKS: Final = 33
"""Parameters of each cubic at which its parallel is checked: it must be regular, and the cam
angle run one way. This is sampled, not proved; cubics of a fit turn by little."""

GAP: Final = 1e-9
"""Neighbouring branches meet within this cam angle [rad]: the rounding of their ends."""


@dataclass(frozen=True, slots=True, eq=False)
class Cubics:
    """Parallels of cubic Bezier pieces.

    Attributes
    ----------
    pieces : (n, 4) complex [mm] Bezier points.
    distance : of the parallels [mm], positive to the right-hand side.
    """

    pieces: ComplexArray
    distance: float

    def traced(
        self, index: IntArray, t: FloatArray
    ) -> tuple[ComplexArray, ComplexArray, FloatArray, FloatArray, FloatArray]:
        """Point, unit normal on the right, pace ds/dt, curvature [1/mm] and its change along the
        curve [1/mm^2] of the parallels `index` (n,) at `t` (n,).

        A parallel at d has the pace (1 + d kappa) times that of its curve, and the curvature
        kappa/(1 + d kappa).
        """
        b = self.pieces[index]
        w = 1.0 - t
        sides = 3.0 * np.diff(b, axis=1)
        bends = 2.0 * np.diff(sides, axis=1)
        point = (
            w**3 * b[:, 0] + 3.0 * w * w * t * b[:, 1] + 3.0 * w * t * t * b[:, 2] + t**3 * b[:, 3]
        )
        first = w * w * sides[:, 0] + 2.0 * w * t * sides[:, 1] + t * t * sides[:, 2]
        second = w * bends[:, 0] + t * bends[:, 1]
        third = bends[:, 1] - bends[:, 0]
        speed = np.abs(first)
        cross = (first.conj() * second).imag
        kappa = cross / speed**3
        # Derivative of kappa over t, from those of the cross product and of the speed.
        grown = (first.conj() * third).imag / speed**3 - 3.0 * kappa * dot(first, second) / speed**2
        share = 1.0 + self.distance * kappa
        normal = -1j * first / speed
        return (
            point + self.distance * normal,
            normal,
            speed * share,
            kappa / share,
            grown / (speed * share**3),
        )


@dataclass(frozen=True, slots=True, eq=False)
class SplineBranches:
    """What the roller runs on, arcs, then cubics; otherwise as `Branches`.

    Attributes
    ----------
    arcs : branches of lines and arcs.
    cubics : the others.
    starts, ends : (m,) cam angles [rad] at the parameters 0 and 1 of the cubics, each less than
        half a turn from the other, of any turn.
    elements, corners : (n,), as of `Parallel`.
    """

    arcs: Branches
    cubics: Cubics
    starts: FloatArray
    ends: FloatArray
    elements: IntArray
    corners: FloatArray

    def jet(
        self, path: FollowerPath, phi: FloatArray, index: IntArray, order: Literal[0, 2, 3]
    ) -> FloatArray:
        """See `Branches.jet`."""
        rows = np.empty((order + 1, len(phi)))
        first = len(self.arcs.elements)
        plain = index < first
        rows[:, plain] = self.arcs.jet(path, phi[plain], index[plain], order)
        curved = ~plain
        if np.any(curved):
            rows[:, curved] = self._cubics_jet(path, phi[curved], index[curved] - first, order)
        return rows

    def _cubics_jet(
        self, path: FollowerPath, phi: FloatArray, index: IntArray, order: int
    ) -> FloatArray:
        t = self.touching(path, phi, index)
        point, normal, _, kappa, slope = self.cubics.traced(index, t)
        _, q = path.cam_coordinates(point)
        jet = Bows(point, normal, kappa).lift_jet(path, phi, q, slope)
        return jet[: order + 1]

    def touching(self, path: FollowerPath, phi: FloatArray, index: IntArray) -> FloatArray:
        """(n,) parameters of the cubics `index` (n,) that the roller touches at `phi` (n,) [rad].

        Raises
        ------
        GeometryError
            If Newton's method finds none.
        """
        spans = self.ends[index] - self.starts[index]
        t = np.clip(_signed_angles(phi - self.starts[index]) / spans, 0.0, 1.0)
        for _ in range(STEPS):
            point, normal, pace, _, _ = self.cubics.traced(index, t)
            angles, q = path.cam_coordinates(point)
            # Along the parallel dZ = (Z_phi) dphi + (Z_q) dq; the part across the path is dphi's.
            across = np.conj(path.along(angles, q)[0])
            turning = (across * (-1j * path.rotation) * point).imag
            rate = (across * 1j * normal).imag * pace
            step = _signed_angles(phi - angles) * turning / rate
            moved = np.clip(t + step, -BEYOND, 1.0 + BEYOND)
            last = np.max(np.abs((moved - t) * spans), initial=0.0)
            t = moved
            if last <= SMALL_STEP * TURN:
                return t
        raise GeometryError("the roller does not touch the spline where it should")


def _spline_branches(
    contour: SplineContour, distance: float, path: FollowerPath
) -> tuple[SplineBranches, FloatArray, FloatArray]:
    """The chain, and where each of its branches begins and ends over the cam angle [rad]."""
    pieces = contour.pieces
    cubic = np.array([isinstance(piece, np.ndarray) for piece in pieces])
    beziers = np.array([piece for piece in pieces if isinstance(piece, np.ndarray)]).reshape(-1, 4)
    arcs = [piece for piece in pieces if not isinstance(piece, np.ndarray)]
    numbers = np.arange(len(pieces))
    plain = _arcs(arcs, numbers[~cubic], distance)
    cubics = Cubics(beziers, distance)
    ends = [_headings(piece) for piece in pieces]
    corners = _corners(pieces, ends, distance)
    straight = branches(joined([plain, corners]), path)
    if np.any(straight.facing < 0.0):
        raise _folded_error()
    starts, finishes = _cubic_ranges(cubics, path)
    forward = path.rotation < 0
    lows, highs = (starts, finishes) if forward else (finishes, starts)
    whole = SplineBranches(
        straight,
        cubics,
        starts,
        finishes,
        np.concatenate((straight.elements, numbers[cubic])),
        np.concatenate((straight.corners, np.full(len(beziers), TURN))),
    )
    return (
        whole,
        np.concatenate((straight.lows, _wrap_angles(lows))),
        np.concatenate((straight.highs, _wrap_angles(highs))),
    )


def _cubic_ranges(cubics: Cubics, path: FollowerPath) -> tuple[FloatArray, FloatArray]:
    """Cam angles (n,) [rad] at both ends of each parallel; raises if it is folded."""
    count = len(cubics.pieces)
    index = np.repeat(np.arange(count), LOOKS)
    t = np.tile(np.linspace(0.0, 1.0, LOOKS), count)
    point, normal, pace, _, _ = cubics.traced(index, t)
    angles, q = path.cam_coordinates(point)
    along, _ = path.along(angles, q)
    if not np.all((pace > 0.0) & (dot(normal, along) > 0.0)):
        raise _folded_error()
    rows = angles.reshape(count, LOOKS)
    # Unrolled step by step, as a cubic may cross cam angle 0.
    return rows[:, 0], rows[:, 0] + np.sum(_signed_angles(np.diff(rows, axis=1)), axis=1)


def _arcs(arcs: list[Arc], numbers: IntArray, distance: float) -> Parallel:
    """The parallels of lines and arcs."""
    starts, ends = (
        np.array([getattr(arc, end_name) for arc in arcs], complex) for end_name in ("start", "end")
    )
    sweeps = np.array([arc.sweep for arc in arcs])
    radii = np.array([arc.radius for arc in arcs])
    headings = [_headings(arc) for arc in arcs]
    first, last = (-1j * np.array([heading[k] for heading in headings], complex) for k in (0, 1))
    curved = sweeps != 0.0
    kappa = np.where(curved, np.sign(sweeps) / np.where(curved, radii, 1.0), 0.0)
    share = 1.0 + kappa * distance
    if np.any(share <= 0.0):
        raise _folded_error()
    lengths = np.where(curved, 0.0, np.abs(ends - starts))
    return cut(
        starts + distance * first, ends + distance * last, first, kappa / share, sweeps, lengths,
        numbers,
    )  # fmt: skip


def _corners(
    pieces: list[Arc | ComplexArray], headings: list[tuple[complex, complex]], distance: float
) -> Parallel:
    """The arcs about the vertices at which the contour turns."""
    first = np.array([heading[0] for heading in headings])
    last = np.roll([heading[1] for heading in headings], 1)
    turns = np.angle(first * last.conj())
    corner_places = np.flatnonzero(np.abs(turns) > CORNER)
    if np.any(turns[corner_places] * distance <= 0.0):
        raise GeometryError("the spline has a corner that turns towards the roller")
    starts = [piece[0] if isinstance(piece, np.ndarray) else piece.start for piece in pieces]
    vertices, arriving_normals, leaving_normals = (
        np.array(starts)[corner_places],
        -1j * last[corner_places],
        -1j * first[corner_places],
    )
    return cut(
        vertices + distance * arriving_normals,
        vertices + distance * leaving_normals,
        arriving_normals,
        np.full(len(corner_places), 1.0 / distance if distance else 0.0),
        turns[corner_places],
        np.zeros(len(corner_places)),
        -1 - corner_places,
    )


def _headings(piece: Arc | ComplexArray) -> tuple[complex, complex]:
    """Unit directions at both ends of a piece."""
    if isinstance(piece, np.ndarray):
        ways = complex(piece[1] - piece[0]), complex(piece[3] - piece[2])
    else:
        ways = piece.heading(piece.start), piece.heading(piece.end)
    return ways[0] / abs(ways[0]), ways[1] / abs(ways[1])


def _folded_error() -> GeometryError:
    """The error for a spline that the roller cannot follow from end to end."""
    return GeometryError(
        "the spline is curved more tightly than the roller, or runs along the follower's path"
    )


def _signed_angles(angles: FloatArray) -> FloatArray:
    """(n,) the same angles [rad] in [-pi, pi)."""
    return np.asarray(np.remainder(angles + 0.5 * TURN, TURN) - 0.5 * TURN)


def _wrap_angles(angles: FloatArray) -> FloatArray:
    """(n,) the same angles [rad] in [0, 2 pi)."""
    turned = np.remainder(angles, TURN)
    return np.where(turned < TURN, turned, 0.0)
