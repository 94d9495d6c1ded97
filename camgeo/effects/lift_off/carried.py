"""The elastic train that a follower carries along, off the cam and after it has landed.

The base of the train has the motion y = h + d, that of a follower on its flank and its gap, and the
train is linear. So its modes, which obey u' = lambda u - y'', are those of the steady state on h
and w besides, with

    w' = lambda w - d''.

With z = w + d' this is z' = lambda (z - d'), in which nothing jumps with d': an impact strikes the
follower in front of the train alone. Its first spring and damper push the follower back by the
force of the steady state and

    Re sum C (z - d') + a d + b d',

see `camgeo.numeric.oscillator.train`. On its flank, with d = 0, z decays freely.

In a cell of cam angle the equations in z and d are solved together at the nodes. With the matrix B
that integrates over time from the start of the cell, and S = (1 - lambda B)^-1,

    z = S (z_0 - lambda B d'),      Re sum C (z - d') = Re sum C S (z_0 - d').

(Collocation at Chebyshev nodes: J. P. Boyd, Chebyshev and Fourier Spectral Methods, chapter 4.)
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from camgeo.effects.elastic import ElasticTrain
from camgeo.effects.lift_off.cells import Nodes
from camgeo.effects.lift_off.flown import Cell, Off
from camgeo.motion.time_course import TimeCourse
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side


@dataclass(frozen=True, slots=True, eq=False)
class Carried:
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

    def moved(self, cell: Cell, over_time: FloatArray, off: Off) -> Moved:
        """How the follower moves with it in a `cell`, from the state `off` on; for `over_time` see
        `Moved`.
        """
        force, rates = self.behind.train.force(0), self.behind.train.rates
        one = np.eye(len(cell.phi))
        steps = one - rates[:, np.newaxis, np.newaxis] * over_time
        alone: ComplexArray = np.linalg.inv(steps).astype(np.complex128)
        of_each = force.weights[:, np.newaxis, np.newaxis] * alone
        per_rate = force.slope * one - np.sum(of_each.real, axis=0) + force.lift * over_time
        kept = np.tensordot(off.memory, of_each, 1).real
        still = np.sum(kept + off.rate * per_rate, axis=1) + force.lift * off.gap
        inverse = np.linalg.inv(np.diag(cell.mass) + per_rate @ over_time)
        return Moved(self, cell, off, inverse, still, over_time, alone)


@dataclass(frozen=True, slots=True, eq=False)
class Moved:
    """A follower with its train at the n nodes of a cell.

    Attributes
    ----------
    carried, cell, off : the train, the cell, and the state at its start.
    inverse : (n, n) from forces to d''.
    still : (n,) force of the train with d'' = 0 [N or N mm].
    over_time : (n, n) B [s].
    alone : (m, n, n) S.
    """

    carried: Carried
    cell: Cell
    off: Off
    inverse: FloatArray
    still: FloatArray
    over_time: FloatArray
    alone: ComplexArray

    def acceleration(self, push: FloatArray) -> FloatArray:
        """(n,) d'' with all other forces `push` (n,)."""
        return np.asarray(self.inverse @ (push - self.still))

    def memory(self, nodes: Nodes, rate: FloatArray) -> Callable[[float], ComplexArray]:
        """z (m,) as a function of the cam angle [rad] in the cell, with d' `rate` (n,)."""
        rates = self.carried.behind.train.rates[:, np.newaxis]
        forced = self.off.memory[:, np.newaxis] - rates * (self.over_time @ rate)
        z = np.einsum("mij,mj->mi", self.alone, forced)
        low, high = self.cell.ends
        half = 0.5 * (high - low)
        series = nodes.fit @ (half * rates * (z - rate) / self.cell.omega).T
        grown = np.polynomial.chebyshev.chebint(series, lbnd=-1.0)

        def at(angle: float) -> ComplexArray:
            place = (angle - low) / half - 1.0
            return np.asarray(self.off.memory + np.polynomial.chebyshev.chebval(place, grown))

        return at
