"""The flight of a follower that has left its only flank, its landing, and its rebounds.

Off the cam the follower is a free body: M q'' is the sum of all forces at the place where it is,
q = h + d, with the motion h of the state and the gap d along q,

    M d'' = -R + sum (Q(q, q') - Q(h, h')),

where R, the force that the contact would have to provide, has the inertia of h in it (Newton's law;
follower jump: Norton, Cam Design and Manufacturing Handbook; Rothbart, Cam Design Handbook, chapter
on dynamics). d is integrated itself, so that nothing cancels where it is small. As the follower has
one coordinate, and h is where it touches the cam, it lands where d is 0 again. The impact speed is
that of the gap along the normal, |dn/dq d'|; after a rebound with the restitution e the gap opens
at e times that speed (Newton's law of restitution).

In each cell of cam angle d solves the integral equation at Chebyshev nodes, by Picard's iteration
(Clenshaw and Norton, The Computer Journal 6 (1963) 88-92).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from camgeo.effects.effect import Subject
from camgeo.effects.force import Force
from camgeo.effects.lift_off.cells import (
    MOST_HALVINGS,
    ORDERS,
    ROUNDING,
    Nodes,
    Polynomial,
    cells_from,
)
from camgeo.effects.results import ContactForce, Inertia, LostContact
from camgeo.effects.touching import leverage_of, outwards_of
from camgeo.effects.wording import missed
from camgeo.motion.time_course import TimeCourse
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.roots import bracketed_roots, sign_changes
from camgeo.units import TURN

MOST_ITERATIONS: Final = 60
"""Of Picard's in a cell; a cell that is too long for the natural frequency needs more."""

CLOSE: Final = 1e-14
"""Change of the gap, as a share of its size, at which they end."""

EVEN: Final = np.linspace(0.0, 1.0, 65)
EARLY: Final = np.append(0.0, np.geomspace(1e-9, 1.0, 128))
"""Places in a cell at which the landing is searched for; early ones where a flight begins with a
speed, which may last but a moment.
"""

NOWHERE: Final = (np.empty(0), np.empty(0))

MOST_REBOUNDS: Final = 5
"""Rebounds of one flight that are followed."""


@dataclass(frozen=True, slots=True)
class Flight:
    """The follower off the cam.

    Attributes
    ----------
    leaving, landing : cam angles [rad], the landing at most a turn beyond the leaving.
    gap : the largest |d|, how far the follower gets from where it would touch [mm or rad].
    speed : of the impact, along the normal [mm/s].
    rebound : whether it begins with the impact of the flight before.
    error : estimate of the relative errors of `gap` and `speed`.
    """

    leaving: float
    landing: float
    gap: float
    speed: float
    rebound: bool
    error: float = 0.0


@dataclass(frozen=True, slots=True)
class _End:
    """Where a flight ends [rad], the rate of d there [per s], and the largest |d| until then."""

    angle: float
    rate: float
    gap: float


class _StiffError(ArithmeticError):
    """Picard's iteration does not converge in a cell."""


