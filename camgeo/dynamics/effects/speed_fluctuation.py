"""Speed of a motor-driven cam over a turn in its steady state.

J omega domega/dphi = T_m(omega) - T(phi, omega, alpha) with alpha = omega domega/dphi, the moment
of inertia J of everything that turns with the camshaft, the torque T_m of the motor, and the drive
torque T of the cam, which includes the inertia of the follower (equation of motion of a machine
with one degree of freedom; Volmer, Getriebetechnik, chapter on dynamics). The solution is the speed
that repeats after each turn.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final, Self

import numpy as np

from camgeo.check.finding import Finding, limit_finding
from camgeo.dynamics.effects.bearing_friction import (
    LINEAR,
    StuckError,
    linear_law,
    scalar_linear_law,
)
from camgeo.dynamics.effects.contact import lost_contact
from camgeo.dynamics.effects.effect import Bound, Column, Quantity, Request
from camgeo.dynamics.effects.forces import all_borders, smooth_edges
from camgeo.dynamics.effects.results import DRIVE_TORQUE, Turning, Unknown
from camgeo.dynamics.effects.shaft import (
    EPS,
    FINEST,
    INTERIOR_FACTOR,
    INTERPOLATION_ERROR,
    KEEP,
    LONGEST,
    NODES,
    ROUGH,
    ROUNDINGS,
    DoubleMesh,
    Mesh,
    NoConvergenceError,
    Shaft,
    State,
    cell_nodes,
    collocation,
    double_mesh,
    interleaved,
    jamming,
    legendre,
    refuse_shocks,
    steady_course,
    switches,
)
from camgeo.dynamics.effects.tables import Motor, MotorDrive
from camgeo.dynamics.effects.wording import (
    N_M,
    Label,
    at_angle,
    placed,
    remaining_share,
    resolved_ends,
    tolerance_error,
)
from camgeo.errors import EffectError
from camgeo.numeric.arrays import SHARE, FloatArray, Side, frozen, merged, resolved
from camgeo.numeric.extremes import Extreme, Extremes, bracketed_roots, piecewise_extremes
from camgeo.units import RPM, TURN, cam_angle


@dataclass(frozen=True, slots=True, eq=False)
class SpeedFluctuation(Turning):
    """The steady state of a motor-driven cam.

    Attributes
    ----------
    turn : the speed over the cam angle.
    steady : the same with its mean values and errors.
    alpha : (n,) angular acceleration of the cam [rad/s^2] at n cam angles.
    mean_speed : over time [rad/s].
    fluctuation : difference of largest and smallest speed, divided by the mean.
    """

    turn: SteadyTurn
    steady: Steady
    alpha: Quantity
    mean_speed: float
    fluctuation: float

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """See `Turning`."""
        return (Unknown(Label("speed", "rev/min", 1.0 / RPM), self.turn.omega, self.steady.speed),)

    def with_added_errors(self, added_errors: Sequence[float], rough: Self) -> Self:
        """See `Turning`."""
        del rough
        steady = replace(self.steady, added_error=added_errors[0])
        return replace(self, steady=steady, errors=steady.figures())


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
    switch_angles = np.setdiff1d(steady.edges, edges)
    kinks = np.concatenate(
        (subject.state.smooth_angles, all_borders(contact.lasting), switch_angles)
    )
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
        return contact.normal_at_rates(phi, side, rates)

    speeds, torques = piecewise_extremes(omega, edges), piecewise_extremes(motor, edges)
    fluctuation = resolved(speeds.highest.value - speeds.lowest.value, mean) / mean
    text = f"speed fluctuation {fluctuation:.5g}, largest minus smallest speed divided by the mean"
    findings = (
        limit_finding("speed-fluctuation", text, fluctuation, data.limit),
        Finding(
            "mean-speed",
            "ok",
            f"mean speed {mean / RPM:.6g} rev/min over time; a disturbance of the speed decays to"
            f" {remaining_share(turn.slope)} of its size per turn",
            mean / RPM,
            unit="rev/min",
        ),
        *_extremes("speed", "speed", speeds, 1.0 / RPM, "rev/min"),
        *_extremes("motor-torque", "torque of the motor", torques, N_M, "N m"),
        Finding(
            "motor-work",
            "ok",
            f"work of the motor over a turn {N_M * work:.5g} J, of which the cam takes"
            f" {N_M * steady.cam_work:.5g} J",
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
        turn=turn,
        steady=steady,
        course=steady_course(turn, alpha, kinks),
        rough_course=steady_course(turn.rough, alpha, kinks),
        alpha=alpha,
        mean_speed=mean,
        fluctuation=fluctuation,
        findings=findings,
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
        extreme = Extreme(factor * end.value, end.place)
        sentence = f"{which} {words} {extreme.value:.6g} {unit} {at_angle(extreme.place)}"
        yield placed(f"{which}-{name}", sentence, extreme, unit)


# -- errors ---------------------------------------------------------------------------------------
# How far the figures of the steady state may be off, and the turn that makes them accurate enough.
#
# All follow from the error e of the speed. The torque of the motor is off by its slope times e, its
# work over a turn by 2 pi times that; both may be small compared with the torque at standstill, so
# the speed must be the more accurate. Mean values are integrals over the nodes of the cells;
# halving the cells changes them by about their error.


@dataclass(frozen=True, slots=True, eq=False)
class Steady:
    """A steady turn with its mean values and the errors of all figures.

    Attributes
    ----------
    turn : the speed over the cam angle.
    edges : (k,) cam angles [rad] from 0 to 2 pi between which the acceleration is smooth.
    period : duration of the turn [s].
    work : of the motor over a turn [N mm], of which the cam takes `cam_work`.
    slowest, fastest : speeds at the nodes [rad/s].
    slope : of the torque of the motor, the steepest at these speeds [N mm s].
    largest : torque of motor or cam, the larger one [N mm]; the terms of the motor's own if both
        are rounding.
    period_error, work_error : changes on cells half as long [s], [N mm].
    added_error : error of the speed that is not that of the solution for this torque law [rad/s].
    """

    turn: SteadyTurn
    edges: FloatArray
    period: float
    work: float
    cam_work: float
    slowest: float
    fastest: float
    slope: float
    largest: float
    period_error: float
    work_error: float
    added_error: float = 0.0

    @property
    def mean(self) -> float:
        """Mean speed over time [rad/s]."""
        return TURN / self.period

    @property
    def speed(self) -> Bound:
        """Error of the speed [rad/s]."""
        error = (self.turn.error + INTERPOLATION_ERROR) * self.fastest
        return Bound(error + self.added_error, self.fastest)

    @property
    def torque(self) -> Bound:
        """Error of the torque of the motor [N mm]."""
        return Bound(self.slope * self.speed.error, self.largest)

    def figures(self) -> dict[str, Bound]:
        """The errors by the names of findings and columns."""
        # |d(1/omega)| <= e / omega^2, relative to the mean of 1/omega at most e / slowest.
        late = self.speed.error / self.slowest + self.period_error / self.period
        mean = Bound(self.mean * late, self.fastest)
        swing = (self.fastest - self.slowest) / self.mean
        shares = 2.0 * self.speed.error / self.mean + swing * late
        work = Bound(TURN * self.torque.error + self.work_error, TURN * self.largest)
        power = work.times(1.0 / self.period)
        power = Bound(power.error + abs(self.work) / self.period * late, power.scale)
        speeds = dict.fromkeys(("cam speed", "largest-speed", "smallest-speed"), self.speed)
        torques = ("motor torque", "largest-motor-torque", "smallest-motor-torque")
        return {
            **{name: bound.times(1.0 / RPM) for name, bound in speeds.items()},
            **dict.fromkeys(torques, self.torque.times(N_M)),
            "mean-speed": mean.times(1.0 / RPM),
            "speed-fluctuation": Bound(shares, self.fastest / self.mean),
            "motor-work": work.times(N_M),
            "mean-motor-power": power.times(N_M),
        }


def accurate(
    shaft: Shaft[Motor],
    law: Quantity,
    edges: FloatArray,
    tolerance: float,
    near: SteadyTurn | None,
) -> Steady:
    """The steady state, of which one that is `near` may be known; raises as `solve`.

    The speed is found to the tolerance, and so is the torque of the motor unless rounding of the
    speed is larger: a stiff motor has almost no slip, from which its torque follows. The error of
    the torque shows this.
    """
    turn = near
    for rough in ROUGH:
        if turn is None or rough < ROUGH[0]:
            turn = solve(shaft, law, edges, max(rough, tolerance), turn)
        switch_angles = switches(law, edges, turn.mesh.laws, turn.driven)
        if not len(switch_angles):
            break
        edges = merged(np.concatenate((edges, switch_angles)))
    steady = _measured(shaft, solve(shaft, law, edges, tolerance, turn), edges)
    worst = max(bound.share for bound in steady.figures().values())
    if worst > tolerance:
        speed = max(0.5 * tolerance * steady.turn.error / worst, FINEST)
        with suppress(EffectError):
            steady = _measured(shaft, solve(shaft, law, edges, speed, steady.turn), edges)
    return steady


def _measured(shaft: Shaft[Motor], turn: SteadyTurn, edges: FloatArray) -> Steady:
    """The mean values, and the data from which their errors follow."""
    motor, mesh = shaft.motor, turn.mesh
    omega = np.sqrt(2.0 * (turn.state.base + turn.state.nodes))
    torque = motor.torque(omega)[0]
    middle = 0.5 * (mesh.low + mesh.high)
    halves = [(mesh.low, middle), (middle, mesh.high)]
    inner = [turn.omega(cell_nodes(*ends).ravel()).reshape(omega.shape) for ends in halves]
    weights = 0.5 * mesh.spans[:, np.newaxis] * collocation().weights
    finer = [
        (np.sum(weights / speeds), np.sum(weights * motor.torque(speeds)[0])) for speeds in inner
    ]
    period, work = (float(value) for value in np.sum(finer, axis=0))
    slowest, fastest = float(np.min(omega)), float(np.max(omega))
    slope = float(np.max(np.abs(_slopes(motor, slowest, fastest))))
    terms = float(np.max(np.abs(motor.torques))) + slope * (fastest + float(motor.speeds[-1]))
    cam = torque - shaft.inertia * turn.rates
    largest = max(float(np.max(np.abs(torque))), float(np.max(np.abs(cam))))
    cam_work = work - shaft.inertia * TURN * turn.mean(turn.rates)
    return Steady(
        turn=turn,
        edges=edges,
        period=period,
        work=resolved(work, TURN * terms),
        cam_work=resolved(cam_work, TURN * terms),
        slowest=slowest,
        fastest=fastest,
        slope=slope,
        largest=largest if largest > SHARE * terms else terms,
        period_error=abs(period - TURN * turn.mean(1.0 / omega)),
        work_error=abs(work - TURN * turn.mean(torque)),
    )


def _slopes(motor: Motor, slowest: float, fastest: float) -> FloatArray:
    """(k,) slopes [N mm s] of the lines of the motor's curve between two speeds [rad/s]."""
    inside = motor.speeds[(motor.speeds > slowest) & (motor.speeds < fastest)]
    return motor.torque(np.concatenate(([slowest], inside, [fastest])))[1]


