"""The part of the disc that holds the roller at each cam angle, and the resulting lift.

The roller is pressed along the follower's path until it touches: of all branches that the path
meets, the outermost holds a roller that is pressed inward, the innermost one that is pressed
outward, see `camgeo.outline.layers`.

A roller with play touches one flank of its groove, which lies half the groove's width from the
pitch curve, so that its centre runs on the pitch curve's parallel at half the clearance. At the cam
angle phi it touches the flank where the demanded motion would touch it at another cam angle theta:
the one at which the follower's path at phi meets the parallel.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal, Protocol

import numpy as np

from camgeo.curve.working_curve import WorkingCurve
from camgeo.errors import GeometryError
from camgeo.mechanism.follower_path import Bows, FollowerPath
from camgeo.mechanism.lift_jet import lift_jet
from camgeo.motion.motion import Motion
from camgeo.numeric.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
    Side,
    ascending,
    dot,
)
from camgeo.outline.layers import (
    NONE,
    Cells,
    Pairs,
    changes,
    covered,
    outermost,
    piece_at,
    seen,
    together,
)
from camgeo.outline.roller_path import Branches
from camgeo.units import TURN

STEPS = 40
"""Most Newton steps; the parallel is near the pitch curve, so five are already many."""

SETTLED = 64.0 * 2.0**-52
"""A step [rad] below this, a few roundings of a cam angle, is the last one."""

LONGEST = 0.2
"""Longest Newton step [rad]."""

AT = 1e-9
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
        angles, _ = self.path.cam_angle_of(self.parallel.point(theta))
        return ascending(angles)

    def leverage(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        """(n,) dn/dq of this lift, see `camgeo.curve.pitch_curve.PitchCurve.leverage`."""
        points, tangents, _ = self.parallel.traced(self._at_breaks(self.touching(phi)), side)
        angles, q = self.path.cam_angle_of(points)
        normals = 1j * self.parallel.pitch.rotation * tangents
        along, _ = self.path.along(angles, q)
        lever: FloatArray = self.path.outward * dot(normals, along)
        return lever

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
        at = self._at_breaks(theta)
        points, tangents, _ = self.parallel.traced(at, side)
        normals = 1j * self.parallel.pitch.rotation * tangents
        _, q = self.path.cam_angle_of(points)
        bows = Bows(points, normals, self.parallel.curvature(at, side))
        return lift_jet(self.path, phi, q, bows)[:3]

    def touching(self, phi: FloatArray) -> FloatArray:
        """(n,) theta [rad] at `phi` (n,) [rad], by Newton's method; raises as `jet`."""
        theta = np.asarray(phi, dtype=np.float64)
        for _ in range(STEPS):
            points, tangents, pace = self.parallel.traced(theta)
            angles, q = self.path.cam_angle_of(points)
            # Along the parallel dZ = (Z_phi) dphi + (Z_q) dq; the part across the path is dphi's.
            across = np.conj(self.path.along(angles, q)[0])
            turning = (across * (-1j * self.path.rotation) * points).imag
            rate = (across * tangents).imag * pace
            if np.any(rate * turning <= 0.0):
                break
            away = np.remainder(phi - angles + math.pi, TURN) - math.pi
            step = np.clip(away * turning / rate, -LONGEST, LONGEST)
            theta = theta + step
            if np.max(np.abs(step), initial=0.0) <= SETTLED * TURN:
                return theta
        raise GeometryError(
            "the play is too large to be followed: the follower's path does not meet the curve of"
            " the roller centre on that flank near by"
        )

    def _at_breaks(self, theta: FloatArray) -> FloatArray:
        """`theta` in one turn, on the breaks themselves where it is there to rounding."""
        breaks = np.append(self.parallel.breaks, self.parallel.breaks[:1] + TURN)
        turned = np.remainder(theta, TURN)
        above = np.searchsorted(breaks, turned)
        for index in (above - 1, np.minimum(above, len(breaks) - 1)) if len(breaks) else ():
            near = np.abs(turned - breaks[index]) <= AT
            turned = np.where(near, breaks[index], turned)
        return np.where(turned >= TURN, turned - TURN, turned)


