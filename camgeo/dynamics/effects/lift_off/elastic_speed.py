"""The speed at which a follower with an elastic train first leaves its flank, found without a gap.

It is searched from low speeds upwards, from an s = 1 / f at which no vibration can be large enough,
see "least reserve" below. Where the smallest reserve at two s exceeds
its fall between them, contact is kept at all speeds between. Close to the crossing the steps shrink
quadratically.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache
from typing import Final

import numpy as np

from camgeo.dynamics.effects.bearing_friction import unit_vectors
from camgeo.dynamics.effects.contact import TOUCH
from camgeo.dynamics.effects.effect import Quantity
from camgeo.dynamics.effects.forces import ElasticTrain, Force
from camgeo.dynamics.effects.lift_off.flank import Flank
from camgeo.kinematics.time_course import TimeCourse
from camgeo.numeric.arrays import SIDES, ComplexArray, FloatArray, Side
from camgeo.numeric.extremes import (
    Extreme,
    piecewise_extremes,
    piecewise_highest,
    piecewise_lowest,
    sample_grid,
)
from camgeo.units import TURN

SEARCHED: Final = 4.0
"""Speeds are searched up to this multiple of that of the scene and of the lift-off speed of a rigid
train, whichever is higher."""

MOST_STEPS: Final = 1500
"""Speeds at which the response is computed; the steps are about as wide as the damping ratio."""

CLOSE: Final = 1e-12
"""Relative distance of the speed of lift-off and that up to which contact is kept."""

ROOT: Final = 1e-13
"""Relative distance of two steps towards a crossing at which it is found."""

SLOPE_STEP: Final = 1e-6
"""Relative distance at which the slope of g is taken."""

OFFSETS: Final = (1e-6, 1e-4, 1e-2)
"""Relative distances at which a crossing is looked for beside a known one."""

GROWTH: Final = 4.0
"""Factor between a step and the next one at most."""

SAFE: Final = 0.8
"""Share of the widest step that the last one lets expect."""


@dataclass(frozen=True, slots=True)
class ElasticSpeed:
    """The outcome of the search for the lift-off speed.

    Attributes
    ----------
    speed : at which contact is first lost, as a factor of that of the scene, with the cam angle
        [rad]; None if it is kept as far as was searched.
    safe_factor : factor up to which contact is kept; 0 if none is.
    error : of `speed`.
    why : the search has ended before the end of its range; empty if it has not.
    """

    speed: Extreme | None = None
    safe_factor: float = 0.0
    error: float = 0.0
    why: str = ""

    @classmethod
    def searched(
        cls,
        flank: Flank,
        behind: ElasticTrain,
        edges: FloatArray,
        rigid: float,
        near: Extreme | None = None,
    ) -> ElasticSpeed:
        """The smallest speed at which the force on `flank` falls below its margin.

        Parameters
        ----------
        edges : (k,) cam angles [rad] from 0 to 2 pi between which the coefficients are smooth.
        rigid : the lift-off speed of a rigid train, as a factor of that of the scene.
        near : the speed at which a train that hardly differs leaves the flank: a crossing beside it
            is the first one too. None if none is known.
        """
        if np.max(behind.train.rates.real) >= 0.0:
            return cls(
                why="without damping the train resonates with a harmonic at ever lower speeds"
            )
        if behind.response.forcing.soft:
            return cls(why="the cam turns faster than the train vibrates")
        search = LeastReserve(flank, behind, edges)
        rest = piecewise_extremes(search.static, edges)
        if rest.lowest.value < -TOUCH * rest.magnitude:
            return cls(Extreme(0.0, rest.lowest.place))
        if rest.lowest.value <= TOUCH * rest.magnitude:
            return cls(why="nothing presses it on its flank at rest")
        swung = search.lowest_jump_reserve()
        if swung is not None and swung.value < -TOUCH * rest.magnitude:
            return cls(Extreme(0.0, swung.place))
        widest = piecewise_highest(search.share, edges).value
        search = replace(search, widest=widest, largest=piecewise_highest(search.most, edges).value)
        crossing = (
            _crossing_near(search, 1.0 / near.value) if near is not None and near.value else None
        )
        if crossing is not None:
            return crossing
        # A rigid train that never leaves the flank sets no limit of its own.
        most = SEARCHED * max(1.0, rigid if np.isfinite(rigid) else 1.0)
        # At higher speeds the forcing would be of another kind, see `SOFT`.
        end = 1.0 / min(most, behind.response.fastest)
        start = search.start(rest.lowest.value)
        if start is None:
            return cls(why="where its load jumps the train may vibrate off it at any speed")
        return _first(search, max(start, 2.0 * end), end)


def _first(search: LeastReserve, start: float, end: float) -> ElasticSpeed:
    """The first crossing, from `start` down to `end`."""
    held, lost = search.evaluate(start), None
    step = 0.5 * (start - end)
    for _ in range(MOST_STEPS):
        trial = search.evaluate(max(held.s - step, end))
        if trial.lost:
            # The crossing is known; now the steps have to show that contact is kept right up to it.
            lost = _crossing(search, held, trial)
            step = 0.5 * (held.s - lost.s)
            continue
        least, sag = min(held.floor, trial.floor), search.sag(held, trial)
        # The lower bounds of g do not suffice here: the exact values may.
        if sag >= least:
            least = min(held.g, trial.g)
        # The sag goes with the square of the step.
        step = (held.s - trial.s) * min(SAFE * math.sqrt(least / sag), GROWTH)
        if sag >= least:
            continue
        if trial.s <= end:
            return ElasticSpeed(safe_factor=1.0 / end)
        per_square = sag / (held.s - trial.s) ** 2
        held = trial
        if lost is None:
            continue
        gap = held.s - lost.s
        if gap <= CLOSE * lost.s:
            return _crossing_result(search, held, lost)
        # The smaller g of the next step is then twice what the chord sags there.
        near = 2.0 * per_square * gap**2 / (held.g / gap)
        step = gap - min(max(near, 0.5 * CLOSE * lost.s), 0.5 * gap)
    why = "its damping is so small that its resonances are too narrow to be searched one by one"
    return ElasticSpeed(safe_factor=1.0 / held.s, why=why)


def _crossing_near(search: LeastReserve, s: float) -> ElasticSpeed | None:
    """The crossing near `s`; None if there is none."""
    for offset in OFFSETS:
        held, lost = (search.evaluate(s * (1.0 + sign * offset)) for sign in (1.0, -1.0))
        if held.g > 0.0 >= lost.g:
            return _crossing_result(search, held, _crossing(search, held, lost))
    return None


def _crossing(search: LeastReserve, held: Point, lost: Point) -> Point:
    """The point between `held` and `lost` where g is 0, by secants in a bracket (the Illinois
    method).
    """
    ends = [(held.s, held.g), (lost.s, lost.g)]
    point = lost
    for _ in range(MOST_STEPS):
        (a, at_a), (b, at_b) = ends
        if abs(a - b) <= ROOT * lost.s:
            break
        s = a - at_a * (a - b) / (at_a - at_b)
        previous, point = point, search.evaluate(s)
        if abs(point.s - previous.s) <= ROOT * lost.s or point.g == 0.0:
            break
        if (point.g > 0.0) == (at_b > 0.0):
            # Halving the value of the end that stays makes the secant pass the root.
            ends = [(a, 0.5 * at_a), (s, point.g)]
        else:
            ends = [(b, at_b), (s, point.g)]
    return point


def _crossing_result(search: LeastReserve, held: Point, lost: Point) -> ElasticSpeed:
    """The crossing at `lost`, with contact kept up to the point `held` just before it."""
    neighbour = search.evaluate(lost.s * (1.0 + SLOPE_STEP))
    slope = abs(neighbour.g - lost.g) / (neighbour.s - lost.s)
    train = search.behind.with_speed_factor(1.0 / lost.s)
    error = search.widest * train.error / slope + (held.s - lost.s)
    speed = Extreme(1.0 / lost.s, lost.lowest.place)
    return ElasticSpeed(speed, 1.0 / held.s, speed.value * error / lost.s)


# -- least reserve --------------------------------------------------------------------------------
# The reserve of the contact before an elastic train at any speed, and its fall between two speeds.
#
# With the cam running f times as fast as in the scene, and s = 1 / f, the reserve of the contact
# (see `Flank.reserve`), divided by f^2, is
#
#     G = s^2 r0 + s r1 + r2 + w P + c sum |V_i|,    V_i = s^2 l0 + s l1 + l2 - p P,
#     P = s^2 (a y + f) + s b y' + s Re sum C u + s^3 Re sum D v - m y'',
#     u' = s lambda u - y'',   v' = s lambda v + f,
#
# with r0 to r2 and the loads l0 to l2 that rub in pivot or guide of a rigid train, whose friction
# is c, the modes u and v of the elastic one, the weights C, D, a and b of the force in its first
# spring and damper, see `camgeo.dynamics.oscillator.train`, the force f on its output, w = dy/dq in
# the direction of the flank, and p the load that a coupler makes of a force on y; a and b are 0
# unless something holds its masses to the frame. Contact is lost where the smallest G of the turn,
# g(s), is below 0. At rest v is -f / (s lambda), but where f jumps the train vibrates at any speed.
#
# On the real line the periodic solution of v' = s lambda v + b is at most |b| / (s |Re lambda|).
# For the derivatives of u by s, v' = s lambda v + lambda u and z' = s lambda z + 2 lambda v, this
# gives |v| <= rho |u| / s and |z| <= 2 rho^2 |u| / s^2 with rho = |lambda| / |Re lambda|, so
#
#     d^2 G / ds^2 <= K = 2 max (r0 + w (a y + f)) + 2 max |c| sum |l0 - p (a y + f)|
#                         + max (|w| + |c p|) (sum |C| (2 rho + 2 rho^2) |u| / s
#                                              + sum |D| (6 + 6 rho + 2 rho^2) |v| s)
#
# as long as no V_i turns. Between two s at the distance d a function is nowhere more than K d^2 / 8
# below its chord. A |V_i| that turns falls below its chord besides; where c > 0, it is at least the
# part of V_i in any one direction, here that of its sum at both ends, and what this lacks of |V_i|
# at an end, which goes with the square of the angle, is added. Where the smaller of both g is
# larger than this, contact is kept at all speeds between: no resonance, however narrow, is stepped
# over (bounds of this kind: S. A. Piyavskii, USSR Comput. Math. Math. Phys. 12 (1972) 57-67, with
# first derivatives). In the interval |u| is at most that at its ends times 1 + rho d / (2 s),
# because the difference of two u obeys the same equation with b = (s_1 - s_0) lambda u_0.


FARTHER: Final = 4.0
"""Factor between two s from which a search may begin."""


@dataclass(frozen=True, slots=True, eq=False)
class Point:
    """A number below g at one s, |u| and |v| of each mode, the V_i (k, n), and what finds g."""

    s: float
    floor: float
    sizes: FloatArray
    loaded: FloatArray
    loads: Callable[[FloatArray, Side], ComplexArray]
    find: Callable[[], Extreme]

    @property
    def lowest(self) -> Extreme:
        """g, with its place."""
        return self.find()

    @property
    def g(self) -> float:
        return self.lowest.value

    @property
    def lost(self) -> bool:
        """Whether g is not above 0."""
        return self.floor <= 0.0 and self.g <= 0.0


def ceiling(function: Quantity, edges: FloatArray) -> float:
    """A bound of the largest value, for much less: nothing is refined, and each point of the grid
    counts with the larger of the steps to its neighbours, eight times what a parabola may rise.
    """
    grid = sample_grid(edges)
    values = function(grid.ravel(), "right").reshape(grid.shape)
    # (k, n + 1) steps to the left and to the right of each point; none at the ends of a row.
    steps = np.pad(np.abs(np.diff(values, axis=1)), ((0, 0), (1, 1)))
    inside = values + np.maximum(steps[:, :-1], steps[:, 1:])
    ends = function(edges[:-1], "right"), function(edges[1:], "left")
    return float(max(np.max(part) for part in (inside, *ends)))


@dataclass(frozen=True, slots=True, eq=False)
class LeastReserve:
    """g(s), and what bounds it.

    Attributes
    ----------
    flank : on which the follower must stay.
    behind : the elastic train.
    edges : (k,) cam angles [rad] from 0 to 2 pi between which the coefficients are smooth.
    widest, largest : the largest `share` and `most`.
    """

    flank: Flank
    behind: ElasticTrain
    edges: FloatArray
    widest: float = 0.0
    largest: float = 0.0

    def weight(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) w."""
        return self.flank.known(phi, side).outwards * self.behind.per_lift(phi, side)

    def share(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) |w| + |c p|: of P in G at most."""
        passed = np.sum(np.abs(self.flank.passed(phi, side, np.ones(len(phi)))), axis=0)
        return np.asarray(
            np.abs(self.behind.per_lift(phi, side))
            + np.abs(self.flank.known(phi, side).drag) * passed
        )

    def parts(
        self, phi: FloatArray, side: Side, share: float = 1.0, more: FloatArray | float = 0.0
    ) -> tuple[FloatArray, FloatArray]:
        """(3, n) r0 + w (a y + f), r1 + w b y', r2 - w m y'', and |c| sum |l0 - p (a y + f)| and
        so on, with the `share` of f, and `more` (n,) besides.
        """
        held, load = self.behind.train.force(0), self.behind.load
        # Of y, y' and y'': what holds the masses to the frame, and their inertia.
        base_weights = np.array([[held.lift], [held.slope], [-self.behind.mass]])
        pushed = base_weights * self.behind.base(phi, side)
        if load is not None:
            pushed[0] += share * load.coefficients(phi, side)[0] + more
        passed = [self.flank.passed(phi, side, push) for push in pushed]
        loads = self.flank.known(phi, side).loads - np.stack(passed)
        rubbed = np.abs(self.flank.known(phi, side).drag) * np.sum(np.abs(loads), axis=1)
        return self.flank.known(phi, side).needed + self.weight(phi, side) * pushed, rubbed

    @property
    def weights(self) -> FloatArray:
        """(m,) |C|."""
        return np.abs(self.behind.train.force(0).weights)

    @property
    def rho(self) -> FloatArray:
        """(m,) of the modes."""
        rates = self.behind.train.rates
        return np.asarray(np.abs(rates) / np.abs(rates.real))

    def static(self, phi: FloatArray, side: Side, more: FloatArray | float = 0.0) -> FloatArray:
        """(n,) the reserve at rest, with `more` (n,) of P."""
        train = self.behind.train
        plain, rubbed = self.parts(phi, side, 1.0 + train.yielding(train.force(0)), more)
        return np.asarray(plain[0] + np.sign(self.flank.known(phi, side).drag) * rubbed[0])

    def most(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) r0 + w (a y + f) + |c| sum |l0 - p (a y + f)|."""
        plain, rubbed = self.parts(phi, side)
        return np.asarray(plain[0] + rubbed[0])

    def evaluate(self, s: float) -> Point:
        train = self.behind.with_speed_factor(1.0 / s)

        def reserve(phi: FloatArray, side: Side) -> FloatArray:
            push = train.beyond_base(phi, side)
            more = self.flank.passed(phi, side, push / s**2)
            r0, r1, r2 = self.flank.reserve(phi, side, 1.0 / s, more)
            return np.asarray(s * (s * r0 + r1) + r2 - self.weight(phi, side) * push)

        def loads(phi: FloatArray, side: Side) -> ComplexArray:
            l0, l1, l2 = self.flank.known(phi, side).loads
            passed = self.flank.passed(phi, side, train.beyond_base(phi, side))
            return np.asarray(s * (s * l0 + l1) + l2 + passed)

        edges = train.edges(self.edges)
        # A bound that costs little; the exact minimum is only searched for where the bound is not
        # enough.
        floor = -ceiling(lambda phi, side: -reserve(phi, side), edges)
        find = cache(lambda: piecewise_lowest(reserve, edges))
        sizes = np.array([mode.largest for mode in train.response.modes])
        # driven by s^2 f
        loaded = np.array([mode.largest for mode in train.response.loaded]) / s**2
        return Point(s, floor, sizes, loaded, loads, find)

    def turned(self, one: Point, other: Point) -> float:
        """Upper bound of what the loads lack of their magnitudes in the direction of their sum,
        where their friction helps the contact.
        """
        if self.flank.contact.bearings is None:
            return 0.0

        def lacking(phi: FloatArray, side: Side) -> FloatArray:
            helping = np.maximum(self.flank.known(phi, side).drag, 0.0)
            both = [point.loads(phi, side) for point in (one, other)]
            d = unit_vectors(both[0] + both[1], np.ones_like(both[0]))
            # |V| - Re(conj(d) V) = |V| |V / |V| - d|^2 / 2
            deficits = [np.abs(v) * np.abs(unit_vectors(v, d) - d) ** 2 for v in both]
            return np.asarray(0.5 * helping * np.max(np.sum(deficits, axis=1), axis=0))

        return ceiling(lacking, self.edges)

    def sag(self, one: Point, other: Point) -> float:
        """How far g may be below its chord between the points `one` and `other`."""
        s, d = min(one.s, other.s), abs(one.s - other.s)
        rho = self.rho
        # Between both points |u| exceeds that at them by no more than this factor.
        grown = 1.0 + 0.5 * rho * d / s
        sizes = np.maximum(one.sizes, other.sizes) * grown
        bend = float(np.sum(self.weights * (2.0 * rho + 2.0 * rho**2) * sizes)) / s
        if self.behind.load is not None:
            loaded = np.maximum(one.loaded, other.loaded) * grown
            turned = pressed(self.behind) * (6.0 + 6.0 * rho + 2.0 * rho**2) * loaded
            bend += float(np.sum(turned)) * max(one.s, other.s)
        curvature = 2.0 * self.largest + self.widest * bend
        return 0.125 * curvature * d * d + self.turned(one, other)

    def lowest_jump_reserve(self) -> Extreme | None:
        """The smallest reserve that is found after a jump of f, at rest else, with its place."""
        smallest: Extreme | None = None
        for place, more in swings(self.behind):
            left = self.static(np.full(len(more), place), "right", more)
            lowest = float(np.min(left))
            if smallest is None or lowest < smallest.value:
                smallest = Extreme(lowest, place)
        return smallest

    def remaining_reserve(self, least: float, s: float) -> float:
        """Lower bound of what the jumps of f leave of the reserve at rest, which is at least
        `least`.
        """
        course = self.flank.subject.state.course
        if self.behind.load is None or course is None:
            return least
        swing = struck(self.behind, s, course)

        def left(phi: FloatArray, side: Side) -> FloatArray:
            return np.asarray(self.static(phi, side) - self.share(phi, side) * swing(phi, side))

        return piecewise_lowest(left, self.edges).value

    def start(self, least: float) -> float | None:
        """An s from which on no vibration makes up for the reserve at rest, at least `least`; None
        if the jumps of f may always do.

        |s C u| is at most |C| (|y''| / |Re lambda| + s J / (1 - exp(s Re lambda T))), with the sum
        J of the jumps of y'.
        """
        if self.remaining_reserve(least, SLOWEST) <= 0.0:
            return None
        train, forcing = self.behind.train, self.behind.response.forcing
        period, c = self.behind.response.base.period, self.weights
        most = float(np.max(np.sum(np.abs(forcing.pieces.series), axis=0)))
        jumps = float(np.sum(np.abs(forcing.jumps)))

        def size(row: int) -> float:
            def of_row(phi: FloatArray, side: Side) -> FloatArray:
                plain, rubbed = self.parts(phi, side)
                return np.asarray(np.abs(plain[row]) + rubbed[row])

            return piecewise_highest(of_row, self.edges).value

        r1, r2, s = size(1) + self.widest * drifting(self.behind), size(2), 1.0
        while True:
            # What is left of a jump adds up over all turns before.
            lasting = 1.0 / -np.expm1(s * train.rates.real * period)
            moved = float(np.sum(c * (most / -train.rates.real + s * jumps * lasting)))
            remaining = self.remaining_reserve(least, s)
            if s * (s * remaining - r1) - r2 - self.widest * moved > 0.0:
                return s
            s *= FARTHER


