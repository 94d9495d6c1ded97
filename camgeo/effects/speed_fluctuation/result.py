"""Speed of a motor-driven cam over a turn in its steady state.

J omega domega/dphi = T_m(omega) - T(phi, omega, alpha) with alpha = omega domega/dphi, the moment
of inertia J of everything that turns with the camshaft, the torque T_m of the motor, and the drive
torque T of the cam, which includes the inertia of the follower (equation of motion of a machine
with one degree of freedom; Volmer, Getriebetechnik, chapter on dynamics). The solution is the speed
that repeats after each turn.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from camgeo.check.finding import Finding, held
from camgeo.effects.effect import Column, Quantity, Request
from camgeo.effects.force import all_borders, smooth_edges
from camgeo.effects.results import DRIVE_TORQUE, Turning
from camgeo.effects.shaft.course import course_of
from camgeo.effects.shaft.obstacles import refuse_shocks
from camgeo.effects.shaft.rate import Shaft
from camgeo.effects.sought import Feedback, Sought
from camgeo.effects.speed_fluctuation.errors import Steady, accurate
from camgeo.effects.speed_fluctuation.steady import SteadyTurn
from camgeo.effects.speed_fluctuation.table import MotorDrive
from camgeo.effects.touching import lost_contact
from camgeo.effects.wording import N_M, Label, at, left_over, placed, resolved_ends
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.numeric.extremes import Extreme, Extremes, piecewise_extremes
from camgeo.numeric.rounding import resolved
from camgeo.units import RPM


@dataclass(frozen=True, slots=True, eq=False)
class SpeedFluctuation(Turning):
    """The steady state.

    Attributes
    ----------
    steady : the speed over the cam angle, and its error.
    alpha : (n,) angular acceleration of the cam [rad/s^2] at n cam angles.
    mean_speed : over time [rad/s].
    fluctuation : difference of largest and smallest speed, divided by the mean.
    """

    steady: Steady
    alpha: Quantity
    mean_speed: float
    fluctuation: float

    @property
    def turn(self) -> SteadyTurn:
        """The speed over the cam angle."""
        return self.steady.turn

    @property
    def sought(self) -> tuple[Sought, ...]:
        """See `Turning`."""
        return (Sought(Label("speed", "rev/min", 1.0 / RPM), self.turn.omega, self.steady.speed),)

    def linearised(
        self, phi: FloatArray, rows: FloatArray, other: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """See `Turning`."""
        return self.turn.linearised(phi, rows, other)

    def fed_back(
        self, feedback: Feedback, told: Finding, beside: Sequence[float], rough: Self
    ) -> Self:
        """See `Turning`."""
        steady = replace(self.steady, beside=beside[0])
        errors = steady.figures()
        return replace(
            self,
            steady=steady,
            rough_course=rough.rough_course,
            feedback=feedback,
            findings=(*self.findings, told),
            errors={**errors, told.name: errors["cam speed"]},
        )


def compute(request: Request[MotorDrive]) -> SpeedFluctuation:
    """The steady state, to the tolerance.

    Raises
    ------
    EffectError
        "stall", if the motor cannot carry the cam through a turn; "shock", if the follower's
        velocity jumps; "jamming", if no acceleration satisfies the equation of motion with
        friction; and if the tolerance cannot be reached.
    """
    subject, data = request.subject, request.data
    drive = request.results[DRIVE_TORQUE]
    law, contact = drive.law, drive.contact
    edges = smooth_edges(subject.state.smooth_angles, contact.lasting)
    refuse_shocks(subject, law)
    shaft = Shaft(data.moment_of_inertia, data.motor)
    near = None if request.near is None else request.near.turn
    steady = accurate(shaft, law, edges, request.tolerance, near)
    switches = np.setdiff1d(steady.edges, edges)
    kinks = np.concatenate((subject.state.smooth_angles, all_borders(contact.lasting), switches))
    turn, mean, work = steady.turn, steady.mean, steady.work
    assert turn.rough is not None  # only that one has none

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
    fluctuation = resolved(speeds.highest.value - speeds.lowest.value, mean) / mean
    text = f"speed fluctuation {fluctuation:.5g}, largest minus smallest speed divided by the mean"
    found = (
        held("speed-fluctuation", text, fluctuation, data.limit),
        Finding(
            "mean-speed",
            "ok",
            f"mean speed {mean / RPM:.6g} rev/min over time; a disturbance of the speed decays to"
            f" {left_over(turn.slope)} of its size per turn",
            mean / RPM,
            unit="rev/min",
        ),
        *_extremes("speed", "speed", speeds, 1.0 / RPM, "rev/min"),
        *_extremes("motor-torque", "torque of the motor", torques, N_M, "N m"),
        Finding(
            "motor-work",
            "ok",
            f"work of the motor over a turn {N_M * work:.5g} J, of which the cam takes"
            f" {N_M * steady.taken:.5g} J",
            N_M * work,
            unit="J",
        ),
        Finding(
            "mean-motor-power",
            "ok",
            f"mean power of the motor {N_M * work / steady.period:.5g} W",
            N_M * work / steady.period,
            unit="W",
        ),
    )
    return SpeedFluctuation(
        steady=steady,
        course=course_of(turn, alpha, kinks),
        rough_course=course_of(turn.rough, alpha, kinks),
        mesh=turn.mesh,
        alpha=alpha,
        mean_speed=mean,
        fluctuation=fluctuation,
        findings=found,
        lost_contact=lost_contact(subject, normal, piecewise_extremes(normal, edges), edges, None),
        columns=(
            Column("cam speed", "rev/min", lambda phi, side: omega(phi, side) / RPM),
            Column("motor torque", "N m", lambda phi, side: N_M * motor(phi, side)),
        ),
        errors=steady.figures(),
    )


def _extremes(name: str, words: str, ends: Extremes, factor: float, unit: str) -> Iterator[Finding]:
    ends = resolved_ends(ends)
    for which, end in (("largest", ends.highest), ("smallest", ends.lowest)):
        found = Extreme(factor * end.value, end.place)
        sentence = f"{which} {words} {found.value:.6g} {unit} {at(found.place)}"
        yield placed(f"{which}-{name}", sentence, found, unit)
