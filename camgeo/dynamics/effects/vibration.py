"""Effect `vibration`: an elastic follower train in its steady state, solved exactly.

The train is a row of masses on springs and dampers, whose base has the motion of the state, and on
whose output the process load acts; see `camgeo.dynamics.oscillator.train` for the equations and
their sources. The motion laws are piecewise smooth, and on each piece the response is known in
closed form, see `camgeo.dynamics.oscillator.steady`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Final

import numpy as np

from camgeo.check.finding import Finding
from camgeo.dynamics.effects.effect import Bound, Column, Request, Subject, scaled
from camgeo.dynamics.effects.forces import ElasticTrain, Force, output_per_follower, search_edges
from camgeo.dynamics.effects.results import INERTIA, LOAD, Elastic
from camgeo.dynamics.effects.tables import TrainData
from camgeo.dynamics.effects.wording import FORCES, MASSES, Label, at_angle, remaining_share
from camgeo.dynamics.oscillator.steady import (
    Base,
    Forcing,
    ResonanceError,
    Response,
    load_forcing,
    steady_state,
)
from camgeo.dynamics.oscillator.train import SeparationError, Stage, Train, chain
from camgeo.errors import EffectError, GeometryError
from camgeo.kinematics.motion import MergedDwell, Motion
from camgeo.kinematics.plan import in_turn
from camgeo.kinematics.time_course import ConstantSpeed, TimeCourse, in_time
from camgeo.numeric.arrays import FloatArray, IntArray, Side, merged, resolved
from camgeo.numeric.extremes import (
    Extreme,
    Extremes,
    inverse,
    piecewise_extremes,
    piecewise_extremes_of_many,
)
from camgeo.numeric.kept import recalling
from camgeo.units import RPM, TURN, cam_angle

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
    behind : see `camgeo.dynamics.effects.results.Elastic`.
    findings, columns : see `camgeo.dynamics.effects.effect.Result`.
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
    label = Label("angle", "deg", math.degrees(1.0)) if turns else Label("length", "mm", 1.0)
    force = FORCES[subject.drive.unit]
    stages = train_stages(request)
    train = build_train(data, stages) if stages else None
    links = len(stages) if data.natural_frequency is None else 0
    clock = motion_clock(subject, request.course)
    period = float(clock.time(clock.edges[-1:])[0])
    moved = _moved_mass(request)
    passed = bool(data.stages) or moved > 0.0
    load, borders = _output_load(request), np.empty(0)
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
            counted = _train_mass(stages, moved, subject)
            behind = _behind(subject, counted, clock, response, load)
        errors = _errors(bounds, train, label, force)
        findings += mode_findings(train, period)
    output = Output(clock, response)
    most = magnitude(piecewise_extremes(output.deflection, edges))
    fastest = magnitude(piecewise_extremes(output.acceleration, edges))
    findings += [error_finding(most, limit, label), acceleration_finding(fastest, clock, label)]
    if load is not None:
        still = magnitude(piecewise_extremes(output.lasting, edges))
        findings.append(load_finding(still, label))
        errors[BY_LOAD] = errors[DEFLECTIONS[0]]
        most = magnitude(piecewise_extremes(output.moving, edges))
    findings += force_findings(output, links, edges, force)
    if response is not None:
        findings += dwell_findings(clock, response, label)
        findings += resonance_findings(response, most.value, label)
    return Vibration(
        output,
        links,
        behind=behind,
        findings=tuple(findings),
        columns=_columns(output, links, label, force, limit, borders),
        errors=errors,
    )


def _output_load(request: Request[TrainData]) -> Force | None:
    """The load as a force on the demanded motion, which is that of the output; None without one."""
    load = request.results.get(LOAD)
    if load is None:
        return None
    force = load.force
    return force if force.far is None else replace(force, coefficients=force.far)


def _errors(bounds: list[Bound], train: Train, shown: Label, force: Label) -> dict[str, Bound]:
    """The errors of all figures; frequencies, settling and amplification are exact.

    The acceleration of a mode is its deflection times the square of its rate.
    """
    deflection = bounds[0].times(shown.scale)
    fast = deflection.times(float(np.max(np.abs(train.rates))) ** 2)
    errors = dict.fromkeys(DEFLECTIONS, deflection)
    errors |= dict.fromkeys(("largest-output-acceleration", "output acceleration"), fast)
    pushed = [bound.times(force.scale) for bound in bounds[1:]]
    if pushed:
        errors[LARGEST_FORCE] = max(pushed, key=lambda bound: bound.error)
    return errors | {force_column(link): bound for link, bound in enumerate(pushed)}


def _train_mass(stages: Sequence[Stage], moved: float, subject: Subject) -> float:
    """The mass in the train; 0 if [effects.inertia] has none with the demanded motion.

    Raises
    ------
    GeometryError
        If it is more than the mass `moved`, of which it is a part.
    """
    if moved == 0.0:
        return 0.0
    mass = sum(stage.mass for stage in stages)
    if mass > moved * (1.0 + SAME):
        label = MASSES[subject.drive.unit]
        raise GeometryError(
            f"must not be, in sum, more than the {label.scale * moved:.6g} {label.unit} of"
            " [effects.inertia] that have the demanded motion, because they are a part of these",
            key=f"effects.vibration.{'moments' if subject.drive.unit == 'rad' else 'masses'}",
            value=f"{label.scale * mass:.6g} {label.unit}",
        )
    return mass


def _behind(
    subject: Subject, mass: float, clock: Clock, response: Response, load: Force | None
) -> ElasticTrain:
    """The elastic train behind the follower; the forces of a rigid train include its `mass`."""

    @recalling
    def push(response: Response, phi: FloatArray, side: Side) -> FloatArray:
        return np.asarray(Output(clock, response).forces([0], phi, side)[0])

    def base(phi: FloatArray, side: Side) -> FloatArray:
        return in_time(clock.motion.jet(phi, side), clock.course, phi)[:3]

    def slip(response: Response, phi: FloatArray, side: Side) -> FloatArray:
        return np.asarray(Output(clock, response).states(phi, side)[1])

    way = partial(output_per_follower, subject)
    return ElasticTrain(response, mass, way, push, base, load, None if load is None else slip)


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
    # If a truncated series of the forcing is too coarse, one to rounding may be fine enough.
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
            # The deflection by the largest load, if it lasted.
            bent = abs(train.yielding(train.deflection(train.output)))
            lift = max(lift, bent * pressed.pieces.largest)
        bounds = [
            Bound(response.error, lift),
            *(
                Bound(response.reading_error(reading), lift * stiffness)
                for reading, stiffness in zip(forces, train.stiffnesses.tolist(), strict=False)
            ),
        ]
        error = max(bound.share for bound in bounds)
        if error <= tolerance:
            return response, bounds
    raise EffectError(
        f"the deflection has an error of {error:.3g} relative to the lift; the tolerance is"
        f" {tolerance:.3g}: an undamped train this close to resonance magnifies rounding errors",
        finding="vibration-tolerance",
        value=error,
        limit=tolerance,
    )


def _columns(
    output: Output,
    links: int,
    shown: Label,
    force: Label,
    limit: float | None,
    borders: FloatArray,
) -> tuple[Column, ...]:
    unit, scale = shown.unit, shown.scale
    bound = None if limit is None else scale * limit

    def push(link: int) -> Column:
        values = scaled(lambda phi, side: output.forces([link], phi, side)[0], force.scale)
        return Column(force_column(link), force.unit, values)

    return (
        Column("vibration deflection", unit, scaled(output.deflection, scale), bound),
        Column(
            "output acceleration",
            f"{unit}/s^2",
            scaled(output.acceleration, scale),
            borders=borders,
        ),
        *(push(link) for link in range(links)),
    )


def build_train(data: TrainData, stages: Sequence[Stage]) -> Train:
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


def train_stages(request: Request[TrainData]) -> tuple[Stage, ...]:
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
    moved = _moved_mass(request)
    mass, frequency = moved or 1.0, data.natural_frequency
    if second is not None:
        # The mass of the scene is the sum of both.
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
        second_mass = mass * second.mass_ratio
        stages.append(_tuned(second_mass, second.natural_frequency, second.damping))
    return tuple(stages)


def _tuned(mass: float, frequency: float, damping: float) -> Stage:
    """The mass on a spring and a damper that make its natural frequency and damping ratio."""
    return Stage(mass, mass * frequency * frequency, 2.0 * damping * frequency * mass)


def _moved_mass(request: Request[TrainData]) -> float:
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
    if _moved_mass(request) == 0.0 and linkage is not None and linkage.member != "slider":
        raise GeometryError(
            "is missing: with a stiffness the natural frequency needs the moment of inertia at"
            " the far end of the linkage; or give natural_frequency",
            key="effects.inertia.output_moment",
        )


# -- findings -------------------------------------------------------------------------------------
# Findings of the vibration.


LARGEST_FORCE: Final = "largest-train-force"
BY_LOAD: Final = "load-deflection"

AMPLIFICATION: Final = 10.0
"""Amplification of a harmonic above which it counts as resonance. Without damping this is reached
within 5 % of the natural frequency; with D of 0.05 or more it is hardly reached, as the maximum is
about 1 / (2 D)."""

EXACT: Final = 1e12
"""An amplification from here on is a rounded infinity: the harmonic equals the natural frequency,
and only a motion without this harmonic has a steady state.
"""

SHARE: Final = 0.1
"""Share of the largest deflection below which a harmonic is not significant."""

SETTLED: Final = 0.02
"""Share of an amplitude at which a transient counts as settled, as in the settling time 4 / (D w)
of control engineering.
"""


def magnitude(both: Extremes) -> Extreme:
    """The extreme of larger magnitude, made positive; its cam angle in [0, 2 pi)."""
    worst = max(both.lowest, both.highest, key=lambda extreme: abs(extreme.value))
    return Extreme(abs(worst.value), worst.place % TURN)


def mode_findings(train: Train, period: float) -> Iterator[Finding]:
    """The natural frequencies, and the time constants of overdamped modes."""
    for rate in train.poles.tolist():
        frequency = abs(rate)
        if rate.imag == 0.0:
            yield Finding(
                name="time-constant",
                severity="ok",
                sentence=f"time constant {1e3 / frequency:.6g} ms of an overdamped mode",
                value=1.0 / frequency,
                unit="s",
            )
            continue
        yield Finding(
            name="natural-frequency",
            severity="ok",
            sentence=(
                f"natural frequency {frequency / TURN:.6g} Hz,"
                f" {frequency * period / TURN:.6g} times the speed of the cam,"
                f" {TURN / period / RPM:.6g} rev/min"
            ),
            value=frequency / TURN,
            unit="Hz",
        )


def error_finding(error: Extreme, limit: float | None, shown: Label) -> Finding:
    """The largest error of the motion, checked against its limit."""
    broken = limit is not None and error.value > limit
    verdict = "" if limit is None else f", {'above' if broken else 'at most'} {shown.format(limit)}"
    return Finding(
        name="largest-motion-error",
        severity="broken" if broken else "ok",
        sentence=(
            f"largest error of the motion {shown.format(error.value)}"
            f" {at_angle(error.place)}{verdict}"
        ),
        value=shown.scale * error.value,
        limit=None if limit is None else shown.scale * limit,
        unit=shown.unit,
        cam_angle=error.place,
    )


def load_finding(deflection: Extreme, shown: Label) -> Finding:
    """The part of this error by which the load deflects the train at rest."""
    return Finding(
        name=BY_LOAD,
        severity="ok",
        sentence=(
            f"at rest the load deflects the output by up to {shown.format(deflection.value)}"
            f" {at_angle(deflection.place)}, which is a part of this error"
        ),
        value=shown.scale * deflection.value,
        unit=shown.unit,
        cam_angle=deflection.place,
    )


def unexcited() -> Finding:
    """The warning that the load cannot be taken into account."""
    return Finding(
        name="unexcited-train",
        severity="warning",
        sentence=(
            "the load acts on a mass that has the demanded motion, and [effects.inertia] states"
            " none: the load is left out here"
        ),
    )


def acceleration_finding(acceleration: Extreme, clock: Clock, shown: Label) -> Finding:
    """The largest acceleration of the output, compared with that of a rigid train."""
    rigid = Output(clock, None)
    stiff = magnitude(piecewise_extremes(rigid.acceleration, clock.edges))
    times = (
        f", {acceleration.value / stiff.value:.4g} times"
        if stiff.value > 0.0
        else ", compared with"
    )
    unit = f"{shown.unit}/s^2"
    return Finding(
        name="largest-output-acceleration",
        severity="ok",
        sentence=(
            f"largest acceleration of the output {shown.scale * acceleration.value:.6g} {unit}"
            f" {at_angle(acceleration.place)}{times} that of a rigid train,"
            f" {shown.scale * stiff.value:.6g} {unit} {at_angle(stiff.place)}"
        ),
        value=shown.scale * acceleration.value,
        unit=unit,
        cam_angle=acceleration.place,
    )


def force_column(link: int) -> str:
    """The name of the force in a spring over the cam angle."""
    return f"train force {link + 1}"


def force_findings(
    output: Output, links: int, edges: FloatArray, label: Label
) -> Iterator[Finding]:
    """The largest force in each spring with its damper, from the cam outwards."""
    if not links:
        return
    for link, both in enumerate(piecewise_extremes_of_many(Links(links), output, edges)):
        extreme = magnitude(both)
        yield Finding(
            name=LARGEST_FORCE,
            severity="ok",
            sentence=(
                f"largest {label.word} in spring and damper {link + 1} of the train"
                f" {label.scale * extreme.value:.6g} {label.unit} {at_angle(extreme.place)}"
            ),
            value=label.scale * extreme.value,
            unit=label.unit,
            cam_angle=extreme.place,
        )


def dwell_findings(clock: Clock, response: Response, shown: Label) -> Iterator[Finding]:
    """The residual vibration at the start of each dwell, the largest one, and what is left of a
    vibration at the end of the shortest dwell.
    """
    rests = [rest for rest in clock.motion.dwells if 0.0 < rest.span < TURN]
    if not rests:
        return
    starts = np.array([rest.start for rest in rests])
    amplitudes = response.free_amplitude(clock.time(in_turn(starts, "right")), "right")
    for rest, amplitude in zip(rests, amplitudes.tolist(), strict=True):
        yield _residual("residual-vibration", "residual vibration", rest, amplitude, shown)
    worst = int(np.argmax(amplitudes))
    yield _residual(
        "largest-residual-vibration",
        "largest residual vibration",
        rests[worst],
        float(amplitudes[worst]),
        shown,
    )
    # The mode that decays most slowly decides what is left.
    slowest = float(np.max(response.train.poles.real))
    shortest = min(rests, key=lambda rest: _duration(clock, rest))
    left = math.exp(slowest * _duration(clock, shortest))
    lasts = "longer" if left <= SETTLED else "shorter"
    yield Finding(
        name="settling",
        severity="ok",
        sentence=(
            f"after the shortest dwell, which starts at cam angle {cam_angle(shortest.start)} deg"
            f" and lasts {1e3 * _duration(clock, shortest):.4g} ms, {remaining_share(left, 3)} of a"
            f" vibration is left: the dwell is {lasts} than the transient, which counts as settled"
            f" at {100.0 * SETTLED:g} %"
        ),
        value=left,
        cam_angle=shortest.start,
    )


def resonance_findings(response: Response, most: float, shown: Label) -> Iterator[Finding]:
    """The harmonic of the cam's speed nearest to each natural frequency."""
    turn = TURN / response.base.period
    for rate in response.train.poles.tolist():
        if rate.imag == 0.0:
            continue
        number = max(1, round(abs(rate) / turn))
        # The transfer is that from -y'', the amplification that from y.
        factor = abs(response.train.transfer(number * turn)) * (number * turn) ** 2
        # A real harmonic has twice the magnitude of its complex coefficient.
        part = resolved(2.0 * abs(response.harmonic(number)), most)
        near = factor > AMPLIFICATION and part > SHARE * most
        amplified = f"amplified {factor:.4g} times, it"
        if not factor < EXACT:
            factor, amplified = None, "amplified without limit, and absent from the motion: it"
        yield Finding(
            name="resonance",
            severity="warning" if near else "ok",
            sentence=(
                f"harmonic {number} of the cam's speed is nearest to the natural frequency,"
                f" {abs(rate) / turn:.6g} times that speed: {amplified}"
                f" contributes {shown.format(part)} of the deflection of {shown.format(most)}"
            ),
            value=factor,
            limit=AMPLIFICATION if near else None,
        )