# -- solve ----------------------------------------------------------------------------------------
# Solution for the steady state, and its obstacles: shocks, a stall, a follower that jams.


GUESSES: Final = 65
"""Number of constant speeds, up to twice the no-load speed, at which the power balance is
tested.
"""


def solve(
    shaft: Shaft[Motor],
    law: Quantity,
    edges: FloatArray,
    tolerance: float,
    near: SteadyTurn | None = None,
) -> SteadyTurn:
    """The steady state, starting from one that is `near`; without it, or if that fails, from the
    power balance, and if that fails from single turns.

    Raises
    ------
    EffectError
        "stall", if there is none; "jamming", if no acceleration satisfies the equation of motion
        with friction; and if the tolerance cannot be reached.
    """
    mesh = double_mesh(law, edges, LONGEST)
    try:
        if near is not None:
            y = near.y(mesh.coarse.nodes.ravel()).reshape(mesh.coarse.nodes.shape)
            with suppress(NoConvergenceError):
                return steady_turn(shaft, law, mesh, y, tolerance)
        guess = _balanced(shaft, mesh.coarse)
        if guess is not None:
            try:
                return steady_turn(shaft, law, mesh, guess, tolerance)
            except NoConvergenceError as error:
                if error.reached is not None:
                    raise
        single_turns = outcome(shaft, law, edges)
        if single_turns.y is None:
            raise _stall(shaft, single_turns.stall)
        y = np.interp(mesh.coarse.nodes, single_turns.angles, single_turns.y)
        return steady_turn(shaft, law, mesh, np.maximum(y, 1e-6 * np.max(y)), tolerance)
    except StuckError as error:
        raise jamming(shaft.inertia, mesh.fine) from error
    except NoConvergenceError as error:
        raise _missed(error.reached, tolerance) from error


