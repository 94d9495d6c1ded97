"""The flights of a follower that has left its flank, its landings, and its rebounds.

Off the cam the follower is a free body: with its coordinate q, the inertia M(q) reduced to it and
the forces Q on it, Lagrange's equation is

    M q'' + (dM/dq / 2) q'^2 = sum Q(q, q').

With q = h + d, the motion h of a follower that touches the wall which it has left, and the gap d,

    M(q) d'' = F(q, q') - F(h, h') - R + (M(h) - M(q)) h'',    F = sum Q - (dM/dq / 2) q'^2,

where R = M(h) h'' - F(h, h') is what that wall would have to provide (follower jump: Norton, Cam
Design and Manufacturing Handbook; Rothbart, Cam Design Handbook, chapter on dynamics). d is
integrated itself, so that nothing cancels where it is small. The follower lands where d is 0 again,
or where it meets the other wall. The impact speed is that along the normal of the wall, |dn/dq v|
with the velocity v of q relative to that of the wall; it goes on with -e v, with the restitution e
(Newton's law), and loses (1 - e^2) M v^2 / 2.

An elastic train that it carries adds a force to R and to the right, see
`camgeo.dynamics.effects.lift_off.flight`; M is then that of the follower in front of it. Where h'
jumps, d' jumps the other way.

In each cell of cam angle d solves the integral equation at Chebyshev nodes, by Picard's iteration
(Clenshaw and Norton, The Computer Journal 6 (1963) 88-92). Between the places where a gap is
evaluated, a bound of its second derivative excludes that it closes.

A follower that rests on a wall has no memory: once it leaves the same place of the turn a second
time, all that follows repeats.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import ClassVar, Final, Self

import numpy as np

from camgeo.cam.cam import Breadth
from camgeo.dynamics.effects.bearing_friction import BearingFriction
from camgeo.dynamics.effects.contact import INNER, OUTER, TOUCH, contact_leverage, ranges_below
from camgeo.dynamics.effects.effect import Quantity, Subject
from camgeo.dynamics.effects.forces import ElasticTrain, Force
from camgeo.dynamics.effects.lift_off.flank import Flank
from camgeo.dynamics.effects.results import ContactForce, Inertia
from camgeo.dynamics.effects.wording import tolerance_error
from camgeo.errors import EffectError
from camgeo.geometry.outline.roller import PlayedLift
from camgeo.geometry.pitch_curve import WorkingCurve
from camgeo.kinematics.mechanism.follower_path import path_of
from camgeo.kinematics.time_course import TimeCourse, period
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side, merged
from camgeo.numeric.extremes import (
    bracketed_roots,
    dips,
    piecewise_extremes,
    sample_grid,
    sign_changes,
    with_roots,
)
from camgeo.units import TURN, cam_angle

MOST_ITERATIONS: Final = 60
"""Most of Picard's iterations in a cell; a cell that is too long for the natural frequency needs
more."""

SURE: Final = 3
"""Successive halvings of the cells that fail for a reason: more will not help. Cells that are much
too long may fail for it too, because the iteration diverges."""

MOST_REBOUNDS: Final = 5
"""Rebounds of one flight that are followed; then it stays on the wall that it has hit."""

MOST_TURNS: Final = 8
"""Turns after which all flights must repeat, and one flight must have ended."""

PULLING: Final = 1e-9
"""A played wall would have to pull where its force is below minus this share of the largest: the
second derivative of a played lift is rounded more than that of the state.
"""


@dataclass(frozen=True, slots=True, eq=False)
class FreeFollower:
    """A follower that may leave its walls.

    Attributes
    ----------
    forces : all but that of the contact and inertia, known off the cam.
    inertia : its mass is above 0.
    course : how the cam turns.
    walls : one, or two with a clearance between them.
    bearings : friction in pivot or guide, which goes on under what loads them without a contact in
        the motion of the state, and against that motion; None without any.
    edges : (k,) [rad] from 0 to 2 pi, between which everything is smooth.
    least : smallest gap [mm or rad]; less is rounding of the lift.
    jumps : cam angles [rad] in [0, 2 pi) at which the velocity of the only wall jumps.
    carried : the elastic train behind the follower; None without any.
    """

    forces: tuple[Force, ...]
    inertia: Inertia
    course: TimeCourse
    walls: tuple[Wall, ...]
    bearings: BearingFriction | None
    edges: FloatArray
    least: float
    jumps: FloatArray = field(default_factory=lambda: np.empty(0))
    carried: CarriedTrain | None = None

    most_turns: ClassVar[int] = MOST_TURNS

    @classmethod
    def with_forces(
        cls,
        contact: ContactForce,
        inertia: Inertia,
        course: TimeCourse,
        walls: tuple[Wall, ...],
        jumps: Sequence[float] = (),
    ) -> Self:
        """The follower under the forces of `contact`, inertia among them; for `jumps` see the
        class.
        """
        others = tuple(force for force in contact.forces if force is not inertia.force)
        cuts = merged(np.concatenate((contact.edges, *(wall.borders for wall in walls))))
        # A smaller gap is rounding of the lift that it is added to.
        least = ROUNDED * float(np.max(np.abs(walls[0].motion(cuts, "right")[0])))
        return cls(others, inertia, course, walls, contact.bearings, cuts, least, np.array(jumps))

    def leavings(self) -> tuple[Leaving, ...]:
        """The ranges of the turn in which the walls would have to pull."""
        places = []
        for number, wall in enumerate(self.walls):

            def push(phi: FloatArray, side: Side, wall: Wall = wall) -> FloatArray:
                needed = self.on_wall(wall, phi, side)[3]
                return np.asarray(np.sign(wall.leverage(phi, side)) * needed)

            extremes = piecewise_extremes(push, self.edges)
            limit = -PULLING * extremes.magnitude
            if extremes.lowest.value < limit:
                for stretch in ranges_below(push, self.edges, limit, extremes.lowest):
                    length = (stretch.end - stretch.start) % TURN
                    places.append(Leaving(number, stretch.start, stretch.start + (length or TURN)))
        return tuple(places)

    def jump(self, angle: float) -> float:
        """The rate of d [per s] with which the follower goes on where the velocity jumps."""
        here = np.array([angle])
        left, right = (self.walls[0].motion(here, side)[1, 0] for side in ("left", "right"))
        return float((left - right) * self.course.rates(here)[0, 0])

    def steady(
        self, leavings: tuple[Leaving, ...], restitution: float, tolerance: float
    ) -> Flights:
        """The flights of a follower that rests on a wall until it has to leave it.

        A follower that lands where the wall would have to pull leaves it again at once.

        Raises
        ------
        EffectError
            If they cannot be computed to the `tolerance`.
        """

        def solved(halvings: int) -> tuple[Flights, ...]:
            return tuple(
                self._chain(leavings, restitution, ChebyshevNodes.with_count(count), halvings)
                for count in ORDERS
            )

        return refined(solved, lambda flights: max(flight.error for flight in flights), tolerance)

    def _chain(
        self,
        leavings: tuple[Leaving, ...],
        restitution: float,
        nodes: ChebyshevNodes,
        halvings: int,
    ) -> Flights:
        """The flights of `steady`, with these `nodes` in each cell, and cells halved as often as
        `halvings` says.
        """
        first = min(leavings, key=lambda leaving: leaving.begin)
        last = first.begin + MOST_TURNS * TURN
        wall, angle = first.wall, first.begin
        all_flights: list[Flight] = []
        begun: list[tuple[Leaving, float, int]] = []
        while angle <= last and len(all_flights) < MOST_FLIGHTS:
            leaving, start = next_leaving(leavings, wall, angle)
            if leaving is None:
                return Flights((), 1)  # it stays on a wall that never has to pull
            for earlier, begin, count in begun:
                turns = round((start - begin) / TURN)
                if earlier is leaving and turns and abs(start - begin - turns * TURN) <= SAME:
                    return Flights(in_turns(all_flights[count:], turns), turns)
            begun.append((leaving, start, len(all_flights)))
            state = FreeState(0.0, leaving.rate)
            flights, end = self.follow_flight(wall, start, state, restitution, nodes, halvings)
            all_flights += flights
            if end is None:
                return Flights(
                    tuple(all_flights), 0, (flights[-1].landing if flights else start) % TURN
                )
            wall, angle = end.wall, end.angle
            if angle == start:  # nothing has opened: it has not left
                ahead = (leaving.end - start) % TURN
                # It stays for the rest of this range; one float at least, so that the search goes
                # on.
                angle = max(start + ahead, float(np.nextafter(start, np.inf)))
        return Flights(tuple(all_flights), 0)

    def follow_flight(
        self,
        wall: int,
        angle: float,
        state: FreeState,
        restitution: float,
        nodes: ChebyshevNodes,
        halvings: int,
    ) -> tuple[list[Flight], End | None]:
        """The flight that leaves the `wall` at `angle` [rad], with its rebounds, and the end of the
        last: None if it lasts longer than `MOST_TURNS`, where that began if nothing opens.
        """
        flights: list[Flight] = []
        end = None
        for number in range(MOST_REBOUNDS + 1 if restitution else 1):
            end = self._flight(wall, angle, state, nodes, halvings)
            if end is None or end.gap == 0.0:
                break
            flights.append(self._landed(end, restitution, (wall, angle), number > 0))
            wall, angle = end.wall, end.angle
            state = FreeState(0.0, -restitution * end.rate, end.memory)
        return flights, end

    def _landed(
        self, end: End, restitution: float, begin: tuple[int, float], rebound: bool
    ) -> Flight:
        """The flight that begins on a wall at an angle [rad], `begin`."""
        left, angle = begin
        here = np.array([end.angle % TURN])
        met = self.walls[end.wall]
        lever = float(met.leverage(here, "left")[0])
        mass = float(self.inertia.mass_terms(here, np.array([end.place]))[0, 0])
        # The speed is multiplied by the restitution, the energy by its square.
        lost = 0.5 * (1.0 - restitution * restitution) * mass * end.rate * end.rate
        return Flight(
            leaving=angle,
            landing=end.angle,
            gap=end.gap,
            speed=abs(lever * end.rate),
            energy=lost,
            rebound=rebound,
            left=self.walls[left].sense,
            met=met.sense,
        )

    def _flight(
        self, wall: int, leaving: float, state: FreeState, nodes: ChebyshevNodes, halvings: int
    ) -> End | None:
        """The end of the flight that leaves the `wall` at `leaving` [rad]; None if it lasts longer
        than `MOST_TURNS`.
        """
        outwards = self.walls[wall].outwards(leaving % TURN)
        most, flying, thrown = 0.0, False, state.rate != 0.0
        for cell in self._sampled(wall, outwards, leaving, nodes, halvings):
            low, high = cell.ends
            if low > leaving:
                state = replace(state, rate=state.rate + self._leap(low))
            gap, speed, memory = self._solved(cell, nodes, state)
            # A flight that begins with a speed may end long before the first of evenly spaced
            # probes.
            probes = low + (high - low) * (UNIFORM if flying or not thrown else EARLY)
            away = outwards * gap(probes)
            # The gap begins with 0, and what rounding makes of it before it opens is no landing.
            opened = np.maximum.accumulate(away > self.least) | flying
            if not opened[-2] and (thrown or away[-1] < -self.least):
                return End(leaving, wall, 0.0, 0.0, 0.0, state.memory)
            back = closes(outwards * gap, probes[opened]) if opened[-2] else None
            across = None
            if cell.room is not None:
                room = nodes.function(cell.room, cell.ends) - outwards * gap
                across = closes(room, probes)
            stops = [stop for stop in (back, across) if stop is not None]
            end = min(stops, default=high)
            # The gap is largest where its rate changes sign, or at an end.
            turning = bracketed_roots(speed, *sign_changes(probes, speed(probes)))
            far = outwards * gap(np.append(turning[turning < end], [low, end]))
            most = max(most, float(np.max(far)))
            last = FreeState(float(gap(end)), float(speed(end)), memory(end))
            if stops:
                # Of the two walls it hits the one that it reaches first.
                hit = wall if across is None or end == back else 1 - wall
                return self._ended(wall, hit, end, last, most)
            state, flying = last, bool(opened[-1])
        return None

    def _leap(self, angle: float) -> float:
        """What the rate of d gains at `angle` [rad], where the velocity of the wall may jump."""
        distances = np.abs(np.mod(angle - self.jumps + 0.5 * TURN, TURN) - 0.5 * TURN)
        return sum(self.jump(jump_angle) for jump_angle in self.jumps[distances <= SAME].tolist())

    def _ended(self, wall: int, hit: int, angle: float, last: FreeState, most: float) -> End:
        """The end on the wall `hit`, with the largest gap until then."""
        here = np.array([angle % TURN])
        left, met = (self.walls[number].motion(here, "left")[:, 0] for number in (wall, hit))
        omega = float(self.course.rates(here)[0, 0])
        place, pace = float(left[0]), omega * float(met[1] - left[1])
        return End(angle, hit, place + last.gap, last.rate - pace, most, last.memory)

    def on_wall(
        self, wall: Wall, phi: FloatArray, side: Side
    ) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """The motion (3, n) on `wall` in time, and (n,) M, F and R there, see the module.

        R has the friction of the bearings, and the force of an elastic train in its steady state.
        """
        jet, rates = wall.motion(phi, side), self.course.rates(phi, side)
        omega, alpha = rates[0], rates[1]
        # From derivatives over the cam angle to those in time.
        timed = np.stack((jet[0], jet[1] * omega, jet[2] * omega * omega + jet[1] * alpha))
        mass, free = self._free(phi, timed[0], timed[1])
        needed = mass * timed[2] - free
        if self.bearings is not None:
            needed = needed + self.bearings.noncontact_friction(phi, side, rates)
        if self.carried is not None:
            needed = needed + self.carried.steady(phi, side)
        return timed, mass, free, needed

    def _free(
        self, phi: FloatArray, q: FloatArray, rate: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """M and F (n,) of a free follower, see the module."""
        mass, half = self.inertia.mass_terms(phi, q)
        free = -half * rate * rate
        for force in self.forces:
            assert force.free_force is not None  # see the class
            free = free + force.free_force(phi, q, rate)
        return mass, free

    def _sampled(
        self, wall: int, outwards: float, leaving: float, nodes: ChebyshevNodes, halvings: int
    ) -> Iterator[Cell]:
        """The cells of a flight; many are evaluated at a time, the more the longer the flight."""
        cells = flight_cells(leaving, self.edges, 0.5**halvings, MOST_TURNS)
        left_wall, size = self.walls[wall], 1
        while block := list(itertools.islice(cells, size)):
            lows, highs = np.array(block).T[:, :, None]
            angles = 0.5 * (lows + highs) + 0.5 * (highs - lows) * nodes.places
            phi = np.mod(angles, TURN).ravel()
            timed, *forces = self.on_wall(left_wall, phi, "right")
            columns = [phi, self.course.rates(phi)[0], *timed, *forces]
            if len(self.walls) > 1:
                other = self.walls[1 - wall].motion(phi, "right")[0]
                columns.append(outwards * (other - timed[0]))
            rows = np.reshape(columns, (len(columns), *angles.shape))
            for number, ends in enumerate(block):
                yield Cell(ends, angles[number], *rows[:, number])
            size = min(2 * size, MOST_AT_ONCE)

    def _solved(
        self, cell: Cell, nodes: ChebyshevNodes, state: FreeState
    ) -> tuple[Polynomial, Polynomial, Callable[[float], ComplexArray]]:
        """d, its rate and the memory of the train in a cell, which at its start are those of
        the `state`.
        """
        count = len(cell.phi)
        # Rounding of the forces moves the gap by about their acceleration times the square of the
        # time in the cell.
        time = (cell.ends[1] - cell.ends[0]) / np.min(cell.omega)
        sizes = np.abs(cell.free) + np.abs(cell.mass * cell.pull)
        size = np.max(np.maximum(sizes, np.abs(cell.needed)) / cell.mass)
        noise = NOISE * float(size) * time * time
        time_integral = nodes.time_integral(cell.ends, cell.omega)
        moved = None if self.carried is None else self.carried.couple(cell, time_integral, state)
        # The iteration starts from a follower that keeps its state.
        d, v = np.full(count, state.gap), np.full(count, state.rate)
        for _ in range(MOST_ITERATIONS):
            mass, free = self._free(cell.phi, cell.lift + d, cell.pace + v)
            if not np.all(mass > 0.0):
                raise StiffError("the follower flies beyond the end of its linkage's motion")
            push = free - cell.free - cell.needed + (cell.mass - mass) * cell.pull
            push = push / mass if moved is None else moved.acceleration(push)
            v = state.rate + time_integral @ push
            last, d = d, state.gap + time_integral @ v
            if np.max(np.abs(d - last)) <= max(CLOSE * float(np.max(np.abs(d))), noise):
                speed = nodes.integral(push / cell.omega, state.rate, cell.ends)
                gap = nodes.integral(v / cell.omega, state.gap, cell.ends)
                memory_function = (
                    (lambda _: state.memory) if moved is None else moved.memory(nodes, v)
                )
                return gap, speed, memory_function
        rate = cell.pace + v
        raise StiffError(
            why_stiff(cell.ends[0], rate, lambda v: self._free(cell.phi, cell.lift + d, v)[1])
        )


# -- closing --------------------------------------------------------------------------------------
# Where a gap closes in a cell.


UNIFORM: Final = np.linspace(0.0, 1.0, 65)
EARLY: Final = np.append(0.0, np.geomspace(1e-9, 1.0, 128))
"""Places in a cell at which the landing is searched for; early ones where a flight begins with a
speed, which may last but a moment.
"""

FINER: Final = np.linspace(0.0, 1.0, 9)
"""Places between two probes, where their gaps do not exclude that it closes in between."""

FINEST: Final = 1e-10
"""A gap that would close and open again within this share of a turn only touches 0."""


def closes(gap: Polynomial, probes: FloatArray) -> float | None:
    """The first place from the first to the last of `probes` at which the `gap`, above 0 at first,
    falls to 0; None if there is none.

    Between probes a bound of its second derivative excludes that it does.
    """
    values = gap(probes)
    width = np.diff(probes)
    # Chebyshev polynomials are at most 1, so the sum of the coefficients bounds the second
    # derivative.
    bend = float(np.sum(np.abs(gap.deriv(2).coef)))
    least = np.minimum(values[:-1], values[1:])
    # A function is at most an eighth of its second derivative times width^2 below its chord.
    doubtful = (least <= 0.0) | (least < 0.125 * bend * width * width)
    for piece in np.flatnonzero(doubtful).tolist():
        low, high = float(probes[piece]), float(probes[piece + 1])
        if values[piece] <= 0.0:
            return low
        if high - low > FINEST * TURN:
            place = closes(gap, low + (high - low) * FINER)
            if place is not None:
                return place
        elif values[piece + 1] <= 0.0:
            return float(bracketed_roots(gap, np.array([low]), np.array([high]))[0])
    return None


# -- walls ----------------------------------------------------------------------------------------
# What stops a follower that is free: its only flank, or two walls with a clearance between them.
#
# The walls of a roller in a groove are its flanks: on the inner one its centre runs on the parallel
# of the pitch curve at half the clearance inwards, on the outer one at half of it outwards. Between
# the discs of a conjugate pair they are the two discs: with the main roller on its disc the
# follower makes the motion of the state, and the return disc gives way by the clearance along its
# normal. The sides of a yoke run on one disc, half a turn apart: with q on the first one, the lift
# on the second one exceeds q by the breadth b of the yoke minus the width w of the cam, if a
# positive lift moves the first one outward (`camgeo.cam.cam`).


LIFTS: Final = 3
"""Lift, velocity and acceleration."""


@dataclass(frozen=True, slots=True, eq=False)
class Wall:
    """A side that pushes the follower, and the motion of a follower that touches it.

    Attributes
    ----------
    sense : the side, see `camgeo.dynamics.effects.contact`.
    motion : (3, n) lift with two derivatives [mm or rad per rad^k].
    leverage : (n,) force on q [1 or mm/rad] per unit of the force with which it pushes; it pushes
        in the direction of its sign.
    borders : (k,) cam angles [rad] in [0, 2 pi) where the formula of the motion changes.
    """

    sense: int
    motion: Quantity
    leverage: Quantity
    borders: FloatArray

    @classmethod
    def of_state(cls, subject: Subject, sense: int) -> Self:
        """The flank `sense`, with the motion of the state."""

        def motion(phi: FloatArray, side: Side) -> FloatArray:
            return subject.state.motion.jet(phi, side, 2)[:LIFTS]

        def leverage(phi: FloatArray, side: Side) -> FloatArray:
            return contact_leverage(subject, phi, side, sense)

        return cls(sense, motion, leverage, subject.state.motion.borders)

    @staticmethod
    def with_clearance(subject: Subject, clearance: float) -> tuple[Wall, Wall]:
        """The walls of a groove, or of a pair of discs, with a `clearance` [mm] above 0, or the two
        sides of a yoke, whose clearance follows from its breadth.

        Their motions raise GeometryError where the clearance is too large for the curves.
        """
        other, breadth = subject.returning, subject.cam.breadth
        if other is None:
            half = 0.5 * clearance
            return _played(subject, -half, INNER, INNER), _played(subject, half, OUTER, OUTER)
        first = Wall.of_state(subject, INNER)
        if breadth is not None:
            return first, _opposite(subject, breadth)
        return first, _played(other, -clearance, OUTER, INNER)

    def outwards(self, angle: float) -> float:
        """Direction of q in which it pushes at one `angle` [rad], +1 or -1."""
        return float(np.sign(self.leverage(np.array([angle]), "right")[0]))


def _opposite(subject: Subject, breadth: Breadth) -> Wall:
    """The second side of a yoke, on the disc half a turn on.

    b - h_0 - kappa_F q = h_0 + kappa_F s(phi + pi), q its lift.
    """
    cam, state = subject.cam, subject.state
    highest = breadth.reach * (cam.yoke_breadth - 2.0 * breadth.height)

    def motion(phi: FloatArray, side: Side) -> FloatArray:
        jet = -state.motion.jet(phi + math.pi, side, 2)[:LIFTS]
        jet[0] += highest
        return np.asarray(jet)

    def leverage(phi: FloatArray, side: Side) -> FloatArray:
        return -state.curve.leverage(phi + math.pi, side)

    return Wall(OUTER, motion, leverage, (state.motion.borders + math.pi) % TURN)


def _played(subject: Subject, distance: float, sense: int, flank: int) -> Wall:
    """The wall `sense`, the `flank` of its disc, with the roller's centre on the parallel at
    `distance` [mm] of its pitch curve.
    """
    cam = subject.cam
    curve = WorkingCurve(subject.state.curve, distance)
    lift = PlayedLift(path_of(cam.follower, cam.rotation), curve)

    def leverage(phi: FloatArray, side: Side) -> FloatArray:
        return flank * lift.leverage(phi, side)

    return Wall(sense, lift.jet, leverage, lift.borders)


# -- flights --------------------------------------------------------------------------------------
# What is known of a follower off the cam: where it leaves, its flights, and the cells of one.


MOST_FLIGHTS: Final = 256
"""Most flights in these turns; more result from too few nodes."""

SAME: Final = 1e-11
"""Landings this close [rad], modulo a turn, are one place."""


UNSETTLED: Final = (
    "the flights did not converge with finer and finer steps: off the cam the follower moves too"
    " fast for them, or the smallest difference decides where it lands"
)


@dataclass(frozen=True, slots=True)
class Flight:
    """The follower off the cam.

    Attributes
    ----------
    leaving, landing : cam angles [rad], the leaving in the turns over which all flights repeat.
    gap : the largest |d|, how far the follower gets from where it would touch [mm or rad].
    speed : of the impact, along the normal [mm/s].
    energy : lost in the impact [N mm].
    rebound : whether it begins with the impact of the flight before.
    left, met : the sides that it leaves and meets, see `camgeo.dynamics.effects.contact`.
    error : estimate of the relative errors of `gap`, `speed` and `energy`.
    late : estimate of the error of `landing` [rad].
    """

    leaving: float
    landing: float
    gap: float
    speed: float
    energy: float
    rebound: bool
    left: int
    met: int
    error: float = 0.0
    late: float = 0.0

    @property
    def crossed(self) -> bool:
        """Whether it meets the other side."""
        return self.left != self.met

    def behind(self, other: Flight) -> bool:
        """Whether it is neither faster nor wider than the `other`."""
        return self.speed <= other.speed and self.gap <= other.gap


@dataclass(frozen=True, slots=True)
class Flights:
    """The flights in the steady state.

    Attributes
    ----------
    flights : by ascending cam angle of leaving, with their rebounds.
    turns : after which they repeat; 0 if they do not within `MOST_TURNS`.
    unlanded : cam angle [rad] at which one begins that lasts longer than that; None without any.
    """

    flights: tuple[Flight, ...]
    turns: int
    unlanded: float | None = None


@dataclass(frozen=True, slots=True)
class Leaving:
    """Where a wall would have to pull.

    Attributes
    ----------
    wall : its number.
    begin, end : cam angles [rad], the begin in [0, 2 pi), the end beyond it, and equal to it where
        the velocity jumps away from the wall.
    rate : of d [per s] with which the follower goes on there.
    """

    wall: int
    begin: float
    end: float
    rate: float = 0.0


def no_train() -> ComplexArray:
    """The memory of a follower that carries no elastic train."""
    return np.zeros(0, dtype=np.complex128)


@dataclass(frozen=True, slots=True, eq=False)
class FreeState:
    """The state of a free follower.

    Attributes
    ----------
    gap, rate : d [mm or rad] and its rate [per s].
    memory : (m,) z of the modes of the train that it carries, see
        `camgeo.dynamics.effects.lift_off.flight`.
    """

    gap: float
    rate: float
    memory: ComplexArray = field(default_factory=no_train)


@dataclass(frozen=True, slots=True, eq=False)
class End:
    """Where a flight ends [rad], on which wall, the coordinate and its rate relative to that wall
    [per s], the largest |d| until then, 0 if it does not open by more than rounding, and the
    memory of the train.
    """

    angle: float
    wall: int
    place: float
    rate: float
    gap: float
    memory: ComplexArray = field(default_factory=no_train)


@dataclass(frozen=True, slots=True, eq=False)
class Cell:
    """A cell of cam angle, and at n angles in it what a free follower needs to know.

    Attributes
    ----------
    ends : [rad].
    angles, phi : (n,) [rad], `phi` in [0, 2 pi).
    omega : (n,) pace of the cam [rad/s].
    lift, pace, pull : (n,) h, h' and h'' in time.
    mass, free, needed : (n,) M, F and R on the wall.
    room : (n,) distance to the other wall in q, away from the wall left; None without one.
    """

    ends: tuple[float, float]
    angles: FloatArray
    phi: FloatArray
    omega: FloatArray
    lift: FloatArray
    pace: FloatArray
    pull: FloatArray
    mass: FloatArray
    free: FloatArray
    needed: FloatArray
    room: FloatArray | None = None


def next_leaving(
    leavings: tuple[Leaving, ...], wall: int, angle: float
) -> tuple[Leaving | None, float]:
    """Where a follower that rests on `wall` at `angle` [rad] leaves it."""
    soonest: tuple[Leaving | None, float] = (None, math.inf)
    for leaving in leavings:
        if leaving.wall != wall:
            continue
        ahead = (leaving.begin - angle) % TURN
        # It is within the range already, and leaves at once.
        if TURN - ahead < leaving.end - leaving.begin:
            ahead = 0.0
        if angle + ahead < soonest[1]:
            soonest = leaving, angle + ahead
    return soonest


def in_turns(flown: list[Flight], turns: int) -> tuple[Flight, ...]:
    """All flights of a period of `turns`, each begun in it, by ascending cam angle."""
    flights = []
    for flight in flown:
        shift = TURN * turns * math.floor(flight.leaving / (TURN * turns))
        flights.append(
            replace(flight, leaving=flight.leaving - shift, landing=flight.landing - shift)
        )
    return tuple(sorted(flights, key=lambda flight: flight.leaving))


def refined(
    solved: Callable[[int], tuple[Flights, ...]],
    worst: Callable[[tuple[Flight, ...]], float],
    tolerance: float,
    sure: int = SURE,
) -> Flights:
    """The finer of two solutions with its errors, of which the `worst` is within the `tolerance`.

    Both are `solved` with cells that are halved so often; `sure` halvings in turn that fail for
    the same reason are the last.

    Raises
    ------
    EffectError
        If there are none.
    """
    error, whys = 1.0, [""]
    for halvings in range(MOST_HALVINGS + 1):
        try:
            rough, fine = solved(halvings)
        except StiffError as stiff:
            whys.append(str(stiff))
            if whys[-1] and whys[-sure:] == sure * whys[-1:]:
                break
            continue
        whys.append("")
        error = 1.0
        if len(rough.flights) == len(fine.flights) and rough.turns == fine.turns:
            flights = _with_errors(rough.flights, fine.flights)
            error = worst(flights) if flights else 0.0
            if error <= max(tolerance, ROUNDING):
                return replace(fine, flights=flights)
    if whys[-1]:
        raise EffectError(whys[-1])
    if error < 1.0:
        raise tolerance_error("the impact speed of a flight", error, "itself", tolerance)
    raise EffectError(UNSETTLED)


def flight_difference(rough: Flight, fine: Flight) -> float:
    """The relative difference of gap, speed and energy; 1 if they end on different walls."""
    if rough.met != fine.met:
        return 1.0
    pairs = (rough.speed, fine.speed), (rough.gap, fine.gap)
    # Relative differences; an energy goes with the square of a speed.
    speed, gap = (abs(a - b) / max(a, b) if a != b else 0.0 for a, b in pairs)
    return max(2.0 * speed, gap)


# -- cells ----------------------------------------------------------------------------------------
# Cells of cam angle in which a flight is integrated, and the nodes in them.


FIRST_CELL: Final = 2.0**-16
"""Length of the first cell as a share of a smooth piece; each cell is twice as long as the one
before, so that a short flight is resolved as well as a long one."""

LONGEST_CELL: Final = 0.25
"""Largest length of a cell as a share of a smooth piece, before cells are halved."""

MOST_HALVINGS: Final = 6
"""Largest number of times that all cells are halved to reach a tolerance."""

ORDERS: Final = (16, 24)
"""Nodes per cell of the solution for the error estimate, and of the final one."""

ROUNDING: Final = 1e-12
"""An estimated error below this share is rounding, whatever the tolerance."""

CLOSE: Final = 1e-14
"""Change of the gap, as a share of its size, at which they end."""

NOISE: Final = 2.0**-50
"""Rounding of the forces, a share of the largest; it moves the gap, however small that is."""

ROUNDED: Final = 2.0**-52
"""Rounding of a lift, a share of the largest."""

MOST_AT_ONCE: Final = 64
"""Cells that are evaluated at a time at most."""

Polynomial = np.polynomial.Chebyshev


class StiffError(ArithmeticError):
    """Picard's iteration does not converge in a cell; words say where shorter ones do not help."""