# -- load swing -----------------------------------------------------------------------------------
# How a load on its output swings an elastic train at low speeds, where the search starts.
#
# In the notation of that module, v' = s lambda v + f: with v = -f / (s lambda) + z,
#
#     z' = s lambda z + f' / (s lambda),
#
# and where f jumps by J, z jumps by J / (s lambda). The slower the cam, the less is left of a jump
# when the next one comes; but right behind it P has s^2 Re sum D J / lambda at any speed.


SLOWEST: Final = 1e200
"""An s at which each vibration has decayed before the next one begins."""

SAMPLES: Final = 32
"""Times a period at which a vibration is looked at."""

MOST_PERIODS: Final = 128
"""Periods of the fastest mode of which this is done at most."""


def pressed(behind: ElasticTrain) -> FloatArray:
    """(m,) |D|."""
    return np.abs(behind.train.force(0).loaded)


def drifting(behind: ElasticTrain) -> float:
    """sum |D z| s^2 at most, but for what the jumps of f leave."""
    load, rates = behind.response.load, behind.train.rates
    if load is None:
        return 0.0
    scales = np.abs(rates) * -rates.real
    return float(np.sum(pressed(behind) / scales)) * load.pieces.steepest


def load_jumps(load: Force) -> FloatArray:
    """(k,) jump of f at each of its borders [N or N mm]."""
    left, right = (load.coefficients(load.borders, side)[0] for side in SIDES)
    return np.asarray(right - left)