def _balanced(shaft: Shaft[Motor], mesh: Mesh) -> float | None:
    """y [rad^2/s^2] of the largest constant speed with balanced power; None if there is none."""
    weights = mesh.spans[:, np.newaxis] * collocation().weights / TURN

    def surplus(omega: FloatArray) -> FloatArray:
        drive = shaft.motor.torque(omega)[0]
        cam_torque = np.empty(len(omega))
        for k, speed in enumerate(omega):
            c0, c1, c2, _, ahead, behind = linear_law(mesh.laws, speed, 0.0)
            force = c0 + speed * (c1 + speed * c2)
            torque = np.where(force == 0.0, 0.0, force * np.where(force > 0.0, ahead, behind))
            cam_torque[k] = np.sum(weights * torque)
        return drive - cam_torque

    top = shaft.motor.no_load_speed
    speeds = np.linspace(0.0, 2.0 * top, GUESSES)[1:]
    values = surplus(speeds)
    if np.any(np.isnan(values)):
        raise StuckError
    falls = np.flatnonzero((values[:-1] >= 0.0) & (values[1:] < 0.0))
    if len(falls):
        k = int(falls[-1])
        balanced_speed = float(
            bracketed_roots(surplus, speeds[k : k + 1], speeds[k + 1 : k + 2])[0]
        )
        return 0.5 * balanced_speed * balanced_speed
    return 0.5 * top * top if values[-1] >= 0.0 else None