SLOW: Final = 1e-6
"""Share of a rate at which viscous friction has gone; what is left of a jump is not."""


def why_stiff(angle: float, rate: FloatArray, force: Callable[[FloatArray], FloatArray]) -> str:
    """Why shorter cells do not help: the follower reverses near the cam `angle` [rad], and the
    `force` on it at a rate (n,) jumps with the sign of that rate. Empty if it does not jump.
    """
    least, most = float(np.min(rate)), float(np.max(rate))
    if not least < 0.0 < most:
        return ""
    back, ahead = (force(np.full_like(rate, SLOW * end)) for end in (least, most))
    if np.allclose(back, ahead, rtol=SLOW, atol=0.0):
        return ""
    return (
        f"off the cam the follower reverses near cam angle {cam_angle(angle, '.0f')} deg, and the"
        " jump of its friction to the other side is not computed"
    )


@dataclass(frozen=True, slots=True, eq=False)
class ChebyshevNodes:
    """The Chebyshev nodes of a cell.

    Attributes
    ----------
    places : (n,) of the nodes, from -1 to 1, ascending.
    fit : (n, n) from the values at the nodes to coefficients.
    gain : (n, n) from these values to the integral from the start of the cell to each node, with
        half the length of the cell as the unit.
    """

    places: FloatArray
    fit: FloatArray
    gain: FloatArray

    @classmethod
    def with_count(cls, count: int) -> Self:
        """Chebyshev nodes, `count` of them."""
        places = np.cos(np.pi * (np.arange(count) + 0.5) / count)[::-1]
        matrix = np.polynomial.chebyshev.chebvander(places, count - 1)
        fit = np.asarray(np.linalg.inv(matrix), dtype=np.float64)
        grown = np.polynomial.chebyshev.chebint(fit, lbnd=-1.0)
        return cls(places, fit, np.polynomial.chebyshev.chebvander(places, count) @ grown)

    def time_integral(self, ends: tuple[float, float], pace: FloatArray) -> FloatArray:
        """(n, n) from values at the nodes of the cell with these `ends` to their integral over time
        to each node, where the cell is passed with the `pace` (n,) [rad/s].
        """
        return np.asarray(0.5 * (ends[1] - ends[0]) * self.gain / pace)

    def function(self, values: FloatArray, ends: tuple[float, float]) -> Polynomial:
        """The polynomial with these `values` (n,) at the nodes of the cell with these `ends`."""
        return Polynomial(self.fit @ values, ends)

    def integral(self, values: FloatArray, start: float, ends: tuple[float, float]) -> Polynomial:
        """The integral of the polynomial with these `values` (n,), which is `start` where the cell
        starts.
        """
        return self.function(values, ends).integ(lbnd=ends[0]) + start


