"""A step of Newton's method for the periodic solution, on all cells of a turn together.

The linearised equation maps the change at the start of each cell to that at its end,
delta_end = a delta_start + d. Chained over the turn, the product of all a is the slope of the
Poincare map, and periodicity gives the change at the start of the turn.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgeo.effects.speed_fluctuation.mesh import Mesh, rule
from camgeo.effects.speed_fluctuation.rate import Shaft
from camgeo.numeric.arrays import FloatArray


class NoConvergenceError(ArithmeticError):
    """Newton's method finds no periodic solution, or not to the tolerance.

    Attributes
    ----------
    reached : the error that was reached as a share of the largest speed; None if there is no
        solution.
    """

    def __init__(self, reached: float | None) -> None:
        super().__init__("no periodic solution was found")
        self.reached = reached


@dataclass(frozen=True, slots=True, eq=False)
class State:
    """y = base + z, so that a small fluctuation keeps its digits.

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


@dataclass(frozen=True, slots=True, eq=False)
class Step:
    """A step of Newton's: the changes, those that arise in each cell, the map's slope."""

    starts: FloatArray
    nodes: FloatArray
    defects: FloatArray
    slope: float


def newton_step(shaft: Shaft, mesh: Mesh, state: State) -> Step:
    """Newton's step from `state`."""
    at = rule()
    spans = mesh.spans
    alpha, growth = shaft.rate(mesh.laws, state.base + state.nodes)
    inner = spans[:, np.newaxis, np.newaxis] * at.integral
    residual = (
        state.starts[:-1, np.newaxis] + spans[:, np.newaxis] * (alpha @ at.integral.T) - state.nodes
    )
    matrix = np.eye(len(at.nodes)) - inner * growth[:, np.newaxis, :]
    sides = np.stack((np.ones_like(residual), residual), axis=2)
    solved = np.linalg.solve(matrix, sides)
    weight = spans[:, np.newaxis] * at.weights * growth
    factors = 1.0 + np.sum(weight * solved[:, :, 0], axis=1)
    gaps = state.starts[:-1] + spans * (alpha @ at.weights) - state.starts[1:]
    offsets = np.sum(weight * solved[:, :, 1], axis=1) + gaps
    slope, shift = 1.0, 0.0
    slopes, shifts = np.empty(len(spans) + 1), np.empty(len(spans) + 1)
    slopes[0], shifts[0] = slope, shift
    for k, (factor, offset) in enumerate(zip(factors.tolist(), offsets.tolist(), strict=True)):
        slope, shift = factor * slope, factor * shift + offset
        slopes[k + 1], shifts[k + 1] = slope, shift
    if slope == 1.0:
        raise NoConvergenceError(None)
    # The turn closes: z at its end is z at its start.
    missing = float(state.starts[-1] - state.starts[0])
    first = (shift + missing) / (1.0 - slope)
    starts = slopes * first + shifts
    nodes = solved[:, :, 0] * starts[:-1, np.newaxis] + solved[:, :, 1]
    # What the cell itself answers to its residual: a stiff motor takes most of it away.
    defects = np.maximum(np.max(np.abs(solved[:, :, 1]), axis=1), np.abs(offsets))
    return Step(starts, nodes, defects, slope)
