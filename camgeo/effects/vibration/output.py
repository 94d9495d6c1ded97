"""The motion of the output over the cam angle, rigid or elastic."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from camgeo.effects.effect import Subject
from camgeo.effects.force import Force
from camgeo.motion.motion import Motion
from camgeo.motion.plan import in_turn
from camgeo.motion.time_course import ConstantSpeed, TimeCourse, in_time
from camgeo.numeric.arrays import FloatArray, IntArray, Side, merged
from camgeo.numeric.oscillator.steady import Base, Forcing, Response, load_of
from camgeo.numeric.roots import inverse
from camgeo.units import TURN


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
        return load_of(pressed, self.time(edges), share)


def clock_of(subject: Subject, course: TimeCourse) -> Clock:
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
        out = np.zeros((3, len(phi)))
        out[2] = in_time(self.clock.motion.jet(phi, side), self.clock.course, phi, side)[2]
        return out

    def deflection(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) output minus motion of the state [mm or rad] at `phi` (n,) [rad]."""
        found: FloatArray = self.states(phi, side)[0]
        return found

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
        found: FloatArray = self.states(phi, side)[2]
        return found

    def forces(self, links: Sequence[int], phi: FloatArray, side: Side) -> FloatArray:
        """(k, n) forces [N or N mm] in the `links`, see `Response.forces`."""
        assert self.response is not None  # a rigid train has no springs
        return self.response.forces(links, self.clock.time(in_turn(phi, side)), side)


@dataclass(frozen=True, slots=True)
class Links:
    """The first `count` springs with their dampers, asked for their forces together: all follow
    from the same modes. See `camgeo.numeric.many.Many`.
    """

    count: int

    def everywhere(self, output: Output, phi: FloatArray, side: Side) -> FloatArray:
        """(count, n) forces [N or N mm]."""
        return output.forces(range(self.count), phi, side)

    def at(self, output: Output, phi: FloatArray, side: Side, which: IntArray) -> FloatArray:
        """(n,) forces, each in the spring with the number in `which` (n,)."""
        found = np.zeros(len(phi))
        for link in np.unique(which).tolist():
            own = which == link
            found[own] = output.forces([link], phi[own], side)[0]
        return found
