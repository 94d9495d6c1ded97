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

import numpy as np

from camgeo.numeric.arrays import FloatArray, merged
from camgeo.numeric.extremes import Extremes, extremes_of
from camgeo.numeric.peaks import grid_of
from camgeo.numeric.quadrature import piecewise_integrals
from camgeo.numeric.roots import roots_on_grid


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
    stretches, error = piecewise_integrals(surplus, places, tolerance)
    energy = np.concatenate(([0.0], np.cumsum(stretches)))
    return StoredEnergy(extremes_of(places, energy), error)


def moment_of_inertia(energy: float, fluctuation: float, speed: float) -> float:
    """J [t mm^2] for the span of energy [N mm], delta, and the mean speed [rad/s]."""
    return energy / (fluctuation * speed * speed)
