"""Cells of a turn with the torque law at their nodes, which can be halved.

The law is (6 or more, n) at n cam angles [rad], see `camgeo.effects.shaft.rate`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np

from camgeo.effects.effect import Quantity
from camgeo.numeric.arrays import BoolArray, FloatArray, IntArray
from camgeo.units import TURN

NODES: Final = 8
"""Radau IIA nodes of a cell, including its end: collocation of order 15 at the ends of cells,
stable even with a motor so stiff that the speed follows at once (Hairer and Wanner, Solving
Ordinary Differential Equations II, section IV.5).
"""


@dataclass(frozen=True, slots=True, eq=False)
class Collocation:
    """Collocation on a cell of length 1.

    Attributes
    ----------
    nodes, weights : (n,) nodes in (0, 1], the last one 1.
    integral : (n, n) from rates at the nodes to the integrals from the start to each node.
    fit : (n + 1, n + 1) from values at the start and the nodes to the Legendre coefficients of the
        polynomial through them.
    halves : (2, n, n + 1) from the same values to those at the nodes of the two halves of the cell.
    """

    nodes: FloatArray
    weights: FloatArray
    integral: FloatArray
    fit: FloatArray
    halves: FloatArray


@lru_cache(maxsize=1)
def collocation() -> Collocation:
    """Collocation at the zeros of P_n - P_(n - 1), with the Legendre polynomials P."""
    series = np.zeros(NODES + 1)
    series[-2:] = -1.0, 1.0
    x = np.sort(np.polynomial.legendre.legroots(series).real)  # of complex type with numpy 2.5
    slope = np.polynomial.legendre.legder(series)
    for _ in range(2):  # Newton steps to full precision
        x = x - np.polynomial.legendre.legval(x, series) / np.polynomial.legendre.legval(x, slope)
    x[-1] = 1.0
    from_rates = np.linalg.inv(legendre(x, NODES - 1))
    integral = np.asarray(0.5 * _antiderivatives(x) @ from_rates, dtype=np.float64)
    fit = np.asarray(np.linalg.inv(legendre(np.append(-1.0, x), NODES)), dtype=np.float64)
    halves = np.stack([legendre(0.5 * (x + shift), NODES) @ fit for shift in (-1.0, 1.0)])
    return Collocation(0.5 * (x + 1.0), integral[-1], integral, fit, halves)


def legendre(x: FloatArray, order: int) -> FloatArray:
    """(n, order + 1) Legendre polynomials at `x` (n,) in [-1, 1]."""
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
    """Cells that cover a turn.

    Attributes
    ----------
    low, high : (m,) their ends [rad].
    laws : (6 or more, m, n) the torque law at their nodes.
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

    def placed(self, phi: FloatArray) -> tuple[IntArray, FloatArray]:
        """(n,) cells at `phi` (n,) [rad], in any turn, and the places in them, -1 to 1."""
        # The end of a turn is not mapped to its start: they are equal only to rounding.
        inside = np.where((phi >= 0.0) & (phi <= TURN), phi, np.mod(phi, TURN))
        cell = np.clip(np.searchsorted(self.low, inside, "right") - 1, 0, len(self.low) - 1)
        return cell, 2.0 * (inside - self.low[cell]) / self.spans[cell] - 1.0

    def halved(self, law: Quantity) -> Mesh:
        """All cells halved, in order."""
        middle = 0.5 * (self.low + self.high)
        low = np.stack((self.low, middle), axis=1).ravel()
        high = np.stack((middle, self.high), axis=1).ravel()
        return Mesh(low, high, laws_of(law, low, high))

    def cells(self, which: BoolArray) -> Mesh:
        """The cells selected by `which` (m,)."""
        return Mesh(self.low[which], self.high[which], self.laws[:, which])

    def replaced(self, split: BoolArray, halves: Mesh) -> Mesh:
        """The mesh with each cell selected by `split` (m,) replaced by its two `halves`."""
        laws = interleaved(split, self.laws.swapaxes(0, 1), halves.laws.swapaxes(0, 1))
        return Mesh(
            interleaved(split, self.low, halves.low),
            interleaved(split, self.high, halves.high),
            laws.swapaxes(0, 1),
        )


@dataclass(frozen=True, slots=True, eq=False)
class DoubleMesh:
    """A mesh, and the mesh of all halves of its cells for the error estimate."""

    coarse: Mesh
    fine: Mesh

    def refined(self, law: Quantity, split: BoolArray) -> DoubleMesh:
        """The cells `split` (m,) of the coarse mesh halved; known values are reused."""
        both = np.repeat(split, 2)
        halves = self.fine.cells(both)
        return DoubleMesh(
            self.coarse.replaced(split, halves), self.fine.replaced(both, halves.halved(law))
        )


@dataclass(frozen=True, slots=True, eq=False)
class State:
    """The state y = base + z; a small fluctuation z keeps its precision.

    Attributes
    ----------
    base : [rad^2/s^2]
    starts : (m + 1,) z at the ends of the cells.
    nodes : (m, n) z at their nodes.
    """

    base: float
    starts: FloatArray
    nodes: FloatArray

    @property
    def all_nodes(self) -> FloatArray:
        """(m, n + 1) z at the start and at the nodes of each cell."""
        return np.concatenate((self.starts[:-1, np.newaxis], self.nodes), axis=1)


def interleaved(split: BoolArray, own: FloatArray, halves: FloatArray) -> FloatArray:
    """The rows `own` (m, ...), with two rows of `halves` in place of each one to `split`."""
    places = np.concatenate((2 * np.flatnonzero(~split), np.flatnonzero(np.repeat(split, 2))))
    found: FloatArray = np.concatenate((own[~split], halves))[np.argsort(places)]
    return found


def nodes_of(low: FloatArray, high: FloatArray) -> FloatArray:
    """(m, n) nodes of the cells [low, high]."""
    nodes: FloatArray = low[:, np.newaxis] + (high - low)[:, np.newaxis] * collocation().nodes
    nodes[:, -1] = high
    return nodes


def laws_of(law: Quantity, low: FloatArray, high: FloatArray) -> FloatArray:
    """(6 or more, m, n) the torque law at the nodes of the cells, at their ends from inside."""
    nodes = nodes_of(low, high)
    return law(nodes.ravel(), "left").reshape(-1, *nodes.shape)


def double_mesh(law: Quantity, edges: FloatArray, longest: float) -> DoubleMesh:
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