AS_DEMANDED = NONE
"""Number of the branch that is the demanded motion itself, or that with the roller's play."""

SEAM = 1e-9
"""Width [rad] up to which a range without any branch is a seam: two branches meet there, and their
ends differ by rounding."""

HALF_ARC = 0.52
"""Half an arc of at most an eighth of a turn over its chord, at most: pi/16 / sin(pi/8)."""


class Touched(Protocol):
    """What a roller may run on, as `camgeo.outline.roller_path.Branches`."""

    @property
    def elements(self) -> IntArray: ...

    @property
    def corners(self) -> FloatArray: ...

    def jet(
        self, path: FollowerPath, phi: FloatArray, index: IntArray, order: Literal[0, 2, 3]
    ) -> FloatArray: ...


@dataclass(frozen=True, slots=True, eq=False)
class ActualLift:
    """The actual lift of a roller that is pressed against a disc, over the cam angle.

    Attributes
    ----------
    path : of the follower.
    motion : the demanded lift.
    branches : those that the roller may run on.
    borders : (k,) cam angles [rad] in [0, 2 pi), ascending, at which the branch changes.
    numbers : (k,) branch from each border to the next, or AS_DEMANDED.
    played : the motion that a roller with play makes where it is AS_DEMANDED; None without play.
    """

    path: FollowerPath
    motion: Motion
    branches: Touched
    borders: FloatArray
    numbers: IntArray
    played: PlayedLift | None = None

    @property
    def breaks(self) -> FloatArray:
        """(m,) cam angles [rad] where a derivative of the demanded or the played lift may jump."""
        if self.played is None:
            return self.motion.breaks
        return ascending(np.concatenate((self.motion.breaks, self.played.breaks)))

    @property
    def knots(self) -> FloatArray:
        """See `camgeo.outline.replay_result.DiscLift`."""
        if self.played is None:
            return self.motion.borders
        return ascending(np.concatenate((self.motion.borders, self.played.borders)))

    @property
    def as_demanded(self) -> bool:
        """See `camgeo.outline.replay_result.DiscLift`."""
        return self.played is None

    @property
    def outward(self) -> int:
        """See `camgeo.outline.replay_result.DiscLift`."""
        return self.path.outward

    def held_by(self, numbers: IntArray) -> tuple[IntArray, FloatArray]:
        """See `camgeo.outline.replay_result.DiscLift`."""
        return self.branches.elements[numbers], self.branches.corners[numbers]

    def heading(self, phi: FloatArray, jet: FloatArray) -> ComplexArray:
        """See `camgeo.outline.replay_result.DiscLift`: where the roller centre runs in the cam."""
        q = self.path.start + self.outward * jet[0]
        turn = -1j * self.path.rotation * self.path.point(phi, q)
        along, _ = self.path.along(phi, q)
        way: ComplexArray = turn + along * self.outward * jet[1]
        return way

    def shift_of(self, _: float, error: FloatArray) -> FloatArray:
        """See `camgeo.outline.replay_result.DiscLift`: as far as the roller centre is off."""
        at_start = np.zeros(1), np.full(1, self.path.start)
        along, point = self.path.along(*at_start)[0], self.path.point(*at_start)
        return np.asarray(abs(complex(along[0]) / complex(point[0])) * np.abs(error[0]))

    def without_corners(self, corner: float) -> ActualLift:
        """The same lift where the roller does not turn about corners of up to `corner` [rad]: the
        branch before one goes on, off by less than the square of the turn.
        """
        _, turns = self.held_by(self.numbers)
        kept = turns > corner
        return replace(self, borders=self.borders[kept], numbers=self.numbers[kept])

    def number(self, phi: FloatArray, side: Side = "right") -> IntArray:
        """(n,) the branch at `phi` (n,) [rad]."""
        return piece_at(self.borders, self.numbers, phi, side)

    def at(self, phi: FloatArray, side: Side = "right") -> FloatArray:
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
        """(order + 1, n) lift with derivatives."""
        number = self.number(phi, side)
        held = number != AS_DEMANDED
        out = np.empty((order + 1, len(phi)))
        if not np.all(held):
            made = self.motion if self.played is None else self.played
            out[:, ~held] = made.jet(phi[~held], side, max(order, 1))[: order + 1]
        if np.any(held):
            out[:, held] = self.branches.jet(self.path, phi[held], number[held], order)
        return out


