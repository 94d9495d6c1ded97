"""Values of a torque over a turn: extremes, mean, root mean square, work, and the flywheel.

A drive with the constant torque T_m, equal to the mean, stores E(phi), the integral of T_m - T, in
everything that turns with the cam. E has its extremes where T passes T_m. With the mean speed omega
and the allowed fluctuation delta, the difference of largest and smallest speed divided by the mean,
this needs the moment of inertia

    J = (E_max - E_min) / (delta omega^2)

(Norton, Design of Machinery, chapter on dynamic force analysis, section on controlling the input
torque by flywheels; Khurmi and Gupta, Theory of Machines, chapter 16 on turning moment diagrams).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from camgeo.effects.drive_torque.law import TorqueLaw
from camgeo.effects.wording import missed
from camgeo.motion.time_course import period
from camgeo.numeric.arrays import FloatArray, merged
from camgeo.numeric.extremes import Extremes, extremes_of, grid_of, piecewise_extremes
from camgeo.numeric.quadrature import piecewise_integral, piecewise_integrals
from camgeo.numeric.roots import roots_on_grid
from camgeo.numeric.rounding import SHARE, resolved
from camgeo.units import TURN


@dataclass(frozen=True, slots=True)
class StoredEnergy:
    """E over a turn, 0 at cam angle 0.

    Attributes
    ----------
    extremes : smallest and largest E [N mm], with their cam angles [rad].
    error : estimate of the error of `span` [N mm].
    """

    extremes: Extremes
    error: float

    @property
    def span(self) -> float:
        """E_max - E_min [N mm]."""
        return self.extremes.highest.value - self.extremes.lowest.value


@dataclass(frozen=True, slots=True)
class Summary:
    """Values of a turn; torques in N mm.

    Attributes
    ----------
    peaks, static_peaks : smallest and largest value of the torque and of its static part.
    mean : over the cam angle: the work of a turn [N mm] divided by 2 pi.
    rms : root mean square over time.
    speed : mean speed over time [rad/s]; 0 if the scene gives none.
    stored : energy in the flywheel; None if none is requested.
    mean_error, rms_error : estimates of the errors of `mean` and `rms` [N mm].
    """

    peaks: Extremes
    static_peaks: Extremes
    mean: float
    rms: float
    speed: float
    stored: StoredEnergy | None
    mean_error: float
    rms_error: float

    @property
    def error(self) -> float:
        """The largest error, relative to the largest torque; that of the energy divided by 2 pi."""
        largest = self.peaks.magnitude
        stored = 0.0 if self.stored is None else self.stored.error / TURN
        worst = max(self.mean_error, self.rms_error, stored)
        return worst / largest if largest > 0.0 else 0.0


def summary(law: TorqueLaw, fluctuation: float | None, tolerance: float) -> Summary:
    """The values of the torque in `law`, with integrals to `tolerance`.

    The mean square over time is the integral of T^2 dt over the turn divided by its duration, with
    dt = dphi / omega; at constant speed, or without a speed, it is the mean over the cam angle.

    Raises
    ------
    EffectError
        If the tolerance cannot be reached.
    """
    edges, course = law.contact.edges, law.subject.state.course

    def values(phi: FloatArray) -> FloatArray:
        return law.torque(phi, "right")

    def squares(phi: FloatArray) -> FloatArray:
        slowness = 1.0 if course is None else 1.0 / course.rates(phi)[0]
        return np.asarray(values(phi) ** 2 * slowness)

    duration = TURN if course is None else period(course)
    peaks = piecewise_extremes(law.torque, edges)
    static_peaks = piecewise_extremes(law.static, law.static_edges())
    work = piecewise_integral(values, edges, tolerance)
    mean = resolved(work.value, work.magnitude) / TURN  # conservative forces do no work
    square = piecewise_integral(squares, edges, tolerance)
    mean_square, unsure = max(square.value, 0.0) / duration, square.error / duration
    rms = math.sqrt(mean_square)
    rms_error = rms - math.sqrt(max(mean_square - unsure, 0.0))
    stored = None
    if fluctuation is not None:
        stored = stored_energy(values, mean, work.error / TURN, edges, tolerance)
    speed = 0.0 if course is None else TURN / duration
    found = Summary(peaks, static_peaks, mean, rms, speed, stored, work.error / TURN, rms_error)
    if found.error > max(tolerance, SHARE):
        raise missed(
            "an integral of the drive torque", found.error, "the largest torque", tolerance
        )
    return found


def stored_energy(
    torque: Callable[[FloatArray], FloatArray],
    mean: float,
    unsure: float,
    edges: FloatArray,
    tolerance: float,
) -> StoredEnergy:
    """The energy stored if the drive provides the mean torque.

    Parameters
    ----------
    torque : (n,) cam angles [rad] -> (n,) [N mm], smooth between neighbouring edges.
    mean, unsure : mean of the torque over the turn, and its error [N mm].
    edges : (m + 1,) [rad] from 0 to 2 pi, ascending.
    tolerance : of the integrals, relative to the integral of the magnitude.
    """

    def surplus(phi: FloatArray) -> FloatArray:
        return mean - torque(phi)

    passing = roots_on_grid(surplus, grid_of(edges))
    places = merged(np.concatenate((edges, passing)))
    stretches, error = piecewise_integrals(surplus, places, tolerance)
    energy = np.concatenate(([0.0], np.cumsum(stretches)))
    return StoredEnergy(extremes_of(places, energy), error + TURN * unsure)


def moment_of_inertia(energy: float, fluctuation: float, speed: float) -> float:
    """J [t mm^2] for the span of energy [N mm], delta, and the mean speed [rad/s]."""
    return energy / (fluctuation * speed * speed)
