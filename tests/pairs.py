"""Conjugate pairs for tests, with the positions of their rollers by independent formulas.

The follower is one rigid body: the position of the return roller follows from that of the main one
and the dimensions of the scene, without the code under test.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass

import numpy as np
from hypothesis import strategies as st

from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.kinematics.mechanism.rollers import (
    OscillatingRoller,
    TranslatingRoller,
    return_on_carriage,
    return_on_lever,
)
from camgeo.numeric.arrays import ComplexArray, FloatArray, phase
from tests.strategies import SMOOTH, oscillating_rollers, plans, signs, translating_rollers

STROKE = 20.0
SWING = 0.3


@dataclass(frozen=True)
class Lever:
    """A lever with two rollers about `pivot`.

    Attributes
    ----------
    first : direction of the main arm at cam angle 0 [rad].
    between : angle from the main to the return arm [rad].
    sense : +1 if a positive lift turns the lever counter-clockwise.
    """

    pivot: complex
    first: float
    between: float
    arms: tuple[float, float]
    sense: int

    def rollers(self, lift: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """(n,), (n,) [mm] both roller centres in the fixed frame."""
        angle = self.first + self.sense * lift
        main: ComplexArray = self.pivot + self.arms[0] * np.exp(1j * angle)
        other: ComplexArray = self.pivot + self.arms[1] * np.exp(1j * (angle + self.between))
        return main, other


@dataclass(frozen=True)
class Carriage:
    """A carriage with two rollers that slides in the direction `along`, a unit vector."""

    start: complex
    along: complex
    apart: complex
    sense: int

    def rollers(self, lift: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """(n,), (n,) [mm] both roller centres in the fixed frame."""
        main = np.empty(len(lift), dtype=np.complex128)
        main[:] = self.start + (self.sense * self.along) * lift
        other: ComplexArray = main + self.apart
        return main, other


def lever_of(main: OscillatingRoller, between: float, arm: float) -> Lever:
    """The lever whose main roller is that of `main`, by the law of cosines."""
    distance = abs(main.pivot)
    cosine = (distance**2 + main.arm**2 - main.base_radius**2) / (2.0 * distance * main.arm)
    first = phase(-main.pivot) + main.arm_side * math.acos(cosine)
    sense = 1 if main.direction is None else main.direction * main.arm_side
    return Lever(main.pivot, first, between, (main.arm, arm), sense)


def carriage_of(main: TranslatingRoller, spacing: float, offset: float) -> Carriage:
    """The carriage whose main roller is that of `main`."""
    along = cmath.exp(1j * main.guide_angle)
    right = -1j * along
    height = math.sqrt(main.base_radius**2 - main.offset**2)
    start = right * main.offset + along * height
    apart = right * (offset - main.offset) - along * spacing
    return Carriage(start, along, apart, main.direction)


@dataclass(frozen=True)
class Pair:
    """Pitch curves of a pair, and the body that carries both rollers."""

    main: PitchCurve
    other: PitchCurve
    body: Lever | Carriage

    def in_cam(self, phi: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """(n,), (n,) [mm] both roller centres as the turning cam sees them."""
        main, other = self.body.rollers(self.main.motion.jet(phi)[0])
        turn = np.exp(-1j * self.main.rotation * phi)
        return main * turn, other * turn


@st.composite
def pairs(draw: st.DrawFn) -> Pair:
    """A pair that closes: both rollers on their side of the cam axis, whatever the lift."""
    sense = draw(signs())
    radius = draw(st.floats(2.0, 12.0))
    if draw(st.booleans()):
        guide, plan = draw(translating_rollers(STROKE)), draw(plans(SMOOTH, STROKE))
        height = math.sqrt(guide.base_radius**2 - guide.offset**2)
        spacing = height + draw(st.floats(40.0, 90.0)) + max(guide.direction, 0) * STROKE
        offset = draw(st.floats(-25.0, 25.0))
        other = return_on_carriage(guide, spacing, offset, radius)
        return Pair(
            PitchCurve(plan, guide, sense),
            PitchCurve(plan, other, sense),
            carriage_of(guide, spacing, offset),
        )
    rocker, plan = draw(oscillating_rollers(SWING)), draw(plans(SMOOTH, SWING))
    # The return arm on the other side of the line of centres, 20 to 150 degrees off it.
    swings = rocker.direction == 1
    low = math.radians(20.0) + (SWING if swings else 0.0)
    high = math.radians(150.0) - (0.0 if swings else SWING)
    distance = abs(rocker.pivot)
    cosine = (distance**2 + rocker.arm**2 - rocker.base_radius**2) / (2.0 * distance * rocker.arm)
    between = -rocker.arm_side * (math.acos(cosine) + draw(st.floats(low, high)))
    between += draw(st.sampled_from([0.0, math.copysign(2.0 * math.pi, -between)]))
    arm = draw(st.floats(50.0, 75.0))
    return Pair(
        PitchCurve(plan, rocker, sense),
        PitchCurve(plan, return_on_lever(rocker, between, arm, radius), sense),
        lever_of(rocker, between, arm),
    )
