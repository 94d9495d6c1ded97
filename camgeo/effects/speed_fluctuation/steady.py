"""The periodic solution of dy/dphi = alpha(phi, y), by collocation over the whole turn at once.

The error estimate is the change by one more Newton step on the mesh of all halves of the cells,
taken several times for what lies between their nodes.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from camgeo.effects.effect import Quantity
from camgeo.effects.shaft.mesh import (
    NODES,
    DoubleMesh,
    Mesh,
    State,
    collocation,
    interleaved,
    legendre,
)
from camgeo.effects.shaft.rate import Shaft
from camgeo.effects.speed_fluctuation.table import Motor
from camgeo.numeric.arrays import FloatArray
from camgeo.units import TURN

MOST_STEPS: Final = 60
"""Largest number of Newton steps; a few are enough except at kinks of the torque law."""

FULL_STEPS: Final = 20
"""Number of full Newton steps; later ones are halved, as a kink may make them alternate."""

MOST_PASSES: Final = 80
"""Largest number of mesh refinements; each one at a kink divides its error by 4."""

MOST_CELLS: Final = 40_000

KEEP: Final = 0.2
"""Smallest share of y that a Newton step leaves."""

NEAR: Final = 1e-3
"""Relative step size at which the iteration is at a solution, even if rounding prevents smaller
steps."""

BETWEEN: Final = 4.0
"""Factor from the change at the nodes to the error between them: where the torque jumps, a stiff
motor changes the speed within a fraction of a cell, partly before its first node."""

ROUNDINGS: Final = 8.0
"""Number of roundings that the estimate assumes for the acceleration at a node."""

EPS: Final = float(np.finfo(np.float64).eps)


class NoConvergenceError(ArithmeticError):
    """Newton's method finds no periodic solution, or does not reach the tolerance.

    Attributes
    ----------
    reached : the error that was reached, relative to the largest speed; None without a solution.
    """

    def __init__(self, reached: float | None) -> None:
        super().__init__("no periodic solution was found")
        self.reached = reached


@dataclass(frozen=True, slots=True, eq=False)
class Step:
    """A Newton step: the changes, the defect of each cell, and the slope of the Poincare map."""

    starts: FloatArray
    nodes: FloatArray
    defects: FloatArray
    slope: float


def newton_step(shaft: Shaft[Motor], mesh: Mesh, state: State) -> Step:
    """The Newton step from `state`, on all cells of the turn together."""
    at = collocation()
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
    # Periodicity: z at the end of the turn is z at its start.
    missing = float(state.starts[-1] - state.starts[0])
    first = (shift + missing) / (1.0 - slope)
    starts = slopes * first + shifts
    nodes = solved[:, :, 0] * starts[:-1, np.newaxis] + solved[:, :, 1]
    # The response of the cell to its residual, which a stiff motor damps strongly.
    defects = np.maximum(np.max(np.abs(solved[:, :, 1]), axis=1), np.abs(offsets))
    return Step(starts, nodes, defects, slope)


@dataclass(frozen=True, eq=False)
class SteadyTurn:
    """The steady state.

    Attributes
    ----------
    shaft : the camshaft and its motor.
    mesh : the cells.
    state : y in them.
    rates : (m, n) alpha at the nodes [rad/s^2].
    slope : of the Poincare map in y; below 1 the state is stable.
    error : estimate of the largest error of the speed, relative to the largest speed.
    rough : the steady state on cells twice as long, from which the error is estimated; None for it.
    """

    shaft: Shaft[Motor]
    mesh: Mesh
    state: State
    rates: FloatArray
    slope: float
    error: float
    rough: SteadyTurn | None

    @cached_property
    def _series(self) -> FloatArray:
        """(m, n + 1) Legendre coefficients of z in each cell."""
        return np.asarray(self.state.all_nodes @ collocation().fit.T)

    def omega(self, phi: FloatArray) -> FloatArray:
        """(n,) speed [rad/s] at `phi` (n,) [rad], in any turn."""
        return np.sqrt(2.0 * self.y(phi))

    def y(self, phi: FloatArray) -> FloatArray:
        """(n,) omega^2 / 2 [rad^2/s^2]."""
        cell, x = self.mesh.placed(phi)
        z: FloatArray = np.sum(legendre(x, NODES) * self._series[cell], axis=1)
        return self.state.base + z

    def linearised(
        self, phi: FloatArray, rows: FloatArray, other: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """See `camgeo.effects.results.Turning`: of omega, whose rate is alpha / omega."""
        y = self.y(phi)
        omega = np.sqrt(2.0 * y)
        alpha, growth = self.shaft.rate(rows, y)
        off = (self.shaft.rate(other, y)[0] - alpha) / omega
        slopes = growth - alpha / omega**2
        return slopes[:, np.newaxis, np.newaxis], off[:, np.newaxis]

    def mean(self, values: FloatArray) -> float:
        """Mean over the cam angle of `values` (m, n) at the nodes."""
        return float(np.sum(self.mesh.spans * (values @ collocation().weights))) / TURN


def steady_turn(
    shaft: Shaft[Motor], law: Quantity, mesh: DoubleMesh, y: FloatArray | float, tolerance: float
) -> SteadyTurn:
    """The periodic solution nearest to `y`.

    Parameters
    ----------
    shaft : the camshaft and its motor.
    law : the torque law of the cam.
    mesh : initial mesh; no cell contains an edge of the law.
    y : initial guess at the nodes (m, n) of the coarse mesh, or one value for all [rad^2/s^2].
    tolerance : largest error of the speed, relative to the largest speed.

    Raises
    ------
    NoConvergenceError
        If no solution is found.
    StuckError
        If friction leaves no acceleration.
    """
    guess = np.broadcast_to(np.asarray(y, dtype=np.float64), mesh.coarse.laws.shape[1:])
    base = float(np.mean(guess))
    start = guess[:, 0] - base
    state = State(base, np.append(start, start[0]), guess - base)
    reached = np.inf
    for _ in range(MOST_PASSES):
        state, left = _solved(shaft, mesh.coarse, state, tolerance)
        fine_state = _on_halves(state)
        step = newton_step(shaft, mesh.fine, fine_state)
        y_fine = fine_state.base + fine_state.nodes
        largest = float(np.max(y_fine))
        # d omega / omega_max = dy / (omega omega_max)
        share = np.max(np.abs(step.nodes) / np.sqrt(y_fine * largest)) * 0.5
        off = max(abs(1.0 - step.slope), EPS)
        rounding = ROUNDINGS * EPS * (1.0 + float(np.max(np.abs(fine_state.nodes))) / largest / off)
        reached = BETWEEN * float(share) + left + rounding
        if reached <= tolerance:
            fine_state, last = _solved(shaft, mesh.fine, fine_state, tolerance)
            solved = (mesh.coarse, state), (mesh.fine, fine_state)
            rates = [shaft.rate(each.laws, own.base + own.nodes)[0] for each, own in solved]
            error = reached + last
            rough = SteadyTurn(shaft, mesh.coarse, state, rates[0], step.slope, error, None)
            return SteadyTurn(shaft, mesh.fine, fine_state, rates[1], step.slope, error, rough)
        worst = np.max(step.defects.reshape(-1, 2), axis=1)
        split = worst >= 0.1 * np.max(worst)
        cells = len(split) + int(np.count_nonzero(split))
        if not np.max(worst) > EPS * EPS * largest or cells > MOST_CELLS:
            break
        mesh = mesh.refined(law, split)
        both = np.repeat(split, 2)
        nodes = interleaved(split, state.nodes, fine_state.nodes[both])
        starts = interleaved(split, state.starts[:-1], fine_state.starts[:-1][both])
        state = State(state.base, np.append(starts, state.starts[-1]), nodes)
    raise NoConvergenceError(reached)


def _solved(shaft: Shaft[Motor], mesh: Mesh, state: State, tolerance: float) -> tuple[State, float]:
    """The collocation solution, and its last change relative to the largest speed."""
    target = max(1e-3 * tolerance, 16.0 * EPS)
    best = np.inf
    for count in range(MOST_STEPS):
        step = newton_step(shaft, mesh, state)
        y = state.base + state.nodes
        down = float(np.max(-step.nodes / y))
        ends = float(np.max(-step.starts / (state.base + state.starts)))
        share = min(1.0, (1.0 - KEEP) / max(down, ends, 1e-300))
        if count >= FULL_STEPS:
            share *= 0.5
        shift = share * float(step.starts[0])
        base = state.base + (state.starts[0] + shift)
        moved = base - state.base
        state = State(
            base,
            state.starts + (share * step.starts - moved),
            state.nodes + (share * step.nodes - moved),
        )
        change = 0.5 * float(np.max(np.abs(step.nodes)) / np.max(y))
        # Where the state is only weakly determined, rounding prevents smaller steps.
        stalled = change >= 0.25 * best and best <= max(0.1 * tolerance, 1e3 * EPS)
        if share == 1.0 and (change <= target or stalled):
            return state, change if stalled and change > target else change * change
        if not np.isfinite(change):
            raise NoConvergenceError(None)
        best = min(best, change)
    raise NoConvergenceError(best if best < NEAR else None)


def _on_halves(state: State) -> State:
    """The polynomials through the nodes of all cells, at the nodes of their halves.

    Integrals of alpha would give the same except for rounding, which a stiff motor magnifies.
    Between nodes with a steep fall a polynomial may become negative, where there is no speed. It is
    kept above 0; such a cell does not have its solution yet, and will be split.
    """
    halves = np.einsum("hij,mj->mhi", collocation().halves, state.all_nodes)
    least = KEEP * np.min(state.base + state.all_nodes, axis=1)
    halves = np.maximum(halves, least[:, np.newaxis, np.newaxis] - state.base)
    middles = halves[:, 0, -1]
    starts = np.append(np.stack((state.starts[:-1], middles), axis=1).ravel(), state.starts[-1])
    return State(state.base, starts, halves.reshape(-1, NODES))