def _residual(name: str, what: str, rest: MergedDwell, amplitude: float, shown: Label) -> Finding:
    return Finding(
        name=name,
        severity="ok",
        sentence=(
            f"{what} of {shown.format(amplitude)} in the dwell that starts at cam angle"
            f" {cam_angle(rest.start)} deg"
        ),
        value=shown.scale * amplitude,
        unit=shown.unit,
        cam_angle=rest.start,
    )


def _duration(clock: Clock, rest: MergedDwell) -> float:
    ends = clock.course.time(np.array([rest.start, rest.start + rest.span]))
    return float(ends[1] - ends[0])


# -- output ---------------------------------------------------------------------------------------
# The motion of the output over the cam angle, rigid or elastic.


@dataclass(frozen=True, slots=True, eq=False)
class Clock:
    """The motion of the state over time; time 0 is cam angle 0.

    Attributes
    ----------
    edges : (m + 1,) cam angles [rad] from 0 to 2 pi, between which motion and speed are smooth.
    """

    motion: Motion
    course: TimeCourse
    edges: FloatArray

    def time(self, phi: FloatArray) -> FloatArray:
        """(n,) time [s] since cam angle 0, at `phi` (n,) [rad]."""
        return np.asarray(self.course.time(phi) - self.course.time(np.zeros(1)))

    def angle(self, t: FloatArray) -> FloatArray:
        """(n,) cam angle [rad] at `t` (n,) [s], within the turn."""
        if isinstance(self.course, ConstantSpeed):
            return t * self.course.speed
        return inverse(self.time, lambda phi: 1.0 / self.course.rates(phi)[0], self.edges, t)

    def jet(self, t: FloatArray, side: Side) -> FloatArray:
        """(4, n) motion and its derivatives over time at `t` (n,) [s]."""
        phi = self.angle(t)
        return in_time(self.motion.jet(phi, side), self.course, phi, side)

    @property
    def base(self) -> Base:
        """The motion as the excitation of the train."""
        return Base(self.jet, self.time(self.edges))

    def load(self, force: Force, share: float) -> Forcing:
        """The `force` on the output as excitation; its series may truncate the `share` of it."""

        def pressed(t: FloatArray) -> FloatArray:
            return np.asarray(force.coefficients(self.angle(t), "right")[0])

        edges = merged(np.concatenate((self.edges, force.borders)))
        return load_forcing(pressed, self.time(edges), share)


