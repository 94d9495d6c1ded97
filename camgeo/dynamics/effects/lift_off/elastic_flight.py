"""The flights of a follower with an elastic train, until they repeat.

A landing moves the train, which goes on vibrating: on the flank as in the steady state and a free
vibration besides, see `camgeo.dynamics.effects.lift_off.flight`. So the follower leaves where the
flank would have to pull with both of them. It begins as if nothing had been before the first place
where it does so in the steady state, and what is told are the flights that repeat after that.

They do so in the limit only. With the change c of their figures from one repetition to the next,
and c_0 that before, what is left of the way is c r / (1 - r), r = c / c_0, if it shrinks alike.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Final

import numpy as np

from camgeo.dynamics.effects.contact import TOUCH
from camgeo.dynamics.effects.lift_off.flank import Flank
from camgeo.dynamics.effects.lift_off.flight import (
    MOST_AT_ONCE,
    MOST_FLIGHTS,
    MOST_HALVINGS,
    ORDERS,
    ROUNDING,
    SAME,
    Carried,
    Flight,
    Flights,
    FreeFollower,
    Leaving,
    Nodes,
    Off,
    StiffError,
    apart,
    cells_from,
    in_turns,
    unsettled,
)
from camgeo.errors import EffectError
from camgeo.kinematics.time_course import period
from camgeo.numeric.arrays import ComplexArray, FloatArray, merged
from camgeo.numeric.extremes import dips, grid_of, piecewise_extremes, roots_on_grid
from camgeo.units import TURN

MOST_TURNS: Final = 24
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
    """What a series of flights has come to.

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
    carried: Carried
    leaps: tuple[Leaving, ...]
    limit: float

    most_turns: ClassVar[int] = MOST_TURNS

    def steady(
        self, leavings: tuple[Leaving, ...], restitution: float, tolerance: float
    ) -> Flights:
        """The flights that repeat, from the first of `leavings` on.

        Raises
        ------
        EffectError
            If they cannot be computed to the `tolerance`.
        """
        begin = min(each.begin for each in leavings), self.carried.at_rest
        off = replace(self.carried, more=self.carried.behind.error)
        rougher = replace(self, free=replace(self.free, carried=off), carried=off)
        error, why = 1.0, ""
        for halvings in range(MOST_HALVINGS + 1):
            try:
                found = self.repeated(begin, restitution, tolerance, Nodes.of(ORDERS[1]), halvings)
                fine = found.flights
                if not fine.turns:
                    return fine
                nodes = Nodes.of(ORDERS[0])
                rough = rougher.repeated(found.end, restitution, tolerance, nodes, halvings).flights
            except StiffError as stiff:
                why = str(stiff)
                continue
            why = ""
            alike = len(rough.flights) == len(fine.flights) and rough.turns == fine.turns
            told = _told(rough.flights, fine.flights) if alike else ()
            error = _share(told) if told else 1.0
            if error <= max(tolerance, ROUNDING):
                return replace(fine, flights=told)
        if why:
            raise EffectError(why)
        raise unsettled(error, tolerance)

    def repeated(
        self, begin: State, restitution: float, tolerance: float, nodes: Nodes, halvings: int
    ) -> Repeated:
        """The flights from `begin` on until they repeat, with these `nodes` in each cell, and cells
        halved so often; those before that if they do not.
        """
        angle, memory = begin
        last = angle + MOST_TURNS * TURN
        flown: list[Flight] = []
        begun: list[tuple[float, int]] = []
        while angle <= last and len(flown) < MOST_FLIGHTS:
            leaving = self._leaving(angle, memory)
            if leaving is None:
                break
            start = leaving.begin
            for each, count in reversed(begun):
                turns = round((start - each) / TURN)
                if turns and abs(start - each - turns * TURN) <= NEAR:
                    slow = _slow(flown, [*begun, (start, len(flown))], turns, tolerance)
                    if slow is not None:
                        settled = _settled(flown, count, turns, slow)
                        return Repeated(Flights(in_turns(settled, turns), turns), (angle, memory))
            begun.append((start, len(flown)))
            memory = self.carried.left(memory, angle, np.array([start]))[:, 0]
            off = Off(0.0, leaving.rate, memory)
            flights, end = self.free.flown_from(0, start, off, restitution, nodes, halvings)
            flown += flights
            if end is None:
                since = flights[-1].landing if flights else start
                return Repeated(Flights(tuple(flown), 0, since % TURN), (angle, memory))
            angle, memory = end.angle, end.memory
            if angle == start:  # nothing has opened: it has not left
                angle = max(leaving.end, start + SAME)
                memory = self.carried.left(memory, start, np.array([angle]))[:, 0]
        return Repeated(Flights(tuple(flown), 0), (angle, memory))

    def _leaving(self, angle: float, memory: ComplexArray) -> Leaving | None:
        """Where it leaves its flank after `angle` [rad], where z is `memory`; None if it stays for
        `MOST_TURNS`.
        """
        wall, size = self.free.walls[0], 1
        outwards = wall.outwards(angle % TURN)
        leaps = [
            replace(each, begin=begin, end=begin)
            for each in self.leaps
            for begin in (each.begin + TURN * math.ceil((angle - each.begin) / TURN),)
        ]
        leap = min(leaps, key=lambda each: each.begin, default=None)

        def reserve(phi: FloatArray) -> FloatArray:
            needed = self.free.on_wall(wall, np.mod(phi, TURN), "right")[3]
            vibrating = self.carried.pushed(self.carried.left(memory, angle, phi))
            return np.asarray(outwards * (needed + vibrating) + self.limit)

        cells = cells_from(angle, self.free.edges, 1.0, MOST_TURNS)
        while block := list(itertools.islice(cells, size)):
            cuts = np.array([block[0][0], *(high for _, high in block)])
            cuts = merged(np.concatenate((cuts, dips(reserve, grid_of(cuts)))))
            cuts = merged(np.concatenate((cuts, roots_on_grid(reserve, grid_of(cuts)))))
            below = np.append(reserve(0.5 * (cuts[:-1] + cuts[1:])) < 0.0, False)
            if np.any(below):
                piece = int(np.argmax(below))
                end = piece + int(np.argmin(below[piece:]))
                found = Leaving(0, float(cuts[piece]), float(cuts[end]))
                return found if leap is None or found.begin < leap.begin else leap
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
        before = ends[-1][0] - turns * TURN
        near = min(begun, key=lambda each: abs(each[0] - before))
        if not abs(near[0] - before) <= NEAR:
            break
        ends.append(near)
    series = [flown[low:high] for (_, high), (_, low) in itertools.pairwise(ends)]
    changes = [_change(*each, turns) for each in itertools.pairwise(series)]
    if changes and changes[0] <= STILL:
        return 1.0
    if len(changes) <= 1 or not changes[0] < changes[1] < math.inf:
        return None
    share = changes[0] / changes[1]
    slow = max(1.0, share / (1.0 - share))
    return slow if slow * changes[0] <= SETTLED * tolerance else None


