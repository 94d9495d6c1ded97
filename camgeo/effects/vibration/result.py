"""Effect `vibration`: an elastic follower train in its steady state, solved exactly.

The train is a row of masses on springs and dampers, whose base has the motion of the state, and on
whose output the process load acts; see `camgeo.numeric.oscillator.chain` for the equations and
their sources. The motion laws are piecewise smooth, and on each piece the response is known in
closed form, see `camgeo.numeric.oscillator.mode`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from camgeo.check.finding import Finding
from camgeo.effects.effect import Bound, Column, Request, Subject
from camgeo.effects.elastic import ElasticTrain, search_edges
from camgeo.effects.force import Force
from camgeo.effects.results import INERTIA, LOAD, Elastic
from camgeo.effects.vibration.findings import (
    BY_LOAD,
    LARGEST_FORCE,
    MotionUnit,
    force_column,
    magnitude,
    of_acceleration,
    of_error,
    of_forces,
    of_load,
    of_modes,
    of_resonance,
    of_rests,
    unexcited,
)
from camgeo.effects.vibration.output import Clock, Output, clock_of
from camgeo.effects.vibration.table import TrainData
from camgeo.effects.wording import FORCES, MASSES, Label
from camgeo.errors import EffectError, GeometryError
from camgeo.motion.kept import MOST_VALUES, Answers
from camgeo.motion.time_course import in_time
from camgeo.numeric.arrays import FloatArray, Side, merged, read_only
from camgeo.numeric.extremes import piecewise_extremes
from camgeo.numeric.oscillator.chain import SeparationError, Stage, chain
from camgeo.numeric.oscillator.steady import ResonanceError, Response, steady_state
from camgeo.numeric.oscillator.train import Train
from camgeo.units import TURN

DEFLECTIONS: Final = (
    "vibration deflection",
    "largest-motion-error",
    "residual-vibration",
    "largest-residual-vibration",
)
"""Figures that are deflections."""

SAME: Final = 1e-9
"""Relative difference of two masses that are the same but for how they were given."""

FORCING: Final = 1e-3
"""Initial tolerance of the forcing, as a share of that of the response, which magnifies errors."""


@dataclass(frozen=True, slots=True, eq=False)
class Vibration(Elastic):
    """The vibration of the train.

    Attributes
    ----------
    behind : see `camgeo.effects.results.Elastic`.
    findings, columns : see `camgeo.effects.effect.Result`.
    errors : of deflections, relative to the largest lift, or deflection by the load at rest if that
        is larger, and of accelerations, relative to that of a free vibration with this amplitude;
        of forces, relative to that of a spring and damper deflected by this amplitude.
    output : over the cam angle.
    links : the number of springs whose forces are known: all, or none where only frequencies are.
    """

    output: Output
    links: int


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
    force = FORCES[subject.drive.unit]
    stages = stages_of(request)
    train = train_of(data, stages) if stages else None
    links = len(stages) if data.natural_frequency is None else 0
    clock = clock_of(subject, request.course)
    period = float(clock.time(clock.edges[-1:])[0])
    moved = _moved(request)
    passed = bool(data.stages) or moved > 0.0
    load, borders = _load_on(request), np.empty(0)
    findings: list[Finding] = []
    if load is not None and (train is None or not passed):
        findings.append(unexcited())
        load = None
    if load is not None:
        borders = load.borders
    smooth = merged(np.concatenate((subject.state.smooth_angles, borders)))
    edges = search_edges(smooth, train, period)
    response, behind, errors = None, None, {}
    if train is not None:
        # The force on the cam has no tolerance of its own.
        share = 0.0 if passed else FORCING * request.tolerance
        response, bounds = _response(clock, train, links, load, (share, request.tolerance))
        if passed:
            counted = _counted(stages, moved, subject)
            behind = _behind(subject, counted, clock, response, load)
        errors = _errors(bounds, train, shown, force)
        findings += of_modes(train, period)
    output = Output(clock, response)
    most = magnitude(piecewise_extremes(output.deflection, edges))
    fastest = magnitude(piecewise_extremes(output.acceleration, edges))
    findings += [of_error(most, limit, shown), of_acceleration(fastest, clock, shown)]
    if load is not None:
        still = magnitude(piecewise_extremes(output.lasting, edges))
        findings.append(of_load(still, shown))
        errors[BY_LOAD] = errors[DEFLECTIONS[0]]
        most = magnitude(piecewise_extremes(output.moving, edges))
    findings += of_forces(output, links, edges, force)
    if response is not None:
        findings += of_rests(clock, response, shown)
        findings += of_resonance(response, most.value, shown)
    return Vibration(
        output,
        links,
        behind=behind,
        findings=tuple(findings),
        columns=_columns(output, links, shown, force, limit, borders),
        errors=errors,
    )


def _load_on(request: Request[TrainData]) -> Force | None:
    """The load as a force on the demanded motion, which is that of the output; None without one."""
    load = request.results.get(LOAD)
    if load is None:
        return None
    force = load.force
    return force if force.far is None else replace(force, coefficients=force.far)


def _errors(bounds: list[Bound], train: Train, shown: MotionUnit, force: Label) -> dict[str, Bound]:
    """The errors of all figures; frequencies, settling and amplification are exact.

    The acceleration of a mode is its deflection times the square of its rate.
    """
    own = bounds[0].times(shown.scale)
    fast = own.times(float(np.max(np.abs(train.rates))) ** 2)
    found = dict.fromkeys(DEFLECTIONS, own)
    found |= dict.fromkeys(("largest-output-acceleration", "output acceleration"), fast)
    pushed = [each.times(force.scale) for each in bounds[1:]]
    if pushed:
        found[LARGEST_FORCE] = max(pushed, key=lambda each: each.error)
    return found | {force_column(link): each for link, each in enumerate(pushed)}


def _counted(stages: Sequence[Stage], moved: float, subject: Subject) -> float:
    """The mass in the train; 0 if [effects.inertia] has none with the demanded motion.

    Raises
    ------
    GeometryError
        If it is more than the mass `moved`, of which it is a part.
    """
    if moved == 0.0:
        return 0.0
    mass = sum(each.mass for each in stages)
    if mass > moved * (1.0 + SAME):
        label = MASSES[subject.drive.unit]
        raise GeometryError(
            f"must not be more than the {label.scale * moved:.6g} {label.unit} of [effects.inertia]"
            " that have the demanded motion, of which they are a part, in sum",
            key=f"effects.vibration.{'moments' if subject.drive.unit == 'rad' else 'masses'}",
            value=f"{label.scale * mass:.6g} {label.unit}",
        )
    return mass


def _behind(
    subject: Subject, mass: float, clock: Clock, response: Response, load: Force | None
) -> ElasticTrain:
    """What the train passes on to the follower; the rigid forces have its `mass`."""

    def per_lift(phi: FloatArray, side: Side) -> FloatArray:
        if subject.drive.linkage is None:
            return np.ones(len(phi))
        return subject.drive.linkage.per_follower(clock.motion.jet(phi, side)[0])

    pushes: Answers[FloatArray] = Answers(MOST_VALUES)

    def push(response: Response, phi: FloatArray, side: Side) -> FloatArray:
        def made() -> FloatArray:
            return read_only(Output(clock, response).forces([0], phi, side)[0])

        return pushes.recall(made, (response, side), phi)

    def base(phi: FloatArray, side: Side) -> FloatArray:
        return in_time(clock.motion.jet(phi, side), clock.course, phi)[:3]

    def slip(response: Response, phi: FloatArray, side: Side) -> FloatArray:
        return np.asarray(Output(clock, response).states(phi, side)[1])

    return ElasticTrain(response, mass, per_lift, push, base, load, None if load is None else slip)


def _response(
    clock: Clock, train: Train, links: int, load: Force | None, shares: tuple[float, float]
) -> tuple[Response, list[Bound]]:
    """The steady state, and the errors of its deflection, with the largest lift as the scale or the
    deflection by the load if that is larger, and of the force in each of the `links`.

    Parameters
    ----------
    shares : of the forcing that may be truncated, or that of rounding if this is too much; and the
        tolerance.
    """
    lift = float(np.max(np.abs(clock.motion.jet(clock.edges)[0])))
    first, tolerance = shares
    error = math.inf
    for share in (first, 0.0):
        try:
            pressed = None if load is None else clock.load(load, share)
            response = steady_state(train, clock.base, share, pressed)
        except ResonanceError as resonance:
            raise EffectError(
                f"resonance without damping: harmonic {resonance.harmonic} of the cam's speed is"
                f" the natural frequency, {resonance.frequency / TURN:.6g} Hz, and the vibration"
                " grows from turn to turn; a steady state needs damping or another speed",
                finding="resonance",
                value=resonance.frequency / TURN,
                unit="Hz",
            ) from None
        forces = [train.force(link) for link in range(links)]
        if pressed is not None:
            bent = abs(train.yielding(train.deflection(train.output)))
            lift = max(lift, bent * pressed.pieces.largest)
        bounds = [
            Bound(response.error, lift),
            *(
                Bound(response.error_of(each), lift * stiffness)
                for each, stiffness in zip(forces, train.stiffnesses.tolist(), strict=False)
            ),
        ]
        error = max(each.share for each in bounds)
        if error <= tolerance:
            return response, bounds
    raise EffectError(
        f"the deflection has an error of {error:.3g} of the lift; the tolerance is {tolerance:.3g}:"
        " an undamped train this close to resonance magnifies rounding errors",
        finding="vibration-tolerance",
        value=error,
        limit=tolerance,
    )


def _columns(
    output: Output,
    links: int,
    shown: MotionUnit,
    force: Label,
    limit: float | None,
    borders: FloatArray,
) -> tuple[Column, ...]:
    unit, scale = shown.unit, shown.scale
    bound = None if limit is None else scale * limit

    def deflection(phi: FloatArray, side: Side) -> FloatArray:
        return scale * output.deflection(phi, side)

    def acceleration(phi: FloatArray, side: Side) -> FloatArray:
        return scale * output.acceleration(phi, side)

    def push(link: int) -> Column:
        def values(phi: FloatArray, side: Side) -> FloatArray:
            return np.asarray(force.scale * output.forces([link], phi, side)[0])

        return Column(force_column(link), force.unit, values)

    return (
        Column("vibration deflection", unit, deflection, bound),
        Column("output acceleration", f"{unit}/s^2", acceleration, borders=borders),
        *(push(link) for link in range(links)),
    )


def train_of(data: TrainData, stages: Sequence[Stage]) -> Train:
    """The elastic train of the `stages`.

    Raises
    ------
    EffectError
        If rounding keeps its modes from being found.
    """
    try:
        return chain(stages, -1 if data.output is None else data.output - 1)
    except SeparationError as error:
        raise EffectError(
            f"{error}: the masses, springs and dampers differ too much for numbers of 16 digits",
            finding="vibration-tolerance",
        ) from None


def stages_of(request: Request[TrainData]) -> tuple[Stage, ...]:
    """The masses in a row with their springs and dampers; none if the train is rigid.

    Without a list there are one or two. With a stiffness k, w^2 = k / m for the mass m from
    [effects.inertia]. With a second mass m is the sum of both, so the first one is
    m / (1 + mass_ratio). With a frequency m is 1 if there is no such mass.

    Raises
    ------
    GeometryError
        If the masses are missing.
    """
    data, second = request.data, request.data.second
    if data.stages:
        return data.stages
    moved = _moved(request)
    mass, frequency = moved or 1.0, data.natural_frequency
    if second is not None:
        mass /= 1.0 + second.mass_ratio
    if frequency is None:
        stiffness = data.stiffness if data.stiffness is not None else data.torsional_stiffness
        assert stiffness is not None  # `parse` refuses a table without
        _require(request)
        if moved == 0.0:
            return ()
        frequency = math.sqrt(stiffness) / math.sqrt(mass)
    stages = []
    if not math.isinf(frequency):
        stages.append(_tuned(mass, frequency, data.damping))
    if second is not None:
        own = mass * second.mass_ratio
        stages.append(_tuned(own, second.natural_frequency, second.damping))
    return tuple(stages)


def _tuned(mass: float, frequency: float, damping: float) -> Stage:
    """The mass on a spring and a damper that make its natural frequency and damping ratio."""
    return Stage(mass, mass * frequency * frequency, 2.0 * damping * frequency * mass)


def _moved(request: Request[TrainData]) -> float:
    """The mass that has the demanded motion, from [effects.inertia]; 0 if it states none."""
    inertia = request.results.get(INERTIA)
    return 0.0 if inertia is None else inertia.moved


def _require(request: Request[TrainData]) -> None:
    """The mass that has the demanded motion must be known."""
    if request.results.get(INERTIA) is None:
        raise GeometryError(
            "is missing: with a stiffness the natural frequency needs the masses",
            key="effects.inertia",
        )
    linkage = request.subject.drive.linkage
    if _moved(request) == 0.0 and linkage is not None and linkage.member != "slider":
        raise GeometryError(
            "is missing: with a stiffness the natural frequency needs the moment of inertia at"
            " the far end of the linkage; or give natural_frequency",
            key="effects.inertia.output_moment",
        )
