"""Kinematics: velocity, acceleration and jerk over time, of output and follower.

VDI 2143-1, eqs. (1) to (4), see `camgeo.kinematics.time_course`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.check.finding import Finding
from camgeo.dynamics.effects.effect import Column, Request, Result, Subject
from camgeo.kinematics.motion import Motion
from camgeo.kinematics.time_course import TimeCourse, TimeExtremes, in_time, period, time_extremes
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.numeric.extremes import Extreme
from camgeo.units import LiftUnit, at_cam_angles

NAMES: Final = ("velocity", "acceleration", "jerk")


@dataclass(frozen=True, slots=True)
class _Moving:
    """A motion, and how its findings and columns are named.

    Attributes
    ----------
    prefix : of the names of its findings and columns: "" for that of the output, "rocker " or
        "follower " for that of a follower with a linkage.
    order : of the highest derivative that is continuous over the whole turn.
    """

    prefix: str
    motion: Motion
    unit: LiftUnit
    order: int
    extremes: TimeExtremes

    @property
    def scale(self) -> float:
        return 1.0 if self.unit == "mm" else math.degrees(1.0)

    def per(self, power: int) -> str:
        length = "mm" if self.unit == "mm" else "deg"
        return f"{length}/s" if power == 1 else f"{length}/s^{power}"

    def columns(self, course: TimeCourse) -> Iterator[Column]:
        for power, name in enumerate(NAMES, start=1):

            def values(phi: FloatArray, side: Side, power: int = power) -> FloatArray:
                timed = in_time(self.motion.jet(phi, side), course, phi, side)
                return np.asarray(self.scale * timed[power])

            yield Column(f"{self.prefix}{name}", self.per(power), values)

    def findings(self) -> Iterator[Finding]:
        extremes = (self.extremes.velocity, self.extremes.acceleration, self.extremes.jerk)
        for power, (name, values) in enumerate(zip(NAMES, extremes, strict=True), start=1):
            # Where a derivative jumps, the next one is infinite.
            bounded = self.order >= power - 1
            for which, end in (("highest", values.highest), ("lowest", values.lowest)):
                yield self._finding(f"{which} {self.prefix}{name}", end, power, bounded=bounded)

    def _finding(self, what: str, end: Extreme, power: int, *, bounded: bool) -> Finding:
        value, unit = self.scale * end.value, self.per(power)
        sentence = f"{value:.6g} {unit} {at_cam_angles(end.place)}"
        if not bounded:
            jumps = "a shock" if power < len(NAMES) else "a shock or a jerk"
            sentence = f"infinite at {jumps}; elsewhere {sentence}"
        return Finding(
            name=what.replace(" ", "-"),
            severity="ok",
            sentence=f"{what} {sentence}",
            value=value if bounded else None,
            unit=unit,
            cam_angle=end.place if bounded else None,
        )


def compute(request: Request[object]) -> Result:
    """The motion in time at the speed of the scene."""
    subject, course = request.subject, request.course
    moving = _motions(subject, course)
    turn = period(course)
    time = Finding("turn-time", "ok", f"a turn takes {turn:.6g} s", turn, unit="s")

    columns = [Column("time", "s", lambda phi, _side: course.time(phi))]
    for motion in moving:
        columns += motion.columns(course)
    if subject.disc is not None and not subject.cam.follower.rolls:
        from camgeo.dynamics.effects.contact import sliding

        def rubbing(phi: FloatArray, side: Side) -> FloatArray:
            return np.asarray(sliding(subject, phi, side) * course.rates(phi)[0])

        columns.append(Column("sliding velocity", "mm/s", rubbing))
    findings = (time, *(finding for motion in moving for finding in motion.findings()))
    return Result(findings=findings, columns=tuple(columns))


def _motions(subject: Subject, course: TimeCourse) -> list[_Moving]:
    """The motion of the output and, with a linkage, that of the follower."""
    state, unit = subject.state, subject.drive.unit
    order, extremes = state.order, state.output_extremes(course)
    motions = [_Moving("", state.output, unit, order, extremes)]
    if subject.drive.linkage is not None:
        # A linkage that closes is smooth: it passes shocks and jerks on and adds none.
        follower_unit = subject.lift_unit
        prefix = "rocker " if follower_unit == "rad" else "follower "
        of_follower = time_extremes(state.motion, course, follower_unit)
        motions.append(_Moving(prefix, state.motion, follower_unit, order, of_follower))
    return motions
