"""The result of a replay: the follower's motion on a disc next to the demanded one.

Two replays together give the play that a conjugate pair of real discs leaves the follower. Pressed
against the main disc alone it has the lift q_1, against the return disc alone q_2. Each disc stops
it on its side, so that it can be anywhere between them; where they overlap the rollers are
squeezed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal, Protocol

import numpy as np

from camgeo.errors import GeometryError
from camgeo.motion.motion import Motion
from camgeo.numeric.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
    Side,
    ascending,
    frozen,
)
from camgeo.numeric.extremes import (
    Extreme,
    Extremes,
    piecewise_extremes,
    piecewise_highest,
)
from camgeo.numeric.many import Quantity
from camgeo.numeric.roots import bracketed_roots
from camgeo.outline.acceleration_joints import AccelerationJoints
from camgeo.outline.replay_lift import AS_DEMANDED
from camgeo.units import TURN

AS_DEMANDED_ELEMENT = np.iinfo(np.intp).min
"""Number of the element that is the demanded motion itself: no piece or vertex has it."""

EQUAL: Final = 1e-12
"""Magnitudes that differ by less than this share of them differ by rounding."""

POLISHED: Final = 1e-6
"""Range [rad] on both sides of a largest value in which the root of its slope is its place."""


class DiscLift(Protocol):
    """The actual lift of a follower on a disc, over the cam angle.

    Attributes
    ----------
    motion : the demanded lift.
    outward : +1 if a positive lift moves the follower outward, else -1.
    borders : (k,) cam angles [rad] in [0, 2 pi), ascending, at which what holds it changes.
    numbers : (k,) what holds it from each border to the next, or AS_DEMANDED.
    breaks : (m,) cam angles [rad] where a derivative of what is demanded may jump.
    knots : (m,) the breaks and all other cam angles [rad] where its formula changes.
    as_demanded : whether the lift is the demanded one, exactly, where it is AS_DEMANDED: not that
        of a roller with play.
    """

    @property
    def motion(self) -> Motion: ...

    @property
    def outward(self) -> int: ...

    @property
    def borders(self) -> FloatArray: ...

    @property
    def breaks(self) -> FloatArray: ...

    @property
    def knots(self) -> FloatArray: ...

    @property
    def as_demanded(self) -> bool: ...

    @property
    def numbers(self) -> IntArray: ...

    def number(self, phi: FloatArray, side: Side = "right") -> IntArray:
        """(n,) number of what holds it at `phi` (n,) [rad], or AS_DEMANDED."""

    def held_by(self, numbers: IntArray) -> tuple[IntArray, FloatArray]:
        """(n,) the contour's elements, as of `Replay`, and (n,) the turns of the contour [rad] at
        vertices, a full turn elsewhere, for `numbers` (n,) other than AS_DEMANDED.
        """

    def at(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        """(n,) lift [mm or rad] at `phi` (n,) [rad]."""

    def jet(self, phi: FloatArray, side: Side = "right", order: Literal[2, 3] = 2) -> FloatArray:
        """(order + 1, n) lift with derivatives [mm or rad per rad^k] at `phi` (n,) [rad]; a roller
        with play has two only.
        """

    def heading(self, phi: FloatArray, jet: FloatArray) -> ComplexArray:
        """(n,) complex, a direction that turns where the velocity of `jet` (3, n) jumps."""

    def shift_of(self, joint: float, error: FloatArray) -> FloatArray:
        """(n,) [rad] how far from a `joint` [rad] of the demanded motion its place on the disc may
        lie, by the `error` (3, n) of the lift and its derivatives around it.
        """


@dataclass(frozen=True, slots=True, eq=False)
class Jumps:
    """Places at which the roller passes from one part of the disc to another with a jump.

    Attributes
    ----------
    phi : (k,) cam angles [rad] in [0, 2 pi), ascending.
    before, after : (k,) the value on both sides.
    """

    phi: FloatArray
    before: FloatArray
    after: FloatArray

    def __len__(self) -> int:
        return len(self.phi)

    def scaled(self, factor: float) -> Jumps:
        """The same jumps in another unit."""
        return Jumps(self.phi, factor * self.before, factor * self.after)

    @property
    def largest(self) -> Extreme | None:
        """The largest jump (after - before) with its cam angle; None if there is none."""
        if not len(self):
            return None
        index = int(np.argmax(np.abs(self.after - self.before)))
        return Extreme(float((self.after - self.before)[index]), float(self.phi[index]))


@dataclass(frozen=True, slots=True, eq=False)
class Replay:
    """The motion of the follower on a disc, next to the demanded one.

    Samples are for pictures. They lie on a regular grid and at both sides of every place where the
    formula of the actual or of the demanded motion changes; such a place occurs twice in `phi`, its
    left side first. What is largest is sought in the smooth pieces between these places, whatever
    the grid.

    Attributes
    ----------
    lift : the actual lift as a function of the cam angle.
    press : -1 if the roller is pressed inward, onto a disc, +1 if outward, into a ring.
    corner : corners up to this angle [rad] are ignored.
    phi : (n,) cam angles [rad] from 0 to 2 pi, ascending.
    demanded, actual : (3, n) lift with two derivatives [mm or rad per rad^k].
    element : (n,) number of the contour's piece that holds the roller, -1 - k at its vertex k, or
        of the outline's corner k; `AS_DEMANDED_ELEMENT` where the roller is where it should be.
    smooth : (n,) False at ignored corners, where the acceleration is meaningless.
    shocks : jumps of the velocity [mm or rad per rad], including those that are demanded.
    drops : jumps of the lift itself: the roller falls off an edge.
    demanded_velocity, demanded_acceleration : largest magnitudes [mm or rad per rad^k].
    """

    lift: DiscLift
    press: int
    corner: float
    phi: FloatArray
    demanded: FloatArray
    actual: FloatArray
    element: IntArray
    smooth: BoolArray
    shocks: Jumps
    drops: Jumps
    demanded_velocity: float
    demanded_acceleration: float

    def __post_init__(self) -> None:
        for name in ("phi", "demanded", "actual"):
            object.__setattr__(self, name, frozen(getattr(self, name), np.float64))
        object.__setattr__(self, "element", frozen(self.element, np.intp))
        object.__setattr__(self, "smooth", frozen(self.smooth, np.bool_))

    @property
    def lost(self) -> FloatArray:
        """(n,) lost stroke [mm or rad]: how far the roller gets beyond where it should be, into the
        disc. Negative where the disc holds it off.
        """
        difference: FloatArray = self.actual[0] - self.demanded[0]
        return self.press * self.lift.outward * difference

    @property
    def largest_loss(self) -> Extreme:
        """Largest lost stroke with its cam angle; 0 if there is none.

        Between the ends of smooth pieces it lies where both velocities are equal.
        """
        sense = self.press * self.lift.outward
        edges = self._edges_apart()
        found = piecewise_highest(lambda phi, side: sense * self._error(phi, side), edges)
        if found.value <= 0.0:
            return Extreme(0.0, found.place % TURN)
        beside = np.searchsorted(edges, found.place) + np.array([-1, 0])
        low = max(found.place - POLISHED, float(edges[max(beside[0], 0)]))
        high = min(found.place + POLISHED, float(edges[beside[1]]))
        ends = np.array([low, high])
        slopes = self._error(ends, "right", 1) if low < found.place < high else np.zeros(2)
        if slopes[0] * slopes[1] < 0.0:
            phi = bracketed_roots(
                lambda phi: self._error(phi, "right", 1), ends[:1], ends[1:], ends=slopes[:, None]
            )
            return Extreme(sense * float(self._error(phi, "right")[0]), float(phi[0]) % TURN)
        return Extreme(found.value, found.place % TURN)

    @property
    def largest_error(self) -> Extreme:
        """Difference actual - demanded lift of the largest magnitude, with its cam angle."""
        return _farthest(piecewise_extremes(self._error, self._edges_apart()))

    @property
    def velocity(self) -> Extreme | None:
        """Actual velocity of the largest magnitude, with its cam angle; None if it is unbounded,
        where the lift jumps.
        """
        return self._peak(lambda phi, side: self.lift.jet(phi, side)[1])

    @property
    def acceleration(self) -> Extreme | None:
        """Actual acceleration of the largest magnitude, with its cam angle; None as of `velocity`.

        At ignored corners it does not count.
        """
        return self._peak(self._acceleration)

    @property
    def largest_acceleration_error(self) -> Extreme | None:
        """Actual - demanded acceleration of the largest magnitude; None as of `velocity`.

        A joint where the demanded acceleration jumps lies on the disc only within the disc's
        position error; so close to one, a value between those of its two sides is not an error. Nor
        do ignored corners count.
        """
        if len(self.drops):
            return None
        motion, edges = self.lift.motion, edges_between(self.lift)
        joints = AccelerationJoints.between(self.lift, self.lift.jet, motion, edges)
        off = joints.deviation(
            lambda phi, side: self.lift.jet(phi, side)[2],
            lambda phi, side: motion.jet(phi, side, 2)[2],
        )

        def counted(phi: FloatArray, side: Side) -> FloatArray:
            return np.where(self._is_smooth(phi, side), off(phi, side), 0.0)

        return self._peak(counted, joints.ends)

    @property
    def ripple(self) -> float | None:
        """Largest error of the acceleration over its demanded peak; None if that is 0, or the error
        unbounded.
        """
        off = self.largest_acceleration_error if self.demanded_acceleration else None
        return None if off is None else abs(off.value) / self.demanded_acceleration

    @property
    def largest_shock(self) -> float | None:
        """Largest jump of the velocity over its demanded peak; None if that is 0."""
        if self.demanded_velocity == 0.0:
            return None
        jump = self.shocks.largest
        return 0.0 if jump is None else abs(jump.value) / self.demanded_velocity

    def _error(self, phi: FloatArray, side: Side, order: Literal[0, 1] = 0) -> FloatArray:
        """(n,) actual - demanded lift at `phi` (n,) [rad], or its first derivative."""
        actual = self.lift.jet(phi, side)[1] if order else self.lift.at(phi, side)
        return np.asarray(actual - self.lift.motion.jet(phi, side, 2 * order or 1)[order])

    def _acceleration(self, phi: FloatArray, side: Side) -> FloatArray:
        return np.where(self._is_smooth(phi, side), self.lift.jet(phi, side)[2], 0.0)

    def _is_smooth(self, phi: FloatArray, side: Side) -> BoolArray:
        """(n,) False at ignored corners."""
        return held_at(self.lift, self.lift.number(phi, side), self.corner)[1]

    def _edges_apart(self) -> FloatArray:
        """`edges_between` without those inside ranges in which the lift is the demanded one."""
        edges = edges_between(self.lift)
        if not self.lift.as_demanded:
            return edges
        apart = self.lift.number(0.5 * (edges[:-1] + edges[1:])) != AS_DEMANDED
        kept: FloatArray = edges[np.append(True, apart) | np.append(apart, True)]
        return kept

    def _peak(self, quantity: Quantity, more: FloatArray | None = None) -> Extreme | None:
        """Of the largest magnitude; it is smooth between `edges_between` and what there is `more`
        (k,) [rad].
        """
        if len(self.drops):
            return None
        edges = edges_between(self.lift)
        edges = edges if more is None else ascending(np.concatenate((edges, more)))
        return _farthest(piecewise_extremes(quantity, edges))


def edges_between(*lifts: DiscLift) -> FloatArray:
    """(k,) cam angles [rad] from 0 to 2 pi between which the lifts and what is demanded are
    smooth.
    """
    parts = [part for lift in lifts for part in (lift.borders, lift.knots)]
    return ascending(np.clip(np.concatenate((np.array([0.0, TURN]), *parts)), 0.0, TURN))


def held_at(lift: DiscLift, numbers: IntArray, corner: float) -> tuple[IntArray, BoolArray]:
    """(n,) the `element` and (n,) whether it is `smooth`, see `Replay`, where `numbers` (n,) hold
    the follower and corners up to `corner` [rad] are ignored.
    """
    element = np.full(len(numbers), AS_DEMANDED_ELEMENT)
    smooth = np.ones(len(numbers), dtype=np.bool_)
    held = numbers != AS_DEMANDED
    element[held], turns = lift.held_by(numbers[held])
    smooth[held] = turns > corner
    return element, smooth


def _farthest(found: Extremes) -> Extreme:
    """That of the larger magnitude, in the first turn; the highest one if they are equal but for
    rounding.
    """
    higher = found.highest.value >= -found.lowest.value * (1.0 - EQUAL)
    one = found.highest if higher else found.lowest
    return Extreme(one.value, one.place % TURN)


def play(main: Replay, other: Replay, phi: FloatArray, side: Side = "right") -> FloatArray:
    """(n,) play between the discs at the cam angles `phi` (n,) [rad], negative where they squeeze.

    In the unit of the lift [mm or rad]: outward times (q_2 - q_1), outward the sense of a lift that
    takes the main roller away from the cam axis.
    """
    outward = main.lift.outward
    return outward * (other.lift.at(phi, side) - main.lift.at(phi, side))


def closing_error(main: Replay, other: Replay) -> Extremes:
    """`extreme_play` between two discs.

    Raises
    ------
    GeometryError
        If both discs push the follower in the same sense, so that it is not between them.
    """
    if main.lift.outward == other.lift.outward:
        raise GeometryError("the two discs push the follower in the same sense: they do not close")
    return extreme_play(main, other)


def extreme_play(main: Replay, other: Replay) -> Extremes:
    """Smallest and largest `play` over the turn, between two discs, or between two flanks if `main`
    is on the inner one.
    """
    edges = edges_between(main.lift, other.lift)
    return piecewise_extremes(lambda phi, side: play(main, other, phi, side), edges)