def flight_cells(
    start: float, edges: FloatArray, share: float, turns: int = 1
) -> Iterator[tuple[float, float]]:
    """Cells [rad] over so many `turns` from `start`, short at first, none across one of `edges`.

    `share` scales their lengths.
    """
    first, end = math.floor(start / TURN), start + turns * TURN
    # The edges of a turn, in all turns that the flight may take.
    ahead = np.concatenate([edges[:-1] + (first + turn) * TURN for turn in range(turns + 1)])
    stops = [start, *ahead[(ahead > start) & (ahead < end)], end]
    size = share * FIRST_CELL
    for low, high in itertools.pairwise(stops):
        length = high - low
        if length <= 8.0 * math.ulp(high):
            continue
        place = low
        while place < high:
            end = min(place + max(size * length, math.ulp(high)), high)
            # No sliver is left at the end of a piece.
            if high - end < 0.5 * size * length:
                end = high
            yield float(place), float(end)
            place = end
            size = min(2.0 * size, share * LONGEST_CELL)


# -- carried train --------------------------------------------------------------------------------
# The elastic train that a follower carries along, off the cam and after it has landed.
#
# The base of the train has the motion y = h + d, that of a follower on its flank and its gap, and
# the train is linear. So its modes, which obey u' = lambda u - y'', are those of the steady state
# on h and w besides, with
#
#     w' = lambda w - d''.
#
# With z = w + d' this is z' = lambda (z - d'), in which nothing jumps with d': an impact strikes
# the follower in front of the train alone. Its first spring and damper push the follower back by
# the force of the steady state and
#
#     Re sum C (z - d') + a d + b d',
#
# see `camgeo.dynamics.oscillator.train`. On its flank, with d = 0, z decays freely.
#
# In a cell of cam angle the equations in z and d are solved together at the nodes. With the matrix
# B that integrates over time from the start of the cell, and S = (1 - lambda B)^-1,
#
#     z = S (z_0 - lambda B d'),      Re sum C (z - d') = Re sum C S (z_0 - d').
#
# (Collocation at Chebyshev nodes: J. P. Boyd, Chebyshev and Fourier Spectral Methods, chapter 4.)


