"""Effect `vibration`: an elastic follower train in its steady state, solved exactly.

The train is one mass on a spring and a damper whose base makes the demanded motion, or two in a
row: `camgeo.numeric.oscillator.train` has the equations with their sources. The motion laws are
smooth in pieces, and on each the response is known in closed form,
`camgeo.numeric.oscillator.mode`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from camgeo.check.finding import Finding
from camgeo.effects.effect import Column, Request, Result
from camgeo.effects.vibration.findings import (
    Telling,
    largest,
    of_acceleration,
    of_error,
    of_modes,
    of_resonance,
    of_rests,
    search_edges,
)
from camgeo.effects.vibration.output import Clock, Elastic, Output, Rigid, clock_of
from camgeo.effects.vibration.spec import Spec
from camgeo.effects.vibration.train import train_of
from camgeo.errors import EffectError
from camgeo.motion.motion import Side
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.oscillator.steady import ResonanceError, steady_state
from camgeo.numeric.oscillator.train import Train
from camgeo.units import TURN

FORCING: Final = 1e-3
"""Share of the tolerance that the forcing may miss at first; the response magnifies it."""


@dataclass(frozen=True, slots=True, eq=False)
class Vibration(Result):
    """What is found of the vibration.

    Attributes
    ----------
    findings, columns : see `camgeo.effects.effect.Result`.
    error : estimate of the error of the deflection, as a share of the largest lift.
    train : its modes; None if it is rigid.
    source : the output over the cam angle.
    """

    train: Train | None
    source: Output
    clock: Clock
    error: float = field(kw_only=True)

    def deflection(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) output less demanded motion [mm or rad] at `phi` (n,) [rad]."""
        found: FloatArray = self.source.states(phi, side)[0]
        return found

    def output(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) motion of the output [mm or rad]."""
        moved: FloatArray = self.clock.plan.jet(phi, side)[0] + self.deflection(phi, side)
        return moved

    def acceleration(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) acceleration of the output [mm/s^2 or rad/s^2]."""
        found: FloatArray = self.source.states(phi, side)[2]
        return found


def compute(request: Request[Spec]) -> Vibration:
    """The steady state of the train.

    Raises
    ------
    GeometryError
        With its key, if data are missing.
    EffectError
        If an undamped train is in resonance, or the tolerance cannot be reached.
    """
    subject, spec = request.subject, request.spec
    turns = subject.cam.drive.unit == "rad"
    limit = spec.limit_angle if turns else spec.limit
    telling = Telling("deg", math.degrees(1.0)) if turns else Telling("mm", 1.0)
    train = train_of(request)
    clock = clock_of(subject, request.course)
    period = float(clock.time(clock.edges[-1:])[0])
    edges = search_edges(subject.cam.drive.smooth_angles, train, period)
    findings: list[Finding] = []
    source: Output = Rigid(clock)
    elastic, error = None, 0.0
    if train is not None:
        elastic, error = _elastic(clock, train, request.tolerance)
        source = elastic
        findings += of_modes(train, period)
    most = largest(source, 0, edges)
    findings.append(of_error(most, limit, telling))
    findings.append(of_acceleration(largest(source, 2, edges), clock, clock.edges, telling))
    if elastic is not None:
        findings += of_rests(elastic, telling)
        findings += of_resonance(elastic, most.value, telling)
    return Vibration(
        train,
        source,
        clock,
        findings=tuple(findings),
        columns=_columns(source, telling, limit),
        error=error,
    )


def _elastic(clock: Clock, train: Train, tolerance: float) -> tuple[Elastic, float]:
    """The output, and the error of its deflection as a share of the largest lift."""
    lift = float(np.max(np.abs(clock.plan.jet(clock.edges)[0])))
    error = math.inf
    for share in (FORCING * tolerance, 0.0):
        try:
            response = steady_state(train, clock.base, share)
        except ResonanceError as resonance:
            raise EffectError(
                f"resonance without damping: harmonic {resonance.harmonic} of the cam's speed is"
                f" the natural frequency, {resonance.frequency / TURN:.6g} Hz, and the vibration"
                " grows from turn to turn; there is a steady state with damping, or beside it",
                finding="resonance",
                value=resonance.frequency / TURN,
                unit="Hz",
            ) from None
        error = response.error / lift if lift > 0.0 else 0.0
        if error <= tolerance:
            return Elastic(clock, response), error
    raise EffectError(
        f"the deflection is known to {error:.3g} of the lift only, {tolerance:.3g} is asked: an"
        " undamped train so near to resonance magnifies all rounding",
        finding="vibration-tolerance",
        value=error,
        limit=tolerance,
    )


def _columns(source: Output, telling: Telling, limit: float | None) -> tuple[Column, ...]:
    def column(name: str, unit: str, order: int, limit: float | None = None) -> Column:
        def values(phi: FloatArray, side: Side) -> FloatArray:
            return np.asarray(telling.scale * source.states(phi, side)[order])

        return Column(name, unit, values, limit)

    bound = None if limit is None else telling.scale * limit
    return (
        column("vibration deflection", telling.unit, 0, bound),
        column("output acceleration", f"{telling.unit}/s^2", 2),
    )