def _settled(flown: list[Flight], count: int, turns: int, slow: float) -> list[Flight]:
    """The last flights, from number `count` on, with the errors that their series leaves."""
    last = flown[count:]
    before = flown[count - len(last) : count]
    return [
        replace(
            new,
            error=slow * apart(old, new),
            late=slow * abs(new.landing - old.landing - turns * TURN),
        )
        for old, new in zip(before, last, strict=True)
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
    return max(each.speed for each in flights), max(each.gap for each in flights)


def _told(rough: tuple[Flight, ...], fine: tuple[Flight, ...]) -> tuple[Flight, ...]:
    """The `fine` flights with their errors: what they differ by, and what their series leaves."""
    return tuple(
        replace(
            better,
            error=better.error + max(apart(worse, better), ROUNDING),
            late=better.late + max(abs(worse.landing - better.landing), ROUNDING * TURN),
        )
        for worse, better in zip(rough, fine, strict=True)
    )


def _share(flights: tuple[Flight, ...]) -> float:
    """The largest error of a figure, as a share of the largest of its kind."""
    speed, gap = _largest(flights)
    return max(each.error * max(each.speed / speed, each.gap / gap) for each in flights)


def carrying(free: FreeFollower, flank: Flank, leaps: tuple[Leaving, ...]) -> ElasticFollower:
    """The follower `free` of `flank` with its train, whose masses are no part of its own.

    Raises
    ------
    EffectError
        If it vibrates so fast that its flights have too many cells.
    """
    contact = flank.contact
    behind = contact.behind
    assert behind is not None  # as the caller has seen
    mass = behind.mass

    def in_front(phi: FloatArray, q: FloatArray) -> FloatArray:
        both = free.inertia.at(phi, q)
        both[0] -= mass
        return both

    forces = tuple(each for each in free.forces if not each.present)
    inertia = replace(free.inertia, at=in_front)
    carried = Carried(behind, free.course)
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
    own = replace(free, forces=forces, inertia=inertia, carried=carried, edges=edges)
    wall = own.walls[0]
    needed = piecewise_extremes(lambda phi, side: own.on_wall(wall, phi, side)[3], contact.edges)
    return ElasticFollower(own, carried, leaps, TOUCH * needed.magnitude)
