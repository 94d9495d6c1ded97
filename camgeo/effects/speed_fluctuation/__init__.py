"""Speed of the cam over a turn in its steady state, driven by a motor.

J omega domega/dphi = T_m(omega) - T(phi, omega, alpha) with alpha = omega domega/dphi, J all that
turns with the camshaft, T_m the motor's torque, T the drive torque of the cam with the inertia of
the follower in it (equation of motion of a machine with one degree of freedom; Volmer,
Getriebetechnik, chapter on dynamics). Sought is the speed that is the same after each turn.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Final, Protocol

import numpy as np

from camgeo.check.finding import Finding
from camgeo.effects.carrier import holds_both_ways
from camgeo.effects.effect import Column, Effect, Request, Subject, toucher
from camgeo.effects.force import Force, all_borders
from camgeo.effects.speed_fluctuation.findings import Balance, findings, loss_of_contact
from camgeo.effects.speed_fluctuation.mesh import Law
from camgeo.effects.speed_fluctuation.motor import parse_motor
from camgeo.effects.speed_fluctuation.rate import Shaft
from camgeo.effects.speed_fluctuation.solve import refuse_shocks, solve
from camgeo.effects.speed_fluctuation.steady import SteadyTurn
from camgeo.errors import GeometryError
from camgeo.motion.motion import Side
from camgeo.numeric.arrays import FloatArray, merged
from camgeo.numeric.peaks import piecewise_extremes
from camgeo.units import RPM, TURN

N_M: Final = 1e-3
"""N m in an N mm."""


class TorqueLaw(Protocol):
    """The torque as a law of the cam angle, see `camgeo.effects.drive_torque.law`."""

    @property
    def contact(self) -> ContactForce: ...

    def coefficients(self, phi: FloatArray, side: Side) -> FloatArray:
        """(6, n) see `camgeo.effects.speed_fluctuation.rate`."""


class ContactForce(Protocol):
    """What is asked of the effect contact-force."""

    @property
    def forces(self) -> Sequence[Force]: ...

    def normal_at(
        self, phi: FloatArray, side: Side, omega: FloatArray, alpha: FloatArray
    ) -> FloatArray: ...


class DriveTorque(Protocol):
    """What is asked of the effect drive-torque."""

    @property
    def law(self) -> TorqueLaw: ...


@dataclass(frozen=True, slots=True)
class Spec:
    """The table.

    Attributes
    ----------
    shaft : moment of inertia and motor.
    limit : allowed fluctuation of the speed; None if there is none.
    """

    shaft: Shaft
    limit: float | None


@dataclass(frozen=True, slots=True, eq=False)
class SpeedFluctuation:
    """The steady state.

    Attributes
    ----------
    turn : the speed over the cam angle.
    mean_speed : over time [rad/s].
    fluctuation : largest less smallest speed by the mean.
    findings, columns, error : see `camgeo.effects.effect.Result`.
    """

    turn: SteadyTurn
    shaft: Shaft
    law: Law = field(repr=False)
    mean_speed: float
    fluctuation: float
    findings: tuple[Finding, ...] = field(repr=False)
    columns: tuple[Column, ...] = field(repr=False)
    error: float

    def omega(self, phi: FloatArray) -> FloatArray:
        """(n,) speed of the cam [rad/s] at `phi` (n,) [rad]."""
        return self.turn.omega(phi)

    def alpha(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        """(n,) its angular acceleration [rad/s^2]."""
        return _alpha(self.turn, self.shaft, self.law, phi, side)


def parse(table: Mapping[str, Any]) -> Spec:
    """The table of the scene.

    Raises
    ------
    GeometryError
        With the key, if motor or moment of inertia are missing or make no sense.
    """
    inertia = table.get("moment_of_inertia")
    if inertia is None:
        raise GeometryError(
            "is missing: the moment of inertia of all that turns with the camshaft",
            key="moment_of_inertia",
        )
    if not inertia > 0.0:
        raise GeometryError(
            "without inertia the speed follows from no equation of motion; allowed is above 0",
            key="moment_of_inertia",
            value=f"{inertia:g}",
        )
    return Spec(Shaft(inertia, parse_motor(table)), table.get("limit"))


def compute(request: Request) -> SpeedFluctuation:
    """The steady state, to the tolerance.

    Raises
    ------
    EffectError
        "stall", if the motor does not carry the cam over a turn; "shock", if the follower's
        velocity jumps; "jamming", if friction leaves no acceleration; and if the tolerance cannot
        be reached.
    """
    subject, spec = request.subject, request.spec
    drive: DriveTorque = request.results["drive-torque"]
    law, contact = drive.law.coefficients, drive.law.contact
    edges = merged(np.concatenate((subject.smooth_angles, all_borders(contact.forces))))
    refuse_shocks(subject, law)
    turn = solve(spec.shaft, law, edges, request.tolerance)
    return _result(subject, spec, turn, law, contact, edges)


def _result(
    subject: Subject,
    spec: Spec,
    turn: SteadyTurn,
    law: Law,
    contact: ContactForce,
    edges: FloatArray,
) -> SpeedFluctuation:
    shaft = spec.shaft

    def omega(phi: FloatArray, _: Side) -> FloatArray:
        return turn.omega(phi)

    def motor(phi: FloatArray, _: Side) -> FloatArray:
        return shaft.motor.torque(turn.omega(phi))[0]

    def pressing(phi: FloatArray, side: Side) -> FloatArray:
        sense = 1.0 if subject.contact == "inner" else -1.0
        alpha = _alpha(turn, shaft, law, phi, side)
        return sense * contact.normal_at(phi, side, turn.omega(phi), alpha)

    speeds = piecewise_extremes(omega, edges)
    motor_torque = shaft.motor.torque(np.sqrt(2.0 * (turn.state.base + turn.state.nodes)))[0]
    work = TURN * turn.mean(motor_torque)
    balance = Balance(work, work - shaft.inertia * TURN * turn.mean(turn.rates), turn.period)
    mean = TURN / balance.period
    found = findings(speeds, piecewise_extremes(motor, edges), balance, turn.slope, spec.limit)
    if not holds_both_ways(subject):
        found += loss_of_contact(piecewise_extremes(pressing, edges), toucher(subject))
    return SpeedFluctuation(
        turn=turn,
        shaft=shaft,
        law=law,
        mean_speed=mean,
        fluctuation=(speeds.highest.value - speeds.lowest.value) / mean,
        findings=found,
        columns=(
            Column("cam speed", "rev/min", lambda phi, side: omega(phi, side) / RPM),
            Column("motor torque", "N m", lambda phi, side: N_M * motor(phi, side)),
        ),
        error=turn.error,
    )


def _alpha(turn: SteadyTurn, shaft: Shaft, law: Law, phi: FloatArray, side: Side) -> FloatArray:
    return shaft.rate(law(phi, side), turn.y(phi))[0]


EFFECT: Final = Effect(
    name="speed-fluctuation",
    title="speed of the cam on its motor",
    compute=compute,
    parse=parse,
    needs=("drive-torque",),
    tabled=True,
    numerical=True,
)
