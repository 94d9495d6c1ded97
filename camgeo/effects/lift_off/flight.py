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
`camgeo.effects.lift_off.carried`; M is then that of the follower in front of it. Where h' jumps, d'
jumps the other way.

In each cell of cam angle d solves the integral equation at Chebyshev nodes, by Picard's iteration
(Clenshaw and Norton, The Computer Journal 6 (1963) 88-92). Between the places where a gap is
evaluated, a bound of its second derivative excludes that it closes.

A follower that rests on a wall has no memory: once it leaves the same place of the turn a second
time, all that follows repeats.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, ClassVar, Final

import numpy as np

from camgeo.effects.bearing_friction import BearingFriction
from camgeo.effects.force import Force
from camgeo.effects.lift_off.cells import (
    CLOSE,
    MOST_AT_ONCE,
    MOST_HALVINGS,
    NOISE,
    ORDERS,
    ROUNDING,
    Nodes,
    Polynomial,
    StiffError,
    cells_from,
)
from camgeo.effects.lift_off.closing import EARLY, EVEN, closes
from camgeo.effects.lift_off.flown import (
    MOST_FLIGHTS,
    SAME,
    Cell,
    End,
    Flight,
    Flights,
    Leaving,
    Off,
    apart,
    in_turns,
    next_leaving,
    unsettled,
)
from camgeo.effects.lift_off.walls import Wall
from camgeo.effects.ranges import ranges_below
from camgeo.effects.results import Inertia
from camgeo.errors import EffectError
from camgeo.motion.time_course import TimeCourse
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side
from camgeo.numeric.extremes import piecewise_extremes
from camgeo.numeric.roots import bracketed_roots, sign_changes
from camgeo.units import TURN
from camgeo.wording import cam_angle

if TYPE_CHECKING:
    from camgeo.effects.lift_off.carried import Carried

MOST_ITERATIONS: Final = 60
"""Of Picard's in a cell; a cell that is too long for the natural frequency needs more."""

SURE: Final = 3
"""Successive halvings of the cells that fail for a reason: more will not help. Cells that are much
too long may fail for it too, because the iteration diverges."""

MOST_REBOUNDS: Final = 5
"""Rebounds of one flight that are followed; then it stays on the wall that it has hit."""

MOST_TURNS: Final = 8
"""Turns after which all flights must repeat, and one flight must have ended."""

