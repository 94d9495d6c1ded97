"""The periodic motion of a cam at the end of an elastic shaft, by collocation over the whole turn.

The equations are in `camgeo.effects.camshaft_windup.wound`, the cell is that of
`camgeo.effects.shaft.mesh`, and the error estimate is the change by one more Newton step on the
mesh of all halves of the cells.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from camgeo.effects.camshaft_windup.wound import Twist, Wound
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
from camgeo.numeric.arrays import FloatArray

MOST_STEPS: Final = 40
"""Largest number of Newton steps."""

FULL_STEPS: Final = 15
"""Number of full Newton steps; later ones are halved, as a kink may make them alternate."""

MOST_PASSES: Final = 60
"""Largest number of mesh refinements."""

MOST_CELLS: Final = 20_000

KEEP: Final = 0.2
"""Smallest share of y that a Newton step leaves."""

BETWEEN: Final = 4.0
"""Factor from the change at the nodes to the error between them."""

ROUNDINGS: Final = 8.0
"""Number of roundings that the estimate assumes for a rate at a node."""

EPS: Final = float(np.finfo(np.float64).eps)


class NoConvergenceError(ArithmeticError):
    """Newton's method finds no periodic solution, or does not reach the tolerance.

    Attributes
    ----------
    reached : the error that was reached, as a share; None without a solution.
    """

    def __init__(self, reached: float | None) -> None:
        super().__init__("no periodic solution was found")
        self.reached = reached


@dataclass(frozen=True, slots=True, eq=False)
class Pair:
    """v and w in the cells of a mesh.

    Attributes
    ----------
    starts : (m + 1, 2) at the ends of the cells.
    nodes : (m, n, 2) at their nodes.
    """

    starts: FloatArray
    nodes: FloatArray

    @property
    def all_nodes(self) -> FloatArray:
        """(m, n + 1, 2) at the start and at the nodes of each cell."""
        return np.concatenate((self.starts[:-1, np.newaxis], self.nodes), axis=1)

    @property
    def largest_windup(self) -> float:
        """[rad] at the nodes; 1 if there is none."""
        return float(np.max(np.abs(self.nodes[..., 1]))) or 1.0


@dataclass(frozen=True, slots=True, eq=False)
class Step:
    """A Newton step: the changes, the defect (m, 2) of each cell, and the monodromy matrix."""

    starts: FloatArray
    nodes: FloatArray
    defects: FloatArray
    monodromy: FloatArray


def newton_step(wound: Wound, mesh: Mesh, pair: Pair) -> Step:
    """The Newton step from `pair`, on all cells of the turn together."""
    rates, slopes = wound.rates(mesh.laws, pair.nodes)
    inner = mesh.spans[:, np.newaxis, np.newaxis] * collocation().integral
    residual = pair.starts[:-1, np.newaxis] + inner @ rates - pair.nodes
    # The rate of w depends on v alone, so that dw is dv's consequence: the equations are solved for
    # dv, from 1 at the start in v and in w, and from the residual.
    by_v, by_w = (inner * slopes[:, np.newaxis, :, 0, each] for each in (0, 1))
    w_by_v = inner * slopes[:, np.newaxis, :, 1, 0]
    matrix = np.eye(NODES) - by_v - by_w @ w_by_v
    solved = np.zeros((*residual.shape, 3))
    solved[:, :, 0, 0] = solved[:, :, 1, 1] = 1.0
    solved[..., 2] = residual
    solved[:, :, 0] = np.linalg.solve(matrix, solved[:, :, 0] + by_w @ solved[:, :, 1])
    solved[:, :, 1] += w_by_v @ solved[:, :, 0]
    # Radau's last node is the end of the cell.
    factors, own = solved[:, -1, :, :2], solved[:, -1, :, 2]
    offsets = own + pair.nodes[:, -1] - pair.starts[1:]
    products, shifts = _passed_on(factors, offsets)
    # Periodicity: the state at the end of the turn is that at its start.
    try:
        closing = shifts[-1] + pair.starts[-1] - pair.starts[0]
        first = np.linalg.solve(np.eye(2) - products[-1], closing)
    except np.linalg.LinAlgError as error:
        raise NoConvergenceError(None) from error
    starts = products @ first + shifts
    nodes = np.einsum("mnij,mj->mni", solved[..., :2], starts[:-1]) + solved[..., 2]
    return Step(starts, nodes, np.max(np.abs(solved[..., 2]), axis=1), products[-1])


def _passed_on(factors: FloatArray, offsets: FloatArray) -> tuple[FloatArray, FloatArray]:
    """What passing all cells before the start of each makes of a change x at the start of the turn,
    (m + 1, 2, 2) A and (m + 1, 2) b of A x + b, where one cell makes `factors` (m, 2, 2) x +
    `offsets` (m, 2): of one cell each, then of 2, 4, 8, ... together.
    """
    maps = np.zeros((len(factors) + 1, 3, 3))
    maps[:] = np.eye(3)
    maps[1:, :2, :2], maps[1:, :2, 2] = factors, offsets
    together = 1
    while together < len(maps):
        maps[together:] = maps[together:] @ maps[:-together]
        together *= 2
    return maps[:, :2, :2], maps[:, :2, 2]


@dataclass(frozen=True, eq=False)
class WoundTurn:
    """The steady state.

    Attributes
    ----------
    wound : the cam on its shaft.
    mesh : the cells.
    pair : v and w in them.
    rates : (m, n) alpha at the nodes [rad/s^2].
    multiplier : the share of a disturbance that is left after a turn, at most: the size of the
        larger eigenvalue of the monodromy matrix.
    multiplier_error : estimate of its error.
    speed_error : estimate of the largest error of the speed [rad/s].
    windup_error : that of the windup [rad].
    rough : the steady state on cells twice as long, from which the errors are estimated; None for
        it.
    """

    wound: Wound
    mesh: Mesh
    pair: Pair
    rates: FloatArray
    multiplier: float
    multiplier_error: float
    speed_error: float
    windup_error: float
    rough: WoundTurn | None

    @property
    def state(self) -> State:
        """y in the cells."""
        square = self.wound.speed**2
        v = (self.pair.starts[:, 0], self.pair.nodes[..., 0])
        return State(0.5 * square, *(square * each for each in v))

    @cached_property
    def _series(self) -> FloatArray:
        """(m, n + 1, 2) Legendre coefficients of v and w in each cell."""
        return np.asarray(collocation().fit @ self.pair.all_nodes)

    def at(self, phi: FloatArray) -> FloatArray:
        """(n, 2) v and w at `phi` (n,) [rad], in any turn."""
        cell, x = self.mesh.placed(phi)
        found: FloatArray = np.einsum("ni,nik->nk", legendre(x, NODES), self._series[cell])
        return found

    def on(self, mesh: Mesh) -> Pair:
        """v and w in the cells of another `mesh`."""
        shape = mesh.nodes.shape
        nodes = self.at(mesh.nodes.ravel()).reshape(*shape, 2)
        return Pair(np.concatenate((self.at(mesh.low[:1]), nodes[:, -1])), nodes)

    def windup(self, phi: FloatArray) -> FloatArray:
        """(n,) w [rad]."""
        return self.at(phi)[:, 1]

    def omega(self, phi: FloatArray) -> FloatArray:
        """(n,) speed [rad/s]."""
        return np.sqrt(2.0 * self.wound.y(self.at(phi)[:, 0]))

    def linearised(
        self, phi: FloatArray, rows: FloatArray, other: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """See `camgeo.effects.results.Turning`: of omega and w, whose rates are alpha / omega and
        Omega / omega - 1.
        """
        shaft, y = self.driven(phi)
        omega = np.sqrt(2.0 * y)
        alpha, growth, per_torque = shaft.response(rows, y)
        slopes, off = np.zeros((len(phi), 2, 2)), np.zeros((len(phi), 2))
        slopes[:, 0, 0] = growth - alpha / omega**2
        slopes[:, 0, 1] = self.wound.shaft.stiffness * per_torque / omega
        slopes[:, 1, 0] = -self.wound.speed / omega**2
        off[:, 0] = (shaft.rate(other, y)[0] - alpha) / omega
        return slopes, off

    def driven(self, phi: FloatArray) -> tuple[Shaft[Twist], FloatArray]:
        """The cam with its shaft wound up as at `phi` (n,) [rad], and y (n,) there."""
        v, w = self.at(phi).T
        return self.wound.driven(w), self.wound.y(v)


def periodic(
    wound: Wound, law: Quantity, mesh: DoubleMesh, pair: Pair, tolerance: float
) -> WoundTurn:
    """The periodic solution near `pair`.

    Parameters
    ----------
    wound : the cam on its shaft.
    law : the torque law of the cam.
    mesh : initial mesh; no cell contains an edge of the law.
    pair : initial guess on the coarse mesh.
    tolerance : largest error of speed and windup, relative to the largest of each.

    Raises
    ------
    NoConvergenceError
        If no solution is found.
    StuckError
        If friction leaves no acceleration.
    """
    reached = math.inf
    for _ in range(MOST_PASSES):
        pair, left = newton(wound, mesh.coarse, pair, tolerance)
        fine = _on_halves(pair)
        step = newton_step(wound, mesh.fine, fine)
        scales = np.array([1.0, pair.largest_windup])
        errors = np.max(_relative(step.nodes, fine), axis=(0, 1)) * scales
        errors = BETWEEN * errors + left * scales + _rounding(wound, step.monodromy, fine)
        reached = float(np.max(errors / scales))
        if reached <= tolerance:
            exact, last = newton(wound, mesh.fine, fine, tolerance)
            errors = errors + last * scales
            own = (
                *_multiplier(wound, mesh, pair, exact),
                wound.speed * float(errors[0]),
                float(errors[1]),
            )
            rough = WoundTurn(
                wound, mesh.coarse, pair, _alpha(wound, mesh.coarse, pair), *own, None
            )
            return WoundTurn(wound, mesh.fine, exact, _alpha(wound, mesh.fine, exact), *own, rough)
        worst = np.max((step.defects / scales).reshape(-1, 4), axis=1)
        split = worst >= 0.1 * np.max(worst)
        cells = len(split) + int(np.count_nonzero(split))
        if not np.max(worst) > EPS * EPS or cells > MOST_CELLS:
            break
        mesh = mesh.refined(law, split)
        both = np.repeat(split, 2)
        nodes = interleaved(split, pair.nodes, fine.nodes[both])
        starts = interleaved(split, pair.starts[:-1], fine.starts[:-1][both])
        pair = Pair(np.concatenate((starts, pair.starts[-1:])), nodes)
    raise NoConvergenceError(reached)


def newton(wound: Wound, mesh: Mesh, pair: Pair, tolerance: float) -> tuple[Pair, float]:
    """The collocation solution, and its last change as a share; raises as `periodic`."""
    target = max(1e-3 * tolerance, 16.0 * EPS)
    best = math.inf
    for count in range(MOST_STEPS):
        if not min(np.min(pair.nodes[..., 0]), np.min(pair.starts[:, 0])) > -0.5:
            raise NoConvergenceError(None)  # the speed has become 0, step by step
        step = newton_step(wound, mesh, pair)
        down = float(np.max(-step.nodes[..., 0] / (0.5 + pair.nodes[..., 0])))
        ends = float(np.max(-step.starts[:, 0] / (0.5 + pair.starts[:, 0])))
        share = min(1.0, (1.0 - KEEP) / max(down, ends, 1e-300))
        if count >= FULL_STEPS:
            share *= 0.5
        change = float(np.max(_relative(step.nodes, pair)))
        pair = Pair(pair.starts + share * step.starts, pair.nodes + share * step.nodes)
        if not math.isfinite(change):
            raise NoConvergenceError(None)
        stalled = change >= 0.25 * best and best <= max(0.1 * tolerance, 1e4 * EPS)
        if share == 1.0 and (change <= target or stalled):
            return pair, change if stalled and change > target else change * change
        best = min(best, change)
    raise NoConvergenceError(None)


def _relative(changes: FloatArray, pair: Pair) -> FloatArray:
    """(m, n, 2) `changes` of speed and windup, relative to the drive's speed and the largest
    windup.
    """
    r = np.sqrt(1.0 + 2.0 * np.maximum(pair.nodes[..., 0], -0.5 + 0.5 * KEEP))
    sizes = np.stack((1.0 / r, np.full(r.shape, 1.0 / pair.largest_windup)), axis=-1)
    return np.asarray(np.abs(changes) * sizes)


def _multiplier(wound: Wound, mesh: DoubleMesh, rough: Pair, pair: Pair) -> tuple[float, float]:
    """The size of the larger eigenvalue of the monodromy matrix, and an estimate of its error: the
    change from the coarse mesh, and rounding, which is more where the two are nearly equal.
    """
    steps = (newton_step(wound, *each) for each in ((mesh.coarse, rough), (mesh.fine, pair)))
    ends = [np.linalg.eigvals(each.monodromy) for each in steps]
    coarse, fine = (float(np.max(np.abs(each))) for each in ends)
    rounding = ROUNDINGS * EPS * len(mesh.fine.low)
    apart = float(np.abs(ends[1][0] - ends[1][1])) / max(fine, 1e-300)
    rounding *= 1.0 + 1.0 / max(apart, math.sqrt(rounding))
    return fine, BETWEEN * abs(fine - coarse) + rounding * max(fine, EPS)


def _rounding(wound: Wound, monodromy: FloatArray, pair: Pair) -> FloatArray:
    """(2,) what rounding of the torque does to v and w.

    A torque off by e winds the shaft up by e / k, and sways the speed by that times the natural
    frequency; of a disturbance, 1 / (1 - multiplier) is what it adds up to over all turns.
    """
    shaft = wound.shaft
    windup = pair.largest_windup + shaft.viscosity * wound.speed / shaft.stiffness
    off = max(float(np.min(np.abs(1.0 - np.linalg.eigvals(monodromy)))), EPS)
    ratio = shaft.natural_frequency / wound.speed
    found: FloatArray = ROUNDINGS * EPS * windup * (1.0 + 1.0 / off) * np.array([ratio, 1.0])
    return found


def _alpha(wound: Wound, mesh: Mesh, pair: Pair) -> FloatArray:
    """(m, n) alpha at the nodes [rad/s^2]."""
    return np.asarray(wound.speed**2 * wound.rates(mesh.laws, pair.nodes)[0][..., 0])


def _on_halves(pair: Pair) -> Pair:
    """The polynomials through the nodes of all cells, at the nodes of their halves; v is kept where
    there is a speed.
    """
    halves = np.einsum("hij,mjk->mhik", collocation().halves, pair.all_nodes)
    halves[..., 0] = np.maximum(halves[..., 0], -0.5 + 0.5 * KEEP)
    middles = halves[:, 0, -1]
    starts = np.stack((pair.starts[:-1], middles), axis=1).reshape(-1, 2)
    return Pair(np.concatenate((starts, pair.starts[-1:])), halves.reshape(-1, NODES, 2))
