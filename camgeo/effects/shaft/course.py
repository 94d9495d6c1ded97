"""How the cam turns in its steady state, as a time course like any other."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Final, Protocol

import numpy as np

from camgeo.effects.effect import Quantity
from camgeo.effects.shaft.mesh import Mesh, State, collocation, legendre
from camgeo.motion.kept import Answers
from camgeo.numeric.arrays import FloatArray, IntArray, Side, frozen, read_only
from camgeo.units import TURN

JUMP: Final = 1e-9
"""A jump of alpha by less than this share of the largest is rounding."""

TIMES: Final = 16
"""Number of Gauss nodes of a cell at which 1 / omega gives the series of its time."""


class SteadyTurn(Protocol):
    """A turn of the steady state.

    Attributes
    ----------
    mesh : cells of the turn.
    state : y in them.
    rates : (m, n) alpha at their nodes [rad/s^2].
    """

    @property
    def mesh(self) -> Mesh: ...

    @property
    def state(self) -> State: ...

    @property
    def rates(self) -> FloatArray: ...


@dataclass(frozen=True, eq=False)
class SteadyCourse:
    """The cam turning as in `turn`; see `camgeo.motion.time_course.TimeCourse`.

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
            inside = np.where(inside == 0.0, TURN, inside)
        cell = np.searchsorted(low, inside, side) - 1
        return np.clip(cell, 0, len(low) - 1), inside

    def _values(
        self, cell: IntArray, phi: FloatArray, *series: FloatArray
    ) -> tuple[FloatArray, ...]:
        """(n,) each of the `series` of the cells at `phi` (n,) [rad] in them."""
        mesh = self.turn.mesh
        x = 2.0 * (phi - mesh.low[cell]) / mesh.spans[cell] - 1.0
        p = legendre(x, max(each.shape[1] for each in series) - 1)
        return tuple(np.sum(p[:, : each.shape[1]] * each[cell], axis=1) for each in series)

    def rates(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        """See `TimeCourse`. Read-only, and kept for the latest requests."""
        phi = np.asarray(phi, dtype=np.float64)

        def made() -> FloatArray:
            z, alpha, rate = self._values(*self._placed(phi, side), *self._series)
            omega = np.sqrt(2.0 * (self.turn.state.base + z))
            return read_only(np.stack((omega, alpha, omega * rate)))

        return self._answers.recall(made, side, phi)

    def time(self, phi: FloatArray) -> FloatArray:
        """See `TimeCourse`; 0 at cam angle 0. Read-only, and kept as the rates are."""
        phi = np.asarray(phi, dtype=np.float64)

        def made() -> FloatArray:
            turns = np.floor(phi / TURN)
            cell, inside = self._placed(phi - TURN * turns, "right")
            (since,) = self._values(cell, inside, self._times)
            return read_only(turns * self._starts[-1] + self._starts[cell] + since)

        return self._answers.recall(made, "time", phi)


def course_of(turn: SteadyTurn, alpha: Quantity, edges: FloatArray) -> SteadyCourse:
    """The course of `turn`, with the acceleration `alpha` smooth between `edges` (k,) [rad]."""
    borders = np.unique(np.mod(edges, TURN))
    right, left = (alpha(borders, side) for side in ("right", "left"))
    size = max(float(np.max(np.abs(turn.rates))), float(np.max(np.abs(right))))
    jumps = borders[np.abs(right - left) > JUMP * size]
    return SteadyCourse(turn, frozen(borders, np.float64), frozen(jumps, np.float64))
