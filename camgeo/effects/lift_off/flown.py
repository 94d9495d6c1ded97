"""What is known of a follower off the cam: where it leaves, its flights, and the cells of one."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np

from camgeo.effects.wording import missed
from camgeo.errors import EffectError
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.units import TURN

MOST_FLIGHTS: Final = 256
"""In these turns; more come from nodes that are too few."""

SAME: Final = 1e-11
"""Landings this close [rad], modulo a turn, are one place."""


UNSETTLED: Final = (
    "finer and finer steps come to no flights that stay the same: off the cam it moves too fast for"
    " them, or the smallest difference decides where it lands"
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
    left, met : the sides that it leaves and meets, see `camgeo.effects.touching`.
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
class Off:
    """The state of a free follower.

    Attributes
    ----------
    gap, rate : d [mm or rad] and its rate [per s].
    memory : (m,) z of the modes of the train that it carries, see
        `camgeo.effects.lift_off.carried`.
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
    for each in leavings:
        if each.wall != wall:
            continue
        ahead = (each.begin - angle) % TURN
        if TURN - ahead < each.end - each.begin:
            ahead = 0.0
        if angle + ahead < soonest[1]:
            soonest = each, angle + ahead
    return soonest


def in_turns(flown: list[Flight], turns: int) -> tuple[Flight, ...]:
    """All flights of so many `turns`, each begun in them, by ascending cam angle."""
    found = []
    for each in flown:
        shift = TURN * turns * math.floor(each.leaving / (TURN * turns))
        found.append(replace(each, leaving=each.leaving - shift, landing=each.landing - shift))
    return tuple(sorted(found, key=lambda each: each.leaving))


def with_bounces(flights: tuple[Flight, ...]) -> list[list[Flight]]:
    """Each flight, with the rebounds after it that stay behind it in speed and gap and end on the
    side where they begin.
    """
    first = next((k for k, each in enumerate(flights) if not each.rebound), 0)
    found: list[list[Flight]] = []
    for each in (*flights[first:], *flights[:first]):
        over = found[-1][0] if found else None
        if over is None or each.crossed or not each.rebound or not each.behind(over):
            found.append([each])
        else:
            found[-1].append(each)
    return found


def unsettled(error: float, tolerance: float) -> EffectError:
    """The exception for flights whose `error` exceeds the tolerance; 1 if nothing is known."""
    if error < 1.0:
        return missed("the impact speed of a flight", error, "itself", tolerance)
    return EffectError(UNSETTLED)


def apart(rough: Flight, fine: Flight) -> float:
    """The relative difference of gap, speed and energy; 1 if they end on different walls."""
    if rough.met != fine.met:
        return 1.0
    pairs = (rough.speed, fine.speed), (rough.gap, fine.gap)
    speed, gap = (abs(a - b) / max(a, b) if a != b else 0.0 for a, b in pairs)
    return max(2.0 * speed, gap)
