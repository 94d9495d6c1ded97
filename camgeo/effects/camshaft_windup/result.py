"""Windup of a camshaft: the angle by which the cam lags behind its drive, over a turn.

J omega domega/dphi = M - T(phi, omega, alpha), where the shaft carries M = k w + c (Omega - omega)
with the windup w = integral of (Omega - omega) dt: the equation of motion of a rigid cam at the end
of a massless shaft, whose other end turns at the constant speed Omega, with the torque T of the cam
that includes the inertia of the follower (Koster, Vibrations of Cam Mechanisms, and Norton, Cam
Design and Manufacturing Handbook, chapter on models of cam-follower systems, treat such shafts).
The solution is the motion that repeats after each turn of the drive. With k towards infinity w
becomes T / k.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Final, Self

import numpy as np

from camgeo.check.finding import Finding, Severity, held
from camgeo.effects.camshaft_windup.periodic import WoundTurn
from camgeo.effects.camshaft_windup.solve import solve
from camgeo.effects.camshaft_windup.table import ElasticShaft
from camgeo.effects.camshaft_windup.wound import Wound
from camgeo.effects.effect import Bound, Column, Quantity, Request
from camgeo.effects.force import smooth_edges
from camgeo.effects.ranges import ranges_below
from camgeo.effects.results import DRIVE_TORQUE, Turning
from camgeo.effects.shaft.course import course_of
from camgeo.effects.shaft.obstacles import refuse_shocks
from camgeo.effects.sought import Feedback, Sought
from camgeo.effects.touching import lost_contact
from camgeo.effects.wording import N_M, Label, extreme_findings, left_over, over, placed
from camgeo.errors import EffectError
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.numeric.extremes import Extreme, Extremes, piecewise_extremes
from camgeo.units import RPM, TURN

BETWEEN_NODES: Final = 16.0 * 2.0**-52
"""Relative error of a value between the nodes: of the sum of nine polynomials."""

REVERSED: Final = 1e-3
"""A torque against that of the drive by less than this share of the largest does not count: a shaft
swings on a little after each move."""

LASTING: Final = 1e-6
"""Without damping the share of a disturbance that is left after a turn is 1, to this accuracy."""

FINEST: Final = 256.0 * 2.0**-52
"""Smallest tolerance that is tried for the sake of the torque."""


@dataclass(frozen=True, slots=True, eq=False)
class CamshaftWindup(Turning):
    """The steady state.

    Attributes
    ----------
    turn : speed and windup over the cam angle.
    """

    turn: WoundTurn

    @property
    def sought(self) -> tuple[Sought, ...]:
        """See `Turning`."""
        speed, windup = _bounds(self.turn)
        return (
            Sought(Label("speed", "rev/min", 1.0 / RPM), self.turn.omega, speed),
            Sought(Label("windup", "deg", math.degrees(1.0)), self.turn.windup, windup),
        )

    def linearised(
        self, phi: FloatArray, rows: FloatArray, other: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """See `Turning`."""
        return self.turn.linearised(phi, rows, other)

    def fed_back(
        self, feedback: Feedback, told: Finding, beside: Sequence[float], rough: Self
    ) -> Self:
        """See `Turning`."""
        turn = replace(
            self.turn,
            speed_error=self.turn.speed_error + beside[0],
            windup_error=self.turn.windup_error + beside[1],
            multiplier_error=self.turn.multiplier_error
            + abs(self.turn.multiplier - rough.turn.multiplier),
        )
        errors = errors_of(turn)
        return replace(
            self,
            turn=turn,
            rough_course=rough.rough_course,
            feedback=feedback,
            findings=(*self.findings, told),
            errors={**errors, told.name: errors["cam speed"]},
        )


def compute(request: Request[ElasticShaft]) -> CamshaftWindup:
    """The steady state, with speed and windup to the tolerance.

    Raises
    ------
    EffectError
        "shock", if the follower's velocity jumps; and as `solve`.
    """
    subject, data = request.subject, request.data
    drive = request.results[DRIVE_TORQUE]
    law, contact = drive.law, drive.contact
    edges = smooth_edges(subject.state.smooth_angles, contact.lasting)
    refuse_shocks(subject, law)
    speed = float(request.course.rates(np.zeros(1))[0, 0])
    wound = Wound(data, speed)
    near = None if request.near is None else request.near.turn
    turn, edges = _accurate(wound, law, edges, request.tolerance, near)
    assert turn.rough is not None  # only that one has none

    def omega(phi: FloatArray, _: Side) -> FloatArray:
        return turn.omega(phi)

    def windup(phi: FloatArray, _: Side) -> FloatArray:
        return turn.windup(phi) * math.degrees(1.0)

    def torque(phi: FloatArray, _: Side) -> FloatArray:
        shaft, y = turn.driven(phi)
        return N_M * shaft.motor.torque(np.sqrt(2.0 * y))[0]

    def alpha(phi: FloatArray, side: Side) -> FloatArray:
        shaft, y = turn.driven(phi)
        return shaft.rate(law(phi, side), y)[0]

    def normal(phi: FloatArray, side: Side) -> FloatArray:
        rates = np.stack((turn.omega(phi), alpha(phi, side)))
        return contact.normal_at(phi, side, rates)

    windups, torques, speeds = (piecewise_extremes(each, edges) for each in (windup, torque, omega))
    speeds = Extremes(*(Extreme(each.value / RPM, each.place) for each in _ends(speeds)))
    largest = max(_ends(windups), key=lambda each: abs(each.value))
    span = windups.highest.value - windups.lowest.value
    limit = None if data.limit is None else math.degrees(data.limit)
    found = (
        held(
            "windup",
            f"the cam is off the angle of its drive by up to {abs(largest.value):.6g} deg",
            abs(largest.value), limit, "deg", largest.place,
        ),
        *extreme_findings("windup", "windup", windups, "deg"),
        Finding(
            "windup-range",
            "ok",
            f"over a turn the windup varies by {span:.6g} deg",
            span,
            unit="deg",
        ),
        *extreme_findings("shaft-torque", "torque in the camshaft", torques, "N m"),
        *_reversal(torque, edges, torques),
        *extreme_findings("speed", "speed of the cam", speeds, "rev/min"),
        *_swinging(turn),
    )  # fmt: skip
    return CamshaftWindup(
        turn=turn,
        course=course_of(turn, alpha, edges),
        rough_course=course_of(turn.rough, alpha, edges),
        mesh=turn.mesh,
        findings=found,
        lost_contact=lost_contact(subject, normal, piecewise_extremes(normal, edges), edges, None),
        columns=(
            Column("windup", "deg", windup, limit),
            Column("shaft torque", "N m", torque),
            Column("cam speed", "rev/min", lambda phi, side: omega(phi, side) / RPM),
        ),
        errors=errors_of(turn),
    )


def _accurate(
    wound: Wound, law: Quantity, edges: FloatArray, tolerance: float, near: WoundTurn | None
) -> tuple[WoundTurn, FloatArray]:
    """As `solve`, with all figures to the tolerance unless rounding of the speed is larger."""
    found = solve(wound, law, edges, tolerance, near)
    worst = max(each.share for each in errors_of(found[0]).values())
    if worst > tolerance:
        with suppress(EffectError):
            finer = max(0.5 * tolerance * tolerance / worst, FINEST)
            return solve(wound, law, edges, finer, found[0])
    return found


def _ends(ends: Extremes) -> tuple[Extreme, Extreme]:
    return ends.lowest, ends.highest


def _reversal(torque: Quantity, edges: FloatArray, ends: Extremes) -> Iterator[Finding]:
    """Where the `torque` in the shaft reverses."""
    least = -REVERSED * ends.magnitude
    if ends.lowest.value >= least or ends.highest.value <= 0.0:
        return
    ranges = ranges_below(torque, edges, least, ends.lowest)
    yield placed(
        "torque-reversal",
        f"the cam drives its camshaft {over([(each.start, each.end) for each in ranges])}: where"
        " the torque in it reverses, play between drive and cam is crossed, with impacts that are"
        " not included in any value",
        ends.lowest,
        "N m",
        0.0,
        "warning",
    )


def _swinging(turn: WoundTurn) -> Iterator[Finding]:
    """How the cam swings on its shaft, and whether it comes to the steady state by itself."""
    natural, left = turn.wound.shaft.natural_frequency, 100.0 * turn.multiplier
    yield Finding(
        "natural-frequency",
        "ok",
        f"the cam without its follower swings on the camshaft at {natural / TURN:.6g} Hz,"
        f" {natural / turn.wound.speed:.5g} times the speed of its drive",
        natural / TURN,
        unit="Hz",
    )
    sentence = f"{left_over(turn.multiplier)} of a disturbance is left after a turn"
    severity: Severity = "ok"
    if abs(turn.multiplier - 1.0) <= LASTING:
        severity = "warning"
        sentence += ": without damping, the cam does not come to this steady state by itself"
    elif turn.multiplier > 1.0:
        severity = "broken"
        sentence += ": the steady state is unstable, and the cam does not stay in it"
    yield Finding("settling", severity, sentence, left, unit="%")


def _bounds(turn: WoundTurn) -> tuple[Bound, Bound]:
    """The errors of speed [rad/s] and windup [rad]."""
    speed, largest = turn.wound.speed, turn.pair.largest_windup
    return (
        Bound(turn.speed_error + BETWEEN_NODES * speed, speed),
        Bound(turn.windup_error + BETWEEN_NODES * largest, largest),
    )


def errors_of(turn: WoundTurn) -> dict[str, Bound]:
    """The errors by the names of findings and columns."""
    shaft, (speed, windup) = turn.wound.shaft, _bounds(turn)
    torque = Bound(
        shaft.stiffness * windup.error + shaft.viscosity * speed.error,
        shaft.stiffness * windup.scale,
    )
    torques = ("shaft torque", "largest-shaft-torque", "smallest-shaft-torque", "torque-reversal")
    windups = ("windup", "largest-windup", "smallest-windup")
    speeds = ("cam speed", "largest-speed", "smallest-speed")
    left = Bound(turn.multiplier_error, max(turn.multiplier, 1.0))
    return {
        "settling": left.times(100.0),
        **dict.fromkeys(windups, windup.times(math.degrees(1.0))),
        "windup-range": Bound(2.0 * windup.error, windup.scale).times(math.degrees(1.0)),
        **dict.fromkeys(torques, torque.times(N_M)),
        **dict.fromkeys(speeds, speed.times(1.0 / RPM)),
    }