def motion_clock(subject: Subject, course: TimeCourse) -> Clock:
    """The motion of the output in the state of `subject`, over time."""
    edges = merged(np.concatenate((subject.state.output.borders, course.borders, [0.0, TURN])))
    return Clock(subject.state.output, course, edges)


@dataclass(frozen=True, slots=True, eq=False)
class Output:
    """The motion of the output.

    Attributes
    ----------
    clock : the motion of the state over time.
    response : of the train in its steady state; None if the train is rigid, without mass.
    """

    clock: Clock
    response: Response | None

    def states(self, phi: FloatArray, side: Side) -> FloatArray:
        """(3, n) deflection [mm or rad], its velocity, and the acceleration of the output."""
        if self.response is not None:
            return self.response.states(self.clock.time(in_turn(phi, side)), side)
        rigid = np.zeros((3, len(phi)))
        rigid[2] = in_time(self.clock.motion.jet(phi, side), self.clock.course, phi, side)[2]
        return rigid

    def deflection(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) output minus motion of the state [mm or rad] at `phi` (n,) [rad]."""
        return np.asarray(self.states(phi, side)[0])

    def lasting(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) the deflection if the load stays as it is there."""
        if self.response is None:
            return np.zeros(len(phi))
        train = self.response.train
        reading = train.deflection(train.output)
        return self.response.at_rest(reading, self.clock.time(in_turn(phi, side)), side)

    def moving(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) the rest of the deflection."""
        return self.deflection(phi, side) - self.lasting(phi, side)

    def acceleration(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) acceleration of the output [mm/s^2 or rad/s^2]."""
        return np.asarray(self.states(phi, side)[2])

    def forces(self, links: Sequence[int], phi: FloatArray, side: Side) -> FloatArray:
        """(k, n) forces [N or N mm] in the `links`, see `Response.forces`."""
        assert self.response is not None  # a rigid train has no springs
        return self.response.forces(links, self.clock.time(in_turn(phi, side)), side)


@dataclass(frozen=True, slots=True)
class Links:
    """The first `count` springs with their dampers, asked for their forces together: all follow
    from the same modes. See `camgeo.numeric.arrays.Many`.
    """

    count: int

    def everywhere(self, output: Output, phi: FloatArray, side: Side) -> FloatArray:
        """(count, n) forces [N or N mm]."""
        return output.forces(range(self.count), phi, side)

    def paired_values(
        self, output: Output, phi: FloatArray, side: Side, which: IntArray
    ) -> FloatArray:
        """(n,) forces, each in the spring with the number in `which` (n,)."""
        forces = np.zeros(len(phi))
        for link in np.unique(which).tolist():
            selected = which == link
            forces[selected] = output.forces([link], phi[selected], side)[0]
        return forces
