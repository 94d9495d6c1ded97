"""Effect `shock-spectrum`: the residual vibration after each move, over t_move / T_n.

The train is at rest when the move begins. The amplitude of its free vibration after the move is
given relative to the stroke, see `camgeo.dynamics.oscillator.steady`. Two values are taken from
the spectrum: the largest residual from one natural period per move upwards, and the ratio above
which it stays below 1 %. With less than one period per move the train hardly follows, and the
residual approaches the stroke itself.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np

from camgeo.check.finding import Finding
from camgeo.dynamics.effects.effect import Request, Result, Subject, build_data
from camgeo.dynamics.oscillator.steady import QUIET, ROUNDINGS, Shock, shock
from camgeo.dynamics.oscillator.train import EPS
from camgeo.kinematics.laws.law import Law
from camgeo.kinematics.plan import MotionPlan, Move
from camgeo.kinematics.time_course import ConstantSpeed, TimeCourse, in_time
from camgeo.numeric.arrays import FloatArray, Side, merged
from camgeo.numeric.extremes import (
    Extreme,
    bracketed_roots,
    inverse,
    piecewise_extremes,
    piecewise_highest,
    sample_grid,
)
from camgeo.units import TURN

SMALLEST_RATIO: Final = 1e-12
"""Stands for 0, where the residual equals the final position of the move."""

FIRST_SPAN: Final = 10.0
"""Ratios searched first, in one step; further ones only while they may have the maximum."""

LONGEST: Final = 1000.0
"""Ratio up to which the start of the permanently small residual is searched for; a velocity jump as
large as the mean velocity leaves 1 % at a ratio of 32."""


@dataclass(frozen=True, slots=True)
class SpectrumRange:
    """Range and damping of the spectrum.

    Attributes
    ----------
    highest_ratio : upper end of the spectrum.
    damping : damping ratio of the train.
    """

    highest_ratio: float = 10.0
    damping: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Spectrum:
    """The spectrum of one move.

    Attributes
    ----------
    move : with its place.
    damping : damping ratio of the train.
    worst : the largest residual above ratio 1, or above 0 if the range ends below 1, with the
        first ratio at which it occurs.
    quiet : ratio above which the residual stays below 1 %; None if it does not up to the highest
        ratio, 0 if it always does.
    """

    move: RestToRest
    damping: float
    worst: Extreme
    quiet: float | None

    def residual(self, ratios: FloatArray) -> FloatArray:
        """(n,) amplitude relative to the stroke at `ratios` (n,), above 0, of duration to T_n."""
        return self.move.shock.residual(ratios, self.damping)

    def largest(self, ratios: FloatArray) -> FloatArray:
        """(n,) largest deflection likewise, see `Shock.largest`."""
        return self.move.shock.largest(ratios, self.damping)


@dataclass(frozen=True, slots=True, eq=False)
class ShockSpectrum(Result):
    """The shock spectra of a motion.

    Attributes
    ----------
    spectra : of the moves from rest to rest, in the order of the cam angle.
    highest_ratio : their upper end.
    """

    spectra: tuple[Spectrum, ...]
    highest_ratio: float


def compute(request: Request[Mapping[str, Any]]) -> ShockSpectrum:
    """The spectra of all moves.

    Without a speed the cam is assumed to turn at constant speed; its value does not matter. A plan
    without a move from rest to rest has no spectrum, which is a warning.
    """
    data, subject = build_data(SpectrumRange, request.data), request.subject
    course = subject.state.course or ConstantSpeed(1.0)
    moves = rest_to_rest_moves(subject, course)
    if not moves:
        sentence = (
            "no move is from rest to rest, with velocity and acceleration 0 at both ends, so there"
            " is no residual vibration"
        )
        none = Finding("shock-spectrum", "warning", sentence)
        return ShockSpectrum((), data.highest_ratio, findings=(none,))
    spectra = tuple(_spectra(moves, data))
    findings = [
        finding for spectrum in spectra for finding in _findings(spectrum, data.highest_ratio)
    ]
    return ShockSpectrum(spectra, data.highest_ratio, findings=tuple(findings))


def _spectra(moves: list[RestToRest], data: SpectrumRange) -> Iterator[Spectrum]:
    """The spectrum of each move; moves of one law have that of the longest, the best resolved."""

    def kind(move: RestToRest) -> int:
        return id(move if move.law is None else move.law)

    longest = {kind(move): move for move in sorted(moves, key=lambda move: move.span)}
    known = {
        key: measured(move.shock, data.damping, data.highest_ratio) for key, move in longest.items()
    }
    for move in moves:
        yield Spectrum(move, data.damping, *known[kind(move)])


def _findings(spectrum: Spectrum, highest: float) -> Iterator[Finding]:
    start = spectrum.move.start
    ends = math.degrees(start), math.degrees(start + spectrum.move.span)
    move = f"the move from cam angle {ends[0]:.6g} to {ends[1]:.6g} deg"
    yield Finding(
        name="largest-residual",
        severity="ok",
        sentence=(
            f"after {move} at most {100.0 * spectrum.worst.value:.4g} % of the stroke remains as"
            f" vibration, with {_periods(f'{spectrum.worst.place:.4g}')} per move; range searched"
            f" {'1' if highest > 1.0 else '0'} to {highest:g}"
        ),
        value=spectrum.worst.value,
        cam_angle=start,
    )
    small = f"{100.0 * QUIET:g} % of the stroke"
    below = (
        f"does not stay below {small} up to {_periods(f'{highest:g}')} per move"
        if spectrum.quiet is None
        else f"stays below {small} above {_periods(f'{spectrum.quiet:.4g}')} per move"
    )
    yield Finding(
        name="residual-small-from",
        severity="ok",
        sentence=f"the vibration after {move} {below}",
        value=spectrum.quiet,
        cam_angle=start,
    )


def _periods(number: str) -> str:
    return f"{number} natural period{'' if number == '1' else 's'}"


def measured(move: Shock, damping: float, end: float) -> tuple[Extreme, float | None]:
    """Two values of the spectrum of `move` up to the ratio `end`.

    The largest residual above ratio 1, or above 0 if `end` is at most 1, with its ratio; and the
    ratio above which it stays below `QUIET`: None if there is none up to `end`, 0 if it always
    does. The spectrum is evaluated only where its bound leaves the answer open.
    """
    low = 1.0 if end > 1.0 else 0.0

    def residual(ratios: FloatArray) -> FloatArray:
        return move.residual(ratios, damping)

    def sided(ratios: FloatArray, _: Side) -> FloatArray:
        return residual(np.maximum(ratios, SMALLEST_RATIO))

    high = min(end, FIRST_SPAN)
    worst = piecewise_highest(sided, _unit_edges(low, high))
    # The search ends where the bound excludes a larger residual farther on.
    while high < end and move.bound(high, damping) > worst.value:
        low, high = high, min(end, 2.0 * high)
        further = piecewise_highest(sided, _unit_edges(low, high))
        worst = max(worst, further, key=lambda extreme: extreme.value)
    # Beyond this ratio the bound proves it; `end` may be a zero with more residual behind it.
    reach = FIRST_SPAN
    while move.bound(reach, damping) > QUIET:
        if reach > max(end, LONGEST):
            return worst, None
        reach *= 2.0
    grid = np.append(sample_grid(_unit_edges(SMALLEST_RATIO, reach)).ravel(), reach)
    loud = np.flatnonzero(residual(grid) > QUIET)
    if not len(loud):
        return worst, 0.0
    last = int(loud[-1])
    if grid[last] >= end:
        return worst, None
    root = bracketed_roots(
        lambda ratios: residual(ratios) - QUIET, grid[last : last + 1], grid[last + 1 : last + 2]
    )
    return worst, float(root[0]) if root[0] <= end else None


def _unit_edges(low: float, high: float) -> FloatArray:
    """Edges at most 1 apart: the residual varies no faster than cos(2 pi ratio)."""
    return np.linspace(low, high, max(2, math.ceil(high - low) + 1))


# -- moves ----------------------------------------------------------------------------------------
# The moves from rest to rest, each scaled to a duration and stroke of 1.


REST: Final = 1e-9
"""Velocity and acceleration, relative to the largest ones, up to which a joint counts as a rest:
they come from rounding decimal input.
"""

SLACK: Final = 1e-12
"""Cam angles [rad] this close are equal except for rounding."""


@dataclass(frozen=True, slots=True, eq=False)
class RestToRest:
    """A move from rest to rest.

    Attributes
    ----------
    start, span : cam angle [rad]; start in [0, 2 pi).
    stroke : largest distance from its start [mm or rad].
    duration : [s] at the speed of the course.
    shock : the move, scaled by its duration and stroke.
    law : of the one segment that it is, if the cam turns at constant speed: moves of the same law
        then have the same shock, but for rounding. None for other moves.
    """

    start: float
    span: float
    stroke: float
    duration: float
    shock: Shock
    law: Law | None = None


def rest_to_rest_moves(subject: Subject, course: TimeCourse) -> list[RestToRest]:
    """All moves from rest to rest, in the order of the cam angle."""
    moves = []
    rests = _rests(subject, course)
    edges = merged(np.concatenate((subject.drive.plan.borders, course.borders, [0.0, TURN])))
    # A move may pass cam angle 0.
    two_turns = np.concatenate((edges[:-1], edges + TURN))
    joints = np.radians([float(degrees) for degrees in subject.drive.plan.joints_deg])
    next_turn = [(start + TURN, end + TURN) for start, end in rests[:1]]
    for (_, start), (end, _) in zip(rests, [*rests[1:], *next_turn], strict=True):
        if not end - start > SLACK:
            continue
        inner = two_turns[(two_turns > start) & (two_turns < end)]
        moving = merged(np.concatenate(([start], inner, [end])))
        turns = math.floor(start / TURN)
        moving = moving - TURN * turns
        move = _move(subject, course, moving)
        if move is not None:
            is_constant = isinstance(course, ConstantSpeed)
            law = _law(subject.drive.plan, joints, moving) if is_constant else None
            moves.append(replace(move, law=law))
    return sorted(moves, key=lambda move: move.start)


def _law(plan: MotionPlan, joints: FloatArray, edges: FloatArray) -> Law | None:
    """The law of the segment, between `joints` of the plan, that is the move over `edges` [rad];
    None if there is no such one.
    """
    middle = 0.5 * (edges[0] + edges[-1]) % TURN
    number = int(np.searchsorted(joints, middle)) - 1
    segment = plan.segments[number]
    whole = np.allclose(joints[number : number + 2], edges[[0, -1]], rtol=0.0, atol=SLACK)
    return segment.law if whole and isinstance(segment, Move) else None


def _rests(subject: Subject, course: TimeCourse) -> list[tuple[float, float]]:
    """Start and end [rad] of all rests, in order; they are equal for a joint."""
    plan = subject.drive.plan
    dwells = [(rest.start, rest.start + rest.span) for rest in plan.dwells if rest.span > 0.0]
    borders = plan.borders
    sides = [in_time(plan.jet(borders, side), course, borders, side) for side in ("right", "left")]
    inside = sample_grid(np.append(borders, TURN)).ravel()
    size = np.max(np.abs(in_time(plan.jet(inside), course, inside)), axis=1)
    calm = np.ones(len(borders), dtype=np.bool_)
    for timed in sides:
        for order in (1, 2):
            calm &= np.abs(timed[order]) <= REST * size[order]
    joints = [
        (float(phi), float(phi))
        for phi in borders[calm]
        if not any(
            start - SLACK <= phi + turn <= end + SLACK
            for start, end in dwells
            for turn in (0.0, TURN)
        )
    ]
    return sorted([*dwells, *joints])


def _move(subject: Subject, course: TimeCourse, edges: FloatArray) -> RestToRest | None:
    """The move over `edges` (m + 1,) [rad]; None if nothing moves."""
    plan = subject.drive.plan
    begin = plan.jet(edges[:1])[0]

    def way(phi: FloatArray, side: Side = "right") -> FloatArray:
        return np.asarray(plan.jet(phi, side)[0] - begin)

    stroke = piecewise_extremes(way, edges).magnitude
    if not stroke > 0.0:
        return None
    times = course.time(edges)
    duration = float(times[-1] - times[0])

    def angle(z: FloatArray) -> FloatArray:
        t = times[0] + duration * z
        if isinstance(course, ConstantSpeed):
            return np.asarray(t * course.speed)
        return inverse(course.time, lambda phi: 1.0 / course.rates(phi)[0], edges, t)

    def lift(z: FloatArray) -> FloatArray:
        return np.asarray(way(angle(z)) / stroke)

    def acceleration(z: FloatArray) -> FloatArray:
        phi = angle(z)
        timed = in_time(plan.jet(phi), course, phi)
        return np.asarray(timed[2] * (duration**2 / stroke))

    right = in_time(plan.jet(edges, "right"), course, edges)[1]
    left = in_time(plan.jet(edges, "left"), course, edges)[1]
    right[-1] = left[0] = 0.0  # the rests
    jumps = (right - left) * (duration / stroke)
    share = (times - times[0]) / duration
    share[-1] = 1.0
    end = float(way(edges[-1:])[0]) / stroke
    rounding = ROUNDINGS * EPS * float(np.max(np.abs(edges))) / float(edges[-1] - edges[0])
    scaled = shock(lift, acceleration, share, jumps, end, rounding)
    return RestToRest(float(edges[0]), float(edges[-1] - edges[0]), stroke, duration, scaled)
