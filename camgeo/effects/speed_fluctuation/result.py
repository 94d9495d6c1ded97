"""Speed of the cam over a turn in its steady state, driven by a motor.

J omega domega/dphi = T_m(omega) - T(phi, omega, alpha) with alpha = omega domega/dphi, J all that
turns with the camshaft, T_m the motor's torque, T the drive torque of the cam with the inertia of
the follower in it (equation of motion of a machine with one degree of freedom; Volmer,
Getriebetechnik, chapter on dynamics). Sought is the speed that is the same after each turn.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from camgeo.check.finding import Finding, held
from camgeo.effects.effect import Column, Quantity, Request, Result
from camgeo.effects.force import smooth_edges
from camgeo.effects.results import DRIVE_TORQUE
from camgeo.effects.speed_fluctuation.rate import Shaft
from camgeo.effects.speed_fluctuation.solve import refuse_shocks, solve
from camgeo.effects.speed_fluctuation.spec import Spec
from camgeo.effects.speed_fluctuation.steady import SteadyTurn
from camgeo.effects.told import N_M, at, loss_of_contact, placed
from camgeo.motion.motion import Side
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.extremes import Extreme, Extremes, piecewise_extremes
from camgeo.units import RPM, TURN


@dataclass(frozen=True, slots=True, eq=False)
class SpeedFluctuation(Result):
    """The steady state.

    Attributes
    ----------
    turn : the speed over the cam angle.
    alpha : (n,) angular acceleration of the cam [rad/s^2] at n cam angles.
    mean_speed : over time [rad/s].
    fluctuation : largest less smallest speed by the mean.
    """

    turn: SteadyTurn
    alpha: Quantity
    mean_speed: float
    fluctuation: float
    error: float = field(kw_only=True)


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
    edges = smooth_edges(subject.drive.smooth_angles, contact.forces)
    refuse_shocks(subject, law)
    shaft = Shaft(spec.moment_of_inertia, spec.motor)
    turn = solve(shaft, law, edges, request.tolerance)

    def omega(phi: FloatArray, _: Side) -> FloatArray:
        return turn.omega(phi)

    def motor(phi: FloatArray, _: Side) -> FloatArray:
        return shaft.motor.torque(turn.omega(phi))[0]

    def alpha(phi: FloatArray, side: Side) -> FloatArray:
        return shaft.rate(law(phi, side), turn.y(phi))[0]

    def normal(phi: FloatArray, side: Side) -> FloatArray:
        rates = np.stack((turn.omega(phi), alpha(phi, side)))
        return contact.normal_at(phi, side, rates)

    speeds, torques = piecewise_extremes(omega, edges), piecewise_extremes(motor, edges)
    mean = TURN / turn.period
    fluctuation = (speeds.highest.value - speeds.lowest.value) / mean
    motor_torque = shaft.motor.torque(np.sqrt(2.0 * (turn.state.base + turn.state.nodes)))[0]
    work = TURN * turn.mean(motor_torque)
    taken = work - shaft.inertia * TURN * turn.mean(turn.rates)
    told = f"speed fluctuation {fluctuation:.5g} (largest less smallest speed by the mean)"
    found = (
        held("speed-fluctuation", told, fluctuation, spec.limit),
        Finding(
            "mean-speed",
            "ok",
            f"mean speed {mean / RPM:.6g} rev/min over time; a disturbance of the speed falls to"
            f" {100.0 * turn.slope:.4g} % of itself in a turn",
            mean / RPM,
            unit="rev/min",
        ),
        *_extremes("speed", "speed", speeds, 1.0 / RPM, "rev/min"),
        *_extremes("motor-torque", "torque of the motor", torques, N_M, "N m"),
        Finding(
            "motor-work",
            "ok",
            f"work of the motor over a turn {N_M * work:.5g} J, taken by the cam"
            f" {N_M * taken:.5g} J",
            N_M * work,
            unit="J",
        ),
        Finding(
            "mean-motor-power",
            "ok",
            f"mean power of the motor {N_M * work / turn.period:.5g} W",
            N_M * work / turn.period,
            unit="W",
        ),
    )
    return SpeedFluctuation(
        turn=turn,
        alpha=alpha,
        mean_speed=mean,
        fluctuation=fluctuation,
        findings=found + loss_of_contact("speed-without-contact", "speed", subject, normal, edges),
        columns=(
            Column("cam speed", "rev/min", lambda phi, side: omega(phi, side) / RPM),
            Column("motor torque", "N m", lambda phi, side: N_M * motor(phi, side)),
        ),
        error=turn.error,
    )


def _extremes(name: str, words: str, ends: Extremes, factor: float, unit: str) -> Iterator[Finding]:
    for which, end in (("largest", ends.highest), ("smallest", ends.lowest)):
        found = Extreme(factor * end.value, end.place)
        sentence = f"{which} {words} {found.value:.6g} {unit} {at(found.place)}"
        yield placed(f"{which}-{name}", sentence, found, unit)
