"""Figures of a torque over a turn: extremes, mean, root mean square, work, stored energy."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.effects.drive_torque.flywheel import StoredEnergy, stored_energy
from camgeo.effects.drive_torque.torque import DriveTorque
from camgeo.errors import EffectError
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.extremes import Extremes
from camgeo.numeric.peaks import piecewise_extremes
from camgeo.numeric.quadrature import piecewise_integral
from camgeo.units import TURN

ROUNDING: Final = 1e-14
"""An error or a mean below this share of the largest torque is rounding."""


@dataclass(frozen=True, slots=True)
class Summary:
    """Figures of a turn; torques in N mm.

    Attributes
    ----------
    peaks, static_peaks : smallest and largest torque, of the whole and of its static part.
    mean : over the cam angle: the work of a turn [N mm] divided by 2 pi.
    rms : root of the mean square over time.
    speed : mean speed over time [rad/s]; 0 if the scene gives none.
    stored : energy in the flywheel; None if none is sought.
    error : estimate of the largest error as a share of the largest torque, an energy's divided by
        2 pi.
    """

    peaks: Extremes
    static_peaks: Extremes
    mean: float
    rms: float
    speed: float
    stored: StoredEnergy | None
    error: float


def summary(torque: DriveTorque, fluctuation: float | None, tolerance: float) -> Summary:
    """The figures of `torque`, the integrals among them to `tolerance`.

    The mean square over time is the integral of T^2 dt over the turn by its duration, with
    dt = dphi / omega; at constant speed, or without one, that is the mean over the cam angle.

    Raises
    ------
    EffectError
        If the tolerance cannot be reached.
    """
    edges, course = torque.edges, torque.course

    def values(phi: FloatArray) -> FloatArray:
        return torque.torque(phi, "right")

    def squares(phi: FloatArray) -> FloatArray:
        slowness = 1.0 if course is None else 1.0 / course.rates(phi)[0]
        return np.asarray(values(phi) ** 2 * slowness)

    duration = TURN
    if course is not None:
        start, end = course.time(np.array([0.0, TURN]))
        duration = float(end - start)
    peaks = piecewise_extremes(torque.torque, edges)
    static_peaks = piecewise_extremes(torque.static, torque.static_edges)
    largest = peaks.magnitude
    work = piecewise_integral(values, edges, tolerance)
    mean = work.value / TURN
    if abs(mean) <= ROUNDING * largest:
        mean = 0.0  # what conserves energy does no work
    square = piecewise_integral(squares, edges, tolerance)
    mean_square = max(square.value, 0.0) / duration
    rms = math.sqrt(mean_square)
    stored = None
    if fluctuation is not None:
        stored = stored_energy(values, mean, edges, tolerance)
    error = 0.0
    if largest > 0.0:
        errors = [work.error / TURN]
        if rms > 0.0:
            errors.append(0.5 * square.error / duration / rms)
        if stored is not None:
            errors.append(stored.error / TURN)
        error = max(errors) / largest
    if error > max(tolerance, ROUNDING):
        raise EffectError(
            f"the integrals of the drive torque reach an error of {error:.3g} of its largest value"
            f" instead of the tolerance of {tolerance:g}",
            value=error,
            limit=tolerance,
        )
    speed = 0.0 if course is None else TURN / duration
    return Summary(peaks, static_peaks, mean, rms, speed, stored, error)
