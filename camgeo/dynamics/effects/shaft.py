"""A camshaft that does not turn at constant speed: its equation of motion over the cam angle."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import Final, Generic, Protocol, TypeVar

import numpy as np

from camgeo.dynamics.effects.bearing_friction import LINEAR, RubbingLaw, StuckError
from camgeo.dynamics.effects.effect import Quantity, Subject
from camgeo.dynamics.effects.forces import torque_shocks
from camgeo.dynamics.effects.wording import at_angle
from camgeo.errors import EffectError
from camgeo.numeric.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
    Side,
    frozen,
    merged,
    read_only,
)
from camgeo.numeric.extremes import dips, roots_on_grid, sample_grid, with_roots
from camgeo.numeric.kept import Answers
from camgeo.units import TURN

JUMP: Final = 1e-9
"""A jump of alpha by less than this share of the largest is rounding."""

TIMES: Final = 16
"""Number of Gauss nodes of a cell at which 1 / omega gives the series of its time."""


class SteadyTurn(Protocol):
    """A turn of the steady state."""

    @property
    def mesh(self) -> Mesh:
        """Cells of the turn."""

    @property
    def state(self) -> State:
        """State y in the cells."""

    @property
    def rates(self) -> FloatArray:
        """(m, n) alpha at their nodes [rad/s^2]."""

    def linearised(
        self, phi: FloatArray, rows: FloatArray, other: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """(n, d, d) the derivatives of the rates over the cam angle of the d quantities that are
        solved for, the speed of the cam first, by these; and (n, d) by how much a torque law with
        the rows `other` changes the rates from those with `rows` (r, n), at n cam angles.
        """


@dataclass(frozen=True, eq=False)
class SteadyCourse:
    """The cam turning as in `turn`; see `camgeo.kinematics.time_course.TimeCourse`.

    y = omega^2 / 2 is a polynomial of the cam angle in each cell, of which alpha is the derivative:
    the cam that turns so obeys alpha = omega domega/dphi exactly, and its equation of motion at the
    nodes.

    Attributes
    ----------
    turn : the steady turn.
    borders : (k,) cam angles [rad] in [0, 2 pi), ascending, where the torque law changes.
    jumps : those at which alpha jumps.
    """

    turn: SteadyTurn
    borders: FloatArray
    jumps: FloatArray
    _answers: Answers[FloatArray] = field(default_factory=Answers, init=False, repr=False)

    @cached_property
    def _series(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """(m, .) Legendre coefficients of z, alpha and dalpha/dphi in each cell."""
        z = self.turn.state.all_nodes @ collocation().fit.T
        scale = (2.0 / self.turn.mesh.spans)[:, np.newaxis]
        alpha = scale * np.polynomial.legendre.legder(z, axis=1)
        return z, alpha, scale * np.polynomial.legendre.legder(alpha, axis=1)

    @cached_property
    def _times(self) -> FloatArray:
        """(m, .) Legendre coefficients of the time since the start of each cell [s]: of the
        integral of the polynomial through 1 / omega at the Gauss nodes.
        """
        x, weights = np.polynomial.legendre.leggauss(TIMES)
        p = legendre(x, TIMES - 1)
        z = self._series[0] @ p[:, : self._series[0].shape[1]].T
        # dt = dphi / omega.
        slowness = 1.0 / np.sqrt(2.0 * (self.turn.state.base + z))
        to_series = (np.arange(TIMES) + 0.5)[:, np.newaxis] * p.T * weights
        half = 0.5 * self.turn.mesh.spans[:, np.newaxis]
        return half * np.polynomial.legendre.legint(slowness @ to_series.T, lbnd=-1.0, axis=1)

    @cached_property
    def _starts(self) -> FloatArray:
        """(m + 1,) time at the ends of the cells [s]."""
        return frozen(np.concatenate(([0.0], np.cumsum(np.sum(self._times, axis=1)))), np.float64)

    def _placed(self, phi: FloatArray, side: Side) -> tuple[IntArray, FloatArray]:
        """(n,) cells and the angle in the turn [rad], 0 to 2 pi."""
        low = self.turn.mesh.low
        inside = np.mod(phi, TURN)
        if side == "left":
            # From the left, cam angle 0 is the end of the turn.
            inside = np.where(inside == 0.0, TURN, inside)
        cell = np.searchsorted(low, inside, side) - 1
        return np.clip(cell, 0, len(low) - 1), inside

    def _values(
        self, cell: IntArray, phi: FloatArray, *series: FloatArray
    ) -> tuple[FloatArray, ...]:
        """(n,) each of the `series` of the cells at `phi` (n,) [rad] in them."""
        mesh = self.turn.mesh
        x = 2.0 * (phi - mesh.low[cell]) / mesh.spans[cell] - 1.0
        p = legendre(x, max(coefficients.shape[1] for coefficients in series) - 1)
        return tuple(
            np.sum(p[:, : coefficients.shape[1]] * coefficients[cell], axis=1)
            for coefficients in series
        )

    def rates(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        """See `TimeCourse`. Read-only, and kept for the latest requests."""
        phi = np.asarray(phi, dtype=np.float64)

        def compute_rates() -> FloatArray:
            z, alpha, rate = self._values(*self._placed(phi, side), *self._series)
            omega = np.sqrt(2.0 * (self.turn.state.base + z))
            return read_only(np.stack((omega, alpha, omega * rate)))

        return self._answers.recall(compute_rates, side, phi)

    def time(self, phi: FloatArray) -> FloatArray:
        """See `TimeCourse`; 0 at cam angle 0. Read-only, and kept as the rates are."""
        phi = np.asarray(phi, dtype=np.float64)

        def compute_time() -> FloatArray:
            turns = np.floor(phi / TURN)
            cell, inside = self._placed(phi - TURN * turns, "right")
            (since,) = self._values(cell, inside, self._times)
            return read_only(turns * self._starts[-1] + self._starts[cell] + since)

        return self._answers.recall(compute_time, "time", phi)


def steady_course(turn: SteadyTurn, alpha: Quantity, edges: FloatArray) -> SteadyCourse:
    """The course of `turn`, with the acceleration `alpha` smooth between `edges` (k,) [rad]."""
    borders = np.unique(np.mod(edges, TURN))
    right, left = (alpha(borders, side) for side in ("right", "left"))
    size = max(float(np.max(np.abs(turn.rates))), float(np.max(np.abs(right))))
    jumps = borders[np.abs(right - left) > JUMP * size]
    return SteadyCourse(turn, frozen(borders, np.float64), frozen(jumps, np.float64))


# -- mesh -----------------------------------------------------------------------------------------
# Cells of a turn with the torque law at their nodes, which can be halved.
#
# The law is (6 or more, n) at n cam angles [rad], see `camgeo.dynamics.effects.shaft`.


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
    # The last node is the end of the cell exactly.
    x[-1] = 1.0
    from_rates = np.linalg.inv(legendre(x, NODES - 1))
    integral = np.asarray(0.5 * _antiderivatives(x) @ from_rates, dtype=np.float64)
    fit = np.asarray(np.linalg.inv(legendre(np.append(-1.0, x), NODES)), dtype=np.float64)
    # The nodes of both halves, in the coordinate of the whole cell.
    halves = np.stack([legendre(0.5 * (x + shift), NODES) @ fit for shift in (-1.0, 1.0)])
    return Collocation(0.5 * (x + 1.0), integral[-1], integral, fit, halves)


def legendre(x: FloatArray, order: int) -> FloatArray:
    """(n, order + 1) Legendre polynomials at `x` (n,) in [-1, 1]."""
    return np.asarray(np.polynomial.legendre.legvander(x, order), dtype=np.float64)


def _antiderivatives(x: FloatArray) -> FloatArray:
    """(n, NODES) their integrals from -1 to `x` (n,)."""
    p = legendre(x, NODES)
    integrals = np.empty((len(x), NODES))
    integrals[:, 0] = x + 1.0
    # (2 k + 1) P_k is the derivative of P_(k + 1) - P_(k - 1).
    integrals[:, 1:] = (p[:, 2:] - p[:, :-2]) / (2 * np.arange(1, NODES) + 1)
    return integrals


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

    @classmethod
    def with_law(cls, law: Quantity, low: FloatArray, high: FloatArray) -> Mesh:
        """The cells [low, high] with the torque law at their nodes, at their ends from inside."""
        nodes = cell_nodes(low, high)
        return cls(low, high, law(nodes.ravel(), "left").reshape(-1, *nodes.shape))

    @property
    def spans(self) -> FloatArray:
        """(m,) lengths of the cells [rad]."""
        return self.high - self.low

    @property
    def nodes(self) -> FloatArray:
        """(m, n) cam angles of the nodes [rad]."""
        return cell_nodes(self.low, self.high)

    def placed(self, phi: FloatArray) -> tuple[IntArray, FloatArray]:
        """(n,) cells at `phi` (n,) [rad], in any turn, and the places in them, -1 to 1."""
        # The end of a turn is not mapped to its start: they are equal only to rounding.
        inside = np.where((phi >= 0.0) & (phi <= TURN), phi, np.mod(phi, TURN))
        cell = np.clip(np.searchsorted(self.low, inside, "right") - 1, 0, len(self.low) - 1)
        return cell, 2.0 * (inside - self.low[cell]) / self.spans[cell] - 1.0

    def halved(self, law: Quantity) -> Mesh:
        """The mesh of the halves of all cells, in order."""
        middle = 0.5 * (self.low + self.high)
        low = np.stack((self.low, middle), axis=1).ravel()
        high = np.stack((middle, self.high), axis=1).ravel()
        return Mesh.with_law(law, low, high)

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
    # Sorted by these numbers, row k of `own` is at 2 k and the halves that replace it at 2 k and 2
    # k + 1.
    places = np.concatenate((2 * np.flatnonzero(~split), np.flatnonzero(np.repeat(split, 2))))
    return np.asarray(np.concatenate((own[~split], halves))[np.argsort(places)])


def cell_nodes(low: FloatArray, high: FloatArray) -> FloatArray:
    """(m, n) nodes of the cells [low, high]."""
    nodes: FloatArray = low[:, np.newaxis] + (high - low)[:, np.newaxis] * collocation().nodes
    # Exactly, so that the end of a cell is the start of the next one.
    nodes[:, -1] = high
    return nodes


def double_mesh(law: Quantity, edges: FloatArray, longest: float) -> DoubleMesh:
    """Cells between neighbouring `edges`, none longer than `longest` [rad]."""
    counts = np.maximum(np.ceil(np.diff(edges) / longest), 1).astype(np.intp)
    grids = [
        np.linspace(a, b, count + 1)
        for a, b, count in zip(edges[:-1], edges[1:], counts, strict=True)
    ]
    low = np.concatenate([grid[:-1] for grid in grids])
    high = np.concatenate([grid[1:] for grid in grids])
    coarse = Mesh.with_law(law, low, high)
    return DoubleMesh(coarse, coarse.halved(law))


# -- periodic -------------------------------------------------------------------------------------
# What both searches for a periodic solution on such a mesh have in common.


EPS: Final = float(np.finfo(np.float64).eps)

LONGEST: Final = TURN / 24.0
"""Largest length of an initial cell [rad]."""

ROUGH: Final = (1e-3, 1e-6)
"""Tolerances of the turns from which the places of kinks are taken. A kink off its place by d adds
an error of d^2, and d is as small as the error of the turn that it is taken from."""

FINEST: Final = 256.0 * EPS
"""Smallest tolerance that is tried for the sake of the torque."""

KEEP: Final = 0.2
"""Smallest share of y that a Newton step leaves."""

INTERIOR_FACTOR: Final = 4.0
"""Factor from the change at the nodes to the error between them: where the torque jumps, a stiff
motor changes the speed within a fraction of a cell, partly before its first node."""

INTERPOLATION_ERROR: Final = 16.0 * EPS
"""Relative error of a value between the nodes: of the sum of nine polynomials, and of a root."""

ROUNDINGS: Final = 8.0
"""Number of roundings that the estimate assumes for a rate at a node."""


class NoConvergenceError(ArithmeticError):
    """Newton's method finds no periodic solution, or does not reach the tolerance.

    Attributes
    ----------
    reached : the error that was reached, as a share of the largest value; None without a solution.
    """

    def __init__(self, reached: float | None) -> None:
        super().__init__("no periodic solution was found")
        self.reached = reached


# -- obstacles ------------------------------------------------------------------------------------
# What leaves a camshaft without a steady state: shocks, and a follower that jams.


def refuse_shocks(subject: Subject, law: Quantity) -> None:
    """Raise EffectError if the velocity of a mass jumps: the resulting speed change is unknown."""
    edges = subject.state.smooth_angles
    places = torque_shocks(subject, lambda phi, side: law(phi, side)[3], edges)
    if len(places):
        first = float(places[0])
        raise EffectError(
            f"the velocity of the follower jumps {at_angle(first)}: the torque is infinite there,"
            " and the equation of motion does not give the speed after it",
            finding="shock",
            cam_angle=first,
        )


def jamming(inertia: float, mesh: Mesh) -> EffectError:
    """The error that the follower jams with the moment of inertia `inertia` [t mm^2] of the
    camshaft.
    """
    if len(mesh.laws) == LINEAR:
        moments = inertia + mesh.laws[3] * mesh.laws[4:]
        # J + g c3 has to be above 0 on either flank.
        bad = ~np.all(moments > 0.0, axis=0)
    else:
        bad = np.any(RubbingLaw.from_rows(mesh.laws).jams, axis=0)
    place = float(mesh.nodes[bad][0]) if np.any(bad) else None
    where = "" if place is None else f" {at_angle(place)}"
    return EffectError(
        "with friction no acceleration of the cam satisfies its equation of motion: the"
        f" follower jams{where}",
        finding="jamming",
        cam_angle=place,
    )


# -- rate -----------------------------------------------------------------------------------------
# The acceleration of a motor-driven cam.
#
# The moment of inertia J of everything that turns with the camshaft, the motor torque T_m and the
# torque T of the cam obey the equation of motion J alpha = T_m(omega) - T. T is g times the
# generalised contact force R = c0 + c1 omega + c2 omega^2 + c3 alpha, with one value of g for R > 0
# and another for R < 0. With r, which is R without its last term, this gives
#
#     alpha = (T_m - g r) / (J + g c3),        R = (J r + c3 T_m) / (J + g c3),
#
# so the sign of J r + c3 T_m determines g. Without friction g = q', and J + g c3 is the total
# moment of inertia reduced to the camshaft, J + M q'^2 (Volmer, Getriebetechnik, chapter on
# dynamics: reduction to the driving member). The state is y = omega^2 / 2, for which dy/dphi =
# alpha, regular down to standstill.
#
# With friction in pivot or guide under their whole loads, alpha = (T_m - T)/J, with T proportional
# to |N|, makes R and the loads linear in |N|, so that the balance of
# `camgeo.dynamics.effects.bearing_friction` has J among its numbers and gives alpha without any
# iteration over it. Its root is the only one on the flank that must carry if its kappa is above 0;
# otherwise no acceleration is certain, and the follower counts as stuck. The linear law at the root
# has g and R as above, and the slope of alpha.


class Drive(Protocol):
    """What drives the camshaft."""

    def torque(self, omega: FloatArray, /) -> tuple[FloatArray, FloatArray]:
        """Torque on the camshaft [N mm] and its derivative [N mm s] at the speeds `omega` (...)
        [rad/s].
        """


Driven = TypeVar("Driven", bound=Drive, covariant=True)


@dataclass(frozen=True, slots=True, eq=False)
class Shaft(Generic[Driven]):
    """The camshaft and its motor.

    Attributes
    ----------
    inertia : J [t mm^2], above 0.
    motor : its torque over speed.
    """

    inertia: float
    motor: Driven

    def push(self, law: FloatArray, y: FloatArray) -> FloatArray:
        """J r + c3 T_m (...), which has the sign of R; parameters as for `rate`."""
        c0, c1, c2, c3 = law[:4]
        omega = np.sqrt(2.0 * y)
        if len(law) != LINEAR:
            return self.inertia * RubbingLaw.from_rows(law).released(*self._free(y)[:2])
        torque: FloatArray = self.inertia * (c0 + omega * (c1 + omega * c2))
        torque += c3 * self.motor.torque(omega)[0]
        return torque

    def linear(self, law: FloatArray, y: FloatArray) -> FloatArray:
        """(6, ...) the linear law at y, see `RubbingLaw`; parameters as for `rate`."""
        if len(law) == LINEAR:
            return law
        return RubbingLaw.from_rows(law).linear(*self._free(y))

    def loads(self, law: FloatArray, y: FloatArray) -> ComplexArray:
        """(k, ...) the loads of pivot or guide at y, of the rows (9 + 12 k, ...)."""
        return RubbingLaw.from_rows(law).loads(*self._free(y))

    def _free(self, y: FloatArray) -> tuple[FloatArray, FloatArray, float]:
        """omega, the acceleration without a contact, and what a torque takes from it."""
        omega, slowing = np.sqrt(2.0 * y), 1.0 / self.inertia
        return omega, slowing * self.motor.torque(omega)[0], slowing

    def rate(self, law: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
        """alpha [rad/s^2], and its derivative with respect to y [1/rad]; see `response`."""
        return self.response(law, y)[:2]

    def response(self, law: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """alpha [rad/s^2], and its derivatives with respect to y [1/rad] and to the torque of the
        motor [1/(t mm^2)].

        Parameters
        ----------
        law : (6, ...) c0 to c3, g where R > 0, g where R < 0; or the rows of a `RubbingLaw`.
        y : (...) [rad^2/s^2], above 0.
        """
        linear = self.linear(law, y)
        c0, c1, c2, c3, ahead, behind = linear
        omega = np.sqrt(2.0 * y)
        drive, slope = self.motor.torque(omega)
        rest = c0 + omega * (c1 + omega * c2)
        gain = np.where(self.push(linear, y) >= 0.0, ahead, behind)
        # Nothing is demanded of the contact: a gain of nan must not spread.
        gain = np.where((rest == 0.0) & (c3 == 0.0), 0.0, gain)
        moment = self.inertia + gain * c3
        if not np.all(moment > 0.0):
            raise StuckError
        alpha = (drive - gain * rest) / moment
        # By y: the derivative by omega, divided by omega.
        growth = (slope - gain * (c1 + 2.0 * omega * c2)) / (omega * moment)
        return alpha, growth, 1.0 / moment


# -- switches -------------------------------------------------------------------------------------
# Where the side of a cam that carries changes.


AnyDrive = TypeVar("AnyDrive", bound=Drive)


def switches(
    law: Quantity,
    edges: FloatArray,
    laws: FloatArray,
    turned: Callable[[FloatArray], tuple[Shaft[AnyDrive], FloatArray]],
) -> FloatArray:
    """(k,) cam angles [rad] at which the side that carries changes, and with it the friction, or a
    force at an end of a guide.

    The acceleration has a kink there, which cells must not contain: one beside the end of a cell is
    seen at none of its nodes.

    Parameters
    ----------
    law : the torque law of the cam, smooth between `edges` (k,) [rad].
    laws : (6 or more, ...) the law somewhere, which shows of what kind it is.
    turned : the camshaft, as it is driven at n cam angles [rad], and y (n,) there.
    """
    linear = len(laws) == LINEAR
    if linear and np.array_equal(*laws[4:]):
        return np.empty(0)

    def push(phi: FloatArray) -> FloatArray:
        shaft, y = turned(phi)
        return shaft.push(law(phi, "right"), y)

    grid = sample_grid(merged(np.concatenate((edges, dips(push, sample_grid(edges))))))
    angles = roots_on_grid(push, grid)
    if linear or not RubbingLaw.from_rows(laws).collinear:
        return angles

    def loads(phi: FloatArray) -> FloatArray:
        shaft, y = turned(phi)
        return shaft.loads(law(phi, "right"), y).real

    return with_roots(loads, merged(np.concatenate((edges, angles))))