@dataclass(frozen=True, slots=True, eq=False)
class CarriedTrain:
    """The elastic train behind a follower, whose first spring is on the follower itself.

    Attributes
    ----------
    behind : the train in the steady state of the state's motion.
    course : how the cam turns.
    more : force [N or N mm] beyond that of the steady state: an error that is assumed of it.
    """

    behind: ElasticTrain
    course: TimeCourse
    more: float = 0.0

    @property
    def at_rest(self) -> ComplexArray:
        """(m,) z in the steady state."""
        return np.zeros(len(self.behind.train.rates), dtype=np.complex128)

    def steady(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) force of the steady state, which the follower has to overcome [N or N mm], without
        the load on the output, which counts among the forces on the follower itself.
        """
        push = self.behind.pushes(self.behind.response, phi, side) + self.more
        if self.behind.load is not None:
            push = push + self.behind.load.coefficients(phi, side)[0]
        return np.asarray(push)

    def left(self, memory: ComplexArray, start: float, angles: FloatArray) -> ComplexArray:
        """(m, n) z at `angles` (n,) [rad], on the flank from `start` on, where it is `memory`."""
        times = self.course.time(np.append(angles, start))
        past = np.multiply.outer(self.behind.train.rates, times[:-1] - times[-1])
        return np.asarray(memory[:, np.newaxis] * np.exp(past))

    def pushed(self, memory: ComplexArray) -> FloatArray:
        """(...) the force of z (m, ...) on a follower that touches its flank [N or N mm]."""
        weights = self.behind.train.force(0).weights
        return np.asarray(np.tensordot(weights, memory, 1).real)

    def fastest(self, mass: float) -> float:
        """A circular frequency [rad/s] that none of the follower, of this `mass`, exceeds.

        The stiffness and the damping of the first link act on the mass as it moves fast. Without
        damping the square of the largest frequency is at most the sum of the squares of that of the
        train on a base at rest and that of the mass on a train at rest, because the matrix of both
        is not negative.
        """
        force, rates = self.behind.train.force(0), self.behind.train.rates
        stiff = abs(force.lift - float(np.sum((force.weights * rates).real))) / mass
        damp = abs(force.slope - float(np.sum(force.weights.real))) / mass
        return math.hypot(float(np.max(np.abs(rates))), math.sqrt(stiff)) + damp

    def couple(self, cell: Cell, time_integral: FloatArray, state: FreeState) -> CoupledCell:
        """The follower coupled with the train in a `cell`, from the `state` at its start; for
        `time_integral` see `CoupledCell`.
        """
        force, rates = self.behind.train.force(0), self.behind.train.rates
        one = np.eye(len(cell.phi))
        # (m, n, n) 1 - lambda B of each mode.
        steps = one - rates[:, np.newaxis, np.newaxis] * time_integral
        alone: ComplexArray = np.linalg.inv(steps).astype(np.complex128)
        mode_forces = force.weights[:, np.newaxis, np.newaxis] * alone
        per_rate = force.slope * one - np.sum(mode_forces.real, axis=0) + force.lift * time_integral
        memory_force = np.tensordot(state.memory, mode_forces, 1).real
        # The force of the train on a follower that keeps its rate.
        still = np.sum(memory_force + state.rate * per_rate, axis=1) + force.lift * state.gap
        # The train takes per_rate B d'' besides, so that (M + per_rate B) d'' is what is left of
        # the push.
        inverse = np.linalg.inv(np.diag(cell.mass) + per_rate @ time_integral)
        return CoupledCell(self, cell, state, inverse, still, time_integral, alone)


@dataclass(frozen=True, slots=True, eq=False)
class CoupledCell:
    """A follower with its train at the n nodes of a cell.

    Attributes
    ----------
    carried, cell, start : the train, the cell, and the state at its start.
    inverse : (n, n) from forces to d''.
    still : (n,) force of the train with d'' = 0 [N or N mm].
    time_integral : (n, n) B [s].
    alone : (m, n, n) S.
    """

    carried: CarriedTrain
    cell: Cell
    start: FreeState
    inverse: FloatArray
    still: FloatArray
    time_integral: FloatArray
    alone: ComplexArray

    def acceleration(self, push: FloatArray) -> FloatArray:
        """(n,) d'' with all other forces `push` (n,)."""
        return np.asarray(self.inverse @ (push - self.still))

    def memory(self, nodes: ChebyshevNodes, rate: FloatArray) -> Callable[[float], ComplexArray]:
        """z (m,) as a function of the cam angle [rad] in the cell, with d' `rate` (n,)."""
        rates = self.carried.behind.train.rates[:, np.newaxis]
        forced = self.start.memory[:, np.newaxis] - rates * (self.time_integral @ rate)
        # S of each mode m, applied to its forcing at the nodes j.
        z = np.einsum("mij,mj->mi", self.alone, forced)
        low, high = self.cell.ends
        half = 0.5 * (high - low)
        # z' = lambda (z - d') in time, by the place in the cell from -1 to 1.
        series = nodes.fit @ (half * rates * (z - rate) / self.cell.omega).T
        grown = np.polynomial.chebyshev.chebint(series, lbnd=-1.0)

        def evaluate(angle: float) -> ComplexArray:
            place = (angle - low) / half - 1.0
            return np.asarray(self.start.memory + np.polynomial.chebyshev.chebval(place, grown))

        return evaluate