def _stall(shaft: Shaft[Motor], phi: float) -> EffectError:
    torque = N_M * float(shaft.motor.torque(np.zeros(1))[0][0])
    place = phi % TURN
    return EffectError(
        f"the motor stalls near cam angle {cam_angle(place, '.1f')} deg: whatever its initial"
        f" speed, its stall torque of {torque:.5g} N m cannot carry the cam through the turn, and"
        " there is no steady state",
        finding="stall",
        value=torque,
        unit="N m",
        cam_angle=place,
    )


def _missed(reached: float | None, tolerance: float) -> EffectError:
    if reached is None or not math.isfinite(reached):
        return EffectError(
            "no steady state of the cam's speed was found, though the motor does not stall"
        )
    return tolerance_error("the speed of the cam", reached, "the largest speed", tolerance)


# -- march ----------------------------------------------------------------------------------------
# Coarse integration of single turns: whether the motor stalls, and where.
#
# Orbits of dy/dphi = alpha(phi, y) never cross. One that ends its turn no slower than it began is
# below a periodic orbit or is one. If all orbits either stall or lose speed over the turn, there is
# none.


STEPS: Final = 1440
"""Smallest number of steps per turn, of a quarter of a degree each."""

GAMMA: Final = 1.0 - math.sqrt(0.5)
"""Coefficient of the L-stable diagonally implicit Runge-Kutta method of two stages and order 2
(Hairer and Wanner, Solving Ordinary Differential Equations II, section IV.6), suitable for stiff
motors."""

MOST_STEPS: Final = 50
"""Largest number of Newton steps in a stage."""

CLOSE: Final = 1e-12
"""Relative change of y at which they end."""

HALVINGS: Final = 40
"""Bisections of the speed range that contains the slowest orbit that completes a turn."""

DOUBLINGS: Final = 60


