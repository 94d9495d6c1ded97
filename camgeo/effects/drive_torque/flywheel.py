"""The flywheel that keeps the speed of a cam within bounds.

A drive that gives the mean torque T_m all the time stores E(phi), the integral of T_m - T, in what
turns with the cam. E is extreme where T passes T_m. With omega the mean speed and delta the allowed
fluctuation, largest less smallest speed by the mean, it takes the moment of inertia

    J = (E_max - E_min) / (delta omega^2)

(Norton, Design of Machinery, chapter on dynamic force analysis, section on controlling the input
torque by flywheels; Khurmi and Gupta, Theory of Machines, chapter 16 on turning moment diagrams).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.numeric.arrays import FloatArray, merged
from camgeo.numeric.extremes import Extremes, extremes_of
from camgeo.numeric.peaks import grid_of
from camgeo.numeric.roots import roots_on_grid

NODES: Final = 16
"""Of the Gauss-Legendre rule on a stretch; its error is taken from the rule on both halves."""

MOST_HALVINGS: Final = 40

MOST_STRETCHES: Final = 100_000
"""At one time. More are asked for only where the rounding of the function is above the tolerance;
then the error says so."""

ROUNDING: Final = 64.0 * float(np.finfo(np.float64).eps)
"""Share of its magnitude to which a stretch's integral is known at best."""


@dataclass(frozen=True, slots=True)
class StoredEnergy:
    """E over a turn, 0 at cam angle 0.

    Attributes
    ----------
    extremes : smallest and largest E [N mm], with their cam angles [rad].
    error : estimate of the error of either [N mm].
    """

    extremes: Extremes
    error: float

    @property
    def span(self) -> float:
        """E_max - E_min [N mm]."""
        return self.extremes.highest.value - self.extremes.lowest.value


def stored_energy(
    torque: Callable[[FloatArray], FloatArray], mean: float, edges: FloatArray, tolerance: float
) -> StoredEnergy:
    """What has to be stored if the drive gives the mean torque.

    Parameters
    ----------
    torque : (n,) cam angles [rad] -> (n,) [N mm], smooth between neighbouring edges.
    mean : of the torque over the turn [N mm].
    edges : (m + 1,) [rad] from 0 to 2 pi, ascending.
    tolerance : of the integrals, as a share of the integral of the magnitude.
    """

    def surplus(phi: FloatArray) -> FloatArray:
        return mean - torque(phi)

    passing = roots_on_grid(surplus, grid_of(edges))
    places = merged(np.concatenate((edges, passing)))
    stretches, error = integrals(surplus, places, tolerance)
    energy = np.concatenate(([0.0], np.cumsum(stretches)))
    return StoredEnergy(extremes_of(places, energy), error)


def moment_of_inertia(energy: float, fluctuation: float, speed: float) -> float:
    """J [t mm^2] for the span of energy [N mm], delta, and the mean speed [rad/s]."""
    return energy / (fluctuation * speed * speed)


def integrals(
    function: Callable[[FloatArray], FloatArray], edges: FloatArray, tolerance: float
) -> tuple[FloatArray, float]:
    """(m,) integrals between neighbouring edges (m + 1,), and an estimate of their summed error.

    A stretch is halved until that changes it by less than its share of `tolerance` times the
    integral of the magnitude.
    """
    low, high = edges[:-1], edges[1:]
    owner = np.arange(len(low))
    out = np.zeros(len(low))
    parts, magnitude = _gauss(function, low, high)
    scale, width = float(np.sum(magnitude)), float(edges[-1] - edges[0])
    error = float(np.finfo(np.float64).eps) * scale
    for _ in range(MOST_HALVINGS):
        middle = 0.5 * (low + high)
        halves, sizes = _gauss(
            function, np.concatenate((low, middle)), np.concatenate((middle, high))
        )
        count = len(low)
        finer = halves[:count] + halves[count:]
        change = np.abs(finer - parts)
        done = change <= tolerance * scale * (high - low) / width
        done |= change <= ROUNDING * magnitude
        if 2 * int(np.sum(~done)) > MOST_STRETCHES:
            done[:] = True
        np.add.at(out, owner[done], finer[done])
        error += float(np.sum(change[done]))
        left = np.concatenate((~done, ~done))
        low, high = np.concatenate((low, middle))[left], np.concatenate((middle, high))[left]
        owner = np.concatenate((owner, owner))[left]
        parts, magnitude = halves[left], sizes[left]
        if not len(low):
            return out, error
    np.add.at(out, owner, parts)
    return out, error + float(np.sum(magnitude))


def _gauss(
    function: Callable[[FloatArray], FloatArray], low: FloatArray, high: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """The integrals over [low, high] (m,) each, and those of the magnitude."""
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    half, middle = 0.5 * (high - low), 0.5 * (high + low)
    x = middle[:, np.newaxis] + half[:, np.newaxis] * nodes
    values = function(x.ravel()).reshape(x.shape)
    return half * (values @ weights), half * (np.abs(values) @ weights)