# -- elastic ------------------------------------------------------------------------------------
# The flights of a follower with an elastic train, until they repeat.
#
# A landing moves the train, which goes on vibrating: on the flank as in the steady state and a free
# vibration besides, see "carried train" above. So the follower leaves where the flank would have to
# pull with both of them. It begins as if nothing had been before the first place where it does so
# in the steady state, and what is reported are the flights that repeat after that.
#
# They do so in the limit only. With the change c of their figures from one repetition to the next,
# and c_0 that before, what is left of the way is c r / (1 - r), r = c / c_0, if it shrinks alike.


MOST_ELASTIC_TURNS: Final = 24
"""Turns after which all flights must repeat: a train with a damping ratio of 0.01 and ten periods a
turn keeps half of its vibration over a turn."""

MOST_PERIODS: Final = 400.0
"""Periods a turn of the fastest vibration whose flights are computed; each is a cell."""

PER_PIECE: Final = 4.0
"""Periods between two edges, of which a cell is a quarter at most."""

NEAR: Final = 1e-2
"""Landings this close [rad], modulo turns, may be one place."""

SETTLED: Final = 0.1
"""Share of the tolerance that the end of the series of repetitions may leave."""

STILL: Final = 1e-11
"""A change of this share from one repetition to the next is rounding."""