@dataclass(frozen=True, slots=True, eq=False)
class Outcome:
    """Whether the cam reaches a steady state.

    Attributes
    ----------
    angles : (k,) ends of the steps [rad].
    y : (k,) of a turn that ends no slower than it began; None if the motor stalls.
    stall : cam angle [rad] of the stall, to the accuracy of a step; nan without one.
    """

    angles: FloatArray
    y: FloatArray | None
    stall: float


def outcome(shaft: Shaft[Motor], law: Quantity, edges: FloatArray) -> Outcome:
    """Whether there is a steady state, from single turns at different speeds.

    The range from 0 to a speed from which the cam slows down is bisected: an orbit that loses speed
    over the turn is an upper bound, one that stalls a lower bound. They converge to the slowest
    orbit that completes a turn; the motor stalls where the orbits below it come to rest.

    Raises
    ------
    StuckError
        If no acceleration satisfies the equation of motion with friction.
    """
    march = _march(shaft, law, edges)
    high = 0.5 * shaft.motor.no_load_speed**2
    for _ in range(DOUBLINGS):
        stalled = march.orbit(high)
        if stalled[-1] < high:
            break
        high *= 2.0
    low = 0.0
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        orbit = march.orbit(middle)
        if orbit[-1] == 0.0:
            low, stalled = middle, orbit
        elif orbit[-1] < middle:
            high = middle
        else:
            return Outcome(march.angles, frozen(orbit, np.float64), math.nan)
    return Outcome(march.angles, None, float(march.angles[len(stalled) - 1]))


@dataclass(frozen=True, slots=True, eq=False)
class _March:
    """Steps over a turn, with the law at the two stages of each."""

    inertia: float
    torque: Callable[[float], tuple[float, float]]
    angles: FloatArray
    laws: list[list[list[float]]]

    def orbit(self, y: float) -> list[float]:
        """y at the ends of the steps of the turn that begins with `y` [rad^2/s^2].

        It ends at the first 0, where the cam comes to rest.
        """
        course = [y]
        steps = np.diff(self.angles).tolist()
        for step, (inside, end) in zip(steps, self.laws, strict=True):
            # Both stages are implicit with the same coefficient: the second one ends the step.
            stage_step = GAMMA * step
            first = self._stage(inside, y, stage_step, y)
            if first is not None:
                slope = (first - y) / stage_step
                second = self._stage(end, y + (step - stage_step) * slope, stage_step, first)
            if first is None or second is None:
                return [*course, 0.0]
            y = second
            course.append(y)
        return course

    def _stage(self, law: list[float], known: float, step: float, y: float) -> float | None:
        """The y above 0 with y = known + step alpha(y), from a guess; None if there is none."""
        if known + step * self._rate(law, 0.0)[0] <= 0.0:
            return None
        y = max(y, np.finfo(np.float64).tiny)
        for _ in range(MOST_STEPS):
            alpha, growth = self._rate(law, y)
            new = y - (y - known - step * alpha) / max(1.0 - step * growth, 0.1)
            # y stays above 0, where alpha is defined.
            new = max(new, 0.1 * y)
            if abs(new - y) <= CLOSE * new:
                return new
            y = new
        return y

    def _rate(self, law: list[float], y: float) -> tuple[float, float]:
        """`Shaft.rate` for one number; the slope is 0 at rest."""
        omega = math.sqrt(2.0 * y)
        drive, slope = self.torque(omega)
        if len(law) != LINEAR:
            law = scalar_linear_law(law, omega, drive / self.inertia, 1.0 / self.inertia)
        c0, c1, c2, c3, ahead, behind = law
        rest = c0 + omega * (c1 + omega * c2)
        gain = ahead if self.inertia * rest + c3 * drive >= 0.0 else behind
        if rest == 0.0 and c3 == 0.0:
            gain = 0.0
        moment = self.inertia + gain * c3
        if not moment > 0.0:
            raise StuckError
        alpha = (drive - gain * rest) / moment
        if omega == 0.0:
            return alpha, 0.0
        return alpha, (slope - gain * (c1 + 2.0 * omega * c2)) / (omega * moment)


