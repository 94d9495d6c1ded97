"""The result of a replay: the follower's motion on a disc next to the demanded one.

Two replays together give the play that a conjugate pair of real discs leaves the follower. Pressed
against the main disc alone it has the lift q_1, against the return disc alone q_2. Each disc stops
it on its side, so that it can be anywhere between them; where they overlap the rollers are
squeezed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Protocol

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
from camgeo.numeric.extremes import Extreme, Extremes, piecewise_extremes
from camgeo.numeric.roots import bracketed_roots
from camgeo.units import TURN

AS_DEMANDED_ELEMENT = np.iinfo(np.intp).min
"""Number of the element that is the demanded motion itself: no piece or vertex has it."""

SHIFT = 4.0
"""A joint of the demanded motion lies on the disc within the disc's position error of its place;
this multiple of the error of the lift around it certainly covers it."""

AROUND = 0.02
"""Range [rad] on both sides of a joint from which the error of the lift around it is taken."""

SEAM = 1e-9
"""Least distance [rad] within which a joint is sought: rounding of cam angles."""


class DiscLift(Protocol):
    """The actual lift of a follower on a disc, over the cam angle.

    Attributes
    ----------
    motion : the demanded lift.
    outward : +1 if a positive lift moves the follower outward, else -1.
    borders : (k,) cam angles [rad] in [0, 2 pi), ascending, at which what holds it changes.
    numbers : (k,) what holds it from each border to the next, or AS_DEMANDED.
    breaks : (m,) cam angles [rad] where a derivative of what is demanded may jump.
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

    Samples lie on a regular grid and at both sides of every place where the formula of the actual
    or of the demanded motion changes; such a place occurs twice in `phi`, its left side first.

    Attributes
    ----------
    lift : the actual lift as a function of the cam angle.
    press : -1 if the roller is pressed inward, onto a disc, +1 if outward, into a ring.
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

        Between samples it lies where both velocities are equal.
        """
        lost = self.lost
        index = int(np.argmax(lost))
        if lost[index] <= 0.0:
            return Extreme(0.0, self._place(index))
        before = np.flatnonzero(self.phi < self.phi[index])[-1:]
        after = np.flatnonzero(self.phi > self.phi[index])[:1]
        near = self.phi[[*before, index, *after]]
        slopes = self._loss_velocity(near)
        for k in np.flatnonzero(slopes[:-1] * slopes[1:] < 0.0).tolist():
            ends = slopes[k : k + 2, np.newaxis]
            phi = bracketed_roots(self._loss_velocity, near[[k]], near[[k + 1]], ends=ends)
            apart = self.lift.at(phi) - self.lift.motion.jet(phi, "right", 1)[0]
            value = self.press * self.lift.outward * float(apart[0])
            if value > lost[index]:
                return Extreme(value, float(phi[0]) % TURN)
        return Extreme(float(lost[index]), self._place(index))

    def _loss_velocity(self, phi: FloatArray) -> FloatArray:
        """(n,) actual - demanded velocity at `phi` (n,) [rad]."""
        actual = self.lift.jet(phi)[1]
        return np.asarray(actual - self.lift.motion.jet(phi, "right", 2)[1])

    @property
    def largest_error(self) -> Extreme:
        """Difference actual - demanded lift of the largest magnitude, with its cam angle."""
        return self._largest(self.actual[0] - self.demanded[0])

    @property
    def velocity(self) -> Extreme:
        """Actual velocity of the largest magnitude, with its cam angle."""
        return self._largest(self.actual[1])

    @property
    def acceleration(self) -> Extreme:
        """Actual acceleration of the largest magnitude, with its cam angle."""
        return self._largest(np.where(self.smooth, self.actual[2], 0.0))

    @property
    def acceleration_error(self) -> FloatArray:
        """(n,) actual - demanded acceleration; 0 where `smooth` is False.

        A joint where the demanded acceleration jumps lies on the disc only within the disc's
        position error; so close to one, a value between those of its two sides is not an error.
        """
        return np.where(self.smooth, self._beyond_joints(), 0.0)

    @property
    def largest_acceleration_error(self) -> Extreme:
        """Of the largest magnitude, with its cam angle."""
        return self._largest(self.acceleration_error)

    @property
    def ripple(self) -> float | None:
        """Largest error of the acceleration over its demanded peak; None if that is 0."""
        if self.demanded_acceleration == 0.0:
            return None
        return abs(self.largest_acceleration_error.value) / self.demanded_acceleration

    @property
    def largest_shock(self) -> float | None:
        """Largest jump of the velocity over its demanded peak; None if that is 0."""
        if self.demanded_velocity == 0.0:
            return None
        jump = self.shocks.largest
        return 0.0 if jump is None else abs(jump.value) / self.demanded_velocity

    def _beyond_joints(self) -> FloatArray:
        """(n,) acceleration error; 0 between the two values of a joint."""
        motion = self.lift.motion
        errors = self.actual - self.demanded
        error = errors[2].copy()
        left, right = _accelerations(motion)
        for joint, before, after in zip(motion.breaks, left, right, strict=True):
            if before == after:
                continue
            away = np.abs(np.remainder(self.phi - joint + 0.5 * TURN, TURN) - 0.5 * TURN)
            shift = self.lift.shift_of(float(joint), errors[:, away < AROUND])
            reach = SEAM + SHIFT * float(np.max(shift, initial=0.0))
            near = away < reach
            low, high = min(before, after), max(before, after)
            actual = self.actual[2][near]
            error[near] = actual - np.clip(actual, low, high)
        return np.asarray(error)

    def _largest(self, values: FloatArray) -> Extreme:
        index = int(np.argmax(np.abs(values)))
        return Extreme(float(values[index]), self._place(index))

    def _place(self, index: int) -> float:
        return float(self.phi[index]) % TURN


def _accelerations(motion: Motion) -> tuple[FloatArray, FloatArray]:
    """(m,), (m,) demanded acceleration before and after each break."""
    if not len(motion.breaks):
        return np.empty(0), np.empty(0)
    return motion.jet(motion.breaks, "left", 2)[2], motion.jet(motion.breaks, "right", 2)[2]


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
    ends = np.array([0.0, TURN])
    borders = (ends, main.lift.borders, other.lift.borders, main.lift.motion.borders)
    edges = ascending(np.clip(np.concatenate(borders), 0.0, TURN))
    return piecewise_extremes(lambda phi, side: play(main, other, phi, side), edges)
