"""How cam and elastic train change each other, to first order: what a Newton step needs.

S is the speed omega over the cam angle that follows from a force F of the train, T the force that
follows from a speed (`camgeo.effects.feedback`). Their derivatives are matrices here, on an even
grid of cam angles, where D differentiates trigonometric polynomials (Trefethen, Spectral Methods in
MATLAB, chapter 3). A mode of the train has omega du/dphi = lambda u - y'', so that with changes d

    (omega D - lambda) du = -dy'' - (du/dphi) domega,    dy'' = 2 s'' omega domega + s' dalpha,

with dalpha = D (omega domega); and S' follows from the linear equations of `Turning.linearised`.
They are as accurate as the grid: what follows from them is a guess, which never decides an error
but by how large it is.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from camgeo.effects.effect import Quantity
from camgeo.effects.elastic import ElasticTrain
from camgeo.effects.force import Force, unmoved
from camgeo.effects.results import Turning
from camgeo.motion.motion import Motion
from camgeo.motion.time_course import TimeCourse
from camgeo.numeric.arrays import BoolArray, FloatArray, Side, read_only
from camgeo.units import TURN

ANGLES: Final = 383
"""Cam angles of the grid, an odd number."""

GRID: Final[FloatArray] = read_only(np.arange(ANGLES, dtype=np.float64) * np.float64(TURN / ANGLES))
"""(n,) cam angles [rad]."""

PER_PERIOD: Final = 8.0
"""Cam angles per period of a mode that the grid resolves, at least."""

SHARPNESS: Final = 36.0
"""Exponent of the filter of order 8 at the last harmonic: it leaves a rounding of that (Vandeven,
1991, on filters of spectral methods)."""


@dataclass(frozen=True, eq=False)
class Tangent:
    """The derivatives at some speed.

    Attributes
    ----------
    follow : (n, n) T' [N or N mm per rad/s].
    answer : (n, n) S'.
    """

    follow: FloatArray
    answer: FloatArray

    @cached_property
    def _whole(self) -> FloatArray:
        """(n, n) P = (1 - S'T')^-1."""
        return np.asarray(np.linalg.inv(np.eye(len(self.follow)) - self.answer @ self.follow))

    def ahead(self, missing: FloatArray) -> FloatArray:
        """(n,) what is still missing of the force [N or N mm] once what is `missing` (n,) is added,
        and what follows from it: T'S' (1 - T'S')^-1 = T' P S' of it.
        """
        return np.asarray(self.follow @ (self._whole @ (self.answer @ missing)))

    @property
    def sizes(self) -> tuple[float, float]:
        """The largest changes of the speed per unit of a change that a round makes by itself, in
        addition to this and in sum: the norms of P - 1 and of P.
        """
        one = np.eye(len(self.follow))
        found = [np.max(np.sum(np.abs(each), axis=1)) for each in (self._whole - one, self._whole)]
        return float(found[0]), float(found[1])


@dataclass(frozen=True, slots=True, eq=False)
class Passed:
    """The force that a train passes on, in place of that of a rigid one.

    Either the whole of it is that at `course`; then masses that it isolates do not take part in
    what is solved for. Or the mass behind it is accelerated at the speed that is solved for, and
    the difference is that at `course`: for a train so stiff that the grid does not resolve it.

    Attributes
    ----------
    motion : y of its base.
    behind : the train, with the cam turning as `course` says.
    """

    course: TimeCourse
    motion: Motion
    behind: ElasticTrain

    @property
    def resolved(self) -> BoolArray:
        """(m,) whether the grid resolves each of the modes."""
        behind = self.behind
        periods = behind.train.rates.imag * (behind.response.base.period / TURN)
        return np.asarray(PER_PERIOD * periods <= ANGLES)

    @property
    def kept(self) -> float:
        """The mass [t or t mm^2] that is accelerated at the speed that is solved for."""
        return 0.0 if np.all(self.resolved) else self.behind.mass

    def on_base(self, phi: FloatArray, side: Side) -> FloatArray:
        """(4, n) c0 to c3 on the base, without a load on the output, which a rigid train has
        there.
        """
        behind = self.behind
        out = np.zeros((4, len(phi)))
        out[0] = -behind.pushes(behind.response, phi, side)
        if behind.load is not None:
            out -= behind.load.coefficients(phi, side)
        if self.kept:
            out[0] += self.kept * behind.base(phi, side)[2]
        else:
            out[2:] = behind.mass * self.motion.jet(phi, side, 2)[2:0:-1]
        return out

    def force(self, smooth: FloatArray) -> Force:
        """The force, which is smooth between the angles `smooth` (m,) [rad]."""

        def on_follower(phi: FloatArray, side: Side) -> FloatArray:
            return self.on_base(phi, side) * self.behind.per_lift(phi, side)

        load, cuts = self.behind.load, self.behind.edges(smooth)
        borders = np.empty(0) if load is None else load.borders
        return Force("the elastic train", on_follower, borders=borders, cuts=cuts, far=self.on_base)


def tangent(passed: Passed, turn: Turning, law: Quantity, other: Quantity) -> Tangent:
    """The derivatives where the train passes on what is `passed`, and the cam turns as `turn` has
    found.

    Parameters
    ----------
    law : the torque law of `turn`.
    other : the law with a unit more of force on the base.
    """
    derive = _derivative()
    return Tangent(_follow(passed, derive), _answer(turn, law, other, derive))


def _derivative() -> FloatArray:
    """(n, n) D."""
    k = np.arange(ANGLES)
    apart = k[:, np.newaxis] - k
    with np.errstate(divide="ignore"):
        found = 0.5 * (-1.0) ** apart / np.sin(apart * (0.5 * TURN / ANGLES))
    found[k, k] = 0.0
    return np.asarray(found)


def _follow(passed: Passed, derive: FloatArray) -> FloatArray:
    behind, phi = passed.behind, GRID
    response, reading = behind.response, behind.train.force(0)
    omega = passed.course.rates(phi)[0]
    lift, velocity, _ = behind.base(phi, "right")
    _, first, second = passed.motion.jet(phi, "right", 2)[:3]
    speeding = derive * omega  # alpha is the derivative of omega^2 / 2
    pushed = np.diag(2.0 * second * omega) + first[:, np.newaxis] * speeding
    time = passed.course.time(phi) - passed.course.time(np.zeros(1))
    force = passed.kept * pushed - np.diag(reading.slope * first)
    rates, weights = behind.train.rates, reading.weights
    modes = zip(response.modes, rates, weights, passed.resolved, strict=True)
    for mode, rate, weight, resolved in modes:
        driven = -pushed
        if resolved:  # of others only the forcing is known here
            u = mode.values(time, "right")
            if response.forcing.soft:  # then it is driven by y
                u = -(velocity + rate * lift + rate**2 * u)
            driven = driven - np.diag(derive @ u)
        own = omega[:, np.newaxis] * derive - rate * np.eye(ANGLES)
        force = force - (weight * np.linalg.solve(own, driven)).real
    return np.asarray(force)


def _answer(turn: Turning, law: Quantity, other: Quantity, derive: FloatArray) -> FloatArray:
    slopes, off = turn.linearised(GRID, law(GRID, "right"), other(GRID, "right"))
    count, size = off.shape
    each = np.arange(count)
    matrix = np.zeros((size, count, size, count))
    sides = np.zeros((size, count, count))
    for row in range(size):
        matrix[row, :, row, :] = derive
        sides[row, each, each] = off[:, row]
        for column in range(size):
            matrix[row, each, column, each] -= slopes[:, row, column]
    solved = np.linalg.solve(matrix.reshape(size * count, -1), sides.reshape(size * count, -1))
    return np.asarray(solved[:count])


def on_base(behind: ElasticTrain, values: FloatArray) -> Force:
    """A force on the base of the train with the `values` [N or N mm] on an even grid, smooth
    between.
    """
    count = len(values)
    series = np.fft.rfft(values) / count
    # The last harmonics would make the series swing at jumps.
    series *= np.exp(-SHARPNESS * (2.0 * np.arange(len(series)) / count) ** 8)

    def far(phi: FloatArray, _: Side) -> FloatArray:
        z = np.exp(1j * phi)
        found = np.zeros(len(phi), dtype=np.complex128)
        for each in series[:0:-1]:
            found = (found + each) * z
        return np.asarray(series[0].real + 2.0 * found.real)

    def force(phi: FloatArray, side: Side) -> FloatArray:
        return far(phi, side) * behind.per_lift(phi, side)

    return Force("the elastic train, ahead", unmoved(force), far=unmoved(far))
