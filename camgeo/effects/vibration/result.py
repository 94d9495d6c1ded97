"""Effect `vibration`: an elastic follower train in its steady state, solved exactly.

The train is a mass on a spring and a damper whose base has the motion of the state, or two of them
in series; see `camgeo.numeric.oscillator.train` for the equations and their sources. The motion
laws are piecewise smooth, and on each piece the response is known in closed form, see
`camgeo.numeric.oscillator.mode`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from camgeo.check.finding import Finding
from camgeo.effects.effect import Bound, Column, Request, Subject
from camgeo.effects.elastic import ElasticTrain, search_edges
from camgeo.effects.results import INERTIA, Elastic
from camgeo.effects.vibration.findings import (
    MotionUnit,
    magnitude,
    of_acceleration,
    of_error,
    of_modes,
    of_resonance,
    of_rests,
)
from camgeo.effects.vibration.output import Clock, Output, clock_of
from camgeo.effects.vibration.table import TrainData
from camgeo.errors import EffectError, GeometryError
from camgeo.numeric.arrays import FloatArray, Side, frozen
from camgeo.numeric.extremes import piecewise_extremes
from camgeo.numeric.oscillator.steady import ResonanceError, Response, answered, steady_state
from camgeo.numeric.oscillator.train import Train, one_mass, two_masses
from camgeo.units import TURN

DEFLECTIONS: Final = (
    "vibration deflection",
    "largest-motion-error",
    "residual-vibration",
    "largest-residual-vibration",
)
"""Figures that are deflections."""

FORCING: Final = 1e-3
"""Initial tolerance of the forcing, as a share of that of the response, which magnifies errors."""


@dataclass(frozen=True, slots=True, eq=False)
class Vibration(Elastic):
    """The vibration of the train.

    Attributes
    ----------
    behind : see `camgeo.effects.results.Elastic`.
    findings, columns : see `camgeo.effects.effect.Result`.
    errors : of deflections, relative to the largest lift, and of accelerations, relative to that of
        a free vibration with this amplitude.
    output : over the cam angle.
    """

    output: Output


def compute(request: Request[TrainData]) -> Vibration:
    """The steady state of the train.

    Raises
    ------
    GeometryError
        With its key, if data are missing.
    EffectError
        If an undamped train is in resonance, or the tolerance cannot be reached.
    """
    subject, data = request.subject, request.data
    turns = subject.drive.unit == "rad"
    limit = data.limit_angle if turns else data.limit
    shown = MotionUnit("deg", math.degrees(1.0)) if turns else MotionUnit("mm", 1.0)
    trains = trains_of(request)
    train = None if trains is None else trains.output
    clock = clock_of(subject, request.course)
    period = float(clock.time(clock.edges[-1:])[0])
    edges = search_edges(subject.state.smooth_angles, train, period)
    findings: list[Finding] = []
    response, behind, errors = None, None, {}
    if trains is not None and train is not None:
        # Forces follow from the accelerations, and have no tolerance of their own.
        share = FORCING * request.tolerance if not trains.mass else 0.0
        response, deflection = _response(clock, train, request.tolerance, share)
        behind = _behind(subject, trains, clock, response)
        errors = _errors(deflection, train, shown)
        findings += of_modes(train, period)
    output = Output(clock, response)
    most = magnitude(piecewise_extremes(output.deflection, edges))
    fastest = magnitude(piecewise_extremes(output.acceleration, edges))
    findings += [of_error(most, limit, shown), of_acceleration(fastest, clock, shown)]
    if response is not None:
        findings += of_rests(clock, response, shown)
        findings += of_resonance(response, most.value, shown)
    return Vibration(
        output,
        behind=behind,
        findings=tuple(findings),
        columns=_columns(output, shown, limit),
        errors=errors,
    )


def _errors(deflection: Bound, train: Train, shown: MotionUnit) -> dict[str, Bound]:
    """The errors of all figures; frequencies, settling and amplification are exact.

    The acceleration of a mode is its deflection times the square of its rate.
    """
    own = deflection.times(shown.scale)
    fast = own.times(float(np.max(np.abs(train.rates))) ** 2)
    found = dict.fromkeys(DEFLECTIONS, own)
    return found | dict.fromkeys(("largest-output-acceleration", "output acceleration"), fast)


def _behind(
    subject: Subject, trains: Trains, clock: Clock, response: Response
) -> ElasticTrain | None:
    """What the train passes on to the follower, if it has mass."""
    if not trains.mass:
        return None
    own = response
    if trains.centre is not trains.output:
        own = answered(trains.centre, response.base, response.forcing)
    rigid = Output(clock, None)

    def per_lift(phi: FloatArray, side: Side) -> FloatArray:
        if subject.drive.linkage is None:
            return np.ones(len(phi))
        return subject.drive.linkage.per_follower(clock.motion.jet(phi, side)[0])

    def states(response: Response, phi: FloatArray, side: Side) -> FloatArray:
        return Output(clock, response).states(phi, side)

    return ElasticTrain(own, trains.mass, per_lift, states, rigid.acceleration)


def _response(clock: Clock, train: Train, tolerance: float, first: float) -> tuple[Response, Bound]:
    """The steady state, and the error of its deflection, with the largest lift as the scale.

    The share of the forcing that is truncated is `first`, or that of rounding if this is too much.
    """
    lift = float(np.max(np.abs(clock.motion.jet(clock.edges)[0])))
    error = math.inf
    for share in (first, 0.0):
        try:
            response = steady_state(train, clock.base, share)
        except ResonanceError as resonance:
            raise EffectError(
                f"resonance without damping: harmonic {resonance.harmonic} of the cam's speed is"
                f" the natural frequency, {resonance.frequency / TURN:.6g} Hz, and the vibration"
                " grows from turn to turn; a steady state needs damping or another speed",
                finding="resonance",
                value=resonance.frequency / TURN,
                unit="Hz",
            ) from None
        error = response.error / lift if lift > 0.0 else 0.0
        if error <= tolerance:
            return response, Bound(response.error, lift)
    raise EffectError(
        f"the deflection has an error of {error:.3g} of the lift; the tolerance is {tolerance:.3g}:"
        " an undamped train this close to resonance magnifies rounding errors",
        finding="vibration-tolerance",
        value=error,
        limit=tolerance,
    )


def _columns(output: Output, shown: MotionUnit, limit: float | None) -> tuple[Column, ...]:
    unit, scale = shown.unit, shown.scale
    bound = None if limit is None else scale * limit

    def deflection(phi: FloatArray, side: Side) -> FloatArray:
        return scale * output.deflection(phi, side)

    def acceleration(phi: FloatArray, side: Side) -> FloatArray:
        return scale * output.acceleration(phi, side)

    return (
        Column("vibration deflection", unit, deflection, bound),
        Column("output acceleration", f"{unit}/s^2", acceleration),
    )


@dataclass(frozen=True, slots=True, eq=False)
class Trains:
    """The train, as the motion of its output and of its centre of mass follow from the base.

    Attributes
    ----------
    output, centre : the same modes with the weights of each; the same object for one mass.
    mass : in the centre of mass [t, or t mm^2 if it turns]; 0 if the scene states no masses.
    """

    output: Train
    centre: Train
    mass: float


def trains_of(request: Request[TrainData]) -> Trains | None:
    """The elastic train; None if it is rigid, without mass.

    With a stiffness k, w^2 = k / m for the mass m from [effects.inertia]. With a second mass m is
    the sum of both, so the first one is m / (1 + mass_ratio).

    Raises
    ------
    GeometryError
        If the masses are missing.
    """
    data, second = request.data, request.data.second
    inertia = request.results.get(INERTIA)
    moved = 0.0 if inertia is None else inertia.moved
    ratio = 0.0 if second is None else second.mass_ratio
    frequency = data.natural_frequency
    if frequency is None:
        stiffness = data.stiffness if data.stiffness is not None else data.torsional_stiffness
        assert stiffness is not None  # `parse` refuses a table without
        if inertia is None:
            raise GeometryError(
                "is missing: with a stiffness the natural frequency needs the masses",
                key="effects.inertia",
            )
        linkage = request.subject.drive.linkage
        if moved == 0.0 and linkage is not None and linkage.member != "slider":
            raise GeometryError(
                "is missing: with a stiffness the natural frequency needs the moment of inertia at"
                " the far end of the linkage; or give natural_frequency",
                key="effects.inertia.output_moment",
            )
        if moved == 0.0:
            return None
        frequency = math.sqrt((1.0 + ratio) * stiffness / moved)
    if math.isinf(frequency):
        if second is None:
            return None
        alone = one_mass(second.frequency, second.damping)
        return Trains(alone, alone, moved * ratio / (1.0 + ratio))
    if second is None:
        alone = one_mass(frequency, data.damping)
        return Trains(alone, alone, moved)
    first, last = (two_masses(frequency, data.damping, second, which) for which in (0, 1))
    weights = frozen((first.weights + ratio * last.weights) / (1.0 + ratio), np.complex128)
    return Trains(last, replace(last, weights=weights), moved)
