"""Coarse integration of single turns: whether the motor stalls, and where.

Orbits of dy/dphi = alpha(phi, y) never cross. One that ends its turn no slower than it began is
below a periodic orbit or is one. If all orbits either stall or lose speed over the turn, there is
none.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.effects.bearing_friction import FIXED, LINEAR, PER_LOAD
from camgeo.effects.bearing_friction import MOST_STEPS as MOST_TURNS
from camgeo.effects.effect import Quantity
from camgeo.effects.shaft.rate import Shaft, StuckError
from camgeo.effects.speed_fluctuation.table import Motor
from camgeo.numeric.arrays import FloatArray, frozen
from camgeo.units import TURN

STEPS: Final = 1440
"""Smallest number of steps per turn, of a quarter of a degree each."""

GAMMA: Final = 1.0 - math.sqrt(0.5)
"""Of the L-stable diagonally implicit Runge-Kutta method of two stages and order 2 (Hairer and
Wanner, Solving Ordinary Differential Equations II, section IV.6), suitable for stiff motors."""

MOST_STEPS: Final = 50
"""Largest number of Newton steps in a stage."""

CLOSE: Final = 1e-12
"""Relative change of y at which they end."""

HALVINGS: Final = 40
"""Bisections of the speed range that contains the slowest orbit that completes a turn."""

DOUBLINGS: Final = 60


@dataclass(frozen=True, slots=True, eq=False)
class Outcome:
    """Whether the cam reaches a steady state.

    Attributes
    ----------
    angles : (k,) ends of the steps [rad].
    y : (k,) of a turn that ends no slower than it began; None if the motor stalls.
    stall : cam angle [rad] of the stall, to the accuracy of a step; nan without one.
    """

    angles: FloatArray
    y: FloatArray | None
    stall: float


def outcome(shaft: Shaft[Motor], law: Quantity, edges: FloatArray) -> Outcome:
    """Whether there is a steady state, from single turns at different speeds.

    The range from 0 to a speed from which the cam slows down is bisected: an orbit that loses speed
    over the turn is an upper bound, one that stalls a lower bound. They converge to the slowest
    orbit that completes a turn; the motor stalls where the orbits below it come to rest.

    Raises
    ------
    StuckError
        If no acceleration satisfies the equation of motion with friction.
    """
    march = _march(shaft, law, edges)
    high = 0.5 * shaft.motor.no_load_speed**2
    for _ in range(DOUBLINGS):
        stalled = march.orbit(high)
        if stalled[-1] < high:
            break
        high *= 2.0
    low = 0.0
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        orbit = march.orbit(middle)
        if orbit[-1] == 0.0:
            low, stalled = middle, orbit
        elif orbit[-1] < middle:
            high = middle
        else:
            return Outcome(march.angles, frozen(orbit, np.float64), math.nan)
    return Outcome(march.angles, None, float(march.angles[len(stalled) - 1]))


@dataclass(frozen=True, slots=True, eq=False)
class _March:
    """Steps over a turn, with the law at the two stages of each."""

    inertia: float
    torque: Callable[[float], tuple[float, float]]
    angles: FloatArray
    laws: list[list[list[float]]]

    def orbit(self, y: float) -> list[float]:
        """y at the ends of the steps of the turn that begins with `y` [rad^2/s^2].

        It ends at the first 0, where the cam comes to rest.
        """
        course = [y]
        steps = np.diff(self.angles).tolist()
        for step, (inside, end) in zip(steps, self.laws, strict=True):
            own = GAMMA * step
            first = self._stage(inside, y, own, y)
            if first is not None:
                slope = (first - y) / own
                second = self._stage(end, y + (step - own) * slope, own, first)
            if first is None or second is None:
                return [*course, 0.0]
            y = second
            course.append(y)
        return course

    def _stage(self, law: list[float], known: float, step: float, y: float) -> float | None:
        """The y above 0 with y = known + step alpha(y), from a guess; None if there is none."""
        if known + step * self._rate(law, 0.0)[0] <= 0.0:
            return None
        y = max(y, np.finfo(np.float64).tiny)
        for _ in range(MOST_STEPS):
            alpha, growth = self._rate(law, y)
            new = y - (y - known - step * alpha) / max(1.0 - step * growth, 0.1)
            new = max(new, 0.1 * y)
            if abs(new - y) <= CLOSE * new:
                return new
            y = new
        return y

    def _rate(self, law: list[float], y: float) -> tuple[float, float]:
        """As `Shaft.rate`, for one number; the slope is 0 at rest."""
        omega = math.sqrt(2.0 * y)
        drive, slope = self.torque(omega)
        if len(law) != LINEAR:
            law = _linear(law, omega, drive / self.inertia, 1.0 / self.inertia)
        c0, c1, c2, c3, ahead, behind = law
        rest = c0 + omega * (c1 + omega * c2)
        gain = ahead if self.inertia * rest + c3 * drive >= 0.0 else behind
        if rest == 0.0 and c3 == 0.0:
            gain = 0.0
        moment = self.inertia + gain * c3
        if not moment > 0.0:
            raise StuckError
        alpha = (drive - gain * rest) / moment
        if omega == 0.0:
            return alpha, 0.0
        return alpha, (slope - gain * (c1 + 2.0 * omega * c2)) / (omega * moment)


def _linear(law: list[float], omega: float, alpha: float, slowing: float) -> list[float]:
    """As `RubbingLaw.linear`, for one cam angle."""
    count = (len(law) - FIXED) // PER_LOAD
    real, imag = FIXED, FIXED + 4 * count
    own = [
        [complex(law[real + k * count + i], law[imag + k * count + i]) for k in range(4)]
        for i in range(count)
    ]
    demand = law[0] + omega * (law[1] + omega * law[2]) + alpha * law[3]
    at = [a[0] + omega * (a[1] + omega * a[2]) + alpha * a[3] for a in own]
    flank = 0 if demand + law[8] * sum(map(abs, at)) >= 0.0 else 1
    u = 1.0 - 2.0 * flank
    torque, free, drag = law[4 + flank], u * law[6 + flank], u * law[8]
    real = FIXED + 8 * count + flank * count
    per = [complex(law[real + i], law[real + 2 * count + i]) for i in range(count)]
    slowed = [b - a[3] * torque * slowing for a, b in zip(own, per, strict=True)]
    moved = free + u * law[3] * torque * slowing
    least = min(free - drag * sum(map(abs, per)), moved - drag * sum(map(abs, slowed)))
    if not least > 0.0:
        raise StuckError
    n, d = -math.inf if drag > 0.0 else math.inf, [_unit(b, 1.0) for b in slowed]
    for _ in range(MOST_TURNS):
        share = sum((e.conjugate() * a).real for e, a in zip(d, at, strict=True))
        carried = moved - drag * sum(
            (e.conjugate() * b).real for e, b in zip(d, slowed, strict=True)
        )
        new = (u * demand + drag * share) / carried
        if not drag * (new - n) > 0.0:
            break
        n = new
        d = [_unit(a + b * n, e) for a, b, e in zip(at, slowed, d, strict=True)]
    shares = [
        sum((e.conjugate() * a[k]).real for e, a in zip(d, own, strict=True)) for k in range(4)
    ]
    carried = law[6 + flank] - law[8] * sum(
        (e.conjugate() * b).real for e, b in zip(d, per, strict=True)
    )
    gain = torque / carried
    return [*(c + law[8] * each for c, each in zip(law[:4], shares, strict=True)), gain, gain]


def _unit(vector: complex, otherwise: complex) -> complex:
    return vector / abs(vector) if vector else otherwise


def _march(shaft: Shaft[Motor], law: Quantity, edges: FloatArray) -> _March:
    counts = np.ceil(np.diff(edges) * (STEPS / TURN)).astype(np.intp)
    grids = [
        np.linspace(a, b, count + 1)[:-1]
        for a, b, count in zip(edges[:-1], edges[1:], counts, strict=True)
    ]
    angles = np.append(np.concatenate(grids), edges[-1])
    low, high = angles[:-1], angles[1:]
    laws = np.stack((law(low + GAMMA * (high - low), "right"), law(high, "left")))
    return _March(shaft.inertia, _plain(shaft.motor), angles, laws.transpose(2, 0, 1).tolist())


def _plain(motor: Motor) -> Callable[[float], tuple[float, float]]:
    """`Motor.torque` for one number."""
    speeds, torques = motor.speeds.tolist(), motor.torques.tolist()
    slopes = (np.diff(motor.torques) / np.diff(motor.speeds)).tolist()

    def torque(omega: float) -> tuple[float, float]:
        row = min(max(bisect_right(speeds, omega) - 1, 0), len(slopes) - 1)
        return torques[row] + slopes[row] * (omega - speeds[row]), slopes[row]

    return torque