REPEATED: Final = 3
"""Repetitions that are compared at most."""


State = tuple[float, ComplexArray]
"""Cam angle [rad], and z (m,) of a follower on its flank."""


@dataclass(frozen=True, slots=True, eq=False)
class Repeated:
    """The result of a series of flights.

    Attributes
    ----------
    flights : that repeat.
    end : the state from which they would do so once more.
    """

    flights: Flights
    end: State


@dataclass(frozen=True, slots=True, eq=False)
class ElasticFollower:
    """A follower on a single flank whose train is elastic.

    Attributes
    ----------
    free : the follower off the flank, with its train.
    leaps : where the velocity of the flank jumps away from the follower.
    limit : force below 0 at which it has left the flank [N or N mm]; less is rounding.
    """

    free: FreeFollower
    carried: CarriedTrain
    leaps: tuple[Leaving, ...]
    limit: float

    most_turns: ClassVar[int] = MOST_ELASTIC_TURNS

    @classmethod
    def with_train(
        cls,
        free: FreeFollower,
        flank: Flank,
        behind: ElasticTrain,
        leaps: tuple[Leaving, ...] = (),
    ) -> Self:
        """The follower `free` of `flank` with its train, whose masses are no part of its own.

        Raises
        ------
        EffectError
            If it vibrates so fast that its flights have too many cells.
        """
        contact, mass = flank.contact, behind.mass

        def in_front(phi: FloatArray, q: FloatArray) -> FloatArray:
            both = free.inertia.mass_terms(phi, q)
            both[0] -= mass
            return both

        forces = tuple(force for force in free.forces if not force.present)
        inertia = replace(free.inertia, mass_terms=in_front)
        carried = CarriedTrain(behind, free.course)
        least = float(np.min(in_front(free.edges, free.walls[0].motion(free.edges, "right")[0])[0]))
        periods = carried.fastest(least) * period(free.course) / TURN
        if periods > MOST_PERIODS:
            raise EffectError(
                f"off the cam the follower and its train vibrate with up to {periods:.4g} periods a"
                f" turn; flights are computed with up to {MOST_PERIODS:g}"
            )
        # The edges of the contact have those between which a rigid train's force is searched.
        smooth = flank.base_edges if contact.bearings is None else contact.edges
        count = math.ceil(periods / PER_PIECE) + 1
        edges = merged(np.concatenate((smooth, np.linspace(0.0, TURN, count + 1))))
        follower = replace(free, forces=forces, inertia=inertia, carried=carried, edges=edges)
        wall = follower.walls[0]
        push = piecewise_extremes(
            lambda phi, side: follower.on_wall(wall, phi, side)[3], contact.edges
        )
        return cls(follower, carried, leaps, TOUCH * push.magnitude)

    def steady(
        self, leavings: tuple[Leaving, ...], restitution: float, tolerance: float
    ) -> Flights:
        """The flights that repeat, from the first of `leavings` on.

        Raises
        ------
        EffectError
            If they cannot be computed to the `tolerance`.
        """
        begin = min(leaving.begin for leaving in leavings), self.carried.at_rest
        # With the force of the train off by its error: what this changes is part of the error.
        perturbed = replace(self.carried, more=self.carried.behind.error)
        rougher = replace(self, free=replace(self.free, carried=perturbed), carried=perturbed)

        def solved(halvings: int) -> tuple[Flights, ...]:
            fine = self.repeated(
                begin, restitution, tolerance, ChebyshevNodes.with_count(ORDERS[1]), halvings
            )
            if not fine.flights.turns:
                return fine.flights, fine.flights
            nodes = ChebyshevNodes.with_count(ORDERS[0])
            rough = rougher.repeated(fine.end, restitution, tolerance, nodes, halvings)
            return rough.flights, fine.flights

        # A stiff train may need all of them.
        return refined(solved, _share, tolerance, MOST_HALVINGS + 1)

    def repeated(
        self,
        begin: State,
        restitution: float,
        tolerance: float,
        nodes: ChebyshevNodes,
        halvings: int,
    ) -> Repeated:
        """The flights from `begin` on until they repeat, with these `nodes` in each cell, and cells
        halved so often; those before that if they do not.
        """
        angle, memory = begin
        last = angle + MOST_ELASTIC_TURNS * TURN
        all_flights: list[Flight] = []
        begun: list[tuple[float, int]] = []
        while angle <= last and len(all_flights) < MOST_FLIGHTS:
            leaving = self._leaving(angle, memory)
            if leaving is None:
                break
            start = leaving.begin
            for earlier, count in reversed(begun):
                turns = round((start - earlier) / TURN)
                # It leaves where it has left whole turns before: the flights may repeat from there.
                if turns and abs(start - earlier - turns * TURN) <= NEAR:
                    slow = _slow(all_flights, [*begun, (start, len(all_flights))], turns, tolerance)
                    if slow is not None:
                        settled = _settled(all_flights, count, turns, slow)
                        return Repeated(Flights(in_turns(settled, turns), turns), (angle, memory))
            begun.append((start, len(all_flights)))
            memory = self.carried.left(memory, angle, np.array([start]))[:, 0]
            state = FreeState(0.0, leaving.rate, memory)
            flights, end = self.free.follow_flight(0, start, state, restitution, nodes, halvings)
            all_flights += flights
            if end is None:
                since = flights[-1].landing if flights else start
                return Repeated(Flights(tuple(all_flights), 0, since % TURN), (angle, memory))
            angle, memory = end.angle, end.memory
            if angle == start:  # nothing has opened: it has not left
                angle = max(leaving.end, start + SAME)
                memory = self.carried.left(memory, start, np.array([angle]))[:, 0]
        return Repeated(Flights(tuple(all_flights), 0), (angle, memory))

    def _leaving(self, angle: float, memory: ComplexArray) -> Leaving | None:
        """Where the follower leaves its flank after `angle` [rad], where z is `memory`; None if it
        stays for `MOST_ELASTIC_TURNS`.
        """
        wall, size = self.free.walls[0], 1
        outwards = wall.outwards(angle % TURN)
        leaps = [
            replace(leap, begin=begin, end=begin)
            for leap in self.leaps
            for begin in (leap.begin + TURN * math.ceil((angle - leap.begin) / TURN),)
        ]
        leap = min(leaps, key=lambda leap: leap.begin, default=None)

        def reserve(phi: FloatArray) -> FloatArray:
            needed = self.free.on_wall(wall, np.mod(phi, TURN), "right")[3]
            vibrating = self.carried.pushed(self.carried.left(memory, angle, phi))
            return np.asarray(outwards * (needed + vibrating) + self.limit)

        cells = flight_cells(angle, self.free.edges, 1.0, MOST_ELASTIC_TURNS)
        while block := list(itertools.islice(cells, size)):
            cuts = np.array([block[0][0], *(high for _, high in block)])
            cuts = merged(np.concatenate((cuts, dips(reserve, sample_grid(cuts)))))
            cuts = with_roots(reserve, cuts)
            below = np.append(reserve(0.5 * (cuts[:-1] + cuts[1:])) < 0.0, False)
            if np.any(below):
                piece = int(np.argmax(below))
                end = piece + int(np.argmin(below[piece:]))
                leaving = Leaving(0, float(cuts[piece]), float(cuts[end]))
                return leaving if leap is None or leaving.begin < leap.begin else leap
            if leap is not None and leap.begin <= cuts[-1]:
                return leap
            size = min(2 * size, MOST_AT_ONCE)
        return leap


