"""Impedances along a train of masses, springs and dampers: force by displacement."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgeo.numeric.arrays import ComplexArray, IntArray
from camgeo.numeric.oscillator.train import EPS


@dataclass(frozen=True, slots=True, eq=False)
class Impedances:
    """Force by displacement, (q, n) each.

    Attributes
    ----------
    s : (q,).
    own : of the mass with what holds it to the frame.
    link : of the spring and damper in front of it.
    to_back : of the mass with all behind it.
    to_front : of the mass with all in front of it, the base at rest.
    """

    s: ComplexArray
    own: ComplexArray
    link: ComplexArray
    to_back: ComplexArray
    to_front: ComplexArray

    @property
    def whole(self) -> ComplexArray:
        """(q, n) force at a mass by its displacement, with the whole train around it."""
        found = self.to_front.copy()
        found[:, :-1] += in_series(self.link[:, 1:], self.to_back[:, 1:])
        return found

    def from_mass(self, mass: IntArray) -> tuple[ComplexArray, ComplexArray]:
        """(q, n) displacements while that of the `mass` (q,) is 1, and the x_i - x_{i-1}."""
        rows, count = np.arange(len(self.s)), self.own.shape[1]
        x = np.zeros_like(self.own)
        bent = np.zeros_like(self.own)
        x[rows, mass] = 1.0
        for i in range(1, count):
            behind = i > mass
            stretch = _divided(self.to_back[:, i], self.link[:, i] + self.to_back[:, i])
            share = _divided(self.link[:, i], self.link[:, i] + self.to_back[:, i])
            x[:, i] = np.where(behind, share * x[:, i - 1], x[:, i])
            bent[:, i] = np.where(behind, -stretch * x[:, i - 1], bent[:, i])
        for i in range(count - 1, 0, -1):
            ahead = i <= mass
            before = self.to_front[:, i - 1]
            stretch = _divided(before, self.link[:, i] + before)
            share = _divided(self.link[:, i], self.link[:, i] + before)
            x[:, i - 1] = np.where(ahead, share * x[:, i], x[:, i - 1])
            bent[:, i] = np.where(ahead, stretch * x[:, i], bent[:, i])
        bent[:, 0] = x[:, 0]
        return x, bent

    def from_base(self) -> tuple[ComplexArray, ComplexArray]:
        """(q, n) displacements while that of the base is 1, and the x_i - x_{i-1}."""
        total = self.link[:, 0] + self.to_back[:, 0]
        first = _divided(self.link[:, 0], total)
        x, bent = self.from_mass(np.zeros(len(self.s), dtype=np.intp))
        x, bent = first[:, np.newaxis] * x, first[:, np.newaxis] * bent
        bent[:, 0] = -_divided(self.to_back[:, 0], total)
        return x, bent


def _divided(a: ComplexArray, b: ComplexArray) -> ComplexArray:
    """a / b, with a tiny b for 0: an impedance that vanishes is one that nearly does."""
    found: ComplexArray = a / np.where(b == 0.0, EPS * EPS * np.maximum(np.abs(a), 1e-250), b)
    return found


def in_series(link: ComplexArray, load: ComplexArray) -> ComplexArray:
    """The impedance of a `link` with a `load` behind it, seen from in front of the link."""
    return link * _divided(load, link + load)
