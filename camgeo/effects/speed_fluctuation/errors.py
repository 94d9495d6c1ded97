"""How far the figures of the steady state may be off, and the turn that makes them accurate enough.

All follow from the error e of the speed. The torque of the motor is off by its slope times e, its
work over a turn by 2 pi times that; both may be small compared with the torque at standstill, so
the speed must be the more accurate. Mean values are integrals over the nodes of the cells; halving
the cells changes them by about their error.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.effects.effect import Bound, Quantity
from camgeo.effects.shaft.mesh import collocation, nodes_of
from camgeo.effects.shaft.rate import Shaft
from camgeo.effects.shaft.switches import switches
from camgeo.effects.speed_fluctuation.solve import solve
from camgeo.effects.speed_fluctuation.steady import SteadyTurn
from camgeo.effects.speed_fluctuation.table import Motor
from camgeo.effects.wording import N_M
from camgeo.errors import EffectError
from camgeo.numeric.arrays import FloatArray, merged
from camgeo.numeric.rounding import SHARE, resolved
from camgeo.units import RPM, TURN

ROUNDING: Final = 16.0 * 2.0**-52
"""Relative error of a speed between the nodes: of the sum of nine polynomials and a root."""

FINEST: Final = 256.0 * 2.0**-52
"""Smallest tolerance of the speed that is tried for the sake of the torque."""

ROUGH: Final = (1e-3, 1e-6)
"""Tolerances of the turns from which the places of kinks are taken. A kink off its place by d adds
an error of d^2, and d is as small as the error of the turn that it is taken from."""


@dataclass(frozen=True, slots=True, eq=False)
class Steady:
    """A steady turn with its mean values and the errors of all figures.

    Attributes
    ----------
    turn : the speed over the cam angle.
    edges : (k,) cam angles [rad] from 0 to 2 pi between which the acceleration is smooth.
    period : duration of the turn [s].
    work : of the motor over a turn [N mm], of which the cam takes `taken`.
    slowest, fastest : speeds at the nodes [rad/s].
    slope : of the torque of the motor, the steepest at these speeds [N mm s].
    largest : torque of motor or cam, the larger one [N mm]; the terms of the motor's own if both
        are rounding.
    period_error, work_error : changes on cells half as long [s], [N mm].
    beside : error of the speed that is not that of the solution for this torque law [rad/s].
    """

    turn: SteadyTurn
    edges: FloatArray
    period: float
    work: float
    taken: float
    slowest: float
    fastest: float
    slope: float
    largest: float
    period_error: float
    work_error: float
    beside: float = 0.0

    @property
    def mean(self) -> float:
        """Mean speed over time [rad/s]."""
        return TURN / self.period

    @property
    def speed(self) -> Bound:
        """Error of the speed [rad/s]."""
        own = (self.turn.error + ROUNDING) * self.fastest
        return Bound(own + self.beside, self.fastest)

    @property
    def torque(self) -> Bound:
        """Error of the torque of the motor [N mm]."""
        return Bound(self.slope * self.speed.error, self.largest)

    def figures(self) -> dict[str, Bound]:
        """The errors by the names of findings and columns."""
        # |d(1/omega)| <= e / omega^2, relative to the mean of 1/omega at most e / slowest.
        late = self.speed.error / self.slowest + self.period_error / self.period
        mean = Bound(self.mean * late, self.fastest)
        swing = (self.fastest - self.slowest) / self.mean
        shares = 2.0 * self.speed.error / self.mean + swing * late
        work = Bound(TURN * self.torque.error + self.work_error, TURN * self.largest)
        power = work.times(1.0 / self.period)
        power = Bound(power.error + abs(self.work) / self.period * late, power.scale)
        speeds = dict.fromkeys(("cam speed", "largest-speed", "smallest-speed"), self.speed)
        torques = ("motor torque", "largest-motor-torque", "smallest-motor-torque")
        return {
            **{name: bound.times(1.0 / RPM) for name, bound in speeds.items()},
            **dict.fromkeys(torques, self.torque.times(N_M)),
            "mean-speed": mean.times(1.0 / RPM),
            "speed-fluctuation": Bound(shares, self.fastest / self.mean),
            "motor-work": work.times(N_M),
            "mean-motor-power": power.times(N_M),
        }


def accurate(
    shaft: Shaft[Motor],
    law: Quantity,
    edges: FloatArray,
    tolerance: float,
    near: SteadyTurn | None,
) -> Steady:
    """The steady state, of which one that is `near` may be known; raises as `solve`.

    The speed is found to the tolerance, and so is the torque of the motor unless rounding of the
    speed is larger: a stiff motor has almost no slip, from which its torque follows. The error of
    the torque shows this.
    """
    turn = near
    for rough in ROUGH:
        if turn is None or rough < ROUGH[0]:
            turn = solve(shaft, law, edges, max(rough, tolerance), turn)
        found = _switches(shaft, law, edges, turn)
        if not len(found):
            break
        edges = merged(np.concatenate((edges, found)))
    steady = _measured(shaft, solve(shaft, law, edges, tolerance, turn), edges)
    worst = _worst(steady)
    if worst > tolerance:
        speed = max(0.5 * tolerance * steady.turn.error / worst, FINEST)
        with suppress(EffectError):
            steady = _measured(shaft, solve(shaft, law, edges, speed, steady.turn), edges)
    return steady


def _switches(
    shaft: Shaft[Motor], law: Quantity, edges: FloatArray, turn: SteadyTurn
) -> FloatArray:
    return switches(law, edges, turn.mesh.laws, lambda phi: (shaft, turn.y(phi)))


def _worst(found: Steady) -> float:
    return max(each.share for each in found.figures().values())


def _measured(shaft: Shaft[Motor], turn: SteadyTurn, edges: FloatArray) -> Steady:
    """The mean values, and the data from which their errors follow."""
    motor, mesh = shaft.motor, turn.mesh
    omega = np.sqrt(2.0 * (turn.state.base + turn.state.nodes))
    torque = motor.torque(omega)[0]
    middle = 0.5 * (mesh.low + mesh.high)
    halves = [(mesh.low, middle), (middle, mesh.high)]
    inner = [turn.omega(nodes_of(*ends).ravel()).reshape(omega.shape) for ends in halves]
    weights = 0.5 * mesh.spans[:, np.newaxis] * collocation().weights
    finer = [(np.sum(weights / each), np.sum(weights * motor.torque(each)[0])) for each in inner]
    period, work = (float(value) for value in np.sum(finer, axis=0))
    slowest, fastest = float(np.min(omega)), float(np.max(omega))
    slope = float(np.max(np.abs(_slopes(motor, slowest, fastest))))
    terms = float(np.max(np.abs(motor.torques))) + slope * (fastest + float(motor.speeds[-1]))
    cam = torque - shaft.inertia * turn.rates
    largest = max(float(np.max(np.abs(torque))), float(np.max(np.abs(cam))))
    taken = work - shaft.inertia * TURN * turn.mean(turn.rates)
    return Steady(
        turn=turn,
        edges=edges,
        period=period,
        work=resolved(work, TURN * terms),
        taken=resolved(taken, TURN * terms),
        slowest=slowest,
        fastest=fastest,
        slope=slope,
        largest=largest if largest > SHARE * terms else terms,
        period_error=abs(period - TURN * turn.mean(1.0 / omega)),
        work_error=abs(work - TURN * turn.mean(torque)),
    )


def _slopes(motor: Motor, slowest: float, fastest: float) -> FloatArray:
    """(k,) slopes [N mm s] of the lines of the motor's curve between two speeds [rad/s]."""
    inside = motor.speeds[(motor.speeds > slowest) & (motor.speeds < fastest)]
    return motor.torque(np.concatenate(([slowest], inside, [fastest])))[1]
