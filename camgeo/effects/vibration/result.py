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
from camgeo.effects.results import INERTIA
from camgeo.effects.vibration.findings import (
    Telling,
    magnitude,
    of_acceleration,
    of_error,
    of_modes,
    of_resonance,
    of_rests,
    search_edges,
)
from camgeo.effects.vibration.output import Clock, Output, clock_of
from camgeo.effects.vibration.spec import Spec
from camgeo.errors import EffectError, GeometryError
from camgeo.motion.motion import Side
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.extremes import piecewise_extremes
from camgeo.numeric.oscillator.steady import ResonanceError, Response, steady_state
from camgeo.numeric.oscillator.train import Train, one_mass, two_masses
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
    output : over the cam angle.
    """

    output: Output
    error: float = field(kw_only=True)


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
    turns = subject.drive.unit == "rad"
    limit = spec.limit_angle if turns else spec.limit
    telling = Telling("deg", math.degrees(1.0)) if turns else Telling("mm", 1.0)
    train = train_of(request)
    clock = clock_of(subject, request.course)
    period = float(clock.time(clock.edges[-1:])[0])
    edges = search_edges(subject.drive.smooth_angles, train, period)
    findings: list[Finding] = []
    response, error = None, 0.0
    if train is not None:
        response, error = _response(clock, train, request.tolerance)
        findings += of_modes(train, period)
    output = Output(clock, response)
    most = magnitude(piecewise_extremes(output.deflection, edges))
    fastest = magnitude(piecewise_extremes(output.acceleration, edges))
    findings += [of_error(most, limit, telling), of_acceleration(fastest, clock, telling)]
    if response is not None:
        findings += of_rests(clock, response, telling)
        findings += of_resonance(response, most.value, telling)
    return Vibration(
        output,
        findings=tuple(findings),
        columns=_columns(output, telling, limit),
        error=error,
    )


def _response(clock: Clock, train: Train, tolerance: float) -> tuple[Response, float]:
    """The steady state, and the error of its deflection as a share of the largest lift."""
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
            return response, error
    raise EffectError(
        f"the deflection is known to {error:.3g} of the lift only, {tolerance:.3g} is asked: an"
        " undamped train so near to resonance magnifies all rounding",
        finding="vibration-tolerance",
        value=error,
        limit=tolerance,
    )


def _columns(output: Output, telling: Telling, limit: float | None) -> tuple[Column, ...]:
    unit, scale = telling.unit, telling.scale
    bound = None if limit is None else scale * limit

    def deflection(phi: FloatArray, side: Side) -> FloatArray:
        return scale * output.deflection(phi, side)

    def acceleration(phi: FloatArray, side: Side) -> FloatArray:
        return scale * output.acceleration(phi, side)

    return (
        Column("vibration deflection", unit, deflection, bound),
        Column("output acceleration", f"{unit}/s^2", acceleration),
    )


def train_of(request: Request[Spec]) -> Train | None:
    """The elastic train; None if it is rigid, for there is no mass.

    With a stiffness k, w^2 = k / m for the mass m that [effects.inertia] gives. With a second mass
    m is both of them together, so that the first one is m / (1 + mass_ratio).

    Raises
    ------
    GeometryError
        If the masses are missing.
    """
    spec = request.spec
    frequency = spec.natural_frequency
    if frequency is None:
        stiffness = spec.stiffness if spec.stiffness is not None else spec.torsional_stiffness
        assert stiffness is not None  # `parse` refuses a table without
        inertia = request.results.get(INERTIA)
        if inertia is None:
            raise GeometryError(
                "is missing: with a stiffness the natural frequency needs the masses",
                key="effects.inertia",
            )
        linkage = request.subject.drive.linkage
        if inertia.moved == 0.0 and linkage is not None and linkage.member != "slider":
            raise GeometryError(
                "is missing: with a stiffness the natural frequency needs the moment of inertia at"
                " the far end of the linkage; or give natural_frequency",
                key="effects.inertia.output_moment",
            )
        if inertia.moved == 0.0:
            return None
        share = 1.0 if spec.second is None else 1.0 + spec.second.mass_ratio
        frequency = math.sqrt(share * stiffness / inertia.moved)
    if math.isinf(frequency):
        return None if spec.second is None else one_mass(spec.second.frequency, spec.second.damping)
    if spec.second is None:
        return one_mass(frequency, spec.damping)
    return two_masses(frequency, spec.damping, spec.second)
