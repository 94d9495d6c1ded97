"""Effect `spring-surge`: the helical spring's lowest natural frequency among the lift's harmonics.

The moved end of the spring has the travel x, with the period T of a turn. Its harmonic n has the
frequency n/T and, with the phase psi = 2 pi t/T, the amplitude

    |c_n| = 1/pi |int x exp(-i n psi) dpsi| = 1/(pi n) |int x' exp(-i n psi) dphi|

over a turn, by parts, since x is continuous and periodic. Near the spring's natural frequency f_1
it excites waves along the coils that little damps (Budynas, Nisbett, Shigley's Mechanical
Engineering Design, 8th ed., section 10-7; Norton, Cam Design and Manufacturing Handbook, on spring
surge).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from camgeo.check.finding import Finding
from camgeo.dynamics.effects.effect import Bound, Request, Result
from camgeo.dynamics.effects.results import SPRING, Spring
from camgeo.dynamics.effects.wording import tolerance_error
from camgeo.errors import GeometryError
from camgeo.kinematics.time_course import period
from camgeo.numeric.arrays import SHARE, FloatArray, Side
from camgeo.numeric.extremes import piecewise_extremes
from camgeo.numeric.quadrature import piecewise_integral
from camgeo.units import RPM, TURN

CLEAR: Final = 15.0
"""Times the speed of the cam that the natural frequency should be at least (Shigley, 8th ed.,
section 10-7: 15 to 20)."""

FARTHEST: Final = 1000.0
"""Times the speed of the cam beyond which no harmonic of a lift matters."""


@dataclass(frozen=True, slots=True, eq=False)
class Surge(Result):
    """The surge.

    Attributes
    ----------
    frequency : f_1 as 2 pi f_1 [rad/s].
    speed : mean speed of the cam [rad/s].
    harmonic : the one nearest to f_1; None if that is farther than any that matters.
    """

    frequency: float
    speed: float
    harmonic: Harmonic | None


@dataclass(frozen=True, slots=True)
class Harmonic:
    """A harmonic of the travel.

    Attributes
    ----------
    order : n, 1 or more.
    amplitude : |c_n| [mm].
    error : estimate of its error [mm].
    travel : half of the whole travel of the spring's end [mm].
    """

    order: int
    amplitude: float
    error: float
    travel: float


def compute(request: Request[Mapping[str, Any]]) -> Surge:
    """The surge at the speed of the scene.

    Raises
    ------
    GeometryError
        With the key, if the spring is not stated by its wire, or there is no speed.
    EffectError
        If the amplitude does not reach the tolerance.
    """
    spring = request.results[SPRING]
    if spring.helical is None:
        raise GeometryError(
            "is missing: spring-surge needs a spring that is stated by its wire",
            key="effects.spring.wire",
        )
    frequency, speed = spring.helical.surge_frequency, TURN / period(request.course)
    ratio = frequency / speed
    nearest = None if ratio > FARTHEST else _harmonic(request, spring, max(1, round(ratio)))
    errors = {}
    if nearest is not None:
        errors["surge-harmonic"] = Bound(nearest.error, nearest.travel)
    return Surge(
        findings=(
            _frequency_finding(frequency, ratio),
            *_harmonic_findings(nearest, frequency, ratio, spring),
        ),
        errors=errors,
        frequency=frequency,
        speed=speed,
        harmonic=nearest,
    )


def _harmonic(request: Request[Mapping[str, Any]], spring: Spring, order: int) -> Harmonic:
    state, course = request.subject.state, request.course
    duration = period(course)

    def travel(phi: FloatArray, side: Side) -> FloatArray:
        return spring.way(phi, side)[0]

    def rate(phi: FloatArray) -> FloatArray:
        """x' (n,)."""
        return np.asarray(spring.way(phi, "right")[1] * state.motion.jet(phi, "right", 1)[1])

    def turned(phi: FloatArray) -> FloatArray:
        """n psi (n,)."""
        return (TURN * order / duration) * course.time(phi)

    edges = state.smooth_angles
    ends = piecewise_extremes(travel, edges)
    half = 0.5 * (ends.highest.value - ends.lowest.value)
    parts = [
        piecewise_integral(wave, edges, 0.1 * request.tolerance)
        for wave in (
            lambda phi: rate(phi) * np.cos(turned(phi)),
            lambda phi: rate(phi) * np.sin(turned(phi)),
        )
    ]
    share = 1.0 / (math.pi * order)
    error = share * math.hypot(*(part.error for part in parts))
    if error > request.tolerance * half:
        raise tolerance_error(
            f"harmonic {order} of the spring's travel",
            error / half,
            "the travel",
            request.tolerance,
        )
    return Harmonic(order, share * math.hypot(*(part.value for part in parts)), error, half)


def _frequency_finding(frequency: float, ratio: float) -> Finding:
    hertz = frequency / TURN
    near = ratio < CLEAR
    return Finding(
        "surge-frequency",
        "warning" if near else "ok",
        f"lowest natural frequency of the spring {hertz:.6g} Hz, {ratio:.4g} times the speed of the"
        f" cam, {'below' if near else 'at least'} {CLEAR:g} times",
        hertz,
        CLEAR * hertz / ratio,
        "Hz",
    )


def _harmonic_findings(
    nearest: Harmonic | None, frequency: float, ratio: float, spring: Spring
) -> Iterator[Finding]:
    """The finding on the amplitude of the nearest harmonic, and on the speed at which it
    resonates.
    """
    if nearest is None:
        return
    order, amplitude = nearest.order, nearest.amplitude
    if amplitude <= max(nearest.error, SHARE * nearest.travel):
        amplitude = 0.0
    yield Finding(
        "surge-harmonic",
        "ok",
        f"harmonic {order} of the spring's travel is nearest to its natural frequency,"
        f" {ratio:.4g} times the speed of the cam: an amplitude of {amplitude:.4g} mm, or"
        f" {spring.stiffness * amplitude:.4g} N without waves; it resonates at"
        f" {frequency / order / RPM:.6g} rev/min",
        amplitude,
        unit="mm",
    )
