"""Speed of the cam over a turn in its steady state, driven by a motor.

J omega domega/dphi = T_m(omega) - T(phi, omega, alpha) with alpha = omega domega/dphi, J all that
turns with the camshaft, T_m the motor's torque, T the drive torque of the cam with the inertia of
the follower in it (equation of motion of a machine with one degree of freedom; Volmer,
Getriebetechnik, chapter on dynamics). Sought is the speed that is the same after each turn.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

import numpy as np

from camgeo.effects.effect import Column, Request, Result
from camgeo.effects.force import all_borders
from camgeo.effects.results import DRIVE_TORQUE
from camgeo.effects.speed_fluctuation.findings import Balance, findings
from camgeo.effects.speed_fluctuation.mesh import Law
from camgeo.effects.speed_fluctuation.rate import Shaft
from camgeo.effects.speed_fluctuation.solve import refuse_shocks, solve
from camgeo.effects.speed_fluctuation.spec import Spec
from camgeo.effects.speed_fluctuation.steady import SteadyTurn
from camgeo.effects.told import loss_of_contact
from camgeo.motion.motion import Side
from camgeo.numeric.arrays import FloatArray, merged
from camgeo.numeric.extremes import piecewise_extremes
from camgeo.units import RPM, TURN

N_M: Final = 1e-3
"""N m in an N mm."""


@dataclass(frozen=True, slots=True, eq=False)
class SpeedFluctuation(Result):
    """The steady state.

    Attributes
    ----------
    turn : the speed over the cam angle.
    mean_speed : over time [rad/s].
    fluctuation : largest less smallest speed by the mean.
    """

    turn: SteadyTurn
    shaft: Shaft
    law: Law = field(repr=False)
    mean_speed: float
    fluctuation: float
    error: float = field(kw_only=True)

    def omega(self, phi: FloatArray) -> FloatArray:
        """(n,) speed of the cam [rad/s] at `phi` (n,) [rad]."""
        return self.turn.omega(phi)

    def alpha(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        """(n,) its angular acceleration [rad/s^2]."""
        return _alpha(self.turn, self.shaft, self.law, phi, side)


def compute(request: Request[Spec]) -> SpeedFluctuation:
    """The steady state, to the tolerance.

    Raises
    ------
    EffectError
        "stall", if the motor does not carry the cam over a turn; "shock", if the follower's
        velocity jumps; "jamming", if friction leaves no acceleration; and if the tolerance cannot
        be reached.
    """
    subject, spec = request.subject, request.spec
    drive = request.results[DRIVE_TORQUE]
    law, contact = drive.law, drive.contact
    edges = merged(np.concatenate((subject.cam.drive.smooth_angles, all_borders(contact.forces))))
    refuse_shocks(subject, law)
    shaft = Shaft(spec.moment_of_inertia, spec.motor)
    turn = solve(shaft, law, edges, request.tolerance)

    def omega(phi: FloatArray, _: Side) -> FloatArray:
        return turn.omega(phi)

    def motor(phi: FloatArray, _: Side) -> FloatArray:
        return shaft.motor.torque(turn.omega(phi))[0]

    def normal(phi: FloatArray, side: Side) -> FloatArray:
        alpha = _alpha(turn, shaft, law, phi, side)
        return contact.normal_at(phi, side, np.stack((turn.omega(phi), alpha)))

    speeds = piecewise_extremes(omega, edges)
    motor_torque = shaft.motor.torque(np.sqrt(2.0 * (turn.state.base + turn.state.nodes)))[0]
    work = TURN * turn.mean(motor_torque)
    balance = Balance(work, work - shaft.inertia * TURN * turn.mean(turn.rates), turn.period)
    mean = TURN / balance.period
    found = findings(speeds, piecewise_extremes(motor, edges), balance, turn.slope, spec.limit)
    return SpeedFluctuation(
        turn=turn,
        shaft=shaft,
        law=law,
        mean_speed=mean,
        fluctuation=(speeds.highest.value - speeds.lowest.value) / mean,
        findings=found + loss_of_contact("speed-without-contact", "speed", subject, normal, edges),
        columns=(
            Column("cam speed", "rev/min", lambda phi, side: omega(phi, side) / RPM),
            Column("motor torque", "N m", lambda phi, side: N_M * motor(phi, side)),
        ),
        error=turn.error,
    )


def _alpha(turn: SteadyTurn, shaft: Shaft, law: Law, phi: FloatArray, side: Side) -> FloatArray:
    return shaft.rate(law(phi, side), turn.y(phi))[0]
