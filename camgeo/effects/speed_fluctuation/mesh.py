"""Cells of a turn with the cam's law at their nodes, halved where it is asked for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np

from camgeo.motion.motion import Side
from camgeo.numeric.arrays import BoolArray, FloatArray

NODES: Final = 8
"""Radau IIA nodes of a cell, its end among them: collocation of order 15 at the ends of cells that
stays sound with a motor so stiff that the speed follows at once (Hairer and Wanner, Solving
Ordinary Differential Equations II, section IV.5)."""


Law = Callable[[FloatArray, Side], FloatArray]
"""(n,) cam angles [rad], side -> (6, n), see `camgeo.effects.speed_fluctuation.rate`."""


@dataclass(frozen=True, slots=True, eq=False)
class Rule:
    """Collocation: all lengths are shares of the cell's.

    Attributes
    ----------
    nodes, weights : (n,) nodes in (0, 1], the last one 1.
    integral : (n, n) from rates at the nodes to the integral from the start to each node.
    fit : (n + 1, n + 1) from values at the start and at the nodes to Legendre's coefficients of the
        polynomial through them.
    halves : (2, n, n + 1) from the same to the values at the nodes of either half of the cell.
    """

    nodes: FloatArray
    weights: FloatArray
    integral: FloatArray
    fit: FloatArray
    halves: FloatArray


@lru_cache(maxsize=1)
def rule() -> Rule:
    """The rule of `NODES` nodes: the zeros of P_n - P_(n - 1), Legendre's polynomials."""
    series = np.zeros(NODES + 1)
    series[-2:] = -1.0, 1.0
    x = np.sort(np.polynomial.legendre.legroots(series).real)  # complex in type with numpy 2.5
    slope = np.polynomial.legendre.legder(series)
    for _ in range(2):  # Newton's steps to the last digits
        x = x - np.polynomial.legendre.legval(x, series) / np.polynomial.legendre.legval(x, slope)
    x[-1] = 1.0
    from_rates = np.linalg.inv(legendre(x, NODES - 1))
    integral = np.asarray(0.5 * _antiderivatives(x) @ from_rates, dtype=np.float64)
    fit = np.asarray(np.linalg.inv(legendre(np.append(-1.0, x), NODES)), dtype=np.float64)
    halves = np.stack([legendre(0.5 * (x + shift), NODES) @ fit for shift in (-1.0, 1.0)])
    return Rule(0.5 * (x + 1.0), integral[-1], integral, fit, halves)


def legendre(x: FloatArray, order: int) -> FloatArray:
    """(n, order + 1) Legendre's polynomials at `x` (n,) in [-1, 1]."""
    return np.asarray(np.polynomial.legendre.legvander(x, order), dtype=np.float64)


def _antiderivatives(x: FloatArray) -> FloatArray:
    """(n, NODES) their integrals from -1 to `x` (n,)."""
    p = legendre(x, NODES)
    out = np.empty((len(x), NODES))
    out[:, 0] = x + 1.0
    out[:, 1:] = (p[:, 2:] - p[:, :-2]) / (2 * np.arange(1, NODES) + 1)
    return out


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """Cells that fill a turn.

    Attributes
    ----------
    low, high : (m,) their ends [rad].
    laws : (6, m, n) the law at their nodes.
    """

    low: FloatArray
    high: FloatArray
    laws: FloatArray

    @property
    def spans(self) -> FloatArray:
        """(m,) lengths of the cells [rad]."""
        return self.high - self.low

    @property
    def nodes(self) -> FloatArray:
        """(m, n) cam angles of the nodes [rad]."""
        return nodes_of(self.low, self.high)

    def halved(self, law: Law) -> Mesh:
        """All cells halved, in order."""
        middle = 0.5 * (self.low + self.high)
        low = np.stack((self.low, middle), axis=1).ravel()
        high = np.stack((middle, self.high), axis=1).ravel()
        return Mesh(low, high, laws_of(law, low, high))

    def cells(self, which: BoolArray) -> Mesh:
        """Some of the cells, `which` (m,)."""
        return Mesh(self.low[which], self.high[which], self.laws[:, which])

    def replaced(self, split: BoolArray, halves: Mesh) -> Mesh:
        """With both `halves` for each of the cells `split` (m,)."""
        laws = interleaved(split, self.laws.swapaxes(0, 1), halves.laws.swapaxes(0, 1))
        return Mesh(
            interleaved(split, self.low, halves.low),
            interleaved(split, self.high, halves.high),
            laws.swapaxes(0, 1),
        )


@dataclass(frozen=True, slots=True, eq=False)
class DoubleMesh:
    """A mesh and the one of all its cells' halves, which tells the error of the first."""

    coarse: Mesh
    fine: Mesh

    def refined(self, law: Law, split: BoolArray) -> DoubleMesh:
        """The cells `split` (m,) of the coarse mesh halved; what is known already is taken over."""
        both = np.repeat(split, 2)
        halves = self.fine.cells(both)
        return DoubleMesh(
            self.coarse.replaced(split, halves), self.fine.replaced(both, halves.halved(law))
        )


def interleaved(split: BoolArray, own: FloatArray, halves: FloatArray) -> FloatArray:
    """The rows `own` (m, ...), but for those to `split` two each of `halves`, in order."""
    places = np.concatenate((2 * np.flatnonzero(~split), np.flatnonzero(np.repeat(split, 2))))
    found: FloatArray = np.concatenate((own[~split], halves))[np.argsort(places)]
    return found


def nodes_of(low: FloatArray, high: FloatArray) -> FloatArray:
    """(m, n) nodes of the cells [low, high]."""
    nodes: FloatArray = low[:, np.newaxis] + (high - low)[:, np.newaxis] * rule().nodes
    nodes[:, -1] = high
    return nodes


def laws_of(law: Law, low: FloatArray, high: FloatArray) -> FloatArray:
    """(6, m, n) the law at the nodes of the cells, from inside at their ends."""
    nodes = nodes_of(low, high)
    return law(nodes.ravel(), "left").reshape(-1, *nodes.shape)


def double_mesh(law: Law, edges: FloatArray, longest: float) -> DoubleMesh:
    """Cells between neighbouring `edges`, none longer than `longest` [rad]."""
    counts = np.maximum(np.ceil(np.diff(edges) / longest), 1).astype(np.intp)
    grids = [
        np.linspace(a, b, count + 1)
        for a, b, count in zip(edges[:-1], edges[1:], counts, strict=True)
    ]
    low = np.concatenate([grid[:-1] for grid in grids])
    high = np.concatenate([grid[1:] for grid in grids])
    coarse = Mesh(low, high, laws_of(law, low, high))
    return DoubleMesh(coarse, coarse.halved(law))
