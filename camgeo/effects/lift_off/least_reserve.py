"""The reserve of the contact before an elastic train at any speed, and its fall between two speeds.

With the cam running f times as fast as in the scene, and s = 1 / f, the reserve of the contact (see
`Flank.reserve`), divided by f^2, is

    G = s^2 r0 + s r1 + r2 + w P + c sum |V_i|,    V_i = s^2 l0 + s l1 + l2 - p P,
    P = s^2 (a y + f) + s b y' + s Re sum C u + s^3 Re sum D v - m y'',
    u' = s lambda u - y'',   v' = s lambda v + f,

with r0 to r2 and the loads l0 to l2 that rub in pivot or guide of a rigid train, whose friction is
c, the modes u and v of the elastic one, the weights C, D, a and b of the force in its first spring
and damper, see `camgeo.numeric.oscillator.train`, the force f on its output, w = dy/dq in the
direction of the flank, and p the load that a coupler makes of a force on y; a and b are 0 unless
something holds its masses to the frame. Contact is lost where the smallest G of the turn, g(s), is
below 0. At rest v is -f / (s lambda), but where f jumps the train vibrates at any speed.

On the real line the periodic solution of v' = s lambda v + b is at most |b| / (s |Re lambda|). For
the derivatives of u by s, v' = s lambda v + lambda u and z' = s lambda z + 2 lambda v, this gives
|v| <= rho |u| / s and |z| <= 2 rho^2 |u| / s^2 with rho = |lambda| / |Re lambda|, so

    d^2 G / ds^2 <= K = 2 max (r0 + w (a y + f)) + 2 max |c| sum |l0 - p (a y + f)|
                        + max (|w| + |c p|) (sum |C| (2 rho + 2 rho^2) |u| / s
                                             + sum |D| (6 + 6 rho + 2 rho^2) |v| s)

as long as no V_i turns. Between two s at the distance d a function is nowhere more than K d^2 / 8
below its chord. A |V_i| that turns falls below its chord besides; where c > 0, it is at least the
part of V_i in any one direction, here that of its sum at both ends, and what this lacks of |V_i| at
an end, which goes with the square of the angle, is added. Where the smaller of both g is larger
than this, contact is kept at all speeds between: no resonance, however narrow, is stepped over
(bounds of this kind: S. A. Piyavskii, USSR Comput. Math. Math. Phys. 12 (1972) 57-67, with first
derivatives). In the interval |u| is at most that at its ends times 1 + rho d / (2 s), because the
difference of two u obeys the same equation with b = (s_1 - s_0) lambda u_0.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np

from camgeo.effects.bearing_friction import unit_vectors
from camgeo.effects.elastic import ElasticTrain
from camgeo.effects.lift_off.flank import Flank
from camgeo.effects.lift_off.load_swing import SLOWEST, drifting, pressed, struck, swings
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side
from camgeo.numeric.extremes import Extreme, ceiling, piecewise_highest, piecewise_lowest

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
        return self.flank.outwards(phi, side) * self.behind.per_lift(phi, side)

    def share(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) |w| + |c p|: of P in G at most."""
        passed = np.sum(np.abs(self.flank.passed(phi, side, np.ones(len(phi)))), axis=0)
        return np.asarray(
            np.abs(self.behind.per_lift(phi, side)) + np.abs(self.flank.drag(phi, side)) * passed
        )

    def parts(
        self, phi: FloatArray, side: Side, share: float = 1.0, more: FloatArray | float = 0.0
    ) -> tuple[FloatArray, FloatArray]:
        """(3, n) r0 + w (a y + f), r1 + w b y', r2 - w m y'', and |c| sum |l0 - p (a y + f)| and
        so on, with the `share` of f, and `more` (n,) besides.
        """
        held, load = self.behind.train.force(0), self.behind.load
        own = np.array([[held.lift], [held.slope], [-self.behind.mass]])
        pushed = own * self.behind.base(phi, side)
        if load is not None:
            pushed[0] += share * load.coefficients(phi, side)[0] + more
        passed = [self.flank.passed(phi, side, push) for push in pushed]
        loads = self.flank.loads(phi, side) - np.stack(passed)
        rubbed = np.abs(self.flank.drag(phi, side)) * np.sum(np.abs(loads), axis=1)
        return self.flank.plain(phi, side)[0] + self.weight(phi, side) * pushed, rubbed

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
        return np.asarray(plain[0] + np.sign(self.flank.drag(phi, side)) * rubbed[0])

    def most(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) r0 + w (a y + f) + |c| sum |l0 - p (a y + f)|."""
        plain, rubbed = self.parts(phi, side)
        return np.asarray(plain[0] + rubbed[0])

    def at(self, s: float) -> Point:
        found = self.behind.at(1.0 / s)

        def reserve(phi: FloatArray, side: Side) -> FloatArray:
            push = found.beyond_base(phi, side)
            more = self.flank.passed(phi, side, push / s**2)
            r0, r1, r2 = self.flank.reserve(phi, side, 1.0 / s, more)
            return np.asarray(s * (s * r0 + r1) + r2 - self.weight(phi, side) * push)

        def loads(phi: FloatArray, side: Side) -> ComplexArray:
            l0, l1, l2 = self.flank.loads(phi, side)
            passed = self.flank.passed(phi, side, found.beyond_base(phi, side))
            return np.asarray(s * (s * l0 + l1) + l2 + passed)

        edges = found.edges(self.edges)
        floor = -ceiling(lambda phi, side: -reserve(phi, side), edges)
        find = cache(lambda: piecewise_lowest(reserve, edges))
        sizes = np.array([mode.largest for mode in found.response.modes])
        # driven by s^2 f
        loaded = np.array([mode.largest for mode in found.response.loaded]) / s**2
        return Point(s, floor, sizes, loaded, loads, find)

    def turned(self, one: Point, other: Point) -> float:
        """What the loads lack of their sizes in the direction of their sum at most, where that
        counts.
        """
        if self.flank.contact.bearings is None:
            return 0.0

        def lacking(phi: FloatArray, side: Side) -> FloatArray:
            helping = np.maximum(self.flank.drag(phi, side), 0.0)
            both = [each.loads(phi, side) for each in (one, other)]
            d = unit_vectors(both[0] + both[1], np.ones_like(both[0]))
            # |V| - Re(conj(d) V) = |V| |V / |V| - d|^2 / 2
            each = [np.abs(v) * np.abs(unit_vectors(v, d) - d) ** 2 for v in both]
            return np.asarray(0.5 * helping * np.max(np.sum(each, axis=1), axis=0))

        return ceiling(lacking, self.edges)

    def sag(self, one: Point, other: Point) -> float:
        """How far g may be below its chord between both."""
        s, d = min(one.s, other.s), abs(one.s - other.s)
        rho = self.rho
        grown = 1.0 + 0.5 * rho * d / s
        sizes = np.maximum(one.sizes, other.sizes) * grown
        bend = float(np.sum(self.weights * (2.0 * rho + 2.0 * rho**2) * sizes)) / s
        if self.behind.load is not None:
            loaded = np.maximum(one.loaded, other.loaded) * grown
            turned = pressed(self.behind) * (6.0 + 6.0 * rho + 2.0 * rho**2) * loaded
            bend += float(np.sum(turned)) * max(one.s, other.s)
        curvature = 2.0 * self.largest + self.widest * bend
        return 0.125 * curvature * d * d + self.turned(one, other)

    def after_jumps(self) -> Extreme | None:
        """The smallest reserve that is found after a jump of f, at rest else, with its place."""
        found: Extreme | None = None
        for place, more in swings(self.behind):
            left = self.static(np.full(len(more), place), "right", more)
            lowest = float(np.min(left))
            if found is None or lowest < found.value:
                found = Extreme(lowest, place)
        return found

    def kept(self, least: float, s: float) -> float:
        """What of the reserve at rest, at least `least`, the jumps of f leave at most."""
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
        if self.kept(least, SLOWEST) <= 0.0:
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
            lasting = 1.0 / -np.expm1(s * train.rates.real * period)
            moved = float(np.sum(c * (most / -train.rates.real + s * jumps * lasting)))
            kept = self.kept(least, s)
            if s * (s * kept - r1) - r2 - self.widest * moved > 0.0:
                return s
            s *= FARTHER