def _march(shaft: Shaft[Motor], law: Quantity, edges: FloatArray) -> _March:
    counts = np.ceil(np.diff(edges) * (STEPS / TURN)).astype(np.intp)
    grids = [
        np.linspace(a, b, count + 1)[:-1]
        for a, b, count in zip(edges[:-1], edges[1:], counts, strict=True)
    ]
    angles = np.append(np.concatenate(grids), edges[-1])
    low, high = angles[:-1], angles[1:]
    laws = np.stack((law(low + GAMMA * (high - low), "right"), law(high, "left")))
    return _March(shaft.inertia, _plain(shaft.motor), angles, laws.transpose(2, 0, 1).tolist())


def _plain(motor: Motor) -> Callable[[float], tuple[float, float]]:
    """`Motor.torque` for one number."""
    speeds, torques = motor.speeds.tolist(), motor.torques.tolist()
    slopes = (np.diff(motor.torques) / np.diff(motor.speeds)).tolist()

    def torque(omega: float) -> tuple[float, float]:
        row = min(max(bisect_right(speeds, omega) - 1, 0), len(slopes) - 1)
        return torques[row] + slopes[row] * (omega - speeds[row]), slopes[row]

    return torque


# -- steady ---------------------------------------------------------------------------------------
# The periodic solution of dy/dphi = alpha(phi, y), by collocation over the whole turn at once.
#
# The error estimate is the change by one more Newton step on the mesh of all halves of the cells,
# taken several times for what lies between their nodes.


MOST_NEWTON_STEPS: Final = 60
"""Largest number of Newton steps; a few are enough except at kinks of the torque law."""

FULL_STEPS: Final = 20
"""Number of full Newton steps; later ones are halved, as a kink may make them alternate."""

MOST_PASSES: Final = 80
"""Largest number of mesh refinements; each one at a kink divides its error by 4."""

MOST_CELLS: Final = 40_000

NEAR: Final = 1e-3
"""Relative step size at which the iteration is at a solution, even if rounding prevents smaller
steps."""


@dataclass(frozen=True, slots=True, eq=False)
class NewtonStep:
    """A Newton step: the changes, the defect of each cell, and the slope of the Poincare map."""

    starts: FloatArray
    nodes: FloatArray
    defects: FloatArray
    slope: float


def newton_step(shaft: Shaft[Motor], mesh: Mesh, state: State) -> NewtonStep:
    """The Newton step from `state`, on all cells of the turn together."""
    rule = collocation()
    spans = mesh.spans
    alpha, growth = shaft.rate(mesh.laws, state.base + state.nodes)
    inner = spans[:, np.newaxis, np.newaxis] * rule.integral
    residual = (
        state.starts[:-1, np.newaxis]
        + spans[:, np.newaxis] * (alpha @ rule.integral.T)
        - state.nodes
    )
    matrix = np.eye(len(rule.nodes)) - inner * growth[:, np.newaxis, :]
    # Column 0: the response to a unit change at the start of the cell; column 1: that to the
    # residual.
    sides = np.stack((np.ones_like(residual), residual), axis=2)
    solved = np.linalg.solve(matrix, sides)
    weight = spans[:, np.newaxis] * rule.weights * growth
    factors = 1.0 + np.sum(weight * solved[:, :, 0], axis=1)
    gaps = state.starts[:-1] + spans * (alpha @ rule.weights) - state.starts[1:]
    offsets = np.sum(weight * solved[:, :, 1], axis=1) + gaps
    # The affine maps of the cells one after the other: the Poincare map, to first order.
    slope, shift = 1.0, 0.0
    slopes, shifts = np.empty(len(spans) + 1), np.empty(len(spans) + 1)
    slopes[0], shifts[0] = slope, shift
    for k, (factor, offset) in enumerate(zip(factors.tolist(), offsets.tolist(), strict=True)):
        slope, shift = factor * slope, factor * shift + offset
        slopes[k + 1], shifts[k + 1] = slope, shift
    # The solution is not isolated, and the step undetermined.
    if slope == 1.0:
        raise NoConvergenceError(None)
    # Periodicity: z at the end of the turn is z at its start.
    missing = float(state.starts[-1] - state.starts[0])
    first = (shift + missing) / (1.0 - slope)
    starts = slopes * first + shifts
    nodes = solved[:, :, 0] * starts[:-1, np.newaxis] + solved[:, :, 1]
    # The response of the cell to its residual, which a stiff motor damps strongly.
    defects = np.maximum(np.max(np.abs(solved[:, :, 1]), axis=1), np.abs(offsets))
    return NewtonStep(starts, nodes, defects, slope)