SLOW: Final = 1e-6
"""Share of a rate at which viscous friction has gone; what is left of a jump is not."""

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
    carried: Carried | None = None

    most_turns: ClassVar[int] = MOST_TURNS

    def leavings(self) -> tuple[Leaving, ...]:
        """Where the walls would have to pull."""
        found = []
        for number, wall in enumerate(self.walls):

            def push(phi: FloatArray, side: Side, wall: Wall = wall) -> FloatArray:
                needed = self.on_wall(wall, phi, side)[3]
                return np.asarray(np.sign(wall.leverage(phi, side)) * needed)

            extremes = piecewise_extremes(push, self.edges)
            limit = -PULLING * extremes.magnitude
            if extremes.lowest.value < limit:
                for each in ranges_below(push, self.edges, limit, extremes.lowest):
                    length = (each.end - each.start) % TURN
                    found.append(Leaving(number, each.start, each.start + (length or TURN)))
        return tuple(found)

    def jump(self, angle: float) -> float:
        """The rate of d [per s] with which the follower goes on where the velocity jumps."""
        here = np.array([angle])
        before, after = (self.walls[0].motion(here, side)[1, 0] for side in ("left", "right"))
        return float((before - after) * self.course.rates(here)[0, 0])

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
        error, whys = 1.0, [""]
        for halvings in range(MOST_HALVINGS + 1):
            try:
                rough, fine = (
                    self._chain(leavings, restitution, Nodes.of(count), halvings)
                    for count in ORDERS
                )
            except StiffError as stiff:
                whys.append(str(stiff))
                if whys[-1] and whys[-SURE:] == SURE * whys[-1:]:
                    break
                continue
            whys.append("")
            alike = len(rough.flights) == len(fine.flights) and rough.turns == fine.turns
            pairs = tuple(zip(rough.flights, fine.flights, strict=False))
            error = max((apart(*both) for both in pairs), default=0.0) if alike else 1.0
            if error <= max(tolerance, ROUNDING):
                told = (
                    replace(
                        better,
                        error=max(apart(worse, better), ROUNDING),
                        late=max(abs(worse.landing - better.landing), ROUNDING * TURN),
                    )
                    for worse, better in pairs
                )
                return replace(fine, flights=tuple(told))
        if whys[-1]:
            raise EffectError(whys[-1])
        raise unsettled(error, tolerance)

    def _chain(
        self, leavings: tuple[Leaving, ...], restitution: float, nodes: Nodes, halvings: int
    ) -> Flights:
        """As `steady`, with these `nodes` in each cell, and cells halved so often."""
        first = min(leavings, key=lambda each: each.begin)
        last = first.begin + MOST_TURNS * TURN
        wall, angle = first.wall, first.begin
        flown: list[Flight] = []
        begun: list[tuple[Leaving, float, int]] = []
        while angle <= last and len(flown) < MOST_FLIGHTS:
            leaving, start = next_leaving(leavings, wall, angle)
            if leaving is None:
                return Flights((), 1)  # it stays on a wall that never has to pull
            for each, before, count in begun:
                turns = round((start - before) / TURN)
                if each is leaving and turns and abs(start - before - turns * TURN) <= SAME:
                    return Flights(in_turns(flown[count:], turns), turns)
            begun.append((leaving, start, len(flown)))
            off = Off(0.0, leaving.rate)
            flights, end = self.flown_from(wall, start, off, restitution, nodes, halvings)
            flown += flights
            if end is None:
                return Flights(tuple(flown), 0, (flights[-1].landing if flights else start) % TURN)
            wall, angle = end.wall, end.angle
            if angle == start:  # nothing has opened: it has not left
                ahead = (leaving.end - start) % TURN
                angle = max(start + ahead, float(np.nextafter(start, np.inf)))
        return Flights(tuple(flown), 0)

    def flown_from(
        self, wall: int, angle: float, off: Off, restitution: float, nodes: Nodes, halvings: int
    ) -> tuple[list[Flight], End | None]:
        """The flight that leaves the `wall` at `angle` [rad], with its rebounds, and the end of the
        last: None if it lasts longer than `MOST_TURNS`, where that began if nothing opens.
        """
        flown: list[Flight] = []
        end = None
        for number in range(MOST_REBOUNDS + 1 if restitution else 1):
            end = self._flight(wall, angle, off, nodes, halvings)
            if end is None or end.gap == 0.0:
                break
            flown.append(self._landed(end, restitution, (wall, angle), number > 0))
            wall, angle = end.wall, end.angle
            off = Off(0.0, -restitution * end.rate, end.memory)
        return flown, end

    def _landed(
        self, end: End, restitution: float, begin: tuple[int, float], rebound: bool
    ) -> Flight:
        """The flight that begins on a wall at an angle [rad], `begin`."""
        left, angle = begin
        here = np.array([end.angle % TURN])
        met = self.walls[end.wall]
        lever = float(met.leverage(here, "left")[0])
        mass = float(self.inertia.at(here, np.array([end.place]))[0, 0])
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
        self, wall: int, leaving: float, off: Off, nodes: Nodes, halvings: int
    ) -> End | None:
        """The end of the flight that leaves the `wall` at `leaving` [rad]; None if it lasts longer
        than `MOST_TURNS`.
        """
        outwards = self.walls[wall].outwards(leaving % TURN)
        most, flying, thrown = 0.0, False, off.rate != 0.0
        for cell in self._sampled(wall, outwards, leaving, nodes, halvings):
            low, high = cell.ends
            if low > leaving:
                off = replace(off, rate=off.rate + self._leap(low))
            gap, speed, memory = self._solved(cell, nodes, off)
            probes = low + (high - low) * (EVEN if flying or not thrown else EARLY)
            away = outwards * gap(probes)
            # The gap begins with 0, and what rounding makes of it before it opens is no landing.
            opened = np.maximum.accumulate(away > self.least) | flying
            if not opened[-2] and (thrown or away[-1] < -self.least):
                return End(leaving, wall, 0.0, 0.0, 0.0, off.memory)
            back = closes(outwards * gap, probes[opened]) if opened[-2] else None
            across = None
            if cell.room is not None:
                room = nodes.function(cell.room, cell.ends) - outwards * gap
                across = closes(room, probes)
            stops = [each for each in (back, across) if each is not None]
            end = min(stops, default=high)
            turning = bracketed_roots(speed, *sign_changes(probes, speed(probes)))
            far = outwards * gap(np.append(turning[turning < end], [low, end]))
            most = max(most, float(np.max(far)))
            last = Off(float(gap(end)), float(speed(end)), memory(end))
            if stops:
                hit = wall if across is None or end == back else 1 - wall
                return self._ended(wall, hit, end, last, most)
            off, flying = last, bool(opened[-1])
        return None

    def _leap(self, angle: float) -> float:
        """What the rate of d gains at `angle` [rad], where the velocity of the wall may jump."""
        apart = np.abs(np.mod(angle - self.jumps + 0.5 * TURN, TURN) - 0.5 * TURN)
        return sum(self.jump(each) for each in self.jumps[apart <= SAME].tolist())

    def _ended(self, wall: int, hit: int, angle: float, last: Off, most: float) -> End:
        """The end on the wall `hit`, with the largest gap until then."""
        here = np.array([angle % TURN])
        own, met = (self.walls[each].motion(here, "left")[:, 0] for each in (wall, hit))
        omega = float(self.course.rates(here)[0, 0])
        place, pace = float(own[0]), omega * float(met[1] - own[1])
        return End(angle, hit, place + last.gap, last.rate - pace, most, last.memory)

    def on_wall(
        self, wall: Wall, phi: FloatArray, side: Side
    ) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """The motion (3, n) on `wall` in time, and (n,) M, F and R there, see the module.

        R has the friction of the bearings, and the force of an elastic train in its steady state.
        """
        jet, rates = wall.motion(phi, side), self.course.rates(phi, side)
        omega, alpha = rates[0], rates[1]
        timed = np.stack((jet[0], jet[1] * omega, jet[2] * omega * omega + jet[1] * alpha))
        mass, free = self._free(phi, timed[0], timed[1])
        needed = mass * timed[2] - free
        if self.bearings is not None:
            needed = needed + self.bearings.alone(phi, side, rates)
        if self.carried is not None:
            needed = needed + self.carried.steady(phi, side)
        return timed, mass, free, needed

    def _free(
        self, phi: FloatArray, q: FloatArray, rate: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """M and F (n,) of a free follower, see the module."""
        mass, half = self.inertia.at(phi, q)
        free = -half * rate * rate
        for each in self.forces:
            assert each.off is not None  # see the class
            free = free + each.off(phi, q, rate)
        return mass, free

    def _sampled(
        self, wall: int, outwards: float, leaving: float, nodes: Nodes, halvings: int
    ) -> Iterator[Cell]:
        """The cells of a flight; many are evaluated at a time, the more the longer the flight."""
        cells = cells_from(leaving, self.edges, 0.5**halvings, MOST_TURNS)
        own, size = self.walls[wall], 1
        while block := list(itertools.islice(cells, size)):
            lows, highs = np.array(block).T[:, :, None]
            angles = 0.5 * (lows + highs) + 0.5 * (highs - lows) * nodes.places
            phi = np.mod(angles, TURN).ravel()
            timed, *forces = self.on_wall(own, phi, "right")
            found = [phi, self.course.rates(phi)[0], *timed, *forces]
            if len(self.walls) > 1:
                other = self.walls[1 - wall].motion(phi, "right")[0]
                found.append(outwards * (other - timed[0]))
            rows = np.reshape(found, (len(found), *angles.shape))
            for number, ends in enumerate(block):
                yield Cell(ends, angles[number], *rows[:, number])
            size = min(2 * size, MOST_AT_ONCE)

    def _solved(
        self, cell: Cell, nodes: Nodes, off: Off
    ) -> tuple[Polynomial, Polynomial, Callable[[float], ComplexArray]]:
        """d, its rate and the memory of the train in a cell, which at its start are those of
        `off`.
        """
        count = len(cell.phi)
        time = (cell.ends[1] - cell.ends[0]) / np.min(cell.omega)
        sizes = np.abs(cell.free) + np.abs(cell.mass * cell.pull)
        size = np.max(np.maximum(sizes, np.abs(cell.needed)) / cell.mass)
        noise = NOISE * float(size) * time * time
        over_time = nodes.over(cell.ends, cell.omega)
        moved = None if self.carried is None else self.carried.moved(cell, over_time, off)
        d, v = np.full(count, off.gap), np.full(count, off.rate)
        for _ in range(MOST_ITERATIONS):
            mass, free = self._free(cell.phi, cell.lift + d, cell.pace + v)
            if not np.all(mass > 0.0):
                raise StiffError("the follower flies beyond the end of its linkage's motion")
            push = free - cell.free - cell.needed + (cell.mass - mass) * cell.pull
            push = push / mass if moved is None else moved.acceleration(push)
            v = off.rate + over_time @ push
            last, d = d, off.gap + over_time @ v
            if np.max(np.abs(d - last)) <= max(CLOSE * float(np.max(np.abs(d))), noise):
                speed = nodes.integral(push / cell.omega, off.rate, cell.ends)
                gap = nodes.integral(v / cell.omega, off.gap, cell.ends)
                kept = (lambda _: off.memory) if moved is None else moved.memory(nodes, v)
                return gap, speed, kept
        raise StiffError(self._turned_round(cell, cell.lift + d, cell.pace + v))

    def _turned_round(self, cell: Cell, q: FloatArray, rate: FloatArray) -> str:
        """That the rate (n,) of q (n,) changes its sign in a cell, and a force jumps with it; empty
        if not.
        """
        least, most = float(np.min(rate)), float(np.max(rate))
        if not least < 0.0 < most:
            return ""
        back, ahead = (self._free(cell.phi, q, np.full_like(q, SLOW * e))[1] for e in (least, most))
        if np.allclose(back, ahead, rtol=SLOW, atol=0.0):
            return ""
        return (
            f"off the cam it turns round near cam angle {cam_angle(cell.ends[0], '.0f')} deg, and"
            " friction that jumps there to the other side is not followed"
        )