@dataclass(frozen=True, slots=True, eq=False)
class FreeFollower:
    """A follower without linkage on a single flank.

    Attributes
    ----------
    subject : the design.
    contact : the contact force, all of whose forces but inertia are known off the cam.
    inertia : its mass is above 0.
    course : how the cam turns.
    sense : of the flank.
    """

    subject: Subject
    contact: ContactForce
    inertia: Inertia
    course: TimeCourse
    sense: int

    def flights(
        self, lost: LostContact, restitution: float, tolerance: float
    ) -> tuple[Flight | float, ...]:
        """All flights of a turn with their rebounds, by ascending cam angle.

        A follower that lands where the flank would have to pull leaves it again at once. In place
        of a flight that lasts until the first one of the next turn, or longer, comes the cam angle
        [rad] at which it begins, and no flight after it.

        Raises
        ------
        EffectError
            If they cannot be computed to the `tolerance`.
        """
        error = 1.0
        for halvings in range(MOST_HALVINGS + 1):
            try:
                rough, fine = (
                    tuple(self._chain(lost, restitution, Nodes.of(count), halvings))
                    for count in ORDERS
                )
            except _StiffError:
                continue
            apart = [_apart(*both) for both in zip(rough, fine, strict=False)]
            error = max(apart, default=0.0) if len(rough) == len(fine) else 1.0
            if error <= max(tolerance, ROUNDING):
                return tuple(
                    replace(each, error=max(off, ROUNDING)) if isinstance(each, Flight) else each
                    for each, off in zip(fine, apart, strict=True)
                )
        raise missed("the impact speed of a flight", error, "itself", tolerance)

    def _chain(
        self, lost: LostContact, restitution: float, nodes: Nodes, halvings: int
    ) -> Iterator[Flight | float]:
        """As `flights`, with these `nodes` in each cell, and cells halved so often."""
        starts = _starts(lost)
        back = 0.0
        for begin, end in starts:
            leaving = max(begin, back)
            if leaving > end or begin < back == end:
                continue
            rate = self._jump(leaving) if begin == end else 0.0
            for number in range(MOST_REBOUNDS + 1 if restitution else 1):
                landing = self._flight(leaving, rate, nodes, halvings)
                if landing is None or landing.angle > starts[0][0] + TURN:
                    yield leaving
                    return
                if landing.gap == 0.0:  # it does not open by more than rounding
                    break
                here = np.array([landing.angle % TURN])
                lever = float(leverage_of(self.subject, here, "left", self.sense)[0])
                speed = abs(lever * landing.rate)
                yield Flight(leaving, landing.angle, landing.gap, speed, number > 0)
                back = leaving = landing.angle
                rate = -restitution * landing.rate

    def _jump(self, angle: float) -> float:
        """The rate of d [per s] with which the follower goes on where the velocity jumps."""
        here = np.array([angle])
        before, after = (
            self.subject.state.motion.jet(here, side)[1, 0] for side in ("left", "right")
        )
        return float((before - after) * self.course.rates(here)[0, 0])

    def _flight(self, leaving: float, rate: float, nodes: Nodes, halvings: int) -> _End | None:
        """The end of the flight that begins at `leaving` [rad] with the `rate` of d [per s]."""
        here = np.array([leaving % TURN])
        outwards = float(outwards_of(self.subject, here, "right", self.sense)[0])
        way, most, flying, thrown = 0.0, 0.0, False, rate != 0.0
        for low, high in cells_from(leaving, self.contact.edges, 0.5**halvings):
            angles: FloatArray = 0.5 * (low + high) + 0.5 * (high - low) * nodes.places
            gap, speed = self._solved(angles, nodes, (low, high), way, rate)
            probes = low + (high - low) * (EVEN if flying or not thrown else EARLY)
            away = outwards * gap(probes)
            # The gap begins with 0, and what rounding makes of it before it opens is no landing.
            opened = np.maximum.accumulate(away > 0.0) | flying
            ends = sign_changes(probes[opened], away[opened]) if opened[-2] else NOWHERE
            if thrown and not opened[-2]:
                return _End(leaving, 0.0, 0.0)
            landed = bracketed_roots(gap, *ends)
            turning = bracketed_roots(speed, *sign_changes(probes, speed(probes)))
            end = float(landed[0]) if len(landed) else high
            far = outwards * gap(np.append(turning[turning < end], [low, end]))
            most = max(most, float(np.max(far)))
            if len(landed):
                return _End(end, float(speed(end)), most)
            way, rate, flying = float(gap(high)), float(speed(high)), bool(opened[-1])
        return None

    def _solved(
        self,
        angles: FloatArray,
        nodes: Nodes,
        ends: tuple[float, float],
        way: float,
        rate: float,
    ) -> tuple[Polynomial, Polynomial]:
        """d and its rate in a cell with these `ends` [rad]; at its start they are `way`, `rate`."""
        phi = np.mod(angles, TURN)
        rates = self.course.rates(phi)
        omega = rates[0]
        mass = self.inertia.to_follower(phi, "right")
        jet = self.subject.state.motion.jet(phi, "right")
        here, pace = jet[0], jet[1] * omega
        free = [each for each in self.contact.forces if each is not self.inertia.force]
        needed = self.contact.demand(phi, "right")
        bound = sum(_off(each, phi, here, pace) for each in free)
        d, v = np.full(len(phi), way), np.full(len(phi), rate)
        for _ in range(MOST_ITERATIONS):
            moved = sum(_off(each, phi, here + d, pace + v) for each in free)
            push = (moved - bound - needed) / mass
            speed = nodes.integral(push / omega, rate, ends)
            gap = nodes.integral(speed(angles) / omega, way, ends)
            last, d, v = d, gap(angles), speed(angles)
            if np.max(np.abs(d - last)) <= CLOSE * np.max(np.abs(d)):
                return gap, speed
        raise _StiffError


def _starts(lost: LostContact) -> list[tuple[float, float]]:
    """Where flights may begin: (start, end) [rad] of each range without contact, by ascending
    start, the end equal to it where the velocity jumps.
    """
    found = [(angle, angle) for angle in lost.leaps]
    for each in lost.ranges:
        length = (each.end - each.start) % TURN
        if length > 0.0:
            found.append((each.start, each.start + length))
    return sorted(found)


def _apart(rough: Flight | float, fine: Flight | float) -> float:
    """The relative difference of gap and speed; 1 if one of both has no landing."""
    if not isinstance(rough, Flight) or not isinstance(fine, Flight):
        return float(isinstance(rough, Flight) or isinstance(fine, Flight))
    return max(abs(rough.speed - fine.speed) / fine.speed, abs(rough.gap - fine.gap) / fine.gap)


def _off(force: Force, phi: FloatArray, q: FloatArray, rate: FloatArray) -> FloatArray:
    assert force.off is not None  # see `FreeFollower.contact`
    return force.off(phi, q, rate)
