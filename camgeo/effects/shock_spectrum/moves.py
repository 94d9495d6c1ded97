"""The moves from rest to rest, each scaled to a duration and stroke of 1."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from camgeo.effects.effect import Subject
from camgeo.motion.laws.law import Law
from camgeo.motion.plan import MotionPlan, Move
from camgeo.motion.time_course import ConstantSpeed, TimeCourse, in_time
from camgeo.numeric.arrays import FloatArray, Side, merged
from camgeo.numeric.extremes import grid_of, piecewise_extremes
from camgeo.numeric.oscillator.spectrum import Shock, shock
from camgeo.numeric.oscillator.steady import ROUNDINGS
from camgeo.numeric.oscillator.train import EPS
from camgeo.numeric.roots import inverse
from camgeo.units import TURN

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


def moves_of(subject: Subject, course: TimeCourse) -> list[RestToRest]:
    """All moves from rest to rest, in the order of the cam angle."""
    return sorted(_moves(subject, course), key=lambda each: each.start)


def _moves(subject: Subject, course: TimeCourse) -> Iterator[RestToRest]:
    rests = _rests(subject, course)
    edges = merged(np.concatenate((subject.drive.plan.borders, course.borders, [0.0, TURN])))
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
        found = _move(subject, course, moving)
        if found is not None:
            even = isinstance(course, ConstantSpeed)
            yield replace(found, law=_law(subject.drive.plan, joints, moving) if even else None)


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
    inside = grid_of(np.append(borders, TURN)).ravel()
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

    after = in_time(plan.jet(edges, "right"), course, edges)[1]
    before = in_time(plan.jet(edges, "left"), course, edges)[1]
    after[-1] = before[0] = 0.0  # the rests
    jumps = (after - before) * (duration / stroke)
    share = (times - times[0]) / duration
    share[-1] = 1.0
    end = float(way(edges[-1:])[0]) / stroke
    rounding = ROUNDINGS * EPS * float(np.max(np.abs(edges))) / float(edges[-1] - edges[0])
    scaled = shock(lift, acceleration, share, jumps, end, rounding)
    return RestToRest(float(edges[0]), float(edges[-1] - edges[0]), stroke, duration, scaled)