def pressed(
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
    wanted = _wanted(nodes, starts, ends)
    cells = Cells.between(nodes)
    first = np.searchsorted(nodes, branches.lows)
    count = np.remainder(np.searchsorted(nodes, branches.highs) - first, len(nodes))
    cell, branch = covered(cells, first, count, "parallel at the roller radius lies")
    used = wanted[cell]
    cell, branch = cell[used], branch[used]
    _require_cover(cells, wanted, cell)
    cell, branch = _without_hidden(cells, cell, branch, branches, path, press)
    inner = _crossings(cells, cell, branch, branches, path)

    def height(chosen: IntArray, phi: FloatArray) -> FloatArray:
        return -press * path.meet(phi, branches.bows.take(chosen), branches.facing[chosen])

    borders, parent, held = outermost(cells, (cell, branch), inner, height)
    seam = np.flatnonzero(wanted[parent] & (held == AS_DEMANDED))
    for number in seam:
        held[number] = held[number - 1]
    return changes(borders, held)


def _wanted(nodes: FloatArray, starts: FloatArray, ends: FloatArray) -> BoolArray:
    """(m,) whether the cell from each node on is in one of the ranges, whose ends are nodes."""
    cell = np.arange(len(nodes))
    wanted = np.zeros(len(nodes), dtype=np.bool_)
    for start, end in zip(starts, ends, strict=True):
        first, last = np.searchsorted(nodes, (start, end % TURN))
        count = (last - first) % len(nodes) if end - start < TURN else len(nodes)
        wanted |= np.remainder(cell - first, len(nodes)) < count
    return wanted


def _without_hidden(
    cells: Cells,
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
    middle = 0.5 * (np.abs(ends[0]) + np.abs(ends[1]))
    half = HALF_ARC * np.abs(ends[1] - ends[0])
    near, far = path.coordinate(np.maximum(middle - half, 0.0)), path.coordinate(middle + half)
    low, high = (near, far) if press < 0 else (-far, -near)
    kept = np.ones(len(cell), dtype=np.bool_)
    kept[several] = seen(inner, low, high)
    return cell[kept], branch[kept]


def _require_cover(cells: Cells, wanted: BoolArray, cell: IntArray) -> None:
    bare = wanted & (np.bincount(cell, minlength=len(wanted)) == 0)
    bare &= cells.high - cells.low > SEAM
    if np.any(bare):
        place = np.degrees(cells.low[np.flatnonzero(bare)[0]])
        raise GeometryError(
            f"at cam angle {place:.6g} degrees the follower's path does not meet the contour; it"
            " must run once round the cam axis, within the follower's reach"
        )


def _crossings(
    cells: Cells, cell: IntArray, branch: IntArray, branches: Branches, path: FollowerPath
) -> FloatArray:
    """Cam angles (k,) [rad] inside cells at which two branches that cover them cross."""
    low, high = path.reach
    found = [np.empty(0)]
    for index, with_index in together(cell):
        one, other = (branches.bows.take(branch[each]) for each in (index, with_index))
        for places in one.crossings(other):
            real = np.flatnonzero(np.isfinite(places))
            points = one.take(real).at(places[real])
            reached = np.flatnonzero((np.abs(points) > low) & (np.abs(points) < high))
            phi, _ = path.cam_angle_of(points[reached])
            inside = cell[index[real[reached]]]
            wide = cells.high[inside] - cells.low[inside]
            offset = np.remainder(phi - cells.low[inside], TURN)
            found.append(phi[(offset > 0.0) & (offset < wide)])
    return np.concatenate(found)