def _slow(
    flown: list[Flight], begun: list[tuple[float, int]], turns: int, tolerance: float
) -> float | None:
    """What is left of the way to the flights that repeat after so many `turns`, as a multiple of
    the last change; None if it is too long, or if nothing has repeated often enough to tell.

    `begun` has where each flight has begun, and how many there were before, the last yet to be.
    """
    ends = [begun[-1]]
    for _ in range(REPEATED):
        expected = ends[-1][0] - turns * TURN
        near = min(begun, key=lambda pair: abs(pair[0] - expected))
        if not abs(near[0] - expected) <= NEAR:
            break
        ends.append(near)
    series = [flown[low:high] for (_, high), (_, low) in itertools.pairwise(ends)]
    changes = [_change(*pair, turns) for pair in itertools.pairwise(series)]
    if changes and changes[0] <= STILL:
        return 1.0
    if len(changes) <= 1 or not changes[0] < changes[1] < math.inf:
        return None
    # The changes of a geometric series: share / (1 - share) of the last one is still to come.
    share = changes[0] / changes[1]
    slow = max(1.0, share / (1.0 - share))
    return slow if slow * changes[0] <= SETTLED * tolerance else None


def _settled(flown: list[Flight], count: int, turns: int, slow: float) -> list[Flight]:
    """The last flights, from number `count` on, with the errors that their series leaves."""
    last = flown[count:]
    previous = flown[count - len(last) : count]
    return [
        replace(
            new,
            error=slow * flight_difference(old, new),
            late=slow * abs(new.landing - old.landing - turns * TURN),
        )
        for old, new in zip(previous, last, strict=True)
    ]


