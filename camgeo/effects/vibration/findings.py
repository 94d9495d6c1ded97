"""Findings of the vibration."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.check.finding import Finding
from camgeo.effects.vibration.output import Clock, Links, Output
from camgeo.effects.wording import Label, at, left_over
from camgeo.motion.motion import Dwell
from camgeo.motion.plan import in_turn
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.extremes import Extreme, Extremes, extremes_of_each, piecewise_extremes
from camgeo.numeric.oscillator.steady import Response
from camgeo.numeric.oscillator.train import Train
from camgeo.numeric.rounding import resolved
from camgeo.units import RPM, TURN
from camgeo.wording import cam_angle

LARGEST_FORCE: Final = "largest-train-force"
BY_LOAD: Final = "load-deflection"

AMPLIFICATION: Final = 10.0
"""Amplification of a harmonic above which it counts as resonance. Without damping this is reached
within 5 % of the natural frequency; with D of 0.05 or more it is hardly reached, as the maximum is
about 1 / (2 D)."""

EXACT: Final = 1e12
"""An amplification from here on is a rounded infinity: the harmonic equals the natural frequency,
and only a motion without this harmonic has a steady state.
"""

SHARE: Final = 0.1
"""Share of the largest deflection below which a harmonic is not significant."""

SETTLED: Final = 0.02
"""Share of an amplitude at which a transient counts as settled, as in the settling time 4 / (D w)
of control engineering.
"""


@dataclass(frozen=True, slots=True)
class MotionUnit:
    """The unit in which the demanded motion is displayed, and the factor from the internal unit."""

    unit: str
    scale: float

    def of(self, value: float) -> str:
        return f"{self.scale * value:.4g} {self.unit}"


def magnitude(both: Extremes) -> Extreme:
    """The extreme of larger magnitude, made positive; its cam angle in [0, 2 pi)."""
    worst = max(both.lowest, both.highest, key=lambda each: abs(each.value))
    return Extreme(abs(worst.value), worst.place % TURN)


def of_modes(train: Train, period: float) -> Iterator[Finding]:
    """The natural frequencies, and the time constants of overdamped modes."""
    for rate in train.poles.tolist():
        frequency = abs(rate)
        if rate.imag == 0.0:
            yield Finding(
                name="time-constant",
                severity="ok",
                sentence=f"a mode that does not oscillate, with the time constant"
                f" {1e3 / frequency:.6g} ms",
                value=1.0 / frequency,
                unit="s",
            )
            continue
        yield Finding(
            name="natural-frequency",
            severity="ok",
            sentence=(
                f"natural frequency {frequency / TURN:.6g} Hz,"
                f" {frequency * period / TURN:.6g} times the speed of the cam,"
                f" {TURN / period / RPM:.6g} rev/min"
            ),
            value=frequency / TURN,
            unit="Hz",
        )


def of_error(found: Extreme, limit: float | None, shown: MotionUnit) -> Finding:
    """The largest error of the motion, checked against its limit."""
    broken = limit is not None and found.value > limit
    against = "" if limit is None else f", {'above' if broken else 'at most'} {shown.of(limit)}"
    return Finding(
        name="largest-motion-error",
        severity="broken" if broken else "ok",
        sentence=(
            f"largest error of the motion {shown.of(found.value)} {at(found.place)}{against}"
        ),
        value=shown.scale * found.value,
        limit=None if limit is None else shown.scale * limit,
        unit=shown.unit,
        cam_angle=found.place,
    )


def of_load(found: Extreme, shown: MotionUnit) -> Finding:
    """The part of this error by which the load deflects the train at rest."""
    return Finding(
        name=BY_LOAD,
        severity="ok",
        sentence=(
            f"at rest the load deflects the output by up to {shown.of(found.value)}"
            f" {at(found.place)}, which is a part of this error"
        ),
        value=shown.scale * found.value,
        unit=shown.unit,
        cam_angle=found.place,
    )


def unexcited() -> Finding:
    """That the load cannot be taken into account."""
    return Finding(
        name="unexcited-train",
        severity="warning",
        sentence=(
            "the load acts on a mass that has the demanded motion, and [effects.inertia] states"
            " none: it is left out here"
        ),
    )


def of_acceleration(found: Extreme, clock: Clock, shown: MotionUnit) -> Finding:
    """The largest acceleration of the output, compared with that of a rigid train."""
    rigid = Output(clock, None)
    stiff = magnitude(piecewise_extremes(rigid.acceleration, clock.edges))
    times = f", {found.value / stiff.value:.4g} times" if stiff.value > 0.0 else ", compared with"
    unit = f"{shown.unit}/s^2"
    return Finding(
        name="largest-output-acceleration",
        severity="ok",
        sentence=(
            f"largest acceleration of the output {shown.scale * found.value:.6g} {unit}"
            f" {at(found.place)}{times} that of a rigid train,"
            f" {shown.scale * stiff.value:.6g} {unit} {at(stiff.place)}"
        ),
        value=shown.scale * found.value,
        unit=unit,
        cam_angle=found.place,
    )


def force_column(link: int) -> str:
    """The name of the force in a spring over the cam angle."""
    return f"train force {link + 1}"


def of_forces(output: Output, links: int, edges: FloatArray, label: Label) -> Iterator[Finding]:
    """The largest force in each spring with its damper, from the cam outwards."""
    if not links:
        return
    for link, both in enumerate(extremes_of_each(Links(links), output, edges)):
        found = magnitude(both)
        yield Finding(
            name=LARGEST_FORCE,
            severity="ok",
            sentence=(
                f"largest {label.word} in spring and damper {link + 1} of the train"
                f" {label.scale * found.value:.6g} {label.unit} {at(found.place)}"
            ),
            value=label.scale * found.value,
            unit=label.unit,
            cam_angle=found.place,
        )


def of_rests(clock: Clock, response: Response, shown: MotionUnit) -> Iterator[Finding]:
    """The vibration at the start of each dwell, the largest of them, and what is left at the
    end.
    """
    rests = [rest for rest in clock.motion.dwells if 0.0 < rest.span < TURN]
    if not rests:
        return
    starts = np.array([rest.start for rest in rests])
    amplitudes = response.free_amplitude(clock.time(in_turn(starts, "right")), "right")
    for rest, amplitude in zip(rests, amplitudes.tolist(), strict=True):
        yield _residual("residual-vibration", "vibration", rest, amplitude, shown)
    worst = int(np.argmax(amplitudes))
    yield _residual(
        "largest-residual-vibration",
        "largest vibration",
        rests[worst],
        float(amplitudes[worst]),
        shown,
    )
    slowest = float(np.max(response.train.poles.real))
    shortest = min(rests, key=lambda rest: _duration(clock, rest))
    left = math.exp(slowest * _duration(clock, shortest))
    lasts = "longer" if left <= SETTLED else "shorter"
    yield Finding(
        name="settling",
        severity="ok",
        sentence=(
            f"{left_over(left, 3)} of a vibration is left after the shortest dwell,"
            f" {1e3 * _duration(clock, shortest):.4g} ms{_from(shortest.start)}, which is"
            f" {lasts} than the transient, settled at {100.0 * SETTLED:g} %"
        ),
        value=left,
        cam_angle=shortest.start,
    )


def of_resonance(response: Response, most: float, shown: MotionUnit) -> Iterator[Finding]:
    """The harmonic of the cam's speed nearest to each natural frequency."""
    turn = TURN / response.base.period
    for rate in response.train.poles.tolist():
        if rate.imag == 0.0:
            continue
        number = max(1, round(abs(rate) / turn))
        factor = abs(response.train.transfer(number * turn)) * (number * turn) ** 2
        part = resolved(2.0 * abs(response.harmonic(number)), most)
        near = factor > AMPLIFICATION and part > SHARE * most
        amplified = f"amplified {factor:.4g} times, it"
        if not factor < EXACT:
            factor, amplified = None, "amplified without limit, and absent from the motion: it"
        yield Finding(
            name="resonance",
            severity="warning" if near else "ok",
            sentence=(
                f"harmonic {number} of the cam's speed is nearest to the natural frequency,"
                f" {abs(rate) / turn:.6g} times that speed: {amplified}"
                f" contributes {shown.of(part)} of the deflection of {shown.of(most)}"
            ),
            value=factor,
            limit=AMPLIFICATION if near else None,
        )


def _residual(name: str, what: str, rest: Dwell, amplitude: float, shown: MotionUnit) -> Finding:
    return Finding(
        name=name,
        severity="ok",
        sentence=f"{what} of {shown.of(amplitude)} left in the dwell{_from(rest.start)}",
        value=shown.scale * amplitude,
        unit=shown.unit,
        cam_angle=rest.start,
    )


def _duration(clock: Clock, rest: Dwell) -> float:
    ends = clock.course.time(np.array([rest.start, rest.start + rest.span]))
    return float(ends[1] - ends[0])


def _from(phi: float) -> str:
    return f" from cam angle {cam_angle(phi)} deg on"
