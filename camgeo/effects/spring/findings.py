"""What is found of a spring: its force, its deflection, where it does not close the contact."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from camgeo.check.finding import Finding
from camgeo.effects.effect import toucher
from camgeo.effects.spring.ways import Way, closing_sense, outward
from camgeo.effects.told import at, placed
from camgeo.motion.motion import Side
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.extremes import Extreme, piecewise_extremes, stretch_below
from camgeo.units import TURN

if TYPE_CHECKING:
    from camgeo.effects.effect import Quantity, Subject

ROUNDING: Final = 64.0 * 2.0**-52
"""A force or lever below this share of its largest magnitude is 0, rounded."""


def force_findings(force: Quantity, subject: Subject, unit: str) -> list[Finding]:
    """Largest and smallest force [unit], and where it is below 0."""
    edges = subject.cam.drive.smooth_angles
    found = piecewise_extremes(force, edges)
    name = "torque" if unit == "N m" else "force"
    findings = [
        placed(
            f"{size}-spring-{name}",
            f"{size} spring {name} {extreme.value:.6g} {unit} {at(extreme.place)}",
            extreme,
            unit,
        )
        for size, extreme in (("largest", found.highest), ("smallest", found.lowest))
    ]
    lowest = found.lowest
    if lowest.value < -ROUNDING * found.magnitude:
        first, last = _below(force, edges, lowest.place)
        findings.append(
            Finding(
                name="slack-spring",
                severity="warning",
                sentence=(
                    f"the spring {name} is below 0 from cam angle {math.degrees(first):.4f} to"
                    f" {math.degrees(last):.4f} deg, {lowest.value:.6g} {unit}"
                    f" {at(lowest.place)}: a real spring is slack there, the values hold on"
                ),
                value=lowest.value,
                limit=0.0,
                unit=unit,
                cam_angle=lowest.place % TURN,
                cam_range=(first, last),
            )
        )
    return findings


def deflection(way: Way, subject: Subject, *, torsion: bool) -> Finding:
    """Largest change of length, or of angle, since cam angle 0."""
    found = piecewise_extremes(lambda phi, side: way(phi, side)[0], subject.cam.drive.smooth_angles)
    farthest = max(found.highest, found.lowest, key=lambda extreme: abs(extreme.value))
    value = abs(math.degrees(farthest.value) if torsion else farthest.value)
    unit = "deg" if torsion else "mm"
    kind = "relaxed" if farthest.value > 0.0 else "tightened"
    place = farthest.place
    sentence = f"largest spring deflection {value:.6g} {unit} {at(place)}, {kind} since cam angle 0"
    return placed("largest-spring-deflection", sentence, Extreme(value, place), unit)


def opening(way: Way, subject: Subject) -> list[Finding]:
    """Whether the spring presses away from the flank that it is to close, and where."""
    edges = subject.cam.drive.smooth_angles

    def closing(phi: FloatArray, side: Side) -> FloatArray:
        """Of the sign of dx/dn towards the flank."""
        towards = closing_sense(subject) * outward(subject, phi, side)
        return np.asarray(towards * way(phi, side)[1])

    found = piecewise_extremes(closing, edges)
    if found.lowest.value >= -ROUNDING * found.magnitude:
        return []
    first, last = _below(closing, edges, found.lowest.place)
    return [
        Finding(
            name="spring-opens-contact",
            severity="warning",
            sentence=(
                f"the spring presses the {toucher(subject)} away from its flank from cam angle"
                f" {math.degrees(first):.4f} to {math.degrees(last):.4f} deg"
            ),
            cam_angle=found.lowest.place % TURN,
            cam_range=(first, last),
        )
    ]


def _below(function: Quantity, edges: FloatArray, place: float) -> tuple[float, float]:
    """From, to [rad] of the range around `place` in which `function` is below 0."""
    found = stretch_below(lambda phi: function(phi, "right"), edges, place)
    return found or (place % TURN, place % TURN)