def _change(after: list[Flight], before: list[Flight], turns: int) -> float:
    """The largest change of speeds, twice, of gaps, as shares of the largest, and of landings
    [rad]; infinite if there are more or fewer flights.
    """
    if len(after) != len(before):
        return math.inf
    speed, gap = _largest(after)
    return max(
        max(
            2.0 * abs(new.speed - old.speed) / speed,
            abs(new.gap - old.gap) / gap,
            abs(new.landing - old.landing - turns * TURN),
        )
        for old, new in zip(before, after, strict=True)
    )


def _largest(flights: Sequence[Flight]) -> tuple[float, float]:
    """The largest speed and gap."""
    return max(flight.speed for flight in flights), max(flight.gap for flight in flights)


def _with_errors(rough: tuple[Flight, ...], fine: tuple[Flight, ...]) -> tuple[Flight, ...]:
    """The `fine` flights with their errors: what they differ by, and what their series leaves."""
    return tuple(
        replace(
            better,
            error=better.error + max(flight_difference(worse, better), ROUNDING),
            late=better.late + max(abs(worse.landing - better.landing), ROUNDING * TURN),
        )
        for worse, better in zip(rough, fine, strict=True)
    )


def _share(flights: tuple[Flight, ...]) -> float:
    """The largest error of a figure, as a share of the largest of its kind."""
    speed, gap = _largest(flights)
    return max(flight.error * max(flight.speed / speed, flight.gap / gap) for flight in flights)
