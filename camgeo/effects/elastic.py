"""The force that an elastic train passes to the follower, beyond that of a rigid one.

The base of the train has the motion y of the output of a rigid train, on the follower. Its first
spring and damper push the masses with the force F, which accelerates them all and moves what holds
them to the frame, against the load p on the output, and push back the base as much. Forces of a
rigid train have -m y'' of the masses and p instead, m in sum. So the generalised force on the
follower is that of a rigid train and

    Q = -(F - m y'' + p) dy/dq,

known for the present course of the cam in time only: the state of a train depends on how the cam
has turned before. Springs and weights act on the base, so they do not excite the train.

With the cam running f times as fast, in the time of the scene, the train is one whose rates are
divided by f, on the same base; forces are then f^2 times those in that time.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from camgeo.effects.force import Force, unmoved
from camgeo.numeric.arrays import FloatArray, Side, merged
from camgeo.numeric.oscillator.steady import Response, answered
from camgeo.numeric.oscillator.train import Train
from camgeo.units import TURN

if TYPE_CHECKING:
    from camgeo.effects.effect import Quantity

MOST_PERIODS: Final = 4096
"""Periods per turn up to which each period is searched for extremes. Beyond this, the samples of a
lasting vibration cover all its phases, and a decaying one is searched where it begins.
"""

RUNGS: Final = 8
"""In an octave: numbers of periods between two rungs have the edges of the upper one, so that those
of neighbouring speeds are the same."""

BEGINNING: Final = np.array([1.0, 2.0])
"""Periods after each border that are then searched separately."""


def search_edges(smooth: FloatArray, train: Train | None, period: float) -> FloatArray:
    """The edges between which extremes are searched for, at most a period of the train apart."""
    if train is None:
        return smooth
    periods = float(np.max(train.rates.imag)) * period / TURN
    if not periods > 1.0:
        return smooth
    rung = math.ceil(RUNGS * math.log2(min(periods, MOST_PERIODS)))
    count = math.ceil(2.0 ** (rung / RUNGS))
    edges = np.concatenate((smooth, np.linspace(0.0, TURN, count + 1)))
    if periods > MOST_PERIODS:
        begin = (smooth[:-1, np.newaxis] + BEGINNING * (TURN / periods)).ravel()
        edges = np.concatenate((edges, begin[begin < TURN]))
    return merged(edges)


@dataclass(frozen=True, slots=True, eq=False)
class ElasticTrain:
    """What is behind the train, at some speed.

    Attributes
    ----------
    response : in the time of the scene.
    mass : behind the train, as far as forces of a rigid train have it [t, or t mm^2 if it turns].
    per_lift : (n,) dy/dq [1, 1/mm or mm].
    pushes : (n,) F [N or N mm] of a response at n cam angles, in the time of the scene.
    base : (3, n) y, y', y'' at n cam angles, in the time of the scene.
    load : p, as a force on y; None if there is none.
    slips : (n,) velocity of the output beyond y' of a response, as `pushes`; None without a load.
    """

    response: Response
    mass: float
    per_lift: Quantity
    pushes: Callable[[Response, FloatArray, Side], FloatArray]
    base: Quantity
    load: Force | None = None
    slips: Callable[[Response, FloatArray, Side], FloatArray] | None = None

    def beyond_rigid(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) Q [N or N mm]."""
        return self.beyond_base(phi, side) * self.per_lift(phi, side)

    def beyond_base(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) -(F - m y'' + p) [N or N mm], on the base."""
        push = self.pushes(self.response, phi, side)
        if self.load is not None:
            push = push + self.load.coefficients(phi, side)[0]
        return np.asarray(self.mass * self.base(phi, side)[2] - push)

    def given(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) power [N mm/s] that the load takes from the train beyond -p y', which it has from a
        rigid one.
        """
        if self.load is None or self.slips is None:
            return np.zeros(len(phi))
        pressed = self.load.coefficients(phi, side)[0]
        return np.asarray(-pressed * self.slips(self.response, phi, side))

    def reduced(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) m (dy/dq)^2, the part of `Inertia.to_follower` that is behind the train."""
        way = self.per_lift(phi, side)
        return self.mass * way * way

    @property
    def error(self) -> float:
        """Estimate of the error of F [N or N mm]."""
        return self.response.error_of(self.train.force(0))

    @property
    def train(self) -> Train:
        """Its modes."""
        return self.response.train

    def edges(self, smooth: FloatArray) -> FloatArray:
        """(k,) cam angles [rad] between which F is searched for extremes."""
        return search_edges(smooth, self.train, self.response.base.period)

    def force(self, smooth: FloatArray) -> Force:
        """Q, which is smooth between the angles `smooth` (m,) [rad] and the borders of the load."""
        cuts = self.edges(smooth)
        return Force(
            "the elastic train",
            unmoved(self.beyond_rigid),
            borders=np.empty(0) if self.load is None else self.load.borders,
            cuts=cuts,
            present=True,
            far=unmoved(self.beyond_base),
        )

    def off(self, demand: Quantity) -> tuple[ElasticTrain, ElasticTrain]:
        """The same with F off by its error, so that the contact carries more everywhere, where it
        must provide the generalised force `demand`; and so that the drive puts in more.

        A force of the contact or a load follows from F at the same cam angle, and a sum of such
        forces or of powers over the turn is off most where all of them are off to the same side.
        """

        def pressing(phi: FloatArray, side: Side) -> FloatArray:
            return np.asarray(demand(phi, side) * self.per_lift(phi, side))

        def driving(phi: FloatArray, side: Side) -> FloatArray:
            return np.asarray(self.base(phi, side)[1])

        return self._off(pressing), self._off(driving)

    def _off(self, way: Quantity) -> ElasticTrain:
        """With F off by its error in the direction of `way`."""

        def pushes(response: Response, phi: FloatArray, side: Side) -> FloatArray:
            error = response.error_of(response.train.force(0))
            return self.pushes(response, phi, side) + error * np.sign(way(phi, side))

        return replace(self, pushes=pushes)

    def at(self, factor: float) -> ElasticTrain:
        """The same with the cam running `factor` times as fast as in `response`."""
        response, load, once = self.response, self.load, factor**-2
        forced = None if response.load is None else response.load.times(once)
        if load is not None:
            pressed = load.coefficients
            load = replace(load, coefficients=lambda phi, side: once * pressed(phi, side))
        train = self.train.in_time(factor)
        found = answered(train, response.base, response.forcing, forced)
        return replace(self, response=found, load=load)