@dataclass(frozen=True, eq=False)
class SteadyTurn:
    """The steady state.

    Attributes
    ----------
    shaft : the camshaft and its motor.
    mesh : the cells.
    state : y in them.
    rates : (m, n) alpha at the nodes [rad/s^2].
    slope : of the Poincare map in y; below 1 the state is stable.
    error : estimate of the largest error of the speed, relative to the largest speed.
    rough : the steady state on cells twice as long, from which the error is estimated; None for it.
    """

    shaft: Shaft[Motor]
    mesh: Mesh
    state: State
    rates: FloatArray
    slope: float
    error: float
    rough: SteadyTurn | None

    @cached_property
    def _series(self) -> FloatArray:
        """(m, n + 1) Legendre coefficients of z in each cell."""
        return np.asarray(self.state.all_nodes @ collocation().fit.T)

    def omega(self, phi: FloatArray) -> FloatArray:
        """(n,) speed [rad/s] at `phi` (n,) [rad], in any turn."""
        return np.sqrt(2.0 * self.y(phi))

    def y(self, phi: FloatArray) -> FloatArray:
        """(n,) omega^2 / 2 [rad^2/s^2]."""
        cell, x = self.mesh.placed(phi)
        z: FloatArray = np.sum(legendre(x, NODES) * self._series[cell], axis=1)
        return self.state.base + z

    def driven(self, phi: FloatArray) -> tuple[Shaft[Motor], FloatArray]:
        """The camshaft, and y (n,) at `phi` (n,) [rad]."""
        return self.shaft, self.y(phi)

    def linearised(
        self, phi: FloatArray, rows: FloatArray, other: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """See `camgeo.dynamics.effects.shaft.SteadyTurn`: of omega, whose rate is alpha / omega."""
        y = self.y(phi)
        omega = np.sqrt(2.0 * y)
        alpha, growth = self.shaft.rate(rows, y)
        differences = (self.shaft.rate(other, y)[0] - alpha) / omega
        slopes = growth - alpha / omega**2
        return slopes[:, np.newaxis, np.newaxis], differences[:, np.newaxis]

    def mean(self, values: FloatArray) -> float:
        """Mean over the cam angle of `values` (m, n) at the nodes."""
        return float(np.sum(self.mesh.spans * (values @ collocation().weights))) / TURN


def steady_turn(
    shaft: Shaft[Motor], law: Quantity, mesh: DoubleMesh, y: FloatArray | float, tolerance: float
) -> SteadyTurn:
    """The periodic solution nearest to `y`.

    Parameters
    ----------
    shaft : the camshaft and its motor.
    law : the torque law of the cam.
    mesh : initial mesh; no cell contains an edge of the law.
    y : initial guess at the nodes (m, n) of the coarse mesh, or one value for all [rad^2/s^2].
    tolerance : largest error of the speed, relative to the largest speed.

    Raises
    ------
    NoConvergenceError
        If no solution is found.
    StuckError
        If friction leaves no acceleration.
    """
    guess = np.broadcast_to(np.asarray(y, dtype=np.float64), mesh.coarse.laws.shape[1:])
    # Close to the solution, z = y - base is small and keeps its digits.
    base = float(np.mean(guess))
    start = guess[:, 0] - base
    state = State(base, np.append(start, start[0]), guess - base)
    reached = np.inf
    for _ in range(MOST_PASSES):
        state, left = _solved(shaft, mesh.coarse, state, tolerance)
        fine_state = _interpolate_halves(state)
        step = newton_step(shaft, mesh.fine, fine_state)
        y_fine = fine_state.base + fine_state.nodes
        largest = float(np.max(y_fine))
        # d omega / omega_max = dy / (omega omega_max)
        share = np.max(np.abs(step.nodes) / np.sqrt(y_fine * largest)) * 0.5
        distance = max(abs(1.0 - step.slope), EPS)
        rounding = (
            ROUNDINGS * EPS * (1.0 + float(np.max(np.abs(fine_state.nodes))) / largest / distance)
        )
        reached = INTERIOR_FACTOR * float(share) + left + rounding
        if reached <= tolerance:
            fine_state, last = _solved(shaft, mesh.fine, fine_state, tolerance)
            solved = (mesh.coarse, state), (mesh.fine, fine_state)
            rates = [
                shaft.rate(grid.laws, values.base + values.nodes)[0] for grid, values in solved
            ]
            error = reached + last
            rough = SteadyTurn(shaft, mesh.coarse, state, rates[0], step.slope, error, None)
            return SteadyTurn(shaft, mesh.fine, fine_state, rates[1], step.slope, error, rough)
        worst = np.max(step.defects.reshape(-1, 2), axis=1)
        # Halving the worst cells alone keeps the mesh small where the solution is smooth.
        split = worst >= 0.1 * np.max(worst)
        cells = len(split) + int(np.count_nonzero(split))
        if not np.max(worst) > EPS * EPS * largest or cells > MOST_CELLS:
            break
        mesh = mesh.refined(law, split)
        both = np.repeat(split, 2)
        nodes = interleaved(split, state.nodes, fine_state.nodes[both])
        starts = interleaved(split, state.starts[:-1], fine_state.starts[:-1][both])
        state = State(state.base, np.append(starts, state.starts[-1]), nodes)
    raise NoConvergenceError(reached)


def _solved(shaft: Shaft[Motor], mesh: Mesh, state: State, tolerance: float) -> tuple[State, float]:
    """The collocation solution, and its last change relative to the largest speed."""
    target = max(1e-3 * tolerance, 16.0 * EPS)
    best = np.inf
    for count in range(MOST_NEWTON_STEPS):
        step = newton_step(shaft, mesh, state)
        y = state.base + state.nodes
        down = float(np.max(-step.nodes / y))
        ends = float(np.max(-step.starts / (state.base + state.starts)))
        # A step must leave the share KEEP of y, which is above 0.
        share = min(1.0, (1.0 - KEEP) / max(down, ends, 1e-300))
        if count >= FULL_STEPS:
            share *= 0.5
        shift = share * float(step.starts[0])
        base = state.base + (state.starts[0] + shift)
        # The base follows the solution; z is what is left of y.
        moved = base - state.base
        state = State(
            base,
            state.starts + (share * step.starts - moved),
            state.nodes + (share * step.nodes - moved),
        )
        change = 0.5 * float(np.max(np.abs(step.nodes)) / np.max(y))
        # Where the state is only weakly determined, rounding prevents smaller steps.
        stalled = change >= 0.25 * best and best <= max(0.1 * tolerance, 1e3 * EPS)
        if share == 1.0 and (change <= target or stalled):
            return state, change if stalled and change > target else change * change
        if not np.isfinite(change):
            raise NoConvergenceError(None)
        best = min(best, change)
    raise NoConvergenceError(best if best < NEAR else None)


def _interpolate_halves(state: State) -> State:
    """The polynomials through the nodes of all cells, at the nodes of their halves.

    Integrals of alpha would give the same except for rounding, which a stiff motor magnifies.
    Between nodes with a steep fall a polynomial may become negative, where there is no speed. It is
    kept above 0; such a cell does not have its solution yet, and will be split.
    """
    halves = np.einsum("hij,mj->mhi", collocation().halves, state.all_nodes)
    least = KEEP * np.min(state.base + state.all_nodes, axis=1)
    halves = np.maximum(halves, least[:, np.newaxis, np.newaxis] - state.base)
    middles = halves[:, 0, -1]
    starts = np.append(np.stack((state.starts[:-1], middles), axis=1).ravel(), state.starts[-1])
    return State(state.base, starts, halves.reshape(-1, NODES))