def struck(behind: ElasticTrain, s: float, clock: TimeCourse) -> Quantity:
    """(n,) sum |D z| s that the jumps of f leave, at most, with the cam turning as in `clock`: each
    decays until the others, and until itself a turn later.
    """
    load, rates, period = behind.load, behind.train.rates, behind.response.base.period
    if load is None:
        return lambda phi, _side: np.zeros(len(phi))
    sizes, jump_times = np.abs(load_jumps(load)), clock.time(load.borders)

    def left(phi: FloatArray, side: Side) -> FloatArray:
        since = clock.time(phi)[:, np.newaxis] - jump_times
        # A jump later in the turn has happened in the turn before.
        since[since < 0.0 if side == "right" else since <= 0.0] += period
        swing = np.zeros(len(phi))
        for weight, rate in zip(pressed(behind) / np.abs(rates), rates.real, strict=True):
            decayed = np.exp(s * rate * since) @ sizes
            swing += weight * decayed / -np.expm1(s * rate * period)
        return swing

    return left


def swings(behind: ElasticTrain) -> Iterator[tuple[float, FloatArray]]:
    """The place [rad] of each border of f, and (k,) what P / s^2 has more behind it than at rest,
    Re sum D J / lambda exp(lambda t), over a period of the slowest mode.
    """
    load, rates = behind.load, behind.train.rates
    if load is None:
        return
    swing = TURN / float(np.min(np.abs(rates)))
    periods = min(float(np.max(np.abs(rates))) * swing / TURN, MOST_PERIODS)
    times = np.linspace(0.0, swing, SAMPLES * math.ceil(periods) + 1)
    shapes = behind.train.force(0).loaded / rates
    free = np.real(np.exp(np.multiply.outer(times, rates)) @ shapes)
    for place, jump in zip(load.borders.tolist(), load_jumps(load).tolist(), strict=True):
        yield place, jump * free
